"""Programs of the league that are made, not kept: the same bytes on every machine."""
import math


def patch(lines=3000):
    """Finishing passes over a wavy surface: blocks of about 0.6 mm, there and back along X, 0.8 mm further in Y each time."""
    out = ["%", "(Mould patch, short blocks; made by tools/league)", "G17 G21 G40 G49 G54 G90 G94", "G64 P0.005", "F3000",
           "(MSG, approach)", "G0 X0 Y0 Z10", "G1 Z0", "(MSG, patch)"]
    step, width = 0.6, 60.0
    count, y, forth = 0, 0.0, True
    while count < lines:
        places = [n * step for n in range(int(width / step) + 1)]
        for x in places if forth else reversed(places):
            z = 2.0 * math.sin(0.12 * x + 0.05 * y) + 0.6 * math.sin(0.31 * x - 0.2 * y + 1.0)
            bow = 0.4 * math.sin(0.2 * x)
            out.append(f"G1 X{x:.3f} Y{y + bow:.3f} Z{z:.3f}")
            count += 1
        y, forth = y + 0.8, not forth
    return "\n".join([*out, "(MSG, retract)", "G0 Z30", "M30", "%", ""])


def blade(points=360):
    """A twisted blade, flank milled along its suction side: the tool leans by 10 to 22 deg and turns by 100 deg about Z."""
    out = ["%", "(Twisted blade, flank milled; made by tools/league)", "G17 G21 G40 G49 G54 G90 G94", "G64 P0.002",
           "T1 M6", "G43.5 H1", "(MSG, approach)"]

    def place(u):
        angle = math.radians(-50.0 + 100.0 * u)
        radius = 70.0 - 15.0 * u + 6.0 * math.sin(5.0 * u)
        lean = math.radians(10.0 + 12.0 * math.sin(math.pi * u))
        k = (math.sin(lean) * math.cos(angle), math.sin(lean) * math.sin(angle), math.cos(lean))
        return (radius * math.cos(angle), radius * math.sin(angle), 4.0 + 18.0 * u), k

    def words(u):
        (x, y, z), (i, j, k) = place(u)
        return f"X{x:.6f} Y{y:.6f} Z{z:.6f} I{i:.8f} J{j:.8f} K{k:.8f}"

    (x, y, z), (i, j, k) = place(0.0)
    out += [f"G0 X{x:.6f} Y{y:.6f} Z{z + 80.0:.6f} I{i:.8f} J{j:.8f} K{k:.8f}", f"G0 {words(0.0)}", "F3000", "(MSG, blade)"]
    out += [f"G1 {words(n / points)}" for n in range(1, points + 1)]
    return "\n".join([*out, "(MSG, retract)", f"G0 Z{z + 100.0:.3f}", "M30", "%", ""])


MADE = {"patch": patch, "blade": blade}
