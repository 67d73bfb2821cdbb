"""Figures 9 and 10: how much of an error imposed across X the trajectory of Y or Z shows."""
import dataclasses

import numpy as np

from figures import probed_points, results, style
from figures.results import NotInFile


WIDTH = 8.4       # inches
MOST_OVER = 3.0   # times the largest residual of a trajectory in an enlargement: points beyond are left out


@dataclasses.dataclass
class Track:
    """One case along X: passes with X, trajectory minus nominal, residual (mm, um, um)."""
    case: results.Case
    look: style.Look
    passes: list

    def largest(self):
        """Largest residual by magnitude: what `servomill compare` prints (um)."""
        return max(np.abs(residual).max() for _, _, residual in self.passes)


def tracks(run, axis, section):
    """Tracks of all cases that can be compared, in the order of the scenario; `section` as the paper names it."""
    base, found = run.base(), []
    for case in run.others():
        rows = case.samples([run.names.section(section)])
        if not len(rows):
            raise run.no_motion([section])
        if not case.has("imposed_linear"):
            raise NotInFile("no error model is imposed")
        one = Track(case, style.look_of(run, case.name), [])
        for part in results.passes(rows):
            x = results.programmed(base, "X", case.column("s")[part])
            one.passes.append((x, results.trajectory_difference(case, base, axis, part),
                               results.imposed_error_residual(case, base, axis, part)))
        found.append(one)
    return found


def imposed_curve(run, axis, section):
    """X (mm) and imposed displacement (um) along the first pass of the base case."""
    base = run.base()
    first = results.passes(base.samples([run.names.section(section)]))[0]
    order = np.argsort(base.column("ref_linear", "X")[first], kind="stable")
    return (base.column("ref_linear", "X")[first][order],
            base.column("imposed_linear", axis)[first][order])


def enlargements(found):
    """Groups of tracks for one panel each: all, then again and again without the largest, as long
    as what remains is less than half as large and hence was hard to see."""
    groups = [sorted(found, key=Track.largest)]
    for size in range(len(found) - 1, 0, -1):
        if groups[0][size - 1].largest() < 0.5 * groups[-1][-1].largest():
            groups.append(groups[0][:size])
    return groups


def draw(run, axis, section):
    run.need_errors_of_only("X")
    found = tracks(run, axis, section)
    groups = enlargements(found)
    heights = [1.3] + [1.0] * len(groups)
    looks = [style.IMPOSED] + [one.look for one in found]
    columns, lines = style.legend_shape(looks, WIDTH)
    figure, strip, rows = style.panels(heights, (WIDTH, 2.15 * sum(heights) + 0.64 + 0.26 * lines), legend_lines=lines)
    axes = [row[0] for row in rows]
    style.legend(strip, looks, columns=columns)

    x, imposed = imposed_curve(run, axis, section)
    for one in found:
        for part, (at, difference, residual) in enumerate(one.passes):
            _pass(axes[0], at, difference, one.look, part)
            for ax, group in zip(axes[1:], groups):
                if one in group:
                    _pass(ax, at, residual, one.look, part)
    style.line(axes[0], x, imposed, style.IMPOSED, zorder=1.9)

    probed = probed_points.along(run, run.names.section(section), axis)
    for one in found:
        points = probed.get(one.case.name)
        if points is None:
            continue
        points.draw(axes[0], points.displacement, one.look)
        for ax, group in zip(axes[1:], groups):
            if ax is axes[1] or one in group and _fit(points, group):
                points.draw(ax, points.residual, one.look)

    axes[0].set_title(f"(a) Trajectory of {axis} minus nominal, and what was imposed" + probed_points.note(probed))
    axes[1].set_title("(b) What is missing: difference to the imposed curve")
    axes[0].set_ylabel(f"{axis} displacement, µm")
    for letter, ax, group in zip("cdefgh", axes[2:], groups[1:]):
        names = [one.look.label for one in found if one in group]
        left_out = [one for one in group if one.case.name in probed and not _fit(probed[one.case.name], group)]
        beyond = "   (probed points lie beyond)" if left_out else ""
        ax.set_title(f"({letter}) Enlarged: " + ", ".join(names) + beyond)
    for ax in axes[1:]:
        ax.axhline(0.0, color=style.BLACK, linewidth=1.0, zorder=1.5)
        ax.set_ylabel("residual, µm")
    for ax in axes:
        ax.margins(x=0.01)
        if ax is not axes[-1]:
            ax.tick_params(labelbottom=False)
    axes[-1].set_xlabel(_x_label(found))
    missing = ", ".join(f"{one.look.label} {style.number(one.largest())} µm"
                        for one in found if "lead" not in one.look.label)
    what = f"Trajectory of {axis}" if probed else axis   # the part may miss it by more
    style.headline(figure, f"{what} misses the imposed curve by: {missing}")
    return figure


def _fit(points, group):
    # noise or back-cutting must not hide the curves that an enlargement is about
    return points.largest() < MOST_OVER * group[-1].largest()


def _pass(ax, x, y, look, number):
    # passes back and forth lie over each other; all but the first are thinner
    more = {} if number == 0 else {"linewidth": 0.8, "alpha": 0.7}
    style.noisy_line(ax, x, y, look, **more)


def _x_label(found):
    passes = found[0].passes
    rising = [x[-1] > x[0] for x, _, _ in passes]
    if len(set(rising)) > 1:
        return "X of the machine, mm   (thin: further passes; the one back lags to the other side)"
    return "X of the machine, mm" + ("   (thin: further passes)" if len(passes) > 1 else "")
