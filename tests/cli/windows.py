#!/usr/bin/python3
"""A run of many parts with record.windows that record one of them: file and memory against a ninth of the parts.

    windows.py SERVOMILL [PARTS]
"""
import os
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
PARTS, SHORTER = 900, 9
SAME_FILE = 1.02      # of the size of the file: texts of the number of parts, places in the file
EACH = 4e3            # bytes of memory of a part more: its moves; a plan of its own would take 130 kB

PROGRAM = """\
G21 G90 G94 F3000
O1 REPEAT [#100]
(MSG, line)
G1 X40 Y5
G4 P0.1
X0 Y0
(MSG, circle)
G2 X0 Y0 I10 J0
O1 ENDREPEAT
M2
"""
SCENARIO = """\
title = "Parts"
machine = "{machine}"
[program]
file = "parts.ngc"
parameters = {{ "#100" = {parts} }}
[record]
period_ms = 1.0
windows = {{ sections = ["line", "circle"], every = {parts} }}
[[case]]
name = "one"
"""


def run(servomill, folder, parts):
    """(bytes of the file, bytes of memory at most) of a run."""
    (folder / "parts.ngc").write_text(PROGRAM, encoding="utf-8")
    text = SCENARIO.format(machine=ROOT / "scenarios" / "machines" / "hsm600u.toml", parts=parts)
    (folder / "parts.toml").write_text(text, encoding="utf-8")
    process = subprocess.Popen([servomill, "run", "parts.toml", "-o", "out.h5", "-q", "-f"], cwd=folder)
    _, status, used = os.wait4(process.pid, 0)
    if os.waitstatus_to_exitcode(status) != 0:
        sys.exit(f"run of {parts} parts failed")
    return (folder / "out.h5").stat().st_size, 1024 * used.ru_maxrss


def main():
    servomill = os.path.abspath(sys.argv[1])
    parts = int(sys.argv[2]) if len(sys.argv) > 2 else PARTS
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        few, many = (run(servomill, folder, count) for count in (parts // SHORTER, parts))
    each = (many[1] - few[1]) / (parts - parts // SHORTER)
    print(f"{parts} parts: file of {many[0] / 1e6:.2f} MB, {many[0] / few[0]:.3f} of that of a ninth of the parts; memory of "
          f"{many[1] / 1e6:.1f} MB, {each / 1e3:.1f} kB more for each part")
    faults = []
    if many[0] > SAME_FILE * few[0]:
        faults.append("the file grows with the number of parts")
    if each > EACH:
        faults.append(f"memory grows by more than {EACH / 1e3:g} kB for each part")
    print("\n".join(faults), end="")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
