"""The commands of the program as functions.

Functions that compute let other threads of Python run meanwhile. `progress` is called about twenty times a second, on the
calling thread, with the share done (0 to 1); what it raises ends the computation. Ctrl-C ends one, too, within half a second.
Arguments named as options of a command take what these take: a number, a text with its unit ("1 um"), a list where an option
may be repeated; `servomill COMMAND --help` explains each.
"""
import json
import os
import shutil
import tempfile
from typing import Any, Callable, Dict, Iterable, List, NamedTuple, Optional, Union

import numpy as np

from . import _core
from .files import Sweep, open as _open
from .results import Case, Comparison, Row, Run
from .scenario import Changes, Loadable, load
from .signals import Signals

Path = Union[str, os.PathLike]
Progress = Optional[Callable[[float], Any]]


def _path(path: Optional[Path]) -> str:
    return "" if path is None else os.fspath(path)


def run(scenario: Loadable, *, set: Changes = None, output: Optional[Path] = None, force: bool = False, threads: int = 0,
        progress: Progress = None) -> Run:
    """Runs every case of a scenario and compares them.

    scenario, set: as for `load`.
    output: result file, written as `servomill run -o` does; without one the recording stays in memory.
    force: replaces an output that exists. threads: 0: one a core; results do not depend on it.

    A machine that stops is a result: `Case.finished` is false, `Case.outcome` says why. Wrong input raises InputError.

    >>> import servomill
    >>> result = servomill.run(example)
    >>> result["feedback"].finished, result["feedback"].servo["true_linear"].shape[1]
    (True, 3)
    >>> result["feedback"].servo.units("true_linear")
    'mm'
    >>> row = result.comparison.find("imposed_error_residual", case="gcode", axis="Y")
    >>> row.value < 1.0, row.unit
    (True, 'um')
    """
    loaded = load(scenario, set)
    cases, rows, text, seconds = _core.run(loaded._core, _path(output), force, threads, progress)
    return Run([Case(description, Signals(servo), Signals(last)) for description, servo, last in cases],
               Comparison([Row(*row) for row in rows], text, loaded.title), loaded.title, _path(output) or None,
               computing_s=seconds)


def sweep(scenario: Loadable, *, set: Changes = None, output: Optional[Path] = None, force: bool = False, points: str = "",
          shard: str = "", threads: int = 0, progress: Progress = None) -> Sweep:
    """Runs a scenario at the points of its `[sweep]` table; the table with one row a point.

    output: file of the table; a sweep that was interrupted is continued. Without one it lies in a temporary file until the
    result is closed.
    points: "1-100"; shard: "2/8"; as the options of `servomill sweep`.

    >>> import servomill
    >>> with servomill.sweep(example) as table:
    ...     table.parameters, list(table["program_feed_override"]), list(table.status)
    (['program_feed_override'], [0.5, 1.0], ['done', 'done'])
    """
    loaded = load(scenario, set)
    temporary = tempfile.mkdtemp(prefix="servomill_") if output is None else None
    path = os.path.join(temporary, "sweep.h5") if temporary else _path(output)
    try:
        written = _core.sweep(loaded._core, path, force, points, shard, threads, progress)
    except BaseException:
        if temporary:
            shutil.rmtree(temporary, ignore_errors=True)
        raise
    table = _open(written)
    assert isinstance(table, Sweep)
    if temporary:
        table.remove_when_closed(temporary)
    return table


def compare(*paths: Path) -> Union[Comparison, List[Comparison]]:
    """Evaluates the comparison of result files again from their recorded signals: one, or a list with one per file."""
    out = []
    for path in paths:
        title, rows, text = _core.compare(_path(path))
        out.append(Comparison([Row(*row) for row in rows], text, title))
    return out[0] if len(out) == 1 else out


