"""Five-axis programs: where the tip is off the programmed path, and by how much tip and tool axis are off along it."""
import numpy as np

from figures import style
from figures.results import NotInFile, passes

TURNS = 0.5        # deg; below that the tool axis stands
LEANS = 28         # tool axes drawn along the way
LEAST = 1e-3       # um, urad: lowest shown
WIDTH = 9.8        # inches
PIECES = 150       # of the path, of each of which the largest deviation is drawn
URAD = 1e-6


def sections_of(run):
    """Sections that the comparison of the deviations is about; None: all."""
    for quantity in run.scenario.get("quantity", []):
        if quantity.get("name") in ("tcp_deviation", "tool_axis_deviation") and "sections" in quantity:
            return quantity["sections"]
    return None


def tip_deviation(case, rows):
    """um, magnitude."""
    return np.linalg.norm(case.column("tool_deviation")[rows], axis=1)


def axis_deviation(case, rows):
    """urad: angle between true and nominal tool axis."""
    nominal, true = (case.column(f"tool_axis_{which}")[rows] for which in ("nominal", "true"))
    return 2.0 * np.arcsin(np.clip(0.5 * np.linalg.norm(true - nominal, axis=1), 0.0, 1.0)) / URAD


def envelope(s, values, length):
    """The largest value of the last, this and the next piece of that length, at the middle of each (ends: at the ends)."""
    piece = np.minimum(((s - s[0]) / length).astype(int), max(int((s[-1] - s[0]) / length) - 1, 0))
    starts = np.flatnonzero(np.diff(piece, prepend=-1))
    largest = np.maximum.reduceat(values, starts)
    padded = np.concatenate([largest[:1], largest, largest[-1:]])
    largest = np.maximum(np.maximum(padded[:-2], padded[1:-1]), padded[2:])
    middle = (s[starts] + s[np.append(starts[1:], len(s)) - 1]) / 2.0
    return np.concatenate([s[:1], middle, s[-1:]]), np.concatenate([largest[:1], largest, largest[-1:]])


def enlargement(tips, deviation):
    """A round factor that makes the largest deviation a tenth of the way's extent."""
    wanted = 0.1 * np.ptp(tips, axis=0).max() / max(deviation.max() * 1e-3, 1e-12)
    power = 10.0 ** np.floor(np.log10(wanted))
    return power * max(step for step in (1.0, 2.0, 5.0) if step * power <= wanted)


def draw(run):
    """Plan view with deviations enlarged; deviations of tip and tool axis along the path."""
    cases = run.finished_cases()
    if not cases or not cases[0].has("tool_axis_nominal"):
        raise NotInFile("no finished case with a tool axis")
    named = sections_of(run)
    rows = {case.name: case.samples(named) for case in cases}
    first = max(cases, key=lambda case: tip_deviation(case, rows[case.name]).max(initial=0.0))
    if len(rows[first.name]) < 2:
        raise NotInFile("no feed moves")
    axes = first.column("tool_axis_nominal")[rows[first.name]]
    if np.degrees(np.linalg.norm(axes - axes[0], axis=1).max()) < TURNS:
        raise NotInFile("the tool axis does not rotate")
    looks = {case.name: style.look_of(run, case.name) for case in cases}
    columns, lines = style.legend_shape(looks.values(), WIDTH)
    figure, strip, grid = style.panels([1.5, 0.8, 0.8], (WIDTH, 9.1 + 0.26 * lines), legend_lines=lines)
    style.legend(strip, list(looks.values()), columns=columns)
    (plan,), (of_tip,), (of_axis,) = grid
    _draw_plan(plan, run, first, cases, rows, looks)
    begin, end = first.column("s")[rows[first.name][[0, -1]]]
    length = (end - begin) / PIECES
    within = f" (largest within {style.number(3.0 * length)} mm)"
    for ax, values, unit, title in (
            (of_tip, tip_deviation, "µm", "Tip: distance from where it should be at equal arc length" + within),
            (of_axis, axis_deviation, "µrad", "Tool axis: angle from where it should point" + within)):
        for case in cases:
            for at in passes(rows[case.name]):     # rapids stand between them
                s, shown = envelope(case.column("s")[at], np.maximum(values(case, at), LEAST), length)
                style.line(ax, s - begin, shown, looks[case.name], linewidth=1.4)
        ax.set_yscale("log")
        ax.set_ylabel(unit)
        ax.set_title(title)
        ax.margins(x=0.01)
    of_tip.tick_params(labelbottom=False)
    of_axis.set_xlabel("arc length, mm")
    peaks = {case.name: tip_deviation(case, rows[case.name]).max() for case in cases}
    style.headline(figure, "Tip off by up to " + peaks_text(peaks, first.name, looks))
    return figure


def peaks_text(peaks, worst, looks):
    """"9.1 µm (none), 0.3 µm (gcode)": the case with the largest deviation and that with the smallest, if it is another."""
    best = min(peaks, key=peaks.get)
    return ", ".join(f"{style.number(peaks[name])} µm ({looks[name].label})" for name in dict.fromkeys((worst, best)))


def _draw_plan(ax, run, first, cases, rows, looks):
    at = rows[first.name]
    tips, axes = first.column("tool_position_nominal")[at], first.column("tool_axis_nominal")[at]
    factor = enlargement(tips, tip_deviation(first, at))
    s = first.column("s")[at]
    lean = 0.12 * np.ptp(tips, axis=0).max() / max(np.linalg.norm(axes[:, :2], axis=1).max(), 1e-12)
    for n in np.searchsorted(s, np.linspace(s[0], s[-1], LEANS)).clip(0, len(s) - 1):
        end = tips[n, :2] + lean * axes[n, :2]
        ax.plot([tips[n, 0], end[0]], [tips[n, 1], end[1]], color=style.PALE, linewidth=2.5, zorder=0)
    for case in cases:
        for at in passes(rows[case.name]):
            shown = case.column("tool_position_nominal")[at] + factor * 1e-3 * case.column("tool_deviation")[at]
            style.line(ax, shown[:, 0], shown[:, 1], looks[case.name], linewidth=1.2)
    for at in passes(rows[first.name]):
        tips = first.column("tool_position_nominal")[at]
        style.line(ax, tips[:, 0], tips[:, 1], style.Look("", style.GREY, style.DOT, "", 1.6))
    ax.set_aspect("equal", adjustable="datalim")
    ax.set_xlabel("X of the workpiece, mm")
    ax.set_ylabel("Y, mm")
    ax.set_title(f"Plan view: programmed (dotted), deviations of the tip x {factor:g}; grey: direction in which the tool leans")
