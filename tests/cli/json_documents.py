#!/usr/bin/python3
"""Every command with --json prints exactly one JSON document. json_documents.py SERVOMILL

A command whose --help has the option has a row here, or the test fails. No number stands for what is not known: NaN and
infinities are no JSON, and are null.
"""
import json
import math
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

HERE = os.path.dirname(os.path.abspath(__file__))
SERVOMILL = os.path.abspath(sys.argv.pop(1))
SCENARIOS = os.path.join(HERE, "..", "..", "scenarios")
GALLERY = os.path.join(HERE, "gallery")
PATIENCE = 300  # s, for one command

SWEEP = 'sweep={"program.feed_override"=[1.0,0.5]}'
MACHINE, SCENARIO = "gallery/machine.toml", "gallery/scenario.toml"
BENCH = "identification/experiments"
MODE = ["--stiffness", "20 N/um", "--frequency", "500 Hz", "--damping", "0.03"]
SLOT = ["--Ktc", "800", "--Krc", "300", "--teeth", "4"]

# what must be there, made with the commands themselves
PREPARED = [
    ["run", SCENARIO, "-q", "-o", "out.h5"],
    ["sweep", SCENARIO, "-q", "-o", "part.h5", "--shard", "1/2", "--set", SWEEP],
    ["sweep", SCENARIO, "-q", "-o", "part.h5", "--shard", "2/2", "--set", SWEEP],
    ["run", "identification/motion.toml", "-q", "-o", f"{BENCH}/motion.h5"],
    ["identify", f"{BENCH}/record.toml", "-q", "--make-up", f"{BENCH}/recording.csv"],
    ["run", "thermal/training.toml", "-q", "-o", "training.h5"],
]

# command: arguments, kind of the document, keys of (each of) its objects
ROWS = [
    (["run", SCENARIO, "-o", "run.h5"], list, {"case", "quantity", "axis", "value", "unit"}),
    (["run", SCENARIO, "-o", "quiet.h5", "--quiet"], list, {"case", "quantity", "axis", "value", "unit"}),
    (["compare", "out.h5"], list, {"case", "quantity", "axis", "value", "unit"}),
    (["compare", "out.h5", "run.h5"], list, {"case", "quantity", "axis", "value", "unit"}),
    (["sweep", SCENARIO, "-o", "sweep.h5", "--set", SWEEP], list, {"point", "row"}),
    (["sweep", SCENARIO, "-o", "sweep.h5", "--set", SWEEP], list, None),  # all points are there
    (["merge", "part.1-of-2.h5", "part.2-of-2.h5", "-o", "merged.h5"], dict, {"file", "points", "missing", "simd_levels", "statistics"}),
    (["budget", SCENARIO, "--case", "table"], list, {"case", "quantity"}),
    (["converge", SCENARIO, "--halve", "tick"], list, {"quantity", "changes", "digits"}),
    (["bode", SCENARIO, "--axis", "Y", "--points", "2", "--f-min", "20", "--f-max", "40"], list, {"axis"}),
    (["bode", SCENARIO, "--axis", "Y", "--loop", "all", "--method", "none", "--points", "2", "--quiet"], list, {"axis"}),
    (["step", SCENARIO, "--axis", "Y"], list, {"axis", "step", "rise_time_s", "settling_time_s"}),
    (["tune", SCENARIO, "--axis", "Y"], list, {"axis", "before", "after", "common_Kv_per_s"}),
    (["fmu", SCENARIO, "--axis", "Y", "--case", "table", "-o", "drive.fmu"], dict, {"file", "fmi", "axes"}),
    (["lobes", *MODE, *SLOT, "--points", "3"], dict, {"teeth", "points"}),
    (["table", SCENARIO, "--format", "siemens", "-o", "siemens"], dict, {"format", "tables", "left", "verified", "notes", "files"}),
    (["table", SCENARIO, "--format", "isg", "-o", "isg"], dict, {"format", "tables", "left", "verified", "notes", "files"}),
    (["table", "errors.toml", "--machine", MACHINE, "--format", "klipper", "-o", "klipper"], dict, {"format", "skew", "mesh", "files"}),
    (["compensate", "cut.ngc", "-m", MACHINE, "--errors", "errors.toml", "--work-offset", "X=0,Y=0,Z=0", "-o", "cut_out.ngc"], dict,
     {"blocks_before", "largest_um", "left_line", "uncertainty", "servo", "assumed"}),
    (["check", SCENARIO, "gallery/part.ngc"], list, {"file", "faults", "warnings", "not_run", "program"}),
    (["check", "gallery/part.ngc", "--quiet"], list, {"file", "faults", "warnings", "not_run", "program"}),
    (["post", "part.cls", "-m", MACHINE, "-o", "post.ngc", "--tool-length", "0", "--feed", "500"], dict,
     {"file", "locations", "points_inserted", "verified", "warnings"}),
    (["recording", f"{BENCH}/recording.csv"], list, {"file", "format", "bases", "channels", "notes"}),
    (["calibrate", "calibration/router/readings.toml"], dict, {"groups", "errors", "undetermined", "suggestions"}),
    (["plan-calibration", "--machine", "machines/router_3axis.toml", "--hours", "2", "--instruments", "square,laser"], dict,
     {"set_ups", "U_before_um", "U_plan_um", "U_bound_um"}),
    (["identify", f"{BENCH}/identify.toml"], dict, {"parameters", "recordings", "laws", "undetermined", "warnings"}),
    (["identify-heat", "training.h5", "--machine", "machines/hsm600u_heat.toml"], dict, set()),
    (["response", "multisine.csv", "--input", "current", "--output", "angle", "--period", "0.5"], dict,
     {"recording", "unit", "lines", "extremes", "two_mass", "rational"}),
    (["response", "multisine.csv", "--input", "current", "--output", "angle", "--period", "0.5", "--fit", "0/2"], dict,
     {"recording", "unit", "lines", "extremes", "two_mass", "rational"}),
    (["evaluate", "standards/linear_axis.csv", "--standard", "iso230-2"], list, {"standard", "name", "parameters", "tables"}),
    (["time", "cut.ngc", "-m", MACHINE, "--start", "X=0,Y=0,Z=0"], dict, {"time_s", "unknown", "lines", "tools"}),
    (["time", SCENARIO], list, {"time_s", "cases", "lines"}),
    (["limits", "out.h5", "-m", MACHINE, "--case", "table"], dict, {"results", "notes"}),
    (["list", "strategies"], list, {"strategy", "help", "keys"}),
    (["list", "quantities"], list, {"quantity", "unit", "help"}),
    (["list", "rules"], list, {"found", "reading", "controls", "readers", "source"}),
    (["list", "keys", "program"], list, {"section", "key", "help", "type", "unit", "default"}),
    (["list", "machines", "--folder", "."], list, {"name", "title"}),
    (["list", "scenarios", "--folder", "."], list, {"name", "title"}),
]


