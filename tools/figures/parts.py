"""The part on the virtual CMM: deviations along a feature with their bars, in plan view, and maps of planes."""
import dataclasses

import matplotlib
import numpy as np

from figures import style
from figures.results import NotInFile, UM_PER_MM
from figures.volumetric import magnification

COVERAGE = 2.0     # bars are so many standard deviations of a repetition
MOST_PANELS = 6
MOST_MAPS = 4      # beside each other
WIDTH = 8.4        # inches, of deviations along features
PANEL, LABELS = 4.6, 0.9   # inches, of a part seen from above; of which labels and title take so much
PALE = "#b5b5b5"   # nominal places: paler than any case


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
    aligned_position: np.ndarray | None = None      # (point, xyz) on the nominal part, nearest after best fit; None: no nominal part
    aligned_deviation: np.ndarray | None = None  # (point, xyz) from there, um

    def minus(self, base):
        """The same relative to a base case; both sides repeat, so their variances add."""
        return dataclasses.replace(self, deviation=self.deviation - base.deviation, mean=self.mean - base.mean,
                                   sigma=np.hypot(self.sigma, base.sigma))

    def missed(self):
        """(point) whether nothing was met there."""
        return np.isnan(self.mean)

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
                *(group[name][:] if name in group else None for name in ("aligned_position", "aligned_deviation")))
    if not found:
        raise NotInFile("no part was probed ([[probe]] of the scenario)")
    order = [one.get("name") for one in run.scenario.get("probe", [])]
    return dict(sorted(found.items(), key=lambda item: order.index(item[0]) if item[0] in order else len(order)))


def base_of(run):
    """Name of the case that probed points are compared with: that of a quantity on probes, or nominal; None."""
    named = [q["baseline"] for q in run.scenario.get("quantity", []) if "probe" in q and "baseline" in q]
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


def looks_of(run, names):
    """{case: its look} in a figure of these cases."""
    return {name: style.look_of(run, name, names) for name in names}


def minus(run, base):
    """", minus nominal" for a title, or nothing."""
    return f", minus {style.look_of(run, base).label}" if base else ""


def missed_note(features):
    """["3 of 41 points missed"] of some features of a case, or nothing."""
    missed = sum(int(one.missed().sum()) for one in features)
    return [f"{missed} of {sum(len(one.mean) for one in features)} points missed"] if missed else []


def largest_note(values):
    """"up to 9.1 µm" of all that was met."""
    met = np.abs(values)[np.isfinite(values)]
    return f"up to {style.number(met.max())} µm" if len(met) else "no point was met"


def not_shown(count, what):
    """"; 1 more case not shown", or nothing."""
    return f"; {count} more {what}{'s' if count > 1 else ''} not shown" if count > 0 else ""


def draw_deviations(run):
    """One panel a feature: measured points with bars, the surface under them, what was imposed."""
    base = base_of(run)
    features = {name: relative(run, cases) for name, cases in probed(run).items()}
    # planes last: the figure `planes` shows them better
    order = sorted(features, key=lambda name: next(iter(features[name].values())).kind == "plane")
    shown = {name: features[name] for name in order[:MOST_PANELS]}
    looks = looks_of(run, list(dict.fromkeys(case for cases in shown.values() for case in cases)))
    with_imposed = base is not None and any(
        np.isfinite(one.imposed).any() for cases in shown.values() for one in cases.values())
    legend = ([style.IMPOSED] if with_imposed else []) + list(looks.values())
    columns, lines = style.legend_shape(legend, WIDTH)
    figure, strip, rows = style.panels([1.0] * len(shown), (WIDTH, 0.94 + 0.26 * lines + 2.5 * len(shown)), legend_lines=lines)
    style.legend(strip, legend, points=True, columns=columns)
    for ax, (name, cases) in zip((row[0] for row in rows), shown.items()):
        title = [name + minus(run, base), *_draw_feature(ax, cases, looks, with_imposed)]
        ax.set_title("\n".join("   ".join(title[i:i + 3]) for i in range(0, len(title), 3)))
    missed = any(one.missed().any() for cases in shown.values() for one in cases.values())
    crosses = ", crosses below: nothing met" if missed else ""
    rows[-1][0].set_xlabel(rows[-1][0].get_xlabel() + f"   (bars: ±{COVERAGE:g} standard deviations of a repetition{crosses}"
                           f"{not_shown(len(features) - len(shown), 'feature')})")
    every = np.concatenate([one.mean for cases in features.values() for one in cases.values()])
    style.headline(figure, f"Part on the CMM{minus(run, base)}: {largest_note(every)} along the normals")
    return figure


