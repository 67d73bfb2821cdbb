#!/usr/bin/python3
"""Tests of the standards as their users evaluate them, compared with numpy.

    evaluate.py SERVOMILL
"""
import json
import os
import subprocess
import sys
import tempfile
import unittest

import h5py
import numpy as np

import nexus_rules

SERVOMILL = os.path.abspath(sys.argv.pop(1))
ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
LINEAR_AXIS = os.path.join(ROOT, "scenarios", "standards", "linear_axis.csv")
ROUNDING = 1e-8  # of a value: JSON has nine digits


def evaluate(*arguments, status=0, cwd=None):
    done = subprocess.run([SERVOMILL, "evaluate", *arguments], cwd=cwd, capture_output=True, text=True, check=False)
    assert done.returncode == status, f"{arguments}: {done.returncode}\n{done.stdout}{done.stderr}"
    return done


def parameters(*arguments, cwd=None):
    (report,) = json.loads(evaluate(*arguments, "--json", cwd=cwd).stdout)
    return {one["parameter"]: one["value"] for one in report["parameters"]}, report


def iso230_2(up, down):
    """All parameters from deviations, a row a target, a column a run."""
    mu, md = up.mean(axis=1), down.mean(axis=1)
    su, sd = up.std(axis=1, ddof=1), down.std(axis=1, ddof=1)
    B = mu - md
    both = np.concatenate([mu, md])
    spread = np.concatenate([2 * su, 2 * sd])
    mean = (mu + md) / 2
    return {"B": np.abs(B).max(), "B_mean": B.mean(), "R_up": 4 * su.max(), "R_down": 4 * sd.max(),
            "R": np.max([2 * su + 2 * sd + np.abs(B), 4 * su, 4 * sd]), "E_up": np.ptp(mu), "E_down": np.ptp(md), "E": np.ptp(both),
            "M": np.ptp(mean), "A_up": (mu + 2 * su).max() - (mu - 2 * su).min(), "A_down": (md + 2 * sd).max() - (md - 2 * sd).min(),
            "A": (both + spread).max() - (both - spread).min()}


