"""``strikewave impact``: laws, dampers, yielding spots, repeated blows, files, and what it refuses."""

import json
import math
import os
import re
from xml.etree import ElementTree

import numpy as np
import pytest

from strikewave.base.constants import material
from strikewave.contact import (
    Contact,
    Geometry,
    Stiffness,
    damper_law,
    damping_laws,
    exact,
    line_cap,
    line_yield_pressure,
    point_cap,
    point_yield_pressure,
    reduced_mass,
    restitution,
    solve_impact,
    stiffness_laws,
    stiffness_of,
)

BODIES = ("--m1", "0.2", "--m2", "0.459", "--speed", "5")
LINE = ("--length", "40 mm", "--radius1", "10 mm", "--radius2", "20 mm")
GIVEN = ("--stiffness", "1e9", "--exponent", "1.5")


def sizes_of(law):
    """Return the options of the sizes that a law takes."""
    return LINE if "length" in stiffness_laws()[law].needs else LINE[2:]


STEEL = material("65Mn")
SIZES = Geometry(0.010, 0.020, 0.040)
BLOW_KEYS = {
    "restitution", "max_indentation", "residual_indentation", "peak_force", "duration", "energy_lost", "flattening",
}  # fmt: skip
KEYS = BLOW_KEYS | {
    "schema", "version", "units", "warnings", "asked_restitution", "peak_time", "turning_time", "method", "stiffness",
    "exponent", "slope", "load", "hysteresis_factor", "law", "law_status", "damping", "damping_status", "damper",
    "damper_status", "damper_coefficient", "damper_exponent", "yield_load", "shape", "cap", "cap_status", "blows",
    "answers", "differ",
}  # fmt: skip


@pytest.fixture
def impact(strikewave):
    """Run ``strikewave impact --json`` with the bodies above; return its document."""

    def call(*words):
        code, out, err = strikewave("impact", *BODIES, *words, "--json")
        assert code == 0, err
        return json.loads(out)

    return call


def codes(document):
    return [warning["code"] for warning in document["warnings"]]


def assert_same(document, blow):
    for key in BLOW_KEYS | {"peak_time", "turning_time"}:
        assert document[key] == pytest.approx(float(getattr(blow, key)), rel=1e-12, abs=1e-300), key
    assert document["method"] == blow.method


def test_keys_of_a_power_law(impact):
    document = impact(*GIVEN, "-e", "0.5")
    assert set(document) == KEYS
    assert [set(blow) for blow in document["blows"]] == [BLOW_KEYS]
    assert_same(document, solve_impact(Contact(1e9, 1.5, exact(0.5)), 0.2, 0.459, 5.0))
    assert (document["law"], document["damping"], document["method"]) == ("given", "exact", "closed form")
    assert (document["flattening"], document["residual_indentation"]) == (1.0, 0.0)
    for key in ("slope", "load", "damper", "damper_status", "damper_coefficient", "yield_load", "shape", "cap"):
        assert document[key] is None, key
    assert document["warnings"] == []


@pytest.mark.parametrize("law", sorted(stiffness_laws()))
def test_every_stiffness_law(impact, law):
    document = impact("--law", law, *sizes_of(law), "-e", "0.7")
    stiffness = stiffness_of(law, STEEL, STEEL, SIZES)
    assert_same(document, solve_impact(stiffness.contact(exact(0.7)), 0.2, 0.459, 5.0))
    assert (document["law"], document["law_status"]) == (law, stiffness.status)
    logarithmic = not isinstance(stiffness, Stiffness)
    held = dict(zip(("slope", "load") if logarithmic else ("stiffness", "exponent"), stiffness[:2], strict=True))
    for key in ("stiffness", "exponent", "slope", "load"):
        assert document[key] == held.get(key)
    assert document["restitution"] == pytest.approx(0.7, abs=1e-7)


