#!/usr/bin/python3
"""What servomill check says of programs of Siemens.

    check_siemens.py SERVOMILL
"""
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

SERVOMILL = os.path.abspath(sys.argv.pop(1))
PATIENCE = 60  # s, far more than anything here takes


def said_of(name, text, *arguments):
    with tempfile.TemporaryDirectory() as folder:
        pathlib.Path(folder, name).write_text(text, encoding="utf-8")
        return subprocess.run([SERVOMILL, "check", name, *arguments], cwd=folder, capture_output=True, text=True,
                              timeout=PATIENCE, check=False)


class CheckSiemens(unittest.TestCase):
    def test_names_what_is_of_the_language(self):
        done = said_of("part.nc", "%_N_PART_MPF\nG17 G71 G90 G94 G64 G505\nG0 X1 Y2\nMSG(\"END\")\nM30\n")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertEqual(done.stdout, """part.nc: no faults
  units          those of its G70, G71, G700 and G710
  work offsets   G505 (line 2)
  tools          none
  extent G505    X 1.000 mm
                 Y 2.000 mm
  machine        X unknown from line 3 on: needs --work-offset
                 Y unknown from line 3 on: needs --work-offset
  cycle time     unknown: needs --machine
  read by        siemens
  not read by    controls for G-code: this is a Siemens program
""")

    def test_machine_data_are_given_by_their_names(self):
        text = "G17 G70 G90 G94 G64 G54\nG0 X0\nG1 X1 F10\nM30\n"
        self.assertIn("F with G70", said_of("part.mpf", text).stderr)
        self.assertEqual(said_of("part.mpf", text, "--parameter", "$MN_SCALING_SYSTEM_IS_METRIC=0").stderr, "")


if __name__ == "__main__":
    unittest.main()
