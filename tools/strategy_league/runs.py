"""Runs of the league: each is a scenario of one case, measured and kept as a line of JSON."""
import concurrent.futures
import hashlib
import json
import os
import pathlib
import re
import subprocess

import h5py
import numpy as np

from strategy_league import jobs, programs


def digest(data):
    return hashlib.sha256(data).hexdigest()


def make_programs(folder):
    folder.mkdir(parents=True, exist_ok=True)
    for name, make in programs.MADE.items():
        (folder / f"{name}.ngc").write_text(make(), encoding="ascii")


def wanted(league, only=""):
    """(job, knowledge, strategy) of every run; what knows nothing runs once."""
    for job in league.jobs:
        if only not in job.name:
            continue
        for strategy in league.strategies_of(job):
            for knowledge in jobs.KNOWLEDGE if strategy.knows() else jobs.KNOWLEDGE[:1]:
                yield job, knowledge, strategy


def drawn(league, samples, only=""):
    """(job, knowledge, strategy) of every run of a Monte Carlo: those that know something, draw after draw."""
    for knowledge in jobs.draws(samples):
        for job in league.jobs:
            if only not in job.name:
                continue
            for strategy in league.strategies_of(job):
                if strategy.knows():
                    yield job, knowledge, strategy


class Runner:
    def __init__(self, league, servomill, version, folder, tell):
        self.league, self.servomill, self.version, self.folder, self.tell = league, servomill, version, folder, tell
        self.made = (folder / "programs").resolve()
        self.binary = digest(pathlib.Path(servomill).read_bytes()) if pathlib.Path(servomill).exists() else version
        self.results = folder / "runs"
        self.cutoffs = {}   # Hz, of the strategies that are tuned

    def tune(self, strategies):
        """The cutoff of each tuned strategy of these: that with the smallest rms of the tip on the tuning program, known as drives are."""
        job = self.league.tuning_job()
        for strategy in self.league.strategies:
            if not strategy.is_tuned() or strategy not in strategies:
                continue
            found = {cutoff: self.one(job, jobs.KNOWLEDGE[2], strategy, cutoff) for cutoff in self.league.tuning["cutoffs_Hz"]}
            good = {cutoff: one["tip_rms"] for cutoff, one in found.items() if "refused" not in one}
            self.cutoffs[strategy.name] = min(good, key=good.get) if good else self.league.tuning["cutoffs_Hz"][0]
            self.tell(f"  {strategy.name}: {self.cutoffs[strategy.name]} Hz of "
                      + ", ".join(f"{c}: {v:.3g} um" for c, v in good.items()))

    def run_all(self, chosen):
        done = 0
        with concurrent.futures.ThreadPoolExecutor(max_workers=os.cpu_count()) as pool:
            runs = {pool.submit(self.one, job, knowledge, strategy, self.cutoffs.get(strategy.name, 0)): (job, knowledge, strategy)
                    for job, knowledge, strategy in chosen}
            for future in concurrent.futures.as_completed(runs):
                future.result()
                done += 1
                if done % 20 == 0 or done == len(runs):
                    self.tell(f"  {done} of {len(runs)} runs")

    def path(self, job, knowledge, strategy, cutoff):
        tuned = f"-{cutoff}Hz" if strategy.is_tuned() else ""
        return self.results / job.name / f"{strategy.name}{tuned}-{knowledge.replace(' ', '_')}.json"

    def _program(self, job):
        """Text of the program of a job."""
        if "made" in job.program:
            return (self.made / f"{job.program['made']}.ngc").read_text(encoding="ascii")
        name = re.search(r'file = "(.*?)"', job.program["text"])[1]
        return (jobs.SCENARIOS / name).read_text(encoding="utf-8")

    def one(self, job, knowledge, strategy, cutoff):
        """What a run shows; taken from its file if that holds the same scenario, run by the same program."""
        text = self.league.scenario(job, knowledge, strategy, cutoff, self.made)
        key = digest(f"{self.version}\n{self.binary}\n{text}\n{self._program(job)}".encode())
        path = self.path(job, knowledge, strategy, cutoff)
        if path.exists():
            kept = json.loads(path.read_text(encoding="utf-8"))
            if kept.get("key") == key:
                return kept
        path.parent.mkdir(parents=True, exist_ok=True)
        scenario, result = path.with_suffix(".toml"), path.with_suffix(".h5")
        scenario.write_text(text, encoding="utf-8")
        done = subprocess.run([self.servomill, "run", scenario, "-o", result, "--force", "-q", "-j", "1"], capture_output=True,
                              text=True)
        found = {"key": key, "job": job.name, "knowledge": knowledge, "strategy": strategy.name, "cutoff_Hz": cutoff}
        if done.returncode == 0:
            found |= measured(result, job.program["sections"])
        elif done.returncode != 2:
            raise SystemError(f"{scenario}: servomill ended with {done.returncode}: {done.stderr.strip()[-300:]}")
        else:
            lines = [line for line in done.stderr.strip().splitlines() if "warning" not in line]
            found["refused"] = lines[-1].split("error: ")[-1] if lines else f"ended with {done.returncode}"
        result.unlink(missing_ok=True)
        partial = path.with_suffix(".json.partial")
        partial.write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")
        partial.replace(path)
        return found


