"""strikewave srs as a user types it: one array a spectrum, limits of the spectrum of a half-sine, refusals, a folder."""

import json
import math
import os
from xml.etree import ElementTree

import numpy as np
import pytest

from strikewave.signal.srs import srs

STEP, LENGTH, PEAK = 1e-6, 1000, 1000.0
"""s, samples, m/s^2."""
CHANGE = PEAK * LENGTH * STEP * 2.0 / math.pi


def history():
    u = (np.arange(20_000) - 2000.0) / LENGTH
    return np.where((u > 0.0) & (u < 1.0), PEAK * np.sin(np.pi * u), 0.0)


@pytest.fixture
def shot(strikewave):
    rows = [f"{STEP * k:.6f},{value:.12g}" for k, value in enumerate(history())]
    with open("shot.csv", "w") as file:
        file.write("time [s],board [m/s^2]\n" + "\n".join(rows) + "\n")
    return "shot.csv"


def document(out):
    parsed = json.loads(out)
    json.dumps(parsed, allow_nan=False)
    assert out.count("\n") == 1
    return parsed


def test_json_has_its_keys_and_one_array_a_spectrum(strikewave, shot):
    code, out, _ = strikewave("srs", shot, "--json")
    assert code == 0
    found = document(out)
    assert set(found) >= {"schema", "version", "units", "warnings", "frequency", "q", "absolute"}
    assert not {"displacement", "pseudo-velocity"} & set(found)
    assert (found["q"], found["side"], found["part"]) == (10.0, "maximax", "total")
    assert found["units"]["frequency"] == "Hz"
    assert found["units"]["absolute"] == "m/s^2"
    assert len(found["frequency"]) == len(found["absolute"])
    assert os.listdir() == ["shot.csv"]


def test_the_grid_is_twelve_an_octave_from_10_hz_to_100_khz(strikewave, shot):
    frequency = document(strikewave("srs", shot, "--json")[1])["frequency"]
    assert frequency[0] == 10.0
    assert frequency[-1] == pytest.approx(100e3, rel=2.0 ** (1 / 12) - 1.0)
    assert np.diff(np.log2(frequency)) == pytest.approx(1 / 12, rel=0.01)


def test_a_grid_as_asked_for(strikewave, shot):
    _, out, _ = strikewave("srs", shot, "--from", "100 Hz", "--to", "1600", "--per-octave", "1", "--json")
    assert document(out)["frequency"] == pytest.approx([100.0, 200.0, 400.0, 800.0, 1600.0])


def test_limits_of_every_kind(strikewave, shot):
    """Stiff oscillators follow the record; soft ones take its velocity change, and move by it over 2 pi f."""
    words = ["--frequency", "10 Hz", "--frequency", "100 kHz", "--q", "inf"]
    units = {
        "absolute": "m/s^2",
        "displacement": "m",
        "relative-velocity": "m/s",
        "pseudo-velocity": "m/s",
        "equivalent-static": "m/s^2",
    }
    kinds = [word for kind in units for word in ("--kind", kind)]
    found = document(strikewave("srs", shot, *words, *kinds, "--json")[1])
    assert found["q"] == "inf"
    assert found["frequency"] == [10.0, 100e3]
    assert found["absolute"][1] == pytest.approx(PEAK, rel=0.01)
    assert found["pseudo-velocity"][0] == pytest.approx(CHANGE, rel=0.01)
    assert found["displacement"][0] == pytest.approx(CHANGE / (2.0 * math.pi * 10.0), rel=0.01)
    assert found["absolute"][0] == pytest.approx(2.0 * math.pi * 10.0 * CHANGE, rel=0.01)
    assert found["relative-velocity"][0] == pytest.approx(CHANGE, rel=0.01)
    assert found["equivalent-static"] == pytest.approx(found["absolute"], rel=1e-9)  # undamped: both are one
    assert {kind: found["units"][kind] for kind in units} == units


def test_the_command_gives_what_the_library_gives(strikewave, shot):
    frequencies = [500.0, 1000.0, 2000.0]
    words = [word for f in frequencies for word in ("--frequency", str(f))]
    library = srs(history(), STEP, frequencies, 25.0, "absolute")
    for side in ("maximax", "positive", "negative"):
        found = document(strikewave("srs", shot, *words, "--q", "25", "--side", side, "--json")[1])
        assert found["side"] == side
        assert found["absolute"] == pytest.approx(library.side(side).tolist(), rel=1e-6)


