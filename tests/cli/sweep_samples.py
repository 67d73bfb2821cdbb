"""Sweeps over samples of identified values; part of sweep.py."""
import csv
import os
import shutil

import numpy as np

from sweep_files import HERE, Sweeps, servomill

IDENTIFIED = """based_on = "machine.toml"
[axis.X]
moving_mass = "750 kg"
[axis.Y]
Kv = "60 1/s"
[identified]
keys = ["axis.X.moving_mass", "axis.Y.Kv"]
units = ["kg", "1/s"]
values = [750.0, 60.0]
covariance = [[100.0, 25.0], [25.0, VARIANCE]]
"""


class Samples(Sweeps):
    """A scenario whose machine has identified values."""

    def setUp(self):
        super().setUp()
        for name in ("machine.toml", "part.ngc"):
            shutil.copy(os.path.join(HERE, "gallery", name), self.folder)
        self.write_identified(25.0)
        with open(os.path.join(HERE, "gallery", "scenario.toml"), encoding="utf-8") as file:
            text = file.read().replace('machine = "machine.toml"', 'machine = "identified.toml"')
        with open(self.path("scenario.toml"), "w", encoding="utf-8") as file:
            file.write(text + '\n[sweep]\nsamples = { from = "identified.toml", count = 60, seed = 4 }\n')

    def write_identified(self, variance):
        with open(self.path("identified.toml"), "w", encoding="utf-8") as file:
            file.write(IDENTIFIED.replace("VARIANCE", str(variance)))

    def run_sweep(self, *more, status=0):
        return servomill("sweep", "scenario.toml", *more, status=status, cwd=self.folder)

    def values_of(self, name):
        """Columns of a CSV file: {name: numbers}."""
        with open(self.path(name), newline="", encoding="utf-8") as file:
            rows = [row for row in csv.DictReader(file) if row["status"] == "done"]
        return {key: np.array([float(row[key]) for row in rows]) for key in rows[0] if key not in ("status", "reason")}

    def statistics_in(self, text):
        """Numbers of the first quantity of the printed statistics."""
        lines = text.splitlines()
        heading = next(n for n, line in enumerate(lines) if "standard deviation" in line)
        return [float(word) for word in lines[heading + 2].split()[-5:]]

    def test_prints_the_distribution_of_each_quantity(self):
        done = self.run_sweep("-o", "out.h5")
        values = self.values_of("out.csv")
        some = values["table_imposed_error_residual_Y_max_flank [um]"]
        expected = [60, some.mean(), some.std(ddof=1), *np.quantile(some, [0.025, 0.975])]
        self.assertGreater(some.std(), 0.0)
        np.testing.assert_allclose(self.statistics_in(done.stdout), expected, rtol=1e-4)
        again = self.run_sweep("-o", "out.h5")
        self.assertEqual(self.statistics_in(again.stdout), self.statistics_in(done.stdout))
        for shard in ("1/2", "2/2"):
            self.run_sweep("-q", "-o", "part.h5", "--shard", shard)
        merged = servomill("merge", "part.1-of-2.h5", "part.2-of-2.h5", "-o", "merged.h5", cwd=self.folder)
        self.assertEqual(self.statistics_in(merged.stdout), self.statistics_in(done.stdout))

    def test_draws_keys_together(self):
        self.run_sweep("-q", "-o", "out.h5")
        values = self.values_of("out.csv")
        mass = values["machine_axis_X_moving_mass [kg]"]
        gain = values["machine_axis_Y_Kv [1/s]"]
        # 25 / (10 x 5) = 0.5; of 60 draws within three standard deviations, (1 - 0.25) / sqrt(60) each
        self.assertAlmostEqual(np.corrcoef(mass, gain)[0, 1], 0.5, delta=0.3)

    def test_counts_refused_samples(self):
        self.write_identified(3600.0)  # a gain below 0 in every sixth draw
        done = self.run_sweep("-o", "out.h5", status=1)
        with open(self.path("out.csv"), newline="", encoding="utf-8") as file:
            refused = sum(row["status"] == "refused" for row in csv.DictReader(file))
        self.assertGreater(refused, 2)
        self.assertIn(f"\n{refused} points refused: samples of identified.toml reach values that the machine does not accept and are "
                      "excluded from its quantities; narrow the interval by recordings that excite these keys more, or remove the keys "
                      "from [identified]\n", done.stderr)
        self.assertEqual(self.statistics_in(done.stdout)[0], 60 - refused)

    def test_is_not_gone_on_with_once_the_values_have_changed(self):
        self.run_sweep("-q", "-o", "out.h5")
        self.run_sweep("-q", "-o", "part.h5", "--shard", "1/2")
        self.write_identified(26.0)
        done = self.run_sweep("-o", "out.h5", status=2)
        self.assertEqual(done.stderr, "out.h5: error: contains a sweep of this scenario with an earlier version of its file 'identified.toml'; "
                                      "use --force to overwrite\n")
        self.run_sweep("-q", "-o", "part.h5", "--shard", "2/2")
        done = servomill("merge", "part.1-of-2.h5", "part.2-of-2.h5", "-o", "merged.h5", cwd=self.folder, status=2)
        self.assertEqual(done.stderr, "part.2-of-2.h5: error: was run with another file 'identified.toml' than part.1-of-2.h5\n")

    def test_knows_the_machine_that_a_swept_one_is_based_on(self):
        points = 'sweep={machine=["identified.toml","other.toml"]}'
        with open(self.path("other.toml"), "w", encoding="utf-8") as file:
            file.write('based_on = "machine.toml"\n[axis.X]\nmoving_mass = 700.0\n')
        self.run_sweep("-q", "-o", "out.h5", "--set", points)
        with open(self.path("machine.toml"), "a", encoding="utf-8") as file:
            file.write("# another comment\n")
        done = self.run_sweep("-o", "out.h5", "--set", points, status=2)
        self.assertEqual(done.stderr, "out.h5: error: contains a sweep of this scenario with an earlier version of its file 'machine.toml'; "
                                      "use --force to overwrite\n")
