#!/usr/bin/python3
"""Holds the results of two builds of servomill against each other: are they equal, bit for bit?

    compare_results.py A.h5 B.h5                     two result files
    compare_results.py BEFORE AFTER SCENARIO...      two programs `servomill`: each runs each scenario
    compare_results.py BEFORE AFTER                  the same with all scenarios of this tree that can be run

All datasets and attributes are compared, but for those of the root that say which build wrote the file. Prints one line for each
difference. Exit status: 0 equal, 1 different, 2 the input is wrong.
"""
import argparse
import pathlib
import subprocess
import sys
import tempfile

import h5py
import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
OF_THE_BUILD = {"servomill_version", "servomill_build", "created", "simd_level"}
RAN = (0, 1)   # done, or the machine stopped


def content(path):
    """Bytes of every dataset and attribute of a file, by each of its paths in there."""
    out = {}

    def take(name, item):
        for key, value in item.attrs.items():
            if name == "" and key in OF_THE_BUILD or key in ("DIMENSION_LIST", "REFERENCE_LIST"):
                continue   # those two are places in the file
            out[f"{name}@{key}"] = np.asarray(value)
        if isinstance(item, h5py.Dataset):
            out[name] = item[()]
        else:
            for child, below in item.items():
                take(f"{name}/{child}".lstrip("/"), below)

    with h5py.File(path, "r") as file:
        take("", file)
    return out


def is_equal(one, other):
    one, other = np.asarray(one), np.asarray(other)
    if one.shape != other.shape or one.dtype.kind != other.dtype.kind:
        return False
    return one.tobytes() == other.tobytes() if one.dtype.kind != "O" else bool(np.all(one == other))


def differences(before, after):
    """Lines "PATH: why", for two result files."""
    one, other = content(before), content(after)
    for path in sorted(one.keys() | other.keys()):
        if path not in one or path not in other:
            yield f"{path}: only in {before if path in one else after}"
        elif not is_equal(one[path], other[path]):
            yield f"{path}: {said(one[path], other[path])}"


def said(one, other):
    one, other = np.asarray(one), np.asarray(other)
    if one.dtype.kind != "f" or one.shape != other.shape:
        return "different"
    return f"different at {np.count_nonzero(one != other)} of {one.size} places, by up to {np.nanmax(abs(one - other)):.3g}"


def run(program, scenario, out):
    done = subprocess.run([program, "run", scenario, "-o", out, "--quiet"], capture_output=True, text=True, check=False)
    return done.returncode, done.stderr


def compare_scenario(before, after, scenario, folder):
    """Differences of the results of two programs; None if neither runs the scenario."""
    results = [run(program, scenario, f"{folder}/{name}.h5") for name, program in (("before", before), ("after", after))]
    if results[0][0] != results[1][0]:
        return [f"exit status {results[0][0]} before, {results[1][0]} after: {results[1][1].strip()}"]
    if results[0][0] not in RAN:
        return None
    return list(differences(f"{folder}/before.h5", f"{folder}/after.h5"))


def compare_programs(before, after, scenarios):
    count = different = 0
    for scenario in scenarios or sorted(ROOT.glob("scenarios/*/*.toml")):
        with tempfile.TemporaryDirectory(dir=".") as folder:
            found = compare_scenario(before, after, str(scenario), folder)
        if found is None:
            continue   # a machine, a sweep that only `servomill sweep` runs
        count += 1
        different += bool(found)
        print(f"{scenario}: {'equal' if not found else 'different'}", flush=True)
        for line in found:
            print(f"  {line}")
    print(f"{count} scenarios, {different} different")
    return different > 0 or count == 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("before")
    parser.add_argument("after")
    parser.add_argument("scenarios", nargs="*", metavar="SCENARIO")
    given = parser.parse_args()
    for path in (given.before, given.after, *given.scenarios):
        if not pathlib.Path(path).is_file():
            parser.error(f"{path}: no such file")
    if not h5py.is_hdf5(given.before):
        return compare_programs(given.before, given.after, given.scenarios)
    found = list(differences(given.before, given.after))
    print("\n".join(found) or "equal")
    return bool(found)


if __name__ == "__main__":
    sys.exit(main())