def test_maximax_is_the_larger_of_the_sides_and_total_of_the_parts(strikewave, shot):
    def spectrum(*words):
        return np.array(
            document(strikewave("srs", shot, "--from", "100", "--to", "10000", *words, "--json")[1])["absolute"]
        )

    assert np.array_equal(
        spectrum(), np.maximum(np.abs(spectrum("--side", "positive")), np.abs(spectrum("--side", "negative")))
    )
    end = ("--end", "3 ms")
    parts = [spectrum("--part", part, *end) for part in ("primary", "residual")]
    assert spectrum() == pytest.approx(np.maximum(*parts), rel=1e-9)


def test_undamped_residual_of_a_half_sine_is_that_of_its_closed_form(strikewave, shot):
    """R = A 4 r cos(pi r) / (1 - 4 r^2), r = f T."""
    frequencies = [200.0, 700.0, 1200.0, 2200.0]
    words = [word for f in frequencies for word in ("--frequency", str(f))]
    found = document(strikewave("srs", shot, *words, "--q", "inf", "--part", "residual", "--end", "3 ms", "--json")[1])
    r = np.array(frequencies) * LENGTH * STEP
    assert found["absolute"] == pytest.approx(np.abs(PEAK * 4.0 * r * np.cos(np.pi * r) / (1.0 - 4.0 * r**2)), rel=2e-3)


def test_the_zero_line_is_taken_off_and_said(strikewave, shot):
    plain = document(strikewave("srs", shot, "--json")[1])
    with open(shot) as file:
        head, *rows = file.read().splitlines()
    with open("off.csv", "w") as file:
        file.write("\n".join([head, *(f"{t},{float(v) + 50.0!r}" for t, v in (row.split(",") for row in rows))]) + "\n")
    off = document(strikewave("srs", "off.csv", "--json")[1])
    assert (plain["zero_line"], off["zero_line"]) == (0.0, pytest.approx(50.0))
    assert off["absolute"] == pytest.approx(plain["absolute"], rel=1e-6, abs=1e-6)


def test_a_calibration_scales_the_spectrum_and_is_kept(strikewave, shot):
    plain = document(strikewave("srs", shot, "--json")[1])
    found = document(strikewave("srs", shot, "--unit", "g", "--polarity", "-1", "--json")[1])
    assert found["calibration"] == {"unit": "g", "polarity": -1}
    assert found["absolute"] == pytest.approx((9.80665 * np.array(plain["absolute"])).tolist(), rel=1e-9)


def test_a_record_whose_unit_nobody_says_says_so(strikewave, shot):
    with open("own.csv", "w") as file:
        file.write(open(shot).read().replace("board [m/s^2]", "board"))
    found = document(strikewave("srs", "own.csv", "--json")[1])
    assert [warning["code"] for warning in found["warnings"]] == ["unit-unknown"]
    assert "this one is in" in found["units"]["absolute"]


def test_what_harms_a_spectrum_is_warned_of(strikewave, shot):
    """A channel that is dead has a spectrum of zeros, and a warning."""
    with open("dead.csv", "w") as file:
        file.write("time [s],board [g]\n" + "\n".join(f"{k * 1e-5:.5f},2.5" for k in range(500)) + "\n")
    code, out, err = strikewave("srs", "dead.csv", "--json")
    found = document(out)
    assert code == 0
    assert [warning["code"] for warning in found["warnings"]] == ["dead"]
    assert set(found["absolute"]) == {0.0}
    assert "bad [dead]" in err