def measured(path, sections):
    """Figures of one case, of its rows of feed motion in these sections."""
    with h5py.File(path) as file:
        case = file["cases/case"]
        if "day" in case:
            return measured_of_day(case)
        servo = case["servo"]
        names = case.attrs["sections"]
        names = (names.decode() if isinstance(names, bytes) else str(names)).split("\n")
        judged = [names.index(name) for name in sections if name in names]
        rows = (servo["rapid"][:] == 0) & np.isin(servo["section"][:].astype(int), judged)
        tip = np.linalg.norm(servo["tool_deviation"][:][rows], axis=1)
        across = np.linalg.norm(np.cross(servo["tool_axis_nominal"][:][rows], servo["tool_axis_true"][:][rows]), axis=1)
        contour = servo["contour_error"][:][rows]
        time = servo["time"][:]
        jerk = np.zeros(len(time))
        jerk[3:] = np.linalg.norm(np.diff(servo["cmd_linear"][:], 3, axis=0), axis=1) * 1e-3 / (time[1] - time[0])**3
        current = servo["current_linear"][:][rows]
        return {"tip_rms": float(np.sqrt(np.mean(tip**2))), "tip_99": float(np.percentile(tip, 99)), "tip_max": float(tip.max()),
                "axis_rms": float(np.sqrt(np.mean(across**2)) * 1e6), "contour_max": float(contour.max()),
                "jerk_rms": float(np.sqrt(np.mean(jerk[rows]**2))),
                "current_rms": float(np.sqrt(np.mean(np.sum(current**2, axis=1)))),
                "cycle_time": float(case.attrs["duration_s"]), "blocks": float(case.attrs["blocks"]), "limits": demanded(case["demands"])}


def demanded(kinds):
    """Largest velocity, acceleration or jerk that path and offset together ask an axis for, % of its limit."""
    return max(100.0 * float(np.max(of[what][:] / of[f"{what}_limit"][:])) for of in kinds.values() for what in ("velocity", "acceleration", "jerk"))


def measured_of_day(case):
    """Figures of the parts of a day; the largest of each for the 99 %."""
    rms, largest = (case["day/cycles"][name][:] for name in ("rms", "largest"))
    return {"tip_rms": float(np.sqrt(np.mean(rms**2))), "tip_99": float(np.percentile(largest, 99)), "tip_max": float(largest.max()),
            "cycle_time": float(case.attrs["duration_s"]), "blocks": float(case.attrs["blocks"]), "limits": demanded(case["demands"])}
