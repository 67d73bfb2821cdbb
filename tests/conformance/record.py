#!/usr/bin/env python3
"""Records what LinuxCNC's stand-alone interpreter makes of programs/*.ngc, one PROGRAM.jsonl each.

    record.py ORACLE [PROGRAM.ngc ...]

ORACLE is a script that runs `rs274` and prints its canonical calls as JSON lines, called as
    ORACLE PROGRAM --tool-table TABLE --lines
with the records that controllers/gcode/canon_json.h describes. Standard library only.

Not recorded: path modes and coolant (LinuxCNC says them as separate calls, here they are fields of
other records or states), the pallet shuttle of M30, and stops of a spindle that stands still. Of an
error only its place behind the other records is kept, for the wording is our own.
"""
import json
import pathlib
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent / "programs"
KEPT = {"rapid", "feed", "arc", "dwell", "tool", "spindle", "stop", "end", "msg", "print", "error"}


def meaningful(records):
    """The records that the test compares."""
    turning = False
    for record in records:
        if record["t"] not in KEPT or record.get("kind") == "PALLET_SHUTTLE":
            continue
        if record["t"] == "spindle" and "dir" in record:
            stops_again = record["dir"] == 0 and not turning
            turning = record["dir"] != 0
            if stops_again:
                continue
        if record["t"] == "error":
            record = {"t": "error"}
        if record.get("line", 0) is None:
            del record["line"]
        yield record


def record(oracle, program):
    run = subprocess.run([sys.executable, oracle, program, "--tool-table", HERE / "tools.tbl", "--lines"],
                         stdout=subprocess.PIPE, check=False)
    if run.returncode not in (0, 3):  # 3: the interpreter met an error in the program
        sys.exit(f"{oracle} failed on {program}")
    lines = [json.loads(line) for line in run.stdout.splitlines()]
    text = "".join(json.dumps(r) + "\n" for r in meaningful(lines))
    program.with_suffix(".jsonl").write_text(text)


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    programs = [pathlib.Path(p).resolve() for p in sys.argv[2:]] or sorted(HERE.glob("*.ngc"))
    for program in programs:
        record(sys.argv[1], program)


if __name__ == "__main__":
    main()
