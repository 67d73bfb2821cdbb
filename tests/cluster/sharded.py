"""A sweep in 8 shards, what its processes are doing, and the table that it should give."""
import os
import signal
import subprocess
import tempfile
import time
import unittest

import h5py

HERE = os.path.dirname(os.path.abspath(__file__))
TOOLS = os.path.join(HERE, "..", "..", "tools")
SCENARIO = os.path.join(HERE, "sweep.toml")
SHARDS = 8
POINTS = 384  # that sweep.toml has; 3 batches of 16 in a shard
PATIENCE = 250  # s, for what takes 10 s on an idle machine


class Sharded(unittest.TestCase):
    """A folder with OUT, for the shards, and SINGLE, for the table of a single process."""
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.single, cls.out = (os.path.join(folder.name, name) for name in ("single.h5", "out.h5"))

    @classmethod
    def begun(cls, shard):
        return begun(shard_name(cls.out, shard))

    @classmethod
    def points_of(cls, shard):
        return points(shard_name(cls.out, shard))

    def expect_going_on(self, shard, finished, there, said):
        """A run that printed SAID goes on with a shard of which so many points were finished when it was killed."""
        self.assertTrue(0 < finished < there, f"{finished} of {there} points when shard {shard} was killed")
        self.assertIn(f"{finished} of {there} points already exist", said)

    def expect_table_of_a_single_process(self):
        self.assertEqual(points(self.out), (POINTS, POINTS))
        self.assertEqual(differences(self.out, self.single), [])


def kill(process):
    """As the kernel does when memory runs out."""
    os.kill(process, signal.SIGKILL)


def shard_name(out, shard):
    return out.replace(".h5", f".{shard}-of-{SHARDS}.h5")


def await_(what, condition, every=0.02):
    """What the condition gives once it gives something."""
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        found = condition()
        if found:
            return found
        time.sleep(every)
    raise AssertionError(f"never came about: {what}")


def single_process(servomill, out):
    subprocess.run([servomill, "sweep", SCENARIO, "-o", out, "--quiet"], check=True)


def points(path):
    """How many points of a table are finished, and how many it has; (0, 0) before it is begun."""
    for name in (path, path + ".partial"):
        try:
            with h5py.File(name, "r", locking=False) as file:
                status = file["sweep/status"][:]
                return int((status != 0).sum()), len(status)
        except (OSError, KeyError):  # not there, or its head is being written
            pass
    return 0, 0


def begun(path):
    finished, there = points(path)
    return 0 < finished < there


def environment(process):
    with open(f"/proc/{process}/environ", "rb") as file:
        return dict(entry.split("=", 1) for entry in file.read().decode().split("\0") if "=" in entry)


def parent(process):
    with open(f"/proc/{process}/stat", encoding="utf-8") as file:
        return int(file.read().rpartition(")")[2].split()[1])


def process_of(out, shard):
    """The servomill that runs a shard of OUT, None if there is none."""
    for entry in filter(str.isdigit, os.listdir("/proc")):
        try:
            with open(f"/proc/{entry}/cmdline", "rb") as file:
                words = file.read().decode().split("\0")
        except OSError:  # has ended
            continue
        if "sweep" in words[1:3] and out in words and f"{shard}/{SHARDS}" in words:
            return int(entry)
    return None


def differences(path, other):
    """Where two tables differ: names of columns and attributes."""
    with h5py.File(path) as a, h5py.File(other) as b:
        names = sorted(set(a["sweep"]) | set(b["sweep"]))
        found = [name for name in names if name not in a["sweep"] or name not in b["sweep"]]
        for name in set(names) - set(found):
            one, two = a["sweep"][name], b["sweep"][name]
            if one.dtype != two.dtype or one[:].tobytes() != two[:].tobytes():
                found.append(name)
    for csv in (path.replace(".h5", ".csv"), other.replace(".h5", ".csv")):
        if not os.path.exists(csv):
            found.append(csv)
    with open(path.replace(".h5", ".csv"), "rb") as a, open(other.replace(".h5", ".csv"), "rb") as b:
        if a.read() != b.read():
            found.append("the CSV files")
    return found
