"""Numbers that no command prints: made of result files, the papers' own tables and scenarios.

Each function takes the results (values.Results) and what a row says beside `derived`; NotInFile says what is missing.
"""
import csv
import math
import pathlib

import numpy as np

from figures import experiment2, nonlinear, probed_points, results as files, straightness
from figures.results import NotInFile

SCENARIOS = pathlib.Path(__file__).resolve().parents[2] / "scenarios"
TABLE31 = SCENARIOS / "li2024" / "table31.csv"


def scenario_key(results, run, key, unit=""):
    """A number that the scenario sets: what was taken from the paper as an input. Elements of lists by name or place.
    unit: that of a text ("20 N/um"); a plain number has the one that its key names."""
    node = results.opened(run).scenario
    for part in key.split("."):
        if isinstance(node, list):
            named = [one for one in node if one.get("name") == part]
            node = named[0] if named else node[int(part)] if part.isdigit() and int(part) < len(node) else None
        else:
            node = node.get(part) if isinstance(node, dict) else None
        if node is None:
            raise NotInFile(f"{run} sets no {key}")
    number, _, written = str(node).partition(" ")
    try:
        value = float(number)
    except ValueError:
        raise NotInFile(f"{key} of {run} is not a number") from None
    if written.strip() != unit:
        raise NotInFile(f"{key} of {run} is {node}, not in {unit or 'the unit of the key'}")
    return value


def _over_sweep(results, run, case, quantity):
    sweep = results.opened(run)
    for one in sweep.quantities:
        if one["case"] == case and one["quantity"] == quantity:
            good = np.isfinite(one["value"])
            if good.sum() < 2 or not good.all():
                raise NotInFile(f"{quantity} of {case} has values at {good.sum()} of {good.size} points of {run}")
            return sweep, good, one["value"][good]
    raise NotInFile(f"{run} holds no {quantity} of {case}")


def sweep_spread(results, run, case, quantity):
    """Largest departure of a quantity from its mean over a sweep, %."""
    _, _, values = _over_sweep(results, run, case, quantity)
    return 100.0 * np.abs(values / values.mean() - 1.0).max()


def sweep_departure_from_proportional(results, run, case, quantity, key):
    """Largest departure of quantity / parameter from its mean over a sweep, %."""
    sweep, good, values = _over_sweep(results, run, case, quantity)
    slope = values / sweep.keys[key][good]
    return 100.0 * np.abs(slope / slope.mean() - 1.0).max()


def slope_correlation(results, run, case, axis, section):
    """Correlation of what is missing with the slope of the imposed curve in the direction of travel; -1: a pure delay."""
    run = results.opened(run)
    found = [one for one in straightness.tracks(run, axis, section) if one.case.name == case]
    if not found:
        raise NotInFile(f"no case {case}")
    x, imposed = straightness.imposed_curve(run, axis, section)
    x, first = np.unique(x, return_index=True)
    slope = np.gradient(imposed[first], x)
    missing, slopes = [], []
    for at, _, residual in found[0].passes:
        missing.append(residual)
        slopes.append(np.interp(at, x, slope) * np.sign(at[-1] - at[0]))
    return float(np.corrcoef(np.concatenate(missing), np.concatenate(slopes))[0, 1])


def volumetric_error(results, run, case):
    """Largest imposed displacement of the tool tip where the program goes, um."""
    one = results.opened(run).cases.get(case)
    if one is None or not one.has("imposed_linear"):
        raise NotInFile(f"{run} holds no imposed displacement of {case}")
    return float(np.linalg.norm(np.column_stack([one.column("imposed_linear", a) for a in "XYZ"]), axis=1).max())


def largest_of(results, run, quantity, cases):
    """The largest value of a quantity over cases and axes."""
    found = [row["value"] for row in results.compared(run) if row["quantity"] == quantity and row["case"] in cases]
    missing = set(cases) - {row["case"] for row in results.compared(run) if row["quantity"] == quantity}
    if missing or not np.isfinite(found).all():
        raise NotInFile(f"{run} holds no {quantity} of {', '.join(sorted(missing) or cases)}")
    return float(np.abs(found).max())


PATHS = "plane, circle, diamond, square"   # sections of experiment 2 on which parts are finished


