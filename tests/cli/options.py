#!/usr/bin/python3
"""Quantities on the command line have one form in every command. options.py SERVOMILL"""
import os
import subprocess
import sys
import tempfile
import unittest

HERE = os.path.dirname(os.path.abspath(__file__))
SERVOMILL = os.path.abspath(sys.argv.pop(1))
SCENARIO = os.path.join(HERE, "gallery", "scenario.toml")
MACHINE = os.path.join(HERE, "gallery", "machine.toml")
PATIENCE = 60  # s, for one command: far more than any takes

PART = "GOTO/0,0,10\nGOTO/5,0,10\nGOTO/5,0,10,0,0,1\nGOTO/5,7,10\n"
PROGRAM = "G21 G90\nG0 X0 Y0 Z5\nG1 X10 F100\nG1 X300 Y200\nM2\n"
TRUNNION = 'structure = "[w C\' A\' b X Y Z t]"\naxis.Z.travel_mm = [-300.0, 300.0]\n'
TILTING = "GOTO/0,0,10,0.3,0.1,0.9\nGOTO/5,0,10,0.2,0.3,0.9\nGOTO/5,0,10,0.1,0.3,0.9\n"

# command without the option, option, bare number, the same with its unit, another value that must matter
POST = ["post", "part.cls", "-m", MACHINE, "-o", "-", "--tool-length", "0"]
POST_5 = ["post", "tilt.cls", "-m", "trunnion.toml", "-o", "-", "--work-offset", "0,0,0", "--feed", "500", "--rotary-feed", "900"]
COMPENSATE = ["compensate", "cut.ngc", "-m", MACHINE, "--errors", "errors.toml", "--work-offset", "X=0,Y=0,Z=0", "-o", "-"]
COMPENSATE_TOOL = ["compensate", "tool.ngc", "-m", MACHINE, "--errors", "angles.toml", "--work-offset", "X=0,Y=0,Z=0",
                   "--tools", "tool.tbl", "-o", "-"]
TABLE = ["table", SCENARIO, "--format", "siemens", "-f", "-o", "out"]
TABLE_C = ["table", "--machine", "turning.toml", "--format", "csv", "-f", "-o", "out"]
BODE = ["bode", SCENARIO, "-a", "Y", "--points", "2", "--f-min", "20", "--f-max", "40"]
STEP = ["step", SCENARIO, "-a", "Y"]
OPTIONS = [
    (POST + ["--feed", "500"], "--tolerance", "3", "3 um", "5"),
    (POST_5 + ["--tool-length", "0", "--tolerance", "1 mm"], "--axis-tolerance", "500", "500 urad", "90"),
    (POST_5, "--tool-length", "80", "80 mm", "90"),
    (POST, "--feed", "500", "500 mm/min", "0.6 m/min"),
    (POST_5[:-2] + ["--tool-length", "0"], "--rotary-feed", "1800", "1800 deg/min", "20 deg/s"),
    (POST + ["--feed", "500"], "--clearance", "4", "4 mm", "5"),
    (POST + ["--feed", "500"], "--retract", "Z=120", "Z=120 mm", "Z=130"),
    (COMPENSATE, "--tolerance", "0.5", "0.5 um", "50"),
    (COMPENSATE, "--max-block", "7", "7 mm", "9"),
    (TABLE, "--spacing", "5", "5 mm", "8"),
    (TABLE, "--tool-length", "50", "50 mm", "60"),
    (TABLE_C, "--rotary-spacing", "5", "5 deg", "9"),
    (BODE, "--amplitude", "0.02", "0.02 mm", "0.04"),
    (BODE + ["--amplitude", "0.02 mm"], "--velocity", "300", "300 mm/min", "6 mm/s"),
    (STEP + ["--kind", "position"], "--amplitude", "0.2", "0.2 mm", "0.3"),
    (STEP + ["--kind", "velocity"], "--amplitude", "7", "7 mm/s", "9"),
    (STEP + ["--kind", "load"], "--amplitude", "300", "300 N", "400"),
    (STEP + ["--kind", "position"], "--duration", "0.4", "0.4 s", "0.3"),
    (["tune", SCENARIO, "-a", "Y"], "--velocity-bandwidth", "150", "150 rad/s", "120"),
    (["tune", SCENARIO, "-a", "Y"], "--phase-margin", "50", "50 deg", "55"),
    (["tune", SCENARIO, "-a", "Y"], "--gain-margin", "20", "20 dB", "30dB"),
    (["tune", SCENARIO, "-a", "Y"], "--overshoot", "3", "3 %", "0.1"),
    (["tune", SCENARIO, "-a", "Y"], "--bandwidth", "5", "5 Hz", "6Hz"),
    (STEP + ["--kind", "position"], "--band", "7", "7 %", "1"),
    (BODE[:-4] + ["--method", "none", "--f-max", "40"], "--f-min", "10", "10 Hz", "0.02 kHz"),
    (BODE[:-4] + ["--method", "none"], "--f-max", "100", "100 Hz", "0.2 kHz"),
    (COMPENSATE[:-4] + ["-o", "-"], "--work-offset", "X=10,Y=0,Z=0", "X=10 mm,Y=0mm,Z=0", "X=9,Y=0,Z=0"),
    (COMPENSATE_TOOL, "--tool-length", "1=50", "1=50mm", "1=9 mm"),
    (POST_5[:-6] + ["--feed", "500", "--rotary-feed", "900", "--tool-length", "0"], "--work-offset", "1,2,3", "1 mm,2mm,3", "1,2,4"),
    (POST_5 + ["--tool-length", "0"], "--start", "C=10", "C=10 deg", "C=200"),
    (TABLE, "--travel", "X=0:100", "X=0:0.1 m", "X=0:90"),
    (TABLE, "--at", "X=50", "X=50 mm", "X=60"),
]


