"""Results of runs, in memory or in a file."""
from typing import Any, Callable, Dict, Iterator, List, Mapping, NamedTuple, Optional, Sequence

import numpy as np

from .signals import Signals


class Row(NamedTuple):
    """One line of a comparison."""

    case: str
    quantity: str
    axis: str       #: "" where the quantity has none
    statistic: str
    sections: str
    value: float    #: in `unit`; NaN where the case stopped or the samples are missing
    unit: str
    reference: str  #: the paper's number with its unit, or ""
    basis: str      #: fitted, predicted, assumed, upper_bound or ""
    note: str       #: why there is no value, or what is not alike
    tolerance: Optional[str]


class Comparison(Sequence[Row]):
    """The lines that the scenario asks for; printed as the command prints them."""

    def __init__(self, rows: List[Row], text: str, title: str = ""):
        self._rows, self._text, self.title = rows, text, title

    def __getitem__(self, index):
        return self._rows[index]

    def __len__(self) -> int:
        return len(self._rows)

    def __str__(self) -> str:
        return self._text

    def __repr__(self) -> str:
        return self._text

    def find(self, quantity: str, case: Optional[str] = None, axis: Optional[str] = None,
             statistic: Optional[str] = None, section: Optional[str] = None) -> Row:
        """The only line with these properties. Raises LookupError where there are none or several."""
        wanted = {"quantity": quantity, "case": case, "axis": axis, "statistic": statistic, "sections": section}
        found = [row for row in self._rows
                 if all(value is None or getattr(row, name) == value for name, value in wanted.items())]
        if len(found) != 1:
            raise LookupError(f"{len(found)} lines of the comparison have "
                              + ", ".join(f"{name} {value!r}" for name, value in wanted.items() if value is not None))
        return found[0]

    def value(self, quantity: str, case: Optional[str] = None, axis: Optional[str] = None,
              statistic: Optional[str] = None, section: Optional[str] = None) -> float:
        """The value of that line, in its unit."""
        return self.find(quantity, case, axis, statistic, section).value

    def to_dataframe(self):
        """A DataFrame of pandas with one line a row."""
        import pandas

        return pandas.DataFrame(self._rows, columns=Row._fields)


class Case:
    """One case of a run: how it ended, and its signals.

    `servo` has the rows of the recording, `last_ticks` the last position periods of a case that stopped.
    """

    def __init__(self, description: Dict[str, Any], servo: Signals, last_ticks: Optional[Signals] = None):
        self.name: str = description["name"]
        self.finished: bool = description["finished"]
        self.outcome: str = description["outcome"]              #: "finished", or why the machine stopped
        self.duration_s: float = description["duration_s"]      #: of the program that the NC ran
        self.blocks: float = description["blocks"]              #: motion blocks of that program
        self.sections: List[str] = description["sections"]
        self.program: str = description["program"]              #: as rewritten; "": the original one ran
        self.notes: List[str] = description.get("notes", [])    #: what the NC corrected or could not do
        self.simulated_s: Optional[float] = description.get("simulated_s")
        self.computing_s: Optional[float] = description.get("computing_s")
        self.servo, self.last_ticks = servo, last_ticks

    def in_section(self, name: str) -> np.ndarray:
        """The rows of `servo` (rows; bool) that lie in the sections of this name: comments (MSG, NAME) begin them."""
        if name not in self.sections:
            raise KeyError(f"no section {name!r}; there are {', '.join(map(repr, self.sections))}")
        return np.isin(self.servo["section"], [n for n, one in enumerate(self.sections) if one == name])

    def to_xarray(self):
        """`servo` as a Dataset of xarray."""
        return self.servo.to_xarray()

    def __repr__(self) -> str:
        return f"<case {self.name}: {self.outcome}, {self.servo.rows} rows>"


class Run(Mapping[str, Case]):
    """A run: its cases by name, and the comparison. A context manager that lets go of the recording, or closes the file.

    Arrays that were taken from it stay.
    """

    def __init__(self, cases: List[Case], comparison: Comparison, title: str, path: Optional[str] = None,
                 close: Optional[Callable[[], None]] = None, computing_s: Optional[float] = None):
        self._cases: Optional[Dict[str, Case]] = {case.name: case for case in cases}
        self.comparison, self.title, self.path, self.computing_s = comparison, title, path, computing_s
        self._close = close

    @property
    def cases(self) -> Dict[str, Case]:
        if self._cases is None:
            raise ValueError("the run is closed")
        return self._cases

    def __getitem__(self, name: str) -> Case:
        return self.cases[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self.cases)

    def __len__(self) -> int:
        return len(self.cases)

    def close(self) -> None:
        self._cases = None
        if self._close is not None:
            self._close()
            self._close = None

    def __enter__(self) -> "Run":
        return self

    def __exit__(self, *_) -> None:
        self.close()

    def to_xarray(self):
        """The signals of every case: Datasets by name of the case."""
        return {name: case.to_xarray() for name, case in self.cases.items()}

    def __repr__(self) -> str:
        if self._cases is None:
            return f"<closed run {self.title!r}>"
        return f"<run {self.title!r}: {', '.join(self.cases)}>"
