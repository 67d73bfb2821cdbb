#!/usr/bin/python3
"""tools/league: scenarios hold what the data say, results are kept and taken again, refusals are shown, choices and fronts follow
from the numbers. Usage: league_test.py SERVOMILL"""
import json
import pathlib
import sys
import tempfile
import tomllib
import unittest

import numpy as np

TOOLS = pathlib.Path(__file__).resolve().parents[2] / "tools"
sys.path.insert(0, str(TOOLS))

from command_line import InputError  # noqa: E402
from strategy_league import jobs, page, programs, runs  # noqa: E402

SERVOMILL = sys.argv.pop() if len(sys.argv) > 1 else "servomill"


def small():
    """The league, one short job and three strategies of it."""
    league = jobs.League()
    league.programs["line"] = {"title": "line", "made": "line", "text": "", "sections": ["line"]}
    league.jobs = [league._job({"machine": "hsm", "program": "line", "unkind": True})]
    league.strategies = [one for one in league.strategies if one.name in ("none", "gcode", "precompensation")]
    return league


def runner(league, folder, version="1"):
    one = runs.Runner(league, SERVOMILL, version, pathlib.Path(folder), lambda text: None)
    one.made.mkdir(parents=True, exist_ok=True)
    (one.made / "line.ngc").write_text("G21 G90 G94\nG0 X1\n(MSG, line)\nG1 X12 F3000\n(MSG, end)\nM30\n", encoding="ascii")
    return one


class Data(unittest.TestCase):
    def test_it_is_large_enough(self):
        league = jobs.League()
        self.assertGreaterEqual(len(league.strategies), 10)
        self.assertGreaterEqual(len(league.jobs), 8)
        self.assertEqual(len({job.name for job in league.jobs}), len(league.jobs))
        self.assertNotIn("contour.ngc", "".join(program["text"] for program in league.programs.values()), "judged is not tuned on")
        for strategy in league.strategies:
            self.assertIn(strategy.needs, page.OFFERS)

    def test_no_placeholder_is_left_in_a_scenario(self):
        league = jobs.League()
        for job, knowledge, strategy in runs.wanted(league):
            text = league.scenario(job, knowledge, strategy, 40, pathlib.Path("made"))
            for word in ("{model}", "{known}", "{gains}", "{cutoff}", "{turns}"):
                self.assertNotIn(word, text, (job.name, strategy.name))

    def test_knowledge_is_exact_or_identified(self):
        league, (strategy,) = jobs.League(), [one for one in jobs.League().strategies if one.name == "precompensation"]
        texts = [league.scenario(league.jobs[1], knowledge, strategy, 40, pathlib.Path("made")) for knowledge in jobs.KNOWLEDGE]
        self.assertIn('model = "machine"\ncutoff_Hz = 40', texts[0])
        self.assertIn('model = "identified"', texts[1])
        self.assertNotIn("machine = {", texts[1])
        self.assertIn('machine = { nc = { Kv = "79.1666 1/s" }, axis = { X = { friction = { coulomb = "360 N", breakaway = "448 N" }', texts[2])

    def test_rotary_axes_correct_where_the_program_has_five_axes(self):
        league, (strategy,) = jobs.League(), [one for one in jobs.League().strategies if one.name == "gcode"]
        for job in league.jobs:
            text = league.scenario(job, jobs.KNOWLEDGE[0], strategy, 40, pathlib.Path("made"))
            self.assertEqual('axes = "all"' in text, "five axes" in job.title, job.name)

    def test_what_knows_nothing_runs_once(self):
        league = jobs.League()
        counts = {}
        for job, _, strategy in runs.wanted(league, league.jobs[0].name):
            if job is league.jobs[0]:
                counts[strategy.name] = counts.get(strategy.name, 0) + 1
        self.assertEqual((counts["none"], counts["contour"], counts["gcode"], counts["learning"]), (1, 1, 3, 3))

    def test_made_programs_are_the_same_every_time_and_run_in_the_travel(self):
        for make in programs.MADE.values():
            self.assertEqual(make(), make())
            self.assertGreater(make().count("\nG1"), 300)

    def test_an_unknown_machine_is_named(self):
        with self.assertRaisesRegex(InputError, r'machine = "lathe"; known are hsm, trunnion, router'):
            jobs.League()._job({"machine": "lathe", "program": "square"})


