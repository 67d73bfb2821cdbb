#!/usr/bin/python3
"""Writes a program that flank mills an S-shaped part: the tool leans along the ruling lines between two S-shaped
curves and turns all the way.

The part is in the manner of test piece M4 of ISO 10791-7. Its dimensions are not those of the standard: all are
options. Base and top are cubic B-splines with the same S-shaped control polygon; that of the top lies --height above,
is shifted along X by --shift and narrower by --top-width. Where the S swings out to one side the flank leans to the
other; the shift keeps the tool axis away from the vertical. The end mill touches the flank along the ruling line:

    r(u) = (top(u) - base(u)) / |...|      tool axis
    p(u) = base(u) + radius n(u)           tip; n: unit vector across the ruling line and the middle of the flank

The origin is the middle of the base. The ending of OUT says what is written:
  .ngc           G-code with tool axis vectors (G43.5), for an NC with tool-centre-point control
  .cls, .apt     cutter locations (APT), .csv the same as a table: `servomill post` makes G-code of them
Exit status: 0 written, 2 the input is wrong, 3 the system failed.
"""
import argparse
import math
import pathlib
import sys

import numpy as np

from command_line import InputError, run

# S-shaped control polygon: x and y as shares of length and width
POLYGON = np.array([(0.00, -0.30), (0.08, 0.10), (0.20, 0.62), (0.41, 0.60), (0.50, 0.00),
                    (0.59, -0.60), (0.80, -0.62), (0.92, -0.10), (1.00, 0.30)])
FINE = 20000           # points in which lengths and deviations are measured


def bspline(points, u):
    """Uniform cubic B-spline with clamped ends (control points (n, d)) and its derivative, at u in [0, 1]."""
    degree = 3
    inner = np.linspace(0.0, 1.0, len(points) - degree + 1)
    knots = np.concatenate([[0.0] * degree, inner, [1.0] * degree])
    u = np.asarray(u, dtype=float)
    basis = np.array([(knots[i] <= u) & ((u < knots[i + 1]) | ((u == 1.0) & (knots[i + 1] == 1.0) & (knots[i] < 1.0)))
                      for i in range(len(knots) - 1)], dtype=float)
    slopes = np.zeros_like(basis)
    for k in range(1, degree + 1):
        count = len(knots) - 1 - k
        raised, slopes = np.zeros((count, len(u))), np.zeros((count, len(u)))
        for i in range(count):
            left, right = knots[i + k] - knots[i], knots[i + k + 1] - knots[i + 1]
            if left > 0.0:
                raised[i] += (u - knots[i]) / left * basis[i]
                slopes[i] += k / left * basis[i]
            if right > 0.0:
                raised[i] += (knots[i + k + 1] - u) / right * basis[i + 1]
                slopes[i] -= k / right * basis[i + 1]
        basis = raised
    return basis.T @ points, slopes.T @ points


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


class SPart:
    """The flank and the tool on it, over u in [0, 1]."""

    def __init__(self, options):
        swing = np.ptp(bspline(POLYGON, np.linspace(0.0, 1.0, FINE))[0][:, 1])
        flat = np.column_stack([(POLYGON[:, 0] - 0.5) * options.length, POLYGON[:, 1] * options.width / swing])
        self.base = np.column_stack([flat, np.zeros(len(flat))])
        self.top = np.column_stack([flat[:, 0] + options.shift, flat[:, 1] * options.top_width / options.width,
                                    np.full(len(flat), options.height)])
        self.radius = options.tool_diameter / 2.0
        self.side = 1.0 if options.side == "left" else -1.0

    def tool(self, u):
        """Tips (n, 3; mm) and unit tool axes (n, 3)."""
        (base, base_slope), (top, top_slope) = bspline(self.base, u), bspline(self.top, u)
        axis = unit(top - base)
        across = unit(np.cross(axis, base_slope + top_slope))
        return base + self.side * self.radius * across, axis


def locations(part, tolerance, axis_tolerance):
    """Locations in even steps of the way, as few as keep both tolerances (mm, rad) between them."""
    fine = np.linspace(0.0, 1.0, FINE)
    tips, axes = part.tool(fine)
    way = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(tips, axis=0), axis=1))])
    count = 8
    while count < FINE // 4:
        at = np.interp(np.linspace(0.0, way[-1], count + 1), way, fine)
        p, k = part.tool(at)
        p_half, k_half = part.tool(np.interp((np.arange(count) + 0.5) * way[-1] / count, way, fine))
        off = np.linalg.norm((p[1:] + p[:-1]) / 2.0 - p_half, axis=1).max()
        turned = np.linalg.norm(unit(k[1:] + k[:-1]) - k_half, axis=1).max()
        if off <= tolerance and turned <= axis_tolerance:
            return p, k
        count = max(count + 1, int(count * min(1.3, math.sqrt(max(off / tolerance, turned / axis_tolerance)))))
    raise InputError(f"s_part.py: error: more than {FINE // 4} locations are needed; raise --tolerance or "
                     "--axis-tolerance")


def check(options, part):
    for name in ("length", "width", "height", "top_width", "tool_diameter", "feed", "tolerance", "axis_tolerance",
                 "path_tolerance"):
        if not (math.isfinite(getattr(options, name)) and getattr(options, name) > 0.0):
            raise InputError(f"s_part.py: error: --{name.replace('_', '-')} is {getattr(options, name):g}; must be > 0")
    tips, axes = part.tool(np.linspace(0.0, 1.0, FINE))
    base = bspline(part.base, np.linspace(0.0, 1.0, FINE))[0]
    if (np.sum(np.diff(tips, axis=0) * np.diff(base, axis=0), axis=1) <= 0.0).any():
        raise InputError(f"s_part.py: error: a tool of {options.tool_diameter:g} mm is too thick for the inner side of "
                         "the S; lower --tool-diameter, or raise --length or --width")
    return np.degrees(np.arccos(np.clip(axes[:, 2], -1.0, 1.0)))


