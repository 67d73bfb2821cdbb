#!/usr/bin/python3
"""Cycle times on the command line: equal to the motion of servomill run, and what they are made of.

    time.py SERVOMILL
"""
import csv
import json
import math
import os
import random
import re
import sys
import unittest

import h5py

import in_folder

SERVOMILL = os.path.abspath(sys.argv.pop(1))
ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
SCENARIOS = os.path.join(ROOT, "scenarios")
PROGRAMS = os.path.join(SCENARIOS, "programs")
MACHINES = os.path.join(SCENARIOS, "machines")
EQUAL = 1e-3    # s, between time and run

# structure and limits: no drives
ROUTER = """name = "router"
structure = "[w b X Y Z (C1) t]"
[axis.X]
v_max = "6 m/min"
a_max = "1 m/s^2"
j_max = "30 m/s^3"
[axis.Y]
v_max = "6 m/min"
a_max = "1 m/s^2"
j_max = "30 m/s^3"
[axis.Z]
v_max = "3 m/min"
a_max = "1 m/s^2"
j_max = "30 m/s^3"
"""
TIMES = "[nc]\ntool_change_time_s = 8.0\nspindle_time_s = 2.5\n"
V, A, J = 0.1, 1.0, 30.0  # of X: m/s, m/s^2, m/s^3
START = ("--start", "X=0,Y=0,Z=0")


def s_curve(length, v, a=A, j=J):
    """Time (s) of a motion from rest to rest that reaches speed and acceleration."""
    return length / v + v / a + a / j


def jerk_alone(length, v, j=J):
    """The same where the acceleration is not reached."""
    return length / v + 2.0 * (v / j) ** 0.5


class Case(in_folder.InFolder):
    program = SERVOMILL

    def setUp(self):
        super().setUp()
        self.write("router.toml", ROUTER)
        self.write("timed.toml", ROUTER.replace("[axis.X]", TIMES + "[axis.X]"))

    def time(self, program, *arguments, machine="router.toml", status=0):
        self.write("part.ngc", program)
        return self.servomill("time", "part.ngc", "--machine", machine, *arguments, status=status)

    def json(self, program, *arguments, machine="router.toml"):
        return json.loads(self.time(program, "--json", *arguments, machine=machine).stdout)