class Draws(unittest.TestCase):
    def setUp(self):
        self.league = jobs.League()
        self.job = self.league.jobs[1]   # unkind

    def drives(self, number):
        return jobs.known_drives(self.job, f"{jobs.DRAW}{number}")

    def test_drives_are_drawn_about_what_they_are(self):
        number = lambda value: float(str(value).strip('"').split()[0])
        samples = [self.drives(n) for n in range(1, 1001)]
        for key, one in (self.job.machine["drives"] | self.job.machine["unkind_drives"]).items():
            values = np.array([number(sample[key]) for sample in samples]) / one["value"] - 1.0
            self.assertAlmostEqual(values.mean(), 0.0, delta=0.12 * abs(one["off"]), msg=key)
            self.assertAlmostEqual(values.std(), abs(one["off"]), delta=0.09 * abs(one["off"]), msg=key)

    def test_what_belongs_together_deviates_together(self):
        for n in range(1, 20):
            drives = self.drives(n)
            ratio = [float(drives[f"axis.X.friction.{name}"].strip('" N')) for name in ("coulomb", "breakaway")]
            self.assertAlmostEqual(ratio[0] / ratio[1], 450.0 / 560.0, places=4)

    def test_a_draw_is_the_same_every_time_and_another_one_differs(self):
        self.assertEqual(self.drives(3), self.drives(3))
        self.assertNotEqual(self.drives(3), self.drives(4))
        machine = self.job.machine
        errors = [jobs.residual_errors(machine, f"{jobs.DRAW}{n}") for n in (3, 3, 4)]
        self.assertEqual(errors[0], errors[1])
        self.assertNotEqual(errors[0], errors[2])
        self.assertEqual(tomllib.loads(errors[0]).keys(), tomllib.loads(machine["identified"]).keys())
        self.assertIn("period_mm = 55.0", errors[0])

    def test_only_what_knows_something_is_drawn_and_shards_share_the_draws(self):
        every = list(runs.drawn(self.league, 3))
        self.assertFalse([one for _, _, one in every if not one.knows()])
        parts = [every[slice(n, None, 4)] for n in range(4)]
        self.assertEqual(sorted(map(repr, sum(parts, []))), sorted(map(repr, every)))

    def test_the_report_states_the_spread(self):
        league = small()
        name = league.jobs[0].name
        results = [{"job": name, "knowledge": f"{jobs.DRAW}{n}", "strategy": "gcode", "tip_99": float(n), "cycle_time": 1.0} for n in range(1, 101)]
        table = page.Table(league, results)
        (row,) = page.spread_rows(table)
        self.assertEqual(row, [name, "gcode", "-", "50.5", "3.48 to 97.5", "100", "100"])

    def test_heat_is_a_job_for_those_that_say_so(self):
        heat = [job for job in self.league.jobs if "day" in job.program]
        self.assertEqual(len(heat), 1)
        self.assertIn("thermal_network", [one.name for one in self.league.strategies_of(heat[0])])
        self.assertNotIn("thermal_network", [one.name for one in self.league.strategies_of(self.job)])


class Runs(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.league = small()
        cls.runner = runner(cls.league, cls.folder.name)
        cls.results = [cls.runner.one(*one, 40) for one in runs.wanted(cls.league)]

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_every_run_has_its_figures(self):
        self.assertEqual(len(self.results), 7)
        for one in self.results:
            self.assertNotIn("refused", one)
            self.assertGreaterEqual(one["tip_max"], one["tip_99"])
            self.assertGreater(one["tip_99"], 0.0)
            self.assertGreater(one["limits"], 90.0)
            self.assertLess(one["limits"], 101.0)
        none, exact = self.results[0], [one for one in self.results if one["strategy"] == "precompensation"][0]
        self.assertLess(exact["tip_rms"], 0.1 * none["tip_rms"])

    def test_a_result_that_lies_there_is_taken_and_that_of_another_program_is_not(self):
        job, knowledge, strategy = next(iter(runs.wanted(self.league)))
        path = self.runner.path(job, knowledge, strategy, 40)
        kept = json.loads(path.read_text())
        path.write_text(json.dumps({**kept, "tip_rms": -1.0}))
        self.assertEqual(self.runner.one(job, knowledge, strategy, 40)["tip_rms"], -1.0)
        again = runner(self.league, self.folder.name, version="2").one(job, knowledge, strategy, 40)
        self.assertEqual(again["tip_rms"], kept["tip_rms"])
        self.assertEqual({**again, "key": ""}, {**kept, "key": ""}, "the same bits")

    def test_a_refused_strategy_says_why(self):
        bad = jobs.Strategy("bad", '[[case.strategy]]\ntype = "gcode"\nmodel = "{model}"\nmax_block_mm = -1\n', "nothing", "", False)
        found = self.runner.one(self.league.jobs[0], jobs.KNOWLEDGE[0], bad, 0)
        self.assertIn("max_block_mm", found["refused"])

    def test_pages_hold_every_strategy(self):
        table = page.Table(self.league, self.results)
        for text in (page.markdown(table, {"precompensation": 40}, "1"), page.page(table, {"precompensation": 40}, "1")):
            for name in ("none", "gcode", "precompensation", "hsm-unkind-line", "Which strategy to choose"):
                self.assertIn(name, text)


class Choices(unittest.TestCase):
    def table(self, **figures):
        """Results of the small league: strategy -> (tip 99 %, cycle time)."""
        league = small()
        results = [{"job": league.jobs[0].name, "knowledge": knowledge, "strategy": name, "tip_99": tip, "cycle_time": time}
                   for name, (tip, time) in figures.items() for knowledge in jobs.KNOWLEDGE]
        return page.Table(league, results), league.jobs[0]

    def test_the_smallest_error_among_those_that_an_nc_can_do(self):
        table, job = self.table(none=(9.0, 1.0), gcode=(2.0, 1.1), precompensation=(1.0, 1.0))
        self.assertEqual(table.best(job, "exact", "nothing")[0].name, "gcode")
        self.assertEqual(table.best(job, "exact", "open NC")[0].name, "precompensation")
        table, job = self.table(none=(1.0, 1.0), gcode=(2.0, 1.1), precompensation=(1.5, 1.0))
        self.assertEqual(table.best(job, "exact", "open NC")[0].name, "none", "where nothing helps")

    def test_a_slow_strategy_is_not_chosen_where_time_counts(self):
        table, job = self.table(none=(9.0, 1.0), gcode=(2.0, 1.03), precompensation=(3.0, 1.01))
        self.assertEqual(table.best(job, "exact", "open NC")[0].name, "gcode")
        self.assertEqual(table.best(job, "exact", "open NC", page.SLOWER)[0].name, "precompensation")

    def test_the_front_holds_what_nobody_beats_in_both(self):
        table, job = self.table(none=(9.0, 1.0), gcode=(2.0, 1.1), precompensation=(2.5, 1.2))
        self.assertEqual([one.name for one in table.pareto(job, "exact")], ["none", "gcode"])


if __name__ == "__main__":
    unittest.main()
