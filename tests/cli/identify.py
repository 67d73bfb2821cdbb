#!/usr/bin/python3
"""The commands that work on recordings of axes, as their users call them.

    identify.py SERVOMILL
"""
import os
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
import unittest

import h5py
import numpy as np

SERVOMILL = os.path.abspath(sys.argv.pop(1))
SCENARIOS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "scenarios")
ACTUAL = {"axis.Y.moving_mass": 640.0, "axis.Y.slide_viscous_friction": 1700.0, "axis.Y.friction.coulomb": 520.0,
          "axis.Y.friction.coulomb_negative": 430.0}


class Way(unittest.TestCase):
    """The shipped way from a motion to an identified machine, in a copy of its folder."""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp()
        for name in ("identification", "machines"):
            shutil.copytree(os.path.join(SCENARIOS, name), os.path.join(cls.folder, name))
        cls.cwd = os.path.join(cls.folder, "identification", "experiments")
        cls.run_in_folder("run", "../motion.toml", "-o", "motion.h5", "-q")
        cls.run_in_folder("identify", "record.toml", "--make-up", "recording.csv")
        cls.printed = cls.run_in_folder("identify", "identify.toml", "-o", "again.toml", "--signals", "signals.h5").stdout

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    @classmethod
    def run_in_folder(cls, *arguments, status=0):
        done = subprocess.run([SERVOMILL, *arguments], cwd=cls.cwd, capture_output=True, text=True, check=False)
        assert done.returncode == status, f"{arguments}: {done.returncode}\n{done.stdout}{done.stderr}"
        return done

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

    def test_signals_hold_the_recording_the_simulation_and_the_parameters(self):
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

    def test_the_report_names_values_intervals_and_the_residual(self):
        self.assertRegex(self.printed, r"axis\.Y\.moving_mass +64\d\.\d +[\d.]+ +kg")
        self.assertRegex(self.printed, r"recording\.csv +estimation +6\.65 s +0\.5\d* um")
        self.assertIn("if each sample were independent", self.printed)

    def test_results_do_not_depend_on_the_number_of_threads(self):
        one = self.run_in_folder("identify", "identify.toml", "--threads", "1").stdout
        two = self.run_in_folder("identify", "identify.toml", "--threads", "2").stdout
        self.assertEqual(one, two)

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
        self.assertIn("--bootstrap: error: 99 are too few replicas for quantiles of 2.5 %; must be >= 100", done.stderr)
        done = self.run_in_folder("identify", "identify.toml", "--profile", "axis.Y.moving_mas", status=2)
        self.assertIn("axis.Y.moving_mas is not estimated in identify.toml; did you mean 'axis.Y.moving_mass'?", done.stderr)

    def test_friction_laws_are_compared(self):
        with open(self.path("identify.toml"), encoding="utf-8") as file:
            text = file.read().replace('file = "recording.csv"', 'file = "recording.csv"\nto_s = 1.5')
        with open(self.path("short.toml"), "w", encoding="utf-8") as file:
            file.write(text)
        printed = self.run_in_folder("identify", "short.toml", "--compare-laws").stdout
        rows = re.findall(r"^(viscous|Coulomb, viscous, offset|LuGre by direction) .* um +[\d.]+ um", printed, re.MULTILINE)
        self.assertEqual(rows, ["viscous", "Coulomb, viscous, offset", "LuGre by direction"])
        self.assertIn("the simplest law that is not worse than the best: ", printed)


unittest.main()
