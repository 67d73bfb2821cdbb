#!/usr/bin/python3
"""Figures of tests, from reports with more and with less in them."""
import json
import math
import pathlib
import subprocess
import sys
import tempfile
import unittest

import numpy as np

TOOL = pathlib.Path(__file__).resolve().parents[2] / "tools" / "standard_figures.py"
sys.path.insert(0, str(TOOL.parent))
import standard_figures  # noqa: E402

NAMES = ("B", "B_mean", "R_up", "R_down", "R", "E_up", "E_down", "E", "M", "A_up", "A_down", "A")


def column(name, values, unit="m"):
    return {"name": name, "unit": unit, "values": values}


def parameter(name, value, U=None, unit="m"):
    return {"parameter": name, "value": value, "U": U, "unit": unit}


def positioning(name="axis.csv", both=True, unit="m", U=1e-7):
    x, up = [0.0, 0.1, 0.2], [1e-6, 2e-6, 4e-6]
    down = [0.5e-6, 2e-6, 3e-6] if both else [None] * 3
    columns = [column("target", x, unit), column("x_up", up, unit), column("x_down", down, unit),
               column("mean", [a and (a + b) / 2 for a, b in zip(down, up)] if both else [None] * 3, unit),
               column("s_up", [1e-7] * 3, unit), column("s_down", [1e-7] * 3 if both else [None] * 3, unit)]
    only_up = ("R_up", "E_up", "A_up")
    return {"standard": "ISO 230-2", "name": name, "notes": [],
            "parameters": [parameter(one, 1e-6 if both or one in only_up else None, U, unit) for one in NAMES],
            "tables": [{"name": "target", "rows": [], "columns": columns}]}


def circle(standard="ISO 230-4", names=("ccw", "cw")):
    angle = np.linspace(0.0, 2 * np.pi, 90, endpoint=False)
    tables = [{"name": f"curve {name}", "rows": [],
               "columns": [column("angle", angle.tolist(), "rad"), column("radial error", (5e-6 * np.sin(2 * angle)).tolist())]} for name in names]
    return {"standard": standard, "name": "a/circle XY.csv", "notes": [],
            "parameters": [parameter("G_ccw", 1e-5), parameter("squareness", 1e-4, unit="rad")], "tables": tables}


def diagonal():
    columns = [column(name, [1e-6, 2e-6, None]) for name in "ERBAM"]
    return {"standard": "ISO 230-6", "name": "3 diagonals", "notes": [], "parameters": [parameter("E_d", 2e-6)],
            "tables": [{"name": "diagonal", "rows": ["d1.csv", "d2.csv", "d3.csv"], "columns": columns}]}


def ball(angle=None):
    """Two sensors in both directions, over the angle or in their order."""
    tables = []
    for k, direction in enumerate(("forward", "backward")):
        place = [math.pi * n / 6 for n in range(13)] if angle else [float(n) for n in range(1, 14)]
        columns = [{"name": "angle" if angle else "reading", "unit": "rad" if angle else "1", "values": place}]
        columns += [{"name": sensor, "unit": "m", "values": [1e-6 * (k + math.sin(n + j)) for n in range(13)]} for j, sensor in enumerate(("radial", "axial"))]
        tables.append({"name": f"curve {direction}", "columns": columns, "rows": []})
    parameters = [{"parameter": sensor, "value": 2.9e-6, "unit": "m", "U": None} for sensor in ("radial", "axial")]
    return {"standard": "ISO 10791-6", "name": "BK1.csv", "parameters": parameters, "tables": tables}


class Figures(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.temporary.name)
        self.addCleanup(self.temporary.cleanup)

    def draw(self, *reports, status=0, options=(), text=None):
        path = self.folder / "reports.json"
        path.write_text(text if text is not None else json.dumps(reports), encoding="utf-8")
        done = subprocess.run([TOOL, path, "-o", self.folder / "out", *options], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, status, done.stdout + done.stderr)
        return done

    def test_each_standard_has_its_figure(self):
        other = {"standard": "ISO 1", "name": "other.csv", "parameters": [], "tables": []}
        done = self.draw(positioning(), positioning(both=False, U=None), positioning(unit="rad"), circle(), circle("ISO 230-7", ("radial_x", "axial")),
                         diagonal(), ball(), ball("deg"), other)
        names = sorted(path.name for path in (self.folder / "out").iterdir())
        self.assertEqual(names, ["3-diagonals-iso230-6.png", "BK1-iso10791-6-2.png", "BK1-iso10791-6.png", "axis-iso230-2-2.png", "axis-iso230-2-3.png", "axis-iso230-2.png",
                                 "circle-XY-iso230-4.png", "circle-XY-iso230-7.png"])
        self.assertIn("ISO 1 has no figure", done.stderr)
        for path in (self.folder / "out").iterdir():
            self.assertEqual(path.read_bytes()[:4], b"\x89PNG")

    def test_the_diagram_shows_what_the_report_has(self):
        figure = standard_figures.positioning(positioning())
        axes = figure.axes[0]
        lines = {line.get_label(): line for line in axes.lines}
        np.testing.assert_allclose(lines["mean \N{UPWARDS ARROW}"].get_ydata(), [1.0, 2.0, 4.0])
        np.testing.assert_allclose(lines["mean \N{UPWARDS ARROW} $\\pm$ 2 s"].get_ydata(), [1.2, 2.2, 4.2])
        np.testing.assert_allclose(lines["mean \N{DOWNWARDS ARROW}"].get_xdata(), [0.0, 100.0, 200.0])
        self.assertEqual([text.get_text() for text in axes.texts if text.get_text()], ["A", "E", "M"])
        self.assertIn("A 1.00 um (U 0.10 um)", axes.get_title())
        self.assertEqual(axes.get_ylabel(), "deviation, um")

    def test_one_direction_has_no_ranges_of_both(self):
        axes = standard_figures.positioning(positioning(both=False)).axes[0]
        self.assertEqual([text.get_text() for text in axes.texts if text.get_text()], [])
        self.assertNotIn("mean \N{DOWNWARDS ARROW}", [line.get_label() for line in axes.lines])

    def test_polar_diagrams_are_magnified_in_round_divisions(self):
        axes = standard_figures.polar(circle()).axes[0]
        self.assertEqual(axes.get_title(), "2 um a division")
        r = axes.lines[0].get_ydata()
        self.assertAlmostEqual((r.max() + r.min()) / 2, standard_figures.RING, places=3)
        self.assertEqual([standard_figures.nice(x) for x in (0.9, 1.0, 4.9, 37.0)], [0.5, 1.0, 2.0, 20.0])

    def test_wrong_files_are_refused(self):
        self.assertIn("reports.json: error:", self.draw(status=2, text="no json\n").stderr)
        self.assertIn("is not a report of servomill evaluate --json", self.draw(status=2, text="[{}]\n").stderr)
        self.assertIn("is not a list of reports", self.draw(status=2, text="{}\n").stderr)
        self.assertIn("is empty", self.draw(status=2, text="[]\n").stderr)
        self.draw(circle())
        self.assertIn("exists; use --force", self.draw(circle(), status=2).stderr)
        self.draw(circle(), options=("--force",))


if __name__ == "__main__":
    unittest.main()
