"""strikewave srs of several records, of axes, of sliding windows and of one oscillator; its filters."""

import csv
import json
import math
import os
from xml.etree import ElementTree

import numpy as np
import pytest

from strikewave.signal.srs import Scope, response_history, resultant_srs, rms_spectrum, rolling_srs, srs

STEP, FREQUENCIES = 1e-5, [100.0, 500.0, 2000.0]
WORDS = [word for f in FREQUENCIES for word in ("--frequency", f"{f:g}")]


def half_sine(peak, start=500, length=100, size=5000):
    u = (np.arange(size) - start) / length
    return np.where((u > 0.0) & (u < 1.0), peak * np.sin(np.pi * u), 0.0)


def write(name, **channels):
    """Channels in m/s^2."""
    rows = zip(*channels.values(), strict=True)
    with open(name, "w") as file:
        file.write(",".join(["time [s]", *(f"{channel} [m/s^2]" for channel in channels)]) + "\n")
        file.writelines(
            f"{k * STEP:.6f}," + ",".join(f"{value:.12g}" for value in row) + "\n" for k, row in enumerate(rows)
        )
    return name


@pytest.fixture
def found(strikewave):
    def run(*words):
        code, out, err = strikewave("srs", *words, *WORDS, "--json")
        assert code == 0, err
        return json.loads(out)

    return run


PEAKS = (900.0, 1000.0, 1110.0)


@pytest.fixture
def shots(strikewave):
    return [write(f"a{k}.csv", x=half_sine(peak)) for k, peak in enumerate(PEAKS)]


def test_envelope_is_the_largest_and_the_limit_that_of_log_normal_spectra(found, shots):
    document = found(*shots)
    unit = srs(half_sine(1.0), STEP, FREQUENCIES).maximax
    assert [one["file"] for one in document["spectra"]] == shots
    for one, peak in zip(document["spectra"], PEAKS, strict=True):
        assert one["absolute"] == pytest.approx(peak * unit, rel=1e-6)
    assert document["envelope"]["absolute"] == pytest.approx(1110.0 * unit, rel=1e-6)
    logs = np.log10(PEAKS)
    # P95/50 of three: k = 1.939, of the non-central t distribution (NIST handbook, 7.2.6.3)
    limit = 10.0 ** (logs.mean() + 1.939 * logs.std(ddof=1))
    assert document["p95_50"]["absolute"] == pytest.approx(limit * unit, rel=1e-4)


@pytest.mark.verify
def test_a_record_without_a_blow_enters_no_envelope_and_is_named(strikewave, found, shots):
    quiet = write("quiet.csv", x=np.random.default_rng(1).normal(size=5000))
    document = found(*shots, quiet)
    assert document["spectra"][-1]["status"] == "bad"
    assert "no blow" in document["spectra"][-1]["left_out"]
    assert [warning["code"] for warning in document["warnings"]] == ["left-out"]
    assert document["envelope"] == found(*shots)["envelope"]
    _, out, err = strikewave("srs", *shots, quiet, *WORDS)
    assert "quiet.csv, x enters no envelope" in err
    assert "Left out: quiet.csv." in " ".join(out.split())


def test_a_record_of_half_the_gain_of_its_siblings_enters_no_envelope(found):
    noise = np.random.default_rng(4)
    peaks = (1000.0, 985.0, 505.0, 1010.0, 1005.0, 990.0)
    files = [write(f"b{k}.csv", x=half_sine(peak) + noise.normal(size=5000)) for k, peak in enumerate(peaks)]
    document = found(*files)
    assert [one["left_out"] is None for one in document["spectra"]] == [True, True, False, True, True, True]
    assert "is the gain set otherwise?" in document["spectra"][2]["left_out"]
    del files[2]
    assert document["p95_50"] == found(*files)["p95_50"]


