"""A result folder has one run at a time; what a killed run left beside it goes with the next."""

import contextlib
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from strikewave.base import output_folder
from strikewave.base.errors import InputError, StrikewaveWarning
from strikewave.base.output_folder import Claim, atomic_folder, claimed, mark_text

WRITER = """
import sys, time
from pathlib import Path
from strikewave.base.output_folder import claimed
from strikewave.base.output_folder import atomic_folder
with claimed(Path(sys.argv[1])) as claim, atomic_folder(claim, "", force=True) as place:
    (place / "waves.nc").write_text("half")
    print("writing", flush=True)
    time.sleep(60)
"""


@contextlib.contextmanager
def another_run(folder, environment):
    """A run in another process that is writing the folder."""
    with subprocess.Popen([sys.executable, "-c", WRITER, str(folder)], env=environment, stdout=subprocess.PIPE) as run:
        try:
            assert run.stdout.readline() == b"writing\n"
            yield run
        finally:
            run.kill()


def write(folder, text):
    with claimed(folder) as claim, atomic_folder(claim, "", force=True) as place:
        (place / "case.toml").write_text(text)


def test_a_second_run_is_told_who_has_the_folder_and_takes_what_a_kill_left(tmp_path, environment):
    folder = tmp_path / "out"
    write(folder, "before")
    with another_run(folder, environment) as run:
        with pytest.raises(InputError, match=f"process {run.pid} is at work"), claimed(folder):
            pass
        assert mark_text(folder / "case.toml") == "before"
        run.send_signal(signal.SIGKILL)
        run.wait()
    left = {path.name for path in tmp_path.iterdir()}
    assert len(left) == 3  # the result, what was being written, and its lock
    write(folder, "after")
    assert [path.name for path in tmp_path.iterdir()] == ["out"]
    assert mark_text(folder / "case.toml") == "after"


def test_runs_on_other_folders_of_a_place_do_not_wait(tmp_path, environment):
    with another_run(tmp_path / "one", environment):
        write(tmp_path / "two", "")
    assert (tmp_path / "two" / "case.toml").exists()


@pytest.mark.parametrize("exchanges", [True, False])
def test_an_older_result_goes_only_for_a_whole_one(tmp_path, monkeypatch, exchanges):
    """With the system's exchange of two names, and with two renames where it has none."""
    folder = tmp_path / "out"
    if not exchanges:
        monkeypatch.setattr(output_folder, "_exchange", lambda one, other: False)
    write(folder, "first")
    write(folder, "second")
    assert mark_text(folder / "case.toml") == "second"
    with pytest.raises(KeyboardInterrupt), claimed(folder) as claim, atomic_folder(claim, "", force=True) as place:
        (place / "case.toml").write_text("third")
        raise KeyboardInterrupt
    assert not claim.written
    assert mark_text(folder / "case.toml") == "second"
    assert [path.name for path in tmp_path.iterdir()] == ["out"]


@pytest.mark.skipif(sys.platform != "linux", reason="renameat2 is of Linux")
def test_a_reader_finds_a_result_at_each_moment_of_a_hundred_replacements(tmp_path, environment):
    folder, done = tmp_path / "out", tmp_path / "done"
    write(folder, "0")
    watcher = (
        "import os, sys\n"
        "missed = looks = 0\n"
        "print('ready', flush=True)\n"
        "while not os.path.exists(sys.argv[2]):\n"
        "    missed, looks = missed + (not os.path.exists(sys.argv[1])), looks + 1\n"
        "print(missed, looks)\n"
    )
    command = [sys.executable, "-c", watcher, str(folder), str(done)]
    with subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, text=True) as run:
        run.stdout.readline()
        for k in range(100):
            write(folder, str(k))
        done.touch()
        missed, looks = map(int, run.stdout.readline().split())
    assert (missed, looks > 0) == (0, True)


def test_a_run_killed_between_two_renames_is_put_right_by_the_next(tmp_path):
    folder = tmp_path / "out"
    write(folder, "before")
    claim = Claim(folder)
    claim.begin()
    folder.rename(claim._old)
    with pytest.warns(StrikewaveWarning, match="the older result is back"), claimed(folder):
        assert mark_text(folder / "case.toml") == "before"
    assert [path.name for path in tmp_path.iterdir()] == ["out"]


def test_folders_above_that_nothing_came_into_go_again(tmp_path):
    with claimed(tmp_path / "a" / "b" / "c"):
        assert (tmp_path / "a" / "b").is_dir()
    assert not any(tmp_path.iterdir())


def test_a_process_that_was_forked_does_not_hold_the_folder(tmp_path):
    """As a worker does that outlives its run."""
    with claimed(tmp_path / "out") as claim:
        child = os.fork()
        if child == 0:
            time.sleep(60)
            os._exit(0)
        assert claim.lock.exists()
    try:
        write(tmp_path / "out", "")
    finally:
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
    assert Path(tmp_path / "out").is_dir()
