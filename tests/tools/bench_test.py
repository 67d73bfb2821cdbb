#!/usr/bin/python3
"""tools/bench configures what other commands have configured without benchmarks."""
import importlib.machinery
import importlib.util
import pathlib
import tempfile
import unittest
import unittest.mock

TOOL = pathlib.Path(__file__).resolve().parents[2] / "tools" / "bench"
LOADER = importlib.machinery.SourceFileLoader("bench", str(TOOL))
bench = importlib.util.module_from_spec(importlib.util.spec_from_loader("bench", LOADER))
LOADER.exec_module(bench)

CONFIGURE = ["cmake", "--preset", "release", "-DSERVOMILL_TESTS=ON", "-DSERVOMILL_BENCHMARKS=ON"]


class Build(unittest.TestCase):
    def commands(self, cache):
        """What it runs in a folder with such a cache of CMake; None: nothing there."""
        with tempfile.TemporaryDirectory() as root:
            folder = pathlib.Path(root) / "build" / "release"
            if cache is not None:
                folder.mkdir(parents=True)
                (folder / "CMakeCache.txt").write_text(cache, encoding="utf-8")
                (folder / "build.ninja").touch()
            with unittest.mock.patch.object(bench, "ROOT", pathlib.Path(root)), \
                    unittest.mock.patch.object(bench.subprocess, "run") as run:
                bench.build("release", ["servomill_bench"])
            make = ["cmake", "--build", str(folder), "--target", "servomill_bench"]
            self.assertEqual(run.call_args_list[-1].args[0], make)
            return [call.args[0] for call in run.call_args_list[:-1]]

    def test_configures_once(self):
        both = "SERVOMILL_BENCHMARKS:BOOL=ON\nSERVOMILL_TESTS:BOOL=ON\n"
        self.assertEqual(self.commands(None), [CONFIGURE])
        self.assertEqual(self.commands(both), [])

    def test_configures_again_after_the_demo(self):
        after_demo = "SERVOMILL_BENCHMARKS:BOOL=ON\nSERVOMILL_TESTS:BOOL=OFF\n"
        self.assertEqual(self.commands(after_demo), [CONFIGURE])
        self.assertEqual(self.commands("SERVOMILL_BENCHMARKS:BOOL=OFF\nSERVOMILL_TESTS:BOOL=ON\n"), [CONFIGURE])


if __name__ == "__main__":
    unittest.main(verbosity=1)
