#!/usr/bin/python3
"""Corrected programs run on LinuxCNC: rs274 takes them, and makes of them as many moves as were written.

    compensate_test.py SERVOMILL

Skipped (exit status 77) where rs274 is not installed (Debian: linuxcnc-uspace); looked for at $RS274, on PATH and in
~/.cache/rs274/root/usr/bin.
"""
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

SOURCE = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(SOURCE / "tools"))
import rs274  # noqa: E402

MACHINE = SOURCE / "scenarios" / "machines" / "router_3axis.toml"
SKIPPED = 77
MOVE = re.compile(r"(?:STRAIGHT_FEED|STRAIGHT_TRAVERSE|ARC_FEED)\(")
TOOLS = "T1 P1 Z+40 D+6\nT2 P2 Z+55.5 D+8\n"
OFFSETS = {5220: 1, 5221: 200, 5222: 250, 5223: -90, 5241: 300, 5242: 200, 5243: -95}
PROGRAM = """%
(a plate)
G21 G90 G17 G40 G54
T1 M6
G43 H1
S12000 M3
G0 X10 Y20 Z5
M8
G1 Z-2 F300
X110 F1200 ; along
G2 X100 Y30 I-10 J0
G3 X80 Y50 R20
G3 X80 Y50 I0 J-15 (full circle)
G91 G1 X5 Y-5
G18 G2 X10 Z0 I5 K0
G17 G90
G92 X0 Y0
G1 X10
G92.1
G20 F40
G1 X2.5 Y1.0
G21 F900
G55 G1 X0 Y0
G93 G1 X30 Y10 F12
G94 F500
G10 L2 P2 X310 Y205 Z-95 R10
G1 X0 Y0
X20 Y15
G53 G0 Z0
M5 M9
M30
%
"""


def check_names(servomill):
    """Corrected programs are called as the control calls its programs."""
    with tempfile.TemporaryDirectory() as folder:
        pathlib.Path(folder, "part.ngc").write_text("G21 G90 T1 M6 G43 H1\nG0 X1 Y2 Z3\nG1 X5 F100\nM2\n")
        for dialect in ("linuxcnc", "heidenhain", "fanuc", "siemens"):
            number = ["--program-number", "17"] if dialect == "fanuc" else []
            subprocess.run([servomill, "compensate", "part.ngc", "--machine", MACHINE, "--dialect", dialect, "-q",
                            "--work-offset", "X=0,Y=0,Z=-100", "--tool-length", "1=50", "--retract", "Z=0", *number],
                           cwd=folder, check=True)
        names = {one.name for one in pathlib.Path(folder).iterdir()} - {"part.ngc"}
        assert names == {"part.compensated.ngc", "part_compensated.h", "O0017.nc", "part_compensated.mpf"}, names
        assert "BEGIN PGM PART_COMPENSATED MM" in pathlib.Path(folder, "part_compensated.h").read_text()
        assert "O0017 (O0017)" in pathlib.Path(folder, "O0017.nc").read_text()


def library_path(exe):
    root = pathlib.Path(exe).parents[1]
    return ":".join(str(root / one) for one in ("lib", "lib/x86_64-linux-gnu"))


def run_rs274(exe, program, folder):
    home = pathlib.Path(folder, "home")
    home.mkdir(exist_ok=True)
    env = {**os.environ, "HOME": str(home), "LD_LIBRARY_PATH": library_path(exe)}
    return subprocess.run([exe, "-t", "tools.tbl", "-v", "offsets.var", "-g", program], cwd=folder, env=env,
                          stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=60)


def main():
    servomill = os.path.abspath(sys.argv[1])
    check_names(servomill)
    try:
        exe = rs274.find()
    except rs274.Missing as missing:
        print(missing)
        return SKIPPED
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder)
        (path / "part.ngc").write_text(PROGRAM)
        (path / "tools.tbl").write_text(TOOLS)
        # machine units of rs274 alone are inches
        var = "".join(f"{n} {v if n == 5220 else v / 25.4:.9f}\n" for n, v in OFFSETS.items())
        (path / "offsets.var").write_text(var)
        (path / "offsets_mm.var").write_text("".join(f"{n} {v}\n" for n, v in OFFSETS.items()))
        said = subprocess.run([servomill, "compensate", "part.ngc", "--machine", MACHINE, "--tools", "tools.tbl",
                               "--parameter-file", "offsets_mm.var", "--reader", "linuxcnc", "--json"], cwd=folder, check=True,
                              capture_output=True, text=True).stdout
        for name, blocks in (("part.ngc", "blocks_before"), ("part.compensated.ngc", "blocks_after")):
            done = run_rs274(exe, name, folder)
            assert done.returncode == 0, (name, done.stderr)
            moves, wanted = len(MOVE.findall(done.stdout)), json.loads(said)[blocks]
            assert moves == wanted, (name, moves, wanted)
    return 0


if __name__ == "__main__":
    sys.exit(main())
