"""Figures of parts and balls, names of the user's own, and long recordings."""
import json
import shutil
import unittest
import unittest.mock

from plot_files import HERE, SMALLEST_PNG, WithFiles, plot, servomill

import h5py
import numpy as np

from figures import balls, five_axis, lag, names, parts, probed_points, results, rows, straightness, style, volumetric

FAST = ("--set", "program.feed_override=4", "--set", "record.period_ms=5")   # shorter recordings
AGREE = 1e-7  # um; `compare` prints nine digits of up to 100 um


class Parts(WithFiles):
    """The part on the virtual CMM."""

    LOST = {"as_it_is": {"front": [3, 20], "notch": [2], "top": [4]}, "compensated": {"front": [30]}}

    @classmethod
    def setUpClass(cls):
        cls.block, cls.missed = cls.root / "block.h5", cls.root / "missed.h5"
        servomill("run", HERE.parents[1] / "scenarios/parts/block.toml", "-o", cls.block, "-q")
        shutil.copy(cls.block, cls.missed)
        with h5py.File(cls.missed, "a") as file:
            for case, features in cls.LOST.items():
                for feature, points in features.items():
                    for name in ("deviation", "sigma", "measured"):
                        for point in points:
                            file[f"cases/{case}/probes/{feature}/{name}"][..., point] = np.nan

    def drawn_of(self, path, draw):
        style.set_up()
        with results.open_result(path) as run:
            figure = draw(run)
        self.addCleanup(style.plt.close, figure)
        return figure

    def crosses(self, axes):
        """Places that are marked as missed, by colour of the case."""
        found = {}
        for line in axes.lines:
            if line.get_marker() == style.MISSED.marker and len(line.get_xydata()):
                found.setdefault(line.get_markeredgecolor(), []).extend(tuple(place) for place in line.get_xydata())
        return found

    def test_the_block_is_drawn_and_agrees_with_compare(self):
        done = plot(self.block, "-o", self.out, "--figures", "probed,part,planes")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertEqual(self.drawn(), ["block-part.png", "block-planes.png", "block-probed.png"])
        for drawn in self.out.iterdir():
            self.assertGreater(drawn.stat().st_size, SMALLEST_PNG, drawn)
        rows = json.loads(servomill("compare", self.block, "--json"))
        said = {row["case"]: row["value"] for row in rows if row["quantity"] == "probed_deviation"}
        with results.open_result(self.block) as run:
            front = parts.relative(run, parts.probed(run)["front"])
        self.assertEqual(list(front), ["as_it_is", "compensated"])
        for case, one in front.items():
            self.assertAlmostEqual(np.abs(one.mean).max(), said[case], delta=AGREE)
            # the bars are those of the scenario: 1.5 um, k = 2, both sides of the difference
            self.assertAlmostEqual(np.sqrt((one.sigma ** 2).mean()), 0.75 * np.sqrt(2.0), delta=0.15)

    def test_a_case_without_strategy_stands_out_where_the_nominal_one_is_left_out(self):
        with results.open_result(self.block) as run:
            looks = parts.looks_of(run, ["as_it_is", "compensated"])
            self.assertEqual((looks["as_it_is"].colour, looks["as_it_is"].line), (style.BLACK, "-"))
            self.assertNotEqual(style.look_of(run, "as_it_is").colour, style.BLACK)   # beside the nominal one
        figure = self.drawn_of(self.block, parts.draw_plan)
        arrows = [style.matplotlib.colors.to_hex(ax.collections[0].get_facecolor()[0]) for ax in figure.axes[1:]]
        self.assertEqual(arrows, [style.BLACK, style.PURPLE])
        self.assertNotIn(parts.PALE, arrows)    # nominal places

    def test_points_that_met_nothing_are_marked_and_counted(self):
        with results.open_result(self.missed) as run:
            nominal = {name: cases["nominal"].nominal for name, cases in parts.probed(run).items()}
        at = {name: [tuple(nominal[name][n][:2]) for n in points] for name, points in self.LOST["as_it_is"].items()}

        figure = self.drawn_of(self.missed, parts.draw_plan)
        strip, as_it_is, compensated = figure.axes
        self.assertEqual([text.get_text() for text in strip.get_legend().texts], ["nominal place", "met nothing"])
        self.assertEqual(as_it_is.get_title(loc="left"), "as it is, 3 of 124 points missed")
        self.assertEqual(compensated.get_title(loc="left"), "compensated, 1 of 124 points missed")
        self.assertEqual(sorted(self.crosses(as_it_is)[style.BLACK]), sorted(at["front"] + at["notch"]))

        figure = self.drawn_of(self.missed, parts.draw_deviations)
        front = figure.axes[1]
        self.assertEqual(front.get_title(loc="left"), "front, minus nominal   as it is: 2 of 41 points missed   "
                         "compensated: 1 of 41 points missed")
        self.assertEqual({colour: len(places) for colour, places in self.crosses(front).items()},
                         {style.BLACK: 2, style.PURPLE: 1})
        self.assertRegex(figure.axes[-1].get_xlabel(), "crosses below: nothing met")

        figure = self.drawn_of(self.missed, parts.draw_planes)
        self.assertEqual(figure.axes[0].get_title(loc="left"), "top, as it is, 1 of 33 points missed")
        self.assertEqual(self.crosses(figure.axes[0]), {style.MISSED.colour: at["top"]})
        self.assertEqual(self.crosses(figure.axes[1]), {})

    def test_the_scale_of_the_part_follows_from_its_deviations_and_is_reported(self):
        self.assertEqual(self.drawn_of(self.block, parts.draw_plan).texts[0].get_text(),
                         "Part from above, minus nominal, × 1000: up to 9.1 µm")
        larger = self.out / "larger.h5"
        shutil.copy(self.block, larger)
        with h5py.File(larger, "a") as file:
            for case in file["cases"].values():
                for probe in case["probes"].values():
                    probe["measured"][...] *= 10.0
        self.assertEqual(self.drawn_of(larger, parts.draw_plan).texts[0].get_text(),
                         "Part from above, minus nominal, × 100: up to 90.9 µm")

    def test_what_a_figure_leaves_out_is_reported(self):
        self.assertEqual([parts.not_shown(count, "case") for count in (0, 1, 2)],
                         ["", "; 1 more case not shown", "; 2 more cases not shown"])
        self.assertEqual(parts.largest_note(np.array([np.nan, -9.06, 1.0])), "up to 9.1 µm")
        self.assertEqual(parts.largest_note(np.array([np.nan])), "no point was met")

    def test_probed_points_of_a_notch_are_counted_where_they_are_lost(self):
        with results.open_result(self.missed) as run:
            (found,) = [probed_points.notches(run)["as_it_is"]]
            self.assertEqual(list(found.missed), [1])
            self.assertTrue(np.isfinite(found.displacement).all())     # of the points that are left
            self.assertEqual(probed_points.note(probed_points.notches(run)), "; crosses: probed, ±2σ; hollow: 1 missed")
        with results.open_result(self.block) as run:
            self.assertEqual(probed_points.note(probed_points.notches(run)), "; crosses: probed, ±2σ")


