"""Response channels as results: screen, report, CSV and JSON, of a board whose swings are known."""

import csv
import json
import re

import numpy as np
import pytest

from strikewave import Examination, record
from strikewave.analyses.record.report import record_report
from strikewave.analyses.record.rows import summaries

STEP = 5e-6
SIZES = (300.0, 270.0, 240.0, 210.0)
"""Of the response to each blow, g: a tenth less each time."""


@pytest.fixture(scope="module")
def train(tmp_path_factory):
    """A file of a frame struck four times, and of a board that swings at 900 Hz with 3 % of damping after each.

    Of a swing 0.1 % is left when the next begins.
    """
    time = STEP * np.arange(34_000)
    rng = np.random.default_rng(3)
    frame, board = rng.normal(size=(2, time.size))
    for k, size in enumerate(SIZES):
        since = time - 0.005 - 0.04 * k
        frame += np.where(abs(since - 5e-4) < 5e-4, 1000.0 * np.cos(np.pi * (since - 5e-4) / 1e-3), 0.0)
        omega = 2.0 * np.pi * 900.0
        board += np.where(since > 0.0, size * np.exp(-0.03 * omega * since) * np.sin(omega * since), 0.0)
    place = tmp_path_factory.mktemp("train") / "train.csv"
    np.savetxt(
        place, np.column_stack([time, frame, board]), "%.7g", ",", header="time (s),frame (g),board (g)", comments=""
    )
    return str(place)


# the highest top of exp(-d w t) sin(w t) with d = 0.03: at tan(w t) = 1/d
TOP = np.exp(-0.03 * np.arctan(1.0 / 0.03)) * np.sin(np.arctan(1.0 / 0.03))


def test_each_blow_has_a_line_in_the_csv(train):
    rows = list(
        csv.DictReader(record(train, examination=Examination(base="frame")).tables()["responses.csv"].splitlines())
    )
    assert [row["blow"] for row in rows] == ["1", "2", "3", "4"]
    # 1 g of noise moves the largest sample by 3 g at most
    assert [float(row["peak [m/s^2]"]) / 9.80665 for row in rows] == pytest.approx(TOP * np.array(SIZES), abs=3.0)
    assert [float(row["ratio"]) for row in rows] == pytest.approx(TOP * np.array(SIZES) / 1000.0, rel=0.02)
    for row in rows:
        for name, truth in (("frequency", 900.0), ("damping", 0.03 / np.hypot(1.0, 0.03))):
            unit = " [Hz]" if name == "frequency" else ""
            doubt = float(row[f"mode_1_{name}_uncertainty{unit}"])
            assert float(row[f"mode_1_{name}{unit}"]) == pytest.approx(truth, abs=4.0 * doubt)


def test_blows_are_summed_up_without_what_a_finding_harms(train):
    [one] = summaries(record(train, examination=Examination(base="frame")).readings)
    assert one.channel == "board"
    assert one.statistics["peak"].n == 4
    assert one.statistics["peak"].mean / 9.80665 == pytest.approx(TOP * np.mean(SIZES), abs=2.0)
    assert one.statistics["peak"].cv == pytest.approx(np.std(SIZES, ddof=1) / np.mean(SIZES), rel=0.05)


@pytest.mark.verify
def test_the_report_has_a_chapter_with_picture_and_tables(train):
    page = record_report(record(train, examination=Examination(base="frame")))
    chapter = page.partition(">Response channels</h2>")[2].partition("<h2")[0]
    assert chapter.count('<figure class="picture') == 1
    captions = re.findall(r"<b>Table \d+.</b>\s*(.*?)</figcaption>", chapter, re.DOTALL)
    assert [words.split(",")[0] for words in captions] == [
        "Responses",
        "Modes of the free decay",
        "All responses together",
    ]
    assert len(re.findall(r"<td[^>]*>(?:899|900)[.\d]* ± 0", chapter)) == 4
    assert ">Response channels</h2>" not in record_report(record(train))


@pytest.mark.verify
def test_the_screen_lists_responses_and_the_document_has_them(train, strikewave):
    code, shown, err = strikewave("record", train, "--base", "frame", "--out", "a")
    assert code == 0, err
    assert "Response channels: board" in shown
    assert "All responses together: board" in shown
    for _ in range(2):
        code, out, err = strikewave("record", train, "--base", "frame", "--out", "b", "--json")
        assert code == 0, err  # every file that the first run wrote is one of a result, and may be replaced
    document = json.loads(out)
    board = document["files"][0]["channels"][1]
    assert [one["blow"] for one in board["responses"]] == [1, 2, 3, 4]
    assert board["response"] in board["responses"]
    assert document["response_summary"][0]["peak"]["n"] == 4
    assert {"peak", "duration", "delay", "rms", "zero", "base_peak"} <= set(document["units"])
