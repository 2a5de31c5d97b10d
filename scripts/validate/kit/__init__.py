"""What studies share: measured files unpacked, tables and text in pages, and the record of comparisons."""

from __future__ import annotations

import lzma
import shutil
from pathlib import Path

from .evidence import Comparison, keep
from .pages import ROOT, cells_of, renewed, table, write_into

__all__ = [
    "DATA",
    "IMAGES",
    "PAGE",
    "ROOT",
    "Comparison",
    "cells_of",
    "keep",
    "renewed",
    "table",
    "unpacked",
    "write_into",
]

DATA = ROOT / "tests" / "data"
"""Measured files that the project carries, a folder a source."""
PAGE = ROOT / "docs" / "fit-measured.md"
"""The page of the studies that fit."""
IMAGES = ROOT / "docs" / "images"


def unpacked(source: Path, folder: Path) -> list[Path]:
    """Return the files of a folder in the order of their names, those packed with xz as copies in another folder."""
    found = []
    for file in sorted(source.iterdir()):
        place = folder / (file.stem if file.suffix == ".xz" else file.name)
        if file.suffix == ".xz":
            place.write_bytes(lzma.decompress(file.read_bytes()))
        elif file.is_file():
            shutil.copy(file, place)
        found.append(place)
    return found