class Equal(Case):
    """The same motion time as the run that simulates it."""

    def recorded(self, scenario, *arguments):
        """Motion time of each case as a run has recorded it."""
        self.servomill("run", scenario, "-o", "out.h5", "-q", "-f", *arguments)
        with h5py.File(os.path.join(self.folder, "out.h5")) as file:
            return {name: float(group.attrs["duration_s"]) for name, group in file["cases"].items()}

    def planned(self, scenario, *arguments):
        """The same as computed without a run."""
        reports = json.loads(self.servomill("time", scenario, "--json", *arguments).stdout)
        return {case: report["time_s"] for report in reports for case in report["cases"]}

    def assertScenarioAgrees(self, scenario, *arguments):
        planned = self.planned(scenario, *arguments)
        recorded = self.recorded(scenario, *arguments)
        self.assertEqual(planned.keys(), recorded.keys())
        for case, duration in recorded.items():
            self.assertAlmostEqual(planned[case], duration, delta=EQUAL, msg=f"{scenario}, {case}")
        return planned

    SHORT_CIRCLES = ("--set", 'program.parameters."#102"=10')  # mm, radius

    def test_cases_of_scenarios(self):
        # rewritten programs, tables, circles, five axes, cutter locations, slow blocks, a probed part
        for scenario, *arguments in (("guevel2025/experiment1",), ("iso/circular", *self.SHORT_CIRCLES), ("iso/s_part", "--set", "record.period_ms=10"),
                                     ("li2024/example1_centre",), ("statements/short_blocks",), ("discriminating/table_step",),
                                     ("parts/block", "--set", "record.period_ms=5")):
            with self.subTest(scenario):
                self.assertScenarioAgrees(os.path.join(SCENARIOS, scenario + ".toml"), *arguments)

    def test_a_feed_override_of_a_scenario(self):
        scenario = os.path.join(SCENARIOS, "iso", "circular.toml")
        slow = self.assertScenarioAgrees(scenario, *self.SHORT_CIRCLES, "--set", "program.feed_override=0.5")
        plain = self.planned(scenario, *self.SHORT_CIRCLES)
        for case, duration in plain.items():
            self.assertGreater(slow[case], 1.5 * duration, case)

    def assertProgramAgrees(self, program, machine, scenario, *arguments):
        self.write("scenario.toml", f'title = "t"\nmachine = "{machine}"\n[program]\nfile = "{program}"\n{scenario}'
                   '\n[record]\nperiod_ms = 10.0\n[[case]]\nname = "plain"\nservo = "ideal"\n')
        recorded = self.recorded("scenario.toml")["plain"]
        done = json.loads(self.servomill("time", program, "--machine", machine, "--json", *arguments).stdout)
        self.assertAlmostEqual(done["time_s"], recorded, delta=EQUAL, msg=program)
        self.assertAlmostEqual(done["feed_s"] + done["rapid_s"] + done["dwell_s"], done["time_s"], places=5)

    def test_programs_on_a_machine_of_three_axes(self):
        machine = os.path.join(MACHINES, "router_3axis.toml")
        offset = "work_offset = { X_mm = 300.0, Y_mm = 300.0, Z_mm = -100.0 }"
        given = ("--work-offset", "X=300,Y=300,Z=-100", "--start", "X=300,Y=300,Z=-100")
        self.write("loops.ngc", "G21 G90 G64 P0.05\n#1=0\nO100 WHILE [#1 LT 6]\nG0 X[#1*5] Y0\nG1 Z-1 F300\n"
                   "G2 X[#1*5+4] Y3 I2 J1.5 F900\nG4 P0.2\nG0 Z5\n#1=[#1+1]\nO100 ENDWHILE\nG81 X1 Y1 Z-3 R2 F200\n"
                   "X5 Y5\nG80\nG91 G1 X3 Y4 F600\nM2\n")
        self.assertProgramAgrees("loops.ngc", machine, offset, *given)
        parameters = offset + '\nparameters = { "#101" = 800.0 }\n[[program.tool]]\nnumber = 1\nlength_mm = 50.0'
        given += ("--parameter", "#101=800", "--tool-length", "1=50")
        for program in ("contour.ngc", "m1_contour.ngc"):
            with self.subTest(program):
                self.assertProgramAgrees(os.path.join(PROGRAMS, program), machine, parameters, *given)

    def test_programs_on_machines_of_five_axes(self):
        machine = os.path.join(MACHINES, "generic_trunnion_ac.toml")
        tool = "start = { Z_mm = 400.0 }\n[[program.tool]]\nnumber = 1\nlength_mm = 120.0"
        given = ("--start", "Z=400", "--tool-length", "1=120")
        self.assertProgramAgrees(os.path.join(PROGRAMS, "s_part.ngc"), machine, tool, *given)


class FiveAxes(Case):
    """Under TCP control with the tool at rest in its direction the path is that of three axes, and so is its time."""

    def both(self, blocks):
        head, end = "G21 G90 G17 G64 P0.01\nG0 X0 Y0 Z0 B0 C0\n", "\nM2\n"
        start = ("--start", "X=0,Y=0,Z=0,B=0,C=0", "--tool-length", "1=0")
        machine = os.path.join(MACHINES, "hsm600u.toml")
        return [self.json(head + mode + blocks + end, *start, machine=machine)["time_s"] for mode in ("", "G43.4 H1\n")]

    def path(self, block, count, seed):
        draw = random.Random(seed)
        angle = x = y = 0.0
        blocks = []
        for _ in range(count):
            angle += draw.uniform(-1.5, 1.5)
            x, y = x + block * math.cos(angle), y + block * math.sin(angle)
            blocks.append(f"G1 X{x:.4f} Y{y:.4f} F3000")
        return "\n".join(blocks)

    def test_corners_of_long_and_short_blocks(self):
        for block in (2.0, 0.3, 0.05):
            linear, tip = self.both(self.path(block, 200, seed=3))
            self.assertLess(tip, 1.002 * linear, block)
            self.assertGreater(tip, 0.95 * linear, block)

    def test_arcs(self):
        linear, tip = self.both("\n".join(f"G{2 + k % 2} X{10 * k + 10}. Y0. I5. J0. F3000" for k in range(10)))
        self.assertLess(tip, 1.01 * linear)