@pytest.mark.parametrize(
    ("words", "field", "came", "allowed"),
    [
        (("--q", "0"), "--q", '"0"', "a quality factor above zero"),
        (("--q", "-3"), "--q", '"-3"', "a quality factor above zero"),
        (("--q", "nan"), "--q", '"nan"', "a quality factor above zero"),
        (("--q", "ten"), "--q", '"ten"', "a quality factor above zero"),
        (("--kind", "velocity"), "--kind", '"velocity"', "absolute, displacement, relative-velocity, pseudo-velocity"),
        (("--side", "up"), "--side", '"up"', "maximax, positive, negative"),
        (("--part", "all"), "--part", '"all"', "total, primary, residual"),
        (("--from", "0"), "--from", '"0"', "above zero"),
        (("--from", "10 m"), "--from", '"10 m"', "a frequency"),
        (("--to", "1 MHz"), "--to", '"1 MHz"', "half the sampling rate"),
        (("--from", "2 kHz", "--to", "1 kHz"), "--to", '"1 kHz"', "above --from"),
        (("--per-octave", "0"), "--per-octave", '"0"', "above zero"),
        (("--per-octave", "1e9"), "--per-octave", '"1e9"', "100 000"),
        (("--frequency", "inf"), "--frequency", '"inf"', "above zero"),
        (("--frequency", "600 kHz"), "--frequency", '"600 kHz"', "half the sampling rate"),
        (("--end", "1 s"), "--end", '"1 s"', "a time from"),
        (("--end", "-1 s"), "--end", '"-1 s"', "a time from"),
        (("--channel", "bord"), "--channel", '"bord"', "board"),
        (("--sensitivity", "bord=1 mV/g"), "--sensitivity", "bord", "board"),
        (("--rate", "0"), "--rate", '"0"', "above zero"),
    ],
)
def test_wrong_input_says_field_what_came_and_what_is_allowed(strikewave, shot, words, field, came, allowed):
    code, out, err = strikewave("srs", shot, *words, "--json")
    assert (code, out) == (2, "")
    assert field in err
    assert came in err
    assert allowed in err
    assert "Traceback" not in err
    assert os.listdir() == ["shot.csv"]


def test_wrong_input_is_as_short_without_json(strikewave, shot):
    code, out, err = strikewave("srs", shot, "--channel", "bord")
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert '"bord"' in err


def test_a_file_that_is_none_is_bad_input(strikewave):
    with open("empty.csv", "w"):
        pass
    os.mkdir("folder")
    for name, told in (
        ("missing.csv", "no such file: missing.csv"),
        ("empty.csv", "empty.csv cannot be used"),
        ("folder", "no such file: folder; this is a folder; name its files"),
    ):
        code, out, err = strikewave("srs", name, "--json")
        assert (code, out) == (2, "")
        assert told in err


def test_a_folder_appears_whole(strikewave, shot, read_page):
    code, out, err = strikewave("srs", shot, "--kind", "absolute", "--kind", "pseudo-velocity")
    assert code == 0
    names = ["record.toml", "report.html", "spectrum.csv", "summary.svg", "tripartite.svg"]
    assert sorted(os.listdir("out/srs-shot")) == names
    assert "Shock response spectrum" in out
    assert "written: out/srs-shot/" in err
    with open("out/srs-shot/spectrum.csv") as file:
        header, *rows = file.read().splitlines()
    assert header == "frequency [Hz],absolute [m/s^2],pseudo-velocity [m/s]"
    found = document(strikewave("srs", shot, "--json")[1])
    assert [float(row.split(",")[1]) for row in rows] == pytest.approx(found["absolute"])
    for name in ("summary.svg", "tripartite.svg"):
        ElementTree.parse(f"out/srs-shot/{name}")
    page = read_page("out/srs-shot/report.html")
    largest = f"{max(found['absolute']) / 9.80665:.4g} g"
    assert any("largest absolute response" in label and value == largest for label, value in page.numbers.items())
    assert page.pictures == 4


@pytest.mark.verify
def test_a_record_that_swings_is_good_for_a_spectrum(strikewave):
    """What is no one-sided blow is no fault of a spectrum: a pyroshock swings."""
    k = np.maximum(np.arange(-4000.0, 36_000.0), 0.0)
    values = 5000.0 * np.exp(-k / 3000.0) * np.sin(k / 20.0) * (1.0 - np.exp(-k / 1500.0))
    rows = [f"{STEP * n:.6f},{value:.9g}" for n, value in enumerate(values)]
    with open("pyro.csv", "w") as file:
        file.write("time [s],board [m/s^2]\n" + "\n".join(rows) + "\n")
    _, out, _ = strikewave("srs", "pyro.csv")
    assert "The record is good." in " ".join(out.split())
    _, out, _ = strikewave("record", "pyro.csv")
    assert "One file, bad." in out
