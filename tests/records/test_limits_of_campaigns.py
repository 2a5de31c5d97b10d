"""Files against their siblings, statistics and calibrations: each rule at both sides of its limit, on made-up readings."""

import dataclasses
import math
from types import SimpleNamespace

import numpy as np
import pytest

from strikewave.base.errors import InputError
from strikewave.base.result import INFO, WARNING
from strikewave.records import calibration, campaign, robust
from strikewave.records.calibration import ChannelCalibration, check_part, known_unit, read_calibrations
from strikewave.records.health_notice import HealthNotice

NAN = math.nan


def blow(peak=100.0, time=1.0, width=2e-3, smooth=2e-3):
    return SimpleNamespace(peak=peak, time=time, width=width, smooth=SimpleNamespace(width=lambda: smooth))


class Reading(SimpleNamespace):
    """Stands for a channel that was read: its figures are the means that are given."""

    def figures(self, name):
        return [value for value in self.given.get(name, ()) if math.isfinite(value)]


def reading(*pulses, unit="m/s^2", name="bar", step=1e-5, duration=0.5, values=None, responses=(), number=1, **given):
    given = {"peak": [one.peak for one in pulses], "width": [one.width for one in pulses]} | given
    channel = SimpleNamespace(unit=unit, name=name, step=step, duration=duration, values=values)
    return Reading(pulses=pulses, channel=channel, responses=responses, given=given, number=number)


def told(judge, readings, *more):
    return [
        (k, finding.code, finding.value, finding.severity) for k, finding in judge(list(enumerate(readings)), *more)
    ]


# No blow


@pytest.mark.parametrize(
    ("peak", "smooth", "found"),
    [
        (4.7, 2e-3, True), (4.8, 2e-3, False), (30.0, 6.1e-3, True), (30.0, 5.9e-3, False), (34.0, 6.1e-3, False), (30.0, 0.66e-3, True),
        (30.0, 0.68e-3, False),
    ],
)  # fmt: skip
def test_an_excursion_twenty_times_below_the_others_is_no_blow(peak, smooth, found):
    """Or three times below, and three times wider or narrower."""
    others = [reading(blow(100.0)), reading(blow(-90.0)), reading(blow(20.0), blow(110.0))]
    said = told(campaign._without_blow, [*others, reading(blow(-peak, smooth=smooth))])
    assert said == ([(3, "no-pulse", pytest.approx(peak / 95.0), "bad")] if found else [])


def test_files_without_a_blow_need_two_others():
    assert told(campaign._without_blow, [reading(blow(100.0)), reading(blow(1.0))]) == []
    assert told(campaign._without_blow, [reading(blow(100.0)), reading(blow(1.0)), reading()]) == []
    assert [
        k
        for k, *_ in told(
            campaign._without_blow, [reading(), reading(blow(90.0)), reading(blow(1.0)), reading(blow(95.0))]
        )
    ] == [2]


def test_what_comes_in_the_period_of_the_mains_is_no_blow_three_times_below():
    def mains(peak):
        return reading(*[blow(peak, 3e-3 + 0.02 * k, smooth=2e-3) for k in range(4)])

    others = [reading(blow(100.0)), reading(blow(102.0))]
    for peak, found in ((33.0, True), (35.0, False)):
        (*_, finding), *rest = [*campaign._without_blow(list(enumerate([*others, mains(peak)]))), (None,)]
        assert (finding is not None and "in the period of the mains" in finding.message) is found
        assert len(rest) == found
    assert (
        told(campaign._without_blow, [reading(blow(100.0)), mains(20.0), mains(21.0)]) == []
    )  # one alone tells no usual one
    found = told(campaign._without_blow, [*others, mains(30.0), mains(30.0), mains(30.0)])
    assert [one[0] for one in found] == [2, 3, 4]  # two do, however many of the mains there are


def test_a_ratio_that_a_setting_explains_is_left_to_the_gain():
    """A hundredth, of the same width: another gain, and no blow of mains."""
    others = [reading(blow(100.0)) for _ in range(3)]
    assert told(campaign._without_blow, [*others, reading(blow(1.0))]) == []
    assert told(campaign._without_blow, [*others, reading(blow(1.0, smooth=2.19e-3))]) == []
    assert len(told(campaign._without_blow, [*others, reading(blow(1.0, smooth=2.21e-3))])) == 1
    assert len(told(campaign._without_blow, [*others, reading(blow(1.06))])) == 1


