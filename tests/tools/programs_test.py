#!/usr/bin/python3
"""What tools/s_part.py, tools/cone_frustum.py and tools/m1_part.py write is what is shipped; they say in one line what is
wrong with their options."""
import pathlib
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAMS = ROOT / "scenarios" / "programs"


def made(tool, *arguments):
    return subprocess.run(["/usr/bin/python3", "-B", ROOT / "tools" / tool, *map(str, arguments)], capture_output=True)


class Shipped(unittest.TestCase):
    def test_s_part(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "s_part.ngc"
            done = made("s_part.py", path)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual(path.read_bytes(), (PROGRAMS / "s_part.ngc").read_bytes())

    def test_m1_part(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "m1_part.stl"
            done = made("m1_part.py", path)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertEqual(path.read_bytes(), (ROOT / "scenarios" / "guevel2025" / "m1_part.stl").read_bytes())

    def test_cone_frusta(self):
        done = made("cone_frustum.py")
        self.assertEqual((done.returncode, done.stderr), (0, b""))
        self.assertEqual(done.stdout, (PROGRAMS / "bk4.ngc").read_bytes())


class Mistakes(unittest.TestCase):
    def refuses(self, message, tool, *arguments):
        done = made(tool, *arguments)
        self.assertEqual((done.returncode, done.stdout, done.stderr.decode()), (2, b"", message + "\n"))

    def test_of_cone_frusta(self):
        for option, value in (("radius", "-1"), ("radius", "inf"), ("step", "0"), ("step", "-1"), ("feed", "0"), ("feed", "nan")):
            self.refuses(f"cone_frustum.py: error: --{option} is {value}; must be > 0", "cone_frustum.py", f"--{option}={value}")
        for step in ("0.7", "9"):    # the circle would not close; no run-in
            self.refuses(f"cone_frustum.py: error: --step is {step}; 360 deg must be an integer number of steps of at most 8 deg",
                         "cone_frustum.py", "--step", step)

    def test_of_the_s_part(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "nodir" / "a.cls"
            self.refuses(f"{path}: error: folder {path.parent} does not exist", "s_part.py", path)
            there = pathlib.Path(folder) / "a.cls"
            self.refuses("s_part.py: error: --height is 0; must be > 0", "s_part.py", there, "--height", "0")
            self.assertFalse(there.exists())

    def test_of_the_m1_part(self):
        with tempfile.TemporaryDirectory() as folder:
            there = pathlib.Path(folder) / "a.stl"
            for message, *options in (("--circle is -1; must be > 0", "--circle", "-1"),
                                      ("--circle 113 does not fit on --diamond 113", "--circle", "113"),
                                      ("--diamond 131 does not fit on --square 160", "--diamond", "131"),
                                      ("--circle-depth, --diamond-depth and --square-depth must grow", "--diamond-depth", "5")):
                self.refuses(f"m1_part.py: error: {message}", "m1_part.py", there, *options)
            self.assertFalse(there.exists())
            there.write_text("")
            self.refuses(f"{there}: error: exists; use --force to overwrite", "m1_part.py", there)


if __name__ == "__main__":
    unittest.main(verbosity=1)
