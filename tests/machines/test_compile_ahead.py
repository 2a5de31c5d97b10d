"""What is compiled ahead of the fast run is what the fast run calls, and nothing else."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from strikewave import load_case
from strikewave.analyses.machine.run import run_case
from strikewave.base.compiled import cache_folder
from strikewave.machines import fast_run
from strikewave.machines.fast_run import compile_fast_run, fast_run_beside

COLD = """
import strikewave
from strikewave.base import compiled
from strikewave.base.compiling import compiling_shown
from numba.core import event

class Mine(event.Listener):
    names = []
    def on_start(self, started):
        if started.data:
            self.names.append(started.data["dispatcher"].py_func.__name__)
    def on_end(self, ended):
        pass

told = []
case = strikewave.load_case("li-ma-2019", ["feed.blows=1"])
with compiling_shown(lambda *what: told.append(what)), event.install_listener("numba:compile", Mine()):
    strikewave.run_case(case, band=True)
print(len(Mine.names), told[-1][0], *sorted(set(Mine.names) & {"run_train", "follow_blow", "begin_blow", "note_blow"}))
"""


def kept(name):
    return len(list(Path(cache_folder() or "").rglob(f"*.{name}-*.nbc")))


def test_what_is_compiled_ahead_is_what_the_fast_run_calls():
    """Each kernel is kept for one set of types alone: another would be kept beside it."""
    compile_fast_run()
    names = ("begin_blow", "end_blow", "ringing", "crowded", "open_row", "note_blow", "measure_row", "note_flight")
    assert {name: kept(name) for name in (*names, "missed_row", "repeats", "run_train")} == dict.fromkeys(
        (*names, "missed_row", "repeats", "run_train"), 1
    )


@pytest.mark.verify
@pytest.mark.parametrize(
    ("case", "band", "begun"), [("li-ma-2019", True, 1), ("li-ma-2019", False, 0), ("jesd22-b111-b", True, 0)]
)
def test_only_a_band_by_the_fast_run_has_it_compiled(monkeypatch, case, band, begun):
    asked = []

    def noted():
        asked.append(case)
        return fast_run_beside()

    monkeypatch.setattr(fast_run, "fast_run_beside", noted)
    run_case(load_case(case), band=band)
    assert len(asked) == begun


@pytest.mark.verify
def test_a_cold_run_takes_the_fast_run_from_the_second_process(tmp_path, environment):
    """The first process compiles none of it, and counts it all the same."""
    if len(os.sched_getaffinity(0) if hasattr(os, "sched_getaffinity") else range(os.cpu_count() or 1)) < 2:
        pytest.skip("one core: nothing is compiled beside")
    run = subprocess.run(
        [sys.executable, "-c", COLD],
        env={**environment, "NUMBA_CACHE_DIR": str(tmp_path)},
        capture_output=True,
        text=True,
        check=True,
    )
    mine, counted, *of_the_fast_run = run.stdout.split()
    assert of_the_fast_run == []
    assert 0 < int(mine) < int(counted)
    assert len(list(tmp_path.rglob("*_integrator.advance-*.nbc"))) == 1
