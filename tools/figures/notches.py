"""Figure 11: positions of the notches along X against the imposed positioning error."""
import dataclasses
import re

import numpy as np

from figures import probed_points, results, style
from figures.results import NotInFile

WIDTH = 8.4   # inches


@dataclasses.dataclass
class Notches:
    """One case: per notch its X (mm), and mean, lowest and highest of displacement and residual."""
    case: str
    look: style.Look
    x: np.ndarray
    difference: np.ndarray    # (notch, [mean, low, high]) um
    residual: np.ndarray      # the same

    def largest(self):
        """Largest residual by magnitude over all samples (um)."""
        return np.abs(self.residual[:, 1:]).max()


def _summary(values):
    return [values.mean(), values.min(), values.max()]


def notches(run, section="notch"):
    base, found = run.base(), []
    for case in run.others():
        parts = results.passes(case.samples([run.names.section(section)]))
        if not parts:
            raise run.no_motion([section])
        if not case.has("imposed_linear"):
            raise NotInFile("no error model is imposed")
        found.append(Notches(
            case.name, style.look_of(run, case.name),
            np.array([results.programmed(base, "X", case.column("s")[p]).mean() for p in parts]),
            np.array([_summary(results.trajectory_difference(case, base, "X", p)) for p in parts]),
            np.array([_summary(results.imposed_error_residual(case, base, "X", p))
                      for p in parts])))
    return found


def draw(run):
    run.need_errors_of_only("X")
    found = notches(run)
    bound = _bound(run)
    looks = [style.IMPOSED] + [one.look for one in found]
    columns, lines = style.legend_shape(looks, WIDTH)
    figure, strip, rows = style.panels([1.25, 1.0, 1.0], (WIDTH, 8.74 + 0.26 * lines), legend_lines=lines)
    axes = [row[0] for row in rows]
    style.legend(strip, looks, lines=False, points=True, columns=columns)

    x = found[0].x
    reach = 0.12 * np.ptp(x) if np.ptp(x) > 0 else 5.0
    curve = run.error_functions("X").get("EXX")
    if curve is not None:
        inside = (curve[0] >= x.min() - reach) & (curve[0] <= x.max() + reach)
        style.line(axes[0], curve[0][inside], curve[1][inside], style.IMPOSED, linewidth=1.6)
    spacing = np.diff(np.sort(x)).min() if len(x) > 1 else 10.0
    for number, one in enumerate(found):
        shift = spacing * 0.11 * (number - (len(found) - 1) / 2)   # side by side, not on each other
        axes[0].plot(one.x, one.difference[:, 0], one.look.marker, color=one.look.colour,
                     markerfacecolor="none", markeredgewidth=1.5, zorder=3,
                     markersize=4.0 + 3.5 * (len(found) - 1 - number))   # one inside the other
        _points(axes[1], one.x + shift, one.residual, one.look)
        _points(axes[2], one.x + shift, one.residual * 1000.0, one.look)

    probed = probed_points.notches(run, run.names.section("notch"))
    for number, one in enumerate(found):
        points = probed.get(one.case)
        if points is not None:
            shift = spacing * 0.11 * (number - (len(found) - 1) / 2 + 0.45)
            points.draw(axes[0], points.displacement, one.look)
            points.draw(axes[1], points.residual, one.look, shift)

    axes[0].set_title("(a) Notch positions minus nominal, and what was imposed" + probed_points.note(probed))
    axes[0].set_ylabel("X displacement, µm")
    axes[1].set_title("(b) Difference to the imposed curve"
                      + (f" on the scale of the paper's bound of ±{bound:g} µm" if bound else ""))
    axes[1].set_ylabel("residual, µm")
    if bound:
        for side in (-bound, bound):
            axes[1].axhline(side, color=style.GREY, linestyle=style.DASH, linewidth=1.2)
        reach_y = max([bound, *(points.reach() for points in probed.values())])
        axes[1].set_ylim(-1.25 * reach_y, 1.25 * reach_y)
    step = run.scenario.get("machine", {}).get("axis", {}).get("X", {}).get("scale_step")
    axes[2].set_title("(c) The same enlarged" + (f": one count of the scale is {step}"
                                                 if step else ""))
    axes[2].set_ylabel("residual, nm")
    for ax in axes:
        ax.axhline(0.0, color=style.BLACK, linewidth=0.8, zorder=1.5)
        ax.set_xlim(x.min() - reach, x.max() + reach)
        if ax is not axes[-1]:
            ax.tick_params(labelbottom=False)
    axes[-1].set_xlabel("X of the machine, mm   (points: mean over a notch, bars: its range; "
                        "drawn side by side)")
    worst = max(one.largest() for one in found)
    style.headline(figure, f"Notches in X: all strategies within {style.number(worst)} µm "
                           "of the imposed curve")
    return figure


def _points(ax, x, summary, look):
    mean, low, high = summary.T
    ax.errorbar(x, mean, yerr=[mean - low, high - mean], color=look.colour, marker=look.marker,
                markersize=5, linestyle="none", elinewidth=1.3, capsize=2.5, zorder=3,
                markerfacecolor=style.face(look))


def _bound(run):
    # the largest residual that the scenario quotes for X, "< 2 um"
    for one in run.scenario.get("quantity", []):
        if one.get("name") == "imposed_error_residual" and one.get("axis") == "X":
            found = re.fullmatch(r"<=?\s*([\d.]+)\s*um", one.get("reference", ""))
            if found:
                return float(found[1])
    return None
