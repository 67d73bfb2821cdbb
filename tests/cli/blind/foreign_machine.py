"""A machine with errors and the instruments that measure it, by the READMEs alone: no line of servomill's own forward model.

The chain is that of `structure` (workpiece first), one homogeneous matrix an axis; signs of errors, sides and frames are those that
plant/geometry/error_model.h states, numbers of readings those of sim/readings/README.md. Lengths in mm, angles in rad.
"""
import numpy as np

LETTERS = "XYZABC"


def rotation(vector):
    """exp([v]x) by Rodrigues' formula."""
    angle = np.linalg.norm(vector)
    if angle < 1e-300:
        return np.eye(3)
    k = np.asarray(vector) / angle
    K = np.array([[0, -k[2], k[1]], [k[2], 0, -k[0]], [-k[1], k[0], 0]])
    return np.eye(3) + np.sin(angle) * K + (1 - np.cos(angle)) * K @ K


def rotation_vector(R):
    """Of a small turn."""
    return 0.5 * np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])


def frame(R=None, p=(0, 0, 0)):
    H = np.eye(4)
    if R is not None:
        H[:3, :3] = R
    H[:3, 3] = p
    return H


class Function:
    """A component error: straight between knots, with a lost motion (up minus down); mm or rad over mm or rad."""

    def __init__(self, knots, values, lost=0.0):
        self.knots, self.values, self.lost = np.asarray(knots, float), np.asarray(values, float), lost

    def __call__(self, s, direction=0):
        return np.interp(s, self.knots, self.values) + 0.5 * self.lost * direction

    def moments(self):
        """Mean and slope by least squares, uniformly weighted, of a function that is straight between its knots."""
        a, b = self.knots[0], self.knots[-1]
        s = np.linspace(a, b, 20001)
        y = np.interp(s, self.knots, self.values)
        weight = np.full(s.size, 1.0)
        weight[[0, -1]] = 0.5
        mean = (weight * y).sum() / weight.sum()
        u = s - 0.5 * (a + b)
        return mean, (weight * u * y).sum() / (weight * u * u).sum()

    def without(self, mean, slope=0.0):
        middle = 0.5 * (self.knots[0] + self.knots[-1])
        return Function(self.knots, self.values - mean - slope * (self.knots - middle), self.lost)


class Machine:
    """`structure` such as "w C' A' b X Y Z t"; centres of rotary axes in mm."""

    def __init__(self, structure, components=None, locations=None, centres=None):
        words = [word.strip("'") for word in structure.split()]
        bed = words.index("b")
        self.structure = structure
        self.chain = [(word, k < bed) for k, word in enumerate(words) if word in LETTERS]
        self.axes = [axis for axis, _ in self.chain]
        self.components = components or {}  # "EXX": Function
        self.locations = locations or {}    # "EC0Y": number
        self.centres = centres or {}

    def _ideal(self, axis, q):
        k = LETTERS.index(axis)
        unit = np.eye(3)[k % 3]
        return frame(p=q * unit) if k < 3 else frame(R=rotation(q * unit))

    def _component(self, axis, q, direction):
        e = [self.components[f"E{d}{axis}"](q, direction) if f"E{d}{axis}" in self.components else 0.0 for d in LETTERS]
        return frame(p=e[:3]) @ frame(R=rotation(e[3:]))

    def _location(self, axis):
        e = [self.locations.get(f"E{d}0{axis}", 0.0) for d in LETTERS]
        return frame(R=rotation(e[3:])) @ frame(p=e[:3])

    def pose(self, q, actual, travel=None):
        """Frame of the spindle nose in that of the workpiece; q: axis to position, travel: axis to 1, -1 or 0."""
        H = np.eye(4)
        for axis, carries_workpiece in self.chain:
            J = self._ideal(axis, q[axis])
            if actual:
                L = self._location(axis)
                J = L @ J @ np.linalg.inv(L)
                E = self._component(axis, q[axis], (travel or {}).get(axis, 0))
                J = E @ J if carries_workpiece else J @ E
            C = frame(p=self.centres.get(axis, (0, 0, 0)))
            H = H @ C @ J @ np.linalg.inv(C)
        return H

    def tip(self, q, point, actual=False, travel=None):
        return (self.pose(q, actual, travel) @ np.append(point, 1.0))[:3]

    def deviation(self, q, point, travel=None):
        """e of the tool at `point`, w of its body; seen from the table, in the axes of the table."""
        ideal, real = self.pose(q, False), self.pose(q, True, travel)
        p = np.append(point, 1.0)
        return ((real - ideal) @ p)[:3], rotation_vector(real[:3, :3] @ ideal[:3, :3].T)

    def bed_axes(self, q):
        """The axes of the machine M, seen from the table, at these joints (columns)."""
        R = np.eye(3)
        for axis, carries_workpiece in self.chain:
            if carries_workpiece:
                R = R @ self._ideal(axis, q[axis])[:3, :3]
        return R

    def turning_axis(self, axis, q):
        """The direction about which the body of the tool turns as that axis counts up, seen from the table."""
        return rotation_vector(self.pose({**q, axis: q[axis] + 1e-4}, False)[:3, :3] @ self.pose(q, False)[:3, :3].T) / 1e-4

    def joints_at(self, target, q, point, offset=(0, 0, 0)):
        """Linear joints with which the true tip, plus an offset in the spindle, stands at a place on the table."""
        q = dict(q)
        for _ in range(6):
            pose = self.pose(q, True)
            missed = (pose @ np.append(np.asarray(point) + offset, 1.0))[:3] - target
            step = np.linalg.solve(self.bed_axes(q), missed)
            for k, axis in enumerate("XYZ"):
                q[axis] -= step[k]
        return q


def projected(machine, frame_axes="XY"):
    """The same errors by the conventions of sim/calibration/README.md: means and slopes of linear axes' component errors put where
    they belong. Constants of X and Y turn the frame of the machine; what remains shows in the squarenesses. First order."""
    assert frame_axes == "XY"
    components, locations = {}, dict(machine.locations)
    add = lambda name, value: locations.__setitem__(name, locations.get(name, 0.0) + value)
    for name, function in machine.components.items():
        direction, axis = name[1], name[2]
        mean, slope = function.moments()
        across = direction in "XYZ" and axis in "XYZ" and direction != axis
        components[name] = function.without(mean, slope if across else 0.0)
        if direction in "ABC" and axis in "XYZ":  # the body that follows is turned
            moved = {"BX": ("EB0Z", 1), "CX": ("EC0Y", 1), "AY": ("EA0Z", 1), "BY": ("EB0Z", 1)}.get(direction + axis)
            if moved:
                add(moved[0], moved[1] * mean)
        if across:
            name, sign = {"YX": ("EC0Y", -1), "ZX": ("EB0Z", 1), "XY": ("EC0Y", -1), "ZY": ("EA0Z", -1), "XZ": ("EB0Z", 1), "YZ": ("EA0Z", -1)}[direction + axis]
            add(name, sign * slope)
    return Machine(machine.structure, components, locations, machine.centres)
