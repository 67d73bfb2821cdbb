#!/usr/bin/python3
"""Strategies out of the tree: loaded, run, refused, and what becomes of one that goes wrong.

    plugins.py SERVOMILL FOLDER_OF_PLUGINS
"""
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import h5py
import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
PLUGINS = os.path.abspath(sys.argv.pop(2))
SERVOMILL = os.path.abspath(sys.argv.pop(1))
PATIENCE = 60  # s, far more than anything here takes
SLOPE = 5000.0  # um/m

# Of tests/cli/plugins/wrong.cpp.
WHERE = ("create", "settle", "step", "destroy")
HOW = ("throws", "throws_number", "returns_text", "nan", "segmentation_fault", "abort", "overflow", "exit", "quick_exit",
       "ends_at_once", "loops", "absurd")
SAID = {"throws": "thrown on purpose", "throws_number": "an exception of unknown type",
        "returns_text": "returned on purpose"}  # the case ends
FAILED = {"segmentation_fault": "crashed (signal 11)", "abort": "crashed (signal 6)", "overflow": "crashed (signal 11)",
          "exit": "called exit()", "quick_exit": "called exit()", "ends_at_once": "ended its process with status 7",
          "loops": "did not return within 10 s"}  # without --isolate the process ends

STRATEGY = """
[[case]]
name = "{name}"
[[case.strategy]]
type = "{type}"
{keys}
"""
QUANTITY = """
[[quantity]]
name = "trajectory_difference"
axis = "Y"
baseline = "nominal"
cases = {cases}
"""


def library(name):
    return os.path.join(PLUGINS, name + ".so")


def scenario_text(*strategies, head=""):
    """The scenario of the gallery with these strategies in place of its table: (type, keys), or (case, type, keys)."""
    with open(os.path.join(HERE, "gallery", "scenario.toml"), encoding="utf-8") as file:
        text = file.read()
    text = text[:text.index('[[case]]\nname = "table"')]
    text += "".join(STRATEGY.format(name=one[0], type=one[-2], keys=one[-1]) for one in strategies)
    return head + text + QUANTITY.format(cases=json.dumps([one[0] for one in strategies]))


def is_running(process):
    try:
        with open(f"/proc/{process}/stat", encoding="ascii") as file:
            return file.read().rpartition(")")[2].split()[0] not in "ZX"
    except FileNotFoundError:
        return False
LOOPING = {("wrong_offset", where) for where in WHERE} | {("wrong_rewrite", "step")}  # 10 s each


PARTS = ("wrong_displacement", "wrong_offset", "wrong_position_loop")  # of a run


