"""What the pages of records, bars, elements and studies show is what the commands give."""

import inspect

import numpy as np
import pytest

import strikewave
from strikewave import load_case, run_wave
from strikewave.base.errors import StrikewaveError
from strikewave.studies.design.design_file import load_design
from strikewave.web import elements_view, target_view
from strikewave.web.case_state import CaseSource
from strikewave.web.case_view import opened
from strikewave.web.record_request import RecordRequest
from strikewave.web.record_view import four_axes, measure
from strikewave.web.study_request import KINDS, StudyRequest
from strikewave.web.study_view import refuse_other_files, study

WIDE = 200e-6
"""Base of the half sine that is planted, s."""


def say(share, words):
    pass


@pytest.fixture
def shots(tmp_path, monkeypatch):
    """Return a folder with two half sines of 3000 and 3100 g, and a file that lies about its kind."""
    monkeypatch.chdir(tmp_path)  # the view goes to the folder of its files, and back after the test
    time = np.arange(0.0, 2e-3, 2e-6)
    for name, peak in (("a.csv", 3000.0), ("b.csv", 3100.0)):
        pulse = peak * np.sin(np.pi * (time - 5e-4) / WIDE) * ((time > 5e-4) & (time < 5e-4 + WIDE))
        lines = [f"{t:.6f},{a:.4f}" for t, a in zip(time, pulse, strict=True)]
        (tmp_path / name).write_text("\n".join(["time [s],acceleration [g]", *lines]) + "\n")
    (tmp_path / "lie.tdms").write_bytes(b"PK\x03\x04 no TDMS at all")
    return tmp_path


@pytest.mark.verify
def test_records_show_the_pulses_that_are_in_them_and_the_file_that_lies_is_bad_in_words(shots):
    view = measure(RecordRequest(str(shots), ("a.csv", "b.csv", "lie.tdms"), spectrum=False), say)
    result = strikewave.record([str(shots / "a.csv"), str(shots / "b.csv")])
    assert dict(view["figures"])["mean peak"] == dict(result.highlights())["mean peak"]
    health = next(table for table in view["lead"] if table[0] == "Health of the files")
    assert health[2][0][:2] == ["lie.tdms", "bad"]
    assert health[2][0][2]
    overlay = view["charts"][1]["series"]
    assert len(overlay) == 2
    assert max(y for _, y in overlay[0]["data"]) == pytest.approx(3000.0, rel=1e-3)  # sampled 100 times over the pulse


def test_no_file_and_another_case_beside_are_refused_in_words(shots):
    with pytest.raises(StrikewaveError, match="drop them on the page"):
        measure(RecordRequest(str(shots), ()), say)
    with pytest.raises(StrikewaveError, match="a built-in case"):
        measure(RecordRequest(str(shots), ("a.csv",), spectrum=False, beside="/etc/passwd:rigid"), say)


def test_on_four_axes_the_lines_of_equal_acceleration_and_displacement_are_those_of_a_sine(shots):
    """At 2 pi f v = a and v = 2 pi f d each line has slope -1 or +1 in decades, through the numbers that it names."""
    options = four_axes(strikewave.shock_spectra([str(shots / "a.csv")], kinds=("pseudo-velocity",)))
    lines = {line["name"]: np.array(line["data"]) for line in options["series"]}
    for name, points in lines.items():
        if name.endswith(" g"):
            a = 2.0 * np.pi * points[:, 0] * points[:, 1]
            assert a == pytest.approx(float(name[:-2]) * 9.80665, rel=1e-5)  # six digits are sent
        elif name.endswith(" mm"):
            d = points[:, 1] / (2.0 * np.pi * points[:, 0])
            assert d == pytest.approx(1e-3 * float(name[:-3]), rel=1e-5)
    assert sum(name.endswith((" g", " mm")) for name in lines) >= 4


def test_a_bar_shows_the_stress_of_its_run():
    source = CaseSource("li-ma-2019-fig13-bar", "", (), "")
    view, solution = target_view.full(source), run_wave(load_case("li-ma-2019-fig13-bar"))
    field, stress = view["charts"][:2]
    assert len(field["series"][0]["data"]) <= target_view.FIELD_TIMES * target_view.FIELD_PLACES
    drawn = max(y for _, y in stress["series"][0]["data"])
    assert drawn == pytest.approx(
        solution.stress(0).max() / 1e6, rel=1e-5
    )  # six digits are sent; no peak is thinned out
    assert {code for _, code, _ in view["notices"]} == {one.code for one in solution.notices}


def test_a_case_of_another_page_is_refused_with_the_page_that_shows_it():
    with pytest.raises(StrikewaveError, match="page Target"):
        opened(CaseSource("togami-1996-bar", "", (), ""), "run")


