#!/usr/bin/python3
"""The commands that work on recordings of axes, as their users call them.

    identify.py SERVOMILL
"""
import json
import os
import re
import sys
import tomllib
import unittest

import h5py
import numpy as np

import in_folder
import nexus_rules

in_folder.InScenarios.program = os.path.abspath(sys.argv.pop(1))
SCENARIOS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "scenarios")
ACTUAL = {"axis.Y.moving_mass": 640.0, "axis.Y.slide_viscous_friction": 1700.0, "axis.Y.friction.coulomb": 520.0,
          "axis.Y.friction.coulomb_negative": 430.0}


MEASURED = os.path.abspath(os.path.join(SCENARIOS, "..", "..", "shared", "data", "measured", "emps_train.mat"))


class AllDrives(in_folder.InScenarios):
    """The drives of scenarios/precompensation under the loops of their own NC, in a copy of its folder."""

    copied, works_in = ("precompensation", "machines", "programs"), ("precompensation", "experiments")

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.run_in_folder("run", "../motion.toml", "-o", "../motion.h5", "-q")
        cls.run_in_folder("identify", "record.toml", "--make-up", "recordings.h5")

    def test_each_axis_has_its_channels(self):
        with h5py.File(os.path.join(self.cwd, "recordings.h5")) as file:
            found = {one.attrs["channel"]: len(one) for group in file.values() for one in group.values()
                     if "channel" in one.attrs}
        self.assertEqual(set(found), {f"{axis} {role}" for axis in "XYZBC" for role in ("command", "feedback", "force")})
        self.assertEqual((found["X force"], found["Z force"]), (35501, 36001))

    def test_a_table_holds_one_time(self):
        with open(os.path.join(self.cwd, "record.toml"), encoding="utf-8") as file:
            text = file.read()
        lengths = iter((0.3, 0.3, 0.4, 0.5, 0.6))     # X and Y alike, as in the whole recording
        text = re.sub(r"from_s = (.+)\nto_s = .+", lambda found: f"from_s = {found[1]}\nto_s = {float(found[1]) + next(lengths)}", text)
        with open(os.path.join(self.cwd, "short.toml"), "w", encoding="utf-8") as file:
            file.write(text)
        done = self.run_in_folder("identify", "short.toml", "--make-up", "recordings.csv", status=2)
        self.assertEqual(done.stderr, "short.toml: error: has 4 time or frequency bases, a table has one; write .h5\n")

    def test_a_rotary_axis_is_identified(self):
        with open(os.path.join(self.cwd, "identify.toml"), encoding="utf-8") as file:
            head, *parts = re.split(r"(?=\[\[)", file.read())
        with open(os.path.join(self.cwd, "of_B.toml"), "w", encoding="utf-8") as file:
            file.write(head + "".join(part for part in parts if "axis.B" in part))
        printed = self.run_in_folder("identify", "of_B.toml", "-o", "of_B_identified.toml").stdout
        self.assertRegex(printed, r"recordings\.h5 +estimation +6\.2 s +0\.5\d* urad")
        self.assert_holds_the_actual_machine(os.path.join(self.cwd, "of_B_identified.toml"), "B")

    def test_the_shipped_result_holds_the_actual_machine(self):
        self.assert_holds_the_actual_machine(os.path.join(self.cwd, "..", "machines", "identified.toml"), "XYZBC")

    def assert_holds_the_actual_machine(self, path, axes):
        with open(os.path.join(self.folder, "machines", "hsm600u.toml"), "rb") as file:
            actual = tomllib.load(file)
        with open(path, "rb") as file:
            identified = tomllib.load(file)["identified"]
        self.assertEqual(len(identified["keys"]), 5 * len(axes))
        for k, key in enumerate(identified["keys"]):
            value = actual
            for name in key.split("."):
                value = value[name]
            value = float(value.split()[0])
            off = identified["values"][k] - value
            # the force that nobody records shakes the slide loose: breakaway comes out too small
            is_biased = key.endswith("breakaway")
            self.assertLessEqual(abs(off), 0.2 * value if is_biased else 3 * np.sqrt(identified["covariance"][k][k]), key)

    def test_what_is_identified_takes_most_of_the_contour_error_away(self):
        printed = self.run_in_folder("sweep", "../identified.toml", "-o", "draws.h5", "--set", "sweep.samples.count=2",
                                     "--json").stdout
        largest = {"identified": [], "uncompensated": []}
        for one in json.loads(printed):
            if one["row"]["quantity"] == "contour_error":
                largest[one["row"]["case"]].append(one["row"]["value"])
        self.assertEqual(len(largest["identified"]), 2)
        for left, before in zip(largest["identified"], largest["uncompensated"]):
            self.assertLess(left, 0.1 * before)


