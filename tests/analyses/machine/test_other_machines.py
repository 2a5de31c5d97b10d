"""Machines of every kind: what each says of itself and is drawn as, what is refused, and the command line."""

import csv
import json
import subprocess
import sys

import pytest

from strikewave.analyses.by_tables import check_case
from strikewave.analyses.machine.build import build_machine
from strikewave.analyses.machine.kind import LaunchedKind, MachineKind, kind_of
from strikewave.analyses.machine.result import load_solution
from strikewave.base.citations import SOURCES
from strikewave.base.errors import InputError, InputErrors
from strikewave.cases.case import Case, dump_case, load_case, parse_case
from strikewave.cases.files import bundled_cases, read_case_text
from strikewave.cases.paths import Form
from strikewave.cases.tables.machine_kinds import KINDS

CASES = {
    "falling-ball": "iso-16063-22-dropball",
    "drop": "jesd22-b111-b",
    "pendulum": "mil-s-901d-hammer",
    "machete": "machete-13-teeth",
    "gas-gun": "en-166-ball",
    "amplifier": "rodgers-2009-amplifier",
    "dual-mass-amplifier": "dual-mass-amplifier",
}
FORM = Form(Case, "case", "")


def refused(kind, *changes):
    """Return the lines with which a changed case is refused."""
    with pytest.raises(InputError) as caught:
        check_case(load_case(CASES[kind], changes))
    return str(caught.value).splitlines()


WRONG = [
    ("falling-ball", "machine.height=0 m", "machine.height: got", "above 0 m"),
    ("falling-ball", "machine.friction=1", "machine.friction: ", "below 1"),
    ("falling-ball", "machine.heigth=1 m", "machine.heigth: unknown key", 'did you mean "height"'),
    ("falling-ball", "striker.mount_stiffness=1e8 N/m", "striker.mount_stiffness: ", "flies"),
    ("falling-ball", "object.gravity=9.8 m/s^2", "object.gravity: ", "add the stop"),
    ("falling-ball", "object.stop_stiffness=1e5 N/m", "object.preload: missing", "hold the object"),
    ("drop", "machine.speed=730 rpm", "machine.speed: unknown key", "it is a key of rotary, gas-gun, and this is drop"),
    ("drop", "machine.follow=2 s", "machine.follow: got", "at most 1 s"),
    ("drop", "object.spring=1e4 N/m", "object.spring: ", "nothing holds an object that moves"),
    ("drop", "contact.exponent=0.5", "contact.exponent: got", "at least 1"),
    ("drop", "contact.law=palmgren", "contact.reference_force: got", "only for the law power"),
    ("drop", "contact.yield_pressure=1 GPa", "contact.yield_pressure: got", "not for the law power"),
    ("drop", "striker.mount_damping=10 N s/m", "striker.mount_damping: got", "there is no mount"),
    ("pendulum", "machine.angle=200 deg", "machine.angle: got", "at most 3.14159 rad"),
    ("pendulum", "machine.angle=180 deg", "machine.angle: got", "less than 180 deg"),
    ("pendulum", "machine.angle=0 deg", "machine.angle: got", "above 0 rad"),
    ("pendulum", "machine.inertia=1 kg m^2", "machine.inertia: ", "at least mass times centre squared"),
    ("pendulum", "machine.period=2 s", "machine.inertia: got", "either inertia or period"),
    ("pendulum", "striker.mass=500 kg", "machine.inertia: got", "it includes [striker]"),
    ("machete", "machine.teeth=31", "machine.teeth: got", "machine.wheel_teeth (30)"),
    ("machete", "machine.teeth=2.5", "machine.teeth: got", "whole number"),
    ("machete", "machine.friction=60 N m", "machine.teeth: ", "friction"),
    ("machete", "machine.mass=2 kg", "machine.centre: missing", "machine.mass"),
    ("gas-gun", "machine.pressure=5 bar", "machine.pressure: got", "either the speed"),
    ("gas-gun", "machine.speed=0 m/s", "machine.speed: got", "above 0"),
    ("gas-gun", "machine.speed=730 rpm", "machine.speed: got", "a speed"),
    ("amplifier", "machine.body.first.mass=0 kg", "machine.body.first.mass: got", "above 0"),
    ("amplifier", "machine.restitution=1.2", "machine.restitution: got", "at most 1"),
    ("amplifier", "machine.body.second.name=first", "machine.body.first.name: got", "of its own"),
    ("amplifier", "object.gravity=1 m/s^2", "object.gravity: got", "falls alike"),
]


