#!/usr/bin/python3
"""The notebooks run from their first to their last cell, and are stored without outputs.

    notebooks.py           ends with 77, which CTest takes for skipped, where nbclient or ipykernel is missing
    notebooks.py FOLDER    also writes them to FOLDER as they have run
"""
import os
import pathlib
import sys
import unittest

try:
    import ipykernel  # noqa: F401
    import matplotlib  # noqa: F401
    import nbclient
    import nbformat
except ImportError:
    sys.exit(77)

FOLDER = pathlib.Path(__file__).resolve().parents[2] / "tools/python/notebooks"
CELL_TIMEOUT = 120  # s, on a shared machine
EXPECTED = {  # text of the outputs
    "the_paper": ["realised_ratio", "feedback_lead  99.9", "Kv = 120 1/s: 9"],
    "my_machine": ["EC0Y", "only in combination", "verified", "squareness"],
    "my_strategy": ["12.0 ms ahead", "largest difference"],
}
OUT = None
os.environ["PYDEVD_DISABLE_FILE_VALIDATION"] = "1"  # the kernel's debugger would warn on standard error


def texts(notebook):
    """All that the cells have printed or returned."""
    out = []
    for cell in notebook.cells:
        for one in cell.get("outputs", []):
            out.append(one.get("text", "") + str(one.get("data", {}).get("text/plain", "")))
    return "\n".join(out)


class Notebooks(unittest.TestCase):
    def run_notebook(self, name):
        path = FOLDER / f"{name}.ipynb"
        notebook = nbformat.read(path, as_version=4)
        for cell in notebook.cells:
            self.assertFalse(cell.get("outputs"), f"{path} is stored with outputs")
        nbclient.NotebookClient(notebook, timeout=CELL_TIMEOUT, resources={"metadata": {"path": str(FOLDER)}}).execute()
        if OUT:
            nbformat.write(notebook, OUT / path.name)
        for text in EXPECTED[name]:
            self.assertIn(text, texts(notebook))

    def test_all_are_expected(self):
        self.assertEqual({path.stem for path in FOLDER.glob("*.ipynb")}, set(EXPECTED))

    def test_the_paper(self):
        self.run_notebook("the_paper")

    def test_my_machine(self):
        self.run_notebook("my_machine")

    def test_my_strategy(self):
        self.run_notebook("my_strategy")


if __name__ == "__main__":
    if len(sys.argv) > 1:
        OUT = pathlib.Path(sys.argv.pop())
    unittest.main()
