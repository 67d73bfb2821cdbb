"""Runs the league of strategies and writes league.json, league.md and league.html.

Exit status: 0 written, 2 the command is wrong, 3 the system failed.
"""
import argparse
import json
import pathlib
import re
import subprocess
import sys

from command_line import InputError, run
from strategy_league import jobs, page, runs


def main(arguments):
    reader = argparse.ArgumentParser(prog="league", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    reader.add_argument("servomill", help="the program")
    reader.add_argument("-o", metavar="DIR", default="out/league", help="folder to write to (default: out/league)")
    reader.add_argument("--only", metavar="TEXT", default="", help="jobs whose name contains it")
    reader.add_argument("--samples", metavar="N", type=int, default=0, help="Monte Carlo: N draws of the knowledge as well")
    reader.add_argument("--shard", metavar="I/N", default="1/1",
                        help="the I-th of N parts of the draws, without a report; the next call without it takes all results in the folder")
    reader.add_argument("--report-only", action="store_true", help="take the results that lie in the folder")
    options = reader.parse_args(arguments)

    league = jobs.League()
    names = ", ".join(job.name for job in league.jobs)
    chosen = list(runs.wanted(league, options.only))
    if not chosen:
        raise InputError(f"league: error: --only {options.only}: no job has that in its name; jobs are {names}")
    draws, part = list(runs.drawn(league, options.samples, options.only)), _shard(options)
    folder = pathlib.Path(options.o)
    folder.mkdir(parents=True, exist_ok=True)
    version = _version(options.servomill)
    runner = runs.Runner(league, options.servomill, version, folder, tell)
    if options.report_only:
        results, cutoffs = kept(folder)
    else:
        runs.make_programs(runner.made)
        tell("Tuning")
        runner.tune({one[2] for one in chosen + draws})
        if part is not None:
            chosen, draws = [], draws[part]
        tell(f"Running {len(chosen) + len(draws)} times")
        runner.run_all(chosen + draws)
        if part is not None:
            tell(f"{len(draws)} draws are in {runner.results}")
            return 0
        cutoffs = runner.cutoffs
        results = [runner.one(*one, cutoffs.get(one[2].name, 0)) for one in chosen + draws]
        (folder / "league.json").write_text(json.dumps({"version": version, "cutoffs_Hz": cutoffs, "results": results}, indent=1) + "\n",
                                            encoding="utf-8")
    table = page.Table(league, results)
    for name, text in (("league.md", page.markdown(table, cutoffs, version)), ("league.html", page.page(table, cutoffs, version))):
        (folder / name).write_text(text, encoding="utf-8")
    refused = [one for one in results if "refused" in one]
    tell(f"{len(results)} results, {len(refused)} refused; written to {folder / 'league.md'} and {folder / 'league.html'}")
    return 0


def _shard(options):
    """The slice of the draws that --shard names; None: all of them, with the rest."""
    found = re.fullmatch(r"([1-9]\d*)/([1-9]\d*)", options.shard)
    number, parts = (int(one) for one in found.groups()) if found else (0, 0)
    if not 1 <= number <= parts:
        raise InputError(f"league: error: --shard {options.shard}: must be I/N with 1 <= I <= N")
    if options.samples < 0:
        raise InputError(f"league: error: --samples {options.samples}: must be >= 0")
    if parts == 1:
        return None
    if options.samples == 0:
        raise InputError("league: error: --shard: needs --samples, whose draws it divides")
    return slice(number - 1, None, parts)


def kept(folder):
    try:
        data = json.loads((folder / "league.json").read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise InputError(f"league: error: {folder / 'league.json'} does not exist; run without --report-only first") from None
    return data["results"], data["cutoffs_Hz"]


def tell(text):
    print(text, flush=True)


def _version(servomill):
    try:
        done = subprocess.run([servomill, "--version"], capture_output=True, text=True)
    except FileNotFoundError:
        raise InputError(f"league: error: {servomill} does not exist") from None
    return done.stdout.strip().removeprefix("servomill ") if done.returncode == 0 else ""


if __name__ == "__main__":
    sys.exit(run(main, sys.argv[1:]))
