"""Layers with loss and dispersion, oscillators, contacts and incident waves, from a case file to the stack."""

import math

import pytest

from strikewave.analyses.by_tables import check_case
from strikewave.analyses.wave.build import build_load
from strikewave.analyses.wave.run import run_wave
from strikewave.base.constants import material
from strikewave.base.errors import InputError, StrikewaveError
from strikewave.cases.case import load_case, parse_case
from strikewave.cases.stack_of_case import build_stack

BASE = """
schema = 1
name = "probe"
[[stack.layer]]
name = "upper"
material = "65Mn"
length = "50 mm"
diameter = "30 mm"
[[stack.layer]]
name = "lower"
material = "2A12"
length = "80 mm"
diameter = "30 mm"
{joint}
[stack.end]
{end}
[load]
shape = "sine-squared"
peak = "20 kN"
duration = "80 us"
{load}
[solver]
duration = "300 us"
{solver}
"""


def case_of(joint="", end='kind = "free"', load="", solver=""):
    return parse_case(BASE.format(joint=joint, end=end, load=load, solver=solver))


def joint_text(**fields):
    lines = ["[[stack.joint]]", 'after = "upper"', *(f"{key} = {value!r}" for key, value in fields.items())]
    return "\n".join(lines).replace("'", '"')


def test_an_oscillator_by_resonance_and_quality():
    """k = m (2 pi f)^2 and c = sqrt(k m)/Q."""
    text = joint_text(kind="oscillator", mass="2 gram", resonance="30 kHz", quality=20)
    joint = build_stack(case_of(text)).joints[0]
    assert joint.attached == 2e-3
    assert joint.stiffness == pytest.approx(2e-3 * (2 * math.pi * 3e4) ** 2)
    assert joint.damping == pytest.approx(math.sqrt(joint.stiffness * 2e-3) / 20)
    end = build_stack(case_of(end='kind = "oscillator"\nmass = "2 gram"\nstiffness = "70 MN/m"')).end
    assert (end.value, end.stiffness, end.damping) == (2e-3, 7e7, 0.0)


def test_a_contact_between_layers_is_hertz_of_their_materials():
    text = joint_text(kind="contact", radius="10 mm", preload="100 N")
    law = build_stack(case_of(text)).joints[0].contact
    steel, aluminium = material("65Mn"), material("2A12")
    compliance = sum((1 - x.poissons_ratio**2) / x.youngs_modulus for x in (steel, aluminium))
    assert float(law.stiffness) == pytest.approx(4 / 3 / compliance * math.sqrt(0.01))
    assert float(law.exponent) == 1.5


def test_loss_and_dispersion_take_the_spectral_solver_and_say_how_well_the_loss_is_held():
    case = parse_case(
        BASE.format(
            joint=joint_text(kind="gasket", material="PTFE", thickness="1 mm"),
            end='kind = "free"',
            load="",
            solver='dispersion = "pochhammer-chree"',
        ),
    )
    document = run_wave(case).document()
    assert document["method"] == "spectral"
    assert document["dispersion"] == "pochhammer-chree"
    [loss] = document["losses"]
    assert loss["where"] == "gasket after upper"
    assert 0.0 < loss["error"] < 0.25
    assert (loss["low"], loss["high"]) == (1e3, 1e5)
    assert document["units"]["loss_factor"] == "1"


def test_the_times_of_a_bolted_joint_are_listed():
    text = joint_text(kind="unilateral", preload="2 kN")
    [joint] = run_wave(case_of(text)).document()["joints"]
    assert joint["after"] == "upper"
    assert len(joint["opened"]) >= 1
    assert joint["opened"][0] < joint["closed"][0] if joint["closed"] else True


def test_an_incident_wave_is_half_of_what_a_free_end_feels():
    load = build_load(case_of(load='applied = "incident wave"'), build_stack(case_of()))
    assert load.kind == "incident"


@pytest.mark.parametrize(
    ("parts", "words"),
    [
        ({"joint": joint_text(kind="oscillator", resonance="30 kHz")}, "mass: missing"),
        ({"joint": joint_text(kind="oscillator", mass="2 gram")}, "resonance: missing"),
        (
            {"joint": joint_text(kind="oscillator", mass="2 gram", resonance="3 kHz", stiffness="1 MN/m")},
            "stiffness or resonance, not both",
        ),
        ({"joint": joint_text(kind="contact", law="hertzz", radius="10 mm")}, "hertz"),
        ({"joint": joint_text(kind="contact")}, "radius"),
        ({"joint": joint_text(kind="contact", radius="10 mm", thickness="1 mm")}, "for a joint of kind contact"),
        ({"joint": joint_text(kind="contact", radius="10 mm", preload="1 kN", gap="1 um")}, "no preload"),
        ({"end": 'kind = "free"\nmass = "1 kg"'}, "no other field"),
        ({"end": 'kind = "oscillator"\nmass = "1 kg"'}, "resonance: missing"),
        ({"load": 'applied = "wave"'}, "incident wave"),
        ({"solver": 'dispersion = "pochhammer"'}, "pochhammer-chree"),
        ({"solver": 'method = "fourier"'}, "spectral"),
    ],
)
def test_what_does_not_fit_is_said(parts, words):
    with pytest.raises(StrikewaveError) as caught:
        check_case(case_of(**parts))
    assert words in str(caught.value)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        (["solver.dispersion=pochhammer-chree"], "strikewave wave"),
        (["solver.method=spectral"], "strikewave wave"),
        (["stack.layer.sensor.loss_factor=0.1"], "strikewave wave"),
    ],
)
def test_a_machine_says_what_only_a_bar_alone_can_have(changes, words):
    with pytest.raises(StrikewaveError) as caught:
        check_case(load_case("li-ma-2019-fig13", changes))
    assert words in str(caught.value)


