"""Campaigns: statistics against closed forms and by simulation; faulty files named, and left out of what they harm."""

import dataclasses
import math

import numpy as np
import pytest
import scipy.stats

from strikewave.records import Channel, FileReading, Record, Request, compare, read_file, summed, unreadable
from strikewave.records.campaign import SUMMED, statistic, trend

STEP, LENGTH, SIZE = 1e-6, 100, 5000


def values_of(peak, seed=1, blows=1):
    k = np.arange(SIZE)
    values = 0.5 * np.random.default_rng(seed).normal(size=SIZE)
    for number in range(blows):
        u = (k - 1000.3 - 1500 * number) / LENGTH
        values += np.where((u > 0.0) & (u < 1.0), peak * np.sin(np.pi * u), 0.0)
    return values


def file_of(name, *channels, step=STEP):
    made = tuple(Channel(f"c{k}", values, step, unit="m/s^2") for k, values in enumerate(channels, start=1))
    return read_file(Record(name, "text", made), {}, Request())


def campaign_of(peaks):
    return [file_of(f"shot{k}", values_of(peak, k)) for k, peak in enumerate(peaks)]


PEAKS = [900.0, 950.0, 1000.0, 1050.0, 1100.0]


def test_mean_and_bounds_are_those_of_the_t_interval():
    """t(0.975, 4) = 2.776445 (any table)."""
    sample = [9.0, 10.0, 11.0, 12.0, 13.0]
    found = statistic(sample)
    spread = math.sqrt(2.5)
    assert found.mean == 11.0
    assert found.cv == pytest.approx(spread / 11.0)
    assert (found.low, found.high) == pytest.approx(
        [11.0 + s * 2.776445 * spread / math.sqrt(5.0) for s in (-1, 1)], rel=1e-6
    )
    assert found.n == 5


def test_mean_and_bounds_are_those_of_scipy(rng):
    sample = rng.normal(100.0, 7.0, size=23)
    found = statistic(sample)
    interval = scipy.stats.t.interval(0.95, 22, sample.mean(), scipy.stats.sem(sample))
    assert (found.low, found.high) == pytest.approx(interval)
    assert found.cv == pytest.approx(scipy.stats.variation(sample, ddof=1))


def test_bounds_of_scatter_go_to_those_of_the_standard_deviation_where_it_is_small():
    """chi^2 interval of the standard deviation, for CV -> 0."""
    sample = 1.0 + 1e-6 * np.array([-2.0, -1.0, 0.0, 1.0, 2.0, 0.5])
    found = statistic(sample)
    low, high = (math.sqrt(5.0 / scipy.stats.chi2.ppf(p, 5)) * found.cv for p in (0.975, 0.025))
    assert (found.cv_low, found.cv_high) == pytest.approx((low, high), rel=1e-6)


@pytest.mark.parametrize(("n", "cv"), [(3, 0.05), (8, 0.1), (20, 0.3)])
def test_bounds_hold_the_truth_in_95_percent_of_campaigns(rng, n, cv):
    trials = 2000
    found = [statistic(rng.normal(1.0, cv, size=n)) for _ in range(trials)]
    least, most = scipy.stats.binom.ppf([0.0005, 0.9995], trials, 0.95)
    assert least <= sum(one.low <= 1.0 <= one.high for one in found) <= most
    assert least <= sum(one.cv_low <= cv <= one.cv_high for one in found) <= most


def test_blows_of_one_file_count_as_one_in_the_bounds():
    """Six blows in three files: t(0.975, 2) = 4.302653 of the means 1, 2, 3."""
    found = statistic([0.9, 1.1, 1.8, 2.2, 2.9, 3.1], files=[0, 0, 1, 1, 2, 2])
    assert (found.mean, found.n) == (pytest.approx(2.0), 6)
    assert (found.low, found.high) == pytest.approx([2.0 + s * 4.302653 / math.sqrt(3.0) for s in (-1, 1)], rel=1e-6)


def test_too_few_values_have_no_bounds():
    one = statistic([5.0])
    assert one.mean == 5.0
    assert all(math.isnan(v) for v in (one.cv, one.low, one.high))
    assert statistic([]).n == 0
    assert math.isnan(statistic([]).mean)


