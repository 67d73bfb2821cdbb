#!/usr/bin/python3
"""A sweep under GNU parallel of which one process is killed, and then everything. parallel.py SERVOMILL"""
import os
import subprocess
import sys
import unittest

import sharded

SERVOMILL = os.path.abspath(sys.argv.pop(1))
KILLED = 2  # the shard whose process is killed; later the power fails on others
INSTALL = '. "$0" && install_packages_or_skip "${PARALLEL_PACKAGES[@]}"'


def start(out, says):
    """tools/parallel; all that it starts carries OUT in its environment. What it says goes to a file."""
    with open(says, "wb") as file:
        return subprocess.Popen(
            [os.path.join(sharded.TOOLS, "parallel"), "--jobs", "4", "--", str(sharded.SHARDS), sharded.SCENARIO, out],
            env={**os.environ, "SERVOMILL": SERVOMILL, "SWEEP_OF": out}, stdout=file, stderr=subprocess.STDOUT)


def text_of(path):
    with open(path, encoding="utf-8") as file:
        return file.read()


def done(out):
    """The shards that OUT.joblog calls done."""
    rows = [line.split("\t") for line in text_of(out.replace(".h5", ".joblog")).splitlines()[1:]]
    return {int(row[0]) for row in rows if row[6] == "0"}  # sequence number, exit status


def power_fails(out):
    """Kills all that start(out) has started, at once: shards, parallel and the script."""
    found = True
    while found:
        found = []
        for process in map(int, filter(str.isdigit, os.listdir("/proc"))):
            try:
                if sharded.environment(process).get("SWEEP_OF") == out:
                    found.append(process)
                    sharded.kill(process)
            except OSError:  # has ended, or is not ours
                pass


class Parallel(sharded.Sharded):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.addClassCleanup(power_fails, cls.out)
        sharded.single_process(SERVOMILL, cls.single)

        first = start(cls.out, cls.out + ".first")
        sharded.await_(f"shard {KILLED} on its way", lambda: cls.begun(KILLED))
        sharded.kill(sharded.process_of(cls.out, KILLED))
        cls.kept = cls.points_of(KILLED)
        sharded.await_(f"shard {KILLED} done", lambda: KILLED in done(cls.out))
        sharded.await_("another shard on its way", lambda: any(map(cls.begun, range(1, sharded.SHARDS + 1))))
        power_fails(cls.out)
        first.wait(sharded.PATIENCE)
        cls.first_said = text_of(cls.out + ".first")
        cls.done_first = done(cls.out)
        cls.cut = {shard: cls.points_of(shard) for shard in range(1, sharded.SHARDS + 1) if cls.begun(shard)}

        cls.status = start(cls.out, cls.out + ".second").wait(sharded.PATIENCE)
        cls.second_said = text_of(cls.out + ".second")

    def test_it_ends_well(self):
        self.assertEqual(self.status, 0, self.second_said)

    def test_killed_shard_is_tried_again_and_keeps_its_finished_points(self):
        self.expect_going_on(KILLED, *self.kept, self.first_said)

    def test_the_same_line_goes_on_behind_the_points_that_a_power_failure_left(self):
        self.assertTrue(self.cut)
        for shard, kept in self.cut.items():
            self.expect_going_on(shard, *kept, self.second_said)

    def test_done_shards_are_not_started_again(self):
        for shard in self.done_first:
            self.assertNotIn(os.path.basename(sharded.shard_name(self.out, shard)), self.second_said)

    def test_merged_table_is_that_of_a_single_process(self):
        self.expect_table_of_a_single_process()


if __name__ == "__main__":
    ready = subprocess.run(["bash", "-c", INSTALL, os.path.join(sharded.TOOLS, "install.sh")], check=False).returncode
    if ready:
        sys.exit(ready)
    unittest.main()
