"""Points probed on the sides of experiment 1, relative to the nominal side, for figures 9, 10 and 11."""
import dataclasses

import numpy as np

from figures import parts, style
from figures.results import NotInFile

COVERAGE = parts.COVERAGE
MOST_SHOWN = 31     # bars of a feature, so that they can be distinguished


@dataclasses.dataclass
class Points:
    """Probed points of one case over X of the machine (mm, um), minus those of the base case."""
    x: np.ndarray
    displacement: np.ndarray
    residual: np.ndarray      # the same minus the imposed displacement
    sigma: np.ndarray         # standard deviation of a repetition, of both sides
    missed: np.ndarray        # how many of the points of each met nothing

    def largest(self):
        return np.nanmax(np.abs(self.residual), initial=0.0)

    def reach(self):
        """Largest residual with its bar."""
        return np.nanmax(np.abs(self.residual) + COVERAGE * self.sigma, initial=0.0)

    def draw(self, ax, values, look, shift=0.0):
        every = np.s_[::-(-len(self.x) // MOST_SHOWN)]
        ax.errorbar(self.x[every] + shift, values[every], yerr=COVERAGE * self.sigma[every], color=look.colour, marker="x",
                    markersize=4.5, linestyle="none", elinewidth=0.9, capsize=1.8, zorder=3.2)
        style.missed_below(ax, self.x[self.missed > 0] + shift, look)


def _features(run, wanted):
    """{feature: {case: parts.Feature relative to the base}} of the features that `wanted` accepts; {} if none was probed."""
    try:
        features = parts.probed(run)
    except NotInFile:
        return {}
    return {name: parts.relative(run, cases) for name, cases in features.items() if wanted(name)}


def _offset(run):
    return float(run.scenario.get("program", {}).get("work_offset", {}).get("X_mm", 0.0))


def along(run, name, axis):
    """{case: Points} of the probed line of that name; displacements in an axis."""
    number = "XYZ".index(axis)
    return {case: Points(one.nominal[:, 0] + _offset(run), one.mean * one.normal[:, number],
                         (one.mean - one.imposed) * one.normal[:, number], one.sigma, one.missed().astype(int))
            for cases in _features(run, lambda feature: feature == name).values() for case, one in cases.items()}


def notches(run, name="notch"):
    """{case: Points} of all features whose names begin so: X of their centre lines, both flanks weighing the same."""
    found = {}
    for cases in _features(run, lambda feature: feature.startswith(name)).values():
        for case, one in cases.items():
            found.setdefault(case, []).append(_centre(one, _offset(run)))
    return {case: Points(*(np.array(column) for column in zip(*sorted(rows)))) for case, rows in found.items()}


def _centre(one, offset):
    across = one.normal[:, 0]

    def middle(values):   # of the flanks, each its mean
        return 0.5 * (_mean(values[across > 0.0]) + _mean(values[across < 0.0]))

    met = np.count_nonzero(~one.missed())
    return (middle(one.nominal[:, 0]) + offset, middle(one.mean * across), middle((one.mean - one.imposed) * across),
            np.sqrt(_mean(one.sigma**2) / max(met, 1)), len(one.mean) - met)


def _mean(values):
    good = values[np.isfinite(values)]
    return good.mean() if len(good) else np.nan


def note(probed):
    """For a title, where there are points."""
    missed = sum(int(points.missed.sum()) for points in probed.values())
    return f"; crosses: probed, ±{COVERAGE:g}σ" + (f"; hollow: {missed} missed" if missed else "") if probed else ""
