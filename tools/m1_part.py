#!/usr/bin/python3
"""Writes the nominal part of scenarios/programs/m1_contour.ngc as a binary STL in mm: a circle on a diamond on a square.

The part is in the manner of test piece M1 of ISO 10791-7, size 160, reduced as in that program; work zero is the middle of
its top. Steps go down as deep as the end mill does: the circle from Z 0, the diamond (a square turned by --turn) from
--circle-depth, the square from --diamond-depth; under --square-depth is a base that is wider by the tool's diameter on
all sides, for there the program leaves a ledge.

The circle is a polygon whose corners lie --tolerance outside and whose sides reach as far inside. STL holds single precision:
coordinates are rounded by up to 4 nm.
Exit status: 0 written, 2 the input is wrong, 3 the system failed.
"""
import argparse
import math
import pathlib
import struct
import sys

import numpy as np

from command_line import InputError, run


def square(side, turn_deg=0.0):
    """Corners (4, 2), counter-clockwise."""
    angle = np.radians(turn_deg + 45.0 + 90.0 * np.arange(4))
    return side / math.sqrt(2.0) * np.column_stack([np.cos(angle), np.sin(angle)])


def circle(radius, tolerance):
    """Corners (n, 2) at radius + tolerance; the middles of the sides are at most tolerance inside."""
    half = math.acos((radius - tolerance) / (radius + tolerance))
    count = 4 * math.ceil(math.pi / half / 4.0)
    angle = 2.0 * math.pi * np.arange(count) / count
    return (radius + tolerance) * np.column_stack([np.cos(angle), np.sin(angle)])


def at(loop, z):
    return np.column_stack([loop, np.full(len(loop), z)])


def wall(loop, low, high):
    """Triangles (n, 3, 3) around a loop, facing away from it."""
    a, b = at(loop, low), at(loop, high)
    a_next, b_next = np.roll(a, -1, axis=0), np.roll(b, -1, axis=0)
    return np.concatenate([np.stack([a, a_next, b_next], axis=1), np.stack([a, b_next, b], axis=1)])


def cap(loop, z, up):
    """A fan from the middle."""
    corners = at(loop, z)
    following = np.roll(corners, -1, axis=0)
    middle = np.broadcast_to([0.0, 0.0, z], corners.shape)
    return np.stack([middle, corners, following] if up else [middle, following, corners], axis=1)


def ledge(outer, inner, z):
    """Between two convex loops about the middle, facing up: zipped from the nearest pair along shorter diagonals."""
    apart = np.linalg.norm(outer[:, None] - inner[None, :], axis=2)
    start = np.unravel_index(apart.argmin(), apart.shape)
    around = [at(np.concatenate([np.roll(loop, -first, axis=0), loop[first:first + 1]]), z)
              for loop, first in zip((outer, inner), start)]
    here, out = [0, 0], []
    while here != [len(outer), len(inner)]:
        diagonal = [np.linalg.norm(around[k][here[k] + 1] - around[1 - k][here[1 - k]])
                    if here[k] + 1 < len(around[k]) else math.inf for k in (0, 1)]
        k = 0 if diagonal[0] <= diagonal[1] else 1
        out.append([around[0][here[0]], around[k][here[k] + 1], around[1][here[1]]])
        here[k] += 1
    triangles = np.array(out)
    if (np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])[:, 2] <= 0.0).any():
        raise InputError("m1_part.py: error: two steps are too similar for the triangles between them")
    return triangles


def triangles_of(options):
    base = square(options.square + 2.0 * options.tool_diameter)
    steps = [(circle(options.circle / 2.0, options.tolerance), options.circle_depth),
             (square(options.diamond, options.turn), options.diamond_depth), (square(options.square), options.square_depth),
             (base, options.square_depth + options.base)]
    parts, top, above = [], 0.0, None
    for loop, depth in steps:
        parts.append(cap(loop, top, True) if above is None else ledge(loop, above, top))
        parts.append(wall(loop, -depth, top))
        top, above = -depth, loop
    return np.concatenate(parts + [cap(base, top, False)])


def stl(triangles):
    """Normals are those of the rounded corners."""
    corners = triangles.astype("<f4")
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    records = np.zeros(len(corners), dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("zero", "<u2")])
    records["normal"], records["corners"] = normals, corners
    return b"M1-like part, mm".ljust(80) + struct.pack("<I", len(records)) + records.tobytes()


def check(options):
    for name in ("square", "diamond", "circle", "circle_depth", "diamond_depth", "square_depth", "base", "tool_diameter",
                 "tolerance"):
        if not (math.isfinite(getattr(options, name)) and getattr(options, name) > 0.0):
            raise InputError(f"m1_part.py: error: --{name.replace('_', '-')} is {getattr(options, name):g}; must be > 0")
    if not math.isfinite(options.turn):
        raise InputError(f"m1_part.py: error: --turn is {options.turn:g}; must be finite")
    if not options.circle_depth < options.diamond_depth < options.square_depth:
        raise InputError("m1_part.py: error: --circle-depth, --diamond-depth and --square-depth must grow")
    if options.circle + 2.0 * options.tolerance >= options.diamond:
        raise InputError(f"m1_part.py: error: --circle {options.circle:g} does not fit on --diamond {options.diamond:g}")
    if abs(square(options.diamond, options.turn)).max() >= options.square / 2.0:
        raise InputError(f"m1_part.py: error: --diamond {options.diamond:g} does not fit on --square {options.square:g}")


def main(arguments):
    reader = argparse.ArgumentParser(prog="m1_part.py", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    reader.add_argument("out", metavar="OUT", help="STL file")
    for name, default, meaning in (
            ("square", 160.0, "side, mm"), ("diamond", 113.0, "side, mm"), ("turn", 30.0, "of the diamond, deg"),
            ("circle", 110.0, "diameter, mm"), ("circle-depth", 6.0, "of the circle's foot, mm"),
            ("diamond-depth", 12.0, "of the diamond's foot, mm"), ("square-depth", 20.0, "of the square's foot, mm"),
            ("base", 20.0, "height below, mm"), ("tool-diameter", 8.0, "of the end mill, mm"),
            ("tolerance", 0.0001, "of the circle, mm to both sides")):
        reader.add_argument(f"--{name}", type=float, default=default, metavar="X", help=f"{meaning} (default: {default:g})")
    reader.add_argument("--force", action="store_true", help="overwrite OUT")
    options = reader.parse_args(arguments)

    path = pathlib.Path(options.out)
    if path.suffix.lower() != ".stl":
        raise InputError(f"{path}: error: the name must end in .stl")
    if path.exists() and not options.force:
        raise InputError(f"{path}: error: exists; use --force to overwrite")
    if not path.parent.is_dir():
        raise InputError(f"{path}: error: folder {path.parent} does not exist")
    check(options)
    triangles = triangles_of(options)
    path.write_bytes(stl(triangles))
    print(f"{path}: {len(triangles)} triangles")
    return 0


if __name__ == "__main__":
    sys.exit(run(main, sys.argv[1:]))
