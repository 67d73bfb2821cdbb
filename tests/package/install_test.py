#!/usr/bin/python3
"""What `cmake --install` puts into a prefix works from there: scenarios by name, manual pages, completion.

install_test.py CMAKE BUILD_FOLDER
"""
import gzip
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

CMAKE, BUILD = sys.argv.pop(1), pathlib.Path(sys.argv.pop(1)).resolve()
COMMANDS = 25    # of the program, at least
CACHE = (BUILD / "CMakeCache.txt").read_text()
WITH_MODULE, WITH_PAGE = "SERVOMILL_PYTHON:BOOL=ON" in CACHE, "SERVOMILL_PAGE:BOOL=ON" in CACHE
DRIVE_BASH = """
source "$1"; shift
COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1))
_servomill
printf '%s\\n' "${COMPREPLY[@]}"
"""
DRIVE_FISH = "source $argv[1]; complete -C \"$argv[2]\""
# _describe and _files belong to the completion system of a terminal: here they print what they are given
DRIVE_ZSH = """
_files() { print -- ":files"; }
completions=$1; shift
words=("$@"); CURRENT=$#
_describe() { local name; for name in "$@"; do [[ ${(Pt)name} == array* ]] && print -l -- "${(P@)name}"; done; return 0 }
source $completions
"""


