#!/usr/bin/python3
"""What was read by rules of other controls is written in full: the strict reader takes every corrected program.

    tolerant_output.py SERVOMILL

Programs that LinuxCNC refuses are read, corrected and written. Of the result: the reader linuxcnc has no fault in it, and
passes, in order, within NEAR of each position that the original moves to.
"""
import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
MACHINE = ROOT / "scenarios" / "machines" / "router_3axis.toml"
NEAR = 0.2  # mm, far more than the errors of the machine, far less than the moves here
START = "G21 G90 G17\nT1 M6\nG54\nG43 H1\nG0 X0. Y0.\nZ5.\n"

PROGRAMS = {
    "the end of the text ends the program": ([], START + "G1 X10 F100\nY10\n"),
    "lower case, semicolons, a title": ([], "% part 5\n" + START.lower() + "g1 x10 f100 ; to the right\ny10\nm30\n%\n"),
    "decimal points": (["--reader", "fanuc", "--decimal-point", "increments"],
                       "%\nO0001\nG21 G90 G17\nT1 M6\nG54\nG43 H1\nG0 X0 Y0\nZ5000\nG1 X10000 F100\nM30\n%\n"),
    "an additional work offset": (["--reader", "fanuc", "--additional-offset", "P2:X=5,Y=5,Z=0"],
                                  START + "G54.1 P2\nG0 X1. Y0. Z5.\nG1 X10. F100.\nM30\n"),
    "Fanuc's cycles and repeats": (["--reader", "fanuc"], START + "G98 G81 X1. Y1. Z-1. R1. F100.\nG91 X5. K3\nG90 G80\nM30\n"),
    "rotation and mirror image": (["--reader", "fanuc"],
                                  START + "G68 X0. Y0. R90.\nG1 X10. F100.\nG69\nG51.1 X0.\nG1 X20. Y1.\nG50.1 X0.\nM30\n"),
    "macros": (["--reader", "fanuc"], START + "#1=1.\nWHILE [#1 LE 3.] DO1\nG1 X[#1*10.] F100.\n#1=#1+1.\nEND1\nM30\n"),
    "conversational": (["--reader", "heidenhain"],
                       "BEGIN PGM A MM\nTOOL CALL 1 Z S100\nL X+0 Y+0 R0 FMAX\nL Z+5 R0 FMAX\nL X+10 F100\nCC X+10 Y+5\n"
                       "C X+10 Y+10 DR+\nL M30\nEND PGM A MM\n"),
}


def moves(servomill, folder, program, arguments):
    done = subprocess.run([servomill, "canon", program, *arguments], cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    records = [json.loads(line) for line in done.stdout.splitlines()]
    return [record["end"] for record in records if "end" in record and isinstance(record["end"], list)], done.stderr


def check(servomill, folder, arguments, program):
    name = "part.h" if program.startswith("BEGIN") else "part.nc"
    pathlib.Path(folder, name).write_text(program)
    pathlib.Path(folder, "tool.tbl").write_text("T1 P1 Z50 D6\n")
    tools = ["--tools", "tool.tbl"]
    done = subprocess.run([servomill, "compensate", name, "--machine", MACHINE, "--work-offset", "X=0,Y=0,Z=0", *tools, "-q",
                           *arguments, "-o", "out.ngc"], cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    wanted, _ = moves(servomill, folder, name, [*tools, *arguments])
    got, said = moves(servomill, folder, "out.ngc", [*tools, "--reader", "linuxcnc"])
    assert "warning" not in said, said
    assert wanted, "the program moves"
    rest = iter(got)
    for end in wanted:
        assert any(math.dist(end[:3], other[:3]) < NEAR for other in rest), f"no move to {end[:3]} in order"


def main():
    servomill = os.path.abspath(sys.argv[1])
    failed = 0
    for name, (arguments, program) in PROGRAMS.items():
        with tempfile.TemporaryDirectory() as folder:
            try:
                check(servomill, folder, arguments, program)
            except AssertionError as fault:
                failed += 1
                print(f"{name}: {fault}")
    print(f"{len(PROGRAMS)} programs that other controls read, {failed} whose output the strict reader does not take")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
