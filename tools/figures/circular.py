"""Circular tests after ISO 230-4: the polar diagram of a ball bar, and the reversals one by one.

Deviations are radial, from the nominal radius, about the least-squares centre of each turn; outward
is positive. G(b) and D are those that the file's comparison holds.
"""
import dataclasses
import re

import numpy as np

from figures import results, style
from figures.results import NotInFile

ROUND = 0.01          # mm: how far the nominal path of a circle may be off one
WHOLE = 2.0           # deg: how far a turn may be off 360
LINES = {1: "-", -1: (0, (4, 2.5))}   # of a turn by its sense
SHADES = ["#8fc1e3", style.BLUE, style.PURPLE, style.BLACK, style.RED, style.GREY]
BEFORE, BEHIND = 10.0, 20.0   # deg about a reversal: where friction shows


@dataclasses.dataclass
class Turn:
    """One turn of one case: angle (deg, unwrapped) and radial deviation (um)."""
    case: str
    label: str         # of the section without its direction, "4 m/min"
    plane: str         # "XY"
    sense: int         # 1 counter-clockwise, -1 clockwise
    radius: float      # nominal, mm
    theta: np.ndarray
    dr: np.ndarray
    form: np.ndarray   # deviation from the turn's own least-squares circle


def least_squares_circle(x, y):
    """Centre and radius with the smallest sum of squared distances (Gauss-Newton)."""
    cx, cy = x.mean(), y.mean()
    radius = np.hypot(x - cx, y - cy).mean()
    for _ in range(10):
        rho = np.hypot(x - cx, y - cy)
        rows = np.stack([(x - cx) / rho, (y - cy) / rho, np.ones_like(x)], axis=1)
        step = np.linalg.lstsq(rows, rho - radius, rcond=None)[0]
        cx, cy, radius = cx + step[0], cy + step[1], radius + step[2]
    return cx, cy, radius


def turn_of(case, section):
    """The section as a turn of a circle, or None if it is none."""
    rows = case.samples([section])
    if len(rows) < 10:
        return None
    nominal = case.column("tool_position_nominal")[rows]
    extent = np.ptp(nominal, axis=0)
    normal = int(np.argmin(extent))
    first, second = (normal + 1) % 3, (normal + 2) % 3
    if extent.max() <= ROUND:
        return None   # the tip stands, as in an R-test
    if extent[normal] > ROUND or min(extent[first], extent[second]) < 0.5 * extent.max():
        return None
    cx, cy, radius = least_squares_circle(nominal[:, first], nominal[:, second])
    off = np.hypot(nominal[:, first] - cx, nominal[:, second] - cy) - radius
    theta = np.unwrap(np.arctan2(nominal[:, second] - cy, nominal[:, first] - cx))
    if np.abs(off).max() > ROUND or abs(abs(np.degrees(theta[-1] - theta[0])) - 360.0) > WHOLE:
        return None
    true = case.column("tool_position_true")[rows]
    x, y = true[:, first], true[:, second]
    cx, cy, mean = least_squares_circle(x, y)
    rho = np.hypot(x - cx, y - cy)
    label = re.sub(r"[\s_-]*c?cw$", "", section) or section
    return Turn(case.name, label, "XYZ"[first] + "XYZ"[second],
                1 if theta[-1] > theta[0] else -1, radius,
                np.degrees(np.unwrap(np.arctan2(y - cy, x - cx))),
                (rho - radius) * results.UM_PER_MM, (rho - mean) * results.UM_PER_MM)


def turns_of(run):
    """{case name: turns} of all finished cases."""
    found = {case.name: [turn for section in case.sections
                         if (turn := turn_of(case, section)) is not None]
             for case in run.finished_cases()}
    if not any(found.values()):
        raise NotInFile("no section is one full circle")
    return {name: turns for name, turns in found.items() if turns}


def numbers(run, quantity):
    """{(case, label): value} of a quantity of both directions, from the file's comparison."""
    found = {}
    for row in run.h5.get("comparison", {}).values():
        if str(row.attrs["quantity"]) == quantity:
            section = str(row.attrs["sections"]).split(", ")[0]
            label = re.sub(r"[\s_-]*c?cw$", "", section) or section
            found[str(row.attrs["case"]), label] = float(row["value"][()])
    return found


