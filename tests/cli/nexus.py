#!/usr/bin/python3
"""Result files that plot themselves: NeXus groups, axes that xarray selects by name.

nexus.py SERVOMILL
"""
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

import h5py
import numpy as np
import xarray

import nexus_rules

try:
    import netCDF4  # noqa: F401  (xarray's engine netcdf4)
    ENGINES = ("h5netcdf", "netcdf4")
except ImportError:
    ENGINES = ("h5netcdf",)

SERVOMILL = pathlib.Path(sys.argv.pop(1)).resolve()
TREE = pathlib.Path(__file__).resolve().parents[2]
GALLERY = TREE / "tests" / "cli" / "gallery" / "scenario.toml"
ROUTER = TREE / "scenarios" / "machines" / "router_3axis.toml"


class Files(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = pathlib.Path(folder.name)
        cls.run_file = cls.write("run", GALLERY)

    @classmethod
    def write(cls, command, *arguments):
        path = cls.folder / f"{command}_{len(list(cls.folder.iterdir()))}.h5"
        option = "--record" if command == "compensate" else "-o"
        subprocess.run([SERVOMILL, command, *arguments, option, path], check=True, capture_output=True, cwd=cls.folder)
        return path

    def check(self, path, shown):
        self.assertEqual(nexus_rules.faults(path), [])
        with h5py.File(path) as file:
            here = file
            while "default" in here.attrs:
                here = here[here.attrs["default"]]
            self.assertEqual((here.name, here.attrs["signal"]), shown)

    def test_a_run_shows_its_contour_error_over_time(self):
        self.check(self.run_file, ("/cases/nominal/servo", "contour_error"))
        with h5py.File(self.run_file) as file:
            servo = file["cases/nominal/servo"]
            self.assertEqual(list(servo.attrs["axes"]), ["time"])
            self.assertEqual(servo["contour_error"].attrs["long_name"],
                             "distance of the true tool centre point to the nominal path [um]")

    def test_a_budget_shows_the_residual_with_its_parts(self):
        path = self.write("budget", GALLERY)
        self.check(path, ("/budget/000", "residual"))
        with h5py.File(path) as file:
            self.assertIn("remainder", file["budget/000"].attrs["auxiliary_signals"])

    def test_responses_show_their_curves(self):
        self.check(self.write("bode", GALLERY, "--axis", "Y"), ("/bode/Y/position_open", "magnitude"))
        self.check(self.write("step", GALLERY, "--axis", "Y"), ("/step/Y/position", "position"))

    def test_a_day_shows_its_temperatures(self):
        path = self.write("run", TREE / "scenarios" / "thermal" / "day.toml")
        self.assertEqual(nexus_rules.faults(path), [])
        with h5py.File(path) as file:
            case = next(iter(file["cases"].values()))
            self.assertTrue(case["day"].attrs["signal"].startswith("temperature_"))
            self.assertIn("cycles", case["day"])

    def test_a_corrected_program_shows_its_corrections(self):
        program = self.folder / "part.ngc"
        program.write_text("G21 G90 G54\nG0 X10 Y10 Z5\nF500\nG1 X60 Y40\nM30\n", encoding="ascii")
        path = self.write("compensate", program, "--machine", ROUTER, "--work-offset", "X=200,Y=250,Z=-90")
        self.check(path, ("/compensate", "correction_x"))

    def test_a_converted_recording_shows_its_first_channel(self):
        table = self.folder / "axis.csv"
        table.write_text("time [s],feedback [mm],command [mm],current [A]\n" +
                         "".join(f"{0.001 * n},{n},{n + 1},{0.5 * n}\n" for n in range(20)), encoding="ascii")
        path = self.write("recording", table)
        self.check(path, ("/base_001", "channel_0001"))
        with h5py.File(path) as file:
            self.assertEqual(list(file["base_001"].attrs["auxiliary_signals"]), ["channel_0002"])

    def test_passes_of_sections_begin_and_end_where_the_rows_do(self):
        with h5py.File(self.run_file) as file:
            case = file["cases/table"]
            passes, servo = case["sections"], case["servo"]
            self.assertEqual(list(passes.attrs["names"]), case.attrs["sections"].split("\n"))
            self.assertEqual(passes["section"].dtype, np.int32)
            for section, begin, end in zip(passes["section"][:], passes["begin"][:], passes["end"][:]):
                time = servo["time"][:][servo["section"][:] == section]
                self.assertEqual((begin, end), (time[0], time[-1]))
            self.assertEqual("flank", passes.attrs["names"][passes["section"][-1]])

    def test_xarray_selects_axes_by_name(self):
        with h5py.File(self.run_file) as file:
            wanted = file["cases/table/servo/true_linear"][:, 1]
            of_tool = file["cases/table/servo/tool_axis_true"][:, 2]
        for engine in ENGINES:
            with self.subTest(engine), xarray.open_dataset(self.run_file, group="cases/table/servo", engine=engine) as data:
                np.testing.assert_array_equal(data["true_linear"].sel(axis_linear="Y"), wanted)
                np.testing.assert_array_equal(data["tool_axis_true"].sel(ijk="K"), of_tool)
                self.assertEqual(data["rapid"].dtype, np.int32)

    @unittest.skipUnless(shutil.which("octave-cli"), "Octave is not installed")
    def test_octave_loads_a_run(self):
        program = (f"d = load('-hdf5', '{self.run_file}'); c = d.cases.table;"
                   "printf('%s %s %d', c.servo.axis_linear, class(c.servo.rapid), numel(c.sections.begin));")
        done = subprocess.run(["octave-cli", "--no-gui", "--eval", program], capture_output=True, text=True, check=False)
        with h5py.File(self.run_file) as file:
            passes = len(file["cases/table/sections/begin"])
        self.assertEqual(done.stdout, f"XYZ int32 {passes}", done.stderr)


class Rules(unittest.TestCase):
    """Every rule finds the fault it is made for."""

    def broken(self, change):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "broken.h5"
            shutil.copy(self.good, path)
            with h5py.File(path, "r+") as file:
                change(file)
            return "\n".join(nexus_rules.faults(path))

    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.good = pathlib.Path(folder.name) / "good.h5"
        subprocess.run([SERVOMILL, "run", GALLERY, "-o", cls.good], check=True, capture_output=True)

    def test_each_is_able_to_fail(self):
        servo = "cases/nominal/servo"

        def set_attribute(where, name, value):
            return lambda file: file[where].attrs.__setitem__(name, value)

        def as_floats(file):
            line = file[f"{servo}/line"]
            values, attrs = line[:].astype(float), dict(line.attrs)
            del file[f"{servo}/line"]
            file[f"{servo}/line"] = values
            file[f"{servo}/line"].attrs.update({key: attrs[key] for key in ("units", "long_name")})

        for change, message in (
                (set_attribute("/", "default", "nowhere"), "leads to no plot"),
                (set_attribute("cases/table", "default", "nowhere"), "default names no group"),
                (set_attribute("cases/table", "NX_class", "NXthing"), "NX_class is NXthing"),
                (set_attribute("cases/table", "NX_class", "NXentry"), "entries are below the root"),
                (set_attribute(servo, "signal", "nothing"), "signal is no dataset"),
                (set_attribute(servo, "signal", "true_linear"), "1 axes of a signal with 2 dimensions"),
                (set_attribute(servo, "axes", "axis_linear"), "axis axis_linear has not the length"),
                (set_attribute(servo, "time_indices", 1), "time_indices is not 0"),
                (set_attribute(servo, "auxiliary_signals", ["true_linear"]), "has not the shape"),
                (set_attribute(servo, "auxiliary_signals", ["line"]), "has another unit"),
                (set_attribute(f"{servo}/time", "long_name", "time"), "without unit s"),
                (as_floats, "whole numbers are stored as float64")):
            with self.subTest(message):
                self.assertIn(message, self.broken(change))


if __name__ == "__main__":
    unittest.main()
