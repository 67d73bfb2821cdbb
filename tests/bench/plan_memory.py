#!/usr/bin/python3
"""Peak of memory of planning a long program: plan_memory.py PLANNER_BENCH mould|short LINES"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from long_programs import program  # noqa: E402


def main():
    bench, kind, lines = sys.argv[1], sys.argv[2], int(sys.argv[3])
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / f"{kind}.ngc"
        path.write_text("\n".join(program(kind, lines)) + "\n", encoding="utf-8")
        done = subprocess.run([bench, path], env={**os.environ, "PLANNER_BENCH_QUICK": "1"}, text=True,
                              stdout=subprocess.PIPE, check=True)
    motion = re.search(r"motion ([\d.]+) min", done.stdout)[1]
    peak = re.search(r"([\d.]+) MB with the plan", done.stdout)[1]
    print(f"{lines} {kind} lines, {motion} min of motion: peak memory {peak} MB")


if __name__ == "__main__":
    main()
