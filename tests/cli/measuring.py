#!/usr/bin/python3
"""A measuring program of single touches, run on a machine with errors; what it latches tells the errors.

    measuring.py SERVOMILL
"""
import csv
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

import h5py
import numpy as np

import nexus_rules

SERVOMILL = os.path.abspath(sys.argv.pop(1))
TRUNNION = pathlib.Path(__file__).resolve().parents[2] / "scenarios" / "calibration" / "trunnion"
ACTUAL = {"EC0Y": 18, "EA0Z": -12, "EB0Z": 25, "EB0A": -31, "EC0A": 22, "EA0C": 27, "EB0C": -19}  # urad


def rows_of(path):
    with open(path, encoding="utf-8") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def positions(rows):
    return np.array([[float(value) for key, value in row.items() if key != "sphere"] for row in rows])


class Measuring(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.run_servomill("run", TRUNNION / "touches.toml", "--touches", "touches", "-o", "t.h5", "-q")

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    @classmethod
    def run_servomill(cls, *words, status=0):
        done = subprocess.run([SERVOMILL, *map(str, words)], cwd=cls.folder.name, capture_output=True, text=True, check=False)
        assert done.returncode == status, done.stderr
        return done.stdout + done.stderr

    def path(self, name):
        return pathlib.Path(self.folder.name) / name

    def test_shipped_readings_are_those_of_the_program(self):
        made, shipped = rows_of(self.path("touches/touches.csv")), rows_of(TRUNNION / "touches" / "touches.csv")
        self.assertEqual([row["sphere"] for row in made], [row["sphere"] for row in shipped])
        np.testing.assert_allclose(positions(made), positions(shipped), atol=2e-6, rtol=0)

    def test_result_file_holds_the_touches(self):
        self.assertEqual(nexus_rules.faults(self.path("t.h5")), [])
        with h5py.File(self.path("t.h5")) as file:
            touches = file["cases/touches/touches"]
            table = positions(rows_of(self.path("touches/touches.csv")))
            self.assertEqual(len(table), 7 * 8 * 2 * 4)
            self.assertTrue(np.all(touches["switched"][:] == 1))
            for column, axis in enumerate("XYZAC"):
                np.testing.assert_allclose(touches[axis][:], table[:, column], atol=1e-6)

    def test_tilts_are_found_within_their_uncertainty(self):
        shutil.copytree(TRUNNION, self.path("trunnion"))
        shutil.copytree(TRUNNION.parents[1] / "machines", self.path("machines"), dirs_exist_ok=True)
        text = (TRUNNION / "machine.toml").read_text(encoding="utf-8").replace("../../machines", str(TRUNNION.parents[1] / "machines"))
        self.path("trunnion/machine.toml").write_text(text, encoding="utf-8")
        shutil.copy(self.path("touches/touches.csv"), self.path("trunnion/touches/touches.csv"))
        said = self.run_servomill("calibrate", "trunnion/touched.toml", "-o", "identified.toml")
        for name, actual in ACTUAL.items():
            found = re.search(rf"^{name} +(\S+) +(\S+)  urad", said, re.MULTILINE)
            self.assertIsNotNone(found, name)
            value, expanded = float(found[1]), float(found[2])
            self.assertLess(abs(value - actual), 1.5 * expanded, name)  # three standard uncertainties
            self.assertLess(expanded, 0.9 * abs(actual), name)          # and it says something

    def test_touches_are_not_overwritten(self):
        said = self.run_servomill("run", TRUNNION / "touches.toml", "--touches", "touches", "-o", "u.h5", "-q", status=2)
        self.assertIn("touches/touches.csv", said)

    def test_a_planned_program_gives_the_rows_that_its_readings_ask_for(self):
        self.run_servomill("plan-calibration", "--machine", TRUNNION / "machine.toml", "--instruments", "probe", "--hours", "0.7", "--controls", "linuxcnc", "-o", "plan")
        plan = self.path("plan/readings.toml").read_text(encoding="utf-8")
        length = re.search(r"stylus (\d+) mm", plan)[1]
        spheres = sorted(set(re.findall(rf'"(sphere \d+) at (.*) of the table, stylus {length} mm', plan)))
        text = f"""title = "planned"
machine = "{TRUNNION / "machine.toml"}"
machine_errors = "actual"
[program]
file = "plan/measure_{length}.ngc"
start = {{ Z_mm = 370.0 }}
[[program.tool]]
number = 1
length_mm = {length}.0
[touch_probe]
stylus_diameter_mm = 6
[record]
period_ms = 100
[[case]]
name = "touches"
servo = "ideal"
"""
        for _, centre in spheres:
            text += f"[[touch_probe.sphere]]\ncentre_mm = [{centre}]\ndiameter_mm = 25\n"
        self.path("planned.toml").write_text(text, encoding="utf-8")
        self.run_servomill("run", "planned.toml", "--touches", "taken", "-o", "planned.h5", "-q")
        asked, taken = rows_of(self.path(f"plan/touches_{length}.csv")), rows_of(self.path("taken/touches.csv"))
        self.assertGreater(len(taken), 50)
        self.assertEqual([row["sphere"] for row in taken], [row["sphere"] for row in asked])
        for axis in ("A_deg", "C_deg"):
            np.testing.assert_allclose([float(row[axis]) for row in taken], [float(row[axis]) for row in asked], atol=1e-3)


if __name__ == "__main__":
    unittest.main()
