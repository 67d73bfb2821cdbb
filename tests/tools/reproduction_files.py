"""Result files and rows that the tests of tools/reproduction share."""
import contextlib
import dataclasses
import pathlib
import subprocess
import sys
import tempfile
import unittest

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
SCENARIOS = ROOT / "scenarios"
sys.path.insert(0, str(ROOT / "tools"))

from reproduction import report, rows, runs, values

SMALL = ("signal_delay", "example1", "example1_unit", "example1_centre")   # fractions of a second each


def servomill(*arguments):
    done = subprocess.run([WithResults.servomill, *map(str, arguments)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


def row(**changes):
    return dataclasses.replace(
        rows.Row(id="x", paper="G", group="g", quantity="q", printed="p", unit="um", why="w", basis="predicted", here={"run": "r"},
                 value=2.0, tolerance=0.5, tolerance_reason="t"), **changes)


class WithResults(unittest.TestCase):
    servomill = ""   # the command

    def other_results(self, folder, failed=None):
        found = values.Results(folder, failed)
        self.addCleanup(found.close)
        return found

    def lines(self, chosen, results=None):
        results = results or self.shared
        return [report.judged(one, values.find(one, results)) for one in rows.read() if chosen(one)]


@contextlib.contextmanager
def shared_results(command):
    """Result files that all tests share, of the small scenarios."""
    WithResults.servomill = command
    with tempfile.TemporaryDirectory() as folder:
        WithResults.folder = pathlib.Path(folder)
        small = [one for one in runs.RUNS if one.name in SMALL]
        WithResults.failed = runs.run_all(small, command, WithResults.folder, lambda _: None)
        WithResults.shared = values.Results(WithResults.folder)
        try:
            yield
        finally:
            WithResults.shared.close()
