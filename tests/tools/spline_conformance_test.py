#!/usr/bin/python3
"""Random programs of G5, G5.1, G5.2 and G5.3 have the points of LinuxCNC's splines.

    spline_conformance_test.py SERVOMILL [COUNT [SEED]]

Skipped (exit status 77) where rs274 is not installed (Debian: linuxcnc-uspace).
"""
import pathlib
import random
import subprocess
import sys
import tempfile

sys.dont_write_bytecode = True
ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))
import rs274  # noqa: E402

SKIPPED = 77


class Writer:
    """A program that both controls take, with some blocks that both refuse."""

    def __init__(self, seed):
        self.random = random.Random(seed)
        self.lines = ["G21 G90 G17 G94 G64", "G0 X1 Y2 Z-1", f"F{self.number(50, 900)}"]

    def number(self, low=-20.0, high=20.0):
        return round(self.random.uniform(low, high), self.random.randrange(5))

    def words(self, letters):
        return " ".join(f"{letter}{self.number()}" for letter in letters)

    def axes(self):
        return self.words(self.random.choice(["XY", "X", "Y"]))

    def cubic(self):
        start = self.words("IJ") if self.random.random() < 0.6 else ""
        self.lines.append(f"G5 {self.axes()} {start} {self.words('PQ')}")

    def quadratic(self):
        self.lines.append(f"G5.1 {self.axes()} {self.words('IJ')}")

    def nurbs(self):
        order = self.random.choice([0, 3, 3, 4, 4, 5, 6])
        weight = self.random.choice(["", f"P{self.number(0.2, 5) or 1}"])
        self.lines.append(f"G5.2 {weight} L{order}")
        for _ in range(max(order, 3) - 1 + self.random.randrange(5)):
            code = self.random.choice(["", "G5.2 "])
            self.lines.append(f"{code}{self.words('XY')} P{self.number(0.2, 5) or 1}")
        self.lines.append("G5.3")

    def wrong(self):
        self.lines.append(self.random.choice([
            "G5 X1 Y1 I1 P1 Q1", "G5 X1 P1 I1 J1", "G5.1 X1 J2", "G5.1 X1 I1 J1 Z2", "G5.3", "G5.2 X1 P1", "G5 I1 J1 P1 Q1",
            "G18\nG5 X1 I1 J1 P1 Q1", "G5.2 P1 L5\nX1 Y1 P1\nG5.3", "G5.2 X1 Y1 P1\nX2 Y2 P-1"]))

    def modes(self):
        self.lines.append(self.random.choice(
            ["G91", "G90", f"F{self.number(50, 900)}", f"G92 X{self.number()}", "G92.1", "G0 X0 Y0", "G1 X3 Y4", "G55", "G54",
             f"G10 L2 P2 X{self.number()} R{self.number()}", "G20", "G21", "G90.1", "M8"]))

    def text(self):
        for _ in range(self.random.randrange(3, 12)):
            self.random.choice([self.cubic, self.quadratic, self.nurbs, self.nurbs, self.modes])()
        if self.random.random() < 0.15:
            self.wrong()
        return "\n".join([*self.lines, "M2", ""])


def main(servomill, count=30, seed=1):
    try:
        rs274.find()
    except rs274.Missing as fault:
        print(fault)
        return SKIPPED
    with tempfile.TemporaryDirectory() as folder:
        for n in range(int(count)):
            (pathlib.Path(folder) / f"spline{int(seed) + n}.ngc").write_text(Writer(int(seed) + n).text())
        command = [sys.executable, ROOT / "tools" / "conformance", folder, "--filter", "none", "--quiet",
                   "--command", f"{servomill} canon --reader linuxcnc"]
        done = subprocess.run(command, check=False, capture_output=True, text=True)
        print(done.stdout, done.stderr)
        return done.returncode


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
