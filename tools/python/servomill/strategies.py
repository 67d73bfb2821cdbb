"""Strategies that are classes of Python, for prototypes."""
import inspect
import re
from typing import Any, Callable, Dict, Mapping, NamedTuple, Optional, Tuple

import numpy as np

from . import _core


class Parameter(NamedTuple):
    """A key of the strategy in `[[case.strategy]]`. Its value is `setup.parameters[name]`, in SI.

    The name ends in its unit as the keys of scenarios do: `time_constant_ms` has the unit "ms".
    """

    default: Optional[float] = None  #: in `unit`; None: the key is required
    unit: str = ""                   #: of a bare number; "": dimensionless
    min: float = -1e300              #: in `unit`, inclusive
    max: float = 1e300
    help: str = ""


class Blocks(NamedTuple):
    """Straight blocks in place of motions, in their order; a motion without blocks stays as it is."""

    move: np.ndarray         #: (k) number of the motion, from 0
    share: np.ndarray        #: (k) of the motion, at which the block ends: rising, and 1 for the last one
    end: np.ndarray          #: (k, 5; m, rad) positions of the axes in machine coordinates
    feed_factor: Any = 1.0   #: (k) or a number; 1: as programmed


_PARTS = ("offset", "step", "rewrite")


def strategy(name: str, *, summary: str = "", parameters: Optional[Mapping[str, Parameter]] = None, knows_errors: bool = False,
             displaces_rotary: bool = False, keeps_no_state: bool = False) -> Callable[[type], type]:
    """Registers a class as a strategy; scenarios that are loaded from then on use it as `type = "NAME"`.

    The class has one or several of

    - `offset(self, Q_ref)`: interpolated position (5; m, rad) -> offset of the setpoint (5; m, rad), behind the feed-forward
      tap, once per position period;
    - `step(self, Q_meas)`: readings of the scales (n, 5; m, rad) -> virtual displacement (n, 5; m, rad), which is added to the
      reading, so that the axis moves by its negative; it acts one model period later. Rows are successive model periods of
      one run, up to eight at once;
    - `rewrite(self, program)`: the motions of the program (`servomill.Program`) -> Blocks, or None: nothing is changed.

    Positions are those of the axes in machine coordinates: X, Y, Z and the rotary axes in alphabetical order; the place of an
    axis that the machine lacks holds 0. `__init__(self, setup)` takes a servomill.Setup, or nothing. Each run and each part
    has an object of its own. An exception ends the case with its message; so does a value that is not finite.

    parameters: keys of the scenario, by name.
    knows_errors: takes the keys `model` and `action`; `setup.error(Q)` and `setup.sign` exist.
    displaces_rotary: `step` and `rewrite` may displace rotary axes.
    keeps_no_state: `step` depends on its argument alone. One object then serves all runs, and rows of one call may be of
      several runs: eight points of a sweep at once.

    It is slow: a call takes some microseconds, and one thread calls at a time. For work, write the strategy in C++
    (strategies/README.md). A class of the same name replaces an earlier one.

    >>> import numpy, servomill
    >>> @servomill.strategy("droop", parameters={"droop_um": servomill.Parameter(5.0, "um", min=0.0)})
    ... class Droop:
    ...     "lowers Z by a constant"
    ...     def __init__(self, setup):
    ...         self.d = numpy.array([0.0, 0.0, -setup.parameters["droop_um"], 0.0, 0.0])
    ...     def offset(self, Q_ref):
    ...         return self.d
    >>> scenario = servomill.load(example, set={"case.feedback.strategy": [{"type": "droop"}]})
    """
    def register(cls: type) -> type:
        _register(cls, name, summary, dict(parameters or {}), knows_errors, displaces_rotary, keeps_no_state)
        return cls

    return register


def _register(cls: type, name: str, summary: str, parameters: Dict[str, Parameter], knows_errors: bool, displaces_rotary: bool,
              keeps_no_state: bool) -> None:
    if not re.fullmatch(r"[a-z][a-z0-9_]*", name):
        raise ValueError(f"the name {name!r} must consist of lower case letters, digits and '_'")
    parts = {part: callable(getattr(cls, part, None)) for part in _PARTS}
    if not any(parts.values()):
        raise TypeError(f"{cls.__name__} has none of the methods {', '.join(_PARTS)}")
    _core.register_strategy({
        "name": name,
        "summary": summary or (inspect.getdoc(cls) or "a class of Python").splitlines()[0],
        "source": _source(cls),
        "make": _maker(cls),
        "keeps_no_state": keeps_no_state,
        "knows_errors": knows_errors,
        "displaces_rotary": displaces_rotary,
        "keys": [_key(key, one) for key, one in parameters.items()],
        **{f"has_{part}": there for part, there in parts.items()},
    })


def _source(cls: type) -> str:
    try:
        return inspect.getsource(cls)
    except (OSError, TypeError):
        return repr(cls)


def _maker(cls: type) -> Callable[[Any], Any]:
    """Objects of the class, whether or not its constructor takes the setup."""
    try:
        takes_setup = len(inspect.signature(cls).parameters) > 0
    except ValueError:
        takes_setup = False
    return cls if takes_setup else lambda setup: cls()


def _key(name: str, one: Parameter) -> Tuple[str, str, str, str, float, float]:
    default = "" if one.default is None else repr(float(one.default))
    return name, one.help or name, one.unit, default, float(one.min), float(one.max)


def _arrays_of_blocks(blocks: Any) -> Tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Blocks as arrays of equal length, for the core."""
    if blocks is None:
        blocks = Blocks(np.empty(0, int), np.empty(0), np.empty((0, 5)))
    one = Blocks(*blocks)
    move, share = np.atleast_1d(np.asarray(one.move, dtype=np.int64)), np.atleast_1d(np.asarray(one.share, dtype=float))
    end = np.asarray(one.end, dtype=float)
    count = len(move)
    if share.shape != (count,) or end.shape != (count, 5):
        raise ValueError(f"blocks have {move.shape} moves, {share.shape} shares and {end.shape} ends, expected (k), (k), (k, 5)")
    if count and move.min() < 0:
        raise ValueError(f"motion {move.min()} does not exist")
    factor = np.broadcast_to(np.asarray(one.feed_factor, dtype=float), (count,))
    return move, share, np.ascontiguousarray(end), np.ascontiguousarray(factor)


def split(program: Any, longest: float) -> Tuple[np.ndarray, np.ndarray]:
    """Motions at feed in equal pieces.

    longest: m, along the path of the program.

    Returns the motion (k) and the share (k) at the end of each piece, for Blocks and for `program.position`. Rapids are one
    piece.
    """
    length = np.asarray(program.s_end) - np.asarray(program.s_begin)
    rapid = np.asarray(program.kind) == 0
    pieces = np.where(rapid, 1, np.maximum(1, np.ceil(length / longest - 1e-9))).astype(int)
    move = np.repeat(np.arange(len(pieces)), pieces)
    first = np.repeat(np.cumsum(pieces) - pieces, pieces)
    return move, (np.arange(len(move)) - first + 1) / pieces[move]
