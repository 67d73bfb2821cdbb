"""Machines drawn at random, measured with every kind of readings.

    foreign_readings.py FOLDER [SEED] [three|five|head]
"""
import os
import sys

import numpy as np

from foreign_bench import UM, URAD, Bench
from foreign_machine import Function, Machine, frame, rotation


def random_function(random, knots, sigma, lost=0.0):
    return Function(knots, random.normal(0.0, sigma, len(knots)), lost)


def forms(machine):
    """Says that the errors of this machine are straight between their knots: otherwise the intervals would be those of any error."""
    text = "\n[adjustment.form]\n"
    for name, function in machine.components.items():
        knots = function.knots if name[2] in "XYZ" else np.degrees(function.knots)
        text += f"{name} = {{ knots_{'mm' if name[2] in 'XYZ' else 'deg'} = [{', '.join(f'{knot:.9g}' for knot in knots)}] }}\n"
    return text


def three_axes(seed):
    random = np.random.default_rng([seed, 1])
    knots = {"X": np.linspace(0, 800, 11), "Y": np.linspace(0, 600, 11), "Z": np.linspace(-400, 0, 11)}
    components = {}
    for axis in "XYZ":
        for direction in "XYZABC":
            lost = random.normal(0.0, 6 * UM) if direction == axis else 0.0
            components[f"E{direction}{axis}"] = random_function(random, knots[axis], 6 * UM if direction in "XYZ" else 8 * URAD, lost)
    locations = {name: random.normal(0.0, 40 * URAD) for name in ("EC0Y", "EB0Z", "EA0Z")}
    return Machine("w b X Y Z t", components, locations), knots


def measure_three(machine, knots, folder, seed):
    bench = Bench(machine, folder, [seed, 2])
    laser = ("laser", bench.noise(0.25e-6))
    q = {"X": 400.0, "Y": 300.0, "Z": -200.0}
    tools = [(0, 0, -100), (120, 0, -100), (0, 90, -250)]
    ways = [dict(form="deviation", drift=True), dict(form="position"), dict(form="runs")]
    for axis in "XYZ":
        for k in range(3):
            others = {a: float(knots[a][[2, 5, 9][(k + i) % 3]]) for i, a in enumerate("XYZ") if a != axis}
            here = {**q, **others}
            extra = dict(ways[k])
            if axis == "X" and k == 0:
                extra = dict(form="deviation", expansion=True)
            if axis == "Y" and k == 0:
                extra = dict(form="deviation", dead_path=True)
            bench.positioning(f"{axis} positioning {k}", axis, here, tools[k], knots[axis], 0.4 * UM, laser, **extra)
            for direction in "XYZ".replace(axis, ""):
                bench.straightness(f"{axis} straightness {direction} {k}", axis, direction, here, tools[k], knots[axis], 0.5 * UM)
            for direction in "ABC":
                bench.angle(f"{axis} angle {direction} {k}", axis, direction, here, tools[k], knots[axis], 1.0 * URAD)
    for axes, lengths in (("XY", (800, 600)), ("YZ", (600, 400)), ("XZ", (800, 400))):
        start = {"X": 0.0 if "X" in axes else 400.0, "Y": 0.0 if "Y" in axes else 300.0, "Z": -400.0 if "Z" in axes else -200.0}
        bench.squareness(axes, start, tools[0], lengths, 1.0 * URAD)
    corners = [({"X": 0.0, "Y": 0.0, "Z": -400.0}, {"X": 800.0, "Y": 600.0, "Z": 0.0}), ({"X": 800.0, "Y": 0.0, "Z": -400.0}, {"X": 0.0, "Y": 600.0, "Z": 0.0})]
    for k, (start, end) in enumerate(corners):
        bench.diagonal(f"diagonal {k}", start, end, tools[0], 11, 0.5 * UM, laser)
    for plane, radius in (("XY", 150), ("YZ", 150), ("XZ", 150), ("YX", 100)):
        bench.circle(f"circle {plane}", plane, q, tools[0], radius, 0.5 * UM, 0.3 * UM)
    points = [np.array(n) / np.linalg.norm(n) for n in ((1, 0, .5), (-1, .3, .8), (0, 1, .4), (.2, -1, .9), (0, 0, 1), (1, 1, .6), (-1, -1, .7), (.5, -.5, .9), (-.4, .8, .3), (.9, -.2, .35), (-.7, .1, .5), (.3, .6, .8))]
    bench.ball_bar("bar", q, tools[0], (400, 300, -400), 250, points, 0.5 * UM, 1 * UM)
    bench.ball_bar("bar, lengths", q, tools[2], (300, 300, -500), 200, points, 0.5 * UM, 1 * UM, "length_mm")
    # a ball plate, calibrated in its own frame, somewhere on the table
    own = {f"b{i}{j}": np.array([100.0 * i, 100.0 * j, 0.0]) for i in range(4) for j in range(3)}
    os.makedirs(folder, exist_ok=True)
    with open(os.path.join(folder, "plate.csv"), "w", encoding="utf-8") as file:
        file.write("sphere,X_mm,Y_mm,Z_mm\n" + "".join(f"{n},{p[0] + bench.noise(0.3 * UM):.6f},{p[1] + bench.noise(0.3 * UM):.6f},{p[2] + bench.noise(0.3 * UM):.6f}\n" for n, p in own.items()))
    place = frame(R=rotation([0.05, -0.03, 0.4]), p=[300, 150, -380])
    scale = 1 + bench.noise(0.3e-6)
    plate = {n: (place @ np.append(p * scale, 1.0))[:3] for n, p in own.items()}
    bench.spheres("plate", plate, [q], tools[0], 0.6 * UM, artefact="plate")
    # a block
    block = [({"X": float(x), "Y": float(y), "Z": float(z)}, n) for z in (-300, -200) for t in range(5)
             for x, y, n in ((200, 100 + 80 * t, (-1, 0, 0)), (600, 100 + 80 * t, (1, 0, 0)), (200 + 100 * t, 100, (0, -1, 0)), (200 + 100 * t, 420, (0, 1, 0)))]
    bench.part("block", q, tools[0], block, 0.7 * UM)
    with open(os.path.join(folder, "machine.toml"), "w", encoding="utf-8") as file:
        file.write('name = "foreign router"\nsource = "drawn at random"\nstructure = "[w b X Y Z (C1) t]"\n\n')
        for axis, (lower, upper) in {"X": (-10, 810), "Y": (-10, 610), "Z": (-410, 10)}.items():
            file.write(f"[axis.{axis}]\ntravel_mm = [{lower}, {upper}]\n\n")
    head = 'machine = "machine.toml"\n\n[[instrument]]\nname = "laser"\nscale_uncertainty_um_per_m = 0.25\n\n'
    head += '[[artefact]]\nname = "plate"\ncentres = "plate.csv"\nuncertainty_um = 0.3\nscale_uncertainty_um_per_m = 0.3\n\n'
    with open(os.path.join(folder, "readings.toml"), "w", encoding="utf-8") as file:
        file.write(head + "\n".join(bench.text) + forms(machine))