@pytest.mark.verify
def test_elements_show_forces_energies_and_the_bodies_in_motion():
    view = elements_view.full(CaseSource("two-bars-fem", "", ("fem.duration=20 us",), ""), say)
    forces, energies = view["charts"]
    assert dict(view["figures"])["contact force"] == f"{max(y for _, y in forces['series'][0]['data']):.4g} kN"
    assert len(energies["series"]) == 7
    assert view["page"].lower().startswith("<!doctype html>")


@pytest.mark.parametrize(
    ("key", "line"),
    [
        ("to", "/etc/passwd"),
        ("to", "@targets.txt"),
        ("to", "../other/shot.csv#1"),
        ("to", "shot.csv; load.file=/etc/passwd"),
        ("to", "C:\\data\\shot.csv"),
        ("goals", "spec:/etc/passwd passes"),
        ("goals", "spec:~/mine.toml passes"),
        ("vary", 'load.file="a.csv, b.csv"'),
    ],
)
def test_a_study_opens_no_file_beside_those_that_were_dropped(key, line):
    with pytest.raises(StrikewaveError, match="dropped on this page"):
        refuse_other_files(StudyRequest("fit", CaseSource("li-ma-2019", "", (), ""), ((key, (line,)),)))


@pytest.mark.parametrize(
    ("key", "line"),
    [
        ("to", "first.rigid_peak=4000 g +- 5 %"),
        ("to", "shot 1.csv#1; machine.speed=700 rpm"),
        ("vary", 'machine.speed="600..800 rpm:5"'),
        ("vary", "object.damper=10 N s/m, 20 N s/m"),
        ("goals", "spec:jesd22-b110:B passes"),
        ("x", "machine.speed=600..800 rpm"),
    ],
)
def test_what_a_study_asks_for_is_let_in(key, line):
    refuse_other_files(StudyRequest("fit", CaseSource("li-ma-2019", "", (), ""), ((key, (line,)),)))


@pytest.mark.verify
def test_a_sweep_shows_the_numbers_of_the_function_and_goes_on_where_it_was(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    texts = (("vary", ("machine.height=0.2..0.3 m:2",)), ("keep", ("first.rigid_peak",)))
    asked = StudyRequest("sweep", CaseSource("jesd22-b111-b", "", (), str(tmp_path)), texts)
    view = study(asked, say)
    expected = strikewave.sweep(load_case("jesd22-b111-b"), ["machine.height=0.2..0.3 m:2"], keep=["first.rigid_peak"])
    assert view["files"]["runs.csv"] == expected.tables()["runs.csv"]
    assert study(asked, say)["files"]["runs.csv"] == view["files"]["runs.csv"]


@pytest.mark.parametrize(("key", "text"), [("runs", "0"), ("runs", "99999999"), ("runs", "many")])
def test_a_study_that_would_take_days_is_refused_in_words(tmp_path, monkeypatch, key, text):
    monkeypatch.chdir(tmp_path)
    asked = StudyRequest("sweep", CaseSource("jesd22-b111-b", "", (), str(tmp_path)), ((key, (text,)),))
    with pytest.raises(StrikewaveError, match="the command line takes more"):
        study(asked, say)


def test_the_file_that_a_design_shows_is_read_by_its_command(tmp_path):
    """Quotes around a value, as they are typed in a shell, are not part of it."""
    vary = ('machine.speed="600..800 rpm"', "machine.engagement = 4..7 mm")
    source = CaseSource("li-ma-2019", "", ("feed.blows=3",), "")
    asked = StudyRequest("design", source, (("vary", vary), ("goals", ("cv < 3 %",)), ("runs", ("64",))))
    lines = dict(asked.commands())
    (tmp_path / "design.toml").write_text(lines["design.toml"])
    read = load_design(tmp_path / "design.toml")
    assert read.case.feed.blows.si == 3.0
    plan = read.plan(read.case)
    assert [variable.path for variable in plan.variables] == ["machine.speed", "machine.engagement"]
    assert (plan.runs, read.file.goals) == (64, ("cv < 3 %",))
    assert lines["command line"] == "strikewave design design.toml"


@pytest.mark.parametrize("kind", KINDS)
def test_the_python_lines_of_a_study_are_a_call_that_its_function_takes(kind, monkeypatch):
    """With the example of each text typed in: names and kinds of what is given are those of the signature."""
    taken = []
    real = inspect.signature(getattr(strikewave, kind))
    monkeypatch.setattr(strikewave, kind, lambda *given, **named: taken.append(real.bind(*given, **named)))
    texts = tuple((text.key, (text.example or "20",)) for text in KINDS[kind].texts)
    lines = dict(StudyRequest(kind, CaseSource("li-ma-2019", "", (), ""), texts).commands())
    exec(compile(lines["Python"], kind, "exec"), {})
    assert taken[0].arguments["case"].name == "li-ma-2019"
    if kind == "map":
        assert taken[0].arguments["points"] == (20, 20)
