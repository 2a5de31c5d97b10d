"""The pool that a study was asked to run on."""

from __future__ import annotations

from concurrent.futures import Executor

from strikewave.studies.engine.pools import GivenPool, Pool, ProcessPool


def pool_of(executor: Executor | None, workers: int, cluster: str | None = None) -> Pool:
    """Return the pool of an executor that is given, of a scheduler, or of so many processes of this machine.

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
    return ProcessPool(workers)