# Structures with their two rotary axes, the centres of these (mm) and the location errors that a machine of that kind can have.
KINDS = {
    "five": ("w C' A' b X Y Z t", {"A": (0, 0, 50)}, ("EB0A", "EC0A", "EA0C", "EB0C"), ("EY0A", "EZ0A", "EX0C", "EY0C")),
    "head": ("w C' b X Y Z B t", {"B": (0, 0, 80)}, ("EA0B", "EC0B", "EA0C", "EB0C"), ("EX0B", "EZ0B", "EX0C", "EY0C")),
}


def five_axes(seed, kind="five"):
    random = np.random.default_rng([seed, 3 if kind == "five" else 5])
    structure, centres, tilts, offsets = KINDS[kind]
    tilting = next(iter(centres))
    knots = {"X": np.linspace(-400, 400, 11), "Y": np.linspace(-300, 300, 11), "Z": np.linspace(-200, 500, 11),
             tilting: np.radians(np.linspace(-60, 60, 9)), "C": np.radians(np.linspace(0, 330, 12))}
    components = {}
    for axis in knots:
        for direction in "XYZABC":
            turns = direction + axis in ("AA", "BB", "CC")
            lost = random.normal(0.0, 6 * UM if axis in "XYZ" else 10 * URAD) if direction == axis or turns else 0.0
            function = random_function(random, knots[axis], 4 * UM if direction in "XYZ" else 8 * URAD, lost)
            mean, slope = function.moments()
            across = direction in "XYZ" and axis in "XYZ" and direction != axis
            components[f"E{direction}{axis}"] = function.without(mean, slope if across else 0.0)
    locations = {name: random.normal(0.0, 30 * URAD) for name in ("EC0Y", "EB0Z", "EA0Z") + tilts}
    locations.update({name: random.normal(0.0, 15 * UM) for name in offsets})
    return Machine(structure, components, locations, centres), knots


