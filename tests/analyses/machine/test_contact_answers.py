"""The first blow of a machine with its contact elastic and yielding: what each answer is, and where it is shown."""

import json
import math
import re

import numpy as np
import pytest

from strikewave import load_case, run_case, run_wave
from strikewave.analyses.machine.report import blow_table
from strikewave.analyses.machine.result import answer_columns
from strikewave.analyses.machine.screen import show
from strikewave.base.constants import STANDARD_GRAVITY, material
from strikewave.base.errors import InputError
from strikewave.cases.case import dump_case, parse_case
from strikewave.contact import automatic_pressure, contact_modulus

from ...contact.jackson_green import jackson_green

YIELDING = ("endevco-tp-321", "iso-16063-22-dropball", "machete-13-teeth", "en-166-ball", "rodgers-2009-amplifier")
"""Built-in cases whose contacts pass first yield and are the pulse."""


def elastic(name, *changes):
    """Return a built-in case without its yield pressure."""
    case = load_case(name, changes)
    return case.model_copy(update={"contact": case.contact.model_copy(update={"yield_pressure": None})})


@pytest.mark.parametrize("name", YIELDING)
def test_each_answer_is_the_run_with_that_pressure_given_by_hand(name):
    """Elastic, low, best (the case itself, by "auto") and high: every one its own run, bit for bit."""
    case = load_case(name)
    found = run_case(case).contact
    bodies = material(case.striker.material), material(case.object.material)
    pressures = automatic_pressure(*bodies)
    assert [row.yield_pressure for row in found.rows] == [None, pressures.low, pressures.best, pressures.high]
    for row in found.rows:
        given = [] if row.yield_pressure is None else [f"contact.yield_pressure={row.yield_pressure!r} Pa"]
        blow = run_case(load_case(name, given) if given else elastic(name)).blows[0]
        assert (row.rigid_peak, row.peak_force, row.restitution) == (blow.rigid_peak, blow.peak_force, blow.restitution)


@pytest.mark.parametrize("name", YIELDING)
def test_answers_keep_the_order_of_their_pressures(name):
    found = run_case(load_case(name)).contact
    first, low, best, high = (row.rigid_peak for row in found.rows)
    assert low < best < high < first
    assert found.band == (low, high)
    assert found.differ
    assert found.times_first_yield > 100.0


@pytest.mark.parametrize("name", ["iso-16063-22-dropball", "machete-13-teeth"])
def test_finite_elements_of_jackson_and_green_in_place_of_the_cap(name):
    """Striker, nose and assembly, own integration; loads as by finite elements, unloads elastically, without damping.

    The two laws differ by up to 16 % in force at equal energy; behind a frame their peaks agree to 5 %.
    """
    case = load_case(name, ["contact.restitution=1"])
    solution = run_case(case)
    striker, struck, steel = case.striker, case.object, material("45 steel")
    modulus, radius = contact_modulus(steel, steel), striker.nose_radius.si
    _, _, force = jackson_green(steel.yield_strength, steel.poissons_ratio, radius, modulus)
    masses = np.array([striker.mass.si, struck.nose_mass.si, struck.mass.si - struck.nose_mass.si])
    place, speed = np.zeros(3), np.array([solution.launch["approach_speed"], 0.0, 0.0])
    step, deepest, largest, peak = 5e-8, 0.0, 0.0, 0.0
    while place[0] - place[1] > 0.0 or deepest == 0.0:
        depth = max(place[0] - place[1], 0.0)
        if depth >= deepest:
            deepest, pressed = depth, force(depth) if depth else 0.0
            largest = pressed
        else:
            flatter = max(4 / 3 * modulus * math.sqrt(radius) * deepest**1.5 / largest, 1.0)
            left = deepest * (1 - 1 / flatter)
            pressed = 4 / 3 * modulus * math.sqrt(radius) * max(flatter * (depth - left), 0.0) ** 1.5 / flatter
        frame = struck.frame_stiffness.si * (place[1] - place[2]) + struck.frame_damping.si * (speed[1] - speed[2])
        speed = speed + step * np.array([-pressed, pressed - frame, frame]) / masses
        place = place + step * speed
        peak = max(peak, frame / masses[2])
    assert solution.blows[0].rigid_peak == pytest.approx(peak, rel=0.05)


def test_a_rotary_machine_answers_for_its_first_blow_alone():
    """The elastic answer beside a given pressure is the first blow of the elastic run of all 11, to rounding."""
    yielding = run_case(load_case("li-ma-2019", ["contact.yield_pressure=1.2 GPa"])).contact
    whole = run_case(load_case("li-ma-2019"))
    assert [row.name for row in yielding.rows] == ["elastic", "yielding"]
    assert yielding.rows[0].rigid_peak == pytest.approx(whole.blows[0].rigid_peak, rel=1e-9)
    assert whole.contact.taken == "elastic"
    assert whole.contact.row("yielding").rigid_peak == whole.blows[0].rigid_peak  # its load is never reached


def test_what_is_asked_of_the_damping_and_what_comes_out_is_said(strikewave):
    code, out, _ = strikewave("run", "--no-band", "iso-16063-22-dropball", "--json")
    document = json.loads(out)
    contact, blow = document["contact"], document["blows"][0]
    assert code == 0
    assert contact["asked_restitution"] == 0.7
    assert contact["restitution"] == blow["restitution"] < 0.6
    said = {warning["code"]: warning for warning in document["warnings"]}
    assert said["restitution-differs"]["limit"] == 0.7
    assert said["restitution-differs"]["value"] == blow["restitution"]
    assert "times" not in said["contact-yields"]["message"]
    assert set(contact["answers"][0]) <= {"name", *document["units"]}


