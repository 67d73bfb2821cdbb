"""Nonlinear error of machines with rotary axes: the figures of X. Li (2024).

Two errors, both at equal arc length s of the program (equal t between two posts):
- of the tip: case minus the case that goes straight (strategy `exact`), in the workpiece;
- of the posts: interpolated and post-processed locations minus the line between the posts, in the machine.
"""
import numpy as np

from figures import style
from figures.results import NotInFile, UM_PER_MM

SPACING = 0.1       # mm, of the points of table 3.1
ENLARGED = 40.0     # times: deviations in the enlarged way
LEAST = 1e-4        # um: what a logarithmic axis shows of nothing
LEAST_SHOWN = 1e-5  # the same, of the largest error


class Segments:
    """Cases of a run along the program's feed moves, sampled at common places."""

    def __init__(self, run):
        kinds = {case.name: [one.get("type") for one in run.strategies(case.name)]
                 for case in run.finished_cases()}
        plain = [name for name, types in kinds.items() if not types or types == ["none"]]
        exact = [name for name, types in kinds.items() if types == ["exact"]]
        if not plain or not exact:
            raise NotInFile("needs a case without strategy and one with the strategy exact")
        self.run, self.plain, self.exact = run, run.cases[plain[0]], run.cases[exact[0]]
        self.others = [case for case in run.finished_cases() if case not in (self.plain, self.exact)]
        rows = self.exact.samples()
        self.s = self.exact.column("s")[rows]
        self.line = self.exact.column("line")[rows]
        self.s, first = np.unique(self.s, return_index=True)
        self.line = self.line[first]
        if len(self.s) < 10:
            raise NotInFile("no feed moves")
        self.tip_exact = self.at(self.exact, "tool_position_true")
        self.post_exact = self.at(self.exact, "ref_linear")
        self.straight = self.at(self.plain, "ref_linear")

    def at(self, case, name, axes="XYZ"):
        """Columns of a dataset at the common places."""
        rows = case.samples()
        s, first = np.unique(case.column("s")[rows], return_index=True)
        rows = rows[first]
        return np.column_stack([np.interp(self.s, s, case.column(name, axis)[rows]) for axis in axes])

    def tip_error(self, case):
        """um, vectors."""
        return (self.at(case, "tool_position_true") - self.tip_exact) * UM_PER_MM

    def post_error(self, positions):
        """um, vectors; of linear axes positions against the line between the posts."""
        return (positions - self.straight) * UM_PER_MM

    def longest_error(self):
        """Places of the segment with the largest error of the tip."""
        error = np.linalg.norm(self.tip_error(self.plain), axis=1)
        return self.line == self.line[np.argmax(error)]

    def chord(self, places):
        """Distance of the straight tip since the segment's begin, mm."""
        tip = self.tip_exact[places]
        return np.linalg.norm(tip - tip[0], axis=1)

    def off_the_chord(self):
        """(distance along its chord (mm), tip of the case without strategy off the chord at equal t (um)) of the
        segment with the largest error; needs no other case."""
        places = self.longest_error()
        tip, s = self.at(self.plain, "tool_position_true")[places], self.s[places]
        t = (s - s[0]) / (s[-1] - s[0])
        chord = tip[-1] - tip[0]
        return t * np.linalg.norm(chord), (tip - tip[0] - np.outer(t, chord)) * UM_PER_MM

    def in_machine(self, error, places):
        """Vectors of the workpiece, turned into the machine by the equations of the paper for its tables C' A'; as they
        are on other machines."""
        if "C' A'" not in str(self.run.scenario.get("machine", {}).get("structure", "")):
            return error
        A, C = np.radians(self.at(self.plain, "ref_rotary", "AC")[places]).T
        turned = np.sin(C) * error[:, 0] + np.cos(C) * error[:, 1]
        return np.column_stack([np.cos(C) * error[:, 0] - np.sin(C) * error[:, 1],
                                np.cos(A) * turned - np.sin(A) * error[:, 2],
                                np.sin(A) * turned + np.cos(A) * error[:, 2]])

    def off_the_line(self):
        """The error of off_the_chord where the axes are, perpendicular to the line between the posts: (distance
        along the chord (mm), um)."""
        places = self.longest_error()
        way, error = self.off_the_chord()
        line = self.straight[places][-1] - self.straight[places][0]
        return way, np.linalg.norm(np.cross(self.in_machine(error, places), line / np.linalg.norm(line)), axis=1)


