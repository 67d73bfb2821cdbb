#!/usr/bin/python3
"""Writes the program of cone frusta as ISO 10791-6 BK4 follows them with five axes: the tip goes around a circle in a plane
tilted about Y, the tool axis along a cone about the normal of that plane. Chords of 0.4 deg lie 0.6 um inside of the arc at a
radius of 100 mm.

    tools/cone_frustum.py > scenarios/programs/bk4.ngc

Exit status: 0 written, 2 the input is wrong.
"""
import argparse
import sys
from math import cos, isfinite, radians, sin

from command_line import InputError, run

FRUSTA = ((10.0, 15.0), (30.0, 45.0))   # deg: tilt of the plane, half angle of the cone
RUN_IN = 16.0                           # deg, before and behind a circle
COARSEST = 8.0                          # deg: the run-in has two blocks


def words(radius, angle, tilt, cone, first):
    """Tip relative to the centre and tool axis at an angle around the circle (deg); `first` parameter of the centre."""
    u, v, tilt, cone = cos(radians(angle)), sin(radians(angle)), radians(tilt), radians(cone)
    axial, radial = cos(cone), sin(cone)
    x, y, z = u * cos(tilt), v, -u * sin(tilt)
    i, j, k = radial * x + axial * sin(tilt), radial * y, radial * z + axial * cos(tilt)
    return (f"X[#{first}{radius * x:+.6f}] Y[#{first + 1}{radius * y:+.6f}] Z[#{first + 2}{radius * z:+.6f}] "
            f"I{i:.9f} J{j:.9f} K{k:.9f}")


def check(options):
    for name in ("radius", "step", "feed"):
        value = getattr(options, name)
        if not (isfinite(value) and value > 0.0):
            raise InputError(f"cone_frustum.py: error: --{name} is {value:g}; must be > 0")
    blocks = 360.0 / options.step
    if options.step > COARSEST or abs(blocks - round(blocks)) > 1e-6 * blocks:
        raise InputError(f"cone_frustum.py: error: --step is {options.step:g}; 360 deg must be an integer number of steps of at most "
                         f"{COARSEST:g} deg")


def program(options):
    lines = [
        "%",
        "(Two cone frusta, ISO 10791-6 BK4; made by tools/cone_frustum.py)",
        "(Centres of the circles: #101 #102 #103 and #104 #105 #106, mm. Every MSG begins a section that the comparison can name)",
        "G17 G21 G40 G54 G90 G94",
        "G64 P0.00002",
        "G43.5 H1",
        f"F{options.feed:g}"]
    for number, (tilt, cone) in enumerate(FRUSTA):
        first = 101 + 3 * number
        lines += [f"(radius {options.radius:g} mm, plane tilted by {tilt:g} deg, cone of half angle {cone:g} deg)",
                  "(MSG, approach)",
                  "G0 " + words(options.radius, -RUN_IN, tilt, cone, first)]
        for n in range(round(-RUN_IN / options.step) + 1, round((360.0 + RUN_IN) / options.step) + 1):
            lines.append("G1 " + words(options.radius, n * options.step, tilt, cone, first))
            if n == 0:
                lines.append(f"(MSG, frustum {tilt:g}-{cone:g})")
            if n == round(360.0 / options.step):
                lines.append("(MSG, leave)")
    return "\n".join(lines + ["M30", "%"])


def main(arguments):
    reader = argparse.ArgumentParser(prog="cone_frustum.py", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    reader.add_argument("--radius", type=float, default=100.0, help="mm (default %(default)s)")
    reader.add_argument("--step", type=float, default=0.4, help="of a block, deg (default %(default)s)")
    reader.add_argument("--feed", type=float, default=600.0, help="mm/min (default %(default)s)")
    options = reader.parse_args(arguments)
    check(options)
    print(program(options))
    return 0


if __name__ == "__main__":
    sys.exit(run(main, sys.argv[1:]))
