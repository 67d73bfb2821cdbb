#!/usr/bin/python3
"""A part on machines drawn from a covariance, against closed forms.

    calibrated_part.py SERVOMILL

The identified machine has a squareness and one coefficient of a straightness; its errors are small, so that what
the corrected block shows follows by hand:

    drawn squareness  EC0Y = identified + e     squareness of the block: e
    drawn bow         EYX = b (x/mm)^2 um       a side of L mm bends by |b| L^2 / 4 (two parallel lines around a parabola)
"""
import csv
import json
import math
import os
import re
import subprocess
import sys
import tempfile
import unittest

import numpy as np

SERVOMILL = os.path.abspath(sys.argv.pop(1))
SCENARIOS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "scenarios")
SKEW, SKEW_DEVIATION = 100.0, 10.0  # urad
BOW_DEVIATION = 1e-3  # um/mm^2
SIDE = 98.0  # mm, of the probed line
COUNT = 60

MACHINE = f"""based_on = "{os.path.abspath(SCENARIOS)}/machines/router_3axis.toml"
[errors.identified]
EC0Y = {{ constant_urad = {SKEW} }}
EYX = {{ polynomial_um = [0.0, 0.0, 0.0] }}
[identified]
keys = ["errors.identified.EC0Y.constant_urad", "errors.identified.EYX.polynomial_um[2]"]
units = ["urad", "1"]
values = [{SKEW}, 0.0]
covariance = [[{SKEW_DEVIATION ** 2}, 0.0], [0.0, {BOW_DEVIATION ** 2}]]
"""

SCENARIO = f"""machine = "machine.toml"
machine_errors = "drawn"
[program]
file = "{os.path.abspath(SCENARIOS)}/programs/block.ngc"
parameters = {{ "#101" = 2400.0 }}
work_offset = {{ X_mm = 300.0, Y_mm = 200.0, Z_mm = -140.0 }}
start = {{ X_mm = -10.0, Y_mm = -10.0, Z_mm = 60.0 }}
[[program.tool]]
number = 1
length_mm = 60.0
diameter_mm = 8.0
[cmm]
uncertainty_um = UNCERTAINTY
[[probe]]
name = "front"
line = {{ from_mm = [1.0, 0.0, -8.0], to_mm = [99.0, 0.0, -8.0], normal = [0, -1, 0], points = 29 }}
[[probe]]
name = "right"
line = {{ from_mm = [100.0, 1.0, -8.0], to_mm = [100.0, 59.0, -8.0], normal = [1, 0, 0], points = 9 }}
[[case]]
name = "corrected"
servo = "ideal"
[[case.strategy]]
type = "gcode"
model = "identified"
[[quantity]]
name = "squareness"
probe = "front"
to = "right"
tolerance = 15.0
[[quantity]]
name = "straightness"
probe = "front"
tolerance = [0.0, 4.0]
[[quantity]]
name = "tool_deviation"
axis = "X"
statistic = "mean"
sections = ["front"]
[[quantity]]
name = "tool_deviation_uncertainty"
axis = "X"
statistic = "mean"
sections = ["front"]
[sweep]
samples = {{ from = "machine.toml", into = "drawn", design = "sobol", count = {COUNT}, seed = 5 }}
"""


PROGRAM = """G21 G17 G90 G94 G54 G64 P0.001
T1 M6
G43 H1
F1000
(MSG, start)
G0 X0 Y0 Z20
(MSG, up)
G1 X100
(MSG, down)
G1 X0
M2
"""

WALLS = """G21 G17 G90 G94 G54 G64 P0.001
T1 M6
G43 H1
S4775 M3
F800
G0 X-20 Y-10
G0 Z5
G1 Z-15
G1 X-4
(MSG, left)
G1 Y70
(MSG, approach)
G0 Z5
G0 X120 Y-10
G1 Z-15
G1 X104
(MSG, right)
G1 Y70
(MSG, approach)
G0 Z5
M2
"""

REVERSAL = f"""based_on = "{os.path.abspath(SCENARIOS)}/machines/router_3axis.toml"
[errors.identified]
EXX = {{ polynomial_um = [0.0], reversal = {{ width_polynomial_um = [3.0], distance_mm = 0.1 }} }}
[identified]
keys = ["errors.identified.EXX.polynomial_um[0]", "errors.identified.EXX.reversal.width_polynomial_um[0]"]
units = ["1", "1"]
values = [0.0, 3.0]
covariance = [[1.0, -0.6], [-0.6, 2.25]]
"""


