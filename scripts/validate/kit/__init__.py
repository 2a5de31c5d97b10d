"""What studies share: measured files unpacked, tables, and text written into pages."""

from __future__ import annotations

import lzma
import re
import shutil
from collections.abc import Sequence
from pathlib import Path

ROOT = Path(__file__).parents[3]
DATA = ROOT / "tests" / "data"
"""Measured files that the project carries, a folder a source."""
PAGE = ROOT / "docs" / "fit-measured.md"
"""The page of these studies."""
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


def table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Return a table as pages have it."""
    ruler = ["---", *["---:"] * (len(heads) - 1)]
    return "\n".join(f"| {' | '.join(cells)} |" for cells in (heads, ruler, *rows))


def write_into(page: Path, name: str, text: str) -> None:
    """Write text into a page between ``<!-- name -->`` and ``<!-- end -->``."""
    marked = rf"(<!-- {re.escape(name)} -->\n).*?(<!-- end -->)"
    written = re.sub(marked, lambda m: f"{m[1]}\n{text}\n\n{m[2]}", page.read_text("utf-8"), flags=re.DOTALL)
    page.write_text(written, "utf-8")
