"""A run that is under way: where it keeps its state and its fields, so that it may go on after it is stopped."""

from __future__ import annotations

import contextlib
import os
import re
import shutil
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

from strikewave.analyses.fem.result import of_blow
from strikewave.base.command_line import command_line
from strikewave.base.errors import InputError
from strikewave.base.folder_claim import refusal
from strikewave.base.interrupts import exit_code
from strikewave.base.result import Notice
from strikewave.base.shock_quantities import MICROSECONDS
from strikewave.fem.mesh import Mesh
from strikewave.fem.run import FieldFrame
from strikewave.fem.vtkhdf import FieldWriter
from strikewave.reporting.faces import amount
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
    except BaseException as stop:
        reason = refusal(stop, home) if isinstance(stop, OSError) else ""
        if not (home / STATE).is_file():
            _clear(home)
        else:
            say(f"stopped; kept: {home}/; to go on from there: {_command('--restart')}")
            if isinstance(stop, KeyboardInterrupt):
                raise SystemExit(exit_code(stop)) from None
        if reason:
            raise InputError("--out", str(home), "a place that can be written", reason) from stop
        raise
    _clear(home)


def _command(option: str) -> str:
    """Return the command that runs now, with --restart or --force."""
    words = [word for word in sys.argv[1:] if word not in ("--restart", "--force")]
    words = ["fem" if k == 0 and word == "run" else word for k, word in enumerate(words)]  # run has no --restart
    end = words.index("--") if "--" in words else len(words)  # behind it all words are names
    return command_line([*words[:end], option, *words[end:]])


def _clear(home: Path) -> None:
    """Remove what a run that was under way left; a folder with other files stays, and is refused."""
    if not home.exists():
        return
    foreign = [entry.name for entry in home.iterdir() if not OWN.match(entry.name)]
    if home.is_symlink() or foreign:
        raise InputError("--out", str(home), "a name that is free", "it holds other files; move them")
    shutil.rmtree(home)


class FieldFile:
    """The fields of a blow: begun with the first frame, or taken up with it where a run goes on.

    ``instants`` are the times of the frames of the whole blow, s.
    """

    def __init__(self, path: Path, mesh: Mesh, instants: Sequence[float]) -> None:
        self.path, self.mesh, self.instants = path, mesh, instants
        self.writer: FieldWriter | None = None
        self.notices: list[Notice] = []

    def add(self, frame: FieldFrame) -> None:
        """Write a frame; what an interrupted run wrote beyond the state that it goes on from is dropped."""
        if self.writer is None:
            earlier = sum(time < frame.time for time in self.instants)
            again = self._taken_up(frame.time, earlier) if earlier else None
            self.writer = again or FieldWriter(self.path, self.mesh)
        self.writer.add(frame)

    def _taken_up(self, time: float, earlier: int) -> FieldWriter | None:
        """Return the writer of the frames before, None where none can be used; what is lost is noted."""
        try:
            writer, reason = FieldWriter.restored(self.path, self.mesh, time), "the others are not there"
        except InputError as error:
            writer, reason = None, error.hint
        count = 0 if writer is None else writer.frames
        if count < earlier:
            message = (
                f"{self.path.name} holds {count} of the {earlier} frames before {amount(MICROSECONDS, time)}, where "
                f"the run went on ({reason}); all else is whole; run anew, with --force, for all frames"
            )
            self.notices.append(Notice("frames-lost", message, float(count), float(earlier)))
        return writer

    def hand_over(self, place: Path) -> list[str]:
        """Close the file, put it into a folder and return its name; nothing where no frame came.

        It stays here as well, under a second name, until the whole result is in its place: a run that is stopped
        before goes on with it.
        """
        if self.writer is None:
            return []
        self.writer.close()
        try:
            os.link(self.path, place / self.path.name)
        except OSError:  # a file system without second names
            shutil.copyfile(self.path, place / self.path.name)
        return [self.path.name]

    def abandon(self) -> None:
        """Leave the file as it is, to be taken up again."""
        if self.writer is not None:
            self.writer.abandon()


class FieldFiles:
    """field.vtkhdf of the first blow, field-2.vtkhdf of the second, and so on."""

    def __init__(self, home: Path, mesh: Mesh, instants: Sequence[float]) -> None:
        self.home, self.mesh, self.instants = home, mesh, instants
        self.files: list[FieldFile] = []

    def of_blow(self, blow: int) -> FieldFile:
        """Return the file of a blow, which is not there before."""
        path = self.home / of_blow("field.vtkhdf", blow)
        self.files.append(FieldFile(path, self.mesh, self.instants))
        return self.files[-1]

    @property
    def notices(self) -> tuple[Notice, ...]:
        """What was lost of the frames before a run went on."""
        return tuple(notice for file in self.files for notice in file.notices)

    def hand_over(self, place: Path) -> list[str]:
        """Close all files, put them into a folder and return their names."""
        return [name for file in self.files for name in file.hand_over(place)]

    def __enter__(self) -> FieldFiles:
        return self

    def __exit__(self, *error: object) -> None:
        for file in self.files:
            file.abandon()
