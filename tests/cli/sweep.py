#!/usr/bin/python3
"""Sweeps as their users meet them: the table, a kill and what comes after, shards and their merge.
sweep.py SERVOMILL"""
import csv
import json
import os
import pathlib
import resource
import shutil
import signal
import subprocess
import unittest

import h5py
import numpy as np

import nexus_rules
from sweep_files import BUILD, HERE, PATIENCE, POINTS, SCENARIO, SERVOMILL, SLOW, Sweeps, columns, servomill
from sweep_merge import *
from sweep_samples import *


class Table(Sweeps):
    def test_has_a_row_a_point(self):
        done = self.sweep("out.h5")
        self.assertEqual(len(done.stderr.splitlines()), 10)
        self.assertEqual(nexus_rules.faults(self.path("out.h5")), [])
        with h5py.File(self.path("out.h5")) as file:
            table = file["sweep"]
            self.assertEqual(table["point"][:].tolist(), list(range(1, 41)))
            self.assertEqual(table["status"][:].tolist(), [1, 1, 3, 1] * 10)
            self.assertEqual(table["status"].attrs["flag_meanings"], "not_run done stopped refused failed")
            feed = table["program_feed_override"]
            self.assertEqual(feed.attrs["key"], "program.feed_override")
            self.assertEqual(sorted(set(feed[:])), [1.0, 2.0, 3.0, 4.0, 5.0])
            entry = table["case_table_strategy_injection_point"]
            self.assertEqual(entry.attrs["values"], "position_command\nfeed_forward")
            self.assertEqual(sorted(set(entry[:])), [0, 1])
            residual = table["table_imposed_error_residual_Y_max_flank"]
            self.assertEqual(residual.attrs["units"], "um")
            self.assertEqual(residual.attrs["case"], "table")
            np.testing.assert_array_equal(np.isnan(residual[:]), table["status"][:] == 3)
            reason = b"".join(table["reason"][2]).decode()
            self.assertIn("time_constant_ms = -1.0; must be >= 0", reason)
            for name, data in table.items():
                self.assertIn("units", data.attrs)
                self.assertIn("long_name", data.attrs)
                if name not in ("point", "character"):
                    self.assertEqual(data.dims[0][0].name, "/sweep/point")

    def test_says_in_csv_what_it_says_in_hdf5(self):
        self.sweep("out.h5")
        with open(self.path("out.csv"), encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file))
        with h5py.File(self.path("out.h5")) as file:
            table = file["sweep"]
            residual = [float(row["table_imposed_error_residual_Y_max_flank [um]"] or "nan") for row in rows]
            np.testing.assert_array_equal(residual, table["table_imposed_error_residual_Y_max_flank"][:])
            self.assertEqual([row["status"] for row in rows[:4]], ["done", "done", "refused", "done"])
            self.assertEqual({row["case_table_strategy_injection_point"] for row in rows}, {"position_command", "feed_forward"})

    def test_is_the_same_for_any_number_of_threads(self):
        self.sweep("one.h5", "-j1")
        self.sweep("two.h5", "-j2")
        self.expect_same_table("one.h5", "two.h5")

    def test_opens_with_xarray(self):
        try:
            import xarray
        except ImportError:
            self.skipTest("no xarray")
        self.sweep("out.h5")
        with xarray.open_dataset(self.path("out.h5"), group="sweep", engine="h5netcdf") as table:
            self.assertEqual(table.sizes["point"], 40)
            self.assertEqual(table["table_imposed_error_residual_Y_max_flank"].dims, ("point",))
            self.assertEqual(table["reason"].dims, ("point",))
            rows = table.to_dataframe()
            self.assertEqual(len(rows), 40)
            self.assertIn(b"time_constant_ms = -1.0; must be >= 0", rows["reason"].iloc[2])
            self.assertEqual(rows["reason"].iloc[0], b"")

    def test_keeps_signals_that_compare_reads(self):
        self.sweep("out.h5", "--points", "1-3", "--keep-signals")
        self.assertEqual(sorted(os.listdir(self.path("out.series"))), ["1.h5", "2.h5"])   # 3 was refused
        compared = servomill("compare", self.path("out.series/2.h5"), "--json")
        with h5py.File(self.path("out.h5")) as file:
            value = file["sweep/table_imposed_error_residual_Y_max_flank"][1]
        self.assertAlmostEqual(json.loads(compared.stdout)[0]["value"], value, delta=1e-7)   # um; nine digits of 100 um

    def test_keeps_the_points_that_are_asked_for(self):
        self.sweep("all.h5")
        self.sweep("some.h5", "--points", "5-9")
        with h5py.File(self.path("all.h5")) as everything, h5py.File(self.path("some.h5")) as some:
            self.assertEqual(some["sweep/point"][:].tolist(), [5, 6, 7, 8, 9])
            for name, data in some["sweep"].items():
                if name == "character":
                    continue
                self.assertEqual(data[:].tobytes(), everything["sweep"][name][4:9].tobytes(), name)


