"""What the pages of records, bars, elements and studies show is what the commands give."""

import inspect
import json
import os
import shlex
from urllib.parse import parse_qs, urlsplit

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import strikewave
from strikewave import load_case, run_wave
from strikewave.analyses.compare.sources import parse_name, paths_of
from strikewave.base.errors import StrikewaveError
from strikewave.reporting.shown_result import shown_table
from strikewave.studies.fit.targets import parse_targets
from strikewave.studies.search.plan import load_design
from strikewave.web.case_state import CaseSource, CaseState
from strikewave.web.case_values import opened
from strikewave.web.charts import ChartLine, heat_chart, line_chart
from strikewave.web.pages.case import elements_view, target_view
from strikewave.web.pages.record.request import RecordRequest
from strikewave.web.pages.record.view import (
    campaign_tables,
    files_in_unit,
    four_axes,
    history_chart,
    measure,
    units_of_channels,
)
from strikewave.web.pages.study.request import KINDS, StudyRequest
from strikewave.web.pages.study.view import refuse_other_files, study
from strikewave.web.sessions import clean_name

WIDE = 200e-6
"""Base of the half sine that is planted, s."""


def say(share, words):
    pass


def surface_of(body):
    """Return the head of a field of bodies, its faces, and the points at each instant, as its docstring says they lie."""
    size = int.from_bytes(body[:4], "little")
    head = json.loads(body[4 : 4 + size])
    faces = np.frombuffer(body, "<u4", 4 * head["faces"], 4 + size)
    count = 3 * head["points"] * len(head["time"])
    points = np.frombuffer(body, "<f4", count, 4 + size + faces.nbytes).reshape(len(head["time"]), -1, 3)
    assert (
        len(body) == 4 + size + faces.nbytes + points.nbytes + len(head["fields"]) * len(head["time"]) * head["faces"]
    )
    return head, (faces, points)


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
def test_records_show_their_pulses_and_name_the_bad_file(shots):
    view = measure(RecordRequest(str(shots), ("a.csv", "b.csv", "lie.tdms"), spectrum=False), say)
    result = strikewave.record([str(shots / "a.csv"), str(shots / "b.csv")])
    assert dict(view["figures"])["mean peak"] == dict(result.highlights())["mean peak"]
    health = next(table for table in view["lead"] if table[0] == "Health of the files")
    assert health[2][0][:2] == ["lie.tdms", "bad"]
    assert health[2][0][2]
    overlay = view["charts"][1]["series"]
    assert len(overlay) == 2
    assert max(y for _, y in overlay[0]["data"]) == pytest.approx(3000.0, rel=1e-3)  # sampled 100 times over the pulse


@pytest.mark.verify
def test_numbers_of_a_file_that_names_no_unit_are_not_called_g(shots):
    for name in ("a.csv", "b.csv"):
        path = shots / name
        path.write_text(path.read_text().replace("acceleration [g]", "channel"))
    result = strikewave.record(["a.csv", "b.csv"])
    assert units_of_channels(result) == [""]
    assert history_chart(result, "")["yAxis"]["name"] == "file's own numbers"
    _, _, rows, _ = campaign_tables(result)[0]
    assert dict(row[:2] for row in rows)["peak"] == "3050"
    spectra = strikewave.shock_spectra(["a.csv", "b.csv"], spectra=strikewave.Spectra(kinds=("pseudo-velocity",)))
    assert four_axes(spectra)["yAxis"]["name"] == "pseudo-velocity (unit·s)"


