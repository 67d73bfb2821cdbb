#!/usr/bin/python3
"""tools/conformance compares servomill with rs274: here with a stand-in that says what rs274 said of a few programs, and
with the real one where it is installed.

    conformance_test.py SERVOMILL
"""
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))
import rs274  # noqa: E402

SERVOMILL = pathlib.Path(sys.argv.pop(1)).resolve()
PROGRAMS = ROOT / "tests" / "conformance" / "programs"

# Says the recording PROGRAM.said that lies in the folder of this script: "LINE CALL" is a canonical call of a line, which
# is printed with the N word that the line has; "LINE error MESSAGE" ends as rs274 does, "LINE sleep" does not.
STAND_IN = '''#!/usr/bin/python3
import pathlib, re, sys, time
program = pathlib.Path(sys.argv[-1])
lines = program.read_text().split("\\n")
for count, said in enumerate((pathlib.Path(__file__).parent / (program.stem + ".said")).read_text().splitlines(), 1):
    line, call = said.split(" ", 1)
    text = lines[int(line) - 1]
    word = re.match(r"N(\\d+)", text)
    if call == "sleep":
        time.sleep(60)
    if call.startswith("error "):
        print(call[6:], text, sep="\\n", file=sys.stderr)
        sys.exit(1)
    print(f"{count:5} N{word[1] if word else '.....'} {call}")
'''


class StandIn(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.home = pathlib.Path(self.folder.name)
        self.programs = self.home / "programs"
        self.programs.mkdir()
        self.rs274 = self.home / "rs274"
        self.rs274.write_text(STAND_IN)
        self.rs274.chmod(0o700)

    def program(self, name, text, *said):
        path = self.programs / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)
        (self.home / f"{path.stem}.said").write_text("".join(line + "\n" for line in said))
        return path

    def compare(self, *options, command=f"{SERVOMILL} canon"):
        done = subprocess.run([ROOT / "tools" / "conformance", self.programs, "--rs274", self.rs274, "--command", command,
                               *map(str, options)], capture_output=True, text=True)
        return done.returncode, done.stdout, done.stderr

    def says(self, status, lines, *options, **more):
        self.assertEqual(self.compare(*options, **more), (status, "".join(line + "\n" for line in lines), ""))


MOVES = ("1 STRAIGHT_TRAVERSE(1.0000, 2.0000, 0.0000, 0.0000, 0.0000, 0.0000)", "2 SET_FEED_RATE(100.0000)",
         "2 ARC_FEED(3.0000, 2.0000, 2.0000, 2.0000, -1, 0.0000, 0.0000, 0.0000, 0.0000)", "3 PROGRAM_END()")


