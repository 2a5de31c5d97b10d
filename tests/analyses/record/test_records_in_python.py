"""The calls of Python on measured files take what the commands take, and give the same."""

import dataclasses
import inspect
from pathlib import Path

import numpy as np
import pytest

import strikewave
from strikewave.base.errors import InputError
from strikewave.cli.group import entries, whole_command

OF_SCREEN = {"out", "json", "force", "show", "pdf", "xlsx", "wide", "verbose", "quiet", "help", "fail_on"}
"""Of the screen, the folder and the exit code: a call returns its result instead."""
GROUPS = {
    "calibration": strikewave.Calibration,
    "reading": strikewave.Reading,
    "filter": strikewave.Filtering,
    "examination": strikewave.Examination,
    "spectra": strikewave.Spectra,
    "scoring": strikewave.Scoring,
    "judging": strikewave.Judging,
}
"""What a call takes as one, by the keyword."""


@pytest.mark.parametrize(
    ("name", "call", "of_others", "otherwise"),
    [
        ("record", strikewave.record, set(), {"paths": "files"}),
        ("srs", strikewave.shock_spectra, {"direction", "cross_axis"}, {"paths": "files"}),
        ("compare", strikewave.compare, {"direction", "cross_axis", "strict"}, {"filter": "cutoff"}),
    ],
    ids=["record", "srs", "compare"],
)
def test_a_call_takes_every_option_of_its_command(name, call, of_others, otherwise):
    options = {parameter.name for parameter in whole_command(name, entries()[name].module).params} - OF_SCREEN
    parameters = inspect.signature(call).parameters
    assert len(parameters) <= 10
    if name == "compare":  # a name says its channel; a filter is a low-pass, and time columns are found
        options -= {"channels", "cfc", *(field.name for field in dataclasses.fields(strikewave.Reading))}
    groups = {key: GROUPS[key] for key in parameters if key in GROUPS and key not in otherwise}
    fields = {field.name for group in groups.values() for field in dataclasses.fields(group)}
    assert fields - of_others | {otherwise.get(key, key) for key in parameters.keys() - groups.keys()} == options


def test_a_keyword_that_a_group_took_over_is_refused_with_its_place(here):
    with pytest.raises(InputError, match=r"gain: got 10; allowed: calibration=strikewave\.Calibration\(gain=\.\.\.\)"):
        strikewave.record("shot.csv", gain=10)
    with pytest.raises(InputError, match=r"q: got 50; allowed: spectra=strikewave\.Spectra\(q=\.\.\.\)"):
        strikewave.shock_spectra("shot.csv", q=50)
    with pytest.raises(InputError, match=r"band: got False; allowed: scoring=strikewave\.Scoring\(band=\.\.\.\)"):
        strikewave.compare("a.csv", "b.csv", band=False)
    with pytest.raises(TypeError, match="unexpected keyword argument 'gian'"):
        strikewave.record("shot.csv", gian=10)


def test_a_group_reads_texts_numbers_and_what_the_command_line_read():
    said = strikewave.Spectra(q="inf", low="0.1 kHz", high=2e4, frequencies="1 kHz", kinds=["absolute"] * 2, end=-1)
    assert (said.q, said.low, said.high, said.end) == (np.inf, 100.0, 2e4, -1.0)
    assert (said.frequencies, said.each_kind) == ([1000.0], ("absolute",))
    assert strikewave.Spectra(frequencies=np.array([100, 200]), q=np.int64(50)).frequencies == [100.0, 200.0]
    assert dataclasses.replace(said, side="positive") == dataclasses.replace(said, side="positive", q=np.inf)
    assert strikewave.Calibration(polarity={"a": -1, 2: 1}, gain=10).polarity == ["a=-1", "2=1"]
    assert dataclasses.astuple(strikewave.Reading(time=2, time_unit="10 us")) == ("2", 1e-5, None)
    assert strikewave.Judging(uncertainty=0.05) == strikewave.Judging(uncertainty="5 %")
    with pytest.raises(InputError, match="none with shock_spectra"):
        strikewave.shock_spectra("a.csv", judging=strikewave.Judging(direction="+x"))


