#!/usr/bin/python3
"""Exported axes under an importer of their own (importer.c), and every rule of it broken once.

    fmu_test.py SERVOMILL IMPORTER FAULTY_LIBRARY SOURCE_DIR
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
import zipfile

SERVOMILL, IMPORTER, FAULTY, SOURCE = (pathlib.Path(word) for word in sys.argv[1:5])
SCENARIO = SOURCE / "scenarios" / "guevel2025" / "experiment1.toml"
PLATFORM = {"2": "linux64", "3": "x86_64-linux"}

# Edits that break a rule: name of the rule, pattern, replacement; of descriptions of both versions.
EDITS = [
    ("well_formed", r"</ModelVariables>", ""),
    ("version", r'fmiVersion="[23].0"', 'fmiVersion="4.0"'),
    ("name_and_token", r' modelName="[^"]*"', ""),
    ("name_and_token", r' (guid|instantiationToken)="[^"]*"', ""),
    ("elements", r"(?s)(  <LogCategories>.*</LogCategories>\n)(.*</ModelVariables>\n)", r"\2\1"),
    ("elements", r"<UnitDefinitions>", "<UnitDefinitions/><UnitDefinitions>"),
    ("interface", r"<CoSimulation [^>]*/>", ""),
    ("identifier", r'modelIdentifier="servomill_axis"', 'modelIdentifier="servomill-axis"'),
    ("binary", r'modelIdentifier="servomill_axis"', 'modelIdentifier="other"'),
    ("unit_names", r'<Unit name="m/s">', '<Unit name="m">'),
    ("base_units", r'<BaseUnit m="1" s="-1"/>', '<BaseUnit m="1" s="-0.5"/>'),
    ("log_categories", r'name="logEvents"', 'name="logStatusError"'),
    ("experiment", r'stepSize="[^"]*"', 'stepSize="0"'),
    ("variable_names", r'name="velocity"', 'name="position"'),
    ("references", r'valueReference="8" causality', 'valueReference="7" causality'),
    ("units", r'<Unit name="A">', '<Unit name="ampere">'),
    ("variability", r'name="Kv"(.*)variability="fixed"', r'name="Kv"\1variability="discrete"'),
    ("initial", r'name="load"(.*)variability="continuous"', r'name="load"\1variability="continuous" initial="exact"'),
    ("start", r'name="load"(.*) start="[^"]*"', r'name="load"\1'),
    ("start", r'name="velocity"(.*)unit="m/s"', r'name="velocity"\1unit="m/s" start="0"'),
    ("range", r'name="Kv"(.*)min="0"', r'name="Kv"\1min="1e9"'),
    ("independent", r'name="load"(.*)causality="input"', r'name="load"\1causality="independent"'),
]
EDITS_2 = [
    ("types", r"<Real unit=\"A\"/>", '<Complex unit="A"/>'),
    ("outputs", r'<Unknown index="7" dependencies=""/>', ""),
    ("outputs", r'<Unknown index="7" dependencies=""/>', '<Unknown index="6" dependencies=""/>'),
    ("initial_unknowns", r'<Unknown index="9"/>', ""),
    ("initial_order", r'(<Unknown index="9"/>)(\s*)(<Unknown index="10"/>)', r"\3\2\1"),
    ("dependencies", r'<Unknown index="7" dependencies=""/>', '<Unknown index="7" dependencies="2 99"/>'),
]
EDITS_3 = [
    ("types", r"<Float64 name=\"load\"", '<Complex name="load"'),
    ("outputs", r'<Output valueReference="6" dependencies=""/>', ""),
    ("outputs", r'<Output valueReference="6" dependencies=""/>', '<Output valueReference="5" dependencies=""/>'),
    ("initial_unknowns", r'<InitialUnknown valueReference="8"/>', ""),
    ("dependencies", r'<Output valueReference="6" dependencies=""/>', '<Output valueReference="6" dependencies="1 99"/>'),
    ("independent", r'<Float64 name="time".*\n', ""),
    ("clocks", r'name="velocity_clock"(.*)"triggered"', r'name="velocity_clock"\1"constant"'),
    ("clocks", r' hasEventMode="true"', ""),
]


def servomill(*words, status=0):
    done = subprocess.run([SERVOMILL, *words], capture_output=True, text=True, check=False)
    assert done.returncode == status, done.stderr
    return done.stdout + done.stderr


def importer(*words, before=()):
    return subprocess.run([*before, IMPORTER, *words], capture_output=True, text=True, check=False)


def broken(output):
    return set(re.findall(r"^broken: (\w+)", output, re.MULTILINE))


class Fmu(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(tempfile.mkdtemp())
        cls.addClassCleanup(shutil.rmtree, cls.folder)

    def export(self, axis="Y", fmi="2", name=None, more=(), scenario=SCENARIO):
        file = self.folder / f"{name or axis + fmi}.fmu"
        what = ("--axis", axis) if axis else ("--machine",)
        servomill("fmu", scenario, *what, "--fmi", fmi, "-o", file, "--force", "--quiet",
                  *(() if scenario != SCENARIO else ("--case", "nominal")), *more)
        return file

    def unpacked(self, *args, **options):
        file = self.export(*args, **options)
        with zipfile.ZipFile(file) as archive:
            self.assertIsNone(archive.testzip())
            archive.extractall(file.with_suffix(""))
        return file.with_suffix("")

    def assert_rules_hold(self, folder):
        done = importer("check", folder)
        self.assertEqual((done.stdout, done.stderr, done.returncode), ("", "", 0))

    def test_every_axis_keeps_all_rules(self):
        for axis, fmi in [*((axis, "2") for axis in "XYZBC"), ("Y", "3"), ("C", "3")]:
            with self.subTest(axis, fmi=fmi):
                self.assert_rules_hold(self.unpacked(axis, fmi))

    def test_any_folder_will_do(self):
        for fmi in "23":
            self.assert_rules_hold(self.unpacked("Y", fmi, name=f"100 % of {fmi}, größer"))

    def test_several_axes_keep_all_rules(self):
        for axes, fmi in (("Y,X", "2"), ("all", "3")):
            with self.subTest(axes, fmi=fmi):
                folder = self.unpacked(axes, fmi)
                self.assert_rules_hold(folder)
                self.assertIn('name="X.position"', (folder / "modelDescription.xml").read_text())

    def test_a_whole_machine_keeps_all_rules(self):
        for fmi in "23":
            with self.subTest(fmi=fmi):
                folder = self.unpacked(None, fmi, name=f"whole{fmi}")
                self.assert_rules_hold(folder)
                text = (folder / "modelDescription.xml").read_text()
                self.assertRegex(text, r'name="tool\.position_x" valueReference="1003" causality="output"')
                self.assertRegex(text, r'name="C\.position"')

    def test_a_machine_that_cannot_be_exported_whole_is_refused(self):
        for words, message in (
                (("--machine", "--axis", "X"), "--axis: error: cannot be given with --machine, which exports all axes"),
                (("--axis", "X", "--tool", "1"), "--tool: error: needs --machine"),
                (("--machine", "--tool", "77"), "--tool: error: the scenario has no tool 77; it has"),
                ((), "--axis: error: is missing")):
            with self.subTest(words=words):
                self.assertIn(message, servomill("fmu", SCENARIO, "--case", "nominal", *words, "-o", self.folder / "none.fmu", status=2))
        self.assertFalse((self.folder / "none.fmu").exists())

    def test_friction_keeps_all_rules(self):
        self.assert_rules_hold(self.unpacked("Y", name="friction", more=("--set", 'machine_override.friction_model="lugre"')))

    def break_description(self, folder, edits):
        """The rules of the description that the edits, one after the other, were seen to break."""
        description = folder / "modelDescription.xml"
        text = description.read_text()
        seen = set()
        for rule, pattern, replacement in edits:
            with self.subTest(rule, pattern=pattern):
                edited, count = re.subn(pattern, replacement, text, count=1)
                self.assertEqual(count, 1)
                description.write_text(edited)
                done = importer("describe", folder)
                self.assertIn(rule, broken(done.stdout))
                self.assertEqual(done.returncode, 1)
                seen.add(rule)
        description.write_text(text)
        self.assertEqual(importer("describe", folder).stdout, "")
        return seen

    def test_every_rule_of_the_description_is_seen_to_break(self):
        rules = importer("rules").stdout.split()
        rules = {"well_formed", *rules[:rules.index("names_version")]}
        # clocks are of FMI 3, and only FMI 2 wants an order
        self.assertEqual(self.break_description(self.unpacked(), EDITS + EDITS_2), rules - {"clocks"})
        self.assertEqual(self.break_description(self.unpacked(fmi="3"), EDITS + EDITS_3), rules - {"initial_order"})

    def test_every_rule_of_behaviour_is_seen_to_break(self):
        folder = self.unpacked(name="faulty")
        shutil.copy(FAULTY, folder / "binaries" / "linux64" / "servomill_axis.so")
        rules = importer("rules").stdout.split()
        self.assertEqual(broken(importer("check", folder).stdout), set(rules[rules.index("names_version"):]))

    def test_clocks_tick_where_the_loops_are_sampled(self):
        # each 0.2, 0.2 and 0.1 ms, at both ends
        done = importer("clocks", self.unpacked(fmi="3", name="clocks"), "0.1")
        self.assertEqual(done.stdout, "position_clock 501\nvelocity_clock 501\ncurrent_clock 1001\nthe same bits\n")

    def test_a_library_without_the_functions_is_seen(self):
        folder = self.unpacked(name="without")
        (folder / "binaries" / "linux64" / "servomill_axis.so").write_bytes(b"")
        self.assertEqual(broken(importer("check", folder).stdout), {"functions"})

    def test_a_changed_constant_is_refused(self):
        folder = self.unpacked(name="changed")
        constants = folder / "resources" / "axis.txt"
        constants.write_text(constants.read_text().replace("cascade.Kv = ", "cascade.Kv = 1"))
        done = subprocess.run([IMPORTER, "check", folder], capture_output=True, text=True, check=False,
                              env={**os.environ, "VERBOSE": "1"})
        self.assertIn("its checksum is wrong: the file has been changed", done.stdout)

    def test_the_same_axis_gives_the_same_bytes(self):
        self.assertEqual(self.export(name="one").read_bytes(), self.export(name="two").read_bytes())

    def test_the_library_needs_the_c_library_only(self):
        library = self.unpacked(name="needs") / "binaries" / "linux64" / "servomill_axis.so"
        listed = subprocess.run(["objdump", "-p", library], capture_output=True, text=True, check=True).stdout
        needed = set(re.findall(r"NEEDED +(\S+)", listed))
        if any("san.so" in name for name in needed):
            self.skipTest("a build with sanitizers")
        self.assertLessEqual(needed, {"libc.so.6", "libm.so.6", "ld-linux-x86-64.so.2"})

    def test_nothing_leaks(self):
        if shutil.which("valgrind") is None:
            self.skipTest("valgrind is not installed")
        folder = self.unpacked(name="leaks")
        done = importer("check", folder, before=("valgrind", "--quiet", "--leak-check=full", "--error-exitcode=9"))
        self.assertEqual((done.returncode, done.stderr), (0, ""))

    def test_steps_run_faster_than_real_time(self):
        folder = self.unpacked(name="fast")
        done = importer("time", folder, "20000")
        self.assertEqual(done.returncode, 0, done.stdout)
        factor = float(re.search(r"([\d.]+) times real time", done.stdout)[1])
        print(done.stdout.strip())
        self.assertGreater(factor, 1.0)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
