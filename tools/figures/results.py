"""Result files of servomill (HDF5) as arrays, and differences between cases along the path.

Positions are in mm, differences in um, angles in deg, time in s, as the file's `units` say. The
definitions are those of `servomill compare` (sim/evaluation/comparison.h); a test holds the two together.
"""
import dataclasses
import pathlib
import tomllib

import h5py
import numpy as np

from command_line import InputError
from figures import names as naming
from figures import rows as of_file

SCHEMA_VERSION = 1
SWEEP_SCHEMA_VERSION = 3
DONE = 1   # of the column `status` of a sweep
UM_PER_MM = 1000.0


class NotInFile(Exception):
    """A figure cannot be drawn from this file; the text says what is missing."""


class ResultFile:
    """What run and sweep files have in common. Use as a context manager."""

    def __init__(self, path):
        self.path = pathlib.Path(path)
        if not self.path.exists():
            raise InputError(f"{path}: error: no such file")
        if self.path.is_dir():
            raise InputError(f"{path}: error: is a folder, not a result file of servomill")
        if not self.path.is_file():   # opening a pipe would wait for whoever writes into it
            raise InputError(f"{path}: error: is not a regular file")
        try:
            self.h5 = h5py.File(self.path, "r")
        except OSError as fault:
            if not h5py.is_hdf5(self.path):
                raise InputError(f"{path}: error: is not an HDF5 file") from None
            reason = str(fault).splitlines()[0]
            raise InputError(f"{path}: error: cannot be read as HDF5: {reason}") from None
        root = self.h5.attrs
        if "schema_version" not in root or "kind" not in root:
            raise InputError(f"{path}: error: is not a result file of servomill")
        self.kind = str(root["kind"])          # of KINDS
        wanted = SWEEP_SCHEMA_VERSION if self.kind == "sweep" else SCHEMA_VERSION
        if int(root["schema_version"]) != wanted:
            raise InputError(f"{path}: error: has schema version {int(root['schema_version'])}; "
                             f"this program reads version {wanted}")
        self.title = str(root.get("title", ""))
        try:
            self.scenario = tomllib.loads(str(self.h5["inputs"].attrs["resolved"]))
        except (KeyError, tomllib.TOMLDecodeError):
            self.scenario = {}                 # figures then know the cases by their names only

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.h5.close()

    def strategies(self, case):
        """Tables [[case.strategy]] of a case, in the order in which they act."""
        for one in self.scenario.get("case", []):
            if one.get("name") == case:
                return one.get("strategy", [])
        return []


class Case:
    """One case of a run: arrays of its group `servo`, read when asked for; of a long one some rows (figures/rows.py)."""

    def __init__(self, name, group):
        self.name = name
        self.finished = int(group.attrs["finished"]) != 0
        self.outcome = str(group.attrs.get("outcome", ""))
        self.sections = str(group.attrs["sections"]).split("\n")
        self._servo = group["servo"]
        self._kept = of_file.kept_rows(self._servo) if "s" in self._servo else None
        self._gaps = of_file.gaps(of_file.read(self._servo["window"], self._kept)) if "window" in self._servo else []
        self._read = {}

    def has_gaps(self):
        """Whether rows were left out (record.windows). There a blank row stands in the columns."""
        return len(self._gaps) > 0

    def has(self, name):
        return name in self._servo

    def labels(self, name):
        """Letters of the columns of a dataset, "XYZ" say."""
        return str(self._servo[name].attrs["columns"])

    def column(self, name, letter=None):
        """A dataset (samples), or the column of one axis of it."""
        if (name, letter) not in self._read:
            if name not in self._servo:
                raise NotInFile(f"case {self.name} has no {name}")
            data = self._servo[name]
            if letter is not None and letter not in self.labels(name):
                raise NotInFile(f"{name} has no axis {letter}")
            column = None if letter is None else self.labels(name).index(letter)
            self._read[name, letter] = of_file.with_blank_rows(name, of_file.read(data, self._kept, column), self._gaps)
        return self._read[name, letter]

    def along(self, name, letter, s):
        """Values of a column at other arc lengths: of_file.along_path, from all rows.
        NotInFile: some of these were left out"""
        if self._kept is None:
            values = of_file.along_path(self, self.column(name, letter), s)
        else:
            values = of_file.values_along(self._servo["s"], self._servo[name], self.labels(name).index(letter), s,
                                          self._servo.get("window"))
        if self.has_gaps() and np.isnan(values).any():
            raise NotInFile(f"case {self.name} has no rows at some of these places (record.windows)")
        return values

    def samples(self, sections=None):
        """Indices of the samples of feed motion in the windows of the recording, in the sections named (all without)."""
        chosen = self.column("rapid") == 0.0
        if self.has("in_window"):
            chosen &= self.column("in_window") == 1.0
        if sections is not None:
            numbers = [i for i, name in enumerate(self.sections) if name in sections]
            chosen &= np.isin(self.column("section"), numbers)
        return np.flatnonzero(chosen)


