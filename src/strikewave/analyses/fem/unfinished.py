"""A run that is under way: where it keeps its state and its fields, so that it may go on after it is stopped."""

from __future__ import annotations

import contextlib
import re
import shlex
import shutil
import sys
from collections.abc import Iterator
from pathlib import Path

from strikewave.analyses.fem.result import of_blow
from strikewave.base.errors import InputError
from strikewave.base.interrupts import exit_code
from strikewave.fem.mesh import Mesh
from strikewave.fem.run import FieldFrame
from strikewave.fem.vtkhdf import FieldWriter
from strikewave.reporting.terminal import say

OWN = re.compile(r"(case|state|field)(-\d+)?(\.|$)")
"""Names of what a run under way writes."""
STATE = "state.h5"
"""Where a run keeps its state to go on from."""


@contextlib.contextmanager
def unfinished(folder: Path, text: str, restart: bool, anew: bool) -> Iterator[Path]:
    """Give a folder for a run that is under way, ``FOLDER.unfinished``; it stays where there is a state to go on from.

    Raises
    ------
    InputError
        If there is nothing to go on from, it belongs to another case, or unfinished work would be lost unasked.
    """
    home = folder.with_name(f"{folder.name}.unfinished")
    case = home / "case.toml"
    begun = (home / STATE).is_file() and case.is_file()
    same = begun and case.read_text("utf-8", errors="replace") == text
    if restart and not begun:
        raise InputError("--restart", str(home), "a run that was interrupted", "leave it out to begin anew")
    if restart and not same:
        hint = f"it holds a run with other values, {case}; to begin anew: {_command('--force')}"
        raise InputError("--restart", str(home), "the same case, its frames and other changes included", hint)
    if begun and not restart and not anew:
        hint = (f"to go on: {_command('--restart')}; " if same else "") + f"to begin anew: {_command('--force')}"
        raise InputError("--out", str(home), "no unfinished run" + ("" if same else " of another case"), hint)
    try:
        if not restart:
            _clear(home)
            home.mkdir(parents=True)
            case.write_text(text, "utf-8")
        yield home
    except OSError as error:
        raise InputError("--out", str(home), "a place that can be written", error.strerror or str(error)) from error
    except BaseException as stop:
        if not (home / STATE).is_file():
            _clear(home)
            raise
        say(f"stopped; kept: {home}/; to go on from there: {_command('--restart')}")
        if isinstance(stop, KeyboardInterrupt):
            raise SystemExit(exit_code(stop)) from None
        raise
    _clear(home)


def _command(option: str) -> str:
    """Return the command that runs now, with --restart or --force."""
    words = [word for word in sys.argv[1:] if word not in ("--restart", "--force")]
    words = ["fem" if k == 0 and word == "run" else word for k, word in enumerate(words)]  # run has no --restart
    return shlex.join(["strikewave", *words, option])


def _clear(home: Path) -> None:
    """Remove what a run that was under way left; a folder with other files stays, and is refused."""
    if not home.exists():
        return
    foreign = [entry.name for entry in home.iterdir() if not OWN.match(entry.name)]
    if home.is_symlink() or foreign:
        raise InputError("--out", str(home), "a name that is free", "it holds other files; move them")
    shutil.rmtree(home)


class FieldFile:
    """The fields of a blow: begun with the first frame, or taken up with it where a run goes on."""

    def __init__(self, path: Path, mesh: Mesh, resumed: bool) -> None:
        self.path, self.mesh, self.resumed = path, mesh, resumed
        self.writer: FieldWriter | None = None

    def add(self, frame: FieldFrame) -> None:
        """Write a frame; what an interrupted run wrote beyond the state that it goes on from is dropped."""
        if self.writer is None:
            begun = self.resumed and self.path.with_name(self.path.name + ".part").is_file()
            again = FieldWriter.restored(self.path, self.mesh, frame.time) if begun else None
            self.writer = again or FieldWriter(self.path, self.mesh)
        self.writer.add(frame)

    def hand_over(self, place: Path) -> list[str]:
        """Close the file, move it into a folder and return its name; nothing where no frame came."""
        if self.writer is None:
            return []
        self.writer.close()
        shutil.move(self.path, place)
        return [self.path.name]

    def abandon(self) -> None:
        """Leave the file as it is, to be taken up again."""
        if self.writer is not None:
            self.writer.abandon()


class FieldFiles:
    """field.vtkhdf of the first blow, field-2.vtkhdf of the second, and so on."""

    def __init__(self, home: Path, mesh: Mesh, resumed: bool) -> None:
        self.home, self.mesh, self.resumed = home, mesh, resumed
        self.files: list[FieldFile] = []

    def of_blow(self, blow: int) -> FieldFile:
        """Return the file of a blow, which is not there before."""
        path = self.home / of_blow("field.vtkhdf", blow)
        self.files.append(FieldFile(path, self.mesh, self.resumed))
        return self.files[-1]

    def hand_over(self, place: Path) -> list[str]:
        """Close all files, move them into a folder and return their names."""
        return [name for file in self.files for name in file.hand_over(place)]

    def __enter__(self) -> FieldFiles:
        return self

    def __exit__(self, *error: object) -> None:
        for file in self.files:
            file.abandon()
