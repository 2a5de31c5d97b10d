"""``strikewave map`` as a user types it: files, documents, going on, and what bad input is told."""

import contextlib
import json
import os
import resource
import shutil
import signal
import sqlite3
import subprocess
import sys
import time
from pathlib import Path

import numba
import numpy as np
import pytest
import xarray

from strikewave import load_case
from strikewave.base.compiling import WORDS
from strikewave.studies.axes import axis_of
from strikewave.studies.engine.store import INDEX, runs_beside
from strikewave.studies.map.cells import FAILED, FIELDS, PLACE
from strikewave.studies.map.figures import picture
from strikewave.studies.map.study import MapStudy, make_map, plan_of

FEW = ("map", "li-ma-2019", "--points", "4x3", "--workers", "1", "--train", "0", "--set", "feed.blows=3")


def test_files_agree_and_the_nearest_case_reads_back(strikewave, read_page):
    code, out, _ = strikewave(*FEW, "--want-cv", "4.5 %")
    assert code == 3  # cells in which blows are missing failed a check
    (folder,) = Path("out").iterdir()
    assert folder.name.startswith("map-li-ma-2019-")
    names = {
        "case.toml",
        "record.toml",
        "map.json",
        "map.nc",
        "map.csv",
        "map.svg",
        "map.png",
        "equal-blows.toml",
        "report.html",
        "runs.sqlite",
    }
    assert {path.name for path in folder.iterdir()} == names
    assert "The nearest setting with a CV" in out
    document = json.loads((folder / "map.json").read_text())
    assert np.shape(document["cells"]["cv"]) == (1, 3, 4)
    changed = load_case(str(folder / "equal-blows.toml"))
    assert changed.machine.speed.si == pytest.approx(document["nearest"]["settings"]["machine.speed"], rel=1e-8)
    assert "nearest within 4.5 %" in out
    page, speed = read_page(folder / "report.html"), document["nearest"]["settings"]["machine.speed"]
    assert page.numbers["machine.speed, nearest with equal blows"] == f"{speed * 30.0 / np.pi:.5g} rpm"
    assert page.numbers["mean peak there"] == f"{document['nearest']['full_run']['peak'] / 9.80665:.4g} g"
    assert page.pictures == 1
    assert "strikewave map li-ma-2019 --points 4x3" in page.text


@pytest.mark.verify
def test_changed_case_never_replaces_the_unchanged_one(strikewave):
    """Without --out each has a folder of its own, as those of other commands."""
    strikewave(*FEW[:8], "--blows", "3")
    strikewave(*FEW)
    assert sorted(len(path.name) for path in Path("out").iterdir()) == [
        len("map-li-ma-2019"),
        len("map-li-ma-2019-") + 8,
    ]


@pytest.mark.verify
def test_tables_fit_into_80_columns(strikewave, monkeypatch):
    monkeypatch.setenv("COLUMNS", "80")
    _, out, _ = strikewave(*FEW, "--want-cv", "20 %", "--panels", "object.damper=10 N s/m, 40 N s/m")
    heads = [line.split("  ")[0].strip() for line in out.splitlines()]
    assert {"machine.speed (rpm)", "object.damper (N s/m)", "CV from 2nd blow (%)", "largest displacement (mm)"} <= set(
        heads
    )


@pytest.mark.verify
def test_case_that_is_even_is_told_so(strikewave):
    """With a limit above its own CV, the case is the nearest even setting, and the file is the case."""
    code, out, _ = strikewave(*FEW, "--want-cv", "20 %", "--out", "here", "--fail-on", "failed")
    assert code == 0  # of cells in which blows are missing, none could not be made
    assert "The case itself has a CV" in out
    assert load_case("here/equal-blows.toml").machine.speed.typed == load_case("li-ma-2019").machine.speed.typed


def test_json_is_one_document_and_writes_nothing(strikewave):
    code, out, _ = strikewave(*FEW, "--json", "--panels", "object.damper=10 N s/m, 40 N s/m", "--log", "y")
    document = json.loads(out)
    assert code in (0, 3)
    assert [axis["path"] for axis in document["axes"]] == ["machine.speed", "object.spring", "object.damper"]
    assert [axis["log"] for axis in document["axes"]] == [False, True, False]
    assert np.shape(document["cells"]["peak"]) == (2, 3, 4)
    assert not Path("out").exists()


