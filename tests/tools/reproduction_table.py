"""Rows of the papers: what they ask for, the verdicts on both sides of their tolerances, and faults of the table."""
import math
import pathlib
import subprocess
import sys
import tempfile
import tomllib
import unittest

from reproduction_files import ROOT, SCENARIOS, row

from command_line import InputError
from reproduction import derived, pictures, rows, runs, verdicts

JUST = 1e-6   # of a tolerance or a limit: beside its edge


def based(path):
    """A scenario as a dict with what it is based on: cases by name, other lists as a whole."""
    own = tomllib.loads(path.read_text(encoding="utf-8"))
    if "based_on" not in own:
        return own
    base = based(path.parent / own["based_on"])
    cases = {one["name"]: one for one in base.get("case", [])} | {one["name"]: one for one in own.get("case", [])}
    return {**base, **own, "case": list(cases.values())}


def promised(scenario):
    """(case, quantity, axis, sections) of all rows that a comparison of the scenario will print."""
    names = [one["name"] for one in scenario["case"]]
    return {(case, one["name"], one.get("axis"), ", ".join(one["sections"]) if "sections" in one else one.get("probe"))
            for one in scenario["quantity"] for case in one.get("cases", names)}


class TheTable(unittest.TestCase):
    def setUp(self):
        self.rows = rows.read()

    def test_every_row_asks_for_something_that_its_scenario_compares(self):
        scenarios = {one.name: based(SCENARIOS / one.scenario) for one in runs.RUNS}
        for one in self.rows:
            with self.subTest(one.id):
                if not one.here:
                    self.assertTrue(one.lacks)
                    continue
                if "run" in one.here:
                    self.assertIn(one.here["run"], scenarios)
                if "derived" in one.here:
                    self.assertIn(one.here["derived"], derived.FUNCTIONS)
                    continue
                for wanted in (one.here, *([one.here["over"]] if "over" in one.here else [])):
                    key = tuple(wanted.get(name) for name in ("case", "quantity", "axis", "sections"))
                    self.assertIn(key, promised(scenarios[one.here["run"]]))

    def test_every_tolerance_has_a_reason_and_every_row_says_why(self):
        for one in self.rows:
            self.assertTrue(one.why, one.id)
            self.assertTrue(one.lacks or one.tolerance_reason, one.id)

    def test_table_3_1_is_the_one_of_the_scenario(self):
        series = [one for one in self.rows if one.part_of == "L1-point-{k}"]
        self.assertEqual([float(one.printed.split()[0]) for one in series], list(derived.table31()))

    def test_figures_are_those_of_both_papers(self):
        numbers = {paper: [one.number for one in pictures.PICTURES if one.paper == paper and one.number[0].isdigit()]
                   for paper in rows.PAPERS}
        self.assertEqual(numbers, {"G": ["6", "9", "10", "11", "12", "14", "15", "16", "17", "18", "19"],
                                   "L": ["3.1", "3.2", "3.3", "4.1"]})

    def test_figures_are_drawn_from_scenarios_that_are_run(self):
        for one in pictures.PICTURES:
            self.assertLessEqual(set(one.runs), {run.name for run in runs.RUNS}, one.number)


