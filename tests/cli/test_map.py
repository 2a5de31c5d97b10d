"""``strikewave map`` as a user types it: files, documents, going on, and what bad input is told."""

import json
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import xarray

from strikewave import load_case
from strikewave.figures.map import map_figure
from strikewave.studies.map import MapStudy, axis_of, plan_of
from strikewave.studies.map_cells import FIELDS, PLACE
from strikewave.studies.map_regimes import FAILED
from strikewave.studies.map_store import NAME

FEW = ("map", "li-ma-2019", "--points", "4x3", "--workers", "1", "--train", "0", "--set", "feed.blows=3")


def test_files_agree_and_the_nearest_case_reads_back(strikewave):
    code, out, err = strikewave(*FEW, "--want-cv", "20 %")
    assert code == 0
    folder = Path("out/map-li-ma-2019")
    names = {"case.toml", "map.json", "map.nc", "map.csv", "map.svg", "map.png", "equal-blows.toml"}
    assert {path.name for path in folder.iterdir()} == names
    assert "a full run of it has a CV of" in err
    document = json.loads((folder / "map.json").read_text())
    assert np.shape(document["cells"]["cv"]) == (1, 3, 4)
    changed = load_case(str(folder / "equal-blows.toml"))
    assert changed.machine.speed.si == pytest.approx(document["nearest"]["settings"]["machine.speed"], rel=1e-8)
    assert "nearest within 20 %" in out


def test_json_is_one_document_and_writes_nothing(strikewave):
    code, out, _ = strikewave(*FEW, "--json", "--panels", "object.damper=10 N s/m, 40 N s/m", "--log", "y")
    document = json.loads(out)
    assert code in (0, 3)
    assert [axis["path"] for axis in document["axes"]] == ["machine.speed", "object.spring", "object.damper"]
    assert np.shape(document["cells"]["peak"]) == (2, 3, 4)
    assert not Path("out").exists()


def test_no_even_setting_is_exit_code_3(strikewave):
    code, _, err = strikewave(*FEW, "--want-cv", "0.000001 %")
    assert code == 3
    assert "no setting of this map" in err


def test_the_same_map_again_replaces_the_old_one(strikewave):
    strikewave(*FEW, "--out", "here")
    first = Path("here/map.nc").read_bytes()
    code, _, _ = strikewave(*FEW, "--out", "here")
    assert code in (0, 3)
    assert len(Path("here/map.nc").read_bytes()) == len(first)
    assert not (Path("here") / NAME).exists()


def test_other_files_and_other_cases_are_never_replaced(strikewave):
    strikewave(*FEW, "--out", "here")
    code, _, err = strikewave(*FEW, "--out", "here", "--set", "machine.radius=190 mm")
    assert code == 2
    assert "another case" in err
    Path("here/notes.txt").write_text("mine")
    code, _, err = strikewave(*FEW, "--out", "here", "--force")
    assert code == 2
    assert "notes.txt" in err


def test_killed_map_goes_on_to_the_same_end(strikewave, environment):
    """SIGKILL once a row is kept: the same command finishes, and every number is that of a map never stopped."""
    words = (*FEW[:2], "--points", "30x20", "--workers", "1", "--train", "0", "--set", "feed.blows=3")
    code = "from strikewave.cli.app import main; main()"
    going = subprocess.Popen([sys.executable, "-c", code, *words, "--out", "killed"], env=environment)
    kept, limit = Path("killed") / NAME, time.monotonic() + 120.0
    while not kept.exists() and going.poll() is None and time.monotonic() < limit:
        time.sleep(0.01)
    going.kill()
    going.wait()
    assert kept.exists()
    _, _, err = strikewave(*words, "--out", "killed")
    assert "of 20 rows are there already" in err
    strikewave(*words, "--out", "whole")
    with xarray.open_dataset("killed/map.nc") as one, xarray.open_dataset("whole/map.nc") as other:
        assert one.identical(other)


def test_rows_of_another_map_are_refused_until_fresh(strikewave):
    folder = Path("here")
    folder.mkdir()
    (folder / NAME).write_bytes(b"not a map")
    code, _, err = strikewave(*FEW, "--out", "here", "--force")
    assert code == 2
    assert "--fresh" in err
    code, _, _ = strikewave(*FEW, "--out", "here", "--force", "--fresh")
    assert code in (0, 3)


def test_picture_of_a_map_without_results_says_so():
    """Panels, marks and legend stand even where no cell has a result; what is assumed has its bar."""
    case = load_case("li-ma-2019", ["feed.blows=3"])
    axes = tuple(axis_of(case, path, None, 3, False) for path in ("machine.speed", "object.spring", "object.damper"))
    plan = plan_of(case, axes)
    data = np.full((*plan.shape, len(FIELDS)), np.nan)
    data[..., PLACE["regime"]], data[..., PLACE["reason"]] = FAILED, 5
    nothing = dict.fromkeys(FIELDS, float("nan"))
    figure = map_figure(MapStudy(plan, data, 0.02, nothing))
    assert [axes.get_xlabel() for axes in figure.axes[:3]] == ["speed of the machine (rpm)"] * 3
    assert figure.axes[0].get_ylabel() == "spring of the object (kN/m)"
    named = [text.get_text() for text in figure.legends[0].get_texts()]
    assert "object.spring assumed: half to twice" in named
    assert "no result, or no regime" in named


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("--x", "machine.sped"), "did you mean"),
        (("--x", "machine.speed=400 rpm"), "low:high"),
        (("--x", "machine.speed=400 kg:900 kg"), "machine.speed"),
        (("--x", "machine.speed=900 rpm:400 rpm"), "lies above"),
        (("--y", "machine.speed"), "another quantity"),
        (("--points", "1e3"), "two whole numbers"),
        (("--points", "2000"), "2 to 1000"),
        (("--log", "z"), "x or y"),
        (("--want-cv", "2"), "a share"),
        (("--want-cv", "nan"), "a share"),
        (("--colour", "peek"), "did you mean"),
        (("--workers", "0"), "1 to 256"),
        (("--panels", "object.damper"), "with 1 to 6 values"),
        (("--blows", "1"), "2 to 1000"),
    ],
)
def test_bad_input_is_told_in_one_line(strikewave, words, told):
    code, out, err = strikewave(*FEW, *words)
    assert code == 2
    assert told in err
    assert not out
