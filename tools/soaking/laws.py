"""Laws that programs and scenarios at random must keep. A law raises Found with what breaks it."""
import pathlib
import random
import re
import shlex
import shutil
import signal
import subprocess
import time

import h5py
import numpy

from . import generate

PATIENCE = 300  # s of the wall, of one command on a busy machine
SANITIZER = re.compile(r"ERROR: \w+Sanitizer|runtime error:|SUMMARY: \w+Sanitizer")
FAULT = re.compile(r"^[^\n]+: error: ", re.MULTILINE)
AGREE = 20e-9  # m, between the integrators; whole runs agree to 3 nm
READERS = ("any", "linuxcnc", "fanuc", "haas", "mach", "grbl", "heidenhain", "siemens")


class Found(Exception):
    """A broken law, with the commands that show it."""


class Commands:
    """Runs one program in a folder, and keeps what was run."""

    def __init__(self, program, folder):
        self.program, self.folder, self.lines = pathlib.Path(program).resolve(), folder, []

    def start(self, *words):
        words = [str(word) for word in (self.program, *words)]
        self.lines.append(shlex.join(words))
        return subprocess.Popen(words, cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, errors="replace")

    def run(self, *words, allowed=(0, 1, 2)):
        process = self.start(*words)
        try:
            out, err = process.communicate(timeout=PATIENCE)
        except subprocess.TimeoutExpired:
            process.kill()
            process.communicate()
            self.fail(f"does not end within {PATIENCE} s")
        if process.returncode < 0:
            self.fail(f"ended by signal {-process.returncode}\n{err[-3000:]}")
        if SANITIZER.search(err):
            self.fail(err[-6000:])
        if process.returncode not in allowed:
            self.fail(f"exit status {process.returncode}, allowed are {allowed}\n{err[-3000:]}")
        if process.returncode == 2 and not FAULT.search(err):
            self.fail(f"exit status 2 without 'FILE: error: ...'\n{err[-3000:]}")
        return process.returncode, out, err

    def fail(self, what):
        raise Found("\n".join(["commands:", *self.lines, "", what]))


def datasets(commands, path):
    """Every dataset of a result file by each of its names; a file that is missing or damaged is a finding."""
    out = {}

    def take(group, above):
        for name, one in group.items():
            if isinstance(one, h5py.Dataset):
                out[above + name] = one[()]
            else:
                take(one, f"{above}{name}/")

    try:
        with h5py.File(path) as file:
            take(file, "")
    except OSError as error:
        commands.fail(f"{path.name} cannot be read: {error}")
    return out


def same_bits(commands, first, second, what):
    one, other = datasets(commands, first), datasets(commands, second)
    different = set(one) ^ set(other)
    different |= {name for name in set(one) & set(other) if numpy.asarray(one[name]).tobytes() != numpy.asarray(other[name]).tobytes()}
    if different:
        commands.fail(f"{what}: other bits in {', '.join(sorted(different)[:8])}")


# --------------------------------------------------------------------------------------------------------------- laws
def accepted(rng, soak, commands, smooth=False):
    """A scenario at random that is not refused, in the folder: what faults name is taken out until it is accepted."""
    scenario = generate.scenario(rng, soak.keys, smooth)
    for _ in range(40):
        scenario.write(commands.folder, soak.machine)
        status, _, err = commands.run("check", "scenario.toml")
        if status == 0:
            status, _, err = commands.run("run", "scenario.toml", "-o", "out.h5", "-q", "--force")
        if status != 2:
            return scenario, status
        commands.lines.clear()
        scenario = scenario.without(rng, err)
    commands.fail("is refused with nothing but its program:\n" + err)


def scenarios_end(rng, soak, folder):
    """Any scenario ends with a status that says why, and without a word of the sanitizers."""
    accepted(rng, soak, Commands(soak.sanitized, folder))


def threads_do_not_matter(rng, soak, folder):
    """One thread and two give the same bits."""
    commands = Commands(soak.program, folder)
    accepted(rng, soak, commands)
    for n in (1, 2):
        commands.run("run", "scenario.toml", "-q", "-j", n, "-o", f"{n}.h5")
    same_bits(commands, folder / "1.h5", folder / "2.h5", "one thread and two")


def killed_runs_start_again(rng, soak, folder):
    """A killed run leaves no result under its name; started again it gives the bits of one that was not killed."""
    commands = Commands(soak.program, folder)
    accepted(rng, soak, commands)
    begin = time.monotonic()
    commands.run("run", "scenario.toml", "-q", "-o", "whole.h5")
    process = commands.start("run", "scenario.toml", "-q", "-o", "killed.h5")
    time.sleep(rng.uniform(0, time.monotonic() - begin))
    process.send_signal(signal.SIGKILL)
    process.communicate()
    if process.returncode == -signal.SIGKILL and (folder / "killed.h5").exists():
        # it was complete before the signal came
        same_bits(commands, folder / "whole.h5", folder / "killed.h5", "a result that was there when the run was killed")
    if (folder / "killed.h5.partial").exists():
        commands.run("compare", "killed.h5.partial", allowed=(0, 1, 2))
    commands.run("run", "scenario.toml", "-q", "-o", "killed.h5", "--force")
    same_bits(commands, folder / "whole.h5", folder / "killed.h5", "a run that was killed and started again")


