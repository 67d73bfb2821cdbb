"""Recorded signals by name: arrays with their units, and Datasets of xarray."""
from typing import Any, Dict, Iterator, Mapping, NamedTuple

import numpy as np


class Description(NamedTuple):
    """A signal as the result file describes it."""

    units: str      #: "mm", "um", "s", ...
    long_name: str
    labels: str     #: one letter a column ("XYZ"); empty: a scalar
    dimension: str  #: name of that dimension ("axis_linear"); empty: a scalar


class Signals(Mapping[str, np.ndarray]):
    """The recorded signals of a case, by the names that the result file has.

    `signals["true_linear"]` is an array (rows, 3), read only, in the unit `signals.units("true_linear")`. Of a run in memory
    it is a view of the recording, which stays as long as the array; of a file, and of a recording that has outgrown memory,
    it is read when it is asked for.
    """

    def __init__(self, source: Any):
        self._source = source
        self._descriptions: Dict[str, Description] = {
            name: Description(*one) for name, one in source.descriptions().items()}

    def __getitem__(self, name: str) -> np.ndarray:
        if name not in self._descriptions:
            raise KeyError(f"no signal {name!r}; there are {', '.join(self._descriptions)}")
        return self._source.array(name)

    def __iter__(self) -> Iterator[str]:
        return iter(self._descriptions)

    def __len__(self) -> int:
        return len(self._descriptions)

    @property
    def rows(self) -> int:
        """Number of rows, one a record period."""
        return len(self._source)

    def describe(self, name: str) -> Description:
        return self._descriptions[name]

    def units(self, name: str) -> str:
        return self._descriptions[name].units

    def axis(self, name: str, letter: str) -> np.ndarray:
        """One column of a signal: `signals.axis("true_linear", "Y")` (rows)."""
        labels = self._descriptions[name].labels
        if letter not in labels or len(letter) != 1:
            raise KeyError(f"{name} has the columns {', '.join(labels) or 'of a scalar'}, not {letter!r}")
        return self[name][:, labels.index(letter)]

    def to_xarray(self):
        """A Dataset over `time` (s), with the units and long names of the result file."""
        import xarray

        variables, coordinates = {}, {}
        for name, one in self._descriptions.items():
            attributes = {"units": one.units, "long_name": one.long_name}
            if name == "time":
                coordinates["time"] = ("time", self[name], attributes)
                continue
            dimensions = ("time", one.dimension) if one.labels else ("time",)
            variables[name] = (dimensions, self[name], attributes)
            if one.labels:
                coordinates[one.dimension] = list(one.labels)
        return xarray.Dataset(variables, coordinates)

    def __repr__(self) -> str:
        return f"<{self.rows} rows of {', '.join(self)}>"