class Balls(WithFiles):
    """R-test and BK4."""

    def test_draw_the_shipped_scenarios(self):
        for name, figure, other in (("rtest", "nest", "ball_bar"), ("bk4", "ball_bar", "nest")):
            path = self.root / f"{name}.h5"
            servomill("run", HERE.parents[1] / f"scenarios/iso/{name}.toml", "-o", path, "-q", *FAST)
            done = plot(path, "-o", self.out, "--why")     # all, though the tip of an R-test stands
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertGreater((self.out / f"{name}-{figure}.png").stat().st_size, SMALLEST_PNG)
            self.assertIn(f"{other}: not drawn, the scenario asks for no ", done.stderr)
            self.assertIn("circular: not drawn, no section is one full circle\n", done.stderr)

    def test_angle_goes_once_around_the_circle_from_zero(self):
        turn = np.radians(np.arange(0.0, 361.0))
        tilted = np.column_stack([0.8 * np.cos(turn), np.sin(turn), -0.6 * np.cos(turn)])
        for sense in (1, -1):
            angle = balls._around(tilted[::sense] + [5.0, 6.0, 7.0], [5.0, 6.0, 7.0])
            np.testing.assert_allclose(angle, turn, atol=0.01)   # the mean of 361 points is off by one in 361


class OwnNames(WithFiles):
    """Figures of the paper, of scenarios with other names."""

    def texts(self, path, draw, cases=(), sections=()):
        """Headline and titles."""
        style.set_up()
        with results.open_result(path) as run:
            run.names = names.Names(names.parse(cases, names.CASES, "case"), names.parse(sections, names.SECTIONS, "section"))
            figure = draw(run)
        self.addCleanup(style.plt.close, figure)
        return figure.texts[0].get_text(), [text.get_text() for text in figure.axes[0].get_legend().texts]

    def test_a_renamed_run_gives_the_same_figures(self):
        renamed = self.out / "renamed.h5"
        shutil.copy(self.contour, renamed)
        with h5py.File(renamed, "a") as file:
            file.move("cases/generated", "cases/as_built")
            file.move("cases/compensated", "cases/corrected")
            file.move("cases/nominal", "cases/ideal")
            scenario = str(file["inputs"].attrs["resolved"])
            for name, own in (("generated", "as_built"), ("compensated", "corrected"), ("nominal", "ideal")):
                scenario = scenario.replace(f'"{name}"', f'"{own}"')
            file["inputs"].attrs["resolved"] = scenario
            for case in file["cases"].values():
                case.attrs["sections"] = str(case.attrs["sections"]).replace("plane", "deck").replace("circle", "hole")
        mine = ["--case", "nominal=ideal", "--case", "generated=as_built", "--case", "compensated=corrected",
                "--section", "plane=deck", "--section", "circle=hole"]
        done = plot(renamed, "-o", self.out / "mine", "--figures", "figure14,figure15", *mine)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        with results.open_result(self.contour) as paper, results.open_result(renamed) as own:
            own.names = names.Names(dict(one.split("=") for one in mine[1:6:2]), dict(one.split("=") for one in mine[7::2]))
            for sections in (volumetric.CONTOURS, volumetric.PLANE):
                _, expected = volumetric.differences(paper, sections)
                _, found = volumetric.differences(own, sections)
                np.testing.assert_array_equal(found["as_built"][2], expected["generated"][2])

    def test_another_section_along_x(self):
        with results.open_result(self.side) as run:
            run.names = names.Names(sections={"flank": "plane"})
            found = {one.case.name: one.largest() for one in straightness.tracks(run, "Z", "flank")}
            run.names = names.Names()
            self.assertEqual(found, {one.case.name: one.largest() for one in straightness.tracks(run, "Z", "plane")})

    def test_headlines_name_what_is_drawn(self):
        headline, legend = self.texts(self.side, volumetric.draw_plane, ["generated=table", "compensated=gcode"], ["plane=flank"])
        self.assertRegex(headline, r"^flank: up to [\d.]+ µm in an axis \(table\), [\d.]+ µm in an axis \(G-code\)$")
        self.assertEqual(legend, ["nominal", "table", "G-code"])

    def test_names_that_do_not_exist(self):
        side = self.side
        self.fails(f"{side}: error: figure9: no feed motion in a section named flnk; did you mean flank?",
                   side, "--figures", "figure9", "--section", "flank=flnk")
        self.fails(f"{side}: error: figure9: no feed motion in a section named wall; --section flank=NAME draws another",
                   side, "--figures", "figure9", "--section", "flank=wall")
        self.fails(f"{side}: error: figure14: no case named tabel; did you mean table?",
                   side, "--figures", "figure14", "--case", "generated=tabel")
        self.fails("plot.py: error: --section flnk=flank: no figure is about a section named flnk; did you mean flank?",
                   side, "--section", "flnk=flank")
        self.fails("plot.py: error: --case table: must be NAME=YOURS, NAME one of nominal, generated, compensated, "
                   "compensated_lead, nominal_air, generated_air, compensated_air", side, "--case", "table")
        self.fails("plot.py: error: --case lists generated twice: table and gcode",
                   side, "--case", "generated=table", "--case", "generated=gcode")


