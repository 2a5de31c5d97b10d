"""Readings: any samples go through without a crash, a warning or a long wait; real records keep what was published."""

import json
import math
import shutil
import warnings
from pathlib import Path

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from strikewave.analyses.record.result import record_result
from strikewave.base.errors import InputError
from strikewave.records import (
    Channel,
    Record,
    Request,
    calibrations_beside,
    compare,
    find_pulses,
    read_file,
    read_record,
    summed,
)
from strikewave.signal.filters import Filter

STEP = 1e-6
SHAPES = ("constant", "spike", "alternating", "step", "steps", "noise", "ramp", "coarse", "sparse", "chirp", "pulse")


@st.composite
def histories(draw, scales):
    """Finite arrays of 16 to 3000 samples: the shapes that break things, at any scale, and arbitrary floats."""
    if draw(st.integers(0, 5)) == 0:
        largest = max(scales)
        return draw(arrays.arrays(float, st.integers(16, 200), elements=st.floats(-largest, largest)))
    size, shape = draw(st.integers(16, 3000)), draw(st.sampled_from(SHAPES))
    rng, k = np.random.default_rng(draw(st.integers(0, 2**32))), np.arange(size)
    at = draw(st.integers(0, size - 1))
    made = {
        "constant": lambda: np.ones(size),
        "spike": lambda: 1.0 * (k == at),
        "alternating": lambda: (-1.0) ** k * np.exp(-k / (1.0 + at)),
        "step": lambda: 1.0 * (k >= at),
        "steps": lambda: (k // (1 + at)) % 2.0,
        "noise": lambda: rng.normal(size=size) / 6.0,
        "ramp": lambda: k / size,
        "coarse": lambda: np.round(rng.normal(size=size)) / 6.0,
        "sparse": lambda: rng.uniform(-1.0, 1.0, size) * (rng.uniform(size=size) < 0.05),
        "chirp": lambda: np.sin(k**1.5 / 50.0),
        "pulse": lambda: np.sin(np.pi * np.clip((k - at) / draw(st.integers(3, max(size // 5, 4))), 0.0, 1.0)),
    }[shape]()
    return draw(st.sampled_from([1.0, -1.0])) * draw(st.sampled_from(scales)) * np.clip(made, -1.0, 1.0)


def read(values, request=None, unit="g", step=STEP):
    return read_file(Record("shot", "text", (Channel("board", values, step, unit=unit),)), {}, request or Request())


def warmed():
    """Compile what is compiled once."""
    read(half_sine())


def half_sine(peak=1000.0, size=4000, length=100, begin=1500.3):
    u = (np.arange(size) - begin) / length
    noise = 1e-3 * peak * np.random.default_rng(1).normal(size=size)
    return np.where((u > 0.0) & (u < 1.0), peak * np.sin(np.pi * u), 0.0) + noise


@pytest.mark.verify
@settings(max_examples=150)
@given(histories(scales=(5e-324, 1e-310, 1e-160, 1e-9, 1.0, 1e20, 1e29, 1e31, 1e160, 1e300, 1.7e308)))
def test_any_samples_give_a_reading_without_a_warning(values):
    warmed()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        file = read(values)
    [reading] = file.channels
    assert file.status in ("good", "suspect", "bad")
    assert all(finding.message for finding in reading.findings)
    assert np.all(np.isfinite(reading.channel.values)) or file.status == "bad"
    json.dumps(record_result([file]).document(), allow_nan=False)


@pytest.mark.verify
@settings(max_examples=100)
@given(histories(scales=(1e-9, 1.0, 1e20)))
def test_any_samples_that_bend_give_pulses_without_a_warning(values):
    straight = np.linspace(values[0], values[-1], values.size)
    assume(np.max(np.abs(values - straight)) > 1e-6 * np.max(np.abs(values)))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for pulse in find_pulses(values, STEP):
            assert math.isfinite(pulse.time)
            assert math.isfinite(pulse.peak)
            assert pulse.begin < pulse.end


@pytest.mark.verify
@settings(max_examples=40)
@given(
    histories(scales=(1.0,)),
    st.lists(st.tuples(st.integers(0, 2999), st.sampled_from([math.nan, math.inf, -math.inf, 9.9e37])), max_size=20),
)
def test_any_samples_with_holes_and_a_filter_give_a_reading(values, holes):
    for place, what in holes:
        values[place % values.size] = what
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        file = read(values, Request(filter=Filter(50e3)))
    json.dumps(record_result([file], [], Filter(50e3)).document(), allow_nan=False)


@pytest.mark.parametrize("size", [0, 1, 2, 15])
def test_too_few_samples_are_bad_and_say_so(size):
    [reading] = read(np.ones(size)).channels
    assert [(f.code, f.severity) for f in reading.findings] == [("too-short", "bad")]


def test_a_record_without_a_number_is_bad():
    [reading] = read(np.full(100, math.nan)).channels
    assert [(f.code, f.severity) for f in reading.findings] == [("not-a-number", "bad")]


def test_a_reading_is_in_si_and_of_the_channel_asked_for():
    record = Record(
        "shot",
        "text",
        (Channel("board", half_sine(), STEP, unit="g"), Channel("frame", half_sine(50.0), STEP, unit="kN")),
    )
    both = read_file(record, {}, Request()).channels
    assert [(r.channel.name, r.number, r.channel.unit) for r in both] == [("board", 1, "m/s^2"), ("frame", 2, "N")]
    assert both[0].pulses[0].peak == pytest.approx(9806.65, rel=0.01)
    assert both[1].pulses[0].peak == pytest.approx(50e3, rel=0.01)
    for wanted in ("frame", "2"):
        [reading] = read_file(record, {}, Request((wanted,))).channels
        assert (reading.channel.name, reading.number) == ("frame", 2)


def test_a_channel_that_is_not_there_is_refused_with_the_nearest():
    record = Record("shot", "text", (Channel("board", half_sine(), STEP),))
    for wanted, said in (("bord", "board"), ("2", "from 1 to 1"), ("0", "from 1 to 1")):
        with pytest.raises(InputError, match=f"--channel.*{said}"):
            read_file(record, {}, Request((wanted,)))


def test_a_filter_is_applied_before_measuring_and_the_blows_before_it_are_kept():
    values = half_sine()
    [reading] = read(values, Request(filter=Filter(5e3)), unit="m/s^2").channels
    assert reading.unfiltered[0].peak == pytest.approx(1000.0, rel=0.01)
    assert reading.pulses[0].peak < reading.unfiltered[0].peak
    assert len(reading.pulses) == 1


def test_a_filter_beyond_the_record_is_refused():
    with pytest.raises(InputError, match="half the sampling rate"):
        read(half_sine(), Request(filter=Filter(0.6 / STEP)))


def test_a_blow_is_the_same_in_another_sign_start_and_scale():
    [plain] = read(half_sine(), unit="").channels[0].pulses
    [other] = read(-3.0 * half_sine(), unit="").channels[0].pulses
    assert other.peak == pytest.approx(-3.0 * plain.peak)
    assert other.width == pytest.approx(plain.width)
    late = Record("shot", "text", (Channel("board", half_sine(), STEP, start=5.0),))
    [moved] = read_file(late, {}, Request()).channels[0].pulses
    assert moved.time == pytest.approx(5.0 + plain.time)


@pytest.fixture(scope="module")
def impacts(measured):
    """Published records of 50 consecutive shocks: "about 5 000 g, 190 us"; the first two before the sensor settled."""
    return [read_record(file) for file in sorted(measured("smd-5kg-impacts").glob("*.lvm"))]


def first_channels(records):
    return compare([read_file(record, {}, Request(("1",))) for record in records])


def replaced(record, values, path):
    channel = record.channels[0]
    stamps = None if channel.stamps is None else channel.stamps[: values.size]
    return Record(
        path, record.format, (Channel(channel.name, values, channel.step, channel.start, channel.unit, stamps),)
    )


def test_published_impacts_have_their_published_figures(impacts):
    files = first_channels(impacts)
    campaign = summed(files)
    assert [file.status for file in files] == ["bad"] * 2 + ["good"] * 14
    assert campaign.statistics["peak"].mean == pytest.approx(5000.0, rel=0.1)
    assert campaign.statistics["width"].mean == pytest.approx(190e-6, rel=0.1)
    assert campaign.statistics["peak"].n == campaign.statistics["width"].n == 14
    assert [Path(path).name for path, _, _ in campaign.left_out] == ["impact_00.lvm", "impact_01.lvm"]


@pytest.mark.verify
def test_published_impacts_renamed_and_shuffled_are_the_same(impacts, rng, tmp_path):
    order = rng.permutation(len(impacts))
    moved = []
    for k, place in enumerate(order):
        shutil.copy(impacts[place].path, tmp_path / f"x{k:02}.dat")
        moved.append(read_record(tmp_path / f"x{k:02}.dat"))
    assert calibrations_beside(tmp_path / "x00.dat") == {}
    files, again = first_channels(impacts), first_channels(moved)
    assert [file.status for file in again] == [files[place].status for place in order]
    one, two = summed(files), summed(again)
    for name, found in one.statistics.items():
        assert vars(two.statistics[name]) == pytest.approx(vars(found), rel=1e-9, nan_ok=True), name


@pytest.mark.verify
def test_published_impacts_cut_turned_and_clipped_are_named(impacts):
    records = list(impacts)
    values = [record.channels[0].values for record in records]
    changed = {
        4: values[4][: values[4].size // 2],
        7: -values[7],
        9: np.minimum(values[9] - np.median(values[9]), 4000.0),
    }
    for k, made in changed.items():
        records[k] = replaced(records[k], made, f"changed{k}")
    files = first_channels(records)
    assert [k for k, file in enumerate(files) if file.status != "good"] == [0, 1, 4, 7, 9]
    said = {k: " ".join(files[k].reasons) for k in changed}
    assert "cut" in said[4]
    assert "other sign" in said[7]
    assert "clipped at 4000" in said[9]
    campaign = summed(files)
    assert {Path(path).name for path, _, _ in campaign.left_out} == {
        "impact_00.lvm",
        "impact_01.lvm",
        "changed7",
        "changed9",
    }
    assert campaign.statistics["peak"].mean == pytest.approx(5000.0, rel=0.1)
