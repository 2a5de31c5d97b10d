"""A stack and its load from a case file: loss, dispersion, oscillators, contacts, own materials, a measured load."""

import math
import re

import numpy as np
import pytest

from strikewave.analyses.by_tables import check_case
from strikewave.analyses.wave.build import build_load
from strikewave.analyses.wave.run import bar_figures, run_wave
from strikewave.base.constants import material
from strikewave.base.errors import InputError, InputErrors, StrikewaveError
from strikewave.cases.case import load_case, parse_case
from strikewave.cases.stack_of_case import build_stack, read_load

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
        )
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


G = 9.80665


def test_force_over_uneven_times_without_a_head_is_in_newton_and_seconds(tmp_path):
    time, force = np.array([0.0, 1e-6, 3e-6, 10e-6]), np.array([0.0, 5.0, 7.0, 0.0])
    (tmp_path / "force.txt").write_text(
        "\n".join(f"{t!r} {f!r}" for t, f in zip(time.tolist(), force.tolist(), strict=True))
    )
    load = read_load(str(tmp_path / "force.txt"))
    assert load.kind == "force"
    assert np.array_equal(load.time, time)
    assert np.array_equal(load.values, force)


def test_acceleration_of_the_face_in_g_becomes_its_speed(tmp_path):
    import pyarrow as pa
    import pyarrow.parquet as pq

    time = np.linspace(0.0, 100.0, 101)
    pq.write_table(pa.table({"time [us]": time, "face [g]": np.full(101, 1000.0)}), tmp_path / "face.parquet")
    load = read_load(str(tmp_path / "face.parquet"))
    assert load.kind == "speed"
    assert load.values[-1] == pytest.approx(1000.0 * G * 100e-6, rel=1e-12)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("time [us], temperature [K]\n0,1\n1,2\n2,3\n", "a force, a speed or an acceleration"),
        ("", "empty"),
        ("time [us], force [kN]\n0,1\n2,2\n1,3\n", "times that rise"),
    ],
)
def test_what_is_no_load_is_refused_in_words(tmp_path, text, said):
    (tmp_path / "load.csv").write_text(text)
    with pytest.raises(InputError, match=said) as refused:
        read_load(str(tmp_path / "load.csv"))
    assert refused.value.field == "load.file"


BAR = """
schema = 1
[[stack.layer]]
name = "bar"
material = "65Mn"
length = "100 mm"
diameter = "20 mm"
[load]
shape = "file"
file = "force.csv"
[solver]
duration = "100 us"
"""


def write_case(folder, text):
    (folder / "bar.toml").write_text(BAR)
    (folder / "force.csv").write_text(text)
    return folder / "bar.toml"


def test_a_load_file_lies_beside_its_case_and_the_case_runs_again_elsewhere(tmp_path, monkeypatch):
    from strikewave import load_case, run_wave
    from strikewave.cases.case import dump_case

    place = write_case(tmp_path, "time [us], force [kN]\n0,0\n10,5\n20,0\n")
    (tmp_path / "other").mkdir()
    monkeypatch.chdir(tmp_path / "other")
    case = load_case(str(place))
    (tmp_path / "other" / "again.toml").write_text(dump_case(case))
    runs = [run_wave(each).run for each in (case, load_case("again.toml"))]
    assert np.array_equal(runs[0].force, runs[1].force)
    assert runs[0].face_force.max() == pytest.approx(5e3, rel=1e-3)


@pytest.mark.parametrize(
    ("text", "codes"),
    [
        ("time, force\n0,0\n10,5\n20,0\n", {"load-unit", "load-long"}),
        ("time [us], force [kN]\n0,0.3\n10,5\n20,0\n", {"load-offset"}),
        ("time [us], force [kN]\n0,0\n10,5\n20,0\n", set()),
    ],
)
def test_what_may_be_wrong_with_a_measured_load_is_said(tmp_path, text, codes):
    from strikewave import load_case, run_wave

    found = {notice.code for notice in run_wave(load_case(str(write_case(tmp_path, text)))).warnings}
    assert found & {"load-unit", "load-long", "load-offset"} == codes


NAMED = 'material = "2A12"'
ALLOY = material("2A12")
OWN = f"""density = "{ALLOY.density} kg/m^3"
modulus = "{ALLOY.youngs_modulus} Pa"
poissons_ratio = {ALLOY.poissons_ratio}"""
LAYERS = """
schema = 1
[[stack.layer]]
name = "first"
material = "2A12"
length = "40 mm"
diameter = "20 mm"
[[stack.layer]]
name = "second"
material = "65Mn"
length = "60 mm"
area = "3 cm^2"
"""
CONTACT = """
[[stack.joint]]
after = "first"
kind = "contact"
radius = "50 mm"
"""
FORCE = """
[load]
shape = "half-sine"
peak = "2 kN"
duration = "40 us"
[solver]
duration = "150 us"
"""
STRUCK = """
[load]
shape = "contact"
speed = "2 m/s"
[striker]
mass = "0.1 kg"
material = "65Mn"
nose_radius = "10 mm"
contact_length = "10 mm"
mount_stiffness = "1 N/m"
mount_damping = "0 N s/m"
[contact]
law = "hertz"
restitution = 1.0
slowest_approach = "1 mm/s"
[solver]
duration = "150 us"
"""
CASES = {"bonded": LAYERS + FORCE, "contact": LAYERS + CONTACT + FORCE, "struck": LAYERS + STRUCK}