class LongRecordings(unittest.TestCase):
    """Of a recording with many rows few are held; 10 000 stand for many here, in blocks of 1000."""

    ROWS, MOST = 10_000, 600

    def setUp(self):
        self.enterContext(unittest.mock.patch.object(rows, "BLOCK", 1000))
        chance = np.random.default_rng(1)
        file = self.file = self.enterContext(h5py.File("rows.h5", "w", driver="core", backing_store=False))
        step = chance.uniform(0.0, 0.02, self.ROWS)
        step[3950:4050] = 0.0   # the tool stands over the end of a block
        file["s"] = np.cumsum(step)
        file["contour_error"] = np.abs(chance.normal(size=self.ROWS))
        file["tool_deviation"] = chance.normal(size=(self.ROWS, 3))
        file["rapid"] = np.zeros(self.ROWS)
        file["rapid"][7000:7003] = 1.0
        file["section"] = np.zeros(self.ROWS, dtype=np.int32)
        file["section"][2000:2200] = 1    # a circle, say
        file["section"][5000:9000] = 2

    def test_few_rows_are_held_with_the_peaks_of_all(self):
        kept = rows.kept_rows(self.file, self.MOST)
        self.assertLess(len(kept), self.MOST)
        self.assertTrue((np.diff(kept) > 0).all())
        for name, column in (("contour_error", None), *(("tool_deviation", k) for k in range(3))):
            every = self.file[name][:] if column is None else self.file[name][:, column]
            some = rows.read(self.file[name], kept, column)
            self.assertEqual((some.min(), some.max()), (every.min(), every.max()), name)
            self.assertEqual(list(some), list(every[kept]))

    def test_short_sections_and_rapid_moves_are_there_as_a_whole(self):
        kept = set(rows.kept_rows(self.file, self.MOST))
        self.assertLessEqual(set(range(2000, 2200)), kept)
        self.assertLessEqual({0, 1999, 4999, 5000, 6999, 7000, 7002, 7003, 9999}, kept)

    def test_a_short_recording_is_held_as_it_is(self):
        self.assertIsNone(rows.kept_rows(self.file, self.ROWS))
        self.assertEqual(rows.read(self.file["tool_deviation"], None, 1).shape, (self.ROWS,))

    def test_another_case_is_read_between_all_of_its_rows(self):
        s, values = self.file["s"][:], self.file["tool_deviation"][:, 2]
        places = np.concatenate([np.linspace(-1.0, s[-1] + 1.0, 777), s[[0, 999, 1000, 3999, 4000, 4001, 9999]]])
        self.assertEqual(list(rows.values_along(self.file["s"], self.file["tool_deviation"], 2, places)),
                         list(rows.interpolated(s, values, places)))


