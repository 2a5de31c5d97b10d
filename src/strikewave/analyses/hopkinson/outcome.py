"""What every result of a split-bar set-up is: its set-up, files, warnings and sources."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from strikewave._version import __version__
from strikewave.analyses.hopkinson.setup_file import SplitBarCase
from strikewave.base.result import Notice

if TYPE_CHECKING:
    import xarray


SCHEMA = 1
"""Of the files of a solution."""


@dataclass(frozen=True, kw_only=True)
class Outcome(ABC):
    """What a set-up came to.

    Attributes
    ----------
    case : SplitBarCase
        Set-up, its text, its folder.
    digests : mapping
        SHA-256 of the files, by their names.
    warnings : tuple of Notice
        What to know.
    citations : tuple of str
        Keys of the sources.
    """

    case: SplitBarCase
    digests: Mapping[str, str]
    warnings: tuple[Notice, ...]
    citations: tuple[str, ...]

    @property
    def title(self) -> str:
        """The title of the set-up."""
        return self.case.setup.title or self.case.setup.name

    @property
    def broken(self) -> bool:
        """Whether a stated limit was broken."""
        return any(notice.broken for notice in self.warnings)

    @abstractmethod
    def dataset(self) -> xarray.Dataset:
        """Return the histories with units."""

    def save(self, path: Path) -> None:
        """Write the histories as NetCDF."""
        self.dataset().to_netcdf(path, engine="h5netcdf")

    def attributes(self) -> dict[str, Any]:
        """Return what stands at the head of a dataset."""
        return {"strikewave_schema": SCHEMA, "strikewave_version": __version__, "case": self.case.text}


def csv_text(columns: Mapping[str, NDArray[np.float64]]) -> str:
    """Return columns of equal length as CSV text; nothing where there is no number."""
    lines = [",".join(columns)]
    for row in zip(*columns.values(), strict=True):
        lines.append(",".join("" if value != value else f"{value:.9g}" for value in row))
    return "\n".join(lines) + "\n"