class Way(in_folder.InScenarios):
    """The shipped way from a motion to an identified machine, in a copy of its folder."""

    copied, works_in = ("identification", "machines"), ("identification", "experiments")

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.run_in_folder("run", "../motion.toml", "-o", "motion.h5", "-q")
        cls.run_in_folder("identify", "record.toml", "--make-up", "recording.csv")
        identify = ("identify", "identify.toml", "-o")
        cls.printed = cls.run_in_folder(*identify, "again.toml", "--signals", "signals.h5", "--threads", "2").stdout
        cls.json = cls.run_in_folder(*identify, "one.toml", "--signals", "one.h5", "--threads", "1", "--json").stdout

    def path(self, name):
        return os.path.join(self.cwd, name)

    def identified(self, name):
        with open(self.path(name), "rb") as file:
            table = tomllib.load(file)["identified"]
        return table["keys"], np.array(table["values"]), np.array(table["covariance"])

    def test_the_identified_machine_holds_the_actual_one(self):
        keys, values, covariance = self.identified("again.toml")
        for key, actual in ACTUAL.items():
            k = keys.index(key)
            self.assertLessEqual(abs(values[k] - actual), 3 * np.sqrt(covariance[k, k]), key)

    def test_the_shipped_result_is_what_comes_out(self):
        keys, values, covariance = self.identified("again.toml")
        shipped = self.identified("../machines/identified.toml")
        self.assertEqual(keys, shipped[0])
        np.testing.assert_allclose(values, shipped[1], rtol=1e-3)
        np.testing.assert_allclose(np.diag(covariance), np.diag(shipped[2]), rtol=2e-2)

    def test_the_identified_machine_is_a_machine(self):
        self.run_in_folder("check", "again.toml")

    def test_nothing_is_overwritten_unasked(self):
        for option, name in (("-o", "again.toml"), ("--signals", "signals.h5")):
            done = self.run_in_folder("identify", "identify.toml", option, name, status=2)
            self.assertIn("exists", done.stderr)
        self.run_in_folder("identify", "record.toml", "--make-up", "recording.csv", status=2)

    def test_a_value_at_its_bound_is_written_as_such_with_exit_status_1(self):
        with open(self.path("identify.toml"), encoding="utf-8") as file:
            text = file.read().replace('key = "axis.Y.moving_mass"', 'key = "axis.Y.moving_mass"\nmax = "610 kg"')
        self.write("bound.toml", text)
        self.run_in_folder("identify", "bound.toml", "-o", "bound_identified.toml", status=1)
        keys, _, _ = self.identified("bound_identified.toml")
        self.assertNotIn("axis.Y.moving_mass", keys)
        with open(self.path("bound_identified.toml"), encoding="utf-8") as file:
            self.assertIn('moving_mass = "610 kg"  # at its bound\n', file.read())
        self.run_in_folder("check", "bound_identified.toml")

    def test_faults_of_inputs_come_before_those_of_outputs(self):
        done = self.run_in_folder("identify", "identify.toml", "--recording", "nothing.csv", "-o", "again.toml", status=2)
        self.assertIn("nothing.csv: error: cannot be read", done.stderr)

    def test_signals_hold_the_recording_the_simulation_and_the_parameters(self):
        self.assertEqual(nexus_rules.faults(self.path("signals.h5")), [])
        with h5py.File(self.path("signals.h5")) as file:
            record = file["recording_001"]
            residual = record["simulated_feedback"][:] - record["feedback"][:]
            np.testing.assert_allclose(record["residual"][:], residual, atol=1e-15)
            self.assertEqual(record["feedback"].attrs["units"], "m")
            parameters = file["parameters"]
            self.assertEqual(parameters.attrs["key_00"], "axis.Y.moving_mass")
            np.testing.assert_allclose(parameters["half_width"][:], 2 * np.sqrt(np.diag(parameters["covariance"][:])))
            colour = record["residual_autocovariance"][0]
            self.assertAlmostEqual(colour / np.mean(residual ** 2), 1.0, delta=0.2)

    def test_json_holds_the_parameters_of_the_report(self):
        found = json.loads(self.json)
        with h5py.File(self.path("signals.h5")) as file:
            values, halves = (file["parameters"][name][:] for name in ("value", "half_width"))
        np.testing.assert_allclose([one["value"] for one in found["parameters"]], values, rtol=1e-8)
        np.testing.assert_allclose([one["U"] for one in found["parameters"]], halves, rtol=1e-8)
        self.assertEqual(found["parameters"][0]["keys"], ["axis.Y.moving_mass"])
        self.assertEqual({one["use"] for one in found["recordings"]} - {"estimation", "validation"}, set())

    def test_a_recording_is_surveyed_as_json(self):
        found = json.loads(self.run_in_folder("recording", "recording.csv", "--json").stdout)[0]
        table = np.genfromtxt(self.path("recording.csv"), delimiter=",", names=True)
        (base,) = found["bases"]
        self.assertEqual((base["samples"], base["unit"], base["gaps"]), (len(table), "s", []))
        self.assertEqual(len(found["channels"]), len(table.dtype.names) - 1)
        first = table[table.dtype.names[1]]
        np.testing.assert_allclose([found["channels"][0]["min"], found["channels"][0]["max"]], [first.min(), first.max()], rtol=1e-8)

    def test_the_report_names_values_intervals_and_the_residual(self):
        self.assertRegex(self.printed, r"axis\.Y\.moving_mass +64\d\.\d +[\d.]+ +kg")
        self.assertRegex(self.printed, r"recording\.csv +estimation +6\.65 s +0\.5\d* um")
        self.assertIn("assumes independent samples", self.printed)

    def test_results_do_not_depend_on_the_number_of_threads(self):
        with open(self.path("one.toml"), encoding="utf-8") as one, open(self.path("again.toml"), encoding="utf-8") as two:
            self.assertEqual(one.read(), two.read())
        compared = []

        def compare(name, one):
            if isinstance(one, h5py.Dataset):
                np.testing.assert_array_equal(one[()], two[name][()], name)
                compared.append(name)

        with h5py.File(self.path("one.h5")) as first, h5py.File(self.path("signals.h5")) as two:
            first.visititems(compare)
            names = []
            two.visititems(lambda name, one: names.append(name) if isinstance(one, h5py.Dataset) else None)
            self.assertEqual(sorted(names), sorted(compared))
        self.assertIn("parameters/covariance", compared)
        self.assertIn("recording_001/simulated_feedback", compared)

    def test_intervals_on_request_are_next_to_those_of_the_covariance(self):
        printed = self.run_in_folder("identify", "identify.toml", "--bootstrap", "100", "--profile", "axis.Y.moving_mass").stdout
        row = re.search(r"97\.5 %.*\n-+\naxis\.Y\.moving_mass +([\d.]+) +([\d.]+) +([\d.]+) +kg +([\d.]+)", printed)
        low, high, replicas, spectrum = (float(x) for x in row.groups())
        self.assertTrue(low < 640.5 < high, row[0])
        self.assertTrue(0.5 < replicas / spectrum < 1.5, row[0])
        self.assertRegex(printed, r"\d+ replicas in blocks of \d+ samples")
        low, high = (float(x) for x in re.search(r"profile \(95 %\).*\n-+\naxis\.Y\.moving_mass +([\d.]+) +([\d.]+) ", printed).groups())
        self.assertTrue(635 < low < 640 < high < 646, (low, high))

    def test_wrong_requests_of_intervals_are_refused(self):
        done = self.run_in_folder("identify", "identify.toml", "--bootstrap", "99", status=2)
        self.assertIn("--bootstrap: error: 99 replicas are too few for 2.5 % quantiles; must be >= 100", done.stderr)
        done = self.run_in_folder("identify", "identify.toml", "--profile", "axis.Y.moving_mas", status=2)
        self.assertIn("axis.Y.moving_mas is not estimated in identify.toml; did you mean 'axis.Y.moving_mass'?", done.stderr)

    def test_the_motion_of_our_own_nc_tells_its_gains_and_its_drive(self):
        """The recording is a run of the engine with its program; the loop is that of the machine, in every function."""
        known = {"axis.Y.moving_mass": (500.0, "kg", 550.0), "axis.Y.Kv": (80.0, "1/s", 83.333), "nc.velocity_feed_forward": (0.9, None, 1.0),
                 "axis.Y.velocity_bandwidth": (180.0, "rad/s", 200.0), "axis.Y.current_time_constant_ms": (0.5, None, 0.35),
                 "axis.Y.stiffness": (1.5e8, "N/m", 2.2e8)}
        text = ('machine = "../machines/start.toml"\n[loop]\nkind = "nc"\nperiod_ms = 0.2\n[[recording]]\nfile = "motion.h5"\n'
                'axis.Y.command = "cases/motion/servo/cmd_linear_Y"\naxis.Y.feedback = "cases/motion/servo/fb_linear_Y"\n')
        for key, (start, unit, _) in known.items():
            text += f'[[estimate]]\nkey = "{key}"\nstart = ' + (f'"{start} {unit}"\n' if unit else f"{start}\n")
        self.write("nc.toml", text)
        self.run_in_folder("identify", "nc.toml", "-o", "nc_identified.toml")
        keys, values, _ = self.identified("nc_identified.toml")
        for key, (_, _, actual) in known.items():
            self.assertAlmostEqual(values[keys.index(key)] / actual, 1.0, delta=5e-3, msg=key)

    def write(self, name, text):
        with open(self.path(name), "w", encoding="utf-8") as file:
            file.write(text)

    def test_friction_laws_are_compared(self):
        with open(self.path("identify.toml"), encoding="utf-8") as file:
            text = file.read().replace('file = "recording.csv"', 'file = "recording.csv"\nto_s = 1.5')
        with open(self.path("short.toml"), "w", encoding="utf-8") as file:
            file.write(text.replace("\nperiod_ms = 0.2", "\nperiod_ms = 0.5"))
        printed = self.run_in_folder("identify", "short.toml", "--compare-laws").stdout
        rows = re.findall(r"^(viscous|Coulomb, viscous, offset|LuGre by direction) .* um +[\d.]+ um", printed, re.MULTILINE)
        self.assertEqual(rows, ["viscous", "Coulomb, viscous, offset", "LuGre by direction"])
        held_out = [float(one) for one in re.findall(r" um +([\d.]+) um +[\d.]+ +\d+$", printed, re.MULTILINE)]
        self.assertEqual(len(held_out), 8)
        self.assertLess(max(held_out), 10.0)      # um; the axis moves by tenths of a metre
        self.assertIn("the simplest law that is not worse than the best: LuGre by direction\n", printed)   # that of the recording


