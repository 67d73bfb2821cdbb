#!/usr/bin/python3
"""Share of the programs of a folder that servomill reads to their end, and each reason of the others.

    read_share.py SERVOMILL [FOLDER]    $SERVOMILL_PROGRAMS where no folder is named

Each file but .md, .stl and .toml is a program, checked without any option. A refusal is one that a user can act on
if it has a reason; one without, or a check that ends otherwise, fails.
"""
import collections
import json
import os
import pathlib
import subprocess
import sys

PATIENCE = 600  # s a program
OTHERS = {".md", ".stl", ".toml", ".py", ".tbl", ".var"}


def checked(servomill, program):
    """(the first fault or None, number of warnings)"""
    done = subprocess.run([servomill, "check", program, "--json"], capture_output=True, text=True, timeout=PATIENCE,
                          check=False)
    if done.returncode not in (0, 2):
        sys.exit(f"{program}: servomill check ends with {done.returncode}: {done.stderr}")
    (said,) = json.loads(done.stdout)
    faults = said["faults"]
    if faults and not faults[0]["message"]:
        sys.exit(f"{program}: refused without a reason")
    return faults[0] if faults else None, len(said["warnings"])


def main():
    servomill = sys.argv[1]
    named = sys.argv[2] if len(sys.argv) > 2 else os.environ.get("SERVOMILL_PROGRAMS")
    if not named:
        sys.exit("not measured: SERVOMILL_PROGRAMS names a folder of programs")
    folder = pathlib.Path(named)
    programs = sorted(path for path in folder.rglob("*") if path.is_file() and path.suffix.lower() not in OTHERS)
    if not programs:
        sys.exit(f"{folder}: no programs")
    reasons, warned = collections.Counter(), 0
    for program in programs:
        fault, warnings = checked(servomill, program)
        warned += warnings > 0
        if fault:
            reasons[fault["message"]] += 1
            print(f"{program}:{fault['line']}: {fault['message']}")
    for reason, count in reasons.most_common():
        print(f"{count} x {reason}")
    read = len(programs) - sum(reasons.values())
    print(f"{read} of {len(programs)} programs read, {warned} with warnings: {100.0 * read / len(programs):.1f} %")


if __name__ == "__main__":
    main()
