"""Machines without a drive on the command line: run, new, validate, diff, cases, and the files of a run."""

import csv
import json

import pytest

from strikewave.analyses.machine.result import load_solution

CASES = {
    "iso-16063-22-dropball": "drop height 1 m",
    "jesd22-b111-b": "drop height 0.2795 m",
    "mil-s-901d-hammer": "release angle 90 deg",
    "machete-13-teeth": "13 teeth",
    "en-166-ball": "speed 45 m/s",
    "rodgers-2009-amplifier": "drop height 0.5 m",
    "dual-mass-amplifier": "drop height 0.5 m, gap 10 mm",
}


@pytest.mark.parametrize("name", CASES)
def test_run_json_of_each_case(strikewave, name):
    code, out, _ = strikewave("run", "--no-band", name, "--json")
    document = json.loads(out)
    assert code == 0
    (blow,) = document["blows"]
    assert blow["turntable_speed"] is None
    assert [phase["name"] for phase in document["phases"]] == ["release", "blows", "end"]
    launch, units = document["launch"], document["units"]
    assert {units[key] for key in launch} <= {"m/s", "J", "1"}
    # first touch is 10 us after the start of the run; the speeds are set for it
    assert blow["approach_speed"] == pytest.approx(launch["approach_speed"], rel=1e-6)
    assert launch["energy_at_touch"] <= launch["energy_released"] * (1.0 + 1e-12)
    assert bool(document["collisions"]) == (name == "rodgers-2009-amplifier")
    assert "first-blow-only" in [warning["code"] for warning in document["warnings"]]


def test_a_rotary_machine_has_no_launch(strikewave):
    _, out, _ = strikewave("run", "--no-band", "li-ma-2019", "--set", "feed.blows=1", "--json")
    assert not {"launch", "collisions"} & set(json.loads(out))


@pytest.mark.parametrize("name", CASES)
def test_validate_lists_the_values_of_each_case(strikewave, name):
    code, out, _ = strikewave("validate", name, "--json")
    document = json.loads(out)
    assert code == 0
    assert {"machine.follow", "striker.mass", "contact.restitution"} <= set(document["values"])
    assert document["provenance"].get("fitted", 0) == 0


@pytest.mark.verify
def test_files_and_report_of_an_amplifier(strikewave, tmp_path):
    code, out, _ = strikewave("run", "--no-band", "rodgers-2009-amplifier", "--out", "it")
    assert code == 0
    assert "Collisions in the line" in out
    assert "the contact law of the case on a rigid object" in out
    page = (tmp_path / "it" / "report.html").read_text("utf-8")
    for words in ("stacked velocity amplifier", "Up to first touch", "Phases, from the start", "Rodgers"):
        assert words in page
    assert "valve signal" not in page.replace("triggered by the valve signal", "")
    rows = list(csv.DictReader((tmp_path / "it" / "blows.csv").open()))
    assert rows[0]["turntable_speed [rad/s]"] == ""
    solution = load_solution(tmp_path / "it")
    assert [c.upper for c in solution.collisions] == ["first", "second", "third", "striker", "object"]
    assert solution.launch["gain"] == pytest.approx(
        solution.collisions[-1].upper_after / -solution.collisions[0].upper_before, rel=1e-12
    )
    assert solution.data["time"].attrs["long_name"] == "time after the start"


@pytest.mark.verify
def test_new_run_and_diff_of_a_drop(strikewave):
    assert strikewave("new", "mine", "--from", "jesd22-b111-b")[0] == 0
    assert strikewave("run", "--no-band", "mine.toml", "--out", "a")[0] == 0
    code, out, _ = strikewave("run", "--no-band", "mine.toml", "--set", "machine.height=0.5 m", "--out", "b")
    assert code == 0
    assert "changed-case" not in out or "machine.height" in out
    code, out, _ = strikewave("diff", "a", "b")
    assert "machine.height" in out


def test_cases_lists_a_bar_for_wave(strikewave):
    _, out, _ = strikewave("cases", "--json")
    commands = {row["name"]: row["command"] for row in json.loads(out)["cases"]}
    assert {commands[name] for name in CASES} == {"run"}
    assert commands["togami-1996-bar"] == "wave"


def test_the_end_of_a_bar_goes_as_fast_as_a_striker_of_its_kind(strikewave):
    """Twice the particle speed v/2 of the pulse, once the pulse is longer than the mass needs."""
    code, out, _ = strikewave("wave", "--no-band", "togami-1996-bar", "--json")
    document = json.loads(out)
    assert code == 0
    end = next(tap for tap in document["taps"] if tap["name"] == "end")
    # the mass of 5 g on a bar of impedance 7 kN s/m follows within 1 us; 1 % for the rounded pulse
    assert end["peaks"]["velocity"] == pytest.approx(6.2, rel=0.01)


@pytest.mark.verify
def test_no_animation_of_other_machines_is_said(strikewave):
    code, _, err = strikewave("run", "--no-band", "en-166-ball", "--animate", "--out", "c")
    assert code == 0
    assert "only the rotary machine" in err


@pytest.mark.parametrize("command", ["scatter", "settings"])
def test_studies_of_the_rotary_machine_refuse_others(strikewave, command):
    words = ["--from", "en-166-ball"] if command == "settings" else ["en-166-ball"]
    more = ["--peak", "1000 g", "--width", "200 us", "--interval", "20 ms"] if command == "settings" else []
    code, _, err = strikewave(command, *words, *more)
    assert code != 0
    assert "internal error" not in err
