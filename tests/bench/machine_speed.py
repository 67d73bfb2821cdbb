#!/usr/bin/python3
"""Speed of experiment 1 of paper [G] with modes of the inertia, a bed and structural modes, as a share of that without.

    machine_speed.py SERVOMILL [ROUNDS]

Each round runs the scenario without and with them, one after the other on one thread; the median of the rounds is printed, of
processor time, on which other work of the computer has little effect.
"""
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
SCENARIO = ROOT / "scenarios" / "guevel2025" / "experiment1.toml"
ROUNDS = 7
WITH = [
    f"machine={ROOT}/scenarios/machines/hsm600u_inertia.toml",
    'machine_override.axis.X.machine_bed={ mass = "5500 kg", frequency_Hz = 18.0, damping = 0.04 }',
    'machine_override.axis.Y.machine_bed={ mass = "5500 kg", frequency_Hz = 22.0, damping = 0.04 }',
    'machine_override.structural_mode=[{ direction = [1, 0, 0], stiffness = "40 N/um", frequency_Hz = 55.0, damping = 0.05 }, '
    '{ direction = [0, 1, 0], stiffness = "50 N/um", frequency_Hz = 45.0, damping = 0.04 }]',
]


def seconds(servomill, folder, changes):
    """Processor time of a run, s: of planning, simulation, comparison and file."""
    settings = [word for change in changes for word in ("--set", change)]
    process = subprocess.Popen([servomill, "run", SCENARIO, "-j", "1", "-q", "-f", "-o", folder / "out.h5", *settings],
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    _, status, used = os.wait4(process.pid, 0)
    if os.waitstatus_to_exitcode(status) != 0:
        sys.exit("a run failed: " + " ".join(settings))
    return used.ru_utime + used.ru_stime


def main():
    servomill = os.path.abspath(sys.argv[1])
    rounds = int(sys.argv[2]) if len(sys.argv) > 2 else ROUNDS
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        pairs = [(seconds(servomill, folder, []), seconds(servomill, folder, WITH)) for _ in range(rounds)]
    shares = sorted(100.0 * without / with_them for without, with_them in pairs)
    print(f"{statistics.median(without for without, _ in pairs):.2f} s without, "
          f"{statistics.median(with_them for _, with_them in pairs):.2f} s with modes, bed and structural modes: "
          f"{statistics.median(shares):.0f} % of the speed without ({shares[0]:.0f} to {shares[-1]:.0f} % in {rounds} rounds)")
    return 0


if __name__ == "__main__":
    sys.exit(main())
