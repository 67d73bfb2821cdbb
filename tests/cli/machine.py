#!/usr/bin/python3
"""Machine files from the settings of real controls.

    machine.py SERVOMILL
"""
import glob
import json
import os
import subprocess
import sys
import tomllib
import unittest

import in_folder

SERVOMILL = os.path.abspath(sys.argv.pop(1))
SAMPLES = "/usr/share/doc/linuxcnc/examples/sample-configs"  # of Debian's linuxcnc-uspace

INI = """[EMC]
MACHINE = my "mill"
[EMCMOT]
SERVO_PERIOD = 1000000
[TRAJ]
COORDINATES = X Y Z
LINEAR_UNITS = mm
ANGULAR_UNITS = degree
MAX_LINEAR_VELOCITY = 60
[KINS]
KINEMATICS = trivkins
JOINTS = 3
[AXIS_X]
MIN_LIMIT = -10.5
MAX_LIMIT = 300
MAX_VELOCITY = 50    # mm/s
MAX_ACCELERATION = 500
[JOINT_0]
MIN_LIMIT = -20
MAX_LIMIT = 290
MAX_VELOCITY = 60
MAX_ACCELERATION = 400
[AXIS_Y]
MAX_VELOCITY = 50
MAX_ACCELERATION = 500
[JOINT_2]
MIN_LIMIT = -1e99
MAX_LIMIT = 0
MAX_VELOCITY = 20
MAX_ACCELERATION = 200
"""
GRBL = """>>> $$
$11=0.020 (junction deviation, mm)
$13=1 (report inches, bool)
$110=6000.000 (x max rate, mm/min)
$111=6000.000
$112=500.000
$113=3600.000
$120=500.000
$121=400.000
$122=50.000
$123=720.000
$130=290.000
$131=790.000
$132=100.000
$392=4.5
ok
"""
FLUIDNC = """name: "desk"
stepping:
  engine: RMT
axes:
  # the gantry
  x:
    steps_per_mm: 200
    max_rate_mm_per_min: 5000.000
    acceleration_mm_per_sec2: 250.000  # gently
    max_travel_mm: 300.000
    homing:
      cycle: 2
      mpos_mm: 10.000
      positive_direction: false
    motor0:
      limit_all_pin: gpio.35:low
  z:
    max_travel_mm: 80
    max_rate_mm_per_min: 900
    acceleration_mm_per_sec2: 100
    homing:
      mpos_mm: -2
      positive_direction: true
junction_deviation_mm: 0.015
relay:
  spinup_ms: 3000
"""
RRF = """; config.g
M550 P"Workbee"
M584 X0 Y1:2 Z3
M566 X500 Y500 Z50 ; jerk
M203 X6000 Y6000.00 Z1000
M201 X500 Y500 Z150
M204 P300 T400
M208 X0 Y0 S1
M208 X770 Y760 S0
m208 Z-85:0
"""


class Machine(in_folder.InFolder):
    program = SERVOMILL

    def text(self, settings, *arguments, name="settings"):
        self.write(name, settings)
        return self.servomill("machine", "from", name, "-o", "-", *arguments)

    def read(self, settings, *arguments, name="settings"):
        return tomllib.loads(self.text(settings, *arguments, name=name).stdout)

    def faults(self, settings, *arguments):
        self.write("settings", settings)
        return self.servomill("machine", "from", "settings", "-o", "-", *arguments, status=2).stderr.splitlines()


