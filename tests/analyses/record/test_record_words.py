"""The first sentences on measured records: what is in doubt is still told, and the reason stands first."""

import numpy as np
import pytest

import strikewave
from strikewave.analyses.record.report import record_report
from strikewave.analyses.record.screen import print_files
from strikewave.analyses.record.sentences import record_words
from strikewave.analyses.record.tables import short_names
from strikewave.base.constants import STANDARD_GRAVITY

PEAK, RINGING = 900.0, 3000.0
"""Planted peak, g, and frequency of the ringing, Hz."""


def written(path, unit="g", begin=0.0):
    """A file with a half-sine of 0.8 ms that rings by a tenth, noise of 1 g; the record begins at a time, s."""
    time = np.arange(0.0, 0.04, 5e-6)
    since = time - 0.01
    pulse = np.where((since >= 0) & (since <= 0.8e-3), np.sin(np.pi * since / 0.8e-3), 0.0)
    ring = np.where(since >= 0, 0.1 * np.exp(-since / 0.003) * np.sin(2 * np.pi * RINGING * since), 0.0)
    values = PEAK * (pulse + ring) + np.random.default_rng(0).normal(0.0, 1.0, time.size)
    rows = np.column_stack([time, values])[time >= begin]
    head = f"time (s),acc ({unit})" if unit else "time (s),acc"
    path.write_text(head + "\n" + "\n".join(f"{t:.6f},{a:.3f}" for t, a in rows) + "\n")
    return path


@pytest.mark.usefixtures("undrawn")
def test_a_peak_in_doubt_is_told_beside_what_it_is_without_ringing(tmp_path):
    """A blow that rings by a tenth goes into no mean; its peak is as read, and without ringing as it was planted."""
    result = strikewave.record(written(tmp_path / "shot.csv"))
    [pulse] = result.readings[0].channels[0].pulses
    assert pulse.rigid.peak == pytest.approx(PEAK * STANDARD_GRAVITY, abs=2.0 * pulse.rigid.peak_uncertainty)
    words = record_words(result)
    assert "No record gave a peak that can be trusted." in words
    assert f"As read, the peak is {pulse.peak / STANDARD_GRAVITY:.4g} g; without ringing " in words
    assert f"without ringing {pulse.rigid.peak / STANDARD_GRAVITY:.4g} g ±" in words
    page = record_report(result)
    assert "peak as read, in doubt" in page
    assert "peak without ringing, in doubt" in page


def test_several_peaks_in_doubt_are_told_by_their_range(tmp_path):
    files = [written(tmp_path / f"{k}.csv") for k in range(2)]
    assert "As read, the peaks of 2 blows are" in record_words(strikewave.record(files))


def test_the_ringing_has_one_frequency_in_finding_and_table(tmp_path):
    """That of the spectrum, within a step of it: a fit together with the pulse is less sure of it."""
    [reading] = strikewave.record(written(tmp_path / "shot.csv")).readings[0].channels
    [message] = [one.message for one in reading.findings if one.code == "ringing"]
    measured = reading.pulses[0].ringing_frequency
    assert f"rings at {measured:.0f}\xa0Hz" in message
    assert measured == pytest.approx(RINGING, rel=0.02)


def test_that_no_unit_is_known_stands_before_the_figures(tmp_path):
    words = record_words(strikewave.record(written(tmp_path / "shot.csv", unit="")))
    assert 0 < words.index("names no unit") < words.index("As read")


def test_a_record_that_begins_in_its_blow_is_said_to(tmp_path):
    words = record_words(strikewave.record(written(tmp_path / "late.csv", begin=0.0103)))
    assert "late.csv is bad: the record begins in a blow" in words


@pytest.mark.usefixtures("undrawn")
def test_copies_of_a_record_are_named_where_they_are_summed_up(tmp_path, capsys):
    """Three copies scatter by nothing, and are no three tests: first sentence, screen, JSON and report say so."""
    files = [written(tmp_path / f"{k}.csv") for k in range(3)]
    other = tmp_path / "other.csv"
    other.write_text("\n".join(files[0].read_text().splitlines()[:-100]) + "\n")
    result = strikewave.record([*files, other])
    assert "; 2 of them (1.csv and 2.csv) repeat the samples of another file, and mean, scat" in record_words(result)
    print_files(result.readings, short_names([str(path) for path in [*files, other]]))
    screen = " ".join(capsys.readouterr().out.split())
    assert '1.csv and 2.csv: its samples are those of file 1, "0.csv"' in screen
    channels = [file["channels"] for file in result.document()["files"]]
    health = [[finding["code"] for finding in one["health"]] for [one] in channels]
    assert ["copy" in codes for codes in health] == [False, True, True, False]
    assert "its samples are those of file 1, " in record_report(result)
    assert "repeat" not in record_words(strikewave.record([files[0], other]))
