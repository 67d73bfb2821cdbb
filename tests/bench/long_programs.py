#!/usr/bin/python3
"""Writes long programs, as long as they are asked for.

    long_programs.py mould|short|five LINES [SEED] > program.ngc

mould   finishing of a mould: rows of chords of 0.6 to 4 mm at 10 mm/s; 70 000 lines are 4.5 h of motion
short   the same surface in chords of 0.05 to 0.2 mm at 50 mm/s, as a CAM system with a small tolerance writes it
five    the same chords while axes B and C swivel
"""
import math
import random
import sys

KINDS = {"mould": ((0.6, 4.0), 600), "short": ((0.05, 0.2), 3000), "five": ((0.05, 0.2), 3000)}  # chords, mm; feed, mm/min
ROW, STEP_OVER, DEPTH = 200.0, 0.3, 250.0  # mm; rows go to and fro within the depth


def surface(x, y):
    return -20 + 6 * math.sin(x / 31) * math.cos(y / 23) + 3 * math.sin(x / 11 + y / 17)


def program(kind, lines, seed=1):
    """Lines of it, without their ends; the last is M2."""
    chance = random.Random(seed)
    chords, feed = KINDS[kind]
    yield "G21 G90 G17 G64 P0.01"
    yield "G0 X0 Y0 Z5"
    yield f"G1 Z{surface(0, 0):.4f} F{feed}"
    x, y, way, to = 0.0, 0.0, 0.0, ROW
    written, ends_row = 3, False
    while written < lines - 1:
        if ends_row:
            way, to, ends_row = way + STEP_OVER, ROW - to, False
            y = DEPTH - abs(way % (2 * DEPTH) - DEPTH)
        else:
            step = chance.uniform(*chords)
            ends_row = abs(to - x) < step
            x = to if ends_row else x + math.copysign(step, to - x)
        swivel = f" B{8 * math.sin(x / 40) * math.cos(y / 30):.4f} C{10 * math.cos(x / 35 + y / 50):.4f}" if kind == "five" else ""
        yield f"G1 X{x:.4f} Y{y:.4f} Z{surface(x, y):.4f}{swivel}"
        written += 1
    yield "M2"


def main():
    if len(sys.argv) not in (3, 4) or sys.argv[1] not in KINDS:
        print(__doc__, file=sys.stderr)
        return 2
    for line in program(sys.argv[1], int(sys.argv[2]), *map(int, sys.argv[3:])):
        print(line)
    return 0


if __name__ == "__main__":
    sys.exit(main())
