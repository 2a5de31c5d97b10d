"""A scheduler of Dask and its workers on the loopback: workers and scheduler that are killed, others that are refused."""

import contextlib
import importlib
import json
import os
import signal
import socket
import struct
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest

from strikewave import load_case
from strikewave.base.errors import InputError
from strikewave.studies.engine import cluster, evaluation
from strikewave.studies.engine.cluster import ClusterPool, OfThisVersion
from strikewave.studies.engine.evaluation import Job
from strikewave.studies.engine.plan import grid, read_variable, varied
from strikewave.studies.engine.runner import Workers, carry_out
from strikewave.studies.engine.store import RunStore
from strikewave.studies.sweep.study import sweep

CASE = load_case("li-ma-2019", ["feed.blows=1"])
EVALUATIONS = """
import os, signal
from dataclasses import dataclass
from strikewave.studies.engine.evaluation import RunOutcome

@dataclass(frozen=True)
class Speed:
    names: tuple[str, ...] = ("speed",)

    def __call__(self, case):
        return RunOutcome((case.machine.speed.si,))

@dataclass(frozen=True)
class Deadly(Speed):
    def __call__(self, case):
        if case.machine.speed.si > 89.0:
            os.kill(os.getpid(), signal.SIGKILL)
        return super().__call__(case)
"""
"""A number that is known, by a module that the workers can import; and one that no process survives at the highest."""


class Cluster:
    """A scheduler and its workers, each a process."""

    def __init__(self, folder):
        self.folder, self.processes = folder, []
        self.scheduler = self.start("scheduler", "--host", "127.0.0.1", "--port", "0")
        end = time.monotonic() + 120.0
        while self.address is None:
            assert time.monotonic() < end, (folder / "scheduler-1.log").read_text()
            time.sleep(0.05)

    @property
    def file(self):
        return self.folder / "scheduler.json"

    @property
    def address(self):
        """Where the scheduler listens; None while its file is not there, or not wholly written."""
        with contextlib.suppress(FileNotFoundError, json.JSONDecodeError):
            return json.loads(self.file.read_text())["address"]
        return None

    def start(self, what, *words):
        log = self.folder / f"{what}-{len(self.processes) + 1}.log"
        module = f"distributed.cli.dask_{what}"
        process = subprocess.Popen(
            [sys.executable, "-m", module, "--scheduler-file", self.file, "--no-dashboard", *words],
            env={**os.environ, "PYTHONPATH": os.pathsep.join([str(self.folder), os.environ.get("PYTHONPATH", "")])},
            cwd=self.folder,
            stderr=log.open("w"),
        )
        self.processes.append(process)
        return process

    def worker(self, watched=False):
        """Start a worker; one that is watched is started again where it ends."""
        nanny = "--nanny" if watched else "--no-nanny"
        return self.start("worker", "--nthreads", "1", nanny, "--local-directory", self.folder)

    def end(self):
        for process in self.processes:
            process.kill()
            process.wait()


@pytest.fixture
def of_two(tmp_path, monkeypatch):
    (tmp_path / "speed_evaluations.py").write_text(EVALUATIONS)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(cluster, "CONNECT_SECONDS", 120.0)  # for workers that are still starting
    made = Cluster(tmp_path)
    yield made
    made.end()


def speeds(count, evaluation="Speed"):
    speed = getattr(importlib.import_module("speed_evaluations"), evaluation)()
    variable = read_variable(CASE, f"machine.speed=40..90 rad/s:{count}")
    return Job(varied(CASE, [variable], "test"), speed), grid([variable])


@pytest.mark.verify
def test_ten_thousand_runs_of_which_a_worker_is_killed_are_each_there_once(of_two):
    """Each row has its own speed; the worker is killed by -9 once four in ten are there."""
    first, _ = of_two.worker(), of_two.worker()
    job, rows = speeds(10_000)

    def advance(done):
        if done.share > 0.4 and first.poll() is None:
            first.send_signal(signal.SIGKILL)
            first.wait()

    with RunStore(None) as kept, ClusterPool(of_two.address) as pool:
        found = carry_out(job, rows, kept, pool, advance)
        numbers, failures = kept.table(("speed",), found.keys)
        assert len(kept.known()) == len(rows)
    assert first.poll() is not None
    assert not any(failures)
    np.testing.assert_array_equal(numbers, rows)


@pytest.mark.verify
def test_a_run_that_ends_every_worker_is_a_row_with_the_reason(tmp_path, monkeypatch, request):
    """The scheduler gives a batch up with the first worker that ends with it (`KilledWorker`); others go on."""
    (tmp_path / "speed_evaluations.py").write_text(EVALUATIONS)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(cluster, "CONNECT_SECONDS", 120.0)
    monkeypatch.setenv("DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES", "0")
    made = Cluster(tmp_path)
    request.addfinalizer(made.end)
    made.worker(watched=True)
    job, rows = speeds(6, "Deadly")
    with RunStore(None) as kept, ClusterPool(made.address) as pool:
        found = carry_out(job, rows, kept, pool)
        numbers, failures = kept.table(("speed",), found.keys)
    np.testing.assert_array_equal(numbers[:-1], rows[:-1])
    assert failures[:-1] == [""] * 5
    assert failures[-1].startswith("its process ended 3 times before it did")


