"""NetCDF in its classic form (CDF-1 and CDF-2); NetCDF-4 is HDF5."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

import numpy as np

from strikewave.records.readers import Options
from strikewave.records.readers.common import ArrayColumn, Scaled, array_columns, assemble, grid_of, left_out, text
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
            columns: list[ArrayColumn] = []
            skipped, scalars = [], list(vars(file).get("_attributes", {}).items())
            for name, variable in file.variables.items():
                numeric = variable.data.dtype.kind in "iuf"
                if numeric and not variable.data.shape:
                    scalars.append((name, variable.data[()]))
                    continue
                own = variable._attributes
                step, start = grid_of(own.items())
                unit = text(own.get("units", own.get("unit")))
                variable_columns = (
                    array_columns(name, _scaled(variable.data, own), unit, step=step, start=start) if numeric else []
                )
                columns += variable_columns
                skipped += [name] * (not variable_columns)
            record = assemble(path, "netcdf", columns, options, grid_of(scalars), left_out(skipped))
            del variable, columns, variable_columns
            return record


def _scaled(data: Any, attributes: dict[str, Any]) -> Scaled:
    return Scaled(lambda key: np.array(data[key], np.float64), attributes.get, data.shape)
