#!/usr/bin/python3
"""The page of an identification, from files with more and with less in them."""
import base64
import os
import pathlib
import re
import subprocess
import tempfile
import unittest

import h5py
import numpy as np

TOOL = pathlib.Path(__file__).resolve().parents[2] / "tools" / "identification_page.py"


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

    def test_pages_are_not_overwritten_unasked(self):
        write(self.file)
        self.run_tool()
        self.assertIn("exists; use --force", self.run_tool(status=2).stderr)
        self.run_tool("--force")
        self.assertIn("is the input", self.run_tool("-o", self.file, "--force", status=2).stderr)

    def test_other_files_are_refused(self):
        write(self.file, kind="run")
        self.assertIn("is no file of servomill identify --signals", self.run_tool(status=2).stderr)
        pathlib.Path(self.file).write_text("text", encoding="utf-8")
        self.run_tool(status=2)


unittest.main()
