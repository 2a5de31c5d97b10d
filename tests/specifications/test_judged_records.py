"""Records against a specification: which stretch is judged, what is taken over, and what is counted."""

import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from strikewave.base import declare
from strikewave.base.documents import plain
from strikewave.base.errors import InputError
from strikewave.records.budget import RECORD, SAMPLING, of_share
from strikewave.records.calibration import ChannelCalibration
from strikewave.records.health_notice import HealthNotice
from strikewave.records.measured_uncertainty import BlowUncertainty, FigureUncertainty
from strikewave.records.pulse_shape import PulseUncertainty
from strikewave.records.reading import ChannelReading, FileReading, Request, read_channel
from strikewave.records.record import Channel
from strikewave.signal.filters import Filter
from strikewave.specifications.ideal_pulses import IdealPulse, PulseBand
from strikewave.specifications.judged_records import (
    Asked,
    JudgedSpectrum,
    SpectraVerdict,
    _noise_before,
    asked_of_spectra,
    before_filter,
    filter_leaves,
    judge_records,
    measured_figure,
    read_direction,
    rests_on_indicative,
    shock_of,
    troubles_of,
)
from strikewave.specifications.judging import Limits, PulseLimits, judged
from strikewave.specifications.reading import load_specification

GRAVITY = 9.80665
STEP = 1e-4
IEC = load_specification("iec-60068-2-27:50g-11ms")


def channel_of(peaks, name="table", unit="m/s^2", offset=0.0, start=0.0):
    """Half-sines of 11 ms, every 0.4 s from 0.2 s on, with a little noise."""
    time = np.arange(round((0.4 * len(peaks) + 0.1) / STEP)) * STEP
    values = offset + 0.3 * np.random.default_rng(5).normal(size=time.size)
    for k, peak in enumerate(peaks):
        values = values + IdealPulse("half-sine", peak * GRAVITY, 11e-3).at(time - 0.2 - 0.4 * k)
    return Channel(name, values, STEP, start, unit)


def file_of(path, *channels):
    readings = [read_channel(one, k, ChannelCalibration(), Request()) for k, one in enumerate(channels, start=1)]
    return FileReading(path, "text", tuple(readings))


ONE = file_of("a.csv", channel_of([50.0]))
DOWN = file_of("b.csv", channel_of([-50.0], offset=3.0, start=7.0))
THREE = file_of("c.csv", channel_of([50.0, 48.0, 80.0]))
TWO = file_of("d.csv", channel_of([50.0]), channel_of([5.0], "across"))


@pytest.mark.parametrize(("file", "sign", "start"), [(ONE, 1.0, 0.0), (DOWN, -1.0, 7.0)])
@pytest.mark.parametrize("band", [None, (0.4, 1.5)])
def test_the_stretch_reaches_as_far_as_the_band_may_be_moved(file, sign, start, band):
    """Without a band 1 and 2 durations, else what is watched of it, and 1.75 durations of 11 ms more to either side."""
    [reading] = file.channels
    [pulse] = reading.pulses
    ideal = IdealPulse("half-sine", 50 * GRAVITY, 11e-3)
    limits = PulseLimits(ideal, "quoted")
    before, after = 1.0, 2.0
    if band is not None:
        limits = replace(limits, band=PulseBand(ideal, 0.1, 0.2, before=band[0], after=band[1]))
        before, after = band[0], 1.0 + band[1]
    shock = shock_of(reading, pulse, limits)
    low = round((pulse.begin - start - (before + 1.75) * 11e-3) / STEP)
    high = round((pulse.end - start + (after + 1.75) * 11e-3) / STEP)
    assert shock.values == pytest.approx(sign * (reading.channel.values[low : high + 1] - pulse.offset), abs=1e-12)
    assert shock.begin == pytest.approx(start + low * STEP, abs=1e-9)
    assert shock.step == STEP
    assert low + shock.peak_index == round((pulse.time - start) / STEP)
    assert (shock.filter_left, shock.filter_width, shock.uncertainty) == (1.0, 1.0, 0.0)
    assert shock.cross_axis_noise == 0.0  # of no channel
    assert shock.figures["peak"].value == abs(pulse.peak)
    assert shock.figures["velocity_change"].value == abs(pulse.velocity_change)
    assert shock.figures["velocity_change"].uncertainty == pulse.area_uncertainty(1.2 * 11e-3)
    assert shock.figures["width"] == (pulse.width, pulse.uncertainty.width, False)