def effectiveness(results, run, case, generated, baseline, axis):
    """What a case takes away of the displacement of another one, both relative to a third: 100 % less what it leaves."""
    def largest(one):
        found = [row["value"] for row in results.compared(run)
                 if (row["case"], row["quantity"], row.get("axis"), row.get("sections")) ==
                 (one, "trajectory_difference", axis, PATHS) and row.get("baseline", baseline) == baseline]
        if len(found) != 1 or not math.isfinite(found[0]):
            raise NotInFile(f"{run} holds no trajectory_difference of {one}, {axis}")
        return found[0]
    return 100.0 * (1.0 - largest(case) / largest(generated))


def height_of_pass(results, run, case, section, above):
    """How far the tool's Z on a section is above that on another one: medians, mm."""
    one = results.opened(run).cases.get(case)
    heights = []
    for name in (section, above):
        rows = one.samples((name,)) if one is not None and one.finished else []
        if not len(rows):
            raise NotInFile(f"{run} holds no {name} of {case}")
        heights.append(float(np.median(one.column("ref_linear", "Z")[rows])))
    return heights[0] - heights[1]


# Parts ----------------------------------------------------------------------------------------------------------------

def _met_everywhere(missed, what):
    # what was measured of a part of its points is no value
    if np.any(missed):
        raise NotInFile(f"{what} was not probed at all of its points")


def probed_residual(results, run, case, axis, feature):
    """Largest distance of probed points to the imposed curve, relative to the nominal side, um. The feature "notches"
    stands for all of them."""
    run = results.opened(run)
    found = probed_points.notches(run) if feature == "notches" else probed_points.along(run, feature, axis)
    if case not in found:
        raise NotInFile(f"{feature} of case {case} was not probed")
    _met_everywhere(found[case].missed, f"{feature} of case {case}")
    if not np.isfinite(found[case].residual).all():
        raise NotInFile(f"no error is imposed on {feature} of case {case}")
    return float(found[case].largest())


def part_minus_trajectory(results, run, case, axis, feature):
    """Root mean square of probed points minus trajectory, both relative to the nominal side, um."""
    run = results.opened(run)
    points = probed_points.along(run, feature, axis).get(case)
    track = [one for one in straightness.tracks(run, axis, feature) if one.case.name == case]
    if points is None or not track:
        raise NotInFile(f"{feature} of case {case} was not probed")
    _met_everywhere(points.missed, f"{feature} of case {case}")
    x, difference, _ = track[0].passes[0]
    order = np.argsort(x, kind="stable")
    apart = points.displacement - np.interp(points.x, x[order], difference[order])
    return float(np.sqrt(np.mean(apart**2)))


def _best_fit(results, run, case):
    fitted = experiment2.best_fit(results.opened(run), case)
    _met_everywhere(fitted.missed(), f"the part of case {case}")
    return fitted


def largest_after_best_fit(results, run, case):
    """Largest distance of the probed contours to the nominal part after best fit, um."""
    return float(_best_fit(results, run, case).largest())


def difference_after_best_fit(results, run, case, baseline):
    """Largest difference of these distances between two parts, um."""
    one, other = (_best_fit(results, run, name) for name in (case, baseline))
    return float(np.abs(one.distance - other.distance).max())


def _cutting_and_air(run, case):
    for name in (case, case + experiment2.AIR):
        if name not in run.cases or not run.cases[name].finished:
            raise NotInFile(f"no finished case named {name}")
    return run.cases[case], run.cases[case + experiment2.AIR]


def _tool_shift(run, case, sections):
    # Z of the tool tip, cutting minus air at equal s, um
    cutting, air = _cutting_and_air(run, case)
    rows = cutting.samples(sections)
    if not len(rows):
        raise NotInFile("no feed motion in sections named " + ", ".join(sections))
    in_air = air.along("tool_position_true", "Z", cutting.column("s")[rows])
    return (cutting.column("tool_position_true", "Z")[rows] - in_air) * files.UM_PER_MM


def cutting_minus_air(results, run, case, at, section):
    """Shift of Z by cutting on a section, at the scale or the tool: its median, um."""
    run = results.opened(run)
    if at == "tool":
        return float(np.median(_tool_shift(run, case, (section,))))
    cutting, air = _cutting_and_air(run, case)
    return float(np.median(files.trajectory_difference(cutting, air, "Z", cutting.samples((section,)))))


def _between_parts(results, run, case, baseline, section):
    apart = abs(cutting_minus_air(results, run, case, "tool", section) - cutting_minus_air(results, run, baseline, "tool", section))
    if apart == 0.0:
        raise NotInFile(f"cutting shifts {case} and {baseline} alike")
    return apart


def stiffness_needed(results, run, case, baseline, section, um):
    """Structural stiffness of Z (N/um) at which the tool would show `um` between two parts cut with these forces."""
    return (scenario_key(results, run, "machine.axis.Z.structural_stiffness", "N/um")
            * _between_parts(results, run, case, baseline, section) / um)