SWEPT = ("program.feed_override", [0.5, 0.7, 0.9, 1.0])


def killed_sweeps_go_on(rng, soak, folder):
    """A killed sweep goes on to the bits of one that was not killed, and its points are those of runs."""
    commands = Commands(soak.program, folder)
    scenario, _ = accepted(rng, soak, commands)
    key, values = SWEPT
    with open(folder / "scenario.toml", "a", encoding="utf-8") as file:
        file.write(f'\n[sweep]\n"{key}" = {values}\n')
    begin = time.monotonic()
    refused = commands.run("sweep", "scenario.toml", "-q", "-o", "whole.h5")[0] == 2

    def point(value):
        scenario.settings[key] = str(value)
        scenario.write(folder, soak.machine)
        return commands.run("run", "scenario.toml", "-q", "-o", "point.h5", "--force")[0]

    if refused:
        if 2 not in [point(value) for value in values]:
            commands.fail("a sweep is refused, none of its points is")
        return
    process = commands.start("sweep", "scenario.toml", "-q", "-o", "killed.h5")
    time.sleep(rng.uniform(0, time.monotonic() - begin))
    process.send_signal(signal.SIGKILL)
    process.communicate()
    finished = process.returncode != -signal.SIGKILL or (folder / "killed.h5").exists()
    commands.run("sweep", "scenario.toml", "-q", "-o", "killed.h5", *(["--force"] if finished else []), allowed=(0, 1))
    same_bits(commands, folder / "whole.h5", folder / "killed.h5", "a sweep that was killed and went on")
    at = rng.randrange(len(values))
    point(values[at])
    compare_point(commands, datasets(commands, folder / "whole.h5"), datasets(commands, folder / "point.h5"), at)


def compare_point(commands, sweep, run, at):
    """The contour error of a point and of its run."""
    alone = [run[name] for name in sorted(run) if re.fullmatch(r"comparison/\d+/value", name)]
    columns = [sweep[name] for name in sorted(sweep) if "contour_error" in name and numpy.ndim(sweep[name]) == 1]
    points = [column[at] for column in columns]
    if not columns or not numpy.array_equal(numpy.array(points), numpy.array(alone), equal_nan=True):
        commands.fail(f"point {at + 1} of the sweep: {points}; its run: {alone}")


def integrators_agree(rng, soak, folder):
    """Exact propagation and SUNDIALS at tight tolerance give the same path of drives that are linear."""
    commands = Commands(soak.program, folder)
    accepted(rng, soak, commands, smooth=True)
    commands.run("run", "scenario.toml", "-q", "-o", "cvode.h5", "--set", 'machine_override.integrator="cvode"', "--set", "machine_override.solver_tolerance_nm=0.002")
    exact, cvode = datasets(commands, folder / "out.h5"), datasets(commands, folder / "cvode.h5")
    for name in exact:
        if name.endswith("/servo/true_linear"):
            apart = 1e-3 * numpy.max(numpy.abs(exact[name] - cvode[name]), initial=0.0)
            if not apart <= AGREE:
                commands.fail(f"{name}: the integrators differ by {apart:.3g} m; at most {AGREE:g} m")


def programs_are_read_or_refused(rng, soak, folder):
    """Programs with parts exchanged are read or refused with a place, by every reader."""
    commands = Commands(soak.sanitized, folder)
    text = rng.choice(soak.programs) if soak.programs and rng.random() < 0.7 else generate.program(rng, 30)
    (folder / "program.ngc").write_text(generate.mutated(rng, text), encoding="utf-8")
    for reader in rng.sample(READERS, 2):
        commands.run("check", "program.ngc", *([] if reader == "any" else ["--reader", reader]))
        commands.lines.clear()


def moves_are_those_of_linuxcnc(rng, soak, folder):
    """Random programs have the moves of LinuxCNC's interpreter."""
    for n in range(20):
        (folder / f"{n}.ngc").write_text(generate.program(rng, rng.randint(5, 40)), encoding="utf-8")
    done = subprocess.run([soak.conformance, folder, "--quiet", "--command", f"{soak.program} canon"], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise Found(f"{soak.conformance} {folder}: exit status {done.returncode}\n{done.stdout[-3000:]}{done.stderr[-1000:]}")


LAWS = {
    "scenarios_end": scenarios_end,
    "programs_are_read_or_refused": programs_are_read_or_refused,
    "threads_do_not_matter": threads_do_not_matter,
    "killed_runs_start_again": killed_runs_start_again,
    "killed_sweeps_go_on": killed_sweeps_go_on,
    "integrators_agree": integrators_agree,
    "moves_are_those_of_linuxcnc": moves_are_those_of_linuxcnc,
}


def check(name, seed, soak, folder):
    """The finding of one law for one seed, or None. The folder stays where there is one."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    try:
        LAWS[name](random.Random(f"{name} {seed}"), soak, folder)
    except Found as found:
        (folder / "finding.txt").write_text(f"{name}, seed {seed}\n{found}\n", encoding="utf-8")
        return str(found)
    shutil.rmtree(folder)
    return None
