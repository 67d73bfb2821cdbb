"""Runs programs on LinuxCNC without hardware and compares its planner with that of servomill time.

    tools/linuxcnc_times [--servomill build/dev/servomill] [--only TEXT] [--logs FOLDER]

The machine of both is tools/linuxcnc_planner/mill.ini: LinuxCNC runs it with its setpoints fed back and recorded at each servo
period, servomill reads it with `machine from`. Printed are the times from the first to the last change of a setpoint, the
ratio, and of LinuxCNC's setpoints, as `servomill limits` finds it, the largest factor over the limit of acceleration of an axis and the largest
distance from the path or between a corner and the motion.
Needs Debian's linuxcnc-uspace (2.9); as root it runs LinuxCNC as user nobody. Takes some minutes, as LinuxCNC runs in real time.
Exit status: 0 done, 2 the input is wrong or LinuxCNC is not there, 3 LinuxCNC fails.
"""
import argparse
import json
import os
import pathlib
import subprocess
import sys
import tempfile

from linuxcnc_planner.control import Control, ControlError
from linuxcnc_planner.programs import PROGRAMS

PERIOD = 1e-3     # s, of the servo
PATIENCE = 120.0  # s, for a program
CHANNELS = ("--period", "1 ms", "--channel", "X=column 2 [mm]", "--channel", "Y=column 3 [mm]", "--channel", "Z=column 4 [mm]", "--line", "column 5")


def motion_time(log):
    """Time (s) from the first to the last change of a position."""
    moving, before = [], None
    for line in log.read_text(encoding="utf-8").splitlines():
        words = line.split()
        if len(words) != 5:  # overrun: samples were lost before recording
            continue
        if before is not None and words[1:4] != before:
            moving.append(int(words[0]))
        before = words[1:4]
    return (moving[-1] - moving[0] + 1) * PERIOD if moving else 0.0


def planned_time(servomill, program, machine):
    done = subprocess.run([servomill, "time", str(program), "--machine", str(machine), "--start", "X=0,Y=0,Z=0", "--json"], capture_output=True,
                          text=True, check=True)
    return json.loads(done.stdout)["time_s"]


def findings(servomill, log, machine, program):
    """Largest factor of an acceleration, largest distance from the path and from a corner (um)."""
    done = subprocess.run([servomill, "limits", str(log), "--machine", str(machine), "--json", *CHANNELS, "--program", str(program),
                           "--work-offset", "X=0,Y=0,Z=0", "--top", "1000000"], capture_output=True, text=True, check=False)
    if done.returncode > 1:
        raise ControlError(done.stderr)
    found = json.loads(done.stdout)
    acceleration = max(one["factor"] for one in found["results"] if one["quantity"] == "acceleration")
    corner = max((line["corner_mm"] or 0.0 for line in found["path"]["lines"]), default=0.0)
    return acceleration, 1e3 * found["path"]["deviation_mm"], 1e3 * corner


def row(control, servomill, name, machine, logs):
    program = control.folder / "program.ngc"
    program.write_text(PROGRAMS[name], encoding="utf-8")
    os.chmod(program, 0o644)
    log = logs / ("".join(c if c.isalnum() else "_" for c in name) + ".txt")
    control.run(program, log, PATIENCE)
    theirs, ours = motion_time(log), planned_time(servomill, program, machine)
    acceleration, path, corner = findings(servomill, log, machine, program)
    print(f"{name:<32} {theirs:10.3f} {ours:10.3f} {ours / theirs:7.3f} {acceleration:13.2f} {path:8.2f} {corner:9.2f}", flush=True)
    return theirs, ours


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--servomill", default="build/dev/servomill")
    parser.add_argument("--only", default="", help="only programs with this text in their names")
    parser.add_argument("--logs", type=pathlib.Path, help="keeps LinuxCNC's setpoints there")
    arguments = parser.parse_args()
    names = [name for name in PROGRAMS if arguments.only in name]
    if not names:
        parser.error(f"--only {arguments.only}: is in the name of no program")
    with tempfile.TemporaryDirectory() as temporary:
        os.chmod(temporary, 0o755)
        folder = pathlib.Path(temporary)
        logs = arguments.logs or folder
        logs.mkdir(parents=True, exist_ok=True)
        machine = folder / "mill.toml"
        try:
            with Control(folder) as control:
                subprocess.run([arguments.servomill, "machine", "from", str(folder / "mill.ini"), "-o", str(machine), "-q"], check=True)
                print(f"{'program':<32} {'LinuxCNC s':>10} {'servomill s':>10} {'ratio':>6} {'acceleration':>13} {'path um':>8} {'corner um':>9}\n{'-' * 95}")
                times = [row(control, arguments.servomill, name, machine, logs) for name in names]
        except (ControlError, OSError, subprocess.CalledProcessError) as error:
            print(error, file=sys.stderr)
            return 3
    theirs, ours = (sum(column) for column in zip(*times))
    print(f"{'-' * 95}\n{'all':<32} {theirs:10.3f} {ours:10.3f} {ours / theirs:7.3f}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
