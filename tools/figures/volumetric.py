"""Figures 14 and 15: trajectories of experiment 2, their differences magnified, and per direction."""
import dataclasses
import math

import numpy as np

from figures import results, style

CONTOURS = ("circle", "diamond", "square")
PLANE = ("plane",)
NEEDED = ("generated", "compensated")
MOST_NAMED_PASSES = 7


def differences(run, sections):
    """Base samples of the sections (as the paper names them), and per case its differences to the base at equal s there.

    Returns (base, {case name: (s, x, y, z, d)}) with s, x, y, z the nominal path (mm) and d
    (sample, XYZ; um), one row where a pass ends that is NaN, so that lines break there.
    """
    needed = [run.part(name).name for name in NEEDED]
    base = run.base()
    names = [case.name for case in run.others()
             if case.name in needed or case.name == run.names.case("compensated_lead")]
    out = {}
    for name in names:
        case = run.cases[name]
        parts = results.passes(case.samples([run.names.section(one) for one in sections]))
        if not parts:
            raise run.no_motion(sections)
        columns = []
        for rows in parts:
            s = case.column("s")[rows]
            path = [base.along("meas_linear", axis, s) for axis in "XYZ"]
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
    figure, plan, side = _canvas(run, base, found)

    _, path, moved = found[run.names.case("generated")]
    extent = np.nanmax(np.nanmax(path[:, :2], axis=0) - np.nanmin(path[:, :2], axis=0))
    scale = magnification(extent, np.nanmax(np.hypot(moved[:, 0], moved[:, 1])), 0.08)
    plan.plot(path[:, 0], path[:, 1], color=style.BLACK, linewidth=3.0, zorder=2)
    for name, (s, at, difference) in found.items():
        look = style.look_of(run, name)
        shown = at[:, :2] + difference[:, :2] * scale / results.UM_PER_MM
        style.line(plan, shown[:, 0], shown[:, 1], look, linewidth=1.5, zorder=3)
        if name == run.names.case("generated"):
            for k in _every(s, at, 70):
                plan.annotate("", xy=shown[k], xytext=at[k, :2], zorder=2.5,
                              arrowprops={"arrowstyle": "-|>,head_width=0.12,head_length=0.25",
                                          "color": look.colour, "linewidth": 0.9,
                                          "shrinkA": 0, "shrinkB": 0})
    plan.set_aspect("equal", adjustable="datalim")
    plan.set_title(f"Seen from above; differences drawn × {scale:.0f}")
    plan.set_xlabel("X, mm")
    plan.set_ylabel("Y, mm")
    _per_direction(run, side, base, found)
    style.headline(figure, _message("Contours", run, found, CONTOURS))
    return figure


def draw_plane(run):
    base, found = differences(run, PLANE)
    figure, picture, side = _canvas(run, base, found)

    s, path, moved = found[run.names.case("generated")]
    level = np.nanmean(path[:, 2])
    extent = np.nanmax(np.nanmax(path[:, :2], axis=0) - np.nanmin(path[:, :2], axis=0))
    scale = magnification(extent, np.nanmax(np.linalg.norm(moved, axis=1)), 0.3)
    flat = path - [0.0, 0.0, level]
    picture.plot(*_oblique(flat), color=style.BLACK, linewidth=3.0, zorder=2)
    for name, (_, at, difference) in found.items():
        look = style.look_of(run, name)
        shown = at - [0.0, 0.0, level] + difference * scale / results.UM_PER_MM
        style.line(picture, *_oblique(shown), look, linewidth=1.5, zorder=3)
        if name == run.names.case("generated"):
            for k in _every(s, at, 75):
                picture.plot(*_oblique(np.stack([flat[k], shown[k]])), color=look.colour,
                             linewidth=0.8, zorder=2.5)
    _oblique_scales(picture, flat, scale, np.nanmax(moved[:, 0]))
    picture.set_title(f"Seen obliquely, Z {level:.0f} mm; differences drawn × {scale:.0f}")
    _per_direction(run, side, base, found)
    style.headline(figure, _message("Top plane", run, found, PLANE))
    return figure


def _oblique(points):
    # cavalier projection: X to the right, Z up, Y up and to the right
    return points[:, 0] + 0.35 * points[:, 1], points[:, 2] + 0.90 * points[:, 1]


