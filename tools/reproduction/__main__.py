"""Runs the scenarios of both papers and writes reproduction.md, reproduction.html and the figures.

Exit status: 0 written, 1 written but a scenario failed, 2 the command is wrong, 3 the system failed.
"""
import argparse
import pathlib
import subprocess
import sys

from command_line import InputError, run
from reproduction import pictures, report, rows, runs, values


def main(arguments):
    reader = argparse.ArgumentParser(prog="reproduction", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    reader.add_argument("servomill", help="the program")
    reader.add_argument("-o", metavar="DIR", default="out/reproduce", help="folder to write to (default: out/reproduce)")
    reader.add_argument("--report-only", action="store_true", help="take the result files that lie in the folder")
    options = reader.parse_args(arguments)

    table = rows.read()
    version = _version(options.servomill)
    folder = pathlib.Path(options.o)
    folder.mkdir(parents=True, exist_ok=True)
    failed = {} if options.report_only else runs.run_all(runs.RUNS, options.servomill, folder, tell)
    tell("Comparing")
    results = values.Results(folder, failed)
    try:
        lines = [report.judged(row, values.find(row, results)) for row in table]
        tell("Drawing the figures")
        drawn = pictures.draw_all(results, folder / "figures", tell)
    finally:
        results.close()
    for name, text in (("reproduction.md", report.markdown(lines, drawn, version)),
                       ("reproduction.html", report.page(lines, drawn, version))):
        (folder / name).write_text(text, encoding="utf-8")
    tell("\n".join(report.summary_lines(lines)))
    tell(f"written to {folder / 'reproduction.md'} and {folder / 'reproduction.html'}")
    return 1 if failed else 0


def tell(text):
    print(text, flush=True)


def _version(servomill):
    try:
        done = subprocess.run([servomill, "--version"], capture_output=True, text=True)
    except FileNotFoundError:
        raise InputError(f"reproduction: error: {servomill} does not exist") from None
    return done.stdout.strip().removeprefix("servomill ") if done.returncode == 0 else ""


if __name__ == "__main__":
    sys.exit(run(main, sys.argv[1:]))