class Emps(in_folder.InScenarios):
    """The command of the README on recordings with the channels of the EMPS benchmark, made up: one with pulses of force."""
    MADE_UP = """name = "made up"
machine = "../machines/emps_start.toml"
[loop]
period_ms = 1.0
position_gain = "160.18 1/s"
velocity_gain = "8557.2675 N s/m"
feedback_mean_of = 2
dead_time_ms = 0.45
[noise]
force_rms = "1 N"
force_time_ms = 8.0
feedback_step_nm = 50
seed = {seed}
[[recording]]
file = "motion.csv"
axis.Y.command = "qg"
axis.Y.feedback = "qg"
axis.Y.disturbance_force = {{ channel = "pulses_N", factor = {factor} }}
[[estimate]]
key = "axis.Y.moving_mass"
start = "95 kg"
"""

    copied, works_in = ("identification", "machines"), ("identification", "experiments")

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.make_up("emps_train.csv", seed=1, factor=1e-12)
        cls.make_up("emps_test.csv", seed=2, factor=1)

    path, write = Way.path, Way.write

    @classmethod
    def make_up(cls, name, seed, factor):
        """A ramp to each speed: both directions; pulses of 30 N and 50 ms in the second half."""
        t = np.arange(8000) * 1e-3
        wanted = np.array([0.15, -0.15, 0.05, -0.1, 0.02, 0.12, -0.02, -0.07])[(t // 1).astype(int)]
        v = np.zeros_like(t)
        for k in range(1, len(t)):
            v[k] = v[k - 1] + np.clip(wanted[k] - v[k - 1], -2e-3, 2e-3)
        q = np.cumsum(v) * 1e-3
        pulses = np.where((t > 4) & (t % 0.5 < 0.05), 30.0, 0.0)
        np.savetxt(os.path.join(cls.cwd, "motion.csv"), np.column_stack([t, q, pulses]), "%.17g", ",",
                   header="time [s],qg [m],pulses_N [N]", comments="")
        with open(os.path.join(cls.cwd, "made_up.toml"), "w", encoding="utf-8") as file:
            file.write(cls.MADE_UP.format(seed=seed, factor=factor))
        cls.run_in_folder("identify", "made_up.toml", "--make-up", "made_up.csv", "--force")
        made = np.genfromtxt(os.path.join(cls.cwd, "made_up.csv"), delimiter=",", names=True)
        t, command, feedback, force = (made[key] for key in made.dtype.names)
        columns, names = [t, command, feedback, force / 35.15], "t,qg,qm,vir"
        if factor == 1:
            columns, names = [*columns, pulses[:len(t)]], names + ",pulses_N"
        np.savetxt(os.path.join(cls.cwd, name), np.column_stack(columns), "%.17g", ",", header=names, comments="")

    def identified(self, *options):
        return self.run_in_folder("identify", "emps.toml", "--recording", "emps_train.csv", "--validation", "emps_test.csv", *options).stdout

    def test_the_pulses_are_predicted_as_well_as_the_rest(self):
        printed = self.identified("-o", "found.toml")
        rms = {use: float(value) for use, value in re.findall(r"emps_\w+\.csv +(estimation|validation) +[\d.]+ s +([\d.]+) um", printed)}
        self.assertLess(rms["validation"], 1.35 * rms["estimation"], printed)
        self.assertIn("emps_train.csv: has no channel 'pulses_N' for disturbance_force, which is optional", printed)
        self.assertNotIn("warning", printed)
        with open(self.path("found.toml"), "rb") as file:
            identified = tomllib.load(file)["identified"]
        k = identified["keys"].index("axis.Y.moving_mass")
        self.assertAlmostEqual(identified["values"][k], 95.0, delta=3 * np.sqrt(identified["covariance"][k][k]))

    def test_pulses_of_the_other_sign_are_noticed(self):
        with open(self.path("emps.toml"), encoding="utf-8") as file:
            text = file.read().replace('channel = "pulses_N", unit = "N"', 'channel = "pulses_N", factor = -1')
        self.write("reversed.toml", text)
        printed = self.run_in_folder("identify", "reversed.toml", "--recording", "emps_train.csv", "--validation", "emps_test.csv").stdout
        self.assertRegex(printed, r"warning: emps_test.csv: with the opposite sign of disturbance_force the position rms is [\d.]+ um in place of "
                                  r"[\d.]+ um; set factor = -1")

    def test_pulses_in_another_unit_are_noticed(self):
        with open(self.path("emps.toml"), encoding="utf-8") as file:
            text = file.read().replace('channel = "pulses_N", unit = "N"', 'channel = "pulses_N", unit = "kN"')
        self.write("wrong_unit.toml", text)
        printed = self.run_in_folder("identify", "wrong_unit.toml", "--recording", "emps_train.csv", "--validation", "emps_test.csv").stdout
        self.assertIn("without the force of disturbance_force the position rms is", printed)

    def test_more_recordings_than_there_are_in_the_experiment_are_refused(self):
        done = self.run_in_folder("identify", "emps.toml", "--recording", "emps_train.csv", "--recording", "emps_test.csv", status=2)
        self.assertIn("--recording: error: is given 2 times; the experiment has 1 recording", done.stderr)


@unittest.skipUnless(os.path.exists(MEASURED), "no recording of the EMPS")
class MeasuredEmps(in_folder.InScenarios):
    """From the recording of a real drive to experiment 1 on it."""
    copied, works_in = ("identification", "machines", "guevel2025", "programs"), ("identification", "experiments")
    path, identified = Way.path, Way.identified

    def test_the_shipped_machine_is_what_comes_out_and_runs_experiment_1(self):
        printed = self.run_in_folder("identify", "emps.toml", "--recording", MEASURED, "-o", "again.toml").stdout
        self.assertRegex(printed, r"estimation +24\.8 s +0\.\d+ um +2\.\d+ %")
        found, shipped = (self.identified(name) for name in ("again.toml", "../machines/emps_identified.toml"))
        self.assertEqual(found[0], shipped[0])
        np.testing.assert_allclose(found[1], shipped[1], rtol=1e-2)
        self.run_in_folder("run", "../emps_experiment1.toml", "-q", "-o", "run.h5")
        with h5py.File(self.path("run.h5")) as file:
            rows = {(str(row.attrs["case"]), str(row.attrs["quantity"]), str(row.attrs["axis"])): float(row["value"][()])
                    for row in file["comparison"].values() if "axis" in row.attrs}
        table, feedback = (rows[case, "imposed_error_residual", "Y"] for case in ("table", "feedback"))
        self.assertTrue(table > 0 and feedback > 0, rows)


unittest.main()