class Installed(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.prefix = pathlib.Path(folder.name) / "prefix"
        cls.here = pathlib.Path(folder.name) / "elsewhere"
        cls.here.mkdir()
        subprocess.run([CMAKE, "--install", BUILD, "--prefix", cls.prefix], check=True, capture_output=True)
        cls.program = str(cls.prefix / "bin" / "servomill")

    def run_program(self, *words, status=0):
        done = subprocess.run([self.program, *words], cwd=self.here, capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, status, done.stderr)
        return done

    def completions(self, *words):
        """What bash offers for the last word."""
        script = self.prefix / "share" / "bash-completion" / "completions" / "servomill"
        done = subprocess.run(["bash", "-c", DRIVE_BASH, "bash", script, self.program, *words], cwd=self.here,
                              capture_output=True, text=True, check=True)
        self.assertEqual(done.stderr, "")
        return done.stdout.split()

    def test_runs_a_scenario_by_its_name(self):
        done = self.run_program("run", "guevel2025/experiment1", "--json", "--set", "record.period_ms=10")
        self.assertIn('"quantity": "realised_ratio"', done.stdout)
        self.assertTrue((self.here / "experiment1.h5").exists())

    def test_every_command_for_scenarios_takes_a_name(self):
        self.run_program("bode", "iso/circular", "--axis", "X", "--method", "none", "--points", "3")
        self.run_program("table", "guevel2025/experiment1", "--format", "linuxcnc", "-o", "tables")
        self.run_program("check", self.prefix / "share/servomill/scenarios/thermal/day.toml")

    def test_a_wrong_name_is_answered_by_the_nearest(self):
        self.assertEqual(self.run_program("run", "guevel2025/experimnt1", status=2).stderr,
                         "guevel2025/experimnt1: error: is no file and no scenario; did you mean 'guevel2025/experiment1'?\n")

    def test_lists_scenarios_by_names_that_run(self):
        lines = self.run_program("list", "scenarios").stdout.splitlines()
        names = [line.split()[0] for line in lines]
        self.assertIn("guevel2025/experiment1", names)
        self.assertGreater(len(names), 30)
        self.assertFalse([name for name in names if name.startswith("machines/")])
        objects = json.loads(self.run_program("list", "scenarios", "--json").stdout)
        self.assertEqual([one["name"] for one in objects], names)

    def test_has_a_page_for_every_command(self):
        pages = {page.name: gzip.decompress(page.read_bytes()).decode() for page in (self.prefix / "share/man/man1").iterdir()}
        commands = re.findall(r"^  ([a-z-]+) ", self.run_program("--help").stdout, re.MULTILINE)
        self.assertGreaterEqual(len(commands), COMMANDS)
        self.assertEqual(set(pages), {"servomill.1.gz"} | {f"servomill-{name}.1.gz" for name in commands})
        for name in commands:
            text = pages[f"servomill-{name}.1.gz"]
            self.assertIn(f"servomill\\-{name}".replace("-", "\\-").replace("\\\\-", "\\-"), text)
            self.assertIn(".SH EXIT STATUS", text)
            # every option of --help is on the page
            for option in re.findall(r"--([a-z][a-z0-9-]+)", self.run_program(name, "--help").stdout.split("Options:")[1]):
                self.assertIn(option.replace("-", "\\-"), text, name)

    def test_brings_the_example_of_a_plug_in(self):
        example = pathlib.Path(__file__).resolve().parents[1] / "plugin_example"
        installed = self.prefix / "share/doc/servomill/examples/plugin"
        for name in ("CMakeLists.txt", "quadrant.cpp"):
            self.assertEqual((installed / name).read_bytes(), (example / name).read_bytes())

    @unittest.skipUnless(WITH_MODULE, "the module is not built")
    def test_brings_notebooks_that_run_without_the_source_tree(self):
        notebooks = {one.stem: one for one in (self.prefix / "share/doc/servomill/examples/notebooks").iterdir()}
        self.assertEqual(set(notebooks), {"the_paper", "my_machine", "my_strategy"})
        (module,) = self.prefix.glob("lib/python*/dist-packages")
        cells = json.loads(notebooks["my_strategy"].read_text())["cells"]  # the one that takes a second
        code = "\n".join("".join(cell["source"]) for cell in cells if cell["cell_type"] == "code")
        done = subprocess.run(["/usr/bin/python3", "-c", code], cwd=self.here, capture_output=True, text=True, check=False,
                              env={**os.environ, "PYTHONPATH": str(module), "MPLBACKEND": "Agg"})
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("12.0 ms ahead", done.stdout)
        for name, notebook in notebooks.items():
            self.assertNotIn("../", notebook.read_text(), name)

    def test_tells_where_its_files_are(self):
        page = gzip.decompress((self.prefix / "share/man/man1/servomill.1.gz").read_bytes()).decode().replace("\\-", "-")
        files = re.findall(r"^\.I (share/\S+)", page.split(".SH FILES")[1], re.MULTILINE)
        self.assertEqual(len(files), 4)
        for file in files:
            is_left_out = "page" in file and not WITH_PAGE or "notebooks" in file and not WITH_MODULE
            self.assertTrue(is_left_out or (self.prefix / file).exists(), file)

    def test_exports_axes_with_the_installed_library(self):
        self.run_program("fmu", "iso/circular", "--axis", "X", "-o", "x.fmu")

    @unittest.skipUnless(shutil.which("man"), "man is not installed")
    def test_man_reads_every_page_without_warning(self):
        for page in sorted((self.prefix / "share/man/man1").iterdir()):
            done = subprocess.run(["man", "--warnings", "-l", page], capture_output=True, text=True, check=True,
                                  env={**os.environ, "MANWIDTH": "100", "LC_ALL": "C.UTF-8"})
            self.assertEqual(done.stderr, "", page.name)
            self.assertIn("EXIT STATUS", done.stdout)

    def test_bash_completes_commands_options_keys_cases_and_scenarios(self):
        self.assertEqual(self.completions("plan"), ["plan-calibration"])
        self.assertEqual(self.completions("run", "--qu"), ["--quiet"])
        self.assertIn("machine.nc.Kv=", self.completions("run", "--set", "machine.nc.K"))
        self.assertEqual(self.completions("budget", "guevel2025/experiment1", "--case", "gcode_"), ["gcode_blocks"])
        self.assertEqual(self.completions("run", "guevel2025/experiment1_fr"), ["guevel2025/experiment1_friction", "guevel2025/experiment1_friction_observer"])
        (self.here / "mine.toml").write_text("", encoding="ascii")
        self.assertEqual(self.completions("run", "min"), ["mine.toml"])
        self.assertEqual(self.completions("list", "sc"), ["scenarios"])
        self.assertEqual(self.completions("no_command", ""), [])

    @unittest.skipUnless(shutil.which("fish"), "fish is not installed")
    def test_fish_completes(self):
        script = self.prefix / "share" / "fish" / "vendor_completions.d" / "servomill.fish"
        path = f"{self.prefix}/bin:{os.environ['PATH']}"
        done = subprocess.run(["fish", "-N", "-c", DRIVE_FISH, script, "servomill run --qui"], capture_output=True, text=True,
                              check=True, env={**os.environ, "PATH": path, "HOME": str(self.here)})
        self.assertEqual(done.stdout, "--quiet\tprints only warnings and faults\n", done.stderr)

    @unittest.skipUnless(shutil.which("zsh"), "zsh is not installed")
    def test_zsh_completes(self):
        (script,) = self.prefix.glob("share/zsh/*/_servomill")
        done = subprocess.run(["zsh", "-fc", DRIVE_ZSH, "zsh", script, self.program, "run", "--qui"], capture_output=True,
                              text=True, check=True)
        self.assertIn("--quiet:prints only warnings and faults\n", done.stdout, done.stderr)


if __name__ == "__main__":
    unittest.main()
