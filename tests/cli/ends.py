#!/usr/bin/python3
"""How a run ends when it is not let alone: signals, a full disk, files of others. ends.py SERVOMILL"""
import os
import resource
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import h5py

HERE = os.path.dirname(os.path.abspath(__file__))
SERVOMILL = os.path.abspath(sys.argv.pop(1))
SCENARIO = os.path.join(HERE, "gallery", "scenario.toml")
MACHINE = os.path.join(HERE, "..", "..", "scenarios", "guevel2025", "experiment1.toml")
# Minutes of motion, seconds of simulation a case; few rows, so that the first case is on the disk long before the second
# one has run.
LONG = ["--set", "program.feed_override=0.001", "--set", "record.period_ms=10"]
PATIENCE = 60  # s, until something is on the disk; far more than it takes


def servomill(*arguments, **more):
    return subprocess.run([SERVOMILL, *arguments], capture_output=True, text=True, timeout=PATIENCE, check=False, **more)


def wait_for(path, mark):
    """Until the file holds the mark."""
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        if os.path.exists(path):
            with open(path, "rb") as file:
                if mark in file.read():
                    return
        time.sleep(0.02)
    raise AssertionError(f"{path} never held {mark}")


class Ends(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.out = os.path.join(folder.name, "out.h5")
        self.partial = self.out + ".partial"

    def start_and_send(self, what, command="run", mark=b"duration_s", more=()):
        """Begins on one thread and sends the signal when the first case or point is on the disk."""
        process = subprocess.Popen([SERVOMILL, command, SCENARIO, "-j1", "-o", self.out, *LONG, *more],
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        wait_for(self.partial, mark)
        process.send_signal(what)
        stdout, stderr = process.communicate(timeout=PATIENCE)
        return process.returncode, stdout, stderr

    def test_interrupt_keeps_complete_cases_and_says_so(self):
        status, stdout, stderr = self.start_and_send(signal.SIGINT)
        self.assertEqual(status, 130)
        self.assertEqual(stderr, f"interrupted; saved in {self.partial}: complete cases nominal; interrupted table\n")
        self.assertFalse(os.path.exists(self.out))
        again = servomill("compare", "--json", self.partial)
        self.assertEqual((again.returncode, again.stderr), (0, ""))
        # a case that was interrupted has no numbers
        self.assertIn('"case": "table"', again.stdout)
        self.assertIn('"value": null', again.stdout)

    def test_kill_leaves_no_file_under_the_final_name(self):
        status, _, _ = self.start_and_send(signal.SIGKILL)
        self.assertEqual(status, -signal.SIGKILL)
        self.assertFalse(os.path.exists(self.out))
        again = servomill("compare", self.partial)
        self.assertEqual((again.returncode, again.stderr), (0, ""))
        refused = servomill("run", SCENARIO, "-o", self.out)
        self.assertEqual(refused.returncode, 2)
        self.assertEqual(refused.stderr, f"{self.partial}: error: exists, left by an unfinished run; "
                                         "use --force to overwrite\n")
        forced = servomill("run", SCENARIO, "-q", "-o", self.out, "--force")
        self.assertEqual((forced.returncode, forced.stderr), (0, ""))
        self.assertFalse(os.path.exists(self.partial))

    def test_interrupted_sweep_keeps_its_complete_points(self):
        points = 'sweep={"program.feed_override"=[1.0,0.001]}'
        process = subprocess.Popen([SERVOMILL, "sweep", SCENARIO, "-o", self.out, "--json", "--set", points],
                                   stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, bufsize=1)
        self.addCleanup(process.stdout.close)
        first = process.stdout.readline()  # printed as soon as it is known
        process.send_signal(signal.SIGINT)
        _, stderr = process.communicate(timeout=PATIENCE)
        self.assertIn("program.feed_override = 1.0", first)
        self.assertEqual(process.returncode, 130)
        self.assertEqual(stderr, f"interrupted; saved in {self.partial}: 1 complete points of 2\n")
        self.assertFalse(os.path.exists(self.out))

    def test_sweep_that_was_killed_at_its_first_writes_begins_anew(self):
        sweep = ["sweep", SCENARIO, "-q", "-o", self.out, "--set", 'sweep={"program.feed_override"=[1.0,0.9]}']
        self.assertEqual(servomill(*sweep).returncode, 0)
        with open(self.out, "rb") as file:
            first = file.read(2048)
        for written in (0, 96, 2047):
            os.remove(self.out)
            os.remove(self.out.removesuffix(".h5") + ".csv")
            with open(self.partial, "wb") as file:
                file.write(first[:written])
            again = servomill(*sweep)
            self.assertEqual((again.returncode, again.stderr), (0, ""), f"{written} bytes")
            self.assertTrue(os.path.exists(self.out))
            self.assertFalse(os.path.exists(self.partial))

    def test_sweep_does_not_overwrite_a_small_file_of_others(self):
        with h5py.File(self.partial, "w", libver="latest") as file:
            file.attrs["of_others"] = 1
        before = os.stat(self.partial)
        self.assertLess(before.st_size, 2048)
        refused = servomill("sweep", SCENARIO, "-q", "-o", self.out, "--set", 'sweep={"program.feed_override"=[1.0,0.9]}')
        self.assertEqual(refused.returncode, 2)
        self.assertRegex(refused.stderr, r"out\.h5\.partial: error: ")
        self.assertEqual(os.stat(self.partial), before)

    def test_full_disk_is_a_failure_of_the_system(self):
        def only(size):
            def limit():  # as a full disk: the write fails
                signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
                resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))
            return limit
        for size in (0, 4096, 40000, 100000):
            result = servomill("run", SCENARIO, "-o", self.out, "--force", preexec_fn=only(size))
            self.assertEqual(result.returncode, 3, f"{size} bytes")
            self.assertRegex(result.stderr, r"out\.h5\.partial: error: cannot be (written|created): File too large\n")
            self.assertFalse(os.path.exists(self.out))

    def test_full_disk_keeps_what_was_there(self):
        self.assertEqual(servomill("run", SCENARIO, "-q", "-o", self.out).returncode, 0)
        with open(self.out, "rb") as file:
            before = file.read()
        def limit():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))
        self.assertEqual(servomill("run", SCENARIO, "-o", self.out, "--force", preexec_fn=limit).returncode, 3)
        with open(self.out, "rb") as file:
            self.assertEqual(file.read(), before)

    def test_what_may_not_be_read_or_written(self):
        nobody = {"user": 65534} if os.geteuid() == 0 else {}  # root may do everything
        with tempfile.TemporaryDirectory() as folder:
            os.chmod(folder, 0o755)
            closed = os.path.join(folder, "closed.ngc")
            with open(closed, "w", encoding="utf-8") as file:
                file.write("M2\n")
            os.chmod(closed, 0)
            try:
                read = servomill("canon", closed, **nobody)
            except PermissionError:
                self.skipTest("others may not run the program that was built")
            self.assertEqual((read.returncode, read.stderr), (2, f"{closed}: error: cannot be read: Permission denied\n"))
            os.chmod(folder, 0o555)
            result = os.path.join(folder, "out.h5")
            written = servomill("run", SCENARIO, "-o", result, **nobody)
            self.assertEqual(written.returncode, 3, written.stderr)
            self.assertEqual(written.stderr, f"{result}.partial: error: cannot be created: Permission denied\n")

    def test_a_diverging_loop_stops_its_case_and_the_others_go_on(self):
        result = servomill("run", SCENARIO, "-q", "-o", self.out, "--set", "machine.nc.Kv=20000",
                           "--set", "machine.nc.check_stability=false",
                           "--set", "machine.nc.following_error_limit_mm=0.5", "--set", "case[0].servo=ideal")
        self.assertEqual(result.returncode, 1)
        self.assertRegex(result.stderr, r"(?m)^case table stopped: axis [XYZ]: following error beyond 0\.5 mm at \d+\.\d{4} s\n$")
        self.assertTrue(os.path.exists(self.out))

    def test_friction_that_the_step_does_not_resolve_is_no_response(self):
        stiff = ('machine_override.axis.X.friction={model="set_valued", coulomb=0, breakaway=600, '
                 'stribeck_velocity=1e-9}')
        why = 'friction too stiff for the exact integrator; use integrator = "cvode"'
        stepped = servomill("step", MACHINE, "--axis", "X", "--kind", "position", "--set", stiff)
        self.assertEqual((stepped.returncode, stepped.stderr), (1, f"axis X, position step: {why}\n"))
        measured = servomill("bode", MACHINE, "--axis", "X", "--points", "2", "--f-max", "20", "--velocity", "0 m/s",
                             "--set", stiff)
        self.assertEqual((measured.returncode, measured.stderr),
                         (1, f"axis X, position loop: {why}; nothing is measured\n"))

    def test_no_axis_is_measured_beyond_its_velocity(self):
        result = servomill("bode", MACHINE, "--axis", "X", "--velocity", "1000 m/s")
        self.assertEqual(result.returncode, 2)
        self.assertRegex(result.stderr,
                         r"^--velocity: error: '1000 m/s' must be no faster than axis X, which reaches [\d.]+ mm/s\n$")


if __name__ == "__main__":
    unittest.main()
