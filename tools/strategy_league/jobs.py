"""The data of the league, and the scenario of one run."""
import dataclasses
import pathlib
import tomllib

from command_line import InputError

HERE = pathlib.Path(__file__).resolve().parent
SCENARIOS = HERE.parents[1] / "scenarios"
KNOWLEDGE = ("exact", "errors identified", "errors and drives identified")


@dataclasses.dataclass(frozen=True)
class Job:
    name: str
    title: str
    machine: dict
    program: dict
    unkind: bool
    offset: str


@dataclasses.dataclass(frozen=True)
class Strategy:
    name: str
    text: str
    needs: str
    measures: str
    turns: bool

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
        self.strategies = [Strategy(name, one["text"], one["needs"], one.get("measures", ""), one.get("turns", False))
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
                   unkind, one.get("offset", ""))

    def tuning_job(self):
        program = {"title": "tuning", "text": self.tuning["text"], "sections": self.tuning["sections"]}
        return Job("tuning", "tuning program", self.machines["hsm"], program, True, "")

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
                  'relative_to = "machine"', machine["identified"], "[[case]]", 'name = "case"',
                  self._strategy(job, knowledge, strategy, cutoff)]
        return "\n".join(parts) + "\n"

    def _strategy(self, job, knowledge, strategy, cutoff):
        machine, five_axes = job.machine, "five axes" in job.program["title"]
        turns = 'axes = "all"' if strategy.turns and five_axes else ""
        drives_differ = knowledge == KNOWLEDGE[2]
        known = ""
        if drives_differ:
            known = f"machine = {machine['known_unkind' if job.unkind else 'known_clean']}"
        text = strategy.text if "{turns}" in strategy.text else strategy.text + "{turns}\n"
        for word, value in (("{model}", "machine" if knowledge == KNOWLEDGE[0] else "identified"), ("{known}", known),
                            ("{gains}", self._gains(job, drives_differ)), ("{cutoff}", str(cutoff)), ("{turns}", turns)):
            text = text.replace(word, value)
        return text

    @staticmethod
    def _gains(job, drives_differ):
        if not job.unkind:
            return ""
        return job.machine["gains_identified" if drives_differ else "gains"]
