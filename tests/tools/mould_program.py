#!/usr/bin/python3
"""A long finishing program, as CAM systems write them for a mould, and a scenario that runs it in four cases.

    mould_program.py FOLDER [--lines 70000] [--hours 4.5] [--seed 1]

writes FOLDER/mould.ngc and FOLDER/mould.toml. Passes along X over a wavy surface, there and back, a little further in Y each
time; blocks are short where the surface bends (chord of 30 um) and where the seed makes them so, and every fiftieth pass begins with
a rapid retract. The same arguments give the same bytes on every machine: integers of micrometres from a generator of our own.
"""
import argparse
import math
import pathlib

WIDTH = 200.0            # mm, of a pass
CHORD = 0.03             # mm
LONGEST = 15.0           # mm, of a block
LEAST_TIME = 0.02        # s, of a block, on the average
PASSES_A_RETRACT = 50


class Random:
    """A linear congruential generator (Knuth, MMIX): the same numbers wherever Python runs."""

    def __init__(self, seed):
        self.state = seed

    def share(self):
        self.state = (6364136223846793005 * self.state + 1442695040888963407) % 2**64
        return (self.state >> 33) / 2**31


def waves(random):
    """Amplitude (mm), wave numbers (1/mm) and phase of each of the waves that the surface is made of."""
    return [(8.0 / n, 2.0 * math.pi * n / 150.0 * random.share(), 2.0 * math.pi * n / 150.0 * random.share(),
             2.0 * math.pi * random.share()) for n in (1, 2, 3, 5, 8)]


def height(surface, x, y):
    return sum(a * math.sin(kx * x + ky * y + phase) for a, kx, ky, phase in surface)


def bend(surface, x, y):
    """Curvature along X, 1/mm."""
    return abs(sum(a * kx * kx * math.sin(kx * x + ky * y + phase) for a, kx, ky, phase in surface))


def one_pass(surface, random, y):
    """Places in X of the block ends of a pass: by chord, and a little by chance."""
    places, x = [0.0], 0.0
    while x < WIDTH:
        by_chord = math.sqrt(8.0 * CHORD / max(bend(surface, x, y), 1e-5))
        x = min(WIDTH, x + min(by_chord, LONGEST) * (0.25 + random.share()))
        places.append(x)
    return places


def blocks(lines, random, surface):
    """Ends (x, y, z) of feed moves, None for a retract before the next one; together `lines` lines."""
    number, left, y = 0, lines, -80.0
    while left > 0:
        places = one_pass(surface, random, y)
        if number % 2:
            places = [WIDTH - x for x in places]
        if number % PASSES_A_RETRACT == 0:
            left -= 3
            yield None
        for x in places[:max(0, left)]:
            yield x - 0.5 * WIDTH, y, height(surface, x, y)
        left -= len(places)
        number += 1
        y = -80.0 + number * 0.08 % 160.0


def feed_length(ends):
    """Way over feed, mm."""
    length, before = 0.0, None
    for end in ends:
        if end is not None and before is not None:
            length += math.dist(before, end)
        before = end
    return length


def program(lines, hours, seed):
    random = Random(seed)
    surface = waves(random)
    ends = list(blocks(lines - 9, random, surface))
    feed = feed_length(ends) / (60.0 * hours)
    yield f"( mould finishing, {lines} lines, {hours:g} h, seed {seed} )"
    yield from ("G21 G17 G90 G94 G40", "T1 M6", "G43 H1", "S12000 M3", f"G0 X{-0.5 * WIDTH:g} Y-80 Z60")
    retracted = False
    for end in ends:
        if end is None:
            yield "G0 Z60"
        elif retracted:
            yield f"G0 X{end[0]:.3f} Y{end[1]:.3f}"
            yield f"G1 X{end[0]:.3f} Y{end[1]:.3f} Z{end[2]:.3f} F{feed:.1f}"
        else:
            yield f"X{end[0]:.3f} Y{end[1]:.3f} Z{end[2]:.3f}"
        retracted = end is None
    yield from ("G0 Z60", "M5", "M2")


SCENARIO = """\
# A long program in four cases; written by tests/tools/mould_program.py.
title   = "A long finishing program"
machine = "{machine}"
machine_errors = "measured"

[program]
file = "mould.ngc"
work_offset = {{ Z_mm = 100.0 }}
start = {{ X_mm = -100.0, Y_mm = -80.0, Z_mm = 160.0 }}

[[program.tool]]
number = 1
length_mm = 110.0
diameter_mm = 6.0

[errors.measured]
EXX = {{ polynomial_um = [0.0, 0.05] }}
EYX = {{ harmonic = {{ amplitude_um = 8.0, period_mm = 120.0 }} }}
EZX = {{ polynomial_um = [0.0, 0.02, 2e-4] }}
EZY = {{ harmonic = {{ amplitude_um = 5.0, period_mm = 90.0 }} }}
EC0Y = "40 urad"

[[case]]
name = "as_it_is"

[[case]]
name = "table"
[[case.strategy]]
type = "table"
model = "measured"
base_axis = "X"
from_mm = -200.0
to_mm = 200.0
spacing_mm = 6.5536

[[case]]
name = "feedback"
[[case.strategy]]
type = "feedback"
model = "measured"

[[case]]
name = "feedback_lead"
[[case.strategy]]
type = "feedback"
model = "measured"
extrapolation_time_ms = "auto"

[[quantity]]
name = "tcp_deviation"

[[quantity]]
name = "tcp_deviation"
statistic = "rms"

[[quantity]]
name = "contour_error"

[[quantity]]
name = "following_error"
axis = "X"

[[quantity]]
name = "tool_difference"
baseline = "as_it_is"
cases = ["table", "feedback", "feedback_lead"]

[[quantity]]
name = "cycle_time"
"""


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--lines", type=int, default=70000)
    parser.add_argument("--hours", type=float, default=4.5)
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    if given.lines < 100 or not LEAST_TIME < 3600.0 * given.hours / given.lines:
        parser.error(f"needs at least 100 lines, and more than {LEAST_TIME} s a line")
    given.folder.mkdir(parents=True, exist_ok=True)
    text = "\n".join(program(given.lines, given.hours, given.seed)) + "\n"
    (given.folder / "mould.ngc").write_text(text)
    machine = pathlib.Path(__file__).resolve().parents[2] / "scenarios" / "machines" / "hsm600u.toml"
    (given.folder / "mould.toml").write_text(SCENARIO.format(machine=machine))


if __name__ == "__main__":
    main()
