#!/usr/bin/python3
"""Errors of machines from readings, as their owners find them.

    calibrate.py SERVOMILL
"""
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
import unittest

import numpy as np

SERVOMILL = os.path.abspath(sys.argv.pop(1))
SCENARIOS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "scenarios")


class Way(unittest.TestCase):
    """The shipped ways, in a copy of their folders."""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp()
        for name in ("calibration", "machines", "programs"):
            shutil.copytree(os.path.join(SCENARIOS, name), os.path.join(cls.folder, name))
        cls.printed = cls.run_in("router", "calibrate", "readings.toml", "-o", "again.toml").stdout

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    @classmethod
    def path(cls, *names):
        return os.path.join(cls.folder, "calibration", *names)

    @classmethod
    def run_in(cls, machine, *arguments, status=0):
        done = subprocess.run([SERVOMILL, *arguments], cwd=cls.path(machine), capture_output=True, text=True, check=False)
        assert done.returncode == status, f"{arguments}: {done.returncode}\n{done.stdout}{done.stderr}"
        return done

    def identified(self, *names):
        with open(self.path(*names), "rb") as file:
            return tomllib.load(file)

    def test_the_shipped_result_is_what_the_readings_give(self):
        again, shipped = self.identified("router", "again.toml"), self.identified("router", "identified.toml")
        self.assertEqual(again["identified"]["keys"], shipped["identified"]["keys"])
        np.testing.assert_allclose(again["identified"]["values"], shipped["identified"]["values"], rtol=1e-6, atol=1e-6)

    def test_squareness_and_the_period_of_the_screw_are_found(self):
        table = self.identified("router", "again.toml")["identified"]
        for key, actual in {"errors.identified.EC0Y.constant_urad": 180.0, "errors.identified.EYY.harmonic[0].amplitude_um": 12.0}.items():
            k = table["keys"].index(key)
            self.assertLess(abs(table["values"][k] - actual), 3 * np.sqrt(table["covariance"][k][k]), key)

    def test_json_holds_what_the_report_prints(self):
        found = json.loads(self.run_in("router", "calibrate", "readings.toml", "--json").stdout)
        for one in found["errors"]:
            shown = f"{one['value']:.3f}" if "value" in one else f"{one['min']:.3f} to {one['max']:.3f}"
            wanted = [one["error"], *shown.split(), f"{one['U']:.2g}", one["unit"]]
            self.assertTrue([line for line in self.printed.splitlines() if line.split()[:len(wanted)] == wanted], wanted)
        squareness = next(one for one in found["errors"] if one["error"] == "EC0Y")
        self.assertLess(abs(squareness["value"] - 180.0), 1.5 * squareness["U"])
        self.assertGreater(len(found["groups"]), 3)
        for sentence in found["undetermined"]:
            self.assertIn(sentence.split()[0], self.printed)

    def test_the_report_names_what_the_instruments_cannot_tell(self):
        self.assertIn("no reading depends on ECY and ECZ", self.printed)
        self.assertRegex(self.printed, r"EAX +\S+ to \S+ +\S+ +urad .* in combination")
        whitened = re.search(r"whitened residuals ([\d.]+)", self.printed)
        self.assertAlmostEqual(float(whitened[1]), 1.0, delta=0.05)

    def test_tables_and_programs_take_the_result(self):
        with open(self.path("router", "part.ngc"), "w", encoding="utf-8") as file:
            file.write("G21 G90 G17 G94 F1000\nG0 X100 Y100 Z-50\nG1 X300 Y300\nM2\n")
        corrects = ("compensate", "part.ngc", "--machine", "again.toml", "--model", "identified", "-o", "out.ngc", "--work-offset", "X=0,Y=0,Z=0")
        refused = self.run_in("router", *corrects, status=2)  # no reading determines Z
        self.assertRegex(refused.stderr, r"^again.toml: error: the correction of Z would change by up to \S+ um over the program with an uncertainty of up to \S+ um \(k = 2\): not "
                         "determined by the calibration; leave Z as programmed with --leave Z, or take the measurements that servomill calibrate names\n$")
        done = self.run_in("router", *corrects, "--leave", "Z")
        self.assertIn("assumed: Z stays as programmed (--leave)", done.stdout)
        with open(self.path("router", "out.ngc"), encoding="utf-8") as file:
            heights = re.findall(r"G[01] .*Z(-?[\d.]+)", file.read())
        self.assertEqual({float(z) for z in heights}, {-50.0})

    def test_the_block_comes_out_better(self):
        printed = self.run_in("router", "run", "part.toml", "-o", "part.h5").stdout
        values = [float(v) for v in re.findall(r"(?:as_it_is|corrected) +(-?[\d.]+) um", printed)]
        squareness_is, squareness, roundness_is, roundness = values[2], values[3], values[4], values[5]
        self.assertLess(abs(squareness), 0.5 * abs(squareness_is))
        self.assertLess(roundness, 0.2 * roundness_is)

    def test_a_ball_bar_alone_names_what_it_tells_and_what_it_cannot(self):
        with open(self.path("router", "readings.toml"), encoding="utf-8") as file:
            head, *groups = file.read().split("[adjustment.form]")[0].split("[[group]]")
        bars = "".join("[[group]]" + group for group in groups if 'kind = "circle"' in group)
        form = '[adjustment.form]\nlinear = { polynomial = 3, harmonics_mm = [5], reversal = 0 }\nEYX = { knots = 9 }\n'
        with open(self.path("router", "bar.toml"), "w", encoding="utf-8") as file:
            file.write(head.split("[[instrument]]")[0] + bars + form)
        printed = self.run_in("router", "calibrate", "bar.toml", "-o", "bar_only.toml").stdout
        table = self.identified("router", "bar_only.toml")["identified"]
        C = np.array(table["covariance"])
        index = {key: k for k, key in enumerate(table["keys"])}

        def known(weights, actual, size):
            """A sum of numbers: within its interval, and known much better than its size."""
            row = np.zeros(len(index))
            for key, weight in weights.items():
                row[index["errors.identified." + key]] = weight
            found, sigma = row @ np.array(table["values"]), np.sqrt(row @ C @ row)
            self.assertLess(abs(found - actual), 3 * sigma, weights)
            self.assertLess(sigma, size, weights)

        known({"EC0Y.constant_urad": 1}, 180.0, 18.0)
        known({"EYY.harmonic[0].amplitude_um": 1}, 12.0, 0.5)     # straightness and pitch have none
        known({"EXY.harmonic[0].amplitude_um": 1}, 0.0, 0.5)
        for axis in "XYZ":
            self.assertRegex(printed, rf"E{axis}{axis} .*\n  reversal +-?0\.\d+ +[01]\.\d+ +um +up minus down")
            known({f"E{axis}{axis}.reversal.width_polynomial_um[0]": 1}, 0.0, 0.5)
        # scale of X minus that of Y: where the circles stand, 0.2 - 0.05 um/mm
        slope = {f"E{a}{a}.polynomial_um[{n}]": (1 if a == "X" else -1) * n * (500.0 if a == "X" else 400.0) ** (n - 1) for a in "XY" for n in (1, 2, 3)}
        known(slope, 0.15, 0.05)
        self.assertIn("no reading depends on ECY and ECZ", printed)
        for name in ("EAZ", "EBZ"):
            self.assertRegex(printed, rf"{name} is determined only in combination")

    def test_the_faces_of_the_trunnion_come_out_better(self):
        rows = json.loads(self.run_in("trunnion", "run", "part.toml", "-o", "part.h5", "--json").stdout)
        found = {(row["quantity"], row["case"]): abs(row["value"]) for row in rows}
        self.assertLess(found["distortion", "corrected"], 0.35 * found["distortion", "as_it_is"])
        self.assertLess(found["squareness", "corrected"], 0.3 * found["squareness", "as_it_is"])

    def test_the_trunnion_gives_its_eight_location_errors(self):
        printed = self.run_in("trunnion", "calibrate", "readings.toml", "-o", "found.toml").stdout
        table = self.identified("trunnion", "found.toml")["identified"]
        actual = {"EC0Y": 18.0, "EA0Z": -12.0, "EB0Z": 25.0, "EB0A": -31.0, "EC0A": 22.0, "EA0C": 27.0, "EB0C": -19.0}
        for name, value in actual.items():
            k = table["keys"].index(f"errors.identified.{name}.constant_urad")
            self.assertLess(abs(table["values"][k] - value), 3 * np.sqrt(table["covariance"][k][k]), name)
        k = table["keys"].index("errors.identified.EY0C.constant_um")  # holds EY0C - EY0A
        self.assertLess(abs(table["values"][k] - 7.0), 3 * np.sqrt(table["covariance"][k][k]))
        self.assertIn("EY0A is determined only in combination: EY0C holds EY0C - EY0A", printed)
        self.assertIn("EX0C is determined only in combination: the set-up does (stylus X of", printed)

    def test_a_plan_is_measured_and_calibrates_the_machine(self):
        machine = "../../machines/router_3axis.toml"
        arguments = ("plan-calibration", "--machine", machine, "--instruments", "square,ballbar", "--hours", "1")
        printed = self.run_in("router", *arguments, "-o", "plan").stdout
        self.assertRegex(printed, r"this plan +[\d.]+ um")
        self.assertIn("exists", self.run_in("router", *arguments, "-o", "plan", status=2).stderr)
        refused = self.run_in("router", "calibrate", "plan/readings.toml", status=2).stderr
        self.assertRegex(refused, r"deviation_um is empty|deviation_urad is missing")
        os.mkdir(self.path("router", "taken"))
        self.run_in("router", "calibrate", "plan/readings.toml", "--make-up", "taken", "--machine-errors", "measured")
        taken = self.run_in("router", "calibrate", "taken/readings.toml").stdout
        self.assertIn("EC0Y", taken)
        self.assertIn("'lasr' is not allowed; must be one of laser", self.run_in("router", "plan-calibration", "--machine", machine, "--instruments", "lasr", status=2).stderr)

    def test_a_plan_for_the_probe_writes_programs_for_four_controls(self):
        machine = "../../machines/generic_trunnion_ac.toml"
        arguments = ("plan-calibration", "--machine", machine, "--instruments", "probe", "--hours", "0.5", "-o", "touch")
        printed = self.run_in("router", *arguments).stdout
        self.assertRegex(printed, r"\d+ touches with a probe of \d+ mm: programs for linuxcnc,heidenhain,fanuc,siemens")
        names = sorted(os.listdir(self.path("router", "touch")))
        word = {"ngc": "G38.2", "h": "TCH PROBE 0.1", "nc": "G31", "mpf": "MEAS=1"}
        for end, text in word.items():
            program = next(name for name in names if name.endswith("." + end))
            with open(self.path("router", "touch", program), encoding="utf-8") as file:
                touches = sum(text in line for line in file)
            with open(self.path("router", "touch", program.replace("measure", "touches").replace("." + end, ".csv")), encoding="utf-8") as file:
                self.assertEqual(touches, len(file.readlines()) - 2, program)
        refused = self.run_in("router", *arguments[:-1], "heads", "--controls", "linuxcnc,fanux", status=2).stderr
        self.assertIn("'fanux' is no control of linuxcnc, heidenhain, fanuc, siemens; did you mean 'fanuc'?", refused)

    def test_a_plan_without_a_measurement_is_refused_and_not_written(self):
        refused = self.run_in("router", "plan-calibration", "--machine", "../../machines/generic_trunnion_ac.toml", "--instruments", "probe",
                              "--hours", "0.25", "-o", "short", status=2).stderr
        self.assertEqual(refused, "--hours: error: must be at least 0.34: the shortest set-up of these instruments takes 20 min\n")
        self.assertFalse(os.path.exists(self.path("router", "short")))

    def test_the_table_of_errors_is_drawn(self):
        self.run_in("router", "calibrate", "readings.toml", "--table", "errors.csv", "-q")
        tool = os.path.join(SCENARIOS, "..", "tools", "errors_figure.py")
        figure = self.path("router", "errors.png")
        for status, argument in ((0, "errors.csv"), (2, "errors.csv"), (2, "readings.toml")):
            done = subprocess.run(["/usr/bin/python3", "-B", tool, argument], cwd=self.path("router"), capture_output=True, text=True, check=False)
            self.assertEqual(done.returncode, status, done.stderr)
        self.assertIn("is not a table of errors", done.stderr)
        self.assertGreater(os.path.getsize(figure), 50_000)

    def test_readings_made_up_are_read_again(self):
        os.mkdir(self.path("router", "readings"))
        made_up = ("calibrate", "readings.toml", "--make-up", "readings", "--machine-errors", "measured", "--seed", "2")
        self.run_in("router", *made_up)
        self.assertIn("exists", self.run_in("router", *made_up, status=2).stderr)
        printed = self.run_in("router", "calibrate", "readings/readings.toml").stdout
        self.assertAlmostEqual(float(re.search(r"whitened residuals ([\d.]+)", printed)[1]), 1.0, delta=0.05)

    def thinned(self, folder, step):
        """A copy of the router's readings in `folder`, with one row in `step`."""
        os.makedirs(self.path(folder))
        shutil.copy(self.path("router", "readings.toml"), self.path(folder))
        for name in (name for name in os.listdir(self.path("router")) if name.endswith(".csv")):
            self.rewrite("router", name, lambda lines: [lines[0], *lines[1::step]], folder)

    def rewrite(self, folder, name, change, into=None):
        """Applies `change` to the lines of a file."""
        with open(self.path(folder, name), encoding="utf-8") as file:
            lines = change(file.read().splitlines())
        with open(self.path(into or folder, name), "w", encoding="utf-8") as file:
            file.write("\n".join(lines) + "\n")

    def test_a_group_of_the_wrong_sign_and_an_outlier_are_named(self):
        def reversed_sign(lines):
            split = [line.rsplit(",", 1) for line in lines[1:]]
            return [lines[0], *(f"{place},{-float(value)}" for place, value in split)]

        def with_outlier(lines):
            place, value = lines[10].rsplit(",", 1)
            return [*lines[:10], f"{place},{float(value) + 100}", *lines[11:]]

        self.thinned("wrong", 4)
        self.rewrite("wrong", "ball_bar_XY2.csv", reversed_sign)
        refused = self.run_in("wrong", "calibrate", "readings.toml", "-q", "-o", "out.toml", status=2).stderr
        self.assertRegex(refused, r'readings.toml: error: readings contradict each other, no machine is written: readings.toml:\d+: "ball bar XY 2" contradicts '
                         r"the other groups; with the opposite sign it would agree with them: check the sign of its readings; correct or remove them, or use "
                         "--accept-contradictions")
        self.assertFalse(os.path.exists(self.path("wrong", "out.toml")))
        accepted = self.run_in("wrong", "calibrate", "readings.toml", "-q", "-o", "out.toml", "--accept-contradictions").stderr
        self.assertIn('"ball bar XY 2" contradicts the other groups; with the opposite sign it would agree', accepted)
        self.rewrite("wrong", "ball_bar_XY2.csv", reversed_sign)
        self.rewrite("wrong", "ball_bar_XY2.csv", with_outlier)
        warnings = self.run_in("wrong", "calibrate", "readings.toml", "-q").stderr
        self.assertIn("ball_bar_XY2.csv:11: reading of \"ball bar XY 2\" is off by", warnings)
        self.assertNotIn("contradicts", warnings)


if __name__ == "__main__":
    unittest.main()
