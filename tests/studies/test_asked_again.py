"""A finished study that is asked again is read, and Ctrl-C keeps each finished run, from the first on."""

import functools
import os
import signal
import sqlite3
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

from strikewave.studies.command import ResumableCommand
from strikewave.studies.engine import runner
from strikewave.studies.engine.evaluation import RunOutcome, attempts
from strikewave.studies.engine.pools import ProcessPool, ThreadPool
from strikewave.studies.engine.runner import carry_out
from strikewave.studies.engine.store import CHUNK, INDEX, KEPT_INDEX, RunStore, begin_from
from strikewave.studies.fit import estimation

BALL = "iso-16063-22-dropball"
FEW = "--set", "feed.blows=2", "--set", "machine.speed.tolerance=1 %"
DESIGN = f"""
schema = 1
case = "{BALL}"
analysis = "impact"
goals = ["approach_speed = 3 m/s +- 1 %"]
[vary]
"machine.height" = "0.1..2 m"
"""
STUDIES = {
    "sweep": ("sweep", BALL, "--vary", "machine.height=0.1 m, 0.2 m", "--analysis", "impact", "--workers", "1"),
    "sweep with histories": ("sweep", BALL, "--vary", "machine.height=0.1 m, 0.2 m", "--keep", "blows"),
    "map": (
        *("map", "li-ma-2019", "--x", "machine.speed=700..730 rpm", "--points", "2x2", "--blows", "3", "--train", "0"),
        *("--workers", "1"),
    ),
    "scatter": ("scatter", "li-ma-2019", *FEW, "--runs", "10", "--shares", "none", "--workers", "1"),
    "design": ("design", "d.toml", "--runs", "16", "--workers", "1"),
    "fit": (
        *("fit", "jesd22-b111-b", "--set", "contact.reference_force=700 kN"),
        *("--to", "first.rigid_peak=1500 g +- 1 %", "--free", "contact.reference_force"),
    ),
    "settings": ("settings", "--spec", "jesd22-b110:A", "--programmer", "linear"),
    "buffer": (
        *("buffer", "li-ma-2019-fig5", "--sensor", "buffered", "--limit", "7000 g", "--material", "PTFE"),
        *("--thickness", "1 mm", "--layers", "1"),
    ),
}  # fmt: skip


@pytest.mark.usefixtures("undrawn")
@pytest.mark.parametrize(
    "which", [pytest.param(one, marks=[pytest.mark.verify] if one != "sweep" else []) for one in STUDIES]
)
def test_a_finished_study_that_is_asked_again_makes_no_run(strikewave, monkeypatch, tmp_path, which):
    """The second time no batch may begin; the tables are those of before to the byte, and the command says so."""
    (tmp_path / "d.toml").write_text(DESIGN)
    words = (*STUDIES[which], "--out", "o", "--fail-on", "never")
    ended, first, err = strikewave(*words)
    assert ended in (0, None), err
    tables = {path.name: path.read_bytes() for path in (tmp_path / "o").glob("*.csv")}
    assert (tmp_path / "o" / KEPT_INDEX).is_file()
    assert not (tmp_path / ".o.runs").exists()
    with monkeypatch.context() as patch:
        patch.setattr(runner, "begin", lambda *_: pytest.fail("a finished run was made again"))
        patch.setattr(estimation, "_made", lambda *_: pytest.fail("a finished run of a fit was made again"))
        ended, again, err = strikewave(*words)
    assert ended in (0, None), err
    assert "finished runs of o; --fresh makes them anew" in err
    assert again == first
    assert {path.name: path.read_bytes() for path in (tmp_path / "o").glob("*.csv")} == tables


def scaled(factors, place):
    """Return a place times factors; a first factor of 0 has no result."""
    MADE.append(place)
    return factors * place if factors[0] else 1.0 / 0.0


MADE = []
"""Places at which `scaled` was asked."""


def test_results_of_a_fit_are_read_by_the_content_of_what_is_asked():
    """To the bit, and what failed as failed; a factor or a place that differs by one bit is another question."""
    places = [np.array([0.1, -0.0]), np.array([0.1 + 2.0**-56, np.nan])]
    factors = [np.array([first, 1.0]) for first in (2.0, 2.0 + 2.0**-51, 0.0)]
    found = []
    with RunStore(None) as store:
        for _ in range(2):
            MADE.clear()
            with estimation.keeping_in(store):
                asked = [functools.partial(scaled, one.copy()) for one in factors]
                found.append([estimation.each_or_none(one, places) for one in asked])
            assert len(MADE) == (6 if len(found) == 1 else 0)
    assert found[0][2] == found[1][2] == [None, None]
    for made, read in zip(found[0][:2], found[1][:2], strict=True):
        assert [one.tobytes() for one in made] == [one.tobytes() for one in read]


def test_what_a_lambda_holds_is_not_seen_so_that_it_is_asked_each_time():
    MADE.clear()
    with RunStore(None) as store, estimation.keeping_in(store):
        for factor in (2.0, 3.0):
            found = estimation.each_or_none(
                lambda place, factor=factor: scaled(np.array([factor]), place), [np.ones(1)]
            )
            assert found == [np.array([factor])]
    assert len(MADE) == 2


@pytest.mark.verify
def test_fresh_makes_the_runs_of_a_finished_study_anew(strikewave):
    words = (*STUDIES["sweep"], "--out", "o")
    strikewave(*words)
    _, _, err = strikewave(*words, "--fresh")
    assert "finished runs of o" not in err


