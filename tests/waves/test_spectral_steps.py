"""How finely a spectrum is taken and what is kept of it: runs that are made up, sizes by hand, and small spectra."""

import dataclasses
import math
from types import SimpleNamespace

import numpy as np
import pytest

from strikewave.waves import (
    BONDED,
    End,
    Impactor,
    Joint,
    Layer,
    LoadPulse,
    Sampled,
    Stack,
    Tap,
    WantedError,
    bar,
    run_bar,
    spectral,
)
from strikewave.waves.dispersion import Rod, wave_number
from strikewave.waves.layers import Branch, LossFit
from strikewave.waves.spectral import Histories, SpectralStack, travel_constants


def layer(name, transit, impedance=2.0, **more):
    """A layer by its transit; of unit density and area, so that Z = c."""
    return Layer(name, 1.0, impedance * impedance, 1.0, transit * impedance, **more)


TWO = Stack((layer("a", 3.0), layer("b", 5.0)), (BONDED,))
LOAD = LoadPulse("sine-squared", 7.0, 4.0)
RISE = 4.0 * (math.asin(math.sqrt(0.9)) - math.asin(math.sqrt(0.1))) / math.pi


@pytest.fixture
def made_up(monkeypatch):
    """Let runs be made up: of so many steps, all values of one size; what is asked for is noted."""
    noted = SimpleNamespace(steps=[], count=10, velocity=[], acceleration=[])

    def look(stack, load, places, duration, step):
        noted.steps.append(step)
        k = len(noted.steps) - 1
        velocity, acceleration = (x[min(k, len(x) - 1)] for x in (noted.velocity, noted.acceleration))
        full = [np.full((2, 3), value) for value in (velocity, acceleration)]
        return SimpleNamespace(steps=noted.count * 2**k, step=step), Histories(full[0], *full)

    monkeypatch.setattr(bar, "_look", look)
    monkeypatch.setattr(bar, "_bar_run", lambda spectrum, histories, places, duration, bound: (spectrum, bound))
    return noted


def followed(noted, velocity, acceleration=(5.0,), stack=TWO, taps=1, **wanted):
    """Return the step at the end over the first, and the bound."""
    noted.velocity, noted.acceleration = velocity, acceleration
    spectrum, bound = bar.spectral_bar(stack, LOAD, [(0, 0.5)] * taps, 60.0, WantedError(**wanted))
    return spectrum.step / noted.steps[0], (bound.velocity, bound.acceleration)


@pytest.mark.parametrize(
    ("velocity", "acceleration", "halves", "bound"),
    [
        ([10.0, 10.009], [5.0], 1, (0.009, 0.0)),
        ([10.0, 10.02, 10.029], [5.0], 2, (0.009, 0.0)),
        ([10.0, 10.02, 10.031, 10.04], [5.0], 3, (0.009, 0.0)),
        ([10.0], [5.0, 5.06, 5.1], 2, (0.0, 0.04)),
        ([10.0, 10.02, 10.04, 10.06, 10.08, 10.1, 10.12], [5.0], 4, (0.02, 0.0)),
        ([-10.0, -10.009], [-5.0, -5.04], 1, (0.009, 0.04)),
        ([0.0, 0.0], [0.0, 0.0], 1, (0.0, 0.0)),
        ([0.0, 0.005, 0.005], [5.0], 2, (0.0, 0.0)),
    ],
)
def test_a_step_is_halved_until_that_changes_a_thousandth_and_a_hundredth(
    made_up, velocity, acceleration, halves, bound
):
    found = followed(made_up, velocity, acceleration)
    assert found == (0.5**halves, pytest.approx(bound, rel=1e-9))


def test_a_step_that_is_asked_for_is_halved_once_for_its_bound(made_up):
    assert followed(made_up, [10.0, 10.3], [5.0, 5.1], step=0.5) == (1.0, pytest.approx((0.6, 0.2), rel=1e-9))
    assert made_up.steps == [0.5, 0.25]


