"""Calibration: hand-computed factors, precedence of what is stated, and nonsense refused by the name of its field."""

import json
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from strikewave.base.errors import InputError
from strikewave.records import Channel, Record, Request, calibrations_beside, read_file
from strikewave.records.calibration import ChannelCalibration, calibrated, calibration_of, laid_over, read_calibrations

G = 9.80665


@pytest.mark.parametrize(
    ("parts", "file_unit", "factor", "unit"),
    [
        ({"sensitivity": "1.2 mV/g", "gain": "10"}, "V", G / 0.012, "m/s^2"),
        ({"sensitivity": "1.2 mV/g"}, "mV", 1e-3 * G / 0.0012, "m/s^2"),
        ({"sensitivity": "5 mV/(m/s^2)"}, "V", 200.0, "m/s^2"),
        ({"sensitivity": "0.2 uV/V/g", "excitation": "5 V"}, "V", G / 1e-6, "m/s^2"),
        ({"sensitivity": "0.2 uV/V/g", "excitation": "5 V", "gain": "100"}, "V", G / 1e-4, "m/s^2"),
        ({"sensitivity": "2 mV/g", "excitation": "5 V", "rated_excitation": "10 V"}, "V", G / 1e-3, "m/s^2"),
        ({"sensitivity": "4 pC/g", "gain": "10 mV/pC"}, "V", G / 0.04, "m/s^2"),
        ({"sensitivity": "-4 pC/N", "gain": "1 mV/pC"}, "V", -250.0, "N"),
        ({"sensitivity": "2 mV/N"}, "V", 500.0, "N"),
        ({"sensitivity": "20 mV/MPa"}, "V", 5e7, "Pa"),
        ({"sensitivity": "2 mV/ustrain"}, "V", 5e-4, "1"),
        ({"sensitivity": "0.5 uV/V/ustrain", "excitation": "4 V"}, "V", 0.5, "1"),
        ({"sensitivity": "1 mV/g", "count": "305 uV"}, "", 0.305 * G, "m/s^2"),
        ({"sensitivity": "1 mV/g", "polarity": -1}, "V", -1000.0 * G, "m/s^2"),
        ({"sensitivity": "1 mV/g", "unit": "mV"}, "g", G, "m/s^2"),
        ({"polarity": -1}, "g", -G, "m/s^2"),
        ({"unit": "g"}, "", G, "m/s^2"),
        ({"unit": "kN"}, "V", 1e3, "N"),
        ({"unit": "ustrain"}, "", 1e-6, "1"),
        ({"unit": "mV"}, "", 1e-3, "V"),
        ({}, "G", G, "m/s^2"),
        ({}, "[m/s²]", 1.0, "m/s^2"),
        ({}, "MPa", 1e6, "Pa"),
        ({}, "bananas", 1.0, ""),
        ({}, "", 1.0, ""),
    ],
)
def test_factor_is_the_one_computed_by_hand(parts, file_unit, factor, unit):
    scale = ChannelCalibration(**parts).scale(file_unit)
    assert scale.factor == pytest.approx(factor, rel=1e-12)
    assert scale.unit == unit


