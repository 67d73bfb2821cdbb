#!/usr/bin/python3
"""The programs that tools/s_part.py and tools/cone_frustum.py write are those that are shipped; both say in one line
what is wrong with their options."""
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
            self.refuses(f"cone_frustum.py: error: --step is {step}; 360 deg must be a whole number of steps of at most 8 deg",
                         "cone_frustum.py", "--step", step)

    def test_of_the_s_part(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "nodir" / "a.cls"
            self.refuses(f"{path}: error: there is no folder {path.parent}", "s_part.py", path)
            there = pathlib.Path(folder) / "a.cls"
            self.refuses("s_part.py: error: --height is 0; must be > 0", "s_part.py", there, "--height", "0")
            self.assertFalse(there.exists())


if __name__ == "__main__":
    unittest.main(verbosity=1)
