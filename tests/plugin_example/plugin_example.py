#!/usr/bin/python3
"""A plug-in of somebody else: configured and built against an installed servomill, outside of the source tree, then run.

    plugin_example.py CMAKE BUILD_FOLDER SERVOMILL
"""
import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

HERE = os.path.dirname(os.path.abspath(__file__))
GALLERY = os.path.join(HERE, "..", "cli", "gallery")
SERVOMILL, BUILD, CMAKE = (os.path.abspath(sys.argv.pop()) for _ in range(3))
PATIENCE = 120  # s, far more than anything here takes
HEIGHT = 200.0  # um
SCENARIO = f"""
[[case]]
name = "quadrant"
[[case.strategy]]
type = "quadrant"
height_um = {HEIGHT}
decay_ms = 1000
"""
QUANTITY = """
[[quantity]]
name = "trajectory_difference"
axis = "X"
baseline = "nominal"
cases = ["quadrant"]
statistic = "{}"
sections = ["{}"]
"""
PROGRAM = "G21 G90 G94 G64\nF1000\n(MSG, forth)\nG1 X10\n(MSG, back)\nG1 X0\nM30\n"


def done(*arguments, **more):
    out = subprocess.run(arguments, capture_output=True, text=True, timeout=PATIENCE, check=False, **more)
    assert out.returncode == 0, f"{arguments}: {out.returncode}\n{out.stdout}{out.stderr}"
    return out.stdout


class PluginExample(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def path(self, *names):
        return os.path.join(self.folder, *names)

    def build(self):
        done(CMAKE, "--install", BUILD, "--prefix", self.path("prefix"), "--component", "plugin")
        shutil.copytree(HERE, self.path("project"))
        done(CMAKE, "-S", self.path("project"), "-B", self.path("build"),
             "-DCMAKE_PREFIX_PATH=" + self.path("prefix"), "-DCMAKE_BUILD_TYPE=Release")
        done(CMAKE, "--build", self.path("build"))
        return self.path("build", "quadrant.so")

    def test_it_is_built_and_acts_behind_a_reversal(self):
        plugin = self.build()
        listed = done(SERVOMILL, "list", "strategies", "--plugin", plugin)
        self.assertIn("quadrant: pulses at the reversals of X, Y and Z\n", listed)
        with open(os.path.join(GALLERY, "scenario.toml"), encoding="utf-8") as file:
            text = file.read()
        with open(self.path("s.toml"), "w", encoding="utf-8") as file:
            file.write(text[:text.index('[[case]]\nname = "table"')] + SCENARIO)
            for statistic, section in (("max", "forth"), ("max", "back"), ("mean", "back")):
                file.write(QUANTITY.format(statistic, section))
        with open(self.path("part.ngc"), "w", encoding="utf-8") as file:
            file.write(PROGRAM)
        shutil.copy(os.path.join(GALLERY, "machine.toml"), self.folder)
        printed = done(SERVOMILL, "run", "s.toml", "-o", "out.h5", "--json", "--plugin", plugin, cwd=self.folder)
        forth, back, mean = (row["value"] for row in json.loads(printed))
        self.assertEqual(forth, 0.0)  # no reversal yet
        self.assertAlmostEqual(back, HEIGHT, delta=0.1 * HEIGHT)
        self.assertLess(mean, -0.5 * HEIGHT)  # towards -X, as the axis then goes


if __name__ == "__main__":
    unittest.main()