class Headlines(unittest.TestCase):
    def test_one_case_is_reported_once(self):
        looks = {name: style.Look(name, style.BLACK) for name in ("plain", "exact")}
        self.assertEqual(five_axis.peaks_text({"plain": 2.5}, "plain", looks), "2.5 µm (plain)")
        self.assertEqual(five_axis.peaks_text({"plain": 2.5, "exact": 0.125}, "plain", looks), "2.5 µm (plain), 0.12 µm (exact)")

    def message(self, **delays):
        class Sweep:
            scenario = {"case": [{"name": name} for name in delays]}
            strategies = results.ResultFile.strategies

        return lag._message(Sweep(), {(name, "Y"): {"value": np.array(values)} for name, values in delays.items()})

    def test_a_delay_that_varies_is_reported_with_its_range(self):
        self.assertEqual(self.message(table=[40.0, 40.2], gcode=[0.3, 0.2]),
                         "The delay is the same at every feed within 1 %: table 40.1 ms")
        self.assertEqual(self.message(table=[40.0, 40.2], gcode=[-0.4, 4.2]),
                         "Delay the same at every feed within 1 %: table 40.1 ms; not of G-code −0.4 to 4.2 ms")
        self.assertEqual(self.message(gcode=[-4.0, 4.0]), "Delay over the feed: G-code −4.0 to 4.0 ms")
        self.assertEqual(self.message(gcode=[0.1, np.nan]), "Lag against feed")