def shot(name="shot.csv", lag=0.0):
    time = np.arange(4000) * 1e-5
    u = (time - 0.01 - lag) / 1e-3
    pulse = 500.0 * np.sin(np.pi * u) * ((u > 0.0) & (u < 1.0)) - 20.0 * np.sin(60.0 * time)
    np.savetxt(name, np.column_stack([time, pulse]), delimiter=",", header="time (s),frame", comments="")
    return name


@pytest.fixture
def here(monkeypatch, tmp_path):
    """An empty folder."""
    monkeypatch.chdir(tmp_path)


@pytest.mark.verify
def test_filters_motion_and_test_are_those_of_the_command(result_of):
    shot()
    with open("test.toml", "w") as file:
        file.write('[test]\nitem = "board 7"\n')
    said = ("--unit", "g", "--cfc", "1000", "--ac-coupling", "200 ms", "--high-pass", "20 Hz", "--motion")
    command, _ = result_of("record", "shot.csv", *said, "--test", "test.toml")
    called = strikewave.record(
        "shot.csv",
        unit="g",
        filter=strikewave.Filtering(cfc=1000, ac_coupling="200 ms", high_pass=20.0),
        examination=strikewave.Examination(motion=True),
        judging=strikewave.Judging(test="test.toml"),
    )
    assert called.document() == command.document()
    assert called.test == command.test == {"item": "board 7"}
    assert called.motions[0].motion.velocity.tolist() == command.motions[0].motion.velocity.tolist()


@pytest.mark.verify
def test_shock_spectra_are_those_of_the_command(result_of):
    files = [shot("a.csv"), shot("b.csv", 1e-3), shot("c.csv", 2e-3)]
    said = ("--q", "25", "--from", "100 Hz", "--to", "4 kHz", "--per-octave", "3", "--kind", "pseudo-velocity")
    more = ("--side", "positive", "--rms", "--rolling", "10 ms,5 ms", "--response", "1 kHz", "--high-pass", "20 Hz")
    command, _ = result_of("srs", *files, "--unit", "g", *said, *more)
    called = strikewave.shock_spectra(
        files, unit="g", spectra=strikewave.Spectra(q=25.0, low=100.0, high="4 kHz", per_octave=3, kinds=["pseudo-velocity"], side="positive", rms=True, rolling=(0.01, 0.005), response=1000.0), filter=strikewave.Filtering(high_pass="20 Hz"),
    )  # fmt: skip
    for name, text in command.tables().items():
        assert called.tables()[name] == text
    assert np.shape(called.document()["spectra"][2]["rolling"]["values"]) == (7, 16)


@pytest.mark.parametrize(
    ("said", "words"),
    [
        ({"filter": {"high_pass": 60e3}}, 'high_pass: got "60 kHz"; allowed: a cutoff below half the sampling rate of'),
        ({"filter": {"high_pass": "fast"}}, 'high_pass: got "fast"; allowed: a frequency with its unit'),
        ({"filter": "CFC"}, 'filter: got "CFC"; allowed: a cutoff above zero such as "10 kHz", a class such as'),
        ({"filter": -1.0}, "filter: got -1.0; allowed: a cutoff above zero"),
        ({"filter": {"ac_coupling": -0.1}}, "ac_coupling: got "),
        ({"channels": [3]}, 'channels: got "3"; allowed: a name, or a number from 1 to 1'),
        ({"channels": "fram"}, 'channels: got "fram"'),
        ({"examination": {"base": "roof"}}, 'base: got "roof"; allowed: a name, or a number from 1 to 1'),
        (
            {"examination": {"base": 1, "columns": "repeats"}},
            'base: got "1"; allowed: a channel of files whose columns are channels',
        ),
        ({"examination": {"columns": "rows"}}, 'columns: got "rows"; allowed: channels or repeats'),
        ({"unit": "kg"}, 'unit: got "kg"'),
        ({"calibration": {"polarity": 2}}, 'polarity: got "2"; allowed: 1 or -1'),
        ({"judging": {"test": "none.toml"}}, "test: no such file: none.toml"),
    ],
)
def test_a_refusal_names_the_parameter(here, said, words):
    shot()
    with pytest.raises(InputError) as refused:
        strikewave.record("shot.csv", **grouped(said))
    assert str(refused.value).startswith(words)


