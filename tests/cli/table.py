#!/usr/bin/python3
"""servomill table as its users meet it. table.py SERVOMILL"""
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

SAID = """\
compensation tables of error model 'imposed' on Three-axis mill
document: Siemens, SINUMERIK 840D sl/828D Function Manual Extended Functions (03/2013), 6FC5397-1BP40-3BA1, K3 Compensations, \
pages 237 to 268
reference: each table contains the errors along its axis through X = 0 mm, Y = 0 mm, Z = 150 mm, tool 0 mm
tables:
  Y over X: 161 points, 5 mm apart from -400 mm, up to 149.807 um; linear interpolation and rounding leave up to 4.788 um
not in these tables: none
TCP at poses all over the travel, relative to the reference: off by up to 150.000 um without these tables, 4.788 um with
verified: 18000 positions, largest difference to the error model 4.7745 um
written: {folder}/NC_CEC.INI
"""


def servomill(*arguments):
    done = subprocess.run([SERVOMILL, *arguments], capture_output=True, text=True, timeout=PATIENCE, check=False)
    return done.returncode, done.stdout, done.stderr


def files_in(folder):
    out = {}
    for name in sorted(os.listdir(folder)):
        with open(os.path.join(folder, name), encoding="utf-8") as file:
            out[name] = file.read()
    return out