class Outcomes(StandIn):
    def test_same(self):
        self.program("arc.ngc", "G0 X1 Y2\nG2 X3 I1 F100\nM2\n", *MOVES)
        self.says(0, ["arc.ngc: same", "1 programs, 1 same, 0 both refuse, 0 refused on purpose, 0 different"])
        self.says(0, ["1 programs, 1 same, 0 both refuse, 0 refused on purpose, 0 different"], "--quiet")

    def test_both_refuse(self):
        self.program("bad.ngc", "G0 X1\nG1 X2\nM2\n", "1 STRAIGHT_TRAVERSE(1.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000)",
                     "2 error Cannot do g1 with zero feed rate")
        self.says(0, ["bad.ngc: both refuse, line 2", "1 programs, 0 same, 1 both refuse, 0 refused on purpose, 0 different"])

    def test_another_end_point(self):
        self.program("end.nc", "G0 X1\nM2\n", "1 STRAIGHT_TRAVERSE(1.5000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000)",
                     "2 PROGRAM_END()")
        self.says(1, ["end.nc: record 1 (line 1), end: rs274 [1.5, 0, 0, 0, 0, 0], servomill [1, 0, 0, 0, 0, 0]",
                      "1 programs, 0 same, 0 both refuse, 0 refused on purpose, 1 different"])

    def test_another_line(self):
        self.program("line.tap", "G0 X1\nG4 P1\n(M2)\nM2\n", "2 STRAIGHT_TRAVERSE(1.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000)",
                     "2 DWELL(1.0000)", "4 PROGRAM_END()")
        self.says(1, ["line.tap: record 1 (line 2), line: rs274 2, servomill 1",
                      "1 programs, 0 same, 0 both refuse, 0 refused on purpose, 1 different"])

    def test_only_servomill_goes_on(self):
        self.program("more.ngc", "G0 X1\nG0 X2\nM2\n", "1 error Bad character '?' used")
        self.says(1, ["more.ngc: record 1 (line 1), t: rs274 error, line 1: Bad character '?' used, servomill rapid, line 1",
                      "1 programs, 0 same, 0 both refuse, 0 refused on purpose, 1 different"])

    def test_errors_at_different_lines(self):
        self.program("bad.ngc", "G1 X2\nM2\n", "2 error Something else")
        self.says(1, ["bad.ngc: record 1 (line 2), line: rs274 2, servomill 1",
                      "1 programs, 0 same, 0 both refuse, 0 refused on purpose, 1 different"])

    def test_refused_on_purpose(self):
        self.program("surface_speed.ngc", "S100 M3\nG96 S10 (G1)\nM2\n", "1 SET_SPINDLE_SPEED(0, 100.0000)",
                     "1 START_SPINDLE_CLOCKWISE(0)", "2 SET_SPINDLE_MODE(0 10.0000)", "3 PROGRAM_END()")
        self.says(0, ["surface_speed.ngc: refused on purpose: G96, line 2",
                      "1 programs, 0 same, 0 both refuse, 1 refused on purpose, 0 different"])
        self.assertEqual(self.compare("--filter", "none")[0], 1)
        self.assertEqual(self.compare("--filter", "G76,G96")[0], 0)

    def test_not_refused_on_purpose_where_something_differs_before(self):
        self.program("thread.ngc", "G0 X1\nG33 Z-1 K1 F10\nM2\n", "1 STRAIGHT_TRAVERSE(2.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000)",
                     "3 PROGRAM_END()")
        self.assertEqual(self.compare()[0], 1)

    def test_programs_without_end(self):
        self.program("endless.ngc", "O1 WHILE [1]\nO1 ENDWHILE\n", "1 sleep")
        self.says(0, ["endless.ngc: rs274 and servomill did not end in 0.1 s",
                      "1 programs, 1 same, 0 both refuse, 0 refused on purpose, 0 different"],
                  "--timeout", 0.1, command="/usr/bin/python3 -c 'import time; time.sleep(60)'")

    def test_moves_of_no_length_are_free(self):
        self.program("null.ngc", "G0 X1 Y2\nG2 X3 I1 F100\nM2\n", MOVES[0], "2 SET_FEED_RATE(100.0000)",
                     "2 STRAIGHT_FEED(1.0000, 2.0000, 0.0000, 0.0000, 0.0000, 0.0000)", *MOVES[2:])
        self.assertEqual(self.compare()[0], 0)

    def test_a_chosen_part_of_a_tree(self):
        self.program("a.ngc", "M2\n", "1 PROGRAM_END()")
        self.program("below/b.ngc", "M2\n", "1 PROGRAM_END()")
        self.program("below/lathe_c.ngc", "M2\n", "1 PROGRAM_END()")
        count = "{} programs, {} same, 0 both refuse, 0 refused on purpose, 0 different"
        self.says(0, ["a.ngc: same", count.format(1, 1)])
        self.says(0, ["a.ngc: same", "below/b.ngc: same", "below/lathe_c.ngc: same", count.format(3, 3)], "--recursive")
        self.says(0, ["a.ngc: same", "below/b.ngc: same", count.format(2, 2)], "--recursive", "--without", "lathe*")
        listed = self.home / "listed"
        listed.write_text("# not ours\nlathe*   # turning\n*/below/b*\n")
        self.says(0, ["a.ngc: same", count.format(1, 1)], "--recursive", "--without-listed", listed)


class Mistakes(StandIn):
    def refuses(self, message, *options):
        self.assertEqual(self.compare(*options), (2, "", message + "\n"))

    def test_no_programs(self):
        self.refuses(f"conformance: error: there are no programs (*.ngc, *.nc, *.tap) in {self.programs}")

    def test_missing_files(self):
        self.refuses("conformance: error: no.tbl does not exist", "--tools", "no.tbl")
        self.refuses("conformance: error: nowhere does not exist", "nowhere")

    def test_no_rs274(self):
        self.program("a.ngc", "M2\n", "1 PROGRAM_END()")
        self.rs274.unlink()
        self.refuses(f"conformance: error: rs274 was not found at {self.rs274}: install Debian's linuxcnc-uspace, "
                     "or give the path with --rs274 or $RS274")


def records(*calls):
    return list(rs274.Canon().records("".join(f"    1 N..... {call}\n" for call in calls)))