def test_a_stretch_ends_with_its_record():
    values = ONE.channels[0].channel.values[1950:2150]
    pulse = replace(ONE.channels[0].pulses[0], width=math.nan)
    reading = replace(ONE.channels[0], channel=Channel("t", values, STEP, 0.195, "m/s^2"))
    limits = PulseLimits(IdealPulse("half-sine", 50 * GRAVITY, 11e-3), "quoted")
    shock = shock_of(reading, pulse, limits)
    assert (shock.values.size, shock.begin) == (200, 0.195)
    assert "width" not in shock.figures
    assert shock_of(reading, replace(pulse, time=0.1), limits).peak_index == 0
    assert shock_of(reading, replace(pulse, time=0.3), limits).peak_index == 199


def test_a_budget_gives_share_amount_and_figures():
    [reading] = ONE.channels
    pulse = reading.pulses[0]
    known = BlowUncertainty(
        {
            name: FigureUncertainty(1.0, 9.0, 0.04 * abs(pulse.peak), 2.0, "", ())
            for name in ("peak", "width", "velocity_change")
        },
        amount=3.0,
    )
    limits = PulseLimits(IdealPulse("half-sine", 50 * GRAVITY, 11e-3), "quoted")
    shock = shock_of(reading, pulse, limits, known=known)
    assert shock.uncertainty == pytest.approx(0.04, rel=1e-12)
    assert shock.cross_axis_noise == 3.0
    assert shock.figures["peak"] == (abs(pulse.peak), pytest.approx(0.02 * abs(pulse.peak)), True)
    assert measured_figure("width", 2.0, PulseUncertainty(1.0, 0.5, 0.25)) == (2.0, 0.5, False)
    table, across = TWO.channels
    beside = shock_of(table, table.pulses[0], limits, [across], known=known)
    quiet = round(0.2 / STEP - 0.25 * 11e-3 / STEP) - round(beside.begin / STEP)
    noise = np.std(beside.cross_axis["across"][:quiet])
    assert beside.cross_axis_noise == pytest.approx(math.hypot(noise, 3.0), rel=0.01)  # some samples more or less
    assert beside.cross_axis["across"].max() == pytest.approx(5 * GRAVITY, rel=0.05)
    first = round(beside.begin / STEP)
    moved = across.channel.values[first : first + beside.values.size] - across.baseline
    assert beside.cross_axis["across"] == pytest.approx(moved, abs=1e-9)


def test_noise_across_is_that_of_the_noisiest_channel_while_it_is_quiet():
    channels = {"y": np.tile([1.0, -1.0], 20), "z": np.tile([2.0, -2.0], 20)}
    channels["y"][30:] = 1e3
    assert _noise_before(channels, np.arange(40) < 16) == 2.0
    assert math.isnan(_noise_before(channels, np.arange(40) < 15))
    assert _noise_before({}, np.zeros(40, dtype=bool)) == 0.0


def test_the_pulse_before_a_filter_is_the_one_at_the_same_time():
    pulse = THREE.channels[0].pulses[1]
    others = [SimpleNamespace(time=pulse.time + by, smooth=by) for by in (-0.4, 0.01, 0.4)]
    assert before_filter(SimpleNamespace(unfiltered=others), pulse) == 0.01
    assert before_filter(SimpleNamespace(unfiltered=others[::2]), pulse) == pulse.smooth
    assert before_filter(SimpleNamespace(unfiltered=()), pulse) == pulse.smooth


