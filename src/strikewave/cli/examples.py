"""``strikewave examples``: notebooks, sample records, studies and cases in a folder of one's own."""

from __future__ import annotations

import lzma
import shutil
import tempfile
from pathlib import Path
from typing import Annotated

import typer

from strikewave.base.errors import InputError
from strikewave.base.json_document import head
from strikewave.cases.case_files import bundled_cases, read_case_text
from strikewave.reporting.options.output import Shown
from strikewave.reporting.terminal import print_json, say

EXAMPLES = Path(__file__).parents[1] / "examples"
PACKED = ".xz"
"""Ending of what is packed where it is kept."""


def copy_examples(folder: Path) -> list[Path]:
    """Copy notebooks, sample records with their credit, studies, and the built-in cases; the folder appears whole.

    Parameters
    ----------
    folder : Path
        Not there yet, or empty.

    Returns
    -------
    list of Path
        The files, relative to the folder.

    Raises
    ------
    InputError
        If something stands in its place, or the folder above it is not there.

    Examples
    --------
    >>> with tempfile.TemporaryDirectory() as place:
    ...     files = copy_examples(Path(place) / "mine")
    >>> Path("notebooks/first-blow.ipynb") in files, Path("cases/li-ma-2019.toml") in files
    (True, True)
    """
    if folder.is_symlink() or (folder.exists() and (not folder.is_dir() or any(folder.iterdir()))):
        raise InputError("FOLDER", str(folder), "a folder that is not there yet, or empty", "choose another name")
    if not folder.absolute().parent.is_dir():
        raise InputError("FOLDER", str(folder), "a folder in one that exists")
    with tempfile.TemporaryDirectory(dir=folder.absolute().parent, prefix=f".{folder.name}.") as place:
        whole = Path(place) / "whole"
        _fill(whole)
        files = sorted(path.relative_to(whole) for path in whole.rglob("*") if path.is_file())
        if folder.exists():
            folder.rmdir()
        whole.rename(folder)
    return files


def _fill(whole: Path) -> None:
    for kept in sorted(path for path in EXAMPLES.rglob("*") if path.is_file()):
        place = whole / kept.relative_to(EXAMPLES)
        place.parent.mkdir(parents=True, exist_ok=True)
        if kept.suffix == PACKED:
            place.with_suffix("").write_bytes(lzma.decompress(kept.read_bytes()))
        else:
            shutil.copyfile(kept, place)
    (whole / "cases").mkdir()
    for name in bundled_cases():
        (whole / "cases" / f"{name}.toml").write_text(read_case_text(name)[0], "utf-8")


def command(
    folder: Annotated[Path, typer.Argument(help="The folder to make, which holds them.", show_default=False)],
    *,
    shown: Shown,
) -> int:
    """Copy notebooks, a record, studies and cases.

    Notebooks need `pip install "strikewave[notebooks]"`; records come with source and licence; cases are the built-in
    ones, to change; studies are files of `strikewave design`.
    """
    files = copy_examples(folder)
    if shown.json:
        print_json({**head({}), "written": [str(folder / path) for path in files]})
        return 0
    counts = ", ".join(
        f"{name} {sum(path.parts[0] == name for path in files)}" for name in ("notebooks", "cases", "studies")
    )
    say(f"written: {folder} ({counts}, a measured record); then: jupyter lab {folder / 'notebooks'}")
    return 0