@pytest.mark.parametrize(
    ("parts", "field"),
    [
        ({"sensitivity": "0 mV/g"}, "sensitivity"),
        ({"sensitivity": "inf mV/g"}, "sensitivity"),
        ({"sensitivity": "nan mV/g"}, "sensitivity"),
        ({"sensitivity": "1e999 mV/g"}, "sensitivity"),
        ({"sensitivity": "1.2"}, "sensitivity"),
        ({"sensitivity": "1.2 mV"}, "sensitivity"),
        ({"sensitivity": "1.2 g/mV"}, "sensitivity"),
        ({"sensitivity": "1,2 mV/g"}, "sensitivity"),
        ({"sensitivity": "1 mV/banana"}, "sensitivity"),
        ({"sensitivity": "1 mV/g " * 1000}, "sensitivity"),
        ({"sensitivity": "1 mV/g", "gain": "0"}, "gain"),
        ({"sensitivity": "1 mV/g", "gain": "inf"}, "gain"),
        ({"sensitivity": "1 mV/g", "gain": "10 dB"}, "gain"),
        ({"sensitivity": "1 pC/g"}, "gain"),
        ({"sensitivity": "1 pC/g", "gain": "10"}, "gain"),
        ({"sensitivity": "1 pC/g", "gain": "0 mV/pC"}, "gain"),
        ({"sensitivity": "1 uV/V/g"}, "excitation"),
        ({"sensitivity": "1 uV/V/g", "excitation": "0 V"}, "excitation"),
        ({"sensitivity": "1 uV/V/g", "excitation": "-5 V"}, "excitation"),
        ({"sensitivity": "1 uV/V/g", "excitation": "5 A"}, "excitation"),
        ({"sensitivity": "1 mV/g", "excitation": "5 V"}, "rated_excitation"),
        ({"sensitivity": "1 mV/g", "rated_excitation": "5 V"}, "excitation"),
        ({"sensitivity": "1 mV/g", "excitation": "5 V", "rated_excitation": "0 V"}, "rated_excitation"),
        ({"sensitivity": "1 mV/g", "count": "0 V"}, "count"),
        ({"sensitivity": "1 mV/g", "count": "-1 mV"}, "count"),
        ({"sensitivity": "1 mV/g", "count": "5"}, "count"),
        ({"sensitivity": "1 mV/g", "unit": "g"}, "unit"),
        ({"unit": "bananas"}, "unit"),
        ({"unit": "degC"}, "unit"),
        ({"gain": "10"}, "gain"),
        ({"count": "1 mV"}, "count"),
        ({"polarity": 0}, "polarity"),
        ({"polarity": 2}, "polarity"),
        ({"polarity": math.nan}, "polarity"),
        ({"polarity": True}, "polarity"),
        ({"polarity": "-1"}, "polarity"),
        ({"polarity": [1]}, "polarity"),
    ],
)
def test_nonsense_is_refused_with_its_field(parts, field):
    with pytest.raises(InputError) as refused:
        ChannelCalibration(**parts).scale("V", "calibration of board")
    assert refused.value.field == f"calibration of board.{field}"
    assert len(str(refused.value)) < 400


@given(
    st.lists(st.floats(-1e9, 1e9), min_size=1, max_size=30),
    st.floats(1e-3, 1e3),
    st.floats(1e-2, 1e3),
    st.sampled_from([1, -1]),
)
def test_calibration_then_its_inverse_returns_the_values(values, sensitivity, gain, polarity):
    given_ = ChannelCalibration(sensitivity=f"{sensitivity!r} mV/g", gain=repr(gain), polarity=polarity)
    volts = Channel("board", np.array(values), 1e-5, unit="V")
    channel, _ = calibrated(volts, given_)
    assert channel.unit == "m/s^2"
    back = channel.values / G * sensitivity * 1e-3 * gain * polarity
    assert np.allclose(back, volts.values, rtol=1e-12, atol=0.0)


def test_a_factor_beyond_the_largest_number_gives_no_warning():
    channel, _ = calibrated(Channel("a", np.array([1e308, 1.0]), 1e-5), ChannelCalibration(unit="kN"))
    assert channel.values.tolist() == [math.inf, 1e3]


@pytest.mark.parametrize(
    ("of_file", "stated", "said"),
    [("mV", "g", True), ("m/s²", "m/s^2", False), ("", "g", False), ("counts", "g", False)],
)
def test_a_unit_that_overrules_that_of_the_file_is_reported(of_file, stated, said):
    found = calibrated(Channel("board", np.array([1.0]), unit=of_file), ChannelCalibration(unit=stated))[1]
    assert [one.code for one in found] == ["unit-overrules"] * said
    assert not said or found[0].message == f"the unit that is stated, {stated}, overrules that of the file, {of_file}"


@pytest.mark.parametrize(
    ("unit", "code"), [("", "unit-unknown"), ("bananas", "unit-unknown"), ("mV", "not-calibrated"), ("g", None)]
)
def test_what_is_not_in_si_is_said(unit, code):
    _, findings = calibrated(Channel("a", np.ones(3), 1e-5, unit=unit), ChannelCalibration())
    assert [finding.code for finding in findings] == ([code] if code else [])
    assert all(finding.severity == "good" for finding in findings)


def test_a_channel_is_meant_by_name_or_number_over_all():
    stated = {"all": {"unit": "V", "polarity": -1}, "2": {"unit": "g"}, "frame": {"unit": "N"}}
    assert calibration_of(stated, "board", 1) == ChannelCalibration(unit="V", polarity=-1)
    assert calibration_of(stated, "board", 2) == ChannelCalibration(unit="g", polarity=-1)
    assert calibration_of(stated, "frame", 1) == ChannelCalibration(unit="N", polarity=-1)


