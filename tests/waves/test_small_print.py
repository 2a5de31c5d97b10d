"""Energy held and lost, times of opening, error bounds, order of places: what the other tests of waves take for granted."""

import dataclasses
import math

import numpy as np
import pytest

from strikewave.analyses.wave.build import build_load
from strikewave.base.constants import material
from strikewave.base.errors import InputError
from strikewave.cases.case import parse_case
from strikewave.cases.stack_of_case import build_stack
from strikewave.contact import Contact
from strikewave.contact.law import Damper, PressureCap
from strikewave.waves import (
    BONDED,
    Branch,
    End,
    Joint,
    Layer,
    LoadPulse,
    Sampled,
    Stack,
    Tap,
    WantedError,
    _kernels,
    bar,
    round_bar,
    run_bar,
)
from strikewave.waves.limits import bar_extremes
from strikewave.waves.load import shortest_time
from strikewave.waves.spectral import SpectralStack
from strikewave.waves.transit import empty_averages, grid_of, state_at_rest, tables_of

STEP, Z1, Z2 = 1e-7, 8e3, 5e3
PULSE = LoadPulse("sine-squared", 2e4, 60e-6, kind="incident")


def timed(name, z, steps=200, **more):
    return Layer(name, 1.0, z * z, 1.0, steps * STEP * z, **more)


def driven(stack, load, steps):
    grid = grid_of(stack, STEP)
    tables, state = tables_of(stack, grid), state_at_rest(stack, grid)
    none = _kernels.Recording(np.zeros((0, 2), np.int64), 1, np.zeros((1, 0)), np.zeros((1, 0)))
    ext = _kernels.Extremes(np.zeros((0, 2), np.int64), 1, np.zeros(0), np.zeros(0))
    _kernels.drive(
        tables,
        state,
        load.at(STEP * np.arange(float(steps))),
        2,
        (none, none),
        empty_averages(none.nodes, none.nodes, 1, 1),
        ext,
        np.zeros(6),
    )
    return tables, state


@pytest.mark.parametrize(
    ("joint", "end", "rel"),
    [
        (Joint(4e8, 300.0, attached=0.02), End("rigid"), 1e-10),
        (BONDED, End("oscillator", 0.05, 2e8), 1e-10),
        (Joint(contact=Contact(4e12, 1.5)), End("rigid"), 2e-3),
    ],
)
def test_energy_in_is_energy_held_and_lost(joint, end, rel):
    """Before an echo is back at the first face all the energy of the wave is in the stack or in the joint's dashpot."""
    load = LoadPulse("sine-squared", 2e4, 12e-6, kind="incident")
    tables, state = driven(Stack((timed("a", Z1, 400), timed("b", Z2, 100)), (joint,), end), load, 700)
    into = float(np.sum(load.at(STEP * np.arange(700.0)) ** 2)) * STEP / Z1
    held = _kernels.energy(tables, state) + state.joint[0, _kernels.LOST]
    assert held == pytest.approx(into, rel=rel)


def test_a_yielded_contact_opens_at_its_dent():
    """A push that yields, then a pull: it opens when nothing presses any more, deeper than where it first touched."""
    time = 1e-6 * np.arange(121.0)
    load = Sampled(time, 3e4 * np.sin(2 * np.pi * time / 120e-6), "incident")
    joint = Joint(contact=Contact(4e12, 1.5, cap=PressureCap(5e3, "point")))
    stack = Stack((timed("a", Z1), timed("b", Z2)), (joint,), End("matched"))
    run = run_bar(stack, load, [Tap(1, 0.0)], 2e-4, WantedError(step=STEP))
    pressed = np.flatnonzero(run.force[:, 0] > 0.0)
    assert run.events[0, 2] == 1.0
    assert run.events[0, 1] == pytest.approx(run.time[pressed[-1] + 1], abs=2 * STEP)