def measure_five(machine, knots, folder, seed):
    bench = Bench(machine, folder, [seed, 4])
    laser = ("laser", bench.noise(0.25e-6))
    tilting = next(axis for axis in knots if axis in "AB")
    q = {"X": 0.0, "Y": 0.0, "Z": 150.0, tilting: 0.0, "C": 0.0}
    tools = [(0, 0, -120), (100, 0, -120), (0, 90, -220)]
    for axis in "XYZ":
        for k in range(3):
            others = {a: float(knots[a][[2, 5, 9][(k + i) % 3]]) for i, a in enumerate("XYZ") if a != axis}
            here = {**q, **others}
            bench.positioning(f"{axis} positioning {k}", axis, here, tools[k], knots[axis], 0.4 * UM, laser)
            for direction in "XYZ".replace(axis, ""):
                bench.straightness(f"{axis} straightness {direction} {k}", axis, direction, here, tools[k], knots[axis], 0.5 * UM)
            for direction in "ABC":
                bench.angle(f"{axis} angle {direction} {k}", axis, direction, here, tools[k], knots[axis], 1.0 * URAD)
    for axes, lengths in (("XY", (800, 600)), ("YZ", (600, 700)), ("XZ", (800, 700))):
        start = {**q, **{a: float(knots[a][0]) for a in axes}}
        bench.squareness(axes, start, tools[0], lengths, 1.0 * URAD)
    for plane in ("XY", "YZ", "XZ"):
        bench.circle(f"circle {plane}", plane, q, tools[0], 150, 0.5 * UM, 0.3 * UM)
    bench.turning(f"{tilting}, autocollimator", tilting, q, knots[tilting], 1 * URAD)
    bench.turning("C, polygon", "C", q, knots["C"], 1 * URAD)
    bench.turning("C, polygon, tilted", "C", {**q, tilting: np.radians(-30)}, knots["C"], 1 * URAD)
    tilts = knots[tilting] if tilting == "A" else knots[tilting][2:-2]  # a head has less room
    poses = [{**q, tilting: a, "C": c} for k in (0, 1) for a in tilts[k::2] for c in knots["C"][k::2]]
    bench.r_test("nest, low", poses, tools[0], (120, 40, 60), 0.6 * UM)
    bench.r_test("nest, high", poses, tools[2], (-70, 90, 180), 0.6 * UM)
    bench.spheres("spheres", {"a": (150, 0, 60), "b": (-60, 120, 100)}, poses, tools[0], 0.6 * UM)
    bench.spheres("spheres, long stylus", {"a": (150, 0, 60), "b": (-60, 120, 100)}, poses[::2], (0, 0, -220), 0.6 * UM, adjusted=True)
    bench.touches("touches", {"a": (140, 30, 60), "b": (-80, 100, 120)}, poses[::2], tools[0], 25, 6, 0.4 * UM)
    structure = machine.structure.replace(" t", " (C1) t")
    centre = ", ".join(f"{c:g}" for c in machine.centres[tilting])
    with open(os.path.join(folder, "machine.toml"), "w", encoding="utf-8") as file:
        file.write(f'name = "foreign five axes"\nsource = "drawn at random"\nstructure = "[{structure}]"\n\n')
        for axis, (lower, upper) in {"X": (-600, 600), "Y": (-600, 600), "Z": (-350, 620)}.items():
            file.write(f"[axis.{axis}]\ntravel_mm = [{lower}, {upper}]\n\n")
        file.write(f"[axis.{tilting}]\ntravel_deg = [-110, 110]\ncentre_mm = [{centre}]\n\n[axis.C]\n")
    with open(os.path.join(folder, "readings.toml"), "w", encoding="utf-8") as file:
        file.write('machine = "machine.toml"\n\n[[instrument]]\nname = "laser"\nscale_uncertainty_um_per_m = 0.25\n\n' + "\n".join(bench.text) + forms(machine))


def make(folder, seed, kind):
    """Draws a machine, measures it, writes all files; returns the machine."""
    os.makedirs(folder, exist_ok=True)
    machine, knots = three_axes(seed) if kind == "three" else five_axes(seed, kind)
    (measure_three if kind == "three" else measure_five)(machine, knots, folder, seed)
    return machine


if __name__ == "__main__":
    make(sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 1, sys.argv[3] if len(sys.argv) > 3 else "three")