def test_a_later_layer_goes_first_whatever_it_calls_the_channel():
    folder = {"all": {"unit": "V"}, "frame": {"unit": "N"}}
    assert calibration_of(laid_over(folder, {"all": {"unit": "g"}}), "frame", 2).unit == "g"
    assert calibration_of(laid_over(folder, {"2": {"unit": "g"}}), "frame", 2).unit == "g"
    assert calibration_of(laid_over({"2": {"unit": "N"}}, {"frame": {"unit": "g"}}), "frame", 2).unit == "g"
    assert calibration_of(laid_over(folder, {"1": {"unit": "g"}}), "frame", 2).unit == "N"


def test_files_beside_the_data_folder_then_file_then_what_is_typed(tmp_path):
    (tmp_path / "calibration.toml").write_text(
        'schema = 1\n[all]\nunit = "V"\n[channel.frame]\nsensitivity = "1 mV/g"\ngain = 10\n'
    )
    (tmp_path / "shot.csv.toml").write_text('[channel.frame]\nsensitivity = "2 mV/g"\n')
    assert calibrations_beside(tmp_path / "other.csv")["frame"] == {"sensitivity": "1 mV/g", "gain": "10"}
    beside = calibrations_beside(tmp_path / "shot.csv")
    assert calibration_of(beside, "frame", 1) == ChannelCalibration(unit="V", sensitivity="2 mV/g", gain="10")
    record = Record("shot.csv", "text", (Channel("frame", np.ones(20), 1e-5),))
    asked = Request(calibrations={"frame": {"sensitivity": "4 mV/g"}})
    [reading] = read_file(record, beside, asked).channels
    assert reading.calibration == ChannelCalibration(unit="V", sensitivity="4 mV/g", gain="10")
    assert reading.channel.values[0] == pytest.approx(G / 0.04)


def test_nothing_beside_the_data_states_nothing(tmp_path):
    (tmp_path / "calibration.toml").mkdir()
    assert calibrations_beside(tmp_path / "shot.csv") == {}


def test_provenance_is_what_was_stated_as_typed():
    stated = ChannelCalibration(sensitivity="1.20 mV/g", gain="10", polarity=-1).stated()
    assert stated == {"sensitivity": "1.20 mV/g", "gain": "10", "polarity": -1}
    assert json.loads(json.dumps(stated)) == stated


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ('[al]\nunit = "g"', 'did you mean "all"'),
        ('[all]\nunti = "g"', 'did you mean "unit"'),
        ("schema = 2", "schema: got 2"),
        ("schema = true", "schema: got True"),
        ("all = 3", "all: got 3; allowed: a table"),
        ("channel = [1]", "tables [channel.NAME]"),
        ("[channel]\nboard = 3", "board: got 3"),
        ('[[all]]\nunit = "g"', "allowed: a table"),
        ("[all]\nunit = 3", "all.unit: got 3"),
        ("[all]\nunit = true", "all.unit: got True"),
        ('[all]\nunit = ["g"]', "all.unit: got ['g']"),
        ("[all.unit.deep]\nx = 1", "all.unit: got"),
        ("[all]\nunit = 1979-05-27", "all.unit"),
        ("[all]\ngain = true", "all.gain: got True"),
        ("[all]\ngain = " + "9" * 5000, "a calibration in TOML"),
        ("a = " + "[" * 5000 + "]" * 5000, "a calibration in TOML"),
        ("a = " + "{a=" * 3000 + "1" + "}" * 3000, "a calibration in TOML"),
        (".".join(["a"] * 40_000) + " = 1", "key of many parts"),
        ("[" + ".".join(["a"] * 40_000) + "]", "key of many parts"),
        ("x" * 2_000_000, "at most"),
        ("unit = g", "a calibration in TOML"),
    ],
    ids=lambda text: text[:20],
)
def test_a_hostile_calibration_file_is_refused(tmp_path, text, said):
    file = tmp_path / "calibration.toml"
    file.write_text(text)
    with pytest.raises(InputError) as refused:
        read_calibrations(file)
    assert said in str(refused.value)
    assert str(file) in str(refused.value)
    assert len(str(refused.value)) < 600


def test_bytes_that_are_no_text_are_refused(tmp_path):
    (tmp_path / "calibration.toml").write_bytes(b"\xff\xfe\x00[all]")
    with pytest.raises(InputError, match="a calibration in TOML"):
        calibrations_beside(tmp_path / "shot.csv")


@pytest.mark.parametrize("value", ["nan", "inf", "0", '"0"', '"ten"'])
def test_a_gain_of_a_file_is_checked_like_a_typed_one(tmp_path, value):
    file = tmp_path / "calibration.toml"
    file.write_text(f'[all]\nsensitivity = "1 mV/g"\ngain = {value}\n')
    with pytest.raises(InputError, match=r"calibration\.gain"):
        calibration_of(read_calibrations(file), "board", 1).scale("V")