def test_answers_that_differ_are_on_screen_and_page_and_others_are_not(capsys):
    yielding = run_case(load_case("iso-16063-22-dropball"))
    title = "First blow with its contact elastic and yielding"
    show(yielding)
    said = capsys.readouterr()
    assert title in said.out
    assert answer_columns(yielding.contact)[0].cells()[2] == "yielding (this run)"
    assert "0.7 asked of the damping" in said.out
    assert [part.caption for part in blow_table(yielding).parts][-1].startswith(title)
    # a nose so wide that first yield is passed by a third, but the lowest pressure never reached
    wide = run_case(load_case("li-ma-2019", ["striker.nose_radius=35 mm", "feed.blows=1"]))
    assert wide.contact.times_first_yield > 1.0
    assert not wide.contact.differ
    show(wide)
    assert title not in capsys.readouterr().out
    assert not any(part.caption.startswith(title) for part in blow_table(wide).parts)
    assert next(n for n in wide.notices if n.code == "contact-yield").message.endswith('"auto"')


def test_an_elastic_case_that_passes_first_yield_names_both_answers():
    solution = run_case(elastic("iso-16063-22-dropball"))
    message = next(notice for notice in solution.notices if notice.code == "contact-yield").message
    for row in (solution.contact.row("elastic"), solution.contact.row("yielding")):
        assert f"{row.rigid_peak / STANDARD_GRAVITY:.0f} g" in message


def test_a_material_without_hardness_and_strength_is_refused_with_what_to_do():
    case = load_case("iso-16063-22-dropball", ["object.material=rubber"])
    with pytest.raises(InputError, match=r"rubber has neither hardness nor yield strength.*give it, such as"):
        run_case(case)
    given = run_case(load_case("iso-16063-22-dropball", ["object.material=rubber", "contact.yield_pressure=1 MPa"]))
    assert given.contact.row("yielding").yield_pressure == 1e6


def test_a_material_that_is_no_metal_gives_no_pressure():
    """The hardness of a polymer is a smaller multiple of its yield strength than the 2.84 of metals."""
    case = load_case("iso-16063-22-dropball", ["object.material=PMMA"])
    with pytest.raises(InputError, match=r"PMMA is no metal.*give it, such as"):
        run_case(case)
    solution = run_case(elastic("iso-16063-22-dropball", "object.material=PMMA"))
    assert [row.name for row in solution.contact.rows] == ["elastic"]
    message = next(notice for notice in solution.notices if notice.code == "contact-yield").message
    assert "these materials do not tell" in message


def test_auto_is_read_written_and_compared_as_a_choice():
    case = load_case("li-ma-2019", ["contact.yield_pressure=auto"])
    assert case.contact.yield_pressure == "auto"
    assert parse_case(dump_case(case)) == case
    assert case.changed_fields() == ["contact.yield_pressure"]
    with pytest.raises(Exception, match=r'contact.yield_pressure: got "aut".*or "auto"'):
        load_case("li-ma-2019", ["contact.yield_pressure=aut"])


def test_a_joint_takes_the_pressure_of_its_softer_neighbour():
    from strikewave.cases.stack_of_case import build_stack

    base = '[[stack.layer]]\nname = "{}"\nmaterial = "{}"\nlength = "20 mm"\ndiameter = "20 mm"\n'
    text = "schema = 1\n" + base.format("one", "45 steel") + base.format("two", "17-4PH")
    text += '[[stack.joint]]\nafter = "one"\nkind = "contact"\nlaw = "hertz"\nradius = "10 mm"\nyield_pressure = "{}"\n'
    text += '[load]\nshape = "half-sine"\npeak = "1 kN"\nduration = "20 us"\n'
    loads = [build_stack(parse_case(text.format(word))).joints[0].contact.cap for word in ("auto", "2016.4 MPa")]
    assert loads[0] == loads[1]


def test_a_pressure_beyond_the_end_of_a_logarithmic_law_is_refused_by_its_field():
    """The limit that the error names is the one at which it stops: just below it the case is taken."""
    from strikewave.analyses.machine.build import build_machine

    own = ["contact.law=johnson", "contact.datum_depth=30 mm"]
    with pytest.raises(InputError) as refused:
        build_machine(load_case("li-ma-2019", [*own, "contact.yield_pressure=1000 GPa"]))
    assert refused.value.field == "contact.yield_pressure"
    most = float(re.search(r"below ([0-9.]+) GPa", refused.value.allowed)[1])
    build_machine(load_case("li-ma-2019", [*own, f"contact.yield_pressure={0.999 * most} GPa"]))
    with pytest.raises(InputError, match="ends"):
        build_machine(load_case("li-ma-2019", [*own, f"contact.yield_pressure={1.001 * most} GPa"]))


def test_the_contact_of_two_layers_is_reported_where_it_yields():
    """A sphere of 10 mm on 45 steel yields below its surface long before 5 kN, and not under 1 N; not where capped."""
    base = '[[stack.layer]]\nname = "{}"\nmaterial = "45 steel"\nlength = "50 mm"\ndiameter = "20 mm"\n'
    text = "schema = 1\n" + base.format("one") + base.format("two")
    text += '[[stack.joint]]\nafter = "one"\nkind = "contact"\nradius = "10 mm"\n{}\n'
    text += '[load]\nshape = "half-sine"\npeak = "{}"\nduration = "50 us"\n[solver]\nduration = "60 us"\n'

    def messages(peak, more=""):
        notices = run_wave(parse_case(text.format(more, peak))).notices
        return [notice.message for notice in notices if notice.code == "contact-yield"]

    (message,) = messages("5 kN")
    assert "between one and two" in message
    assert "stack.joint.one.yield_pressure" in message
    assert not messages("1 N")
    assert not messages("5 kN", 'yield_pressure = "auto"')