@pytest.mark.parametrize("law", sorted(damping_laws()))
def test_every_damping_law(impact, law):
    document = impact(*GIVEN, "-e", "0.5", "--damping", law)
    found = damping_laws()[law]
    assert document["restitution"] == pytest.approx(float(restitution(found.function(0.5))), rel=1e-12)
    assert document["hysteresis_factor"] == pytest.approx(float(found.function(0.5)), rel=1e-15)
    assert document["damping_status"] == found.status
    assert ("restitution-differs" in codes(document)) == (law != "exact")
    assert ("law-from-memory" in codes(document)) == (found.status == "from memory")


def test_a_law_from_memory_is_named_on_the_screen(strikewave):
    code, out, err = strikewave("impact", *BODIES, *GIVEN, "-e", "0.5", "--damping", "hu-guo")
    assert code == 0
    assert re.search(r"^damping law +hu-guo\nstatus of the damping law +from memory$", out, re.MULTILINE)
    assert "info [law-from-memory]: the damping law hu-guo" in err


def test_pereira_in_a_hole_is_from_memory(impact):
    document = impact("--law", "pereira", "--length", "40 mm", "--radius1", "10 mm", "--radius2", "-10.5 mm")
    assert document["law_status"] == "from memory"
    assert "the stiffness law pereira" in next(
        w["message"] for w in document["warnings"] if w["code"] == "law-from-memory"
    )


def test_a_cylinder_on_a_plane_takes_a_datum_depth(impact):
    sizes = Geometry(0.010, np.inf, 0.040, 0.050)
    document = impact("--law", "johnson", "--length", "40 mm", "--radius1", "10 mm", "--datum-depth", "50 mm")
    assert document["load"] == pytest.approx(stiffness_of("johnson", STEEL, STEEL, sizes).load, rel=1e-14)


@pytest.mark.parametrize(("name", "differs"), [("tsuji", False), ("tsuji-cut-off", False), ("jankowski", True)])
def test_dampers(impact, name, differs):
    document = impact("--law", "hertz", "--radius1", "10 mm", "--damper", name, "-e", "0.5")
    stiffness = stiffness_of("hertz", STEEL, STEEL, Geometry(0.010))
    damper = damper_law(name).function(stiffness, float(reduced_mass(0.2, 0.459)), 0.5)
    assert_same(document, solve_impact(stiffness.contact(damper=damper), 0.2, 0.459, 5.0))
    assert document["restitution"] == pytest.approx(float(damper_law(name).given(0.5, 1.5)), abs=1e-6)
    assert (document["damper"], document["damper_status"]) == (name, "quoted")
    assert document["damper_coefficient"] == pytest.approx(float(damper.coefficient), rel=1e-14)
    assert document["damper_exponent"] == damper.exponent
    assert document["damping"] is document["damping_status"] is document["hysteresis_factor"] is None
    assert ("restitution-differs" in codes(document)) == differs


def test_kuwabara_kono_is_asked_for_a_time(impact):
    document = impact("--law", "hertz", "--radius1", "10 mm", "--damper", "kuwabara-kono", "--time", "1 us")
    assert document["asked_restitution"] is None
    assert codes(document) == ["contact-yield"]
    assert 0.9 < document["restitution"] < 1.0
    k = stiffness_of("hertz", STEEL, STEEL, Geometry(0.010)).stiffness
    assert document["damper_coefficient"] == pytest.approx(1.5 * 1e-6 * k, rel=1e-12)


def yielding(cap, stiffness, count):
    """Solve blows on one spot."""
    blows, deepest = [], 0.0
    for _ in range(count):
        blows.append(solve_impact(stiffness.contact(exact(0.7), cap), 0.2, 0.459, 5.0, deepest))
        deepest = blows[-1].deepest
    return blows


