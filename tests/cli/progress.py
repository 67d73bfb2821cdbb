#!/usr/bin/python3
"""The line that shows how far a command is: on a terminal only, from two seconds on, and gone at the end. progress.py SERVOMILL [AtOnce|Shown]"""
import os
import pty
import random
import re
import select
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

HERE = os.path.dirname(os.path.abspath(__file__))
SERVOMILL = os.path.abspath(sys.argv.pop(1))
SCENARIO = os.path.join(HERE, "gallery", "scenario.toml")
LEARNING = os.path.join(HERE, "..", "..", "scenarios", "precompensation", "s_part.toml")
LONG = ["-j1", "--set", "program.feed_override=0.0002", "--set", "record.period_ms=50"]
DELAY = 2.0  # s, before anything is shown
MAX_END = 0.5  # s, after an interrupt
PATIENCE = 120  # s
COMPUTED = 0.1  # s of the processor, after which a command has begun and is far from its end
BAR = r"\[=* *\] +\d+ %"
PROGRESS = BAR + r"|so far|[\d.]+ (s|min|h) left"


def sweep_of(points):
    feeds = ",".join(f"{0.002 + 0.0001 * n:.4f}" for n in range(points))
    return ["-j1", "--set", 'sweep={"program.feed_override"=[%s]}' % feeds]


MANY, MORE = sweep_of(8), sweep_of(24)


def computed(process):
    """Time of the processor that it has taken, s."""
    with open(f"/proc/{process.pid}/stat", encoding="utf-8") as file:
        user, system = file.read().rsplit(")", 1)[1].split()[11:13]
    return (int(user) + int(system)) / os.sysconf("SC_CLK_TCK")


def halt(process):
    """Holds a command that has begun until progress would be shown: while it waits, other tests compute."""
    begin = time.monotonic()
    while process.poll() is None and computed(process) < COMPUTED:
        assert time.monotonic() < begin + PATIENCE, "it does not compute"
        time.sleep(0.02)
    process.send_signal(signal.SIGSTOP)
    time.sleep(DELAY)
    process.send_signal(signal.SIGCONT)


class Terminal:
    """A command on a terminal of its own; `seen` is all that it has written there."""

    def __init__(self, *arguments, stdout=None, cwd=None):
        self.ours, theirs = pty.openpty()
        self.begin = time.monotonic()
        self.process = subprocess.Popen([SERVOMILL, *arguments], stdin=subprocess.DEVNULL, stdout=stdout or theirs, stderr=theirs, cwd=cwd)
        os.close(theirs)
        self.seen = ""
        self.first = None  # s, when progress was shown first

    def read(self, timeout):
        """False behind the end."""
        if not select.select([self.ours], [], [], timeout)[0]:
            return True
        try:
            data = os.read(self.ours, 65536)
        except OSError:  # nobody writes any more
            return False
        self.seen += data.decode()
        if self.first is None and re.search(PROGRESS, self.seen):
            self.first = time.monotonic() - self.begin
        return bool(data)

    def wait_for(self, pattern):
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end and not re.search(pattern, self.seen):
            if not self.read(0.1):
                break
        found = re.search(pattern, self.seen)
        assert found, f"{pattern} was never shown: {self.seen!r}"
        return found.group()

    def end(self):
        """Reads to the end; the exit status."""
        while self.read(PATIENCE):
            pass
        os.close(self.ours)
        return self.process.wait(PATIENCE)

    def interrupt(self):
        """Ends the command; the time (s) that it takes."""
        begin = time.monotonic()
        self.process.send_signal(signal.SIGINT)
        self.process.wait(PATIENCE)
        took = time.monotonic() - begin
        self.end()
        return took

    def screen(self):
        """The text that is left on the line: a carriage return goes back to its beginning."""
        lines = []
        for line in self.seen.replace("\r\n", "\n").split("\n"):
            shown = []
            for part in line.split("\r"):
                shown[:len(part)] = part
            lines.append("".join(shown).rstrip())
        return "\n".join(lines)


