#!/usr/bin/python3
"""Tells by how much the memory of what evaluates a long program exceeds that of a ninth of its duration.

    long_evaluation.py SERVOMILL budget|probes|figures [MINUTES]     270 minutes of motion: 70 000 lines; others in proportion

budget    `servomill budget` of the deviation of the tool in one case
probes    `servomill run` of one case with a part that is probed at nine points
figures   tools/plot.py of the result file of four cases

Both programs (mould_program.py) have the same lines; the feeds of the shorter one are nine times as high.
"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
PLOT = HERE.parents[1] / "tools" / "plot.py"
LINES, MINUTES, SHORTER = 70000, 270, 9

PROBES = """
[record]
max_size_GB = 100

[cmm]
approach_mm = 40.0
search_mm = 40.0

[[probe]]
name = "first_pass"
line = { from_mm = [-80.0, -79.0, 0.0], to_mm = [80.0, -79.0, 0.0], normal = [0, 0, 1], points = 9 }

[[quantity]]
name = "probed_deviation"
probe = "first_pass"
"""


def peak(command, folder):
    """Peak memory (bytes) of a command and those that it starts."""
    with open(folder / "said", "w", encoding="utf-8") as said:
        process = subprocess.Popen(command, cwd=folder, stdout=said, stderr=subprocess.STDOUT)
        _, status, used = os.wait4(process.pid, 0)
    if os.waitstatus_to_exitcode(status) != 0:
        sys.exit(f"{command[1]}: {(folder / 'said').read_text(encoding='utf-8')}")
    return 1024 * used.ru_maxrss


def with_probes(scenario):
    """The scenario with its first case alone, and probes."""
    text = scenario.read_text(encoding="utf-8")
    first, second, end = re.match(r"(.*?\[\[case\]\].*?)(\[\[case\]\].*?)\[\[quantity\]\](.*)", text, re.S).groups()
    assert second and end
    scenario.write_text(first + PROBES, encoding="utf-8")


def measured(kind, servomill, folder):
    if kind == "budget":
        return peak([servomill, "budget", "mould.toml", "--quantity", "tool_deviation", "--case", "feedback", "-o", "out.h5"], folder)
    if kind == "probes":
        with_probes(folder / "mould.toml")
        return peak([servomill, "run", "mould.toml", "-o", "out.h5"], folder)
    peak([servomill, "run", "mould.toml", "-o", "out.h5"], folder)
    return peak([sys.executable, "-B", PLOT, "out.h5", "-o", "figures"], folder)


def main():
    if not 3 <= len(sys.argv) <= 4 or sys.argv[2] not in ("budget", "probes", "figures"):
        sys.exit(__doc__)
    servomill, kind = os.path.abspath(sys.argv[1]), sys.argv[2]
    minutes = float(sys.argv[3]) if len(sys.argv) == 4 else MINUTES
    lines = max(100, round(LINES * minutes / MINUTES))
    peaks = []
    for duration in (minutes / SHORTER, minutes):
        with tempfile.TemporaryDirectory(dir=".") as name:
            folder = pathlib.Path(name).resolve()
            subprocess.run([sys.executable, "-B", HERE / "mould_program.py", folder, "--lines", str(lines), "--hours", str(duration / 60)],
                           check=True)
            peaks.append(measured(kind, servomill, folder))
    print(f"{kind} of {minutes:g} min of motion: {peaks[1] / 1e6:.0f} MB of memory, more than those of a ninth of the time "
          f"({peaks[0] / 1e6:.0f} MB) by {100 * (peaks[1] / peaks[0] - 1):.1f} %")


if __name__ == "__main__":
    main()