@pytest.mark.parametrize(("kind", "change", "begins", "words"), WRONG)
def test_wrong_inputs_are_refused_with_field_and_remedy(kind, change, begins, words):
    lines = refused(kind, change)
    assert len(lines) == 1
    assert lines[0].startswith(begins)
    assert words in lines[0]


def test_a_bare_number_is_taken_in_the_unit_of_its_own_machine():
    assert load_case(CASES["gas-gun"], ["machine.speed=40"]).machine.speed.typed == "40 m/s"
    assert load_case("li-ma-2019", ["machine.speed=40"]).machine.speed.typed == "40 rad/s"


def test_a_long_run_keeps_its_samples_bounded():
    (line,) = refused("drop", "machine.follow=1 s", "solver.output_step=1e-7 s")
    assert line.startswith("solver.output_step: got")


@pytest.mark.parametrize(
    "raw", [3, "drop", [], [1], {}, {"kind": []}, {"kind": {"a": 1}}, {"kind": "drop", "height": {}}]
)
def test_a_machine_that_is_no_table_is_refused(raw):
    import tomlkit

    document = tomlkit.parse(dump_case(load_case(CASES["drop"])))
    document["machine"] = raw
    with pytest.raises(InputErrors, match="machine"):
        parse_case(tomlkit.dumps(document))


@pytest.mark.parametrize(
    "body", ["x", 3, [1], [{}], [{"name": "a"}], {"name": "a"}, [{"name": "\u0007", "mass": "1 kg"}]]
)
def test_bodies_that_are_no_rows_are_refused(body):
    import tomlkit

    document = tomlkit.parse(dump_case(load_case(CASES["amplifier"])))
    document["machine"]["body"] = body
    with pytest.raises(InputErrors, match=r"machine\.body"):
        parse_case(tomlkit.dumps(document))


def edited(kind, old, new):
    text = dump_case(load_case(CASES[kind]))
    assert old in text
    return text.replace(old, new)


def test_a_feed_is_for_the_rotary_machine_alone():
    text = dump_case(load_case(CASES["drop"]))
    feed = dump_case(load_case("li-ma-2019"))
    table = feed[feed.index("[feed]") : feed.index("[object]")]
    with pytest.raises(InputErrors) as caught:
        parse_case(text + "\n" + table)
    assert "feed: got" in str(caught.value)
    assert "remove it" in str(caught.value)
    with pytest.raises(InputErrors, match=r"feed: missing; add \[feed\]"):
        parse_case(feed.replace(table, ""))


def test_a_body_without_mass_is_named():
    text = edited("amplifier", 'mass = {value = "31.623 gram", provenance = "inferred", note = "geometric row"}\n', "")
    with pytest.raises(InputErrors, match=r"machine\.body\.third\.mass: missing"):
        parse_case(text)


def test_a_gun_needs_its_speed_or_its_reservoir():
    text = dump_case(load_case(CASES["gas-gun"]))
    line = next(line for line in text.splitlines() if line.startswith("speed"))
    with pytest.raises(InputError, match=r"machine.speed: missing"):
        check_case(parse_case(text.replace(line, "")))
    with pytest.raises(InputError, match=r"machine.volume: missing"):
        check_case(parse_case(text.replace(line, 'pressure = "5 bar"')))
    whole = 'pressure = "90 kPa"\nvolume = "5000 cm^3"\nbore = "25 mm"\nlength = "1 m"'
    with pytest.raises(InputError, match=r"machine.pressure: got .*add 1 atm"):
        check_case(parse_case(text.replace(line, whole)))


