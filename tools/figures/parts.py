"""The part on the virtual CMM: deviations along a feature with their bars, in plan view, and maps of planes."""
import dataclasses

import matplotlib
import numpy as np

from figures import style
from figures.results import NotInFile, UM_PER_MM
from figures.volumetric import magnification

COVERAGE = 2.0     # bars are so many standard deviations of a repetition
MOST_PANELS = 6


@dataclasses.dataclass
class Feature:
    """What was probed of one feature of one case (mm, um)."""
    kind: str
    nominal: np.ndarray      # (point, xyz)
    normal: np.ndarray       # (point, ijk)
    deviation: np.ndarray    # (point) without error of the CMM; NaN where nothing was met
    mean: np.ndarray         # (point) of the repetitions
    sigma: np.ndarray        # (point) standard deviation of a repetition
    imposed: np.ndarray      # (point) asked for along the normal; NaN: nothing
    fit_place: np.ndarray | None = None      # (point, xyz) on the nominal part, nearest after best fit; None: no nominal part
    fit_deviation: np.ndarray | None = None  # (point, xyz) from there, um

    def minus(self, base):
        """The same relative to a base case; both sides repeat, so their variances add."""
        return dataclasses.replace(self, deviation=self.deviation - base.deviation, mean=self.mean - base.mean,
                                   sigma=np.hypot(self.sigma, base.sigma))

    def is_level(self):
        """Whether all normals lie in XY."""
        return np.abs(self.normal[:, 2]).max() < 1e-3


def probed(run):
    """{feature: {case: Feature}} of all finished cases, in the order of the file."""
    found = {}
    for case in run.finished_cases():
        for name, group in run.h5.get(f"cases/{case.name}/probes", {}).items():
            deviation = group["deviation"][:]
            imposed = group["imposed"][:] if "imposed" in group else np.full_like(deviation, np.nan)
            found.setdefault(name, {})[case.name] = Feature(
                str(group.attrs["kind"]), group["nominal"][:], group["normal"][:], deviation,
                group["measured"][:].mean(axis=0), group["sigma"][:], imposed,
                *(group[name][:] if name in group else None for name in ("fit_place", "fit_deviation")))
    if not found:
        raise NotInFile("no part was probed ([[probe]] of the scenario)")
    order = [one.get("name") for one in run.scenario.get("probe", [])]
    return dict(sorted(found.items(), key=lambda item: order.index(item[0]) if item[0] in order else len(order)))


def base_of(run):
    """Name of the case that probed points are compared with: that of a quantity on probes, or nominal; None."""
    named = [q["base"] for q in run.scenario.get("quantity", []) if "probe" in q and "base" in q]
    known = [name for name in [*named, "nominal"] if name in run.cases and run.cases[name].finished]
    return known[0] if known and len(run.finished_cases()) > 1 else None


def relative(run, cases):
    """The cases of one feature less the base, which is left out; all as they are without one."""
    base = base_of(run)
    if base not in cases:
        return cases
    return {name: one.minus(cases[base]) for name, one in cases.items() if name != base}