@pytest.mark.verify
def test_no_even_setting_is_exit_code_3(strikewave):
    code, out, _ = strikewave(*FEW, "--want-cv", "0.000001 %")
    assert code == 3
    assert "No setting has blows" in out


@pytest.mark.verify
def test_the_same_map_again_replaces_the_old_one(strikewave):
    strikewave(*FEW, "--out", "here")
    first = Path("here/map.nc").read_bytes()
    code, _, _ = strikewave(*FEW, "--out", "here")
    assert code in (0, 3)
    assert len(Path("here/map.nc").read_bytes()) == len(first)
    assert [path.name for path in Path().iterdir()] == ["here"]


@pytest.mark.verify
@pytest.mark.parametrize("other", [("--set", "machine.radius=190 mm"), ("--x", "machine.speed=500 rpm..600 rpm")])
def test_other_files_and_other_maps_are_never_replaced(strikewave, other):
    """Another case, or other axes: refused before anything is run."""
    strikewave(*FEW, "--out", "here")
    code, _, err = strikewave(*FEW, *other, "--out", "here")
    assert code == 2
    assert "--force" in err
    Path("here/notes.txt").write_text("mine")
    code, _, err = strikewave(*FEW, "--out", "here", "--force")
    assert code == 2
    assert "notes.txt" in err


def begun(environment, *words, **more):
    """The command, begun as a process group of its own."""
    code = "from strikewave.cli.app import main; main()"
    command = [sys.executable, "-c", code, *words]
    return subprocess.Popen(command, env=environment, stderr=subprocess.PIPE, text=True, start_new_session=True, **more)


def cells_kept(folder):
    """Return how many cells stand in the index of a map that is under way.

    Its writer holds the index alone, so that a copy is read: a part of a batch in it is not counted by SQLite.
    """
    index = runs_beside(folder) / INDEX
    copies = [Path(f"copied.sqlite{ending}") for ending in ("", "-wal")]
    try:
        for copy in copies:
            shutil.copyfile(index.with_name(f"{INDEX}{copy.name.removeprefix('copied.sqlite')}"), copy)
        with contextlib.closing(sqlite3.connect(copies[0])) as base:
            return base.execute("SELECT count(*) FROM runs").fetchone()[0]
    except (OSError, sqlite3.Error):  # not there yet, or copied between two of its files
        return 0
    finally:
        for path in Path().glob("copied.sqlite*"):
            path.unlink()


def wait_for_cells(folder, going):
    """Wait until some cells of a map that is under way are kept."""
    limit = time.monotonic() + 120.0
    while going.poll() is None and time.monotonic() < limit and not cells_kept(Path(folder)):
        time.sleep(0.01)
    assert runs_beside(Path(folder)).exists()


@pytest.mark.verify
def test_killed_map_goes_on_to_the_same_end(strikewave, environment):
    """SIGKILL once cells are kept: the same command finishes, and every number is that of a map never stopped."""
    words = (*FEW[:2], "--points", "14x20", "--workers", "1", "--train", "0", "--set", "feed.blows=3")
    going = begun(environment, *words, "--out", "killed")
    wait_for_cells("killed", going)
    going.kill()
    going.communicate()
    _, _, err = strikewave(*words, "--out", "killed")
    assert "of 280 cells are there already" in err
    assert not runs_beside(Path("killed")).exists()
    strikewave(*words, "--out", "whole")
    with xarray.open_dataset("killed/map.nc") as one, xarray.open_dataset("whole/map.nc") as other:
        assert one.identical(other)