@pytest.mark.parametrize(
    ("count", "layers", "taps", "halves"),
    # the next try would take four times the count of the first
    [
        (76_000, 100, 1, 1),  # 30.4e6 layer steps
        (74_000, 100, 1, 2),
        (251_000, 2, 1, 1),  # 1.004e6 steps
        (249_000, 2, 1, 2),
        (202_000, 2, 5, 1),  # 4.04e6 samples
        (198_000, 2, 5, 2),
    ],
)
def test_a_step_is_halved_as_far_as_work_steps_and_samples_go(made_up, count, layers, taps, halves):
    made_up.count = count
    stack = Stack((layer("a", 1.0),) * layers, (BONDED,) * (layers - 1))
    ever = [10.0 + 0.1 * k for k in range(9)]
    assert followed(made_up, ever, stack=stack, taps=taps)[0] == 0.5**halves


@pytest.mark.parametrize(
    ("load", "duration", "period", "step"),
    [
        (LOAD, 60.0, math.inf, RISE / 50.0),
        (LOAD, 0.3, math.inf, 0.3 / 50.0),
        (LOAD, 60.0, 0.25, 0.25 / 50.0),
        (LOAD, 60.0, 1e-6, 60.0 * 3 / 4e6 * 50.0 / 50.0),
        (LoadPulse("rectangle", 7.0, 8.0), 60.0, math.inf, 8.0 / 50.0),
    ],
)
def test_the_first_step_is_a_fiftieth_of_what_changes_first(made_up, monkeypatch, load, duration, period, step):
    monkeypatch.setattr(bar, "refuse_samples", lambda *_: None)
    monkeypatch.setattr(bar, "_refuse_steps", lambda *_: None)
    made_up.velocity = made_up.acceleration = [1.0]
    bar.spectral_bar(TWO, load, [(0, 0.5)] * 3, duration, WantedError(period=period))
    assert made_up.steps[0] == pytest.approx(step, rel=1e-12)


@pytest.mark.parametrize(("step", "taps", "words"), [
    (1.25e-4, 1, None), (1.19e-4, 1, r"a step of 0\.000119 s, and once more at half.*than 1e\+06 steps"),
    (1.25e-4, 4, None), (1.25e-4, 5, "samples at 5 taps"), (1.194e-4, 4, "samples at 4 taps"),
])  # fmt: skip
def test_a_million_steps_and_four_million_samples_are_followed_at_most(made_up, step, taps, words):
    """60 s at half the step: 0.96 or 1.008 million."""
    made_up.velocity = made_up.acceleration = [1.0]
    asked = TWO, LOAD, [(0, 0.5)] * taps, 60.0, WantedError(step=step)
    if words is None:
        bar.spectral_bar(*asked)
        return
    with pytest.raises(ValueError, match=words):
        bar.spectral_bar(*asked)


def test_a_change_is_taken_where_both_have_a_sample_and_in_both_directions():
    def histories(velocity, acceleration):
        return Histories(np.empty(0), np.array(velocity, dtype=float), np.array(acceleration, dtype=float))

    coarse = histories([[1.0, 2.0, 3.0], [0.0, 0.0, 0.0]], [[0.0, 9.0, 0.0], [1.0, 1.0, 1.0]])
    for more in ([], [77.0]):
        fine = histories(
            [[1.5, 50.0, 2.0, 50.0, -1.0, *more], [0.0, 50.0, 3.0, 50.0, 0.0, *more]],
            [[0.0, 50.0, 3.0, 50.0, 0.0, *more], [1.0, 50.0, 2.0, 50.0, 1.0, *more]],
        )
        found = bar._change(coarse, fine)
        assert (found.velocity, found.acceleration) == (4.0, 6.0)
    shorter = histories([[1.5, 50.0, 2.25], [0.0, 50.0, 0.0]], [[0.0, 50.0, 9.0], [1.0, 50.0, 1.0]])
    assert bar._change(coarse, shorter).velocity == 0.5
    longer = histories(*(np.pad(x, ((0, 0), (0, 4))) for x in (fine.velocity, fine.acceleration)))
    assert bar._change(coarse, longer).velocity == 4.0


