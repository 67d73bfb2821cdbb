#!/usr/bin/python3
"""What the scenarios about statements of [G] say at their heads, and what is identified with its intervals.
statements.py SERVOMILL"""
import csv
import functools
import json
import math
import os
import subprocess
import sys
import tempfile
import unittest

HERE = os.path.dirname(os.path.abspath(__file__))
SERVOMILL = os.path.abspath(sys.argv.pop(1))
SCENARIOS = os.path.join(HERE, "..", "..", "scenarios")
STATEMENTS = os.path.join(SCENARIOS, "statements")
SHARE = 0.01     # numbers at the heads have three digits
CHORD_UM = 0.2   # chord tolerance of rewritten programs and path tolerance, 0.1 um each


class Statements(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.out = os.path.join(folder.name, "out.h5")

    def servomill(self, command, name, *arguments):
        return subprocess.run([SERVOMILL, command, os.path.join(STATEMENTS, name), "-o", self.out, "--force", *arguments],
                              capture_output=True, text=True, check=False)

    @functools.cache
    def run_of(self, name):
        """A run of the scenario, once a test."""
        done = self.servomill("run", name, "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        return done

    def values(self, name, quantity, statistic="max"):
        """{case: value} of a quantity of a run."""
        rows = json.loads(self.run_of(name).stdout)
        return {row["case"]: row["value"] for row in rows
                if row["quantity"] == quantity and row["statistic"] in (None, statistic)}

    def near(self, found, **expected):
        for case, value in expected.items():
            self.assertAlmostEqual(found[case], value, delta=SHARE * value, msg=case)

    def test_a_rewritten_program_belongs_to_its_origin(self):
        found = self.values("origin_shift.toml", "imposed_error_residual")
        self.near(found, gcode_moved=254.6, feedback=4.87, feedback_moved=4.87)
        for case in ("gcode", "gcode_again"):
            self.assertLess(found[case], CHORD_UM)

    def test_a_table_cannot_follow_a_sudden_error(self):
        found = self.values("sudden_error.toml", "imposed_error_residual")
        self.near(found, table=15.0, table_fine=22.1, table_prompt=18.7, feedback=6.31, feedback_lead=1.44)
        self.assertLess(found["gcode"], 1.0)
        refused = self.servomill("run", "sudden_error.toml", "--set",
                                 "case.table_fine.strategy.max_step_ratio=0.015625")
        self.assertEqual(refused.returncode, 2)
        self.assertIn("table over X: slope 18.59 um/mm at X = ", refused.stderr)
        self.assertIn("the NC accepts at most 15.62 um/mm (max_step_ratio)", refused.stderr)

    def test_short_blocks_cost_time(self):
        time = self.values("short_blocks.toml", "cycle_time")
        blocks = self.values("short_blocks.toml", "blocks")
        self.assertEqual(blocks["gcode_0.1mm"], 2000)
        # 200 mm of path at one block in 3.6 ms
        for case, block in (("gcode_0.2mm", 0.2), ("gcode_0.1mm", 0.1)):
            self.assertAlmostEqual(time[case], 200.0 / block * 3.6e-3, delta=0.05 * time[case])
        for case in ("feedback", "gcode_1mm", "gcode_0.1mm_fast_nc"):
            self.assertLess(time[case], 1.05 * time["nominal"])

    def test_saturation_limits_take_what_they_must_and_say_so(self):
        found = self.values("saturation.toml", "imposed_error_residual")
        self.near(found, wide=4.87, displacement=50.0, rate=20.8, short_table=117.6)
        said = self.run_of("saturation.toml").stderr.splitlines()
        self.assertEqual(len(said), 4, said)
        self.assertRegex(said[0], r"flank\.ngc:\d+: warning: case displacement: strategy feedback: virtual displacement "
                                  r"of Y saturated at 100 um, first here, [0-9.]+ s in all$")
        self.assertRegex(said[1], r"flank\.ngc:\d+: warning: case rate: strategy feedback: rate of the virtual "
                                  r"displacement of Y saturated at 0\.3 mm/s, first here, [0-9.]+ s in all$")
        for line, end in zip(said[2:], ("-70.0000", "70.9024")):
            self.assertRegex(line, r"flank\.ngc:\d+: warning: case short_table: strategy table: the table over X ends at "
                             + end + " mm, the program continues to ")

    def test_delays_add_to_the_lag(self):
        done = self.servomill("sweep", "delay.toml", "--quiet")
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(self.out[:-3] + ".csv", encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len(rows), 9)
        column = {key.split(" [")[0]: key for key in rows[0]}
        feed, Kv = 1394.0 / 60.0, 73.0   # mm/s, 1/s
        for row in rows:
            signal = float(row["feedback_hardware_signal_delay_us"])
            model = float(row["feedback_hardware_model_period_us"])
            ahead = float(row[column["connected_trajectory_difference_X_mean_flank"]])
            self.assertAlmostEqual(ahead, feed * signal * 1e-3, delta=1e-3 + 1e-3 * ahead)
            behind = float(row[column["feedback_lag_time_Y_flank"]])
            period = 0.2                 # ms, of the position loop: within it, it takes what the model gives
            self.assertAlmostEqual(behind, 1e3 / Kv + 1.5e-3 * model, delta=period)

    def test_the_table_of_axis_C_has_no_impact_but_its_errors_have(self):
        found = self.values("rotation_of_c.toml", "trajectory_difference")
        self.assertEqual(set(found.values()), {0.0})
        tip = self.values("rotation_of_c.toml", "tcp_deviation")
        self.assertAlmostEqual(tip["turned_180"], tip["nominal"], delta=0.01)
        self.assertAlmostEqual(tip["off_centre"] - tip["off_centre_0"], 20.0, delta=0.6)

    def swept(self, name):
        """Columns of a sweep below scenarios/, as numbers."""
        done = self.servomill("sweep", os.path.join(SCENARIOS, name), "--quiet")
        self.assertEqual(done.returncode, 0, done.stderr)
        with open(self.out[:-3] + ".csv", encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file))
        return {key.split(" [")[0]: [float(row[key]) for row in rows] for key in rows[0] if key not in ("status", "reason")}

    def test_another_gain_or_feed_forward_shows_where_a_table_enters(self):
        found = self.swept("discriminating/injection_point.toml")
        gain, share = found["machine_nc_Kv"], found["machine_nc_velocity_feed_forward"]
        behind, fed = (found[case + "_imposed_error_residual_Y_max_flank"] for case in ("behind_tap", "fed_forward"))

        def span(values, feed_forward, low, high):
            chosen = [v for v, k, f in zip(values, gain, share) if f == feed_forward and low < k < high]
            self.assertEqual(len(chosen), 3)
            return round(min(chosen), 1), round(max(chosen), 1)

        for values, wanted in ((behind, ((20.0, 20.0), (24.0, 25.5), (18.1, 18.6), (20.0, 20.0))),
                               (fed, ((20.0, 20.0), (20.0, 20.0), (20.0, 20.0), (22.0, 22.7)))):
            self.assertEqual((span(values, 1.0, 60, 90), span(values, 1.0, 30, 50), span(values, 1.0, 90, 140),
                              span(values, 0.5, 60, 90)), wanted)

    def test_a_step_of_the_table_distinguishes_lag_dead_time_and_update_period(self):
        found = self.swept("discriminating/table_step.toml")

        def span(case, window, statistic="mean"):
            values = found[f"{case}_trajectory_difference_Y_{statistic}_{window}_ms"]
            return round(min(values), 1), round(max(values), 1)

        for case, early, late, largest in (("lag", (4.2, 4.8), (16.0, 16.1), (5.8, 6.4)),
                                           ("dead_time", (0.0, 0.0), (19.1, 19.6), (0.0, 0.0)),
                                           ("update", (2.3, 7.0), (19.3, 19.6), (10.1, 17.9))):
            self.assertEqual((span(case, "10_to_20"), span(case, "60_to_100"), span(case, "10_to_20", "max")),
                             (early, late, largest), case)

    def test_what_experiment_1_identifies_has_an_interval_and_is_a_product(self):
        scenario = os.path.join(SCENARIOS, "guevel2025", "experiment1.toml")
        for Kv, response, period, realised_ratio in ((63.4, 41.2, 62.0, 96.0), (73.0, 43.3, 62.0, 96.5), (86.8, 45.5, 62.0, 97.0),
                                                  (73.0 * 62.0 / 80.0, 43.3 * 80.0 / 62.0, 80.0, 96.5)):
            done = self.servomill("run", scenario, "--json", "--set", f"machine_override.nc.Kv={Kv} 1/s",
                                  "--set", f"case.table.strategy.time_constant_ms={response}",
                                  "--set", f"errors.imposed.EYX.harmonic.period_mm={period}")
            self.assertEqual(done.returncode, 0, done.stderr)
            found = {(row["case"], row["quantity"], row["axis"]): row["value"] for row in json.loads(done.stdout)}
            self.assertAlmostEqual(found["feedback", "realised_ratio", "Y"], realised_ratio, delta=0.06)
            self.assertAlmostEqual(found["table", "imposed_error_residual", "Y"], 20.0, delta=0.1)

    def test_block_length_and_friction_leave_what_the_README_of_the_sweeps_says(self):
        found = self.swept("sweeps/blocks_friction.toml")
        residual = {(length, force): value for length, force, value in
                    zip(found["case_gcode_strategy_max_block_mm"], found["machine_axis_Y_friction_coulomb"],
                        found["gcode_imposed_error_residual_Y_max_flank"])}
        for length, row in ((0.5, (0.1, 2.4, 3.6, 5.4)), (1.0, (0.2, 2.1, 3.4, 5.2)), (2.0, (0.8, 1.8, 3.1, 5.0)),
                            (3.2, (1.9, 1.9, 2.8, 4.7)), (4.0, (3.0, 3.0, 3.0, 4.3))):
            self.assertEqual(tuple(round(residual[length, force], 1) for force in (0.45, 112.5, 225.0, 450.0)), row)
        curvature = 0.150 * (2.0 * math.pi / 62.0) ** 2
        length = 186.0 / math.ceil(186.0 / 3.2)           # mm, of equal blocks
        chord = curvature * length**2 / 8.0 * 1000.0      # um
        self.assertAlmostEqual(residual[3.2, 0.45], chord, delta=0.01)

    def test_only_a_change_of_the_command_shifts_Z_at_the_scale(self):
        done = self.servomill("run", os.path.join(SCENARIOS, "guevel2025", "z_hypotheses.toml"), "--json")
        self.assertEqual(done.returncode, 0, done.stderr)
        found = {(row["case"], row["axis"] or "top"): row["value"] for row in json.loads(done.stdout)}
        for case, scale, top in (("compensated", 0.14, 0.0), ("datum", 5.14, 0.0), ("temperature", 5.14, 0.0),
                                 ("growth", 0.14, -5.0), ("force", 0.14, 0.0), ("force_p", 0.22, 0.0),
                                 ("force_p_72N", 4.3, -4.1)):
            with self.subTest(case):
                self.assertAlmostEqual(found[case, "Z"], scale, delta=0.03)
                self.assertAlmostEqual(found[case, "top"], top, delta=0.05)
                self.assertAlmostEqual(found[case, "X"], 0.37, delta=0.02)
                self.assertAlmostEqual(found[case, "Y"], 0.42, delta=0.02)
        self.assertAlmostEqual(found["air", "Z"], 0.12, delta=0.01)


if __name__ == "__main__":
    unittest.main()
