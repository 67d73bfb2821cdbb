#!/usr/bin/python3
"""A result file opens in H5Web on its default plot: the contour error over time, with units.

h5web_test.py SERVOMILL FOLDER

FOLDER keeps the packages of package-lock.json from one run to the next. Ends with 77 (skipped) where node, npm or
Chromium is missing.
"""
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
GALLERY = HERE.parent / "cli" / "gallery" / "scenario.toml"
PATIENCE = 120   # s, of each command on a busy machine
ATTEMPTS = 4     # to install the packages: servers refuse now and then
SKIPPED = 77


def skip(why):
    print(f"SKIPPED: {why}")
    sys.exit(SKIPPED)


def install(folder):
    """npm ci, once for each state of the lock file."""
    folder.mkdir(parents=True, exist_ok=True)
    done = folder / "installed.json"
    wanted = (HERE / "package-lock.json").read_text(encoding="utf-8")
    if done.exists() and done.read_text(encoding="utf-8") == wanted:
        return
    for name in ("package.json", "package-lock.json", ".npmrc"):
        shutil.copy(HERE / name, folder)
    for attempt in range(1, ATTEMPTS + 1):
        npm = subprocess.run(["npm", "ci", "--no-progress"], cwd=folder, capture_output=True, text=True, check=False, timeout=600)
        if npm.returncode == 0:
            break
        time.sleep(3 * attempt)
    assert npm.returncode == 0, f"npm ci failed: {npm.stderr.strip()[-300:]}"
    done.write_text(wanted, encoding="utf-8")


def shown(path, folder, chromium):
    node = subprocess.run(["node", HERE / "h5web.mjs", path, folder, chromium], capture_output=True, text=True,
                          check=False, timeout=PATIENCE)
    assert node.returncode == 0, node.stderr
    return json.loads(node.stdout)


def main():
    servomill, folder = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
    chromium = shutil.which("chromium")
    if not (chromium and shutil.which("node") and shutil.which("npm")):
        skip("node, npm or chromium is not installed")
    install(folder)
    with tempfile.TemporaryDirectory() as temporary:
        result = os.path.join(temporary, "result.h5")
        subprocess.run([servomill, "run", GALLERY, "-o", result], check=True, capture_output=True)
        found = shown(result, folder, chromium)
    print(found)
    error = "distance of the true tool centre point to the nominal path [um]"
    assert found["faults"] == [], found["faults"]
    assert found["view"] == "NX Line", found["view"]
    assert found["figure"] == error, found["figure"]
    assert error in found["texts"], found["texts"]
    assert "time since the start of the program [s]" in found["texts"], found["texts"]


main()
