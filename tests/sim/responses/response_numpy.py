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

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "cli"))
import nexus_rules  # noqa: E402

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
    assert not nexus_rules.faults(signals), nexus_rules.faults(signals)
    with h5py.File(signals) as file:
        stored = np.column_stack([file["response"][key][:] for key in ("frequency", "real", "imaginary", "variance", "radius_95")])
        np.testing.assert_array_equal(stored, found)
        assert ("two_mass" in file) == ("--fit" in options)
    return printed


def local_polynomial(u, y, half_width=6, order=2):
    """Response and variance of all lines by the local polynomial method, each window by numpy's least squares."""
    U, Y = (np.fft.fft(x - x.mean())[:len(x) // 2] for x in (u, y))
    out = {}
    for k in range(1, len(U)):
        first = min(max(k - half_width, 1), len(U) - 2 * half_width - 1)
        lines = np.arange(first, first + 2 * half_width + 1)
        powers = ((lines - k) / half_width)[:, None] ** np.arange(order + 1)
        scale = np.sqrt(np.mean(np.abs(U[lines]) ** 2))
        K = np.hstack([powers * U[lines, None] / scale, powers])
        values = np.linalg.lstsq(K, Y[lines], rcond=None)[0]
        left = np.sum(np.abs(Y[lines] - K @ values) ** 2) / (len(lines) - 2 * (order + 1))
        out[k] = values[0] / scale, left * np.linalg.inv(K.conj().T @ K)[0, 0].real / scale ** 2
    return out


def chirp(servomill, folder):
    """One sweep through a resonance, with noise: the local polynomial method takes it without a period."""
    rng = np.random.default_rng(3)
    t = np.arange(4000) * 1e-3
    u = np.sin(2 * np.pi * (5 * t + 0.5 * 50 * t ** 2))
    y = np.zeros_like(u)
    for n in range(2, len(u)):
        y[n] = 0.02 * u[n - 1] + 1.8 * y[n - 1] - 0.97 * y[n - 2]
    y += 1e-3 * rng.standard_normal(len(y))
    np.savetxt(folder / "chirp.csv", np.column_stack([t, u, y]), "%.17g", ",", header="time [s],u,y", comments="")
    out = folder / "chirp_response.csv"
    printed = run(servomill, "response", folder / "chirp.csv", "--input", "u", "--output", "y", "--f-min", 20, "--f-max", 150, "--table", out,
                  "--fit", "2/2+delay")
    found, wanted = np.loadtxt(out, delimiter=",", skiprows=1), local_polynomial(u, y)
    lines = np.rint(found[:, 0] * 4).astype(int)
    G, variance = (np.array([wanted[k][part] for k in lines]) for part in (0, 1))
    error = np.abs(found[:, 1] + 1j * found[:, 2] - G) / np.abs(G)
    print(f"chirp: {len(lines)} lines, greatest relative difference {error.max():.2g}")
    assert len(lines) > 400 and error.max() <= TOLERANCE
    assert np.allclose(found[:, 3], variance, rtol=1e-6)
    pole = np.log(np.roots([1, -1.8, 0.97])[0]) * 1000 / 2 / np.pi
    frequency, half_width = (float(x) for x in re.search(r"pole pair +([\d.]+) +([\d.]+)", printed).groups())
    assert abs(frequency - abs(pole)) < half_width + 0.01 * abs(pole), (frequency, half_width, abs(pole))


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
        chirp(servomill, folder)
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
