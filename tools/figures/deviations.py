"""Any run over time: following error, tool deviation and contour error of every case."""
import numpy as np

from figures import style
from figures.results import NotInFile

WIDTH = 9.6     # inches
HELD = {"µm": 0.1, "deg": 1e-4}   # following error that an axis which only holds may show


def _holds_still(case, name, letter, held):
    reference = case.column(name.replace("following_error", "ref"), letter)
    return (len(reference) == 0 or
            np.ptp(reference) == 0.0 and np.abs(case.column(name, letter)).max() < held)


def rows_of(run):
    """Panels as (title, unit, function of a case): what at least one case holds."""
    cases = list(run.cases.values())
    if not any(len(case.column("time")) for case in cases):
        raise NotInFile("no samples")
    panels = []
    for name, unit in (("following_error_linear", "µm"), ("following_error_rotary", "deg")):
        holders = [case for case in cases if case.has(name)]
        for letter in holders[0].labels(name) if holders else "":
            if all(_holds_still(case, name, letter, HELD[unit]) for case in holders):
                continue
            panels.append((f"Following error of {letter} (setpoint minus what the NC reads)",
                           unit, lambda case, n=name, a=letter: case.column(n, a)))
    if cases[0].has("tool_deviation"):
        panels.append(("Tool deviation (true minus nominal tool centre point, magnitude)", "µm",
                       lambda case: np.linalg.norm(case.column("tool_deviation"), axis=1)))
    if cases[0].has("contour_error"):
        panels.append(("Contour error (distance of the tool centre point to the nominal path)",
                       "µm", lambda case: case.column("contour_error")))
    return panels


def draw(run):
    if not run.cases:
        raise NotInFile("no cases")
    panels = rows_of(run)
    cases = list(run.cases.values())
    looks = {case.name: style.look_of(run, case.name) for case in cases}
    columns, lines = style.legend_shape(looks.values(), WIDTH)
    figure, strip, grid = style.panels([1.0] * len(panels), (WIDTH, 1.75 * len(panels) + 0.64 + 0.26 * lines),
                                       legend_lines=lines)
    axes = [row[0] for row in grid]
    style.legend(strip, list(looks.values()), columns=columns)
    for ax, (title, unit, values) in zip(axes, panels):
        for case in cases:
            time, shown = style.thin(case.column("time"), values(case))
            style.line(ax, time, shown, looks[case.name], linewidth=1.1)
            if not case.finished and len(time):
                ax.plot(time[-1], shown[-1], marker="X", markersize=9, clip_on=False, zorder=5,
                        color=looks[case.name].colour)
        _rapids(ax, cases[0])
        ax.set_title(title)
        ax.set_ylabel(unit)
        ax.margins(x=0.01)
        if ax is not axes[-1]:
            ax.tick_params(labelbottom=False)
    stopped = [case for case in cases if not case.finished]
    note = "   (X: stopped)" if stopped else ""
    if (cases[0].column("rapid") > 0.5).any():
        note = f"   (grey: rapid moves of {cases[0].name})" + note
    axes[-1].set_xlabel("time, s" + note)
    headline = run.title or run.path.stem
    if stopped:
        headline += " (stopped: " + ", ".join(case.name for case in stopped) + ")"
    style.headline(figure, headline)
    return figure


def _rapids(ax, case):
    time, rapid = case.column("time"), case.column("rapid") > 0.5
    edges = np.flatnonzero(np.diff(np.concatenate([[0], rapid.astype(int), [0]])))
    for start, end in edges.reshape(-1, 2):
        ax.axvspan(time[start], time[min(end, len(time) - 1)], color=style.PALE, linewidth=0,
                   zorder=0)