class Table(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        self.out = os.path.join(folder.name, "deep", "out")
        self.command = ["table", SCENARIO, "--format", "siemens", "-o", self.out]

    def test_says_what_the_tables_hold_and_leave(self):
        self.assertEqual(servomill(*self.command), (0, SAID.format(folder=self.out), ""))

    def test_comment_of_the_file_says_the_same(self):
        servomill(*self.command)
        lines = files_in(self.out)["NC_CEC.INI"].splitlines()
        said = SAID.splitlines()[:-2]
        self.assertEqual(lines[2:2 + len(said)], ["; " + line for line in said])

    def test_replaces_files_only_by_force(self):
        servomill(*self.command)
        before = files_in(self.out)
        coarse = [*self.command, "--spacing", "10 mm"]
        self.assertEqual(servomill(*coarse), (2, "", f"{self.out}/NC_CEC.INI: error: exists; use --force to overwrite\n"))
        self.assertEqual(files_in(self.out), before)
        self.assertEqual(servomill(*coarse, "--force", "--quiet"), (0, "", ""))
        self.assertNotEqual(files_in(self.out), before)

    def test_takes_a_machine_and_a_file_of_error_models(self):
        servomill(*self.command)
        errors = os.path.join(self.folder, "errors.toml")
        with open(errors, "w", encoding="utf-8") as file:
            file.write("[errors.imposed]\nEYX = { harmonic = { amplitude_um = 150.0, period_mm = 62.0 } }\n")
        other = os.path.join(self.folder, "other")
        self.assertEqual(servomill("table", errors, "--machine", MACHINE, "--format", "siemens", "-o", other, "-q"), (0, "", ""))
        self.assertEqual(files_in(other), files_in(self.out))

    def test_needs_no_more_of_a_machine_than_travel_and_errors(self):
        router = os.path.join(self.folder, "router.toml")
        with open(router, "w", encoding="utf-8") as file:
            file.write("""\
name = "router"
structure = "[w b X Y Z t]"
axis.X.travel_mm = [0.0, 1000.0]
axis.Y.travel_mm = [0.0, 600.0]
axis.Z.travel_mm = [-120.0, 0.0]
[errors.measured]
EXX = { polynomial_um = [0.0, 0.2] }
EC0Y = "0.2 mm/m"
""")
        for command in (["table", "--machine", router], ["table", router, "--machine", router]):
            status, said, faults = servomill(*command, "--format", "linuxcnc", "-o", self.out, "--force")
            self.assertEqual((status, faults), (0, ""))
            # a leaning Y is shorter by 200e-6^2 / 2 of 0.3 m: no table of 6 nm
            self.assertEqual(sorted(os.listdir(self.out)), ["compensation.ini", "joint_0_x.comp"])
            self.assertIn("note: no table Y over Y: 0.006 um at most, of second order in errors of other directions\n", said)
            self.assertIn("verified: 6000 positions, largest difference to the error model 0.0060 um\n", said)
        status, said, faults = servomill("table", "--machine", router, "--format", "siemens", "-o", self.out, "-f",
                                         "--set", 'errors.measured.EXX={polynomial_um=[0.0,0.1]}', "-a", "X")
        self.assertEqual((status, faults), (0, ""))
        self.assertIn("X over X: 101 points, 10 mm apart from 0 mm, up to 49.995 um;", said)

    def test_every_format_writes_what_it_names(self):
        for name, files in (("linuxcnc", ["compensation.ini", "joint_0_x.comp"]),
                            ("heidenhain", ["CONFIG.CMA.txt", "X.COM.txt", "notes.txt"]), ("csv", ["notes.txt", "x.csv"]),
                            ("isg", ["notes.txt", "volcomp.csv"]), ("etalon", ["notes.txt", "volcomp.exc"])):
            out = os.path.join(self.folder, name)
            status, said, faults = servomill("table", SCENARIO, "--set", "errors.imposed.EXX={polynomial_um=[0.0,0.1]}",
                                             "--format", name, "-o", out)
            self.assertEqual((status, faults), (0, ""))
            self.assertEqual(sorted(os.listdir(out)), files)
            self.assertEqual(sorted(said.splitlines()[-1].split()[1:]), [os.path.join(out, file) for file in files])

    def test_writes_the_squareness_for_firmwares(self):
        for name, file, line in (("marlin", "skew.gcode", "M852 I-0.00020000 J0.00000000 K0.00000000"),
                                 ("klipper", "skew.cfg", "xy_skew = -0.00020000"),
                                 ("reprapfirmware", "skew.g", "M556 S100 X0.020000 Y0.000000 Z0.000000")):
            out = os.path.join(self.folder, name)
            status, said, faults = servomill("table", SCENARIO, "--set", 'errors.imposed.EC0Y="200 urad"', "--format", name, "-o", out)
            self.assertEqual((status, faults), (0, ""))
            self.assertIn("not in this correction: EYX\n", said)
            self.assertIn("verified: 3 right angles, largest deviation 0.0000 urad\n", said)
            self.assertIn(line, files_in(out)[file].splitlines())

    def test_imports_what_it_wrote(self):
        errors = ["--set", "errors.imposed.EXX={polynomial_um=[0.0,0.1]}", "--set", 'errors.imposed.EC0Y="20 urad"']
        for name, file in (("isg", "volcomp.csv"), ("etalon", "volcomp.exc"), ("csv", "x.csv")):
            out = os.path.join(self.folder, name)
            self.assertEqual(servomill("table", SCENARIO, *errors, "--format", name, "-o", out, "-q"), (0, "", ""))
            inputs = ["--import", os.path.join(out, file)]
            if name == "csv":
                inputs += ["--import", os.path.join(out, "locations.csv")]
            back = os.path.join(self.folder, name + ".toml")
            command = ["table", *inputs, "--format", name, "--machine", MACHINE, "--model", "imposed", "-o", back]
            status, said, faults = servomill(*command)
            self.assertEqual((status, faults), (0, ""))
            self.assertIn(f"\nverified: 2001 positions, to 2 nm and 2 nrad\nwritten: {back}\n", said)
            self.assertEqual(servomill(*command), (2, "", f"{back}: error: exists; use --force to overwrite\n"))
            again = os.path.join(self.folder, name + "_again")
            self.assertEqual(servomill("table", back, "--machine", MACHINE, "--format", name, "-o", again, "-q"), (0, "", ""))
            self.assertEqual({k: v for k, v in files_in(again).items() if k != "notes.txt"},
                             {k: v for k, v in files_in(out).items() if k != "notes.txt"})

    def test_a_folder_that_cannot_be_made_is_the_systems_fault(self):
        status, said, faults = servomill("table", SCENARIO, "--format", "csv", "-o", "/proc/none")
        self.assertEqual((status, said), (3, ""))
        self.assertEqual(faults, "/proc/none: error: cannot be created: No such file or directory\n")


if __name__ == "__main__":
    unittest.main()