def test_a_bolted_spring_opens_when_the_bolt_alone_pulls():
    load = LoadPulse("half-sine", -2e4, 80e-6, kind="incident")
    stack = Stack((timed("a", Z1), timed("b", Z1)), (Joint(1e9, unilateral=True, preload=5e3),), End("matched"))
    run = run_bar(stack, load, [Tap(1, 0.0)], 2e-4, WantedError(step=STEP))
    opened = run.time[np.flatnonzero(run.force[:, 0] <= -5e3)[0]]
    assert run.events[0] == pytest.approx([0.0, opened, 1.0], abs=1.5 * STEP)


def test_a_rigid_gap_closes_to_one_step_of_the_closed_form():
    gap, speed = 20.05e-6, 2.0
    load = LoadPulse("rectangle", Z1 * speed / 2, 1e-4, kind="incident")
    stack = Stack((timed("a", Z1), timed("b", Z2)), (Joint(unilateral=True, gap=gap),), End("matched"))
    run = run_bar(stack, load, [Tap(1, 0.0)], 1e-4, WantedError(step=STEP))
    assert run.events[0, 1] == pytest.approx(200 * STEP + gap / speed, abs=0.5 * STEP)


def test_layers_that_differ_in_poissons_ratio_travel_apart():
    a, b = (timed("x", Z1, poissons_ratio=nu, dispersion="pochhammer-chree", diameter=0.02) for nu in (0.1, 0.4))
    both = SpectralStack(Stack((a, b), (BONDED,)), LoadPulse("half-sine", 1.0, 2e-5), STEP, 500)
    alone = SpectralStack(Stack((b, b), (BONDED,)), LoadPulse("half-sine", 1.0, 2e-5), STEP, 500)
    assert np.array_equal(both.travel(1), alone.travel(1))
    assert not np.allclose(both.travel(0), both.travel(1))


def test_places_may_come_in_any_order():
    spectrum = SpectralStack(
        Stack((timed("a", Z1), timed("b", Z2)), (BONDED,)), LoadPulse("half-sine", 1.0, 2e-5), STEP, 800
    )
    places = [(1, 1.0), (0, 0.5), (1, 0.2), (0, 0.0)]
    together = spectrum.look(places)
    for k, place in enumerate(places):
        assert together.velocity[k] == pytest.approx(spectrum.look([place]).velocity[0], abs=1e-12)


def test_a_step_that_is_asked_for_keeps_its_own_bound():
    stack, load = Stack((timed("a", Z1), timed("b", Z2)), (BONDED,)), LoadPulse("sine-squared", 2e4, 20e-6)
    run = run_bar(stack, load, [Tap(1, 1.0)], 1e-4, WantedError(step=4e-7, method="spectral"))
    fine = run_bar(stack, load, [Tap(1, 1.0)], 1e-4, WantedError(step=2.5e-8, method="spectral"))
    for name in ("velocity", "acceleration"):
        miss = np.abs(getattr(run, name) - getattr(fine, name)[::16][: len(run.time)]).max()
        assert miss < getattr(run.bound, name) < 4 * miss


def test_the_step_is_halved_for_the_acceleration_too():
    stack, load = Stack((timed("a", Z1),)), LoadPulse("sine-squared", 2e4, 20e-6)
    run = run_bar(stack, load, [Tap(0, 1.0)], 1e-4, WantedError(1e-1, 1e-3, method="spectral"))
    assert run.relative_bound[1] < 1e-3


def test_the_field_of_a_spectrum_is_that_of_delay_lines():
    stack, load = Stack((timed("a", Z1), timed("b", Z2)), (BONDED,)), LoadPulse("sine-squared", 2e4, 20e-6)
    run, lines = (
        run_bar(stack, load, [Tap(1, 0.5)], 1e-4, WantedError(step=STEP, method=m)) for m in ("spectral", "delay lines")
    )
    for name, scale in (("field_force", 2e4), ("field_velocity", 4e4 / Z1)):
        ours = np.array([np.interp(lines.field_time, run.field_time, x) for x in getattr(run, name).T])
        for place in (0.25, 0.75):
            k, m = (int(np.argmin(np.abs(x.field_position - place * x.field_position[-1]))) for x in (run, lines))
            assert ours[k] == pytest.approx(getattr(lines, name)[:, m], abs=0.05 * scale)
    assert run.field_least.min() == pytest.approx(lines.field_least.min(), rel=5e-3)
    assert run.field_least.min() < -1e4


