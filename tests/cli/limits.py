#!/usr/bin/python3
"""Recorded motion against the limits of a machine, on the command line.

    limits.py SERVOMILL
"""
import json
import os
import sys
import unittest

import numpy as np

import in_folder

SERVOMILL = os.path.abspath(sys.argv.pop(1))
ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
T = 1e-3        # s, between samples
V, A, J = 0.1, 1.0, 30.0  # m/s, m/s^2, m/s^3

MACHINE = """name = "router"
structure = "[w C' b X Y Z (C1) t]"
[axis.X]
v_max = "6 m/min"
a_max = "1 m/s^2"
[axis.Y]
v_max = "6 m/min"
a_max = "1 m/s^2"
j_max = "30 m/s^3"
[axis.C]
v_max = "1 rad/s"
a_max = "10 rad/s^2"
"""


def trapezoid(a=A, v=V, length=0.05):
    """Positions (m) of a move from rest to rest with constant acceleration, as LinuxCNC plans it, after 0.1 s of rest."""
    ramp, cruise = v / a, length / v - v / a
    acceleration = np.concatenate([np.zeros(100), np.full(round(ramp / T), a), np.zeros(round(cruise / T)),
                                   np.full(round(ramp / T), -a), np.zeros(100)])
    velocity = np.concatenate([[0.0], np.cumsum(acceleration) * T])
    return np.concatenate([[0.0], np.cumsum(0.5 * (velocity[1:] + velocity[:-1])) * T])


