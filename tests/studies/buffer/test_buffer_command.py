"""``strikewave buffer`` as a user types it: documents, files, the way back, records, and what bad input is told."""

import csv
import json
import math
import os
import tomllib

import numpy as np
import pytest

from strikewave.base.constants import STANDARD_GRAVITY
from strikewave.cases.case import parse_case

BAR = """
schema = 1
name = "bar"
[[stack.layer]]
name = "bar"
material = "65Mn"
length = "200 mm"
diameter = "30 mm"
[load]
shape = "sine-squared"
peak = "40 kN"
duration = "60 us"
[[tap]]
name = "end"
layer = "bar"
position = 1.0
[solver]
duration = "400 us"
"""
SENSOR = """
[[sensor]]
name = "acc"
tap = "end"
resonance = "100 kHz"
range = "60000 g"
mass = "5 gram"
[[sensor.gasket]]
material = "PTFE"
thickness = "1 mm"
diameter = "15 mm"
"""
FEW = ("--material", "rubber", "--material", "PTFE", "--thickness", "1 mm", "--layers", "2")


@pytest.fixture
def bar(strikewave):
    with open("bar.toml", "w") as file:
        file.write(BAR + SENSOR)
    return "bar.toml"


@pytest.fixture
def shot(strikewave):
    """A half-sine of 10 000 g and 60 us, in g, at 1 MHz."""
    t = np.arange(1500) * 1e-6
    values = np.where((t > 2e-4) & (t < 2.6e-4), 1e4 * np.sin(np.pi * (t - 2e-4) / 60e-6), 0.0)
    rows = "\n".join(f"{a:.6f},{b:.9g}" for a, b in zip(t, values, strict=True))
    with open("shot.csv", "w") as file:
        file.write("time [s],base [g]\n" + rows + "\n")
    return "shot.csv"


def test_json_ranks_every_stack_and_writes_nothing(strikewave, bar):
    code, out, err = strikewave("buffer", bar, "--limit", "5000 g", *FEW, "--json")
    found = json.loads(out)
    assert code == 0
    assert set(found) >= {
        "schema",
        "version",
        "units",
        "warnings",
        "limit",
        "rank",
        "kept",
        "sensor",
        "blow",
        "candidates",
    }
    assert found["limit"] == pytest.approx(5000 * STANDARD_GRAVITY)
    # none, 2 of one gasket, 4 of two
    assert [row["place"] for row in found["candidates"]] == [1, 2, 3, 4, 5, 6, 7]
    first = found["candidates"][0]
    assert first["keeps"]
    assert abs(first["peak"]) <= found["limit"]
    assert next(row for row in found["candidates"] if row["name"] == "direct")["within_10"] is None
    assert "does not load it back" in found["back_effect"]
    assert {name: row["status"] for name, row in found["materials"].items()} == {
        "rubber": "quoted",
        "PTFE": "from memory",
    }
    numbers = {key for row in found["candidates"] for key, value in row.items() if isinstance(value, float)}
    assert numbers <= set(found["units"])
    assert os.listdir() == ["bar.toml"]
    assert "done in" in err


@pytest.mark.verify
def test_the_written_case_reads_what_the_study_said(strikewave, bar, read_page):
    code, out, _ = strikewave("buffer", bar, "--limit", "5000 g", *FEW, "--out", "there")
    assert code == 0
    files = {
        "case.toml",
        "buffer.json",
        "buffers.csv",
        "peak-bandwidth.svg",
        "histories.svg",
        "transmissibility.svg",
        "report.html",
        "runs.sqlite",
    }
    assert set(os.listdir("there")) == files
    assert "back-effect" in out
    with open("there/buffer.json") as file:
        first = json.load(file)["candidates"][0]
    with open("there/buffers.csv") as file:
        rows = list(csv.DictReader(file))
    assert float(rows[0]["peak [m/s^2]"]) == pytest.approx(first["peak"], rel=1e-8)
    assert first["name"] in out
    page = read_page("there/report.html")
    assert page.numbers["reading on the first"] == f"{first['true_peak'] / 9.80665:.4g} g"
    assert page.pictures == 3
    assert first["name"] in page.text
    assert "strikewave buffer bar.toml --limit" in page.text
    _, out, _ = strikewave("wave", "--no-band", "there/case.toml", "--json")
    assert json.loads(out)["sensors"]["acc"]["peak"] == pytest.approx(first["peak"], rel=1e-9)