def own(text, numbers=OWN):
    return text.replace(NAMED, numbers)


@pytest.mark.parametrize("name", CASES)
def test_numbers_of_ones_own_are_those_of_the_material_that_has_them(name):
    assert bar_figures(parse_case(own(CASES[name]), "own")) == bar_figures(parse_case(CASES[name], "named"))


@pytest.mark.parametrize("name", ["contact", "struck"])
def test_a_contact_has_the_modulus_of_the_layer_and_not_of_the_material_that_it_also_names(name):
    """Of half the modulus, written beside the name or for all of the layer's own."""
    half = f"{ALLOY.youngs_modulus / 2} Pa"
    beside = parse_case(CASES[name], "beside", [f"stack.layer.first.modulus={half}"])
    alone = parse_case(own(CASES[name]), "alone", [f"stack.layer.first.modulus={half}"])
    assert bar_figures(beside) == bar_figures(alone)
    contacts = [
        build_stack(case).joints[0].contact if name == "contact" else build_load(case, build_stack(case)).contact
        for case in (beside, parse_case(CASES[name], "named"))
    ]
    assert contacts[0].stiffness < contacts[1].stiffness


@pytest.mark.parametrize(
    ("name", "numbers", "line"),
    [
        (
            "contact",
            'density = "2780 kg/m^3"\nmodulus = "72 GPa"',
            "stack.layer.first.poissons_ratio: missing; needed: a number of its own, for the contact, where it names no "
            'material; add poissons_ratio = 0.3, or material = "65Mn"',
        ),
        ("struck", 'density = "2780 kg/m^3"\nmodulus = "72 GPa"', "stack.layer.first.poissons_ratio: missing"),
        ("bonded", 'density = "2780 kg/m^3"', "stack.layer.first.material: missing"),
        ("bonded", 'density = "2780"\nmodulus = "72 GPa"', "density with its unit"),
        ("bonded", 'density = "0.001 kg/m^3"\nmodulus = "72 GPa"', "at least 0.1 kg/m^3"),
        ("bonded", 'density = "2780 kg/m^3"\nmodulus = "72 Pa"', "at least 1000 Pa"),
        ("bonded", 'density = "nan kg/m^3"\nmodulus = "72 GPa"', "density with its unit"),
        ("contact", f"{OWN}\nyield_strength = 3", "yield_strength: unknown key"),
        ("contact", OWN.replace("poissons_ratio = 0.33", "poissons_ratio = 0.6"), "at most 0.5"),
    ],
)
def test_what_a_layer_of_its_own_lacks_is_named_with_what_to_add(name, numbers, line):
    with pytest.raises((StrikewaveError, InputErrors), match=re.escape(line)) as error:
        run_wave(parse_case(own(CASES[name], numbers), "own"))
    assert "\n" not in str(error.value)


def test_an_area_no_wider_than_an_atom_is_refused():
    with pytest.raises(InputErrors, match=r"stack\.layer\.second\.area: .*at least 1e-12 m\^2"):
        parse_case(LAYERS.replace("3 cm^2", "1e-30 m^2") + FORCE, "thin")


def test_a_pressure_of_its_own_is_asked_for_where_no_table_has_a_hardness():
    text = own(CASES["contact"]).replace('radius = "50 mm"', 'radius = "50 mm"\nyield_pressure = "auto"')
    with pytest.raises(StrikewaveError, match="first has neither hardness nor yield strength"):
        build_stack(parse_case(text, "own"))
    given = parse_case(text.replace('"auto"', '"1 GPa"'), "own")
    assert build_stack(given).joints[0].contact.cap is not None


def test_poissons_ratio_of_a_named_material_stays_where_its_modulus_is_replaced():
    changes = ["stack.layer.upper.modulus=200 GPa", "solver.dispersion=love-rayleigh"]
    layers = build_stack(load_case("li-ma-2019-fig13-bar", changes)).layers
    assert layers[0].poissons_ratio == material("65Mn").poissons_ratio


def test_none_takes_a_quantity_out_and_what_is_needed_is_then_missing():
    """A diameter gives way to an area; without either, and without a length, that is said."""
    changes = ["stack.layer.first.diameter=none", "stack.layer.first.area=3 cm^2"]
    assert build_stack(parse_case(CASES["bonded"], "area", changes)).layers[0].area == pytest.approx(3e-4)
    with pytest.raises(StrikewaveError, match=re.escape('or --set "stack.layer.first.diameter=none"')):
        build_stack(parse_case(CASES["bonded"], "both", changes[1:]))
    with pytest.raises(StrikewaveError, match="a diameter or an area"):
        build_stack(parse_case(CASES["bonded"], "neither", changes[:1]))
    with pytest.raises(InputErrors, match=r"stack\.layer\.first\.length: missing"):
        parse_case(CASES["bonded"], "short", ["stack.layer.first.length=none"])
    kept = parse_case(CASES["bonded"], "kept", ["solver.error=none"])
    assert kept == parse_case(CASES["bonded"], "kept")
