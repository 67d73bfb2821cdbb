"""Result files that the tests of tools/plot.py share, and the program itself."""
import contextlib
import io
import pathlib
import subprocess
import sys
import tempfile
import types
import unittest
import unittest.mock

HERE = pathlib.Path(__file__).resolve().parent
PLOT = HERE.parents[1] / "tools" / "plot.py"
sys.path.insert(0, str(PLOT.parent))

import plot as program
from figures import style

SMALLEST_PNG = 5000  # bytes; empty axes of these sizes stay below
COARSE = 60          # dots per inch: half of the time of drawing goes into pixels


def servomill(*arguments, status=0):
    done = subprocess.run([WithFiles.servomill, *map(str, arguments)], capture_output=True, text=True)
    assert status in (None, done.returncode), done.stderr
    return done.stdout


def plot(*arguments, dpi=COARSE):
    """Runs the program within this process: its exit status and what it prints."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err), unittest.mock.patch.object(style, "DPI", dpi):
        status = program.run(program.main, [str(one) for one in arguments])
    return types.SimpleNamespace(returncode=status, stdout=out.getvalue(), stderr=err.getvalue())


def plot_names(*arguments):
    """The same with empty files in place of pictures, for tests of which figures there are."""
    with unittest.mock.patch.object(program, "save", lambda figure, path, ending: path.touch()):
        return plot(*arguments)


@contextlib.contextmanager
def shared_files(program):
    """Makes the result files that all tests share, with that `servomill`."""
    WithFiles.servomill = program
    WithFiles.folder = tempfile.TemporaryDirectory()
    root = WithFiles.root = pathlib.Path(WithFiles.folder.name)
    side, contour = HERE / "side_and_contour.toml", HERE / "generated_and_compensated.toml"
    for name in ("side", "contour", "sweep", "stopped", "none"):
        setattr(WithFiles, name, root / f"{name}.h5")
    limit = "machine_override.nc.following_error_limit_mm="
    servomill("run", side, "-o", WithFiles.side)
    servomill("run", contour, "-o", WithFiles.contour)
    servomill("sweep", side, "-o", WithFiles.sweep)
    servomill("run", side, "-o", WithFiles.stopped, "--set", limit + "0.04", status=1)
    servomill("run", side, "-o", WithFiles.none, "--set", limit + "0.0005", status=1)
    with WithFiles.folder:
        yield


class WithFiles(unittest.TestCase):
    """Each test has a folder of its own for what it draws."""
    servomill = ""

    def setUp(self):
        self.out = pathlib.Path(tempfile.mkdtemp(dir=self.root))

    def drawn(self):
        return sorted(path.name for path in self.out.iterdir())

    def fails(self, message, *arguments):
        """One line of error, exit status 2, nothing written."""
        done = plot(*arguments, "-o", self.out)
        self.assertEqual(done.stderr, message + "\n")
        self.assertEqual(done.stdout, "")
        self.assertEqual(done.returncode, 2)
        self.assertEqual(self.drawn(), [])