@pytest.mark.verify
def test_a_result_is_replaced_by_force_and_other_files_never(strikewave, bar):
    words = ("buffer", bar, *FEW, "--out", "there")
    assert strikewave(*words, "--limit", "5000 g")[0] == 0
    code, _, err = strikewave(*words, "--limit", "5000 g", "--set", "load.peak=20 kN")
    assert code == 2
    assert "--force" in err
    assert strikewave(*words, "--limit", "5000 g", "--set", "load.peak=20 kN", "--force")[0] == 0
    with open("there/mine.txt", "w") as file:
        file.write("mine")
    assert strikewave(*words, "--limit", "5000 g", "--force")[0] == 2
    assert os.path.isfile("there/mine.txt")


@pytest.mark.verify
@pytest.mark.parametrize("rank", ["bandwidth", "peak"])
def test_without_layers_there_is_only_the_direct_mounting(strikewave, bar, rank):
    code, out, err = strikewave("buffer", bar, "--limit", "50000 g", "--layers", "0", "--rank", rank, "--out", "there")
    assert code == 0
    assert "1 of 1 stacks keep" in out
    assert "internal" not in err
    with open("there/case.toml") as file:
        assert "gasket" not in tomllib.loads(file.read())["sensor"][0]


def test_no_stack_that_keeps_the_limit_ends_with_3_and_says_what_stands_against_it(strikewave, bar):
    code, out, err = strikewave("buffer", bar, "--limit", "20 g", *FEW, "--json")
    assert code == 3
    assert not json.loads(out)["kept"]
    assert "limit-not-kept" in err or "limit-not-kept" in out
    assert "rigid-body pulse itself" in out


def test_a_record_at_the_mounting_surface(strikewave, shot):
    words = ("--mass", "5 gram", "--diameter", "15 mm", "--record", shot)
    code, out, _ = strikewave("buffer", *words, "--limit", "5000 g", *FEW, "--json")
    found = json.loads(out)
    assert code == 0
    # the sine is zero at its ends but its largest sample is the top
    assert found["blow"]["surface_peak"] == pytest.approx(1e4 * STANDARD_GRAVITY, rel=1e-6)
    change = 2.0 / math.pi * 60e-6 * 1e4 * STANDARD_GRAVITY
    assert found["blow"]["surface_velocity_change"] == pytest.approx(change, rel=1e-3)
    assert found["blow"]["rigid_peak"] is None
    assert {"record-bandwidth"} <= {w["code"] for w in found["warnings"]}


@pytest.mark.verify
def test_a_record_has_one_peak_width_and_velocity_change_whatever_reads_it(strikewave, tmp_path):
    """The largest sample of a noisy record stands above its peak by about two standard deviations of the noise."""
    time = np.arange(0.0, 6e-3, 2e-6)
    pulse = 1200.0 * np.sin(np.pi * (time - 2e-3) / 5e-4) * ((time > 2e-3) & (time < 2.5e-3))
    values = pulse + 3.0 + np.random.default_rng(3).normal(0.0, 6.0, time.size)
    table = np.column_stack([time, values])
    np.savetxt("noisy.csv", table, "%.9g", ",", header="time (s),board (g)", comments="")
    of_record = json.loads(strikewave("record", "noisy.csv", "--json")[1])["files"][0]["channels"][0]["pulses"][0]
    words = ("--mass", "5 gram", "--diameter", "15 mm", "--record", "noisy.csv", "--limit", "5000 g", *FEW)
    of_buffer = json.loads(strikewave("buffer", *words, "--json")[1])["blow"]
    same = {"peak": "surface_peak", "width": "pulse_width", "velocity_change": "surface_velocity_change"}
    assert {key: of_record[key] for key in same} == {key: of_buffer[name] for key, name in same.items()}
    assert of_record["peak"] / STANDARD_GRAVITY == pytest.approx(1200.0, abs=3.0)  # noise over the root of some 30
    above = (of_buffer["largest_sample"] - of_buffer["surface_peak"]) / STANDARD_GRAVITY
    assert 3.0 < above < 24.0
    assert f"(largest sample {of_buffer['largest_sample'] / STANDARD_GRAVITY:.5g} g" in strikewave("buffer", *words)[1]


