#!/usr/bin/python3
"""The page of an identification, from files with more and with less in them."""
import base64
import importlib.util
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import h5py
import numpy as np

TOOL = pathlib.Path(__file__).resolve().parents[2] / "tools" / "identification_page.py"
sys.path.insert(0, str(TOOL.parent))
SPEC = importlib.util.spec_from_file_location("identification_page", TOOL)
TOOL_MODULE = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(TOOL_MODULE)


def write(path, command=True, force=True, laws=True, identifiable=("yes", "yes"), kind="identification"):
    rng = np.random.default_rng(1)
    with h5py.File(path, "w") as file:
        file.attrs["kind"], file.attrs["name"] = kind, "drive <Y>"
        group = file.create_group("parameters")
        for k, (key, unit) in enumerate((("axis.Y.moving_mass", "kg"), ("axis.Y.friction.coulomb", "N"))):
            group.attrs[f"key_{k:02}"], group.attrs[f"unit_{k:02}"], group.attrs[f"identifiable_{k:02}"] = key, unit, identifiable[k]
        group["value"], group["half_width"], group["half_width_counted"] = [640.5, 514.0], [3.3, 49.0], [0.4, 6.2]
        group["covariance"] = [[2.7, -1.0], [-1.0, 600.0]]
        for number, use in ((1, "estimation"), (2, "validation")):
            record = file.create_group(f"recording_{number:03}")
            record.attrs["recording"], record.attrs["use"] = f"folder/record{number}.csv", use
            t = np.arange(500) * 1e-3
            record["time"], record["feedback"] = t, np.sin(t)
            record["residual"] = 1e-6 * rng.standard_normal(500)
            record["simulated_feedback"] = record["feedback"][:] + record["residual"][:]
            record["feedback"].attrs["units"] = "m"
            if command:
                record["command"] = np.sin(t) + 1e-4
            if force:
                record["force"], record["simulated_force"] = np.cos(t), np.cos(t)
                record["force"].attrs["units"] = "N"
            if use == "estimation":
                record["lag"], record["residual_autocovariance"] = t[:100], 1e-12 * 0.9 ** np.arange(100)
        if laws:
            group = file.create_group("laws")
            group["law"], group["parameters"] = [0.0, 1.0], [4.0, 6.0]
            group["rms"], group["held_out_rms"] = [0.0, 1e-6], [0.0, 1.1e-6]
            group["held_out_error"], group["bic"] = [0.0, 1e-7], [0.0, 0.0]
            group.attrs["law_00"], group.attrs["law_01"] = "refused", "Coulomb"


def resonance(f):
    return 1 / (1 - (f / 60) ** 2 + 0.02j * f / 60)


def write_response(path, fit=True):
    """A response with a band of 5 %, and a model that is 10 % off above 80 Hz."""
    f = np.arange(10.0, 200.0)
    with h5py.File(path, "w") as file:
        file.attrs.update({"kind": "response", "name": "folder/bench.mat", "input": "i <A>", "output": "phi"})
        for name, grid, factor in (("response", f, 1.0), ("two_mass", np.geomspace(10, 199, 1000), 1.1)):
            if name == "two_mass" and not fit:
                continue
            group = file.create_group(name)
            value = resonance(grid) * np.where(grid > 80, factor, 1)
            group["frequency"], group["real"], group["imaginary"] = grid, value.real, value.imag
            group["real"].attrs["units"] = "rad/A"
        file["response/radius_95"] = 0.05 * np.abs(resonance(f))
        if fit:
            file["two_mass/value"], file["two_mass/half_width"] = [54.02, 1.0], [0.04, 0.01]
            file["two_mass/noise_ratio"], file["two_mass/median_misfit"] = 2.5, 0.031
            for k, (key, unit) in enumerate((("antiresonance", "Hz"), ("inertia ratio J_l/J_m", "1"))):
                file["two_mass"].attrs[f"key_{k:02}"], file["two_mass"].attrs[f"unit_{k:02}"] = key, unit