class Run(ResultFile):
    """A file that `servomill run` wrote."""

    names = naming.Names()   # of its cases and sections, where they are not the paper's

    def __init__(self, path):
        super().__init__(path)
        if self.kind != "run":
            raise InputError(f"{path}: error: contains a {self.kind}, not a run")
        groups = self.h5.get("cases", {})
        order = [one.get("name") for one in self.scenario.get("case", [])]
        names = sorted(groups, key=lambda n: (order.index(n) if n in order else len(order), n))
        self.cases = {name: Case(name, groups[name]) for name in names}

    def finished_cases(self):
        return [case for case in self.cases.values() if case.finished]

    def base(self):
        """The case that the others are compared with: the scenario's, or the one named nominal."""
        named = [q["baseline"] for q in self.scenario.get("quantity", [])
                 if q.get("name") == "imposed_error_residual" and "baseline" in q]
        own = [self.names.cases["nominal"]] if "nominal" in self.names.cases else []
        for name in own or named + ["nominal"]:
            if name in self.cases:
                if not self.cases[name].finished:
                    raise NotInFile(f"case {name}, the baseline, stopped")
                return self.cases[name]
        raise NotInFile(f"no case named {self.names.case('nominal')} to compare with" + self.case_hint("nominal"))

    def case_hint(self, name):
        return naming.hint("case", name, self.names.case(name), list(self.cases))

    def part(self, name):
        """The finished case that stands for the paper's of that name."""
        own = self.names.case(name)
        if own not in self.cases:
            raise NotInFile(f"no case named {own}" + self.case_hint(name))
        if not self.cases[own].finished:
            raise NotInFile(f"case {own} stopped")
        return self.cases[own]

    def no_motion(self, names):
        """What to throw where no section that stands for the paper's `names` has feed motion."""
        own = [self.names.section(name) for name in names]
        there = [name for case in self.cases.values() for name in case.sections if name]
        what = "a section" if len(own) == 1 else "sections"
        return NotInFile(f"no feed motion in {what} named {', '.join(own)}" +
                         naming.hint("section", names[0], own[0], there))

    def others(self):
        """Finished cases without the base; all of these can be compared with it."""
        base = self.base()
        found = [case for case in self.finished_cases() if case is not base]
        if not found:
            raise NotInFile("no finished case to compare with " + base.name)
        return found

    def imposed_name(self):
        """Name of the error model that the comparison is about."""
        models = list(self.h5.get("errors", {}))
        name = self.scenario.get("imposed", models[0] if len(models) == 1 else None)
        if name not in models:
            raise NotInFile("no error model is imposed")
        return name

    def need_errors_of_only(self, axis):
        """Throws NotInFile unless the imposed errors depend on this axis and on no other."""
        axes = [name for name in self.h5[f"errors/{self.imposed_name()}"] if name != "locations"]
        if axes != [axis]:
            raise NotInFile(f"the imposed errors are functions of {', '.join(axes)}, not of "
                            f"{axis} alone")

    def error_functions(self, axis):
        """{name: (positions, values, unit)} of the imposed model's functions of one axis."""
        path = f"errors/{self.imposed_name()}/{axis}"
        if path not in self.h5:
            raise NotInFile(f"no error functions of {axis}")
        group = self.h5[path]
        position = group["position"][:]
        return {name: (position, data[:], str(data.attrs["units"]))
                for name, data in group.items() if name != "position"}