@pytest.mark.parametrize(
    ("duration", "layers", "taps", "pays"),
    [
        (9_900.0, 59, 1, True),
        (9_900.0, 61, 1, False),  # 60 million layer steps
        (9_990.0, 1, 1, True),
        (10_010.0, 1, 1, False),  # a million steps
        (9_900.0, 1, 4, True),
        (9_900.0, 1, 5, False),  # four million samples
    ],
)
def test_a_spectrum_pays_as_far_as_work_steps_and_samples_go(duration, layers, taps, pays):
    """At half the first step, a hundredth of what changes first: here 1 s."""
    stack = Stack((layer("a", 1.0),) * layers, (BONDED,) * (layers - 1))
    load = dataclasses.replace(LOAD, duration=LOAD.duration / RISE)
    assert bar.spectrum_pays(stack, load, duration, taps) is pays
    assert not bar.spectrum_pays(stack, LoadPulse("rectangle", 7.0, 4.0), 1.0, 1)
    assert not bar.spectrum_pays(stack, Impactor(1.0, 1.0), 1.0, 1)


def test_only_layers_with_loss_or_dispersion_need_a_spectrum():
    lossy = layer("lossy", 1.0, loss=LossFit(1.0, (), 0.0, (1.0, 2.0)))
    slow = layer("slow", 1.0, dispersion="love-rayleigh", poissons_ratio=0.3)
    assert not bar.needs_spectrum(TWO)
    for one, word in ((lossy, "loses energy"), (slow, "disperses")):
        stack = Stack((TWO.layers[0], one), (BONDED,))
        assert bar.needs_spectrum(stack)
        with pytest.raises(ValueError, match=f"layer {one.name} {word}"):
            bar.refuse_spectral_layers(stack)
    bar.refuse_spectral_layers(TWO)


@pytest.mark.parametrize(
    ("duration", "step", "steps"),
    [
        (1.0, 0.1, 11),
        (1.01, 0.1, 12),
        (1.1, 0.1, 12),
        (0.3, 0.1, 4),
        (0.05, 0.1, 2),
        (1.0 + 0.5e-12, 0.1, 11),
        (1.0 + 1.5e-12, 0.1, 12),
    ],
)
def test_samples_reach_the_end_of_a_run(duration, step, steps):
    assert bar._look(TWO, LOAD, [(0, 0.0)], duration, step)[0].steps == steps


@pytest.mark.parametrize("batch", [1, 2, 4, 6])
def test_extremes_of_faces_are_looked_at_some_at_once_and_begin_at_zero(batch, monkeypatch):
    """Of each face k the forces k + 1, -k/2 and 0.25 but for face 3, which is pulled alone, and face 0, pushed alone."""
    forces = np.array([[k + 1.0, -0.5 * k, 0.25] for k in range(6)])
    forces[3], forces[0] = -abs(forces[3]), abs(forces[0]) + 0.5
    looked = []

    def look(places, accelerated):
        looked.append(len(places))
        assert not accelerated
        return SimpleNamespace(force=forces[[2 * at + round(end) for at, end in places]])

    spectrum = SimpleNamespace(stack=SimpleNamespace(layers=(None,) * 3), steps=100, look=look)
    least, greatest = bar._face_extremes(spectrum, batch)
    assert least.tolist() == [[0.0, -0.5], [-1.0, -4.0], [-2.0, -2.5]]
    assert greatest.tolist() == [[1.5, 2.0], [3.0, 0.0], [5.0, 6.0]]
    assert looked == [min(batch, 6 - begin) for begin in range(0, 6, batch)]
    monkeypatch.setattr(bar, "MOST_WORK", 900.0 / batch)  # 3 x 3 layers of 100 steps
    assert all(np.isnan(x).all() for x in bar._face_extremes(spectrum, batch))
    monkeypatch.setattr(bar, "MOST_WORK", 901.0 / batch)
    assert not any(np.isnan(x).any() for x in bar._face_extremes(spectrum, batch))


HUNG = Stack(
    (layer("a", 0.2), layer("b", 0.3, 5.0)), (Joint(30.0, 0.2, attached=0.5),), End("oscillator", 0.7, 20.0, 0.3)
)