# Another gain


@pytest.mark.parametrize(
    ("ratio", "scatter", "found"),
    [
        (2.0, 0.0, 2.0), (1.0 / 5.0, 0.0, 0.2), (100.0, 0.0, 100.0), (0.01, 0.0, 0.01), (10.0, 0.0, 10.0), (1000.0, 0.0, 1000.0),
        (2.0 * math.exp(0.049), 0.0, 2.0), (2.0 * math.exp(0.051), 0.0, None), (2.0 * math.exp(-0.051), 0.0, None),
        (2.0 * math.exp(0.089), 0.03, 2.0), (2.0 * math.exp(0.091), 0.03, None), (2.0 * math.exp(0.149), 0.09, 2.0),
        (2.0 * math.exp(0.151), 0.09, None), (3.0, 0.0, None),
    ],
)  # fmt: skip
def test_factors_of_settings_are_met_within_five_percent_or_the_scatter(ratio, scatter, found):
    scaled = campaign._scaled(ratio, scatter)
    assert (scaled and scaled[1]) == (found and pytest.approx(found))


PEAKS = [98.0, 100.0, 102.0, 100.0]
"""Their median deviation is 1, times 1.363 for four of them and 1.4826 of a normal distribution: 2.02."""


@pytest.mark.parametrize(
    ("peak", "width", "found"),
    [
        (200.0, 2e-3, True), (50.0, 2e-3, True), (-200.0, 2e-3, False), (200.0, 2.19e-3, True), (200.0, 2.21e-3, False), (200.0, 1.79e-3, False),
        (200.0, 1.81e-3, True), (150.0, 2e-3, False),
    ],
)  # fmt: skip
def test_a_peak_of_a_factor_and_the_same_width_is_another_gain(peak, width, found):
    files = [*(reading(blow(one)) for one in PEAKS), reading(blow(peak, width=width))]
    said = told(campaign._other_gain, files)
    assert said == ([(4, "gain-differs", pytest.approx(peak / 100.0), "suspect")] if found else [])
    beside = told(campaign._other_gain, [reading(), *files])  # one without a blow has no width
    assert [(k - 1, *rest) for k, *rest in beside] == said


def test_others_that_do_not_agree_tell_no_gain():
    """Their scatter over the median is at most a fifth; two of them have the deviation times 1.196."""
    apart = 20.0 / (1.196 * 1.4826)
    for share, found in ((0.99, 1), (1.01, 0)):
        files = [reading(blow(100.0 - share * apart)), reading(blow(100.0 + share * apart)), reading(blow(1000.0))]
        assert len([k for k, *_ in told(campaign._other_gain, files) if k == 2]) == found
    assert told(campaign._other_gain, [reading(blow(100.0)), reading(blow(200.0))]) == []
    assert (
        told(
            campaign._other_gain, [reading(blow(100.0)), reading(blow(-100.0)), reading(blow(50.0)), reading(blow(0.0))]
        )
        is not None
    )


def test_the_message_of_a_gain_says_times_or_part_of():
    def message(peak, **how):
        files = [*(reading(blow(one), **how) for one in PEAKS), reading(blow(peak), **how)]
        return next(campaign._other_gain(list(enumerate(files))))[1]

    assert (
        "its peak, 200, is about 2 times the median 100 of the other files, and its width is theirs"
        in message(200.0, unit="").message
    )
    assert "its peak, 20, is about 1/5 of the median 100" in message(20.0, unit="").message
    assert message(20.0).harms == ("peak", "velocity_change")


def response(peak, ratio, frequency=500.0):
    return {
        "responses": (SimpleNamespace(ratio=ratio),),
        "peak": [peak],
        "ratio": [ratio],
        "frequency": [frequency],
        "rms": [peak],
    }


