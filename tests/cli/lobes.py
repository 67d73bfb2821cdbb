#!/usr/bin/python3
"""Stability lobes on the command line.

    lobes.py SERVOMILL
"""
import csv
import json
import os
import subprocess
import sys
import tempfile
import unittest

import numpy as np

SERVOMILL = os.path.abspath(sys.argv.pop(1))
ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
MACHINE = os.path.join(ROOT, "scenarios", "machines", "hsm600u_chatter.toml")
SCENARIO = os.path.join(ROOT, "scenarios", "parts", "chatter.toml")
KRC = 400.0e6  # N/m^2
MODE = ("--stiffness", "20 N/um", "--frequency", "500 Hz", "--damping", "0.03")
SLOT = ("--teeth", "4", "--Ktc", "1700", "--Krc", "400")


def lobes(*arguments, status=0, cwd=None):
    done = subprocess.run([SERVOMILL, "lobes", *arguments], capture_output=True, text=True, check=False, cwd=cwd)
    assert done.returncode == status, f"{arguments}: {done.returncode}\n{done.stdout}{done.stderr}"
    return done.stderr if status else done.stdout


def closed_form(turns, teeth=4, k=20e6, f0=500.0, zeta=0.03):
    """Lowest depth (m) of a = -1 / (2 Krc Re G) over all lobes at these speeds (1/s)."""
    f = np.linspace(f0 * 1.0001, 4 * f0, 400_000)
    r = f / f0
    G = 1.0 / (k * (1 - r * r + 2j * zeta * r))
    depth, phase = -1 / (2 * KRC * G.real), np.mod(np.pi + 2 * np.angle(G), 2 * np.pi)
    lowest = np.full(len(turns), np.inf)
    for lobe in range(30):
        n = f / ((phase / (2 * np.pi) + lobe) * teeth)  # turns at which this chatter has this lobe
        order = np.argsort(n)
        lowest = np.minimum(lowest, np.interp(turns, n[order], depth[order], left=np.inf, right=np.inf))
    return lowest


class Lobes(unittest.TestCase):
    def test_a_slot_has_the_closed_form(self):
        done = json.loads(lobes(*MODE, *SLOT, "--speed-min", "3000", "--speed-max", "9000", "--points", "13", "--depth-max", "60", "--json"))
        speed = np.array([one["speed_rpm"] for one in done["points"]])
        expected = closed_form(speed / 60)
        np.testing.assert_allclose([one["zeroth_order_mm"] for one in done["points"]], expected * 1e3, rtol=1e-3)
        np.testing.assert_allclose([one["limit_mm"] for one in done["points"]], expected * 1e3, rtol=5e-3)
        self.assertEqual({one["kind"] for one in done["points"]}, {"Hopf"})

    def test_low_immersion_has_flips(self):
        arguments = ("--teeth", "2", "--diameter", "10", "--milling", "down", "--radial-depth", "0.3", "--material", "42CrMo4", "--depth-max", "60")
        done = json.loads(lobes(*MODE, *arguments, "--speed-min", "8000", "--speed-max", "24000", "--json"))
        self.assertLessEqual({one["kind"] for one in done["points"]}, {"Hopf", "flip", None})
        self.assertIn("flip", {one["kind"] for one in done["points"]})
        self.assertAlmostEqual(done["entry_deg"], 180 - np.degrees(np.arccos(1 - 0.3 / 5)), places=6)
        self.assertEqual(done["exit_deg"], 180.0)

    def test_modes_of_a_machine_and_tool_and_material_of_a_scenario(self):
        few = ("--points", "3", "--json")
        machine = json.loads(lobes(MACHINE, "--teeth", "4", "--helix", "0", "--material", "42CrMo4", *few))
        scenario = json.loads(lobes(SCENARIO, *few))
        self.assertEqual(machine, scenario)
        printed = lobes(MACHINE, "--teeth", "4", "--material", "42CrMo4", "--points", "3")
        self.assertIn("mode 24 N/um, 620 Hz, damping 0.035, 0 deg from the feed", printed)
        self.assertIn("mode 20 N/um, 500 Hz, damping 0.03, 90 deg from the feed", printed)

    def test_threads_do_not_matter(self):
        one, two = (lobes(*MODE, *SLOT, "--points", "5", "--json", "--threads", n) for n in "12")
        self.assertEqual(one, two)

    def test_the_table_is_drawn(self):
        with tempfile.TemporaryDirectory() as folder:
            table = os.path.join(folder, "lobes.csv")
            lobes(*MODE, *SLOT, "--points", "9", "-o", table)
            self.assertIn("exists", lobes(*MODE, *SLOT, "--points", "9", "-o", table, status=2))
            with open(table, newline="", encoding="utf-8") as file:
                self.assertEqual(len(list(csv.DictReader(file))), 9)
            for status in (0, 2):  # the second time the figure exists
                done = subprocess.run(["/usr/bin/python3", "-B", os.path.join(ROOT, "tools", "lobes_figure.py"), table], capture_output=True, text=True, check=False)
                self.assertEqual(done.returncode, status, done.stderr)
            self.assertGreater(os.path.getsize(os.path.join(folder, "lobes.png")), 20_000)

    def test_wrong_input_is_refused_with_what_is_missing(self):
        for arguments, message in (
                ((*SLOT,), "servomill lobes: error: needs modes of the tool point: [[structural_mode]] of the machine with frequency_Hz, or --stiffness, --frequency and --damping"),
                ((*SLOT, "--stiffness", "20"), "--frequency: error: is missing; a mode has --stiffness, --frequency and --damping"),
                ((*SLOT, "--mode-angle", "20"), "--mode-angle: error: needs --stiffness, --frequency and --damping"),
                ((*MODE, "--material", "42CrMo4"), "--teeth: error: is missing; the file gives no tool"),
                ((*MODE, "--teeth", "4"), "servomill lobes: error: needs a material: [cutting] of a scenario, --material, or --Ktc and --Krc"),
                ((*MODE, *SLOT, "--radial-depth", "1"), "--radial-depth: error: needs --milling up or down"),
                ((*MODE, *SLOT, "--milling", "up"), "--radial-depth: error: is missing; up and down milling need it"),
                ((*MODE, *SLOT, "--milling", "up", "--radial-depth", "11", "--diameter", "10"), "--radial-depth: error: '11' must be <= 10 mm, the diameter"),
                ((*MODE, *SLOT, "--helix", "30"), "--helix: error: needs --diameter"),
                ((*MODE[:-1], "1.5", *SLOT), "--damping: error: '1.5' must be < 1"),
                ((*MODE, *SLOT, "--speed-max", "1000"), "--speed-max: error: '1000' must be above --speed-min, 2000"),
                ((*MODE, *SLOT, "--points", "1"), "--points: error: '1' must be 2 to 2000"),
                ((*MODE, "--teeth", "4", "--material", "42CrMo"), "did you mean '42CrMo4'?"),
                ((SCENARIO, "--tool", "3"), "--tool: error: no tool 3; the scenario has 1 with a diameter_mm"),
                ((MACHINE, "--tool", "1"), "--tool: error: needs a scenario, which has tools"),
        ):
            with self.subTest(arguments):
                self.assertIn(message, lobes(*arguments, status=2))


if __name__ == "__main__":
    unittest.main()
