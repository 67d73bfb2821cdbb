#!/usr/bin/python3
"""A sweep under GNU parallel of which one process is killed, and then everything. parallel.py SERVOMILL"""
import os
import signal
import subprocess
import sys
import tempfile
import unittest

import sharded

SERVOMILL = os.path.abspath(sys.argv.pop(1))
KILLED, CUT = 2, 7  # the shard whose process is killed, the one during which the power fails
INSTALL = '. "$0" && install_packages_or_skip "${PARALLEL_PACKAGES[@]}"'


def start(out):
    """tools/parallel; all that it starts carries OUT in its environment."""
    return subprocess.Popen([os.path.join(sharded.TOOLS, "parallel"), "--jobs", "4", "--", str(sharded.SHARDS),
                             sharded.SCENARIO, out], env={**os.environ, "SERVOMILL": SERVOMILL, "SWEEP_OF": out},
                            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)


def power_fails(out):
    """Kills all that start(out) has started, at once: shards, parallel and the script."""
    found = True
    while found:
        found = []
        for process in map(int, filter(str.isdigit, os.listdir("/proc"))):
            try:
                if sharded.environment(process).get("SWEEP_OF") == out:
                    found.append(process)
                    os.kill(process, signal.SIGKILL)
            except OSError:  # has ended, or is not ours
                pass


class Parallel(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.single, cls.out = (os.path.join(folder.name, name) for name in ("single.h5", "out.h5"))
        cls.addClassCleanup(power_fails, cls.out)
        sharded.single_process(SERVOMILL, cls.single)

        first = start(cls.out)
        killed, cut = (sharded.shard_name(cls.out, shard) for shard in (KILLED, CUT))
        cls.kept = {}
        sharded.await_(f"shard {KILLED} on its way", lambda: sharded.begun(killed))
        os.kill(sharded.process_of(cls.out, KILLED), signal.SIGKILL)
        cls.kept[KILLED] = sharded.points(killed)
        sharded.await_(f"shard {CUT} on its way", lambda: sharded.begun(cut))
        power_fails(cls.out)
        cls.kept[CUT] = sharded.points(cut)
        cls.first_said, _ = first.communicate(timeout=sharded.PATIENCE)
        with open(cls.out.replace(".h5", ".joblog"), encoding="utf-8") as file:
            cls.done_first = [line.split("\t")[0] for line in file.readlines()[1:] if line.split("\t")[6] == "0"]

        second = start(cls.out)
        cls.second_said, _ = second.communicate(timeout=sharded.PATIENCE)
        cls.status = second.returncode

    def test_it_ends_well(self):
        self.assertEqual(self.status, 0, self.second_said)

    def test_killed_shard_is_tried_again_and_keeps_its_finished_points(self):
        finished, there = self.kept[KILLED]
        self.assertTrue(0 < finished < there, f"{finished} of {there} points when it was killed")
        self.assertIn(str(KILLED), self.done_first)
        self.assertIn(f"{finished} points kept", self.first_said)

    def test_the_same_line_runs_what_the_power_failure_left(self):
        finished, there = self.kept[CUT]
        self.assertTrue(0 < finished < there, f"{finished} of {there} points when the power failed")
        self.assertNotIn(str(CUT), self.done_first)
        self.assertIn(f"{finished} points kept", self.second_said)

    def test_done_shards_are_not_started_again(self):
        for shard in self.done_first:
            self.assertNotIn(f"{shard}-of-{sharded.SHARDS}.h5", self.second_said)

    def test_merged_table_is_that_of_a_single_process(self):
        self.assertEqual(sharded.points(self.out), (512, 512))
        self.assertEqual(sharded.differences(self.out, self.single), [])


if __name__ == "__main__":
    ready = subprocess.run(["bash", "-c", INSTALL, os.path.join(sharded.TOOLS, "install.sh")], check=False).returncode
    if ready:
        sys.exit(ready)
    unittest.main()
