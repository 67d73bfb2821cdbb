#!/usr/bin/python3
"""Opens the file of series_writer_test with h5py and xarray, knowing nothing of servomill."""
import sys

import h5py
import numpy as np
import xarray

path = sys.argv[1]

with h5py.File(path, "r") as file:
    assert file.attrs["Conventions"] == "CF-1.8", file.attrs["Conventions"]
    assert file["inputs"].attrs["scenario"] == 'title = "Épreuve"\n', file["inputs"].attrs["scenario"]
    assert list(file["cases"]) == ["table", "gcode"], list(file["cases"])  # order of making

    def complete(name, thing):
        if isinstance(thing, h5py.Dataset):
            assert isinstance(thing.attrs["units"], str) and thing.attrs["units"], name
            assert isinstance(thing.attrs["long_name"], str) and thing.attrs["long_name"], name

    file.visititems(complete)

    servo = file["cases/table/servo"]
    series = servo["ref_linear"]
    assert series.shape == (10, 3) and series.chunks == (4, 1) and series.shuffle, series.chunks
    assert series.compression == "gzip" and series.compression_opts == 1
    assert [d.keys()[0] for d in series.dims] == ["time", "axis_linear"], [d.keys() for d in series.dims]
    assert servo["line"].dims[0][0] == servo["time"] and servo["line"].dtype == np.int32
    assert servo["contour_error"].dtype == np.float32
    assert b"".join(servo["axis_linear"][:]) == b"XYZ"
    assert np.array_equal(series[:, 1], 100 * np.arange(10) + 1)

with xarray.open_dataset(path, group="cases/table/servo", engine="h5netcdf") as data:
    assert dict(data.sizes)["time"] == 10 and dict(data.sizes)["axis_linear"] == 3, data.sizes
    assert data["ref_linear"].dims == ("time", "axis_linear"), data["ref_linear"].dims
    assert data["ref_linear"].attrs["units"] == "mm"
    at = data["ref_linear"].sel(time=0.5, method="nearest").values
    assert np.array_equal(at, [500, 501, 502]), at

with xarray.open_dataset(path, group="cases/gcode/probes", engine="h5netcdf") as data:
    assert data["deviation"].dims == ("point",), data["deviation"].dims

with xarray.open_dataset(path, group="comparison/residual", engine="h5netcdf") as data:
    assert float(data["value"]) == 20.0
