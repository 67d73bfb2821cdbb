#!/usr/bin/python3
"""Machines drawn and measured by a generator that knows the READMEs only (foreign_machine.py, foreign_bench.py, foreign_readings.py), and calibrated.

    blind.py SERVOMILL      SERVOMILL_FOREIGN_THREE, _FIVE, _HEAD: machines (3, 1, 1)
"""
import os
import re
import subprocess
import sys
import tempfile
import tomllib
import unittest

import numpy as np

import foreign_readings
from foreign_machine import projected

SERVOMILL = os.path.abspath(sys.argv.pop(1))
COVERED = 1.959964  # standard deviations of a 95 % interval
SMALL = 1e-9        # of the correlation matrix: eigenvalues of combinations that are exactly 0


def truth_of(machine, key):
    """Number of the machine's errors that a key of the identified model names; um or urad."""
    name, rest = re.fullmatch(r"errors\.identified\.(\w+)\.(.+)", key).groups()
    unit = foreign_readings.UM if name[1] in "XYZ" else foreign_readings.URAD
    if rest.startswith("constant"):
        return name, machine.locations.get(name, 0.0) / unit
    function = machine.components[name]
    if rest.startswith("reversal"):
        return name, (function.lost if rest.endswith("[0]") else 0.0) / unit
    return name, function.values[int(re.search(r"\[(\d+)\]", rest)[1])] / unit


class Machines(unittest.TestCase):
    def calibrate(self, folder, kind, seed):
        machine = foreign_readings.make(folder, seed, kind)
        done = subprocess.run([SERVOMILL, "calibrate", "readings.toml", "-o", "identified.toml", "--table", "errors.csv", "--force", "-q"],
                              cwd=folder, capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 0, f"{kind} {seed}: {done.stderr}")
        with open(os.path.join(folder, "identified.toml"), "rb") as file:
            written = tomllib.load(file)
        with open(os.path.join(folder, "errors.csv"), encoding="utf-8") as file:
            combined = {line.split(",")[0] for line in file if line.rstrip().endswith(",1")}
        return machine, written["identified"], combined, done

    def measure(self, kind, count):
        inside, all_of, squares, ranks, left_out, warnings = {}, {}, 0.0, 0, set(), []
        with tempfile.TemporaryDirectory() as folder:
            for seed in range(1, count + 1):
                machine, identified, combined, done = self.calibrate(folder, kind, seed)
                truth = projected(machine) if kind == "three" else machine
                left_out |= combined
                warnings += [f"{kind} {seed}: {line}" for line in done.stderr.splitlines()]
                named = [truth_of(truth, key) for key in identified["keys"]]
                values, C = np.array(identified["values"]), np.array(identified["covariance"])
                used = [k for k, (name, _) in enumerate(named) if name not in combined and C[k, k] > 0]
                e = np.array([values[k] - named[k][1] for k in used])
                C = C[np.ix_(used, used)]
                sigma = np.sqrt(np.diag(C))
                for k, z in zip(used, e / sigma):
                    name = named[k][0]
                    inside[name] = inside.get(name, 0) + (abs(z) <= COVERED)
                    all_of[name] = all_of.get(name, 0) + 1
                eigenvalues, vectors = np.linalg.eigh(C / np.outer(sigma, sigma))
                kept = eigenvalues > SMALL * eigenvalues[-1]
                squares += (((vectors.T @ (e / sigma))[kept]) ** 2 / eigenvalues[kept]).sum()
                ranks += kept.sum()
        pooled = 100.0 * sum(inside.values()) / sum(all_of.values())
        each = {name: 100.0 * inside[name] / all_of[name] for name in inside}
        least, most = min(each, key=each.get), max(each, key=each.get)
        print(f"{kind} axes, {count} machines: pooled coverage {pooled:.2f} %, functions {each[least]:.1f} ({least}) to {each[most]:.1f} % ({most}), "
              f"whitened {squares / ranks:.4f} over {ranks}, in combination {len(left_out)}: {' '.join(sorted(left_out))}")
        print("\n".join(warnings[:20]))
        return pooled, each, squares / ranks, ranks, sum(all_of.values()), warnings

    def check(self, kind, count):
        pooled, each, whitened, ranks, numbers, warnings = self.measure(kind, count)
        # numbers of one function come and go together: three standard deviations of the count of functions
        slack = 300.0 * np.sqrt(0.05 * 0.95 / (len(each) * count))
        self.assertAlmostEqual(pooled, 95.0, delta=max(1.0, slack))
        self.assertAlmostEqual(whitened, 1.0, delta=max(0.05, 4.0 * np.sqrt(2.0 / ranks)))

    def test_three_axes(self):
        self.check("three", int(os.environ.get("SERVOMILL_FOREIGN_THREE", "3")))

    def test_five_axes(self):
        self.check("five", int(os.environ.get("SERVOMILL_FOREIGN_FIVE", "1")))

    def test_five_axes_with_a_head(self):
        self.check("head", int(os.environ.get("SERVOMILL_FOREIGN_HEAD", "1")))


if __name__ == "__main__":
    unittest.main(verbosity=1)
