#!/usr/bin/python3
"""What servomill check knows of a program, and what it does not: nothing unknown counts as known.

    check_unknown.py SERVOMILL
"""
import json
import os
import sys
import unittest

import in_folder

SERVOMILL = os.path.abspath(sys.argv.pop(1))
ROUTER = """name = "router"
structure = "[w b X Y Z (C1) t]"
""" + "".join(f'[axis.{letter}]\nv_max = "6 m/min"\na_max = "1 m/s^2"\nj_max = "30 m/s^3"\n' for letter in "XYZ")


class Unknown(in_folder.InFolder):
    program = SERVOMILL

    def setUp(self):
        super().setUp()
        self.write("router.toml", ROUTER)
        self.write("tool.tbl", "T1 P1 Z+50 D6\n")

    def check(self, program, *arguments, status=0):
        self.write("part.ngc", program)
        return self.servomill("check", "part.ngc", *arguments, status=status)

    def lines(self, program, label, *arguments, status=0):
        """What stands behind a label and below it."""
        out, at = [], None
        for line in self.check(program, *arguments, status=status).stdout.splitlines():
            if not line.startswith("  "):
                continue
            at = line[2:17].strip() or at
            if at == label:
                out.append(line[17:])
        return out

    # rs274 of LinuxCNC: "Unknown g code used" for each of them; Haas has G234 and G254, grbl and Mach nothing of the kind
    def test_codes_of_five_axes_are_those_of_fanuc(self):
        for words, code in (("G43.4 H1", "G43.4"), ("G43.5 H1", "G43.5"), ("G68.2 X0. Y0. Z0. I0. J0. K0.", "G68.2")):
            program = f"G21 G90\n{words}\nG1 X1. Y0. Z0. I0. J0. K1. F100.\nM30\n" if code == "G43.5" else f"G21 G90\n{words}\nG1 X1. F100.\nM30\n"
            self.assertIn("fanuc", self.lines(program, "read by")[0])
            self.assertEqual(self.lines(program, "not read by"),
                             [f"{name}: part.ngc:2:1: {code} is not supported by {name}" for name in ("linuxcnc", "haas", "mach", "grbl")])
            done = self.check(program, "--reader", "linuxcnc", status=2)
            self.assertEqual(done.stderr, f"part.ngc:2:1: error: {code} is not supported by linuxcnc\n")

    def test_the_chosen_reader_is_not_said_to_read_what_it_refuses(self):
        program = "G21 G90\nG0 X400\nM30\n"
        done = self.check(program, "--reader", "fanuc", "--machine", "router.toml", status=2)
        fault = ("a length or an angle without a decimal point: in millimetres, inches or degrees (calculator-type decimal points), or in least "
                 "input increments (Fanuc and Haas with increments); choose with --decimal-point")
        self.assertEqual(done.stderr, f"part.ngc:2:4: error: {fault}\n")
        self.assertIn(f"\n  cycle time     unknown: the program is read up to line 2\n  read by        linuxcnc, haas, mach, grbl\n"
                      f"  not read by    fanuc: part.ngc:2:4: {fault}\n", done.stdout)

    def test_a_time_of_no_known_move_is_unknown(self):
        program = "G21 G90\nG0 X10. Y5.\nM30\n"
        self.assertEqual(self.lines(program, "cycle time", "--machine", "router.toml"), ["unknown: every move is from or to an unknown position"])
        report = json.loads(self.check(program, "--json", "--machine", "router.toml").stdout)[0]
        self.assertIsNone(report["program"]["cycle_time"]["s"])
        self.assertEqual(self.lines("G21 G90\nM30\n", "cycle time", "--machine", "router.toml"), ["0.0 s on router"])

    def test_known_positions_outside_the_travel_are_faults(self):
        self.write("router.toml", ROUTER.replace("[axis.X]\n", "[axis.X]\ntravel_mm = [0.0, 300.0]\n"))
        # the arc about (280, 0) from (260, 0) through (300, 0) to (280, -20), in the machine 10 mm to the right
        program = "G21 G90 G17\nG0 X-20. Y0.\nG0 X260.\nG2 X280. Y-20. I20. J0. F600.\nM30\n"
        given = ["--machine", "router.toml", "--work-offset", "X=10,Y=0"]
        expected = ("part.ngc:2: error: X moves to -10.0000 mm, outside its travel; must be >= 0.0000\n"
                    "part.ngc:4: error: X moves to 310.0000 mm, outside its travel; must be <= 300.0000\n")
        self.assertEqual(self.check(program, *given, status=2).stderr, expected)
        self.assertEqual(self.check(program, *given, "--quiet", status=2).stderr, expected)
        faults = json.loads(self.check(program, *given, "--json", status=2).stdout)[0]["faults"]
        self.assertEqual([fault["line"] for fault in faults], [2, 4])
        self.assertEqual(self.check(program, "--machine", "router.toml").stderr, "")  # nobody has said where the workpiece is
        many = "G21 G90\n" + "".join(f"X-{k}.\n" for k in range(21, 35)) + "M30\n"
        self.assertIn("part.ngc: error: 4 more moves leave the travel\n", self.check(many.replace("X-21", "G0 X-21"), *given, status=2).stderr)

    def test_compensation_for_an_unknown_diameter_leaves_positions_unknown(self):
        program = "G21 G90 G17\nG0 X0. Y0. Z5.\nG41 D1\nG1 X10. F600.\nY20.\nZ-1.\nG40 X30.\nM30\n"
        self.assertEqual(self.check(program).stderr, "part.ngc:3:1: warning: G41: the diameter of tool 1 is unknown; the programmed path is "
                                                     "used without compensation; pass a tool table with --tools\n")
        self.assertEqual(self.lines(program, "extent G54"), ["X 0.000 ... 30.000 mm; feeds 0.000 ... 30.000 mm", "Y 0.000 ... 20.000 mm; feeds 0.000 ... 20.000 mm",
                                                             "Z -1.000 ... 5.000 mm; feeds -1.000 ... 5.000 mm"])
        self.assertEqual(self.lines(program, "not in it"), ["X moves to an unknown position (line 4)", "Y moves to an unknown position (line 5)"])
        self.assertEqual(self.lines(program, "machine", "--work-offset", "X=0,Y=0,Z=0")[0],
                         "X 0.000 ... 30.000 mm; unknown from line 4 on: needs --work-offset and --tools")
        self.assertNotIn("not in it", self.check(program, "--tools", "tool.tbl").stdout)


if __name__ == "__main__":
    unittest.main()
