#!/usr/bin/python3
"""tools/linuxcnc_times without LinuxCNC: its machine and programs are read, times and accelerations are those of a log.

    linuxcnc_planner_test.py SERVOMILL
"""
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

TOOLS = pathlib.Path(__file__).resolve().parents[2] / "tools"
sys.path.insert(0, str(TOOLS))

from linuxcnc_planner import __main__ as table  # noqa: E402
from linuxcnc_planner.programs import PROGRAMS  # noqa: E402

SERVOMILL = os.path.abspath(sys.argv.pop())
TICK = table.PERIOD


class Table(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        self.machine = self.folder / "mill.toml"
        subprocess.run([SERVOMILL, "machine", "from", str(TOOLS / "linuxcnc_planner" / "mill.ini"), "-o", str(self.machine), "-q"], check=True)

    def write(self, name, text):
        file = self.folder / name
        file.write_text(text, encoding="utf-8")
        return file

    def test_every_program_is_planned_without_a_warning(self):
        for name, text in PROGRAMS.items():
            program = self.write("p.ngc", text)
            done = subprocess.run([SERVOMILL, "time", str(program), "--machine", str(self.machine), "--reader", "linuxcnc",
                                   "--start", "X=0,Y=0,Z=0", "-q"], capture_output=True, text=True, check=False)
            self.assertEqual((done.returncode, done.stderr), (0, ""), name)

    # G61.1 stops at each corner: 4 sides of 40 mm at 50 mm/s with 800 mm/s^2, whose acceleration rises within 1 ms
    def test_a_planned_time_is_that_of_the_motion(self):
        program = self.write("p.ngc", PROGRAMS["square, G61.1"])
        self.assertAlmostEqual(table.planned_time(SERVOMILL, program, self.machine), 4 * (40 / 50 + 50 / 800 + TICK), places=5)

    def test_a_log_has_its_time_of_motion_and_its_acceleration(self):
        rows, x, v = [], 0.0, 0.0
        for a in [0] * 50 + [1600] * 20 + [0] * 100 + [-1600] * 20 + [0] * 50:  # mm/s^2, twice the limit
            x += v * TICK + 0.5 * a * TICK**2
            v += a * TICK
            rows.append(x)
        log = self.write("log.txt", "overrun\n" + "".join(f"{k} {x:.6f} 0.000000 0.000000 4 \n" for k, x in enumerate(rows, 1000)))
        self.assertAlmostEqual(table.motion_time(log), 0.14, delta=TICK)
        program = self.write("part.ngc", "G21 G90 G64 P0.1\nG1 X5 F6000\nY5\nM2\n")  # the log ends at 3.84 mm, before its corner
        acceleration, path, corner = table.findings(SERVOMILL, log, self.machine, program)
        self.assertAlmostEqual(acceleration, 2.0, delta=0.02)
        self.assertLess(path, 1e-3)
        self.assertEqual(corner, 0.0)


if __name__ == "__main__":
    unittest.main()
