"""The finished runs of a study in a folder, so that one that was stopped goes on where it was and repeats nothing.

``index.sqlite`` holds a row a run: its key (see `.evaluation`), its numbers (SI), or the document of its
answer, or why it failed; a folder may hold runs of several studies. Histories go into
``run-histories-N.parquet`` once there are enough for a file; till then they stand in the index. One process writes,
each batch of runs in one transaction: what was finished stays, whatever ends the program. A run that failed is a row
too; one for want of memory, or whose process was ended, is forgotten when the store is opened again, and made again.
"""

from __future__ import annotations

import contextlib
import errno
import importlib
import os
import shutil
import sqlite3
import tempfile
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strikewave.base.errors import InputError, refusal
from strikewave.base.result import RUN_FAILED, Verdicts
from strikewave.studies.engine.evaluation import KeptHistory, RunOutcome

Array = NDArray[np.float64]

INDEX, KEPT_INDEX = "index.sqlite", "runs.sqlite"
"""Names of the index in the folder of a store, and of its copy in the folder of a result."""
CHUNK, STATE = "run-histories-{}.parquet", "state-{}.h5"
"""Names of the other files in the folder."""
APPLICATION, FORMAT = 0x5354524B, 4
"""Number that tells the index from other files of SQLite ("STRK"), and version of the index."""
BEFORE_VERDICTS = 3
"""Version of the index whose runs have no verdict: it is read, and the verdicts of its runs are not known."""
CHUNK_BYTES = 32_000_000
"""Bytes of histories in a file. Chosen: some 2000 runs of eleven blows, which a process holds without noticing, and
100 000 of them make fifty files."""
LONGEST_NAME = 200
"""Characters of a folder's name that the store takes over: a file system takes 255 bytes, dot and ending included."""
KEY_DIGITS = 32
"""Digits of a key in the name of a file: 128 bits tell all runs apart."""
_HINT = "begin anew with --fresh, or choose another folder"


_VERDICTS = "SELECT key, verdict, failure FROM runs"


def runs_beside(folder: Path) -> Path:
    """Return where the finished runs of the study in a folder are kept till all is written.

    Examples
    --------
    >>> str(runs_beside(Path("out/map")))
    'out/.map.runs'
    """
    return folder.with_name(f".{folder.name[:LONGEST_NAME]}.runs")


def begin_from(result: Path, folder: Path) -> bool:
    """Begin a store with the finished runs that a result keeps, and tell whether there were any.

    Nothing is done where the store is there already: it has what a later study was stopped with.
    """
    index = result / KEPT_INDEX
    if folder.exists() or not index.is_file() or index.is_symlink():
        return False
    try:
        folder.mkdir()
        for path in result.glob(CHUNK.format("*")):
            if path.is_file() and not path.is_symlink():  # a link may lead to anything that may be read
                shutil.copyfile(path, folder / path.name)
        shutil.copyfile(index, folder / INDEX)
    except OSError:  # the runs are made anew, and what refuses the copy refuses the store
        shutil.rmtree(folder, ignore_errors=True)
        return False
    return True