def test_what_springs_and_masses_miss_is_in_the_bound():
    for stack in (
        Stack((timed("a", Z1),), (), End("oscillator", 0.02, 5e8, 200.0)),
        Stack((timed("a", Z1), timed("b", Z2)), (Joint(2e9, 500.0),)),
    ):
        load, tap = LoadPulse("sine-squared", 2e4, 20e-6), [Tap(len(stack.layers) - 1, 1.0)]
        run, fine = (
            run_bar(stack, load, tap, 1e-4, WantedError(step=s, method="delay lines")) for s in (STEP, STEP / 8)
        )
        for name in ("velocity", "acceleration"):
            miss = np.abs(getattr(run, name) - getattr(fine, name)[::8][: len(run.time)]).max()
            assert 0.0 < miss < getattr(run.bound, name)


def test_the_chosen_step_resolves_a_stiff_hung_mass():
    m, f = 1e-4, 2e6
    stack = Stack((timed("a", Z1), timed("b", Z2)), (Joint(m * (2 * math.pi * f) ** 2, attached=m),))
    run = run_bar(stack, LoadPulse("sine-squared", 2e4, 20e-6), [Tap(1, 1.0)], 6e-5, WantedError(method="delay lines"))
    assert run.grid.step <= 20.0 / (2 * math.pi * f) / 50.0 * (1 + 1e-9)


def test_mass_of_a_stack_counts_what_hangs_on_it():
    a = timed("a", Z1)
    stack = Stack((a, a), (Joint(1e9, attached=0.3),), End("oscillator", 0.7, 1e9))
    assert stack.mass == pytest.approx(2 * a.mass + 1.0)


TEXT = """
schema = 1
name = "probe"
[[stack.layer]]
name = "upper"
material = "65Mn"
{own}
length = "50 mm"
diameter = "30 mm"
[[stack.layer]]
name = "lower"
material = "2A12"
length = "80 mm"
diameter = "30 mm"
{joint}
[load]
{load}
[solver]
duration = "300 us"
{solver}
"""
SINE = 'shape = "half-sine"\npeak = "1 kN"\nduration = "80 us"'


def test_a_layer_that_names_no_material_needs_a_poissons_ratio_to_disperse():
    own = TEXT.format(own="", joint="", load=SINE, solver='dispersion = "love-rayleigh"')
    own = own.replace('material = "65Mn"', 'density = "7820 kg/m^3"\nmodulus = "211 GPa"', 1)
    with pytest.raises(InputError, match=r"upper\.poissons_ratio"):
        build_stack(parse_case(own))


def test_a_yield_pressure_reaches_the_joint():
    joint = '[[stack.joint]]\nafter = "upper"\nkind = "contact"\nradius = "10 mm"\nyield_pressure = "2 GPa"'
    contact = build_stack(parse_case(TEXT.format(own="", joint=joint, load=SINE, solver=""))).joints[0].contact
    assert (
        contact.cap is not None and contact.cap.pressure_load > 0
        if hasattr(contact.cap, "pressure_load")
        else contact.cap is not None
    )


def test_a_measured_force_may_be_an_incident_wave(tmp_path):
    path = tmp_path / "f.csv"
    path.write_text("time [us],force [kN]\n0,0\n50,10\n100,0\n")
    case = parse_case(
        TEXT.format(own="", joint="", load=f'shape = "file"\nfile = "{path}"\napplied = "incident wave"', solver="")
    )
    assert build_load(case, build_stack(case)).kind == "incident"


