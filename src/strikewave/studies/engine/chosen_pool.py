"""The pool that a study was asked to run on."""

from __future__ import annotations

import os
from concurrent.futures import Executor

from strikewave.studies.engine.pools import GivenPool, Pool, ProcessPool, ThreadPool
from strikewave.uncertainty.runs import MOST_THREADS


def pool_of(executor: Executor | None, workers: int | None, cluster: str | None = None) -> Pool:
    """Return the pool of an executor that is given, of a scheduler, or of so many processes of this machine.

    With none of them threads of this process.

    Examples
    --------
    >>> pool_of(None, 1).width
    1
    """
    if executor is not None:
        return GivenPool(executor)
    if cluster:
        from strikewave.studies.engine.cluster import ClusterPool

        return ClusterPool(cluster)
    return ThreadPool(min(os.cpu_count() or 1, MOST_THREADS)) if workers is None else ProcessPool(workers)