@pytest.mark.verify
@pytest.mark.parametrize("after", [0.0, 0.3, 1.0])
def test_interrupt_ends_all_processes_at_once(strikewave, environment, after):
    """Ctrl-C goes to the whole group, while workers start or run rows of minutes: no traceback, and no process
    left, whose stderr would be waited for."""
    strikewave(*FEW, "--out", "warm")
    words = ("map", "li-ma-2019", "--points", "1000x40", "--workers", "2", "--train", "240", "--out", "here")
    going = begun(environment, *words)
    line = going.stderr.readline()
    assert "machines" in line, line
    time.sleep(after)
    os.killpg(going.pid, signal.SIGINT)
    _, err = going.communicate(timeout=60.0)
    assert going.returncode == 130
    assert "stopped; " in err
    assert "Traceback" not in err


@pytest.mark.verify
def test_interrupted_map_says_what_is_kept(strikewave, environment):
    going = begun(environment, "map", "li-ma-2019", "--points", "8x400", "--train", "0", "--out", "here")
    wait_for_cells("here", going)
    os.killpg(going.pid, signal.SIGINT)
    _, err = going.communicate(timeout=60.0)
    assert "of 3200 cells are kept in" in err
    assert "nothing was written" not in err


@pytest.mark.verify
def test_full_disk_is_told_and_the_same_command_goes_on(strikewave, environment):
    """Files of 80 kB at most: told in words, and with room again the cells that stand are not run."""
    words = (
        "map",
        "li-ma-2019",
        "--points",
        "24x20",
        "--workers",
        "1",
        "--train",
        "0",
        "--blows",
        "3",
        "--out",
        "here",
    )

    def small():
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (80_000, resource.RLIM_INFINITY))

    strikewave(*FEW, "--out", "warm")
    going = begun({**environment, "PYTHONDONTWRITEBYTECODE": "1"}, *words, preexec_fn=small)
    _, err = going.communicate(timeout=120.0)
    assert going.returncode == 2
    assert "a place that can be written" in err
    code, _, err = strikewave(*words)
    assert code in (0, 3)
    assert "of 480 cells are there already" in err


@pytest.mark.verify
def test_a_folder_of_something_else_and_a_damaged_index_are_refused(strikewave):
    place = runs_beside(Path("here"))
    place.mkdir()
    (place / "notes.txt").write_text("mine")
    code, _, err = strikewave(*FEW, "--out", "here")
    assert code == 2
    assert "other files" in err
    (place / "notes.txt").rename(place / INDEX)
    (place / INDEX).write_text("no index " * 1000)
    code, _, err = strikewave(*FEW, "--out", "here")
    assert code == 2
    assert "--fresh" in err
    assert strikewave(*FEW, "--out", "here", "--fresh")[0] in (0, 3)
    assert not place.exists()


def test_compiling_is_told_as_by_other_commands(strikewave, monkeypatch):
    def compiles_first(*rest, **named):
        numba.njit(lambda x: x + 1.0)(2.0)
        return make_map(*rest, **named)

    monkeypatch.setattr("strikewave.studies.map.report.make_map", compiles_first)
    _, _, err = strikewave(*FEW, "--json")
    assert err.count(WORDS) == 1


def test_picture_of_a_map_without_results_says_so():
    """Panels, marks and legend stand even where no cell has a result; what is assumed has its bar."""
    case = load_case("li-ma-2019", ["feed.blows=3"])
    axes = tuple(axis_of(case, path, None, 3, False) for path in ("machine.speed", "object.spring", "object.damper"))
    plan = plan_of(case, axes)
    data = np.full((*plan.shape, len(FIELDS)), np.nan)
    data[..., PLACE["regime"]], data[..., PLACE["reason"]] = FAILED, 5
    nothing = dict.fromkeys(FIELDS, float("nan"))
    figure = picture(MapStudy(plan, data, 0.02, nothing))
    assert [axes.get_xlabel() for axes in figure.axes[:3]] == ["speed of the machine (rpm)"] * 3
    assert figure.axes[0].get_ylabel() == "spring of the object (kN/m)"
    named = [text.get_text() for text in figure.legends[0].get_texts()]
    assert "object.spring assumed: half to twice" in named
    assert "no result, or no regime" in named


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("--x", "machine.sped"), "did you mean"),
        (("--x", "machine.speed=400 rpm"), "low..high"),
        (("--x", "machine.speed=400 kg..900 kg"), "machine.speed"),
        (("--x", "machine.speed=900 rpm..400 rpm"), "lies above"),
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
