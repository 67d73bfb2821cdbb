#!/usr/bin/python3
"""Runs, their results in memory and in files, and their ends."""
import gc
import math
import os
import pathlib
import signal
import tempfile
import threading
import time
import unittest

import numpy
import servomill
import strategies  # noqa: F401: registers them

HERE = pathlib.Path(__file__).resolve().parent
SCENARIO = HERE / "short.toml"
# an hour of motion: no computer here ends it within the test
LONG = {"record.settle_ms": 3.6e6, "record.period_ms": 1000.0}
MAX_INTERRUPT = 0.5  # s
PATIENCE = 20.0      # s, for a shared machine to begin


class Results(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.path = os.path.join(cls.folder.name, "short.h5")
        cls.result = servomill.run(SCENARIO, output=cls.path)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_has_the_cases_in_order(self):
        self.assertEqual(list(self.result), ["nominal", "feedback", "gcode"])
        self.assertTrue(all(case.finished and case.outcome == "finished" for case in self.result.values()))
        self.assertEqual(self.result["gcode"].sections, ["", "approach", "flank", "circle", "plane"])
        self.assertIn("G1 X-3", self.result["gcode"].program)
        self.assertEqual(self.result["nominal"].program, "")

    def test_arrays_are_views_that_keep_the_run_alive(self):
        run = servomill.run(SCENARIO)
        array, again = run["feedback"].servo["true_linear"], run["feedback"].servo["true_linear"]
        self.assertTrue(numpy.shares_memory(array, again))
        self.assertFalse(array.flags.owndata or array.flags.writeable)
        before = array.copy()
        run.close()
        del run, again
        gc.collect()
        for _ in range(3):
            servomill.run(SCENARIO)  # would take the memory
        numpy.testing.assert_array_equal(array, before)

    def test_file_has_the_same_bits(self):
        with servomill.open(self.path) as stored:
            for name, case in self.result.items():
                self.assertEqual(list(case.servo), list(stored[name].servo))
                for signal_name in case.servo:
                    numpy.testing.assert_array_equal(case.servo[signal_name], stored[name].servo[signal_name])
                    self.assertEqual(case.servo.describe(signal_name), stored[name].servo.describe(signal_name))
                self.assertEqual((case.blocks, case.duration_s, case.sections, case.program),
                                 (stored[name].blocks, stored[name].duration_s, stored[name].sections, stored[name].program))
            self.assertEqual([row[:9] for row in self.result.comparison], [row[:9] for row in stored.comparison])
            self.assertEqual(str(stored.comparison), str(self.result.comparison))

    def test_closes(self):
        with servomill.open(self.path) as stored:
            servo = stored["feedback"].servo
        with self.assertRaisesRegex(ValueError, "closed"):
            servo["time"]
        with servomill.run(SCENARIO) as run:
            pass
        with self.assertRaisesRegex(ValueError, "closed"):
            run["feedback"]

    def test_datasets_have_units(self):
        try:
            import xarray
        except ImportError:
            self.skipTest("no xarray")
        data = self.result["feedback"].to_xarray()
        self.assertEqual(data.true_linear.attrs, {"units": "mm", "long_name": "position of the slide or table, linear axes"})
        numpy.testing.assert_array_equal(data.true_linear.sel(axis_linear="Y"),
                                         self.result["feedback"].servo.axis("true_linear", "Y"))
        with servomill.open(self.path) as stored:
            xarray.testing.assert_identical(data, stored["feedback"].to_xarray())
        with xarray.open_dataset(self.path, group="cases/feedback/servo", engine="h5netcdf", decode_times=False) as by_xarray:
            self.assertEqual(dict(by_xarray.sizes), dict(data.sizes))
            self.assertEqual(by_xarray.true_linear.attrs["units"], "mm")

    def test_compare_gives_the_same_lines(self):
        again = servomill.compare(self.path)
        self.assertEqual(list(again), list(self.result.comparison))
        self.assertEqual(str(again), str(self.result.comparison))
        self.assertEqual(len(servomill.compare(self.path, self.path)), 2)

    def test_comparison_finds_one_line(self):
        comparison = self.result.comparison
        self.assertEqual(comparison.value("cycle_time", case="gcode"), comparison.find("cycle_time", case="gcode").value)
        with self.assertRaisesRegex(LookupError, "^3 lines of the comparison have quantity 'cycle_time'$"):
            comparison.find("cycle_time")

    def test_sections_are_rows(self):
        case = self.result["feedback"]
        x = case.servo.axis("ref_linear", "X")[case.in_section("flank")]
        self.assertTrue(numpy.all(numpy.diff(x) >= 0.0))
        self.assertAlmostEqual(x[-1] - x[0], 12.0, delta=0.2)  # mm, a row at each end
        self.assertEqual(sum(case.in_section(name).sum() for name in set(case.sections)), case.servo.rows)
        with self.assertRaisesRegex(KeyError, "no section 'flanke'; there are '', 'approach'"):
            case.in_section("flanke")

    def test_names_are_checked(self):
        servo = self.result["feedback"].servo
        with self.assertRaisesRegex(KeyError, "no signal 'true'; there are time"):
            servo["true"]
        with self.assertRaisesRegex(KeyError, "has the columns X, Y, Z, not 'A'"):
            servo.axis("true_linear", "A")

    def test_opens_results_only(self):
        with tempfile.TemporaryDirectory() as folder:
            text = os.path.join(folder, "text.h5")
            with open(text, "w", encoding="utf-8") as file:
                file.write("x")
            with self.assertRaisesRegex(ValueError, f"^{text}: is no HDF5 file, so no result of a run or a sweep$"):
                servomill.open(text)

    def test_refuses_to_overwrite(self):
        with self.assertRaisesRegex(servomill.InputError, "exists"):
            servomill.run(SCENARIO, output=self.path)
        servomill.run(SCENARIO, output=self.path, force=True)
        with self.assertRaisesRegex(servomill.InputError, "is an input"):
            servomill.run(SCENARIO, output=SCENARIO, force=True)


class Stops(unittest.TestCase):
    def test_machine_that_stops_is_a_result(self):
        run = servomill.run(SCENARIO, set={"machine.nc.following_error_limit_mm": 0.001})
        case = run["nominal"]
        self.assertFalse(case.finished)
        self.assertRegex(case.outcome, "following error")
        self.assertGreater(case.last_ticks.rows, 0)
        self.assertTrue(math.isnan(run.comparison.value("imposed_error_residual", case="feedback")))


class Scenarios(unittest.TestCase):
    def test_dictionary_and_text_are_as_good_as_a_file(self):
        scenario = servomill.load(SCENARIO)
        for given in (scenario.keys, scenario.resolved):
            again = servomill.load(given, folder=HERE, name="again")
            self.assertEqual(again.resolved, scenario.resolved)
            self.assertEqual(list(servomill.run(again).comparison), list(servomill.run(scenario).comparison))

    def test_files_of_a_text_are_relative_to_its_folder(self):
        text = SCENARIO.read_text(encoding="utf-8")
        self.assertEqual(servomill.load(text, folder=HERE).cases, ["nominal", "feedback", "gcode"])
        with self.assertRaisesRegex(servomill.InputError, "cannot be read"):
            servomill.load(text, folder=HERE / "nowhere")

    def test_changes_come_after_changes(self):
        half = servomill.load(SCENARIO, set={"program.feed_override": 0.5})
        slow = servomill.load(half, set={"machine.nc.Kv": "40 1/s"})
        self.assertEqual((slow["program.feed_override"], slow["machine.nc.Kv"]), (0.5, "40 1/s"))
        self.assertIs(servomill.load(slow), slow)

    def test_estimate_is_about_the_run(self):
        self.assertAlmostEqual(servomill.load(SCENARIO).estimate()["motion_s"], 3 * 0.75, delta=0.1)

    def test_has_all_faults_with_their_places(self):
        text = SCENARIO.read_text(encoding="utf-8").replace("title ", "titel ").replace('axis = "Y"', 'axis = "Q"')
        with self.assertRaises(servomill.InputError) as caught:
            servomill.load(text, folder=HERE, name="wrong")
        error = caught.exception
        self.assertEqual(len(error.faults), 2)
        self.assertEqual((error.file, error.line), (str(HERE / "wrong.toml"), 1 + text[:text.index("titel")].count("\n")))
        self.assertEqual(error.key, "titel")
        self.assertIn("is not known", error.rule)
        self.assertEqual(error.faults[1].key, "quantity[0].axis")
        self.assertEqual(str(error), "\n".join(map(str, error.faults)))

    def test_arguments_are_checked_as_options(self):
        with self.assertRaisesRegex(servomill.InputError, "unknown option '--pionts'; did you mean '--points'?"):
            servomill.bode(SCENARIO, "Y", pionts=3)
        with self.assertRaises(servomill.InputError) as caught:
            servomill.bode(SCENARIO, "Y", f_max=1e9)
        self.assertEqual(caught.exception.file, "f_max")


class Sweeps(unittest.TestCase):
    def test_table_is_that_of_the_runs(self):
        with servomill.sweep(SCENARIO) as table:
            numpy.testing.assert_array_equal(table["program_feed_override"], [0.5, 1.0])
            full = servomill.run(SCENARIO)
            self.assertEqual(table["feedback_cycle_time"][1], full.comparison.value("cycle_time", case="feedback"))
            self.assertEqual(table.describe("feedback_cycle_time")["units"], "s")
            self.assertEqual(table.reasons, ["", ""])
            folder = pathlib.Path(table.path).parent
        self.assertFalse(folder.exists())
        with self.assertRaisesRegex(ValueError, "closed"):
            table["feedback_cycle_time"]

    def test_texts_and_reasons(self):
        lists = {"sweep": {"case.feedback.strategy.extrapolation_time_ms": ["auto", -1.0]}}
        with servomill.sweep(SCENARIO, set=lists) as table:
            self.assertEqual(list(table.status), ["done", "refused"])
            self.assertIn("extrapolation_time_ms", table.reasons[1])
            self.assertEqual(table.parameters, ["case_feedback_strategy_extrapolation_time_ms"])

    def test_goes_on_with_its_file(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "sweep.h5")
            servomill.sweep(SCENARIO, output=path, points="1-1").close()
            with self.assertRaises(servomill.InputError):
                servomill.sweep(SCENARIO, output=path)
            with servomill.sweep(SCENARIO, output=path, force=True) as table:
                self.assertEqual(len(table.points), 2)
            self.assertTrue(os.path.exists(path))


class Progress(unittest.TestCase):
    def test_rises_to_one(self):
        shares = []
        servomill.run(SCENARIO, progress=shares.append)
        self.assertEqual(shares, sorted(shares))
        self.assertEqual(shares[-1], 1.0)

    def test_exception_ends_the_run(self):
        def stop(share):
            raise RuntimeError("enough")

        begin = time.monotonic()
        with self.assertRaisesRegex(RuntimeError, "enough"):
            servomill.run(SCENARIO, set=LONG, progress=stop)
        self.assertLess(time.monotonic() - begin, PATIENCE)
        self.assertTrue(servomill.run(SCENARIO)["feedback"].finished)

    def test_cannot_begin_a_computation(self):
        with self.assertRaisesRegex(RuntimeError, "progress function cannot begin"):
            servomill.run(SCENARIO, set=LONG, progress=lambda share: servomill.load(SCENARIO))


class Interrupts(unittest.TestCase):
    def time_to_end(self, compute):
        """Sends SIGINT once the computation goes on; the time (s) from then to its end."""
        sent = []

        def interrupt(share):
            if not sent and share > 0.0:
                sent.append(time.monotonic())
                threading.Timer(0.1, os.kill, (os.getpid(), signal.SIGINT)).start()

        with self.assertRaises(KeyboardInterrupt):
            compute(interrupt)
        return time.monotonic() - sent[0] - 0.1

    def ends_in_time(self, compute):
        """The best of three: a shared machine may hold back any thread for so long."""
        times = []
        while len(times) < 3 and (not times or times[-1] > MAX_INTERRUPT):
            times.append(self.time_to_end(compute))
        self.assertLess(min(times), MAX_INTERRUPT)
        self.assertTrue(servomill.run(SCENARIO)["feedback"].finished)

    def test_ends_a_run_in_time(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "long.h5")
            self.ends_in_time(lambda progress: servomill.run(SCENARIO, set=LONG, output=path, progress=progress))
            self.assertFalse(os.path.exists(path))

    def test_ends_a_sweep_in_time(self):
        many = {"sweep": {"machine.nc.Kv": {"linear": ["40 1/s", "80 1/s"], "count": 20_000}}}
        self.ends_in_time(lambda progress: servomill.sweep(SCENARIO, set=many, progress=progress))

    def test_ends_a_strategy_in_time(self):
        mine = {**LONG, "case.feedback.strategy": [{"type": "python_none"}]}
        self.ends_in_time(lambda progress: servomill.run(SCENARIO, set=mine, progress=progress))

    def test_lets_other_threads_go_on(self):
        count = [0, True]

        def work():
            while count[1]:
                count[0] += 1
                time.sleep(0.001)

        thread = threading.Thread(target=work)
        thread.start()
        self.ends_in_time(lambda progress: servomill.run(SCENARIO, set=LONG, progress=progress))
        count[1] = False
        thread.join()
        self.assertGreater(count[0], 20)


if __name__ == "__main__":
    unittest.main()
