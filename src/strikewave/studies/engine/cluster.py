"""Many machines: a pool whose batches the scheduler of Dask shares among its workers.

A worker that ends loses nothing: the scheduler gives its batches to others. Where the scheduler itself ends, the pool
waits till it is back at its address, and what was out is run again.
"""

from __future__ import annotations

import asyncio
import contextlib
import importlib
import logging
import socket
import threading
import time
from collections.abc import Sequence
from concurrent.futures import CancelledError, Future, InvalidStateError
from dataclasses import dataclass
from types import TracebackType
from typing import Any, Generic

from strikewave.base.compiled import is_cold
from strikewave.base.errors import InputError, MissingPackageError, StrikewaveError
from strikewave.studies.engine.evaluation import program_key
from strikewave.studies.engine.pools import Answer, Asked, Batch, Loss, Pool

OPTION = "--cluster"
CONNECT_SECONDS = 7.0
"""Seconds in which a scheduler must answer: a wrong address is then known before anyone looks away. Ten are promised
from the start of the command; the rest is for a machine that is slow to load Dask."""
NO_ADDRESS = "this is no address of Dask, which has a protocol, a host and a port"
OTHER_ANSWER = "what is there does not answer as a scheduler of Dask does"
RETURN_PAUSE = 0.5
"""Seconds between two tries to find a scheduler that ended: one may be refused at once."""
CERTIFICATES = "distributed.comm.tls: ca-file, client.cert and client.key"
"""Keys of the configuration of Dask that name certificates of a client."""
RETURN_SECONDS = 300.0
"""Seconds in which a scheduler that ended must be back, with a worker. Chosen: a batch system starts one in minutes."""
WIDTH_SECONDS = 5.0
"""Seconds between two looks at how many workers there are, which may come and go."""
ENDED_WORKER, CLOSED = "KilledWorker", "ClosedClientError"
"""Names of the errors of Dask: a batch that ended its worker several times; a scheduler that is gone."""


@dataclass(frozen=True)
class OfThisVersion(Generic[Asked, Answer]):
    """A batch that only a worker with the same strikewave runs: one that joins late is not asked before."""

    batch: Batch[Asked, Answer]
    program: str

    def __call__(self, rows: Sequence[Asked]) -> list[Answer]:
        """Return what some rows come to."""
        if program_key() != self.program:
            raise StrikewaveError(_other_version(program_key(), self.program))
        return self.batch(rows)


class ClusterPool(Pool):
    """The workers of a scheduler of Dask; see `Pool`.

    Parameters
    ----------
    address : str
        Address of the scheduler, such as ``tcp://host:8786``.

    Raises
    ------
    InputError
        If Dask is missing, the scheduler cannot be reached, or a worker has another strikewave.
    """

    def __init__(self, address: str) -> None:
        self._address = address
        self._running = set[Future[Any]]()
        self._is_warm = False
        self._connect()
        self._counted, self._width = 0.0, 1

    def _connect(self) -> None:
        """Connect, and note which scheduler it is."""
        self._client = self._connected(CONNECT_SECONDS)
        self._scheduler = self._client.scheduler_info()["id"]
        self._executor = self._client.get_executor(pure=False)  # pure: equal batches would share a result

    def _connected(self, seconds: float) -> Any:
        """Return a client that has a worker, all of whose workers have this strikewave."""
        try:
            distributed = importlib.import_module("distributed")
        except ImportError:
            raise MissingPackageError(OPTION, "dask.distributed", "cluster") from None
        _silence()
        allowed = "the address of a Dask scheduler that can be reached"
        hint = "such as tcp://host:8786; start one by dask scheduler, and its workers by dask worker ADDRESS"
        reason = _reason_not_there(self._address, seconds)
        if reason:
            raise InputError(OPTION, self._address, allowed, f"{reason}; {hint}")
        try:
            # not the default: a client that the caller has stays theirs
            client = distributed.Client(self._address, timeout=seconds, set_as_default=False)
        except (OSError, ValueError, RuntimeError, TypeError):
            raise InputError(OPTION, self._address, allowed, hint) from None
        try:
            client.wait_for_workers(1, timeout=seconds)
        except (OSError, RuntimeError):
            client.close()
            raise InputError(OPTION, self._address, "a scheduler with a worker", hint) from None
        for worker, program in client.run(program_key, on_error="return").items():
            if program != program_key():
                client.close()
                raise InputError(OPTION, self._address, f"workers with this strikewave: {worker} has {_said(program)}")
        return client

    @property
    def width(self) -> int:
        """The number of batches that run at a time: the threads of all workers."""
        if time.monotonic() > self._counted + WIDTH_SECONDS:
            with contextlib.suppress(Exception):  # on the way to a scheduler that is gone
                self._width = max(sum(self._client.nthreads().values()), 1)
            self._counted = time.monotonic()
        return self._width

    def submit(self, job: Batch[Asked, Answer], rows: Sequence[Asked]) -> Future[list[Answer]]:
        """Begin a batch."""
        if not self._is_warm:
            self._warm(job, rows)
        future: Future[list[Answer]] = self._executor.submit(OfThisVersion(job, program_key()), rows)
        self._running.add(future)
        future.add_done_callback(self._running.discard)
        return future

    def _warm(self, job: Batch[Asked, Answer], rows: Sequence[Asked]) -> None:
        """Let one worker of each machine compile the kernels that are not there; the others find them on its disk."""
        self._is_warm = True
        one_each = {worker.rpartition(":")[0]: worker for worker in self._client.nthreads()}
        cold = [worker for worker, is_new in self._client.run(is_cold, workers=[*one_each.values()]).items() if is_new]
        if cold:
            self._client.run(job, rows[:1], workers=cold, on_error="ignore")

    def loss(self, error: BaseException) -> Loss | None:
        """Return what was lost: with several workers the batch is to blame, with the scheduler none is."""
        name = type(error).__name__
        if name == ENDED_WORKER:
            return Loss.BY_THIS
        return Loss.BY_NONE if isinstance(error, CancelledError) or name == CLOSED else None

    def look(self) -> None:
        """End what is out where the scheduler is gone: nobody reports a batch that was on its way to it then."""
        if not self._is_there():
            self._end_running()

    def _is_there(self) -> bool:
        """Tell whether the scheduler is still the one that batches were given to: another knows none of them."""
        if self._client.status != "running":
            return False
        try:
            return bool(self._client.scheduler_info()["id"] == self._scheduler)
        except Exception:  # on the way to a scheduler that is gone
            return False

    def _end_running(self) -> None:
        """End batches of a scheduler that is gone as if they were taken back: they are run again."""
        for future in list(self._running):
            with contextlib.suppress(InvalidStateError):  # it came back meanwhile
                future.set_exception(CancelledError())

    def renew(self) -> None:
        """Wait till the scheduler is there again, and has a worker."""
        if self._is_there():
            return
        self._client.close()
        self._end_running()
        end = time.monotonic() + RETURN_SECONDS
        while True:
            try:
                self._connect()
                break
            except InputError:
                if time.monotonic() > end:
                    gone = f"the scheduler at {self._address} ended, and was not back in {RETURN_SECONDS / 60:.0f} min"
                    raise StrikewaveError(f"{gone}; what was finished is kept") from None
                time.sleep(RETURN_PAUSE)
        self._is_warm = False

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for future in list(self._running):
            future.cancel()
        self._client.close()