class CalibratedPart(unittest.TestCase):
    """The block of the router, corrected by what is known of a machine that is drawn."""

    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory()
        cls.folder = cls.temporary.name
        cls.write("machine.toml", MACHINE)
        cls.write("scenario.toml", SCENARIO.replace("UNCERTAINTY", "0.0"))
        cls.printed = cls.run_here("sweep", "scenario.toml", "-o", "out.h5").stdout
        with open(os.path.join(cls.folder, "out.csv"), newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        cls.values = {name.split(" ")[0]: np.array([float(row[name]) for row in rows]) for name in rows[0] if name not in ("status", "reason")}

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    @classmethod
    def write(cls, name, text):
        with open(os.path.join(cls.folder, name), "w", encoding="utf-8") as file:
            file.write(text)

    @classmethod
    def run_here(cls, *arguments):
        done = subprocess.run([SERVOMILL, *arguments], cwd=cls.folder, capture_output=True, text=True, check=False)
        assert done.returncode == 0, f"{arguments}: {done.returncode}\n{done.stdout}{done.stderr}"
        return done

    def column(self, part):
        return next(values for name, values in self.values.items() if part in name)

    def test_squareness_is_what_is_drawn_less_what_is_known(self):
        drawn = self.column("EC0Y") - SKEW
        self.assertGreater(drawn.std(), 0.7 * SKEW_DEVIATION)
        # the bow turns the front side as a whole towards the right one: 2 b x_middle um/mm, in um/m, with the middle at
        # x = 350 mm of the machine; EC0Y > 0 leans the right side away from it
        turned = 2.0 * self.column("EYX") * 350.0 * 1000.0
        np.testing.assert_allclose(self.column("squareness"), drawn - turned, atol=0.3)  # um/m: 0.02 um over a side

    def test_straightness_is_the_bow_that_is_drawn(self):
        wanted = np.abs(self.column("EYX")) * SIDE ** 2 / 4.0
        self.assertGreater(wanted.max(), 2.0)
        # um: the chord of a millimetre of path, and points every 3.5 mm
        np.testing.assert_allclose(self.column("straightness"), wanted, atol=0.03)

    def test_first_order_is_what_monte_carlo_finds(self):
        residual, stated = self.column("tool_deviation_X"), self.column("tool_deviation_uncertainty_X")
        self.assertEqual(np.ptp(stated), 0.0)  # that of what is known, at all points
        # of 60 samples, three standard deviations of a standard deviation
        self.assertAlmostEqual(2.0 * residual.std(ddof=1) / stated[0], 1.0, delta=3.0 / math.sqrt(2.0 * COUNT))
        self.assertAlmostEqual(residual.mean() / stated[0], 0.0, delta=3.0 * 0.5 / math.sqrt(COUNT))

    def statistics(self, quantity):
        line = next(line for line in self.printed.splitlines() if line.startswith(quantity))
        return line.split()

    def test_conformity_is_the_share_within_the_tolerance(self):
        for quantity, lower, upper in (("squareness", -15.0, 15.0), ("straightness", 0.0, 4.0)):
            values = self.column(quantity)
            share = 100.0 * np.mean((values >= lower) & (values <= upper))
            line = " ".join(self.statistics(quantity))
            self.assertIn(f" {share:.1f} % {1.65 * values.std(ddof=1):.5g}", line)

    def test_conformity_is_near_its_closed_form(self):
        # |b| L^2 / 4 <= 4 um: erf(4 / (sqrt 2 sigma))
        sigma = BOW_DEVIATION * SIDE ** 2 / 4.0
        wanted = math.erf(4.0 / (math.sqrt(2.0) * sigma))
        share = np.mean(self.column("straightness") <= 4.0)
        self.assertAlmostEqual(share, wanted, delta=3.0 * math.sqrt(wanted * (1.0 - wanted) / COUNT))

    def test_each_sample_is_probed_with_a_noise_of_its_own(self):
        # U = 10 um (k = 2): a slope of the 29 points of the front side scatters by 5 um / sqrt(sum x^2)
        text = re.sub(r"covariance = .*", "covariance = [[1e-6, 0.0], [0.0, 1e-18]]", MACHINE)
        self.write("known.toml", text)
        noisy = SCENARIO.replace("UNCERTAINTY", "10.0").replace("machine.toml", "known.toml")
        self.write("noisy.toml", noisy)
        self.run_here("sweep", "noisy.toml", "-o", "noisy.h5")
        with open(os.path.join(self.folder, "noisy.csv"), newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        name = next(name for name in rows[0] if "squareness" in name)
        shown = np.array([float(row[name]) for row in rows])
        slopes = [5.0 / math.sqrt(sum((x - x.mean()) ** 2)) * 1000.0 for x in (np.linspace(0.0, 98.0, 29), np.linspace(0.0, 58.0, 9))]
        wanted = math.hypot(*slopes)
        # of 60 samples, three standard deviations of a standard deviation
        self.assertAlmostEqual(shown.std(ddof=1), wanted, delta=3.0 * wanted / math.sqrt(2.0 * COUNT))

    def test_compensate_gives_the_uncertainty_of_each_corrected_point(self):
        self.write("part.ngc", "G21 G17 G90 G94 G54 F600\nG0 X0 Y0 Z0\nG1 X100 Y0\nG1 X100 Y60\nG0 Z10\nM2\n")
        done = self.run_here("compensate", "part.ngc", "--machine", "machine.toml", "--model", "identified", "--work-offset", "X=300,Y=200,Z=-80",
                             "--tool-length", "1=60", "-o", "out.ngc", "--point-uncertainty", "points.csv")
        with open(os.path.join(self.folder, "points.csv"), newline="", encoding="utf-8") as file:
            rows = [{key: float(value) if value else None for key, value in row.items()} for row in csv.DictReader(file)]
        self.assertGreaterEqual(len(rows), 2)
        for row in rows:  # by hand: dx = -EC0Y y, dy = b x^2
            self.assertAlmostEqual(row["U_X_um"], 2.0 * SKEW_DEVIATION * row["Y_mm"] / 1000.0, delta=1e-4)
            self.assertAlmostEqual(row["U_Y_um"], 2.0 * BOW_DEVIATION * row["X_mm"] ** 2, delta=1e-3)
            self.assertIsNone(row["U_Z_um"])  # EZX and others are not identified
        self.assertEqual((rows[-1]["X_mm"], rows[-1]["Y_mm"]), (400.0, 260.0))
        rms = [math.sqrt(sum(row[name] ** 2 for row in rows) / len(rows)) for name in ("U_X_um", "U_Y_um")]
        self.assertIn(f"uncertainty of the corrected points (k = 2): X 5.20 um (rms {rms[0]:.2f}), Y 320.00 um (rms {rms[1]:.2f}), "
                      "Z unknown; largest in line ", done.stdout)
        self.assertIn("not determined by the calibration, neither corrected nor in this uncertainty: EB0Z (X), EA0Z (Y), ", done.stdout)

    def test_compensate_refuses_to_guess_an_uncertainty(self):
        done = subprocess.run([SERVOMILL, "compensate", "part.ngc", "--machine", "machine.toml", "--model", "measured", "--work-offset",
                               "X=300,Y=200,Z=-80", "-o", "other.ngc", "--point-uncertainty", "other.csv"],
                              cwd=self.folder, capture_output=True, text=True, check=False)
        self.assertEqual((done.returncode, done.stderr),
                         (2, "machine.toml: error: has no covariance of the error model 'measured' ([identified]); servomill calibrate -o writes it\n"))

    def uncertainties(self, machine, program, sections):
        """(axis, statistic, section): um of a run."""
        self.write("both.ngc", program)
        wanted = [(axis, statistic, section) for section in sections for axis in "XY" for statistic in ("max", "mean")]
        text = SCENARIO[:SCENARIO.index("[cmm]")].replace('machine_errors = "drawn"\n', "").replace("machine.toml", machine)
        text = re.sub(r'file = ".*"', 'file = "both.ngc"', text)
        text += '[[case]]\nname = "corrected"\nservo = "ideal"\n'
        text += "".join(f'[[quantity]]\nname = "tool_deviation_uncertainty"\naxis = "{axis}"\nstatistic = "{statistic}"\nsections = ["{section}"]\n'
                        for axis, statistic, section in wanted)
        self.write("residual.toml", text)
        self.run_here("run", "residual.toml", "-o", "residual.h5", "--force")
        os.rename(os.path.join(self.folder, machine), os.path.join(self.folder, "gone.toml"))  # the file holds all
        rows = json.loads(self.run_here("compare", "residual.h5", "--json").stdout)
        os.rename(os.path.join(self.folder, "gone.toml"), os.path.join(self.folder, machine))
        return dict(zip(wanted, (row["value"] for row in rows)))

    def test_a_run_gives_the_uncertainty_of_its_residual(self):
        found = self.uncertainties("machine.toml", PROGRAM, ["up", "down"])
        for section in ("up", "down"):  # by hand, at x = 300 to 400 mm, y = 200 mm
            self.assertAlmostEqual(found["X", "max", section], 2.0 * SKEW_DEVIATION * 0.2, delta=1e-3)
            self.assertAlmostEqual(found["Y", "max", section], 2.0 * BOW_DEVIATION * 400.0 ** 2, delta=0.2)

    def test_the_uncertainty_is_that_of_the_direction_of_travel(self):
        self.write("reversal.toml", REVERSAL)
        found = self.uncertainties("reversal.toml", PROGRAM, ["up", "down"])
        # U^2 = 4 (s_m^2 +- r s_m s_w + s_w^2 / 4) with 1, 1.5 um and r = -0.4; a reversal takes 0.1 mm of 100 mm
        self.assertAlmostEqual(found["X", "mean", "up"], 2.0 * math.sqrt(1.0 - 0.6 + 0.5625), delta=0.01)
        self.assertAlmostEqual(found["X", "mean", "down"], 2.0 * math.sqrt(1.0 + 0.6 + 0.5625), delta=0.01)
        self.assertAlmostEqual(found["X", "max", "down"], 2.0 * math.sqrt(1.0 + 0.6 + 0.5625), delta=1e-3)
        self.assertAlmostEqual(found["Y", "max", "down"], 0.0, delta=1e-6)

    def test_sides_cut_in_either_direction_show_the_lost_motion_that_is_left(self):
        # X comes rising to the left side and falling to the right one; 3 um of lost motion w and no mean are corrected:
        # sides at m + (w - 3) / 2 and m - (w - 3) / 2
        self.write("reversal.toml", REVERSAL)
        self.write("walls.ngc", WALLS)
        text = SCENARIO[:SCENARIO.index("[[probe]]")].replace("UNCERTAINTY", "0.0").replace("machine.toml", "reversal.toml")
        text = re.sub(r'file = ".*"', 'file = "walls.ngc"', text)
        text = text.replace('parameters = { "#101" = 2400.0 }\n', "")
        for name, x, normal in (("left", 0.0, -1), ("right", 100.0, 1)):
            text += f'[[probe]]\nname = "{name}"\nline = {{ from_mm = [{x}, 10.0, -8.0], to_mm = [{x}, 50.0, -8.0], normal = [{normal}, 0, 0], points = 5 }}\n'
        text += SCENARIO[SCENARIO.index("[[case]]"):SCENARIO.index("[[quantity]]")]
        text += "".join(f'[[quantity]]\nname = "probed_position"\nprobe = "{name}"\naxis = "X"\ntolerance = 2.0\n' for name in ("left", "right"))
        text += SCENARIO[SCENARIO.index("[sweep]"):].replace("machine.toml", "reversal.toml")
        self.write("walls.toml", text)
        self.run_here("sweep", "walls.toml", "-o", "walls.h5")
        with open(os.path.join(self.folder, "walls.csv"), newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))

        def column(part):
            name = next(name for name in rows[0] if part in name)
            return np.array([float(row[name]) for row in rows])

        mean, half = column("EXX_polynomial"), 0.5 * (column("width_polynomial") - 3.0)
        left, right = column("position_X_left"), column("position_X_right")
        self.assertGreater(np.abs(half).max(), 1.0)
        np.testing.assert_allclose(left, mean + half, atol=0.02)
        np.testing.assert_allclose(right, mean - half, atol=0.02)
        # their uncertainties are those of either direction: s_m^2 +- r s_m s_w + s_w^2 / 4, r = -0.4
        for found, wanted in ((left, math.sqrt(1.0 - 0.6 + 0.5625)), (right, math.sqrt(1.0 + 0.6 + 0.5625))):
            self.assertAlmostEqual(found.std(ddof=1) / wanted, 1.0, delta=3.0 / math.sqrt(2.0 * COUNT))

    def test_a_machine_without_covariance_has_no_such_quantity(self):
        self.write("plain.toml", f'based_on = "{os.path.abspath(SCENARIOS)}/machines/router_3axis.toml"\n')
        with self.assertRaisesRegex(AssertionError, "needs a machine with identified errors and their covariance, as written by servomill calibrate -o"):
            self.uncertainties("plain.toml", PROGRAM, ["up"])

    def test_a_run_says_if_the_tolerance_is_met(self):
        done = self.run_here("run", "scenario.toml", "-o", "run.h5")
        self.assertRegex(done.stdout, r"squareness .* \+-15, met")
        self.assertRegex(done.stdout, r"straightness .* 0 to 4, met")
        lines = self.run_here("compare", "run.h5", "--json").stdout.splitlines()
        self.assertIn('"tolerance": [-15, 15], "is_within_tolerance": true', lines[0])


if __name__ == "__main__":
    unittest.main()
