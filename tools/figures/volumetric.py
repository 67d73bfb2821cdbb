"""Figures 14 and 15: trajectories of experiment 2, their differences magnified, and per direction."""
import math

import numpy as np

from figures import results, style
from figures.results import NotInFile

CONTOURS = ("circle", "diamond", "square")
PLANE = ("plane",)
NEEDED = ("generated", "compensated")


def differences(run, sections):
    """Base samples of the sections, and per case its differences to the base at equal s there.

    Returns (base, {case name: (s, x, y, z, d)}) with s, x, y, z the nominal path (mm) and d
    (sample, XYZ; um), one row where a pass ends that is NaN, so that lines break there.
    """
    for name in NEEDED:
        if name not in run.cases:
            raise NotInFile(f"no case named {name}")
        if not run.cases[name].finished:
            raise NotInFile(f"case {name} stopped")
    base = run.base()
    names = [case.name for case in run.others()
             if case.name in NEEDED or case.name == "compensated_lead"]
    out = {}
    for name in names:
        case = run.cases[name]
        parts = results.passes(case.samples(sections))
        if not parts:
            raise NotInFile("no feed motion in sections named " + ", ".join(sections))
        columns = []
        for rows in parts:
            s = case.column("s")[rows]
            path = [along for along in (results.along_path(
                base, base.column("meas_linear", axis), s) for axis in "XYZ")]
            moved = [results.trajectory_difference(case, base, axis, rows) for axis in "XYZ"]
            block = np.stack([s, *path, *moved], axis=1)
            columns.append(np.vstack([block, np.full((1, block.shape[1]), np.nan)]))
        table = np.vstack(columns)
        out[name] = (table[:, 0], table[:, 1:4], table[:, 4:7])
    return base, out


def magnification(extent_mm, largest_um, share=0.08):
    """A round factor (1, 2, 5 times a power of ten) that makes the largest difference about
    `share` of the extent of the picture."""
    wanted = share * extent_mm * results.UM_PER_MM / max(largest_um, 1e-6)
    power = 10.0 ** math.floor(math.log10(wanted))
    return max(step * power for step in (1, 2, 5) if step * power <= wanted)


def draw_contours(run):
    base, found = differences(run, CONTOURS)
    figure, strip, grid = style.panels([1.0, 1.0, 1.0], (11.5, 6.9), columns=2, widths=[1.25, 1.0])
    spec = grid[0][0].get_gridspec()
    for row in grid:
        row[0].remove()
    plan = figure.add_subplot(spec[1:, 0])
    _legend(run, strip, base, found)

    _, path, moved = found["generated"]
    extent = np.nanmax(np.ptp(path[~np.isnan(path[:, 0])][:, :2], axis=0))
    scale = magnification(extent, np.nanmax(np.hypot(moved[:, 0], moved[:, 1])))
    plan.plot(path[:, 0], path[:, 1], color=style.BLACK, linewidth=1.6, zorder=2)
    for name, (s, at, difference) in found.items():
        look = style.look_of(run, name)
        shown = at[:, :2] + difference[:, :2] * scale / results.UM_PER_MM
        style.line(plan, shown[:, 0], shown[:, 1], look, linewidth=1.5, zorder=3)
        if name == "generated":
            for k in _every(s, at, 70):
                plan.annotate("", xy=shown[k], xytext=at[k, :2], zorder=2.5,
                              arrowprops={"arrowstyle": "-|>,head_width=0.12,head_length=0.25",
                                          "color": look.colour, "linewidth": 0.9,
                                          "shrinkA": 0, "shrinkB": 0})
    plan.set_aspect("equal", adjustable="datalim")
    plan.set_title(f"Seen from above; differences drawn × {scale:,.0f}".replace(",", " "))
    plan.set_xlabel("X, mm")
    plan.set_ylabel("Y, mm")
    _per_direction(run, [row[1] for row in grid], found)
    style.headline(figure, _message(run, found))
    return figure


def draw_plane(run):
    base, found = differences(run, PLANE)
    figure, strip, grid = style.panels([1.0, 1.0, 1.0], (11.5, 6.9), columns=2, widths=[1.25, 1.0])
    spec = grid[0][0].get_gridspec()
    for row in grid:
        row[0].remove()
    view = figure.add_subplot(spec[1:, 0], projection="3d")
    _legend(run, strip, base, found)

    generated = style.look_of(run, "generated")
    view.plot(*found["generated"][1].T, color=style.BLACK, linewidth=1.6)
    level = np.nanmean(found["generated"][1][:, 2])
    # heights are drawn in um above the nominal plane: the axis itself is the magnification
    view.cla()
    for name, (s, at, difference) in found.items():
        look = style.look_of(run, name)
        if name == "generated":
            view.plot(at[:, 0], at[:, 1], np.zeros(len(at)), color=style.BLACK, linewidth=1.6)
            for k in _every(s, at, 60):
                view.plot([at[k, 0]] * 2, [at[k, 1]] * 2, [0.0, difference[k, 2]],
                          color=generated.colour, linewidth=0.8)
        view.plot(at[:, 0], at[:, 1], difference[:, 2], color=look.colour, linestyle=look.line,
                  linewidth=1.6)
    _, at, difference = found["generated"]
    view.set_title(f"Height over the nominal plane at Z {level:.0f} mm (µm on mm: × 1000 and more)")
    view.set_xlabel("X, mm")
    view.set_ylabel("Y, mm")
    view.set_zlabel("dZ, µm")
    view.view_init(elev=24, azim=-62)
    _per_direction(run, [row[1] for row in grid], found)
    style.headline(figure, _message(run, found))
    return figure


def _legend(run, strip, base, found):
    style.legend(strip, [style.look_of(run, name) for name in [base.name, *found]])


def _every(s, at, count):
    # about `count` samples at equal steps of the path, none of them in a gap
    good = np.flatnonzero(~np.isnan(at[:, 0]))
    length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(at[good], axis=0), axis=1))])
    return good[np.searchsorted(length, np.linspace(0.0, length[-1], count))]


def _per_direction(run, axes, found):
    for number, (ax, axis) in enumerate(zip(axes, "XYZ")):
        ax.axhline(0.0, color=style.BLACK, linewidth=1.4, zorder=2)
        for name, (s, _, difference) in found.items():
            style.line(ax, s, difference[:, number], style.look_of(run, name), zorder=3)
        ax.set_ylabel(f"d{axis}, µm")
        ax.margins(x=0.01)
        if ax is not axes[-1]:
            ax.tick_params(labelbottom=False)
    axes[0].set_title("Difference to nominal at equal path length")
    axes[-1].set_xlabel("path length s, mm")


def _message(run, found):
    def largest(name):
        return np.nanmax(np.abs(found[name][2]))
    return (f"{style.number(largest('generated'))} µm generated, "
            f"{style.number(largest('compensated'))} µm left after compensation (any direction)")