def test_responses_are_compared_by_their_ratio_and_last_as_their_swings():
    files = [reading(**response(one, one / 50.0)) for one in PEAKS] + [reading(**response(200.0, 4.0))]
    ((k, finding),) = campaign._other_gain(list(enumerate(files)))
    assert (k, finding.harms) == (4, campaign.OF_SIZE)
    assert "its peak over that of the base, 4, is about 2 times the median 2" in finding.message
    assert campaign._lasting(files[0]) == 1.0 / 500.0
    assert campaign._lasting(reading(blow(width=3e-3), blow(width=5e-3))) == pytest.approx(4e-3)
    assert math.isnan(campaign._lasting(reading()))
    files[4] = reading(**response(200.0, 4.0, 560.0))
    assert list(campaign._other_gain(list(enumerate(files)))) == []
    assert campaign._size_name(list(enumerate([*files, reading(**response(1.0, NAN))]))) == "peak"
    assert campaign._size_name([(0, reading(blow()))]) == "peak"


# Outliers


def test_outliers_differ_by_two_percent_at_least():
    usual = [100.0, 100.01, 99.99, 100.02, 99.98, 100.0, 100.01]
    for peak, found in ((102.1, True), (101.9, False), (97.9, True)):
        said = told(campaign._outlying, [*(reading(blow(one)) for one in usual), reading(blow(peak))])
        assert [one[:3] for one in said] == ([(7, "outlier", pytest.approx(peak / 100.0))] if found else [])
    assert told(campaign._outlying, [reading(blow(one)) for one in (100.0, 100.1, 99.9, 200.0)]) == []


def test_the_message_of_an_outlier_has_its_distance_side_and_unit():
    usual = [99.0, 100.0, 101.0, 99.5, 100.5, 100.0, 99.8, 100.2, 99.3, 100.7, 100.0]
    spread = float(np.std(usual, ddof=1))

    def said(value, name="width", **how):
        files = [reading(**{name: [one * 1e-3 if name == "width" else one]}, **how) for one in [*usual, value]]
        return next(campaign._outlying(list(enumerate(files))))[1]

    found = said(105.0)
    assert found.harms == ("width",)
    assert (
        f"its width, 105\xa0ms, is an outlier: {5.0 / spread:.2g} standard deviations above the median 100\xa0ms"
        in found.message
    )
    assert "below the median" in said(95.0).message
    assert "its velocity change, 105, is" in said(105.0, "velocity_change").message
    assert "more than 100 standard" in said(100.0 + 101.0 * spread).message
    assert "99 standard" in said(100.0 + 99.0 * spread).message
    assert "its peak, 105 N, is" in said(105.0, "peak", unit="N").message


def test_outliers_of_responses_are_of_ratio_and_frequency():
    usual = [99.0, 100.0, 101.0, 99.5, 100.5, 100.0]
    files = [reading(**response(one, one / 50.0, 500.0 + one)) for one in usual]
    wrong = reading(**response(100.0, 2.4, 600.0))
    ((_, finding),) = campaign._outlying(list(enumerate([*files, wrong])))
    assert (finding.harms, finding.message.partition(",")[0]) == (campaign.OF_SIZE, "its peak over that of the base")
    ((k, finding),) = campaign._outlying(list(enumerate([reading(), *files, reading(**response(100.0, 2.0, 650.0))])))
    assert k == 7  # one that answers nothing is passed over
    assert (finding.harms, "650\xa0Hz" in finding.message) == (("frequency",), True)


@dataclasses.dataclass(frozen=True)
class Told(Reading):
    """Stands for a channel with findings, which can be replaced."""

    findings: tuple
    given: dict


def test_an_outlier_is_told_where_others_have_its_figure():
    """Peaks of 3 and 5 beside those of three others, 9, 10 and 11; no other states a width, and it no interval."""
    odd = HealthNotice(sorted(campaign.ODD)[0], "odd", harms=("peak", "width", "interval"))
    one = Told((odd, HealthNotice("rebound", "none", harms=("peak",))), {"peak": [3.0, 5.0], "width": [0.1]})
    points = {"peak": ((2, 9.0), (3, 10.0), (4, 11.0)), "interval": ((2, 1.0), (3, 2.0))}
    (found,) = campaign._outliers(7, SimpleNamespace(path="a.csv"), one, points)
    assert (found.path, found.figure, found.value, found.ratio, found.reason) == ("a.csv", "peak", 4.0, 0.4, "odd")
    assert found.mean_with == 8.5  # of the means of the four files
    assert found.cv_with == pytest.approx(np.std([9.0, 10.0, 11.0, 3.0, 5.0], ddof=1) / 8.5)


