"""Budgets beside figures: screen, page, JSON and CSV of record, srs and compare say the same, and verdicts rest on them."""

import csv
import io
import math

import numpy as np
import pytest

import strikewave as sw
from strikewave.analyses.record.report import record_report
from strikewave.base import declare
from strikewave.base.documents import plain
from strikewave.base.errors import InputError

G = 9.80665
BUDGET = """schema = 1
title = "channel 1"
status = "normative"
source = "certificate 17"
[[contribution]]
kind = "sensitivity"
name = "certificate"
value = "4 %"
coverage = 2
[[contribution]]
kind = "offset"
value = "0.5 g"
distribution = "rectangular"
status = "indicative"
"""
SPECTRUM = """schema = 1
title = "levels"
edition = "1"
status = "quoted"
source = "a test"
[srs]
points = [["100 Hz", "100 g"], ["1 kHz", "100 g"]]
[[srs.tolerance]]
from = "100 Hz"
to = "1 kHz"
low = "-20 dB"
high = "20 dB"
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    place = tmp_path_factory.mktemp("budget")
    time = np.arange(12_000) * 5e-6
    for k, peak in enumerate((50.0, 59.3)):
        noise = 0.02 * np.random.default_rng(k).standard_normal(time.size)
        blow = np.where((time > 0.04) & (time < 0.044), peak * np.sin(np.pi * (time - 0.04) / 4e-3), 0.0)
        table = np.column_stack([time, blow + noise])
        np.savetxt(place / f"s{k}.csv", table, delimiter=",", header="time (s),frame (g)", comments="")
    (place / "budget.toml").write_text(BUDGET)
    (place / "levels.toml").write_text(SPECTRUM)
    return place


@pytest.fixture(scope="module")
def found(folder):
    return sw.record([folder / "s0.csv", folder / "s1.csv"], judging=sw.Judging(uncertainty=folder / "budget.toml"))


# u(peak) = 2 % of 50 g and 0.5 g/sqrt(3), which the noise of 0.02 g does not reach
EXPANDED = 2.0 * math.hypot(0.02 * 50.0, 0.5 / math.sqrt(3.0))


@pytest.mark.verify
def test_the_figures_of_each_blow_have_their_expanded_uncertainty_everywhere(found):
    [one] = found.readings[0].channels[0].uncertainties
    assert one.figures["peak"].expanded / G == pytest.approx(EXPANDED, rel=1e-3)
    document = found.content()["files"][0]["channels"][0]["pulses"][0]["uncertainty"]
    assert document["peak"]["expanded"] == one.figures["peak"].expanded
    assert [row["name"] for row in document["peak"]["contributions"]][:2] == ["certificate", "offset"]
    assert document["width"]["contributions"][0]["name"] == "offset"
    row = next(csv.DictReader(io.StringIO(found.tables()["pulses.csv"])))
    column = next(name for name in row if name.startswith("peak_expanded_uncertainty"))
    assert float(row[column]) == pytest.approx(one.figures["peak"].expanded, rel=1e-3)
    page = record_report(found)
    assert "Budget of the peak" in page
    assert "certificate 17" in page
    assert "AC coupling" in page  # not stated


def test_without_a_budget_the_document_says_that_noise_and_baseline_are_all(folder):
    found = sw.record(folder / "s0.csv")
    row = found.content()["files"][0]["channels"][0]["pulses"][0]
    assert row["uncertainty"]["peak"]["standard"] == row["peak_uncertainty"]
    assert row["uncertainty"]["peak"]["contributions"][0]["name"] == "noise and baseline"
    assert "budget" not in found.content()
    assert not any("expanded" in name for name in found.tables()["pulses.csv"].splitlines()[0].split(","))


def test_numbers_from_memory_are_a_warning_that_names_them(found):
    [notice] = [one for one in found.notices if one.code == "budget-from-memory"]
    assert "1 contribution of the uncertainty budget" in notice.message
    assert "offset" in notice.message


def test_a_guarded_verdict_takes_the_whole_and_says_what_it_holds(folder):
    plain, whole = (
        sw.record(folder / "s1.csv", spec="iec-60068-2-27:50g-11ms", judging=sw.Judging("guarded", budget)).verdict
        for budget in (None, folder / "budget.toml")
    )
    peaks = [next(one for one, _ in verdict.clauses if one.clause == "peak") for verdict in (plain, whole)]
    assert [one.verdict for one in peaks] == ["pass", "cannot-tell"]  # 59.3 g of at most 60 g
    assert peaks[1].uncertainty / G == pytest.approx(2.0 * math.hypot(0.02 * 59.3, 0.5 / math.sqrt(3.0)), rel=1e-3)
    document = declare.content(whole)
    assert document["uncertainty"] is None
    assert document["uncertainty_holds"] == ("noise and baseline", "instants of sampling", "certificate", "offset")
    assert "temperature" in document["uncertainty_not_stated"]
    assert plain.asked.holds == ("noise and baseline",)


@pytest.mark.verify
def test_the_screen_of_a_verdict_has_its_rule_and_its_uncertainty(folder, strikewave, monkeypatch):
    monkeypatch.chdir(folder)
    options = ("--spec", "iec-60068-2-27:50g-11ms", "--decision", "guarded", "--uncertainty", "budget.toml")
    for words in (("record", "s1.csv", *options), ("compare", "s1.csv", "spec:iec-60068-2-27:50g-11ms", *options[2:])):
        code, out, _ = strikewave(*words, "--out", "out", "--force")
        text = " ".join(out.split())
        assert code in (0, 3)
        assert "59.28 ± 2.4 g" in text or "59.3 ± 2.4 g" in text or "59.29 ± 2.4 g" in text
        assert "Decision rule: guarded, U on both sides of each limit." in text
        assert "certificate and offset; not stated:" in text


@pytest.mark.verify
def test_a_spectrum_moves_with_its_gain_and_is_judged_by_it(folder):
    found = sw.shock_spectra(
        folder / "s0.csv", judging=sw.Judging(uncertainty="10 %"), spectra=sw.Spectra(high="2 kHz")
    )
    spectrum, expanded = found.spectra[0].maximax, found.expanded(0)
    assert np.all(expanded >= 0.1 * spectrum * (1.0 - 1e-9))
    assert np.max(expanded / spectrum) < 0.105  # noise and baseline of 0.04 % add in quadrature
    assert "absolute expanded uncertainty" in found.tables()["spectrum.csv"].splitlines()[0]
    assert found.content()["uncertainty"]["absolute"]["coverage"] == 2.0
    judged = sw.shock_spectra(
        folder / "s0.csv", spec=str(folder / "levels.toml"), judging=sw.Judging(decision="guarded", uncertainty="10 %")
    )
    assert judged.verdict.verdict == "pass"
    assert judged.verdict.asked.share == 0.1
    assert judged.verdict.clauses[0].uncertainty == 0.0  # no share changes within 10 %


def test_spectra_of_two_kinds_are_as_uncertain_as_each_alone(folder):
    """To the bit: they share the records that are changed, and no number."""
    budget, asked = sw.Judging(uncertainty=folder / "budget.toml"), {"high": "1 kHz", "per_octave": 2}
    kinds = ["absolute", "pseudo-velocity"]
    together = sw.shock_spectra(
        folder / "s0.csv", spectra=sw.Spectra(kinds=kinds, **asked), judging=budget
    ).first.found.uncertainties
    for one, kind in zip(together, kinds, strict=True):
        [alone] = sw.shock_spectra(
            folder / "s0.csv", spectra=sw.Spectra(kinds=[kind], **asked), judging=budget
        ).first.found.uncertainties
        assert np.array_equal(one.standard, alone.standard)
        assert [each.name for each in one.contributions] == [each.name for each in alone.contributions]
        both = ([each.standard for each in found.contributions] for found in (one, alone))
        assert np.array_equal(*both)


def test_a_spectrum_of_which_too_little_lies_before_the_blow_is_not_judged_by_an_unknown_uncertainty(folder, tmp_path):
    lines = (folder / "s0.csv").read_text().splitlines()
    (tmp_path / "late.csv").write_text("\n".join([lines[0], *lines[6_000:]]))
    judged = sw.shock_spectra(
        tmp_path / "late.csv", spec=str(folder / "levels.toml"), judging=sw.Judging(decision="guarded")
    )
    assert judged.verdict.verdict == "cannot-tell"
    assert "its uncertainty is not known" in judged.verdict.clauses[0].reason


@pytest.mark.verify
def test_a_comparison_has_the_uncertainty_of_what_was_measured(folder):
    found = sw.compare(
        str(folder / "s0.csv"), str(folder / "s1.csv"), judging=sw.Judging(uncertainty=folder / "budget.toml")
    )
    pair = found.figures["peak"]
    assert 2.0 * pair.a_uncertainty / G == pytest.approx(EXPANDED, rel=1e-3)
    assert pair.uncertainty == pytest.approx(
        (1.0 + pair.difference) * math.hypot(pair.a_uncertainty / pair.a, pair.b_uncertainty / pair.b), rel=0.2
    )
    assert plain(found.content())["budget"]["title"] == "channel 1"
    with pytest.raises(InputError, match="only with a specification"):
        sw.compare(str(folder / "s0.csv"), str(folder / "s1.csv"), judging=sw.Judging(decision="guarded"))
    with pytest.raises(InputError, match="only with a record"):
        sw.compare("li-ma-2019", "li-ma-2019", judging=sw.Judging(uncertainty="5 %"), scoring=sw.Scoring(band=False))


def test_an_acceleration_is_refused_for_a_channel_that_measures_none(folder, tmp_path):
    (tmp_path / "force.csv").write_text((folder / "s0.csv").read_text().replace("frame (g)", "force (kN)"))
    with pytest.raises(InputError, match="shares of the peak: offset states an acceleration"):
        sw.record(tmp_path / "force.csv", judging=sw.Judging(uncertainty=folder / "budget.toml"))


@pytest.mark.verify
def test_a_new_budget_is_one_that_can_be_used(folder, strikewave, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    assert strikewave("new", "mine", "--from", "budget")[0] == 0
    found = sw.record(folder / "s0.csv", judging=sw.Judging(uncertainty="mine.toml"))
    assert found.budget.not_stated == ()
    assert math.isfinite(found.readings[0].channels[0].uncertainties[0].figures["width"].expanded)
