#!/usr/bin/python3
"""A sweep as a Slurm job array of which one process and one node are killed.
tools/slurm/local_cluster -n 4 slurm.py SERVOMILL"""
import os
import re
import subprocess
import sys
import unittest

import sharded

SERVOMILL = os.path.abspath(sys.argv.pop(1))
KILLED, LOST = 2, 3  # the shard whose process is killed, the one whose node is lost


def lose_node(process):
    """Everything at once, as when the power fails: slurmd, job step, batch script, servomill."""
    script = sharded.parent(process)
    pid_file = os.path.join(os.path.dirname(os.environ["SLURM_CONF"]), "run", f"slurmd.{node_of(process)}.pid")
    with open(pid_file, encoding="utf-8") as file:
        slurmd = int(file.read())
    for one in (slurmd, sharded.parent(script), script, process):
        sharded.kill(one)


def node_of(process):
    return sharded.environment(process)["SLURMD_NODENAME"]


def jobs():
    """What Slurm knows of each job: those of the array by the number of the shard, the merge as 'merge'."""
    text = subprocess.run(["scontrol", "show", "job", "--oneliner"], stdout=subprocess.PIPE, text=True,
                          check=True).stdout
    found = [dict(re.findall(r"(\w+)=(\S*)", line)) for line in text.splitlines()]
    return {job.get("ArrayTaskId", "merge"): job for job in found}


class Array(sharded.Sharded):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        subprocess.run([os.path.join(sharded.TOOLS, "slurm", "submit"), "--", str(sharded.SHARDS),
                        sharded.SCENARIO, cls.out], env={**os.environ, "SERVOMILL": SERVOMILL}, check=True)
        victims = {KILLED: sharded.kill, LOST: lose_node}
        cls.kept, cls.node = {}, {}
        while victims:
            shard = sharded.await_("a victim on its way", lambda: next(
                filter(cls.begun, victims), None))
            process = sharded.process_of(cls.out, shard)
            cls.node[shard] = node_of(process)
            victims.pop(shard)(process)
            cls.kept[shard] = cls.points_of(shard)
        sharded.single_process(SERVOMILL, cls.single)  # Slurm takes 15 s to miss the node
        sharded.await_("an empty queue", lambda: subprocess.run(
            ["squeue", "--noheader"], stdout=subprocess.PIPE, check=True).stdout == b"", every=0.5)
        cls.jobs = jobs()

    def log(self, shard):
        with open(sharded.shard_name(self.out, shard).replace(".h5", ".log"), encoding="utf-8") as file:
            return file.read()

    def test_all_shards_and_the_merge_are_completed(self):
        names = [str(shard) for shard in range(1, sharded.SHARDS + 1)] + ["merge"]
        self.assertEqual({name: job["JobState"] for name, job in self.jobs.items()}, dict.fromkeys(names, "COMPLETED"))

    def test_shard_whose_process_was_killed_is_queued_again(self):
        self.assertEqual(self.jobs[str(KILLED)]["Restarts"], "1")
        self.assertIn(f"sweep.sbatch: shard {KILLED}: servomill ended with status 137; queued again", self.log(KILLED))

    def test_shard_of_a_lost_node_runs_on_another(self):
        self.assertEqual(self.jobs[str(LOST)]["Restarts"], "1")
        self.assertNotEqual(self.jobs[str(LOST)]["BatchHost"], self.node[LOST])

    def test_finished_points_are_not_run_again(self):
        for shard in (KILLED, LOST):
            self.expect_going_on(shard, *self.kept[shard], self.log(shard))

    def test_merged_table_is_that_of_a_single_process(self):
        self.expect_table_of_a_single_process()


if __name__ == "__main__":
    unittest.main()