@pytest.mark.verify
def test_a_scheduler_that_is_killed_and_comes_back_loses_no_run(of_two):
    worker = of_two.worker()
    job, rows = speeds(600)

    def advance(done):
        if done.share > 0.3 and of_two.scheduler.poll() is None:
            of_two.scheduler.kill()
            of_two.scheduler.wait()
            worker.kill()
            host, port = of_two.address.removeprefix("tcp://").split(":")
            of_two.start("scheduler", "--host", host, "--port", port)
            of_two.worker()

    with RunStore(None) as kept, ClusterPool(of_two.address) as pool:
        found = carry_out(job, rows, kept, pool, advance)
        numbers, failures = kept.table(("speed",), found.keys)
        assert len(kept.known()) == len(rows)
    assert of_two.scheduler.poll() is not None
    assert not any(failures)
    np.testing.assert_array_equal(numbers, rows)


@pytest.mark.verify
def test_a_sweep_has_the_bits_of_this_process_and_another_version_is_refused(of_two, monkeypatch):
    of_two.worker()
    words = CASE, ["machine.speed=600..800 rpm:5"], ["first.rigid_peak", "first.width"]
    given = sweep(words[0], words[1], keep=words[2], analysis="fast", workers=Workers(cluster=of_two.address))
    own = sweep(words[0], words[1], keep=words[2], analysis="fast")
    assert np.array_equal(given.numbers, own.numbers)
    evaluation.program_key.cache_clear()
    monkeypatch.setattr(evaluation, "__version__", "9.9.9")
    with pytest.raises(InputError, match=r"--cluster: .* workers with this strikewave: tcp://.* not 9\.9\.9"):
        ClusterPool(of_two.address)
    evaluation.program_key.cache_clear()


def test_a_worker_that_joins_late_with_another_version_runs_nothing():
    with pytest.raises(Exception, match=r"strikewave .*, not 9\.9\.9"):
        OfThisVersion(list, "9.9.9 abc")([(1.0,)])


@contextlib.contextmanager
def listening(answer):
    """Yield the port of what takes all connections and sends each these bytes; it hangs up behind some, and only then."""
    lines = []
    with socket.create_server(("127.0.0.1", 0)) as server:

        def take():
            with contextlib.suppress(OSError):  # at the end
                while True:
                    line, _ = server.accept()
                    lines.append(line)
                    line.sendall(answer)
                    if answer:
                        line.close()

        threading.Thread(target=take, daemon=True).start()
        yield server.getsockname()[1]
        server.shutdown(socket.SHUT_RDWR)
    for line in lines:
        line.close()


@pytest.mark.parametrize(
    "answer",
    [
        b"",
        b"HTTP/1.0 400 Bad request syntax\r\n\r\nnothing here",
        bytes(range(256)) * 16,  # read as lengths of frames, these are exabytes
        struct.pack("<QQ", 8, 0),
    ],
)
def test_what_is_no_scheduler_is_refused_in_one_line_however_it_answers(answer, monkeypatch, capfd):
    monkeypatch.setattr(cluster, "CONNECT_SECONDS", 1.0)
    with (
        listening(answer) as port,
        pytest.raises(InputError, match="does not answer as a scheduler of Dask does") as refused,
    ):
        ClusterPool(f"tcp://127.0.0.1:{port}")
    assert "\n" not in str(refused.value)
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize(
    ("address", "reason"),
    [
        ("tcp://127.0.0.1:9", "nothing takes a connection there"),
        ("tls://127.0.0.1:8786", r"certificates, .*distributed\.comm\.tls: ca-file, client\.cert and client\.key"),
        ("ucx://127.0.0.1:8786", "Dask knows no ucx:// here"),
        ("http://127.0.0.1:8786", "Dask knows no http:// here"),
        ("nowhere", "no address of Dask"),
        ("tcp://", "no address of Dask"),
        ("tcp://127.0.0.1:99999", "no address of Dask"),
        ("tcp://a..b:8786", "no address"),
        ("tcp://[", "no address"),
    ],
)
def test_a_scheduler_that_cannot_be_reached_is_refused_in_one_line(address, reason, monkeypatch, capfd):
    monkeypatch.setattr(cluster, "CONNECT_SECONDS", 1.0)
    with pytest.raises(InputError, match=f"--cluster: .*a Dask scheduler that can be reached; .*{reason}") as refused:
        ClusterPool(address)
    assert "\n" not in str(refused.value)
    assert capfd.readouterr().err == ""
    assert not Path("dask-worker-space").exists()