class Curve(NamedTuple):
    """A frequency response."""

    name: str                        #: "position_open"
    long_name: str
    frequency: np.ndarray            #: (n; Hz)
    exact: np.ndarray                #: (n; complex) dimensionless; of compliances m/N
    measured: Optional[np.ndarray]   #: (n; complex); NaN where the encoders do not resolve it; None: nothing was measured
    fine_frequency: np.ndarray       #: (m; Hz), for drawing
    fine_exact: np.ndarray           #: (m; complex)


class Loop(NamedTuple):
    """One loop of one axis. Margins are infinite where there is no crossing."""

    axis: str
    loop: str                        #: position, velocity or compliance
    stable: bool
    slowest_time_constant_s: float
    gain_margin: float               #: factor by which the gain may rise
    gain_margin_Hz: float
    phase_margin_deg: float
    crossover_Hz: float
    sensitivity_peak: float
    bandwidth_Hz: float
    peak: float
    peak_Hz: float
    fault: Optional[str]             #: why nothing was measured
    curves: Dict[str, Curve]


def bode(scenario: Loadable, axis: str, *, set: Changes = None, progress: Progress = None, **options: Any) -> List[Loop]:
    """Frequency responses of the sampled loops of an axis: exact multirate model, and what a simulation shows.

    axis: "Y", "X,Y" or "all". options: those of `servomill bode`: loop ("position", "velocity", "compliance", "all"), f_min,
    f_max, points, method ("sine", "multisine", "none"), amplitude, velocity.

    >>> import servomill
    >>> (loop,) = servomill.bode(example, "Y", method="none")
    >>> loop.stable, sorted(loop.curves)
    (True, ['position_closed', 'position_fed_forward', 'position_open'])
    """
    loops = _core.bode(load(scenario, set)._core, progress, axis=axis, **options)
    return [Loop(**{**one, "curves": {curve["name"]: Curve(**curve) for curve in one["curves"]}}) for one in loops]


class Moves(List[Dict[str, Any]]):
    """Canonical moves, one dictionary each, with the names and units of `servomill canon`: mm, deg."""

    warnings: List[str]


def canon(program: Path, **options: Any) -> Moves:
    """The canonical moves of a program. options: those of `servomill canon`: tools, parameter, reader, machine, ...

    >>> import servomill
    >>> moves = servomill.canon(example_program)
    >>> moves[0]["t"], moves[0]["line"]
    ('msg', 6)
    """
    lines, warnings = _core.canon(_path(program), **options)
    moves = Moves(map(json.loads, lines.splitlines()))
    moves.warnings = warnings
    return moves


class Compensated(NamedTuple):
    """A corrected program."""

    program: str             #: its text
    name: str                #: file name that the command would give it
    report: List[str]        #: what was changed and assumed
    warnings: List[str]
    changes: Dict[str, Any]  #: the report in numbers, as --json prints it

    def write(self, path: Optional[Path] = None) -> str:
        """Writes the program to a new file (default: `name`); the file's name."""
        target = _path(path) or self.name
        with open(target, "x", encoding="utf-8") as file:
            file.write(self.program)
        return target


def compensate(program: Path, machine: Path, *, set: Changes = None, progress: Progress = None, **options: Any) -> Compensated:
    """Corrects a program for the errors of a machine; the result has been read back and compared with the original.

    machine: machine file with its [errors.NAME]. options: those of `servomill compensate`: model, tolerance, max_block,
    work_offset, tool_length, tools, dialect, retract, ...
    """
    done = _core.compensate(_path(program), progress, machine=_path(machine), set=dict(set) if set else None, **options)
    return Compensated(done["program"], done["name"], done["report"], done["warnings"], json.loads(done["json"]))


class PostProcessed(NamedTuple):
    """A program from cutter locations."""

    program: str
    warnings: List[str]
    locations: int
    inserted: int     #: points between the locations
    verified: str     #: result of the comparison with the locations