def _draw_feature(ax, cases, looks, with_imposed):
    """One feature of all cases; what was missed, for the title."""
    first = next(iter(cases.values()))
    x, label = along(first)
    shift = 0.12 * np.ptp(x) / max(len(x), 8)
    notes = []
    if with_imposed:
        _curve(ax, first.kind, x, first.imposed, style.IMPOSED, linewidth=1.6)
    for number, (case, one) in enumerate(cases.items()):
        look = looks[case]
        _curve(ax, one.kind, x, one.deviation, look, linewidth=1.0, alpha=0.8)
        at = x + shift * (number - (len(cases) - 1) / 2)   # bars side by side
        ax.errorbar(at, one.mean, yerr=COVERAGE * one.sigma, color=look.colour, marker=look.marker, markersize=3.5,
                    markerfacecolor=style.face(look), linestyle="none", elinewidth=1.0, capsize=1.8, zorder=3)
        style.missed_below(ax, at[one.missed()], look)
        notes += [f"{look.label}: {missed}" for missed in missed_note([one])]
    ax.axhline(0.0, color=style.GREY, linewidth=0.8, zorder=1.5)
    ax.set_ylabel("deviation, µm")
    ax.set_xlabel(label)
    return notes


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
    every = list(dict.fromkeys(case for cases in level.values() for case in cases))
    of_case = {case: [cases[case] for cases in level.values() if case in cases] for case in every[:MOST_PANELS]}
    looks = looks_of(run, list(of_case))
    points = np.concatenate([one.nominal[:, :2] for features in of_case.values() for one in features])
    means = np.concatenate([one.mean for features in of_case.values() for one in features])
    extent = np.ptp(points, axis=0)
    scale = magnification(extent.max(), np.max(np.abs(means[np.isfinite(means)]), initial=0.0), 0.1)
    columns = 1 if len(of_case) == 1 else 2
    lines = -(-len(of_case) // columns)
    height = (PANEL - LABELS) * min(1.0, max(0.4, extent[1] / max(extent[0], 1e-9 + 0.1 * extent[1]))) + LABELS
    figure, strip, rows = style.panels([1.0] * lines, (PANEL * columns + 0.4, height * lines + 0.8), columns=columns)
    key = [style.Look("nominal place", PALE, "", ".")] + ([style.MISSED] if np.isnan(means).any() else [])
    style.legend(strip, key, lines=False, points=True)
    axes = [ax for row in rows for ax in row]
    for ax in axes[len(of_case):]:
        ax.axis("off")
    for ax, (case, features) in zip(axes, of_case.items()):
        for one in features:
            draw_arrows(ax, one.nominal[:, :2], one.mean[:, None] * one.normal[:, :2] * scale / UM_PER_MM, looks[case])
        ax.set_aspect("equal", adjustable="datalim")
        ax.margins(0.12)
        ax.set_title(", ".join([looks[case].label, *missed_note(features)]))
        ax.set_xlabel("X of the part, mm")
        ax.set_ylabel("Y of the part, mm")
    style.headline(figure, f"Part from above{minus(run, base_of(run))}, × {scale:.0f}: {largest_note(means)}"
                   + not_shown(len(every) - len(of_case), "case"))
    return figure


def draw_arrows(ax, places, moved, look):
    """Arrows from places (mm) by what they are moved on the picture; a cross where that is NaN."""
    met = np.isfinite(moved).all(axis=1)
    ax.plot(*places[met].T, ".", color=PALE, markersize=2.5, zorder=2)
    ax.quiver(*places[met].T, *moved[met].T, color=look.colour, angles="xy", scale_units="xy", scale=1.0, width=0.004, zorder=3)
    style.missed(ax, *places[~met].T, look)


def draw_planes(run):
    """Maps of probed planes: a row a feature, a column a case, one scale of colours."""
    planes = {name: relative(run, cases) for name, cases in probed(run).items()
              if next(iter(cases.values())).kind == "plane"}
    if not planes:
        raise NotInFile("no plane was probed")
    planes = dict(list(planes.items())[:MOST_PANELS])
    every = list(dict.fromkeys(case for cases in planes.values() for case in cases))
    looks = looks_of(run, every[:MOST_MAPS])
    values = np.concatenate([cases[case].mean for cases in planes.values() for case in looks if case in cases])
    largest = max(np.max(np.abs(values[np.isfinite(values)]), initial=0.0), 1e-3)
    norm = matplotlib.colors.Normalize(-largest, largest)
    figure, axes = style.plt.subplots(len(planes), len(looks), squeeze=False,
                                      figsize=(3.6 * len(looks) + 1.4, 3.0 * len(planes) + 0.5))
    for row, (feature, cases) in zip(axes, planes.items()):
        for ax, (case, look) in zip(row, looks.items()):
            if case not in cases:
                ax.axis("off")
                continue
            one = cases[case]
            i, j = np.sort(np.argsort(np.ptp(one.nominal, axis=0))[-2:])   # the directions in which it extends
            ax.use_sticky_edges = False   # points at the edge are not cut
            if _is_grid(one.nominal[:, [i, j]], one.mean):
                ax.tricontourf(one.nominal[:, i], one.nominal[:, j], one.mean, levels=np.linspace(norm.vmin, norm.vmax, 21),
                               cmap="RdBu_r", norm=norm, extend="both")
            met = ~one.missed()
            ax.scatter(one.nominal[met, i], one.nominal[met, j], c=one.mean[met], cmap="RdBu_r", norm=norm, s=16,
                       edgecolors=style.BLACK, linewidths=0.5, zorder=3)
            style.missed(ax, one.nominal[~met, i], one.nominal[~met, j], style.MISSED)
            ax.margins(0.06)
            ax.set_title(", ".join([feature, look.label, *missed_note([one])]))
            ax.set_xlabel(f"{'XYZ'[i]} of the part, mm")
            ax.set_ylabel(f"{'XYZ'[j]}, mm")
    bar = figure.colorbar(matplotlib.cm.ScalarMappable(norm, "RdBu_r"), ax=axes, shrink=0.85)
    bar.set_label("deviation along the normal, µm")
    crosses = " (crosses: nothing met)" if np.isnan(values).any() else ""
    style.headline(figure, f"Probed planes{minus(run, base_of(run))}: {largest_note(values)}{crosses}"
                   + not_shown(len(every) - len(looks), "case"))
    return figure


def _is_grid(p, values):
    # whether there is an area to colour between points that were all met
    return np.isfinite(values).all() and len(p) >= 4 and np.linalg.matrix_rank(p - p.mean(axis=0), tol=1e-6) == 2