class Verdicts(unittest.TestCase):
    def test_change_on_both_sides_of_every_tolerance(self):
        edges = 0
        for one in rows.read():
            if one.lacks:
                continue
            inside = {verdicts.verdict(one, value) for value in _inside(one)}
            self.assertLessEqual(inside, {verdicts.REPRODUCED, verdicts.WITHIN, verdicts.IDENTIFIED, verdicts.BUILT_IN,
                                          verdicts.GIVEN}, one.id)
            for value in _outside(one):
                edges += 1
                self.assertIn(verdicts.verdict(one, value), (verdicts.NOT_REPRODUCED, verdicts.NOT_EXPLAINED), one.id)
        self.assertGreater(edges, len(rows.read()))

    def test_by_meaning(self):
        for one, value, wanted in (
                (row(), 2.5, verdicts.REPRODUCED),
                (row(), 2.51, verdicts.NOT_REPRODUCED),
                (row(basis="assumed"), 2.0, verdicts.WITHIN),
                (row(basis="assumed"), 2.51, verdicts.NOT_REPRODUCED),
                (row(basis="fitted"), 2.0, verdicts.IDENTIFIED),
                (row(basis="fitted"), 2.51, verdicts.NOT_REPRODUCED),
                (row(basis="fitted", meaning="below", tolerance=0.0), 1.0, verdicts.IDENTIFIED),
                (row(basis="built_in"), 2.0, verdicts.BUILT_IN),
                (row(basis="built_in"), 1.49, verdicts.NOT_REPRODUCED),
                (row(meaning="below", tolerance=0.0), 2.0, verdicts.WITHIN),
                (row(meaning="below", tolerance=0.0), 2.01, verdicts.NOT_REPRODUCED),
                (row(meaning="below", tolerance=0.0), -2.0, verdicts.WITHIN),
                (row(meaning="below", tolerance=0.0), -2.01, verdicts.NOT_REPRODUCED),
                (row(meaning="above", tolerance=0.0), 1.99, verdicts.NOT_REPRODUCED),
                (row(meaning="between", value=None, limits=(1.0, 3.0), tolerance=0.0), 3.0, verdicts.WITHIN),
                (row(basis="given", tolerance=0.0), 2.0, verdicts.GIVEN),
                (row(basis="given", tolerance=0.0), 2.1, verdicts.NOT_REPRODUCED),
                (row(open=True), 0.0, verdicts.NOT_EXPLAINED),
                (row(open=True), 2.0, verdicts.REPRODUCED),
                (row(lacks="its unit"), 2.0, verdicts.NOT_COMPARED),
                (row(lacks="its curve", here={}), None, verdicts.NOT_COMPARED),
                (row(), None, verdicts.MISSING),
                (row(meaning="below"), math.nan, verdicts.MISSING),
                (row(meaning="below"), -math.inf, verdicts.MISSING)):
            self.assertEqual(verdicts.verdict(one, value), wanted, (one, value))

    def test_only_predictions_are_reproduced(self):
        for one in rows.read():
            if one.basis != "predicted" and not one.lacks:
                self.assertNotEqual(verdicts.verdict(one, sum(_inside(one)) / 2), verdicts.REPRODUCED, one.id)

    def test_no_row_accepts_a_factor_of_three(self):
        for one in rows.read():
            if one.meaning == "between" and not one.lacks and one.limits[0] > 0.0:
                self.assertLess(one.limits[1] / one.limits[0], 3.0 if not one.open else 5.1, one.id)


def _edges(one):
    low, high = verdicts.limits(one)
    return [(edge, sign) for edge, sign in ((low, -1.0), (high, 1.0)) if math.isfinite(edge)]


def _step(one, edge):
    return JUST * max(one.tolerance, abs(edge), 1e-3)


def _inside(one):
    edges = [edge - sign * (_step(one, edge) if verdicts.limits(one)[0] < verdicts.limits(one)[1] else 0.0)
             for edge, sign in _edges(one)]
    return edges if len(edges) == 2 else [edges[0], edges[0]]


def _outside(one):
    return [edge + sign * _step(one, edge) for edge, sign in _edges(one)]


class Faults(unittest.TestCase):
    def fails(self, text, message):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "rows.toml"
            path.write_text(text, encoding="utf-8")
            with self.assertRaises(InputError) as fault:
                rows.read(path)
        self.assertEqual(str(fault.exception).replace(str(path), "rows.toml"), message)

    GOOD = ('[[row]]\nid = "a"\npaper = "G"\ngroup = "g"\nquantity = "q"\nprinted = "p"\nunit = "um"\nwhy = "w"\nbasis = "predicted"\n'
            'here = {}\nvalue = 1.0\ntolerance_reason = "t"\n')

    def test_say_which_row(self):
        self.fails(self.GOOD.replace('"predicted"', '"guessed"'), "rows.toml: row a: error: basis = 'guessed'; must be one of fitted, "
                   "predicted, assumed, built_in, given")
        self.fails(self.GOOD.replace("value = 1.0\n", ""), "rows.toml: row a: error: value is missing; if the paper gives none, "
                   "lacks must name what is missing")
        self.fails(self.GOOD.replace("value = 1.0\n", 'meaning = "below"\nvalue = -1.0\n'),
                   "rows.toml: row a: error: value = -1; must be >= 0 where it limits a magnitude")
        self.fails(self.GOOD.replace('tolerance_reason = "t"\n', ""), "rows.toml: row a: error: tolerance_reason is missing")
        self.fails(self.GOOD.replace('why = "w"\n', ""), "rows.toml: row a: error: why is missing")
        self.fails(self.GOOD + self.GOOD, "rows.toml: row a: error: appears 2 times")

    def test_the_program_is_not_there(self):
        done = subprocess.run([sys.executable, "-B", "-m", "reproduction", "nowhere/servomill", "-o", tempfile.gettempdir()],
                              capture_output=True, text=True, cwd=ROOT / "tools")
        self.assertEqual((done.returncode, done.stderr),
                         (2, "reproduction: error: nowhere/servomill does not exist\n"))