def _models(way, error):
    t = (way - way[0]) / (way[-1] - way[0])
    middle = np.array([np.interp(0.5, t, column) for column in error.T])
    return {"a sin πt": np.outer(np.sin(np.pi * t), middle), "4 a t (1 − t)": np.outer(4 * t * (1 - t), middle)}


def draw_distribution(run):
    """Figure 3.2: error of one segment, with the two models through its middle."""
    segments = Segments(run)
    places = segments.longest_error()
    way = segments.chord(places)
    tip = segments.in_machine(segments.tip_error(segments.plain)[places], places)   # amplitudes as strategies take them
    errors = [("tip off the chord (joints go linearly)", tip),
              ("posts off the line between the posts", segments.post_error(segments.post_exact)[places])]
    looks = [style.Look("error", style.BLACK, "-", "o"), style.Look("model a sin πt", style.BLUE, style.DASH, ""),
             style.Look("model 4 a t (1 − t)", style.RED, style.DASH_DOT, "")]
    figure, strip, grid = style.panels([1.0, 0.55], (10.2, 5.6), columns=2)
    style.legend(strip, looks, points=True)
    shares = []
    for column, (title, error) in enumerate(errors):
        size = np.linalg.norm(error, axis=1)
        top, bottom = grid[0][column], grid[1][column]
        points = np.append(np.arange(0.0, way[-1], SPACING), way[-1])
        style.line(top, way, size, looks[0])
        top.plot(points, np.interp(points, way, size), "o", color=style.BLACK, markersize=4)
        for look, model in zip(looks[1:], _models(way, error).values()):
            style.line(top, way, np.linalg.norm(model, axis=1), look)
            left = np.linalg.norm(error - model, axis=1)
            style.line(bottom, way, left, look)
            shares.append(100.0 * left.max() / size.max())
        top.set_title(f"{title}: {style.number(size.max())} µm")
        top.tick_params(labelbottom=False)
        bottom.set_title(f"what is left: sine {shares[-2]:.1f} %, parabola {shares[-1]:.2g} %")
        bottom.set_xlabel("distance along the chord, mm")
    grid[0][0].set_ylabel("|error|, µm")
    grid[1][0].set_ylabel("|error − model|, µm")
    style.headline(figure, f"Nonlinear error of one segment: of the tip, a sine leaves {shares[0]:.1f} %, "
                           f"a parabola {shares[1]:.2g} %")
    return figure


def _case_looks(segments):
    """Looks by name of the case, for errors of the tip."""
    colours = {"harmonic": style.BLUE, "parabolic": style.RED, "exact": style.PURPLE}
    looks = {segments.plain.name: style.Look("tip, " + segments.plain.name, style.BLACK, "-", "o")}
    for case in segments.others + [segments.exact]:
        one = segments.run.strategies(case.name)[-1]
        post_processed = one.get("definition") == "post_processed_location"
        label = "tip, harmonic as printed" if post_processed and one["type"] == "harmonic" else "tip, " + case.name.replace("_", " ")
        looks[case.name] = style.Look(label, style.LIGHT_PURPLE if post_processed else colours.get(one["type"], style.GREY),
                                      style.DASH if post_processed else "-" if one["type"] == "exact" else style.DASH_DOT, "s")
    return looks


def _post_processed_case(segments):
    for case in segments.others:
        if segments.run.strategies(case.name)[-1].get("definition") == "post_processed_location":
            return case
    raise NotInFile("no case with definition = \"post_processed_location\"")


