"""Result files, read when something of them is asked for."""
import os
import shutil
import weakref
from typing import Any, Callable, Dict, Iterator, List, Mapping, Optional, Union

import numpy as np

from . import _core
from .results import Case, Comparison, Row, Run
from .signals import Signals


def _own_long_name(long_name: str, name: str) -> str:
    """The part of one name; signals that are equal have one dataset, whose long name is that of all ("ref: ... = cmd: ...")."""
    for part in long_name.split(" = "):
        if part.startswith(f"{name}: "):
            return part[len(name) + 2:]
    return long_name


class _StoredSignals:
    """The group `servo` of a case, as servomill.signals.Signals wants it."""

    def __init__(self, group):
        self._group = group

    def __len__(self) -> int:
        return self._group["time"].shape[0]

    def descriptions(self) -> Dict[str, tuple]:
        out = {}
        for name, data in self._group.items():
            if name != "time" and data.attrs.get("CLASS") == b"DIMENSION_SCALE":
                continue
            scale = data.dims[1][0].name.rsplit("/", 1)[-1] if data.ndim == 2 else ""
            units = data.attrs["units"]
            # behind the long name of what NeXus viewers draw stands its unit, too
            long_name = data.attrs["long_name"].removesuffix(f" [{units}]")
            out[name] = (units, _own_long_name(long_name, name), data.attrs.get("columns", ""), scale)
        return out

    def array(self, name: str) -> np.ndarray:
        if not self._group:
            raise ValueError("the file is closed")
        values = self._group[name][()]
        values.flags.writeable = False
        return values


def _sections(text: str) -> List[str]:
    return text.split("\n")


def _stored_case(name: str, group) -> Case:
    attributes = group.attrs
    description = {
        "name": name,
        "finished": bool(attributes["finished"]),
        "outcome": attributes["outcome"] or "finished",
        "duration_s": float(attributes["duration_s"]),
        "blocks": float(attributes["blocks"]),
        "sections": _sections(attributes["sections"]),
        "program": attributes.get("program", ""),
    }
    last = Signals(_StoredSignals(group["last_ticks"])) if "last_ticks" in group else None
    return Case(description, Signals(_StoredSignals(group["servo"])), last)


def _stored_rows(file) -> List[Row]:
    rows = []
    for group in file.get("comparison", {}).values():
        of = group.attrs
        rows.append(Row(of["case"], of["quantity"], of["axis"], of["statistic"], of["sections"], float(group["value"][()]),
                        group["value"].attrs["units"], of["reference"], of["basis"], of.get("note", ""), of.get("tolerance")))
    return rows


class StoredRun(Run):
    """A run in a file; `file` is that of h5py, for all else that lies in it (sim/records/README.md)."""

    def __init__(self, path: str, file):
        self.file = file
        rows = _stored_rows(file)
        text = _core.format_rows([tuple(row) for row in rows])
        cases = [_stored_case(name, group) for name, group in file["cases"].items()]
        super().__init__(cases, Comparison(rows, text, file.attrs["title"]), file.attrs["title"], path, file.close)


class Sweep(Mapping[str, np.ndarray]):
    """The table of a sweep: one row a point, columns by name. A context manager that closes the file.

    Columns are the keys of the sweep, then the lines of the comparison (`describe` has their units); texts stand as they
    were written. `status` has "done", "stopped", "refused" or "failed" for each point, `reasons` why.
    """

    def __init__(self, path: str, file):
        self.path, self.file = path, file
        self._remove: Callable[[], object] = lambda: None
        table = self._table
        self._names: List[str] = sorted((name for name, data in table.items() if "role" in data.attrs),
                                        key=lambda name: table[name].attrs["role"] != "parameter")

    def remove_when_closed(self, folder: str) -> None:
        """Takes over the folder of the file: it is removed with the sweep, or when Python ends."""
        self._remove = weakref.finalize(self, shutil.rmtree, folder, ignore_errors=True)

    @property
    def _table(self):
        if not self.file:
            raise ValueError("the sweep is closed")
        return self.file["sweep"]

    def __getitem__(self, name: str) -> np.ndarray:
        if name not in self._names:
            raise KeyError(f"no column {name!r}; there are {', '.join(self._names)}")
        data = self._table[name]
        if "values" not in data.attrs:
            return data[()]
        texts = np.array(data.attrs["values"].split("\n"), dtype=object)
        return texts[data[()].astype(int)]

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def __len__(self) -> int:
        return len(self._names)

    @property
    def parameters(self) -> List[str]:
        """Columns of the keys that the sweep varies."""
        return [name for name in self._names if self.describe(name)["role"] == "parameter"]

    @property
    def quantities(self) -> List[str]:
        """Columns of the comparison."""
        return [name for name in self._names if self.describe(name)["role"] == "quantity"]

    def describe(self, name: str) -> Dict[str, Any]:
        """Units, long name, and what the column is of: key; or case, quantity, axis, statistic, sections."""
        hidden = ("CLASS", "NAME", "REFERENCE_LIST", "DIMENSION_LIST")
        return {key: value for key, value in self._table[name].attrs.items() if key not in hidden}

    @property
    def points(self) -> np.ndarray:
        """Numbers of the points, from 1."""
        return self._table["point"][()]

    @property
    def status(self) -> np.ndarray:
        data = self._table["status"]
        return np.array(data.attrs["flag_meanings"].split(), dtype=object)[data[()].astype(int)]

    @property
    def reasons(self) -> List[str]:
        return [b"".join(row).decode(errors="replace").strip() for row in self._table["reason"][()]]

    def to_xarray(self):
        """A Dataset over `point`, with units and long names."""
        import xarray

        variables = {name: ("point", self[name], self.describe(name)) for name in self}
        return xarray.Dataset({**variables, "status": ("point", self.status)}, {"point": self.points})

    def to_dataframe(self):
        """A DataFrame of pandas, one line a point."""
        return self.to_xarray().to_dataframe()

    def close(self) -> None:
        self.file.close()
        self._remove()

    def __enter__(self) -> "Sweep":
        return self

    def __exit__(self, *_) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"<sweep of {len(self.points)} points: {', '.join(self._names)}>" if self.file else "<closed sweep>"


def open(path: Union[str, os.PathLike]) -> Union[StoredRun, Sweep]:
    """Opens a result file of `run` or `sweep`, of this package or of the command.

    Nothing but names and attributes is read; arrays are when they are asked for. The result is a context manager.

    >>> import servomill
    >>> with servomill.open(example_result) as result:
    ...     result["feedback"].servo["true_linear"].shape[1], result["feedback"].servo.units("true_linear")
    (3, 'mm')
    """
    import h5py

    path = os.fspath(path)
    if os.path.isfile(path) and not h5py.is_hdf5(path):
        raise ValueError(f"{path}: is no HDF5 file, so no result of a run or a sweep")
    file = h5py.File(path, "r")
    kind = file.attrs.get("kind")
    if kind == "run":
        return StoredRun(path, file)
    if kind == "sweep":
        return Sweep(path, file)
    file.close()
    raise ValueError(f"{path}: is no result of a run or a sweep; open it with h5py")
