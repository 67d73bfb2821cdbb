#!/usr/bin/python3
"""Budgets of a machine with every cause, whose remainders are shared among pairs of causes.

    budget_pairs.py SERVOMILL

Prints the largest remainder of twelve budgets (four cases, three axes) as a share of the residual (rms), before and after
pairs are shared. What is less than 0.05 um counts as 0.
"""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

import h5py
import numpy as np
import xarray

import nexus_rules

SERVOMILL = pathlib.Path(sys.argv.pop(1)).resolve()
SCENARIO = pathlib.Path(__file__).with_name("budget_pairs") / "every_cause.toml"
SMALL = 0.05       # um, rms
WANTED = 0.1       # of the residual, rms
ROUNDING = 1e-9    # um
NEVER_IN_PAIRS = {"lag", "delay", "measurement", "interpolation", "uncorrectable", "imposed"}


class Pairs(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.path = pathlib.Path(folder.name) / "budget.h5"
        printed = subprocess.run([SERVOMILL, "budget", SCENARIO, "--quantity", "tool_deviation", "--section", "slot", "--quiet",
                                  "--json", "-o", cls.path], check=True, capture_output=True, text=True)
        cls.budgets = json.loads(printed.stdout)

    def test_remainders_are_small_once_pairs_are_shared(self):
        shares = [self.share_of(one, one["remainder_rms"]) for one in self.budgets]
        after = [self.share_of(one, one.get("unexplained_rms", one["remainder_rms"])) for one in self.budgets]
        self.assertEqual(len(shares), 12)
        large = sum(share > WANTED for share in shares)
        print(f"remainder: {100 * max(shares):.1f} % of the residual, {large} of {len(shares)} above {100 * WANTED:.0f} %")
        print(f"with half of each pair: {100 * max(after):.1f} % of the residual")
        self.assertGreater(large, 0, "no budget here needs its pairs")
        self.assertLessEqual(max(after), WANTED)

    @staticmethod
    def share_of(budget, rms):
        return rms / budget["residual_rms"] if rms > SMALL else 0.0

    def test_shares_add_up_where_the_residual_is_largest(self):
        for one in (one for one in self.budgets if "pairs" in one):
            shares = sum(part["share"] for part in one["parts"].values())
            self.assertAlmostEqual(shares + one["unexplained"], one["residual"], delta=1e-6)
            self.assertAlmostEqual(sum(one["share_kinds"].values()), shares, delta=1e-6)

    def test_pairs_and_shares_are_in_the_file(self):
        self.assertEqual(nexus_rules.faults(self.path), [])
        with h5py.File(self.path) as file:
            groups = [group for group in file["budget"].values() if "pairs" in group]
            self.assertEqual(len(groups), sum("pairs" in one for one in self.budgets))
            for group in groups:
                self.check_sums(group)

    # Pairs make the remainder, shares the residual, and half of a pair goes to either cause: sample by sample.
    def check_sums(self, group):
        def total(child):
            return sum(np.array(data) for name, data in group[child].items() if name != "s")
        np.testing.assert_allclose(total("pairs"), group["remainder"], atol=ROUNDING)
        np.testing.assert_allclose(total("shares"), group["residual"], atol=ROUNDING)
        for cause, share in group["shares"].items():
            if cause in ("s", "remainder"):
                continue
            halves = [np.array(data) / 2 for name, data in group["pairs"].items() if cause in name.split("_with_")]
            self.assertFalse(cause in NEVER_IN_PAIRS and halves, cause)
            np.testing.assert_allclose(share, group[cause][:] + sum(halves), atol=ROUNDING)

    def test_xarray_selects_a_pair_by_its_place(self):
        number = next(n for n, one in enumerate(self.budgets) if "pairs" in one)
        largest = max(self.budgets[number]["pairs"], key=lambda pair: pair["rms"])
        with xarray.open_dataset(self.path, group=f"budget/{number:03}/pairs", engine="h5netcdf") as data:
            pair = data["_with_".join(largest["causes"])]
            self.assertEqual(pair.dims, ("s",))
            at_place = float(pair.sel(s=self.budgets[number]["s_mm"], method="nearest"))
            self.assertAlmostEqual(at_place, largest["at_place"], delta=1e-3)


if __name__ == "__main__":
    unittest.main()