@pytest.mark.parametrize(
    ("kind", "words"),
    [("drpo", 'did you mean "drop"'), ("hopkinson", "`strikewave wave` runs it"), (3, "'rotary'"), (None, "missing")],
)
def test_an_unknown_kind_is_refused_with_all_kinds(kind, words):
    text = dump_case(load_case(CASES["drop"]))
    line = "" if kind is None else f"kind = {kind!r}"
    with pytest.raises(InputErrors) as caught:
        parse_case(text.replace('kind = "drop"', line, 1))
    (line,) = caught.value.lines
    assert line.startswith("machine.kind: ")
    assert words in line
    assert "'amplifier'" in line


@pytest.mark.parametrize("key", ["mount_stiffness", "nose_radius", "contact_length"])
def test_a_rotary_machine_needs_all_of_its_striker(key):
    text = dump_case(load_case("li-ma-2019"))
    line = next(line for line in text.splitlines() if line.startswith(key))
    with pytest.raises(InputErrors, match=f"striker.{key}: missing; add {key} = "):
        parse_case(text.replace(line, ""))


@pytest.mark.parametrize("key", ["spring", "preload", "damper", "stop_stiffness", "stop_restitution", "gravity"])
def test_a_rotary_machine_needs_all_that_holds_its_object(key):
    text = dump_case(load_case("li-ma-2019"))
    line = next(line for line in text.splitlines() if line.startswith(f"{key} ="))
    with pytest.raises(InputErrors, match=f"object.{key}: missing; add {key}"):
        parse_case(text.replace(line, ""))
    with pytest.raises(InputErrors, match=r"object.spring: got"):
        load_case("li-ma-2019", ["object.spring=0 N/m"])


def test_a_nose_needs_the_sizes_of_its_law():
    (line,) = refused("falling-ball", "contact.law=palmgren")
    assert line.startswith("striker.contact_length: missing")
    text = dump_case(load_case(CASES["falling-ball"]))
    radius = next(line for line in text.splitlines() if line.startswith("nose_radius"))
    with pytest.raises(InputError, match=r"striker.nose_radius: missing"):
        check_case(parse_case(text.replace(radius, "")))


def test_a_shaper_needs_force_and_depth():
    text = dump_case(load_case(CASES["drop"]))
    for key in ("reference_force", "reference_depth"):
        line = next(line for line in text.splitlines() if line.startswith(key))
        with pytest.raises(InputError, match=f"contact.{key}: missing"):
            check_case(parse_case(text.replace(line, "")))


@pytest.mark.parametrize("name", CASES.values())
def test_a_case_is_written_so_that_it_reads_the_same(name):
    case = load_case(name)
    assert parse_case(dump_case(case)) == case


@pytest.mark.parametrize("kind", [kind for kind in CASES if kind != "drop"])
def test_what_needs_a_rotary_machine_says_so(kind):
    with pytest.raises(InputError, match=r"machine.kind: got .*this needs a rotary machine"):
        load_case(CASES[kind]).rotary_tables()


def test_paths_of_a_machine_know_its_kind():
    assert FORM.range_at(["machine", "gas-gun", "speed"]).unit == "m/s"
    assert FORM.range_at(["machine", "rotary", "speed"]).unit == "rad/s"
    assert FORM.range_at(["machine", "body", "first", "gap"]).unit == "m"
    assert "wheel_teeth" in FORM.keys_at(["machine", "machete"])
    assert "wheel_teeth" not in FORM.keys_at(["machine", "drop"])


def test_values_of_bodies_have_paths():
    case = load_case(CASES["amplifier"], ["machine.body.second.mass=200 gram"])
    assert case.values()["machine.body.second.mass"].si == pytest.approx(0.2, rel=1e-15)
    assert "machine.body.second.mass" in case.changed_fields()


