#!/usr/bin/python3
"""servomill identify-heat, as its users call it: from a day to a machine whose sensors compensate.

    identify_heat.py SERVOMILL
"""
import json
import os
import sys
import tomllib
import unittest

import h5py

import in_folder

in_folder.InScenarios.program = os.path.abspath(sys.argv.pop(1))
SCENARIOS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "scenarios")
MACHINE = "../machines/hsm600u_heat.toml"


class IdentifyHeat(in_folder.InScenarios):
    copied, works_in = ("thermal", "machines", "programs"), ("thermal",)

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.run_in_folder("run", "training.toml", "-o", "training.h5", "-q")

    def refusal(self, *arguments):
        return self.run_in_folder("identify-heat", *arguments, status=2).stderr

    @staticmethod
    def values(path):
        with open(path, "rb") as file:
            return tomllib.load(file)["identified"]

    def test_the_shipped_machine_is_the_one_of_the_shipped_day(self):
        self.run_in_folder("identify-heat", "training.h5", "--machine", MACHINE, "-o", "sensors.toml")
        found = self.values(os.path.join(self.cwd, "sensors.toml"))
        shipped = self.values(os.path.join(SCENARIOS, "machines", "hsm600u_heat_sensors.toml"))
        self.assertEqual(found["keys"], shipped["keys"])
        for ours, theirs, U in zip(found["values"], shipped["values"], (row[i] for i, row in enumerate(shipped["covariance"]))):
            self.assertAlmostEqual(ours, theirs, delta=1e-6 + 0.01 * U ** 0.5)

    def test_the_day_and_its_table_give_the_same(self):
        with h5py.File(os.path.join(self.cwd, "training.h5")) as file, open(os.path.join(self.cwd, "day.csv"), "w", encoding="utf-8") as out:
            day = file["cases/machine/day"]
            sensors = [key.removeprefix("sensor_") for key in day if key.startswith("sensor_")]
            out.write("X_mm,Y_mm,Z_mm,B_deg,C_deg,tool_mm," + ",".join(f"{name}_degC" for name in sensors) + ",drift_X_um,drift_Y_um,drift_Z_um\n")
            at = {"centre": (0, 0), "left": (-250, 0), "right": (250, 0), "front": (0, -180), "back": (0, 180)}
            for place, (x, y) in at.items():
                for n in range(len(day["time"])):
                    temperatures = [repr(float(day["sensor_" + name][n])) for name in sensors]
                    drift = [repr(float(day["drift"][place][axis][n])) for axis in "XYZ"]
                    out.write(",".join([str(x), str(y), "200,0,0,120", *temperatures, *drift]) + "\n")
        of_day, of_table = (json.loads(self.run_in_folder("identify-heat", name, "--machine", MACHINE, "--json").stdout)
                            for name in ("training.h5", "day.csv"))
        self.assertEqual(of_day.keys(), of_table.keys())
        for key, value in of_day.items():
            if isinstance(value, dict):
                self.assertAlmostEqual(value["value"], of_table[key]["value"], places=5)

    def test_errors_are_chosen(self):
        printed = self.run_in_folder("identify-heat", "training.h5", "--machine", MACHINE, "--errors", "EZZ,EAZ").stdout
        self.assertIn("EAZ", printed)
        self.assertNotIn("EXX", printed)
        self.assertIn("--errors: error: 'EQQ'", self.refusal("training.h5", "--machine", MACHINE, "--errors", "EQQ"))
        self.assertIn("names EZZ twice", self.refusal("training.h5", "--machine", MACHINE, "--errors", "EZZ,EZZ"))

    def test_wrong_calls(self):
        self.assertIn("--machine: error: is missing", self.refusal("training.h5"))
        self.assertIn("has no [heat]", self.refusal("training.h5", "--machine", "../machines/hsm600u.toml"))
        self.assertIn("--case: error: training.h5 has no day of a case 'machin'; it has days of machine",
                      self.refusal("training.h5", "--machine", MACHINE, "--case", "machin"))
        self.run_in_folder("identify-heat", "training.h5", "--machine", MACHINE, "-o", "once.toml")
        self.assertIn("once.toml", self.refusal("training.h5", "--machine", MACHINE, "-o", "once.toml"))

    def test_drift_that_is_compensated_is_not_that_of_the_machine(self):
        self.run_in_folder("run", "corrected_day.toml", "-o", "corrected_day.h5", "-q")
        self.assertIn("corrected_day.h5: error: case sensors has the strategy thermal: its drift is the residual of this strategy; name a case without it",
                      self.refusal("corrected_day.h5", "--machine", MACHINE, "--case", "sensors"))
        self.assertIn("--case: error: is missing; corrected_day.h5 has days of datums alone, sensors, network, wrong network",
                      self.refusal("corrected_day.h5", "--machine", MACHINE))


if __name__ == "__main__":
    unittest.main()
