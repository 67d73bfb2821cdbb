#!/usr/bin/python3
"""The lines of Python in sim/records/README.md run as they are printed. Usage: readme_test.py SERVOMILL"""
import ast
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

try:
    import h5netcdf  # noqa: F401
    import xarray    # noqa: F401
except ImportError:
    sys.exit(77)

HERE = pathlib.Path(__file__).resolve().parent
README = HERE.parents[1] / "sim/records/README.md"
SERVOMILL = ""


def servomill(*arguments):
    subprocess.run([SERVOMILL, *map(str, arguments)], check=True, capture_output=True)


def values_of(block):
    """Runs a block; the values of the expressions that its statements are."""
    names, values = {}, []
    for statement in ast.parse(block).body:
        if isinstance(statement, ast.Expr):
            values.append(eval(compile(ast.Expression(statement.value), str(README), "eval"), names))
        else:
            exec(compile(ast.Module([statement], []), str(README), "exec"), names)
    return values


class Readme(unittest.TestCase):
    def test_results_open_with_h5py_and_xarray(self):
        blocks = re.findall(r"^```python\n(.*?)^```$", README.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
        (block,) = [one for one in blocks if "out/demo" in one]
        here = os.getcwd()
        with tempfile.TemporaryDirectory() as folder:
            demo = pathlib.Path(folder) / "out" / "demo"
            demo.mkdir(parents=True)
            scenario = HERE / "side_and_contour.toml"
            servomill("run", scenario, "-q", "-o", demo / "experiment1.h5")
            servomill("sweep", scenario, "-q", "-o", demo / "experiment1_feed.h5")
            os.chdir(folder)
            try:
                column, selected, table = values_of(block)
            finally:
                os.chdir(here)
            self.assertEqual(column.ndim, 1)
            self.assertEqual(selected.values.tolist(), column.tolist())
            self.assertEqual(list(table.index.names), ["point"])
            self.assertEqual(len(table), 2)      # points of the sweep


if __name__ == "__main__":
    SERVOMILL = str(pathlib.Path(sys.argv.pop(1)).resolve())
    unittest.main(verbosity=1)
