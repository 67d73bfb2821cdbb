#!/usr/bin/python3
"""Recorded motion against the path of its program, on the command line: motions in closed form and our own runs.

    limits_path.py SERVOMILL
"""
import json
import os
import re
import sys
import unittest

import h5py
import numpy as np

import in_folder

SERVOMILL = os.path.abspath(sys.argv.pop(1))
ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
MACHINES = os.path.join(ROOT, "scenarios", "machines")
V = 50.0   # mm/s
T = 1e-3   # s
ERROR = 0.05  # deg

MACHINE = """name = "router"
structure = "[w b X Y Z (C1) t]"
[axis.X]
v_max = "60 m/min"
a_max = "1000 m/s^2"
[axis.Y]
v_max = "60 m/min"
a_max = "1000 m/s^2"
[axis.Z]
v_max = "60 m/min"
a_max = "1000 m/s^2"
"""
ZERO = ("--work-offset", "X=0,Y=0,Z=0")


def samples(points, step=V * T):
    """Places at equal steps along the lines between points (mm), each point included."""
    out = [np.asarray(points[0], float)]
    for a, b in zip(points, points[1:]):
        a, b = np.asarray(a, float), np.asarray(b, float)
        n = max(1, round(np.linalg.norm(b - a) / step))
        out += [a + (b - a) * k / n for k in range(1, n + 1)]
    return np.array(out)


def arc(centre, radius, begin, end, n):
    """Places (mm) on an arc of the XY plane between two angles (deg)."""
    at = np.radians(np.linspace(begin, end, n))
    return np.stack([centre[0] + radius * np.cos(at), centre[1] + radius * np.sin(at), np.zeros(n)], axis=1)


