#!/usr/bin/python3
"""tools/evidence: rows pass and fail by their numbers, and a row without its number never passes.

    evidence_test.py BUILD_FOLDER
"""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

sys.dont_write_bytecode = True
ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(sys.argv.pop(1)).resolve()

ROW = '[[row]]\nquantity = "q"\nwanted = "{}"\nrun = ["sh", "-c", "{}"]\n{}\n'
NUMBER = "find = 'largest (\\S+)'"


def evidence(*arguments):
    return subprocess.run([sys.executable, "-B", ROOT / "tools" / "evidence", "--build", BUILD, *arguments],
                          capture_output=True, text=True, check=False)


class Evidence(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def of(self, rows, *arguments):
        file = self.folder / "topic.toml"
        file.write_text('title = "a topic"\n' + rows)
        return evidence(str(file), *arguments)

    def one(self, row, *arguments):
        done = self.of(row, "--json", "-", *arguments)
        [result] = next(iter(json.loads(done.stdout)["topics"].values()))
        return done.returncode, result

    def test_both_sides_of_every_comparison(self):
        for wanted, inside, outside in (("= 0", 0, 1), ("<= 0.5", 0.5, 0.51), (">= 40", 40, 39), ("< 2", 1, 2), ("> 2", 3, 2),
                                        ("2 to 3", 2, 1.9), ("2 to 3", 3, 3.1)):
            for value, status in ((inside, 0), (outside, 1)):
                found, result = self.one(ROW.format(wanted, f"echo largest {value}", NUMBER))
                self.assertEqual((found, result["pass"], result["measured"]), (status, status == 0, value), wanted)

    def test_the_largest_of_several_numbers_counts(self):
        self.assertEqual(self.one(ROW.format("<= 2", "echo largest 1; echo largest 3; echo largest 2", NUMBER))[1]["measured"], 3)

    def test_a_row_without_its_number_fails(self):
        status, result = self.one(ROW.format("= 0", "echo nothing", NUMBER))
        self.assertEqual((status, result["pass"], result["measured"]), (1, False, None))

    def test_a_command_that_ends_badly_fails_whatever_it_printed(self):
        self.assertFalse(self.one(ROW.format("= 0", "echo largest 0; exit 3", NUMBER))[1]["pass"])
        self.assertTrue(self.one(ROW.format("= 0", "echo largest 0; exit 3", NUMBER + "\nstatus = 3"))[1]["pass"])
        self.assertFalse(self.one(ROW.format("passes", "exit 1", ""))[1]["pass"])

    def test_counts_are_shared(self):
        row = ROW.format(">= 1", "echo largest {count} $N", NUMBER + '\ncount = 1000\nenvironment = { N = "{count}" }')
        self.assertEqual(self.one(row)[1]["measured"], 1000)
        self.assertEqual(self.one(row, "--share", "50")[1]["measured"], 20)
        self.assertEqual(self.one(row, "--share", "1e6")[1]["measured"], 1)

    def test_equal_commands_run_once(self):
        mark = self.folder / "runs"
        row = ROW.format(">= 0", f"echo x >> {mark}; wc -l < {mark} | sed 's/^/largest /'", NUMBER)
        self.of(row + row)
        self.assertEqual(mark.read_text(), "x\n")

    def test_the_table_says_machine_build_and_what_failed(self):
        done = self.of(ROW.format("= 0", "echo largest 7 of them", NUMBER + '\nunit = "um"'))
        head, title = done.stdout.splitlines()[0], done.stdout.splitlines()[2]
        self.assertRegex(head, r"^servomill .*; .* cores; SIMD level (baseline|avx2|avx512); counts divided by 1$")
        self.assertEqual(title, "a topic")
        self.assertRegex(done.stdout, r"q +\W*= 0 um +7 um +NO ")
        self.assertIn("largest 7 of them", done.stdout)

    def test_faults_of_a_table_are_named(self):
        for rows, message in ((ROW.format("about 3", "true", NUMBER),
                               'topic.toml: error: row 1: wanted = "about 3"; must be "passes" or such as "<= 0.5", "94 to 96"'),
                              (ROW.format("2 to many", "true", ""),
                               'topic.toml: error: row 1: wanted = "2 to many"; must be "passes" or such as "<= 0.5", "94 to 96"'),
                              (ROW.format("= 3", "true", ""), "topic.toml: error: row 1: find is missing, and '= 3' needs a number"),
                              (ROW.format("passes", "true", "colour = 1"), "topic.toml: error: row 1: unknown key colour; "),
                              ("", "topic.toml: error: row is missing")):
            done = self.of(rows)
            self.assertEqual(done.returncode, 2)
            self.assertTrue(done.stderr.startswith(message), done.stderr)
        done = evidence("nothing")
        self.assertEqual(done.returncode, 2)
        self.assertRegex(done.stderr, r"^tools/evidence: no topic 'nothing'; there are ")

    def test_every_topic_can_be_read(self):
        self.assertEqual(evidence("--list").returncode, 0)


if __name__ == "__main__":
    unittest.main()