@pytest.mark.parametrize(
    ("head", "peak", "of_integral"), [("channel", "500.0 (no unit)", "(no unit)"), ("force [N]", "0.5000 kN", "N s")]
)
@pytest.mark.parametrize("first", [True, False])
def test_a_file_in_another_unit_or_none_changes_no_number_of_the_others(shots, head, peak, of_integral, first):
    """A half sine of 500 over 200 us has the integral 2/pi of 0.1; each number stands with the unit of its own file."""
    rows = (shots / "a.csv").read_text().splitlines()[1:]
    other = [f"{t},{float(a) / 6.0}" for t, a in (row.split(",") for row in rows)]
    (shots / "other.csv").write_text("\n".join([f"time [s],{head}", *other]) + "\n")
    names = ("other.csv", "a.csv", "b.csv") if first else ("a.csv", "b.csv", "other.csv")
    result = strikewave.record(names)
    heads, rows = shown_table(result)
    shown = {row[0]: dict(zip(heads, row, strict=True)) for row in rows}
    assert [shown[name]["peak"] for name in ("a.csv", "b.csv", "other.csv")] == ["3000 g", "3100 g", peak]
    integral, unit = shown["other.csv"]["velocity change"].split(" ", 1)
    assert float(integral) == pytest.approx(0.1 * 2.0 / np.pi, rel=1e-3)
    assert unit == of_integral
    assert units_of_channels(result)[0]  # what has no unit stands last, and in a diagram of its own
    assert files_in_unit(result, "m/s^2") == ["a.csv", "b.csv"]
    if not first:  # else the campaign is of the first file, whose channel has another name
        assert dict(result.highlights())["mean peak"] == "3050 g"


def test_numbers_that_touch_are_left_out_at_every_axis():
    """Their height is stated: else ECharts takes a letter's width for it, which some systems have too narrow."""
    line = line_chart("F", "t", "F", [ChartLine("a", [[0.0, 1.0]])])
    field = heat_chart("x-t", "t", "x", ["0"], ["0"], [[0, 0, 1.0]], "MPa", ends=(0.0, 1.0, 0.0, 1.0))
    drawn = [line["xAxis"], line["yAxis"], *field["xAxis"], *field["yAxis"]]
    for label in (axis["axisLabel"] for axis in drawn if axis.get("show", True)):
        assert label["hideOverlap"]
        assert label["lineHeight"] >= label["fontSize"]


@pytest.mark.verify
def test_a_bad_record_far_off_zero_does_not_press_the_others_flat(shots):
    rows = "".join(f"{k}e-6,90000\n" for k in range(1000))
    (shots / "off.csv").write_text("time [s],acceleration [g]\n" + rows)
    result = strikewave.record(["a.csv", "b.csv", "off.csv"])
    assert [file.status for file in result.readings] == ["good", "good", "bad"]
    axis = history_chart(result, "m/s^2")["yAxis"]
    assert 3100.0 <= axis["max"] < 4000.0
    alone = history_chart(strikewave.record(["off.csv"]), "m/s^2")
    assert "max" not in alone["yAxis"]  # a bad one alone is seen whole


@pytest.mark.verify
def test_a_finding_names_the_field_of_the_page_that_mends_it(shots):
    head, *rows = (shots / "a.csv").read_text().splitlines()
    turned = [f"{t},{-float(a)}" for t, a in (row.split(",") for row in rows)]
    (shots / "a.csv").write_text("\n".join([head, *turned]) + "\n")

    def said(**more):
        view = measure(RecordRequest(str(shots), ("a.csv",), spectrum=False, **more), say)
        return json.dumps([view["lead"], view["notices"]], ensure_ascii=False), view

    assert "“polarity” -1 turns it" in said()[0]
    words, mended = said(polarity="-1")
    assert "turns it" not in words
    assert "strikewave record a.csv --polarity -1" in mended["same"][0][1]
    with pytest.raises(StrikewaveError, match=r"^“polarity”: got"):
        measure(RecordRequest(str(shots), ("a.csv",), spectrum=False, polarity="2"), say)


