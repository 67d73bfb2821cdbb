#!/usr/bin/python3
"""tools/plot.py draws what a result file holds, agrees with `servomill compare`, and says what is
wrong with a file in one line. Usage: plot_test.py SERVOMILL"""
import contextlib
import dataclasses
import io
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import types
import unittest
import unittest.mock

HERE = pathlib.Path(__file__).resolve().parent
PLOT = HERE.parents[1] / "tools" / "plot.py"
sys.path.insert(0, str(PLOT.parent))

import h5py
import numpy as np
from PIL import Image

import plot as program
from figures import balls, circular, five_axis, lag, names, nonlinear, notches, parts, probed_points, results, rows, straightness, style, sweeps, volumetric

SERVOMILL = ""
AGREE = 1e-7        # um; `compare` prints nine digits of up to 100 um
AT_OTHER_PLACES = 5e-3  # um; between samples 1 um apart, about corners between locations
SMALLEST_PNG = 5000  # bytes; empty axes of these sizes stay below


def servomill(*arguments, status=0):
    done = subprocess.run([SERVOMILL, *map(str, arguments)], capture_output=True, text=True)
    assert status in (None, done.returncode), done.stderr
    return done.stdout


def plot(*arguments):
    """Runs the program within this process: its exit status and what it prints."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        status = program.run(program.main, [str(one) for one in arguments])
    return types.SimpleNamespace(returncode=status, stdout=out.getvalue(), stderr=err.getvalue())


def setUpModule():
    """Result files that all tests share."""
    WithFiles.folder = tempfile.TemporaryDirectory()
    root = WithFiles.root = pathlib.Path(WithFiles.folder.name)
    side, contour = HERE / "side_and_contour.toml", HERE / "generated_and_compensated.toml"
    for name in ("side", "contour", "sweep", "stopped", "none"):
        setattr(WithFiles, name, root / f"{name}.h5")
    limit = "machine_override.nc.following_error_limit_mm="
    servomill("run", side, "-o", WithFiles.side)
    servomill("run", contour, "-o", WithFiles.contour)
    servomill("sweep", side, "-o", WithFiles.sweep)
    servomill("run", side, "-o", WithFiles.stopped, "--set", limit + "0.04", status=1)
    servomill("run", side, "-o", WithFiles.none, "--set", limit + "0.0005", status=1)


def tearDownModule():
    WithFiles.folder.cleanup()


class WithFiles(unittest.TestCase):
    """Each test has a folder of its own for what it draws."""

    def setUp(self):
        self.out = pathlib.Path(tempfile.mkdtemp(dir=self.root))

    def drawn(self):
        return sorted(path.name for path in self.out.iterdir())

    def fails(self, message, *arguments):
        """One line of error, exit status 2, nothing written."""
        done = plot(*arguments, "-o", self.out)
        self.assertEqual(done.stderr, message + "\n")
        self.assertEqual(done.stdout, "")
        self.assertEqual(done.returncode, 2)
        self.assertEqual(self.drawn(), [])


class Servo(WithFiles):
    """Frequency and step responses."""

    def test_draws_what_the_file_holds(self):
        bode, step = self.out / "y.h5", self.out / "z.h5"
        few = ["--points", 5, "--from", 10, "-q"]
        servomill("bode", HERE / "side_and_contour.toml", "--axis", "Y,B", "--loop", "all", *few, "-o", bode)
        servomill("step", HERE / "side_and_contour.toml", "--axis", "Z", "-q", "-o", step)
        done = plot(bode, step, "-o", self.out / "figures")
        self.assertEqual(done.returncode, 0, done.stderr)
        drawn = sorted(path.name for path in (self.out / "figures").iterdir())
        self.assertEqual(drawn, ["y-compliance.png", "y-position.png", "y-velocity.png", "z-step.png"])
        for name in drawn:
            self.assertGreater((self.out / "figures" / name).stat().st_size, SMALLEST_PNG)

    def test_draws_error_budgets_that_add_up(self):
        budget = self.out / "b.h5"
        printed = servomill("budget", HERE / "side_and_contour.toml", "--json", "-o", budget, "--axis", "Y",
                            "--case", "table", "--case", "gcode")
        done = plot(budget, "-o", self.out / "figures")
        self.assertEqual(done.returncode, 0, done.stderr)
        drawn = self.out / "figures" / "b-budget.png"
        self.assertGreater(drawn.stat().st_size, SMALLEST_PNG)
        with results.open_result(budget) as file:
            said = [json.loads(line) for line in printed.splitlines()]
            self.assertEqual([(one.case, one.sections) for one in file.budgets],
                             [(line["case"], line["sections"]) for line in said])
            self.assertEqual({one.case for one in file.budgets}, {"table", "gcode"})
            for one, line in zip(file.budgets, said):
                self.assertEqual({part.name for part in one.parts}, set(line["parts"]))
                total = sum(part.signal for part in one.parts) + one.remainder.signal
                self.assertLess(np.abs(total - one.residual.signal).max(), AGREE)
                at = np.abs(one.residual.signal).argmax()
                self.assertEqual(one.s[at], one.place)
                for part in one.parts:
                    self.assertEqual(part.signal[at], part.at_place)
                    self.assertAlmostEqual(line["parts"][part.name]["at_place"], part.at_place, 6)

    def test_measured_is_exact_where_the_encoder_resolves_it(self):
        path = self.out / "y.h5"
        servomill("bode", HERE / "side_and_contour.toml", "--axis", "Y", "--points", 4, "--from", 5, "--to", 100, "-q",
                  "-o", path)
        with results.open_result(path) as responses:
            curve = responses.axes["Y"]["position_closed"]
            f = curve["measured_frequency"][:]
            exact = np.interp(np.log(f), np.log(curve["frequency"][:]), curve["magnitude"][:])
            np.testing.assert_allclose(curve["measured_magnitude"][:], exact, rtol=0.01)

    def test_a_loop_that_is_not_there(self):
        path = self.root / "velocity_only.h5"
        servomill("bode", HERE / "side_and_contour.toml", "--axis", "Y", "--loop", "velocity", "--method", "none", "-q",
                  "-o", path)
        self.fails(f"{path}: error: position: the file holds no position loop", path, "--figures", "position")


class Agreement(WithFiles):
    """The numbers behind the figures are those that `servomill compare` prints."""

    def rows(self, path, quantity):
        lines = servomill("compare", path, "--json").splitlines()
        return [row for row in map(json.loads, lines) if row["quantity"] == quantity]

    def test_largest_residuals_of_figures_9_10_and_11(self):
        with results.Run(self.side) as run:
            mine = {}
            for axis, section in (("Y", "flank"), ("Z", "plane")):
                for one in straightness.tracks(run, axis, section):
                    mine[one.case.name, axis] = one.largest()
            for case, one in zip(run.others(), notches.notches(run)):
                mine[case.name, "X"] = one.largest()
        rows = self.rows(self.side, "imposed_curve_residual")
        self.assertEqual(len(rows), 9)
        for row in rows:
            self.assertAlmostEqual(mine[row["case"], row["axis"]], row["value"], delta=AGREE)

    def test_difference_over_the_whole_path(self):
        with results.Run(self.side) as run:
            for row in self.rows(self.side, "trajectory_difference"):
                case = run.cases[row["case"]]
                d = results.trajectory_difference(case, run.base(), row["axis"], case.samples())
                self.assertAlmostEqual(np.abs(d).max(), row["value"], delta=AGREE)

    def test_differences_of_figure_15(self):
        with results.Run(self.contour) as run:
            _, found = volumetric.differences(run, volumetric.PLANE)
            for row in self.rows(self.contour, "trajectory_difference"):
                self.assertAlmostEqual(np.nanmax(np.abs(found[row["case"]][2][:, 2])),
                                       row["value"], delta=AGREE)

    def test_radial_deviations_of_the_circle(self):
        with results.Run(self.side) as run:
            turns = circular.turns_of(run)
        for quantity, extreme in (("radial_deviation_max", np.max), ("radial_deviation_min", np.min)):
            rows = self.rows(self.side, quantity)
            self.assertEqual(len(rows), 4)
            for row in rows:
                (turn,) = turns[row["case"]]
                self.assertEqual((turn.label, turn.plane), ("circle", "XY"))
                self.assertAlmostEqual(extreme(turn.dr), row["value"], delta=AGREE)

    def test_circles_of_one_direction_show_no_other_and_no_empty_table(self):
        for draw in (circular.draw, circular.draw_reversals):
            with results.Run(self.side) as run:
                figure = draw(run)
            self.addCleanup(style.plt.close, figure)
            labels = [text.get_text() for text in figure.axes[0].get_legend().texts]
            self.assertEqual(labels, ["circle", "cw"])
            self.assertNotIn("G(b), µm", [text.get_text() for ax in figure.axes for text in ax.texts])

    def test_divisions_are_round_and_two_hold_the_largest_deviation(self):
        for largest, unit in ((0.29, 0.2), (25.3, 20.0), (2.0, 1.0), (4.1, 5.0), (100.0, 50.0)):
            self.assertAlmostEqual(circular.division(largest), unit)

    def test_cases_that_can_be_compared_share_the_coarser_division(self):
        largest = {"none": 0.29, "filter": 1.5, "friction": 21.9, "compensated": 6.3, "mismatch": 117.0}
        self.assertEqual({case: float(f"{unit:.6g}") for case, unit in circular.divisions(largest).items()},
                         {"none": 0.2, "filter": 1.0, "friction": 20.0, "compensated": 20.0, "mismatch": 100.0})

    def test_angles_behind_a_reversal_follow_the_direction(self):
        theta = np.array([80.0, 89.0, 92.0, 100.0, 500.0])
        for sense, place in ((1, [-10.0, -1.0, 2.0, 10.0]), (-1, [-10.0, -2.0, 1.0, 10.0])):
            turn = circular.Turn("", "", "XY", sense, 50.0, theta, theta, theta)
            behind, form = circular.around_reversal(turn, 90.0)
            self.assertEqual(list(behind), place)
            self.assertEqual(list(form), [90.0 + sense * one for one in place])

    def test_base_is_read_between_its_samples_and_held_beyond_its_ends(self):
        class Base:
            @staticmethod
            def column(_):
                return np.array([0.0, 1.0, 1.0, 3.0])

        values = np.array([10.0, 20.0, 30.0, 50.0])
        at = np.array([-1.0, 0.0, 0.5, 1.0, 2.0, 3.0, 4.0])
        self.assertEqual(list(rows.along_path(Base, values, at)),
                         [10.0, 10.0, 15.0, 30.0, 40.0, 50.0, 50.0])

    def test_magnification_is_round_and_as_large_as_fits(self):
        for extent, largest, factor in ((100.0, 8.0, 1000), (100.0, 8.1, 500), (100.0, 1.5, 5000)):
            self.assertEqual(volumetric.magnification(extent, largest, share=0.08), factor)

    def test_feed_of_a_sweep_is_that_of_the_program(self):
        with results.Sweep(self.sweep) as sweep:
            feed, label = lag.feeds(sweep)
        self.assertEqual((list(feed), label), ([1500.0, 3000.0], "feed, mm/min"))

    def test_thinning_for_the_picture_keeps_the_peaks(self):
        x, y = np.arange(100_000.0), np.zeros(100_000)
        y[54_321], y[77_777] = 5.0, -3.0
        shown = style.thin(x, y)
        self.assertLess(len(shown[0]), 10_000)
        self.assertEqual((shown[1].max(), shown[1].min()), (5.0, -3.0))
        self.assertEqual(shown[0][shown[1].argmax()], 54_321.0)


class Looks(WithFiles):
    def test_a_case_takes_the_look_of_its_name_or_of_its_last_strategy(self):
        class File:
            scenario = {"case": [
                {"name": "north", "strategy": [{"type": "gcode"}, {"type": "feedback"}]},
                {"name": "east", "strategy": [{"type": "feedback", "lead_ms": "auto"}]},
                {"name": "plain", "strategy": [{"type": "none"}]},
                {"name": "table", "strategy": [{"type": "gcode"}]}]}
            strategies = results.ResultFile.strategies

        for case, colour in (("north", style.PURPLE), ("east", style.LIGHT_PURPLE),
                             ("plain", style.BLACK), ("table", style.BLUE)):
            self.assertEqual(style.look_of(File(), case).colour, colour, case)

    def test_cases_with_one_strategy_differ_in_line_and_shade(self):
        class File:
            scenario = {"case": [{"name": n, "strategy": [{"type": "none"}]} for n in "abcd"]}
            strategies = results.ResultFile.strategies

        looks = [style.look_of(File(), case) for case in "abcd"]
        self.assertEqual(looks[0].colour, style.BLACK)
        self.assertEqual(len({look.colour for look in looks}), 4)
        self.assertEqual(len({look.line for look in looks}), 4)

    def test_cases_that_are_not_shown_change_no_look(self):
        class File:
            scenario = {"case": [{"name": n, "strategy": [{"type": "none"}]} for n in "abc"]}
            strategies = results.ResultFile.strategies

        self.assertEqual(style.look_of(File(), "b", "bc").colour, style.BLACK)
        self.assertEqual(style.look_of(File(), "c", "bc"), dataclasses.replace(style.look_of(File(), "b"), label="c"))

    def test_strategies_differ_in_grey_or_in_line(self):
        shown = [style.LOOKS[name] for name in ("nominal", "table", "feedback", "feedback_lead",
                                                "gcode")]

        def grey(look):
            r, g, b = (int(look.colour[i:i + 2], 16) for i in (1, 3, 5))
            return 0.299 * r + 0.587 * g + 0.114 * b

        for i, one in enumerate(shown):
            for other in shown[:i]:
                self.assertTrue(abs(grey(one) - grey(other)) > 20 or one.line != other.line,
                                f"{one.label} and {other.label}")

    def test_cases_are_called_alike_in_all_figures(self):
        class File:
            scenario = {"case": [{"name": "none", "strategy": [{"type": "none"}]},
                                 {"name": "gcode_ideal", "strategy": [{"type": "gcode"}]}]}
            strategies = results.ResultFile.strategies

        self.assertEqual([style.look_of(File(), one).label for one in ("none", "nominal", "gcode_ideal")],
                         ["uncompensated", "nominal", "G-code ideal"])

    def test_a_legend_takes_as_many_lines_as_it_needs(self):
        def looks(label, count):
            return [style.Look(label, style.BLACK)] * count

        self.assertEqual(style.legend_shape(looks("table", 4), 9.6), (4, 1))
        self.assertEqual(style.legend_shape(looks("feedback with lead", 8), 9.6), (4, 2))
        self.assertEqual(style.legend_shape(looks("a name as long as it gets, and then some", 2), 3.0), (1, 2))

    def test_envelope_is_the_largest_of_three_pieces(self):
        s = np.linspace(0.0, 10.0, 1001)
        ripple = np.abs(np.sin(40.0 * s))
        ripple[550] = 7.0
        at, largest = five_axis.envelope(s, ripple, 1.0)
        self.assertEqual((at[0], at[-1], largest.max()), (0.0, 10.0, 7.0))
        np.testing.assert_allclose(at[largest == 7.0], [4.5, 5.5, 6.5], atol=0.02)
        self.assertGreater(largest.min(), 0.99)


class Pictures(WithFiles):
    PALETTE_TOL = 16   # of 255: colours of a few points and of a bar of colours are still told apart

    def test_a_palette_leaves_rare_colours_what_they_are(self):
        style.set_up()
        figure, ax = style.plt.subplots()
        self.addCleanup(style.plt.close, figure)
        ax.scatter(range(9), range(9), c=np.linspace(-1.0, 1.0, 9), cmap="RdBu_r", s=9)
        for look in style.LOOKS.values():
            ax.plot([0.0, 1.0], [8.0, 8.0], color=look.colour)
        figure.colorbar(style.matplotlib.cm.ScalarMappable(cmap="RdBu_r"), ax=ax)
        program.save(figure, self.out / "palette.png", "png")
        drawn = np.asarray(figure.canvas.buffer_rgba())[:, :, :3].astype(int)
        with Image.open(self.out / "palette.png") as picture:
            self.assertEqual(picture.mode, "P")
            saved = np.asarray(picture.convert("RGB")).astype(int)
        self.assertLess(np.abs(saved - drawn).max(), self.PALETTE_TOL)
        colours, counts = np.unique(drawn.reshape(-1, 3), axis=0, return_counts=True)
        common = colours[np.argsort(counts)[-3:]]     # paper, grid, frame
        for colour in common:
            self.assertTrue((saved[(drawn == colour).all(axis=2)] == colour).all(), colour)


class Drawing(WithFiles):
    def test_all_that_a_run_holds_is_drawn_and_the_rest_counted(self):
        done = plot(self.side, "-o", self.out)
        self.assertEqual((done.returncode, done.stderr),
                         (0, "16 other figures would need what the file does not hold; see --why\n"))
        self.assertEqual(len(self.drawn()), 7)

    def test_of_several_files_each_is_counted(self):
        done = plot(self.side, self.sweep, "-o", self.out)
        self.assertEqual((done.returncode, done.stderr.splitlines()), (0, [
            f"{self.side}: 16 other figures would need what the file does not hold; see --why",
            f"{self.sweep}: 2 other figures would need what the file does not hold; see --why"]))

    def test_all_that_a_run_holds_is_drawn_and_the_rest_explained_where_one_asks(self):
        done = plot(self.side, "-o", self.out, "--why")
        self.assertEqual(done.returncode, 0, done.stderr)
        names = ["circular", "deviations", "figure10", "figure11", "figure6", "figure9",
                 "reversals"]
        self.assertEqual(self.drawn(), [f"side-{name}.png" for name in names])
        self.assertEqual(done.stderr.splitlines(), [
            "figure12: not drawn, no error functions of Z",
            "figure14: not drawn, no case named generated; --case generated=NAME draws another",
            "figure15: not drawn, no case named generated; --case generated=NAME draws another",
            *(f"figure{n}: not drawn, no finished case named generated, compensated; --case generated=NAME draws another"
              for n in (16, 17, 18, 19)),
            *(f"{name}: not drawn, no part was probed ([[probe]] of the scenario)"
              for name in ("probed", "part", "planes")),
            "nest: not drawn, the scenario asks for no radial_ball_deviation",
            "ball_bar: not drawn, the scenario asks for no ball_bar_deviation",
            *(f"li_{n}: not drawn, needs a case without strategy and one with the strategy exact"
              for n in ("3_2", "3_3", "4_1")),
            "five_axis: not drawn, the tool axis does not turn"])
        self.assertEqual(sorted(done.stdout.split()), sorted(str(p) for p in self.out.iterdir()))
        for path in self.out.iterdir():
            self.assertGreater(path.stat().st_size, SMALLEST_PNG, path)
        with Image.open(self.out / "side-figure9.png") as picture:
            self.assertAlmostEqual(picture.info["dpi"][0], 150.0, delta=0.1)
            colours = {rgb for _, rgb in picture.convert("RGB").getcolors()}
        for name in ("nominal", "table", "feedback", "gcode"):
            rgb = [int(style.LOOKS[name].colour[i:i + 2], 16) for i in (1, 3, 5)]
            nearest = min(max(abs(a - b) for a, b in zip(rgb, other)) for other in colours)
            self.assertLess(nearest, 16, name)     # of 255; the palette rounds

    def test_experiment_2_is_drawn(self):
        done = plot(self.contour, "-o", self.out, "--figures", "figure12,figure14,figure15")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertEqual(len(self.drawn()), 3)
        for path in self.out.iterdir():
            self.assertGreater(path.stat().st_size, SMALLEST_PNG, path)

    def test_nonlinear_errors_are_drawn_and_agree_with_compare(self):
        path = self.out / "table32.h5"
        servomill("run", HERE.parents[1] / "scenarios" / "li2024" / "table32.toml", "-o", path)
        rows = [json.loads(line) for line in servomill("compare", path, "--json").splitlines()]
        with results.open_result(path) as run:
            segments = nonlinear.Segments(run)
            for row in rows:
                if row["quantity"] == "tool_difference":
                    error = np.linalg.norm(segments.tip_error(run.cases[row["case"]]), axis=1).max()
                    self.assertAlmostEqual(error, row["value"], delta=AT_OTHER_PLACES)
        done = plot(path, "-o", self.out, "--figures", "li_3_2,li_3_3,li_4_1")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        for one in done.stdout.split():
            self.assertGreater(pathlib.Path(one).stat().st_size, SMALLEST_PNG, one)

    def test_a_sweep_gives_lag_against_feed_in_every_format_reproducibly(self):
        for folder, formats in (("first", "png,svg,pdf"), ("again", "png,svg")):
            done = plot(self.sweep, "-o", self.out / folder, "--format", formats)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual(len(done.stdout.splitlines()), 2 * len(formats.split(",")))   # lag, curves
        first, again = self.out / "first", self.out / "again"
        for name in ("sweep-lag.png", "sweep-lag.svg", "sweep-curves.png", "sweep-curves.svg"):
            self.assertEqual((first / name).read_bytes(), (again / name).read_bytes(), name)
        self.assertTrue((first / "sweep-lag.pdf").read_bytes().startswith(b"%PDF"))
        self.assertIn("response time, ms", (first / "sweep-lag.svg").read_text())

    def sweep_of(self, name, table):
        path = self.out / name
        servomill("sweep", HERE.parent / "cli" / "gallery" / "scenario.toml", "-q", "-o", path, "--set", f"sweep={{{table}}}",
                  status=None)
        return path

    def test_two_parameters_give_maps(self):
        path = self.sweep_of("two.h5", 'program.feed_override=[1.0,2.0,3.0],case.table.strategy.entry='
                                       '["position_command","feed_forward"]')
        with results.open_result(path) as sweep:
            feed, entry = (next(one for one in sweep.parameters if part in one.key) for part in ("feed", "entry"))
            value = sweep.quantities[0]["value"]
            picture = sweeps.as_picture(feed, entry, value)
            self.assertEqual(entry.texts, ("position_command", "feed_forward"))
            for x, y, one in zip(feed.values, entry.values, value):
                self.assertEqual(picture[int(y), int(x) - 1], one)
        done = plot(path, "-o", self.out, "--format", "svg", "--figures", "maps")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        drawn = (self.out / "two-maps.svg").read_text()
        for text in ("feed_forward", "program.feed_override", "imposed curve residual"):
            self.assertIn(text, drawn)

    def test_one_number_and_texts_give_curves(self):
        path = self.sweep_of("text.h5", 'program.feed_override=[1.0,2.0,3.0],case.table.strategy.entry='
                                        '["position_command","feed_forward"]')
        done = plot(path, "-o", self.out, "--format", "svg", "--figures", "curves")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        drawn = (self.out / "text-curves.svg").read_text()
        self.assertIn("table, feed_forward", drawn)

    def test_parameters_that_go_together_are_one_and_further_ones_have_maps_of_their_own(self):
        path = self.sweep_of("three.h5", 'program.feed_override=[1.0,2.0],case.table.strategy.entry='
                                         '["position_command","feed_forward"],together=[{'
                                         'machine.axis.X.v_max=["20 m/min","30 m/min","40 m/min"],'
                                         'machine.axis.Y.v_max=["10 m/min","20 m/min","30 m/min"]}]')
        with results.open_result(path) as sweep:
            self.assertEqual([(one.key, one.others) for one in sweep.varied(sampled=False)],
                             [("program.feed_override", 0), ("case.table.strategy.entry", 0), ("machine.axis.X.v_max", 1)])
        done = plot(path, "-o", self.out, "--format", "svg", "--figures", "maps,curves")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        maps, curves = ((self.out / f"three-{name}.svg").read_text() for name in ("maps", "curves"))
        for text in ("table, position_command:", "table, feed_forward:", "machine.axis.X.v_max (and 1 more), m/min"):
            self.assertIn(text, maps)
        self.assertIn("table, feed_override 2, feed_forward", curves)

    def test_samples_give_clouds_and_histograms_and_say_what_failed(self):
        path = self.sweep_of("random.h5", 'samples={design="random",count=20},'
                                          'errors.imposed.EYX.harmonic.amplitude_um={normal=[100.0,10.0]},'
                                          'case.table.strategy.response_time_ms={normal=[10.0,10.0]}')
        with results.open_result(path) as sweep:
            self.assertEqual([one.sampled for one in sweep.parameters], [True, True])
            lost = np.count_nonzero(~sweep.done)
            self.assertGreater(lost, 0)
        done = plot(path, "-o", self.out, "--format", "svg,png", "--figures", "samples")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        drawn = (self.out / "random-samples.svg").read_text()
        self.assertIn("harmonic.amplitude_um", drawn)
        self.assertIn(f"{lost} of 20 points not done", drawn)
        self.fails(f"{path}: error: curves: the sweep samples its parameters", path, "--figures", "curves")

    def fails(self, message, *arguments):
        done = plot(*arguments, "-o", self.out)
        self.assertEqual((done.stderr, done.stdout, done.returncode), (message + "\n", "", 2))

    def test_a_case_that_stopped_is_shown_over_time_and_left_out_of_comparisons(self):
        done = plot(self.stopped, "-o", self.out, "--format", "svg",
                    "--figures", "figure9,deviations")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stderr, r"^case feedback stopped \(.*following error.*\); "
                                      r"it is drawn over time only\n$")
        self.assertIn("(stopped: feedback)", (self.out / "stopped-deviations.svg").read_text())
        self.assertNotIn(">feedback<", (self.out / "stopped-figure9.svg").read_text())

    def test_a_run_where_all_stopped_still_shows_what_happened(self):
        done = plot(self.none, "-o", self.out, "--format", "svg", "--figures", "deviations")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(self.drawn(), ["none-deviations.svg"])
        done = plot(self.none, "-o", self.out, "--figures", "figure9")
        self.assertEqual((done.returncode, done.stderr.splitlines()[-1]), (
            2, f"{self.none}: error: figure9: case nominal, which the others are compared with, "
            "stopped"))

    def test_nothing_is_overwritten_without_force(self):
        arguments = (self.sweep, "-o", self.out, "--figures", "lag")
        file = self.out / "sweep-lag.png"
        file.write_bytes(b"mine")
        done = plot(*arguments)
        self.assertEqual((done.returncode, done.stderr, file.read_bytes()),
                         (2, f"{file}: error: exists; use --force to overwrite\n", b"mine"))
        self.assertEqual(plot(*arguments, "--force").returncode, 0)
        self.assertGreater(file.stat().st_size, SMALLEST_PNG)

    def test_several_files_at_once(self):
        done = plot(self.side, self.sweep, "-o", self.out, "--figures", "figure6,lag")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertEqual(self.drawn(), ["side-figure6.png", "sweep-lag.png"])

    def test_list_names_every_figure(self):
        done = subprocess.run([PLOT, "--list"], capture_output=True, text=True)
        self.assertEqual([line.split()[0] for line in done.stdout.splitlines()],
                         ["figure6", "figure9", "figure10", "figure11", "figure12", "figure14",
                          "figure15", "figure16", "figure17", "figure18", "figure19", "probed", "part", "planes", "lag", "curves", "maps", "samples", "circular", "reversals", "nest", "ball_bar",
                          "li_3_2", "li_3_3", "li_4_1",
                          "five_axis", "deviations", "position", "velocity",
                          "compliance", "compensated", "budget", "step"])


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
        rows = [json.loads(line) for line in servomill("compare", self.block, "--json").splitlines()]
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

    def test_the_scale_of_the_part_follows_from_its_deviations_and_is_told(self):
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

    def test_what_a_figure_leaves_out_is_told(self):
        self.assertEqual([parts.not_shown(count, "case") for count in (0, 1, 2)],
                         ["", "; 1 more case not shown", "; 2 more cases not shown"])
        self.assertEqual(parts.told_largest(np.array([np.nan, -9.06, 1.0])), "up to 9.1 µm")
        self.assertEqual(parts.told_largest(np.array([np.nan])), "no point was met")

    def test_probed_points_of_a_notch_are_counted_where_they_are_lost(self):
        with results.open_result(self.missed) as run:
            (found,) = [probed_points.notches(run)["as_it_is"]]
            self.assertEqual(list(found.missed), [1])
            self.assertTrue(np.isfinite(found.displacement).all())     # of the points that are left
            self.assertEqual(probed_points.told(probed_points.notches(run)), "; crosses: probed, ±2σ; hollow: 1 missed")
        with results.open_result(self.block) as run:
            self.assertEqual(probed_points.told(probed_points.notches(run)), "; crosses: probed, ±2σ")


class Balls(WithFiles):
    """R-test and BK4."""

    def test_draw_the_shipped_scenarios(self):
        for name, figure, other in (("rtest", "nest", "ball_bar"), ("bk4", "ball_bar", "nest")):
            path = self.root / f"{name}.h5"
            servomill("run", HERE.parents[1] / f"scenarios/iso/{name}.toml", "-o", path, "-q")
            done = plot(path, "-o", self.out, "--why")     # all, though the tip of an R-test stands
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertGreater((self.out / f"{name}-{figure}.png").stat().st_size, SMALLEST_PNG)
            self.assertIn(f"{other}: not drawn, the scenario asks for no ", done.stderr)
            self.assertIn("circular: not drawn, no section is one turn of a circle\n", done.stderr)

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
        self.fails("plot.py: error: --case names generated twice: table and gcode",
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
    def test_one_case_is_told_once(self):
        looks = {name: style.Look(name, style.BLACK) for name in ("plain", "exact")}
        self.assertEqual(five_axis.told_peaks({"plain": 2.5}, "plain", looks), "2.5 µm (plain)")
        self.assertEqual(five_axis.told_peaks({"plain": 2.5, "exact": 0.125}, "plain", looks), "2.5 µm (plain), 0.12 µm (exact)")

    def message(self, **delays):
        class Sweep:
            scenario = {"case": [{"name": name} for name in delays]}
            strategies = results.ResultFile.strategies

        return lag._message(Sweep(), {(name, "Y"): {"value": np.array(values)} for name, values in delays.items()})

    def test_a_delay_that_varies_is_told_with_its_range(self):
        self.assertEqual(self.message(table=[40.0, 40.2], gcode=[0.3, 0.2]),
                         "The delay is the same at every feed within 1 %: table 40.1 ms")
        self.assertEqual(self.message(table=[40.0, 40.2], gcode=[-0.4, 4.2]),
                         "Delay the same at every feed within 1 %: table 40.1 ms; not of G-code −0.4 to 4.2 ms")
        self.assertEqual(self.message(gcode=[-4.0, 4.0]), "Delay over the feed: G-code −4.0 to 4.0 ms")
        self.assertEqual(self.message(gcode=[0.1, np.nan]), "Lag against feed")


class OutputFiles(WithFiles):
    """-o with the name of a file."""

    def test_one_figure_into_a_file_of_that_name(self):
        for name, start in (("a.png", b"\x89PNG"), ("b.svg", b"<?xml"), ("new/c.PDF", b"%PDF")):
            path = self.out / name
            done = plot(self.side, "--figures", "figure6", "-o", path)
            self.assertEqual((done.returncode, done.stdout, done.stderr), (0, f"{path}\n", ""))
            self.assertTrue(path.read_bytes().startswith(start), name)
        done = plot(self.side, "--figures", "figure6", "-o", self.out / "a.png")
        self.assertEqual((done.returncode, done.stderr), (2, f"{self.out / 'a.png'}: error: exists; use --force to overwrite\n"))

    def refuses(self, message, target, *arguments):
        done = plot(*arguments, "-o", target)
        self.assertEqual((done.returncode, done.stdout, done.stderr), (2, "", f"{target}: error: {message}\n"))

    def test_what_cannot_be_one(self):
        self.refuses("holds one figure, not 2 (side-figure6, side-figure9); name one with --figures, or a folder with -o",
                     self.out / "a.png", self.side, "--figures", "figure6,figure9")
        self.refuses("ends in .png, but --format is svg", self.out / "a.png", self.side, "--format", "svg")
        self.refuses("figures are written as png, svg, pdf", self.out / "a.jpg", self.side)
        self.refuses(".txt is no format of figures; they are written as png, svg, pdf; make a folder of that name first",
                     self.out / "one.txt", self.side)
        self.refuses("is a file; figures go into a folder, or into a file that ends in .png, .svg, .pdf",
                     self.side, self.side, "--force")
        self.assertEqual(self.drawn(), [])
        before = self.side.read_bytes()
        alias = self.out / "alias.png"
        alias.symlink_to(self.side)
        self.refuses("is one of the files that are read", alias, self.side, "--figures", "figure6", "--force")
        self.assertEqual(self.side.read_bytes(), before)


class Mistakes(WithFiles):
    def test_a_figure_that_is_asked_for_and_not_held(self):
        self.fails(f"{self.side}: error: lag: the file holds a run, not a sweep", self.side, "--figures", "lag")
        self.fails(f"{self.contour}: error: figure9: the imposed errors are functions of X, Y, Z, "
                   "not of X alone", self.contour, "--figures", "figure9")
        self.fails(f"{self.side}: error: lag: the file holds a run, not a sweep\n"
                   f"{self.side}: error: nest: the scenario asks for no radial_ball_deviation", self.side, "--figures", "lag,nest")

    def test_of_several_figures_those_are_drawn_that_the_file_holds(self):
        done = plot(self.side, "-o", self.out, "--figures", "figure6,lag,nest")
        self.assertEqual((done.returncode, done.stderr.splitlines()), (0, [
            "lag: not drawn, the file holds a run, not a sweep",
            "nest: not drawn, the scenario asks for no radial_ball_deviation"]))
        self.assertEqual(self.drawn(), ["side-figure6.png"])

    def test_a_figure_that_fails_costs_no_other(self):
        def fail(_):
            raise np.linalg.LinAlgError("SVD did not converge")

        figures = [dataclasses.replace(one, draw=fail) if one.name == "figure9" else one for one in program.FIGURES]
        with unittest.mock.patch.object(program, "FIGURES", figures):
            done = plot(self.side, "-o", self.out, "--figures", "figure6,figure9")
            self.assertEqual((done.returncode, done.stderr), (
                0, "figure9: not drawn, drawing it failed (LinAlgError: SVD did not converge)\n"))
            self.assertEqual(self.drawn(), ["side-figure6.png"])
            done = plot(self.side, "-o", self.out / "all")
            self.assertEqual((done.returncode, done.stderr.splitlines()), (0, [   # a failure is told unasked
                "figure9: not drawn, drawing it failed (LinAlgError: SVD did not converge)",
                "16 other figures would need what the file does not hold; see --why"]))

    def test_a_file_that_cannot_be_read_costs_no_other(self):
        missing = self.root / "missing.h5"
        done = plot(missing, self.side, "-o", self.out, "--figures", "figure6")
        self.assertEqual((done.returncode, done.stderr), (2, f"{missing}: error: no such file\n"))
        self.assertEqual(self.drawn(), ["side-figure6.png"])

    def test_status_of_the_process(self):
        done = subprocess.run([PLOT, self.root / "missing.h5"], capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stdout), (2, ""))

    def test_files_whose_figures_would_have_the_same_name(self):
        self.fails("plot.py: error: two files are named side; draw them apart",
                   self.side, self.root / "elsewhere" / "side.h5")

    def test_names_that_do_not_exist(self):
        self.fails("plot.py: error: no figure is named figur9; did you mean figure9?",
                   self.side, "--figures", "figur9")
        self.fails("plot.py: error: no format is named jpeg; there are png, svg, pdf",
                   self.side, "--format", "jpeg")
        self.fails("plot.py: error: no result file is named; see plot.py --help")

    def test_files_that_are_not_results(self):
        missing, text, foreign, newer = (self.root / name for name in
                                         ("missing.h5", "text.h5", "foreign.h5", "newer.h5"))
        text.write_text("no HDF5\n")
        with h5py.File(foreign, "w") as file:
            file["data"] = 1.0
        shutil.copy(self.sweep, newer)
        with h5py.File(newer, "a") as file:
            file.attrs["schema_version"] = 99
        self.fails(f"{missing}: error: no such file", missing)
        self.fails(f"{text}: error: is not an HDF5 file", text)
        self.fails(f"{foreign}: error: is not a result file of servomill", foreign)
        self.fails(f"{newer}: error: has schema version 99; this program reads version 3", newer)

    def test_a_pipe_is_refused_at_once(self):
        pipe = self.root / "pipe.h5"
        os.mkfifo(pipe)
        done = subprocess.run([PLOT, pipe], capture_output=True, text=True, timeout=60)
        self.assertEqual((done.returncode, done.stdout, done.stderr),
                         (2, "", f"{pipe}: error: is no regular file; a result file of servomill is read from a disk\n"))

    def test_an_interrupt_ends_it_without_a_traceback(self):
        # an interrupt from a terminal goes to the whole group: the process that waits and the one that draws
        process = subprocess.Popen([PLOT, self.side, "-o", self.out, "--format", "png,svg,pdf"], start_new_session=True,
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        process.stdout.readline()   # it draws
        os.killpg(process.pid, signal.SIGINT)
        _, said = process.communicate(timeout=60)
        self.assertEqual((process.returncode, said.count("Traceback"), said.count("KeyboardInterrupt")), (130, 0, 0))

    def test_a_damaged_file(self):
        cut, hollow = self.root / "cut.h5", self.root / "hollow.h5"
        cut.write_bytes(self.side.read_bytes()[:100_000])
        done = plot(cut, "-o", self.out)
        self.assertEqual(done.returncode, 2)
        self.assertRegex(done.stderr, r"^\S+cut.h5: error: cannot be read as HDF5: .*\n$")
        shutil.copy(self.side, hollow)
        with h5py.File(hollow, "a") as file:
            del file["cases/table/servo/s"]
        self.fails(f"{hollow}: error: figure9: case table holds no s", hollow, "--figures", "figure9")

    def test_a_file_on_which_the_library_crashes(self):
        crash = ("import os, signal, sys; sys.path.insert(0, sys.argv.pop(1)); import plot; "
                 "plot.open_result = lambda file: os.kill(os.getpid(), signal.SIGSEGV); sys.exit(plot.run_apart(sys.argv[1:]))")
        done = subprocess.run([sys.executable, "-B", "-c", crash, PLOT.parent, self.side, "-o", self.out],
                              capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stdout, done.stderr),
                         (2, "", f"{self.side}: error: is damaged (reading it ended with SIGSEGV)\n"))
        done = subprocess.run([PLOT, self.side, "-o", self.out, "--figures", "figure6"], capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stdout, done.stderr), (0, f"{self.out}/side-figure6.png\n", ""))

    def test_files_that_lack_what_every_one_holds(self):
        def damaged(source, change):
            path = self.root / "damaged.h5"
            shutil.copy(source, path)
            with h5py.File(path, "a") as file:
                change(file)
            done = plot(path, "-o", self.out)
            self.assertEqual((done.returncode, done.stdout, self.drawn()), (2, "", []), done.stderr)
            return done.stderr.replace(str(path), "FILE")

        def set_version(file):
            file.attrs["schema_version"] = "one"

        def lose(name, attribute=None):
            def change(file):
                del (file[name].attrs if attribute else file)[attribute or name]
            return change

        self.assertRegex(damaged(self.side, set_version), r"^FILE: error: is damaged \(.*'one'.*\)\n$")
        self.assertRegex(damaged(self.side, lose("cases/table", "finished")), r"^FILE: error: is damaged \(.*finished.*\)\n$")
        self.assertRegex(damaged(self.side, lose("cases/table/servo")), r"^FILE: error: is damaged \(.*servo.*\)\n$")
        self.assertRegex(damaged(self.sweep, lose("sweep/program_feed_override", "key")),
                         r"^FILE: error: is damaged \(.*key.*\)\n$")


if __name__ == "__main__":
    SERVOMILL = sys.argv.pop(1)
    unittest.main(verbosity=1)
