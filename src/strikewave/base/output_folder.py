"""Folders of results: one run at a time writes one, it appears whole, and nothing of somebody else's is replaced.

A result is written beside its place under another name, then renamed into it. Beside ``out/NAME`` lie, hidden and named
after it, while a run is under way: a lock, which the system lets go of when the run ends, however it ends; and the
folder that it writes into. Only the run with the lock touches them; the next one removes what a killed run left.
"""

from __future__ import annotations

import contextlib
import errno
import hashlib
import importlib
import os
import re
import secrets
import shutil
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from strikewave.base.errors import InputError, StrikewaveWarning, refusal, show

LONGEST_NAME, DIGITS = 60, 12  # well within the 255 bytes of file systems in any script; 48 bits keep names apart
"""Characters of a name that its hidden neighbours take over, and hexadecimal digits behind them, of the whole name."""
AT_FDCWD, RENAME_EXCHANGE = -100, 2
"""Numbers of Linux: paths count from the working folder; two names change places."""


class Claim:
    """A result folder that this run alone writes: as typed, from the root, and the hidden place of its files."""

    def __init__(self, folder: Path) -> None:
        self.typed, self.folder = folder, folder.absolute()
        self.place = hidden_beside(self.folder, hashlib.sha256(os.fsencode(self.folder.name)).hexdigest()[:DIGITS])
        self._old = self.place.with_name(f"{self.place.name}.old")
        self._begun: tuple[int, int] | None = None

    @property
    def lock(self) -> Path:
        """The file that is locked."""
        return self.place.with_name(f"{self.place.name}.lock")

    @property
    def written(self) -> bool:
        """True if the result of this run is in its place."""
        return self._begun is not None and _identity(self.folder) == self._begun

    def recover(self) -> None:
        """Remove what a killed run left, and put the older result back where it was stopped between two renames."""
        if self._old.is_dir() and not self.folder.exists():
            self._old.rename(self.folder)
            words = f"a run was stopped while it replaced {self.folder}; the older result is back"
            warnings.warn(words, StrikewaveWarning, stacklevel=2)
        for left in (self._old, self.place):
            shutil.rmtree(left, ignore_errors=True)

    def begin(self) -> None:
        """Make the hidden folder."""
        self.place.mkdir()
        self._begun = _identity(self.place)

    def swap(self) -> None:
        """Put the hidden folder in the place of the result; at each moment the place holds one or the other.

        Where the system cannot exchange two names there is a moment without either: `recover` puts the older back.
        """
        if not self.folder.exists():
            self.place.rename(self.folder)
        elif not _exchange(self.place, self.folder):
            self.folder.rename(self._old)
            try:
                self.place.rename(self.folder)
            except BaseException:
                if not self.folder.exists():
                    self._old.rename(self.folder)
                raise
            shutil.rmtree(self._old, ignore_errors=True)


@contextlib.contextmanager
def claimed(folder: Path) -> Iterator[Claim]:
    """Claim a result folder for this run, unless another run has it or nothing can be written there.

    Folders above it are made, and go again where nothing came into them.
    """
    claim = Claim(folder)
    made = [parent for parent in claim.folder.parents if not parent.exists()]
    try:
        try:
            claim.folder.parent.mkdir(parents=True, exist_ok=True)
            lock = _lock(claim)
        except OSError as error:
            allowed, reason = "a place that can be written", refusal(error, claim.folder)
            raise InputError("--out", folder, allowed, reason) from None
        try:
            claim.recover()
            yield claim
        finally:
            if lock is not None:
                claim.lock.unlink(missing_ok=True)
                os.close(lock)
    finally:
        for parent in made:
            with contextlib.suppress(OSError):
                parent.rmdir()


