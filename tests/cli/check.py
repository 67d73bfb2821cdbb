#!/usr/bin/python3
"""What servomill check says of programs: one program a property, with all that it prints.

    check.py SERVOMILL
"""
import json
import os
import subprocess
import sys
import tempfile
import unittest

HERE = os.path.dirname(os.path.abspath(__file__))
SERVOMILL = os.path.abspath(sys.argv.pop(1))
PATIENCE = 60  # s, far more than anything here takes

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
TOOLS = "T1 P1 Z+50 D6\nT2 P2 Z+80\n"
CONTROLS = "linuxcnc, fanuc, haas, mach, grbl"


class Check(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = temporary.name
        self.write("router.toml", ROUTER)
        self.write("tool.tbl", TOOLS)

    def write(self, name, text):
        with open(os.path.join(self.folder, name), "w", encoding="utf-8") as file:
            file.write(text)

    def check(self, program, *arguments, status=0):
        self.write("part.ngc", program)
        done = subprocess.run([SERVOMILL, "check", "part.ngc", *arguments], cwd=self.folder, capture_output=True,
                              text=True, timeout=PATIENCE, check=False)
        self.assertEqual(done.returncode, status, done.stderr)
        return done

    def json(self, program, *arguments, status=0):
        return json.loads(self.check(program, "--json", *arguments, status=status).stdout)[0]["program"]

    def assertSays(self, program, expected, *arguments):
        self.assertEqual(self.check(program, *arguments).stdout, "part.ngc: no faults\n" + expected.lstrip("\n"))

    def lines(self, program, label, *arguments, status=0):
        """What stands behind a label and below it."""
        out, at = [], None
        for line in self.check(program, *arguments, status=status).stdout.splitlines():
            if not line.startswith("  "):
                continue
            if line[2:17].strip():
                at = line[2:17].strip()
            if at == label:
                out.append(line[17:])
        return out

    def test_says_everything_of_a_program_without_a_machine(self):
        self.assertSays("""G21 G90 G17 G54
T1 M6
G43 H1
S1000 M3
G0 X0 Y0
G0 Z5
G1 Z-1 F200
G1 X50
G0 Z5
M30
""", """
  units          mm, G21 (line 1)
  work offsets   G54 (line 1)
  tools          T1 (line 2): unknown: no tool table given; used: M6, length
  extent G54     X 0.000 ... 50.000 mm; feeds 0.000 ... 50.000 mm
                 Y 0.000 mm; feeds 0.000 mm
                 Z -1.000 ... 5.000 mm; feeds -1.000 ... 5.000 mm
  machine        X unknown from line 5 on: needs --work-offset
                 Y unknown from line 5 on: needs --work-offset
                 Z unknown from line 6 on: needs --work-offset and the tool lengths
  cycle time     unknown: needs --machine
  read by        linuxcnc, fanuc, haas, mach (with T1 in its tool table)
  not read by    grbl: part.ngc:3:1: G43 is not supported by grbl
""")

    # F600: 0.01 m/s, reached with jerk 30 m/s^3 alone in 2 sqrt(0.01 / 30) s. G1 takes 50 mm / 0.01 m/s
    # and one such rise more. The rapids of 3 mm in Z: 2 x (2 t + 2 t), 2 j t^3 = 3 mm.
    def test_says_everything_of_a_program_on_a_machine(self):
        feed = 5.0 + 2.0 * (0.01 / 30.0) ** 0.5
        rapid = 4.0 * (3e-3 / 60.0) ** (1.0 / 3.0)
        program = "G21 G90\nT1 M6 G43\nG0 X10 Y20\nZ3\nZ0\nG1 X60 F600\nG0 Z3\nG4 P2.\nM2\n"
        arguments = ["--tools", "tool.tbl", "--machine", "router.toml", "--work-offset", "X=100,Y=0,Z=-200"]
        self.assertSays(program, f"""
  units          mm, G21 (line 1)
  work offsets   G54 (active at the start)
  tools          T1 (line 2): length 50 mm, diameter 6 mm; used: M6, length
  extent G54     X 10.000 ... 60.000 mm; feeds 10.000 ... 60.000 mm
                 Y 20.000 mm; feeds 20.000 mm
                 Z 0.000 ... 3.000 mm; feeds 0.000 mm
  machine        X 110.000 ... 160.000 mm
                 Y 20.000 mm
                 Z -150.000 ... -147.000 mm
  cycle time     {2.0 + feed + 2.0 * rapid:.1f} s on router
                 without 2 moves from unknown positions (lines 3, 4), 1 tool change
  read by        linuxcnc, fanuc, haas, mach
  not read by    grbl: part.ngc:2:7: G43 is not supported by grbl
""", *arguments)
        time = self.json(program, *arguments)["cycle_time"]
        self.assertAlmostEqual(time["s"], 2.0 + feed + 2.0 * rapid, delta=1e-3)
        self.assertEqual(time["left_out_lines"], [3, 4])

    def test_units(self):
        self.assertEqual(self.lines("G0 X1\nM2\n", "units"), ["no G20 or G21: unit of the control; mm is assumed"])
        self.assertEqual(self.lines("G20 G0 X1\nM2\n", "units"), ["inch, G20 (line 1)"])
        self.assertEqual(self.lines("G20 G0 X1\nG21 X1\nG20\nM2\n", "units"),
                         ["inch, G20 (line 1)", "mm, G21 (line 2)", "the program changes units"])
        self.assertEqual(self.lines("G20 G0 X1\nM2\n", "extent G54"), ["X 25.400 mm"])

    def test_work_offsets(self):
        self.assertEqual(self.lines("G0 X1\nM2\n", "work offsets"), ["G54 (active at the start)"])
        self.assertEqual(self.lines("G54\nG55\nG0 X1\nG59.3\nX2\nM2\n", "work offsets"), ["G55 (line 2), G59.3 (line 4)"])
        self.assertEqual(self.lines("G10 L2 P1 X5\nG52 Y1\nG92 Z0\nG0 X1\nM2\n", "work offsets"),
                         ["G54 (active at the start)", "changed by G10 (line 1)", "changed by G52 (line 2)",
                          "changed by G92 (line 3)"])
        self.assertEqual(self.lines("G53 G0 X1\nM2\n", "work offsets"), ["none"])

    def test_tools(self):
        program = "T1\nM6\nG43 H3\nG0 X0 Y0\nG41 D2\nG1 X9 F100\nG40 X20\nM2\n"
        self.assertEqual(self.lines(program, "tools"),
                         ["T1 (line 1): unknown: no tool table given; used: M6",
                          "T2 (line 5): unknown: no tool table given; used: diameter",
                          "T3 (line 3): unknown: no tool table given; used: length"])
        tools = ["--tools", "tool.tbl"]
        self.assertEqual(self.lines("T2 M6 G43\nG0 Z1\nT9\nM2\n", "tools", *tools, status=2),
                         ["T2 (line 1): length 80 mm; used: M6, length", "T9 (line 3): unknown: not in the tool table"])
        self.assertEqual(self.lines("G0 X1\nM2\n", "tools"), ["none"])
        self.assertEqual(self.json("T1 M6 G43\nG0 Z1\nM2\n", "--tool-length", "1=12.5")["tools"],
                         [{"number": 1, "line": 1, "in_table": True, "length_mm": 12.5, "diameter_mm": None, "loaded": True,
                           "uses_length": True, "uses_diameter": False}])

    # The circle about (10, 0) from (0, 0) clockwise to (20, 0) goes through (10, 10).
    def test_extent_holds_the_extreme_points_of_arcs(self):
        program = "G0 X0 Y0\nG2 X20 Y0 I10 F100\nM2\n"
        self.assertEqual(self.lines(program, "extent G54"),
                         ["X 0.000 ... 20.000 mm; feeds 0.000 ... 20.000 mm", "Y 0.000 ... 10.000 mm; feeds 0.000 ... 10.000 mm"])
        machine = self.lines(program, "machine", "--work-offset", "X=100,Y=-5")
        self.assertEqual(machine, ["X 100.000 ... 120.000 mm", "Y -5.000 ... 5.000 mm"])
        turned = self.lines(program, "machine", "--work-offset", "X=0,Y=0,R=90")
        self.assertEqual(turned, ["X -10.000 ... 0.000 mm", "Y 0.000 ... 20.000 mm"])

    def test_positions_that_nothing_names_are_unknown(self):
        self.assertEqual(self.lines("G91 G0 X5\nM2\n", "not in it"), ["X moves to an unknown position (line 1)"])
        after = "G0 X5\nG28 X5\nG91 X1\nG90 X7\nM2\n"  # home is where the control has stored it
        self.assertEqual(self.lines(after, "not in it"), ["X moves to an unknown position (line 3)"])
        self.assertEqual(self.lines(after, "extent G54"), ["X 5.000 ... 7.000 mm"])
        work_offset = ["--work-offset", "X=10"]
        self.assertEqual(self.lines(after, "machine", *work_offset),
                         ["X 15.000 ... 17.000 mm; unknown from line 2 on: needs --work-offset"])

    def test_places_of_the_machine_are_known_without_a_work_offset(self):
        program = "G53 G0 Z-5\nG0 X1\nM2\n"
        self.assertEqual(self.lines(program, "machine"), ["X unknown from line 2 on: needs --work-offset", "Z -5.000 mm"])
        self.assertEqual(self.lines(program, "extent G54"), ["X 1.000 mm"])

    def test_a_shift_from_an_unknown_position_hides_the_machine(self):
        program = "G92 X0\nG0 X5\nM2\n"
        self.assertEqual(self.lines(program, "extent G54"), ["X 5.000 mm"])
        self.assertEqual(self.lines(program, "machine", "--work-offset", "X=10"),
                         ["X unknown from line 2 on: needs --work-offset"])
        known = "G0 X1\nG92 X0\nG0 X5\nM2\n"
        self.assertEqual(self.lines(known, "machine", "--work-offset", "X=10"), ["X 11.000 ... 16.000 mm"])

    # Drilled from a height that nothing names: the tool may go back there.
    def test_the_height_before_a_cycle(self):
        program = "G98 G0 X1 Y2\nG81 Z-3 R1 F100\nG80\nM2\n"
        self.assertEqual(self.lines(program, "extent G54")[-1], "Z -3.000 ... 1.000 mm; feeds -3.000 ... 1.000 mm")
        self.assertEqual(self.lines(program, "not in it"), ["Z moves to an unknown position (line 2)"])

    def test_cycle_time_is_unknown_where_it_cannot_be_planned(self):
        def time(program, *more):
            return self.lines(program, "cycle time", "--machine", "router.toml", *more)
        self.assertEqual(time("G0 C90\nM2\n"), ["unknown: line 1 moves C, but the machine has no such axis"])
        self.assertEqual(time("G0 X0\nG95 S100 G1 X1 F0.1\nM2\n"), ["unknown: line 2 feeds per revolution with the spindle off"])
        self.assertEqual(time("G0 X0 Y0 Z5\nG1 X1\nG1 X2 F100\nM2\n"),
                         ["unknown: the feed of line 2 is unknown; if no F precedes it, pass --feed"])
        self.write("router.toml", ROUTER.replace('j_max = "30 m/s^3"\n[axis.Z]', "[axis.Z]"))
        self.assertEqual(time("G0 X0\nX1\nM2\n"), ["unknown: the machine file lacks v_max, a_max or j_max of Y"])

    def test_conversational_programs_in_their_own_words(self):
        program = ("BEGIN PGM P MM\nTOOL CALL 1 Z S1000\nL X+0 Y+5 Z+9 FMAX M3\n"
                   "CYCL DEF 251 RECTANGULAR POCKET Q218=9\nL X+10 Y+5 FMAX M99\nL X+20 Y+5 Z+9 FMAX\n"
                   "END PGM P MM\n")
        self.assertEqual(self.lines(program, "units"), ["mm, BEGIN PGM MM (line 1)"])
        self.assertEqual(self.lines(program, "work offsets"), ["preset 1 (active at the start)"])
        self.assertEqual(self.lines(program, "tools"),
                         ["T1 (line 2): unknown: no tool table given; used: TOOL CALL, length"])
        self.assertEqual(self.lines(program, "preset 1"),
                         ["X 0.000 ... 20.000 mm", "Y 5.000 mm", "Z 9.000 mm"])
        self.assertEqual(self.lines(program, "not read by"),
                         ["controls for G-code: this is Heidenhain conversational"])
        found = self.json(program)
        self.assertEqual(found["units"], [{"word": "BEGIN PGM MM", "line": 1}])
        self.assertEqual(list(found["extent"]["work"]), ["preset 1"])
        warnings = self.check(program).stderr
        self.assertIn("extent and cycle time exclude its moves", warnings)
        self.assertNotIn("LinuxCNC", warnings)

    # What a pocket cycle moves is not known, so neither is the time: 10 mm at F600 is a part of it.
    # A cycle that is defined and not called moves nothing.
    def test_time_with_moves_that_are_not_known(self):
        def program(call):
            return ("BEGIN PGM P MM\nL X+0 Y+5 Z+9 A+0 C+0 FMAX\nCYCL DEF 251 RECTANGULAR POCKET Q218=9\n"
                    f"L X+10 F600{call}\nL X+0 Y+5 Z+9 FMAX{call}\nTCH PROBE 412 Q321=+0\nEND PGM P MM\n")
        time = self.json(program(" M99"), "--machine", "router.toml")["cycle_time"]
        self.assertIsNone(time["s"])
        self.assertEqual(time["unknown_moves"], [{"of": "CYCL DEF 251", "lines": [4, 5]}, {"of": "TCH PROBE", "lines": [6]}])
        least = 1.0 + 2.0 * (0.01 / 30.0) ** 0.5
        self.assertAlmostEqual(time["at_least_s"], least, delta=1e-3)
        self.assertEqual(self.lines(program(" M99"), "cycle time", "--machine", "router.toml")[:3],
                         [f"unknown: at least {least:.1f} s on router", "the moves of CYCL DEF 251 are not known (lines 4, 5)",
                          "the moves of TCH PROBE are not known (line 6)"])
        known = self.json(program("").replace("TCH PROBE 412 Q321=+0\n", ""), "--machine", "router.toml")["cycle_time"]
        self.assertEqual(known["unknown_moves"], [])
        self.assertEqual(known["s"], known["at_least_s"])

    # F 468.97... mm/min is a feed like any other, although surveys once took it for an unknown one.
    def test_a_feed_is_unknown_by_the_move(self):
        def time(program):
            return self.json(program, "--machine", "router.toml")["cycle_time"]
        for feed in (740.740734, 29.16302890 * 25.4):
            known = time(f"G21 G90 G0 X0 Y0 Z0\nG1 X10 F{feed}\nM2\n")
            self.assertAlmostEqual(known["s"], 600.0 / feed, delta=0.1)
        unknown = time("G21 G90 G0 X0 Y0 Z0\nG1 X10\nX20 F600\nM2\n")
        self.assertIsNone(unknown["s"])
        self.assertIn("the feed of line 2 is unknown", unknown["why_unknown"])

    # The run begins where the program has named all axes.
    def test_cycle_time_is_that_of_a_run(self):
        arcs = "".join(f"G1 X{10 + i} Y{i % 3}\nG2 X{11 + i} Y{i % 3} I0.5 J0\n" for i in range(40))
        program = f"G21 G90 G0 X10 Y0\nZ3\nG1 Z0 F2000\n{arcs}G0 Z3\nG4 P0.5\nG1 X-20 F900\nM2\n"
        with open(os.path.join(HERE, "gallery", "machine.toml"), encoding="utf-8") as file:
            self.write("machine.toml", file.read())
        checked = self.json(program, "--machine", "machine.toml")["cycle_time"]
        self.assertEqual(checked["left_out_lines"], [1, 2])
        self.write("scenario.toml", """machine = "machine.toml"
[program]
file = "part.ngc"
start = { X_mm = 10.0, Y_mm = 0.0, Z_mm = 3.0 }
[[case]]
name = "one"
servo = "ideal"
[[quantity]]
name = "cycle_time"
""")
        done = subprocess.run([SERVOMILL, "run", "scenario.toml", "-q"], cwd=self.folder, check=True, capture_output=True, text=True,
                              timeout=PATIENCE)
        shown = subprocess.run([SERVOMILL, "compare", "scenario.h5", "--json"], cwd=self.folder, check=True,
                               capture_output=True, text=True, timeout=PATIENCE)
        self.assertEqual(done.stderr, "")
        self.assertAlmostEqual(checked["s"], json.loads(shown.stdout)[0]["value"], delta=1e-6)

    def test_says_which_controls_read_a_program_and_what_stops_the_others(self):
        program = "G0 X1 N5\nG0 X2 /2\n"
        lines = self.check("G21\nG0 X1\n", status=0).stdout.splitlines()
        self.assertEqual(lines[-4:], ["  read by        mach, grbl",
                                      "  not read by    linuxcnc: part.ngc:2: the program ends without M2, M30 or a closing '%'",
                                      "                 fanuc: part.ngc:2: the program ends without M2, M30 or a closing '%'",
                                      "                 haas: part.ngc:2: the program ends without M2, M30 or a closing '%'"])
        readers = self.json("G21\nG0 X1\n")["readers"]
        self.assertEqual(readers["grbl"], {"reads": True})
        self.assertEqual(readers["haas"], {"reads": False, "file": "part.ngc", "line": 2, "column": 0,
                                           "why": "the program ends without M2, M30 or a closing '%'"})
        self.assertEqual(self.lines(program, "read by", status=2), ["none of the controls"])

    def test_reads_up_to_the_first_fault(self):
        done = self.check("G0 X1\nX2\nG1 X3 Q\nX4\nM2\n", status=2)
        self.assertEqual(done.stderr, "part.ngc:3:8: error: expected a value after Q, found the end of the line\n")
        self.assertIn("  read           up to line 3, which has the first fault\n", done.stdout)
        self.assertIn("  extent G54     X 1.000 ... 2.000 mm\n", done.stdout)

    def test_json_of_a_program_that_is_refused_before_its_first_block(self):
        said = self.json("%PART G71 *\nN10 G90\nN20 G0 X1\n", status=2)
        self.assertEqual(said["first_fault_line"], 1)

    def test_quiet_says_nothing_of_a_right_program(self):
        done = self.check("G21 G0 X1.\nM2\n", "--quiet")
        self.assertEqual((done.stdout, done.stderr), ("", ""))

    def test_json_of_a_whole_program(self):
        self.assertEqual(self.json("G21 G54\nG0 X1 Z2\nG1 X4 F100\nM0\nM2\n", "--work-offset", "X=10"), {
            "file": "part.ngc",
            "units": [{"word": "G21", "line": 1}],
            "work_offsets": [{"word": "G54", "line": 1}],
            "offsets_changed_by": [],
            "tools": [],
            "extent": {"work": {"G54": {"motion": {"X": [1, 4], "Z": [2, 2]}, "feed": {"X": [1, 4], "Z": [2, 2]}}},
                       "machine": {"X": [11, 14]}, "unknown_from_line": {"Z": {"work": None, "machine": 2}},
                       "unknown_additional_offsets": [], "tcp_controlled_from_line": None},
            "cycle_time": None,
            "tool_changes": 0,
            "stops": 1,
            "readers": {name: {"reads": True} for name in CONTROLS.split(", ")},
            "first_fault_line": None})

    # G54.1 P3 without its offset: an extent of its own, and no machine coordinates
    def test_an_additional_work_offset_that_is_not_given(self):
        program = "G21 G90\nG54.1 P3\nG0 X0 Y0\nG1 X10. F100.\nG54\nG0 X99.\nM30\n"
        fanuc = ["--reader", "fanuc"]
        self.assertEqual(self.lines(program, "work offsets", *fanuc), ["G54.1 P3 (line 2), G54 (line 5)"])
        self.assertEqual(self.lines(program, "extent G54.1 P3", *fanuc),
                         ["X 0.000 ... 10.000 mm; feeds 0.000 ... 10.000 mm", "Y 0.000 mm; feeds 0.000 mm"])
        self.assertEqual(self.lines(program, "extent G54", *fanuc), ["X 99.000 mm"])
        needs = "unknown from line 3 on: needs --work-offset and --additional-offset P3"
        self.assertEqual(self.lines(program, "machine", *fanuc), ["X " + needs, "Y " + needs])
        self.assertEqual(self.lines(program, "machine", "--work-offset", "X=100", *fanuc)[0], "X 199.000 mm; " + needs)
        given = ["--additional-offset", "P3:X=50,Y=7,Z=0", "--work-offset", "X=100,Y=0"]
        self.assertEqual(self.lines(program, "machine", *given, *fanuc), ["X 50.000 ... 199.000 mm", "Y 7.000 mm"])
        self.assertEqual(self.lines(program, "extent G54.1 P3", *given, *fanuc)[0], "X 0.000 ... 10.000 mm; feeds 0.000 ... 10.000 mm")
        self.assertEqual(self.lines(program, "read by", *fanuc), ["fanuc, haas"])
        self.assertEqual(self.check(program, *fanuc).stderr.count("this work offset is unknown"), 1)
        self.assertEqual(self.json(program, *fanuc)["extent"]["unknown_additional_offsets"], [3])

    # The tip of tilted planes and tool-centre-point control stands in work coordinates.
    def test_tilted_planes_and_tool_centre_point_control_without_a_machine(self):
        program = ("G21 G90 G17\nT1 M6\nG54\nG43 H1\nG0 X1. Y2. Z50.\nG68.2 X0. Y0. Z0. I0. J30. K0.\nG53.1\nG0 X3. Y4.\n"
                   "G1 Z-1. F100.\nG69\nG43.4 H1\nG0 X5. Y0. Z9. B10.\nG1 X8. B20. F500.\nG49\nG53 G0 Z0.\nG0 X7.\nM30\n")
        fanuc = ["--reader", "fanuc"]
        done = self.check(program, *fanuc)
        self.assertIn("G53.1: the rotary axis positions depend on the machine; pass it with --machine", done.stderr)
        self.assertEqual(self.lines(program, "extent G54", *fanuc),
                         ["X 1.000 ... 8.000 mm; feeds 5.000 ... 8.000 mm", "Y 0.000 ... 2.000 mm; feeds 0.000 mm",
                          "Z 9.000 ... 50.000 mm; feeds 9.000 mm", "B 10.000 ... 20.000 deg; feeds 10.000 ... 20.000 deg"])
        self.assertEqual(self.lines(program, "not in it", *fanuc), ["Z moves to an unknown position (line 8)", "moves in a tilted work plane (line 8)"])
        machine = self.lines(program, "machine", "--work-offset", "X=0,Y=0,Z=0,B=0", "--tool-length", "1=50", *fanuc)
        self.assertEqual(machine[0], "X 1.000 ... 7.000 mm; unknown from line 8 on: needs --work-offset")
        self.assertEqual(machine[-1], "X, Y and Z unknown under TCP control and in a tilted plane (line 8): "
                                      "simulate them with a scenario")
        self.assertIn("fanuc", self.lines(program, "read by", *fanuc)[0])
        self.assertIn("G43.5 requires I J K in its first move",
                      self.check("G21 G90\nT1 M6\nG43.5 H1\nG1 X1. F100.\nM30\n", *fanuc, status=2).stderr)

    # M140 MB MAX goes to the end of travel, which only a machine file has.
    def test_a_retract_to_the_end_of_travel(self):
        program = ("BEGIN PGM A MM\nTOOL CALL 1 Z S100\nL Z+5 R0 FMAX\nL M140 MB MAX\nL X+1 FMAX\nL Z+2 FMAX\nL M30\n"
                   "END PGM A MM\n")
        lines = self.lines(program, "machine", "--work-offset", "X=0,Z=0", "--tool-length", "1=50")
        self.assertEqual(lines, ["X 1.000 mm", "Z 52.000 ... 55.000 mm; unknown from line 4 on: needs --work-offset, --machine and "
                                               "the tool lengths"])
        self.write("router.toml", ROUTER.replace("[axis.Z]\n", "[axis.Z]\ntravel_mm = [-300.0, 400.0]\n"))
        self.assertEqual(self.lines(program, "machine", "--work-offset", "X=0,Z=0", "--tool-length", "1=50", "--machine", "router.toml"),
                         ["X 1.000 mm", "Z 52.000 ... 400.000 mm"])
        self.assertIn("heidenhain", self.lines(program, "read by")[0])

    # M82 is the builder's: --ignore-code, program.ignore_codes of a scenario, nc.ignore_codes of a machine
    def test_codes_that_are_left_out(self):
        program = "G21 G90\nM82\nG0 X10. Y0. Z3.\nG1 X20. F600.\nM2\n"
        refused = self.check(program, status=2).stderr
        self.assertIn("part.ngc:2:1: error: ", refused)
        self.assertEqual(self.lines(program, "extent G54", "--ignore-code", "M82")[0], "X 10.000 ... 20.000 mm; feeds 10.000 ... 20.000 mm")
        with open(os.path.join(HERE, "gallery", "machine.toml"), encoding="utf-8") as file:
            machine = file.read()
        scenario = 'machine = "machine.toml"\n[program]\nfile = "part.ngc"\n{}[[case]]\nname = "one"\nservo = "ideal"\n'

        def faults(key, of_machine=""):
            self.write("machine.toml", machine.replace("[nc]\n", "[nc]\n" + of_machine))
            self.write("scenario.toml", scenario.format(key))
            return subprocess.run([SERVOMILL, "check", "scenario.toml", "--quiet"], cwd=self.folder, capture_output=True, text=True,
                                  timeout=PATIENCE, check=False).stderr
        self.assertEqual(faults(""), refused[refused.index("part.ngc:2:1: error"):])
        self.assertNotIn("error", faults('ignore_codes = ["M82"]\n'))
        self.assertIn('scenario.toml:4:16: error: program.ignore_codes', faults('ignore_codes = ["M3"]\n'))
        self.assertIn("M3: is a standard code and cannot be ignored", faults('ignore_codes = ["M3"]\n'))
        self.assertIn("82: must be an M code of the machine builder, such as M82", faults('ignore_codes = ["82"]\n'))
        self.assertNotIn("error", faults("", 'ignore_codes = ["M82"]\n'))
        self.assertIn("part.ngc:2:1: error", faults("ignore_codes = []\n", 'ignore_codes = ["M82"]\n'))
        done = self.check(program, "--machine", "machine.toml", status=0)
        self.assertNotIn("error", done.stderr)

    def test_a_work_offset_of_an_axis_that_the_machine_lacks(self):
        done = self.check("G0 X1\nM2\n", "--machine", "router.toml", "--work-offset", "C=5", status=2)
        self.assertEqual(done.stderr, "--work-offset C=5: error: the machine has no axis C\n")


if __name__ == "__main__":
    unittest.main()