@dataclasses.dataclass(frozen=True, eq=False)
class Parameter:
    """One key of a sweep: a number a point, or one of some texts."""
    key: str
    unit: str
    values: np.ndarray        # numbers; of texts their places; NaN where a point was not run
    texts: tuple = ()
    sampled: bool = False     # from a distribution, else on the grid
    others: int = 0           # parameters that go together with this one

    def label(self):
        return self.key + (f" (and {self.others} more)" if self.others else "") + ("" if self.unit == "1" else f", {self.unit}")

    def goes_with(self, other):
        """Whether each value of one has its value of the other."""
        good = np.isfinite(self.values) & np.isfinite(other.values)
        pairs = np.unique(np.column_stack([self.values[good], other.values[good]]), axis=0)
        return len(pairs) == len(self.distinct()) == len(other.distinct())

    def distinct(self):
        """The values that there are, sorted."""
        return np.unique(self.values[np.isfinite(self.values)])


class Sweep(ResultFile):
    """A file that `servomill sweep` wrote: `parameters`, and `quantities`, a list of dicts. Points
    that were not run have no row here."""

    def __init__(self, path):
        super().__init__(path)
        if self.kind != "sweep":
            raise InputError(f"{path}: error: contains a {self.kind}, not a sweep")
        if "sweep/status" not in self.h5:
            raise InputError(f"{path}: error: has an incomplete table")
        table = self.h5["sweep"]
        self.run = table["status"][:] != 0
        self.done = table["status"][:][self.run] == DONE
        columns = [data for data in table.values() if "role" in data.attrs]
        self.parameters = [self._parameter(data) for data in columns if data.attrs["role"] == "parameter"]
        self.keys = {one.key: one.values for one in self.parameters}
        self.quantities = [
            {**{name: str(data.attrs[name]) for name in ("case", "quantity", "axis", "statistic", "sections",
                                                         "reference", "basis")},
             "value": data[:][self.run], "unit": str(data.attrs["units"])}
            for data in columns if data.attrs["role"] == "quantity"]

    def _parameter(self, data):
        key = str(data.attrs["key"])
        texts = tuple(str(data.attrs["values"]).split("\n")) if "values" in data.attrs else ()
        return Parameter(key, str(data.attrs["units"]), data[:][self.run].astype(float), texts,
                         naming.is_sampled(self.scenario.get("sweep", {}), key))

    def varied(self, sampled):
        """Parameters with more than one value: the sampled ones, or those of the grid, of which only the
        first of those that go together."""
        found = []
        for one in self.parameters:
            if one.sampled != sampled or len(one.distinct()) < 2:
                continue
            leader = next((n for n, other in enumerate(found) if not sampled and one.goes_with(other)), None)
            if leader is None:
                found.append(one)
            else:
                found[leader] = dataclasses.replace(found[leader], others=found[leader].others + 1)
        return found


class Responses(ResultFile):
    """A file that `servomill bode` or `servomill step` wrote: `axes` {letter: its group}."""

    def __init__(self, path):
        super().__init__(path)
        self.axes = dict(self.h5.get(self.kind, {}))
        if not self.axes:
            raise InputError(f"{path}: error: contains no {self.kind} of any axis")

    def unit(self, letter, curve):
        """Unit of the magnitude of a curve, as a reader writes it."""
        text = str(self.axes[letter][curve]["magnitude"].attrs["units"])
        return {"um N-1": "µm/N", "urad N-1 m-1": "µrad/Nm"}.get(text, text)

    def transmission(self, letter):
        """Slide travel (mm, deg) per motor angle (rad)."""
        return float(self.axes[letter].attrs["travel_per_radian"])


