"""The rows of a job that are not finished yet, run batch by batch on a pool, and kept as they come back.

Few batches are out at a time, so that neither side holds more than it works on. A batch that was with a process that
ended is run again alone, in halves if that ends too: the run that a process dies of is found, and becomes a row.
"""

from __future__ import annotations

import contextlib
import os
import time
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from dataclasses import dataclass
from typing import Generic, NamedTuple, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from strikewave.base.compiled import is_cold
from strikewave.base.errors import InputError
from strikewave.base.result import Verdicts
from strikewave.studies.engine.evaluation import RunOutcome, failed
from strikewave.studies.engine.pools import (
    MOST_DEATHS,
    QUEUED,
    GivenPool,
    Loss,
    Pool,
    ProcessPool,
    ThreadPool,
    begin,
    error_of,
)
from strikewave.studies.engine.store import RunStore, given_or_temporary
from strikewave.uncertainty.runs import MOST_THREADS

BATCH_SECONDS, OF_A_HUNDRED = 0.25, 1.6
"""About how long a batch takes: handing it over, some 2 ms, then costs a hundredth, and a study that is killed has lost
no more than that of each process. With more than sixteen workers 1.6 s for every hundred of them: a scheduler of Dask
works 8 ms on a batch (measured), half of its time then."""
AFTER_STOP = 2.0
"""Seconds after Ctrl-C in which batches under way may end: eight times what one is to take. Runs that take longer are
not finished, and are made again."""
LOOK_SECONDS = 10.0
"""Seconds without a batch that came back after which the pool looks whether all that is out is still under way."""
MOST_PROCESSES = 256
"""Most processes. Chosen: the cores of a large machine; a typing error shall not start thousands."""
MOST_IN_BATCH = 256
"""Most runs of a batch: what it keeps stays small."""

Array = NDArray[np.float64]
Asked = TypeVar("Asked")
Asked_contra = TypeVar("Asked_contra", contravariant=True)