@pytest.mark.parametrize(
    ("counts", "left_out", "more"),
    [((1, 1), (), False), ((1, 2), (), True), ((), (("a", (), "b"),), True), ((), (), False)],
)
def test_a_campaign_says_more_than_one_blow_where_figures_have_several_or_files_are_left_out(counts, left_out, more):
    statistics = {str(k): campaign.statistic(np.arange(n) + 1.0) for k, n in enumerate(counts)}
    assert campaign.Campaign("c", 1, "", statistics, {}, left_out, {}).sums_up is more


def test_what_is_worth_knowing_is_a_remark_of_a_result_and_all_else_a_warning():
    for severity, told in (("good", INFO), ("suspect", WARNING), ("bad", WARNING)):
        notice = HealthNotice("clipped", "at 5 g", 3.0, severity=severity).notice
        assert (notice.code, notice.message, notice.value, notice.severity) == ("clipped", "at 5 g", 3.0, told)


# Other differences


def of_files(*readings):
    return [one[:2] for one in told(campaign._unlike_others, readings)]


def test_another_sign_needs_three_files_and_a_usual_one():
    up, down = reading(blow(100.0)), reading(blow(-100.0))
    assert of_files(up, down, up) == [(1, "polarity-differs")]
    assert of_files(down, down, up) == [(2, "polarity-differs")]
    assert of_files(up, down) == []
    assert of_files(up, down, up, down) == []
    assert of_files(up, reading(), up) == []


def test_a_shorter_record_is_one_where_most_last_as_long():
    """Three in five are within a hundredth of the median: then less than nine tenths of it is short."""
    usual = [reading(blow(), duration=d) for d in (0.5, 0.5, 0.5049)]
    for duration, short in ((0.449, True), (0.451, False)):
        assert of_files(*usual, reading(blow(), duration=duration)) == [(3, "truncated")] * short
    assert of_files(*usual, reading(blow(), duration=0.4), reading(blow(), duration=0.3)) == [
        (3, "truncated"),
        (4, "truncated"),
    ]
    assert (
        of_files(
            *usual[:2], reading(blow(), duration=0.5051), reading(blow(), duration=0.4), reading(blow(), duration=0.9)
        )
        == []
    )
    assert of_files(usual[0], reading(blow(), duration=0.3)) == []


def test_another_unit_name_or_rate_is_told():
    usual = reading(blow())
    assert of_files(usual, usual, reading(blow(), unit="N")) == [(2, "unit-differs")]
    assert of_files(usual, usual, reading(blow(), name="top")) == [(2, "name-differs")]
    assert of_files(usual, reading(blow(), name="top")) == [(1, "name-differs")]
    assert of_files(usual, reading(blow(), name="a"), reading(blow(), name="b")) == []
    for step, said in ((1.011e-5, True), (1.009e-5, False), (0.989e-5, True), (0.991e-5, False)):
        assert of_files(usual, usual, reading(blow(), step=step)) == [(2, "rate-differs")] * said
    (found,) = told(campaign._unlike_others, [usual, usual, reading(blow(), step=2e-5)])
    assert found[2] == pytest.approx(5e4)
    assert list(campaign._unlike_others([(0, usual)])) == []


def test_copies_are_named_by_the_first_of_them():
    values = np.array([1.0, 2.0, 4.0])
    files = [reading(values=one) for one in (values, values + 0.0, values[::-1], values.copy(), np.ones(3), np.ones(3))]
    found = list(campaign._copies([(k + 3, one) for k, one in enumerate(files)], [f"{k}.csv" for k in range(9)]))
    assert [(k, one.value) for k, one in found] == [(4, 4), (6, 4)]
    assert "those of file 4," in found[0][1].message


