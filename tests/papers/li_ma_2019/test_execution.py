"""Runs of elements that are stopped go on where they were, and end as if they had not been."""

import numpy as np
import pytest

from strikewave import load_case
from strikewave.fem import solve
from strikewave.papers.li_ma_2019.runs import executing
from strikewave.studies.engine.evaluation import run_key
from strikewave.studies.engine.store import RunStore

CASE = load_case("two-bars-fem", ["fem.duration=20 us"])


@pytest.mark.verify
def test_a_stopped_run_of_elements_goes_on_bit_for_bit(monkeypatch):
    monkeypatch.setattr(solve, "REPORT", 0.0)  # told of each instant

    def until_half(share, _):
        if share > 0.5:
            raise KeyboardInterrupt

    shares = []
    with RunStore(None) as store:
        with executing(store, report=until_half) as stopped, pytest.raises(KeyboardInterrupt):
            stopped.elements(CASE)
        assert store.state(run_key(CASE, "elements")).is_file()
        assert not store.empty
        with executing(store, report=lambda share, _: shares.append(share)) as goes_on:
            late = goes_on.elements(CASE)
        with executing(store, report=lambda share, _: None) as other:  # another case is another state
            assert other.elements(load_case("two-bars-fem", ["fem.duration=10 us"])).run.time[-1] < late.run.time[-1]
    with executing() as execution:
        whole = execution.elements(CASE)
    assert min(share for share in shares if share > 0.0) >= 0.25  # what was kept is not run again
    assert np.array_equal(late.run.time, whole.run.time)
    for name, force in whole.run.force.items():
        assert np.array_equal(late.run.force[name], force)


def test_a_state_that_is_damaged_is_begun_anew():
    case = load_case("two-bars-fem", ["fem.duration=5 us"])
    with RunStore(None) as store, executing(store) as execution:
        state = store.state(run_key(case, "elements"))
        state.write_bytes(b"no state")
        assert execution.elements(case).run.time[-1] == pytest.approx(5e-6)