class Limits(in_folder.InFolder):
    program = SERVOMILL

    def setUp(self):
        super().setUp()
        self.write("router.toml", MACHINE)

    def limits(self, log, *arguments, status=0, name="log.csv"):
        self.write(name, log)
        return self.servomill("limits", name, "--machine", "router.toml", *arguments, status=status)

    def results(self, log, *arguments, status=0, name="log.csv"):
        done = json.loads(self.limits(log, "--json", *arguments, status=status, name=name).stdout)
        return {(one["axis"], one["quantity"]): one for one in done["results"]}

    def csv(self, X, heading="X [mm]", unit=1e-3, decimals=9):
        return f"time [s],{heading}\n" + "".join(f"{k * T:.3f},{x / unit:.{decimals}f}\n" for k, x in enumerate(X))

    def test_a_motion_at_its_limits_does_not_exceed_them(self):
        found = self.results(self.csv(trapezoid()))
        self.assertEqual(set(found), {("X", "velocity"), ("X", "acceleration")})  # no j_max
        for one in found.values():
            self.assertAlmostEqual(one["factor"], 1.0, delta=1e-4)
            self.assertEqual(one["excesses"], 0)

    def test_an_excess_has_its_factor_its_time_and_its_line(self):
        X = trapezoid(a=8.1)
        line = np.where(np.arange(len(X)) < 300, 12, 13)
        log = "time [s],X [mm],line\n" + "".join(f"{k * T:.3f},{x * 1e3:.9f},{n}\n" for k, (x, n) in enumerate(zip(X, line)))
        one = self.results(log, status=1)["X", "acceleration"]
        self.assertAlmostEqual(one["factor"], 8.1, delta=1e-3)
        self.assertEqual(one["excesses"], 2)
        self.assertEqual({excess["line"] for excess in one["largest_excesses"]}, {12, 13})
        first = min(one["largest_excesses"], key=lambda excess: excess["from_s"])
        self.assertAlmostEqual(first["from_s"], 0.1, delta=1.5 * T)
        self.assertAlmostEqual(first["to_s"], 0.1 + V / 8.1, delta=1.5 * T)
        text = self.limits(log, status=1).stdout
        self.assertRegex(text, r"acceleration of X: 8\.100 times the limit from 0\.\d+ to 0\.\d+ s, line 12\n")

    def test_halsampler_needs_the_period_and_the_channels(self):
        X = trapezoid(a=2.0)
        log = "".join(f"{k} {x * 1e3:.6f} {0.0:.6f} \n" for k, x in enumerate(X))
        self.assertIn("numbers its samples; set their period with --period", self.limits(log, "--channel", "X=column 2 [mm]", status=2).stderr)
        self.assertIn("no channel has the name of an axis (column 2, column 3)", self.limits(log, "--period", "1 ms", status=2).stderr)
        one = self.results(log, "--period", "1 ms", "--channel", "X=column 2 [mm]", status=1)["X", "acceleration"]
        self.assertAlmostEqual(one["factor"], 2.0, delta=0.03)

    def test_units_of_a_channel_count(self):
        found = self.results(self.csv(trapezoid(), "joint.0.pos-cmd [inch]", unit=25.4e-3))
        self.assertAlmostEqual(found["X", "velocity"]["factor"], 1.0, delta=1e-4)
        noted = json.loads(self.limits(self.csv(trapezoid(), "X"), "--json").stdout)["notes"]
        self.assertIn("channel 'X' has no unit: taken for a position in mm", noted)
        self.assertIn("is not a unit of position, velocity or acceleration of X", self.limits(self.csv(trapezoid(), "X [A]"), status=2).stderr)

    def test_names_may_end_with_their_unit(self):
        log = self.csv(trapezoid(), "X_mm").replace("time [s]", "time_s")
        done = json.loads(self.limits(log, "--json").stdout)
        self.assertEqual(done["notes"][0], "X is channel 'X_mm'")
        self.assertEqual([one["axis"] for one in done["results"]], ["X", "X"])

    def test_a_time_is_not_proposed_as_an_axis(self):
        log = self.csv(trapezoid(), "slide").replace("time [s]", "time of day")
        self.assertEqual(self.limits(log, status=2).stderr, "log.csv: error: no channel has the name of an axis (time of day, slide); "
                         'assign them, such as --channel "X=slide [mm]"\n')

    def test_a_velocity_is_derived_once_less(self):
        speed = 0.05 * np.sin(1.5 * A / 0.05 * T * np.arange(1000))
        one = self.results(self.csv(speed, "X [mm/s]"), status=1)["X", "acceleration"]
        self.assertAlmostEqual(one["factor"], 1.5, delta=0.01)
        self.assertAlmostEqual(one["window_s"], T, delta=1e-9)

    def test_rotary_axes_are_in_degrees(self):
        angle = trapezoid(a=10.0, v=1.0, length=1.0)  # rad
        found = self.results(self.csv(angle, "C [deg]", unit=np.pi / 180))
        self.assertAlmostEqual(found["C", "velocity"]["largest"], 180 / np.pi * 60, delta=0.1)
        self.assertAlmostEqual(found["C", "acceleration"]["factor"], 1.0, delta=1e-3)

    # 1 um: 4 q/2 / T^2 = 2 m/s^2 over two samples, so that means are taken over longer windows
    def test_resolution_widens_the_window_and_is_printed(self):
        one = self.results(self.csv(trapezoid(), decimals=3))["X", "acceleration"]
        self.assertGreater(one["window_s"], 5 * T)
        self.assertLess(one["resolution"], 0.06 * one["limit"])
        self.assertEqual(one["excesses"], 0)
        self.assertLess(one["factor"], 1.06)

    def test_the_step_of_the_samples_is_named_and_can_be_given(self):
        log = self.csv(np.round(trapezoid() / 20e-6) * 20e-6)
        self.assertIn("  note: X: all samples are multiples of 0.02 mm: treated as their resolution\n", self.limits(log).stdout)
        narrow = self.results(log, "--resolution", "1 um", status=1)["X", "acceleration"]  # which it is not
        self.assertLess(narrow["window_s"], self.results(log)["X", "acceleration"]["window_s"])

    def test_a_window_that_does_not_resolve_the_limit_is_no_excess(self):
        one = self.results(self.csv(trapezoid(), decimals=3), "--window", "2 ms")["X", "acceleration"]
        self.assertGreater(one["factor"], 1.0)
        self.assertFalse(one["resolved"])
        self.assertEqual(one["excesses"], 0)
        self.assertIn("not resolved", self.limits(self.csv(trapezoid(), decimals=3), "--window", "2 ms").stdout)

    # a jerk needs four samples
    def test_a_limit_that_is_not_evaluated_is_not_kept(self):
        rows = self.csv(np.zeros(3), "Y [mm]")
        done = self.limits(rows, status=1).stdout
        self.assertIn("  note: jerk of Y is not evaluated: no window of 3 ms without missing samples fits into its 3 samples\n", done)
        self.assertRegex(done, r"\n +jerk +30000 +- +mm/s\^3 +- +- +not evaluated +3 ms +-\n")
        report = json.loads(self.limits(rows, "--json", status=1).stdout)
        self.assertIsNone(report["within_limits"])
        jerk = report["results"][-1]
        self.assertEqual([jerk[key] for key in ("largest", "factor", "time_s", "time_beyond_s", "resolution")], [None] * 5)
        self.assertEqual((jerk["evaluated"], jerk["resolved"]), (False, False))
        self.limits(self.csv(np.zeros(4), "Y [mm]"))

    def test_a_given_window_longer_than_the_log_is_not_evaluated(self):
        done = self.limits(self.csv(np.zeros(50)), "--window", "60 ms", status=1).stdout
        self.assertIn("velocity of X is not evaluated: no window of 60 ms without missing samples fits into its 50 samples", done)

    # 0.1 mm: 4 q / h^3 is above 5 % of 30 m/s^3 up to h = 64 ms, and the rule allows 100 ms for three of them
    def test_a_chosen_window_is_at_most_100_ms_and_fits_into_the_log(self):
        coarse = np.round(trapezoid() / 1e-4) * 1e-4
        for log, window in ((coarse, 0.099), (coarse[100:151], 0.048)):
            jerk = self.results(self.csv(log, "Y [mm]"))["Y", "jerk"]
            self.assertAlmostEqual(jerk["window_s"], window, delta=1e-9)
            self.assertTrue(jerk["evaluated"])

    def test_missing_samples_are_no_jump(self):
        rows = self.csv(trapezoid()).splitlines(keepends=True)
        rows[250:280] = []
        rows[300] = rows[300].split(",")[0] + ",NaN\n"
        found = self.results("".join(rows))
        self.assertTrue(all(one["excesses"] == 0 for one in found.values()))

    def test_a_run_keeps_the_limits_of_its_machine(self):
        machine = os.path.join(ROOT, "scenarios", "machines", "router_3axis.toml")
        self.write("part.ngc", "G21 G90 G64 P0.02\nG0 X10 Y5\nG1 X40 F3000\nG3 X50 Y15 I0 J10\nG1 Y30\nX20 Y40\nM2\n")
        self.write("s.toml", f'title = "t"\nmachine = "{machine}"\n[program]\nfile = "part.ngc"\nwork_offset = {{ X_mm = 300.0, Y_mm = 300.0 }}\n'
                   '[record]\nperiod_ms = 1.0\n[[case]]\nname = "one"\nservo = "ideal"\n[[case]]\nname = "two"\nservo = "ideal"\n')
        self.servomill("run", "s.toml", "-o", "out.h5", "-q")
        self.assertIn("choose with --case or --channel", self.servomill("limits", "out.h5", "--machine", machine, status=2).stderr)
        case = ("limits", "out.h5", "--machine", machine, "--case", "one", "--json")
        done = json.loads(self.servomill(*case).stdout)
        self.assertTrue(done["within_limits"])
        jerk = [one for one in done["results"] if one["quantity"] == "jerk" and one["axis"] != "Z"]
        self.assertTrue(all(0.9 < one["factor"] < 1.01 and one["line"] > 0 for one in jerk), jerk)
        weak = json.loads(self.servomill(*case, "--set", 'axis.Y.a_max="0.5 m/s^2"', status=1).stdout)
        self.assertFalse(weak["within_limits"])

    def test_wrong_requests_are_refused(self):
        log = self.csv(trapezoid())
        self.assertIn("the machine has no axis B", self.limits(log, "--channel", "B=X [deg]", status=2).stderr)
        self.assertIn("must be AXIS=CHANNEL", self.limits(log, "--channel", "X", status=2).stderr)
        self.assertIn("did you mean 'X'", self.limits(log, "--channel", "X=x [mm]", status=2).stderr)
        self.assertEqual(self.servomill("limits", "log.csv", status=2).stderr, "servomill limits: error: needs --machine M.toml; see --help\n")


if __name__ == "__main__":
    unittest.main()