def test_the_chosen_step_resolves_contacts_and_the_end():
    """Twenty relaxation times, or radians of the resonance, are 50 steps."""
    mass, frequency = 1e-4, 2e6
    end = End("oscillator", mass, mass * (2 * math.pi * frequency) ** 2)
    assert shortest_time(Stack((timed("a", Z1),), (), end), PULSE) <= 20 / (2 * math.pi * frequency) * (1 + 1e-9)
    touch = Stack((timed("a", Z1), timed("b", Z2)), (Joint(contact=Contact(4e13, 1.5)),))
    depth = (PULSE.largest / 4e13) ** (1 / 1.5)
    assert shortest_time(touch, PULSE) <= 20 * depth / PULSE.largest / (1 / Z1 + 1 / Z2) * (1 + 1e-9)


def test_steps_are_not_halved_beyond_the_work(monkeypatch):
    monkeypatch.setattr(bar, "MOST_WORK", 1.0)
    load = LoadPulse("rectangle", 1.0, 50e-6)
    run = run_bar(Stack((timed("a", Z1),)), load, [Tap(0, 1.0)], 1e-4, WantedError(method="spectral"))
    assert run.grid.step == pytest.approx(50e-6 / 50 / 2)


@pytest.mark.parametrize("end", ["free", "rigid"])
def test_a_last_film_of_no_thickness_changes_nothing(end):
    """1e-18 s: 1 + R (free) or 1 - R (rigid) rounds to 0, and the other one carries the wave on."""
    film = dataclasses.replace(timed("film", Z1), length=1e-18 * Z1)
    run = SpectralStack(Stack((timed("a", Z1), film), (BONDED,), End(end)), PULSE, STEP, 800).look([(1, 0.5)])
    bare = SpectralStack(Stack((timed("a", Z1),), (), End(end)), PULSE, STEP, 800).look([(0, 1.0)])
    name = "velocity" if end == "free" else "force"
    largest = np.abs(getattr(bare, name)).max()
    assert getattr(run, name)[0] == pytest.approx(getattr(bare, name)[0], abs=1e-6 * largest)


@pytest.mark.parametrize(
    ("joint", "end"),
    [
        (Joint(mass=0.5), End()),
        (Joint(1e9, 10.0, attached=0.5), End()),
        (BONDED, End("mass", 0.5)),
        (BONDED, End("oscillator", 0.5, 1e9, 1e3)),
    ],
)
def test_bars_that_fly_with_their_masses_feel_nothing(joint, end):
    layers = tuple(timed(name, z, speed=10.0) for name, z in (("a", Z1), ("b", Z2)))
    run = run_bar(
        Stack(layers, (joint,), end), LoadPulse("rectangle", 0.0, 1e-6), [Tap(1, 0.5)], 2e-4, WantedError(step=STEP)
    )
    assert np.abs(run.force).max() < 1e-9
    assert run.velocity[:, 0] == pytest.approx(np.full(len(run.time), 10.0), abs=1e-12)


@pytest.mark.parametrize(
    "load",
    [
        LoadPulse("triangle", 2e4, 100e-6, 99.5e-6),
        Sampled(1e-6 * np.array([0.0, 10.0, 40.0, 40.05, 40.1, 60.0]), 1e4 * np.array([0.0, 1.0, 1.0, 1.9, 1.0, 0.0])),
    ],
)
def test_the_steepest_part_of_a_load_sets_the_step(load):
    """A fall of half a microsecond, a spike of a tenth: ten steps at least cover them."""
    run = run_bar(Stack((timed("a", Z1),)), load, [Tap(0, 1.0)], 1.5e-4)
    steepest = np.abs(np.diff(load.at(np.arange(0.0, load.duration, 1e-9)))).max() / 1e-9
    assert run.grid.step < 0.1 * load.largest / steepest


@pytest.mark.verify
def test_every_layer_of_many_is_watched_for_its_largest_force():
    """A neck among 3000 layers, by delay lines; its force is that of the bar, its stress a hundred times."""
    count, necked = 3000, 1002
    layers = [timed(f"{k}", Z1, 1) for k in range(count)]
    layers[necked] = dataclasses.replace(layers[necked], area=0.01, density=100.0, modulus=layers[necked].modulus * 100)
    stack = Stack(tuple(layers), (BONDED,) * (count - 1), End("matched"))
    run = run_bar(stack, PULSE, [Tap(0, 0.5)], 2e-4, WantedError(step=STEP, method="delay lines"))
    largest, _, greatest = bar_extremes(run)
    assert largest[necked] == pytest.approx(2e4, rel=1e-3)
    assert greatest[necked] == pytest.approx(2e4, rel=1e-3)