@pytest.mark.verify
def test_the_sensor_that_a_record_leaves_fits_into_a_case(strikewave, shot, read_page):
    words = ("--mass", "5 gram", "--diameter", "15 mm", "--model", "Endevco 7270A-20K", "--record", shot)
    assert strikewave("buffer", *words, "--limit", "5000 g", *FEW, "--out", "there")[0] == 0
    assert {"record.toml", "sensor.toml"} <= set(os.listdir("there"))
    assert "Its recorder is ideal." in read_page("there/report.html").text
    with open("there/sensor.toml") as file:
        text = file.read()
    with open("there/buffer.json") as file:
        name = json.load(file)["candidates"][0]["name"]
    assert " | ".join(f"{g['material']} {g['thickness']}" for g in tomllib.loads(text)["sensor"][0]["gasket"]) == name
    case = parse_case(BAR + text)
    assert case.sensor[0].model == "Endevco 7270A-20K"


def test_a_record_with_the_sensor_of_a_case(strikewave, bar, shot):
    code, out, _ = strikewave("buffer", bar, "--record", shot, "--limit", "5000 g", *FEW, "--json")
    found = json.loads(out)
    assert code == 0
    assert found["sensor"]["name"] == "acc"
    assert found["sensor"]["resonance"] == 1e5


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--limit", "5000"], ["--limit", 'write "5000 m/s^2"']),
        ([], ["--limit", "missing"]),
        (["--limit", "0 g"], ["--limit", "above zero"]),
        (["--limit", "-3 g"], ["--limit", "above zero"]),
        (["--limit", "5 kg"], ["--limit", "an acceleration"]),
        (["--limit", "5000 g", "--material", "PTFF"], ["--material", 'did you mean "PTFE"?']),
        (["--limit", "5000 g", "--thickness", "0 mm"], ["--thickness", "above 0 m"]),
        (["--limit", "5000 g", "--thickness", "1"], ["--thickness", "a bare number has no unit"]),
        (["--limit", "5000 g", "--thickness", "nan mm"], ["--thickness"]),
        (["--limit", "5000 g", "--thickness", "5 m"], ["--thickness", "at most 0.1 m"]),
        (["--limit", "5000 g", "--sensor", "ac"], ["--sensor", 'did you mean "acc"?']),
        (["--limit", "5000 g", "--layers", "-1"], ["--layers", "from 0 to 10"]),
        (["--limit", "5000 g", "--layers", "9"], ["--layers", "at most 20000"]),
        (["--limit", "5000 g", "--rank", "price"], ["--rank", "bandwidth, peak, robust"]),
        (["--limit", "5000 g", "--blow", "99"], ["--blow", "from 1 to 1"]),
        (["--limit", "5000 g", "--record", "none.csv", "--blow", "2"], ["--blow", "without --record"]),
        (["--limit", "5000 g", "--model", "Endevco"], ["accelerometer"]),
        (["--limit", "5000 g", "--mass", "0 gram"], ["--mass", "above 0 kg"]),
        (["--limit", "5000 g", "--diameter", "wide"], ["--diameter", "a length"]),
        (["--limit", "5000 g", "--record", "none.csv"], ["none.csv"]),
    ],
)
def test_bad_words_are_told_what_is_allowed(strikewave, bar, words, told):
    code, out, err = strikewave("buffer", bar, *words, "--json")
    assert code == 2
    assert out == ""
    for part in told:
        assert part in err
    assert "internal" not in err


def test_a_case_without_sensor_or_tap(strikewave):
    with open("bare.toml", "w") as file:
        file.write(BAR)
    code, _, err = strikewave("buffer", "bare.toml", "--limit", "5000 g")
    assert code == 2
    assert "[[sensor]]" in err
    with open("lost.toml", "w") as file:
        file.write(BAR + SENSOR.replace('tap = "end"', 'tap = "ende"'))
    code, _, err = strikewave("buffer", "lost.toml", "--limit", "5000 g")
    assert code == 2
    assert 'did you mean "end"?' in err


def test_a_sensor_without_mass_or_footprint_is_told_how_to_give_them(strikewave):
    bare = SENSOR[: SENSOR.index("mass")]
    with open("bare.toml", "w") as file:
        file.write(BAR + bare)
    for given, missing in (([], '--mass "5 gram"'), (["--mass", "5 gram"], '--diameter "15 mm"')):
        code, _, err = strikewave("buffer", "bare.toml", "--limit", "5000 g", *given)
        assert code == 2
        assert missing in err
    words = ("--mass", "5 gram", "--diameter", "15 mm", *FEW, "--json")
    assert strikewave("buffer", "bare.toml", "--limit", "50000 g", *words)[0] == 0


def test_neither_case_nor_record(strikewave):
    code, _, err = strikewave("buffer", "--limit", "5000 g")
    assert code == 2
    assert "--record" in err


