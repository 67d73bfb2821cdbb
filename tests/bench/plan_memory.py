#!/usr/bin/python3
"""Peak of memory of planning a long program.

    plan_memory.py PLANNER_BENCH mould|short LINES    reading and planning alone
    plan_memory.py SERVOMILL mould|short LINES        `servomill check` of a scenario with one case
"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from long_programs import program  # noqa: E402


SCENARIO = """\
title   = "A long program"
machine = "{machine}"

[program]
file = "{kind}.ngc"
work_offset = {{ Z_mm = 100.0 }}
start = {{ Z_mm = 160.0 }}

[[case]]
name = "one"
"""


def peak_of_check(servomill, path):
    """Peak of memory of `servomill check` of a scenario with the program, 10^6 bytes."""
    machine = pathlib.Path(__file__).resolve().parents[2] / "scenarios" / "machines" / "hsm600u.toml"
    scenario = path.with_suffix(".toml")
    scenario.write_text(SCENARIO.format(machine=machine, kind=path.stem), encoding="utf-8")
    process = subprocess.Popen([servomill, "check", scenario], stdout=subprocess.DEVNULL)
    _, status, used = os.wait4(process.pid, 0)
    if os.waitstatus_to_exitcode(status) != 0:
        sys.exit("servomill check failed")
    return used.ru_maxrss * 1024 / 1e6


def main():
    bench, kind, lines = sys.argv[1], sys.argv[2], int(sys.argv[3])
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / f"{kind}.ngc"
        path.write_text("\n".join(program(kind, lines)) + "\n", encoding="utf-8")
        if pathlib.Path(bench).name == "servomill":
            print(f"{lines} {kind} lines: peak memory {peak_of_check(bench, path):.0f} MB")
            return
        done = subprocess.run([bench, path], env={**os.environ, "PLANNER_BENCH_QUICK": "1"}, text=True,
                              stdout=subprocess.PIPE, check=True)
    motion = re.search(r"motion ([\d.]+) min", done.stdout)[1]
    peak = re.search(r"([\d.]+) MB with the plan", done.stdout)[1]
    print(f"{lines} {kind} lines, {motion} min of motion: peak memory {peak} MB")


if __name__ == "__main__":
    main()