class Totals(Case):
    # 100 mm in X at 6 m/min, 50 mm at 600 mm/min, half a second
    PROGRAM = "G21 G90 G0 X100\nG1 X150 F600\nG4 P0.5\nM2\n"

    def test_kinds_of_motion_have_their_known_times(self):
        done = self.json(self.PROGRAM, *START)
        self.assertAlmostEqual(done["rapid_s"], s_curve(0.1, V), places=6)
        self.assertAlmostEqual(done["feed_s"], jerk_alone(0.05, 0.01), places=6)
        self.assertAlmostEqual(done["dwell_s"], 0.5, places=6)
        self.assertAlmostEqual(done["total_s"], done["time_s"], places=6)
        self.assertAlmostEqual(done["at_programmed_feed_s"], 5.0, places=6)
        self.assertEqual((done["rapid_travel_mm"], done["feed_travel_mm"]), (100.0, 50.0))

    def test_limits_have_their_known_times(self):
        limits = self.json(self.PROGRAM, *START)["limits_s"]
        self.assertAlmostEqual(limits["velocity"]["X"], 1.0 - V / A - A / J, places=6)
        self.assertAlmostEqual(limits["acceleration"]["X"], 2.0 * (V / A - A / J), places=6)
        self.assertAlmostEqual(limits["jerk"]["X"], 4.0 * A / J + 4.0 * (0.01 / J) ** 0.5, places=6)
        self.assertAlmostEqual(limits["feed"], 5.0 - 2.0 * (0.01 / J) ** 0.5, places=6)
        self.assertEqual(limits["jerk"]["Y"], 0.0)

    def test_moves_from_unknown_positions_are_left_out_and_named(self):
        done = self.json(self.PROGRAM)
        self.assertIsNone(done["total_s"])
        self.assertEqual(done["rapid_s"], 0.0)
        self.assertEqual(done["unknown"], ["1 move from unknown positions (line 1); --start names the first"])
        self.assertIn("part.ngc on router: at least 5.54 s\n", self.time(self.PROGRAM).stdout)

    def test_tool_changes_and_spindle_are_unknown_until_the_machine_file_says(self):
        program = "G21 G90\nT1 M6\nS1000 M3\nG0 X10\nM3 S1000\nT2 M6\nT2 M6\nS2000 M3\nX20\nM0\nM5\nM2\n"
        done = self.json(program, *START)
        self.assertEqual(done["tool_changes"], {"count": 2, "time_s": None})
        self.assertEqual(done["spindle_changes"], {"count": 4, "time_s": None})  # M6 stops the spindle
        self.assertIsNone(done["total_s"])
        self.assertIn("  not in it: 2 tool changes: no nc.tool_change_time_s in the machine file\n",
                      self.time(program, *START).stdout)
        timed = self.json(program, *START, machine="timed.toml")
        self.assertEqual(timed["tool_changes"], {"count": 2, "time_s": 16})
        self.assertEqual(timed["spindle_changes"], {"count": 4, "time_s": 10})
        self.assertEqual(timed["unknown"], ["1 stop until the operator continues"])
        self.assertAlmostEqual(timed["at_least_s"], timed["time_s"] + 26.0, places=6)

    def test_a_probing_move_is_planned_to_its_end_and_said_so(self):
        done = self.json("G21 G90 G38.2 Z-10 F100\nM2\n", *START)
        self.assertAlmostEqual(done["feed_s"], jerk_alone(0.01, 0.1 / 60), places=6)
        self.assertEqual(done["unknown"], ["1 probing move, planned to the programmed end"])

    def test_rigid_tapping_takes_the_acceleration_of_the_spindle(self):
        program = "G21 G90 S1200 M3\nG33.1 Z-10 K1\nM2\n"
        unknown = self.json(program, *START)
        self.assertEqual(unknown["unknown"][-1], "2 moves of G33 or G33.1, planned as if the spindle were as quick as the axes: "
                                                 "no nc.spindle in the machine file")
        self.assertAlmostEqual(unknown["feed_s"], 2 * jerk_alone(0.01, 1.2 / 60), places=6)
        self.write("spindle.toml", ROUTER.replace("[axis.X]", "[nc.spindle]\nacceleration_rpm_per_s = 6000.0\n[axis.X]"))
        known = self.json(program, *START, machine="spindle.toml")
        self.assertAlmostEqual(known["feed_s"], 2 * s_curve(0.01, 1.2 / 60, a=6000 / 60 * 1e-3), places=6)
        self.assertFalse([line for line in known["unknown"] if "G33" in line])

    def test_a_feed_override(self):
        half = self.json(self.PROGRAM, *START, "--feed-override", "0.5")
        self.assertAlmostEqual(half["feed_s"], jerk_alone(0.05, 0.005), places=6)
        self.assertAlmostEqual(half["at_programmed_feed_s"], 10.0, places=6)

    def test_keys_of_the_machine_can_be_changed(self):
        done = self.json("G21 G90 G0 X100\nM2\n", *START, "--set", 'axis.X.a_max="2 m/s^2"')
        self.assertAlmostEqual(done["rapid_s"], 1.0 + 2.0 * (V / J) ** 0.5, places=6)

    def test_tolerances_of_a_machine_without_drives_count(self):
        program = "G21 G90 G64\n" + "".join(f"G1 X{k} Y{k % 2} F3000\n" for k in range(1, 40)) + "M2\n"
        self.write("loose.toml", ROUTER.replace("[axis.X]", "[nc]\npath_tolerance_um = 200\n[axis.X]"))
        fine, loose = self.json(program, *START), self.json(program, *START, machine="loose.toml")
        self.assertLess(loose["time_s"], 0.8 * fine["time_s"])

    def test_travel_is_reported_once_positions_are_known(self):
        self.write("short.toml", ROUTER.replace("[axis.Y]", "travel_mm = [0, 50]\n[axis.Y]", 1))
        done = self.time("G21 G90 G0 X100\nM2\n", *START, machine="short.toml")
        self.assertRegex(done.stderr, r"part\.ngc:1: warning: X .*100.* travel")