@pytest.mark.verify
def test_channels_of_two_units_share_no_axis(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    time = np.arange(0.0, 2e-3, 2e-6)
    pulse = np.sin(np.pi * (time - 5e-4) / WIDE) * ((time > 5e-4) & (time < 5e-4 + WIDE))
    rows = [f"{t:.6f},{3000.0 * a:.4f},{500.0 * a:.4f}" for t, a in zip(time, pulse, strict=True)]
    (tmp_path / "a.csv").write_text("\n".join(["time [s],acceleration [g],force [N]", *rows]) + "\n")
    result = strikewave.record(["a.csv"])
    charts = [history_chart(result, unit) for unit in units_of_channels(result)]
    largest = {chart["yAxis"]["name"]: max(y for _, y in chart["series"][0]["data"]) for chart in charts}
    assert largest == pytest.approx({"acceleration (g)": 3000.0, "force (kN)": 0.5}, rel=1e-3)


@pytest.mark.verify
def test_a_simulation_is_laid_over_the_healthiest_record_and_scored(shots):
    (shots / "0.csv").write_text("time [s],acceleration [g]\n0,1\n1e-6,nan\n2e-6,1\n")
    asked = RecordRequest(str(shots), ("0.csv", "a.csv"), spectrum=False, beside="jesd22-b111-b:rigid")
    view = measure(asked, say)
    chart = view["charts"][-1]
    assert chart["title"]["text"] == "Record and simulation"
    assert chart["series"][0]["name"].startswith("a.csv")
    titles = [table[0] for table in view["tables"]]
    assert {"Largest pulse", "Agreement", "ISO/TS 18571"} <= set(titles)
    assert "strikewave compare a.csv jesd22-b111-b:rigid" in view["same"][0][1]


def test_no_file_and_another_case_beside_are_refused_in_words(shots):
    with pytest.raises(StrikewaveError, match="drop them on the page"):
        measure(RecordRequest(str(shots), ()), say)
    with pytest.raises(StrikewaveError, match="a built-in case"):
        measure(RecordRequest(str(shots), ("a.csv",), spectrum=False, beside="/etc/passwd:rigid"), say)


def test_lines_of_equal_acceleration_and_displacement_are_those_of_a_sine(shots):
    """At 2 pi f v = a and v = 2 pi f d each line has slope -1 or +1 in decades, through the numbers that it names."""
    options = four_axes(
        strikewave.shock_spectra([str(shots / "a.csv")], spectra=strikewave.Spectra(kinds=("pseudo-velocity",)))
    )
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
    cells = np.array(field["series"][0]["data"])
    assert len(cells) <= target_view.FIELD_TIMES * target_view.FIELD_PLACES
    low, high = field["yAxis"][1]["min"], field["yAxis"][1]["max"]
    assert (low, high) == (0.0, pytest.approx(58.0, rel=0.01))  # the length, in whole steps of the waves
    height = (high - low) / (cells[:, 1].max() + 1.0)
    # an axis of equal cells tells the truth: each shows a place within itself, and half a step of the waves beside
    assert cells[:, 3] == pytest.approx(low + height * (cells[:, 1] + 0.5), abs=0.5 * height)
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
    head, (faces, points) = surface_of(view["body"])
    assert faces.max() == head["points"] - 1
    moved = points[-1].mean(axis=0) - points[0].mean(axis=0)
    along, across = np.array(head["axis"]), np.cross(head["towards"], head["axis"])
    assert moved @ along > 0.0  # one bar runs into the other
    assert abs(moved @ across) < 1e-3 * (moved @ along)  # the halves are mirror images across the cut


@pytest.mark.parametrize(
    ("key", "line"),
    [
        ("to", "/etc/passwd"),
        ("to", "@targets.txt"),
        ("to", "../other/shot.csv#1"),
        ("to", ".."),
        ("to", "rigid = .."),
        ("to", "..#1; machine.speed=700 rpm"),
        ("to", "sweep-1/.."),
        ("goals", "spec:.. passes"),
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
        ("x", "machine.speed = 600 rpm .. 800 rpm"),
        ("to", "-rf.csv"),
        ("to", "shot..1.csv"),
    ],
)
def test_what_a_study_asks_for_is_let_in(key, line):
    refuse_other_files(StudyRequest("fit", CaseSource("li-ma-2019", "", (), ""), ((key, (line,)),)))


PIECES = ["..", ".", "/", "\\", "shot", "*", "[.]", "?", "#1", "@2", ";", " ", "=", "rigid", "+-", "~", ":", "studies"]


@given(st.lists(st.sampled_from(PIECES), max_size=5).map("".join))
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_no_measured_name_that_is_let_in_stands_for_a_file_of_another_folder(tmp_path, monkeypatch, line):
    own = tmp_path / "studies"
    (own / "studies").mkdir(parents=True, exist_ok=True)
    for place in (tmp_path, own, own / "studies"):
        (place / "shot").write_text("1\n")
    monkeypatch.chdir(own)
    case = load_case("li-ma-2019")
    try:
        refuse_other_files(StudyRequest("fit", CaseSource("li-ma-2019", "", (), ""), (("to", (line,)),)))
        files = [path for target in parse_targets([line], case) for path in paths_of(parse_name(target.right))]
    except StrikewaveError:
        return
    assert all(path.resolve().is_relative_to(own.resolve()) for path in files)


NAMES = st.text(st.characters(max_codepoint=0x2FFF), min_size=1, max_size=30).map(clean_name)


@given(NAMES | st.sampled_from(["-rf.csv", "--out", "--", "-", "a b.csv", "'.csv"]))
def test_each_command_that_is_shown_names_a_dropped_file_whatever_it_is_called(name):
    """The words as a shell takes them apart: the file is among them, and none of its names is taken for an option."""
    record = RecordRequest("", (name,), beside="li-ma-2019:rigid").commands()[0][1]
    study = StudyRequest("sweep", CaseSource(name, "schema = 1", (), ""), ()).commands()[0][1]
    case = CaseState(name, "schema = 1").command()
    for line, file in [
        *((line, name) for line in record.splitlines()),
        (study, f"{name}.toml"),
        (case, f"{name}.toml"),
    ]:
        program, _, word, *_ = shlex.split(line)
        assert (program, os.path.normpath(word)) == ("strikewave", os.path.normpath(file))
        assert not word.startswith("-")


@pytest.mark.verify
def test_a_sweep_shows_the_numbers_of_the_function_and_goes_on_where_it_was(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    texts = (("vary", ("machine.height=0.2..0.3 m:2",)), ("keep", ("first.rigid_peak",)))
    asked = StudyRequest("sweep", CaseSource("jesd22-b111-b", "", (), str(tmp_path)), texts)
    view = study(asked, say)
    expected = strikewave.sweep(load_case("jesd22-b111-b"), ["machine.height=0.2..0.3 m:2"], keep=["first.rigid_peak"])
    assert view["files"]["runs.csv"] == expected.tables()["runs.csv"]
    assert study(asked, say)["files"]["runs.csv"] == view["files"]["runs.csv"]
    heights = [parse_qs(urlsplit(link).query)["set"] for link in view["links"][0]]
    assert heights == [["machine.height=0.2 m"], ["machine.height=0.3 m"]]
    peaks = [y for _, y, _ in view["charts"][0]["series"][0]["data"]]
    assert peaks == pytest.approx(expected.number("first.rigid_peak") / 9.80665, rel=1e-3)  # four digits are sent


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


@pytest.mark.verify
def test_readings_at_a_section_are_those_of_a_tap_there():
    """A tap in the middle of a layer, and the section that is nearest to it, hold the same wave."""
    source = CaseSource("li-ma-2019-fig13-bar", "", (), "")
    sections, solution = target_view.full(source)["sections"], run_wave(load_case("li-ma-2019-fig13-bar"))
    place = sections.nearest(29.0)
    step = np.diff(sections.position).max()
    assert abs(sections.position[place] - 29.0) <= 0.5 * step
    tap = next(k for k, (name, _) in enumerate(solution.taps) if name == "sensor")
    largest = np.abs(solution.stress(tap)).max() / 1e6
    # the wave rises over 5 us, 26 mm of steel: half a step beside the tap the peak is the same within a tenth
    assert np.abs(sections.stress[:, place]).max() == pytest.approx(largest, rel=0.1)