SETTINGS_OF_CASES = {
    "iso-16063-22-dropball": "drop height 1 m",
    "jesd22-b111-b": "drop height 0.2795 m",
    "mil-s-901d-hammer": "release angle 90 deg",
    "machete-13-teeth": "13 teeth",
    "en-166-ball": "speed 45 m/s",
    "rodgers-2009-amplifier": "drop height 0.5 m",
    "dual-mass-amplifier": "drop height 0.5 m, gap 10 mm",
}


@pytest.mark.parametrize("name", SETTINGS_OF_CASES)
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


@pytest.mark.parametrize("name", SETTINGS_OF_CASES)
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
    assert {commands[name] for name in SETTINGS_OF_CASES} == {"run"}
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


LAUNCHED = [name for name in bundled_cases() if load_case(name).launched() is not None]
RESERVOIR = 'pressure = "6 bar"\nvolume = "5000 cm^3"\nbore = "25 mm"\nlength = "1 m"'


@pytest.mark.parametrize("kind", KINDS)
def test_a_kind_has_its_words_settings_and_sources(kind):
    table = KINDS[kind]
    assert issubclass(table, MachineKind)
    assert table.__doc__.startswith("[machine]: ")
    assert table.description.endswith(".")
    assert len(table.chain) > 2
    assert set(table.settings) <= set(table.model_fields)
    assert set(table.sources) <= set(SOURCES)


def test_every_kind_has_a_case_and_every_launched_case_is_built():
    assert {load_case(name).machine.kind for name in LAUNCHED} | {"rotary"} == set(KINDS)
    for name in LAUNCHED:
        assert build_machine(load_case(name)).launch is not None


@pytest.mark.parametrize("name", LAUNCHED)
def test_a_schematic_shows_masses_and_what_it_is_not(name):
    case = load_case(name)
    (picture,), parts = kind_of(case).drawing(case)
    numbers = [one for part in parts for one in part.entries]
    mass = case.striker.mass.si
    assert any(one.shown in (f"{mass:.4g} kg", f"{mass * 1e3:.4g} g") for one in numbers)
    assert "not to scale" in picture.caption
    counted = int(picture.label.rpartition("Of the ")[2].split()[0])
    assert counted == sum(one.provenance != "computed" for one in numbers)


@pytest.mark.parametrize("name", LAUNCHED)
def test_a_schematic_numbers_each_part_once(name):
    case = load_case(name)
    (picture,), parts = kind_of(case).drawing(case)
    shown = [text.get_text() for axes in picture.figure.axes for text in axes.texts]
    assert sorted(word for word in shown if word.isdigit()) == sorted(str(k) for k in range(1, len(parts) + 1))


def test_a_pressed_gun_is_drawn_with_its_reservoir():
    text, name = read_case_text("en-166-ball")
    line = next(line for line in text.splitlines() if line.startswith("speed"))
    case = parse_case(text.replace(line, RESERVOIR), name)
    numbers = [one.shown for part in kind_of(case).drawing(case).parts for one in part.entries]
    assert {"5000 cm³", "6 bar", "25 mm"} <= set(numbers)


def test_a_case_without_a_machine_is_of_no_kind():
    with pytest.raises(InputError, match="machine: missing"):
        kind_of(load_case("togami-1996-bar"))


def test_reading_a_case_takes_no_physics():
    """The folder of kinds is read with every case: no kernels, no pictures."""
    code = (
        "import sys; from strikewave.cases.case import load_case; load_case('jesd22-b111-b');"
        "print(sorted({'numba', 'matplotlib', 'strikewave.machines'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


@pytest.mark.verify
@pytest.mark.parametrize("kind", [kind for kind in KINDS if issubclass(KINDS[kind], LaunchedKind)])
def test_a_kind_can_be_imported_before_any_case(kind):
    module = KINDS[kind].__module__
    subprocess.run([sys.executable, "-c", f"import {module}"], check=True, capture_output=True)