# what a stack is made of, and what it may not be


def test_a_round_bar_has_the_area_of_its_circle_and_all_of_its_material():
    steel = material("65Mn")
    bar = round_bar("bar", steel, 0.7, 0.03, 2.0)
    assert (bar.name, bar.length, bar.diameter, bar.speed) == ("bar", 0.7, 0.03, 2.0)
    assert bar.area == pytest.approx(math.pi * 0.015**2, rel=1e-15)
    assert (bar.density, bar.modulus) == (steel.density, steel.youngs_modulus)
    assert (bar.yield_strength, bar.poissons_ratio) == (steel.yield_strength, steel.poissons_ratio)


def test_a_layer_by_hand():
    """3 kg/m^3 and 12 Pa: 2 m/s; on 5 m^2 30 kg/s; 7 m in 3.5 s, 105 kg."""
    one = Layer("one", 3.0, 12.0, 5.0, 7.0)
    assert (one.bar_speed, one.impedance, one.transit, one.mass) == (2.0, 30.0, 3.5, 105.0)
    assert math.pi * one.diameter**2 / 4.0 == pytest.approx(5.0, rel=1e-15)
    assert Layer("one", 3.0, 12.0, 5.0, 7.0, 5e-3).diameter == 5e-3


@pytest.mark.parametrize("place", range(4))
def test_a_layer_has_four_finite_sizes_above_zero(place):
    for value in (0.0, -1.0, math.inf, math.nan):
        sizes = [2.0] * 4
        sizes[place] = value
        with pytest.raises(ValueError, match="must be above zero and finite"):
            Layer("one", *sizes)
    Layer("small", 1e-3, 1e-3, 1e-3, 1e-3)


SPRINGY = Branch(1.0, 1.0)


@pytest.mark.parametrize(
    ("values", "words"),
    [
        *(
            ({key: value}, "no negative value")
            for key in ("damping", "gap", "preload", "mass", "attached")
            for value in (-1e-3, math.nan)
        ),
        *(({"stiffness": value}, "a stiffness above zero") for value in (0.0, -1.0, math.nan)),
        ({"attached": 5e-3}, "a finite stiffness"),
        ({"attached": 5e-3, "stiffness": 1.0, "branches": (SPRINGY,)}, "a finite stiffness"),
        ({"attached": 5e-3, "stiffness": 1.0, "unilateral": True}, "a finite stiffness"),
        ({"attached": 5e-3, "stiffness": 1.0, "mass": 5e-3}, "a finite stiffness"),
        ({"gap": 5e-3}, "only a unilateral"),
        ({"preload": 5e-3}, "only a unilateral"),
        ({"gap": 5e-3, "preload": 5e-3, "unilateral": True}, "carries no preload"),
        ({"damping": 5e-3}, "no damping"),
        ({"branches": (SPRINGY,)}, "no damping"),
        ({"mass": 5e-3, "stiffness": 1.0}, "bonded on both faces"),
        ({"mass": 5e-3, "unilateral": True}, "bonded on both faces"),
        ({"contact": Contact(1.0, 1.0), "stiffness": 1.0}, "nothing else"),
        ({"contact": Contact(1.0, 1.0), "mass": 5e-3}, "nothing else"),
        ({"contact": Contact(1.0, 1.0), "attached": 5e-3}, "nothing else"),
        ({"contact": Contact(1.0, 1.0), "damping": 5e-3}, "nothing else"),
        ({"contact": Contact(1.0, 1.0), "branches": (SPRINGY,)}, "nothing else"),
        ({"contact": Contact(1.0, 1.0, 5e-3)}, "restitution of 1"),
        ({"contact": Contact(1.0, 1.0, damper=Damper(5e-3))}, "no other damper"),
        ({"contact": Contact(1.0, 1.5, cap=PressureCap(3.0, "point")), "preload": 3.01}, "beyond first yield at 3 N"),
    ],
)
def test_a_joint_that_cannot_be_is_refused(values, words):
    with pytest.raises(ValueError, match=words):
        Joint(**values)