def number(x, decimals):
    text = f"{x:.{decimals}f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def words(letters, values, decimals):
    return " ".join(f"{letter}{number(value, decimals)}" for letter, value in zip(letters, values))


def about(options, tilt, count):
    return ["S-shaped part in the manner of M4 of ISO 10791-7; dimensions are not those of the standard",
            f"base {options.length:g} x {options.width:g} mm, height {options.height:g}, top {options.top_width:g} mm "
            f"wide and shifted by {options.shift:g}",
            f"end mill D {options.tool_diameter:g} mm on the {options.side} side; {count} locations",
            f"tool axis {tilt.min():.1f} to {tilt.max():.1f} deg from the vertical"]


def approach_of(p, k, distance):
    """Tips before and behind the flank: along it, away from the part."""
    return p[0] - unit(p[1:2] - p[0:1])[0] * distance, p[-1] + unit(p[-1:] - p[-2:-1])[0] * distance


def ngc(options, p, k, comments):
    first, last = approach_of(p, k, options.tool_diameter)
    lines = [f"({text})" for text in comments]
    lines += ["(Work zero: middle of the base. X Y Z: tip; I J K: tool axis)",
              "G17 G21 G40 G49 G54 G90 G94", f"G64 P{number(options.path_tolerance, 7)}", f"T{options.tool} M6",
              f"G43.5 H{options.tool}", "(MSG, approach)"]
    above = first + 2.0 * options.height * k[0]
    lines += [f"G0 {words('XYZIJK', (*above, *k[0]), 7)}", f"G0 {words('XYZ', first, 7)}",
              f"G1 {words('XYZIJK', (*p[0], *k[0]), 7)} F{options.feed:g}", "(MSG, flank)"]
    lines += [words("XYZIJK", (*tip, *axis), 7) for tip, axis in zip(p[1:], k[1:])]
    lines += ["(MSG, retract)", words("XYZIJK", (*last, *k[-1]), 7),
              f"G0 {words('XYZ', last + 2.0 * options.height * k[-1], 7)}", "M30"]
    return "\n".join(lines) + "\n"


def cls(options, p, k, comments):
    first, last = approach_of(p, k, options.tool_diameter)
    goto = lambda tip, axis: "GOTO/" + ",".join(number(x, 7) for x in (*tip, *axis))
    lines = [f"$$ {text}" for text in comments]
    lines += ["PARTNO S PART", "UNITS/MM", f"LOADTL/{options.tool}", "RAPID", goto(first + 2.0 * options.height * k[0], k[0]),
              "RAPID", goto(first, k[0]), f"FEDRAT/{options.feed:g},MMPM"]
    lines += [goto(tip, axis) for tip, axis in zip(p, k)]
    lines += [goto(last, k[-1]), "RAPID", goto(last + 2.0 * options.height * k[-1], k[-1]), "FINI"]
    return "\n".join(lines) + "\n"


def csv(options, p, k, comments):
    lines = [f"# {text}" for text in comments] + ["x_mm,y_mm,z_mm,i,j,k,feed"]
    lines += [",".join(number(x, 7) for x in (*tip, *axis, options.feed)) for tip, axis in zip(p, k)]
    return "\n".join(lines) + "\n"


WRITERS = {".ngc": ngc, ".cls": cls, ".apt": cls, ".csv": csv}


def main(arguments):
    reader = argparse.ArgumentParser(prog="s_part.py", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    reader.add_argument("out", metavar="OUT", help="program or cutter locations")
    for name, default, meaning in (
            ("length", 200.0, "of the S, mm"), ("width", 90.0, "of the S at its base, mm"),
            ("height", 40.0, "of the flank, mm"), ("top-width", 66.0, "width of the S at the top, mm"),
            ("shift", 6.0, "of the top along X, mm"), ("tool-diameter", 16.0, "of the end mill, mm"),
            ("feed", 1000.0, "of the tip, mm/min"),
            ("tolerance", 0.002, "by which the tip may leave its curve between locations, mm"),
            ("axis-tolerance", 40.0, "by which the tool axis may, urad"),
            ("path-tolerance", 0.0001, "G64 P of a program, mm")):
        reader.add_argument(f"--{name}", type=float, default=default, metavar="X", help=f"{meaning} (default: {default:g})")
    reader.add_argument("--side", choices=("left", "right"), default="left",
                        help="of the S, seen along it, on which the tool is (default: left)")
    reader.add_argument("--tool", type=int, default=1, metavar="N", help="number of the tool (default: 1)")
    reader.add_argument("--force", action="store_true", help="overwrite OUT")
    options = reader.parse_args(arguments)

    path = pathlib.Path(options.out)
    if path.suffix not in WRITERS:
        raise InputError(f"{path}: error: the name must end in {', '.join(WRITERS)}")
    if path.exists() and not options.force:
        raise InputError(f"{path}: error: exists; use --force to overwrite")
    if not path.parent.is_dir():
        raise InputError(f"{path}: error: folder {path.parent} does not exist")
    part = SPart(options)
    tilt = check(options, part)
    p, k = locations(part, options.tolerance, options.axis_tolerance * 1e-6)
    path.write_text(WRITERS[path.suffix](options, p, k, about(options, tilt, len(p))))
    way = np.linalg.norm(np.diff(p, axis=0), axis=1).sum()
    print(f"{path}: {len(p)} locations, {way:.1f} mm, tool axis {tilt.min():.1f} to {tilt.max():.1f} deg from the vertical")
    return 0


if __name__ == "__main__":
    sys.exit(run(main, sys.argv[1:]))