def test_what_harms_some_spectra_names_their_files(found, shots):
    t = np.arange(5000) * STEP
    drifting = write("drifting.csv", x=half_sine(1000.0) + 4e3 * t)
    warnings = found(*shots, drifting)["warnings"]
    assert warnings
    assert all(warning["message"].startswith("drifting.csv, x: ") for warning in warnings)


def test_a_record_without_a_clock_is_refused_and_a_short_one_has_no_windows(strikewave, shots):
    with open("still.csv", "w") as file:
        file.write("time [s],x [m/s^2]\n" + "0,1\n" * 40)
    code, _, err = strikewave("srs", "still.csv")
    assert code == 2
    assert "still.csv cannot be used; needed: time stamps that differ; state the sampling rate by --rate" in err
    code, out, err = strikewave("srs", shots[0], "still.csv", *WORDS, "--json")
    assert code == 3
    assert len(json.loads(out)["spectra"]) == 1
    short = write("short.csv", x=np.arange(10.0))
    code, out, err = strikewave("srs", *shots, short, *WORDS, "--json", "--rolling", "10 ms")
    assert code == 0, err
    assert ["rolling" in one for one in json.loads(out)["spectra"]] == [True, True, True, False]


def test_a_file_that_cannot_be_read_is_named_and_fails(strikewave, shots):
    code, out, err = strikewave("srs", *shots, "gone.csv", *WORDS, "--json")
    assert code == 3
    assert [warning["code"] for warning in json.loads(out)["warnings"]] == ["unreadable"]
    assert "left out: no such file: gone.csv" in err


def test_two_channels_have_an_envelope_and_no_limit(found):
    write("two.csv", x=half_sine(1000.0), y=half_sine(500.0, length=200))
    document = found("two.csv", "--channel", "x", "--channel", "y")
    assert [one["channel"] for one in document["spectra"]] == ["x", "y"]
    assert "p95_50" not in document
    largest = np.maximum(*(one["absolute"] for one in document["spectra"]))
    assert document["envelope"]["absolute"] == pytest.approx(largest.tolist())


def test_resultant_is_that_of_the_library_and_of_one_shock_that_shock(found):
    write("axes.csv", x=half_sine(600.0), y=half_sine(800.0), z=half_sine(300.0, 700))
    axes = ("--channel", "x", "--channel", "y")
    both = found("axes.csv", *axes, "--resultant")["resultant"]["absolute"]
    # 3-4-5: one shock of 1000 along an oblique line; the parabola between samples is good to 1e-4
    assert both == pytest.approx(srs(half_sine(1000.0), STEP, FREQUENCIES).maximax, rel=1e-4)
    three = found("axes.csv", *axes, "--channel", "z", "--resultant")["resultant"]["absolute"]
    histories = [half_sine(600.0), half_sine(800.0), half_sine(300.0, 700)]
    assert three == pytest.approx(resultant_srs(histories, STEP, FREQUENCIES), rel=1e-6)


def test_rolling_response_rms_and_beginning_are_those_of_the_library(found):
    values = half_sine(1000.0)
    write("a.csv", x=values)
    document = found("a.csv", "--rolling", "10 ms,5 ms", "--response", "500 Hz", "--rms")
    rolling = rolling_srs(values, STEP, FREQUENCIES, (0.01, 0.005))
    assert document["rolling"]["time"] == pytest.approx(rolling.time)
    assert np.array(document["rolling"]["values"]) == pytest.approx(rolling.maximax, rel=1e-6, abs=1e-6)
    history = response_history(values, STEP, 500.0)
    assert np.array(document["response"]["absolute"]) == pytest.approx(history, rel=1e-6, abs=1e-6)
    assert document["rms"]["absolute"] == pytest.approx(rms_spectrum(values, STEP, FREQUENCIES), rel=1e-6)
    tail = values + 50.0 * (np.arange(values.size) < 400)
    write("late.csv", x=tail)
    zero = found("late.csv", "--initial", "steady")["zero_line"]
    for initial in ("shifted", "steady"):
        document = found("late.csv", "--initial", initial)
        expected = srs(tail - zero, STEP, FREQUENCIES, scope=Scope(initial=initial)).maximax
        assert document["absolute"] == pytest.approx(expected, rel=1e-6)
        assert document["initial"] == initial