def test_a_filter_takes_as_much_whatever_the_peak_and_a_coarse_record_is_refined():
    for shape in ("half-sine", "trapezoid"):
        fine = filter_leaves(Filter(100.0), IdealPulse(shape, 1.0, 11e-3), 1e-5)
        assert 0.5 < fine < 0.999 or shape == "trapezoid"
        assert filter_leaves(Filter(100.0), IdealPulse(shape, 7.0, 11e-3), 1e-3) == pytest.approx(fine, rel=2e-3)
    limits = PulseLimits(IdealPulse("half-sine", 50 * GRAVITY, 11e-3), "quoted")
    shock = shock_of(ONE.channels[0], ONE.channels[0].pulses[0], limits, filter_=Filter(300.0))
    assert shock.filter_left == pytest.approx(filter_leaves(Filter(300.0), limits.pulse, STEP))
    assert shock.filter_cutoff == pytest.approx(Filter(300.0).half_power(STEP))
    assert 1.0 < shock.filter_width < 1.2


def test_findings_harm_figures_the_worst_first_and_machines_are_judged_as_they_are():
    notices = [
        HealthNotice("drift", "d", harms=("velocity_change",)),
        HealthNotice("outlier", "o", severity="bad"),
        HealthNotice("flat-top", "f", harms=("peak",)),
        HealthNotice("gap", "g", severity="good", harms=("width",)),
    ]
    assert troubles_of(notices) == {"velocity_change": "drift: d", "peak": "flat-top: f"}
    bad = HealthNotice("clipped", "c", severity="bad")
    assert troubles_of([*notices, bad]) == dict.fromkeys(("peak", "width", "velocity_change"), "clipped: c")


def test_a_verdict_rests_on_indicative_limits_if_any_passes_or_all_that_fail_are_so():
    def one(value, status):
        return judged("x", value, Limits(0.0, 1.0, status), "1")

    sure, unsure, wrong, maybe = one(0.5, "quoted"), one(0.5, "indicative"), one(2.0, "quoted"), one(2.0, "indicative")
    assert [rests_on_indicative(some, "pass") for some in ([sure], [sure, unsure], [unsure, wrong])] == [
        False,
        True,
        True,
    ]
    fails = [rests_on_indicative(some, "fail") for some in ([wrong, maybe], [maybe, sure], [sure], [wrong])]
    assert fails == [False, True, False, False]
    assert not rests_on_indicative([unsure], "cannot-tell")
    row = plain(declare.content(judged("x", 3.0, Limits(-math.inf, 1.0, "quoted"), "m")))
    assert (row["limit"], row["margin"], row["verdict"]) == ([None, 1.0], -2.0, "fail")


def test_records_are_judged_blow_by_blow_with_directions_rate_and_files_without_a_blow():
    directions = [read_direction("c*=+x"), read_direction("+y"), read_direction("a*#1=-z")]
    quiet = file_of("q.csv", channel_of([]))
    empty = FileReading("e.csv", "text", ())
    found = judge_records([ONE, THREE, quiet, empty], IEC, Asked(directions=directions))
    assert [(one.file, one.number, one.direction, one.found.verdict) for one in found.shocks] == [
        ("a.csv", 1, "-z", "pass"),
        ("c.csv", 1, "+y", "pass"),
        ("c.csv", 2, "+y", "pass"),
        ("c.csv", 3, "+y", "fail"),
    ]
    campaign = {clause.clause: clause for clause in found.campaign}
    assert campaign["files without a shock"].value == 2.0
    assert campaign["files without a shock"].reason == "no shock was found in q.csv, e.csv"
    assert (campaign["shocks in -z"].value, campaign["shocks in +y"].value) == (1.0, 2.0)
    assert found.verdict == "fail"
    document = declare.content(found)
    assert [one["blow"] for one in document["shocks"]] == [1, 1, 2, 3]
    worst = {clause["clause"]: clause for clause in document["clauses"]}
    assert (worst["peak"]["file"], worst["peak"]["blow"]) == ("c.csv", 3)
    assert "file" not in worst["files without a shock"]
    bump = judge_records([THREE], load_specification("iec-60068-2-27-bump:" + "40g-6ms"), Asked())
    [rate] = [clause for clause in bump.campaign if clause.clause == "shocks a second"]
    assert rate.value == pytest.approx(2.5, rel=1e-3)