def post(locations: Path, machine: Path, *, set: Changes = None, progress: Progress = None, **options: Any) -> PostProcessed:
    """Post-processes cutter locations (APT or CSV) to G-code.

    options: those of `servomill post`: tool_length, tools, work_offset, tolerance, tcp, classical, clearance, retract, ...
    """
    return PostProcessed(**_core.post(_path(locations), progress, machine=_path(machine), set=dict(set) if set else None, **options))


class Estimate(NamedTuple):
    """An identified value of a drive, in the unit of its key."""

    keys: List[str]
    value: float
    unit: str
    half_width: Optional[float]  #: of the 95 % interval; None: the recordings do not determine it


class Fit(NamedTuple):
    """How far the simulation is from one recording."""

    feedback_rms: float  #: m or rad
    force_rms: float     #: share of the rms of the recorded force; 0: none was recorded


class Identification(NamedTuple):
    estimates: List[Estimate]
    estimation: List[Fit]    #: of recordings that were fitted
    validation: List[Fit]    #: of those that were not
    converged: bool
    unidentifiable: List[str]
    warnings: List[str]
    report: str              #: all that the command prints

    def value(self, key: str) -> float:
        """The value of a key: `value("axis.X.moving_mass")`."""
        found = {name: one.value for one in self.estimates for name in one.keys}
        return found[key]


def _paths(files: Union[None, Path, Iterable[Path]]) -> List[str]:
    if files is None:
        return []
    return [_path(files)] if isinstance(files, (str, os.PathLike)) else [_path(one) for one in files]


def identify(experiment: Path, *, recording: Union[None, Path, Iterable[Path]] = None,
             validation: Union[None, Path, Iterable[Path]] = None, output: Optional[Path] = None,
             signals: Optional[Path] = None, force: bool = False, threads: int = 0, progress: Progress = None) -> Identification:
    """Finds parameters of drives from recordings of real axes.

    output: machine file with the identified values (.toml); signals: measured and simulated signals (.h5).
    """
    done = _core.identify(_path(experiment), _paths(recording), _paths(validation), _path(output), _path(signals), force,
                          threads, progress)
    done["estimates"] = [Estimate(*one) for one in done["estimates"]]
    for name in ("estimation", "validation"):
        done[name] = [Fit(*one) for one in done[name]]
    return Identification(**done)


class Function(NamedTuple):
    """A component error along the travel."""

    position: np.ndarray     #: (n; mm or deg)
    value: np.ndarray        #: (n; um or urad)
    uncertainty: np.ndarray  #: (n; um or urad) standard uncertainty
    in_combination: bool     #: it holds other errors, or a part of it is left out


class Location(NamedTuple):
    """A location error."""

    value: float        #: um or urad
    uncertainty: float  #: standard uncertainty
    in_combination: bool


class Calibration(NamedTuple):
    """Errors of a machine by their names of ISO 230-1."""

    functions: Dict[str, Function]
    locations: Dict[str, Location]
    unidentifiable: List[str]
    suggestions: List[str]   #: measurements that would determine them
    warnings: List[str]
    report: str              #: all that the command prints


def calibrate(readings: Path, *, machine: Optional[Path] = None, output: Optional[Path] = None, model: str = "identified",
              force: bool = False, accept_contradictions: bool = False, progress: Progress = None) -> Calibration:
    """Finds the geometric errors of a machine from readings of lasers, ball bars, R-tests and touch probes.

    machine: the measured machine; default: the one that the readings name. output: machine file with the errors as
    [errors.MODEL], their uncertainty and covariance (.toml); refused where readings contradict each other, unless
    accept_contradictions is true.
    """
    done = _core.calibrate(_path(readings), _path(machine), _path(output), model, force, accept_contradictions, progress)
    done["functions"] = {name: Function(*one) for name, one in done["functions"].items()}
    done["locations"] = {name: Location(*one) for name, one in done["locations"].items()}
    return Calibration(**done)