class Page(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.file = os.path.join(self.folder.name, "signals.h5")
        self.page = os.path.join(self.folder.name, "signals.html")

    def tearDown(self):
        self.folder.cleanup()

    def run_tool(self, *more, status=0):
        done = subprocess.run([TOOL, self.file, *more], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, status, done.stderr)
        return done

    def text(self):
        return pathlib.Path(self.page).read_text(encoding="utf-8")

    def test_it_holds_every_section_and_nothing_from_elsewhere(self):
        write(self.file)
        self.run_tool()
        text = self.text()
        for word in ("drive &lt;Y&gt;", "axis.Y.moving_mass", "640.5", "3.3", "record1.csv", "record2.csv", "the fit has not seen it",
                     "Friction laws", "Coulomb"):
            self.assertIn(word, text)
        self.assertNotIn("refused", text)
        self.assertNotRegex(text, r'(src|href)="(?!data:)')
        pictures = re.findall(r"base64,([^\"]+)", text)
        self.assertEqual(len(pictures), 5)   # correlation, two motions, one colour, laws
        for one in pictures:
            self.assertTrue(base64.b64decode(one).startswith(b"\x89PNG"))

    def test_what_the_file_lacks_is_left_out(self):
        write(self.file, command=False, force=False, laws=False, identifiable=("yes", "no"))
        self.run_tool()
        self.assertIn("cannot be identified", self.text())
        self.assertEqual(self.text().count("base64,"), 3)

    def test_responses_are_drawn_with_their_fit(self):
        write_response(self.file)
        self.run_tool()
        text = self.text()
        for word in ("bench.mat: i &lt;A&gt; to phi", "antiresonance", "54.02", "Median misfit 3.10 %, 2.5 times the noise; the uncertainty "
                     "includes the model error", "against the fitted two masses"):
            self.assertIn(word, text)
        self.assertEqual(text.count("base64,"), 1)

    def test_responses_need_no_fit(self):
        write_response(self.file, fit=False)
        self.run_tool()
        self.assertNotIn("two masses", self.text())
        self.assertEqual(self.text().count("base64,"), 1)

    def test_the_misfit_is_drawn_in_units_of_the_band(self):
        write_response(self.file)
        with h5py.File(self.file) as file:
            figure = TOOL_MODULE.frequency_response_figure(file["response"], TOOL_MODULE.response_in(file["two_mass"]), "rad/A", ("G", "fit"))
        f, misfit = figure.axes[2].lines[0].get_data()
        np.testing.assert_allclose(misfit[f > 82], 2.0, rtol=0.05)   # 10 % off, of a radius of 5 %
        self.assertLess(misfit[f < 50].max(), 0.05)
        corners = figure.axes[0].collections[0].get_paths()[0].vertices
        self.assertAlmostEqual(corners[:, 1].max(), 1.05 * np.abs(resonance(60.0)), places=6)

    def test_several_files_are_one_page(self):
        write(self.file)
        other = os.path.join(self.folder.name, "response.h5")
        write_response(other)
        self.run_tool(other)
        self.assertIn("record1.csv", self.text())
        self.assertIn("bench.mat", self.text())
        self.assertIn("is an input of this command", self.run_tool(other, "-o", other, "--force", status=2).stderr)

    def test_pages_are_not_overwritten_unasked(self):
        write(self.file)
        self.run_tool()
        self.assertIn("exists; use --force", self.run_tool(status=2).stderr)
        self.run_tool("--force")
        self.assertIn("is an input of this command", self.run_tool("-o", self.file, "--force", status=2).stderr)

    def test_other_files_are_refused(self):
        write(self.file, kind="run")
        self.assertIn("is not a file of servomill identify --signals", self.run_tool(status=2).stderr)
        pathlib.Path(self.file).write_text("text", encoding="utf-8")
        self.run_tool(status=2)


unittest.main()