class Positioning(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def write(self, name, text):
        with open(os.path.join(self.folder.name, name), "w", encoding="utf-8") as file:
            file.write(text)
        return name

    def test_random_axes_are_what_numpy_computes(self):
        rng = np.random.default_rng(230)
        for _ in range(10):
            targets, runs = rng.integers(2, 12), rng.integers(2, 8)
            x = np.cumsum(rng.uniform(5, 50, targets))
            up, down = (rng.normal(0, 3e-3, (targets, 1)) + rng.normal(0, 1e-3, (targets, runs)) for _ in range(2))
            lines = [f"{direction},{place!r}," + ",".join(repr(float(place + d)) for d in row)
                     for direction, table in (("forward", up), ("backward", down)) for place, row in zip(x.tolist(), table)]
            name = self.write("axis.csv", "direction,target_mm," + ",".join(f"p{j + 1}" for j in range(runs)) + "\n" + "\n".join(lines) + "\n")
            found, _ = parameters(name, "--standard", "2", cwd=self.folder.name)
            for symbol, value in iso230_2(up * 1e-3, down * 1e-3).items():
                self.assertAlmostEqual(found[symbol], value, delta=1e-14 + ROUNDING * abs(value), msg=symbol)

    def test_a_raw_log_gives_what_its_table_gives(self):
        with open(LINEAR_AXIS, encoding="utf-8") as file:
            rows = [line.split(",") for line in file if line[:1] in "fb"]
        time, last, lines = 0.0, -15.0, []

        def add(name, value):
            lines.append(f"ioc:{name} 2023-12-08 12:{int(time // 60):02d}:{time % 60:09.6f} {value:.10g}")

        def go(target, position):
            nonlocal time, last
            for k in range(1, 6):
                time += 0.05
                add("M1-PosSet", last + (target - last) * k / 5)
                add("Enc01-PosAct", last + (position - last) * k / 5)
            time += 1.5
            add("Enc01-PosAct", position)
            last = target

        go(-12.0, -12.0)
        forward, backward = ([row for row in rows if row[0] == way] for way in ("forward", "backward"))
        for run in range(5):
            for turn, half in ((12.0, forward), (-12.0, backward[::-1])):
                for row in half:
                    go(float(row[1]), float(row[2 + run]))
                go(turn, turn)
        name = self.write("axis.log", "\n".join(lines) + "\n")
        found, report = parameters(name, "--standard", "2", "--target", "PosSet", "--position", "PosAct", cwd=self.folder.name)
        for symbol, value in parameters(LINEAR_AXIS, "--standard", "2")[0].items():
            self.assertAlmostEqual(found[symbol], value, delta=1e-13, msg=symbol)
        self.assertIn("target 12 is approached in one direction only, 5 times", " ".join(report["notes"]))

    def test_the_order_of_rows_tells_their_direction(self):
        rows = [(t, t + 0.001 * (k + 1)) for k, t in enumerate((0, 10, 20))] + [(t, t - 0.002) for t in (20, 10, 0)]
        text = "Target [mm];Actual [mm]\n" + "".join(f"{t};{p:.4f}\n".replace(".", ",") for t, p in rows + rows[::1])
        name = self.write("rows.csv", text)
        found, report = parameters(name, "--standard", "2", cwd=self.folder.name)
        self.assertAlmostEqual(found["B"], 5e-6, delta=1e-12)
        self.assertIn("ascending targets as forward", " ".join(report["notes"]))

    def test_printed_table_file_and_json_agree(self):
        found, report = parameters(LINEAR_AXIS, "--standard", "ISO 230-2")
        self.assertEqual(len(report["tables"][0]["columns"]), 10)
        out = os.path.join(self.folder.name, "out.csv")
        printed = evaluate(LINEAR_AXIS, "--standard", "230-2", "--table", out).stdout
        for symbol, value in (("B", 12.2), ("R", 68.8), ("M", 27.7), ("E", 36.8), ("A", 88.8)):
            self.assertRegex(printed, rf"(?m)^{symbol} .* {value}  nm$")
            self.assertAlmostEqual(found[symbol] * 1e9, value, delta=0.05)
        rows = [line.split(",") for line in open(out, encoding="utf-8").read().splitlines()]
        self.assertEqual({row[2]: float(row[3]) for row in rows[1:]}, found)
        self.assertIn("exists", evaluate(LINEAR_AXIS, "--standard", "2", "--table", out, status=2).stderr)


class Readings(unittest.TestCase):
    """Groups of a file of readings, and what no standard evaluates."""

    ROUTER = os.path.join(ROOT, "scenarios", "calibration", "router", "readings.toml")

    def reports(self, standard):
        return json.loads(evaluate(self.ROUTER, "--standard", standard, "--json").stdout)

    def test_groups_of_the_standard_are_evaluated(self):
        axes, circles = self.reports("iso230-2"), self.reports("iso230-4")
        self.assertTrue(all(one["name"].startswith("step gauge") for one in axes))
        self.assertTrue(all(one["name"].startswith("ball bar") for one in circles))
        self.assertGreater(min(len(axes), len(circles)), 2)
        for one in circles:
            found = {value["parameter"]: value["value"] for value in one["parameters"]}
            self.assertGreaterEqual(found["G_LSC_ccw"], found["G_ccw"] - 1e-12)
            self.assertGreaterEqual(found["G_b"], max(found["G_ccw"], found["G_cw"]) - 1e-12)

    def test_lengths_of_a_group_are_taken_back_to_20_degrees(self):
        # 30 degC: 11.5 um/m/K * 10 K * 1 m of a scale of 300 um/m
        expansion = "expansion = { coefficient_per_K = 11.5e-6 }\ndrift = true\n"
        with tempfile.TemporaryDirectory() as folder:
            rows = ["X_mm,direction,deviation_um,temperature_degC"] + [f"{x},{d},{0.3 * x},30" for d, xs in (("forward", range(0, 1001, 100)), ("backward", range(1000, -1, -100)))
                                                                       for x in xs]
            with open(os.path.join(folder, "x.csv"), "w", encoding="utf-8") as file:
                file.write("\n".join(rows) + "\n")
            found = {}
            for name, keys in (("as_read", ""), ("at_20", expansion)):
                with open(os.path.join(folder, "readings.toml"), "w", encoding="utf-8") as file:
                    file.write(f'machine = "{os.path.join(ROOT, "scenarios", "machines", "router_3axis.toml")}"\n[[group]]\nname = "X"\nkind = "positioning"\n'
                               f'axis = "X"\nreadings = "x.csv"\nat = {{ Y_mm = 0, Z_mm = -50 }}\npoint_mm = [0, 0, -60]\nuncertainty_um = 1\n{keys}')
                report = json.loads(evaluate(os.path.join(folder, "readings.toml"), "--standard", "iso230-2", "--json").stdout)[0]
                found[name] = {value["parameter"]: value["value"] for value in report["parameters"]}["M"], report["notes"]
        self.assertAlmostEqual(found["as_read"][0], 300e-6, delta=1e-9)
        self.assertAlmostEqual(found["at_20"][0], 300e-6 - 115e-6, delta=1e-9)
        self.assertEqual(found["at_20"][1][:2], ["readings are taken back to 20 degC with 11.5 um/m/K",
                                                 "drift is not removed: the standard evaluates readings as they were taken"])

    def test_the_machine_of_readings_needs_no_drives(self):
        with tempfile.TemporaryDirectory() as folder:
            with open(os.path.join(folder, "bare.toml"), "w", encoding="utf-8") as file:
                file.write('structure = "[w b X Y Z (C1) t]"\n[axis.X]\ntravel_mm = [0, 1000]\n')
            rows = [f"{x},{direction},{0.3 * x}" for direction, xs in (("forward", range(0, 1001, 100)), ("backward", range(1000, -1, -100)))
                    for x in xs]
            with open(os.path.join(folder, "x.csv"), "w", encoding="utf-8") as file:
                file.write("X_mm,direction,deviation_um\n" + "\n".join(rows) + "\n")
            with open(os.path.join(folder, "readings.toml"), "w", encoding="utf-8") as file:
                file.write('machine = "bare.toml"\n[[group]]\nname = "X"\nkind = "positioning"\naxis = "X"\nreadings = "x.csv"\n'
                           'at = { Y_mm = 0, Z_mm = -50 }\npoint_mm = [0, 0, -60]\nuncertainty_um = 1\n')
            (report,) = json.loads(evaluate(os.path.join(folder, "readings.toml"), "--standard", "iso230-2", "--json").stdout)
            found = {value["parameter"]: value["value"] for value in report["parameters"]}
            self.assertAlmostEqual(found["M"], 300e-6, delta=1e-9)

    def test_a_standard_without_its_groups_is_refused(self):
        said = evaluate(self.ROUTER, "--standard", "10791-6", status=2).stderr
        self.assertIn("has no group for iso10791-6", said)


class Uncertainty(unittest.TestCase):
    LASER = os.path.join(ROOT, "scenarios", "standards", "laser.toml")

    def test_of_the_shipped_laser_is_that_of_numpy(self):
        """The README's U of A, E and B, with another generator."""
        (report,) = json.loads(evaluate(LINEAR_AXIS, "--standard", "2", "--uncertainty", self.LASER, "--json").stdout)
        U = {one["parameter"]: one["U"] for one in report["parameters"]}
        with open(LINEAR_AXIS, encoding="utf-8") as file:
            rows = [line.split(",") for line in file.read().splitlines() if not line.startswith("#")][1:]
        table = np.array([[float(x) for x in row[1:]] for row in rows]) * 1e-3
        x, deviation = table[:5, 0], table[:, 1:] - table[:, :1]
        value = iso230_2(deviation[:5], deviation[5:])
        time = np.empty((2, 5, 5))
        for run in range(5):
            time[0, :, run] = 10 * run + np.arange(5)
            time[1, :, run] = 10 * run + 9 - np.arange(5)
        time /= 49
        rng = np.random.default_rng(1)
        squares = dict.fromkeys(value, 0.0)
        trials = 4000
        for _ in range(trials):
            strain = 0.15e-6 * rng.normal() + 0.8 * 1e-6 * rng.normal() + 11.5e-6 * 0.1 * rng.normal() \
                - 0.5 * np.sum(rng.uniform(-0.5e-3, 0.5e-3, 2) ** 2)
            error = strain * (x - x[0])[None, :, None] + rng.uniform(-30e-9, 30e-9) * (time - 0.5) \
                + rng.uniform(-0.5e-9, 0.5e-9, time.shape) + rng.uniform(-10e-9, 10e-9, time.shape)
            trial = iso230_2(deviation[:5] - error[0], deviation[5:] - error[1])
            for symbol in squares:
                squares[symbol] += (trial[symbol] - value[symbol]) ** 2
        for symbol, square in squares.items():
            expected = 2 * np.sqrt(square / trials)
            self.assertAlmostEqual(U[symbol] / expected, 1.0, delta=0.06, msg=symbol)

    def test_what_is_missing_is_named(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "laser.toml")
            with open(path, "w", encoding="utf-8") as file:
                file.write("resolution_um = 0.001\nvariation_um = 0.02\n")
            printed = evaluate(LINEAR_AXIS, "--standard", "2", "--uncertainty", path).stdout
        self.assertRegex(printed, r"(?m)^R .* 68.8 +\d")
        self.assertRegex(printed, r"(?m)^A .* 88.8 +-  nm$")
        self.assertIn("U of E_up, E_down, E, M, A_up, A_down, A cannot be stated without scale_uncertainty or target_uncertainty, misalignment, "
                      "coefficient, coefficient_uncertainty, temperature, temperature_uncertainty", printed)


class SimulatedTest(unittest.TestCase):
    """scenarios/standards/positioning.toml: the sheet of the run is that of its readings."""

    @classmethod
    def setUpClass(cls):
        temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(temporary.cleanup)
        cls.folder = temporary.name
        scenario = os.path.join(ROOT, "scenarios", "standards", "positioning.toml")
        done = subprocess.run([SERVOMILL, "run", scenario, "-o", "out.h5", "--readings", "readings"], cwd=cls.folder, capture_output=True, text=True,
                              check=False)
        assert done.returncode == 0, done.stderr
        cls.printed = done.stdout

    def path(self, case):
        return os.path.join(self.folder, "readings", case, "X.csv")

    def test_parameters_of_the_run_are_those_of_its_readings(self):
        self.assertEqual(nexus_rules.faults(os.path.join(self.folder, "out.h5")), [])
        with h5py.File(os.path.join(self.folder, "out.h5")) as file:
            for case in ("as_it_is", "table"):
                values, _ = parameters(self.path(case), "--standard", "2")
                stored = file[f"cases/{case}/tests/X"]
                for symbol, value in values.items():
                    self.assertAlmostEqual(stored[symbol][()] * 1e-6, value, delta=2e-12, msg=symbol)
                deviations = stored["deviation_up"][()], stored["deviation_down"][()]
                for symbol, value in iso230_2(*deviations).items():
                    self.assertAlmostEqual(stored[symbol][()], value, delta=1e-9, msg=symbol)

    def test_compensation_lowers_systematic_errors_and_leaves_lost_motion(self):
        is_now, table = (parameters(self.path(case), "--standard", "2")[0] for case in ("as_it_is", "table"))
        # 20 um/m over 400 mm less a part of the periodic error of +-1.5 um, and 4 um of lost motion
        self.assertGreater(is_now["E"], (8 + 4 - 3.5) * 1e-6)
        self.assertLess(table["E"], (4 + 3.5) * 1e-6)
        for values in (is_now, table):
            self.assertAlmostEqual(abs(values["B_mean"]), 4e-6, delta=0.3e-6)

    def test_the_sheets_of_both_cases_are_printed_side_by_side(self):
        self.assertIn("ISO 230-2, X: 9 targets from 20 to 420 mm, 5 runs in both directions", self.printed)
        self.assertRegex(self.printed, r"parameter +meaning +as_it_is +U \(k = 2\) +table +U \(k = 2\) +unit")
        self.assertRegex(self.printed, r"(?m)^A +bi-directional positioning accuracy +[\d.]+ +[\d.]+ +[\d.]+ +[\d.]+ +um$")


class SimulatedDiagonals(unittest.TestCase):
    """scenarios/standards/diagonals.toml: a laser along the diagonals of a face, and a ball bar."""

    @classmethod
    def setUpClass(cls):
        temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(temporary.cleanup)
        cls.folder = temporary.name
        scenario = os.path.join(ROOT, "scenarios", "standards", "diagonals.toml")
        done = subprocess.run([SERVOMILL, "run", scenario, "-o", "out.h5", "--readings", "readings"], cwd=cls.folder, capture_output=True, text=True,
                              check=False)
        assert done.returncode == 0, done.stderr

    def path(self, *names):
        return os.path.join(self.folder, "readings", *names)

    def test_parameters_of_the_run_are_those_of_its_readings(self):
        self.assertEqual(nexus_rules.faults(os.path.join(self.folder, "out.h5")), [])
        with h5py.File(os.path.join(self.folder, "out.h5")) as file:
            for case in ("as_it_is", "gcode"):
                stored = file[f"cases/{case}/tests/face"]
                values, _ = parameters(self.path(case, "face", "PP.csv"), self.path(case, "face", "NP.csv"), "--standard", "6")
                for symbol, value in values.items():
                    self.assertAlmostEqual(stored[symbol][()] * 1e-6, value, delta=4e-12, msg=symbol)
                largest = {}
                for line in ("PP", "NP"):
                    found = iso230_2(stored[line]["deviation_up"][()], stored[line]["deviation_down"][()])
                    largest = {symbol: max(found[symbol], largest.get(symbol, 0.0)) for symbol in "ERBA"}
                for symbol, value in largest.items():
                    self.assertAlmostEqual(stored[symbol + "_d"][()], value, delta=1e-9, msg=symbol)

    def test_errors_are_found_and_corrected(self):
        before, after = (parameters(self.path(case, "circle.csv"), "--standard", "4", "--radius", "100")[0] for case in ("as_it_is", "gcode"))
        self.assertAlmostEqual(before["squareness"], -60e-6, delta=0.5e-6)
        self.assertAlmostEqual(before["scale_mismatch"], 40e-6, delta=0.5e-6)
        for symbol in ("B_1", "B_2"):  # less than 3 um: the change over takes 0.05 mm, 1.8 deg of the circle
            self.assertAlmostEqual(before[symbol], -3e-6, delta=0.4e-6)
            self.assertAlmostEqual(after[symbol], 0.0, delta=0.05e-6)
        # 0.3 um is the range of the readings of the ball bar, 0.1 um its step
        self.assertLess(after["G_b"], 0.5e-6)


unittest.main()
