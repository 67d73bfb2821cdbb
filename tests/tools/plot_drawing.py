"""Figures that tools/plot.py draws of runs and sweeps."""
import json
import pathlib

from plot_files import HERE, SMALLEST_PNG, WithFiles, plot, plot_names, program, servomill

import h5py
import numpy as np
from PIL import Image

from figures import lag, nonlinear, results, style, sweeps

AT_OTHER_PLACES = 5e-3  # um; between samples 1 um apart, about corners between locations


class Drawing(WithFiles):
    def test_all_that_a_run_holds_is_drawn_and_the_rest_counted(self):
        done = plot_names(self.side, "-o", self.out)
        self.assertEqual((done.returncode, done.stderr),
                         (0, "18 figures skipped: the file lacks their data (--why)\n"))
        self.assertEqual(len(self.drawn()), 7)

    def test_of_several_files_each_is_counted(self):
        done = plot_names(self.side, self.sweep, "-o", self.out)
        self.assertEqual((done.returncode, done.stderr.splitlines()), (0, [
            f"{self.side}: 18 figures skipped: the file lacks their data (--why)",
            f"{self.sweep}: 2 figures skipped: the file lacks their data (--why)"]))

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
            "five_axis: not drawn, the tool axis does not rotate",
            "inertia: not drawn, no finished case has a structure that gives way to acceleration (inertial_deflection)",
            "day: not drawn, no case of the file has a day"])
        self.assertEqual(sorted(done.stdout.split()), sorted(str(p) for p in self.out.iterdir()))
        for path in self.out.iterdir():
            self.assertGreater(path.stat().st_size, SMALLEST_PNG, path)
        done = plot(self.side, "-o", self.out / "fine", "--figures", "figure9", dpi=style.DPI)
        self.assertEqual(done.returncode, 0, done.stderr)
        with Image.open(self.out / "fine" / "side-figure9.png") as picture:
            self.assertAlmostEqual(picture.info["dpi"][0], 150.0, delta=0.1)
            colours = {rgb for _, rgb in picture.convert("RGB").getcolors()}
        for name in ("nominal", "table", "feedback", "gcode"):
            rgb = [int(style.LOOKS[name].colour[i:i + 2], 16) for i in (1, 3, 5)]
            nearest = min(max(abs(a - b) for a, b in zip(rgb, other)) for other in colours)
            self.assertLess(nearest, 16, name)     # of 255; the palette rounds

    def test_a_day_is_drawn_and_its_ranges_are_those_of_its_drift(self):
        path = self.out.parent / "environment.h5"
        scenario = HERE.parent.parent / "scenarios/thermal/environment.toml"
        servomill("run", scenario, "-o", path, "--force", "--quiet")
        done = plot(path, "-o", self.out, "--figures", "day")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertGreater((self.out / "environment-day.png").stat().st_size, SMALLEST_PNG)
        with h5py.File(path) as h5:
            day = h5["cases/machine/day"]
            hours, drift = day["time"][:], day["drift/right/X"][:]
            self.assertEqual(len(hours), 24 * 60 + 1)
            self.assertAlmostEqual(day["drift/right/range_X"][()], np.ptp(drift), places=9)
            self.assertAlmostEqual(day["drift/right/range_60min_X"][()], np.ptp(drift[hours <= 1.0]), places=9)
            self.assertLess(np.abs(day["temperature_bed"][:] - 21.0).max(), 3.5)

    def test_experiment_2_is_drawn(self):
        done = plot(self.contour, "-o", self.out, "--figures", "figure12,figure14,figure15")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertEqual(len(self.drawn()), 3)
        for path in self.out.iterdir():
            self.assertGreater(path.stat().st_size, SMALLEST_PNG, path)

    def test_nonlinear_errors_are_drawn_and_agree_with_compare(self):
        path = self.out / "table32.h5"
        servomill("run", HERE.parents[1] / "scenarios" / "li2024" / "table32.toml", "-o", path)
        rows = json.loads(servomill("compare", path, "--json"))
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
        path = self.sweep_of("two.h5", 'program.feed_override=[1.0,2.0,3.0],case.table.strategy.injection_point='
                                       '["position_command","feed_forward"]')
        with results.open_result(path) as sweep:
            feed, point = (next(one for one in sweep.parameters if part in one.key) for part in ("feed", "injection_point"))
            value = sweep.quantities[0]["value"]
            picture = sweeps.as_picture(feed, point, value)
            self.assertEqual(point.texts, ("position_command", "feed_forward"))
            for x, y, one in zip(feed.values, point.values, value):
                self.assertEqual(picture[int(y), int(x) - 1], one)
        done = plot(path, "-o", self.out, "--format", "svg", "--figures", "maps")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        drawn = (self.out / "two-maps.svg").read_text()
        for text in ("feed_forward", "program.feed_override", "imposed error residual"):
            self.assertIn(text, drawn)

    def test_one_number_and_texts_give_curves(self):
        path = self.sweep_of("text.h5", 'program.feed_override=[1.0,2.0,3.0],case.table.strategy.injection_point='
                                        '["position_command","feed_forward"]')
        done = plot(path, "-o", self.out, "--format", "svg", "--figures", "curves")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        drawn = (self.out / "text-curves.svg").read_text()
        self.assertIn("table, feed_forward", drawn)

    def test_parameters_that_go_together_are_one_and_further_ones_have_maps_of_their_own(self):
        path = self.sweep_of("three.h5", 'program.feed_override=[1.0,2.0],case.table.strategy.injection_point='
                                         '["position_command","feed_forward"],zip=[{'
                                         'machine.axis.X.v_max=["20 m/min","30 m/min","40 m/min"],'
                                         'machine.axis.Y.v_max=["10 m/min","20 m/min","30 m/min"]}]')
        with results.open_result(path) as sweep:
            self.assertEqual([(one.key, one.others) for one in sweep.varied(sampled=False)],
                             [("program.feed_override", 0), ("case.table.strategy.injection_point", 0), ("machine.axis.X.v_max", 1)])
        done = plot(path, "-o", self.out, "--format", "svg", "--figures", "maps,curves")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        maps, curves = ((self.out / f"three-{name}.svg").read_text() for name in ("maps", "curves"))
        for text in ("table, position_command:", "table, feed_forward:", "machine.axis.X.v_max (and 1 more), m/min"):
            self.assertIn(text, maps)
        self.assertIn("table, feed_override 2, feed_forward", curves)

    def test_samples_give_clouds_and_histograms_and_say_what_failed(self):
        path = self.sweep_of("random.h5", 'samples={design="random",count=20},'
                                          'errors.imposed.EYX.harmonic.amplitude_um={normal=[100.0,10.0]},'
                                          'case.table.strategy.time_constant_ms={normal=[10.0,10.0]}')
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

    def test_identified_values_are_samples(self):
        path = self.sweep_of("identified.h5", 'samples={count=12,identified=[{keys=["axis.X.moving_mass","nc.Kv"],units=["kg","1/s"],'
                                              'values=[750.0,60.0],covariance=[[100.0,1.0],[1.0,9.0]]}]},program.feed_override=[1.0,2.0]')
        with results.open_result(path) as sweep:
            self.assertEqual([(one.key, one.sampled) for one in sweep.parameters],
                             [("machine.axis.X.moving_mass", True), ("machine.nc.Kv", True), ("program.feed_override", False)])
        done = plot(path, "-o", self.out, "--format", "svg", "--figures", "samples")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertIn("nc.Kv, 1/s", (self.out / "identified-samples.svg").read_text())

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
            2, f"{self.none}: error: figure9: case nominal, the baseline, stopped"))

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
        done = plot("--list")
        self.assertEqual([line.split()[0] for line in done.stdout.splitlines()],
                         ["figure6", "figure9", "figure10", "figure11", "figure12", "figure14",
                          "figure15", "figure16", "figure17", "figure18", "figure19", "probed", "part", "planes", "lag", "curves", "maps", "samples", "circular", "reversals", "nest", "ball_bar",
                          "li_3_2", "li_3_3", "li_4_1",
                          "five_axis", "deviations", "inertia", "day", "position", "velocity",
                          "compliance", "compensated", "budget", "step"])
