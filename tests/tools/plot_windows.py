"""Figures of recordings with windows and extremes (record.windows, record.extremes), and of structures with inertia."""
from plot_files import HERE, SMALLEST_PNG, WithFiles, plot, servomill

import h5py
import numpy as np

from figures import deviations, inertia, results, rows, style

SIDE = HERE / "side_and_contour.toml"
CORNER = HERE.parent / "cli" / "gallery" / "scenario.toml"
CIRCULAR = HERE.parents[1] / "scenarios" / "structure" / "circular.toml"
# m/s, m, um per m/s2: the deflection of the static case is k v^2 / R
SPEED, RADIUS, GAIN_X, GAIN_Y = 8.0 / 60.0, 0.020, 2.0, 1.0
TRANSIENT = 0.03   # of the deflection: acceleration at the ends of a turn


class Gaps(WithFiles):
    def run_with(self, name, *keys):
        path = self.out.parent / f"{name}.h5"
        if not path.exists():
            sets = [part for key in keys for part in ("--set", f"record.{key}")]
            servomill("run", SIDE, "-o", path, "-q", *sets)
        return path

    def test_no_line_joins_two_windows(self):
        path = self.run_with("times", 'windows={sections=["circle"],time_s=[[0.2,0.4],[1,1.3]]}')
        with results.open_result(path) as run:
            for case in run.finished_cases():
                self.assertTrue(case.has_gaps())
                time, error = case.column("time"), case.column("following_error_linear", "X")
                blank = np.isnan(error)
                self.assertGreaterEqual(blank.sum(), 2)
                step = np.diff(time)
                longer = np.flatnonzero(step > 1.5 * np.median(step[step > 0.0]))
                self.assertTrue(blank[longer].all())      # a line ends before each of them
                for part in results.passes(case.samples()):
                    self.assertFalse(blank[part].any())
                    self.assertLess(np.diff(time[part]).max(initial=0.0), 1.5 * np.median(step[step > 0.0]))
            figure = deviations.draw(run)
            drawn = [line for ax in figure.axes for line in ax.lines if len(line.get_xdata()) > 20]
            for line in drawn:
                x, y = (np.asarray(one, float) for one in line.get_data())
                joined = np.isfinite(y[1:]) & np.isfinite(y[:-1]) & (np.diff(x) > 0.1)
                self.assertFalse(joined.any())
            self.assertIn("gaps: not recorded", figure.axes[-1].get_xlabel())

    def test_a_complete_section_gives_the_same_figure(self):
        path = self.run_with("flank", 'windows.sections=["flank","circle"]')
        with results.open_result(path) as some, results.open_result(self.side) as every:
            for case in some.others():
                there = every.cases[case.name]
                mine, theirs = (results.trajectory_difference(one, run.base(), "Y", one.samples(["flank"]))
                                for one, run in ((case, some), (there, every)))
                np.testing.assert_array_equal(mine, theirs)

    def test_what_the_baseline_left_out_is_not_interpolated(self):
        path = self.run_with("flank", 'windows.sections=["flank","circle"]')
        with results.open_result(path) as run:
            base = run.base()
            s = base.column("s")
            gap = np.flatnonzero(np.isnan(base.column("meas_linear", "X")))[0]
            between = 0.5 * (s[gap - 1] + s[gap + 1])
            with self.assertRaisesRegex(results.NotInFile, f"case {base.name} has no rows at some of these places"):
                base.along("meas_linear", "X", np.array([between]))
            group = base._servo
            found = rows.values_along(group["s"], group["meas_linear"], 0, np.array([s[gap - 2], between]), group["window"])
            self.assertEqual(list(np.isnan(found)), [False, True])

    def test_thinned_lines_keep_gaps_and_peaks(self):
        x = np.arange(20000.0)
        y = -2.0 - np.sin(0.01 * x)
        y[[5000, 12345]] = np.nan
        y[777] = -0.5
        shown_x, shown = style.thin(x, y)
        self.assertEqual(list(shown_x[np.isnan(shown)]), [5000.0, 12345.0])
        self.assertEqual((np.nanmax(shown), np.nanmin(shown)), (-0.5, np.nanmin(y)))

    def test_extremes_are_a_band(self):
        path = self.run_with("extremes", "extremes=true", "period_ms=5")
        with results.open_result(path) as run:
            case = run.base()
            low, value, high = (case.column(f"following_error_linear{end}", "X") for end in ("_min", "", "_max"))
            self.assertTrue(((low <= value) & (value <= high)).all())
            figure = deviations.draw(run)
            self.assertTrue(all(ax.collections for ax in figure.axes[1:]))
        done = plot(path, "-o", self.out, "--figures", "deviations")
        self.assertEqual((done.returncode, done.stderr), (0, ""))


class Inertia(WithFiles):
    def test_the_tip_leaves_the_scales_on_a_circle_by_the_closed_form(self):
        path = self.out / "circular.h5"
        servomill("run", CIRCULAR, "-o", path, "-q")
        with results.open_result(path) as run:
            at, where = inertia.place_of(run.cases["static"])
            self.assertTrue(where.startswith("In section 8 m/min"), where)
            moved = run.cases["static"].column(inertia.SIGNAL)[at]
            inner = moved[len(moved) // 4:-len(moved) // 4]
            for column, gain in ((0, GAIN_X), (1, GAIN_Y)):
                self.assertAlmostEqual(np.abs(inner[:, column]).max(), gain * SPEED ** 2 / RADIUS,
                                       delta=TRANSIENT * gain * SPEED ** 2 / RADIUS)
        done = plot(path, "-o", self.out, "--figures", "inertia")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertGreater((self.out / "circular-inertia.png").stat().st_size, SMALLEST_PNG)

    def test_about_a_corner_the_path_near_it_is_drawn(self):
        path = self.out / "corner.h5"
        servomill("run", CORNER, "-o", path, "-q", "--set", "machine_override.inertial_deflection.YY.gain_um_per_m_s2=1.5",
                  "--set", "machine_override.inertial_deflection.XX.gain_um_per_m_s2=1.0")
        with results.open_result(path) as run:
            at, where = inertia.place_of(run.base())
            self.assertRegex(where, r"^On line \d+")
            s = run.base().column("s")[at]
            self.assertLessEqual(np.ptp(s), 2.0 * inertia.REACH)
        done = plot(path, "-o", self.out, "--figures", "inertia")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