@pytest.mark.parametrize("law", ["johnson", "palmgren", "hertz"])
def test_blows_on_a_spot_that_yields(impact, law):
    document = impact("--law", law, *sizes_of(law), "-e", "0.7", "--yield-pressure", "1.2 GPa", "--repeat", "4")
    point = point_cap(STEEL, STEEL, 0.010, 0.020, 1.2e9)
    cap = point if law == "hertz" else line_cap(STEEL, STEEL, 0.010, 0.020, 0.040, 1.2e9)
    blows = yielding(cap, stiffness_of(law, STEEL, STEEL, SIZES), 4)
    assert document["shape"] == cap.shape
    named = ("thornton", "quoted") if law == "hertz" else ("line", "checked")
    assert (document["cap"], document["cap_status"]) == named
    assert document["yield_load"] == pytest.approx(float(cap.yield_load), rel=1e-14)
    assert_same(document, blows[0])
    for told, blow in zip(document["blows"], blows, strict=True):
        assert told == pytest.approx({key: float(getattr(blow, key)) for key in BLOW_KEYS}, rel=1e-12)
    left = [blow["residual_indentation"] for blow in document["blows"]]
    assert left == sorted(left)
    assert left[0] > 0.0
    message = next(w["message"] for w in document["warnings"] if w["code"] == "restitution-differs")
    assert "the contact yields" in message
    assert "contact-yield" not in codes(document)


def test_a_given_stiffness_yields_at_a_load(impact):
    document = impact(*GIVEN, "--yield-load", "6.5 kN", "--shape", "point")
    assert (document["yield_load"], document["shape"]) == (6500.0, "point")
    assert document["flattening"] > 1.0


def test_blows_without_yielding_are_all_the_same(impact):
    document = impact(*GIVEN, "-e", "0.5", "--repeat", "1000")
    assert len(document["blows"]) == 1000
    assert document["blows"][999] == {key: document[key] for key in BLOW_KEYS}


def test_many_blows_are_shortened_on_the_screen(strikewave):
    code, out, _ = strikewave("impact", *BODIES, *GIVEN, "--yield-load", "1 kN", "--shape", "line", "--repeat", "40")
    assert code == 0
    first = [line.split()[0] for line in out.split("Blows on the same spot")[1].splitlines() if line.strip()]
    rows = [word for word in first if word.isdigit() or word == "..."]
    assert rows == [*(str(k) for k in range(1, 11)), "...", *(str(k) for k in range(31, 41))]
    assert "the first and last 10 of 40 blows" in out


def test_an_elastic_line_that_would_yield_is_warned_of(impact):
    limit = float(line_cap(STEEL, STEEL, 0.010, 0.020, 0.040, line_yield_pressure(STEEL, 430e6)).yield_load)
    document = impact("--law", "palmgren", *LINE)
    warning = next(w for w in document["warnings"] if w["code"] == "contact-yield")
    assert warning["limit"] == pytest.approx(limit, rel=1e-12)
    assert warning["value"] == document["peak_force"] > limit
    assert codes(impact("--law", "palmgren", "--length", "40 mm")) == ["yield-unchecked"]


def test_an_elastic_sphere_that_would_yield_is_warned_of(impact):
    limit = float(point_cap(STEEL, STEEL, 0.010, math.inf, point_yield_pressure(STEEL, 430e6)).yield_load)
    document = impact("--law", "hertz", "--radius1", "10 mm")
    assert codes(document) == ["contact-yield"]
    assert document["warnings"][0]["limit"] == pytest.approx(limit, rel=1e-12)


def test_a_cap_below_first_yield_asks_for_its_unit(impact):
    """A forgotten unit: 1.2 is 1.2 Pa."""
    document = impact("--law", "hertz", "--radius1", "10 mm", "--yield-pressure", "1.2")
    assert "yield-pressure-low" in codes(document)


def test_a_soft_line_below_yield_is_not_warned_of(strikewave):
    words = ("--m1", "1 gram", "--m2", "1 gram", "--speed", "0.1")
    document = json.loads(strikewave("impact", *words, "--law", "palmgren", *LINE, "--json")[1])
    assert document["warnings"] == []


