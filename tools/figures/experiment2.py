"""Figures 16 to 19: three parts of experiment 2, in air and cut, and as probed."""
import dataclasses

import numpy as np

from figures import names as naming
from figures import parts, results, style
from figures.results import NotInFile, UM_PER_MM
from figures.volumetric import magnification

PARTS = ("nominal", "generated", "compensated")
CIRCLE, PLANE = "circle", "plane"     # sections
TOP = "top"                           # probed feature
SUPERPOSED = 100.0                    # times: differences in figure 19, as in the paper's
AIR = "_air"


def _cases(run, names):
    """{the paper's name: case}"""
    own = {name: run.names.case(name) for name in names}
    missing = [name for name in names if own[name] not in run.cases or not run.cases[own[name]].finished]
    if missing:
        raise NotInFile("no finished case named " + ", ".join(own[name] for name in missing) + run.case_hint(missing[0]))
    return {name: run.cases[own[name]] for name in names}


def _look(run, name):
    return style.look_of(run, run.names.case(name))


def _tool_z(case, rows):
    return case.column("tool_position_true", "Z")[rows]


def draw_air_and_cutting(run):
    """Figure 16: Z of the circle at the scale, in air and while cutting, and what cutting adds at scale and tool."""
    cutting = _cases(run, PARTS)
    air = _cases(run, [name + AIR for name in PARTS])
    base = cutting["nominal"]
    figure, strip, grid = style.panels([1.0, 0.8], (11.0, 7.2), columns=2, widths=[1.0, 1.0])
    looks = {name: dataclasses.replace(_look(run, name), line="-", width=3.0 if name == "nominal" else 1.7)
             for name in PARTS}   # the nominal one lies under the others
    air_look = style.Look("in air", style.GREY, style.DASH, "", 1.2)
    style.legend(strip, [*looks.values(), air_look])
    (oblique, over), (scale, tool) = grid
    printed, size, circle = {}, 0.0, run.names.section(CIRCLE)
    for name in PARTS:
        rows, rows_air = (one.samples([circle]) for one in (cutting[name], air[name + AIR]))
        if not len(rows) or not len(rows_air):
            raise run.no_motion([CIRCLE])
        size = max(size, np.abs(_height(base, cutting[name], rows)).max())
    factor = magnification(150.0, size, 0.25)
    for name in PARTS:
        for case, look in ((cutting[name], looks[name]),
                           (air[name + AIR], dataclasses.replace(looks[name], line=air_look.line, width=air_look.width))):
            rows = case.samples([circle])
            angle, x, y = _around(base, case, rows)
            z = _height(base, case, rows)
            style.line(oblique, x + 0.35 * y, z * factor / UM_PER_MM + 0.5 * y, look)
            style.line(over, angle, z, look)
        rows = cutting[name].samples([circle])
        angle, _, _ = _around(base, cutting[name], rows)
        added = results.trajectory_difference(cutting[name], air[name + AIR], "Z", rows)
        style.noisy_line(scale, angle, added, looks[name], buckets=120)
        at_tool = (_tool_z(cutting[name], rows) - air[name + AIR].along(
            "tool_position_true", "Z", cutting[name].column("s")[rows])) * UM_PER_MM
        style.noisy_line(tool, angle, at_tool, looks[name], buckets=120)
        printed[name] = (np.abs(np.median(added)), np.abs(np.median(at_tool)))
    oblique.set_title(f"(a) Circle seen obliquely, Z at the scale × {factor:.0f}")
    oblique.set_aspect("equal", adjustable="datalim")
    oblique.axis("off")
    over.set_title("(b) Z at the scale minus programmed")
    scale.set_title("(c) Cutting minus air, at the scale")
    tool.set_title("(d) Cutting minus air, at the tool")
    for ax in (over, scale, tool):
        ax.set_ylabel("Z, µm")
        ax.margins(x=0.01)
        ax.set_xlabel("angle from the beginning of the circle, deg")
    largest = [max(printed[name][i] for name in PARTS) for i in (0, 1)]
    style.headline(figure, f"Cutting shifts Z along the circle by {style.number(largest[0])} µm at the scale and "
                           f"{style.number(largest[1])} µm at the tool (largest of the medians)")
    return figure


def _around(base, case, rows):
    s = case.column("s")[rows]
    x, y = (base.along("ref_linear", axis, s) for axis in "XY")
    x, y = x - 0.5 * (x.max() + x.min()), y - 0.5 * (y.max() + y.min())
    angle = np.degrees(np.unwrap(np.arctan2(y, x)))
    return np.abs(angle - angle[0]), x, y


def _height(base, case, rows):
    # scale minus what the nominal program asks for, um
    nominal = base.along("ref_linear", "Z", case.column("s")[rows])
    return (case.column("meas_linear", "Z")[rows] - nominal) * UM_PER_MM


