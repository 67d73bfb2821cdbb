#!/usr/bin/python3
"""Laws of the soak: they hold for the program, and each is seen to break with one that is at fault.

    soak_test.py SERVOMILL
"""
import os
import pathlib
import random
import shutil
import subprocess
import sys
import tempfile
import unittest

SERVOMILL = os.path.abspath(sys.argv.pop(1))
ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))
sys.dont_write_bytecode = True
from soaking import __main__ as soaking  # noqa: E402
from soaking import generate, laws  # noqa: E402

SEEDS = range(3)
# Law and the fault of a program that it finds: bash, before the command itself.
FAULTS = {
    "scenarios_end": 'if [ "$1" = run ]; then kill -SEGV $$; fi',
    "programs_are_read_or_refused": 'echo "x.cpp:1:2: runtime error: index out of bounds" >&2',
    "threads_do_not_matter": 'if [[ " $* " == *" -j 2 "* ]]; then set -- "$@" --set program.feed_override=0.9; fi',
    "killed_runs_start_again": 'if [[ " $* " == *" killed.h5 --force"* ]]; then set -- "$@" --set program.feed_override=0.9; fi',
    "killed_sweeps_go_on": 'if [[ " $* " == *" point.h5 "* ]]; then set -- "$@" --set machine_override.nc.Kv=30; fi',
    "integrators_agree": 'if [[ "$*" == *cvode* ]]; then set -- "$@" --set machine_override.nc.Kv=30; fi',
}


class Soak(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp())
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        cls.soak = soaking.Soak(SERVOMILL, SERVOMILL)

    def at_fault(self, lines):
        program = self.folder / "servomill"
        program.write_text(f'#!/bin/bash\n{lines}\nexec "{SERVOMILL}" "$@"\n', encoding="utf-8")
        program.chmod(0o755)
        return program

    def test_laws_hold(self):
        for name in FAULTS:
            with self.subTest(name):
                self.assertIsNone(laws.check(name, 1, self.soak, self.folder / name))
                self.assertFalse((self.folder / name).exists())

    def test_every_law_is_seen_to_break(self):
        self.assertEqual(set(FAULTS) | {"moves_are_those_of_linuxcnc"}, set(laws.LAWS))
        for name, lines in FAULTS.items():
            with self.subTest(name):
                soak = soaking.Soak(SERVOMILL, SERVOMILL)
                soak.program = soak.sanitized = self.at_fault(lines)
                first = next((seed for seed in SEEDS if laws.check(name, seed, soak, self.folder / f"{name}-{seed}")), None)
                self.assertIsNotNone(first, "no seed finds it")
                kept = (self.folder / f"{name}-{first}" / "finding.txt").read_text()
                self.assertTrue(kept.startswith(f"{name}, seed {first}\ncommands:\n"), kept)

    def test_a_file_that_is_missing_is_a_finding(self):
        commands = laws.Commands(SERVOMILL, self.folder)
        commands.run("--version")
        with self.assertRaisesRegex(laws.Found, r"--version\n\nwhole\.h5 cannot be read: "):
            laws.datasets(commands, self.folder / "whole.h5")

    def test_a_seed_is_the_same_scenario_again(self):
        one, two = (generate.scenario(random.Random(4), self.soak.keys).text("m.toml") for _ in range(2))
        self.assertEqual(one, two)
        self.assertNotEqual(one, generate.scenario(random.Random(5), self.soak.keys).text("m.toml"))

    def test_programs_at_random_are_programs(self):
        for seed in range(20):
            path = self.folder / "program.ngc"
            path.write_text(generate.program(random.Random(seed), 30), encoding="utf-8")
            done = subprocess.run([SERVOMILL, "canon", path, "--reader", "linuxcnc"], capture_output=True, text=True, check=False)
            self.assertEqual((done.returncode, done.stderr), (0, ""), path.read_text())

    def test_a_report_counts_what_held_and_names_what_broke(self):
        report = soaking.Report(self.folder, ["one", "other"])
        report.add("one", 1, None)
        report.add("other", 2, "why")
        text = report.write()
        self.assertIn("| one | 1 | 0 |\n| other | 0 | 1 |\n", text)
        self.assertIn(f"- other, seed 2: {self.folder}/found/other-2", text)
        self.assertEqual((self.folder / "report.md").read_text(), text)


if __name__ == "__main__":
    unittest.main()
