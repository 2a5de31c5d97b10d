"""Files judged against their siblings: no blow, another gain, outliers; what they would do is stated."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from strikewave.base.constants import STANDARD_GRAVITY
from strikewave.records import Channel, Record, Request, compare, read_file, summed

STEP, LENGTH, SIZE, G = 1e-5, 100e-6, 10_000, STANDARD_GRAVITY
"""10 us, a record of 0.1 s."""


def file_of(name, values):
    return read_file(Record(name, "text", (Channel("c", values, STEP, unit="g"),)), {}, Request())


def shot(peak, seed, gain=1.0, noise=2.0, length=20 * LENGTH):
    time = STEP * np.arange(SIZE)
    u = (time - 0.02) / length
    blow = np.where((u > 0.0) & (u < 1.0), peak * np.sin(np.pi * u), 0.0)
    return gain * (blow + noise * np.random.default_rng(seed).normal(size=SIZE))


def blips(seed, period=1.0 / 60.0, height=30.0):
    time = STEP * np.arange(SIZE)
    phase = (time - 0.005) % period
    return height * np.exp(-0.5 * ((phase - 0.004) / 3e-4) ** 2) + 2.0 * np.random.default_rng(seed).normal(size=SIZE)


def scattered(count, mean=1500.0, cv=0.02, seed=5):
    return mean * (1.0 + cv * np.random.default_rng(seed).normal(size=count))


def codes(file):
    return [finding.code for finding in file.channels[0].findings]


@pytest.mark.verify
def test_files_that_hold_only_mains_stay_without_a_blow():
    """40 shots of 4660 g among 11 files with a 30 g blip each 1/60 s."""
    peaks = scattered(40, 4660.0, 0.027)
    files = [file_of(f"shot{k}", shot(peak, k)) for k, peak in enumerate(peaks)]
    files += [file_of(f"empty{k}", blips(100 + k)) for k in range(11)]
    files = compare(files)
    campaign = summed(files)
    assert [file.status for file in files[40:]] == ["bad"] * 11
    assert all(not file.channels[0].pulses for file in files[40:])
    assert [path for path, _, _ in campaign.left_out] == [f"empty{k}" for k in range(11)]
    one = campaign.statistics["peak"]
    assert one.n == 40
    assert one.mean / G == pytest.approx(np.mean(peaks), rel=5e-3)
    assert one.cv == pytest.approx(np.std(peaks, ddof=1) / np.mean(peaks), rel=0.05)
    assert "interval" not in campaign.statistics


@pytest.mark.verify
def test_files_of_mains_are_known_where_they_are_most():
    files = [file_of(f"shot{k}", shot(4660.0 + 50.0 * k, k)) for k in range(4)]
    files += [file_of(f"empty{k}", blips(100 + k)) for k in range(9)]
    campaign = summed(compare(files))
    assert campaign.statistics["peak"].n == 4


@pytest.mark.parametrize("count", [4, 5, 12])
def test_a_file_at_half_the_gain_is_named_and_what_it_would_do_is_stated(count):
    peaks = scattered(count)
    files = [file_of(f"shot{k}", shot(peak, k, gain=0.48 if k == 2 else 1.0)) for k, peak in enumerate(peaks)]
    files = compare(files)
    campaign = summed(files)
    assert codes(files[2]) == ["gain-differs"]
    assert "1/2 of" in files[2].reasons[0]
    assert [file.status for k, file in enumerate(files) if k != 2] == ["good"] * (count - 1)
    others = np.delete(peaks, 2)
    assert campaign.statistics["peak"].mean / G == pytest.approx(others.mean(), rel=5e-3)
    assert campaign.statistics["width"].n == count
    odd = next(outlier for outlier in campaign.outliers if outlier.figure == "peak")
    assert odd.path == "shot2"
    assert odd.value / G == pytest.approx(0.48 * peaks[2], rel=0.01)
    with_it = np.append(others, 0.48 * peaks[2])
    assert odd.mean_with / G == pytest.approx(with_it.mean(), rel=5e-3)
    assert odd.cv_with == pytest.approx(with_it.std(ddof=1) / with_it.mean(), rel=0.02)
    assert {outlier.figure for outlier in campaign.outliers} == {"peak", "velocity_change"}
    assert not campaign.trends["peak"].significant


@pytest.mark.parametrize(
    ("gain", "words"),
    [(2.0, "2 times"), (10.0, "10 times"), (0.1, "1/10 of"), (9.80665, "m/s^2 taken for g"), (1e-3, "another unit")],
)
def test_factors_of_a_gain_or_a_unit_are_named(gain, words):
    files = [file_of(f"shot{k}", shot(peak, k, gain if k == 1 else 1.0)) for k, peak in enumerate(scattered(6))]
    files = compare(files)
    assert codes(files[1]) == ["gain-differs"]
    assert words in files[1].reasons[0]
    assert summed(files).statistics["peak"].n == 5


def test_a_softer_blow_of_half_the_peak_is_no_gain():
    """Half the peak, 1.4 times the width: among three no file is the odd one; among ten it is an outlier."""
    for count, expected in ((3, []), (10, ["outlier", "outlier"])):
        files = [file_of(f"shot{k}", shot(peak, k)) for k, peak in enumerate(scattered(count - 1))]
        files = compare([*files, file_of("soft", shot(750.0, 99, length=28 * LENGTH))])
        assert codes(files[-1])[: len(expected)] == expected
        assert "gain-differs" not in codes(files[-1])


def test_an_outlier_without_a_factor_is_named_with_its_distance():
    peaks = scattered(20)
    files = [file_of(f"shot{k}", shot(1.3 * peak if k == 7 else peak, k)) for k, peak in enumerate(peaks)]
    files = compare(files)
    assert codes(files[7])[0] == "outlier"
    assert "standard deviations above" in files[7].reasons[0]
    campaign = summed(files)
    assert campaign.statistics["peak"].n == 19
    assert campaign.outliers[0].ratio == pytest.approx(1.3 * peaks[7] / np.median(np.delete(peaks, 7)), rel=0.01)


def test_a_campaign_that_is_stepped_on_purpose_keeps_all_its_files():
    peaks = [500.0] * 4 + [1000.0] * 4 + [2000.0] * 4
    files = compare([file_of(f"shot{k}", shot(peak, k, length=(20 - k) * LENGTH)) for k, peak in enumerate(peaks)])
    assert summed(files).statistics["peak"].n == 12


@pytest.mark.verify
@settings(derandomize=True, max_examples=12, deadline=None)
@given(count=st.integers(5, 12), cv=st.floats(0.002, 0.08), seed=st.integers(0, 2**16))
def test_the_order_of_files_changes_no_statistic_but_the_trend(count, cv, seed):
    peaks = scattered(count, cv=cv, seed=seed)
    files = [file_of(f"shot{k}", shot(peak, k)) for k, peak in enumerate(peaks)]
    plain, turned = summed(compare(files)), summed(compare(files[::-1]))
    for name, one in plain.statistics.items():
        assert vars(turned.statistics[name]) == pytest.approx(vars(one), rel=1e-9, nan_ok=True)
    assert {outlier.path for outlier in plain.outliers} == {outlier.path for outlier in turned.outliers}


def named(files, code):
    return [k for k, file in enumerate(files) if code in codes(file)]


def test_copies_of_a_record_beside_another_are_summed_up():
    """Five of one scatter by nothing: their scatter says nothing of how far off the sixth is."""
    files = compare([*[file_of(f"copy{k}", shot(1500.0, 1)) for k in range(5)], file_of("other", shot(1535.0, 2))])
    assert {file.status for file in files} == {"good"}
    assert named(files, "copy") == [1, 2, 3, 4]
    (message,) = (one.message for one in files[4].all_findings if one.code == "copy")
    assert message.startswith('its samples are those of file 1, "copy0": ')
    peaks = summed(files).statistics["peak"]
    assert peaks.n == 6
    assert peaks.mean / G == pytest.approx((5 * 1500.0 + 1535.0) / 6, rel=3e-3)


def test_as_many_records_to_one_side_as_to_the_other_have_no_usual_peak():
    """The median of a peak and of its negative is zero."""
    files = compare([file_of(f"f{k}", sign * shot(1500.0, 1)) for k, sign in enumerate((1.0, -1.0, 1.0))])
    assert named(files, "polarity-differs") == [1]
    assert summed(files).statistics["peak"].n == 2


def test_a_small_train_of_short_blows_in_the_period_of_the_mains_is_no_blip_of_it():
    """200 us at a quarter of the usual peak: no blip of the mains is so short."""
    time = STEP * np.arange(SIZE)

    def train(peak, seed):
        u = (time[:, None] - 5e-3 - 20e-3 * np.arange(5)) / (2.0 * LENGTH)
        blows = np.sum(np.where((u > 0.0) & (u < 1.0), peak * np.sin(np.pi * u), 0.0), axis=1)
        return blows + np.random.default_rng(seed).normal(size=SIZE)

    files = compare([file_of(f"f{k}", train(peak, k)) for k, peak in enumerate((1500.0, 1540.0, 1480.0, 370.0))])
    assert not named(files, "no-pulse")
    assert not named(files, "mains")
