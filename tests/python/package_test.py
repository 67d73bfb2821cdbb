#!/usr/bin/python3
"""The package as it is installed: its files, its stubs. Usage: package_test.py CMAKE BUILD_DIR"""
import ast
import inspect
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

import servomill

CMAKE = BUILD = ""
PACKAGE = pathlib.Path(__file__).resolve().parents[2] / "tools/python/servomill"


def public(names):
    return {name for name in names if not name.startswith("_")}


def declared(body):
    """Names of the functions, classes and variables of a stub, with those of classes below them."""
    out = {}
    for one in body:
        if isinstance(one, ast.ClassDef):
            out[one.name] = declared(one.body)
        elif isinstance(one, ast.FunctionDef):
            out[one.name] = None
        elif isinstance(one, ast.AnnAssign):
            out[one.target.id] = None
    return out


class Stubs(unittest.TestCase):
    def test_declare_what_there_is(self):
        stub = declared(ast.parse((PACKAGE / "_core.pyi").read_text(encoding="utf-8")).body)
        core = servomill._core
        self.assertEqual(public(stub), public(dir(core)))
        for name, members in stub.items():
            if members is not None:
                self.assertEqual(public(members), public(dir(getattr(core, name))), name)

    def test_everything_has_a_text_and_annotations(self):
        for name in servomill.__all__:
            one = getattr(servomill, name)
            if name == "__version__":
                continue
            self.assertTrue(inspect.getdoc(one), f"{name} has no docstring")
            if inspect.isfunction(one):
                lacking = [parameter.name for parameter in inspect.signature(one).parameters.values()
                           if parameter.annotation is inspect.Parameter.empty]
                self.assertEqual(lacking, [], name)


class Installation(unittest.TestCase):
    def test_is_complete(self):
        with tempfile.TemporaryDirectory() as prefix:
            subprocess.run([CMAKE, "--install", BUILD, "--prefix", prefix, "--component", "python"], check=True, capture_output=True)
            (package,) = pathlib.Path(prefix).glob("lib/python*/dist-packages/servomill")
            self.assertTrue({path.name for path in PACKAGE.iterdir() if path.is_file()} <= {path.name for path in package.iterdir()})
            printed = self.printed("import servomill; print(servomill.__file__, servomill.__version__)", package, prefix)
            self.assertEqual(printed.split(), [str(package / "__init__.py"), servomill.__version__])

    def test_finds_scenarios_of_the_installation_by_name(self):
        with tempfile.TemporaryDirectory() as prefix, tempfile.TemporaryDirectory() as elsewhere:
            subprocess.run([CMAKE, "--install", BUILD, "--prefix", prefix], check=True, capture_output=True)
            (package,) = pathlib.Path(prefix).glob("lib/python*/dist-packages/servomill")
            printed = self.printed("import servomill; print(*servomill.scenarios())", package, elsewhere)
            self.assertIn("guevel2025/experiment1", printed.split())
            printed = self.printed("import servomill; print(servomill.load('guevel2025/experiment1').path)", package, elsewhere)
            self.assertEqual(os.path.realpath(printed.strip()),
                             os.path.realpath(f"{prefix}/share/servomill/scenarios/guevel2025/experiment1.toml"))
            printed = self.printed("import servomill\ntry: servomill.load('guevel2025/experimant1')\n"
                                   "except servomill.InputError as error: print(error.rule)", package, elsewhere)
            self.assertEqual(printed, "is no file and no scenario; did you mean 'guevel2025/experiment1'?\n")

    @staticmethod
    def printed(program, package, folder):
        return subprocess.run([sys.executable, "-B", "-c", program], env={**os.environ, "PYTHONPATH": str(package.parent)},
                              check=True, capture_output=True, encoding="utf-8", cwd=folder).stdout


if __name__ == "__main__":
    BUILD = sys.argv.pop()
    CMAKE = sys.argv.pop()
    unittest.main()