def test_a_deep_indentation_of_a_sphere_is_warned_of(impact):
    document = impact("--law", "hertz", "--radius1", "1 mm")
    assert codes(document) == ["indentation-large", "contact-yield"]
    assert document["warnings"][0]["value"] == pytest.approx(document["max_indentation"] / 1e-3, rel=1e-12)


def test_out_holds_page_document_and_picture(strikewave, tmp_path, read_page):
    words = ("impact", *BODIES, "--law", "johnson", *LINE, "-e", "0.7", "--yield-pressure", "1.2 GPa", "--repeat", "9")
    code, out, err = strikewave(*words, "--out", "a", "--json")
    assert code == 0
    assert "written: a/ (report.html, impact.svg, history.csv, impact.json, record.toml)" in err
    assert sorted(os.listdir("a")) == ["history.csv", "impact.json", "impact.svg", "record.toml", "report.html"]
    assert os.listdir(tmp_path) == ["a"]
    assert json.loads(open("a/impact.json", encoding="utf-8").read()) == json.loads(out)
    ElementTree.parse("a/impact.svg")
    page, found = read_page("a/report.html"), json.loads(out)
    assert page.numbers["peak force"] == f"{found['peak_force'] / 1e3:.4g} kN"
    assert page.numbers["coefficient of restitution"] == f"{found['restitution']:.4g}"
    assert (page.pictures, "Blows" in page.sections) == (1, True)


@pytest.mark.verify
def test_out_replaces_another_impact_by_force_alone(strikewave):
    assert strikewave("impact", *BODIES, *GIVEN, "--out", "a")[0] == 0
    code, out, err = strikewave("impact", *BODIES, *GIVEN, "-e", "0.5", "--out", "a")
    assert (code, out) == (2, "")
    assert "add --force" in err
    assert strikewave("impact", *BODIES, *GIVEN, "-e", "0.5", "--out", "a", "--force")[0] == 0
    assert json.loads(open("a/impact.json").read())["asked_restitution"] == 0.5


@pytest.mark.verify
def test_the_history_that_is_written_identifies_its_own_law(strikewave):
    """500 steps of 9 digits, without a baseline before: K, n, e and speed to 1e-3."""
    words = ("--m1", "0.2", "--m2", "inf", "--speed", "5")
    assert strikewave("impact", *words, *GIVEN, "-e", "0.6", "--out", "a")[0] == 0
    code, out, err = strikewave("identify", "a/history.csv", "--channel", "force", "--mass", "0.2", "--json")
    assert code == 0, err
    values = {name: row["value"] for name, row in json.loads(out)["values"].items()}
    assert values["stiffness"] == pytest.approx(1e9, rel=2e-2)  # K carries n: one part in 1e3 of n is a percent of K
    assert values["exponent"] == pytest.approx(1.5, rel=1e-3)
    assert values["restitution"] == pytest.approx(0.6, rel=1e-3)
    assert values["speed"] == pytest.approx(5.0, rel=1e-3)


