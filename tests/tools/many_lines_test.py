#!/usr/bin/python3
"""tests/tools/many_lines.py runs, whatever the keys of its scenario are called today, and prints what tests/evidence looks for.

    many_lines_test.py SERVOMILL
"""
import pathlib
import re
import subprocess
import sys
import tempfile
import tomllib

HERE = pathlib.Path(__file__).resolve().parent


def main():
    servomill = str(pathlib.Path(sys.argv[1]).resolve())
    rows = tomllib.loads((HERE.parent / "evidence" / "long_programs.toml").read_text(encoding="utf-8"))["row"]
    of_tool = [row for row in rows if "{root}/tests/tools/many_lines.py" in row["run"]]
    for options, count in (([], 3), (["--rows"], 1)):
        wanted = [row["find"] for row in of_tool if ("--rows" in row["run"]) == bool(options)]
        with tempfile.TemporaryDirectory() as folder:
            done = subprocess.run([sys.executable, "-B", HERE / "many_lines.py", *options, servomill, "5000"], cwd=folder, check=False,
                                  capture_output=True, text=True)
        if done.returncode != 0 or len(wanted) != count:
            sys.exit(f"{len(wanted)} rows; {done.stdout}{done.stderr}")
        for pattern in wanted:
            if not re.search(pattern, done.stdout):
                sys.exit(f"'{pattern}' is not in {done.stdout}")


if __name__ == "__main__":
    main()