@pytest.mark.verify
def test_the_robust_rank_leaves_a_robust_stack_in_the_case(strikewave, bar):
    thick = ("--material", "rubber", "--thickness", "1 mm", "--thickness", "5 mm", "--layers", "1")
    firsts = {}
    for rank in ("bandwidth", "robust"):
        words = ("--limit", "9000 g", "--rank", rank, *thick, "--set", "solver.duration=2 ms", "--out", rank)
        assert strikewave("buffer", bar, *words)[0] == 0
        with open(f"{rank}/buffer.json") as file:
            firsts[rank] = json.load(file)["candidates"][0]
        with open(f"{rank}/case.toml") as file:
            gasket = tomllib.loads(file.read())["sensor"][0]["gasket"][0]
        assert f"rubber {gasket['thickness']['value']}" == firsts[rank]["name"]
    assert firsts["robust"]["robust"]
    assert not firsts["bandwidth"]["robust"]


@pytest.mark.verify
def test_the_screen_begins_with_words_and_its_rows_are_in_order(strikewave, bar, monkeypatch):
    for columns in ("160", "80"):
        monkeypatch.setenv("COLUMNS", columns)
        names = ("--material", "rubber", "--material", "polycarbonate", "--thickness", "0.5 mm")
        code, out, err = strikewave("buffer", bar, "--limit", "5000 g", *names, "--out", "there", "--force")
        assert code == 0
        assert err[0].strip()
        lines = out.splitlines()
        assert max(map(len, lines[:-1])) <= int(columns)
        begin = next(k for k, line in enumerate(lines) if line.startswith("─"))
        end = next((k for k, line in enumerate(lines) if "stacks with" in line), len(lines))
        ranking = lines[begin:end]
        firsts = [line.split()[0].rstrip("*") for line in ranking if line.strip()]
        places = [int(word) for word in firsts if word.isdigit()]
        assert len(places) > 3
        assert places == sorted(places)
        assert "now: PTFE 1 mm" in out
        # a number and its unit stay together; with room, so does the name of a gasket
        parted = ("0.5",) if columns == "80" else ("rubber", "polycarbonate", "0.5")
        assert [line for line in ranking if line.rstrip().endswith(parted)] == []


def _write(name, values):
    rows = "\n".join(f"{1e-6 * k:.6f},{value:.9g}" for k, value in enumerate(values))
    with open(name, "w") as file:
        file.write("time [s],base [g]\n" + rows + "\n")


def test_a_record_that_its_examination_calls_bad_is_refused(strikewave):
    t = np.arange(3000)
    _write("drift.csv", 15.0 * np.sin(2.0 * np.pi * t / 900.0) + 10.0 * t / 3000.0)
    words = ("--mass", "5 gram", "--diameter", "15 mm", "--limit", "5000 g", *FEW, "--json")
    code, out, err = strikewave("buffer", "--record", "drift.csv", *words)
    assert code == 2
    assert out == ""
    assert "no-pulse" in err


def test_a_real_record_without_a_blow_is_refused(strikewave, measured):
    words = ("--unit", "g", "--mass", "5 gram", "--diameter", "15 mm", "--limit", "5000 g", *FEW, "--json")
    code, _, err = strikewave("buffer", "--record", str(measured("smd-5kg-impacts") / "impact_00.lvm"), *words)
    assert code == 2
    assert "no-pulse" in err
    assert "not-settled" in err


@pytest.mark.verify
def test_what_is_suspect_in_a_record_is_among_the_warnings(strikewave):
    t = np.arange(3000)
    _write("downwards.csv", np.where((t > 500) & (t < 560), -1e4 * np.sin(np.pi * (t - 500) / 60.0), 0.0))
    words = ("--mass", "5 gram", "--diameter", "15 mm", "--limit", "9000 g", *FEW, "--json")
    code, out, _ = strikewave("buffer", "--record", "downwards.csv", *words)
    assert code == 0
    suspect = [w["message"] for w in json.loads(out)["warnings"] if w["code"] == "record-suspect"]
    assert any(message.startswith("polarity:") for message in suspect)


def test_a_record_in_volts_needs_its_sensitivity(strikewave, shot):
    words = ("--record", shot, "--unit", "mV", "--mass", "5 gram", "--diameter", "15 mm", *FEW)
    code, _, err = strikewave("buffer", *words, "--limit", "5000 g", "--json")
    assert code == 2
    assert "--sensitivity" in err
