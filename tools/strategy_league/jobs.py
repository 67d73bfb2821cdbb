"""The data of the league, and the scenario of one run."""
import dataclasses
import pathlib
import re
import tomllib
import zlib

import numpy as np

from command_line import InputError

HERE = pathlib.Path(__file__).resolve().parent
SCENARIOS = HERE.parents[1] / "scenarios"
KNOWLEDGE = ("exact", "errors identified", "errors and drives identified")
DRAW = "draw "   # before its number: knowledge that is drawn


def draws(samples):
    return [f"{DRAW}{number}" for number in range(1, samples + 1)]


DRIVES, ERRORS = 0, 1   # streams of random numbers


def generator(knowledge, machine, stream):
    """The random numbers of a draw: the same for every strategy and program on a machine."""
    return np.random.default_rng([int(knowledge.removeprefix(DRAW)), zlib.crc32(machine["title"].encode()), stream])


@dataclasses.dataclass(frozen=True)
class Job:
    name: str
    title: str
    machine: dict
    program: dict
    unkind: bool
    offset: str
    strategies: tuple   # names of those that run; empty: all that are not for heat alone


@dataclasses.dataclass(frozen=True)
class Strategy:
    name: str
    text: str
    needs: str
    measures: str
    turns: bool
    heat: bool = False   # corrects nothing else

    def knows(self):
        """True if what it does depends on what it knows."""
        return any(word in self.text for word in ("{model}", "{known}", "{gains}"))

    def is_tuned(self):
        return "{cutoff}" in self.text


class League:
    def __init__(self, path=HERE / "league.toml"):
        with open(path, "rb") as file:
            data = tomllib.load(file)
        self.machines, self.programs = data["machine"], data["program"]
        self.tuning = data["tuning"]
        self.strategies = [Strategy(name, one["text"], one["needs"], one.get("measures", ""), one.get("turns", False),
                                    one.get("heat", False))
                           for name, one in data["strategy"].items()]
        self.jobs = [self._job(one) for one in data["job"]]

    def _job(self, one):
        for key, known in (("machine", self.machines), ("program", self.programs)):
            if one[key] not in known:
                raise InputError(f"league.toml: error: [[job]] {key} = \"{one[key]}\"; known are {', '.join(known)}")
        machine, program = self.machines[one["machine"]], self.programs[one["program"]]
        unkind = one.get("unkind", False)
        kind = "unkind" if unkind else "clean"
        return Job(f"{one['machine']}-{kind}-{one['program']}", f"{program['title']}; {machine['title']}, {kind}", machine, program,
                   unkind, one.get("offset", ""), tuple(one.get("strategies", ())))

    def strategies_of(self, job):
        """Those that run a job."""
        return [one for one in self.strategies if (one.name in job.strategies if job.strategies else not one.heat)]

    def tuning_job(self):
        program = {"title": "tuning", "text": self.tuning["text"], "sections": self.tuning["sections"]}
        return Job("tuning", "tuning program", self.machines["hsm"], program, True, "", ())

    def scenario(self, job, knowledge, strategy, cutoff, made):
        """Text of the scenario of one run; `made` is the folder with the made programs."""
        machine = job.machine
        parts = ['title = "league"', 'source = "league.toml"', f'machine = "{SCENARIOS / machine["file"]}"',
                 'machine_errors = "machine"', "[machine_override]"]
        if job.unkind:
            parts.append(machine["unkind"])
        parts += ["[program]", job.program["text"].replace('"programs/', f'"{SCENARIOS}/programs/')]
        if "made" in job.program:
            parts.append(f'file = "{made / job.program["made"]}.ngc"')
        if job.offset:
            parts += [f"work_offset = {{ {job.offset} }}", "start = { Z_mm = 20.0 }"]
        parts += ["[record]", "period_ms = 1.0", "[errors.machine]", machine["errors"], "[errors.identified]",
                  'relative_to = "machine"', residual_errors(machine, knowledge), "[[case]]", 'name = "case"',
                  self._strategy(job, knowledge, strategy, cutoff).replace('"machines/', f'"{SCENARIOS}/machines/'), job.program.get("day", "")]
        return "\n".join(parts) + "\n"

    def _strategy(self, job, knowledge, strategy, cutoff):
        five_axes = "five axes" in job.program["title"]
        turns = 'axes = "all"' if strategy.turns and five_axes else ""
        drives = known_drives(job, knowledge)
        known = f"machine = {inline(nested(drives))}" if drives else ""
        text = strategy.text if "{turns}" in strategy.text else strategy.text + "{turns}\n"
        for word, value in (("{model}", "machine" if knowledge == KNOWLEDGE[0] else "identified"), ("{known}", known),
                            ("{gains}", gains(job, drives)), ("{cutoff}", str(cutoff)), ("{turns}", turns)):
            text = text.replace(word, value)
        return text


def known_drives(job, knowledge):
    """{key: value as TOML} of what is known wrongly of drives, structure and heat; empty: it is known exactly."""
    if knowledge in KNOWLEDGE[:2]:
        return {}
    data = job.machine["drives"] | (job.machine.get("unkind_drives", {}) if job.unkind else {})
    deviates = {}
    if knowledge.startswith(DRAW):
        random = generator(knowledge, job.machine, DRIVES)
        for key, one in data.items():
            deviates.setdefault(one.get("group", key), random.standard_normal())
    out = {}
    for key, one in data.items():
        share = one["off"] * deviates.get(one.get("group", key), 1.0)
        value = f"{one['value'] * (1.0 + share):.6g}"
        out[key] = f'"{value} {one["unit"]}"' if "unit" in one else value
    return out


def residual_errors(machine, knowledge):
    """Errors that a calibration leaves; of a draw each number of them times a normal deviate."""
    if not knowledge.startswith(DRAW):
        return machine["identified"]
    random = generator(knowledge, machine, ERRORS)

    def drawn(key, value):
        if isinstance(value, dict):
            return {name: drawn(name, one) for name, one in value.items()}
        if key.startswith(("period", "phase")):
            return repr(value)
        number, _, unit = str(value).partition(" ")
        number = f"{float(number) * random.standard_normal():.6g}"
        return f'"{number} {unit}"' if unit else number

    errors = tomllib.loads(machine["identified"])
    return "\n".join(f"{name} = {inline(drawn(name, value))}" for name, value in errors.items()) + "\n"


def gains(job, drives):
    """Keys of the strategy inertia: the structure as it is known."""
    if not job.unkind:
        return ""
    lines = []
    for key, one in job.machine["unkind_drives"].items():
        found = re.fullmatch(r"inertial_deflection\.(.)\1\.(gain_um_per_m_s2|frequency_Hz)", key)
        if found:
            axis, what = found.groups()
            name = f"{axis}{axis}_um_per_m_s2" if what.startswith("gain") else f"{axis}_frequency_Hz"
            lines.append(f"{name} = {drives.get(key, one['value'])}")
    lines += [f"{axis}_damping = {value}" for axis, value in job.machine["damping"].items()]
    return "\n".join(lines)


def nested(values):
    """Tables of dotted keys."""
    out = {}
    for key, value in values.items():
        *path, last = key.split(".")
        table = out
        for name in path:
            table = table.setdefault(name, {})
        table[last] = value
    return out


def inline(value):
    """A TOML value of tables whose leaves are written already."""
    if not isinstance(value, dict):
        return value
    return "{ " + ", ".join(f"{key} = {inline(one)}" for key, one in value.items()) + " }"
