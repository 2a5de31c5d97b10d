"""``strikewave spec synthesize`` as a user types it: verdict, files, and what is refused."""

import csv
import json
from pathlib import Path

import numpy as np
import pytest

SPECTRUM = """
schema = 1
title = "A shock of our own"
edition = "2026"
status = "quoted"
source = "our test plan"

[srs]
points = [["100 Hz", "20 g"], ["800 Hz", "200 g"], ["3 kHz", "200 g"]]
share_above = "50 %"

[[srs.tolerance]]
from = "100 Hz"
to = "3 kHz"
low = "-3 dB"
high = "3 dB"
"""


@pytest.mark.verify
@pytest.mark.parametrize("by", ["damped-sines", "wavelets"])
def test_a_motion_for_a_spectrum_of_ones_own_is_judged_and_written(strikewave, by):
    Path("ours.toml").write_text(SPECTRUM)
    code, out, _ = strikewave("spec", "synthesize", "ours.toml", "--by", by, "--out", "made", "--json")
    assert code == 0
    document = json.loads(out)
    assert document["spec"]["verdict"] == "pass"
    assert document["spec"]["by_indicative_limits"] is False
    assert abs(document["end"]["velocity"]) < 1e-6 * document["peak"]["velocity"]
    assert abs(document["end"]["displacement"]) < 1e-6 * document["peak"]["displacement"]
    assert json.loads(Path("made/synthesis.json").read_text())["peak"] == document["peak"]
    assert {"report.html", "summary.svg", "acceleration.csv"} <= {one.name for one in Path("made").iterdir()}
    with Path("made/acceleration.csv").open() as file:
        head, *rows = csv.reader(file)
    assert head == ["time [s]", "acceleration [m/s^2]"]
    values = np.array(rows, dtype=float)
    assert np.abs(values[:, 1]).max() == pytest.approx(document["peak"]["acceleration"], rel=1e-8)
    np.testing.assert_allclose(np.diff(values[:, 0]), 1.0 / document["rate"], rtol=1e-4)


@pytest.mark.verify
def test_srs_judges_the_written_motion_alike(strikewave):
    Path("ours.toml").write_text(SPECTRUM)
    assert strikewave("spec", "synthesize", "ours.toml", "--out", "made")[0] == 0
    code, out, _ = strikewave("srs", "made/acceleration.csv", "--spec", "ours.toml", "--json")
    assert code == 0
    assert json.loads(out)["spec"]["verdict"] == "pass"


def test_a_half_sine_is_for_a_drop_table_and_fails_where_it_cannot_meet_a_spectrum(strikewave):
    Path("ours.toml").write_text(SPECTRUM.replace("20 g", "2 g"))
    code, out, _ = strikewave("spec", "synthesize", "ours.toml", "--by", "half-sine", "--json")
    assert code == 3
    document = json.loads(out)
    pulse = document["half_sine"]
    change = 2.0 / np.pi * pulse["peak"] * pulse["duration"]
    # the trapezoid of 200 samples and more loses (pi/200)^2/12 = 2e-5 of the area of a half-sine
    assert document["end"]["velocity"] == pytest.approx(change, rel=3e-5)
    assert document["spec"]["verdict"] == "fail"


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["synthesize"], "NAME: missing; needed: a specification"),
        (["synthesize", "nasa-gves"], 'did you mean "nasa-gevs"?'),
        (["synthesize", "jesd22-b110:B"], "a specification of a spectrum; choose from: "),
        (["synthesize", "nasa-std-7003a"], "strikewave spec new FILE.toml --from nasa-std-7003a, and add them under [srs]"),
        (["synthesize", "nasa-gevs", "--by", "sines"], "--by"),
        (["synthesize", "nasa-gevs", "--rate", "20 kHz"], "--rate: got \"20000 Hz\"; allowed: at least 80000 Hz"),
        (["synthesize", "nasa-gevs", "--rate", "100 MHz"], "at most"),
        (["synthesise", "nasa-gevs"], "synthesize"),
    ],
)  # fmt: skip
def test_a_wrong_word_is_one_line(strikewave, words, said):
    code, out, err = strikewave("spec", *words)
    assert (code, out) == (2, "")
    assert said in err
    assert len(err.splitlines()) == 1