class Plugins(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        for name in ("machine.toml", "part.ngc"):
            shutil.copy(os.path.join(HERE, "gallery", name), self.folder)

    def write(self, text, name="s.toml"):
        with open(os.path.join(self.folder, name), "w", encoding="utf-8") as file:
            file.write(text)

    def write_program(self, text):
        self.write(text, "part.ngc")

    def servomill(self, *arguments, status=0):
        done = subprocess.run([SERVOMILL, *arguments], cwd=self.folder, capture_output=True, text=True,
                              timeout=PATIENCE, check=False)
        self.assertEqual(done.returncode, status, done.stdout + done.stderr)
        return done

    def run_ramp(self, output, *more, head="", keys=f"slope_um_per_m = {SLOPE}"):
        self.write(scenario_text(("smooth_ramp", keys), head=head))
        return self.servomill("run", "s.toml", "-o", output, "--json", *more)

    def open(self, name):
        return h5py.File(os.path.join(self.folder, name))

    def test_a_virtual_displacement_moves_the_axis_by_its_negative(self):
        self.run_ramp("out.h5", "--plugin", library("ramp"))
        with self.open("out.h5") as file:
            for name, slope in (("nominal", 0.0), ("smooth_ramp", SLOPE * 1e-6)):
                x, y = file[f"cases/{name}/servo/meas_linear"][-1, :2]  # at rest at X10 Y5
                self.assertAlmostEqual(x, 10.0, delta=1e-4)
                self.assertAlmostEqual(y, 5.0 - slope * x, delta=1e-4)
            self.assertRegex(file.attrs["servomill_build"], r"^\S+ with ramp 1\.2 \([0-9a-f]{16}\)$")

    def test_an_offset_follows_the_identified_model(self):
        self.write(scenario_text(("identified", 'model = "imposed"\naction = "impose"')))
        self.servomill("run", "s.toml", "-o", "out.h5", "--plugin", library("ramp"))
        with self.open("out.h5") as file:
            x, y = file["cases/identified/servo/meas_linear"][-1, :2]
        self.assertAlmostEqual(y - 5.0, 0.150 * np.sin(2.0 * np.pi * x / 62.0), delta=1e-3)  # EYX

    def test_a_rewritten_program_is_the_one_of_the_tree(self):
        """Blocks of a plug-in, displaced by the identified errors, are those of `gcode`: text and all signals."""
        self.write_program("G21 G90 G94 G17\nF1000\nG1 X10 Y5\nG4 P0.1\nG2 X20 Y15 I10\nG0 Z4\nG1 X3\nM30\n")
        common = 'model = "imposed"\naction = "impose"\nmax_block_mm = 0.5'
        self.write(scenario_text(("tree", "gcode", common + "\ntolerance_um = 1000"), ("plugin", "blocks", common)))
        self.servomill("run", "s.toml", "-o", "out.h5", "--plugin", library("blocks"))
        with self.open("out.h5") as file:
            tree, plugin = file["cases/tree"], file["cases/plugin"]
            texts = [case.attrs["program"].replace(name, "") for case, name in ((tree, "tree"), (plugin, "plugin"))]
            self.assertGreater(len(texts[0].splitlines()), 80)
            self.assertEqual(*texts)
            for signal, data in tree["servo"].items():
                self.assertEqual(data[:].tobytes(), plugin["servo/" + signal][:].tobytes(), signal)

    def test_a_proportional_term_in_the_position_loop_is_a_larger_gain(self):
        """In lag mode, and with powers of two, for which there is no rounding: the same bits."""
        lag = "\nvelocity_feed_forward = 0.0\nacceleration_feed_forward = 0.0\n"
        signals = {}
        for name, kind, keys, gain in (("term", "larger_gain", "gain = 32", 32), ("gain", "none", "", 64)):
            self.write(scenario_text(("one", kind, keys)).replace('Kv = "60 1/s"\n', f'Kv = "{gain} 1/s"' + lag))
            self.servomill("run", "s.toml", "-o", name + ".h5", "--plugin", library("gain"))
            with self.open(name + ".h5") as file:
                signals[name] = {signal: data[:].tobytes() for signal, data in file["cases/one/servo"].items()}
                self.assertGreater(np.abs(file["cases/one/servo/following_error_linear"][:]).max(), 0.3)  # mm
        self.assertEqual(signals["term"], signals["gain"])

    def test_the_scenario_can_name_it(self):
        by_option = self.run_ramp("option.h5", "--plugin", library("ramp"))
        by_key = self.run_ramp("key.h5", head=f'plugins = ["{library("ramp")}"]\n')
        self.assertEqual(by_option.stdout, by_key.stdout)
        with self.open("option.h5") as one, self.open("key.h5") as other:
            for signal, data in one["cases/smooth_ramp/servo"].items():
                self.assertEqual(data[:].tobytes(), other["cases/smooth_ramp/servo/" + signal][:].tobytes(), signal)

    def test_a_result_is_compared_with_the_plugin_that_the_user_names(self):
        for output, printed in (("key.h5", self.run_ramp("key.h5", head=f'plugins = ["{library("ramp")}"]\n').stdout),
                                ("option.h5", self.run_ramp("option.h5", "--plugin", library("ramp")).stdout)):
            refused = self.servomill("compare", output, status=2).stderr
            self.assertIn("was computed with the plug-in ramp.so: pass it with --plugin", refused)
            done = self.servomill("compare", output, "--json", "--plugin", library("ramp"))
            self.assertEqual(done.stdout, printed)

    def test_runs_in_lockstep_give_the_same_bits(self):
        slopes = [100.0 * n for n in range(1, 12)]  # more than eight lanes
        self.write(scenario_text(("smooth_ramp", "")))
        sweep = f"sweep={{case.smooth_ramp.strategy.slope_um_per_m={slopes}}}"
        self.servomill("sweep", "s.toml", "-q", "-o", "sweep.h5", "--plugin", library("ramp"), "--set", sweep)
        with self.open("sweep.h5") as file:
            values = [data[:] for name, data in file["sweep"].items() if "trajectory_difference" in name]
        self.assertEqual(len(values), 1)
        for slope, value in list(zip(slopes, values[0]))[::5]:
            (row,) = json.loads(self.run_ramp(f"{slope}.h5", "--plugin", library("ramp"),
                                              keys=f"slope_um_per_m = {slope}").stdout)
            self.assertEqual(row["value"], float(f"{value:.9g}"), slope)

    def test_it_is_listed_with_its_keys(self):
        listed = self.servomill("list", "strategies", "--plugin", library("ramp")).stdout
        self.assertIn("smooth_ramp: displaces Y in proportion to X\n"
                      "  slope_um_per_m       of the displacement of Y over X [um/m; default 100]\n", listed)

    def test_its_keys_are_checked(self):
        for keys, message in (("slop_um_per_m = 1.0", "did you mean 'slope_um_per_m'?"),
                              ("time_constant_ms = 0.0", "must be >= 0.001")):
            self.write(scenario_text(("smooth_ramp", keys)))
            self.assertIn(message, self.servomill("check", "s.toml", "--plugin", library("ramp"), status=2).stderr)

    def test_without_it_the_strategy_is_unknown(self):
        self.write(scenario_text(("smooth_ramp", "")))
        self.assertIn("must be one of contour, exact, feedback", self.servomill("check", "s.toml", status=2).stderr)

    def test_refusals(self):
        for name, why in (
                ("other_version", "was built for version 999 of the plug-in interface, this program has 1; rebuild it "
                                  "with the headers of this program"),
                ("no_function", "is not a plug-in: it does not export the function servomill_plugin_c_entry"),
                ("taken_name", "its strategy 'feedback' has the name of another one"),
                ("small_struct", "strategy 1: its struct has 8 bytes, expected 88 to 1024"),
                ("later_part", "strategy 1: has functions unknown to this program: it was built for a later version"),
                ("default_outside", "strategy 1: parameter 0 has the default 5, outside of its range 0 to 1")):
            done = self.servomill("list", "strategies", "--plugin", library(name), status=2)
            self.assertEqual(done.stderr, f"{library(name)}: error: {why}\n")
        self.assertEqual(self.servomill("list", "strategies", "--plugin", "no.so", status=2).stderr,
                         "no.so: error: No such file or directory\n")
        done = self.servomill("list", "strategies", "--plugin", "part.ngc", status=2)
        self.assertTrue(done.stderr.startswith("part.ngc: error: cannot be loaded: "), done.stderr)
        self.write('plugins = ["no.so"]\n' + scenario_text())
        self.assertEqual(self.servomill("check", "s.toml", status=2).stderr,
                         "s.toml:1:11: error: no.so: No such file or directory\n")

    def test_one_that_was_built_with_earlier_headers_still_works(self):
        with open(os.path.join(HERE, "plugins", "plugin_c_first.h"), encoding="ascii") as first, \
                open(os.path.join(HERE, "..", "..", "strategies", "plugin_c.h"), encoding="ascii") as now:
            versions = [re.search(r"#define SERVOMILL_PLUGIN_ABI (\d+)u", file.read())[1] for file in (first, now)]
        self.assertEqual(*versions)  # else that header has to be replaced
        self.write(scenario_text(("earlier", ""), ("earlier_guarded", "")))
        self.servomill("run", "s.toml", "-o", "out.h5", "--plugin", library("earlier"))
        with self.open("out.h5") as file:
            for name in ("earlier", "earlier_guarded"):
                x, y = file[f"cases/{name}/servo/meas_linear"][-1, :2]
                self.assertAlmostEqual(y, 5.0 - 0.005 * x, delta=1e-4)

    def test_one_of_a_later_program_works_as_far_as_it_is_known(self):
        self.write(scenario_text(("refused", "")))
        self.servomill("run", "s.toml", "-o", "out.h5", "--plugin", library("later"))

    def test_one_that_goes_wrong_ends_its_case_alone(self):
        for name, why in (("refusing", "displacement: X is beyond 10 mm"),
                          ("writing_nan", "displacement returned a value that is not finite"),
                          ("offset_nan", "offset returned a value that is not finite"),
                          ("low_pass", "offset returned a value that is not finite"),
                          ("undeclared", "offset returned a value that is not finite"),
                          ("turning", "displacement: displaces a rotary axis, contrary to its declaration"),
                          ("never_made", "settle: needs a licence")):
            self.write(scenario_text((name, "")).replace("X10", "X20"))
            self.write("G17 G21 G40 G49 G54 G90 G94\nG1 F1000 X5\nG1 X20\nM30\n", "part.ngc")
            done = self.servomill("run", "s.toml", "-f", "-o", "out.h5", "--plugin", library("faulty"), status=1)
            at_begin = name in ("low_pass", "undeclared", "never_made")
            line = 2 if at_begin else 3
            time = "0.0000" if at_begin else r"0\.\d{4}"
            self.assertRegex(done.stdout, rf"{name} +stopped: strategy {name}: {why} at {time} s, line {line} of the "
                                          "program\n")
            with self.open("out.h5") as file:
                self.assertEqual(file["cases/nominal"].attrs["finished"], 1)
                self.assertEqual(file["cases/" + name].attrs["finished"], 0)

    def test_one_that_hangs_or_crashes_ends_the_command_and_leaves_the_other_cases(self):
        for name, why in (("hanging", "did not return within 10 s"), ("crashing", "crashed (signal 11)")):
            self.write(scenario_text((name, ""), ("offset_nan", "")))
            done = self.servomill("run", "s.toml", "-j", "2", "-o", name + ".h5", "--plugin", library("faulty"), status=3)
            first, kept = done.stderr.splitlines()
            self.assertEqual(first, f"strategy {name} ({library('faulty')}): the plug-in {why}")
            self.assertTrue(kept.startswith(f"saved in {name}.h5"), kept)
            partial = kept.removeprefix("saved in ").split(":")[0]
            with self.open(partial) as file:
                complete = sorted(file["cases"])
            self.assertIn("nominal", complete)
            self.assertNotIn(name, complete)
            if name == "hanging":  # the case behind it had all the time
                self.assertEqual(complete, ["nominal", "offset_nan"])
            self.assertTrue(kept.endswith(f": complete cases {', '.join(complete)}; interrupted " +
                                          ", ".join(sorted({name, "offset_nan"} - set(complete)))), kept)


    def run_wrong(self, kinds, *options, status):
        """Runs a case for each (strategy, where, how), next to one that is well."""
        cases = [(f"{name}_{where}_{how}", name, f"where = {WHERE.index(where)}\nhow = {HOW.index(how)}")
                 for name, where, how in kinds]
        self.write(scenario_text(*cases))
        return [case for case, _, _ in cases], self.servomill("run", "s.toml", "-f", "-o", "out.h5", "--plugin",
                                                              library("wrong"), *options, status=status)

    def check_stopped(self, done, reasons):
        """Each case has stopped for its reason, and `nominal` is complete."""
        with self.open("out.h5") as file:
            self.assertEqual(file["cases/nominal"].attrs["finished"], 1)
            for case, why in reasons.items():
                self.assertEqual(file["cases/" + case].attrs["finished"], 0, case)
                self.assertRegex(done.stdout, rf"(?m)^{case} +stopped: {why}")
        self.servomill("compare", "out.h5", "--plugin", library("wrong"))

    def test_what_is_thrown_or_not_finite_ends_its_case(self):
        kinds = [(name, where, how) for name in PARTS for where in ("create", "settle", "step") for how in SAID]
        kinds += [("wrong_rewrite", where, how) for where in ("create", "step") for how in SAID]
        kinds += [(name, "step", "nan") for name in (*PARTS, "wrong_rewrite")] + [("wrong_position_loop", "step", "absurd")]
        reasons = {}
        for options in ((), ("--isolate",)):
            cases, done = self.run_wrong(kinds, *options, status=1)
            for case, (name, where, how) in zip(cases, kinds):
                function = name.removeprefix("wrong_")
                if function in ("displacement", "position_loop") and where != "step":
                    function = "settle"
                said = {"nan": " returned a value that is not finite", "absurd": " adds -1e+12 m/s to axis Y, beyond 10 times its v_max",
                        **{one: ": " + text for one, text in SAID.items()}}[how]
                if function == "rewrite":
                    said = ": block 2 (line 8) ends at Y = nan, which is not finite" if how == "nan" else said
                    reasons[case] = re.escape(f"strategy {name}: rewrite{said}") + "$"
                    continue
                reasons[case] = re.escape(f"strategy {name}: {function}{said}") + r" at 0\.\d{4} s, line \d of the program"
            self.check_stopped(done, reasons)

    def test_one_that_ends_the_process_ends_the_command_with_status_3(self):
        for name in PARTS:
            for where, how in (("create", "segmentation_fault"), ("settle", "exit"), ("step", "abort"), ("step", "exit"),
                               ("step", "quick_exit"), ("step", "overflow"), ("destroy", "abort"), ("destroy", "throws")):
                _, done = self.run_wrong([(name, where, how)], "-j", "1", status=3)
                first, kept = done.stderr.splitlines()[-2:]
                why = FAILED.get(how, FAILED["abort"])
                self.assertEqual(first, f"strategy {name} ({library('wrong')}): the plug-in {why}", (where, how))
                partial = kept.removeprefix("saved in ").split(":")[0]
                self.assertIn("complete cases nominal; interrupted", kept)
                with self.open(partial) as file:
                    self.assertEqual(list(file["cases"]), ["nominal"])
                os.remove(os.path.join(self.folder, partial))

    def test_one_that_ends_the_process_while_it_rewrites_ends_the_command_with_status_3(self):
        for where, how in (("create", "exit"), ("step", "segmentation_fault"), ("step", "loops"), ("destroy", "throws")):
            _, done = self.run_wrong([("wrong_rewrite", where, how)], status=3)
            why = FAILED.get(how, FAILED["abort"])
            self.assertEqual(done.stderr.splitlines()[-1], f"strategy wrong_rewrite ({library('wrong')}): the plug-in {why}")

    def test_what_cannot_be_rewritten_is_a_fault_of_check(self):
        self.write(scenario_text(("wrong_rewrite", f"where = {WHERE.index('step')}\nhow = {HOW.index('returns_text')}")))
        done = self.servomill("check", "s.toml", "--plugin", library("wrong"), status=2)
        self.assertRegex(done.stderr + done.stdout, r"s\.toml:\d+:\d+: error: case wrong_rewrite: strategy wrong_rewrite: "
                                                    "rewrite: returned on purpose")

    def test_isolated_it_ends_only_its_case(self):
        kinds = [(name, where, how) for name in (*PARTS, "wrong_rewrite")
                 for where in WHERE for how in FAILED
                 if (how != "loops" or (name, where) in LOOPING) and (name, where) != ("wrong_rewrite", "settle")]
        cases, done = self.run_wrong(kinds, "--isolate", "-j", "8", status=1)
        self.check_stopped(done, {
            case: re.escape(f"strategy {name} ({library('wrong')}): the plug-in {FAILED[how]}") + "$"
            for case, (name, where, how) in zip(cases, kinds)})

    def test_isolated_an_interrupt_ends_all_processes(self):
        text = scenario_text(("loops", "wrong_offset", f"where = {WHERE.index('step')}\nhow = {HOW.index('loops')}"))
        self.write(text)
        arguments = [SERVOMILL, "run", "s.toml", "-o", "out.h5", "--plugin", library("wrong"), "--isolate"]
        with subprocess.Popen(arguments, cwd=self.folder, stderr=subprocess.PIPE, text=True) as process:
            time.sleep(2.0)  # `nominal` has ended long since, the other one loops
            with open(f"/proc/{process.pid}/task/{process.pid}/children", encoding="ascii") as file:
                children = file.read().split()
            process.send_signal(signal.SIGINT)
            _, said = process.communicate(timeout=PATIENCE)
        self.assertEqual(process.returncode, 130, said)
        self.assertRegex(said, r"interrupted; saved in out\.h5\.partial: complete cases nominal; interrupted loops\n$")
        self.assertEqual(len(children), 1)
        for _ in range(50):
            if not is_running(children[0]):
                return
            time.sleep(0.1)
        self.fail("the child goes on")

    def test_isolated_the_bits_are_the_same(self):
        self.write(scenario_text(("smooth_ramp", f"slope_um_per_m = {SLOPE}"), ("identified", 'model = "imposed"')))
        printed = {}
        for name, options in (("alone.h5", ()), ("isolated.h5", ("--isolate",)), ("long.h5", ("--isolate", "-j", "1"))):
            printed[name] = self.servomill("run", "s.toml", "-o", name, "--json", "--plugin", library("ramp"),
                                           *options).stdout
            self.assertEqual(printed[name], printed["alone.h5"])
        with self.open("alone.h5") as one:
            for name in ("isolated.h5", "long.h5"):
                with self.open(name) as other:
                    for case in ("nominal", "smooth_ramp", "identified"):
                        self.assertEqual(sorted(one[f"cases/{case}/servo"]), sorted(other[f"cases/{case}/servo"]))
                        for signal, data in one[f"cases/{case}/servo"].items():
                            there = other[f"cases/{case}/servo/{signal}"]
                            self.assertEqual(data[:].tobytes(), there[:].tobytes(), signal)
                            self.assertEqual(data.dtype, there.dtype)
                            self.assertEqual(data.attrs["units"], there.attrs["units"])


if __name__ == "__main__":
    unittest.main()
