#!/usr/bin/python3
"""Every command ends within half a second of a signal, at any instant, and nothing is lost.

signals.py SERVOMILL [INSTANTS]    random instants of each command (or environment SERVOMILL_INSTANTS); 3 unless said
"""
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

HERE = os.path.dirname(os.path.abspath(__file__))
ARGUMENTS = [one for one in sys.argv[1:] if not one.startswith("-")]
SERVOMILL = os.path.abspath(ARGUMENTS[0])
INSTANTS = int(ARGUMENTS[1] if len(ARGUMENTS) > 1 else os.environ.get("SERVOMILL_INSTANTS", "3"))
SCENARIOS = os.path.join(HERE, "..", "..", "scenarios")
LIMIT = 0.5  # s
PATIENCE = 120  # s

LONG = ["--set", "program.feed_override=0.02"]
FEEDS = "sweep={\"program.feed_override\"=[0.5,0.2,0.1,0.05]}"


def program(blocks):
    """Small pockets, arcs and all."""
    lines = ["(MSG, flank)", "G21 G90 G17 G54", "T1 M6", "G43 H1", "G0 X0 Y0 Z5", "G1 Z-1 F600"]
    for i in range(blocks):
        x, y = (i * 7) % 100, (i * 3) % 80
        lines.append(f"G1 X{x} Y{y}" if i % 3 else f"G2 X{x + 1} Y{y} I0.5 J0")
        if i % 3 == 0:
            lines[-1] = f"G1 X{x} Y{y}\nG2 X{x + 1} Y{y} I0.5 J0"
    return "\n".join(lines) + "\nG0 Z50\nM2\n"


def locations(count):
    lines = ["PARTNO/TEST", "LOADTL/1", "FEDRAT/600,MMPM"]
    lines += [f"GOTO/{(i * 7) % 100},{(i * 3) % 80},{i % 5},{0.1 * ((i % 7) - 3)},0.1,0.9" for i in range(count)]
    return "\n".join(lines) + "\nEND\n"


FILES = {
    "long.ngc": program(30000),
    "middle.ngc": program(100),
    "part.cls": locations(500),
    "tool.tbl": "T1 P1 Z+50 D6\n",
    "errors.toml": "[errors.measured]\nEC0Y = { um_per_m = 120.0 }\nEXX = { polynomial_um = [0.0, 0.3, -0.002] }\n",
}
TRUNNION = os.path.join(SCENARIOS, "machines", "generic_trunnion_ac.toml")
EXPERIMENT1 = os.path.join(SCENARIOS, "guevel2025", "experiment1.toml")
PART = os.path.join(SCENARIOS, "guevel2025", "experiment1_part.toml")
MACHINE = ["--machine", "machine.toml"]
# a result that has got its name just then is complete
RUN_KEEPS = ["out.h5.partial", "out.h5"]
# name, command, files that may stay when it is interrupted
COMMANDS = [
    ("run", ["run", "scenario.toml", "-o", "out.h5", *LONG], RUN_KEEPS),
    ("run, part and probes", ["run", PART, "-o", "out.h5"], RUN_KEEPS),
    ("run, planning", ["run", "scenario.toml", "-o", "out.h5", "--set", "program.file=middle.ngc"], RUN_KEEPS),
    ("sweep", ["sweep", "scenario.toml", "-o", "out.h5", "--set", FEEDS], RUN_KEEPS),
    ("sweep with signals", ["sweep", "scenario.toml", "-o", "out.h5", "--keep-signals", "--set", FEEDS],
     RUN_KEEPS + ["out.series"]),
    ("budget", ["budget", "scenario.toml", "-o", "out.h5", "--set", "program.feed_override=0.2"], []),
    ("converge", ["converge", "scenario.toml", "--set", "program.feed_override=0.2"], []),
    ("bode", ["bode", EXPERIMENT1, "--axis", "X", "--points", "12", "--f-min", "4", "-o", "out.h5"], ["out.h5"]),
    ("step", ["step", EXPERIMENT1, "--axis", "X", "--duration", "2 s", "-o", "out.h5"], []),
    ("tune", ["tune", EXPERIMENT1, "--axis", "X"], []),
    ("compensate", ["compensate", "long.ngc", *MACHINE, "--errors", "errors.toml", "--tools", "tool.tbl",
                    "--work-offset", "X=0,Y=0,Z=-100", "-o", "out.ngc", "--record", "out.h5"], []),
    ("post", ["post", "part.cls", "--machine", TRUNNION, "--tools", "tool.tbl", "--work-offset", "0,0,0",
              "-o", "out.ngc"], []),
    ("table", ["table", "errors.toml", *MACHINE, "--format", "csv", "--spacing", "0.1 mm", "-o", "tables"], []),
    ("canon", ["canon", "long.ngc", "--tools", "tool.tbl"], []),
    ("check", ["check", "long.ngc", "scenario.toml", EXPERIMENT1, "--tools", "tool.tbl"], []),
    ("merge", ["merge", "in.1-of-2.h5", "in.2-of-2.h5", "-o", "out.h5"], ["out.h5"]),
    ("compare", ["compare", "in.h5"], []),
    ("list", ["list", "quantities"], []),
]


