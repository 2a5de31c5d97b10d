"""A run of any length takes bounded memory: what is dropped of it is integrated again where it is asked for."""

import dataclasses
import itertools

import numpy as np
import pytest

from strikewave import load_case
from strikewave.analyses.machine.build import build_machine
from strikewave.analyses.machine.observe import observe
from strikewave.contact import motion
from strikewave.machines import blows, run_machine


def run_of(count):
    return run_machine(build_machine(load_case("li-ma-2019", [f"feed.blows={count}", "solver.output_step=100 us"])))


def test_what_was_dropped_comes_back_to_the_bit(monkeypatch):
    whole = run_of(4)
    monkeypatch.setattr(motion, "_KEPT_BYTES", 0)
    monkeypatch.setattr(motion, "_RECENT", 2)
    dropped = run_of(4)
    kept, again = (run.spans[0].motion for run in (whole, dropped))
    chance = np.random.default_rng(1)
    times = np.append(chance.uniform(0.0, whole.end, 500), kept.changes.time)
    for first, second in zip(kept.sample(times), again.sample(times), strict=True):
        np.testing.assert_array_equal(first, second)
    assert [dataclasses.astuple(blow) for blow in blows(whole)] == [
        dataclasses.astuple(blow) for blow in blows(dropped)
    ]
    np.testing.assert_array_equal(kept.impulses(0.0, kept.end.time), again.impulses(0.0, kept.end.time))


def test_impulses_of_a_part_add_up_to_those_of_the_whole():
    run = run_of(2)
    followed = run.spans[0].motion
    edges = np.unique(np.concatenate([[0.0], followed.switched.time, [followed.end.time]]))
    parts = [followed.impulses(*pair) for pair in itertools.pairwise(edges)]
    whole = followed.impulses(0.0, followed.end.time)
    np.testing.assert_allclose(np.sum(parts, axis=0), whole, rtol=1e-12, atol=1e-12 * np.abs(whole).max())


def test_an_object_without_taps_keeps_no_more_of_a_blow_than_what_sensors_read():
    seen = observe(load_case("li-ma-2019", ["feed.blows=1"]))
    assert not seen.taps
    assert all(history.since.size == history.rigid.size == 0 for history in seen.histories if history is not None)


@pytest.mark.verify
def test_a_thousand_blows_take_no_more_memory_than_two_hundred():
    short, long = run_of(200), run_of(1000)
    assert len(long.contacts()) >= 1000
    bound = motion._KEPT_BYTES
    assert bound < short.spans[0].motion.nbytes < 1.02 * bound  # one stretch, checkpoints and switches beyond
    assert long.spans[0].motion.nbytes < 1.1 * bound
    last = long.span_at(long.end).sample(np.linspace(long.end - 0.01, long.end, 200))
    assert np.isfinite(last.assembly_place).all()
    assert long.spans[0].motion.nbytes < 1.2 * bound
    assert long.energy_error < 1e-6
