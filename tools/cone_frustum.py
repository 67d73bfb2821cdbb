#!/usr/bin/python3
"""Writes the program of cone frusta as ISO 10791-6 BK4 follows them with five axes: the tip goes around a circle in a plane
tilted about Y, the tool axis along a cone about the normal of that plane. Chords of 0.4 deg lie 0.6 um inside of the arc at a
radius of 100 mm.

    tools/cone_frustum.py > scenarios/programs/bk4.ngc
"""
import argparse
from math import cos, radians, sin

FRUSTA = ((10.0, 15.0), (30.0, 45.0))   # deg: tilt of the plane, half angle of the cone
RUN_IN = 16.0                           # deg, before and behind a circle

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("--radius", type=float, default=100.0, help="mm (default %(default)s)")
parser.add_argument("--step", type=float, default=0.4, help="of a block, deg (default %(default)s)")
parser.add_argument("--feed", type=float, default=600.0, help="mm/min (default %(default)s)")
arguments = parser.parse_args()


def words(angle, tilt, cone, first):
    """Tip relative to the centre and tool axis at an angle around the circle (deg); `first` parameter of the centre."""
    u, v, tilt, cone = cos(radians(angle)), sin(radians(angle)), radians(tilt), radians(cone)
    r, axial, radial = arguments.radius, cos(cone), sin(cone)
    x, y, z = u * cos(tilt), v, -u * sin(tilt)
    i, j, k = radial * x + axial * sin(tilt), radial * y, radial * z + axial * cos(tilt)
    return f"X[#{first}{r * x:+.6f}] Y[#{first + 1}{r * y:+.6f}] Z[#{first + 2}{r * z:+.6f}] I{i:.9f} J{j:.9f} K{k:.9f}"


print("%")
print("(Two cone frusta, ISO 10791-6 BK4; made by tools/cone_frustum.py)")
print("(Centres of the circles: #101 #102 #103 and #104 #105 #106, mm. Every MSG begins a section that the comparison can name)")
print("G17 G21 G40 G54 G90 G94")
print("G64 P0.00002")
print("G43.5 H1")
print(f"F{arguments.feed:g}")
for number, (tilt, cone) in enumerate(FRUSTA):
    print(f"(radius {arguments.radius:g} mm, plane tilted by {tilt:g} deg, cone of half angle {cone:g} deg)")
    print("(MSG, approach)")
    print("G0 " + words(-RUN_IN, tilt, cone, 101 + 3 * number))
    for n in range(round(-RUN_IN / arguments.step) + 1, round((360.0 + RUN_IN) / arguments.step) + 1):
        print("G1 " + words(n * arguments.step, tilt, cone, 101 + 3 * number))
        if n == 0:
            print(f"(MSG, frustum {tilt:g}-{cone:g})")
        if n == round(360.0 / arguments.step):
            print("(MSG, leave)")
print("M30")
print("%")
