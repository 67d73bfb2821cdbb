"""Sweeps in a folder of their own: what the tests of tables and of their merge share."""
import os
import subprocess
import sys
import tempfile
import unittest

import h5py

HERE = os.path.dirname(os.path.abspath(__file__))
SERVOMILL = os.path.abspath(sys.argv.pop(1))
SCENARIO = os.path.join(HERE, "gallery", "scenario.toml")
PATIENCE = 60  # s, far more than anything here takes
# 40 points: feed x response time, the third response time is refused
POINTS = ('sweep={program.feed_override=[1.0,2.0,3.0,4.0,5.0],case.table.strategy.injection_point=["position_command",'
          '"feed_forward"],case.table.strategy.time_constant_ms=[0.0,10.0,-1.0,20.0]}')
SLOW = 'program.parameters."#101"=300.0'  # mm/min: some hundredths of a second a point


def servomill(*arguments, status=0, **more):
    done = subprocess.run([SERVOMILL, *arguments], capture_output=True, text=True, timeout=PATIENCE, check=False, **more)
    assert status in (None, done.returncode), f"{arguments}: {done.returncode}\n{done.stderr}"
    return done


BUILD = servomill("--version").stdout.split()[-1]


def columns(path):
    """All columns of a table: {name: bytes}."""
    with h5py.File(path) as file:
        return {name: data[:].tobytes() for name, data in file["sweep"].items()}


class Sweeps(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def path(self, name):
        return os.path.join(self.folder, name)

    def read(self, name):
        with open(self.path(name), encoding="utf-8") as file:
            return file.read()

    def sweep(self, name, *more, status=1, points=POINTS):
        return servomill("sweep", SCENARIO, "-q", "-o", self.path(name), "--set", points, *more, status=status)

    def refused(self, message, *arguments):
        done = servomill(*arguments, status=2)
        self.assertEqual(done.stderr.replace(self.folder + "/", ""), message + "\n")

    def expect_same_table(self, one, other):
        self.assertEqual(columns(self.path(one)), columns(self.path(other)))
        csv_of = [self.read(name.replace(".h5", ".csv")) for name in (one, other)]
        self.assertEqual(*csv_of)
