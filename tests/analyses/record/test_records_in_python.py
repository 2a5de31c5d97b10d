"""The calls of Python on measured files take what the commands take, and give the same."""

import inspect
from pathlib import Path

import numpy as np
import pytest

import strikewave
from strikewave.base.errors import InputError
from strikewave.cli.group import entries, whole_command

OF_SCREEN = {"out", "json", "force", "show", "pdf", "xlsx", "wide", "verbose", "quiet", "help", "fail_on"}
"""Of the screen, the folder and the exit code: a call returns its result instead."""
OTHERWISE = {
    "files": "paths",
    "channel": "channels",
    "frequency": "frequencies",
    "kind": "kinds",
    "cfc": "filter",
    "cutoff": "filter",
    "columns": "repeats_in_columns",
}
"""What a call names otherwise: several are a sequence, a class is a filter, and a choice of two is a flag."""


@pytest.mark.parametrize(
    ("name", "call"), [("record", strikewave.record), ("srs", strikewave.shock_spectra)], ids=["record", "srs"]
)
def test_a_call_takes_every_option_of_its_command(name, call):
    options = {parameter.name for parameter in whole_command(name, entries()[name].module).params} - OF_SCREEN
    assert {OTHERWISE.get(option, option) for option in options} == set(inspect.signature(call).parameters)


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
        "shot.csv", unit="g", filter="CFC 1000", ac_coupling="200 ms", high_pass=20.0, motion=True, test="test.toml"
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
        files, unit="g", q=25.0, low=100.0, high="4 kHz", per_octave=3, kinds=["pseudo-velocity"], side="positive",
        rms=True, rolling=(0.01, 0.005), response=1000.0, high_pass="20 Hz",
    )  # fmt: skip
    for name, text in command.tables().items():
        assert called.tables()[name] == text
    assert np.shape(called.document()["spectra"][2]["rolling"]["values"]) == (7, 16)


@pytest.mark.parametrize(
    ("said", "words"),
    [
        ({"high_pass": 60e3}, 'high_pass: got "60 kHz"; allowed: a cutoff below half the sampling rate of frame'),
        ({"high_pass": "fast"}, 'high_pass: got "fast"; allowed: a cutoff above zero such as "5 Hz"'),
        ({"filter": "CFC"}, 'filter: got "CFC"; allowed: a cutoff above zero such as "10 kHz", a class such as'),
        ({"filter": -1.0}, "filter: got -1.0; allowed: a cutoff above zero"),
        ({"ac_coupling": -0.1}, "ac_coupling: got "),
        ({"channels": [3]}, 'channels: got "3"; allowed: a name, or a number from 1 to 1'),
        ({"channels": "fram"}, 'channels: got "fram"'),
        ({"base": "roof"}, 'base: got "roof"; allowed: a name, or a number from 1 to 1'),
        (
            {"base": 1, "repeats_in_columns": True},
            "base: got 1; allowed: a channel of files whose columns are channels",
        ),
        ({"unit": "kg"}, 'unit: got "kg"'),
        ({"test": "none.toml"}, "test: no such file: none.toml"),
    ],
)
def test_a_refusal_names_the_parameter(here, said, words):
    shot()
    with pytest.raises(InputError) as refused:
        strikewave.record("shot.csv", **said)
    assert str(refused.value).startswith(words)


@pytest.mark.parametrize(
    ("said", "words"),
    [
        ({"kinds": ["absolut"]}, 'kinds: got "absolut"'),
        ({"q": 0.0}, "q: got 0.0; allowed: a quality factor above zero"),
        ({"side": "left"}, 'side: got "left"; allowed: one of maximax, positive, negative'),
        ({"high": "60 kHz"}, 'high: got "60 kHz"; allowed: a frequency below half the sampling rate'),
        ({"low": 0.0}, "low: got 0.0; allowed: a frequency above zero"),
        ({"rolling": (1e-3, -1.0)}, "rolling: got"),
        ({"resultant": True}, 'resultant: got "1 channel"; allowed: 2 or 3 perpendicular channels'),
    ],
)
def test_a_refusal_of_spectra_names_the_parameter(here, said, words):
    shot()
    with pytest.raises(InputError) as refused:
        strikewave.shock_spectra("shot.csv", **said)
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
    assert [file.path for file in strikewave.record("shots.csv", measurement=2).readings] == [
        "shots.csv: measurement 2"
    ]
    with pytest.raises(InputError, match=r"measurement: got 3; allowed: a number from 1 to 2"):
        strikewave.record("shots.csv", measurement=3)


def test_channels_that_begin_at_different_times_are_one_body_struck_once(here):
    """Both write the same shock; the second recorder begins 3 ms after the first."""
    nptdms = pytest.importorskip("nptdms")
    noon = np.datetime64("2026-01-05T12:00:00", "us")
    starts = (noon, noon + np.timedelta64(3000, "us"))
    with nptdms.TdmsWriter("late.tdms") as file:
        for name, start, instant in zip(("board", "frame"), starts, (0.01, 0.007), strict=True):
            said = {"wf_increment": 1e-5, "wf_start_offset": 0.0, "wf_start_time": start, "unit_string": "g"}
            file.write_segment([nptdms.ChannelObject("a", name, struck_at(instant)[1], said)])
    found = strikewave.record("late.tdms", pair=(1, 2))
    (pair,) = found.pairs
    assert (pair.one_body, pair.found.delay) == ("yes", pytest.approx(0.0, abs=1e-6))
    times = [channel.pulses[0].time for channel in found.readings[0].channels]
    assert times == pytest.approx([0.0105] * 2, abs=1e-5)
    (answer,) = strikewave.record("late.tdms", base=1).readings[0].channels[1].responses
    assert answer.delay == pytest.approx(0.0, abs=1e-5)
