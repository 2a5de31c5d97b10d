"""Users of the app: a session for each browser, with a folder of its own, and an end."""

from __future__ import annotations

import hashlib
import re
import secrets
import shutil
import tempfile
import time
import unicodedata
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

from strikewave.base.errors import StrikewaveError

MOST_SESSIONS = 64
"""Sessions at a time; a new one ends the one that is unseen for longest, never one with an open page."""
IDLE = 4 * 3600.0
"""Time after which a session without an open page ends, s: longer than a lunch, shorter than a night."""
MOST_KEPT = 2 << 30
"""Most bytes of all files of one session."""
LONGEST_NAME = 80
LONGEST_BYTES = 180
"""Bytes of a name, whose letters may take four each: a disk takes 255, with the additions of a page."""
SECRET = "session-secret"
KEPT = "pages"
"""Folder, in each session, of the files of its open pages."""


class FullError(StrikewaveError):
    """There is no room; the message says of what, for a page."""


def clean_name(name: str) -> str:
    r"""Return the name of a sent file as one that leads nowhere and hides nothing.

    Examples
    --------
    >>> clean_name("../../etc/passwd"), clean_name("C:\\a\\shot 1.csv"), clean_name("<img src=x>.csv")
    ('passwd', 'shot 1.csv', '_img src=x_.csv')
    >>> clean_name("..."), clean_name("a\u202eb.csv\n"), clean_name(".hidden")
    ('file', 'a_b.csv_', 'hidden')
    """
    last = re.split(r"[/\\]", unicodedata.normalize("NFC", name))[-1]
    plain = "".join(letter if letter.isprintable() and letter not in "<>:\"|?*&'`$" else "_" for letter in last)
    plain = plain.strip(" .")
    stem, dot, kind = plain.rpartition(".")
    if len(plain) > LONGEST_NAME or len(plain.encode()) > LONGEST_BYTES:
        stem, end = (stem, dot + kind) if len(kind) < 10 else (plain, "")
        most = LONGEST_BYTES - len(end.encode())
        plain = stem[: LONGEST_NAME - len(end)].encode()[:most].decode(errors="ignore").rstrip(" .") + end
    return plain or "file"


def is_there(path: Path) -> bool:
    """Tell whether a file exists under a name, or under a like one on disks that do not tell capitals apart."""
    return path.exists()


class TakenFile(NamedTuple):
    """A dropped file: its stored path, and a remark for the user where its name or content changed."""

    path: Path
    remark: str


class Session:
    """The state of one browser: a folder for its files, made with the first of them, and its open pages and jobs."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.seen = time.monotonic()
        self.pages = 0
        self.jobs: set[Any] = set()

    def touch(self) -> None:
        """Note that the browser is there."""
        self.seen = time.monotonic()

    def place(self, *names: str) -> Path:
        """Return a folder below its own, made where it is missing; names are cleaned."""
        place = self.folder.joinpath(*map(clean_name, names))
        place.mkdir(parents=True, exist_ok=True, mode=0o700)
        return place

    def keep(self, name: str, content: bytes, *below: str) -> Path:
        """Store a sent file under its cleaned name; raise `FullError` if the session would hold too much."""
        path = self.place(*below) / clean_name(name)
        if path.is_dir():
            raise FullError(f"{path.name}: a folder of this page is called so; give the file another name")
        before = path.stat().st_size if path.is_file() else 0
        if self.size() - before + len(content) > MOST_KEPT:
            raise FullError(f"{path.name}: a session keeps {MOST_KEPT >> 30} GB at most; remove other files first")
        path.write_bytes(content)
        return path

    def take(self, dropped: Sequence[tuple[str, bytes]], *below: str) -> list[TakenFile]:
        """Store files that were dropped together, none in the place of another: names may differ in case alone.

        A file that was dropped before replaces its older self. Raises `FullError` as `keep`.
        """
        taken: dict[Path, str] = {}
        for name, content in dropped:
            place = self.place(*below)
            path, remark = place / clean_name(name), ""
            listed = {other.name for other in place.iterdir()}
            is_known = path.name in listed and not path.is_dir()
            # the sizes first: files may have hundreds of megabytes
            is_same = is_known and path.stat().st_size == len(content) and path.read_bytes() == content
            if not is_same and (path in taken or (path.name not in listed and is_there(path))):
                count = 2
                while is_there(path.with_name(f"{path.stem}-{count}{path.suffix}")):
                    count += 1
                path = path.with_name(f"{path.stem}-{count}{path.suffix}")
                remark = f"{clean_name(name)} is kept as {path.name}: another file has that name"
            elif is_known and not is_same:
                remark = f"{path.name}: the file that was dropped now is in the place of the one before"
            taken[self.keep(path.name, content, *below)] = remark
        return [TakenFile(path, remark) for path, remark in taken.items()]

    def size(self) -> int:
        """Return the bytes of its files."""
        return sum(path.stat().st_size for path in self.folder.rglob("*") if path.is_file())

    def end(self) -> None:
        """Stop its work, and remove the files of its pages."""
        for job in list(self.jobs):
            job.cancel()
        shutil.rmtree(self.folder / KEPT, ignore_errors=True)


class Sessions:
    """All sessions, in a folder that stays, or in a temporary one that goes with the app."""

    def __init__(self, folder: Path | None = None) -> None:
        self._kept = folder is not None
        self._home = Path(tempfile.mkdtemp(prefix="strikewave-")) if folder is None else folder
        self._home.mkdir(parents=True, exist_ok=True)
        self._open: dict[str, Session] = {}
        self.secret = self._secret()

    def _secret(self) -> str:
        """Return the key that signs the cookies: stored beside kept results, so that a restart knows the browsers."""
        place = self._home / SECRET
        if self._kept and place.is_file():
            return place.read_text("ascii").strip()
        secret = secrets.token_urlsafe(32)
        if self._kept:
            place.touch(mode=0o600)
            place.write_text(secret, "ascii")
        return secret

    def of(self, browser: str) -> Session:
        """Return the session of a browser, by its cookie; raise `FullError` if there are too many with open pages."""
        name = "session-" + hashlib.sha256(browser.encode()).hexdigest()[:16]
        if name not in self._open:
            self.end_idle()
            if len(self._open) >= MOST_SESSIONS:
                self._end_oldest()
            self._open[name] = Session(self._home / name)
        session = self._open[name]
        session.touch()
        return session

    def __len__(self) -> int:
        return len(self._open)

    def _end_oldest(self) -> None:
        unseen = [name for name, session in self._open.items() if not session.pages]
        if not unseen:
            raise FullError(f"{MOST_SESSIONS} browsers use this app now, which is all it takes: try again later")
        self._end(min(unseen, key=lambda name: self._open[name].seen))

    def end_idle(self) -> None:
        """End sessions without an open page for long."""
        now = time.monotonic()
        for name in [n for n, session in self._open.items() if not session.pages and now - session.seen > IDLE]:
            self._end(name)

    def _end(self, name: str) -> None:
        session = self._open.pop(name)
        session.end()
        if not self._kept:
            shutil.rmtree(session.folder, ignore_errors=True)

    def end(self) -> None:
        """End all."""
        for name in list(self._open):
            self._end(name)
        if not self._kept:
            shutil.rmtree(self._home, ignore_errors=True)