def test_a_file_without_a_blow_loses_what_was_found_of_it():
    from strikewave.records.reading import ChannelReading, FileReading
    from strikewave.records.record import Channel

    said = (
        HealthNotice("a", "", harms=("peak",)),
        HealthNotice("b", "", harms=("interval",)),
        HealthNotice("c", "", harms=("spectrum",)),
    )
    one = ChannelReading(Channel("a", np.zeros(3), 1.0), 1, (blow(),), said, ChannelCalibration())
    file = FileReading("a", "text", (one, dataclasses.replace(one, number=2)))
    found, other = campaign._with(file, 1, HealthNotice("no-pulse", "")).channels
    assert (found.pulses, [f.code for f in found.findings]) == ((), ["c", "no-pulse"])
    assert other is file.channels[1]
    assert [f.code for f in campaign._with(file, 1, HealthNotice("x", "")).channels[0].findings] == ["a", "b", "c", "x"]


def test_a_file_is_bad_by_what_was_found_on_it():
    def of(*severities):
        return SimpleNamespace(findings=[HealthNotice("a", "", severity=one) for one in severities])

    assert [campaign._file_bad(of(*one)) for one in ((), ("good", "suspect"), ("good", "bad"))] == [False, False, True]


# Statistics


def test_statistics_of_files_by_hand():
    """Three files of 1, 2 and 1 blows: means 2, 5 and 8; all blows 2, 4, 6, 8."""
    found = campaign.statistic([2.0, 4.0, 6.0, 8.0], [7, 5, 5, 9])
    t = 4.302652729911275  # Student's t of two degrees of freedom, 0.975
    assert (found.mean, found.median, found.n) == (5.0, 5.0, 4)
    assert (found.low, found.high) == (
        pytest.approx(5.0 - t * 3.0 / math.sqrt(3.0)),
        pytest.approx(5.0 + t * 3.0 / math.sqrt(3.0)),
    )
    assert found.cv == pytest.approx(math.sqrt(20.0 / 3.0) / 5.0)
    assert found.robust_cv == pytest.approx(1.363 * robust.MAD_TO_SIGMA * 2.0 / 5.0)
    assert campaign.statistic([2.0, 4.0], [3, 3]).high == campaign.statistic([2.0, 4.0]).high
    assert campaign._vangel(0.1, 5.0, 4) == pytest.approx(0.1 / math.sqrt((7.0 / 4.0 - 1.0) * 0.01 + 5.0 / 3.0))
    assert campaign._vangel(5.0, 0.01, 9) == math.inf
    assert campaign._vangel(0.1, 0.05, 6) == pytest.approx(0.1 / math.sqrt((2.05 / 6.0 - 1.0) * 0.01 + 0.01))
    assert math.isnan(campaign._vangel(math.inf, 5.0, 4))


def test_a_trend_changes_by_its_slope_over_the_files():
    found = campaign.trend([3, 3, 5, 9], [1.0, 3.0, 4.0, 8.0])  # 2 at 3, 4 at 5, 8 at 9
    assert (found.slope, found.change) == (1.0, 6.0 / 4.0)
    assert math.isnan(campaign.trend([0, 1, 2], [-1.0, 0.0, 1.0]).change)
    assert [campaign.Trend(1.0, low, high, 1.0).significant for low, high in ((0.1, 2.0), (0.0, 2.0), (-2.0, -0.1), (-1.0, 0.0), (NAN, NAN))] == [
        True, False, True, False, False,
    ]  # fmt: skip


def test_spreads_of_few_values_are_that_of_their_median_deviation():
    for n in range(2, 13):
        values = np.arange(float(n))
        factor = robust.SMALL_SAMPLE[n - 2] if n < 10 else n / (n - 0.8)
        assert robust.spread_of(values) == pytest.approx(
            factor * robust.MAD_TO_SIGMA * np.median(np.abs(values - np.median(values)))
        )


def test_one_value_in_four_may_be_an_outlier():
    sample = [1.0, 1.1, 0.9, 1.05, 0.95, 1.02, 0.98]
    assert robust.outliers([*sample, 9.0], 0.01) == [7]
    assert robust.outliers([*sample, 9.0, -9.0], 0.01) == [8, 7] or robust.outliers([*sample, 9.0, -9.0], 0.01) == [
        7,
        8,
    ]
    assert robust.outliers([1.0, 1.1, 0.9, 1.05, 9.0], 0.01) == [4]
    assert robust.outliers([1.0, 1.0, 1.0, 1.0, 1.0 + 1e-10, 9.0], 0.01) == []