class Records(unittest.TestCase):
    """The state behind canonical calls."""

    def test_inches_become_mm(self):
        move, = records("USE_LENGTH_UNITS(CANON_UNITS_INCHES)", "SET_FEED_RATE(10.0000)",
                        "STRAIGHT_FEED(1.0000, 0.0000, 0.0000, 90.0000, 0.0000, 0.0000)")
        self.assertEqual((move["end"], move["feed"]), ([25.4, 0.0, 0.0, 90.0, 0.0, 0.0], 254.0))

    def test_feed_keeps_its_value_when_the_unit_changes(self):
        move, = records("SET_FEED_RATE(100.0000)", "USE_LENGTH_UNITS(CANON_UNITS_INCHES)",
                        "STRAIGHT_FEED(1.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000)")
        self.assertEqual(move["feed"], 100.0)

    def test_feed_of_rotary_axes_alone_is_in_degrees(self):
        move, = records("USE_LENGTH_UNITS(CANON_UNITS_INCHES)", "SET_FEED_RATE(10.0000)",
                        "STRAIGHT_FEED(0.0000, 0.0000, 0.0000, 90.0000, 0.0000, 0.0000)")
        self.assertEqual(move["feed"], 10.0)

    def test_feed_modes(self):
        move = "STRAIGHT_FEED(1.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000)"
        found = records('COMMENT("interpreter: feed mode set to inverse time")', "SET_FEED_MODE(0, 0)", move,
                       'COMMENT("interpreter: feed mode set to units per revolution")', "SET_FEED_MODE(0, 1)", move,
                       'COMMENT("interpreter: feed mode set to units per minute")', "SET_FEED_MODE(0, 0)", move)
        self.assertEqual([record["fmode"] for record in found], ["inv", "upr", "upm"])

    def test_machine_coordinates_turn_after_the_shift(self):
        move, = records("SET_G5X_OFFSET(1, 10.0000, 20.0000, 0.0000, 0.0000, 0.0000, 0.0000)",
                        "SET_G92_OFFSET(1.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000)", "SET_XY_ROTATION(90.0000)",
                        "USE_TOOL_LENGTH_OFFSET(0.0000 0.0000 5.0000, 0.0000 0.0000 0.0000, 0.0000 0.0000 0.0000)",
                        "STRAIGHT_TRAVERSE(2.0000, 0.0000, 1.0000, 0.0000, 0.0000, 7.0000)")
        for found, wanted in zip(move["mend"], [10.0, 23.0, 6.0, 0.0, 0.0, 7.0]):
            self.assertAlmostEqual(found, wanted, delta=1e-14)    # one cosine

    def test_planes_order_the_axes_of_arcs(self):
        arc = "ARC_FEED(1.0000, 2.0000, 3.0000, 4.0000, 2, 5.0000, 0.0000, 0.0000, 0.0000)"
        ends = {"XY": [1.0, 2.0, 5.0], "YZ": [5.0, 1.0, 2.0], "XZ": [2.0, 5.0, 1.0]}
        for plane, end in ends.items():
            move, = records(f"SELECT_PLANE(CANON_PLANE_{plane})", arc)
            self.assertEqual((move["end"][:3], move["plane"], move["center"], move["turns"]), (end, plane, [3.0, 4.0], 2))

    def test_prints_and_messages(self):
        found = list(rs274.Canon().records('    1 N7 MESSAGE("  two   words")\nbare   text\n'))
        self.assertEqual(found, [{"t": "msg", "line": 7, "text": "two words"}, {"t": "print", "text": "bare text"}])

    def test_stops_of_a_standing_spindle_count_unless_an_end_or_a_tool_change_makes_them(self):
        found = records("STOP_SPINDLE_TURNING(0)", "SET_SPINDLE_SPEED(0, 9.0000)", "START_SPINDLE_CLOCKWISE(0)", "START_CHANGE()",
                       "STOP_SPINDLE_TURNING(0)", "CHANGE_TOOL(0)", "START_CHANGE()", "STOP_SPINDLE_TURNING(0)", "CHANGE_TOOL(0)",
                       "STOP_SPINDLE_TURNING(0)", "SET_SPINDLE_MODE(0 0.0000)", "PROGRAM_END()")
        self.assertEqual([record.get("dir", record["t"]) for record in found], [0, "spindle", 1, 0, "tool", "tool", "end"])

    def test_lines_are_not_known_under_cutter_compensation(self):
        found = list(rs274.Canon().records("""    1 N5 COMMENT("interpreter: cutter radius compensation on left")
    2 N6 DWELL(1.0000)
    3 N7 COMMENT("interpreter: cutter radius compensation off")
    4 N7 DWELL(1.0000)
"""))
        self.assertEqual([record.get("line") for record in found], [None, 7])

    def test_lines_get_n_words(self):
        program = b"%\n/ g0 x1\n\nn5.5 g1 (a)\n  o1 if [1]\nn12. x1\n%\n" + b"(" + b"a" * 251 + b"\n"
        self.assertEqual(rs274.numbered(program, 3).split(b"\n")[:7],
                         [b"%", b"/N3000002 g0 x1", b"", b"N3000004 g1 (a)", b"N3000005 o1 if [1]", b"n12. x1", b"%"])
        self.assertEqual(rs274.numbered(program, 3).split(b"\n")[7], b"(" + b"a" * 251)


def installed():
    try:
        return rs274.find()
    except rs274.Missing:
        return None


@unittest.skipUnless(installed(), "rs274 is not installed")
class Live(unittest.TestCase):
    def test_records_are_those_in_the_repository(self):
        with rs274.Interpreter() as interpreter:
            for name in ("arcs_planes", "sub_error_inside", "file_sub"):
                found = interpreter.records(PROGRAMS / f"{name}.ngc", tools=PROGRAMS / "tools.tbl", subs=PROGRAMS / "subs")
                wanted = [json.loads(line) for line in (PROGRAMS / f"{name}.jsonl").read_text().splitlines()]
                self.assertEqual([rs274.without(record, "msg") for record in found], wanted)


if __name__ == "__main__":
    unittest.main(verbosity=1)