def along(feature):
    """(positions, label): distance along a line or notch, angle around a circle, number of the point else."""
    p = feature.nominal
    if feature.kind in ("line", "notch"):
        half = len(p) // 2 if feature.kind == "notch" else len(p)
        middle = 0.5 * (p[:half] + p[half:]) if feature.kind == "notch" else p
        axis = int(np.argmax(np.ptp(middle, axis=0)))
        straight = np.ptp(np.delete(middle, axis, axis=1), axis=0).max() < 1e-9
        x = middle[:, axis] if straight else np.linalg.norm(middle - middle[0], axis=1)
        return np.tile(x, len(p) // half), f"{'XYZ'[axis]} of the part, mm" if straight else "along the feature, mm"
    if feature.kind in ("circle", "cylinder"):
        centre = 0.5 * (p.max(axis=0) + p.min(axis=0))
        angle = np.degrees(np.arctan2(p[:, 1] - centre[1], p[:, 0] - centre[0])) % 360.0
        return angle, "angle, deg"
    return np.arange(len(p), dtype=float), "number of the point"


def draw_deviations(run):
    """One panel a feature: measured points with bars, the surface under them, what was imposed."""
    features = probed(run)
    shown = dict(list(features.items())[:MOST_PANELS])
    base = base_of(run)
    names = list(dict.fromkeys(name for cases in shown.values() for name in relative(run, cases)))
    looks = {name: style.look_of(run, name) for name in names}
    with_imposed = base is not None and any(
        np.isfinite(one.imposed).any() for cases in shown.values() for one in cases.values())
    legend = ([style.IMPOSED] if with_imposed else []) + list(looks.values())
    figure, strip, rows = style.panels([1.0] * len(shown), (8.4, 1.2 + 2.5 * len(shown)))
    style.legend(strip, legend, points=True)
    worst = 0.0
    for ax, (name, cases) in zip((row[0] for row in rows), shown.items()):
        cases = relative(run, cases)
        x, label = along(next(iter(cases.values())))
        shift = 0.12 * np.ptp(x) / max(len(x), 8)
        if with_imposed:
            one = next(iter(cases.values()))
            _curve(ax, one.kind, x, one.imposed, style.IMPOSED, linewidth=1.6)
        for number, (case, one) in enumerate(cases.items()):
            look = looks[case]
            _curve(ax, one.kind, x, one.deviation, look, linewidth=1.0, alpha=0.8)
            at = x + shift * (number - (len(cases) - 1) / 2)   # bars side by side
            ax.errorbar(at, one.mean, yerr=COVERAGE * one.sigma, color=look.colour, marker=look.marker, markersize=3.5,
                        markerfacecolor=style.face(look), linestyle="none", elinewidth=1.0, capsize=1.8, zorder=3)
            if np.isfinite(one.mean).any():
                worst = max(worst, np.nanmax(np.abs(one.mean)))
        missed = {case: int(np.isnan(one.mean).sum()) for case, one in cases.items() if np.isnan(one.mean).any()}
        told = "".join(f"   {style.spoken(case)}: {count} of {len(x)} points missed" for case, count in missed.items())
        ax.set_title(f"{name}" + (f", minus {style.spoken(base)}" if base else "") + told)
        ax.axhline(0.0, color=style.BLACK, linewidth=0.8, zorder=1.5)
        ax.set_ylabel("deviation, µm")
        ax.set_xlabel(label)
    rest = len(features) - len(shown)
    note = f"   bars: ±{COVERAGE:g} standard deviations of a repetition" + (
        f"; {rest} more features not shown" if rest else "")
    rows[-1][0].set_xlabel(rows[-1][0].get_xlabel() + note)
    what = f"minus {style.spoken(base)} " if base else ""
    style.headline(figure, f"Part on the CMM {what}up to {style.number(worst)} µm along the normals")
    return figure


def _curve(ax, kind, x, y, look, **more):
    # the points of one pass over the feature after the other; only a line and a circle are curves
    pieces = {"line": 1, "circle": 1, "notch": 2}.get(kind, 0)
    for piece in range(pieces):
        part = np.s_[piece * len(x) // pieces:(piece + 1) * len(x) // pieces]
        order = np.argsort(x[part], kind="stable")
        style.line(ax, x[part][order], y[part][order], look, zorder=2, **more)


def draw_plan(run):
    """The part seen from above, one panel a case: arrows from nominal to probed points, magnified."""
    features = {name: relative(run, cases) for name, cases in probed(run).items()}
    level = {name: cases for name, cases in features.items() if next(iter(cases.values())).is_level()}
    if not level:
        raise NotInFile("no probed feature has normals in XY")
    names = list(dict.fromkeys(name for cases in level.values() for name in cases))[:MOST_PANELS]
    every = [cases[name] for cases in level.values() for name in names if name in cases]
    points = np.concatenate([one.nominal[:, :2] for one in every])
    largest = max((np.nanmax(np.abs(one.mean)) for one in every if np.isfinite(one.mean).any()), default=0.0)
    scale = magnification(np.ptp(points, axis=0).max(), largest, 0.1)
    columns = 1 if len(names) == 1 else 2
    lines = -(-len(names) // columns)
    figure, strip, rows = style.panels([1.0] * lines, (4.6 * columns + 0.4, 4.4 * lines + 0.8), columns=columns)
    style.legend(strip, [style.look_of(run, name) for name in names], lines=False, points=True)
    axes = [ax for row in rows for ax in row]
    for ax in axes[len(names):]:
        ax.axis("off")
    for ax, case in zip(axes, names):
        look = style.look_of(run, case)
        for name, cases in level.items():
            if case not in cases:
                continue
            one = cases[case]
            moved = one.mean[:, None] * one.normal[:, :2] * scale / UM_PER_MM
            ax.plot(one.nominal[:, 0], one.nominal[:, 1], ".", color=style.GREY, markersize=2.5, zorder=2)
            ax.quiver(one.nominal[:, 0], one.nominal[:, 1], moved[:, 0], moved[:, 1], color=look.colour,
                      angles="xy", scale_units="xy", scale=1.0, width=0.004, zorder=3)
        ax.set_aspect("equal", adjustable="datalim")
        ax.margins(0.12)
        ax.set_title(style.spoken(case))
        ax.set_xlabel("X of the part, mm")
        ax.set_ylabel("Y of the part, mm")
    base = base_of(run)
    what = f" minus {style.spoken(base)}" if base else ""
    style.headline(figure, f"Part from above{what}, × {scale:.0f}: up to {style.number(largest)} µm")
    return figure


def draw_planes(run):
    """Maps of probed planes: a row a feature, a column a case, one scale of colours."""
    planes = {name: relative(run, cases) for name, cases in probed(run).items()
              if next(iter(cases.values())).kind == "plane"}
    if not planes:
        raise NotInFile("no plane was probed")
    planes = dict(list(planes.items())[:MOST_PANELS])
    names = list(dict.fromkeys(name for cases in planes.values() for name in cases))[:4]
    values = np.concatenate([cases[name].mean for cases in planes.values() for name in names if name in cases])
    largest = np.nanmax(np.abs(values)) if np.isfinite(values).any() else 0.0
    norm = matplotlib.colors.Normalize(-max(largest, 1e-3), max(largest, 1e-3))
    figure, strip, rows = style.panels([1.0] * len(planes), (3.6 * len(names) + 1.4, 3.0 * len(planes) + 0.8),
                                       columns=len(names))
    strip.set_visible(False)
    for row, (feature, cases) in zip(rows, planes.items()):
        for ax, case in zip(row, names):
            if case not in cases:
                ax.axis("off")
                continue
            one = cases[case]
            i, j = np.sort(np.argsort(np.ptp(one.nominal, axis=0))[-2:])   # the directions in which it extends
            map_ = ax.tricontourf if _is_grid(one.nominal[:, [i, j]], one.mean) else None
            if map_ is not None:
                map_(one.nominal[:, i], one.nominal[:, j], one.mean, levels=np.linspace(norm.vmin, norm.vmax, 21),
                     cmap="RdBu_r", norm=norm, extend="both")
            ax.scatter(one.nominal[:, i], one.nominal[:, j], c=one.mean, cmap="RdBu_r", norm=norm, s=16,
                       edgecolors=style.BLACK, linewidths=0.5, zorder=3)
            ax.margins(0.06)
            ax.set_title(f"{feature}, {style.spoken(case)}")
            ax.set_xlabel(f"{'XYZ'[i]} of the part, mm")
            ax.set_ylabel(f"{'XYZ'[j]}, mm")
    bar = figure.colorbar(matplotlib.cm.ScalarMappable(norm, "RdBu_r"), ax=[ax for row in rows for ax in row],
                          shrink=0.85)
    bar.set_label("deviation along the normal, µm")
    base = base_of(run)
    what = f" minus {style.spoken(base)}" if base else ""
    style.headline(figure, f"Probed planes{what}: within ±{style.number(largest)} µm")
    return figure


def _is_grid(p, values):
    # whether there is an area to colour between points that were all met
    return np.isfinite(values).all() and len(p) >= 4 and np.linalg.matrix_rank(p - p.mean(axis=0), tol=1e-6) == 2
