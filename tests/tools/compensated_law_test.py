#!/usr/bin/env python3
"""A constant error shifts a program, and changes nothing else of it: every program of the conformance corpus, as far as
it can be corrected, makes the same canonical moves before and after `servomill compensate`, but for the shift. A rapid
shifts the axes that it moves; what it leaves, a short feed brings to the path before the next feed.

    compensated_law_test.py SERVOMILL
"""
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAMS = ROOT / "tests/conformance/programs"
MACHINE = ROOT / "scenarios/machines/router_3axis.toml"
SHIFT = (0.1, 0.05, 0.02)  # mm: minus the errors below
ERRORS = "[errors.c]\nEXX = { constant_um = -100.0 }\nEYX = { constant_um = -50.0 }\nEZX = { constant_um = -20.0 }\n"
OFFSETS = "5220 1\n5221 500\n5222 400\n5223 -100\n5241 600\n5242 300\n5243 -95\n5250 12.5\n"
PRINTED = 2e-5  # mm: half of a step of the printed decimals, at both ends
# Not for comparing: places of the machine (G28, G30, G53) stay where they are; a helix on which C turns as well becomes
# lines.
PLACES = re.compile(r"G\s*(28|30|53)", re.IGNORECASE)
LEFT = {"comp_entry.ngc"}
LEAST_COMPARED = 100
SERVOMILL = None


def run(*words):
    return subprocess.run([SERVOMILL, *map(str, words)], capture_output=True, text=True, timeout=120, check=False)


def moves(records):
    """Motion that goes somewhere, and what else the machine does, in order; messages apart."""
    at = None
    for record in records:
        if record["t"] in ("msg", "print", "coolant"):
            continue
        if record["t"] in ("rapid", "feed"):
            if at is not None and max(abs(p - q) for p, q in zip(at, record["mend"])) < 1e-6:
                continue
        at = record.get("mend", at)
        yield {key: value for key, value in record.items() if key not in ("line", "end", "center")}


def shifted(records):
    """The same moves as the corrected program makes them; the machine begins at zero."""
    at, out = [0.0] * 6, [0.0] * 6
    for record in records:
        if "mend" not in record:
            yield record
            continue
        wanted = [p + s for p, s in zip(at, SHIFT + (0, 0, 0))]
        if record["t"] != "rapid" and max(abs(p - q) for p, q in zip(out, wanted)) > PRINTED:
            yield {"t": "feed", "mend": wanted}
        ends = [p + s for p, s in zip(record["mend"], SHIFT + (0, 0, 0))]
        if record["t"] == "rapid":
            ends = [e if abs(p - q) > 1e-9 else o for e, p, q, o in zip(ends, record["mend"], at, out)]
        at, out = record["mend"], ends
        yield {**record, "mend": ends}


def difference(before, after):
    if before["t"] != after["t"]:
        return f"{before['t']} became {after['t']}"
    for key, value in before.items():
        if key == "mend":
            if max(abs(p - q) for p, q in zip(value, after[key])) > PRINTED:
                return f"ends at {after[key]}, not at {value}"
        elif key == "mcenter":
            continue  # the ends and the turns say it; radii are kept to the printed decimals only
        elif key in ("feed", "sec", "rpm"):
            if abs(value - after[key]) > 1e-4 * abs(value):
                return f"{key} {value} became {after[key]}"
        elif value != after.get(key):
            return f"{key} {value} became {after.get(key)}"
    return ""


class ConstantError(unittest.TestCase):
    def test_shifts_every_program(self):
        compared, wrong = 0, []
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            (folder / "errors.toml").write_text(ERRORS)
            (folder / "offsets.var").write_text(OFFSETS)
            reading = ["--tools", PROGRAMS / "tools.tbl", "--parameter-file", folder / "offsets.var", "--subs",
                       PROGRAMS / "subs"]
            for program in sorted(PROGRAMS.glob("*.ngc")):
                if program.name in LEFT or PLACES.search(program.read_text(encoding="utf-8")):
                    continue
                out = folder / "out.ngc"
                done = run("compensate", program, "--machine", MACHINE, "--errors", folder / "errors.toml", "-f", "-q", "-o",
                           out, "--start", "X=0,Y=0,Z=0", *reading)
                if done.returncode != 0:
                    continue  # refused, with a place
                before = run("canon", program, *reading)
                if before.returncode != 0:
                    continue
                after = run("canon", out, *reading)
                if after.returncode != 0:
                    wrong.append(f"{program.name}: the corrected program is refused: {after.stderr.strip()}")
                    continue
                first = list(shifted(moves(map(json.loads, before.stdout.splitlines()))))
                second = list(moves(map(json.loads, after.stdout.splitlines())))
                compared += 1
                why = next((f"move {i + 1}: {d}" for i, d in enumerate(map(difference, first, second)) if d), "")
                if not why and len(first) != len(second):
                    why = f"{len(first)} moves became {len(second)}"
                if why:
                    wrong.append(f"{program.name}: {why}")
        self.assertGreater(compared, LEAST_COMPARED)
        self.assertEqual(wrong, [], "\n" + "\n".join(wrong))


if __name__ == "__main__":
    SERVOMILL = str(pathlib.Path(sys.argv.pop(1)).resolve())
    unittest.main()