class RunStore:
    """Finished runs; a context manager that holds the folder for this process alone.

    Parameters
    ----------
    folder : Path or None
        Made where it is not there; None for a temporary one.
    fresh : bool, optional
        True to remove the runs that are there.
    option : str, optional
        Option that names the folder, for errors.

    Raises
    ------
    InputError
        If the folder cannot be written, holds something else, is damaged, or another study writes there.
    """

    def __init__(self, folder: Path | None, fresh: bool = False, option: str = "--out") -> None:
        self._option = option
        self._temporary = tempfile.TemporaryDirectory(prefix="strikewave-") if folder is None else None
        self.folder = Path(self._temporary.name) if self._temporary is not None else Path(str(folder))
        self._waiting = 0  # bytes of histories in the index
        self._columns = set[str]()
        with self._in_words():
            if self.folder.is_symlink() or (self.folder.exists() and not self.folder.is_dir()):
                raise InputError(
                    self._option, self.folder, "a folder for the finished runs", "this is a file or a link"
                )
            self.folder.mkdir(parents=True, exist_ok=True)
            self._base = self._opened(fresh)

    def _opened(self, fresh: bool) -> sqlite3.Connection:
        index = self.folder / INDEX
        if not index.exists() and any(not path.match(CHUNK.format("*")) for path in self.folder.iterdir()):
            allowed = "an empty or new folder, or one with finished runs"
            raise InputError(self._option, self.folder, allowed, f"it holds other files, and no {INDEX}")
        if fresh:
            _remove_damaged(index)
        # no waiting: a folder that another study holds is refused at once
        base = sqlite3.connect(index, isolation_level=None, timeout=0.0)
        try:
            self._check_mark(base, fresh)
            # exclusive: WAL then needs no shared memory, which network file systems have not
            base.execute("PRAGMA locking_mode = EXCLUSIVE")
            base.execute("PRAGMA journal_mode = WAL")
            # a power cut may take the last batches, never the index; waiting for the disk at each would cost more
            base.execute("PRAGMA synchronous = NORMAL")
            base.execute("BEGIN EXCLUSIVE")
            if fresh:
                self._empty(base)
                for path in self.folder.glob(STATE.format("*")):
                    path.unlink()
            self._prepare(base)
            base.execute("COMMIT")
            self._check_chunks(base)
        except BaseException:
            base.close()
            raise
        return base

    def _check_mark(self, base: sqlite3.Connection, fresh: bool) -> None:
        """Refuse an index of something else, before anything of it is changed."""
        (mark,), (version,) = (base.execute(f"PRAGMA {what}").fetchone() for what in ("application_id", "user_version"))
        tables = base.execute("SELECT count(*) FROM sqlite_master").fetchone()[0]
        index, allowed = str(self.folder / INDEX), "an index of this version of strikewave"
        if tables and mark != APPLICATION:
            raise InputError(self._option, index, allowed, "choose another folder: this one is of another program")
        if tables and version not in (BEFORE_VERDICTS, FORMAT) and not fresh:
            raise InputError(self._option, index, allowed, _HINT)

    @staticmethod
    def _empty(base: sqlite3.Connection) -> None:
        for (table,) in base.execute("SELECT name FROM sqlite_master WHERE type = 'table'").fetchall():
            base.execute(f"DROP TABLE {_quoted(table)}")

    def _prepare(self, base: sqlite3.Connection) -> None:
        """Make the tables where there are none, and learn what is there."""
        base.execute(f"PRAGMA application_id = {APPLICATION}")
        base.execute(f"PRAGMA user_version = {FORMAT}")
        base.execute(
            "CREATE TABLE IF NOT EXISTS runs "
            "(key BLOB PRIMARY KEY, failure TEXT NOT NULL, retry INTEGER NOT NULL, seconds REAL NOT NULL, "
            "document TEXT NOT NULL, verdict TEXT NOT NULL DEFAULT '') WITHOUT ROWID"
        )
        if "verdict" not in {row[1] for row in base.execute("PRAGMA table_info(runs)")}:
            base.execute("ALTER TABLE runs ADD COLUMN verdict TEXT NOT NULL DEFAULT ''")
        # lost for want of memory, or with its process: another try may end otherwise
        base.execute("DELETE FROM runs WHERE retry")
        base.execute(
            "CREATE TABLE IF NOT EXISTS histories (key BLOB NOT NULL, name TEXT NOT NULL, unit TEXT NOT NULL, "
            'blow INTEGER NOT NULL, start REAL, step REAL, "values" BLOB NOT NULL)'
        )
        base.execute("CREATE TABLE IF NOT EXISTS chunks (number INTEGER PRIMARY KEY)")
        self._columns = {row[1] for row in base.execute("PRAGMA table_info(runs)")}
        (self._waiting,) = base.execute('SELECT coalesce(sum(length("values")), 0) FROM histories').fetchone()

    def _check_chunks(self, base: sqlite3.Connection) -> None:
        """Remove files of histories that the index does not know: their writing was not finished."""
        known = {CHUNK.format(number) for (number,) in base.execute("SELECT number FROM chunks")}
        lost = next((name for name in sorted(known) if not (self.folder / name).is_file()), None)
        if lost is not None:
            raise InputError(self._option, self.folder, f"finished runs with their histories; {lost} is gone", _HINT)
        for path in self.folder.glob(CHUNK.format("*")):
            if path.name not in known:
                path.unlink()
        for path in self.folder.glob(f".{CHUNK.format('*')}.partial"):
            path.unlink()

    def __enter__(self) -> RunStore:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Let the folder go; what is in it stays, unless it is a temporary one."""
        self._base.close()
        if self._temporary is not None:
            self._temporary.cleanup()

    def remove(self) -> None:
        """Remove index and files, the index first, so that it never names a file that is gone."""
        self.close()
        index = [self.folder / f"{INDEX}{end}" for end in ("", "-wal", "-shm")]
        for path in [*index, *self.chunks, *self.folder.glob(STATE.format("*"))]:
            path.unlink(missing_ok=True)
        with contextlib.suppress(OSError):
            self.folder.rmdir()

    @property
    def empty(self) -> bool:
        """True if it has nothing to go on with: no finished run, and no state of one."""
        return not self.known() and not any(self.folder.glob(STATE.format("*")))

    @property
    def fruitless(self) -> bool:
        """True if no run has come to anything."""
        with self._in_words():
            return self._base.execute("SELECT 1 FROM runs WHERE failure = '' LIMIT 1").fetchone() is None

    def known(self) -> set[bytes]:
        """Return the keys of all finished runs, failed ones among them."""
        with self._in_words():
            return {key for (key,) in self._base.execute("SELECT key FROM runs")}

    def keep(self, names: Sequence[str], finished: Iterable[tuple[bytes, RunOutcome]]) -> None:
        """Keep finished runs, all of them or none; one that is there already stays as it is."""
        with self._in_words():
            self._add_columns(names)
            places = "".join(f", {_quoted(name)}" for name in names)
            marks = ", ?" * len(names)
            self._base.execute("BEGIN")
            try:
                for key, outcome in finished:
                    numbers = outcome.numbers or (None,) * len(names)
                    done = self._base.execute(
                        f"INSERT OR IGNORE INTO runs (key, failure, retry, seconds, document, verdict{places}) "
                        f"VALUES (?, ?, ?, ?, ?, ?{marks})",
                        (
                            key,
                            outcome.failure,
                            outcome.retry,
                            outcome.seconds,
                            outcome.document,
                            outcome.judged,
                            *numbers,
                        ),
                    )
                    if done.rowcount:
                        self._keep_histories(key, outcome.histories)
            except BaseException:
                with contextlib.suppress(sqlite3.OperationalError):  # of a full disk SQLite has rolled back itself
                    self._base.execute("ROLLBACK")
                raise
            self._base.execute("COMMIT")
            if self._waiting >= CHUNK_BYTES:
                self.write_chunk()

    def _add_columns(self, names: Sequence[str]) -> None:
        for name in names:
            if name not in self._columns:
                self._base.execute(f"ALTER TABLE runs ADD COLUMN {_quoted(name)} REAL")
                self._columns.add(name)

    def _keep_histories(self, key: bytes, histories: Iterable[KeptHistory]) -> None:
        for history in histories:
            values = np.ascontiguousarray(history.values, "<f8").tobytes()
            row = (key, history.name, history.unit, history.blow, history.start, history.step, values)
            self._base.execute("INSERT INTO histories VALUES (?, ?, ?, ?, ?, ?, ?)", row)
            self._waiting += len(values)

    def write_chunk(self) -> None:
        """Move the histories that wait in the index into a file of their own."""
        with self._in_words():
            rows = self._base.execute("SELECT * FROM histories").fetchall()
            if not rows:
                return
            (number,) = self._base.execute("SELECT coalesce(max(number), 0) + 1 FROM chunks").fetchone()
            # the file first: one that the index does not know is removed when the store is opened again
            _write_parquet(rows, self.folder / CHUNK.format(number))
            self._base.execute("BEGIN")
            self._base.execute("INSERT INTO chunks VALUES (?)", (number,))
            self._base.execute("DELETE FROM histories")
            self._base.execute("COMMIT")
            self._waiting = 0

    def state(self, key: bytes) -> Path:
        """Return where a long run keeps the state that it goes on from: it is removed with the store."""
        return self.folder / STATE.format(key.hex()[:KEY_DIGITS])

    @property
    def chunks(self) -> list[Path]:
        """The files of histories, in their order."""
        paths = self.folder.glob(CHUNK.format("*"))
        return sorted(paths, key=lambda path: int(path.stem.rpartition("-")[2]))

    def hand_over(self, folder: Path, keys: Iterable[bytes]) -> list[str]:
        """Put the histories of some runs into another folder, and return the names of their files.

        They stay here too: till the result stands in its place, they are all that is left of their runs. A file that
        holds nothing else gets a second name there; where the file system has none, it is copied.
        """
        self.write_chunk()
        wanted, names = set(keys), list[str]()
        for path in self.chunks:
            with self._in_words(folder):
                if _hand_over(path, folder / CHUNK.format(len(names) + 1), wanted):
                    names.append(CHUNK.format(len(names) + 1))
        return names

    def copy_into(self, folder: Path, handed_over: Sequence[str]) -> list[str]:
        """Write a copy of the index into the folder of a result, so that the same question is answered from there.

        Of what has histories in files of its own, only where all of these were handed over with it. Return the name.
        """
        with self._in_words(folder):
            if [path.name for path in self.chunks] != list(handed_over):
                return []
            self._base.execute("VACUUM INTO ?", (str(folder / KEPT_INDEX),))
        return [KEPT_INDEX]

    def table(self, names: Sequence[str], keys: Sequence[bytes]) -> tuple[Array, list[str]]:
        """Return numbers (runs, names) and failures of runs that are there; NaN where there is no number."""
        with self._in_words():
            self._add_columns(names)
            wanted = {key: place for place, key in enumerate(dict.fromkeys(keys))}
            numbers, failures = np.full((len(wanted), len(names)), np.nan), [""] * len(wanted)
            columns = "".join(f", {_quoted(name)}" for name in names)
            for key, failure, *values in self._base.execute(f"SELECT key, failure{columns} FROM runs"):
                place = wanted.get(key)
                if place is not None:
                    numbers[place] = [np.nan if value is None else value for value in values]
                    failures[place] = failure
        at = [wanted[key] for key in keys]
        return numbers[at], [failures[place] for place in at]

    def verdicts(self, keys: Sequence[bytes], noun: str = "runs", not_judged: Sequence[str] = ()) -> Verdicts:
        """Return the verdicts of runs that are there, in the order of their keys; "" of those kept without one."""
        with self._in_words():
            rows = {key: (verdict, failure) for key, verdict, failure in self._base.execute(_VERDICTS)}
        texts = [RUN_FAILED if rows[key][1] else rows[key][0] for key in keys]
        reason = next((rows[key][1] for key in keys if rows[key][1]), "")
        return Verdicts(texts, noun, reason, not_judged)

    def documents(self, keys: Sequence[bytes]) -> list[tuple[str, str]]:
        """Return the documents of runs that are there, and their failures."""
        question = "SELECT document, failure FROM runs WHERE key = ?"
        with self._in_words():
            return [self._base.execute(question, (key,)).fetchone() for key in keys]

    def histories(self) -> Iterator[tuple[bytes, KeptHistory]]:
        """Yield all histories with the keys of their runs, one file after the other."""
        parquet = importlib.import_module("pyarrow.parquet")
        for path in self.chunks:
            for batch in parquet.ParquetFile(path).iter_batches(batch_size=256):
                values = batch.column("values")
                for place, row in enumerate(batch.drop_columns(["values"]).to_pylist()):
                    of_run = values[place].values.to_numpy(zero_copy_only=False)
                    yield row.pop("key"), _history(**row, values=np.asarray(of_run, dtype=float))
        for key, name, unit, blow, start, step, values in self._base.execute("SELECT * FROM histories"):
            yield key, _history(name, unit, blow, start, step, np.frombuffer(values, "<f8"))

    @contextlib.contextmanager
    def _in_words(self, folder: Path | None = None) -> Iterator[None]:
        """Say in words what SQLite and the file system refuse."""
        path = self.folder if folder is None else folder
        place = str(path)
        try:
            yield
        except sqlite3.OperationalError as error:
            if "locked" in str(error):
                raise InputError(
                    self._option, place, "a folder that no other study writes to", "wait till it has ended"
                ) from None
            full = OSError(errno.ENOSPC, os.strerror(errno.ENOSPC)) if "full" in str(error) else None
            why = str(error) if full is None else refusal(full, path)
            raise InputError(self._option, place, "a place that can be written", why) from None
        except sqlite3.DatabaseError as error:
            if type(error) is not sqlite3.DatabaseError:  # a fault of ours
                raise
            raise InputError(self._option, place, "finished runs; their index is damaged", _HINT) from None
        except OSError as error:
            raise InputError(self._option, place, "a place that can be written", refusal(error, path)) from None


def given_or_temporary(store: RunStore | None) -> contextlib.AbstractContextManager[RunStore]:
    """Return a store that someone else opened and closes, or one for as long as it is used."""
    return RunStore(None) if store is None else contextlib.nullcontext(store)


def _hand_over(path: Path, other: Path, keys: set[bytes]) -> bool:
    """Put the histories of some runs that a file holds into another one, and tell whether it holds any."""
    parquet, compute = (importlib.import_module(f"pyarrow.{name}") for name in ("parquet", "compute"))
    held = parquet.read_table(path, columns=["key"]).column("key")
    known = set(compute.unique(held).to_pylist())
    if not known & keys:
        return False
    if known <= keys:  # nothing to leave out: the same file under a second name costs no copy
        try:
            os.link(path, other)
        except OSError:
            shutil.copyfile(path, other)
        return True
    chosen = [row.as_py() in keys for row in held]
    _write_table(parquet.read_table(path).filter(chosen), other)
    return True


def _remove_damaged(index: Path) -> None:
    """Remove an index that SQLite cannot read, so that another can be begun."""
    if not index.is_file():
        return
    base = sqlite3.connect(index, timeout=0.0)
    try:
        sound = base.execute("PRAGMA quick_check(1)").fetchone() == ("ok",)
    except sqlite3.DatabaseError as error:
        sound = type(error) is not sqlite3.DatabaseError  # locked, or out of reach
    finally:
        base.close()
    if not sound:
        for path in (index, *(index.with_name(f"{index.name}{end}") for end in ("-wal", "-shm"))):
            path.unlink(missing_ok=True)


def _history(name: str, unit: str, blow: int, start: float | None, step: float | None, values: Array) -> KeptHistory:
    """Return a history from its row: SQLite has no NaN, and gives None."""
    begin, each = (np.nan if value is None else float(value) for value in (start, step))
    return KeptHistory(name, unit, blow, begin, each, values)


def _quoted(name: str) -> str:
    """Return the name of a column as SQL has it."""
    return '"' + name.replace('"', '""') + '"'


def _write_parquet(rows: Sequence[tuple[bytes, str, str, int, float, float, bytes]], path: Path) -> None:
    """Write histories as one table, a row a history."""
    pa = importlib.import_module("pyarrow")
    keys, names, units, blows, starts, steps, values = zip(*rows, strict=True)
    offsets = np.concatenate([[0], np.cumsum([len(packed) // 8 for packed in values])]).astype(np.int32)
    flat = pa.Array.from_buffers(pa.float64(), int(offsets[-1]), [None, pa.py_buffer(b"".join(values))])
    table = pa.table(
        {
            "key": pa.array(keys, pa.binary()),
            "name": pa.array(names).dictionary_encode(),
            "unit": pa.array(units).dictionary_encode(),
            "blow": pa.array(blows, pa.int32()),
            "start": pa.array(starts, pa.float64()),
            "step": pa.array(steps, pa.float64()),
            "values": pa.ListArray.from_arrays(pa.array(offsets), flat),
        }
    )
    _write_table(table, path)


def _write_table(table: Any, path: Path) -> None:
    """Write a table of histories, whole or not at all."""
    partial = path.with_name(f".{path.name}.partial")
    importlib.import_module("pyarrow.parquet").write_table(
        table,
        partial,
        compression="zstd",
        use_dictionary=["key", "name", "unit"],
        column_encoding={"values.list.element": "BYTE_STREAM_SPLIT"},
    )
    partial.replace(path)


def store_in(place: Path | str | None) -> RunStore:
    """Return the store of a folder that the argument ``store`` names, or one for as long as it is used."""
    return RunStore(None if place is None else Path(place), option="store")
