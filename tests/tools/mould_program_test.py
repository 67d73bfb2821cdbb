#!/usr/bin/python3
"""The scenario of tests/tools/mould_program.py is one that servomill runs, whatever its keys are called today.

    mould_program_test.py SERVOMILL
"""
import pathlib
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent


def main():
    servomill = str(pathlib.Path(sys.argv[1]).resolve())
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([sys.executable, "-B", HERE / "mould_program.py", folder, "--lines", "100", "--hours", "0.003"], check=True)
        for arguments in (["run", "mould.toml", "-o", "out.h5"],
                          ["budget", "mould.toml", "--quantity", "tool_deviation", "--case", "feedback"]):
            done = subprocess.run([servomill, *arguments], cwd=folder, check=False, capture_output=True, text=True)
            if done.returncode != 0:
                sys.exit(f"servomill {' '.join(arguments)}: {done.stdout}{done.stderr}")


if __name__ == "__main__":
    main()
