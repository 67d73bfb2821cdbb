"""Instruments on a machine, and the files of readings that its owner would write, made by sim/readings/README.md alone."""
import os

import numpy as np

UM = 1e-3  # mm
URAD = 1e-6  # rad
LINEAR = "XYZ"


class Bench:
    """Collects groups: their tables in TOML, their rows in CSV files."""

    def __init__(self, machine, folder, seed):
        self.machine, self.folder, self.random = machine, folder, np.random.default_rng(seed)
        self.text, self.count = [], 0

    def noise(self, sigma, size=None):
        return self.random.normal(0.0, sigma, size)

    def group(self, name, kind, keys, columns=None, rows=(), separator=",", decimal="."):
        lines = ["[[group]]", f'name = "{name}"', f'kind = "{kind}"'] + keys
        if columns:
            self.count += 1
            file = f"readings_{self.count:02d}.csv"
            lines.append(f'readings = "{file}"')
            with open(os.path.join(self.folder, file), "w", encoding="utf-8") as out:
                out.write(f"# {name}\n" + separator.join(columns) + "\n")
                for row in rows:
                    fields = [value if isinstance(value, str) else repr(round(float(value), 9)).replace(".", decimal) for value in row]
                    out.write(separator.join(fields) + "\n")
        self.text.append("\n".join(lines) + "\n")

    def at(self, q, without=""):
        return "at = { " + ", ".join(f"{a}_mm = {q[a]:g}" if a in LINEAR else f"{a}_deg = {np.degrees(q[a]):g}"
                                      for a in self.machine.axes if a not in without) + " }"

    @staticmethod
    def point(p):
        return f"point_mm = [{p[0]:g}, {p[1]:g}, {p[2]:g}]"

    # Lines -------------------------------------------------------------------------------------------------------------------

    def positioning(self, name, axis, q, p, targets, sigma, scale=None, runs=2, form="deviation", expansion=False, dead_path=False, drift=False):
        zero, k = self.noise(20 * UM), scale[1] if scale else 0.0
        rows, together = [], {}
        warm, coefficient, alpha = 21.7, 11.5e-6 + self.noise(1e-6), 11.5e-6
        shown_warm = warm + self.noise(0.3)
        wave = self.noise(0.2e-6) if dead_path else 0.0
        rate = self.noise(3 * UM) if drift else 0.0
        sequence = [(run, way, t) for run in range(1, runs + 1) for way in (1, -1) for t in (targets if way > 0 else targets[::-1])]
        for n, (run, way, t) in enumerate(sequence):
            here = {**q, axis: t}
            e, _ = self.machine.deviation(here, p, {axis: way})
            d = e @ self.machine.bed_axes(here)[:, "XYZ".index(axis)]
            share = n / (len(sequence) - 1)
            length = t - sequence[0][2]
            d += zero + k * length + self.noise(sigma) + rate * share
            if expansion:
                # what is compared with is long by alpha (T - 20): its readings are long, and brought back by the reader
                d += coefficient * (warm - 20.0) * length
            d += wave * share * ((200.0 if dead_path else 0.0) + length)
            word = {1: "forward", -1: "backward"}[way]
            if form == "runs":
                together.setdefault((t, word), []).append(t + d)
            elif form == "position":
                rows.append([t, word, str(run), t + d])
            else:
                row = [t, word, str(run), d / UM]
                rows.append(row + [shown_warm] if expansion else row)
        columns = {"deviation": ["target_mm", "direction", "run", "deviation_um"], "position": ["target_mm", "direction", "run", "position_mm"],
                   "runs": ["direction", "target_mm"] + [f"p{r}" for r in range(1, runs + 1)]}[form]
        if form == "runs":
            rows = [[word, t] + values for (t, word), values in together.items()]
        keys = [f'axis = "{axis}"', self.at(q, axis), self.point(p), f"uncertainty_um = {sigma / UM:g}"]
        if scale:
            keys.append(f'instrument = "{scale[0]}"')
        if expansion:
            columns = columns + ["temperature_degC"]
            keys.append(f"expansion = {{ coefficient_per_K = {alpha}, coefficient_uncertainty_per_K = 1e-6, temperature_uncertainty_K = 0.3 }}")
        if dead_path:
            keys.append("dead_path = { length_mm = 200, wavelength_uncertainty_um_per_m = 0.2 }")
        if drift:
            keys.append("drift = true")
        self.group(name, "positioning", keys, columns, rows, ";" if form == "position" else ",", "," if form == "position" else ".")

    def turning(self, name, axis, q, targets, sigma, p=(0, 0, -150), runs=2):
        zero = self.noise(20 * URAD)
        rows = []
        for run in range(1, runs + 1):
            for way in (1, -1):
                for t in targets if way > 0 else targets[::-1]:
                    here = {**q, axis: t}
                    _, w = self.machine.deviation(here, p, {axis: way})
                    d = w @ self.machine.turning_axis(axis, here) + zero + self.noise(sigma)
                    rows.append([np.degrees(t), {1: "+", -1: "-"}[way], str(run), d / URAD])
        self.group(name, "positioning", [f'axis = "{axis}"', self.at(q, axis), self.point(p), f"uncertainty_urad = {sigma / URAD:g}"],
                   ["target_deg", "direction", "run", "deviation_urad"], rows)

    def straightness(self, name, axis, direction, q, p, targets, sigma):
        zero, slope = self.noise(20 * UM), self.noise(50e-6)
        rows = []
        for t in targets:
            here = {**q, axis: t}
            e, _ = self.machine.deviation(here, p)
            d = e @ self.machine.bed_axes(here)[:, "XYZ".index(direction)] + zero + slope * (t - np.mean(targets)) + self.noise(sigma)
            rows.append([t, d / UM])
        self.group(name, "straightness", [f'axis = "{axis}"', f'direction = "{direction}"', self.at(q, axis), self.point(p), f"uncertainty_um = {sigma / UM:g}"],
                   ["target_mm", "deviation_um"], rows)

    def angle(self, name, axis, direction, q, p, targets, sigma):
        zero = self.noise(50 * URAD)
        rows = []
        for t in targets:
            here = {**q, axis: t}
            _, w = self.machine.deviation(here, p)
            rows.append([t, (w @ self.machine.bed_axes(here)[:, "ABC".index(direction)] + zero + self.noise(sigma)) / URAD])
        self.group(name, "angle", [f'axis = "{axis}"', f'direction = "{direction}"', self.at(q, axis), self.point(p), f"uncertainty_urad = {sigma / URAD:g}"],
                   ["target_mm", "deviation_urad"], rows)

    def squareness(self, axes, q, p, lengths, sigma, n=11):
        slopes = []
        for moving, across, length in ((axes[0], axes[1], lengths[0]), (axes[1], axes[0], lengths[1])):
            t = np.linspace(0.0, length, n)
            e = []
            for step in t:
                here = {**q, moving: q[moving] + step}
                e.append(self.machine.deviation(here, p)[0] @ self.machine.bed_axes(here)[:, "XYZ".index(across)])
            slopes.append(np.polyfit(t, e, 1)[0])
        value = -slopes[0] - slopes[1] + self.noise(sigma)
        self.group(f"square {axes}", "squareness", [f'axes = "{axes}"', self.at(q), self.point(p), f"lengths_mm = [{lengths[0]:g}, {lengths[1]:g}]",
                                                     f"uncertainty_urad = {sigma / URAD:g}", f"deviation_urad = {value / URAD:.6f}"])

    def diagonal(self, name, start, end, p, n, sigma, scale):
        zero = self.noise(20 * UM)
        whole = np.array([end[a] - start[a] for a in LINEAR])
        direction = self.machine.bed_axes(start) @ (whole / np.linalg.norm(whole))
        rows = []
        for way, word in ((1, "forward"), (-1, "backward")):
            for share in np.linspace(0, 1, n)[::way]:
                here = {**start, **{a: start[a] + share * (end[a] - start[a]) for a in LINEAR}}
                travel = {a: int(np.sign(end[a] - start[a])) * way for a in LINEAR}
                e, _ = self.machine.deviation(here, p, travel)
                d = e @ direction + zero + scale[1] * share * np.linalg.norm(whole) + self.noise(sigma)
                rows.append([here["X"], here["Y"], here["Z"], word, "1", d / UM])
        # the diagonal runs from its first to its last row: rows of the way back stand before those of the way there
        rows = sorted(rows, key=lambda row: row[0] * np.sign(whole[0]))
        keys = [self.point(p), f"uncertainty_um = {sigma / UM:g}", f'instrument = "{scale[0]}"']
        others = [a for a in self.machine.axes if a not in LINEAR]
        if others:
            keys.append(self.at(start, "XYZ"))
        self.group(name, "positioning", keys, ["X_mm", "Y_mm", "Z_mm", "direction", "run", "deviation_um"], rows)

    # Circles and bars ----------------------------------------------------------------------------------------------------------

    def circle(self, name, plane, q, p, radius, sigma, radius_sigma, step=5):
        u, v = plane
        i, j = "XYZ".index(u), "XYZ".index(v)
        axes = self.machine.bed_axes(q)
        centre, longer = self.noise(15 * UM, 2), self.noise(radius_sigma)
        ball = self.machine.tip(q, p) + axes[:, i] * centre[0] + axes[:, j] * centre[1]
        rows = []
        for way, word in ((1, "ccw"), (-1, "cw")):
            for degrees in np.arange(0, 360, step)[::way]:
                a = np.radians(degrees)
                here = {**q, u: q[u] + radius * np.cos(a), v: q[v] + radius * np.sin(a)}
                # direction in which each axis has come there: at a turning point that before it
                before = a - way * 1e-6
                travel = {u: int(np.sign(-np.sin(before))) * way, v: int(np.sign(np.cos(before))) * way}
                shown = np.linalg.norm(self.machine.tip(here, p, True, travel) - ball)
                rows.append([float(degrees), word, "1", (shown - radius + longer + self.noise(sigma)) / UM])
        self.group(name, "circle", [f'plane = "{plane}"', self.at(q), self.point(p), f"radius_mm = {radius:g}", f"radius_uncertainty_um = {radius_sigma / UM:g}",
                                    f"uncertainty_um = {sigma / UM:g}"], ["angle_deg", "direction", "run", "deviation_um"], rows)

    def ball_bar(self, name, q, p, ball, length, directions, sigma, length_sigma, column="deviation_um"):
        """A telescoping bar of about one length, about a ball on the table; rotary axes as in q."""
        ball = np.asarray(ball, float)
        true_ball, stands, longer = ball + self.noise(10 * UM, 3), self.noise(10 * UM, 3), self.noise(length_sigma)
        rows = []
        for n in directions:
            here = self._nominal_joints(ball + length * np.asarray(n), q, p)
            shown = np.linalg.norm(self.machine.tip(here, np.asarray(p) + stands, True) - true_ball) + longer + self.noise(sigma)
            rows.append([here["X"], here["Y"], here["Z"], (shown - length) / UM if column == "deviation_um" else shown])
        others = [self.at(q, "XYZ")] if len(self.machine.axes) > 3 else []
        self.group(name, "ball_bar", [f"ball_mm = [{ball[0]:g}, {ball[1]:g}, {ball[2]:g}]", f"length_mm = {length:g}", f"length_uncertainty_um = {length_sigma / UM:g}",
                                      self.point(p), f"uncertainty_um = {sigma / UM:g}"] + others, ["X_mm", "Y_mm", "Z_mm", column], rows)

    def _nominal_joints(self, target, q, p):
        q = dict(q)
        step = np.linalg.solve(self.machine.bed_axes(q), self.machine.tip(q, p) - target)
        for k, axis in enumerate("XYZ"):
            q[axis] = round(q[axis] - step[k], 6)
        return q

    # Balls ---------------------------------------------------------------------------------------------------------------------

    def joints_row(self, here):
        return [here[a] if a in LINEAR else np.degrees(here[a]) for a in self.machine.axes]

    def joint_columns(self):
        return [f"{a}_mm" if a in LINEAR else f"{a}_deg" for a in self.machine.axes]

    def r_test(self, name, poses, p, nest, sigma):
        true_nest, stands = self.noise(10 * UM, 3), self.noise(10 * UM, 3)
        rows = []
        for pose in poses:
            here = self._nominal_joints(np.asarray(nest), pose, p)
            e, _ = self.machine.deviation(here, p)
            d = e + self.machine.pose(here, False)[:3, :3] @ stands - true_nest + self.noise(sigma, 3)
            rows.append(self.joints_row(here) + list(d / UM))
        self.group(name, "r_test", [self.point(p), f"uncertainty_um = {sigma / UM:g}"], self.joint_columns() + ["dx_um", "dy_um", "dz_um"], rows)

    def spheres(self, name, places, poses, p, sigma, adjusted=False, artefact=None):
        stands = np.zeros(3) if adjusted else self.noise(10 * UM, 3)
        rows = []
        for label, place in places.items():
            for pose in poses:
                here = self.machine.joints_at(np.asarray(place) + self.machine.bed_axes(pose) @ self.noise(sigma, 3), pose, p, stands)
                rows.append(self.joints_row(here) + [label])
        keys = [self.point(p), f"uncertainty_um = {sigma / UM:g}"] + (['tool = "adjusted"'] if adjusted else [])
        if artefact:
            keys.append(f'artefact = "{artefact}"')
        self.group(name, "sphere", keys, self.joint_columns() + ["sphere"], rows)

    def touches(self, name, places, poses, p, sphere, stylus, sigma, lobes=1.0 * UM):
        """Five touches of each sphere at each pose: along the spindle and along X and Y, from both sides."""
        stands, pretravel = self.noise(8 * UM, 3), 4 * UM + self.noise(1 * UM)
        cosine, sine = self.noise(lobes), self.noise(lobes)
        rows = []
        for label, place in places.items():
            for pose in poses:
                spindle = self.machine.pose(pose, False)[:3, :3]
                for n in (spindle[:, 2], spindle[:, 0], -spindle[:, 0], spindle[:, 1], -spindle[:, 1]):
                    n_S = spindle.T @ n
                    across, azimuth = np.hypot(n_S[0], n_S[1]), np.arctan2(n_S[1], n_S[0])
                    distance = 0.5 * (sphere + stylus) - pretravel - across * (cosine * np.cos(3 * azimuth) + sine * np.sin(3 * azimuth)) + self.noise(sigma)
                    rows.append(self.joints_row(self.machine.joints_at(np.asarray(place) + distance * n, pose, p, stands)) + [label])
        self.group(name, "touch", [self.point(p), f"sphere_mm = {sphere:g}", f"stylus_mm = {stylus:g}", f"uncertainty_um = {sigma / UM:g}",
                                   "pretravel = { waves = 3, size_um = 2 }"], self.joint_columns() + ["sphere"], rows)

    def part(self, name, q, p, points, sigma):
        """A block cut with the side and the end of a tool, measured elsewhere."""
        datum, turn, radius = self.noise(20 * UM, 3), self.noise(100 * URAD, 3), self.noise(5 * UM)
        tips = [self.machine.tip({**q, **here}, p) for here, _ in points]
        middle = np.mean(tips, axis=0)
        rows = []
        for (here, n), tip in zip(points, tips):
            n = np.asarray(n, float)
            e, _ = self.machine.deviation({**q, **here}, p)
            rows.append(self.joints_row({**q, **here}) + list(n) + [(e @ n + (datum + np.cross(turn, tip - middle)) @ n - radius + self.noise(sigma)) / UM])
        self.group(name, "part", [self.point(p), f"uncertainty_um = {sigma / UM:g}"], self.joint_columns() + ["nx", "ny", "nz", "deviation_um"], rows)