def grouped(said):
    return {name: GROUPS[name](**value) if isinstance(value, dict) else value for name, value in said.items()}


@pytest.mark.parametrize(
    ("said", "words"),
    [
        ({"kinds": ["absolut"]}, 'kinds: got "absolut"'),
        ({"q": 0.0}, 'q: got "0.0"; allowed: a quality factor above zero'),
        ({"side": "left"}, 'side: got "left"; allowed: one of maximax, positive, negative'),
        ({"high": "60 kHz"}, 'high: got "60 kHz"; allowed: a frequency below half the sampling rate'),
        ({"low": 0.0}, 'low: got "0.0"; allowed: a frequency above zero'),
        ({"rolling": (1e-3, -1.0)}, "rolling: got"),
        ({"resultant": True}, 'resultant: got "1 channel"; allowed: 2 or 3 perpendicular channels'),
    ],
)
def test_a_refusal_of_spectra_names_the_parameter(here, said, words):
    shot()
    with pytest.raises(InputError) as refused:
        strikewave.shock_spectra("shot.csv", spectra=strikewave.Spectra(**said))
    assert str(refused.value).startswith(words)


def struck_at(instant, size=2000, step=1e-5):
    """A shock of 1 ms and 500 g at an instant, with a little noise."""
    time = step * np.arange(size)
    at = (time - instant) / 1e-3
    noise = np.random.default_rng(1).normal(0.0, 0.5, size)
    return time, np.where((at > 0.0) & (at < 1.0), 500.0 * np.sin(np.pi * np.clip(at, 0.0, 1.0)) ** 2, 0.0) + noise


def test_a_file_of_two_measurements_is_two_records_with_no_interval(here):
    time, values = struck_at(0.01)
    lines = "".join(f"{t:.5f},{v:.4f}\n" for t, v in zip(time, values, strict=True))
    Path("shots.csv").write_text("time [s],frame [g]\n" + lines + lines)
    found = strikewave.record("shots.csv")
    assert [file.path for file in found.readings] == ["shots.csv: measurement 1", "shots.csv: measurement 2"]
    assert [file.channels[0].pulses[0].time for file in found.readings] == pytest.approx([0.0105] * 2, abs=1e-5)
    assert all(not file.channels[0].intervals for file in found.readings)
    assert "measurements" in [notice.code for notice in found.notices]
    assert [
        file.path for file in strikewave.record("shots.csv", reading=strikewave.Reading(measurement=2)).readings
    ] == ["shots.csv: measurement 2"]
    with pytest.raises(InputError, match=r"measurement: got 3; allowed: a number from 1 to 2"):
        strikewave.record("shots.csv", reading=strikewave.Reading(measurement=3))


def test_channels_that_begin_at_different_times_are_one_body_struck_once(here):
    """Both write the same shock; the second recorder begins 3 ms after the first."""
    nptdms = pytest.importorskip("nptdms")
    noon = np.datetime64("2026-01-05T12:00:00", "us")
    starts = (noon, noon + np.timedelta64(3000, "us"))
    with nptdms.TdmsWriter("late.tdms") as file:
        for name, start, instant in zip(("board", "frame"), starts, (0.01, 0.007), strict=True):
            said = {"wf_increment": 1e-5, "wf_start_offset": 0.0, "wf_start_time": start, "unit_string": "g"}
            file.write_segment([nptdms.ChannelObject("a", name, struck_at(instant)[1], said)])
    found = strikewave.record("late.tdms", examination=strikewave.Examination(pair=(1, 2)))
    (pair,) = found.pairs
    assert (pair.one_body, pair.found.delay) == ("yes", pytest.approx(0.0, abs=1e-6))
    times = [channel.pulses[0].time for channel in found.readings[0].channels]
    assert times == pytest.approx([0.0105] * 2, abs=1e-5)
    (answer,) = (
        strikewave.record("late.tdms", examination=strikewave.Examination(base=1)).readings[0].channels[1].responses
    )
    assert answer.delay == pytest.approx(0.0, abs=1e-5)