class Watched(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def start(self, *arguments, **more):
        return Terminal(*arguments, cwd=self.folder, **more)

    def start_and_halt(self, *arguments, **more):
        terminal = self.start(*arguments, **more)
        halt(terminal.process)
        return terminal

    def interrupted(self, terminal):
        """Ends it, and looks at what remains."""
        took = terminal.interrupt()
        self.assertEqual(terminal.process.returncode, 130)
        self.assertNotRegex(terminal.screen(), PROGRESS)
        self.assertIn("interrupted", terminal.screen())
        return took


class AtOnce(Watched):
    """What other work on the machine would delay beyond its limit."""

    def test_shows_nothing_of_a_short_command(self):
        terminal = self.start("run", SCENARIO)
        self.assertEqual(terminal.end(), 0)
        self.assertNotRegex(terminal.seen, PROGRESS)

    def test_an_interrupt_erases_it(self):
        times = []
        while len(times) < 3 and (not times or times[-1] > MAX_END):  # a shared machine may hold it back for so long
            terminal = self.start("run", SCENARIO, "--force", "-o", f"{len(times)}.h5", *LONG)
            terminal.wait_for(BAR)
            times.append(self.interrupted(terminal))
        self.assertLess(min(times), MAX_END)


class Shown(Watched):
    def test_comes_after_two_seconds_and_goes_at_the_end(self):
        terminal = self.start("sweep", SCENARIO, "-j1", "--set", 'sweep={"program.feed_override"=[0.0015,0.0030,0.0031,0.0032,0.0033]}')
        terminal.wait_for(BAR + r", [\d.]+ (s|min|h) left")
        self.assertGreaterEqual(terminal.first, DELAY - 0.1)
        self.assertEqual(terminal.end(), 0)
        self.assertNotRegex(terminal.screen(), BAR)
        self.assertIn("written to", terminal.screen())

    def quiet(self, *arguments, stdout=None):
        """True if no progress was on the terminal after more than four seconds."""
        terminal = self.start_and_halt("sweep", SCENARIO, *MORE, *arguments, stdout=stdout)
        if terminal.process.stdout:
            self.addCleanup(terminal.process.stdout.close)
        end = time.monotonic() + 2.0
        while time.monotonic() < end:
            terminal.read(0.1)
        self.assertIsNone(terminal.process.poll(), "it should take longer")
        seen = terminal.seen
        terminal.interrupt()
        return not re.search(PROGRESS, seen)

    def test_is_not_there_with_json_or_quiet(self):
        self.assertTrue(self.quiet("--json"))
        self.assertTrue(self.quiet("--quiet"))

    def test_is_not_there_where_a_pipe_is_read(self):
        self.assertTrue(self.quiet(stdout=subprocess.PIPE))

    def test_is_not_there_without_a_terminal(self):
        process = subprocess.Popen([SERVOMILL, "sweep", SCENARIO, *MANY], cwd=self.folder, stdin=subprocess.DEVNULL,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        halt(process)
        threading.Timer(2.0, process.send_signal, [signal.SIGINT]).start()
        _, stderr = process.communicate(timeout=PATIENCE)
        self.assertEqual(process.returncode, 130)
        self.assertRegex(stderr, r"^interrupted[^\r]*$")

    def test_counts_points_of_a_sweep(self):
        terminal = self.start_and_halt("sweep", SCENARIO, *MANY)
        terminal.wait_for(BAR + r".*, \d of 8 points")
        self.interrupted(terminal)

    def test_forecasts_a_measurement_whose_low_frequencies_take_longer(self):
        terminal = self.start_and_halt("bode", SCENARIO, "--axis", "Y", "--loop", "velocity", "--f-min", "0.1", "--points", "400")
        terminal.wait_for(BAR + r", [\d.]+ (s|min|h) left")
        self.interrupted(terminal)

    def test_says_only_what_was_done_where_nothing_can_be_forecast(self):
        terminal = self.start_and_halt("bode", SCENARIO, "--axis", "Y", "--loop", "all", "--f-min", "0.1", "--points", "400")
        said = terminal.wait_for(r"\d of 3 loops.*? so far")
        self.assertNotIn("left", said)
        self.interrupted(terminal)

    def test_counts_speeds_of_stability_lobes(self):
        terminal = self.start_and_halt("lobes", "--stiffness", "20 N/um", "--frequency", "500 Hz", "--damping", "0.03", "--Ktc", "800",
                              "--Krc", "300", "--teeth", "4", "--points", "2000", "--speed-min", "500", "--threads", "1")
        terminal.wait_for(BAR + r".*, \d+ of 2000 speeds")
        self.interrupted(terminal)

    def test_counts_trial_runs_of_strategies_that_learn(self):
        terminal = self.start_and_halt("run", LEARNING, "-o", "learnt.h5")
        terminal.wait_for(r"\d+ of \d+ trial runs")
        self.interrupted(terminal)

    def test_counts_lines_of_a_program(self):
        with open(os.path.join(self.folder, "long.ngc"), "w", encoding="utf-8") as out:
            out.write("G21 G90\nF1000\n" + "".join(f"G1 X{n % 97} Y{n % 89}\n" for n in range(1_000_000)) + "M2\n")
        terminal = self.start_and_halt("check", "long.ngc")
        terminal.wait_for(r"of \d+ lines")
        self.interrupted(terminal)

    def write_noise(self, rows):
        """A recording of two channels without a period."""
        noise = random.Random(1)
        with open(os.path.join(self.folder, "noise.csv"), "w", encoding="utf-8") as out:
            out.write("time [s];u [A];y [mm/s]\n")
            out.writelines(f"{0.001 * n:.3f};{noise.gauss(0, 1):.6f};{noise.gauss(0, 1):.6f}\n" for n in range(rows))

    def test_counts_lines_of_a_spectrum(self):
        self.write_noise(1_000_000)
        terminal = self.start_and_halt("response", "noise.csv", "--input", "u", "--output", "y")
        terminal.wait_for(BAR + r".* of 500000 lines")
        self.interrupted(terminal)

    def test_counts_lines_of_a_recording(self):
        names = ";".join(f"channel {n} [A]" for n in range(40))
        with open(os.path.join(self.folder, "wide.csv"), "w", encoding="utf-8") as out:
            out.write(f"time [s];{names}\n")
            out.writelines(f"{0.001 * n:.3f}{';1.5' * 40}\n" for n in range(1_000_000))
        terminal = self.start_and_halt("recording", "wide.csv")
        terminal.wait_for(r"of 1000001 lines")
        self.interrupted(terminal)

    def test_fits_on_a_line_of_the_terminal(self):
        terminal = self.start_and_halt("run", LEARNING, "-o", "learnt.h5")
        terminal.wait_for(r"trial runs")
        self.interrupted(terminal)
        for line in re.split(r"[\r\n]", terminal.seen):
            self.assertLessEqual(len(line), 80)


if __name__ == "__main__":
    unittest.main()
