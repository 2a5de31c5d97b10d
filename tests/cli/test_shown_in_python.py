"""What a command comes to shows itself in Python: a line, a notebook's page, a table, a picture; its report is the same."""

import xml.etree.ElementTree as ElementTree
from pathlib import Path

import numpy as np
import openpyxl
import pytest

import strikewave
from strikewave import load_setup, run_hopkinson
from strikewave.base.errors import InputError
from strikewave.reporting.shown_result import ShownResult, shown_table

WAVE = ("wave", "li-ma-2019-fig13-bar", "--no-band")
SCATTER = ("scatter", "li-ma-2019-equal-blows", "--runs", "10", "--shares", "none", "--set", "feed.blows=2")
MAP = ("map", "li-ma-2019", "--points", "3x2", "--workers", "1", "--train", "0", "--set", "feed.blows=2")
GASKETS = ("--material", "PTFE", "--thickness", "1 mm", "--layers", "1")
SETTINGS = (
    "settings",
    "--interval",
    "20 ms",
    "--peak",
    "4000 g",
    "--width",
    "200 us",
    "--strikers",
    "4",
    "--striker-mass",
    "1 kg",
)
COMMANDS = [
    ("record", "pulse.csv"),
    ("srs", "pulse.csv", "--per-octave", "1"),
    ("identify", "pulse.csv", "--m1", "0.2", "--m2", "0.4"),
    ("compare", "pulse.csv", "pulse.csv"),
    ("impact", "--m1", "0.2", "--m2", "0.4", "--speed", "3", "--stiffness", "4.7e9", "-n", "1.1", "-e", "0.5"),
    MAP,
    ("buffer", "li-ma-2019-fig5", "--sensor", "buffered", "--limit", "7000 g", *GASKETS),
    *(pytest.param(words, marks=pytest.mark.verify) for words in (WAVE, SCATTER, SETTINGS)),  # together 15 s
]


def write_pulse():
    """Write a half-sine of 3000 g and 200 us as a measured file."""
    time = np.arange(0.0, 1e-3, 2e-6)
    pulse = 3000.0 * np.clip(np.sin(np.pi * (time - 2e-4) / 2e-4), 0.0, None) * ((time > 2e-4) & (time < 4e-4))
    lines = [f"{t:.6f},{a:.4f}" for t, a in zip(time, pulse, strict=True)]
    Path("pulse.csv").write_text("\n".join(["time [s],acceleration [g]", *lines]) + "\n")


@pytest.mark.verify
@pytest.mark.parametrize("words", COMMANDS, ids=lambda words: words[0])
def test_the_result_of_a_command_shows_itself_and_writes_the_same_report(result_of, words):
    write_pulse()
    result, folder = result_of(*words)
    assert isinstance(result, ShownResult)
    line, page = repr(result), result._repr_html_()
    assert line.startswith(f"<{type(result).__name__} ")
    assert "\n" not in line
    ElementTree.fromstring(page.replace("<br>", "<br/>"))  # every other tag is closed
    assert "<table" in page
    assert len(result.to_dataframe()) >= 1
    assert result.plot().axes
    main = openpyxl.load_workbook(folder / "result.xlsx", read_only=True)[result.table_name]
    assert len(list(main.iter_rows(values_only=True))) == 1 + len(result.to_dataframe())
    assert result.report("again.html").read_text("utf-8") == (folder / "report.html").read_text("utf-8")


@pytest.mark.verify
def test_records_in_python_are_those_of_the_command(result_of):
    """The same document, whatever is said of reading, calibration and filter; and the same refusals."""
    write_pulse()
    said = ("--unit", "g", "--polarity", "acceleration=-1", "--filter", "20 kHz", "--drop-height", "1 m")
    command, _ = result_of("record", "pulse.csv", *said)
    called = strikewave.record(
        "pulse.csv",
        unit="g",
        calibration=strikewave.Calibration(polarity={"acceleration": -1}),
        examination=strikewave.Examination(drop_height=1.0),
        filter="20 kHz",
    )
    assert called.document() == command.document()
    assert called.filter == command.filter
    assert [row for row in called.calibrations if "polarity" in row[1]] == [("the call", "acceleration: polarity = -1")]
    with pytest.raises(InputError, match="a channel of the files"):
        strikewave.record("pulse.csv", unit={"acceleratoin": "g"})
    with pytest.raises(InputError, match="measured file"):
        strikewave.record([])


def test_a_shot_shows_a_table_spread_over_its_history(strikewave):
    """A dozen rows from the first to the last sample: the first ones alone are all zero."""
    assert strikewave("new", "shot", "--from", "hopkinson")[0] == 0
    shot = run_hopkinson(load_setup("shot.toml"))
    heads, rows = shown_table(shot, 12)
    stress = heads.index("true stress (MPa)")
    assert heads[0] == "time (µs)"
    table = shot.to_dataframe()
    assert len(rows) == 12
    assert float(rows[-1][0]) == pytest.approx(1e6 * table["time"].iloc[-1], rel=1e-3)  # four digits are shown
    largest = max(float(row[stress]) for row in rows)
    assert largest > 0.5e-6 * table["true stress"].max()
    assert "true stress (MPa)" in shot._repr_html_()