@pytest.mark.parametrize(
    ("values", "kind"),
    [
        ({}, "bonded"),
        ({"stiffness": 5e-3}, "compliant"),
        ({"stiffness": 5e-3, "damping": 5e-3}, "compliant"),
        ({"stiffness": 5e-3, "damping": 5e-3, "branches": (SPRINGY,)}, "gasket"),
        ({"unilateral": True, "gap": 5e-3}, "unilateral"),
        ({"unilateral": True, "preload": 5e-3}, "unilateral"),
        ({"unilateral": True, "stiffness": 5e-3, "damping": 5e-3, "branches": (SPRINGY,)}, "unilateral"),
        ({"mass": 5e-3}, "mass"),
        ({"attached": 5e-3, "stiffness": 5e-3, "damping": 5e-3}, "oscillator"),
        ({"contact": Contact(1.0, 1.0), "gap": 5e-3}, "contact"),
        ({"contact": Contact(1.0, 1.5, cap=PressureCap(3.0, "point")), "preload": 2.99}, "contact"),
    ],
)
def test_a_joint_is_called_what_it_does(values, kind):
    joint = Joint(**values)
    assert joint.kind == kind
    assert joint.unilateral == (kind in ("unilateral", "contact"))


@pytest.mark.parametrize("kind", ["mass", "spring", "dashpot", "oscillator"])
def test_an_end_with_a_value_has_one_above_zero(kind):
    for value in (0.0, -1.0, math.inf, math.nan):
        with pytest.raises(ValueError, match="a value above zero"):
            End(kind, value, 2.0)
    assert End(kind, 5e-3, 5e-3, 0.0).value == 5e-3
    if kind == "oscillator":
        for spring in ((0.0, 1.0), (math.inf, 1.0), (1.0, -1e-3), (1.0, math.inf), (-1.0, 0.0)):
            with pytest.raises(ValueError, match="a stiffness above zero"):
                End(kind, 2.0, *spring)


def test_an_end_is_of_a_known_kind_and_a_stack_has_a_joint_between_each_two_layers():
    with pytest.raises(ValueError, match="an end is one of free, matched, rigid"):
        End("loose")
    with pytest.raises(ValueError, match="at least one layer"):
        Stack(())
    a = timed("a", Z1)
    for joints in ((), (BONDED, BONDED)):
        with pytest.raises(ValueError, match=f"2 layers need 1 joints, got {len(joints)}"):
            Stack((a, a), joints)


def test_mass_transit_and_what_hangs_on_a_stack_by_hand():
    layers = tuple(Layer(f"{k}", 1.0, 1.0, 1.0, length) for k, length in enumerate((2.0, 3.0, 7.0)))
    joints = Joint(mass=11.0), Joint(1.0, attached=5e-3)
    assert Stack(layers, joints).hung == ((1, 5e-3),)
    assert Stack(layers, joints, End("oscillator", 17.0, 1.0)).hung == ((1, 5e-3), (2, 17.0))
    assert Stack(layers, joints).transit == 12.0
    for end, mass in (
        (End(), 23.005),
        (End("mass", 17.0), 40.005),
        (End("oscillator", 17.0, 1.0), 40.005),
        (End("spring", 17.0), 23.005),
    ):
        assert Stack(layers, joints, end).mass == pytest.approx(mass, rel=1e-15)


def test_only_known_theories_of_dispersion_are_taken_and_need_a_poissons_ratio():
    with pytest.raises(ValueError, match="is one of none, love-rayleigh, pochhammer-chree"):
        timed("a", Z1, dispersion="love")
    with pytest.raises(ValueError, match="needs a Poisson's ratio"):
        timed("a", Z1, dispersion="love-rayleigh")
    assert timed("a", Z1, dispersion="love-rayleigh", poissons_ratio=0.0).dispersion == "love-rayleigh"
