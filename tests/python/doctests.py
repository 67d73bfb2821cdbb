#!/usr/bin/python3
"""The examples of the docstrings and of tools/python/README.md run as they are printed."""
import doctest
import importlib
import os
import pathlib
import pkgutil
import sys
import tempfile

import servomill

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
NAMES = {"example": str(HERE.parent / "tools/side_and_contour.toml"), "example_program": str(HERE.parent / "tools/side_and_contour.ngc")}


def tests(folder):
    """Docstrings of all modules, then the page."""
    names = dict(NAMES, example_result=os.path.join(folder, "result.h5"))
    servomill.run(names["example"], output=names["example_result"])
    finder = doctest.DocTestFinder()
    for one in pkgutil.iter_modules(servomill.__path__):
        if one.name != "_core":
            module = importlib.import_module(f"servomill.{one.name}")
            yield from (test for test in finder.find(module, extraglobs=names) if test.examples)
    page = ROOT / "tools/python/README.md"
    yield doctest.DocTestParser().get_doctest(page.read_text(encoding="utf-8").replace("\n```\n", "\n\n"), {}, "README.md", str(page), 0)


def main():
    runner = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS)
    with tempfile.TemporaryDirectory() as folder:
        wanted = list(tests(folder))
        os.chdir(ROOT)
        for test in wanted:
            runner.run(test)
    print(f"{runner.tries} examples, {runner.failures} wrong")
    return 1 if runner.failures or runner.tries < 40 else 0


if __name__ == "__main__":
    sys.exit(main())