def test_values_that_are_all_equal_have_no_scatter():
    assert dataclasses.astuple(statistic([2.0, 2.0, 2.0])) == (2.0, 0.0, 2.0, 2.0, 3, 0.0, 0.0, 2.0, 0.0)


def test_a_mean_of_zero_has_no_relative_scatter():
    found = statistic([-1.0, 1.0])
    assert found.cv == math.inf
    assert math.isnan(found.cv_low)


def test_trend_is_that_of_scipy(rng):
    x = np.arange(12.0)
    y = 30.0 + 0.2 * x + rng.normal(size=12)
    line = scipy.stats.theilslopes(y, x)
    found = trend(x, y)
    assert found.slope == pytest.approx(line.slope)
    assert found.change == pytest.approx(11.0 * line.slope / np.median(y))
    tau = [scipy.stats.kendalltau(x, y - bound * x).pvalue for bound in (found.low - 1e-9, found.high + 1e-9)]
    assert max(tau) <= 0.05  # a slope just outside the bounds is refused by Kendall's test


def test_trend_of_four_files_has_no_bounds_and_is_not_significant():
    found = trend([0, 1, 2, 3], [1.0, 2.0, 3.0, 4.0])
    assert found.slope == 1.0
    assert math.isnan(found.low)
    assert not found.significant


def test_one_wrong_file_at_the_end_makes_no_trend():
    """Half the gain in the last of 12 files: least squares would see -17 % of the mean."""
    peaks = 1500.0 * (1.0 + 0.01 * np.random.default_rng(4).normal(size=12))
    peaks[-1] *= 0.48
    assert scipy.stats.linregress(np.arange(12), peaks).slope * 11 / peaks.mean() < -0.15
    assert abs(trend(np.arange(12), peaks).change) < 0.05


def test_a_campaign_has_the_statistics_of_its_blows():
    files = compare(campaign_of(PEAKS))
    campaign = summed(files)
    assert [file.status for file in files] == ["good"] * 5
    assert campaign.left_out == ()
    assert campaign.statistics["peak"].n == 5
    assert campaign.statistics["peak"].mean == pytest.approx(1000.0, rel=2e-3)
    assert campaign.statistics["peak"].cv == pytest.approx(np.std(PEAKS, ddof=1) / 1000.0, rel=0.02)
    width = LENGTH * STEP * (1.0 - 2.0 * math.asin(0.1) / math.pi)
    assert campaign.statistics["width"].mean == pytest.approx(width, rel=0.01)
    assert campaign.statistics["velocity_change"].mean == pytest.approx(2e3 / math.pi * LENGTH * STEP, rel=0.01)
    assert campaign.statistics["peak"].median == pytest.approx(1000.0, rel=2e-3)
    assert campaign.outliers == ()
    assert campaign.trends["peak"].slope == pytest.approx(50.0, rel=0.03)
    assert campaign.trends["peak"].change == pytest.approx(0.2, rel=0.03)


def test_renamed_and_shuffled_files_have_the_same_statistics():
    files = campaign_of(PEAKS)
    other = [file_of(f"renamed{k}", values_of(PEAKS[k], k)) for k in (3, 0, 4, 1, 2)]
    one, two = summed(compare(files)), summed(compare(other))
    for name, found in one.statistics.items():
        assert vars(two.statistics[name]) == pytest.approx(vars(found), rel=1e-12, nan_ok=True), name


def faulty(number, values):
    files = campaign_of(PEAKS)
    files[number] = file_of("faulty", values)
    files = compare(files)
    campaign = summed(files)
    [(path, figures, reason)] = campaign.left_out
    assert path == "faulty"
    return files[number], campaign, figures, reason


def test_a_file_of_the_other_sign_is_named_and_left_out_of_what_has_a_sign():
    file, campaign, figures, reason = faulty(2, -values_of(1000.0))
    assert "other sign" in reason
    assert file.status == "suspect"
    assert set(figures) == {"peak", "velocity_change"}
    assert campaign.statistics["peak"].n == campaign.statistics["velocity_change"].n == 4
    assert campaign.statistics["width"].n == 5


