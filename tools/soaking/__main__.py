"""Runs laws on programs and scenarios at random, and fuzz targets between them, for hours (tools/soak).

    python3 -m soaking HOURS --program SERVOMILL --sanitized SERVOMILL [--fuzz TOOL] [-o FOLDER] [--seed N] [--law NAME]...
"""
import argparse
import itertools
import pathlib
import subprocess
import sys
import time

import rs274

from . import generate, laws

ROOT = pathlib.Path(__file__).resolve().parents[2]
LARGEST = 20_000  # bytes of a program that is mutated
FUZZ_SLICE = 120  # s of each fuzz target, between rounds of the laws
FUZZ_EVERY = 600  # s


class Soak:
    """What the laws need, and what they have found."""

    def __init__(self, program, sanitized):
        self.program, self.sanitized = pathlib.Path(program).resolve(), pathlib.Path(sanitized).resolve()
        printed = subprocess.run([self.program, "list", "keys", "--json"], capture_output=True, text=True, check=True).stdout
        self.keys = generate.keys_of(printed)
        self.machine = ROOT / "scenarios" / "machines" / "hsm600u.toml"
        self.conformance = ROOT / "tools" / "conformance"
        files = [*ROOT.glob("scenarios/programs/*.ngc"), *ROOT.glob("tests/fuzz/corpus/fuzz_gcode/*")]
        self.programs = [path.read_text(encoding="utf-8", errors="replace") for path in sorted(files) if path.stat().st_size < LARGEST]


class Report:
    """A line for each law: how often it held, and where the seeds at fault lie."""

    def __init__(self, folder, names):
        self.folder, self.held, self.findings = folder, dict.fromkeys(names, 0), []
        self.begin = time.monotonic()

    def add(self, name, seed, finding):
        if finding is None:
            self.held[name] += 1
            return
        self.findings.append((name, seed))
        print(f"{name}, seed {seed}:\n{finding}\n", flush=True)

    def write(self):
        hours = (time.monotonic() - self.begin) / 3600
        lines = [f"# Soak, {hours:.2f} h", "", "| law | held | broken |", "|---|---|---|"]
        for name, held in self.held.items():
            lines.append(f"| {name} | {held} | {sum(one == name for one, _ in self.findings)} |")
        lines += ["", *(f"- {name}, seed {seed}: {self.folder / 'found' / f'{name}-{seed}'}" for name, seed in self.findings)]
        text = "\n".join(lines) + "\n"
        (self.folder / "report.md").write_text(text, encoding="utf-8")
        return text


def fuzz(tool, report, targets=itertools.count()):
    """The next fuzz target for a while."""
    listed = subprocess.run(["sed", "-n", r"s/^all=(\(.*\))$/\1/p", tool], capture_output=True, text=True, check=True).stdout.split()
    target = listed[next(targets) % len(listed)]
    done = subprocess.run([tool, target, str(FUZZ_SLICE)], capture_output=True, text=True, check=False)
    name = f"fuzz: {target}"
    report.held.setdefault(name, 0)
    report.add(name, "-", None if done.returncode == 0 else done.stdout[-3000:] + done.stderr[-3000:])


def checkable(names):
    """The laws, without those that need a program which is not installed."""
    try:
        rs274.find()
        return names
    except rs274.Missing as fault:
        print(f"not checked: moves_are_those_of_linuxcnc: {fault}")
        return [name for name in names if name != "moves_are_those_of_linuxcnc"]


def arguments():
    parser = argparse.ArgumentParser(prog="tools/soak", description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("hours", type=float, help="how long, in hours")
    parser.add_argument("--program", required=True, help="the program as it is built for use")
    parser.add_argument("--sanitized", required=True, help="the program with sanitizers")
    parser.add_argument("--fuzz", help="tools/fuzz: runs its targets in between; without it none")
    parser.add_argument("-o", "--output", type=pathlib.Path, default=pathlib.Path("out/soak"), help="folder of report and findings")
    parser.add_argument("--seed", type=int, help="first seed (default: the time); with --law: the one to see again")
    parser.add_argument("--law", action="append", choices=laws.LAWS, help="only this one; again for others")
    return parser.parse_args()


def main():
    options = arguments()
    soak = Soak(options.program, options.sanitized)
    names = checkable(options.law or list(laws.LAWS))
    options.output.mkdir(parents=True, exist_ok=True)
    report = Report(options.output, names)
    end = time.monotonic() + 3600 * options.hours
    next_fuzz = time.monotonic()
    for seed in itertools.count(options.seed if options.seed is not None else int(time.time())):
        for name in names:
            report.add(name, seed, laws.check(name, seed, soak, (options.output / "found" / f"{name}-{seed}").resolve()))
        if options.fuzz and time.monotonic() >= next_fuzz:
            fuzz(options.fuzz, report)
            next_fuzz = time.monotonic() + FUZZ_EVERY
        text = report.write()
        if time.monotonic() >= end:
            break
    print(text)
    return 1 if report.findings else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        sys.exit(130)
