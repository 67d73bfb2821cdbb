#!/usr/bin/python3
"""Strategies that are classes of Python: the same results as the built-in ones, and ends with their messages."""
import os
import pathlib
import re
import tempfile
import threading
import unittest
import warnings

import numpy
import servomill
import strategies

SCENARIO = pathlib.Path(__file__).resolve().parent / "short.toml"
TOL = 1e-12  # relative: both compute the same in the same order
FEEDBACK = "case.feedback.strategy"


def knowing(**keys):
    return [{"model": "imposed", "action": "impose", **keys}]


def case_with(strategy, **changes):
    """The case `feedback` of the scenario with another strategy."""
    with servomill.run(SCENARIO, set={FEEDBACK: strategy, **changes}) as run:
        return run["feedback"]


class Strategies(unittest.TestCase):
    def assert_same(self, ours, built_in):
        one, other = case_with(ours), case_with(built_in)
        self.assertTrue(one.finished and other.finished, one.outcome)
        self.assertGreater(one.servo.rows, 600)
        for name in other.servo:
            numpy.testing.assert_allclose(one.servo[name], other.servo[name], rtol=TOL, atol=TOL, err_msg=name)

    def test_step_is_feedback(self):
        self.assert_same(knowing(type="python_feedback"), knowing(type="feedback", max_rate_mm_per_s=1e6))

    def test_step_of_a_run_is_feedback(self):
        strategies.FeedbackOfRun.counts.clear()
        self.assert_same(knowing(type="python_feedback_of_run"), knowing(type="feedback", max_rate_mm_per_s=1e6))
        *settling, (of_run,) = strategies.FeedbackOfRun.counts  # an object anew whenever it settles
        self.assertEqual([count for (count,) in settling], [1] * len(settling))
        self.assertGreater(of_run, 10_000)

    def test_nothing_is_none(self):
        self.assert_same([{"type": "python_none"}], [{"type": "none"}])

    def test_offset_is_a_continuous_table(self):
        self.assert_same(knowing(type="python_offset"), knowing(type="table", layout="continuous"))

    def test_blocks_are_gcode(self):
        self.assert_same(knowing(type="python_blocks", longest_mm=0.5),
                         knowing(type="gcode", max_block_mm=0.5, tolerance_um=1e6))

    def test_compensates_with_the_other_sign(self):
        self.assert_same([{"type": "python_blocks", "model": "imposed"}],
                         [{"type": "gcode", "model": "imposed", "max_block_mm": 1.0, "tolerance_um": 1e6}])


class Sweeps(unittest.TestCase):
    """Points side by side in lanes, on several threads."""

    def columns(self, strategy):
        lanes = {FEEDBACK: strategy, "sweep": {"errors.imposed.EYX.harmonic.amplitude_um": [float(n) for n in range(80, 92)]}}
        with servomill.sweep(SCENARIO, set=lanes, threads=4) as table:
            self.assertEqual(set(table.status), {"done"})
            return {name: table[name] for name in table.quantities}

    def test_are_the_same_with_and_without_state(self):
        built_in = self.columns(knowing(type="feedback", max_rate_mm_per_s=1e6))
        for name in ("python_feedback", "python_feedback_of_run"):
            for column, values in self.columns(knowing(type=name)).items():
                numpy.testing.assert_allclose(values, built_in[column], rtol=TOL, atol=TOL, err_msg=f"{name} {column}")


class Ends(unittest.TestCase):
    def outcome(self, name):
        case = case_with([{"type": name}])
        self.assertFalse(case.finished)
        return re.sub(r" at \d+\.\d+ s, line \d+ of the program$", "", case.outcome)

    def test_names_exception_and_line(self):
        self.assertRegex(self.outcome("python_raises"),
                         r"^strategy python_raises: step: ValueError: beyond Y = 0 \(strategies\.py:\d+\)$")

    def test_refuses_what_is_not_finite(self):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            self.assertEqual(self.outcome("python_infinite"),
                             "strategy python_infinite: offset returned a value that is not finite")

    def test_refuses_another_shape(self):
        self.assertRegex(self.outcome("python_wrong_shape"),
                         r"^strategy python_wrong_shape: step returned an array of shape \(3,\), expected \(\d, 5\)$")

    def test_refuses_rotary_axes(self):
        self.assertEqual(self.outcome("python_turns"),
                         "strategy python_turns: step displaces a rotary axis, contrary to its declaration")

    def test_refuses_blocks_of_no_motion(self):
        self.assertRegex(self.outcome("python_no_such_motion"), r"^strategy python_no_such_motion: rewrite: .*motion 10000")

    def test_refuses_a_computation_within(self):
        self.assertRegex(self.outcome("python_runs"), "offset: RuntimeError: a strategy .* cannot begin a computation")

    def test_leaves_the_other_cases(self):
        with servomill.run(SCENARIO, set={FEEDBACK: [{"type": "python_raises"}]}) as run:
            self.assertEqual([case.finished for case in run.values()], [True, False, True])


class Registration(unittest.TestCase):
    def test_replaces_a_class_of_the_same_name(self):
        for value in (1e-6, 2e-6):
            @servomill.strategy("python_again")
            class Again:
                def offset(self, Q_ref, value=value):
                    return numpy.array([0.0, value, 0.0, 0.0, 0.0])
            servo = case_with([{"type": "python_again"}]).servo
            difference = servo.axis("cmd_linear", "Y") - servo.axis("ref_linear", "Y")
            numpy.testing.assert_allclose(difference, 1e3 * value, atol=2e-9)  # mm, twice the resolution of the recording

    def test_refuses_names_of_others(self):
        with self.assertRaisesRegex(servomill.InputError, "the name 'feedback' belongs to another strategy"):
            servomill.strategy("feedback")(strategies.Offset)

    def test_refuses_a_class_without_parts(self):
        with self.assertRaisesRegex(TypeError, "none of the methods offset, step, rewrite"):
            servomill.strategy("empty")(object)

    def test_keys_are_checked(self):
        with self.assertRaises(servomill.InputError) as caught:
            servomill.load(SCENARIO, set={FEEDBACK: knowing(type="python_blocks", longest_mm=0.0)})
        self.assertIn("must be >= 0.01", caught.exception.rule)
        with self.assertRaisesRegex(servomill.InputError, "unknown unit 'furlong'"):
            servomill.strategy("odd", parameters={"far": servomill.Parameter(1.0, "furlong")})(strategies.Offset)

    def test_result_names_the_class(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "out.h5")
            servomill.run(SCENARIO, set={FEEDBACK: [{"type": "python_none"}]}, output=path)
            with servomill.open(path) as run:
                self.assertIn("python_none in Python (", run.file.attrs["servomill_build"])
            self.assertGreater(len(servomill.compare(path)), 0)


class Threads(unittest.TestCase):
    def test_run_while_others_compute(self):
        """Runs from several threads of Python, with strategies that need the GIL, while the main thread keeps it busy."""
        results = []

        def work():
            results.append(case_with(knowing(type="python_offset")).finished)

        threads = [threading.Thread(target=work) for _ in range(3)]
        for one in threads:
            one.start()
        while any(one.is_alive() for one in threads):
            sum(range(1000))
        self.assertEqual(results, [True] * 3)


if __name__ == "__main__":
    unittest.main()