HERTZ = "--law hertz --radius1 .01"
BAD = {
    "--law jonson --radius1 .01": 'did you mean "johnson"?',
    "--law palmgren": "--length: missing",
    "--law johnson --length .04": "--radius1: missing",
    "--law johnson --length .04 --radius1 .01": "--datum-depth says it",
    "--law radzimovsky --length .04 --radius1 .01": "no limit for a plane",
    "--law hertz --radius1 .01 --radius2 -.01": "a hole larger than --radius1",
    "--law hertz --radius1 .01 --radius2 0": "negative for a hole",
    "--law hertz --radius1 -1": "--radius1",
    "--law pereira --length .04 --radius1 .01 --radius2 -.1": "0.005 to 10 mm",
    "--law johnson --length .04 --radius1 1e-320 --radius2 .02": "radii below",
    "--law johnson --length 1e-300 --radius1 .01 --radius2 1e300": "contact length must be positive",
    "--law hertz --radius1 .01 --exponent 1.5": "--exponent",
    "--law hertz --radius1 .01 --material1 cheese": "--material1",
    "--stiffness 0 --exponent 1.5": "--stiffness",
    "--stiffness 1e9": "--exponent: missing",
    "--stiffness 1e9 --exponent 11": "a number from 0.1 to 10",
    f"{HERTZ} -e 0": "--restitution",
    f"{HERTZ} -e 1.01": "--restitution",
    f"{HERTZ} -e nan": "--restitution",
    f"{HERTZ} --damping exakt": 'did you mean "exact"?',
    f"{HERTZ} --damper tsuij": 'did you mean "tsuji"?',
    f"{HERTZ} --damper tsuji --damping exact": "a damper replaces the damping law",
    f"{HERTZ} --damper kuwabara-kono -e 0.5": "cannot be asked for one",
    f"{HERTZ} --damper kuwabara-kono --time 1us -e 0.5": "cannot be asked for one",
    f"{HERTZ} --damper kuwabara-kono": "--time: missing",
    f"{HERTZ} --damper kuwabara-kono --time -1": "--time",
    f"{HERTZ} --damper kuwabara-kono --time 1e200": "could not be followed",
    f"{HERTZ} --damper tsuji --time 1us": "takes --restitution",
    f"{HERTZ} --damper kelvin-voigt -e 0.5": "exponent must be 1",
    f"{HERTZ} --time 1us": "--time",
    f"{HERTZ} --damper tsuji --yield-pressure 1e9": "no --damper beside it",
    "--stiffness 1e9 --exponent .5 --damper tsuji -e .5": "the exponent of the damper",
    "--law johnson --length .04 --radius1 .01 --radius2 .02 --damper tsuji": "johnson is logarithmic",
    "--law johnson --length .001 --radius1 .01 --radius2 .02 --m1 1e6 --m2 inf": "beyond the end of the logarithmic law",
    f"{HERTZ} --repeat 0": "--repeat",
    f"{HERTZ} --repeat 1001": "1 to 1000",
    f"{HERTZ} --repeat 1.5": "--repeat",
    f"{HERTZ} --speed 0": "--speed",
    f"{HERTZ} --speed inf": "--speed",
    f"{HERTZ} --m1 0": "--m1",
    f"{HERTZ} --m1 inf --m2 inf": "at most one infinite mass",
    f"{HERTZ} --m1 1e300 --speed 1e300": "energy",
    f"{HERTZ} --yield-pressure 1e300": "a pressure that a body bears",
    f"{HERTZ} --yield-pressure 1e9 --yield-load 1": "--yield-load",
    f"{HERTZ} --yield-pressure 1e9 --shape point": "--shape",
    f"{HERTZ} --yield-pressure aut": "--yield-pressure",
    f"{HERTZ} --yield-pressure auto --material1 rubber": "rubber has neither hardness nor yield strength",
    "--stiffness 1e9 --exponent 1.5 --yield-pressure auto": "give --yield-load and --shape",
    f"{HERTZ} --yield-pressure 0": "--yield-pressure",
    f"{HERTZ} --shape point": "--yield-load: missing",
    "--law palmgren --length .04 --yield-pressure 1e9": "--radius1: missing",
    "--stiffness 1e9 --exponent 1.5 --yield-pressure 1e9": "give --yield-load and --shape",
    "--stiffness 1e9 --exponent 1.5 --yield-load 1e3": "--shape: missing",
    "--stiffness 1e9 --exponent 1.5 --yield-load 1e3 --shape round": "line or point",
    "--stiffness 1e9 --exponent 1.5 --yield-load 1e-100 --shape line": "could not be followed",
    f"{HERTZ} --out .": "--out",
}


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
@pytest.mark.parametrize("line", BAD)
def test_bad_input_is_one_line_and_exit_2(strikewave, tmp_path, line):
    (tmp_path / "taken").write_text("not a result")
    code, out, err = strikewave("impact", *BODIES, *line.split())
    assert (code, out) == (2, "")
    assert len(err.strip().splitlines()) == 1, err
    assert BAD[line] in err