@pytest.mark.verify
def test_another_question_into_the_folder_is_refused(strikewave):
    strikewave(*STUDIES["sweep"], "--out", "o")
    other = [word.replace("0.2 m", "0.3 m") for word in STUDIES["sweep"]]
    ended, _, err = strikewave(*other, "--out", "o")
    assert ended == 2
    assert "it holds another result" in err


class Asked(ResumableCommand):
    """A study that makes no run: what its store has is what the result keeps."""

    def solved(self, store):
        """Return nothing."""

    def summary(self, result):
        """Return nothing."""

    def show(self, result):
        """Print nothing."""


@pytest.mark.parametrize("what", ["as it was written", "no index", "another program's", "a newer version's"])
def test_kept_runs_that_cannot_be_read_are_made_anew(tmp_path, what, capsys):
    """What stands in a result as its runs is no reason to refuse the same question."""
    kept = tmp_path / "o" / KEPT_INDEX
    kept.parent.mkdir()
    with RunStore(None) as store:
        store.keep(("peak",), [(b"a", RunOutcome((1.0,), verdict="passed"))])
        assert store.copy_into(kept.parent, []) == [KEPT_INDEX]
    if what == "no index":
        kept.write_bytes(b"no index at all" * 100)
    elif what != "as it was written":
        base = sqlite3.connect(kept)
        base.execute("PRAGMA application_id = 7" if what == "another program's" else "PRAGMA user_version = 99")
        base.commit()
        base.close()
    command = Asked()
    with command.under_way(tmp_path / "o"):
        known = command.store.known()
    assert known == ({b"a"} if what == "as it was written" else set())
    assert ("finished runs of" in capsys.readouterr().err) == bool(known)
    assert not (tmp_path / ".o.runs").exists()


def test_links_among_kept_histories_are_not_followed(tmp_path):
    kept, secret = tmp_path / "o", tmp_path / "secret"
    kept.mkdir()
    secret.write_text("of another")
    with RunStore(None) as store:
        assert store.copy_into(kept, []) == [KEPT_INDEX]
    (kept / CHUNK.format(1)).write_text("histories")
    (kept / CHUNK.format(2)).symlink_to(secret)
    assert begin_from(kept, tmp_path / "runs")
    assert sorted(path.name for path in (tmp_path / "runs").iterdir()) == [INDEX, CHUNK.format(1)]


class Stopping:
    """Work whose third run is stopped by Ctrl-C: in this process it is one batch."""

    names = ("twice",)

    def key(self, number):
        return str(number).encode()

    def __call__(self, numbers):
        return attempts(lambda number=number: self.run(number) for number in numbers)

    def run(self, number):
        if number == 3:
            raise KeyboardInterrupt
        return RunOutcome((2.0 * number,))


def test_finished_runs_of_a_batch_that_ctrl_c_stops_are_kept(monkeypatch):
    """In this process a batch of several is stopped within: those before are finished."""
    monkeypatch.setattr(runner._Unfinished, "_next_batch", lambda self, _: [self._taken() for _ in range(3)])
    with RunStore(None) as store, ProcessPool(1) as pool:
        with pytest.raises(KeyboardInterrupt):
            carry_out(Stopping(), [1, 2, 3, 4], store, pool)
        assert store.known() == {b"1", b"2"}


class Slow:
    """Work that takes a while, on threads."""

    names = ("twice",)

    def __init__(self):
        self.begun = threading.Event()

    def key(self, number):
        return str(number).encode()

    def __call__(self, numbers):
        self.begun.set()
        time.sleep(0.2)
        return [RunOutcome((2.0 * number,)) for number in numbers]


def test_batches_that_end_soon_after_ctrl_c_are_kept(monkeypatch):
    """Ctrl-C comes while two batches are under way, before any was reported."""
    work, waited = Slow(), runner.wait

    def stopped(*arguments):
        monkeypatch.setattr(runner, "wait", waited)
        work.begun.wait(5.0)
        raise KeyboardInterrupt

    monkeypatch.setattr(runner, "wait", stopped)
    with RunStore(None) as store, ThreadPool(2) as pool:
        with pytest.raises(KeyboardInterrupt):
            carry_out(work, [1, 2, 3, 4], store, pool)
        assert store.known() >= {b"1", b"2"}


@pytest.mark.verify
@pytest.mark.parametrize("workers", ["1", "2"])
def test_ctrl_c_after_the_first_run_keeps_it_and_the_same_command_goes_on(tmp_path, environment, workers):
    """The signal comes as soon as the store has a run; what it says is kept is there, and is not made again."""
    words = [sys.executable, "-m", "strikewave", "sweep", "li-ma-2019", "--vary", "machine.speed=500..900 rpm:12"]
    words += ["--workers", workers, "--out", "o"]
    child = subprocess.Popen(words, cwd=tmp_path, env=environment, stderr=subprocess.PIPE, text=True)
    journal, deadline = tmp_path / ".o.runs" / f"{INDEX}-wal", time.monotonic() + 60.0
    while time.monotonic() < deadline and child.poll() is None:
        if journal.is_file() and journal.stat().st_size > 40_000:  # the tables alone take 30 kB
            break
        time.sleep(0.01)
    child.send_signal(signal.SIGINT)
    _, err = child.communicate(timeout=60)
    if child.returncode == 0:
        pytest.skip("all runs had ended before the signal")
    assert child.returncode == 130, err
    kept = int(err.partition("stopped; ")[2].partition(" of 12 runs")[0])
    assert kept >= 1
    with RunStore(tmp_path / ".o.runs") as store:
        assert len(store.known()) == kept
    done = subprocess.run(
        words, cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=120, check=False
    )
    assert done.returncode == 0, done.stderr
    assert not os.path.exists(tmp_path / ".o.runs")
