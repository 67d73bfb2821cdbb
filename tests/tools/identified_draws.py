#!/usr/bin/python3
"""How often does precompensation with identified knowledge leave less than a quarter of the largest contour error?

    identified_draws.py SERVOMILL COUNT

Runs scenarios/precompensation/identified.toml on COUNT machines drawn from what is known.
"""
import json
import pathlib
import subprocess
import sys
import tempfile


def main():
    servomill, count = sys.argv[1:3]
    scenario = pathlib.Path(__file__).resolve().parents[2] / "scenarios" / "precompensation" / "identified.toml"
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run([servomill, "sweep", scenario, "-o", pathlib.Path(folder) / "draws.h5", "--json",
                               "--set", f"sweep.samples.count={count}"], stdout=subprocess.PIPE, check=True)
    largest = {"identified": [], "uncompensated": []}
    for one in json.loads(done.stdout):
        row = one["row"]
        if row["quantity"] == "contour_error":
            largest[row["case"]].append(row["value"])
    left = [after / before for after, before in zip(largest["identified"], largest["uncompensated"])]
    assert len(left) == int(count), f"{len(left)} machines"
    within = 100 * sum(share < 0.25 for share in left) / len(left)
    print(f"{len(left)} machines: {within:.0f} % with less than a quarter of the largest contour error; "
          f"left {min(largest['identified']):.2f} to {max(largest['identified']):.2f} um of "
          f"{min(largest['uncompensated']):.1f} to {max(largest['uncompensated']):.1f} um")


if __name__ == "__main__":
    main()
