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

import numpy as np

SERVOMILL = os.path.abspath(sys.argv.pop(1))
ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
LINEAR_AXIS = os.path.join(ROOT, "scenarios", "standards", "linear_axis.csv")
ROUNDING = 1e-8  # of a value: JSON has nine digits


def evaluate(*arguments, status=0, cwd=None):
    done = subprocess.run([SERVOMILL, "evaluate", *arguments], cwd=cwd, capture_output=True, text=True, check=False)
    assert done.returncode == status, f"{arguments}: {done.returncode}\n{done.stdout}{done.stderr}"
    return done


def parameters(*arguments, cwd=None):
    report = json.loads(evaluate(*arguments, "--json", cwd=cwd).stdout)
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


unittest.main()