def _oblique_scales(ax, flat, scale, to_the_right):
    # the passes are named by their Y beside the curves, the front one by its X; a bar tells what a height means
    ends = np.flatnonzero(np.isnan(flat[:, 0]))
    starts = np.concatenate([[0], ends[:-1] + 1])
    low, high = np.nanmin(flat[:, 0]), np.nanmax(flat[:, 0])
    gap = 0.04 * (high - low)
    beside = high + gap + max(to_the_right, 0.0) * scale / results.UM_PER_MM
    fronts = []
    for start, end in zip(starts, ends):
        y = np.mean(flat[start:end, 1])
        fronts.append(y)
    for y in fronts[::-(-len(fronts) // MOST_NAMED_PASSES)]:
        u, v = _oblique(np.array([[beside, y, 0.0]]))
        ax.text(u[0], v[0], f"Y {y:.0f} mm".replace("-", "−"), va="center")
    for x in (low, high):
        u, v = _oblique(np.array([[x, min(fronts), 0.0]]))
        ax.text(u[0], v[0] - gap, f"X {x:.0f} mm".replace("-", "−"), ha="center", va="top")
    bar = 10.0 * scale / results.UM_PER_MM      # mm on the picture
    u, v = _oblique(np.array([[low - 2.5 * gap, min(fronts), 0.0]]))
    ax.plot([u[0]] * 2, [v[0], v[0] + bar], color=style.GREY, linewidth=2.5)
    ax.text(u[0] - 0.5 * gap, v[0] + bar / 2, "10 µm", ha="right", va="center", color=style.GREY)
    ax.margins(0.08)
    ax.set_aspect("equal", adjustable="box")
    ax.axis("off")


def _canvas(run, base, found):
    # one large picture on the left, three strips for X, Y, Z on the right
    figure, strip, grid = style.panels([1.0, 1.0, 1.0], (11.5, 6.9), columns=2, widths=[1.25, 1.0])
    spec = grid[0][0].get_gridspec()
    for row in grid:
        row[0].remove()
    picture = figure.add_subplot(spec[1:, 0])
    nominal = dataclasses.replace(style.look_of(run, base.name), width=3.0)
    style.legend(strip, [nominal] + [style.look_of(run, name) for name in found])
    return figure, picture, [row[1] for row in grid]


def _every(s, at, count):
    # about `count` samples at equal steps of the path, none of them in a gap
    good = np.flatnonzero(~np.isnan(at[:, 0]))
    length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(at[good], axis=0), axis=1))])
    return good[np.searchsorted(length, np.linspace(0.0, length[-1], count))]


def _per_direction(run, axes, base, found):
    for number, (ax, axis) in enumerate(zip(axes, "XYZ")):
        ax.axhline(0.0, color=style.BLACK, linewidth=3.0, zorder=2)
        for name, (s, _, difference) in found.items():
            gaps = np.flatnonzero(np.isnan(s))
            for part in np.split(np.arange(len(s)), gaps):
                part = part[~np.isnan(s[part])]
                style.noisy_line(ax, s[part], difference[part, number],
                                 style.look_of(run, name), buckets=100, zorder=3)
        ax.set_ylabel(f"d{axis}, µm")
        ax.margins(x=0.01)
        if ax is not axes[-1]:
            ax.tick_params(labelbottom=False)
    axes[-1].set_xlabel("path length s, mm   (case minus nominal at equal s)")
    _name_sections(axes[0], run, base, found)


def _name_sections(ax, run, base, found):
    # above the strips, over the middle of all passes of a section
    s = found[run.names.case("generated")][0]
    names = [name for name in map(run.names.section, CONTOURS) if name in base.sections and len(base.samples([name]))]
    for name in names:
        passes = [base.column("s")[part] for part in results.passes(base.samples([name]))]
        if any(np.nanmin(np.abs(s - part.mean())) < 1.0 for part in passes):
            ax.text(0.5 * (passes[0].min() + passes[-1].max()), 1.04, name, ha="center", color=style.GREY,
                    transform=ax.get_xaxis_transform())


def _message(what, run, found, sections):
    own = list(dict.fromkeys(map(run.names.section, sections)))
    if own != list(sections):
        what = ", ".join(own)

    def largest(name):
        return np.nanmax(np.abs(found[run.names.case(name)][2]))

    if run.names.cases:
        return f"{what}: up to " + ", ".join(f"{style.number(largest(name))} µm in an axis "
                                             f"({style.look_of(run, run.names.case(name)).label})" for name in NEEDED)
    return (f"{what}: up to {style.number(largest('generated'))} µm generated in an axis, "
            f"{style.number(largest('compensated'))} µm left after compensation")
