"""Figures of a record follow its units: another unit of values or of time, a later begin, or the other sign change them
as they must, and nothing else. A power of two is exact in floating point; what is left is that of logarithms."""

import dataclasses
import math

import numpy as np
import pytest

from strikewave.records import find_pulses
from strikewave.records.health import examine
from strikewave.records.health.sampled_record import BlowRecord
from strikewave.records.response import decaying_modes
from strikewave.records.two_sensors import paired_motion

STEP = 2e-6
TIME = STEP * np.arange(6000)


def ringing_blows():
    """Two blows that ring, the first with a rebound, in noise, with a shift of the zero after them."""
    rng = np.random.default_rng(5)
    values = 0.01 * rng.normal(size=TIME.size) + 0.2
    for begin, peak in ((2e-3, 10.0), (7e-3, 9.0)):
        u = (TIME - begin) / 200e-6
        since = np.maximum(TIME - begin, 0.0)
        values += np.where((u > 0) & (u < 1), peak * np.sin(np.pi * np.clip(u, 0, 1)), 0.0)
        values += 0.4 * peak * np.exp(-since / 200e-6) * np.sin(2.0 * np.pi * 21e3 * since)
    u = (TIME - 4e-3) / 200e-6
    values += np.where((u > 0) & (u < 1), 3.0 * np.sin(np.pi * np.clip(u, 0, 1)), 0.0)
    return values


DIMENSIONS = {
    **dict.fromkeys(("peak", "offset", "noise", "peak_uncertainty", "level", "wander", "ripple"), (1, 0)),
    **dict.fromkeys(("rise", "width", "length", "width_uncertainty", "step"), (0, 1)),
    **dict.fromkeys(("velocity_change", "velocity_change_uncertainty"), (1, 1)),
    **dict.fromkeys(("ringing_frequency", "frequency", "cutoff", "lowest_mode"), (0, -1)),
    "slope": (1, 0),
}
"""Powers of the units of values and of time; others have none, and places in time follow the begin, too."""
PLACES = ("time", "begin", "end")
SIGNED = ("peak", "offset", "velocity_change", "level", "slope")


def figures_of(one, path=""):
    """Return all numbers of a blow by their names, with those of what it holds."""
    found = {}
    fields = (
        one._asdict() if hasattr(one, "_asdict") else {f.name: getattr(one, f.name) for f in dataclasses.fields(one)}
    )
    for name, value in fields.items():
        if hasattr(value, "_asdict") or dataclasses.is_dataclass(value):
            found |= figures_of(value, f"{path}{name}.")
        elif isinstance(value, float):
            found[f"{path}{name}"] = value
        elif isinstance(value, tuple):
            for k, inner in enumerate(value):
                found |= figures_of(inner, f"{path}{name}{k}.")
        elif not isinstance(value, np.ndarray):
            found[f"{path}{name}"] = value
    return found


@pytest.fixture(scope="module")
def plain():
    return find_pulses(ringing_blows(), STEP)


@pytest.mark.parametrize(
    ("value", "unit", "later"),
    [(2.0**-20, 1.0, 0.0), (1024.0, 1.0, 0.0), (-1.0, 1.0, 0.0), (1.0, 2.0**-9, 0.0), (1.0, 1.0, 0.125)],
)
def test_figures_of_blows_follow_their_units(value, unit, later, plain):
    other = find_pulses(value * ringing_blows(), unit * STEP, later)
    assert len(other) == len(plain) == 2
    for one, two in zip(plain, other, strict=True):
        before, after = figures_of(one), figures_of(two)
        assert before.keys() == after.keys()
        assert {"rigid.peak", "split.cutoff", "rebounds0.peak"} <= before.keys() or one is plain[1]
        for name, figure in before.items():
            last = name.split(".")[-1]
            if not isinstance(figure, float):
                assert after[name] == figure, name
                continue
            if name.startswith("uncertainty."):
                power = {"peak": (1, 0), "width": (0, 1), "velocity_change": (1, 1)}[last]
                expected = abs(value) ** power[0] * unit ** power[1] * figure
            elif last in PLACES:
                expected = unit * figure + later
            else:
                size, time = DIMENSIONS.get(last, (0, 0))
                sign = math.copysign(1.0, value) if last in SIGNED else 1.0
                expected = sign * abs(value) ** size * unit**time * figure
            assert after[name] == pytest.approx(
                expected, rel=1e-5, abs=1e-12 if last in PLACES else 0.0, nan_ok=True
            ), name


def test_what_is_wrong_does_not_hang_on_the_unit(plain):
    found = [
        examine(
            BlowRecord(
                value * ringing_blows(), STEP * unit, pulses=tuple(find_pulses(value * ringing_blows(), STEP * unit))
            )
        )
        for value, unit in ((1.0, 1.0), (2.0**-20, 1.0), (1.0, 2.0**-9))
    ]
    assert found[0]
    for other in found[1:]:
        assert [(one.code, one.severity, one.harms) for one in other] == [
            (one.code, one.severity, one.harms) for one in found[0]
        ]


def test_modes_follow_their_units():
    rng = np.random.default_rng(3)
    t = STEP * np.arange(1500)
    values = np.exp(-t / 4e-4) * np.cos(2e4 * np.pi * t) + 0.5 * np.exp(-t / 8e-4) * np.sin(6e4 * np.pi * t)
    values += 0.01 * rng.normal(size=t.size)
    one, other = decaying_modes(values, STEP), decaying_modes(2.0**-20 * values, STEP / 512.0)
    assert len(one) == len(other) == 2
    for a, b in zip(one, other, strict=True):
        expected = (512.0 * a.frequency, a.damping, 2.0**-20 * a.amplitude, 512.0 * a.frequency_uncertainty)
        assert dataclasses.astuple(b) == pytest.approx((*expected, a.damping_uncertainty), rel=1e-6)
        assert b.decay_time == pytest.approx(a.decay_time / 512.0, rel=1e-6)


def test_two_sensors_follow_their_units(plain):
    first = ringing_blows()
    second = 0.8 * np.roll(first, 3) + 0.01 * np.random.default_rng(9).normal(size=first.size)
    one = paired_motion(first, second, STEP, plain)
    small = 2.0**-20
    other = paired_motion(small * first, small * second, STEP / 32.0, find_pulses(small * first, STEP / 32.0))
    later = paired_motion(first, second, STEP, find_pulses(first, STEP, 0.125), 0.125)
    for found, value, unit in ((other, small, 1.0 / 32.0), (later, 1.0, 1.0)):
        for name in ("delay", "delay_uncertainty", "peak_lag"):
            assert getattr(found, name) == pytest.approx(unit * getattr(one, name), rel=1e-5), name
        for name in ("gain", "gain_uncertainty", "explained", "differential_share"):
            assert getattr(found, name) == pytest.approx(getattr(one, name), rel=1e-5), name
        for name in ("common_uncertainty", "differential_peak", "differential_in_band"):
            assert getattr(found, name) == pytest.approx(value * getattr(one, name), rel=1e-5), name
        assert (found.blows, found.leads, found.one_body) == (one.blows, one.leads, one.one_body)
        assert found.transfer.frequency == pytest.approx(one.transfer.frequency / unit)
        for name in ("h1", "h2", "coherence", "uncertainty"):
            assert getattr(found.transfer, name) == pytest.approx(getattr(one.transfer, name), rel=1e-4), name
        assert np.array(found.transfer.trusted) == pytest.approx(np.array(one.transfer.trusted) / unit, nan_ok=True)
    assert one.delay == pytest.approx(3.0 * STEP, rel=0.01)
    assert one.gain == pytest.approx(0.8, rel=0.01)