class CommandLine(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        files = {"part.cls": PART, "tool.ngc": PROGRAM.replace("G0 X0", "T1 M6\nG43 H1\nG0 X0"),
                 "angles.toml": "[errors.e]\nEBX = { polynomial_urad = [0.0, 1.0] }\n", "tilt.cls": TILTING, "cut.ngc": PROGRAM, "trunnion.toml": TRUNNION,
                 "errors.toml": "[errors.e]\nEXX = { polynomial_um = [0.0, 0.1, 0.0005] }\n",
                 "tool.tbl": "T1 P1 Z+20\n", "turning.toml": TRUNNION + "axis.X.travel_mm = [0.0, 10.0]\naxis.Y.travel_mm = [0.0, 10.0]\n"
                 "[errors.e]\nECC = { harmonic = { amplitude_urad = 30.0, period_deg = 90.0 } }\n"}
        for name, text in files.items():
            with open(os.path.join(self.folder, name), "w", encoding="utf-8") as file:
                file.write(text)

    def servomill(self, *arguments):
        done = subprocess.run([SERVOMILL, *arguments], capture_output=True, text=True, timeout=PATIENCE, check=False, cwd=self.folder)
        return done.returncode, done.stdout, done.stderr

    def outcome(self, *arguments):
        """All that a command says and writes."""
        status, said, faults = self.servomill(*arguments)
        self.assertEqual(status, 0, (arguments, faults))
        out = os.path.join(self.folder, "out")
        written = {}
        for name in sorted(os.listdir(out)) if os.path.isdir(out) else []:
            with open(os.path.join(out, name), encoding="utf-8") as file:
                written[name] = file.read()
            os.remove(os.path.join(out, name))
        return said, written

    def test_bare_numbers_are_in_the_unit_of_the_option(self):
        for command, option, bare, with_unit, other in OPTIONS:
            with self.subTest(command=command[0], option=option):
                first = self.outcome(*command, option, bare)
                self.assertEqual(self.outcome(*command, option, with_unit), first)
                self.assertNotEqual(self.outcome(*command, option, other), first)

    def test_errors_of_a_machine_file(self):
        with open(os.path.join(self.folder, "router.toml"), "w", encoding="utf-8") as file:
            file.write('structure = "[w b X Y Z t]"\naxis.X.travel_mm = [0.0, 900.0]\n[errors.e]\nEC0Y = "0.2 mm/m"\n')
        own = ["compensate", "cut.ngc", "-m", "router.toml", "--work-offset", "X=0,Y=0,Z=0", "-o", "-"]
        said, _ = self.outcome(*own)
        self.assertEqual(self.outcome(*own, "--errors", "router.toml")[0], said)
        self.assertIn("X300.04", said)  # 0.2 mm/m of 200 mm
        status, _, faults = self.servomill(*own, "--errors", "trunnion.toml")
        self.assertEqual((status, faults), (2, "trunnion.toml: error: contains the errors of a machine with other axes\n"))

    def test_a_loop_that_its_own_gain_does_not_stabilise(self):
        bode = ["bode", SCENARIO, "--axis", "Y", "--method", "none", "--points", "2", "--set",
                "machine_override.nc.check_stability=false", "--set"]
        falls, helps = "  the gain must fall ", "  the velocity loop inside is unstable: no Kv stabilises it, lower velocity_bandwidth\n"
        fast = 'machine_override.axis.Y.velocity_bandwidth="90000 rad/s"'
        for loop, change, says, not_says in (("position", "machine_override.axis.Y.Kv=5000", falls, helps),
                                             ("position", fast, helps, falls), ("velocity", fast, falls, helps)):
            status, said, _ = self.servomill(*bode, change, "--loop", loop)
            self.assertEqual(status, 1)
            self.assertIn("UNSTABLE", said)
            self.assertIn(says, said)
            self.assertNotIn(not_says, said)


if __name__ == "__main__":
    unittest.main()
