#!/usr/bin/python3
"""Functions and commands of the same name have the same results. Usage: command_test.py SERVOMILL"""
import json
import math
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

import numpy
import servomill

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCENARIO = ROOT / "tests/python/short.toml"
PROGRAM = ROOT / "tests/tools/side_and_contour.ngc"
ROUTER = ROOT / "scenarios/machines/router_3axis.toml"
HSM600U = ROOT / "scenarios/machines/hsm600u.toml"
SERVOMILL = ""
KEYS = ("case", "quantity", "axis", "statistic", "sections")
DIGITS = 1e-8  # relative: JSON has nine digits


def printed(*arguments):
    done = subprocess.run([SERVOMILL, *map(str, arguments)], check=True, capture_output=True, encoding="utf-8")
    return done.stdout


class Commands(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def file(self, name, text):
        (self.folder / name).write_text(text, encoding="utf-8")
        return self.folder / name

    def test_run(self):
        lines = json.loads(printed("run", SCENARIO, "--json", "-o", self.folder / "out.h5"))
        ours = servomill.run(SCENARIO).comparison
        self.assertEqual([row[:5] for row in ours], [tuple(one[key] or "" for key in KEYS) for one in lines])
        numpy.testing.assert_allclose([row.value for row in ours], [one["value"] for one in lines], rtol=DIGITS)
        with servomill.open(self.folder / "out.h5") as stored:
            self.assertEqual([row.value for row in ours], [row.value for row in stored.comparison])

    def test_run_with_changes(self):
        rows = json.loads(printed("run", SCENARIO, "--json", "-o", self.folder / "out.h5", "--set", "program.feed_override=0.7",
                                  "--set", 'machine.nc.Kv="50 1/s"'))
        ours = servomill.run(SCENARIO, set={"program.feed_override": 0.7, "machine.nc.Kv": "50 1/s"}).comparison
        numpy.testing.assert_allclose([row.value for row in ours], [row["value"] for row in rows], rtol=DIGITS)

    def test_sweep(self):
        printed("sweep", SCENARIO, "-q", "-o", self.folder / "theirs.h5")
        with servomill.sweep(SCENARIO) as ours, servomill.open(self.folder / "theirs.h5") as theirs:
            self.assertEqual(list(ours), list(theirs))
            for name in ours:
                numpy.testing.assert_array_equal(ours[name], theirs[name])

    def test_options_that_would_have_no_effect_are_refused(self):
        with self.assertRaisesRegex(servomill.InputError, "the scenario has no case 'nowhere'"):
            servomill.bode(SCENARIO, "Y", case="nowhere", method="none")
        for option in ("output", "json", "quiet"):
            with self.assertRaisesRegex(servomill.InputError, "is an option of the command only"):
                servomill.bode(SCENARIO, "Y", method="none", **{option: "x"})

    def test_bode(self):
        (ours,) = servomill.bode(SCENARIO, "Y", loop="velocity", method="sine", points=3)
        *points, loop = json.loads(printed("bode", SCENARIO, "--axis", "Y", "--loop", "velocity", "--method", "sine", "--points", 3,
                                           "--json"))
        numpy.testing.assert_allclose([loop["gain_margin"], loop["phase_margin_deg"], loop["bandwidth_Hz"]],
                                      [ours.gain_margin, ours.phase_margin_deg, ours.bandwidth_Hz], rtol=DIGITS)
        curve = ours.curves["velocity_open"]
        theirs = [one for one in points if one["curve"] == "velocity_open"]
        numpy.testing.assert_allclose(abs(curve.exact), [one["exact"]["magnitude"] for one in theirs], rtol=DIGITS)
        measured = [one["measured"]["magnitude"] if one["measured"] else math.nan for one in theirs]
        numpy.testing.assert_allclose(abs(curve.measured), measured, rtol=DIGITS)
        self.assertTrue(numpy.isfinite(measured).any())

    def test_canon(self):
        ours = servomill.canon(PROGRAM, parameter=["#101=1", "#102=2"], reader="linuxcnc")
        theirs = printed("canon", PROGRAM, "--reader", "linuxcnc")
        self.assertEqual(list(ours), [json.loads(line) for line in theirs.splitlines()])
        self.assertGreater(len(servomill.canon(PROGRAM).warnings), 0)

    def test_compensate(self):
        options = {"work_offset": ["X=200", "Y=250", "Z=-90"], "start": "Z=-40", "tolerance": "2 um"}
        ours = servomill.compensate(PROGRAM, ROUTER, **options)
        out = self.folder / "out.ngc"
        text = printed("compensate", PROGRAM, "--machine", ROUTER, "--work-offset", "X=200,Y=250,Z=-90", "--start", "Z=-40",
                       "--tolerance", "2 um", "--json", "-o", out)
        self.assertEqual(ours.program, out.read_text(encoding="utf-8"))
        self.assertEqual(ours.changes, json.loads(text))
        self.assertTrue(any("verified" in line for line in ours.report))
        self.assertEqual(pathlib.Path(ours.write(self.folder / "ours.ngc")).read_text(encoding="utf-8"), ours.program)
        with self.assertRaises(FileExistsError):
            ours.write(self.folder / "ours.ngc")
        with self.assertRaises(servomill.InputError) as caught:
            servomill.compensate(PROGRAM, ROUTER, tolerance=-1, work_offset=options["work_offset"], start="Z=-40")
        self.assertEqual((caught.exception.file, caught.exception.rule), ("tolerance", "'-1' must be > 0"))

    def test_post(self):
        part = self.file("part.cls", "LOADTL/1\nFEDRAT/300\nGOTO/0,0,0,0,0,1\nGOTO/10,0,0,0,0,1\nGOTO/20,5,0,0,0,1\n")
        options = {"tool_length": "110 mm", "work_offset": "0,0,50"}
        ours = servomill.post(part, HSM600U, **options)
        printed("post", part, "--machine", HSM600U, "--tool-length", "110 mm", "--work-offset", "0,0,50", "-o", self.folder / "out.ngc")
        self.assertEqual(ours.program, (self.folder / "out.ngc").read_text(encoding="utf-8"))
        self.assertEqual(ours.locations, 3)
        self.assertRegex(ours.verified, "^verified: ")

    def test_calibrate(self):
        readings = ROOT / "scenarios/calibration/router/readings.toml"
        ours = servomill.calibrate(readings, output=self.folder / "ours.toml")
        text = printed("calibrate", readings, "-o", self.folder / "theirs.toml", "--table", self.folder / "table.csv")
        self.assertTrue(text.startswith(ours.report))
        self.assertEqual((self.folder / "ours.toml").read_text(encoding="utf-8"), (self.folder / "theirs.toml").read_text(encoding="utf-8"))
        table = [line.split(",") for line in (self.folder / "table.csv").read_text(encoding="utf-8").splitlines()[1:]]
        for name, function in ours.functions.items():
            rows = numpy.array([[float(row[1]), float(row[3]), float(row[4]), float(row[6])] for row in table if row[0] == name])
            numpy.testing.assert_allclose(function[:3], rows.T[:3], atol=1e-6, err_msg=name)  # digits of the table
            self.assertEqual(set(rows[:, 3]), {float(function.in_combination)})
        for name, location in ours.locations.items():
            (row,) = [row for row in table if row[0] == name]
            numpy.testing.assert_allclose(location, [float(row[3]), float(row[4]), float(row[6])], atol=1e-6, err_msg=name)
        self.assertEqual({row[0] for row in table}, {*ours.functions, *ours.locations})

    def test_identify(self):
        for name in ("identification", "machines"):
            shutil.copytree(ROOT / "scenarios" / name, self.folder / name)
        experiments = self.folder / "identification/experiments"
        servomill.run(self.folder / "identification/motion.toml", output=experiments / "motion.h5")
        printed("identify", experiments / "record.toml", "--make-up", experiments / "recording.csv")
        text = (experiments / "identify.toml").read_text(encoding="utf-8")
        head, mass, viscous, *_ = text.split("[[estimate]]")
        (experiments / "identify.toml").write_text("[[estimate]]".join([head, mass, viscous]), encoding="utf-8")
        ours = servomill.identify(experiments / "identify.toml", output=self.folder / "ours.toml", signals=self.folder / "ours.h5")
        text = printed("identify", experiments / "identify.toml", "-o", self.folder / "theirs.toml")
        self.assertTrue(text.startswith(ours.report))
        self.assertEqual((self.folder / "ours.toml").read_text(encoding="utf-8"), (self.folder / "theirs.toml").read_text(encoding="utf-8"))
        self.assertTrue(ours.converged and os.path.exists(self.folder / "ours.h5"))
        self.assertEqual(ours.value("axis.Y.moving_mass"), ours.estimates[0].value)
        self.assertGreater(ours.estimates[0].half_width, 0.0)
        self.assertGreater(ours.estimation[0].feedback_rms, 0.0)


if __name__ == "__main__":
    SERVOMILL = sys.argv.pop()
    unittest.main()