@dataclasses.dataclass
class FittedPlane:
    """Least-squares plane z = c + a x + b y of probed points (um over mm)."""
    c: float
    a: float
    b: float
    residual: np.ndarray

    def rotations(self):
        """About X and Y, deg."""
        return np.degrees(np.arctan(self.b / UM_PER_MM)), -np.degrees(np.arctan(self.a / UM_PER_MM))


def fitted_plane(points, deviation):
    """Plane through the deviations (um) over X and Y (mm) of points that were met."""
    good = np.isfinite(deviation)
    if good.sum() < 3:
        raise NotInFile("fewer than three points of the plane met the surface")
    matrix = np.column_stack([np.ones(good.sum()), points[good, 0], points[good, 1]])
    c, a, b = np.linalg.lstsq(matrix, deviation[good], rcond=None)[0]
    return FittedPlane(c, a, b, deviation[good] - matrix @ [c, a, b])


def draw_top_plane(run):
    """Figure 17: trajectory, probed points and least-squares plane of the top, seen along Y and along X."""
    cases = _cases(run, PARTS)
    features = parts.probed(run)
    top = run.names.section(TOP)
    if top not in features:
        raise NotInFile(f"no probed feature named {top}" + naming.hint("section", TOP, top, list(features)))
    base = cases["nominal"]
    figure, strip, grid = style.panels([1.0, 1.0], (11.4, 7.4), columns=3, sharey=None)
    looks = {name: _look(run, name) for name in PARTS}
    style.legend(strip, [dataclasses.replace(looks[name], line="-", marker="") for name in PARTS] +
                 [style.Look("probed, ±σ", style.GREY, "", "x"), style.Look("least-squares plane", style.GREY, style.DASH, "")],
                 points=True)
    z_offset = run.scenario.get("program", {}).get("work_offset", {})
    printed = {}
    for column, name in enumerate(PARTS):
        one = features[top].get(cases[name].name)
        if one is None:
            raise NotInFile(f"case {cases[name].name} was not probed")
        plane = fitted_plane(one.nominal, one.mean)
        printed[name] = plane.rotations()
        rows = cases[name].samples([run.names.section(PLANE)])
        if not len(rows):
            raise run.no_motion([PLANE])
        at = {axis: results.programmed(base, axis, cases[name].column("s")[rows]) - float(z_offset.get(f"{axis}_mm", 0.0))
              for axis in "XY"}
        height = _height(base, cases[name], rows)
        for row, axis, slope in ((0, "X", plane.a), (1, "Y", plane.b)):
            ax = grid[row][column]
            for part in results.passes(np.arange(len(rows))[np.flatnonzero(np.diff(rows, prepend=rows[0] - 1) >= 1)]):
                ax.plot(at[axis][part][::20], height[part][::20], ",", color=style.paler(looks[name].colour, 0.5), zorder=1.8)
            number = "XY".index(axis)
            shown = np.s_[::-(-len(one.mean) // 169)]
            ax.errorbar(one.nominal[shown, number], one.mean[shown], yerr=one.sigma[shown], color=looks[name].colour, marker="x",
                        markersize=3.5, linestyle="none", elinewidth=0.8, zorder=3)
            reach = np.array([one.nominal[:, number].min(), one.nominal[:, number].max()]) * 1.35
            ax.plot(reach, plane.c + slope * reach, color=style.GREY, linestyle=style.DASH, linewidth=2.0, zorder=3.5)
            ax.set_xlabel(f"{axis} of the part, mm")
            if column == 0:
                ax.set_ylabel("Z, µm")
            style.missed_below(ax, one.nominal[one.missed(), number], looks[name])
        about_x, about_y = (f"{angle:.5f}°".replace("-", "−") for angle in plane.rotations())
        grid[0][column].set_title(f"{looks[name].label}: about Y by {about_y}", fontsize=10.5)
        grid[1][column].set_title("\n".join([f"about X by {about_x}, flat within {np.ptp(plane.residual):.1f} µm",
                                             *parts.missed_note([one])]), fontsize=10.5)
    for row in grid:
        limits = [ax.get_ylim() for ax in row]
        for ax in row:
            ax.set_ylim(min(low for low, _ in limits), max(high for _, high in limits))
    style.headline(figure, "Top plane, generated / compensated: turned by "
                   f"{np.hypot(*printed['generated']):.4f}° / {np.hypot(*printed['compensated']):.5f}°")
    return figure


@dataclasses.dataclass
class FittedPart:
    """Contours of one part in XY after the best fit of all its probed points to the nominal part (mm, um)."""
    nominal: np.ndarray     # (point, xy) where the CMM probed
    place: np.ndarray       # (point, xy) on the nominal part; NaN where nothing was met
    deviation: np.ndarray   # (point, xy) of the probed point from there
    distance: np.ndarray    # (point) the same along the normal
    sigma: np.ndarray
    features: dict          # {name: slice of the points}
    missed_note: list       # as of parts.missed_note

    def largest(self):
        return np.nanmax(np.linalg.norm(self.deviation, axis=1))

    def missed(self):
        return np.isnan(self.distance)


def best_fit(run, case):
    """All probed features of a part with normals in XY, as aligned with its nominal part (part.stl of the scenario)."""
    features = {name: cases[case] for name, cases in parts.probed(run).items() if case in cases and cases[case].is_level()}
    if not features:
        raise NotInFile(f"no probed feature of case {case} has normals in XY")
    if any(one.aligned_position is None for one in features.values()):
        stl = run.scenario.get("part", {}).get("stl")
        raise NotInFile(f"the part of case {case} could not be aligned with {stl}" if stl else
                        f"the part of case {case} was not aligned: the scenario has no nominal part (part.stl)")
    if all(one.missed().all() for one in features.values()):
        raise NotInFile(f"no point of the contours of case {case} met the surface")
    nominal, place, deviation, normal, sigma = (np.concatenate([getattr(one, name) for one in features.values()])
                                                for name in ("nominal", "aligned_position", "aligned_deviation", "normal", "sigma"))
    ends = np.cumsum([len(one.mean) for one in features.values()])
    slices = {name: np.s_[end - len(one.mean):end] for end, (name, one) in zip(ends, features.items())}
    return FittedPart(nominal[:, :2], place[:, :2], deviation[:, :2], (deviation * normal).sum(axis=1), sigma, slices,
                      parts.missed_note(features.values()))


NOMINAL = style.Look("nominal geometry", parts.PALE, "-", "", 1.0)


def _key(fitted):
    # what a legend says beside the cases
    return [NOMINAL] + ([style.MISSED] if any(one.missed().any() for one in fitted.values()) else [])


def draw_quivers(run):
    """Figure 18: distances of the three parts to the nominal one in XY after best fit."""
    fitted = {name: best_fit(run, case.name) for name, case in _cases(run, PARTS).items()}
    largest = max(one.largest() for one in fitted.values())
    figure, strip, grid = style.panels([1.0], (13.2, 5.7), columns=3)
    style.legend(strip, _key(fitted), lines=False, points=True)
    factor = magnification(np.ptp(fitted["nominal"].nominal, axis=0).max(), largest, 0.12)
    for ax, (name, one) in zip(grid[0], fitted.items()):
        look = _look(run, name)
        _draw_outline(ax, one)
        met = ~one.missed()
        ax.quiver(*one.place[met].T, *one.deviation[met].T * factor / UM_PER_MM, color=look.colour, angles="xy",
                  scale_units="xy", scale=1.0, width=0.004, zorder=3)
        style.missed(ax, *one.nominal[~met].T, look)
        ax.set_aspect("equal", adjustable="datalim")
        ax.margins(0.12)
        ax.set_title("\n".join([f"{look.label}: up to {style.number(one.largest())} µm (σ {np.nanmean(one.sigma):.2f} µm)",
                                *one.missed_note]))
        ax.set_xlabel("X of the part, mm")
    grid[0][0].set_ylabel("Y of the part, mm")
    style.headline(figure, f"Distances to the nominal part after best fit, × {factor:.0f}: up to {style.number(largest)} µm")
    return figure


def _draw_outline(ax, part):
    for points in part.features.values():
        style.line(ax, *_closed(part.nominal[points], part.nominal[points]).T, NOMINAL, zorder=1.9)


def _closed(points, nominal):
    # a full circle of points is drawn closed
    apart = np.linalg.norm(nominal - nominal[0], axis=1)
    return np.vstack([points, points[:1]]) if len(apart) > 2 and apart[-1] < 1.5 * apart[1] else points


def draw_superposed(run):
    """Figure 19: the three parts on each other, distances magnified."""
    fitted = {name: best_fit(run, case.name) for name, case in _cases(run, PARTS).items()}
    figure, strip, grid = style.panels([1.0], (8.6, 8.8))
    ax = grid[0][0]
    _draw_outline(ax, fitted["nominal"])
    looks = {name: dataclasses.replace(_look(run, name), line=style.DASH if name == "compensated" else "-", marker="")
             for name in fitted}
    for name, one in fitted.items():
        shown = one.place + one.deviation * SUPERPOSED / UM_PER_MM
        for points in one.features.values():
            style.line(ax, *_closed(shown[points], one.nominal[points]).T, looks[name], zorder=3.2 if name == "compensated" else 3)
        style.missed(ax, *one.nominal[one.missed()].T, looks[name])
    style.legend(strip, [*_key(fitted), *looks.values()], lines=False, points=True)
    ax.set_aspect("equal", adjustable="datalim")
    ax.set_xlabel("X of the part, mm")
    ax.set_ylabel("Y of the part, mm")
    missed = [f"{looks[name].label}: {printed}" for name, one in fitted.items() for printed in one.missed_note]
    ax.set_title("\n".join([f"Distances × {SUPERPOSED:.0f}, after best fit", *missed]))
    apart = np.abs(fitted["compensated"].distance - fitted["nominal"].distance)
    style.headline(figure, f"Probed after best fit, nominal and compensated part: {parts.largest_note(apart)} apart")
    return figure