def division(largest):
    """A round number of micrometres such that two divisions hold the largest deviation."""
    exponent = 10.0 ** np.floor(np.log10(max(largest, 1e-6) / 2.0))
    return next(m * exponent for m in (1.0, 2.0, 5.0, 10.0) if 2.0 * m * exponent >= largest)


ALIKE = 4.0   # divisions that differ by no more are drawn as the coarser one


def divisions(largest):
    """{case: division} of {case: largest deviation}: one for cases that can be compared so."""
    found, coarsest = {}, np.inf
    for case in sorted(largest, key=largest.get, reverse=True):
        own = division(largest[case])
        if own * ALIKE < coarsest * (1.0 - 1e-9):
            coarsest = own
        found[case] = coarsest
    return found


def looks_of(turns):
    """{label: colour} in the order of the program."""
    labels = list(dict.fromkeys(turn.label for of_case in turns.values() for turn in of_case))
    return {label: SHADES[min(i, len(SHADES) - 1)] for i, label in enumerate(labels)}


def signed(value):
    """A number of a table with its sign, in two or three digits."""
    text = f"{value:+.2f}" if abs(value) < 10.0 else f"{value:+.1f}"
    return "0.00" if text in ("+0.00", "-0.00") else text.replace("-", "−")


def draw(run):
    turns = turns_of(run)
    colours = looks_of(turns)
    columns = len(turns) if len(turns) <= 4 else 3
    units = divisions({name: max(np.abs(turn.dr).max() for turn in of_case)
                       for name, of_case in turns.items()})
    rows = -(-len(turns) // columns)
    both, mean = (numbers(run, quantity) for quantity in (
        "bidirectional_circular_error", "mean_bidirectional_radial_error"))
    listed = colours if both or mean else {}     # below each picture
    height = WIDTH * (top() - bottom(listed)) / (2.0 * SIDE) + 0.3     # with the title
    figure, strip, grid = style.panels([1.0] * rows, (WIDTH * columns + 0.1, height * rows + 0.75),
                                       columns=columns)
    panels = [ax for row in grid for ax in row]
    for ax, (name, of_case) in zip(panels, turns.items()):
        _polar(ax, of_case, colours, units[name])
        if listed:
            _table(ax, both, mean, name, listed)
        ax.set_ylim(bottom(listed), top())
        ax.set_title(name.replace("_", " "), loc="center", fontweight="bold")
    for ax in panels[len(turns):]:
        ax.axis("off")
    _legend(strip, colours, turns, 0.012)
    first = next(iter(turns.values()))[0]
    style.headline(figure, f"Circular test in {first.plane}, R {first.radius:.4g} mm: "
                           "radial deviation, magnified")
    return figure


WIDTH = 3.3    # inches, of one picture
CENTRE = 4.0   # divisions from the middle of the picture to the nominal circle
REACH = 6.0    # ... to the outermost ring
SIDE = 6.8     # ... to its sides
LINE = 1.0     # ... from one line of the table to the next


def top():
    return REACH + 0.8


def bottom(colours):
    return -REACH - 1.0 - LINE * (len(colours) + 0.7)


def rings(ax, unit):
    """Rings of a polar diagram, `unit` um apart, the middle one of which is the nominal circle; the scale."""
    around = np.radians(np.linspace(0.0, 360.0, 721))
    for ring in range(-2, 3):
        radius = CENTRE + ring
        ax.plot(radius * np.cos(around), radius * np.sin(around), zorder=1,
                color=style.GREY if ring == 0 else "#d5d5d5", linewidth=1.3 if ring == 0 else 0.7)
    for angle in range(0, 180, 45):
        c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
        for side in (-1.0, 1.0):
            ax.plot([side * (CENTRE - 2) * c, side * REACH * c],
                    [side * (CENTRE - 2) * s, side * REACH * s], color="#d5d5d5",
                    linewidth=0.7, zorder=1)
    # the scale, in the middle where no curve is
    ax.plot([-0.5, 0.5], [0.3, 0.3], color=style.BLACK, linewidth=2.2, solid_capstyle="butt")
    for end in (-0.5, 0.5):
        ax.plot([end, end], [0.12, 0.48], color=style.BLACK, linewidth=1.2)
    ax.text(0.0, -0.05, f"{unit:g} µm", ha="center", va="top", fontsize=10.5,
            fontweight="bold")
    ax.set_xlim(-SIDE, SIDE)
    ax.set_aspect("equal")
    ax.axis("off")


def _polar(ax, turns, colours, unit):
    rings(ax, unit)
    for turn in turns:
        theta, radius = np.radians(turn.theta), CENTRE + turn.dr / unit
        keep = slice(None, None, max(1, len(theta) // 4000))
        ax.plot((radius * np.cos(theta))[keep], (radius * np.sin(theta))[keep],
                color=colours[turn.label], linewidth=1.4,
                linestyle=LINES[turn.sense], zorder=3)
    plane = turns[0].plane
    ax.text(REACH + 0.15, 0.0, plane[0], ha="left", va="center", color=style.GREY)
    ax.text(0.0, REACH + 0.1, plane[1], ha="center", va="bottom", color=style.GREY)


def _table(ax, both, mean, case, colours):
    """Lines below the picture: what the comparison says of each label."""
    columns = [(1.4, "G(b)", both, style.number), (4.6, "D", mean, signed)]
    y = -REACH - 1.0
    for x, title, _, _ in columns:
        ax.text(x, y, title + ", µm", ha="right", va="center", fontsize=9.5, color=style.GREY)
    for label, colour in colours.items():
        y -= LINE
        ax.text(-5.6, y, label, va="center", fontsize=9.5, color=colour)
        for x, _, values, text in columns:
            value = values.get((case, label))
            ax.text(x, y, "–" if value is None or not np.isfinite(value) else text(value),
                    ha="right", va="center", fontsize=9.5)


def _legend(strip, colours, turns, left=-0.01):
    handles = [style.plt.Line2D([], [], color=colour, linewidth=1.8, label=label)
               for label, colour in colours.items()]
    senses = {turn.sense for of_case in turns.values() for turn in of_case}
    handles += [style.plt.Line2D([], [], color=style.GREY, linewidth=1.6, label=label, linestyle=LINES[sense])
                for sense, label in ((1, "ccw"), (-1, "cw")) if sense in senses]
    box = strip.legend(handles=handles, loc="center left", bbox_to_anchor=(left, 0.5),
                       ncol=len(handles), handlelength=2.0, columnspacing=1.3, borderpad=0,
                       handletextpad=0.6)
    box.set_in_layout(False)


def draw_reversals(run):
    turns = turns_of(run)
    colours = looks_of(turns)
    figure, strip, grid = style.panels([1.0] * len(turns), (10.2, 1.85 * len(turns) + 1.0),
                                       columns=4)
    for row, (name, of_case) in zip(grid, turns.items()):
        extent = [0.0, 0.0]
        for quadrant, ax in enumerate(row):
            for turn in of_case:
                behind, dr = around_reversal(turn, 90.0 * quadrant)
                ax.plot(behind, dr, color=colours[turn.label], linewidth=1.4,
                        linestyle=LINES[turn.sense])
                extent = [min(extent[0], dr.min()), max(extent[1], dr.max())]
            ax.axvline(0.0, color=style.GREY, linewidth=1.0, zorder=1.5)
            ax.set_xlim(-BEFORE, BEHIND)
            ax.set_xticks([-10, 0, 10, 20])
        pad = 0.08 * (extent[1] - extent[0])
        for quadrant, ax in enumerate(row):
            ax.set_ylim(extent[0] - pad, extent[1] + pad)
            if quadrant > 0:
                ax.tick_params(labelleft=False)
            if row is not grid[-1]:
                ax.tick_params(labelbottom=False)
        row[0].set_ylabel(name.replace("_", " ") + "\nform, µm")
    plane = next(iter(turns.values()))[0].plane
    for quadrant, ax in enumerate(grid[0]):
        ax.set_title(f"{'+−'[quadrant // 2]}{plane[quadrant % 2]}: {plane[quadrant % 2]} reverses")
    figure.align_ylabels([row[0] for row in grid])
    for ax in grid[-1]:
        ax.set_xlabel("behind the reversal, deg")
    _legend(strip, colours, turns)
    style.headline(figure, "Deviation from the least-squares circle where the axes reverse")
    return figure


def around_reversal(turn, place):
    """Angle behind a reversal in the direction of travel (deg, rising) and form deviation there."""
    behind = turn.sense * (turn.theta - place)
    behind = (behind + 180.0) % 360.0 - 180.0
    order = np.argsort(behind, kind="stable")
    inside = order[(behind[order] >= -BEFORE) & (behind[order] <= BEHIND)]
    return behind[inside], turn.form[inside]
