#!/usr/bin/python3
"""Runs a long program (mould_program.py) in four cases and tells what that takes.

    long_program.py SERVOMILL [MINUTES]      270 minutes of motion: 70 000 lines; others in proportion

Prints peak memory, size of the file, speed over all cases, and by how much the memory exceeds that of the same lines in a ninth of
the time (feeds nine times as high): what the plan holds of a line is the same.
"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
LINES, MINUTES = 70000, 270
CASES = 4
SHORTER = 9


def run(servomill, lines, minutes, folder):
    """Peak memory (bytes), size of the file (bytes), time (s) and motion (s, of all cases)."""
    subprocess.run([sys.executable, "-B", HERE / "mould_program.py", folder, "--lines", str(lines), "--hours", str(minutes / 60)],
                   check=True)
    begin = time.monotonic()
    with open(folder / "said", "w", encoding="utf-8") as said:
        process = subprocess.Popen([servomill, "run", "mould.toml", "-o", "mould.h5"], cwd=folder, stdout=said, stderr=subprocess.STDOUT)
        _, status, used = os.wait4(process.pid, 0)
    took = time.monotonic() - begin
    text = (folder / "said").read_text(encoding="utf-8")
    if os.waitstatus_to_exitcode(status) != 0:
        sys.exit(f"servomill run: {text}")
    motion = sum(float(one) for one in re.findall(r"(\S+) s of motion in", text))
    return 1024 * used.ru_maxrss, (folder / "mould.h5").stat().st_size, took, motion


def main():
    if not 2 <= len(sys.argv) <= 3:
        sys.exit(__doc__)
    servomill = os.path.abspath(sys.argv[1])
    minutes = float(sys.argv[2]) if len(sys.argv) == 3 else MINUTES
    lines = max(100, round(LINES * minutes / MINUTES))
    results = []
    for duration in (minutes / SHORTER, minutes):
        with tempfile.TemporaryDirectory(dir=".") as folder:
            results.append(run(servomill, lines, duration, pathlib.Path(folder)))
    memory, size, took, motion = results[1]
    print(f"{minutes:g} min of motion in {CASES} cases: {memory / 2**30:.3f} GiB of memory, file of {size / 1e9:.3f} GB, "
          f"{motion / took:.0f} x real time over all cases in {took:.0f} s")
    print(f"memory exceeds that of the same lines in a ninth of the time ({results[0][0] / 2**30:.3f} GiB) by {100 * (memory / results[0][0] - 1):.1f} %")


if __name__ == "__main__":
    main()
