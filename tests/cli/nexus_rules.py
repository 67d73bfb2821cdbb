"""Rules of NeXus that a result file keeps, so that viewers open it on a plot.

Sources, NeXus manual v2024.02: [D] "Rules for Storing Data Items in NeXus Files", section "Find the plottable data"
(version 3: attribute `default`); [N] base class NXdata; [R] base class NXroot, which has entries only as groups with
a default. Rules of our own are marked [S].
"""
import h5py
import numpy as np

GROUPS = ("NXroot", "NXentry", "NXsubentry", "NXcollection", "NXdata")
WITHOUT_UNIT = ("1", "unknown")


def faults(path):
    """Broken rules of a file, a line each."""
    out = []
    with h5py.File(path, "r") as file:
        out += default_faults(file)
        groups = [file]
        file.visititems(lambda _, thing: groups.append(thing) if isinstance(thing, h5py.Group) else None)
        for group in groups:
            out += group_faults(group)
        file.visititems(lambda name, thing: out.extend(dataset_faults(name, thing)))
    return out


def default_faults(file):
    """[D] From the root, `default` names a child, and so on until an NXdata group."""
    here, seen = file, 0
    while here.attrs.get("NX_class") != "NXdata":
        child = here.attrs.get("default")
        if not isinstance(child, str) or child not in here or seen > 10:
            return [f"{here.name}: default '{child}' leads to no plot"]
        here, seen = here[child], seen + 1
    return []


def group_faults(group):
    kind = group.attrs.get("NX_class")
    name = group.name
    if kind not in GROUPS:
        return [f"{name}: NX_class is {kind}"]
    out = []
    if (kind == "NXroot") != (name == "/"):
        out.append(f"{name}: NXroot is the root and nothing else")
    if kind == "NXentry" and group.parent.name != "/":
        out.append(f"{name}: [R] entries are below the root")
    if "default" in group.attrs and not isinstance(group.get(group.attrs["default"]), h5py.Group):
        out.append(f"{name}: [D] default names no group")
    return out + (data_faults(group) if kind == "NXdata" else [])


def texts(value):
    return [value] if isinstance(value, str) else [str(one) for one in value]


def data_faults(group):
    """[N] Signal, axes, their indices and auxiliary signals."""
    name, attrs = group.name, group.attrs
    signal = group.get(str(attrs.get("signal")))
    if not isinstance(signal, h5py.Dataset) or signal.ndim == 0:
        return [f"{name}: [N] signal is no dataset of at least one dimension"]
    out = label_faults(signal)
    axes = texts(attrs.get("axes", ()))
    if len(axes) != signal.ndim:
        out.append(f"{name}: [N] {len(axes)} axes of a signal with {signal.ndim} dimensions")
    for dimension, axis in enumerate(axes):
        if axis == ".":
            continue
        data = group.get(axis)
        if not isinstance(data, h5py.Dataset) or data.shape != (signal.shape[dimension],):
            out.append(f"{name}: [N] axis {axis} has not the length of dimension {dimension}")
            continue
        if data.dtype.kind not in "if":
            out.append(f"{name}: [S] axis {axis} is no number, which H5Web refuses")
        if attrs.get(f"{axis}_indices") != dimension:
            out.append(f"{name}: [N] {axis}_indices is not {dimension}")
        out += label_faults(data)
    for other in texts(attrs.get("auxiliary_signals", ())):
        data = group.get(other)
        if not isinstance(data, h5py.Dataset) or data.shape != signal.shape:
            out.append(f"{name}: [N] auxiliary signal {other} has not the shape of the signal")
            continue
        if data.attrs["units"] != signal.attrs["units"]:
            out.append(f"{name}: [S] auxiliary signal {other} has another unit than the signal")
        out += label_faults(data)
    return out


def label_faults(data):
    """[S] H5Web labels with long_name alone, so that has the unit."""
    units, label = str(data.attrs["units"]), str(data.attrs["long_name"])
    if not units or units in WITHOUT_UNIT or units.startswith("as ") or label.endswith(f" [{units}]"):
        return []
    return [f"{data.name}: [S] label '{label}' without unit {units}"]


def dataset_faults(name, data):
    """[S] Octave and netCDF read neither strings of variable length nor fixed ones; whole numbers are integers."""
    if not isinstance(data, h5py.Dataset):
        return []
    if data.dtype.kind in "OSU":
        return [] if data.dtype == np.dtype("S1") else [f"{name}: is a dataset of strings"]
    is_direction = data.ndim == 2 and data.shape[1] == 3
    is_of_user = "role" in data.attrs    # a column of a sweep: its numbers may be whole
    if data.dtype.kind != "f" or data.attrs["units"] != "1" or data.size < 2 or is_direction or is_of_user:
        return []
    values = data[:]
    if np.all(values == np.round(values)) and np.ptp(values) > 0.0:
        return [f"{name}: whole numbers are stored as {data.dtype}"]
    return []