def refuse_constant(name):
    raise ValueError(f"{name} is no JSON")


def write_multisine(path):
    """Four periods of a resonator under a multisine, with a little noise."""
    samples, rate, lines = 500, 1000.0, range(3, 100, 4)
    with open(path, "w", encoding="utf-8") as out:
        out.write("time [s],current [A],angle [rad]\n")
        for n in range(5 * samples):
            t = n / rate
            u = y = 0.0
            for k in lines:
                w = 2.0 * math.pi * k * rate / samples
                response = 900.0 / complex(60000.0 - w * w, 30.0 * w)
                phase = w * t - math.pi * k * k / 100.0
                u += math.cos(phase)
                y += abs(response) * math.cos(phase + math.atan2(response.imag, response.real))
            y += 1e-7 * math.sin(12.9898 * n * n)
            out.write(f"{t!r},{u!r},{y!r}\n")


class Documents(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.temporary.cleanup)
        cls.folder = cls.temporary.name
        for name in ("calibration", "guevel2025", "identification", "machines", "programs", "standards", "thermal"):
            shutil.copytree(os.path.join(SCENARIOS, name), os.path.join(cls.folder, name))
        shutil.copytree(GALLERY, os.path.join(cls.folder, "gallery"))
        files = {"cut.ngc": "G21 G90\nG0 X1 Y1 Z5\nG1 X10 F100\nG1 X30 Y20\nM2\n",
                 "errors.toml": "[errors.measured]\nEC0Y.constant_urad = 20.0\n",
                 "part.cls": "GOTO/0,0,10\nGOTO/5,0,10\nGOTO/5,7,10\n"}
        for name, text in files.items():
            with open(os.path.join(cls.folder, name), "w", encoding="utf-8") as out:
                out.write(text)
        write_multisine(os.path.join(cls.folder, "multisine.csv"))
        for arguments in PREPARED:
            cls.done(*arguments)

    @classmethod
    def done(cls, *arguments):
        done = subprocess.run([SERVOMILL, *arguments], cwd=cls.folder, capture_output=True, text=True, timeout=PATIENCE, check=False)
        assert done.returncode == 0, f"{arguments}: {done.returncode}\n{done.stdout}{done.stderr}"
        return done.stdout

    def test_each_is_one_document(self):
        for arguments, kind, keys in ROWS:
            with self.subTest(" ".join(arguments)):
                document = json.loads(self.done(*arguments, "--json"), parse_constant=refuse_constant)
                self.assertIs(type(document), kind)
                objects = document if kind is list else [document]
                if keys is None:
                    self.assertEqual(objects, [])
                    continue
                self.assertTrue(objects)
                for one in objects:
                    self.assertLessEqual(keys, set(one))

    def test_every_command_with_the_option_is_here(self):
        commands = re.findall(r"^  ([a-z-]+) ", self.done("--help"), re.MULTILINE)
        self.assertGreater(len(commands), 20)
        with_option = {name for name in commands if re.search(r"^  --json\b", self.done(name, "--help"), re.MULTILINE)}
        self.assertEqual(with_option, {arguments[0] for arguments, _, _ in ROWS})
        self.assertEqual(set(commands) - with_option, {"canon", "machine", "view"})  # always JSON, one object per line; a machine file; a server

    def test_lists_have_an_object_a_line(self):
        lines = self.done("list", "quantities", "--json").splitlines()
        self.assertEqual((lines[0][0], lines[-1]), ("[", "]"))
        for line in lines[:-1]:
            json.loads(line[1:])

    def test_lists_are_those_of_the_text(self):
        text = self.done("list", "quantities").splitlines()
        self.assertEqual([one["quantity"] for one in json.loads(self.done("list", "quantities", "--json"))],
                         [line.split()[0] for line in text])
        text = re.findall(r"^(\w+): ", self.done("list", "strategies"), re.MULTILINE)
        self.assertEqual([one["strategy"] for one in json.loads(self.done("list", "strategies", "--json"))], text)

    def test_what_a_loop_lacks_is_null(self):
        *_, compliance = json.loads(self.done("bode", SCENARIO, "--axis", "Y", "--loop", "compliance", "--method", "none", "--json"))
        self.assertNotIn("gain_margin", compliance)
        stable, unstable = ({one["axis"]: one for one in self.loops(kv)}["Y"] for kv in ("40 1/s", "20000 1/s"))
        self.assertTrue(stable["stable"] and stable["gain_margin"] > 1.0 and stable["gain_margin_Hz"] > 0.0)
        self.assertFalse(unstable["stable"])
        for key in ("gain_margin", "gain_margin_Hz", "phase_margin_deg", "crossover_Hz", "bandwidth_Hz", "peak", "peak_Hz"):
            self.assertIsNone(unstable[key], key)

    def loops(self, kv):
        done = subprocess.run([SERVOMILL, "bode", SCENARIO, "--axis", "Y", "--loop", "position", "--method", "none", "--json", "--set",
                               f"machine.nc.Kv={kv}", "--set", "machine.nc.check_stability=false"], cwd=self.folder, capture_output=True,
                              text=True, timeout=PATIENCE, check=False)
        return [one for one in json.loads(done.stdout) if "loop" in one]

    def test_a_load_step_has_no_overshoot(self):
        steps = {one["step"]: one for one in json.loads(self.done("step", SCENARIO, "--axis", "Y", "--json"))}
        self.assertIsNone(steps["load"]["overshoot"])
        self.assertIsNone(steps["load"]["rise_time_s"])
        self.assertGreaterEqual(steps["position"]["overshoot"], 0.0)

    def test_a_response_without_a_number_has_null(self):
        document = json.loads(self.done("response", "multisine.csv", "--input", "current", "--output", "angle", "--period", "0.5",
                                        "--fit", "0/2", "--json"))
        self.assertIsNone(document["two_mass"])
        self.assertIsNone(document["rational"]["dead_time_s"])
        (pole,) = document["rational"]["poles"]
        self.assertAlmostEqual(pole["frequency_Hz"], math.sqrt(60000.0) / (2.0 * math.pi), delta=0.01)


if __name__ == "__main__":
    unittest.main()
