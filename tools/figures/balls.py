"""Tests with a ball in the spindle (ISO 10791-6): what a nest of sensors reads over the angle of the
axis that turns, and what a ball bar reads around its circle; every case in one picture.

Deviations are true minus nominal, in the workpiece; those of a nest begin at 0, as the sensors are
set there.
"""
import dataclasses

import numpy as np

from figures import circular, style
from figures.results import NotInFile, UM_PER_MM

TURNS = 1e-3           # deg, by which an axis turns that turns
NEST = "radial_ball_deviation"
BAR = "ball_bar_deviation"


def _asked(run, quantity):
    """Tables [[quantity]] of that name."""
    found = [one for one in run.scenario.get("quantity", []) if one.get("name") == quantity]
    if not found:
        raise NotInFile(f"the scenario asks for no {quantity}")
    return found


def _ranges(run, quantity):
    """{(case, sections): range, um} as the file's comparison has it."""
    return {(str(row.attrs["case"]), str(row.attrs["sections"])): float(row["value"][()])
            for row in run.h5.get("comparison", {}).values()
            if str(row.attrs["quantity"]) == quantity and str(row.attrs["statistic"]) == "range"}


def _shown(run):
    """Cases by name. One that differs from another by its servo loops alone lies under it: it is left out."""
    ideal = {one.get("name") for one in run.scenario.get("case", []) if one.get("servo") == "ideal"}
    cases = [case for case in run.finished_cases() if case.name not in ideal]
    return cases or run.finished_cases()


def _look(run, case):
    """As everywhere, but a case without strategy stands out: its twin on ideal axes is left out."""
    acting = [one for one in run.strategies(case) if one.get("type") != "none"]
    look = style.look_of(run, case)
    return look if acting else dataclasses.replace(look, colour=style.BLACK, line="-", width=2.2)


def _turning(case, rows):
    """Letter and angle (deg) of the rotary axis that turns alone, or None."""
    turning = [letter for letter in case.labels("ref_rotary")
               if np.ptp(case.column("ref_rotary", letter)[rows]) > TURNS]
    return (turning[0], case.column("ref_rotary", turning[0])[rows]) if len(turning) == 1 else None


def draw_nest(run):
    """R-test: what the three sensors read over the angle, a column for each section."""
    cases = _shown(run)
    asked = [list(one["sections"]) for one in _asked(run, NEST)]
    columns = []
    for sections in asked:
        rows = cases[0].samples(sections)
        turning = _turning(cases[0], rows) if len(rows) else None
        if turning:
            columns.append((sections, turning[0]))
    if not columns:
        raise NotInFile("no section moves exactly one rotary axis")
    looks = {case.name: _look(run, case.name) for case in cases}
    width = 4.4 * len(columns) + 0.8
    across, lines = style.legend_shape(looks.values(), width)
    figure, strip, grid = style.panels([1.0] * 3, (width, 6.34 + 0.26 * lines), columns=len(columns), legend_lines=lines)
    style.legend(strip, looks.values(), columns=across)
    for column, (sections, letter) in enumerate(columns):
        for case in cases:
            rows = case.samples(sections)
            angle = _turning(case, rows)[1]
            off = (case.column("tool_position_true")[rows] - case.column("tool_position_nominal")[rows]) * UM_PER_MM
            for row in range(3):
                style.line(grid[row][column], *style.thin(angle, off[:, row] - off[0, row]), looks[case.name])
        grid[0][column].set_title(", ".join(sections))
        grid[2][column].set_xlabel(f"{letter}, deg")
        for row in range(2):
            grid[row][column].tick_params(labelbottom=False)
    for row, name in enumerate("XYZ"):
        low = min(ax.get_ylim()[0] for ax in grid[row])
        high = max(ax.get_ylim()[1] for ax in grid[row])
        for ax in grid[row]:
            ax.set_ylim(low, high)
        grid[row][0].set_ylabel(f"{name} of the table, µm")
    figure.align_ylabels([row[0] for row in grid])
    style.headline(figure, "R-test: displacement of the ball in the sensor nest" + _before_and_after(run, cases))
    return figure