def all_files(folder):
    found = {}
    for root, _, names in os.walk(folder):
        for name in names:
            path = os.path.join(root, name)
            about = os.stat(path)
            found[os.path.relpath(path, folder)] = (about.st_size, about.st_mtime_ns)
    return found


class Signals(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(temporary.cleanup)
        cls.folder = temporary.name
        for name in ("scenario.toml", "machine.toml", "part.ngc"):
            shutil.copy(os.path.join(HERE, "gallery", name), cls.folder)
        for name, text in FILES.items():
            with open(os.path.join(cls.folder, name), "w", encoding="utf-8") as file:
                file.write(text)
        few = "sweep={\"program.feed_override\"={ linear = [0.5, 2.0], count = 8 }}"
        for shard in ("1/2", "2/2"):
            cls.whole("sweep", "scenario.toml", "-q", "-o", "in.h5", "--shard", shard, "--set", few)
        cls.whole("run", "scenario.toml", "-q", "-o", "in.h5", *LONG)

    @classmethod
    def whole(cls, *arguments):
        """Runs to the end; returns how long that takes."""
        begin = time.monotonic()
        result = subprocess.run([SERVOMILL, *arguments], cwd=cls.folder, capture_output=True, text=True,
                                timeout=PATIENCE, check=False)
        assert result.returncode in (0, 1), (arguments, result.stderr)
        return time.monotonic() - begin

    def clear(self):
        for name in os.listdir(self.folder):
            path = os.path.join(self.folder, name)
            if name.startswith("out") or name == "tables":
                shutil.rmtree(path) if os.path.isdir(path) else os.remove(path)

    def interrupted(self, arguments, instant, what):
        """Status, standard error and time from the signal to the end."""
        process = subprocess.Popen([SERVOMILL, *arguments], cwd=self.folder, stdout=subprocess.DEVNULL,
                                   stderr=subprocess.PIPE, text=True)
        try:
            process.wait(instant)
        except subprocess.TimeoutExpired:
            pass
        begin = time.monotonic()
        process.send_signal(what)
        _, stderr = process.communicate(timeout=PATIENCE)
        return process.returncode, stderr, time.monotonic() - begin

    def test_every_command_at_any_instant(self):
        instants = random.Random(18)
        worst_of_all = 0.0
        for name, arguments, may_stay in COMMANDS:
            with self.subTest(name):
                self.clear()
                duration = self.whole(*arguments)
                worst, ended = 0.0, {}
                for i in range(INSTANTS):
                    self.clear()
                    before = all_files(self.folder)
                    what = (signal.SIGINT, signal.SIGTERM)[i % 2]
                    instant = instants.uniform(0.0, duration)
                    status, stderr, latency = self.interrupted(arguments, instant, what)
                    said = f"{name} at {instant:.3f} s of {duration:.3f} s: status {status}, {latency:.3f} s, {stderr!r}"
                    worst = max(worst, latency)
                    ended[status] = ended.get(status, 0) + 1
                    self.assertLess(latency, LIMIT, said)
                    self.assertIn(status, (130, 0, 1, -what), said)  # -what: before the handlers are there
                    after = all_files(self.folder)
                    self.assertEqual({one: after.get(one) for one in before}, before, said)
                    if status in (0, 1):
                        continue
                    new = sorted({one.split(os.sep)[0] for one in after if one not in before} - set(may_stay))
                    self.assertEqual(new, [], said)
                    if status == 130:
                        self.assertTrue(stderr.splitlines()[-1].startswith("interrupted"), said)
                    partial = os.path.exists(os.path.join(self.folder, "out.h5.partial"))
                    self.assertEqual("saved in out.h5.partial" in stderr, partial, said)
                worst_of_all = max(worst_of_all, worst)
                print(f"{name:<22} {duration:6.2f} s whole, {INSTANTS} signals, ended {ended}, latest {1e3 * worst:4.0f} ms",
                      flush=True)
        print(f"largest latency {1e3 * worst_of_all:.0f} ms")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
