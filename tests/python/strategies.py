"""Strategies in Python for the tests: what the built-in ones do, and some that go wrong."""
import numpy
import servomill


@servomill.strategy("python_none", keeps_no_state=True)
class Nothing:
    def step(self, Q_meas):
        return numpy.zeros_like(Q_meas)


@servomill.strategy("python_feedback", knows_errors=True, keeps_no_state=True)
class Feedback:
    """Without the limits of the built-in one."""

    def __init__(self, setup):
        self.setup = setup

    def step(self, Q_meas):
        d = numpy.zeros_like(Q_meas)
        d[:, :3] = -self.setup.sign * self.setup.error(Q_meas)
        return d


@servomill.strategy("python_feedback_of_run", knows_errors=True)
class FeedbackOfRun(Feedback):
    """The same with an object for each run, which counts its rows."""

    counts = []

    def __init__(self, setup):
        super().__init__(setup)
        self.count = [0]
        self.counts.append(self.count)

    def step(self, Q_meas):
        assert 1 <= len(Q_meas) <= 8
        self.count[0] += len(Q_meas)
        return super().step(Q_meas)


@servomill.strategy("python_offset", knows_errors=True)
class Offset:
    def __init__(self, setup):
        self.setup = setup

    def offset(self, Q_ref):
        return numpy.append(self.setup.sign * self.setup.error(Q_ref), [0.0, 0.0])


@servomill.strategy("python_blocks", knows_errors=True, parameters={"longest_mm": servomill.Parameter(1.0, "mm", min=0.01)})
class DisplacedBlocks:
    def __init__(self, setup):
        self.setup = setup

    def rewrite(self, program):
        move, share = servomill.split(program, self.setup.parameters["longest_mm"])
        end = program.position(move, share)
        end[:, :3] += self.setup.sign * self.setup.error(end)
        return servomill.Blocks(move, share, end)


@servomill.strategy("python_raises")
class Raises:
    def step(self, Q_meas):
        if Q_meas[0, 1] > 0.0:
            raise ValueError("beyond Y = 0")
        return numpy.zeros_like(Q_meas)


@servomill.strategy("python_infinite")
class Infinite:
    def offset(self, Q_ref):
        return Q_ref / 0.0 if Q_ref[1] > 0.0 else numpy.zeros(5)


@servomill.strategy("python_wrong_shape")
class WrongShape:
    def step(self, Q_meas):
        return numpy.zeros(3)


@servomill.strategy("python_turns")
class Turns:
    def step(self, Q_meas):
        return numpy.full_like(Q_meas, 1e-6)


@servomill.strategy("python_no_such_motion")
class NoSuchMotion:
    def rewrite(self, program):
        return servomill.Blocks([10_000], [1.0], numpy.zeros((1, 5)))


@servomill.strategy("python_runs")
class Runs:
    def offset(self, Q_ref):
        servomill.load("nowhere.toml")
