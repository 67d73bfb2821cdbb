"""Any run over time: following error, tool deviation and contour error of every case."""
import numpy as np

from figures import style
from figures.results import NotInFile

WIDTH = 9.6     # inches
HELD = {"µm": 0.1, "deg": 1e-4}   # following error that an axis which only holds may show


def _holds_still(case, name, letter, held):
    reference = case.column(name.replace("following_error", "ref"), letter)
    return (len(reference) == 0 or np.nanmax(reference) == np.nanmin(reference) and
            np.nanmax(np.abs(case.column(name, letter))) < held)


def rows_of(run):
    """Panels as (title, unit, function of a case, signal with extremes): what at least one case holds."""
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
                           unit, lambda case, n=name, a=letter: case.column(n, a), (name, letter)))
    if cases[0].has("tool_deviation"):
        panels.append(("Tool deviation (true minus nominal tool centre point, magnitude)", "µm",
                       lambda case: np.linalg.norm(case.column("tool_deviation"), axis=1), ("tcp_deviation", None)))
    if cases[0].has("contour_error"):
        panels.append(("Contour error (distance of the tool centre point to the nominal path)",
                       "µm", lambda case: case.column("contour_error"), ("contour_error", None)))
    return panels


def _band_between_rows(ax, case, look, signal):
    """What the signal was between the rows, where these tell of it."""
    name, letter = signal
    if not case.has(name + "_min"):
        return
    time, least, greatest = style.band(case.column("time"), case.column(name + "_min", letter),
                                       case.column(name + "_max", letter))
    ax.fill_between(time, least, greatest, where=np.isfinite(least), color=look.colour, alpha=0.25, linewidth=0)


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
    for ax, (title, unit, values, signal) in zip(axes, panels):
        for case in cases:
            _band_between_rows(ax, case, looks[case.name], signal)
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
    if any(case.has(signal[0] + "_min") for case in cases for *_, signal in panels):
        note += "   (bands: between the rows)"
    if any(case.has_gaps() for case in cases):
        note += "   (gaps: not recorded)"
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