def test_auto_is_the_pressure_of_the_softer_material_given_by_hand(impact):
    """7075-T6 of 1.471 GPa against 65Mn of 2.84 x 430 MPa: 2 x 1.2212 GPa."""
    sphere = ("--law", "hertz", "--radius1", "10 mm", "--material2", "7075-T6")
    auto = impact(*sphere, "--yield-pressure", "auto")
    by_hand = impact(*sphere, "--yield-pressure", "2.4424 GPa")
    for key in ("peak_force", "restitution", "yield_load", "residual_indentation"):
        assert auto[key] == pytest.approx(by_hand[key], rel=1e-9), key
    assert [row["name"] for row in by_hand["answers"]] == ["elastic", "yielding"]


def test_elastic_and_yielding_answers_are_shown_where_they_differ(impact, strikewave):
    sphere = ("--law", "hertz", "--radius1", "10 mm", "-e", "0.8")
    elastic, yielding = impact(*sphere), impact(*sphere, "--yield-pressure", "auto")
    assert elastic["differ"]
    assert yielding["differ"]
    for one, other in zip(elastic["answers"], yielding["answers"], strict=True):
        assert one["name"] == other["name"]
        assert one["peak_force"] == pytest.approx(other["peak_force"], rel=1e-6)
    names = [row["name"] for row in yielding["answers"]]
    assert names == ["elastic", "yielding, low", "yielding", "yielding, high"]
    forces = [row["peak_force"] for row in yielding["answers"]]
    assert forces[1] < forces[2] < forces[3] < forces[0]
    assert yielding["asked_restitution"] == 0.8
    assert yielding["restitution"] < 0.8
    assert {"contact-yields", "restitution-differs"} <= set(codes(yielding))
    _, out, err = strikewave("impact", *BODIES, *sphere, "--yield-pressure", "auto")
    assert "First blow with its contact elastic and yielding" in out
    assert f"elastic {elastic['peak_force'] / 1e3:.4g} kN" in err


def test_a_contact_far_below_first_yield_has_one_answer(strikewave):
    words = ("impact", "--m1", "1e-6", "--m2", "1e-6", "--speed", "1e-3", "--law", "hertz", "--radius1", "1 m")
    code, out, err = strikewave(*words)
    assert code == 0
    assert "elastic and yielding" not in out
    assert "yield" not in err


def test_a_contact_shorter_than_its_bodies_are_long_is_named(impact):
    """A steel cube of 0.459 kg has an edge of 38.9 mm, so a wave comes back after 15 us; a line of 40 m lasts 1.7 us."""
    bodies = ("--material1", "65Mn", "--material2", "65Mn")
    long, usual = (impact("--law", "palmgren", "--length", size, *bodies) for size in ("40 m", "40 mm"))
    assert "contact-short" in codes(long)
    assert "contact-short" not in codes(usual)
    for speed, code in (("900", "approach-fast"), ("5194", "approach-fast"), ("5195", "faster-than-wave")):
        assert code in codes(impact("--law", "hertz", "--radius1", "10 mm", *bodies, "--speed", speed))


@pytest.mark.parametrize(
    ("words", "stiffness", "damper"),
    [
        (("-n", "1.5", "--damping", "exact"), "N/m^1.5", "N s/m^(p+1)"),
        (("-n", "1", "--damper", "kelvin-voigt"), "N/m", "N s/m"),
        (("-n", "1.5", "--damper", "tsuji"), "N/m^1.5", "N s/m^1.25"),
    ],
)
def test_the_units_of_stiffness_and_damper_have_the_exponents_of_the_law(strikewave, words, stiffness, damper):
    typed = ("impact", *BODIES, "--stiffness", "1e9", "-e", "0.8", *words)
    units = json.loads(strikewave(*typed, "--json")[1])["units"]
    assert (units["stiffness"], units["damper_coefficient"]) == (stiffness, damper)
    screen = strikewave(*typed)[1]
    assert f"stiffness ({stiffness})" in screen
    assert (f"damper coefficient ({damper})" in screen) == ("--damper" in words)
