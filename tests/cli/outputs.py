#!/usr/bin/python3
"""No output takes the place of an input, forced or not; links are followed; what is said of partial files is so.

outputs.py SERVOMILL
"""
import fcntl
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

HERE = os.path.dirname(os.path.abspath(__file__))
SERVOMILL = os.path.abspath(sys.argv.pop(1))
GALLERY = os.path.join(HERE, "gallery")
REFUSED = "is an input of this command and is never overwritten; choose another file"

ERRORS = "[errors.imposed]\nEC0Y = { um_per_m = 120.0 }\n"
FILES = {
    "program.ngc": "G21 G90 G17 G54\nG53 G0 Z0\nT1 M6\nG43 H1\nG0 X0 Y0\nG1 X10 F200\nO<sub> CALL\nM2\n",
    "sub.ngc": "O<sub> SUB\nG1 Y10\nO<sub> ENDSUB\n",
    "tool.tbl": "T1 P1 Z+50 D6\n",
    "work.var": "5221 0\n5222 0\n5223 -100\n",
    "errors.toml": ERRORS,
    "part.cls": "PARTNO/TEST\nLOADTL/1\nFEDRAT/200,MMPM\nGOTO/0,0,0\nGOTO/10,0,0\nEND\n",
    "record.csv": "t [s],x [mm]\n0,1\n1,2\n",
    "base.toml": "",  # the scenario of the gallery
    "above.toml": "based_on = \"base.toml\"\n",
}


def servomill(*arguments, cwd):
    return subprocess.run([SERVOMILL, *arguments], capture_output=True, text=True, timeout=60, check=False, cwd=cwd)


def contents(folder):
    found = {}
    for root, _, names in os.walk(folder):
        for name in names:
            path = os.path.join(root, name)
            if os.path.islink(path):
                found[path] = os.readlink(path)
            else:
                with open(path, "rb") as file:
                    found[path] = file.read()
    return found