def wear_needed(results, run, case, baseline, section, um):
    """Wear (factor on the terms of the edge) of the later part at which the tool would show `um` between the two."""
    first = scenario_key(results, run, "cutting.wear")
    later = scenario_key(results, run, f"case.{case}.wear")
    return first + (later - first) * um / _between_parts(results, run, case, baseline, section)


# Li 2024 --------------------------------------------------------------------------------------------------------------

def table31():
    """The 23 values of table 3.1, mm."""
    with TABLE31.open(encoding="utf-8") as lines:
        rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))
    return np.array([float(row["error_mm"]) for row in rows])


def _segments(results, run):
    return results.once(("segments", run), lambda: nonlinear.Segments(results.opened(run)))


def _segment(results, run):
    segments = _segments(results, run)
    places = segments.longest_error()
    return segments.chord(places), np.linalg.norm(segments.tip_error(segments.plain)[places], axis=1)


def points_of(chord):
    """Places of the points of table 3.1 on a chord (mm): every 0.1 mm and at its end."""
    return np.append(np.arange(0.0, chord, nonlinear.SPACING), chord)


def points_of_segment(results, run):
    """How many points lie on the segment at the spacing of table 3.1."""
    return float(len(points_of(_segment(results, run)[0][-1])))


def chord(results, run):
    """Length of the segment with the largest error, mm."""
    return float(_segment(results, run)[0][-1])


def error_at_point(results, run, k, off="chord"):
    """Error at point k of table 3.1, um. off: "chord" of the tip in the workpiece; "line" between the posts, where the
    axes are."""
    segments = _segments(results, run)
    if off == "line":
        way, error = segments.off_the_line()
    else:
        way, vectors = segments.off_the_chord()
        error = np.linalg.norm(vectors, axis=1)
    points = points_of(way[-1])
    if k > len(points):
        raise NotInFile(f"the segment has {len(points)} points")
    return float(np.interp(points, way, error)[k - 1])


def error_of_length(results, run, location):
    """How far the tool axis of a location of the scenario's .cls file is from unit length, over what its printed digits
    allow (half a unit of the last one of j and k); below 1 it may be a unit vector."""
    results.opened(run)   # of a scenario that was not run there is no value
    path = SCENARIOS / "li2024" / f"{run}.cls"
    points = [line.split("/")[1].split(",")[3:] for line in path.read_text(encoding="utf-8").splitlines()
              if line.startswith("GOTO/")]
    words = points[location - 1]
    i, j, k = map(float, words)
    allowed = sum(0.5 * 10.0 ** -len(word.split(".")[1]) * abs(value) for word, value in zip(words[1:], (j, k)))
    return abs(float(np.linalg.norm([i, j, k])) - 1.0) / allowed


def left_of_table31(results, model):
    """What a model through the peak leaves of the paper's own table 3.1, % of the peak."""
    values = table31()
    way = np.minimum(nonlinear.SPACING * np.arange(len(values)), CHORD_OF_TABLE31)
    t = way / way[-1]
    shape = np.sin(np.pi * t) if model == "sine" else 4.0 * t * (1.0 - t)
    return float(100.0 * np.abs(values - values.max() * shape).max() / values.max())


CHORD_OF_TABLE31 = 2.1846   # mm, between the locations that section 3.2.3 prints


def peak_over_segments(results, run, case, lowest=False):
    """Largest share of a segment's error that a case leaves, over all segments, %."""
    segments = _segments(results, run)
    if case not in segments.run.cases:
        raise NotInFile(f"no case {case}")
    before = np.linalg.norm(segments.tip_error(segments.plain), axis=1)
    after = np.linalg.norm(segments.tip_error(segments.run.cases[case]), axis=1)
    shares = [100.0 * after[segments.line == line].max() / before[segments.line == line].max()
              for line in np.unique(segments.line) if (segments.line == line).sum() > 10]
    return float(min(shares) if lowest else max(shares))


FUNCTIONS = {one.__name__: one for one in (
    scenario_key, largest_of, effectiveness, height_of_pass, sweep_spread, sweep_departure_from_proportional,
    slope_correlation, volumetric_error, points_of_segment, probed_residual, part_minus_trajectory,
    largest_after_best_fit, difference_after_best_fit, cutting_minus_air, stiffness_needed, wear_needed, chord,
    error_at_point, error_of_length, left_of_table31, peak_over_segments)}
