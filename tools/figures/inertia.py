"""A structure that gives way to acceleration: what the tip does and no scale shows, over a circle or a corner."""
import numpy as np

from figures import circular, style
from figures.results import NotInFile, passes
from figures.volumetric import magnification

SIGNAL = "inertial_deflection"
REACH = 15.0      # mm of the path on both sides of the largest deflection at most, where it is not on a circle
SMALL = 0.05      # of the largest deflection: the corner ends there
MARGIN = 1.0      # mm of the path before and behind a corner, at least; beyond the ends of feed motion is none
LEAST = 1e-3      # um: less is none
SHARE = 0.12      # of the extent: the largest deflection as drawn
WIDTH = 9.6       # inches


def place_of(case):
    """(rows, what they are): the circle on which the structure gives way most, or the path around the largest deflection
    that is not at an end of feed motion; None if it gives way nowhere."""
    rows = case.samples()
    size = np.linalg.norm(case.column(SIGNAL), axis=1)
    if not len(rows) or size[rows].max() < LEAST:
        return None
    circles = [name for name in case.sections if name and circular.turn_of(case, name) is not None]
    if circles:
        name = max(circles, key=lambda one: size[case.samples([one])].max())
        return case.samples([name]), f"In section {name}"
    s = case.column("s")
    parts = passes(rows)
    between = [part[(s[part] > s[part[0]] + MARGIN) & (s[part] < s[part[-1]] - MARGIN)] for part in parts]
    inner = np.concatenate(between)
    peak = inner[size[inner].argmax()] if len(inner) else rows[size[rows].argmax()]
    part = next(part for part in parts if part[0] <= peak <= part[-1])
    section = case.sections[int(case.column("section")[peak])]
    small = part[size[part] < SMALL * size[peak]]
    begin, end = s[small[small < peak]].max(initial=s[part[0]]), s[small[small > peak]].min(initial=s[part[-1]])
    reach = min(REACH, max(s[peak] - begin, end - s[peak]) + max(end - begin, MARGIN))
    near = part[np.abs(s[part] - s[peak]) <= reach]
    return near, f"On line {int(case.column('line')[peak])}" + (f" of {section}" if section else "")


def draw(run):
    bending = [case for case in run.finished_cases() if case.has(SIGNAL) and place_of(case) is not None]
    if not bending:
        raise NotInFile("no finished case has a structure that gives way to acceleration (inertial_deflection)")
    first = max(bending, key=lambda case: np.linalg.norm(case.column(SIGNAL)[place_of(case)[0]], axis=1).max())
    at, where = place_of(first)
    scales, moved = first.column("meas_linear")[at], first.column(SIGNAL)[at]
    letters = [letter for n, letter in enumerate(first.labels("meas_linear")) if np.abs(moved[:, n]).max() > LEAST]
    plane = np.sort(np.argsort(np.ptp(scales, axis=0))[::-1][:2])
    factor = magnification(np.ptp(scales, axis=0).max(), np.linalg.norm(moved[:, plane], axis=1).max(), SHARE)
    looks = {case.name: style.look_of(run, case.name) for case in bending}
    shown = _at_same_place(bending, first.column("s")[at[[0, -1]]])
    columns, lines = style.legend_shape(looks.values(), WIDTH)
    figure, strip, grid = style.panels([3.0] + [1.0] * len(letters), (WIDTH, 6.4 + 1.5 * len(letters)), legend_lines=lines)
    style.legend(strip, list(looks.values()), columns=columns)
    _plan(grid[0][0], shown, looks, first, plane, factor)
    for row, letter in zip(grid[1:], letters):
        for case, part in shown:
            style.line(row[0], case.column("s")[part], case.column(SIGNAL, letter)[part], looks[case.name], linewidth=1.2)
        row[0].axhline(0.0, color=style.BLACK, linewidth=0.8)
        row[0].set_ylabel("µm")
        row[0].set_title(f"Tip minus scale of {letter}")
    grid[-1][0].set_xlabel("path length, mm")
    largest = np.linalg.norm(moved, axis=1).max()
    style.headline(figure, f"{where} the tip is up to {style.number(largest)} µm away from where the scales show it ({first.name})")
    return figure


def _at_same_place(cases, ends):
    """[(case, rows)] between two path lengths, a pass after the other."""
    found = []
    for case in cases:
        s = case.column("s")
        found += [(case, part) for part in passes(case.samples()) for part in [part[(s[part] >= ends[0]) & (s[part] <= ends[1])]]
                  if len(part)]
    return found


def _plan(ax, shown, looks, first, plane, factor):
    a, b = plane
    for case, part in shown:
        path = case.column("meas_linear")[part] + factor * 1e-3 * case.column(SIGNAL)[part]
        style.line(ax, path[:, a], path[:, b], looks[case.name], linewidth=1.2)
    for case, part in shown:
        if case is first:
            path = case.column("meas_linear")[part]
            style.line(ax, path[:, a], path[:, b], style.Look("", style.GREY, style.DOT, "", 1.6))
    ax.set_aspect("equal", adjustable="datalim")
    letters = first.labels("meas_linear")
    ax.set_xlabel(f"{letters[a]}, mm")
    ax.set_ylabel(f"{letters[b]}, mm")
    ax.set_title(f"Path of the scales (dotted) and of the tip: deflection by acceleration x {factor:g}")