class Folder(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = temporary.name
        for name in ("scenario.toml", "machine.toml", "part.ngc"):
            shutil.copy(os.path.join(GALLERY, name), self.folder)
        shutil.copy(os.path.join(GALLERY, "scenario.toml"), self.path("base.toml"))
        for name, text in FILES.items():
            if text:
                self.write(name, text)

    def path(self, *names):
        return os.path.join(self.folder, *names)

    def write(self, name, text):
        with open(self.path(name), "w", encoding="utf-8") as file:
            file.write(text)

    def read(self, name):
        with open(self.path(name), encoding="utf-8") as file:
            return file.read()

    def run_here(self, *arguments):
        return servomill(*arguments, cwd=self.folder)


COMPENSATE = ["compensate", "program.ngc", "--machine", "machine.toml", "--errors", "errors.toml", "--tools", "tool.tbl",
              "--parameter-file", "work.var"]
POST = ["post", "part.cls", "--machine", "machine.toml", "--tools", "tool.tbl"]
SCENARIO_FILES = ["above.toml", "base.toml", "machine.toml", "part.ngc"]
# command, the option of its output, its inputs
COMMANDS = [
    (COMPENSATE, "-o", ["program.ngc", "machine.toml", "errors.toml", "tool.tbl", "work.var", "sub.ngc"]),
    (COMPENSATE + ["-o", "other.ngc"], "--record", ["program.ngc", "machine.toml", "errors.toml", "tool.tbl", "work.var"]),
    (POST, "-o", ["part.cls", "machine.toml", "tool.tbl"]),
    (["run", "above.toml"], "-o", SCENARIO_FILES),
    (["sweep", "above.toml", "--set", "sweep={\"program.feed_override\"=[1.0,0.5]}"], "-o", SCENARIO_FILES),
    (["budget", "above.toml"], "-o", SCENARIO_FILES),
    (["bode", "above.toml", "--axis", "X", "--method", "none"], "-o", SCENARIO_FILES),
    (["step", "above.toml", "--axis", "X"], "-o", SCENARIO_FILES),
    (["recording", "record.csv"], "-o", ["record.csv"]),
]


def hard_link(folder, name):
    os.link(os.path.join(folder, name), os.path.join(folder, "hard"))
    return "hard"


def symbolic_link(folder, name):
    os.symlink(name, os.path.join(folder, "soft"))
    os.symlink("soft", os.path.join(folder, "softer"))
    return "softer"


def another_way(folder, name):
    os.makedirs(os.path.join(folder, "deep"))
    return os.path.join("deep", "..", name)


NAMES = [lambda _, name: name, hard_link, symbolic_link, another_way]


class Inputs(Folder):
    def test_no_command_overwrites_an_input_under_any_name(self):
        combinations = overwritten = 0
        for command, option, inputs in COMMANDS:
            for name in inputs:
                for make in NAMES:
                    for force in ([], ["--force"]):
                        with tempfile.TemporaryDirectory() as folder:
                            shutil.copytree(self.folder, folder, dirs_exist_ok=True)
                            output = make(folder, name)
                            before = contents(folder)
                            result = servomill(*command, option, output, *force, cwd=folder)
                            combinations += 1
                            said = f"{command[0]} {option} {output} ({name}) {force}"
                            overwritten += contents(folder) != before
                            self.assertEqual(contents(folder), before, said)
                            why = REFUSED
                            if name == "sub.ngc" and not force:  # only the program knows what it calls
                                why = "exists; use --force to overwrite"
                            self.assertEqual((result.returncode, result.stdout, result.stderr),
                                             (2, "", f"{output}: error: {why}\n"), said)
        print(f"{combinations} combinations, {overwritten} overwritten")
        self.assertGreaterEqual(combinations, 100)

    def test_partial_file_of_an_output_may_be_an_input_either(self):
        os.rename(self.path("part.ngc"), self.path("out.h5.partial"))
        result = self.run_here("run", "scenario.toml", "-f", "-o", "out.h5", "--set", "program.file=out.h5.partial")
        self.assertEqual((result.returncode, result.stderr), (2, f"out.h5: error: its partial file {REFUSED}\n"))

    def test_tables_of_a_sweep_and_of_an_nc_overwrite_no_input(self):
        os.rename(self.path("scenario.toml"), self.path("out.csv"))
        swept = self.run_here("sweep", "out.csv", "-f", "-o", "out.h5", "--set", "sweep={\"program.feed_override\"=[1.0,0.5]}")
        self.assertEqual((swept.returncode, swept.stderr), (2, f"out.csv: error: {REFUSED}\n"))
        os.rename(self.path("out.csv"), self.path("x.csv"))
        table = self.run_here("table", "x.csv", "--format", "csv", "-o", ".", "-f")
        self.assertEqual((table.returncode, table.stderr), (2, f"./x.csv: error: {REFUSED}\n"))
        self.assertFalse(os.path.exists(self.path("notes.txt")))

    def test_merge_overwrites_no_shard(self):
        for shard in ("1/2", "2/2"):
            self.assertEqual(self.run_here("sweep", "scenario.toml", "-q", "-o", "out.h5", "--shard", shard, "--set",
                                           "sweep={\"program.feed_override\"=[1.0,0.5]}").returncode, 0)
        before = contents(self.folder)
        for name in ("out.1-of-2.h5", "out.2-of-2.h5"):
            merged = self.run_here("merge", "out.1-of-2.h5", "out.2-of-2.h5", "-f", "-o", name)
            self.assertEqual((merged.returncode, merged.stderr), (2, f"{name}: error: {REFUSED}\n"))
        self.assertEqual(contents(self.folder), before)

    def test_two_outputs_are_two_files(self):
        for record in ("out.ngc", "./out.ngc"):
            result = self.run_here(*COMPENSATE, "-o", "out.ngc", "--record", record)
            self.assertEqual((result.returncode, result.stderr),
                             (2, f"--record {record}: error: is the same file as the program out.ngc; choose another one\n"))
        self.assertFalse(os.path.exists(self.path("out.ngc")))


class Links(Folder):
    def setUp(self):
        super().setUp()
        os.makedirs(self.path("store"))

    def test_the_file_behind_is_replaced_in_its_own_folder(self):
        self.write("store/real.ngc", "old\n")
        os.symlink("store/real.ngc", self.path("out.ngc"))
        refused = self.run_here(*POST, "-o", "out.ngc")
        self.assertEqual((refused.returncode, refused.stderr),
                         (2, "out.ngc: error: exists; use --force to overwrite\n"))
        self.assertEqual(self.run_here(*POST, "-q", "-o", "out.ngc", "-f").returncode, 0)
        self.assertTrue(os.path.islink(self.path("out.ngc")))
        self.assertIn("G1 X10", self.read("store/real.ngc"))
        self.assertEqual(os.listdir(self.path("store")), ["real.ngc"])

    def test_result_files_as_well(self):
        os.symlink("store/real.h5", self.path("out.h5"))
        refused = self.run_here("run", "scenario.toml", "-o", "out.h5")
        self.assertEqual((refused.returncode, refused.stderr),
                         (2, "out.h5: error: is a symbolic link to 'store/real.h5', which does not exist; use --force to "
                             "write it\n"))
        forced = self.run_here("run", "scenario.toml", "-o", "out.h5", "-f")
        self.assertEqual((forced.returncode, forced.stderr), (0, ""))
        self.assertIn("written to store/real.h5\n", forced.stdout)
        self.assertTrue(os.path.islink(self.path("out.h5")))
        self.assertEqual(os.listdir(self.path("store")), ["real.h5"])

    def test_loops_and_missing_folders_are_wrong_inputs(self):
        os.symlink("b.ngc", self.path("a.ngc"))
        os.symlink("a.ngc", self.path("b.ngc"))
        os.symlink("ring", self.path("ring"))
        for name, why in (("a.ngc", "is a symbolic link loop; choose another file"),
                          ("nowhere/out.ngc", "folder 'nowhere' does not exist"),
                          ("ring/out.ngc", "the folder 'ring' is a symbolic link loop"),
                          ("part.cls/out.ngc", "'part.cls' is not a folder"),
                          ("store/", "is a folder; specify a file"),
                          ("/dev/null", "is a device; a result file gets its name only when complete: specify a regular file")):
            for command, option, _ in COMMANDS:
                result = self.run_here(*command, option, name, "-f")
                self.assertEqual((result.returncode, result.stderr), (2, f"{name}: error: {why}\n"), command[0])

    def test_standard_output_is_no_file(self):
        for command in (POST, COMPENSATE):
            result = self.run_here(*command, "-o", "-")
            self.assertEqual(result.returncode, 0, result.stderr)
            self.assertIn("X10", result.stdout)
            self.assertFalse(os.path.exists(self.path("-")))


class PartialFiles(Folder):
    def test_lock_tells_whether_a_run_has_ended(self):
        with open(self.path("out.h5.partial"), "wb") as file:
            file.write(b"\x89HDF\r\n\x1a\n")
            file.flush()
            fcntl.flock(file, fcntl.LOCK_EX)
            for force in ([], ["-f"]):
                running = self.run_here("run", "scenario.toml", "-o", "out.h5", *force)
                self.assertEqual((running.returncode, running.stderr),
                                 (3, "out.h5.partial: error: cannot be created: another process writes it\n"))
        ended = self.run_here("run", "scenario.toml", "-o", "out.h5")
        self.assertEqual((ended.returncode, ended.stderr),
                         (2, "out.h5.partial: error: exists, left by an unfinished run; use --force to overwrite\n"))

    def test_what_is_no_result_is_not_called_the_rest_of_a_run(self):
        with open(self.path("out.h5.partial"), "w", encoding="utf-8") as file:
            file.write("hello\n")
        foreign = self.run_here("run", "scenario.toml", "-o", "out.h5")
        self.assertEqual((foreign.returncode, foreign.stderr),
                         (2, "out.h5.partial: error: exists and is not a result file; incomplete results have this "
                             "name: remove it, or choose another result file\n"))
        os.mkdir(self.path("two.h5.partial"))
        folder = self.run_here("run", "scenario.toml", "-o", "two.h5")
        self.assertEqual((folder.returncode, folder.stderr),
                         (2, "two.h5.partial: error: exists and is a folder; incomplete results have this "
                             "name: remove it, or choose another result file\n"))

    def test_nothing_stays_where_nothing_was_promised(self):
        before = set(contents(self.folder))
        refused = self.run_here("bode", "scenario.toml", "--axis", "X", "-o", "out.h5", "--velocity", "1000 m/s")
        self.assertEqual(refused.returncode, 2)
        self.assertEqual(set(contents(self.folder)), before)


if __name__ == "__main__":
    unittest.main()
