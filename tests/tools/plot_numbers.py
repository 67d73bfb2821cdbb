"""Numbers that tools/plot.py draws: those of the result files, which agree with `servomill compare`."""
import json

from plot_files import HERE, SMALLEST_PNG, WithFiles, plot, servomill

import numpy as np

from figures import circular, lag, notches, results, rows, straightness, style, volumetric

AGREE = 1e-7  # um; `compare` prints nine digits of up to 100 um


class Servo(WithFiles):
    """Frequency and step responses."""

    def test_draws_what_the_file_holds(self):
        bode, step = self.out / "y.h5", self.out / "z.h5"
        few = ["--points", 5, "--f-min", 10, "-q"]
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
            said = json.loads(printed)
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
        servomill("bode", HERE / "side_and_contour.toml", "--axis", "Y", "--points", 4, "--f-min", 5, "--f-max", 100, "-q",
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
        self.fails(f"{path}: error: position: the file has no position loop", path, "--figures", "position")


class Agreement(WithFiles):
    """The numbers behind the figures are those that `servomill compare` prints."""

    def rows(self, path, quantity):
        rows = json.loads(servomill("compare", path, "--json"))
        return [row for row in rows if row["quantity"] == quantity]

    def test_largest_residuals_of_figures_9_10_and_11(self):
        with results.Run(self.side) as run:
            mine = {}
            for axis, section in (("Y", "flank"), ("Z", "plane")):
                for one in straightness.tracks(run, axis, section):
                    mine[one.case.name, axis] = one.largest()
            for case, one in zip(run.others(), notches.notches(run)):
                mine[case.name, "X"] = one.largest()
        rows = self.rows(self.side, "imposed_error_residual")
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

    def test_radial_errors_of_the_circle(self):
        with results.Run(self.side) as run:
            turns = circular.turns_of(run)
        for quantity, extreme in (("radial_error_max", np.max), ("radial_error_min", np.min)):
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