def test_a_clipped_file_is_bad():
    file, campaign, figures, reason = faulty(2, np.minimum(values_of(1000.0), 700.0))
    assert "clipped" in reason
    assert file.status == "bad"
    assert set(figures) == set(SUMMED)
    assert campaign.statistics["width"].n == 4


def test_a_file_cut_off_after_its_blow_is_named_and_keeps_its_blow():
    files = campaign_of(PEAKS)
    files[2] = file_of("faulty", values_of(1000.0)[: SIZE // 2])
    files = compare(files)
    assert [file.status for file in files] == ["good", "good", "suspect", "good", "good"]
    assert "cut off" in " ".join(files[2].reasons)
    assert summed(files).statistics["peak"].n == 5


def test_a_file_cut_in_its_blow_gives_no_figures():
    file, campaign, figures, _ = faulty(2, values_of(1000.0)[:1050])
    assert file.status == "suspect"
    assert {"peak", "rise", "width", "velocity_change"} <= set(figures)
    assert campaign.statistics["peak"].n == 4


def test_an_unreadable_file_is_named():
    files = [*campaign_of(PEAKS), FileReading("broken", "", (), (unreadable("FILE: broken"),))]
    campaign = summed(compare(files))
    assert campaign.left_out == (("broken", SUMMED, "FILE: broken"),)
    assert campaign.statistics["peak"].n == 5


def test_another_sampling_rate_is_said_and_harms_nothing():
    files = [*campaign_of(PEAKS), file_of("slow", values_of(1000.0)[::2], step=2 * STEP)]
    files = compare(files)
    assert [finding.code for finding in files[-1].channels[0].findings] == ["rate-differs"]
    assert files[-1].status == "good"
    assert summed(files).statistics["peak"].n == 6


def test_another_unit_is_named_and_left_out():
    other = Record("volts", "text", (Channel("c1", values_of(1000.0), STEP, unit="V"),))
    files = compare([*campaign_of(PEAKS), read_file(other, {}, Request())])
    assert "unit-differs" in [finding.code for finding in files[-1].channels[0].findings]
    assert summed(files).statistics["peak"].n == 5


def test_two_channels_are_summed_apart():
    files = compare(
        [file_of(f"shot{k}", values_of(peak, k), values_of(2.0 * peak, k + 9)) for k, peak in enumerate(PEAKS)]
    )
    one, two = summed(files, 1), summed(files, 2)
    assert (one.channel, two.channel) == ("c1", "c2")
    assert one.statistics["peak"].mean == pytest.approx(1000.0, rel=5e-3)
    assert two.statistics["peak"].mean == pytest.approx(2000.0, rel=5e-3)
    assert summed(files, 3) is None


def test_a_campaign_of_one_file_has_a_mean_and_no_bounds():
    campaign = summed(compare(campaign_of([1000.0])))
    assert campaign.statistics["peak"].n == 1
    assert campaign.statistics["peak"].mean == pytest.approx(1000.0, rel=5e-3)
    assert math.isnan(campaign.statistics["peak"].low)
    assert campaign.trends == {}


def test_a_campaign_of_one_file_with_several_blows_has_bounds_and_intervals():
    campaign = summed(compare([file_of("shot", values_of(1000.0, blows=3))]))
    assert campaign.statistics["peak"].n == 3
    assert campaign.statistics["interval"].n == 2
    assert campaign.statistics["interval"].mean == pytest.approx(1500 * STEP, rel=1e-3)
    assert campaign.trends == {}


def test_a_campaign_of_bad_files_has_nothing_but_their_names():
    files = compare([file_of(f"dead{k}", np.zeros(SIZE)) for k in range(3)])
    campaign = summed(files)
    assert campaign.statistics == campaign.trends == {}
    assert [path for path, _, _ in campaign.left_out] == ["dead0", "dead1", "dead2"]
    assert [figures for _, figures, _ in campaign.left_out] == [SUMMED] * 3


def test_no_file_is_no_campaign():
    assert summed([]) is None
    assert summed([FileReading("broken", "", (), (unreadable("broken"),))]) is None
