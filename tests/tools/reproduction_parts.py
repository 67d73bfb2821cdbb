"""What is derived from probed parts, and drawn of them."""
import pathlib
import tempfile
import types
import unittest

from reproduction_files import HERE, row, servomill

import h5py
import numpy as np

from figures import experiment2, parts, results as files, style
from reproduction import derived, values


class Parts(unittest.TestCase):
    """Figures 16 to 19 and what is derived from probed parts, of parts whose errors are known."""

    SCALE, TILT = 0.3, 2e-4       # um/mm along X and against Y; rad about X
    SHIFT, TURN = np.array([7.0, -4.0]), 50.0     # um, urad: what a best fit takes away

    @classmethod
    def setUpClass(cls):
        folder = cls.enterClassContext(tempfile.TemporaryDirectory())
        path = pathlib.Path(folder) / "parts.h5"
        servomill("run", HERE / "generated_and_compensated.toml", "-q", "-o", path)
        with h5py.File(path, "a") as file:
            for case in experiment2.PARTS:
                file.copy(file[f"cases/{case}"], file["cases"], case + experiment2.AIR)
                cls.probe(file[f"cases/{case}"], case == "generated")
        cls.run_ = cls.enterClassContext(files.open_result(path))

    @classmethod
    def probe(cls, case, deformed):
        angle = np.arange(72) * 5.0
        round_ = np.column_stack([np.cos(np.radians(angle)), np.sin(np.radians(angle)), 0.0 * angle])
        x, y = (grid.ravel() for grid in np.meshgrid(np.linspace(-20.0, 20.0, 5), np.linspace(-20.0, 20.0, 5)))
        for name, kind, points, normals in (
                ("circle", "circle", 50.0 * round_, round_),
                ("side", "line", np.column_stack([np.full(9, 60.0), np.linspace(-40.0, 40.0, 9), np.zeros(9)]),
                 np.tile([1.0, 0.0, 0.0], (9, 1))),
                ("top", "plane", np.column_stack([x, y, 0.0 * x]), np.tile([0.0, 0.0, 1.0], (25, 1)))):
            moved, form = np.zeros_like(points), np.zeros_like(points)
            if deformed:
                form[:, :2] = cls.SCALE * points[:, :2] * [1.0, -1.0]
                moved[:, :2] = (cls.SHIFT + cls.TURN / 1000.0 * np.column_stack([-points[:, 1], points[:, 0]])
                                + form[:, :2])
                moved[:, 2] = 1000.0 * np.tan(cls.TILT) * points[:, 1]
            group = case.create_group(f"probes/{name}")
            group.attrs["kind"] = kind
            group["nominal"], group["normal"] = points, normals
            group["deviation"] = (moved * normals).sum(axis=1)
            group["measured"] = np.tile(group["deviation"][:], (3, 1))
            group["sigma"] = np.zeros(len(points))
            group["aligned_position"] = points
            group["aligned_deviation"] = (form * normals).sum(axis=1)[:, None] * normals

    def test_plane_is_turned_as_it_was_cut(self):
        feature = parts.probed(self.run_)["top"]["generated"]
        about_x, about_y = experiment2.fitted_plane(feature.nominal, feature.mean).rotations()
        self.assertAlmostEqual(about_x, np.degrees(self.TILT), delta=1e-12)
        self.assertAlmostEqual(about_y, 0.0, delta=1e-12)

    def test_distortion_is_that_of_the_scale_errors(self):
        results = types.SimpleNamespace(opened=lambda _: self.run_)
        self.assertLess(derived.largest_after_best_fit(results, "", "nominal"), 1e-9)
        largest = derived.largest_after_best_fit(results, "", "generated")
        self.assertAlmostEqual(largest, self.SCALE * 60.0, delta=1e-9)   # the side lies 60 mm out
        self.assertAlmostEqual(derived.difference_after_best_fit(results, "", "generated", "nominal"), largest, delta=1e-9)
        for at in ("scale", "tool"):
            self.assertEqual(derived.cutting_minus_air(results, "", "generated", at, "circle"), 0.0)

    def changed(self, change):
        """The run after change(file, the features of the generated part)."""
        with tempfile.NamedTemporaryFile(suffix=".h5") as copy:
            path = pathlib.Path(copy.name)
            path.write_bytes(self.run_.path.read_bytes())
            with h5py.File(path, "a") as file:
                change(file, file["cases/generated/probes"])
            return self.enterContext(files.open_result(path))

    def test_without_a_nominal_part_there_is_no_best_fit(self):
        def forget(_, features):
            for feature in features.values():
                del feature["aligned_position"], feature["aligned_deviation"]

        def forget_with_stl(file, features):
            forget(file, features)
            file["inputs"].attrs["resolved"] = file["inputs"].attrs["resolved"] + '\n[part]\nstl = "m1_part.stl"\n'

        for change, reason in (
                (forget, "the part of case generated was not aligned: the scenario has no nominal part (part.stl)"),
                (forget_with_stl, "the part of case generated could not be aligned with m1_part.stl")):
            run = self.changed(change)
            for draw in (lambda one: experiment2.best_fit(one, "generated"), experiment2.draw_quivers, experiment2.draw_superposed):
                with self.assertRaises(files.NotInFile) as fault:
                    draw(run)
                self.assertEqual(str(fault.exception), reason)
            self.assertIsNotNone(experiment2.best_fit(run, "nominal"))

    LOST = [0, 10]   # points of the circle

    def lose(self, points):
        def change(_, features):
            for point in points:
                for name in ("deviation", "measured", "sigma"):
                    features["circle"][name][..., point] = np.nan
                for name in ("aligned_position", "aligned_deviation"):
                    features["circle"][name][point] = np.nan
        return self.changed(change)

    def test_points_that_met_nothing_are_marked_and_break_the_outline(self):
        style.set_up()
        run = self.lose(self.LOST)
        places = experiment2.best_fit(run, "generated").nominal[self.LOST]
        for draw, axes in ((experiment2.draw_quivers, 2), (experiment2.draw_superposed, 1)):
            figure = draw(run)
            self.addCleanup(style.plt.close, figure)
            ax = figure.axes[axes]
            (crosses,) = [line.get_xydata() for line in ax.lines
                          if line.get_marker() == style.MISSED.marker and len(line.get_xydata())]
            np.testing.assert_array_equal(crosses, places)
            self.assertIn("2 of 81 points missed", ax.get_title(loc="left"))
        outlines = [line.get_xydata() for line in ax.lines if line.get_color() == style.RED]
        self.assertEqual(sorted(np.isnan(outline[:, 0]).sum() for outline in outlines), [0, 3])  # the first one twice: it is closed

    def test_of_a_part_of_the_points_there_is_no_number(self):
        results = types.SimpleNamespace(opened=lambda _: self.lose(self.LOST))
        for number in (lambda: derived.largest_after_best_fit(results, "", "generated"),
                       lambda: derived.difference_after_best_fit(results, "", "generated", "nominal")):
            with self.assertRaises(files.NotInFile) as fault:
                number()
            self.assertEqual(str(fault.exception), "the part of case generated was not probed at all of its points")
        with self.assertRaises(files.NotInFile) as fault:
            experiment2.best_fit(self.changed(lambda _, features: self.lose_all(features)), "generated")
        self.assertEqual(str(fault.exception), "no point of the contours of case generated met the surface")

    @staticmethod
    def lose_all(features):
        for feature in features.values():
            feature["measured"][...] = np.nan

    def test_figures_are_drawn(self):
        style.set_up()
        for draw in (experiment2.draw_air_and_cutting, experiment2.draw_top_plane, experiment2.draw_quivers,
                     experiment2.draw_superposed):
            figure = draw(self.run_)
            self.assertTrue(figure.axes)
            style.plt.close(figure)


class Compared:
    """Results in place of files: one row of a comparison."""

    def __init__(self, **row):
        self.row = {"case": "one", "quantity": "flatness", "unit": "um", "value": 0.0, **row}

    def compared(self, _):
        return [self.row]


class OfAPart(unittest.TestCase):
    WANTED = {"run": "experiment2", "case": "one", "quantity": "flatness"}

    def test_of_the_points_is_no_value(self):
        self.assertEqual(values._compared(self.WANTED, Compared(), "um"), 0.0)
        with self.assertRaisesRegex(files.NotInFile, "4 of 22 points of 'top'"):
            values._compared(self.WANTED, Compared(note="4 of 22 points of 'top'"), "um")

    def test_over_nothing_is_no_value(self):
        with self.assertRaisesRegex(files.NotInFile, "is 0"):
            values._number({**self.WANTED, "over": {"case": "one"}}, Compared(), "%")