def _before_and_after(run, cases):
    """": 21 um before, 0.3 um with X" from the ranges of radial deviation, where there are both."""
    ranges = _ranges(run, NEST)
    largest = {case.name: max((value for (name, _), value in ranges.items() if name == case.name), default=np.nan)
               for case in cases}
    if len(largest) < 2 or not all(np.isfinite(value) for value in largest.values()):
        return ""
    before, best = cases[0].name, min(largest, key=largest.get)
    if best == before:
        return f"; radial {style.number(largest[before])} µm with {_look(run, before).label}, more with the others"
    return (f"; radial {style.number(largest[before])} µm before, {style.number(largest[best])} µm with "
            f"{_look(run, best).label}")


def _around(nominal, centre):
    """Angle of the nominal tip around the axis of its circle (rad), beginning at 0."""
    middle = nominal.mean(axis=0)
    _, _, axes = np.linalg.svd(nominal - middle, full_matrices=False)
    first = nominal[0] - middle
    first -= axes[2] * (first @ axes[2])
    first /= np.linalg.norm(first)
    second = np.cross(axes[2], first)
    angle = np.unwrap(np.arctan2((nominal - middle) @ second, (nominal - middle) @ first))
    return angle if angle[-1] > 0.0 else -angle


def _angles(ax):
    """Angles outside of the rings, from where the circle begins."""
    for angle in range(0, 360, 45):
        away = circular.REACH + (0.75 if angle % 90 else 0.4)
        ax.text(away * np.cos(np.radians(angle)), away * np.sin(np.radians(angle)), f"{angle}°", ha="center", va="center",
                fontsize=8, color=style.GREY)


def draw_bar(run):
    """BK4: deviation of the bar's length around the circle, magnified; a picture for each bar."""
    cases = _shown(run)
    bars = [bar for one in _asked(run, BAR) for bar in one["bar"]]
    ranges = _ranges(run, BAR)
    looks = {case.name: _look(run, case.name) for case in cases}
    read = {}
    for n, bar in enumerate(bars):
        centre = np.array(bar["centre_mm"], float)
        for case in cases:
            rows = case.samples([bar["section"]])
            if len(rows) < 10:
                raise NotInFile(f"no samples in section {bar['section']}")
            nominal, true = case.column("tool_position_nominal")[rows], case.column("tool_position_true")[rows]
            off = (np.linalg.norm(true - centre, axis=1) - np.linalg.norm(nominal - centre, axis=1)) * UM_PER_MM
            read[n, case.name] = (_around(nominal, centre), off)
    unit = circular.division(max(np.abs(off).max() for _, off in read.values()))
    below = -circular.REACH - 1.0 - circular.LINE * (len(cases) + 0.7)
    width = 3.9
    height = width * (circular.top() - below) / (2.0 * circular.SIDE) + 0.3
    across, lines = style.legend_shape(looks.values(), width * len(bars) + 0.1)
    figure, strip, grid = style.panels([1.0], (width * len(bars) + 0.1, height + 0.49 + 0.26 * lines), columns=len(bars),
                                       legend_lines=lines)
    style.legend(strip, looks.values(), columns=across)
    for n, (ax, bar) in enumerate(zip(grid[0], bars)):
        circular.rings(ax, unit)
        _angles(ax)
        y = -circular.REACH - 1.0
        ax.text(3.4, y, "range, µm", ha="right", va="center", fontsize=9.5, color=style.GREY)
        for case in cases:
            angle, off = read[n, case.name]
            keep = slice(None, None, max(1, len(angle) // 4000))
            radius = circular.CENTRE + off / unit
            style.line(ax, (radius * np.cos(angle))[keep], (radius * np.sin(angle))[keep], looks[case.name], zorder=3)
            y -= circular.LINE
            value = ranges.get((case.name, bar["section"]), np.nan)
            ax.text(-4.6, y, looks[case.name].label, va="center", fontsize=9.5, color=looks[case.name].colour)
            ax.text(3.4, y, style.number(value) if np.isfinite(value) else "–", ha="right", va="center", fontsize=9.5)
        ax.set_ylim(below, circular.top())
        ax.set_title(bar["section"], loc="center", fontweight="bold")
    style.headline(figure, "BK4: length of the ball bar around its circle, magnified")
    return figure