def draw_segment(run):
    """Figure 3.3: one segment in the machine, posts before and after, and the errors of both kinds."""
    segments = Segments(run)
    places = segments.longest_error()
    way = segments.chord(places)
    post_processed = _post_processed_case(segments)
    compensated = segments.at(post_processed, "ref_linear")
    error = segments.post_error(segments.post_exact)[places]
    i, j = np.argsort(np.ptp(segments.straight[places], axis=0))[::-1][:2]
    figure, strip, grid = style.panels([1.0], (12.6, 4.8), columns=3, legend_lines=2)
    before = style.Look("posts of locations between", style.BLACK, style.DASH, "")
    after = style.Look("the same, compensated as printed", style.BLUE, "-", "")
    ideal = style.Look("line between the posts", style.GREY, style.DOT, "", 2.6)
    looks = _case_looks(segments)
    tips = [case for case in [segments.plain, *segments.others] if case is not post_processed]
    style.legend(strip, [before, looks[segments.plain.name], after, *(looks[case.name] for case in tips[1:2]), ideal,
                         *(looks[case.name] for case in [*tips[2:], post_processed])], columns=4)
    left, middle, right = grid[0]
    for look, positions in ((ideal, segments.straight), (before, segments.post_exact), (after, compensated)):
        style.line(left, positions[places][:, i], positions[places][:, j], look)
    left.set_xlabel(f"{'XYZ'[i]} of the machine, mm")
    left.set_ylabel(f"{'XYZ'[j]} of the machine, mm")
    left.set_title("Posts of the segment")
    rest = segments.post_error(compensated)[places]
    for look, values in ((before, error), (after, rest)):
        style.line(middle, way, np.linalg.norm(values, axis=1), look)
    share = 100.0 * np.linalg.norm(rest, axis=1).max() / np.linalg.norm(error, axis=1).max()
    middle.set_title(f"Posts off the line: {share:.1f} % left")
    middle.set_ylabel("distance from the line, µm")
    peak = max(np.linalg.norm(segments.tip_error(case)[places], axis=1).max() for case in [*tips, post_processed])
    for case in [*tips, post_processed]:
        error = np.linalg.norm(segments.tip_error(case)[places], axis=1)
        style.line(right, way, np.maximum(error, LEAST_SHOWN * peak), looks[case.name])
    right.set_yscale("log")
    right.set_title("Tip off the chord")
    right.set_ylabel("distance from the chord, µm")
    for ax in (middle, right):
        ax.set_xlabel("distance along the chord, mm")
    tip_before, tip_after = (np.linalg.norm(segments.tip_error(case)[places], axis=1).max()
                             for case in (segments.plain, post_processed))
    style.headline(figure, f"As published the posts come to the line; the tip stays off the chord: "
                           f"{style.number(tip_before)} µm before, {style.number(tip_after)} µm after")
    return figure


def draw_way(run):
    """Figure 4.1: path in the machine, enlarged around the largest error, and the errors along it."""
    segments = Segments(run)
    looks = _case_looks(segments)
    cases = [segments.plain, *segments.others]
    figure, strip, grid = style.panels([1.0, 0.9], (10.6, 7.4), columns=2, legend_lines=2)
    style.legend(strip, [looks[case.name] for case in cases] +
                 [style.Look("straight tip (exact)", style.GREY, style.DOT, "", 2.6)], columns=4)
    i, j = np.argsort(np.ptp(segments.post_exact, axis=0))[::-1][:2]
    whole, enlarged = grid[0]
    zoom = segments.longest_error()
    zoom = np.flatnonzero(zoom)
    wide = slice(max(0, zoom[0] - len(zoom)), zoom[-1] + len(zoom))
    for case in cases:
        positions = segments.at(case, "ref_linear")
        off = positions - segments.post_exact
        style.line(whole, positions[:, i], positions[:, j], looks[case.name], linewidth=1.0)
        shown = (segments.post_exact + ENLARGED * off)[wide]
        style.line(enlarged, shown[:, i], shown[:, j], looks[case.name])
    style.line(enlarged, segments.post_exact[wide][:, i], segments.post_exact[wide][:, j],
               style.Look("", style.GREY, style.DOT, "", 2.6))
    for ax, title in ((whole, "Path of the axes"), (enlarged, f"Enlarged, deviations × {ENLARGED:g}")):
        ax.set_xlabel(f"{'XYZ'[i]} of the machine, mm")
        ax.set_ylabel(f"{'XYZ'[j]} of the machine, mm")
        ax.set_title(title)
    linear, logarithmic = grid[1]
    s = segments.s - segments.s[0]
    peaks = {}
    for case in cases:
        error = np.linalg.norm(segments.tip_error(case), axis=1)
        peaks[case.name] = error.max()
        style.line(linear, s, error, looks[case.name], linewidth=1.1)
        style.line(logarithmic, s, np.maximum(error, LEAST), looks[case.name], linewidth=1.1)
    logarithmic.set_yscale("log")
    for ax in (linear, logarithmic):
        ax.set_xlabel("arc length of the program, mm")
        ax.set_ylabel("tip off the chord, µm")
    linear.set_title("Error of the tip")
    logarithmic.set_title("The same, logarithmic")
    style.headline(figure, "Tip off the chord, µm: " + ", ".join(
        f"{looks[name].label.removeprefix('tip, ')} {peak:.2g}" for name, peak in peaks.items()))
    return figure
