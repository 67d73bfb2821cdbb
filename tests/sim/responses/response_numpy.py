#!/usr/bin/python3
"""The maximum-likelihood response is what numpy computes from the same samples.

    response_numpy.py SERVOMILL

On a made-up recording; and on that of the two-inertia bench with its wanted numbers, where it lies beside the project.
"""
import pathlib
import re
import subprocess
import sys
import tempfile

import h5py
import numpy as np

BENCH = pathlib.Path(__file__).resolve().parents[4] / "shared/data/measured/two_inertia_multisine_A.mat"
TOLERANCE = 1e-9


def run(*arguments):
    return subprocess.run([str(a) for a in arguments], check=True, capture_output=True, text=True).stdout


def reference(u, y, samples, skip):
    """Response and variance of its lines: means and scatter over the periods."""
    count = len(u) // samples
    U, Y = (np.fft.fft(x[skip * samples:count * samples].reshape(-1, samples), axis=1)[:, :samples // 2] for x in (u, y))
    n = len(U)
    mean_u, mean_y = U.mean(axis=0), Y.mean(axis=0)
    var_u, var_y = (np.sum(np.abs(x - x.mean(axis=0)) ** 2, axis=0) / (n * (n - 1)) for x in (U, Y))
    cov = np.sum((Y - mean_y) * np.conj(U - mean_u), axis=0) / (n * (n - 1))
    with np.errstate(divide="ignore", invalid="ignore"):
        G = mean_y / mean_u
        variance = np.abs(G) ** 2 * (var_y / np.abs(mean_y) ** 2 + var_u / np.abs(mean_u) ** 2
                                     - 2 * np.real(cov / (mean_y * np.conj(mean_u))))
    return G, variance


def compare(servomill, recording, table, names, period, samples, rate, folder, options=()):
    out, signals = folder / "response.csv", folder / "response.h5"
    printed = run(servomill, "response", recording, "--input", names[0], "--output", names[1], "--period", period,
                  "--table", out, "--signals", signals, "--force", *options)
    found = np.loadtxt(out, delimiter=",", skiprows=1)
    G, variance = reference(table[0], table[1], samples, 1)
    lines = np.rint(found[:, 0] * samples / rate).astype(int)
    assert len(lines) > 10
    error = np.abs(found[:, 1] + 1j * found[:, 2] - G[lines]) / np.abs(G[lines])
    print(f"{recording.name}: {len(lines)} lines, greatest relative difference {error.max():.2g}, of the variance "
          f"{np.max(np.abs(found[:, 3] / variance[lines] - 1)):.2g}")
    assert error.max() <= TOLERANCE
    assert np.allclose(found[:, 3], variance[lines], rtol=1e-6)
    with h5py.File(signals) as file:
        stored = np.column_stack([file["response"][key][:] for key in ("frequency", "real", "imaginary", "variance", "radius_95")])
        np.testing.assert_array_equal(stored, found)
        assert ("two_mass" in file) == ("--fit" in options)
    return printed


def made_up(folder):
    rng = np.random.default_rng(1)
    t = np.arange(6 * 400)
    u = sum(np.cos(2 * np.pi * k * t / 400 - np.pi * k * k / 60) for k in range(2, 60))
    y = np.zeros_like(u)
    for n in range(2, len(t)):
        y[n] = 1.6 * y[n - 1] - 0.8 * y[n - 2] + 0.1 * u[n - 1]
    u, y = (x + 0.05 * rng.standard_normal(len(t)) for x in (u, y))
    path = folder / "made_up.csv"
    np.savetxt(path, np.column_stack([t * 1e-3, u, y]), delimiter=",", header="time [s],u,y", comments="", fmt="%.17g")
    return path, (u, y)


def main():
    servomill = sys.argv[1]
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        path, table = made_up(folder)
        compare(servomill, path, table, ("u", "y"), 0.4, 400, 1000.0, folder)
        if not BENCH.is_file():
            print(f"skipped: no {BENCH.name}")
            return
        csv = folder / "bench.csv"
        run(servomill, "recording", BENCH, "-o", csv, "--time-unit", "us")
        heads = csv.read_text(encoding="utf-8").splitlines()[0].split(",")
        data = np.loadtxt(csv, delimiter=",", skiprows=1)
        column = {re.sub(r" \[.*", "", head): data[:, k] for k, head in enumerate(heads)}
        printed = compare(servomill, BENCH, (column["iq_refx"], column["theta_mx"]), ("iq_refx", "theta_mx"), 1, 2500, 2500.0,
                          folder, ("--time-unit", "us", "--fit", "two-mass"))
        found = re.search(r"antiresonance ([\d.]+) Hz, resonance ([\d.]+) Hz, median misfit ([\d.]+) %", printed)
        antiresonance, resonance, misfit = (float(x) for x in found.groups())
        print(f"antiresonance {antiresonance} Hz, resonance {resonance} Hz, median misfit {misfit} %")
        assert abs(antiresonance - 54) <= 1 and abs(resonance - 76.2) <= 0.5 and misfit <= 4


main()