class Path(in_folder.InFolder):
    program = SERVOMILL

    def setUp(self):
        super().setUp()
        self.write("router.toml", MACHINE)

    def limits(self, program, places, *arguments, status=0, offset=ZERO):
        self.write("part.ngc", program)
        self.write("log.csv", "time [s],X [mm],Y [mm],Z [mm]\n" + "".join(f"{k * T:.3f},{x:.9f},{y:.9f},{z:.9f}\n" for k, (x, y, z) in enumerate(places)))
        return self.servomill("limits", "log.csv", "--machine", "router.toml", "--program", "part.ngc", *offset, *arguments, status=status)

    def path(self, program, places, *arguments, status=0, offset=ZERO):
        return json.loads(self.limits(program, places, "--json", "--top", "1000", *arguments, status=status, offset=offset).stdout)["path"]

    def lines(self, *arguments, **more):
        return {line["line"]: line for line in self.path(*arguments, **more)["lines"]}

    # A corner of 90 deg rounded with r is passed in (sqrt 2 - 1) r and left by (1 - 1/sqrt 2) r.
    def test_a_rounded_corner_in_closed_form(self):
        r = 0.1
        # an odd number of places: one on the bisector
        rounded = np.concatenate([samples([(0, 0, 0), (10 - r, 0, 0)]), arc((10 - r, r), r, -90, 0, 101)[1:-1], samples([(10, r, 0), (10, 10, 0)])])
        program = "G21 G90 G64 P0.05\nG1 X10 F3000\nY10\nM2\n"
        lines = self.lines(program, rounded)
        self.assertAlmostEqual(lines[2]["corner_mm"], (2 ** 0.5 - 1) * r, delta=1e-6)
        self.assertAlmostEqual(max(lines[line]["deviation_mm"] for line in (2, 3)), (1 - 0.5 ** 0.5) * r, delta=1e-6)
        self.assertEqual({lines[line]["tolerance_mm"] for line in (2, 3)}, {0.05})
        self.assertIsNone(lines[3]["corner_mm"])
        narrow = self.path(program, rounded, "--tolerance", "35 um", status=1)  # the corner is beyond it, the path is not
        self.assertEqual(narrow["lines_beyond"], 1)
        self.assertEqual([line["line"] for line in narrow["lines"] if line["beyond"]], [2])

    def test_what_lies_between_two_samples_is_not_known(self):
        places = np.concatenate([samples([(0, 0, 0), (10, 0, 0)])[:-1], samples([(10, 1e-4, 0), (10, 10, 0)])[1:]])
        program = "G21 G90 G64 P0.05\nG1 X10 F3000\nX10.0001 Y0.0001\nX10 Y10\nM2\n"
        line = self.lines(program, places)[3]
        self.assertIsNone(line["deviation_mm"])
        self.assertIsNone(line["time_s"])
        self.assertIsNotNone(line["corner_mm"])
        shown = next(row for row in self.limits(program, places, "--top", "9").stdout.splitlines() if row.split()[:1] == ["3"])
        self.assertEqual(len(re.findall(r"\d mm", shown)), 2)  # tolerance and corner

    def test_a_tolerance_of_the_machine_file_is_said(self):
        places = samples([(0, 0, 0), (10, 0, 0)])
        message = "no G64 P is active: compared with nc.path_tolerance_um = 10 of the machine file; change it with --tolerance"
        self.assertIn(f"part.ngc:2: {message}", self.path("G21 G90 G64\nG1 X10 F3000\nM2\n", places)["notes"])
        for program, arguments in (("G21 G90 G64 P0.05\nG1 X10 F3000\nM2\n", ()), ("G21 G90 G61\nG1 X10 F3000\nM2\n", ()),
                                   ("G21 G90 G64\nG1 X10 F3000\nM2\n", ("--tolerance", "35 um"))):
            self.assertFalse([note for note in self.path(program, places, *arguments)["notes"] if message in note])

    # the tool of G41 is not the programmed path
    def test_compensation_for_an_unknown_diameter_is_refused(self):
        done = self.limits("G21 G90 G64 P0.05\nG41 D1\nG1 X10 F3000\nM2\n", samples([(0, 0, 0), (10, 0, 0)]), status=2)
        self.assertEqual(done.stderr, "part.ngc:3: error: the diameter of the tool of G41 or G42 is unknown; pass a tool table with --tools\n")

    def test_both_sides_of_the_tolerance(self):
        shifted = samples([(0, 0, 0), (20, 0, 0)])
        shifted[1:, 1] += 0.02
        program = "G21 G90 G64 P0.02\nG1 X20 F3000\nM2\n"
        self.assertTrue(self.path(program, shifted)["within_tolerance"])
        shifted[1:, 1] += 0.0002
        beyond = self.path(program, shifted, status=1)
        self.assertFalse(beyond["within_tolerance"])
        self.assertAlmostEqual(beyond["time_beyond_s"], (len(shifted) - 1) * T, delta=1e-9)
        text = self.limits(program, shifted, status=1).stdout
        self.assertRegex(text, r"Path of part.ngc: beyond the tolerance in 1 line; 0 corners passed, deviation 0\.020200 mm at most")

    # Thrice over the same line, then across it: each pass has its own error.
    def test_a_path_that_returns_and_crosses_itself_is_followed_in_its_order(self):
        passes = [samples([(0, 0, 0), (10, 0, 0)]), samples([(10, 0, 0), (0, 0, 0)]), samples([(0, 0, 0), (10, 0, 0)]),
                  samples([(10, 0, 0), (10, 5, 0), (5, 5, 0), (5, -5, 0)])]
        for error, places in zip((0.001, 0.002, 0.004), passes):
            places[1:-1, 1] += error
        lines = self.lines("G21 G90 G64 P0.05\nG1 X10 F3000\nX0\nX10\nY5\nX5\nY-5\nM2\n", np.concatenate(passes))
        self.assertEqual([round(lines[k]["deviation_mm"], 6) for k in (2, 3, 4, 5, 6, 7)], [0.001, 0.002, 0.004, 0.0, 0.0, 0.0])

    def test_a_full_circle_begins_at_its_begin(self):
        circle = arc((0, 0), 10.003, 180, -180, 1257)
        circle[0] = circle[-1] = (-10, 0, 0)
        found = self.path("G21 G90 G64 P0.05\nG2 I10 F3000\nG1 X-12\nM2\n", np.concatenate([circle, samples([(-10, 0, 0), (-12, 0, 0)])]))
        self.assertAlmostEqual(found["deviation_mm"], 0.003, delta=1e-6)
        self.assertEqual(found["share_passed"], 1.0)
        self.assertEqual(found["corners"], 1)

    # Blocks of 0.02 mm at right angles: the motion goes straight through them.
    def test_short_blocks_that_are_cut_are_passed(self):
        stairs = "".join(f"X{0.02 * k:.2f}\nY{0.02 * (k % 2):.2f}\n" for k in range(1, 200))
        found = self.path("G21 G90 G64 P0.05\nG1 F3000\n" + stairs + "M2\n", samples([(0, 0, 0), (3.98, 0.01, 0)]))
        self.assertLess(found["deviation_mm"], 0.0201)
        self.assertGreater(found["share_passed"], 0.99)

    def test_a_recording_that_ends_early_is_noted(self):
        found = self.path("G21 G90 G64 P0.05\nG1 X10 F3000\nY10\nM2\n", samples([(0, 0, 0), (10, 0, 0), (10, 5, 0)]))
        self.assertAlmostEqual(found["share_passed"], 0.75, delta=1e-6)
        self.assertEqual(found["notes"][:1], ["the recording ends in line 3, after 75 % of the path"])

    def test_what_nobody_has_given_is_unknown(self):
        program, places = "G21 G90 G64 P0.05\nG1 X10 F3000\nM2\n", samples([(0, 0, 0), (10, 0, 0)])
        self.assertIn("part.ngc:2: error: the position of G54 on X is unknown; set it with --work-offset, --additional-offset or --parameter-file",
                      self.limits(program, places, status=2, offset=()).stderr)
        self.assertLess(self.path(program, places, offset=("--work-offset", "X=0"))["deviation_mm"], 1e-12)  # Y and Z do not move
        off = self.path(program, places, offset=("--work-offset", "X=1,Y=0.2,Z=0"))
        self.assertAlmostEqual(off["share_passed"], 10 / 11, delta=1e-6)
        across = self.path("G21 G90 G64 P0.05\nG1 X10 Y0 F3000\nX20\nM2\n", samples([(0, 0, 0), (20, 0, 0)]), offset=("--work-offset", "X=0,Y=0.2"), status=1)
        self.assertAlmostEqual(across["deviation_mm"], 0.2, delta=1e-6)
        incremental = "G21 G91 G64 P0.05\nG1 X10 F3000\nM2\n"  # from where the machine is
        self.assertEqual(self.path(incremental, places, offset=())["share_passed"], 1.0)
        taught = "G21 G90 G64 P0.05\nG10 L20 P1 X0\nG1 X10 F3000\nM2\n"
        self.assertEqual(self.path(taught, samples([(3, 0, 0), (13, 0, 0)]), offset=())["share_passed"], 1.0)
        long = "G21 G90 G64 P0.05\nG43 H7\nG1 Z10 F3000\nM2\n"
        self.assertIn("part.ngc:3: error: the length of tool 7 is unknown; set it with --tools or --tool-length",
                      self.limits(long, samples([(0, 0, 0), (0, 0, 10)]), status=2).stderr)
        self.assertEqual(self.path(long, samples([(0, 0, 0), (0, 0, 60)]), "--tool-length", "7=50")["share_passed"], 1.0)
        self.assertIn("moves to a position stored in the control", self.limits("G21\nG28\nM2\n", places, status=2).stderr)

    def test_what_cannot_be_compared_is_refused(self):
        self.write("part.ngc", "G21\nG0 X1\nM2\n")
        self.write("flat.csv", "time [s],X [mm],Y [mm]\n0,0,0\n0.001,0,0\n0.002,0,0\n")
        flat = ("limits", "flat.csv", "--machine", "router.toml")
        self.assertIn("no channel is a position of Z", self.servomill(*flat, "--program", "part.ngc", status=2).stderr)
        self.assertIn("--tolerance: error: needs --program PROGRAM", self.servomill(*flat, "--tolerance", "1 um", status=2).stderr)
        self.assertIn("contains no motion: there is no path to compare", self.limits("G21\nM2\n", samples([(0, 0, 0), (1, 0, 0)]), status=2).stderr)

    # Tip and rotary axes: the tip stands still in the workpiece while C turns, which only the kinematics tells.
    def test_the_tip_under_TCP_control_is_that_in_the_workpiece(self):
        machine = os.path.join(MACHINES, "hsm600u.toml")
        self.write("tcp.ngc", "G21 G90 G64 P0.01\nT1 M6\nG0 X30 Y0 Z50 B0 C0\nG43.4 H1\nG1 Z10 F2000\nX20 Y10 B10 C30\nX0 Y20 B-15 C60\nG49\nM2\n")
        self.write("tool.tbl", "T1 P1 Z50 D10\n")
        self.write("s.toml", f'title = "t"\nmachine = "{machine}"\n[program]\nfile = "tcp.ngc"\n\n[[program.tool]]\nnumber = 1\nlength_mm = 50.0\n'
                   '[record]\nperiod_ms = 1.0\n[[case]]\nname = "one"\nservo = "ideal"\n')
        self.servomill("run", "s.toml", "-o", "out.h5", "-q")
        check = ("limits", "out.h5", "--machine", machine, "--program", "tcp.ngc", "--tools", "tool.tbl",
                 "--work-offset", "X=0,Y=0,Z=0,B=0,C=0", "--json", "--top", "100")
        path = json.loads(self.servomill(*check).stdout)["path"]
        self.assertEqual(path["share_passed"], 1.0)
        self.assertLess(max(line["rotary_deg"] for line in path["lines"]), 0.01)
        with h5py.File(os.path.join(self.folder, "out.h5"), "r+") as file:
            rotary = file["cases/one/servo/cmd_rotary"]  # B, C
            rotary[1:, 1] += ERROR
        path = json.loads(self.servomill(*check, status=1).stdout)["path"]
        vertical = next(line for line in path["lines"] if line["line"] == 5)  # 30 mm from C: what the turn moves is across it
        self.assertAlmostEqual(vertical["deviation_mm"], 30.0 * np.radians(ERROR), delta=1e-4)
        self.assertAlmostEqual(vertical["rotary_deg"], ERROR, delta=1e-4)

    def test_the_tip_needs_the_rotary_axes(self):
        machine = os.path.join(MACHINES, "hsm600u.toml")
        self.write("tcp.ngc", "G21 G90 G64 P0.01\nG43.4 H1\nG1 X10 F2000\nM2\n")
        self.write("log.csv", "time [s],X [mm],Y [mm],Z [mm]\n0,0,0,0\n0.001,0,0,0\n0.002,0,0,0\n")
        refused = self.servomill("limits", "log.csv", "--machine", machine, "--program", "tcp.ngc", "--tool-length", "1=50", *ZERO, status=2)
        self.assertIn("tcp.ngc:3: error: uses TCP control: the path requires the positions of the rotary axes, which the recording lacks", refused.stderr)

        self.write("half.csv", "time [s],X [mm],Y [mm],Z [mm],B [deg]\n0,0,0,0,0\n0.001,0,0,0,0\n0.002,0,0,0,0\n")  # C is unknown, not 0
        refused = self.servomill("limits", "half.csv", "--machine", machine, "--program", "tcp.ngc", "--tool-length", "1=50", *ZERO, status=2)
        self.assertIn("which the recording lacks", refused.stderr)


if __name__ == "__main__":
    unittest.main()