class Parts(Case):
    PROGRAM = ("G21 G90\nT1 M6\n(MSG, rough)\nG1 X100 F6000\nX0\nT2 M6\n(MSG, finish)\nG1 Y10 F600\nY0\n"
               "(MSG, rough)\nG0 X1\nM2\n")

    def test_tools_and_sections_add_up(self):
        done = self.json(self.PROGRAM, *START, machine="timed.toml")
        self.assertEqual([one["tool"] for one in done["tools"]], [1, 2])
        self.assertEqual([one["section"] for one in done["sections"]], ["rough", "finish"])
        for parts in (done["tools"], done["sections"]):
            self.assertAlmostEqual(sum(one["time_s"] for one in parts), done["time_s"], places=5)
        self.assertAlmostEqual(done["tools"][0]["time_s"], 2.0 * s_curve(0.1, V), places=5)
        self.assertAlmostEqual(done["sections"][1]["time_s"], 2.0 * jerk_alone(0.01, 0.01), places=5)

    def test_lines_that_take_longest_come_first_with_their_blocks(self):
        lines = self.json(self.PROGRAM, *START, "--top", "3")["lines"]
        self.assertEqual([one["line"] for one in lines][2:], [8])
        self.assertEqual(sorted(one["line"] for one in lines[:2]), [4, 5])
        self.assertEqual(lines[2]["block"], "G1 Y10 F600")
        self.assertEqual((lines[2]["limit"], lines[2]["axis"]), ("feed", None))

    def test_no_lines_are_printed_on_request(self):
        self.assertEqual(self.json(self.PROGRAM, *START, "--top", "0")["lines"], [])
        self.assertNotIn("Lines", self.time(self.PROGRAM, *START, "--top", "0").stdout)

    def test_a_line_of_a_loop_has_the_time_of_all_its_passes(self):
        done = self.json("G21 G90\nO1 REPEAT [5]\nG1 X10 F600\nX0\nO1 ENDREPEAT\nM2\n", *START)
        self.assertEqual(sorted((one["line"], round(one["time_s"], 3)) for one in done["lines"]),
                         [(3, round(5 * jerk_alone(0.01, 0.01), 3)), (4, round(5 * jerk_alone(0.01, 0.01), 3))])

    def test_a_subroutine_in_a_file_of_its_own_has_its_own_lines(self):
        self.write("side.ngc", "O<side> SUB\nG1 X10 F600\nG1 X0\nO<side> ENDSUB\nM2\n")
        done = self.json("G21 G90\nO<side> CALL\nG1 Y5 F600\nM2\n", *START)
        self.assertEqual({(os.path.basename(one["file"]), one["line"]) for one in done["lines"]},
                         {("side.ngc", 2), ("side.ngc", 3), ("part.ngc", 3)})
        self.assertRegex(self.time("G21 G90\nO<side> CALL\nM2\n", *START).stdout, r"side\.ngc:2 .* G1 X10 F600\n")

    def test_csv_has_every_row(self):
        for table, rows in (("line", 5), ("tool", 2), ("section", 2)):
            done = self.json(self.PROGRAM, *START, "--by", table, "--csv", "out.csv", "-f", "--top", "1")
            with open(os.path.join(self.folder, "out.csv"), encoding="utf-8", newline="") as file:
                read = list(csv.DictReader(file))
            self.assertEqual(len(read), rows, table)
            self.assertAlmostEqual(sum(float(row["time_s"]) for row in read), done["time_s"], delta=1e-4)
            if table == "line":
                self.assertEqual([int(row["line"]) for row in read], [4, 5, 8, 9, 11])
                self.assertEqual([row["section"] for row in read], ["rough", "rough", "finish", "finish", "rough"])
        self.assertIn("exists", self.time(self.PROGRAM, "--csv", "out.csv", status=2).stderr)