def test_channels_across_are_no_shocks_and_must_be_there_and_hold_an_acceleration():
    found = judge_records([TWO], IEC, Asked(cross_axis=["across"]))
    [shock] = found.shocks
    cross = next(clause for clause in shock.found.clauses if clause.clause == "cross-axis")
    assert cross.value == pytest.approx(5 * GRAVITY, rel=0.05)
    assert len(judge_records([TWO], IEC, Asked()).shocks) == 2
    with pytest.raises(InputError, match="--cross-axis"):
        judge_records([TWO], IEC, Asked(cross_axis=["acros"]))
    volts = replace(
        TWO, channels=(TWO.channels[0], replace(TWO.channels[1], channel=replace(TWO.channels[1].channel, unit="V")))
    )
    assert len(judge_records([volts], IEC, Asked()).shocks) == 1
    with pytest.raises(InputError, match="across, V"):
        judge_records([volts], IEC, Asked(cross_axis=["2"]))
    with pytest.raises(InputError, match="records of an acceleration"):
        judge_records([replace(volts, channels=volts.channels[1:])], IEC, Asked())
    bare = replace(volts.channels[1], channel=replace(volts.channels[1].channel, unit=""))
    with pytest.raises(InputError, match="across, no known unit"):
        judge_records([replace(volts, channels=(TWO.channels[0], bare))], IEC, Asked(cross_axis=["2"]))
    with pytest.raises(InputError, match='got "V";'):
        judge_records([replace(volts, channels=volts.channels[1:])], IEC, Asked())
    with pytest.raises(InputError, match="no known unit"):
        judge_records([replace(volts, channels=(volts.channels[1], bare))], IEC, Asked())
    with pytest.raises(InputError, match='got "no channel";'):
        judge_records([replace(volts, channels=())], IEC, Asked())
    clipped = TWO.channels[1].with_finding(HealthNotice("drift", "d")).with_finding(HealthNotice("clipped", "c"))
    found = judge_records([replace(TWO, channels=(TWO.channels[0], clipped))], IEC, Asked(cross_axis=["2"]))
    assert found.shocks[0].shock.troubles == {"cross_axis": "across: clipped: c"}


def test_what_is_asked_of_budgets_and_directions_is_told():
    assert (Asked().share, Asked().holds) == (0.0, ("noise and baseline",))
    assert Asked(budget=of_share(0.05)).share == 0.05
    assert isinstance(ONE.channels[0], ChannelReading)
    asked = Asked(directions=[read_direction("+x"), read_direction("b*=-x"), read_direction("#2=+y")])
    assert [asked.direction_of(*one) for one in (("a", ["1"]), ("b1", ["1"]), ("b1", ["y", "2"]))] == ["+x", "-x", "+y"]
    assert Asked().direction_of("a", ["1"]) == ""


def test_each_blow_has_its_own_uncertainty():
    def known(share, pulse):
        one = FigureUncertainty(1.0, 1.0, share * abs(pulse.peak), 2.0, "", ())
        return BlowUncertainty(dict.fromkeys(("peak", "width", "velocity_change"), one))

    [reading] = THREE.channels
    shares = (0.01, 0.02, 0.04)
    each = tuple(known(*pair) for pair in zip(shares, reading.pulses, strict=True))
    found = judge_records([replace(THREE, channels=(replace(reading, uncertainties=each),))], IEC, Asked())
    assert [one.shock.uncertainty for one in found.shocks] == pytest.approx(shares)


BARE = PulseLimits(IdealPulse("half-sine", 50 * GRAVITY, 11e-3), "quoted")


@pytest.mark.parametrize(("at", "counts"), [(0.3, True), (0.2, False)])
def test_noise_across_ends_a_quarter_of_a_blow_before_it(at, counts):
    table, across = TWO.channels
    pulse = table.pulses[0]
    values = across.channel.values.copy()
    values[round((pulse.begin - at * (pulse.end - pulse.begin)) / STEP)] = 1e4
    noisy = replace(across, channel=replace(across.channel, values=values))
    assert (shock_of(table, pulse, BARE, [noisy]).cross_axis_noise > 100.0) == counts


