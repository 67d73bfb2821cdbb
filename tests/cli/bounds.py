#!/usr/bin/python3
"""Every input has a bound that is checked before the work. bounds.py SERVOMILL"""
import math
import os
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

HERE = os.path.dirname(os.path.abspath(__file__))
SERVOMILL = os.path.abspath(sys.argv.pop(1))
GALLERY = os.path.join(HERE, "gallery")
LIMIT = 20  # s; what is bounded ends in far less
MEMORY = 4_000_000_000  # bytes, address space
DEVICE = "is a device, not a regular file"
PIPE = "is a pipe, not a regular file"
LARGE = "is 3 GB, larger than the limit of 2 GB"


def limit_memory():
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))


class Bounds(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = temporary.name
        for name in ("scenario.toml", "machine.toml", "part.ngc"):
            shutil.copy(os.path.join(GALLERY, name), self.folder)
        self.write("cut.ngc", "G21 G90 G17 G54\nG0 X0 Y0 Z5\nG1 Z-1 F200\nG1 X100\nM2\n")
        self.write("errors.toml", "[errors.measured]\nEC0Y = { um_per_m = 120.0 }\n")
        self.write("part.cls", "LOADTL/1\nFEDRAT/600\nGOTO/0,0,10\n")
        os.mkfifo(self.path("pipe"))
        self.write("large", "")
        os.truncate(self.path("large"), 3_000_000_000)  # takes no room on the disk

    def path(self, name):
        return os.path.join(self.folder, name)

    def write(self, name, text):
        with open(self.path(name), "w", encoding="utf-8") as file:
            file.write(text)

    def run_here(self, *arguments):
        """What it says on standard error, and its status; it must end by itself."""
        begin = time.monotonic()
        result = subprocess.run([SERVOMILL, *arguments], capture_output=True, text=True, timeout=LIMIT, check=False,
                                cwd=self.folder, preexec_fn=limit_memory)
        self.assertLess(time.monotonic() - begin, LIMIT, arguments)
        return result.returncode, result.stderr

    def test_what_has_no_end_is_no_input(self):
        machine = ["--machine", "machine.toml"]
        for name, why in (("/dev/zero", DEVICE), ("/dev/random", DEVICE), ("pipe", PIPE)):
            read = f"{name}: error: cannot be read: {why}\n"
            for command in (["canon", name], ["check", name], ["run", name], ["sweep", name], ["compare", name],
                            ["merge", name, "-o", "out.h5"], ["canon", "cut.ngc", "--tools", name],
                            ["canon", "cut.ngc", "--parameter-file", name], ["canon", "cut.ngc", "--machine", name],
                            ["post", name, *machine, "-o", "out.ngc"], ["post", "part.cls", "--machine", name, "-o", "out.ngc"],
                            ["post", "part.cls", *machine, "--tools", name, "-o", "out.ngc"],
                            ["compensate", name, *machine, "--errors", "errors.toml", "--work-offset", "X=0,Y=0,Z=0",
                             "-o", "out.ngc"],
                            ["compensate", "cut.ngc", "--machine", name, "-o", "out.ngc"],
                            ["compensate", "cut.ngc", *machine, "--errors", name, "-o", "out.ngc"],
                            ["table", name, "--format", "csv", "-o", "out"]):
                self.assertEqual(self.run_here(*command), (2, read), command)
            self.assertEqual(self.run_here("run", "scenario.toml", "--set", f"program.file={name}"),
                             (2, f"--set program.file={name}: error: program '{name}' cannot be read: {why}\n"))
            self.assertEqual(self.run_here("run", "scenario.toml", "--set", f"machine={name}"),
                             (2, f"--set machine={name}: error: machine '{name}' cannot be read: {why}\n"))

    def test_files_have_a_size(self):
        self.assertEqual(self.run_here("post", "large", "--machine", "machine.toml", "-o", "out.ngc"),
                         (2, f"large: error: cannot be read: {LARGE}\n"))
        self.assertEqual(self.run_here("run", "large"),
                         (2, "large: error: cannot be read: is 3 GB, larger than the limit of 100 MB\n"))

    def test_a_line_is_refused_at_its_limit(self):
        for command in ("canon", "check"):
            begin = time.monotonic()
            status, said = self.run_here(command, "large")
            self.assertEqual(status, 2)
            self.assertRegex(said, r"^large:1:")
            self.assertLess(time.monotonic() - begin, 5.0, "3 GB have been read")

    def test_way_over_feed_is_known_at_once(self):
        for override, hours in (("1e-06", "179"), ("2e-09", "8.97e+04"), ("1e-12", "1.79e+08")):
            for command in ("run", "check", "budget"):
                self.assertEqual(self.run_here(command, "scenario.toml", "--set", f"program.feed_override={override}"),
                                 (2, f"part.ngc: error: takes {hours} h at program.feed_override = {override}; must be <= "
                                     "record.max_duration_h = 24: check feeds and feed_override, or raise record.max_duration_h\n"))

    def test_signals_have_a_size(self):
        self.assertEqual(self.run_here("run", "scenario.toml", "--set", "program.feed_override=2e-4",
                                       "--set", "record.max_size_GB=1", "--set", "record.period_ms=1"),
                         (2, "part.ngc: error: takes 108 min in 2 cases and 6.5e+06 rows: 2.9 GB of signals; must be <= "
                             "record.max_size_GB = 1; raise it, or record fewer rows: record.period_ms = 1\n"))

    def first_lines(self, count, *changes, output="out.h5"):
        """What a run says first; it is interrupted then."""
        settings = [word for change in changes for word in ("--set", change)]
        process = subprocess.Popen([SERVOMILL, "run", "scenario.toml", "-o", output, "--force", *settings],
                                   stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, cwd=self.folder,
                                   preexec_fn=limit_memory)
        said = [process.stderr.readline() for _ in range(count)]
        process.send_signal(signal.SIGINT)
        process.communicate(timeout=LIMIT)
        return said

    def test_memory_does_not_bound_the_duration(self):
        self.assertRegex(self.first_lines(1, "program.feed_override=1e-4")[0],
                         r"^estimate: 3\.59 h of motion, 1\.3e\+07 rows, 5\.9 GB of signals in a file of 0\.98 GB, 0\.\d+ GB of memory, ")

    def test_the_size_of_signals_is_known_before_planning(self):
        experiment = os.path.join(HERE, "..", "..", "scenarios", "guevel2025", "experiment1.toml")
        begin = time.monotonic()
        status, said = self.run_here("run", experiment, "--set", "program.feed_override=1e-3")
        self.assertEqual(status, 2)
        self.assertRegex(said, r"error: takes \S+ h in \d+ cases and \S+ rows: \S+ GB of signals; must be <= record.max_size_GB = 8")
        self.assertLess(time.monotonic() - begin, 5.0, "the motion has been planned")

    def test_what_is_long_or_large_is_reported_before_it_begins(self):
        said = self.first_lines(1, "program.feed_override=2e-4")[0]
        self.assertRegex(said, r"^estimate: 108 min of motion, 6\.5e\+06 rows, 2\.9 GB of signals in a file of 0\.4\d GB, "
                         r"0\.\d+ GB of memory, about \d+ (s|min) of computing\n$")

    def test_a_disk_that_is_too_small_is_reported_before_it_begins(self):
        disk, slow = self.path("disk"), "program.feed_override=2e-4"
        os.mkdir(disk)
        tmpfs = ["mount", "-t", "tmpfs", "-o", "size=900m", "tmpfs", disk]   # takes memory as it is filled
        if subprocess.run(tmpfs, stderr=subprocess.DEVNULL, check=False).returncode != 0:
            self.skipTest("no file system of a chosen size may be mounted here")
        self.addCleanup(subprocess.run, ["umount", disk], check=True)
        status, said = self.run_here("run", "scenario.toml", "-o", "disk/out.h5", "--set", slow)
        self.assertEqual(status, 2, said)
        self.assertRegex(said, r"^estimate: .*\npart\.ngc: error: takes 0\.9\d GB of disk space while running; \S+/disk has 0\.94 GB free: "
                         r"lower record\.max_size_GB = 8 or choose another file \(--output\)\n$")
        status, said = self.run_here("budget", "scenario.toml", "--quantity", "tool_deviation", "-o", "disk/out.h5", "--set", slow)
        self.assertEqual(status, 2, said)
        self.assertRegex(said, r"^estimate: \d+ runs, each .*\npart\.ngc: error: takes [2-9]\.\d GB of disk space while running; \S+/disk has 0\.94 GB free: lower ")
        self.assertEqual(os.listdir(disk), [])
        subprocess.run(["mount", "-o", "remount,size=1100m", disk], check=True)
        self.first_lines(1, slow, output="disk/out.h5")
        self.assertNotEqual(os.listdir(disk), [], "the run has begun")

    def test_a_full_folder_of_temporary_files_is_named_with_a_remedy(self):
        disk = self.path("temporary")
        os.mkdir(disk)
        if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=2m", "tmpfs", disk], stderr=subprocess.DEVNULL, check=False).returncode != 0:
            self.skipTest("no file system of a chosen size may be mounted here")
        self.addCleanup(subprocess.run, ["umount", disk], check=True)
        blocks = (f"G1 X{math.sin(0.37 * n):.5f} Y{math.cos(0.61 * n):.5f} Z{math.sin(0.83 * n):.5f} F{3000 + n % 97}\n" for n in range(600_000))
        self.write("long.ngc", "G21 G90 G94 G54\n" + "".join(blocks) + "M2\n")
        run = [SERVOMILL, "run", "scenario.toml", "--set", "program.file=long.ngc", "-q"]

        def said_with(size):
            subprocess.run(["mount", "-o", f"remount,size={size}", disk], check=True)
            done = subprocess.run(run, capture_output=True, text=True, timeout=10 * LIMIT, check=False, cwd=self.folder,
                                  preexec_fn=limit_memory, env={**os.environ, "TMPDIR": disk})
            return done.returncode, done.stderr
        self.assertEqual(said_with("100k"), (3, f"{disk}: error: text of the program cannot be written: No space left on device; "
                                                 "TMPDIR chooses another folder\n"))
        status, said = said_with("44m")
        self.assertEqual(status, 2, said)
        self.assertRegex(said, r"^long\.ngc: error: its planned motion takes about 0\.025 GB of temporary files; \S+/temporary has 0\.0\d+ GB free: "
                               r"choose another folder \(TMPDIR\)\n$")
        self.assertEqual(os.listdir(disk), [])

    def test_blocks_of_corrected_programs_are_counted_first(self):
        command = ["compensate", "cut.ngc", "--machine", "machine.toml", "--errors", "errors.toml", "--work-offset",
                   "X=0,Y=0,Z=0", "-o", "out.ngc"]
        self.assertEqual(self.run_here(*command, "--max-block", "1 nm"),
                         (2, "--max-block: error: 0.001 um makes 1.1e+08 blocks of 0.106 m of feed; must be <= 1e+07 blocks; "
                             "use a larger value\n"))
        self.assertEqual(self.run_here(*command, "--tolerance", "1e-9 um"),
                         (2, "--tolerance: error: '1e-9 um' must be >= 0.001 um\n"))

    def test_no_number_of_points_is_endless(self):
        for command in (["bode", "scenario.toml", "--axis", "X", "--points", "1000000000"],
                        ["bode", "scenario.toml", "--axis", "X", "--f-min", "1e-9"],
                        ["step", "scenario.toml", "--axis", "X", "--duration", "1e9 s"],
                        ["sweep", "scenario.toml", "--set",
                         'sweep={"program.feed_override"={linear=[0.5,1.0],count=1000000000000}}'],
                        ["sweep", "scenario.toml", "--set",
                         'sweep={"program.feed_override"={linear=[0.5,1.0],count=2000000000}}']):
            status, said = self.run_here(*command)
            self.assertEqual(status, 2, (command, said))
            self.assertRegex(said, "must be ", command)


if __name__ == "__main__":
    unittest.main()