class LinuxCnc(Machine):
    def test_axes_have_the_stricter_limit_of_axis_and_joint(self):
        machine = self.read(INI)
        self.assertEqual(machine["name"], 'my "mill"')
        X = machine["axis"]["X"]
        self.assertEqual((X["v_max"], X["a_max"], X["travel_mm"]), ("50 mm/s", "400 mm/s^2", [-10.5, 290]))
        self.assertEqual(machine["axis"]["Z"]["v_max"], "20 mm/s")

    def test_every_value_has_the_line_that_it_is_from(self):
        text = self.text(INI).stdout
        self.assertRegex(text, r'v_max = "50 mm/s" +# \[AXIS_X\] MAX_VELOCITY, line 16\n')
        self.assertRegex(text, r"travel_mm = \[-10.5, 290\] +# \[AXIS_X\] MIN_LIMIT, line 14; \[JOINT_0\] MAX_LIMIT, line 20\n")

    def test_what_the_file_does_not_give_is_a_comment_or_a_named_assumption(self):
        done = self.text(INI)
        self.assertIn("# travel_mm: not given\n", done.stdout)
        self.assertIn("# travel_mm: not given, but the upper end ([JOINT_2] MAX_LIMIT, line 28)\n", done.stdout)
        self.assertRegex(done.stdout, r'j_max = "400000 mm/s\^3" +# assumed: acceleration rises within 1 ms\n')
        self.assertIn("# period of the setpoints: 1 ms ([EMCMOT] SERVO_PERIOD, line 4)", done.stdout)
        self.assertIn("  assumed: j_max: acceleration rises within 1 ms, as LinuxCNC plans with constant acceleration", done.stderr)
        self.assertIn("  assumed: path_tolerance_um = 10: ", done.stderr)
        self.assertIn("  note: [TRAJ] MAX_LINEAR_VELOCITY = 60 (settings:9:1) limits the path velocity", done.stderr)

    def test_inches_become_millimetres(self):
        for word in ("inch", "in", "imperial", "0.0393700787401574803"):
            machine = self.read(INI.replace("LINEAR_UNITS = mm", f"LINEAR_UNITS = {word}"))
            self.assertEqual(machine["axis"]["Z"]["v_max"], "508 mm/s", word)
            self.assertEqual(machine["axis"]["X"]["travel_mm"], [-266.7, 7366], word)

    def test_a_tolerance_is_in_the_unit_of_its_code(self):
        def tolerance(code, units="mm"):
            text = INI.replace("LINEAR_UNITS = mm", f"LINEAR_UNITS = {units}")
            return self.read(text + f"[RS274NGC]\nRS274NGC_STARTUP_CODE = {code}\n")["nc"]["path_tolerance_um"]
        self.assertEqual(tolerance("G17 G21 G64P0.005"), 5)
        self.assertEqual(tolerance("g20 g64 p0.001 q0.001"), 25.4)
        self.assertEqual(tolerance("G64 P0.001", "inch"), 25.4)
        self.assertEqual(tolerance("G64"), 10)

    def test_a_gantry_has_one_axis_of_two_joints(self):
        text = INI.replace("KINEMATICS = trivkins", "KINEMATICS = trivkins coordinates=XYYZ kinstype=BOTH")
        text = text.replace("[JOINT_2]", "[JOINT_1]\nMAX_VELOCITY = 44\n[JOINT_2]\nMAX_VELOCITY = 33\n[JOINT_3]")
        axes = self.read(text)["axis"]
        self.assertEqual([*axes], ["X", "Y", "Z"])
        self.assertEqual((axes["Y"]["v_max"], axes["Z"]["v_max"]), ("33 mm/s", "20 mm/s"))

    def test_rotary_axes_are_in_the_table_unless_the_kinematics_is_known(self):
        more = "[JOINT_3]\nMAX_VELOCITY = 360\nMAX_ACCELERATION = 1000\nMIN_LIMIT = -120\nMAX_LIMIT = 120\n" \
               "[JOINT_4]\nMAX_VELOCITY = 180\nMAX_ACCELERATION = 500\nWRAPPED_ROTARY = 1\nMIN_LIMIT = -1\nMAX_LIMIT = 1\n"
        five = INI.replace("COORDINATES = X Y Z", "COORDINATES = XYZAC") + more
        machine = self.read(five)
        self.assertEqual(machine["structure"], "[w C' A' b X Y Z (C1) t]")
        self.assertEqual(machine["axis"]["A"], {"travel_deg": [-120, 120], "v_max": "360 deg/s", "a_max": "1000 deg/s^2",
                                                "j_max": "1000000 deg/s^3"})
        self.assertNotIn("travel_deg", machine["axis"]["C"])
        known = self.text(five.replace("trivkins", "xyzac-trt-kins"))
        self.assertNotIn("assumed: structure", known.stderr)
        self.assertIn("the centres of the rotary axes are pins of HAL", known.stdout)
        given = self.read(five, "--structure", "[w b X Y Z A (C1) t]")
        self.assertEqual((given["structure"], [*given["axis"]]), ("[w b X Y Z A (C1) t]", ["X", "Y", "Z", "A"]))

    def test_files_of_old_versions_number_their_axes(self):
        old = "[EMC]\nVERSION = $Revision$\n[EMCMOT]\nSERVO_PERIOD = 1000000\n[TRAJ]\nCOORDINATES = X Z\nLINEAR_UNITS = inch\n" \
              "[AXIS_0]\nMAX_VELOCITY = 1\nMAX_ACCELERATION = 10\n[AXIS_2]\nMAX_VELOCITY = 2\nMAX_ACCELERATION = 20\n"
        axes = self.read(old)["axis"]
        self.assertEqual({letter: axis["v_max"] for letter, axis in axes.items()}, {"X": "25.4 mm/s", "Z": "50.8 mm/s"})

    def test_included_files_count_and_are_named(self):
        self.write("limits.inc", "[AXIS_Y]\nMAX_VELOCITY = 7\n")
        text = self.text("#INCLUDE limits.inc\n" + INI).stdout
        self.assertRegex(text, r'v_max = "7 mm/s" +# \[AXIS_Y\] MAX_VELOCITY, limits.inc:2\n')

    # motion.c of LinuxCNC: servo_period_nsec = 1000000
    def test_without_a_servo_period_it_is_that_of_motmod(self):
        done = self.text(INI.replace("SERVO_PERIOD = 1000000", ""))
        self.assertIn('j_max = "400000 mm/s^3"', self.text(INI).stdout)
        self.assertIn('j_max = "400000 mm/s^3"', done.stdout)
        self.assertNotIn("period of the setpoints", done.stdout)
        self.assertIn("[EMCMOT] SERVO_PERIOD is missing: 1 ms is the default of motmod", done.stderr)

    def test_faults_have_their_lines(self):
        self.assertEqual(self.faults(INI.replace("MAX_VELOCITY = 60", "MAX_VELOCITY = fast").replace("SERVO_PERIOD = 1000000", "SERVO_PERIOD = 0")),
                         ["settings:4:1: error: [EMCMOT] SERVO_PERIOD = 0; must be > 0",
                          "settings:21:1: error: [JOINT_0] MAX_VELOCITY = fast; must be a number"])
        self.assertEqual(self.faults(INI.replace("LINEAR_UNITS = mm", "LINEAR_UNITS = furlong")),
                         ["settings:7:1: error: [TRAJ] LINEAR_UNITS = furlong; is no unit"])
        self.assertEqual(self.faults(INI.replace("[AXIS_Y]\nMAX_VELOCITY = 50\n", "")),
                         ["settings: error: does not give the largest velocity of Y: [AXIS_Y] MAX_VELOCITY",
                          "settings: error: does not give the largest acceleration of Y: [AXIS_Y] MAX_ACCELERATION"])
        self.assertEqual(self.faults(INI.replace("X Y Z", "X Y Z A B C") + "".join(
            f"[AXIS_{axis}]\nMAX_VELOCITY = 1\nMAX_ACCELERATION = 1\n" for axis in "ABC")),
            ["settings: error: has three rotary axes, but at most two are supported: choose them with --structure"])

    @unittest.skipUnless(os.path.isdir(SAMPLES), "linuxcnc-uspace is not installed")
    def test_sample_configurations_of_linuxcnc_are_read(self):
        read, refused = 0, []
        for file in sorted(glob.glob(SAMPLES + "/sim/axis/*.ini")):
            done = subprocess.run([SERVOMILL, "machine", "from", file, "-o", "-"], capture_output=True, text=True, check=False)
            if done.returncode == 0:
                tomllib.loads(done.stdout)
                read += 1
            else:
                refused.append(done.stderr)
        self.assertGreater(read, 10)
        for fault in refused:
            self.assertRegex(fault, "three rotary axes|does not give the largest|is not known as settings")