def _silence() -> None:
    """Leave it to us to say what went wrong with a connection; each module of Dask has a logger with its own level."""
    for name in list(logging.root.manager.loggerDict):
        if name.partition(".")[0] == "distributed":
            logging.getLogger(name).setLevel(logging.CRITICAL + 1)


def _reason_not_there(address: str, seconds: float) -> str:
    """Return why no scheduler answers at an address within so many seconds; empty where one does.

    It is asked without a client, which waits for an answer for ever, and for its own end when it is given up. What
    hangs (a name server, a port that takes all and says nothing) is left to a thread that ends with the program.
    """
    reasons: list[str] = []

    def ask() -> None:
        reasons.append(_asked(address, seconds))

    asking = threading.Thread(target=ask, name="strikewave cluster", daemon=True)
    asking.start()
    asking.join(seconds)
    return reasons[0] if reasons else f"what is there gave no answer in {seconds:.0f} s"


def _asked(address: str, seconds: float) -> str:
    """Return why no scheduler answers, in words; empty where one does."""
    comm = importlib.import_module("distributed.comm")
    registry = importlib.import_module("distributed.comm.registry")
    certificates: dict[str, Any] = {}
    scheme = comm.parse_address(address)[0]
    try:
        registry.get_backend(scheme).get_connector()
    except Exception:  # a protocol that is not known, or one whose package is not installed
        return f"Dask knows no {scheme}:// here"
    try:
        if scheme in ("tcp", "tls"):
            host, port = comm.get_address_host_port(address)
            if not 0 < port < 1 << 16:
                return NO_ADDRESS
            socket.getaddrinfo(host, port)
    except OSError:
        return "no address is found for the name of its host"
    except ValueError:
        return NO_ADDRESS
    if scheme == "tls":
        try:
            certificates = importlib.import_module("distributed").Security().get_connection_args("client")
        except (OSError, ValueError) as error:
            return f"the certificates that Dask is configured with cannot be read ({error}): see {CERTIFICATES}"
        if certificates["ssl_context"] is None:
            return f"tls:// needs certificates, which the configuration of Dask names under {CERTIFICATES}"
    try:
        answer = asyncio.run(asyncio.wait_for(_identity(comm, address, 0.8 * seconds, certificates), 0.9 * seconds))
    except TimeoutError:
        return OTHER_ANSWER
    except OSError as error:
        is_alone = type(error) is OSError  # that of all tries; a line that is cut has an error of its own
        return "nothing takes a connection there" if is_alone else OTHER_ANSWER
    except Exception:  # bytes of another protocol can be any error
        return OTHER_ANSWER
    return "" if answer == "Scheduler" else f"what answers there is a {str(answer).lower()} of Dask"


async def _identity(comm: Any, address: str, seconds: float, certificates: dict[str, Any]) -> object:
    """Return what one that speaks the protocol of Dask says that it is; what it sends is not unpickled."""
    asyncio.get_running_loop().set_exception_handler(lambda *_: None)
    line = await comm.connect(address, timeout=seconds, deserialize=False, **certificates)
    try:
        await line.write({"op": "identity", "reply": True})
        return (await line.read())["type"]
    finally:
        line.abort()


def _said(program: object) -> str:
    """Return what a worker has, in words: a key of its program, or an error that says why it has none."""
    if isinstance(program, str):
        return _other_version(program, program_key())
    return f"none that can be used ({program})"


def _other_version(other: str, program: str) -> str:
    """Say how two programs differ: by version, or else by source.

    Examples
    --------
    >>> _other_version("0.1.0 ab", "0.2.0 ab"), _other_version("0.2.0 cd", "0.2.0 ab")
    ('strikewave 0.1.0, not 0.2.0', 'strikewave 0.2.0 with other kernels')
    """
    (version, _), (own, _) = (key.split(" ", 1) for key in (other, program))
    return f"strikewave {version}, not {own}" if version != own else f"strikewave {version} with other kernels"
