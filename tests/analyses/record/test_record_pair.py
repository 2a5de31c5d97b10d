"""``record --pair`` and its like in Python: planted delay and gain on screen, in JSON, tables and report; refusals."""

import csv
import json
import math
from pathlib import Path

import numpy as np
import pytest

import strikewave as sw
from strikewave.base.errors import InputError

STEP, DELAY, GAIN = 1e-5, 40e-6, 0.9


@pytest.fixture
def shots(tmp_path, rng):
    """Two files of three channels: a pulse, its copy 40 us later and 10 % smaller, noise."""
    time = STEP * np.arange(4000)
    files = []
    for name in ("a", "b"):

        def pulse(delay):
            u = (time - 0.015 - delay) / 1e-3
            return 500.0 * np.where((u > 0.0) & (u < 1.0), np.sin(np.pi * np.clip(u, 0.0, 1.0)), 0.0)  # fmt: skip

        columns = [time, pulse(0.0), GAIN * pulse(DELAY), np.zeros(time.size)]
        table = np.column_stack(columns) + np.column_stack([np.zeros(time.size), rng.normal(size=(time.size, 3))])
        np.savetxt(tmp_path / f"{name}.csv", table, delimiter=",", header="time (s),left,right,idle", comments="")
        files.append(tmp_path / f"{name}.csv")
    return files


@pytest.mark.verify
def test_delay_and_gain_stand_in_json_and_tables(strikewave, shots):
    words = [str(path) for path in shots]
    code, out, err = strikewave("record", *words, "--unit", "g", "--pair", "left,2", "--out", "x", "--json")
    assert code == 0, err
    document = json.loads(out)
    assert [one["file"] for one in document["pairs"]] == words
    for one in document["pairs"]:
        assert (one["first"], one["second"], one["leads"], one["one_body"]) == ("left", "right", "left", "no")
        assert one["delay"] == pytest.approx(DELAY, abs=4.0 * one["delay_uncertainty"])
        assert one["gain"] == pytest.approx(GAIN, abs=4.0 * one["gain_uncertainty"])
        assert one["delay_uncertainty"] < 2e-6
        assert len(one["transfer"]["frequency"]) == len(one["transfer"]["h1"])
    units = document["units"]
    assert (units["delay"], units["gain"], units["alike_to"], units["common_peak"]) == ("s", "1", "Hz", "m/s^2")
    with open("x/pairs.csv") as file:
        rows = list(csv.DictReader(file))
    assert [row["leads"] for row in rows] == ["left", "left"]
    assert float(rows[0]["delay [s]"]) == pytest.approx(document["pairs"][0]["delay"])
    with open("x/transfer.csv") as file:
        head = next(csv.reader(file))
    assert head[:2] == ["file", "frequency [Hz]"]
    again, _, err = strikewave("record", *words, "--unit", "g", "--pair", "left,2", "--out", "x", "--json")
    assert again == 0, err  # every file that it wrote is one of a result, and may be replaced


@pytest.mark.verify
def test_screen_and_report_say_who_leads(strikewave, shots, read_page):
    code, out, _ = strikewave("record", str(shots[0]), "--unit", "g", "--pair", "1,2", "--out", "x")
    assert code == 0
    assert " ".join(out.split()).startswith("left and right do not move as one rigid body: gain 0.89")
    assert "<dt>one rigid body</dt><dd>no" in Path("x/report.html").read_text("utf-8")
    assert "Two sensors on one object: left and right" in out
    assert "not one rigid body: gain 0.89" in " ".join(out.split())
    assert "Two sensors" in read_page("x/report.html").sections


@pytest.mark.verify
def test_several_files_are_answered_together_at_the_head(strikewave, shots):
    out = strikewave("record", *map(str, shots), "--unit", "g", "--pair", "1,2", "--out", "x")[1]
    assert " ".join(out.split()).startswith("left and right do not move as one rigid body")
    out = strikewave("record", *map(str, shots), "--unit", "g", "--pair", "1,3", "--out", "x", "--force")[1]
    assert "one rigid body" in " ".join(out.split()).partition(". ")[0]


def test_python_takes_what_the_command_takes(shots):
    [found] = sw.record(shots[0], unit="g", examination=sw.Examination(pair=("left", "right"))).pairs
    assert found.leads == "left"
    assert found.found.delay == pytest.approx(DELAY, abs=2e-6)
    assert sw.record(shots[0], unit="g").pairs == []


def test_what_cannot_be_compared_says_why(shots):
    [found] = sw.record(shots[0], unit={"left": "g", "right": "kN"}, examination=sw.Examination(pair=(1, 2))).pairs
    assert found.one_body == "cannot-tell"
    assert "N" in found.why
    assert math.isnan(found.row.delay)


@pytest.mark.parametrize("pair", ["1", "1,1", "1,2,3", "left,", "1,9"])
def test_a_pair_that_is_none_is_refused(strikewave, shots, pair):
    code, _, err = strikewave("record", str(shots[0]), "--unit", "g", "--pair", pair)
    assert code == 2
    assert "--pair" in err
    assert "1,2" in err


def test_a_wrong_pair_in_python_names_the_parameter(shots):
    with pytest.raises(InputError, match=r"^pair"):
        sw.record(shots[0], unit="g", examination=sw.Examination(pair=(1, 9)))