def test_a_layer_of_own_numbers_needs_a_poissons_ratio_for_dispersion():
    text = BASE.format(joint="", end="", load="", solver='dispersion = "love-rayleigh"')
    text = text.replace('material = "2A12"', 'density = "2700 kg/m^3"\nmodulus = "70 GPa"')
    with pytest.raises(InputError, match=r"stack\.layer\.lower\.poissons_ratio"):
        check_case(parse_case(text))
    check_case(parse_case(text.replace('modulus = "70 GPa"', 'modulus = "70 GPa"\npoissons_ratio = 0.33')))


def test_a_band_without_a_loss_factor_is_refused():
    text = BASE.format(joint="", end="", load="", solver="")
    text = text.replace('material = "2A12"', 'material = "2A12"\nband_low = "1 kHz"')
    with pytest.raises(InputError, match="loss_factor"):
        check_case(parse_case(text))


def test_a_mass_at_the_end_is_not_pushed_twice():
    """A slow load moves bar and mass as one body: F over the mass of both."""
    text = BASE.format(joint="", end='kind = "mass"\nmass = "0.5 kg"', load="", solver="")
    text = text.replace('duration = "80 us"', 'duration = "4 ms"').replace('duration = "300 us"', 'duration = "4 ms"')
    solution = run_wave(parse_case(text))
    middle = len(solution.run.time) // 2
    assert solution.rigid[middle] == pytest.approx(20e3 / solution.run.stack.mass, rel=0.01)


@pytest.mark.verify
def test_a_film_between_bars_is_run_and_reported_in_seconds():
    """A nanometre between 50 and 80 mm: a wave crosses it a hundred million times in the run."""
    from strikewave.analyses.wave.report import wave_report

    film = '[[stack.layer]]\nname = "film"\nmaterial = "2A12"\nlength = "1 nm"\ndiameter = "30 mm"\n'
    text = BASE.format(joint="", end="", load="", solver="")
    text = text.replace('[[stack.layer]]\nname = "lower"', film + '[[stack.layer]]\nname = "lower"')
    solution = run_wave(parse_case(text))
    assert solution.method == "spectral"
    assert "<svg" in wave_report(solution)


def test_the_route_of_the_paper_takes_an_incident_wave_as_it_comes():
    """Endless neighbours: the corrected route is then the exact answer, to the error bound of the run."""
    middle = '[[stack.layer]]\nname = "middle"\nmaterial = "2A12"\nlength = "20 mm"\ndiameter = "30 mm"\n'
    tap = '[[tap]]\nname = "mid"\nlayer = "middle"\n'
    parts = {"joint": "", "end": 'kind = "matched"', "load": 'applied = "incident wave"'}
    text = BASE.format(**parts, solver='route = "corrected"').replace("2A12", "65Mn") + tap
    text = text.replace('[[stack.layer]]\nname = "lower"', middle + '[[stack.layer]]\nname = "lower"')
    solution = run_wave(parse_case(text))
    route, exact = solution.by_route(0, "corrected").force, solution.run.force[:, 0]
    assert abs(route - exact).max() < 2e-3 * abs(exact).max()


@pytest.mark.parametrize(
    ("name", "changes", "codes"),
    [
        ("li-ma-2019-fig13-bar", ["load.duration=400 us"], {"load-long"}),
        ("togami-1996-bar", [], set()),
        (
            "togami-1996-bar",
            ["stack.joint.striker.law=palmgren", "stack.joint.striker.length=1 m"],
            {"contact-longer-than-face"},
        ),
    ],
)
def test_a_bar_names_loads_and_contacts_that_cannot_be(name, changes, codes):
    """Layers that meet by a contact of finite stiffness jump nowhere: their peak acceleration is quoted."""
    seen = {notice.code for notice in run_wave(load_case(name, changes)).notices}
    assert seen & {"load-long", "contact-not-over", "contact-longer-than-face", "discontinuous-load"} == codes
