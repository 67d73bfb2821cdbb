"""Our side of each row: values of the comparison that a run stores, and what is derived from its file."""
import dataclasses
import math
import pathlib

from command_line import InputError
from figures.results import NotInFile, open_result
from reproduction import derived

MATCHED = ("case", "quantity", "axis", "sections", "statistic")   # attributes of a stored row


@dataclasses.dataclass(frozen=True)
class Value:
    number: float | None
    reason: str = ""      # why there is none


class Results:
    """Result files of one folder by the name of their scenario; read when asked for."""

    def __init__(self, folder, failed=None):
        """failed: {run: why its scenario failed}"""
        self.folder, self.failed = pathlib.Path(folder), failed or {}
        self._compared, self._opened, self._made = {}, {}, {}

    def path(self, run):
        """Its result file. NotInFile where there is none."""
        path = self.folder / f"{run}.h5"
        if run in self.failed:
            raise NotInFile(f"{run}: {self.failed[run]}")
        if not path.exists():
            raise NotInFile(f"{path.name} was not written")
        return path

    def compared(self, run):
        """The rows that a run compared, as dicts. NotInFile where there are none."""
        if run not in self._compared:
            table = self.opened(run).h5.get("comparison")
            if table is None:
                raise NotInFile(f"{run} has an incomplete comparison")
            self._compared[run] = [
                {**{key: str(text) for key, text in row.attrs.items()}, "value": float(row["value"][()]),
                 "unit": str(row["value"].attrs["units"])} for row in table.values()]
        return self._compared[run]

    def opened(self, run):
        """The result file as figures.results has it."""
        if run not in self._opened:
            path = self.path(run)
            try:
                self._opened[run] = open_result(path)
            except InputError as fault:
                raise NotInFile(f"{fault}") from None
        return self._opened[run]

    def once(self, key, make):
        """make(), the first time; what it gave, later."""
        if key not in self._made:
            self._made[key] = make()
        return self._made[key]

    def close(self):
        for one in self._opened.values():
            one.h5.close()


def _matches(wanted, row):
    return all(row.get(key) == wanted[key] for key in MATCHED if key in wanted)


def _compared(wanted, results, unit):
    rows = [row for row in results.compared(wanted["run"]) if _matches(wanted, row)]
    what = ", ".join(str(wanted[key]) for key in ("run", *MATCHED) if key in wanted)
    if not rows:
        raise NotInFile(f"no value for {what}")
    if len(rows) > 1:
        raise NotInFile(f"{len(rows)} values for {what}")
    if not math.isfinite(rows[0]["value"]):
        raise NotInFile(f"the value for {what} is not a number" + (f": {rows[0]['note']}" if "note" in rows[0] else ""))
    if "points of" in rows[0].get("note", ""):
        raise NotInFile(f"the value for {what} covers only part of its points: {rows[0]['note']}")
    if unit is not None and rows[0]["unit"] != unit:
        raise NotInFile(f"{what} is in {rows[0]['unit']}, not in {unit}")
    return rows[0]["value"]


def _number(wanted, results, unit):
    if "derived" in wanted:
        arguments = {key: value for key, value in wanted.items() if key not in ("derived", "absolute")}
        return derived.FUNCTIONS[wanted["derived"]](results, **arguments)
    if "over" in wanted:   # a ratio of two values; in percent where the row is
        above, below = _compared(wanted, results, None), _compared({"run": wanted["run"], **wanted["over"]}, results, None)
        if below == 0.0:
            raise NotInFile("the value that it is compared with is 0")
        return above / below * (100.0 if unit == "%" else 1.0)
    if "of" in wanted:   # in percent of a number
        return 100.0 * _compared(wanted, results, None) / wanted["of"]
    return _compared(wanted, results, unit)


def find(row, results):
    """Value of a row: of `here` either a row of the comparison (run, case, quantity, ...), the ratio of two (over), its
    share of a number (of), or what a function of derived.py makes of the files (derived and its arguments)."""
    if not row.here:
        return Value(None, row.lacks)
    try:
        number = _number(row.here, results, row.unit)
    except NotInFile as reason:
        return Value(None, f"{reason}")
    if row.here.get("absolute"):
        number = abs(number)
    return Value(number) if math.isfinite(number) else Value(None, "is not a number")
