#!/usr/bin/python3
"""Makes the result files that the tests of the page open.

    files.py SERVOMILL FOLDER
"""
import pathlib
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
SIDE = "scenarios/guevel2025/experiment1.toml"
COMMANDS = {
    "run": ("run", SIDE, "--set", "record.period_ms=4"),
    "circle": ("run", "tests/page/circle.toml"),
    "part": ("run", "scenarios/parts/block.toml", "--set", "record.period_ms=2"),
    "windows": ("run", SIDE, "--set", "record.period_ms=4", "--set", 'record.windows.sections=["notch", "flank"]'),
    "day": ("run", "scenarios/thermal/day.toml", "--set", "record.period_ms=50"),
    "sweep": ("sweep", "scenarios/sweeps/blocks_friction.toml"),
    "budget": ("budget", "tests/page/circle.toml", "--quantity", "tool_deviation"),
    "bode": ("bode", SIDE, "--axis", "Y", "--loop", "position"),
}


def run(*words, cwd):
    done = subprocess.run(words, cwd=cwd, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{words}: status {done.returncode}: {done.stderr}")


def identify(servomill, signals):
    """Recordings that are made up, and what they identify, in a copy of their folder."""
    with tempfile.TemporaryDirectory() as copy:
        for name in ("identification", "machines"):
            shutil.copytree(ROOT / "scenarios" / name, pathlib.Path(copy) / name)
        cwd = pathlib.Path(copy) / "identification" / "experiments"
        run(servomill, "run", "../motion.toml", "-o", "motion.h5", "-q", cwd=cwd)
        run(servomill, "identify", "record.toml", "--make-up", "recording.csv", cwd=cwd)
        run(servomill, "identify", "identify.toml", "--signals", signals, "--force", cwd=cwd)


def long_program(servomill, result):
    """A program above 1 MB, which the file has as a list of characters: comments, and a part behind them."""
    with tempfile.TemporaryDirectory() as copy:
        folder = pathlib.Path(copy) / "long"
        shutil.copytree(ROOT / "tests" / "cli" / "gallery", folder)
        program = folder / "part.ngc"
        program.write_text("(a comment ahead of the part: \u00e4)\n" * 50_000 + program.read_text(encoding="utf-8"), encoding="utf-8")
        run(servomill, "run", "scenario.toml", "-o", result, "--force", cwd=folder)


def main():
    servomill, folder = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    for name, (command, scenario, *options) in COMMANDS.items():
        # Names of scenarios are relative to the source tree, as users type them.
        run(servomill, command, scenario, *options, "-o", folder / f"{name}.h5", "--force", cwd=ROOT)
    identify(servomill, folder / "identified.h5")
    long_program(servomill, folder / "long.h5")
    (folder / "text.h5").write_text("not HDF5, whatever its name\n", encoding="utf-8")
    (folder / "cut.h5").write_bytes((folder / "run.h5").read_bytes()[:300_000])
    return 0


if __name__ == "__main__":
    sys.exit(main())
