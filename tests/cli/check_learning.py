#!/usr/bin/python3
"""What servomill check leaves out of scenarios whose strategies learn from runs. check_learning.py SERVOMILL"""
import json
import os
import resource
import subprocess
import sys
import unittest

HERE = os.path.dirname(os.path.abspath(__file__))
SERVOMILL = os.path.abspath(sys.argv.pop(1))
SCENARIO = os.path.join(HERE, "gallery", "scenario.toml")
LEARNING = os.path.join(HERE, "..", "..", "scenarios", "precompensation", "s_part.toml")
PATIENCE = 60  # s, far more than anything here takes
MAX_CHECK = 5  # s of processor; the trial runs take 15


class CheckOfLearning(unittest.TestCase):
    # Trial runs take as long as the case itself: of this scenario many times as long as all that is checked.
    def test_trial_runs_are_counted_and_not_made(self):
        before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
        done = subprocess.run([SERVOMILL, "check", LEARNING], capture_output=True, text=True, timeout=PATIENCE, check=True)
        took = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before
        self.assertRegex(done.stdout, r"no faults\n.*: not run: \d+ trial runs from which strategies learn in cases .*learning")
        self.assertLess(took, MAX_CHECK)
        json_ = subprocess.run([SERVOMILL, "check", LEARNING, "--json"], capture_output=True, text=True, timeout=PATIENCE, check=True)
        self.assertIn("trial runs", json.loads(json_.stdout)[0]["not_run"])

    def test_nothing_is_left_out_of_others(self):
        plain = subprocess.run([SERVOMILL, "check", SCENARIO, "--json"], capture_output=True, text=True, timeout=PATIENCE, check=True)
        self.assertIsNone(json.loads(plain.stdout)[0]["not_run"])


if __name__ == "__main__":
    unittest.main()
