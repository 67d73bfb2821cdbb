#!/usr/bin/python3
"""servomill converge as its users meet it.

    converge.py SERVOMILL
"""
import json
import os
import subprocess
import sys
import unittest

HERE = os.path.dirname(os.path.abspath(__file__))
SERVOMILL = os.path.abspath(sys.argv.pop(1))
SCENARIO = os.path.join(HERE, "gallery", "scenario.toml")
PATIENCE = 60  # s, far more than anything here takes


def converge(*arguments, status=0):
    done = subprocess.run([SERVOMILL, "converge", *arguments], capture_output=True, text=True, timeout=PATIENCE, check=False)
    assert done.returncode == status, f"{arguments}: {done.returncode}\n{done.stderr}"
    return done


class Converge(unittest.TestCase):
    def test_prints_a_line_a_row_of_the_comparison(self):
        done = converge(SCENARIO)
        lines = done.stdout.splitlines()
        self.assertEqual(lines[0].split(), ["quantity", "axis", "statistic", "section", "case", "value", "recording", "block",
                                            "solver", "tick", "digits", "stable", "unit"])
        row = lines[2].split()
        self.assertEqual(row[:5] + row[7:9] + row[-1:],
                         ["imposed_error_residual", "Y", "max", "flank", "table", "0", "0", "um"])
        self.assertEqual(done.stderr, "")

    def test_says_the_same_in_json(self):
        row = json.loads(converge(SCENARIO, "--json").stdout)[0]
        self.assertEqual(list(row["changes"]), ["recording", "block", "solver", "tick"])
        self.assertGreater(row["digits"], 1)
        self.assertAlmostEqual(float(row["stable"]), row["value"], delta=0.01 * row["value"])

    def test_halves_only_what_is_asked_for(self):
        row = json.loads(converge(SCENARIO, "--json", "--halve", "tick").stdout)[0]
        self.assertEqual(row["changes"]["recording"], 0)

    def test_knows_no_other_steps(self):
        self.assertEqual(converge(SCENARIO, "--halve", "record", status=2).stderr,
                         "--halve: error: no step 'record'; known are: recording, block, solver, tick\n")
        self.assertEqual(converge(SCENARIO, "--halve", "solvr", status=2).stderr,
                         "--halve: error: no step 'solvr'; did you mean 'solver'?\n")

    def test_faults_are_those_of_a_run(self):
        self.assertIn("program.feed_override = -1.0; must be > 0",
                      converge(SCENARIO, "--set", "program.feed_override=-1.0", status=2).stderr)


if __name__ == "__main__":
    unittest.main()