@pytest.mark.parametrize(("steps", "coarse"), [(998, 1), (999, 2), (1499, 3)])
def test_a_run_keeps_each_step_at_taps_and_some_in_its_field(steps, coarse, monkeypatch):
    """What is kept are histories at their places; masses on springs are pushed by what is lost from face to face."""
    load = dataclasses.replace(LOAD, duration=1.0, peak=-7e-3)
    run = run_bar(
        HUNG, load, [Tap(0, 1.0), Tap(1, 0.0), Tap(1, 1.0)], 0.01 * steps, WantedError(step=0.01, method="spectral")
    )
    spectrum = SpectralStack(HUNG, load, 0.01, steps + 1)
    assert run.time == pytest.approx(0.01 * np.arange(steps + 1), rel=1e-12)
    assert run.field_time == pytest.approx(0.01 * coarse * np.arange(steps // coarse + 1), rel=1e-12)
    assert len(run.field_position) == 200
    places = [(0, run.field_position[7] / 0.4), (1, (run.field_position[-11] - 0.4) / 1.5)]
    seen = spectrum.look(places)
    for k, force, velocity in zip((7, -11), seen.force, seen.velocity, strict=True):
        assert run.field_force[:, k] == pytest.approx(force[::coarse], abs=1e-9)
        assert run.field_velocity[:, k] == pytest.approx(velocity[::coarse], abs=1e-9)
        assert (run.field_least[k], run.field_greatest[k]) == pytest.approx((force.min(), force.max()), abs=1e-9)
    assert run.field_layer[[0, -1]].tolist() == [0, 1]
    before, behind, end = run.force.T
    assert run.hung_acceleration == pytest.approx(np.column_stack([(before - behind) / 0.5, end / 0.7]), abs=1e-9)
    assert run.mean_push == pytest.approx(load.at(run.time) - end, abs=2e-5)
    assert run.end_force == pytest.approx(end, abs=1e-9)
    assert run.face_least[0, 1] == pytest.approx(before.min(), abs=1e-9)
    assert run.face_greatest[1, 0] == pytest.approx(behind.max(), abs=1e-9)
    assert run.field_greatest.min() >= 0.0 >= run.field_least.max()
    assert run.momentum_error < 1e-9
    assert (run.energy_lost, run.events.shape, run.touches.shape) == (0.0, (0, 3), (0, 3))
    assert (run.grid.counts, run.grid.mismatch, run.grid.lengths(HUNG)) == ((0, 0), 0.0, (0.4, 1.5))
    if steps == 998:  # a few places at a time do the same
        for module in (spectral, bar):
            monkeypatch.setattr(module, "MOST_VALUES", 120.5 * (steps + 1))
        few = run_bar(HUNG, load, [Tap(0, 1.0)], 0.01 * steps, WantedError(step=0.01, method="spectral"))
        for name in ("field_force", "field_velocity", "field_least", "field_greatest", "face_least", "face_greatest"):
            assert getattr(few, name) == pytest.approx(getattr(run, name), abs=1e-9)


def test_a_place_of_a_field_is_found_in_a_thousandth_of_its_layer():
    run = run_bar(HUNG, LOAD, [Tap(0, 1.0)], 0.4, WantedError(step=0.1, method="spectral"))
    cells = np.concatenate(
        [run.field_position[run.field_layer == 0] / 0.4, (run.field_position[run.field_layer == 1] - 0.4) / 1.5]
    )
    assert 1e3 * cells == pytest.approx(np.rint(1e3 * cells), abs=1e-6)
    assert np.bincount(run.field_layer).tolist() == [80, 120]  # 0.2 s and 0.3 s


def test_a_field_has_200_places_in_a_hundred_layers_at_most_or_as_many_as_its_steps_allow(monkeypatch):
    """Twenty million values: of 41 steps 200 places; two places a layer at least."""
    asked, look = [], SpectralStack.look

    def nodes(stack, grid, layers, places):
        asked.append((layers, places, grid.counts))
        return spectral_bar_nodes(stack, grid, layers, places)

    looks = []
    monkeypatch.setattr(
        SpectralStack, "look", lambda self, *more, **how: looks.append(self) or look(self, *more, **how)
    )
    spectral_bar_nodes = bar.field_nodes
    monkeypatch.setattr(bar, "field_nodes", nodes)
    for values in (2e7, 30.5 * 5, 2.0 * 5):
        monkeypatch.setattr(bar, "_FIELD_VALUES", values)
        run_bar(TWO, LOAD, [Tap(0, 1.0)], 0.4, WantedError(step=0.1, method="spectral"))
    assert len(looks) == 3 * 5  # at taps with two steps; at the field, at faces and at masses, at once
    assert asked == [(100, 200, (1000, 1000)), (15, 30, (1000, 1000)), (1, 2, (1000, 1000))]
    monkeypatch.undo()
    assert int(bar._FIELD_VALUES / 99_000) == 202


# the transform itself

SPECTRUM = SpectralStack(TWO, LOAD, 0.25, 61)


def test_a_period_is_twice_what_is_kept_and_what_wraps_around_has_died_to_1e_8():
    assert SPECTRUM.count >= 2 * (61 + 2)
    assert SPECTRUM.count < 1.1 * 2 * 63
    assert math.exp(-SPECTRUM.sigma * SPECTRUM.count * 0.25) == pytest.approx(1e-8, rel=1e-12)
    s = SPECTRUM.s
    assert s.real == pytest.approx(SPECTRUM.sigma, rel=1e-15)
    assert s.imag == pytest.approx(2.0 * math.pi * np.arange(s.size) / (SPECTRUM.count * 0.25), rel=1e-12)
    assert s.size == SPECTRUM.count // 2 + 1


def test_a_load_is_rounded_over_a_step_to_either_side():
    """Weights of 1/4, 1/2, 1/4."""
    time = 0.25 * np.arange(-1, 63)
    jump = Sampled(np.array([0.0, 5.0, 5.1, 60.0]), np.array([0.0, 3.0, -1.0, 2.0]))
    spectrum = dataclasses.replace(SPECTRUM, load=jump)
    found = spectrum.history(spectrum._loaded)
    assert found.shape == (61,)
    assert found == pytest.approx(np.convolve(jump.at(time), [0.25, 0.5, 0.25], "valid")[:61], abs=1e-7)


@pytest.mark.parametrize(("name", "size"), [("MOST_LAYER_FREQUENCIES", 2), ("MOST_CONSTANTS", 1)])
def test_a_spectrum_that_would_take_too_much_is_refused(monkeypatch, name, size):
    """Two layers of one kind."""
    bins = SPECTRUM.s.size
    monkeypatch.setattr(spectral, name, bins * size)
    SpectralStack(TWO, LOAD, 0.25, 61)
    monkeypatch.setattr(spectral, name, bins * size - 1)
    with pytest.raises(ValueError, match=rf"2 layers \(1 of them different\) at {bins} frequencies.*than 15\.2 s"):
        SpectralStack(TWO, LOAD, 0.25, 61)


@pytest.mark.parametrize(
    ("layers", "steps", "taken"),
    [(30, 32_000_000, True), (30, 35_000_000, False), (1, 49_000_000, True), (1, 52_000_000, False)],
)
def test_a_thousand_million_layer_frequencies_and_fifty_million_constants_are_followed(layers, steps, taken):
    stack = Stack((layer("a", 1.0),) * layers, (BONDED,) * (layers - 1))
    if taken:
        assert SpectralStack(stack, LOAD, 0.25, steps).steps == steps
        return
    with pytest.raises(ValueError, match="are too many"):
        SpectralStack(stack, LOAD, 0.25, steps)


def test_layers_are_of_one_kind_where_their_waves_run_alike():
    """Speed, loss, theory and Poisson's ratio; a diameter where it disperses alone."""
    first = layer("a", 3.0, diameter=0.1)
    loss = LossFit(0.5, (Branch(0.5, 1.0),), 0.0, (1.0, 2.0))
    disperses = {"dispersion": "love-rayleigh", "poissons_ratio": 0.3}
    kinds = [
        first,
        layer("b", 5.0, diameter=0.2),
        layer("c", 5.0, 3.0),
        layer("d", 5.0, loss=loss),
        layer("e", 5.0, diameter=0.1, **disperses),
        layer("f", 5.0, diameter=0.2, **disperses),
        layer("g", 5.0, diameter=0.1, dispersion="pochhammer-chree", poissons_ratio=0.3),
        first,
    ]
    joints = (
        Joint(5.0, 7.0, (Branch(2.0, 3.0), Branch(4.0, 6.0))),
        Joint(mass=8.0),
        *(BONDED,) * 4,
        Joint(9.0, 1.5, attached=2.5),
    )
    tables, found = spectral._tables_of(Stack(tuple(kinds), joints, End("oscillator", 3.0, 4.0, 5.0)))
    assert tables.group.tolist() == [0, 0, 1, 2, 3, 4, 5, 0]
    assert [one.name for one in found] == ["a", "c", "d", "e", "f", "g"]
    assert tables.joint[[0, 1, 2, 6]].tolist() == [
        [5.0, 7.0, 0.0, 0.0],
        [math.inf, 0.0, 8.0, 0.0],
        [math.inf, 0.0, 0.0, 0.0],
        [9.0, 1.5, 0.0, 2.5],
    ]
    assert tables.branch[0].tolist() == [[2.0, 3.0], [4.0, 6.0]]
    assert not tables.branch[1:].any()
    assert tables.line_mass.tolist() == [1.0] * 8
    assert tables.length.tolist() == [one.length for one in kinds]
    assert tables.end[1:].tolist() == [3.0, 4.0, 5.0]
    alone = spectral._tables_of(Stack((first,)))[0]
    assert (alone.branch.shape, alone.joint.shape) == ((1, 0, 2), (1, 4))


def test_waves_of_a_layer_run_by_its_modulus_at_that_frequency_and_by_its_theory():
    """G = s sqrt(rho/E(s)), E of a spring and one branch by hand; dispersion takes w = -i s of half its diameter."""
    s = np.array([0.3 + 1.7j, 0.3 + 9.0j])
    loss = LossFit(0.4, (Branch(1.1, 0.7),), 0.0, (1.0, 2.0))
    modulus = 9.0 * (0.4 + 1.1 * s * 0.7 / (1.0 + s * 0.7))
    assert travel_constants(layer("a", 1.0, 3.0), s) == pytest.approx(s / 3.0, rel=1e-14)
    assert travel_constants(layer("a", 1.0, 3.0, loss=loss), s) == pytest.approx(s * np.sqrt(1.0 / modulus), rel=1e-13)
    slow = layer("a", 1.0, 3.0, loss=loss, dispersion="love-rayleigh", poissons_ratio=0.3, diameter=0.4)
    k = wave_number(-1j * s, Rod(0.2, 3.0, 0.3), "love-rayleigh", np.sqrt(modulus))
    assert travel_constants(slow, s) == pytest.approx(1j * k, rel=1e-13)


@pytest.mark.parametrize("steps", [25, 43, 55])
def test_impulses_and_momentum_are_those_at_the_last_sample(steps):
    """F0 (t/2 - T/(4 pi) sin(2 pi t/T)) of sin^2(pi t/T) in 8 s; a matched bar passes it on 8 s later."""
    stack = Stack(TWO.layers, TWO.joints, End("matched"))
    pulse = LoadPulse("sine-squared", 7.0, 8.0)
    face, end, found = SpectralStack(stack, pulse, 0.25, steps).ends()
    time = 0.25 * np.arange(steps)

    def impulse(t):
        t = min(max(t, 0.0), 8.0)
        return 7.0 * (t / 2.0 - 2.0 / math.pi * math.sin(math.pi * t / 4.0))

    entered, through = impulse(time[-1]), impulse(time[-1] - 8.0)
    # a load of 32 steps, rounded over one: (pi/32)^2/2 of it
    assert found == pytest.approx((entered, through, entered - through), abs=5e-3 * 28.0)
    assert face == pytest.approx(pulse.at(time), abs=5e-3 * 7.0)
    assert end == pytest.approx(pulse.at(time - 8.0), abs=5e-3 * 7.0)


def test_what_is_not_accelerated_has_no_acceleration_and_the_same_rest():
    places = [(1, 0.5), (0, 0.25)]
    whole, bare = SPECTRUM.look(places), SPECTRUM.look(places, accelerated=False)
    assert bare.acceleration.shape == (2, 0)
    assert np.array_equal(whole.force, bare.force)
    assert np.array_equal(whole.velocity, bare.velocity)
    assert whole.acceleration[1] == pytest.approx(np.gradient(whole.velocity[1], 0.25), abs=0.15)


@pytest.mark.parametrize(
    ("end", "impedance"),
    [
        (End("mass", 0.7), lambda s: 0.7 * s),
        (End("spring", 30.0), lambda s: 30.0 / s),
        (End("dashpot", 1.3), lambda s: 1.3 + 0.0 * s),
        (End("matched"), lambda s: 5.0 + 0.0 * s),
        (End("oscillator", 0.7, 30.0, 0.4), lambda s: 1.0 / (1.0 / (0.7 * s) + 1.0 / (30.0 / s + 0.4))),
    ],
)
def test_what_closes_a_stack_is_pushed_by_its_impedance_times_its_speed(end, impedance):
    """And a place on the last face has that force and that speed; on the first face the load, rounded over a step."""
    stack = Stack((layer("a", 0.2), layer("b", 0.3, 5.0)), (Joint(30.0, 0.2),), end)
    spectrum = SpectralStack(stack, LOAD, 0.05, 100)
    force, velocity, ends, _ = spectrum._respond([(0, 0.0), (1, 1.0)])
    assert ends[1] == pytest.approx(impedance(spectrum.s) * ends[2], rel=1e-9)
    assert force[1] == pytest.approx(ends[1], rel=1e-9)
    assert velocity[1] == pytest.approx(ends[2], rel=1e-9)
    assert force[0] == pytest.approx(ends[0], rel=1e-12)
    assert ends[0] == pytest.approx(spectrum._loaded, rel=1e-12)


@pytest.mark.parametrize(
    ("joint", "law"),
    [
        (
            Joint(30.0, 0.2, (Branch(7.0, 0.3), Branch(2.0, 0.05))),
            lambda s: (s / (30.0 + 0.2 * s + 7.0 * s * 0.3 / (1.0 + 0.3 * s) + 2.0 * s * 0.05 / (1.0 + 0.05 * s)), 0.0),
        ),
        (Joint(mass=0.7), lambda s: (0.0, 0.7 * s)),
        (Joint(30.0, 0.4, attached=0.7), lambda s: (0.0, 1.0 / (1.0 / (0.7 * s) + 1.0 / (30.0 / s + 0.4)))),
        (Joint(6e-3, 0.0, (Branch(7e-3, 0.3),)), lambda s: (s / (6e-3 + 7e-3 * s * 0.3 / (1.0 + 0.3 * s)), 0.0)),
        (Joint(30.0, 0.4, attached=5e-3), lambda s: (0.0, 1.0 / (1.0 / (5e-3 * s) + 1.0 / (30.0 / s + 0.4)))),
        (BONDED, lambda s: (0.0, 0.0)),
    ],
)
def test_a_joint_gives_way_by_its_force_and_is_pushed_by_what_is_lost_over_it(joint, law):
    """Speeds differ by f times its mobility, forces by its impedance times the speed."""
    stack = Stack((layer("a", 0.2), layer("b", 0.3, 5.0)), (joint,), End("rigid"))
    spectrum = SpectralStack(stack, LOAD, 0.05, 100)
    force, velocity, _, _ = spectrum._respond([(0, 1.0), (1, 0.0)])
    mobility, impedance = law(spectrum.s)
    size = np.abs(velocity[0])
    assert np.abs(velocity[0] - velocity[1] - mobility * force[0]).max() < 1e-9 * size.max()
    assert np.abs(force[0] - force[1] - impedance * velocity[1]).max() < 1e-9 * np.abs(force[0]).max()