class Work(Protocol[Asked_contra]):
    """The work of a process on its rows, or on whatever else tells its runs apart: picklable."""

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the numbers of its runs."""
        ...

    def key(self, asked: Asked_contra, /) -> bytes:
        """Return the key of a run."""
        ...

    def __call__(self, asked: Sequence[Asked_contra], /) -> list[RunOutcome]:
        """Return what some runs come to."""
        ...


class StudyProgress(NamedTuple):
    """Progress of a job: runs in all, finished, of these failed, and how many are finished in a second."""

    total: int
    done: int
    failed: int
    rate: float

    @property
    def share(self) -> float:
        """Share of the runs that are finished."""
        return self.done / self.total if self.total else 1.0

    @property
    def words(self) -> str:
        """Rate and failures, for a line of progress.

        Examples
        --------
        >>> StudyProgress(100, 50, 2, 12.345).words
        '12.3 runs/s, 2 failed'
        """
        rate = f"{self.rate:.3g} runs/s" if self.rate else ""
        return ", ".join(filter(None, [rate, f"{self.failed} failed" if self.failed else ""]))


Advance = Callable[[StudyProgress], None]


def share_reporter(progress: Callable[[float], None] | None) -> Advance | None:
    """Return what reports the share of the runs that are finished, 0 to 1; None where nobody asks.

    Examples
    --------
    >>> report = share_reporter(print)
    >>> report(StudyProgress(4, 1, 0, 2.0)) if report else None
    0.25
    """
    return None if progress is None else (lambda done: progress(done.share))


class Finished(NamedTuple):
    """Keys of the rows of a job, in their order, and how many of them were there already."""

    keys: list[bytes]
    reused: int


def carry_out(
    job: Work[Asked], rows: Sequence[Asked], store: RunStore, pool: Pool, advance: Advance | None = None
) -> Finished:
    """Run all rows of a job that a store does not have, equal ones once; whoever made the pool ends it."""
    work = _Unfinished(job, rows, store, advance)
    work.all_on(pool)
    return Finished(work.keys, work.reused)


class FinishedRuns(NamedTuple):
    """The runs of some rows, in their order: keys, numbers (runs, names), why runs failed, and their verdicts."""

    keys: list[bytes]
    numbers: Array
    failures: list[str]
    verdicts: Verdicts


def finished_runs(
    job: Work[Asked],
    rows: Sequence[Asked],
    store: RunStore,
    pool: Pool,
    advance: Advance | None = None,
    noun: str = "runs",
    not_judged: Sequence[str] = (),
) -> FinishedRuns:
    """Run what a store does not have of a job, and return all of it; see `carry_out` and `Verdicts`."""
    keys = carry_out(job, rows, store, pool, advance).keys
    numbers, failures = store.table(job.names, keys)
    return FinishedRuns(keys, numbers, failures, store.verdicts(keys, noun, not_judged))


@contextlib.contextmanager
def at_work(store: RunStore | None, pool: Pool | None, workers: int = 1) -> Iterator[tuple[RunStore, Pool]]:
    """Give a store and a pool: those that are given, else a temporary one, and so many processes; the pool is ended."""
    with given_or_temporary(store) as open_store, ProcessPool(workers) if pool is None else pool as open_pool:
        yield open_store, open_pool


@dataclass(frozen=True)
class Workers:
    """Processes, executor or cluster that make the runs of a study, and their device.

    Attributes
    ----------
    count : int or None
        Processes of this machine, one a core at most; None for threads of this process. With more than one process,
        call the study below ``if __name__ == "__main__":``.
    executor : Executor or None
        Executor that runs instead: any of `concurrent.futures`, or one that acts as these do.
    cluster : str or None
        Address of a Dask scheduler that shares the runs among machines, such as ``tcp://host:8786``.
    device : str or None
        ``cuda`` or ``cuda-mixed``: the steps of elements are taken on the GPU, which the processes share. `sweep` and
        `design` take it.

    Examples
    --------
    >>> import strikewave
    >>> strikewave.Workers(4, device="cuda-mixed").count
    4
    """

    count: int | None = 1
    executor: Executor | None = None
    cluster: str | None = None
    device: str | None = None

    def __post_init__(self) -> None:
        """Refuse numbers of processes that are typing errors."""
        if self.count is not None and not 1 <= self.count <= MOST_PROCESSES:
            raise InputError("--workers", self.count, f"a whole number from 1 to {MOST_PROCESSES}")

    def pool(self) -> Pool:
        """Return the pool of the executor, of the scheduler, or of so many processes or threads.

        Examples
        --------
        >>> Workers().pool().width
        1
        """
        if self.executor is not None:
            return GivenPool(self.executor)
        if self.cluster:
            from strikewave.studies.engine.cluster import ClusterPool

            return ClusterPool(self.cluster)
        if self.count is None:
            return ThreadPool(min(os.cpu_count() or 1, MOST_THREADS))
        return ProcessPool(self.count)


def as_workers(workers: int | Workers | None, elements: bool = False) -> Workers:
    """Return who makes the runs of a study, of a number of processes too; a device is refused where no elements run."""
    chosen = workers if isinstance(workers, Workers) else Workers(workers)
    if chosen.device is not None and not elements:
        raise InputError("workers", f"device {chosen.device}", "no device: these runs are none of elements")
    return chosen


def seconds_each(job: Work[Asked], rows: Sequence[Asked]) -> float:
    """Return about how long a run takes, s, by some that are made and thrown away.

    The first, the middle and the last one are timed, after one that loads what a process needs.
    """
    job(rows[:1])  # compiles and loads, which no later run does
    places = sorted({0, len(rows) // 2, len(rows) - 1})
    return float(np.mean([outcome.seconds for outcome in job([rows[place] for place in places])]))


class _Unfinished(Generic[Asked]):
    """The rest of a job, and its batches that are out; keys are made while processes run the rows before."""

    def __init__(self, job: Work[Asked], rows: Sequence[Asked], store: RunStore, advance: Advance | None) -> None:
        self._job, self._store, self._advance = job, store, advance
        self.keys, self.reused = list[bytes](), 0
        self._all, self._known = rows, store.known()
        self._rows = dict[bytes, Asked]()  # that are out
        self._next: bytes | None = None  # found ahead, so that it is known whether any is left
        self._out = dict[Future[list[RunOutcome]], list[bytes]]()
        self._suspects, self._innocent = deque[list[bytes]](), deque[list[bytes]]()  # to be run again
        self._deaths = dict[bytes, int]()  # of a batch of one: how often its process ended with it
        self._begin = time.perf_counter()
        self._done = self._failed = 0
        self._seconds = 0.0
        self._look_ahead()

    def _look_ahead(self) -> None:
        """Find the next row that is not finished; equal ones are run once."""
        self._next = None
        while self._next is None and len(self.keys) < len(self._all):
            row = self._all[len(self.keys)]
            key = self._job.key(row)
            self.keys.append(key)
            if key in self._known:
                self.reused += 1
                continue
            self._known.add(key)
            self._rows[key] = row
            self._next = key

    def _taken(self) -> bytes:
        key = self._next
        assert key is not None
        self._look_ahead()
        return key

    def all_on(self, pool: Pool) -> None:
        """Run what is left on a pool; where Ctrl-C stops it, what was finished by then is kept."""
        try:
            self._all_on(pool)
        except KeyboardInterrupt:
            self._keep_finished()
            raise

    def _keep_finished(self) -> None:
        """Keep the batches that have ended, and those that do so within about the time of one."""
        for future in self._out:
            future.cancel()
        under_way = [future for future in self._out if not future.cancelled()]
        for future in wait(under_way, AFTER_STOP).done:
            if error_of(future) is None:
                self._finish(self._out.pop(future), future.result(), quiet=True)

    def _all_on(self, pool: Pool) -> None:
        if is_cold() and self._next:  # one process compiles the kernels, and the others find them on the disk
            self._submit(pool, [self._taken()])
            self._take(pool)
        while self._next or self._out or self._suspects or self._innocent:
            if self._suspects and not self._out:  # alone, so that an end of its process names it
                self._submit(pool, self._suspects.popleft())
            while (self._next or self._innocent) and not self._suspects and len(self._out) < QUEUED * pool.width:
                self._submit(pool, self._innocent.popleft() if self._innocent else self._next_batch(pool))
            self._take(pool)

    def _next_batch(self, pool: Pool) -> list[bytes]:
        """Return the keys of some rows: fewer at the end, so that no process waits long for the last."""
        each = self._seconds / self._done if self._done else BATCH_SECONDS
        left = len(self._all) - len(self.keys) + 1
        width = pool.width
        wanted = max(BATCH_SECONDS, OF_A_HUNDRED * width / 100.0)
        # an even share of what is left at the end: the last batches shrink, and all processes end together
        size = min(int(wanted / max(each, 1e-9)), MOST_IN_BATCH, left // (QUEUED * width))
        batch = [self._taken()]
        while self._next and len(batch) < size:
            batch.append(self._taken())
        return batch

    def _submit(self, pool: Pool, keys: list[bytes]) -> None:
        try:
            future = begin(pool, self._job, [self._rows[key] for key in keys])
        except KeyboardInterrupt as stop:  # of this process, which runs batches itself
            finished: list[RunOutcome] = getattr(stop, "finished", [])
            self._finish(keys[: len(finished)], finished, quiet=True)
            raise
        self._out[future] = keys

    def _take(self, pool: Pool) -> None:
        """Wait for a batch, and keep all that are there."""
        if not self._out:
            return
        alone = len(self._out) == 1
        done = wait(self._out, LOOK_SECONDS, FIRST_COMPLETED).done
        if not done:
            pool.look()
            return
        losses = {self._kept(pool, future) for future in done}
        if Loss.BY_ANY in losses:
            for future in wait(self._out).done:  # what breaks a pool ends all that is out
                self._kept(pool, future)
            if alone:  # nothing else was out: it is to blame
                self._blame(self._suspects.pop())
        if losses - {None}:
            pool.renew()

    def _kept(self, pool: Pool, future: Future[list[RunOutcome]]) -> Loss | None:
        """Keep a batch that came back; or return what ended it before its time, and have it run again."""
        keys = self._out[future]
        error = error_of(future)
        if error is None:
            self._finish(keys, future.result())
        del self._out[future]  # not before it is kept: Ctrl-C may come in between
        if error is None:
            return None
        loss = pool.loss(error)
        if loss is None:
            raise error
        if loss is Loss.BY_ANY:
            self._suspects.append(keys)
        elif loss is Loss.BY_NONE:
            self._innocent.append(keys)
        else:
            self._blame(keys)
        return loss

    def _blame(self, keys: list[bytes]) -> None:
        """Look closer at a batch that ended its process: it, or one of its halves, is run again."""
        if len(keys) > 1:
            self._suspects.extendleft([keys[len(keys) // 2 :], keys[: len(keys) // 2]])
            return
        (key,) = keys
        self._deaths[key] = self._deaths.get(key, 0) + 1
        if self._deaths[key] < MOST_DEATHS:
            self._suspects.appendleft(keys)
            return
        reason = f"its process ended {MOST_DEATHS} times before it did: killed, or out of memory"
        self._finish(keys, [failed(reason, retry=True)])

    def _finish(self, keys: list[bytes], outcomes: list[RunOutcome], quiet: bool = False) -> None:
        """Keep what a batch came to, and report it unless the study is ending."""
        self._store.keep(self._job.names, zip(keys, outcomes, strict=True))
        for key in keys:
            self._rows.pop(key, None)
        self._done += len(keys)
        self._failed += sum(bool(outcome.failure) for outcome in outcomes)
        self._seconds += sum(outcome.seconds for outcome in outcomes)
        if self._advance is not None and not quiet:
            rate = self._done / max(time.perf_counter() - self._begin, 1e-9)
            self._advance(StudyProgress(len(self._all), self.reused + self._done, self._failed, rate))
