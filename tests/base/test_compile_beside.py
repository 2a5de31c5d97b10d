"""A second process compiles beside the first where that helps; whatever becomes of it, the first goes on."""

import os
import subprocess
import sys

import numba
import pytest

from strikewave.base import compiled, compiling
from strikewave.base.compiling import await_kernel, compiled_beside, compiling_shown

JOBS = """
import time
import numba

def two():
    inner = numba.njit(lambda x: 2.0 * x)
    numba.njit(lambda x: inner(x) + 1.0)(3.0)

def fails():
    raise ValueError

def lasts():
    time.sleep(600.0)
"""


@pytest.fixture
def started(tmp_path, monkeypatch):
    """A cold cache, two cores and a module of jobs; gives the processes that were started."""
    (tmp_path / "jobs_of_a_test.py").write_text(JOBS)
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(compiled, "cache_folder", lambda: str(tmp_path))
    monkeypatch.setattr(os, "sched_getaffinity", lambda process: {0, 1}, raising=False)
    processes = []

    class Noted(subprocess.Popen):
        def __init__(self, *rest, **options):
            super().__init__(*rest, **options)
            processes.append(self)

    monkeypatch.setattr(compiling.subprocess, "Popen", Noted)
    return processes


@pytest.mark.verify
def test_kernels_of_the_second_process_count_as_those_of_the_first(started):
    told = []
    with compiling_shown(lambda *what: told.append(what)), compiled_beside("any", "jobs_of_a_test:two"):
        numba.njit(lambda x: x + 1.0)(3.0)
    assert told == [(0, False), (1, False), (2, False), (3, False), (3, True)]
    assert [process.returncode for process in started] == [0]


@pytest.mark.parametrize("job", ["jobs_of_a_test:fails", "no_such_module:two", "jobs_of_a_test:no_such_function"])
def test_a_second_process_that_fails_harms_nothing(started, job, capfd):
    with compiled_beside("any", job):
        done = True
    assert done
    assert [process.returncode for process in started] == [1]
    assert capfd.readouterr() == ("", "")


def test_where_no_process_starts_the_block_runs_alone(started, monkeypatch):
    def refused(*rest, **options):
        raise OSError("no more processes")

    monkeypatch.setattr(compiling.subprocess, "Popen", refused)
    with compiled_beside("any", "jobs_of_a_test:two"):
        done = True
    assert done


def test_a_block_that_fails_ends_the_second_process(started):
    with pytest.raises(KeyboardInterrupt), compiled_beside("any", "jobs_of_a_test:lasts"):
        raise KeyboardInterrupt
    assert started[0].returncode not in (None, 0)


def test_the_second_process_ends_with_the_first(started):
    with pytest.raises(ZeroDivisionError), compiled_beside("any", "jobs_of_a_test:lasts"):
        started[0].stdin.close()  # as the system does when the first process is gone
        assert started[0].wait(60.0) == 1
        raise ZeroDivisionError


def compiled_already(monkeypatch, folder):
    (folder / "_kernels.last-12.py311.nbi").write_bytes(b"")


def without_a_cache(monkeypatch, folder):
    monkeypatch.setattr(compiled, "cache_folder", lambda: None)


def on_one_core(monkeypatch, folder):
    monkeypatch.setattr(os, "sched_getaffinity", lambda process: {0}, raising=False)


def in_a_frozen_program(monkeypatch, folder):
    monkeypatch.setattr(sys, "frozen", True, raising=False)


def without_an_interpreter(monkeypatch, folder):
    monkeypatch.setattr(sys, "executable", "")


@pytest.mark.parametrize(
    "where", [compiled_already, without_a_cache, on_one_core, in_a_frozen_program, without_an_interpreter]
)
def test_nothing_is_started_where_it_would_not_help(started, monkeypatch, tmp_path, where):
    where(monkeypatch, tmp_path)
    with compiled_beside("last", "jobs_of_a_test:two"):
        pass
    assert started == []


@pytest.mark.verify
def test_the_second_process_never_runs_the_script_of_the_first(tmp_path):
    """A script without a guard of its main part, as people write them."""
    script = tmp_path / "script.py"
    script.write_text(
        "from strikewave.base import compiled\n"
        "from strikewave.base.compiling import compiled_beside\n"
        f"compiled.cache_folder = lambda: {str(tmp_path)!r}\n"
        "print('once')\n"
        "with compiled_beside('any', 'math:sqrt'):\n"
        "    print('within')\n"
    )
    run = subprocess.run([sys.executable, script], capture_output=True, text=True, check=True)
    assert run.stdout == "once\nwithin\n"


def test_a_job_waits_until_the_code_of_a_kernel_is_there_and_no_longer_than_it_has_patience(tmp_path, monkeypatch):
    monkeypatch.setattr(compiled, "cache_folder", lambda: str(tmp_path))
    monkeypatch.setattr(compiling, "PATIENCE", 0.1)
    await_kernel("never")
    looks = []

    def looked(seconds):
        looks.append(seconds)
        kind = "nbi" if len(looks) == 1 else "1.nbc"
        (tmp_path / f"_a.last-12.py311.{kind}").write_bytes(b"")

    monkeypatch.setattr(compiling, "PATIENCE", 60.0)
    monkeypatch.setattr(compiling.time, "sleep", looked)
    await_kernel("_a.last")
    assert len(looks) == 2
