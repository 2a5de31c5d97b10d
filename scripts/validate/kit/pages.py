"""Tables and text that studies write into pages, and read back from them."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

ROOT = Path(__file__).parents[3]


def table(heads: Sequence[str], rows: Sequence[Sequence[str]], words: int = 1) -> str:
    """Return a table as pages have it: so many columns of words, then numbers."""
    ruler = [*["---"] * words, *["---:"] * (len(heads) - words)]
    return "\n".join(f"| {' | '.join(cells)} |" for cells in (heads, ruler, *rows))


def written(page: str, name: str, text: str) -> str:
    """Return a page with text between ``<!-- name -->`` and ``<!-- end -->``."""
    marked = _marked(name)
    if not marked.search(page):
        raise ValueError(f"the page has no <!-- {name} --> before an <!-- end -->")
    return marked.sub(lambda m: f"{m[1]}\n{text}\n\n{m[3]}", page)


def write_into(page: Path, name: str, text: str) -> None:
    """Write text into a file between ``<!-- name -->`` and ``<!-- end -->``."""
    page.write_text(written(page.read_text("utf-8"), name, text), "utf-8")


def cells_of(page: Path, name: str) -> list[list[str]]:
    """Return the rows of a table that a study wrote into a page, without its heads."""
    found = _marked(name).search(page.read_text("utf-8"))
    if found is None:
        raise ValueError(f"{page.name} has no table {name}")
    lines = [line for line in found[2].splitlines() if line.startswith("|")]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines[2:]]


def renewed(page: Path, name: str, rows: Sequence[list[str]]) -> list[list[str]]:
    """Return the rows of a table as a page has them, those made anew in the place of the ones with their first cell."""
    anew = {row[0]: row for row in rows}
    return [*(anew.pop(row[0], row) for row in cells_of(page, name)), *anew.values()]


def _marked(name: str) -> re.Pattern[str]:
    return re.compile(rf"(<!-- {re.escape(name)} -->\n)(.*?)(<!-- end -->)", re.DOTALL)
