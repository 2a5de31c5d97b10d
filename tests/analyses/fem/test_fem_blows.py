"""``strikewave fem --blows``: what is written and said of each blow, and a run that goes on in its second blow."""

import json
import os
from pathlib import Path

import numpy as np
import pytest

SOFT = """
schema = 1
title = "A block on a wall"
[[mesh.part]]
name = "rod"
shape = "block"
material = "2A12"
width = "4 mm"
depth = "4 mm"
height = "20 mm"
size = "2 mm"
velocity = { z = "-60 m/s" }
solid = { law = "bilinear", tangent_modulus = "1 GPa" }
[fem]
duration = "30 us"
interval = "0.5 us"
frames = 3
[[fem.wall]]
side = "rod.z-"
normal = "z"
"""
NAME = "rod.z--wall"


@pytest.fixture
def rod(strikewave, tmp_path):
    (tmp_path / "rod.toml").write_text(SOFT)
    return "rod.toml"


@pytest.mark.verify
def test_each_blow_has_its_files_and_its_row(strikewave, rod):
    from strikewave import load_case

    code, out, _ = strikewave("fem", rod, "--blows", "3", "--out", "b")
    assert code == 0
    later = [f"{name}-{k}.{end}" for k in (2, 3) for name, end in (("histories", "csv"), ("histories", "nc"))]
    fields = ["field.vtkhdf", "field-2.vtkhdf", "field-3.vtkhdf"]
    first = ["case.toml", "histories.csv", "histories.nc", "report.html", "summary.svg"]
    assert sorted(os.listdir("b")) == sorted([*first, *later, *fields])
    assert "Blow after blow" in out
    assert "at rest before blow 3" in out
    page = Path("b/report.html").read_text()
    assert "Blow after blow" in page
    assert "Yield in each blow, and relaxation before it" in page
    assert load_case("b/case.toml").fem.blows.si == 3.0


def test_the_document_tells_each_blow(strikewave, rod):
    document = json.loads(strikewave("fem", rod, "--blows", "2", "--json")[1])
    first, second = document["blows"]
    assert (first["blow"], second["blow"]) == (1, 2)
    assert first["contacts"] == document["contacts"]
    assert first["parts"] == document["parts"]
    assert first["rest"] is None
    assert second["plastic_energy"]["rod"] < first["plastic_energy"]["rod"]
    assert second["plastic_strain"]["rod"] >= first["plastic_strain"]["rod"] > 0.0
    assert 0.0 < first["restitution"][NAME] < second["restitution"][NAME] < 1.0
    assert abs(second["energy_error"]) < 0.01
    numbers = {key for key, value in second["rest"].items() if isinstance(value, float)}
    assert numbers <= set(document["units"])
    (only,) = json.loads(strikewave("fem", rod, "--json")[1])["blows"]
    assert only == first


@pytest.mark.verify
def test_one_blow_has_no_word_of_others(strikewave, rod):
    _, out, _ = strikewave("fem", rod, "--out", "one")
    assert "Blow after blow" not in out + Path("one/report.html").read_text()
    assert not [name for name in os.listdir("one") if "-2" in name]


@pytest.mark.parametrize("wrong", ["0", "21", "1.5"])
def test_a_number_of_blows_that_cannot_be_is_refused(strikewave, rod, wrong):
    code, _, err = strikewave("fem", rod, "--set", f"fem.blows={wrong}", "--json")
    assert code == 2
    assert "fem.blows" in err


@pytest.mark.verify
def test_a_run_interrupted_in_its_second_blow_goes_on_to_the_same_files(strikewave, rod, monkeypatch):
    import h5py

    from strikewave.analyses.fem import screen as fem

    command = ("fem", rod, "--blows", "2", "--no-report", "--out")
    assert strikewave(*command, "whole")[0] == 0
    add, seen = fem.FieldFile.add, []

    def interrupted(self, frame):
        seen.append(frame.time)
        if len(seen) == 5:
            raise KeyboardInterrupt
        add(self, frame)

    with monkeypatch.context() as patch:
        patch.setattr(fem.FieldFile, "add", interrupted)
        assert strikewave(*command, "broken")[0] == 130
    assert Path("broken.unfinished/state-1.h5").is_file()
    assert strikewave(*command, "broken", "--restart")[0] == 0
    assert not Path("broken.unfinished").exists()
    assert sorted(os.listdir("broken")) == sorted(os.listdir("whole"))
    for name in ("histories.csv", "histories-2.csv"):
        assert Path("broken", name).read_bytes() == Path("whole", name).read_bytes()
    for name in ("field.vtkhdf", "field-2.vtkhdf"):
        with h5py.File(f"broken/{name}") as one, h5py.File(f"whole/{name}") as other:
            for path in ("Steps/Values", "PointData/displacement", "CellData/stress"):
                assert np.array_equal(one[f"VTKHDF/{path}"], other[f"VTKHDF/{path}"])


@pytest.mark.verify
def test_a_result_of_several_blows_takes_the_place_of_an_older_one(strikewave, rod):
    command = ("fem", rod, "--blows", "2", "--no-report", "--out", "again")
    assert strikewave(*command)[0] == 0
    assert Path("again/histories-2.csv").is_file()
    code, _, err = strikewave(*command)
    assert code == 0, err


def test_a_blow_that_is_not_over_when_the_next_begins_is_said(rod):
    from strikewave import load_case
    from strikewave.analyses.fem.run import run_fem

    short = run_fem(load_case(rod, ["fem.blows=2", "fem.duration=6 us"]))
    assert "blow-unfinished" in {notice.code for notice in short.warnings}
    loose = run_fem(load_case(rod, ["fem.blows=2"]))
    assert not {"blow-unfinished", "blow-rest"} & {notice.code for notice in loose.warnings}