class Raised(Case):
    def test_a_limit_saves_what_the_closed_form_says(self):
        done = self.json("G21 G90 G0 X100\nM2\n", *START, "--raise", "10")
        saved = {one["limit"]: one["saved_s"] for one in done["raised"]}
        whole = s_curve(0.1, V)
        self.assertAlmostEqual(saved["velocity of X"], whole - s_curve(0.1, 1.1 * V), places=6)
        self.assertAlmostEqual(saved["acceleration of X"], whole - s_curve(0.1, V, 1.1 * A), places=6)
        self.assertAlmostEqual(saved["jerk of X"], whole - s_curve(0.1, V, A, 1.1 * J), places=6)
        self.assertEqual(saved["jerk of Y"], 0.0)
        self.assertEqual(saved["programmed feed"], 0.0)
        self.assertEqual(done["raised"][0]["limit"], "velocity of all axes")

    def test_the_report_sorts_savings_and_names_what_brings_nothing(self):
        text = self.time("G21 G90 G0 X100\nM2\n", *START, "--raise", "10 %").stdout
        self.assertIn("What a limit that is 10 % higher brings\n", text)
        nothing = re.search(r"  nothing: (.*)\n", text)[1].split(", ")
        self.assertLessEqual({"programmed feed", "path tolerance", "velocity of Y"}, set(nothing))

    def test_percent_must_be_a_number(self):
        for wrong in ("ten", "0", "-5", "nan"):
            self.assertIn(f"--raise {wrong}: error: must be a number of percent",
                          self.time("G0 X1\nM2\n", f"--raise={wrong}", status=2).stderr)


class Wrong(Case):
    def test_every_fault_of_the_program_is_printed(self):
        done = self.time("G21 G90 G0 X1\nG1 X2\nG1 X3 F100 Q\nM2\n", status=2)
        self.assertIn("part.ngc:2:", done.stderr)
        self.assertIn("part.ngc:3:", done.stderr)

    def test_warnings_of_the_reader_are_printed(self):
        done = self.time("G21 G90 G0 X1. (unclosed\nM2\n", *START)
        self.assertIn("part.ngc:1:16: warning: a comment without ')'", done.stderr)
        self.assertEqual(done.stderr.count("\n"), 1)

    def test_limits_must_be_there(self):
        self.write("bare.toml", 'name = "bare"\nstructure = "[w b X Y Z (C1) t]"\n')
        self.assertEqual(self.time("G0 X1\nM2\n", machine="bare.toml", status=2).stderr,
                         "bare.toml: error: the machine file lacks v_max, a_max or j_max of X, Y, Z\n")

    def test_an_axis_that_the_machine_lacks_is_named(self):
        self.assertEqual(self.time("G21 G90 G0 X1 C90\nM2\n", status=2).stderr,
                         "part.ngc: error: the cycle time is unknown: line 1 moves C, but the machine has no such axis\n")

    def test_faults_of_programs_come_before_those_of_outputs(self):
        self.write("times.csv", "kept")
        done = self.time("G0 X1\nG1 Y(\nM2\n", "--csv", "times.csv", *START, status=2)
        self.assertIn("part.ngc:2:", done.stderr)
        done = self.time("G0 X1\nM2\n", "--csv", "times.csv", *START, status=2)
        self.assertIn("times.csv: error: exists", done.stderr)

    def test_options_of_programs_are_refused_for_scenarios(self):
        scenario = os.path.join(SCENARIOS, "iso", "circular.toml")
        self.assertIn("--start: error: is for programs", self.servomill("time", scenario, "--start", "X=0", status=2).stderr)
        self.assertIn("--case nomnial: error: is no case of the scenario",
                      self.servomill("time", scenario, "--case", "nomnial", status=2).stderr)

    def test_needs_a_machine(self):
        self.write("part.ngc", "M2\n")
        self.assertEqual(self.servomill("time", "part.ngc", status=2).stderr,
                         "servomill time: error: needs --machine M.toml; see --help\n")


if __name__ == "__main__":
    unittest.main()