class Others(Machine):
    def test_grbl(self):
        machine = self.read(GRBL)
        self.assertEqual(machine["nc"], {"reader": "grbl", "decimal_point": "calculator", "path_tolerance_um": 20, "spindle_time_s": 4.5})
        self.assertEqual(machine["axis"]["X"], {"travel_mm": [-290, 0], "v_max": "6000 mm/min", "a_max": "500 mm/s^2", "j_max": "50000 mm/s^3"})
        self.assertEqual(machine["axis"]["A"], {"v_max": "3600 deg/min", "a_max": "720 deg/s^2", "j_max": "72000 deg/s^3"})
        self.assertEqual(machine["structure"], "[w A' b X Y Z (C1) t]")

    def test_of_a_setting_that_comes_twice_the_last_counts(self):
        self.assertEqual(self.read(GRBL + "$110=1200\n")["axis"]["X"]["v_max"], "1200 mm/min")
        self.assertEqual(self.faults(GRBL.replace("$121=400.000", "$121=-4")), ["settings:9:1: error: $121 = -4; must be > 0"])

    def test_fluidnc(self):
        machine = self.read(FLUIDNC)
        self.assertEqual(machine["nc"], {"reader": "grbl", "decimal_point": "calculator", "path_tolerance_um": 15, "spindle_time_s": 3})
        self.assertEqual(machine["axis"]["X"], {"travel_mm": [10, 310], "v_max": "5000 mm/min", "a_max": "250 mm/s^2", "j_max": "25000 mm/s^3"})
        self.assertEqual(machine["axis"]["Z"]["travel_mm"], [-82, -2])
        self.assertEqual(machine["structure"], "[w b X Z (C1) t]")
        self.assertEqual(self.faults(FLUIDNC.replace("5000.000", "quick")),
                         ["settings:8:5: error: axes/x/max_rate_mm_per_min = quick; must be a number"])

    def test_reprapfirmware(self):
        done = self.text(RRF)
        machine = tomllib.loads(done.stdout)
        self.assertEqual(machine["name"], "Workbee")
        self.assertEqual(machine["axis"]["X"]["travel_mm"], [0, 770])
        self.assertEqual(machine["axis"]["Z"]["travel_mm"], [-85, 0])
        self.assertEqual((machine["axis"]["X"]["a_max"], machine["axis"]["Z"]["a_max"]), ("400 mm/s^2", "150 mm/s^2"))
        self.assertEqual(machine["axis"]["Y"]["v_max"], "6000 mm/min")
        self.assertIn("M204 T, along the path, line 7", done.stdout)
        self.assertIn("note: M566 X500 Y500 Z50 (settings:4:1): instantaneous changes of speed", done.stderr)
        self.assertEqual(self.faults(RRF.replace("Y6000.00", "Y{var.fast}")), ["settings:5:12: error: M203 Y = {var.fast}; must be a number"])
        self.assertIn("G20: settings in inches are not supported", self.faults("G20\n" + RRF)[0])

    def test_choices_replace_assumptions(self):
        done = self.text(RRF, "--acceleration-time", "20 ms", "--path-tolerance", "50 um", "--structure", "[w X' b Y Z (C1) t]")
        machine = tomllib.loads(done.stdout)
        self.assertEqual((machine["axis"]["X"]["j_max"], machine["nc"]["path_tolerance_um"], machine["structure"]),
                         ("20000 mm/s^3", 50, "[w X' b Y Z (C1) t]"))
        self.assertNotIn("assumed", done.stdout + done.stderr)

    def test_the_file_is_a_machine_and_is_not_overwritten(self):
        self.write("grbl.txt", GRBL)
        self.assertEqual(self.servomill("machine", "from", "grbl.txt").stdout.splitlines()[:2],
                         ["grbl.toml:", "  X: -290 ... 0 mm, 6000 mm/min, 500 mm/s^2"])
        self.assertIn("exists", self.servomill("machine", "from", "grbl.txt", status=2).stderr)
        self.servomill("machine", "from", "grbl.txt", "--force", "--quiet")
        self.write("part.ngc", "G21 G90 G0 X-100.\nM2\n")
        done = json.loads(self.servomill("time", "part.ngc", "--machine", "grbl.toml", "--start", "X=0", "--json").stdout)
        v, a, j = 0.1, 0.5, 50.0
        self.assertAlmostEqual(done["time_s"], 0.1 / v + v / a + a / j, places=6)

    def test_limits_that_are_missing_are_named_as_the_control_names_them(self):
        for settings, without, key in ((GRBL, "$122=50.000\n", "acceleration of Z: $122"), (FLUIDNC, "    max_rate_mm_per_min: 900\n", "velocity of Z: axes/z/max_rate_mm_per_min"),
                                       (RRF, " Z150", "acceleration of Z: M201 Z")):
            self.assertEqual(self.faults(settings.replace(without, "")), [f"settings: error: does not give the largest {key}"])

    def test_unknown_files_are_refused(self):
        self.assertEqual(self.faults("hello\n"), ["settings: error: is not known as settings of a control; name it with --control"])
        self.assertIn("has no limits of an axis", self.faults("hello\n", "--control", "grbl")[0])
        self.assertIn("did you mean 'grbl'", self.faults("hello\n", "--control", "gbrl")[0])
        self.assertIn("needs `from SETTINGS`", self.servomill("machine", "to", "x", status=2).stderr)


if __name__ == "__main__":
    unittest.main()