@pytest.mark.verify
def test_channels_and_files_have_rolling_spectra_and_responses_each(strikewave, found):
    write("two.csv", x=half_sine(1000.0), y=half_sine(500.0, 700))
    write("late.csv", x=half_sine(300.0, 900), y=half_sine(0.0))
    asked = ("--rolling", "10 ms,5 ms", "--response", "500 Hz")
    both = found("two.csv", "--channel", "x", "--channel", "y", *asked)["spectra"]
    files = found("two.csv", "late.csv", *asked)["spectra"]
    for one, of in zip(
        [*both, files[1]], [half_sine(1000.0), half_sine(500.0, 700), half_sine(300.0, 900)], strict=True
    ):
        history = response_history(of, STEP, 500.0)
        assert np.array(one["response"]["absolute"]) == pytest.approx(history, rel=1e-6, abs=1e-6)
        rolling = rolling_srs(of, STEP, FREQUENCIES, (0.01, 0.005)).maximax
        assert np.array(one["rolling"]["values"]) == pytest.approx(rolling, rel=1e-6, abs=1e-6)
    code, _, err = strikewave("srs", "two.csv", "late.csv", *WORDS, *asked, "--out", "all")
    assert code == 0, err
    for name, lines in (("response", 2 * 5000), ("rolling", 2 * len(FREQUENCIES) * len(both[0]["rolling"]["time"]))):
        ElementTree.parse(f"all/{name}.svg")
        with open(f"all/{name}.csv") as file:
            head, *rows = csv.reader(file)
        assert head[:3] == ["file", "channel", "time [s]"]
        assert len(rows) == lines
        assert {row[0] for row in rows} == {"two.csv", "late.csv"}


@pytest.mark.verify
def test_files_share_the_frequencies_that_the_slowest_can_carry_in_any_order(strikewave, shots):
    with open("slow.csv", "w") as file:
        file.write("time [s],x [m/s^2]\n")
        file.writelines(f"{k * 1e-4:.4f},{value:.9g}\n" for k, value in enumerate(half_sine(800.0)[::10]))
    wanted = ("--from", "10 Hz", "--per-octave", "3", "--json")
    grids = []
    for files in ((shots[0], "slow.csv"), ("slow.csv", shots[0])):
        code, out, err = strikewave("srs", *files, *wanted)
        assert code == 0, err
        grids.append(json.loads(out)["frequency"])
    assert grids[0] == grids[1]
    assert 2.0 ** (-1 / 3) * 0.4 * 10e3 < grids[0][-1] <= 0.4 * 10e3  # 2/5 of 10 kHz
    _, out, _ = strikewave("srs", shots[0], "slow.csv")
    assert "in common: the lowest sampling rate is 10 kHz of slow.csv" in " ".join(out.split())
    _, _, err = strikewave("srs", shots[0], "slow.csv", "--to", "6 kHz")
    assert "half the sampling rate of slow.csv, 5000 Hz" in err


@pytest.mark.verify
def test_files_of_all_of_it(strikewave, shots):
    for turn in ("first", "again"):  # every file that it wrote is one of a result, and may be replaced
        words = ("--rolling", "10 ms", "--response", "1 kHz", "--out", "one")
        code, _, err = strikewave("srs", shots[0], *WORDS, *words)
        assert code == 0, (turn, err)
    assert code == 0, err
    code, _, err = strikewave("srs", *shots, *WORDS, "--rms", "--out", "many")
    assert code == 0, err
    for name in ("one/rolling.svg", "one/response.svg", "one/summary.svg", "many/summary.svg"):
        ElementTree.parse(name)
    with open("one/rolling.csv") as file:
        head, *rows = csv.reader(file)
    assert head == ["time [s]", "frequency [Hz]", "absolute [m/s^2]"]
    assert len(rows) == 3 * len({row[0] for row in rows})
    with open("many/spectrum.csv") as file:
        head = next(csv.reader(file))
    assert head[:3] == ["frequency [Hz]", "absolute envelope [m/s^2]", "absolute p95_50 [m/s^2]"]
    assert "absolute rms of a2.csv, x [m/s^2]" in head
    assert "report.html" in os.listdir("many")


