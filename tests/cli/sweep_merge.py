"""Shards of a sweep and their merge."""
import os

import h5py
import numpy as np

from sweep_files import BUILD, POINTS, SCENARIO, Sweeps, servomill


class Merge(Sweeps):
    def shards(self, count, *more):
        for shard in range(1, count + 1):
            self.sweep("out.h5", "--shard", f"{shard}/{count}", *more, status=None)
        return [self.path(f"out.{shard}-of-{count}.h5") for shard in range(1, count + 1)]

    def test_gives_the_table_of_one_process(self):
        self.sweep("single.h5")
        for count in (1, 3, 8):
            shards = self.shards(count)
            done = servomill("merge", *reversed(shards), "-o", self.path("merged.h5"), "--force")
            self.assertEqual(done.stdout.replace(self.folder + "/", ""), "30 points done, 10 points refused in merged.h5\n")
            self.expect_same_table("merged.h5", "single.h5")

    def test_says_that_shards_were_computed_with_different_instructions(self):
        first = servomill("sweep", SCENARIO, "-q", "-o", self.path("out.h5"), "--set", POINTS, "--shard", "1/2", status=1,
                          env={**os.environ, "SERVOMILL_SIMD": "baseline"})
        second = servomill("sweep", SCENARIO, "-q", "-o", self.path("out.h5"), "--set", POINTS, "--shard", "2/2", status=1)
        shards = [self.path(f"out.{shard}-of-2.h5") for shard in (1, 2)]
        done = servomill("merge", *shards, "-o", self.path("merged.h5"))
        with h5py.File(self.path("merged.h5")) as file:
            names = file["sweep/simd_level"].attrs["flag_meanings"].split()
            used = [names[int(n)] for n in np.unique(file["sweep/simd_level"][:])]
        with h5py.File(shards[1]) as file:
            self.assertEqual(used, sorted({"baseline", file.attrs["simd_level"]}, key=names.index))
        if len(used) == 1:
            self.skipTest("this machine has but one level")
        self.assertEqual(done.stderr.replace(self.folder + "/", ""),
                         f"merged.h5: points were computed with different instructions ({', '.join(used)}; column "
                         "simd_level): they differ only in their last bits; SERVOMILL_SIMD=baseline gives the same "
                         "bits everywhere\n")
        for one in (first, second):
            self.assertNotIn("instructions", one.stderr)
        # signals that are added to rows of another level
        done = servomill("sweep", SCENARIO, "-q", "-o", self.path("out.h5"), "--set", POINTS, "--shard", "1/2", "--keep-signals",
                         status=1)
        self.assertIn(f"out.1-of-2.h5: points were computed with different instructions ({', '.join(used)};", done.stderr)

    def test_names_what_is_missing(self):
        shards = self.shards(4)
        out = ["-o", self.path("merged.h5")]
        self.refused("merged.h5: error: shards 2, 4 of 4 are missing; use --partial to merge the existing ones",
                     "merge", shards[0], shards[2], *out)
        done = servomill("merge", shards[0], shards[2], *out, "--partial")
        self.assertEqual(done.stderr.replace(self.folder + "/", ""), "merged.h5: shards 2, 4 of 4 are missing\n")
        with h5py.File(self.path("merged.h5")) as file:
            self.assertEqual(np.count_nonzero(file["sweep/status"][:]), 20)
        self.refused("merged.h5: error: lacks 20 of its points; use --force to overwrite",
                     "sweep", SCENARIO, *out, "--set", POINTS)

    def test_refuses_what_overlaps_or_is_of_another_sweep(self):
        three, two = self.shards(3), self.shards(2)
        out = ["-o", self.path("merged.h5")]
        self.refused("out.1-of-3.h5: error: overlaps out.1-of-3.h5: both contain point 1", "merge", three[0], three[0], *out)
        self.refused("out.1-of-2.h5: error: overlaps out.1-of-3.h5: both contain point 1", "merge", three[0], two[0], *out)
        self.sweep("other.h5", "--shard", "2/3", status=None, points=POINTS.replace("10.0", "11.0"))
        self.refused("other.2-of-3.h5: error: contains a sweep of another scenario than out.1-of-3.h5",
                     "merge", three[0], self.path("other.2-of-3.h5"), *out)
        self.sweep("part.h5", "--shard", "2/3", "--points", "1-20", status=None)
        self.refused("part.2-of-3.h5: error: has points 1 to 20, not those of out.1-of-3.h5",
                     "merge", three[0], self.path("part.2-of-3.h5"), *out)
        with h5py.File(three[1], "r+") as file:
            file.attrs["schema_version"] = 1
        self.refused("out.2-of-3.h5: error: contains a sweep of schema version 1; this program reads version 3",
                     "merge", *three, *out)
        with h5py.File(three[1], "r+") as file:
            file.attrs["schema_version"] = 3
            file.attrs["servomill_build"] = "0.1.0+0123456789ab"
        self.refused(f"out.2-of-3.h5: error: was written by servomill 0.1.0+0123456789ab, out.1-of-3.h5 by {BUILD}: "
                     "points of two builds may differ; run these shards again with one build", "merge", *three, *out)
        for shard in three:
            with h5py.File(shard, "r+") as file:
                file.attrs["servomill_build"] = "0.1.0+0123456789ab"
        self.refused(f"out.1-of-3.h5: error: was written by servomill 0.1.0+0123456789ab; this is {BUILD}, "
                     "which did not write all of it: merge with that build", "merge", *three, *out)

    def test_takes_shards_that_did_not_end(self):
        shards = self.shards(2)
        with h5py.File(shards[1], "r+") as file:   # as a kill leaves it
            file["sweep/status"][3:] = 0
        os.rename(shards[1], shards[1] + ".partial")
        parts = ["merge", shards[0], shards[1] + ".partial", "-o", self.path("merged.h5")]
        self.refused("merged.h5: error: out.2-of-2.h5.partial lacks 17 of its 20 points; use --partial to merge the existing ones", *parts)
        done = servomill(*parts, "--partial")
        self.assertIn("17 points not run", done.stdout)
        with h5py.File(self.path("merged.h5")) as file:
            self.assertEqual(np.count_nonzero(file["sweep/status"][:] == 0), 17)

    def test_needs_files_and_a_name(self):
        self.refused("servomill merge: error: needs at least one SHARD.h5; see --help", "merge")
        self.refused("servomill merge: error: needs the name of the result: -o OUT.h5", "merge", "a.h5")
        self.refused("nothing.h5: error: cannot be read: No such file or directory", "merge", self.path("nothing.h5"), "-o", "x")
