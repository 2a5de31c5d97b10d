"""NetCDF in its classic form (CDF-1 and CDF-2); NetCDF-4 is HDF5."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

import numpy as np

from strikewave.records.readers import Options
from strikewave.records.readers.common import Column, assemble, columns_of, grid_of, left_out, number, text
from strikewave.records.record import Record


def sniff(head: bytes) -> bool:
    """Return whether a file begins like classic NetCDF."""
    return head[:4] in (b"CDF\x01", b"CDF\x02")


def read(path: Path, options: Options) -> Record:
    """Read the 1-D variables and narrow tables of a classic NetCDF file."""
    from scipy.io import netcdf_file

    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", category=RuntimeWarning, module=r"scipy\.io")
        with netcdf_file(path, "r", mmap=True) as file:
            columns: list[Column] = []
            skipped, scalars = [], list(vars(file).get("_attributes", {}).items())
            for name, variable in file.variables.items():
                numeric = variable.data.dtype.kind in "iuf"
                if numeric and not variable.data.shape:
                    scalars.append((name, variable.data[()]))
                    continue
                own = variable._attributes
                step, start = grid_of(own.items())
                unit = text(own.get("units", own.get("unit")))
                found = columns_of(name, _Scaled(variable.data, own), unit, step=step, start=start) if numeric else []
                columns += found
                skipped += [name] * (not found)
            record = assemble(path, "netcdf", columns, options, grid_of(scalars), left_out(skipped))
            del variable, columns, found
            return record


class _Scaled:
    """Slices of a variable with scale, offset and fill value of the CF conventions applied."""

    def __init__(self, data: Any, named: dict[str, Any]) -> None:
        self.data, self.named, self.shape = data, named, data.shape

    def __getitem__(self, key: Any) -> Any:
        values = np.array(self.data[key], np.float64)
        for name in ("_FillValue", "missing_value"):
            values[values == number(self.named.get(name))] = np.nan
        scale, offset = number(self.named.get("scale_factor")), number(self.named.get("add_offset"))
        values *= 1.0 if np.isnan(scale) else scale
        return values if np.isnan(offset) else values + offset