def test_filters_are_those_of_record(found, strikewave):
    write("drifting.csv", x=half_sine(1000.0) + 5.0 * np.sin(2.0 * math.pi * 8.0 * np.arange(5000) * STEP))
    plain, low = found("drifting.csv"), found("drifting.csv", "--filter", "600 Hz")
    # a half-sine of 1 ms through 600 Hz loses some at 2 kHz and little at 100 Hz
    assert low["absolute"][2] < 0.97 * plain["absolute"][2]
    assert low["absolute"][0] == pytest.approx(plain["absolute"][0], rel=0.02)
    code, out, err = strikewave("record", "drifting.csv", "--high-pass", "40 Hz", "--json")
    assert code == 0, err
    [told] = [f for f in json.loads(out)["files"][0]["channels"][0]["health"] if f["code"] == "high-pass"]
    # the high-pass takes about cutoff times length, 4 %, off: a small share, and not none
    assert 0.85 < told["value"] < 0.99


@pytest.mark.parametrize(
    ("words", "field", "came", "allowed"),
    [
        (("a0.csv", "--rolling", "1 s"), "--rolling", '"1 s"', "the whole record"),
        (("a0.csv", "--rolling", "1 us"), "--rolling", '"1 us"', "two samples"),
        (("a0.csv", "--rolling", "10 ms,1 ns"), "--rolling", '"10 ms,1 ns"', "a hop of one sample"),
        (("a0.csv", "--rolling", "10 Hz"), "--rolling", '"10 Hz"', "a window and a hop"),
        (("a0.csv", "--rolling", "1 ms,2 ms,3 ms"), "--rolling", '"1 ms,2 ms,3 ms"', "a window and a hop"),
        (("a0.csv", "a1.csv", "--end", "1 s"), "--end", '"1 s"', "a time of a0.csv from 0 s to 0.04999 s"),
        (("a0.csv", "--resultant"), "--resultant", '"1 channel"', "2 or 3 perpendicular channels"),
        (("a0.csv", "a1.csv", "--resultant"), "--resultant", '"2 files"', "the channels of one file"),
        (("a0.csv", "--resultant", "--side", "positive"), "--side", '"positive"', "a length has no sign"),
        (("a0.csv", "--high-pass", "60 kHz"), "--high-pass", '"60 kHz"', "below half the sampling rate"),
        (("a0.csv", "--high-pass", "1 mHz"), "--high-pass", '"0.001 Hz"', "half a period a record"),
        (("a0.csv", "--high-pass", "0"), "--high-pass", '"0"', "above zero"),
        (("a0.csv", "--filter", "5 kHz", "--cfc", "60"), "--cfc", '"60"', "either --filter or --cfc"),
        (("a0.csv", "--response", "60 kHz"), "--response", '"60 kHz"', "half the sampling rate"),
        (("a0.csv", "--initial", "moving"), "--initial", '"moving"', "rest, shifted, steady"),
        (("none.csv", "gone.csv"), "left out", "none.csv", "no such file"),
    ],
)
def test_wrong_input_says_field_what_came_and_what_is_allowed(strikewave, shots, words, field, came, allowed):
    code, out, err = strikewave("srs", *words)
    assert (code, out) == (2, "")
    for part in (field, came, allowed):
        assert part in err
    assert "Traceback" not in err
