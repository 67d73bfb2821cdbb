#!/usr/bin/python3
"""Opens a real result with h5py, xarray, h5dump and Octave, none of which know servomill.

result_file.py SERVOMILL
"""
import json
import os
import pathlib
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
            for key in ("Conventions", "servomill_version", "servomill_build", "schema_version", "kind", "simd_level", "scenario", "title"):
                self.assertIn(key, file.attrs)

    def test_equal_signals_are_one_dataset(self):
        with h5py.File(self.path, "r") as file:
            nominal, table = (file[f"cases/{name}/servo"] for name in ("nominal", "table"))
            self.assertEqual(list(nominal), list(table))  # in the same order
            # the nominal case corrects nothing, and the NC of both reads the scale
            self.assertEqual(nominal["cmd_linear"], nominal["ref_linear"])
            self.assertEqual(nominal["meas_linear"], nominal["fb_linear"])
            self.assertEqual(nominal["ref_linear"].attrs["long_name"],
                             "ref_linear: interpolated position, linear axes = cmd_linear: setpoint after corrections, linear axes")
            self.assertNotEqual(table["cmd_linear"], table["ref_linear"])
            self.assertNotEqual(table["true_linear"], nominal["true_linear"])
            for name in ("time", "s", "line", "tool_position_nominal"):
                self.assertEqual(table[name], nominal[name], name)
            # readers find dimensions by their scales
            for name, data in table.items():
                if "CLASS" not in data.attrs:
                    self.assertEqual(data.dims[0][0], table["time"], name)
                if data.ndim == 2:
                    self.assertEqual("".join(letter.decode() for letter in data.dims[1][0]), data.attrs["columns"], name)

    def test_xarray_and_netcdf_find_the_dimensions_of_every_name(self):
        for engine in ("h5netcdf", "netcdf4"):
            for case in ("nominal", "table"):
                try:
                    data = xarray.open_dataset(self.path, group=f"cases/{case}/servo", engine=engine, decode_times=False)
                except ValueError as error:
                    self.skipTest(str(error))
                with data:
                    for name in ("ref_linear", "cmd_linear", "true_linear"):
                        self.assertEqual(data[name].dims, ("time", "axis_linear"), (engine, case, name))

    def test_inputs_are_kept_as_they_were_read(self):
        with h5py.File(self.path, "r") as file:
            for key, name in (("scenario", "scenario.toml"), ("machine", "machine.toml"), ("program", "part.ngc")):
                with open(os.path.join(HERE, "gallery", name), encoding="utf-8") as text:
                    self.assertEqual(file["inputs"].attrs[key], text.read(), key)

    def test_a_long_program_is_kept_once_and_compressed(self):
        folder = pathlib.Path(self.folder.name, "long")
        shutil.copytree(os.path.join(HERE, "gallery"), folder)
        program = folder / "part.ngc"
        program.write_text(program.read_text(encoding="utf-8") + "(a comment behind the end: \u00e4)\n" * 50_000, encoding="utf-8")
        text = program.read_text(encoding="utf-8")
        path = folder / "long.h5"
        subprocess.run([SERVOMILL, "run", folder / "scenario.toml", "-o", path], capture_output=True, check=True)
        self.assertLess(path.stat().st_size, os.path.getsize(self.path) + 100_000)
        with h5py.File(path, "r") as file:
            self.assertEqual(file["inputs/program"][()].tobytes().decode(), text)
            self.assertNotIn("program", file["inputs"].attrs)
            self.assertIn('text_checksum = "', file["inputs"].attrs["resolved"])
        program.unlink()
        self.assertEqual(self.compare(str(path)), (0, ""))
        with h5py.File(path, "r+") as file:
            of_another = file["inputs"].attrs["resolved"].replace('text_checksum = "', 'text_checksum = "0')
            file["inputs"].attrs["resolved"] = of_another
        status, message = self.compare(str(path))
        self.assertEqual(status, 2)
        self.assertRegex(message, r'program\.text_checksum = "0[0-9a-f]{16}"; differs from that of part\.ngc: the program has changed')

    def test_xarray_knows_the_dimensions(self):
        with xarray.open_dataset(self.path, group=SERVO, engine="h5netcdf") as data:
            for name, value in data.data_vars.items():
                self.assertEqual(value.dims[0], "time", name)
                self.assertIn("units", value.attrs, name)
            self.assertEqual(data["meas_linear"].dims[1], "axis_linear")
            self.assertTrue(np.all(np.diff(data["time"].values) > 0))

    def test_comparison_holds_what_was_printed(self):
        rows = json.loads(self.printed)
        with h5py.File(self.path, "r") as file:
            self.assertEqual(len(file["comparison"]), len(rows))

    def compare(self, path):
        result = subprocess.run([SERVOMILL, "compare", path], capture_output=True, text=True, check=False)
        return result.returncode, result.stderr.replace(self.folder.name + "/", "")

    def changed(self, change):
        """Path of a copy that went through `change`."""
        path = os.path.join(self.folder.name, "changed.h5")
        shutil.copy(self.path, path)
        with h5py.File(path, "r+") as file:
            change(file)
        return path

    def test_files_of_others_are_refused(self):
        def of_tomorrow(file):
            file.attrs["schema_version"] = 99

        def of_others(file):
            del file.attrs["schema_version"]

        def without_signal(file):
            del file[f"{SERVO}/meas_linear"]

        def with_a_short_signal(file):
            name = f"{SERVO}/line"
            short = file[name][:5]
            units, long_name = (file[name].attrs[key] for key in ("units", "long_name"))
            del file[name]
            file[name] = short
            file[name].attrs["units"], file[name].attrs["long_name"] = units, long_name

        def without_inputs(file):
            del file["inputs"]

        self.assertEqual(self.compare(self.changed(of_tomorrow)),
                         (2, "changed.h5: error: has schema version 99; this program reads version 1\n"))
        self.assertEqual(self.compare(self.changed(of_others)),
                         (2, "changed.h5: error: is not a result file of servomill\n"))
        self.assertEqual(self.compare(self.changed(without_inputs)), (2, "changed.h5: error: has no '/inputs'\n"))
        self.assertEqual(self.compare(self.changed(with_a_short_signal)),
                         (2, f"changed.h5: error: '/{SERVO}/line' differs in length from the earlier signals\n"))
        self.assertEqual(self.compare(self.changed(without_signal)),
                         (2, f"changed.h5: error: has no '/{SERVO}/meas_linear'\n"))

    def test_a_truncated_file_is_an_input_error(self):
        with open(self.path, "rb") as file:
            data = file.read()
        path = os.path.join(self.folder.name, "short.h5")
        for share in (0.001, 0.01, 0.1, 0.5, 0.9, 0.99):
            with open(path, "wb") as file:
                file.write(data[: int(share * len(data))])
            status, stderr = self.compare(path)
            self.assertEqual(status, 2, share)
            self.assertRegex(stderr, r"^short\.h5: error: .+\n$")

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
