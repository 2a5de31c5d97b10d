"""Blows planted in noise, offset, drift, ringing and clipping, against what is found in them."""

import numpy as np
import planted_bench
import pytest


@pytest.fixture(scope="module", params=[60, pytest.param(200, marks=pytest.mark.verify)])
def tallies(request):
    # a seed of its own, not that of the table in the docs
    return planted_bench.tallied(seed=7_001, count=request.param)


def total(tallies, name, lowest=0):
    return sum(getattr(tally, name) for (band, _), tally in tallies.items() if band[0] >= lowest)


@pytest.mark.verify
def test_every_blow_that_stands_15_db_out_of_the_noise_is_found(tallies):
    planted = total(tallies, "planted", 15)
    assert planted > 200
    assert total(tallies, "found", 15) >= 0.995 * planted


def test_at_most_one_found_blow_in_a_hundred_is_false(tallies):
    assert total(tallies, "false") <= 0.01 * total(tallies, "found")


def test_clipping_is_told_where_it_was_planted_and_only_there(tallies):
    assert total(tallies, "clipped") >= 3
    assert total(tallies, "flagged") == total(tallies, "clipped")
    assert total(tallies, "wrongly") == 0


def test_without_ringing_the_bias_of_figures_is_below_the_noise_or_one_percent(tallies):
    for (band, ringing), tally in tallies.items():
        if not ringing and band[0] >= 25 and len(tally.errors["peak"]) > 20:
            bound = max(0.01, 10 ** (-band[0] / 20))  # at 25 dB a sharp tip drowns in noise of 6 %
            for name in ("peak", "width", "velocity_change"):
                assert abs(tally.spread(name)[0]) < bound, (band, name)


def test_ringing_frequency_is_found_to_one_percent(tallies):
    for (band, ringing), tally in tallies.items():
        if ringing and band[0] >= 25:
            bias, spread = tally.spread("ringing frequency")
            assert abs(bias) < 0.01
            assert spread < 0.01


def test_noise_alone_holds_no_blow(rng):
    from strikewave.records import find_pulses

    found = sum(bool(find_pulses(rng.normal(size=20_000), 5e-6)) for _ in range(100))
    assert found <= 5  # one in a hundred is allowed; more than 5 has a chance of 5e-4


def test_the_finder_takes_any_unit_offset_and_sign():
    import planted

    from strikewave.records import find_pulses

    record = planted.plant(np.random.default_rng(3))
    step = record.time[1]
    plain = find_pulses(record.values, step)
    turned = find_pulses(-1e6 * record.values + 1e9, step)
    assert len(plain) == len(turned) > 0
    for one, other in zip(plain, turned, strict=True):
        assert other.peak == pytest.approx(-1e6 * one.peak, rel=1e-6)
        assert other.width == pytest.approx(one.width, rel=1e-6)