class Resume(Sweeps):
    def start(self, name, *more):
        return subprocess.Popen([SERVOMILL, "sweep", SCENARIO, "-j1", "-o", self.path(name), "--set", POINTS, "--set", SLOW,
                                 *more], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def finished(self, name):
        with h5py.File(self.path(name)) as file:
            return np.count_nonzero(file["sweep/status"][:])

    def end_after(self, what, name):
        """Sends a signal when the first points are reported."""
        process = self.start(name)
        process.stdout.readline()
        process.send_signal(what)
        _, stderr = process.communicate(timeout=PATIENCE)
        return process.returncode, stderr

    def test_goes_on_behind_a_kill(self):
        self.sweep("whole.h5", "--set", SLOW)
        done = []
        while True:
            status, _ = self.end_after(signal.SIGKILL, "out.h5")
            if status != -signal.SIGKILL or len(done) == 3:
                break
            done.append(self.finished("out.h5.partial"))
        self.assertGreaterEqual(len(done), 2, "it was too quick to be killed")
        self.assertEqual(done, sorted(done))
        self.assertGreater(done[0], 0)
        if os.path.exists(self.path("out.h5.partial")):
            again = servomill("sweep", SCENARIO, "-o", self.path("out.h5"), "--set", POINTS, "--set", SLOW, status=1)
            self.assertRegex(again.stdout, r"out\.h5\.partial: \d+ of 40 points already exist")
        self.expect_same_table("out.h5", "whole.h5")
        self.assertFalse(os.path.exists(self.path("out.h5.partial")))

    def test_goes_on_behind_an_interrupt(self):
        status, stderr = self.end_after(signal.SIGTERM, "out.h5")
        self.assertEqual(status, 130)
        kept = self.finished("out.h5.partial")
        self.assertIn(f"interrupted; saved in {self.path('out.h5.partial')}: {kept} complete points of 40\n", stderr)
        self.sweep("out.h5", "--set", SLOW)
        self.sweep("whole.h5", "--set", SLOW)
        self.expect_same_table("out.h5", "whole.h5")

    def test_does_nothing_when_all_is_done(self):
        self.sweep("out.h5")
        before = os.stat(self.path("out.h5"))
        again = servomill("sweep", SCENARIO, "-o", self.path("out.h5"), "--set", POINTS, status=1)
        self.assertEqual(again.stdout.replace(self.folder + "/", ""), "out.h5 already contains all 40 points\n")
        self.assertEqual(os.stat(self.path("out.h5")).st_mtime_ns, before.st_mtime_ns)

    def test_refuses_another_sweep(self):
        self.sweep("out.h5")
        again = ["sweep", SCENARIO, "-o", self.path("out.h5")]
        self.refused("out.h5: error: contains a sweep of an earlier version of this scenario; use --force to overwrite",
                     *again, "--set", POINTS, "--set", SLOW)
        self.refused("out.h5: error: contains points 1 to 40, shard 1 of 1 of the sweep; requested are points 1 to 3, shard 1 "
                     "of 1; use --force to overwrite", *again, "--set", POINTS, "--points", "1-3")
        servomill(*again, "-q", "--force", "--set", POINTS, "--points", "1-2")

    def test_refuses_a_sweep_over_files_that_have_changed(self):
        for name in ("one.ngc", "two.ngc"):
            shutil.copy(os.path.join(HERE, "gallery", "part.ngc"), self.path(name))
        points = f'sweep={{program.file=["{self.path("one.ngc")}","{self.path("two.ngc")}"]}}'
        for out in ("out.h5", "part.h5"):
            self.sweep(out, status=0, points=points, *(["--shard", "1/2"] if out == "part.h5" else []))
        self.sweep("out.h5", status=0, points=points)   # is complete
        with open(self.path("two.ngc"), "a", encoding="utf-8") as file:
            file.write("; changed\n")
        message = "contains a sweep of this scenario with an earlier version of its file 'two.ngc'; use --force to overwrite"
        for out in ("out.h5", "out.h5.partial"):
            if out.endswith(".partial"):
                os.rename(self.path("out.h5"), self.path(out))
            self.refused(f"{out}: error: {message}", "sweep", SCENARIO, "-o", self.path("out.h5"), "--set", points)
        self.sweep("part.h5", "--shard", "2/2", status=0, points=points)
        self.refused("part.2-of-2.h5: error: was run with another file 'two.ngc' than part.1-of-2.h5", "merge",
                     self.path("part.1-of-2.h5"), self.path("part.2-of-2.h5"), "-o", self.path("merged.h5"))

    def test_prints_one_line_a_point_in_order(self):
        points = POINTS.replace("[1.0,2.0,3.0,4.0,5.0]", "{linear=[0.2,2.0],count=4}")
        done = servomill("sweep", SCENARIO, "-o", self.path("out.h5"), "--set", points, status=1)
        lines = done.stdout.splitlines()
        begin = next(n for n, line in enumerate(lines) if line.startswith("point "))
        names = lines[begin].split()
        self.assertEqual(names[:4], ["point", "program.feed_override", "case.table.strategy.injection_point",
                                     "case.table.strategy.time_constant_ms"])
        self.assertEqual(names[4:], [line.split()[0] for line in lines[:begin - 1]])
        self.assertRegex(lines[0], r"^q1   \w+, .*\(\w+\)$")
        rows = [line.split() for line in lines[begin + 1:-1]]
        run = [n for n in range(1, 33) if n % 4 != 3]   # the others are refused
        self.assertEqual([int(row[0]) for row in rows], run)
        self.assertEqual([row[1] for row in rows[::6]], ["0.2", "0.8", "1.4", "2"])
        self.assertEqual({len(row) for row in rows}, {len(names)})
        self.assertEqual([int(line.split()[1]) for line in done.stderr.splitlines()], list(range(3, 33, 4)))
        with h5py.File(self.path("out.h5")) as file:
            first = next(data for data in file["sweep"].values() if data.attrs.get("role") == "quantity")
            for row in rows:
                self.assertAlmostEqual(float(row[4]) / first[int(row[0]) - 1], 1.0, delta=1e-4)
        again = servomill("sweep", SCENARIO, "-f", "-j", "1", "-o", self.path("out.h5"), "--set", points, status=1)
        self.assertEqual((again.stdout, again.stderr), (done.stdout, done.stderr))

    def test_refuses_what_another_version_wrote(self):
        self.sweep("out.h5")
        for name, value, message in (
                ("servomill_build", "0.1.0+0123456789ab",
                 f"was written by servomill 0.1.0+0123456789ab, this is {BUILD}: points of two builds may differ; "
                 "continue with that build, choose another --output or use --force to run all points again\n"),
                ("schema_version", 1, "exists; use --force to overwrite")):
            with h5py.File(self.path("out.h5"), "r+") as file:
                file.attrs[name] = value
            done = servomill("sweep", SCENARIO, "-o", self.path("out.h5"), "--set", POINTS, status=2)
            self.assertIn(f"out.h5: error: {message}", done.stderr)

    def test_two_processes_do_not_share_a_file(self):
        process = self.start("out.h5")
        process.stdout.readline()
        process.send_signal(signal.SIGSTOP)  # it has the file for as long as the others look
        done = servomill("sweep", SCENARIO, "-o", self.path("out.h5"), "--set", POINTS, "--set", SLOW, status=3)
        forced = servomill("sweep", SCENARIO, "-o", self.path("out.h5"), "--force", "--set", POINTS, status=3)
        process.kill()
        process.communicate()
        said = [one.stderr.replace(self.folder + "/", "") for one in (done, forced)]
        self.assertEqual(said, ["out.h5.partial: error: cannot be opened: another process writes it\n",
                                "out.h5.partial: error: cannot be created: another process writes it\n"])
        again = servomill("sweep", SCENARIO, "-o", self.path("out.h5"), "--set", POINTS, "--set", SLOW, status=1)
        self.assertIn("of 40 points already exist", again.stdout)

    def test_needs_no_force_behind_a_disk_that_was_full(self):
        for size in (0, 4096, 20000):
            def limit():  # as a full disk: the write fails
                signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
                resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))
            with self.subTest(size=size):
                full = subprocess.run([SERVOMILL, "sweep", SCENARIO, "-q", "-o", self.path("out.h5"), "--set", POINTS],
                                      capture_output=True, text=True, timeout=PATIENCE, check=False, preexec_fn=limit)
                self.assertEqual(full.returncode, 3, full.stderr)
                self.assertRegex(full.stderr, r"out\.h5\.partial: error: cannot be (written|created): File too large\n")
                self.sweep("out.h5")
                os.remove(self.path("out.h5"))
                os.remove(self.path("out.csv"))

    def test_adds_the_signals_of_points_that_were_run_without(self):
        self.sweep("out.h5", "--points", "1-3")
        before = columns(self.path("out.h5"))
        again = ["sweep", SCENARIO, "-o", self.path("out.h5"), "--set", POINTS, "--points", "1-3", "--keep-signals"]
        said = servomill(*again, status=1).stdout.replace(self.folder + "/", "")
        self.assertTrue(said.startswith("out.h5: 3 of 3 points already exist\n2 of them lack signals, run again\n"), said)
        self.assertEqual(sorted(os.listdir(self.path("out.series"))), ["1.h5", "2.h5"])  # 3 was refused
        self.assertEqual(columns(self.path("out.h5")), before)
        self.assertIn("already contains all 3 points", servomill(*again, status=1).stdout)
        # those of another sweep do not count
        servomill(*again, "-q", "--set", 'program.parameters."#101"=2000.0', "--force", status=1)
        self.sweep("out.h5", "--points", "1-3", "--force")
        self.assertIn("2 of them lack signals, run again", servomill(*again, status=1).stdout)

    def test_retries_what_failed_on_request(self):
        self.sweep("out.h5")
        self.sweep("whole.h5")
        with h5py.File(self.path("out.h5"), "r+") as file:
            file["sweep/status"][4] = 4
            file["sweep/reason"][4, :17] = np.frombuffer(b"not enough memory", dtype="S1")
            file["sweep/table_imposed_error_residual_Y_max_flank"][4] = np.nan
        same = ["sweep", SCENARIO, "-o", self.path("out.h5"), "--set", POINTS]
        self.assertIn("already contains all 40 points", servomill(*same, status=1).stdout)
        said = servomill(*same, "--retry-failed", status=1).stdout.replace(self.folder + "/", "")
        self.assertTrue(said.startswith("out.h5.partial: 39 of 40 points already exist\n"), said)
        self.expect_same_table("out.h5", "whole.h5")
        self.assertIn("already contains all 40 points", servomill(*same, "--retry-failed", status=1).stdout)

    def test_retries_nothing_beside_another_sweep_that_was_stopped(self):
        self.sweep("out.h5")
        with h5py.File(self.path("out.h5"), "r+") as file:
            file["sweep/status"][4] = 4
        pathlib.Path(self.path("out.h5.partial")).write_text("of another run")
        same = ["sweep", SCENARIO, "-o", self.path("out.h5"), "--set", POINTS]
        refused = servomill(*same, "--retry-failed", status=2)
        self.assertIn("out.h5.partial: error: also exists, from another run; use --force to overwrite", refused.stderr)
        self.assertEqual(pathlib.Path(self.path("out.h5.partial")).read_text(), "of another run")
        with h5py.File(self.path("out.h5")) as file:
            self.assertEqual(file["sweep/status"][4], 4)


if __name__ == "__main__":
    unittest.main()
