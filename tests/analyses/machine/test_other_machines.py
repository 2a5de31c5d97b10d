"""Cases of machines without a drive: what is refused, with which field and remedy, and what stays strict."""

import pytest

from strikewave.analyses.by_tables import check_case
from strikewave.base.errors import InputError, InputErrors
from strikewave.cases.case import Case, load_case, parse_case
from strikewave.cases.paths import Form
from strikewave.cases.written_case import dump_case

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