def _lock(claim: Claim) -> int | None:
    """Lock the file of a claim and return it, open; None where the system has no locks."""
    try:
        fcntl: Any = importlib.import_module("fcntl")
    except ImportError:
        return None
    while True:
        file = os.open(claim.lock, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o666)
        try:
            # of the process, not of the open file: workers that were forked do not hold it when the run is dead
            fcntl.lockf(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            owner = os.read(file, DIGITS).decode("ascii", "replace").strip()
            os.close(file)
            if error.errno not in (errno.EACCES, errno.EAGAIN):
                return None
            hint = f"process {owner or 'unknown'} is at work on it; wait for its end, or choose another folder"
            raise InputError("--out", claim.folder, "a folder that no other run writes", hint) from None
        if _identity(claim.lock) == _identity(file):
            break
        os.close(file)  # its owner removed it meanwhile
    with contextlib.suppress(OSError):  # the number is a word to the user: a full disk may lack it
        os.truncate(file, 0)
        os.write(file, str(os.getpid()).encode())
    return file


def _identity(path: Path | int) -> tuple[int, int] | None:
    try:
        entry = os.stat(path)
    except FileNotFoundError:
        return None
    return entry.st_dev, entry.st_ino


def _exchange(first: Path, second: Path) -> bool:
    """Let two folders change places in one step; return whether the system did."""
    import ctypes

    try:
        rename = ctypes.CDLL(None).renameat2
    except (AttributeError, OSError, TypeError):
        return False
    return bool(rename(AT_FDCWD, os.fsencode(first), AT_FDCWD, os.fsencode(second), RENAME_EXCHANGE) == 0)


def hidden_beside(path: Path, ending: str) -> Path:
    """Return a hidden name beside a path.

    Examples
    --------
    >>> hidden_beside(Path("out/map"), "12ab").as_posix()
    'out/.map-12ab'
    """
    return path.with_name(f".{path.name[:LONGEST_NAME]}-{ending}")


MARKS = ("case.toml", "record.toml")
"""One of these files marks a folder as a result; its text distinguishes one result from another."""
ANIMATIONS = ("machine.html", "machine.gif", "animation.html", "animation.gif")
"""Files that take long to make and depend on the inputs alone: a rerun that does not make them keeps them."""
_RANDOM_BYTES = 6  # 48 bits: no two runs ever share them
"""Random bytes behind the name of a file that is being written."""
_LIST = "\n# The files of this result with their SHA-256. What was added or changed since is never replaced.\n"
"""Begins the list of the files at the end of the text that marks a folder."""
_ROW = re.compile(r"# ([0-9a-f]{64}|none)  (.+)")
"""A line of that list: the SHA-256 of a file, or that it is none, and its name."""


def mark_of(folder: Path) -> Path | None:
    """Return the file that marks a folder as a result; None where there is none."""
    return next((folder / name for name in MARKS if (folder / name).is_file()), None)


def mark_text(mark: Path) -> str:
    """Return the text that marks a result, without the list of its files.

    What was written behind the list belongs to the text: who adds a table to a case adds it at the end of the file.
    """
    return _parted(mark)[0]


def _parted(mark: Path) -> tuple[str, dict[str, str] | None]:
    """Return the text that marks a result, and the SHA-256 of each file of its list; None where it has no list."""
    text, begin, rest = mark.read_text("utf-8", errors="replace").partition(_LIST)
    rows = [(line, _ROW.fullmatch(line)) for line in rest.splitlines() if line.strip()]
    added = "".join(f"{line}\n" for line, row in rows if row is None)
    return text + added, {row[2]: row[1] for _, row in rows if row is not None} if begin else None


def list_files(folder: Path) -> None:
    """Write the files of a folder with their SHA-256 into the file that marks it, as comments; nothing without a mark.

    By the list a result is told from files that only have such names: a measurement may be called ``histories.csv``.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as place:
    ...     mark, table = Path(place) / "case.toml", Path(place) / "blows.csv"
    ...     _ = mark.write_text("schema = 1"), table.write_text("1")
    ...     list_files(Path(place))
    ...     _ = table.write_text("2")
    ...     changed_files(Path(place)), mark_text(mark)
    (['blows.csv'], 'schema = 1')
    """
    mark = mark_of(folder)
    if mark is None:
        return
    text = mark_text(mark)
    lines = [f"# {_digest(path)}  {path.relative_to(folder).as_posix()}\n" for path in _entries(folder) if path != mark]
    lines.append(f"# {_digest_of(text)}  {mark.name}\n")
    with mark.open("w", encoding="utf-8", newline="\n") as file:
        file.write(text + _LIST + "".join(lines))


def changed_files(folder: Path) -> list[str] | None:
    """Return the files of a result folder that were added or changed since it was written, but for the mark.

    None stands for a folder without a list: an older strikewave wrote it, or somebody else.
    """
    mark = mark_of(folder)
    listed = None if mark is None else _parted(mark)[1]
    if listed is None:
        return None
    others = {path.relative_to(folder).as_posix(): path for path in _entries(folder) if path != mark}
    return [name for name, path in others.items() if name not in listed or _digest(path) != listed[name]]


def _entries(folder: Path) -> list[Path]:
    """Return all files below a folder, links, and folders that hold nothing; sorted."""
    entries = (path for path in folder.rglob("*") if path.is_symlink() or not path.is_dir() or not any(path.iterdir()))
    return sorted(entries)


def _digest(path: Path) -> str:
    """Return the SHA-256 of a file; a word for what is none."""
    if path.is_symlink() or not path.is_file():
        return "none"
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _digest_of(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()


def check_place(folder: Path, identity: str, force: bool = False) -> None:
    """Refuse a result folder that holds something else, is a file, or cannot be written.

    A folder that is absent, empty, or holds the very same result (its ``case.toml`` or ``record.toml`` equals
    ``identity``, or begins with it where it is one line) may be written; any other result only by ``force``; one that
    holds other files, or files that were changed since, never, nor one without a list of its files.
    """
    try:
        if folder.is_symlink() or (folder.exists() and not folder.is_dir()):
            raise InputError("--out", folder, "a folder", "this is a file or a link; choose another name")
        parent = next((p for p in folder.absolute().parents if p.exists()), None)
        if parent is None:
            raise InputError("--out", folder, "a folder below the root")
        if not parent.is_dir() or not os.access(parent, os.W_OK):
            raise InputError("--out", folder, "a place that can be written", f"{parent} cannot")
        if not folder.exists() or not any(folder.iterdir()):
            return
        mark, changed = mark_of(folder), changed_files(folder)
        if mark is None or changed is None or changed:
            raise InputError("--out", folder, "an empty or new folder", _obstacle(folder, mark, changed))
        text = mark_text(mark)
        # the text of a search begins with what was asked, one line, and what was found follows
        is_search = identity.endswith("\n") and identity.count("\n") == 1
        if not force and not (text.startswith(identity) if is_search else text == identity):
            raise InputError("--out", folder, "a new folder", "it holds another result; add --force to replace it")
    except OSError as error:
        raise InputError("--out", folder, "a folder that can be written", error.strerror or str(error)) from None


def _obstacle(folder: Path, mark: Path | None, changed: list[str] | None) -> str:
    """Return the reason why a folder is not replaced, with the way out."""
    if mark is None:
        names = ", ".join(sorted(entry.name for entry in folder.iterdir()))
        return f"it holds files that are not of a result ({show(names)}); move them, or choose another folder"
    if changed is None:
        why = f"{mark.name} there has no list of the files of a result: an older strikewave wrote it, or it is yours"
        return f"{why}; move the folder, or choose another one"
    names = show(", ".join(changed))
    return f"it holds files that were added or changed since its run ({names}); move them, or choose another folder"


def check_unchanged(folder: Path, identity: str) -> None:
    """Refuse to replace a result whose ``case.toml`` was changed after the run: it may be someone's only copy."""
    with contextlib.suppress(OSError):
        mark = mark_of(folder)
        if mark is None:
            return
        text, listed = _parted(mark)
        if listed is None or text == identity:
            return
        if _digest_of(text) != listed.get(mark.name):
            hint = f"{mark} was changed after the run: move it to run it, or choose another folder"
            raise InputError("--out", folder, "a result as its run wrote it", hint)


@contextlib.contextmanager
def atomic_folder(claim: Claim, identity: str, force: bool = False) -> Iterator[Path]:
    """Give a temporary folder to write into; it takes the place of the claimed one once all is written.

    On any error, Ctrl-C or a full disk included, the temporary folder goes and the old result stays.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as home:
    ...     with claimed(Path(home) / "out") as claim, atomic_folder(claim, identity="") as place:
    ...         _ = (place / "case.toml").write_text("")
    ...     [p.name for p in (Path(home) / "out").iterdir()], len(list(Path(home).iterdir()))
    (['case.toml'], 1)
    """
    check_place(claim.folder, identity, force)
    try:
        claim.begin()
        yield claim.place
        list_files(claim.place)
        check_place(claim.folder, identity, force)
        claim.swap()
    except OSError as error:
        allowed, reason = "a place that can be written", refusal(error, claim.folder)
        raise InputError("--out", claim.folder, allowed, reason) from error
    finally:
        shutil.rmtree(claim.place, ignore_errors=True)


def keep_true_files(old: Path, new: Path, identity: str) -> tuple[list[str], list[str]]:
    """Copy the animations of an older run that are still true into the new folder; return the kept and removed names.

    They are true where the older folder is of the same inputs, and every table and picture that both hold is equal to
    the byte: tables tell other numbers, pictures other units.
    All else that the new run did not write goes with the older folder.
    """
    if not old.is_dir():
        return [], []
    rest = sorted(entry.name for entry in old.iterdir() if not (new / entry.name).exists())
    shared = [path for kind in ("*.csv", "*.svg") for path in new.glob(kind) if (old / path.name).is_file()]
    same = any((old / mark).is_file() and mark_text(old / mark) == identity for mark in MARKS)
    same = same and bool(shared) and all(path.read_bytes() == (old / path.name).read_bytes() for path in shared)
    kept = [name for name in rest if same and name in ANIMATIONS]
    for name in kept:
        shutil.copy2(old / name, new / name)
    return kept, [name for name in rest if name not in kept]


def write_atomically(path: Path, text: str) -> None:
    r"""Write a text file that appears whole or not at all; its lines end with ``\n`` on every system."""
    partial = hidden_beside(path, secrets.token_hex(_RANDOM_BYTES))
    try:
        with partial.open("x", encoding="utf-8", newline="\n") as file:
            file.write(text)
        partial.replace(path)
    except OSError as error:
        raise InputError("FILE", path, "a place that can be written", refusal(error, path)) from None
    finally:
        partial.unlink(missing_ok=True)