def test_a_width_of_some_milliseconds_is_one():
    [reading] = ONE.channels
    short = replace(reading.pulses[0], width=4e-3)
    assert shock_of(reading, short, BARE).figures["width"].value == 4e-3


def test_several_channels_across_are_left_out_and_a_misspelt_one_is_named():
    three = file_of("d.csv", channel_of([50.0]), channel_of([5.0], "across"), channel_of([4.0], "third"))
    found = judge_records([three], IEC, Asked(cross_axis=["across", "d*#third"]))
    assert [one.reading.channel.name for one in found.shocks] == ["table"]
    assert set(found.shocks[0].shock.cross_axis) == {"across", "third"}
    with pytest.raises(InputError, match='did you mean "across"'):
        judge_records([three], IEC, Asked(cross_axis=["d.csv#acros"]))


def test_shocks_without_a_direction_are_named_by_their_channels_where_there_are_several():
    stated = [read_direction("c*=+x")]

    def reason(*files):
        campaign = judge_records(list(files), IEC, Asked(directions=stated)).campaign
        return next(one.reason for one in campaign if one.clause == "shocks without a direction")

    assert reason(ONE, THREE).startswith("a.csv has no direction")
    assert reason(TWO, THREE).startswith("d.csv, table; d.csv, across have no direction")
    document = declare.content(judge_records([ONE, THREE], IEC, Asked(directions=stated)))
    assert [one["direction"] for one in document["shocks"]] == [None, "+x", "+x", "+x"]


def test_of_files_without_a_shock_three_are_named():
    empty = [FileReading(f"{name}.csv", "text", ()) for name in "pqrst"]
    campaign = judge_records([ONE, *empty], IEC, Asked()).campaign
    clause = next(one for one in campaign if one.clause == "files without a shock")
    assert (clause.value, clause.low, clause.high, clause.margin) == (5.0, 0.0, 0.0, -5.0)
    assert all(f"{name}.csv" in clause.reason for name in "pqr")
    assert not any(f"{name}.csv" in clause.reason for name in "st")


def test_a_verdict_of_spectra_is_that_of_the_worst_and_says_what_uncertainties_hold():
    clause = judged("x", 2.0, Limits(0.0, 1.0, "indicative"), "1")
    one = JudgedSpectrum(
        "n", "f.csv", "c", np.ones(1), np.ones(1), (judged("x", 0.5, Limits(0.0, 1.0, "quoted"), "1"),)
    )
    spectra = (one, one._replace(file="g.csv", clauses=(clause,)))
    bare = SpectraVerdict(IEC, None, asked_of_spectra(), spectra)
    assert [each.verdict for each in spectra] == ["pass", "fail"]
    assert (bare.verdict, bare.by_indicative, bare.asked.holds, bare.asked.not_stated) == ("fail", True, (), ())
    guarded = asked_of_spectra("guarded")
    assert guarded.not_stated
    assert guarded.holds == (RECORD, SAMPLING)
    budget = replace(bare, asked=asked_of_spectra(budget=of_share(0.05)))
    assert (budget.asked.holds, budget.asked.not_stated) == (of_share(0.05).names, of_share(0.05).not_stated)
    assert asked_of_spectra("guarded", budget=of_share(0.05)).holds == budget.asked.holds
    assert [declare.content(one)["uncertainty"] for one in (bare, budget)] == [0.0, 0.05]
    assert [(row["file"], row["verdict"]) for row in declare.content(bare)["clauses"]] == [
        ("f.csv", "pass"),
        ("g.csv", "fail"),
    ]


def test_a_peak_beyond_the_stretch_is_its_last_sample():
    values = ONE.channels[0].channel.values[1500:2150]
    reading = replace(ONE.channels[0], channel=Channel("t", values, STEP, 0.15, "m/s^2"))
    shock = shock_of(reading, replace(reading.pulses[0], time=0.3), BARE)
    assert shock.values.size < 600
    assert shock.peak_index == shock.values.size - 1
