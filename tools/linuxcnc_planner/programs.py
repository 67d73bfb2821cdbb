"""Programs of some seconds, each for one thing that planners do differently."""
import math

HEAD = "G21 G90 G17 G94\n"


def lines(points, feed):
    """Straight blocks through points (mm)."""
    return f"F{feed}\n" + "".join("G1 " + " ".join(f"{axis}{x:.4f}" for axis, x in zip("XYZ", point)) + "\n" for point in points)


def square(mode, feed=3000, size=40):
    return HEAD + mode + "\nG0 X0 Y0 Z0\n" + lines([(size, 0), (size, size), (0, size), (0, 0)], feed) + "M2\n"


def zigzag(pitch, feed=3000):
    points = []
    for k in range(10):
        points += [(40 if k % 2 == 0 else 0, k * pitch), (40 if k % 2 == 0 else 0, (k + 1) * pitch)]
    return HEAD + "G64 P0.02\nG0 X0 Y0 Z0\n" + lines(points, feed) + "M2\n"


def chords(step, feed=3000, radius=20):
    count = round(2 * math.pi / math.radians(step))
    turn = [2 * math.pi * k / count for k in range(1, count + 1)]
    return (HEAD + "G64 P0.01\nG0 X0 Y0 Z0\n" + lines([(radius * math.sin(a), radius * (1 - math.cos(a))) for a in turn], feed) + "M2\n")


def surface(length, feed=3000):
    """Rows over a wavy surface, as a mould has them."""
    points = []
    for row in range(4):
        xs = [k * length for k in range(int(60 / length) + 1)]
        for x in xs if row % 2 == 0 else reversed(xs):
            points.append((x, row * 0.5, 4 * math.sin(x / 6) * math.cos(row / 8)))
    return HEAD + "G64 P0.01\nG0 X0 Y0 Z0\n" + lines(points, feed) + "M2\n"


def arcs(radius, feed=3000):
    text = HEAD + "G64 P0.02\nG0 X0 Y0 Z0\n" + f"F{feed}\n"
    for k in range(8):
        text += f"G{2 + k % 2} X{2 * radius * (k + 1):.4f} Y0 I{radius:.4f} J0\n"
    return text + "M2\n"


def helix(feed=2000):
    return HEAD + f"G64 P0.02\nG0 X0 Y0 Z0\nG2 X0 Y0 Z-6 I15 J0 P4 F{feed}\nM2\n"


def holes():
    return HEAD + "G0 X0 Y0 Z5\nG81 X5 Y5 Z-3 R1 F600\n" + "".join(f"X{x} Y{y}\n" for x in (15, 25, 35) for y in (5, 15)) + "G80\nM2\n"


def hops():
    return HEAD + "G0 X0 Y0 Z0\n" + "".join(f"G0 X{40 * (k % 2)} Y{3 * k} Z{5 * (k % 3)}\n" for k in range(12)) + "M2\n"


def star(mode, feed=3000):
    points = [(25 * math.sin(4 * math.pi * k / 5), 25 * math.cos(4 * math.pi * k / 5) - 25) for k in range(1, 6)]
    return HEAD + mode + "\nG0 X0 Y0 Z0\n" + lines(points, feed) + "M2\n"


PROGRAMS = {
    "square, G61": square("G61"),
    "square, G61.1": square("G61.1"),
    "square, G64 P0.02": square("G64 P0.02"),
    "square, G64 P0.2": square("G64 P0.2"),
    "square of 4 mm, G64 P0.05": square("G64 P0.05", size=4),
    "zigzag of 1 mm, G64 P0.02": zigzag(1.0),
    "zigzag of 5 mm, G64 P0.02": zigzag(5.0),
    "star, G64 P0.05": star("G64 P0.05"),
    "star, G61.1": star("G61.1"),
    "circle in chords of 10 deg": chords(10),
    "circle in chords of 3 deg": chords(3),
    "circle in chords of 1 deg": chords(1),
    "circle in chords of 0.3 deg": chords(0.3),
    "surface in 2 mm": surface(2.0),
    "surface in 0.5 mm": surface(0.5),
    "surface in 0.1 mm": surface(0.1),
    "half circles of 5 mm": arcs(5.0),
    "helix": helix(),
    "holes, G81": holes(),
    "rapids": hops(),
}