class CompensatedProgram(ResultFile):
    """A file that `servomill compensate --record` wrote: arrays of its path by name."""

    def __init__(self, path):
        super().__init__(path)
        group = self.h5["compensate"]
        self.compensate = {name: group[name][:] for name in ("s", "line", "block_end", "rapid")}
        for name in ("position", "correction"):
            self.compensate[name] = np.stack([group[f"{name}_{axis}"][:] for axis in "xyz"], axis=1)


@dataclasses.dataclass(frozen=True)
class BudgetPart:
    """One signal of a budget (um) where the residual is largest, and its rms."""
    name: str
    at_place: float
    rms: float
    signal: np.ndarray


class Budget:
    """The budget of one quantity of one case."""

    def __init__(self, group):
        self.case, self.quantity, self.axis, self.sections = (
            str(group.attrs[name]) for name in ("case", "quantity", "axis", "sections"))
        signals = [name for name, one in group.items() if isinstance(one, h5py.Dataset) and name != "s"]
        kept = of_file.kept_rows(group, deciding=signals)
        self.place, self.s = float(group.attrs["place"]), of_file.read(group["s"], kept)
        parts = {name: BudgetPart(name, float(group[name].attrs["at_place"]), float(group[name].attrs["rms"]),
                                  of_file.read(group[name], kept)) for name in signals}
        self.residual, self.remainder = parts.pop("residual"), parts.pop("remainder")
        self.parts = list(parts.values())


class Budgets(ResultFile):
    """A file that `servomill budget` wrote: `budgets`, without those of cases that stopped."""

    def __init__(self, path):
        super().__init__(path)
        self.budgets = [Budget(group) for group in self.h5.get("budget", {}).values()
                        if not str(group.attrs["note"])]
        if not self.budgets:
            raise InputError(f"{path}: error: contains no budget of a finished case")


KINDS = {"budget": Budgets, "run": Run, "sweep": Sweep, "bode": Responses, "step": Responses, "compensate": CompensatedProgram}


# what h5py and numpy throw where groups, datasets or attributes are missing, of another type, or cannot be read
DAMAGES = (KeyError, ValueError, TypeError, OSError, RuntimeError, AttributeError, IndexError, OverflowError)


def damaged(path, fault):
    reason = fault.args[0] if isinstance(fault, KeyError) else fault   # a KeyError puts quotes around it
    return InputError(f"{path}: error: is damaged ({' '.join(str(reason).split())})")


def open_result(path):
    """The file as what its kind says.
    InputError: it cannot be read, is none of servomill, or is damaged"""
    try:
        with ResultFile(path) as probe:
            kind = probe.kind
    except DAMAGES as fault:
        raise damaged(path, fault) from None
    if kind not in KINDS:
        raise InputError(f"{path}: error: contains a {kind}; figures are drawn from " +
                         ", ".join(KINDS))
    try:
        return KINDS[kind](path)
    except DAMAGES as fault:
        raise damaged(path, fault) from None


def trajectory_difference(case, base, axis, rows):
    """Scale reading of a case minus that of the base at equal s (um), at the samples `rows`."""
    nominal = base.along("meas_linear", axis, case.column("s")[rows])
    return (case.column("meas_linear", axis)[rows] - nominal) * UM_PER_MM


def imposed_error_residual(case, base, axis, rows):
    """trajectory_difference minus the imposed displacement at the programmed position (um)."""
    return trajectory_difference(case, base, axis, rows) - case.column("imposed_linear", axis)[rows]


def programmed(base, axis, s):
    """Interpolated position of the base case at given arc lengths (mm)."""
    return base.along("ref_linear", axis, s)


def passes(rows):
    """Splits rising sample indices where samples are left out: one array a pass."""
    return np.split(rows, np.flatnonzero(np.diff(rows) > 1) + 1) if len(rows) else []
