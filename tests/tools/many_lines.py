#!/usr/bin/python3
"""Runs a program of short lines of five axes in three cases (none, table, feedback), recorded every 10 ms.

    many_lines.py SERVOMILL [LINES]      10^7 lines are 7.4 h of motion and 500 MB of text
    many_lines.py --rows SERVOMILL LINES

Prints peak memory, size of the file, speed over all cases, and the processor time of a line beyond a tenth of the lines against that of
the lines before. With --rows, prints the size of the file of two cases (none, table) recorded every millisecond.
"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import time

sys.dont_write_bytecode = True
ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "bench"))
from long_programs import program  # noqa: E402

LINES = 10_000_000
SCENARIO = """\
title   = "Many short lines"
machine = "{machine}"
imposed = "imposed"

[program]
file = "five.ngc"
work_offset = {{ Z_mm = 100.0 }}
start = {{ Z_mm = 160.0 }}

[errors.imposed]
EYX = {{ harmonic = {{ amplitude_um = 1.5, period_mm = 62.0 }} }}
EZX = "EYX"

[record]
period_ms = {period_ms}

[[case]]
name = "none"
[[case.strategy]]
type = "none"

[[case]]
name = "table"
[[case.strategy]]
type = "table"
model = "imposed"
action = "impose"
base_axis = "X"
from_mm = -200.0
to_mm = 250.0
spacing_mm = 3.2768
injection_point = "position_command"
"""
FEEDBACK = """\

[[case]]
name = "feedback"
[[case.strategy]]
type = "feedback"
model = "imposed"
action = "impose"
max_um = 500.0
max_rate_mm_per_s = 10.0
"""


def run(servomill, lines, folder, period_ms=10.0, more_cases=FEEDBACK):
    """Peak memory (bytes), size of the file (bytes), time and processor time (s), and motion (s, of all cases)."""
    with open(folder / "five.ngc", "w", encoding="utf-8") as file:
        file.writelines(line + "\n" for line in program("five", lines))
    machine = ROOT / "scenarios" / "machines" / "hsm600u.toml"
    (folder / "five.toml").write_text(SCENARIO.format(machine=machine, period_ms=period_ms) + more_cases, encoding="utf-8")
    begin = time.monotonic()
    with open(folder / "said", "w", encoding="utf-8") as said:
        process = subprocess.Popen([servomill, "run", "five.toml", "-o", "five.h5"], cwd=folder, stdout=said, stderr=subprocess.STDOUT)
        _, status, used = os.wait4(process.pid, 0)
    took = time.monotonic() - begin
    text = (folder / "said").read_text(encoding="utf-8")
    if os.waitstatus_to_exitcode(status) != 0:
        sys.exit(f"servomill run: {text}")
    motion = sum(float(one) for one in re.findall(r"(\S+) s of motion in", text))
    return 1024 * used.ru_maxrss, (folder / "five.h5").stat().st_size, took, used.ru_utime + used.ru_stime, motion


def print_rows(servomill, lines):
    with tempfile.TemporaryDirectory(dir=".") as folder:
        _, size, _, processor, motion = run(servomill, lines, pathlib.Path(folder), period_ms=1.0, more_cases="")
    print(f"{lines} lines, {motion / 2 / 60:.1f} min of motion in 2 cases: file of {size / 1e6:.0f} MB, {size / (1000 * motion):.1f} bytes a row, "
          f"{processor:.1f} s of the processor")


def main():
    if len(sys.argv) == 4 and sys.argv[1] == "--rows":
        return print_rows(os.path.abspath(sys.argv[2]), int(sys.argv[3]))
    if not 2 <= len(sys.argv) <= 3:
        sys.exit(__doc__)
    servomill = os.path.abspath(sys.argv[1])
    lines = int(sys.argv[2]) if len(sys.argv) == 3 else LINES
    results = []
    for count in (lines // 100, lines // 10, lines):
        with tempfile.TemporaryDirectory(dir=".") as folder:
            results.append(run(servomill, max(100, count), pathlib.Path(folder)))
    few, less, most = results
    memory, size, took, _, motion = most
    early = (less[3] - few[3]) / (lines // 10 - lines // 100)
    late = (most[3] - less[3]) / (lines - lines // 10)
    print(f"{lines} lines, {motion / 3 / 60:.1f} min of motion in 3 cases: {memory / 2**30:.3f} GiB of memory, file of {size / 1e9:.3f} GB, "
          f"{motion / took:.0f} x real time over all cases in {took:.0f} s")
    print(f"a line takes {1e6 * late:.1f} us of the processor behind a tenth of them, {1e6 * early:.1f} us before: {100 * (late / early - 1):+.1f} %")


if __name__ == "__main__":
    main()
