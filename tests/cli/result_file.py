#!/usr/bin/python3
"""Opens a real result with h5py, xarray, h5dump and Octave, none of which know servomill.

result_file.py SERVOMILL
"""
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

import h5py
import numpy as np
import xarray

HERE = os.path.dirname(os.path.abspath(__file__))
SERVOMILL = os.path.abspath(sys.argv.pop(1))
SCENARIO = os.path.join(HERE, "gallery", "scenario.toml")
SERVO = "cases/table/servo"


class ResultFile(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        cls.path = os.path.join(cls.folder.name, "out.h5")
        cls.printed = subprocess.run([SERVOMILL, "run", SCENARIO, "--json", "-o", cls.path], check=True,
                                     capture_output=True, text=True).stdout

    def test_every_dataset_says_what_it_is(self):
        nameless, datasets = [], []

        def visit(name, thing):
            if not isinstance(thing, h5py.Dataset):
                return
            datasets.append(name)
            for key in ("units", "long_name"):
                if not isinstance(thing.attrs.get(key), str) or not thing.attrs[key]:
                    nameless.append(f"{name}: {key}")

        with h5py.File(self.path, "r") as file:
            file.visititems(visit)
            self.assertEqual(nameless, [])
            self.assertGreater(len(datasets), 40)
            self.assertEqual(list(file["cases"]), ["nominal", "table"])
            for key in ("Conventions", "servomill_version", "schema_version", "kind", "scenario", "title"):
                self.assertIn(key, file.attrs)

    def test_inputs_are_kept_as_they_were_read(self):
        with h5py.File(self.path, "r") as file:
            for key, name in (("scenario", "scenario.toml"), ("machine", "machine.toml"), ("program", "part.ngc")):
                with open(os.path.join(HERE, "gallery", name), encoding="utf-8") as text:
                    self.assertEqual(file["inputs"].attrs[key], text.read(), key)

    def test_xarray_knows_the_dimensions(self):
        with xarray.open_dataset(self.path, group=SERVO, engine="h5netcdf") as data:
            for name, value in data.data_vars.items():
                self.assertEqual(value.dims[0], "time", name)
                self.assertIn("units", value.attrs, name)
            self.assertEqual(data["meas_linear"].dims[1], "axis_linear")
            self.assertTrue(np.all(np.diff(data["time"].values) > 0))

    def test_comparison_holds_what_was_printed(self):
        rows = [line for line in self.printed.splitlines() if line.startswith("{")]
        with h5py.File(self.path, "r") as file:
            self.assertEqual(len(file["comparison"]), len(rows))

    @unittest.skipUnless(shutil.which("h5dump"), "h5dump is not installed")
    def test_h5dump_reads_all(self):
        result = subprocess.run(["h5dump", "-H", self.path], capture_output=True, text=True, check=False)
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        values = subprocess.run(["h5dump", "-d", f"/{SERVO}/time", self.path], capture_output=True, text=True, check=False)
        self.assertEqual((values.returncode, values.stderr), (0, ""))

    @unittest.skipUnless(shutil.which("octave-cli"), "Octave is not installed")
    def test_octave_reads_all(self):
        program = f"d = load('-hdf5', '{self.path}'); printf('%d', numel(d.cases.table.servo.time));"
        result = subprocess.run(["octave-cli", "--no-gui", "--eval", program], capture_output=True, text=True, check=False)
        with h5py.File(self.path, "r") as file:
            self.assertEqual((result.returncode, result.stdout), (0, str(len(file[f"{SERVO}/time"]))), result.stderr)


if __name__ == "__main__":
    unittest.main()