@pytest.mark.parametrize(("n", "rows"), [(10, 10), (11, 6), (21, 7)])
def test_more_points_than_the_most_are_means_of_neighbours(monkeypatch, n, rows):
    """The line is that through the means of as many neighbours, by hand."""
    monkeypatch.setattr(robust, "MOST_OF_LINE", 10)
    x = 2.0 * np.arange(float(n)) + 1.0
    y = 3.0 * x + 5.0 * np.sin(x)
    size = -(-n // 10)
    means = [[np.mean(v[k : k + size]) for k in range(0, n, size)] for v in (x, y)]
    assert len(means[0]) == rows
    monkeypatch.setattr(robust, "MOST_OF_LINE", 1000)
    by_hand = robust.median_line(*map(np.array, means), 0.95)
    monkeypatch.setattr(robust, "MOST_OF_LINE", 10)
    assert robust.median_line(x, y, 0.95) == pytest.approx(by_hand, rel=1e-12, nan_ok=True)


# Calibrations


@pytest.mark.parametrize(
    ("text", "known"),
    [
        (" [G] ", ("m/s^2", 9.80665)), ("(Volts)", ("V", 1.0)), ("0.5 kN", ("N", 500.0)),
        ("0.005 g", ("m/s^2", 0.04903325)), ("-3 g", None), ("0 g", None), ("3 bananas", None),
        ("ME", ("1", 1e-6)), ("1e999 g", None), ("m/s/s", ("m/s^2", 1.0)), ("MilliVolts", ("V", 1e-3)), ("", None),
    ],
)  # fmt: skip
def test_units_as_files_write_them(text, known):
    found = known_unit(text)
    assert found == (None if known is None else (known[0], pytest.approx(known[1])))


@pytest.mark.parametrize(
    ("parts", "unit", "factor", "measured"),
    [
        ({"sensitivity": "2 mV/g"}, "", 9.80665 / 2e-3, "m/s^2"),
        ({"sensitivity": "-4 pC/N", "gain": "10 mV/pC", "polarity": -1}, "mV", 1e-3 / (4e-12 * 1e10), "N"),
        ({"sensitivity": "0.2 mV/V/g", "excitation": "5 V"}, "V", 9.80665 / (0.2e-3 * 5.0), "m/s^2"),
        ({"sensitivity": "3 mV/N", "excitation": "5 V", "rated_excitation": "10 V"}, "V", 1.0 / (3e-3 * 0.5), "N"),
        ({"sensitivity": "3 mV/(m/s)", "count": "2 mV", "gain": "7"}, "counts", 2e-3 / (3e-3 * 7.0), "m/s"),
        ({"sensitivity": "3 mV/V/strain", "excitation": "4 V"}, "V", 1.0 / (3e-3 * 4.0), "1"),
        ({"sensitivity": "3 V/mm"}, "V", 1.0 / 3e3, "m"),
        ({"unit": "kPa", "polarity": -1}, "V", -1e3, "Pa"), ({}, "what", 1.0, ""), ({"polarity": -1}, "what", -1.0, ""),
    ],
)  # fmt: skip
def test_scales_are_those_worked_out_by_hand(parts, unit, factor, measured):
    found = ChannelCalibration(**parts).scale(unit)
    assert (found.factor, found.unit) == (pytest.approx(factor, rel=1e-12), measured)


@pytest.mark.parametrize(
    ("parts", "unit", "field"),
    [
        ({"polarity": 2}, "V", "polarity"), ({"polarity": True}, "V", "polarity"), ({"gain": "2"}, "g", "gain"), ({"count": "2 mV"}, "g", "count"),
        ({"unit": "what"}, "", "unit"), ({"sensitivity": "0 mV/g"}, "V", "sensitivity"), ({"sensitivity": "2 mV/V/g"}, "V", "excitation"),
        ({"sensitivity": "2 mV/g", "excitation": "5 V"}, "V", "rated_excitation"), ({"sensitivity": "2 mV/g", "rated_excitation": "5 V"}, "V", "excitation"),
        ({"sensitivity": "2 pC/g"}, "V", "gain"), ({"sensitivity": "2 mV/g", "gain": "0"}, "V", "gain"), ({"sensitivity": "2 mV/g", "gain": "inf"}, "V", "gain"),
        ({"sensitivity": "2 mV/g", "gain": "x"}, "V", "gain"), ({"sensitivity": "2 mV/g"}, "g", "unit"), ({"sensitivity": "2 mV/g"}, "what", "unit"),
        ({"sensitivity": "2 mV/g", "count": "0 V"}, "V", "count"), ({"sensitivity": "2 mV"}, "V", "sensitivity"), ({"sensitivity": "2 V"}, "V", "sensitivity"),
        ({"sensitivity": "1e300 kV/g", "gain": "1e300"}, "V", "sensitivity"), ({"sensitivity": "2 1/N"}, "V", "excitation"),
    ],
)  # fmt: skip
def test_parts_that_do_not_fit_are_refused_by_their_field(parts, unit, field):
    with pytest.raises(InputError) as caught:
        ChannelCalibration(**parts).scale(unit)
    assert caught.value.field == f"calibration.{field}"


def test_parts_are_checked_one_by_one():
    for name, text in (
        ("unit", "1000 g"),
        ("gain", "3"),
        ("gain", "10 mV/pC"),
        ("sensitivity", "2 mV/g"),
        ("count", "3 mV"),
        ("excitation", "5 V"),
        ("what", "x"),
    ):
        check_part(name, text, "f")
    for name, text in (
        ("unit", "x"),
        ("gain", "0"),
        ("gain", "10 mV"),
        ("sensitivity", "2"),
        ("count", "3 N"),
        ("excitation", "-5 V"),
        ("rated_excitation", "0 V"),
    ):
        with pytest.raises(InputError):
            check_part(name, text, "f")


@pytest.mark.parametrize(
    ("unit", "words"),
    [
        ("[mg]", 'mg is a mass; for thousandths of g: --unit "0.001 g"'), ("UG", 'UG is a mass; for millionths of g: --unit "1e-6 g"'),
        ("KG", 'KG is a mass; for thousands of g: --unit "1000 g"'), ("k g", 'thousands of g are --unit "1000 g"'), ("kgees", 'thousands of g are --unit "1000 g"'),
        ("N", ""), ("kgx", ""),
    ],
)  # fmt: skip
def test_masses_that_may_be_meant_for_gravity_are_told(unit, words):
    assert calibration.ambiguous(unit) == words


@pytest.mark.parametrize(
    ("unit", "hint"),
    [("m/s2x", "did you mean"), ("zzzzzzz", "choose from"), ("kgees", 'thousands of g are --unit "1000 g"')],
)
def test_a_unit_that_is_none_is_refused_with_what_may_be_meant(unit, hint):
    with pytest.raises(InputError) as refused:
        calibration.check_unit(unit, "--unit")
    assert hint in refused.value.hint
    assert (refused.value.field, refused.value.got) == ("--unit", unit)


def test_a_calibration_file_up_to_its_limits(tmp_path, monkeypatch):
    file = tmp_path / "calibration.toml"
    text = 'schema = 1\n[all]\nunit = "V"\n[channel.bar]\ngain = 3\npolarity = -1\n'
    file.write_text(text)
    assert read_calibrations(file) == {"all": {"unit": "V"}, "bar": {"gain": "3", "polarity": -1}}
    monkeypatch.setattr(calibration, "LARGEST_FILE", len(text))
    read_calibrations(file)
    monkeypatch.setattr(calibration, "LARGEST_FILE", len(text) - 1)
    with pytest.raises(InputError, match="at most"):
        read_calibrations(file)
    monkeypatch.undo()
    for size in (100_000, 100_001):  # bytes, most of them a remark
        file.write_text(text + "#" * (size - len(text)))
        if size == 100_000:
            assert len(read_calibrations(file)) == 2
    with pytest.raises(InputError, match="at most 100000 bytes"):
        read_calibrations(file)


@pytest.mark.parametrize(
    "text",
    [
        "schema = 2", "schema = true", "[what]", "channel = 3", '[channel.all]\nunit = "V"', "[all]\nwhat = 1", "all = 3", "[all]\nunit = 3",
        "[all]\ngain = true", "[all]\nsensitivity = 3", "schema =",
    ],
)  # fmt: skip
def test_what_is_no_calibration_file_is_refused(tmp_path, text):
    (tmp_path / "a.toml").write_text(text)
    with pytest.raises(InputError):
        read_calibrations(tmp_path / "a.toml")
