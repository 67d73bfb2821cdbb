#!/usr/bin/python3
"""Writes the program of a cone frustum as ISO 10791-6 BK4 follows it with five axes: the tip goes around a circle in a plane
tilted about Y, the tool axis along a cone about the normal of that plane. Chords of 0.25 deg lie 0.24 um inside of the arc at a
radius of 100 mm.

    tools/cone_frustum.py > scenarios/programs/bk4.ngc
"""
import argparse
from math import cos, radians, sin

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("--radius", type=float, default=100.0, help="mm (default %(default)s)")
parser.add_argument("--tilt", type=float, default=10.0, help="of the plane, deg (default %(default)s)")
parser.add_argument("--cone", type=float, default=15.0, help="half angle, deg (default %(default)s)")
parser.add_argument("--step", type=float, default=0.25, help="of a block, deg (default %(default)s)")
parser.add_argument("--feed", type=float, default=2000.0, help="mm/min (default %(default)s)")
arguments = parser.parse_args()
tilt, cone, run_in = radians(arguments.tilt), radians(arguments.cone), 15.0


def words(angle):
    """Tip relative to the centre #101 #102 #103 and tool axis at an angle (deg) around the circle."""
    u, v = cos(radians(angle)), sin(radians(angle))
    r = arguments.radius
    axial, radial = cos(cone), sin(cone)
    x, y, z = u * cos(tilt), v, -u * sin(tilt)
    i, j, k = radial * x + axial * sin(tilt), radial * y, radial * z + axial * cos(tilt)
    return f"X[#101{r * x:+.6f}] Y[#102{r * y:+.6f}] Z[#103{r * z:+.6f}] I{i:.9f} J{j:.9f} K{k:.9f}"


print("%")
print("(Cone frustum, ISO 10791-6 BK4; made by tools/cone_frustum.py)")
print(f"(radius {arguments.radius:g} mm, plane tilted by {arguments.tilt:g} deg, cone of half angle {arguments.cone:g} deg)")
print("(Centre of the circle: #101 #102 #103, mm. Every MSG begins a section that the comparison can name)")
print("G17 G21 G40 G54 G90 G94")
print("G64 P0.001")
print("G43.5 H1")
print("(MSG, approach)")
print(f"G0 {words(-run_in)}")
print(f"F{arguments.feed:g}")
for n in range(int(-run_in / arguments.step) + 1, int((360.0 + run_in) / arguments.step) + 1):
    angle = n * arguments.step
    print(f"G1 {words(angle)}")
    if angle == 0.0:
        print("(MSG, circle)")
    if angle == 360.0:
        print("(MSG, leave)")
print("M30")
print("%")
