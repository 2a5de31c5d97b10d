"""What strangers wrote into titles, notes and names commands no terminal, and leaves files whole that others open."""

import json
import math
from pathlib import Path
from xml.etree import ElementTree

import h5py
import matplotlib.pyplot as plt
import numpy as np
import pytest

from strikewave import dump_case, load_case
from strikewave.base.documents import json_text
from strikewave.reporting.columns import Column, csv_table
from strikewave.reporting.output_options import LONGEST_FOLDER, folder_name
from strikewave.reporting.style import save

HOSTILE = "a\x1b]0;owned\x07\x1b[31m\x9b2J\u202e\x08\x7fz"
"""Names the window, turns red, clears the screen, writes from the right, steps back."""


def commands_in(text):
    return {letter for letter in text if not (letter.isprintable() or letter in "\n\xa0")}


@pytest.fixture
def case():
    text = dump_case(load_case("jesd22-b111-b"))
    title, note = (json.dumps(f"{word} {HOSTILE}") for word in ("title", "note"))
    lines = [f"title = {title}" if line.startswith("title = ") else line for line in text.splitlines()]
    assert 'note = "' in text
    return "\n".join(lines).replace('note = "', f"note = {note[:-1]} ", 1) + "\n"


@pytest.fixture
def record(tmp_path):
    place = tmp_path / f"{HOSTILE}.h5"
    samples = np.arange(1000)
    with h5py.File(place, "w") as file:
        file["time"] = samples * 1e-6
        file[HOSTILE] = 1000.0 * np.clip(np.sin((samples - 300) * math.pi / 200), 0.0, None) * (samples < 500)
        file[HOSTILE].attrs["unit"] = "g"
    return place


@pytest.mark.parametrize(
    "words",
    [
        ("run", "case.toml", "--no-band"),
        ("run", "case.toml", "--no-band", "--json"),
        ("validate", "case.toml"),
        ("diff", "case.toml", "jesd22-b111-b"),
        ("record", "RECORD", "--json"),
        ("srs", "RECORD", "--json"),
        pytest.param(("record", "RECORD"), marks=pytest.mark.verify),
        pytest.param(("srs", "RECORD"), marks=pytest.mark.verify),
    ],
    ids=" ".join,
)
def test_screens_and_files_hold_no_commands(strikewave, case, record, words):
    Path("case.toml").write_text(case)
    code, out, err = strikewave(*(record if word == "RECORD" else word for word in words))
    assert code in (0, 3), err
    assert commands_in(out + err) == set()
    assert "owned" in out + err or words[0] in ("run", "diff")
    for file in Path("out").rglob("*"):
        assert commands_in(str(file)) == set()
        if file.suffix in (".html", ".svg", ".csv", ".json"):
            assert commands_in(file.read_text("utf-8")) == set(), file
        if file.suffix == ".svg":
            ElementTree.parse(file)


def test_json_still_means_the_same():
    document = {HOSTILE: [f"{HOSTILE}\udcff", "µ–²"]}
    assert commands_in(json_text(document)) == set()
    assert json.loads(json_text(document)) == document
    assert "µ–²" in json_text(document)


def test_tables_for_spreadsheets_hold_no_commands():
    text = csv_table([Column(HOSTILE, [HOSTILE, f"\x1b={HOSTILE}", f"={HOSTILE}"])])
    assert commands_in(text) == set()
    assert text.splitlines()[-1].startswith("'=")


def test_pictures_with_any_text_are_well_formed(tmp_path):
    figure, axes = plt.subplots()
    axes.set_title(f"{HOSTILE}\ufffe < & µ", parse_math=False)
    save(figure, tmp_path / "a.svg")
    plt.close(figure)
    ElementTree.parse(tmp_path / "a.svg")
    assert commands_in((tmp_path / "a.svg").read_text("utf-8")) == set()


@pytest.mark.parametrize("name", [HOSTILE, "\udcff", "a" * 5000, "µ" * 5000, "衝" * 100])
def test_folders_nobody_asked_for_have_names_of_any_file_system(name):
    taken = folder_name(name)
    assert commands_in(taken) == set()
    assert len(taken.encode()) <= LONGEST_FOLDER + 9
    assert folder_name(name + "b") != taken
