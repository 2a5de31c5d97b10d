"""Identification from force pulses: integrated independently, with noise, with ringing, and those it must refuse."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.stats import chi2

from strikewave.contact import Contact, exact, impact_history, solve_impact
from strikewave.contact.force_pulse import ForcePulse, cut_out
from strikewave.contact.identification import COMBINATIONS, identify
from strikewave.contact.pulse_fit import SCALES, VALUES

STEP = 0.5e-6
PULSE = ForcePulse(1e-4, 2e4, 60e-6, 1.5, 0.6)
TIME = np.arange(800) * STEP


def integrated(K, n, e, m, v, samples=200):
    """Time and force of a blow by scipy's integrator, with a stretch before and after; first touch at 1 ms."""
    chi = float(exact(e))
    depth = ((n + 1) * m * v * v / (2 * K)) ** (1 / (n + 1))

    def force(y):
        return K * np.maximum(y[0], 0.0) ** n * (1 + chi * y[1] / v)

    def out(t, y):
        return y[0] + 1e-9 * depth

    out.terminal, out.direction = True, -1
    made = solve_ivp(
        lambda t, y: [y[1], -force(y) / m], (0.0, 50 * depth / v), [0.0, v], method="DOP853", events=out,
        rtol=1e-11, atol=[1e-13 * depth, 1e-12 * v], dense_output=True, max_step=depth / v / 50,
    )  # fmt: skip
    end = made.t[-1]
    t = np.linspace(-0.6 * end, 1.6 * end, int(2.2 * samples))
    inside = (t > 0.0) & (t < end)
    return t + 1e-3, np.where(inside, force(made.sol(np.clip(t, 0.0, end))), 0.0)


@pytest.mark.verify
@pytest.mark.parametrize(
    "known", [("mass",), ("speed",), ("stiffness",), ("mass", "speed"), ("mass", "stiffness"), SCALES]
)
@pytest.mark.parametrize(
    ("n", "e"), [(1.0, 0.7), (10 / 9, 0.5), (1.5, 0.9), (1.5, 0.3), (2.0, 0.6), (0.8, 0.6), (3.0, 0.8)]
)
def test_integrated_pulses_come_back(n, e, known):
    truth = dict(zip(VALUES, (4.7e9 * 1e4 ** (n - 1.1), n, e, 0.139, 20.0), strict=True))
    found = identify(*integrated(*truth.values()), {name: truth[name] for name in known})
    for name, value in truth.items():
        # the accuracy asked for; measured 3e-6
        assert found.values[name].value == pytest.approx(value, rel=1e-4)
        assert found.values[name].given == (name in known)
    assert found.begin.value == pytest.approx(1e-3, abs=1e-9)
    assert found.described
    assert found.residual < 1e-6


def test_without_stiffness_mass_and_speed_only_their_combinations_are_told():
    K, n, e, m, v = 2e9, 1.3, 0.55, 0.4, 3.0
    found = identify(*integrated(K, n, e, m, v))
    assert all(found.values[name] == (None, None, False) for name in SCALES)
    assert found.words[0].startswith(
        "stiffness, mass and speed cannot be told apart from a force pulse: it fixes mass x"
    )
    assert "1.2 N s" in found.words[0]
    blow = solve_impact(Contact(K, n, exact(e)), m, np.inf, v)
    told = m * v, m * v * (1 + e), float(blow.peak_force), float(blow.duration), K * v**n
    for name, value in zip(COMBINATIONS, told, strict=True):
        # as above
        assert found.combinations[name].value == pytest.approx(value, rel=1e-5)
    assert found.names == ("exponent", "restitution", "begin")
    assert found.correlation.shape == (3, 3)
    assert np.diag(found.correlation) == pytest.approx(np.ones(3))


@pytest.mark.verify
@given(
    st.floats(0.7, 4.0), st.floats(0.03, 1.0), st.floats(-4.0, 4.0), st.floats(-6.0, 2.0), st.floats(-1.0, 1.0),
    st.sampled_from(SCALES), st.integers(30, 400),
)  # fmt: skip
def test_any_pulse_of_the_law_is_found_whatever_its_size(n, e, newtons, seconds, shift, known, samples):
    made = ForcePulse(shift, 10.0**newtons, 10.0**seconds, n, e)
    span = 3.0 * max(made.width, 0.4 * made.duration)
    t = shift + np.linspace(-made.width, span, samples)
    if not np.all(np.diff(t) > 1e-9 * abs(shift)) or np.count_nonzero(made.force(t) > 0.03 * made.peak) < 12:
        return
    found = identify(t, made.force(t), {known: 2.0})
    # a different minimum fits to 1e-3 of the peak at best
    assert found.residual < 1e-6
    assert found.values["exponent"].value == pytest.approx(n, rel=1e-2)
    assert found.values[known] == (2.0, None, True)
    assert found.combinations["impulse"].value == pytest.approx(made.peak * made.width, rel=1e-4)
    momentum = found.values["mass"].value * found.values["speed"].value
    assert found.combinations["momentum"].value == pytest.approx(momentum, rel=1e-9)


@given(st.floats(0.5, 5.0), st.floats(0.02, 1.0))
def test_a_force_pulse_is_the_history_of_its_impact(n, e):
    contact = solve_impact(Contact(3e8, n, exact(e)), 0.2, 0.5, 7.0)
    history = impact_history(contact)
    momentum = 0.2 * 0.5 / 0.7 * 7.0
    pulse = ForcePulse(0.0, float(contact.peak_force), momentum * (1 + e) / float(contact.peak_force), n, e)
    # the error that the docstring states, and that of the kernel's duration for n above 2
    assert pulse.force(history.time) == pytest.approx(history.force, abs=5e-6 * pulse.peak)
    assert pulse.momentum == pytest.approx(momentum, rel=1e-12)
    assert pulse.stiffness_speed == pytest.approx(3e8 * 7.0**n, rel=1e-9)
    assert pulse.duration == pytest.approx(float(contact.duration), rel=1e-9)


@pytest.mark.verify
@pytest.mark.parametrize("known", [("mass",), ("speed", "exponent"), ("mass", "speed"), ("mass", "restitution")])
def test_standard_errors_are_the_scatter_of_noisy_records(known, rng):
    truth = {name: x.value for name, x in identify(TIME, PULSE.force(TIME), {"mass": 0.1}).values.items()}
    runs, clean = 60, PULSE.force(TIME)
    given_ = {name: truth[name] for name in known}
    scaled = {name: [] for name in VALUES if name not in known}
    for _ in range(runs):
        found = identify(TIME, clean + 300.0 + rng.normal(size=TIME.size) * 0.004 * PULSE.peak, given_)
        assert found.described
        assert found.noise == pytest.approx(0.004 * PULSE.peak, rel=0.2)
        for name, ratios in scaled.items():
            value, error, _ = found.values[name]
            ratios.append((value - truth[name]) / error)
    low, high = chi2.ppf([1e-4, 1 - 1e-4], runs)
    for name, ratios in scaled.items():
        # scatter over standard error, and bias, each at a chance of 1 in 5000
        assert low < np.sum(np.square(ratios)) < high, name
        assert abs(np.mean(ratios)) < 3.7 / math.sqrt(runs), name


def test_a_stated_noise_is_taken_and_unevenly_spaced_samples_are_fine(rng):
    t = np.sort(rng.uniform(0.0, 4e-4, 600))
    one, two = (identify(t, PULSE.force(t), {"mass": 0.1}, noise=noise) for noise in (20.0, 40.0))
    assert two.noise == 40.0
    for name in ("stiffness", "exponent", "restitution", "speed"):
        assert two.values[name].standard_error == pytest.approx(2.0 * one.values[name].standard_error, rel=1e-6)
    assert one.values["exponent"].value == pytest.approx(1.5, rel=1e-5)


def test_a_half_sine_is_the_linear_elastic_contact():
    u = (TIME - 5e-5) / 1e-4
    found = identify(TIME, np.where((u > 0) & (u < 1), 500.0 * np.sin(np.pi * u), 0.0), {"mass": 2.0})
    assert found.values["exponent"].value == pytest.approx(1.0, rel=1e-6)
    assert found.values["restitution"].value == 1.0
    # K = m (pi / duration)^2
    assert found.values["stiffness"].value == pytest.approx(2.0 * (math.pi / 1e-4) ** 2, rel=1e-5)
    assert any("restitution is at its limit 1" in words for words in found.words)


def test_a_pulse_that_rises_slower_than_it_falls_has_its_restitution_at_the_limit():
    force = PULSE.force(TIME)[::-1]
    found = identify(TIME, force, {"mass": 1.0})
    assert found.values["restitution"].value == 1.0
    assert not found.described


def test_ringing_is_called_out(rng):
    t = TIME - PULSE.begin
    rings = np.where(t > 0, 0.12 * PULSE.peak * np.exp(-t / 2e-4) * np.sin(2 * np.pi * 25e3 * t), 0.0)
    found = identify(TIME, PULSE.force(TIME) + rings + rng.normal(size=TIME.size) * 20.0, {"mass": 0.1})
    assert not found.described
    assert "does not describe this pulse" in found.words[-1]
    assert "standard errors are too small" in found.words[-1]
    assert 0.02 < found.residual < 0.2


def test_a_slight_pattern_is_said_but_not_held_against_the_law(rng):
    bent = PULSE.force(TIME) * (1.0 + 0.01 * np.sin(TIME / 2e-5))
    found = identify(TIME, bent + rng.normal(size=TIME.size) * 10.0, {"mass": 0.1})
    assert found.described
    assert "follows a pattern" in found.words[-1]


def test_values_that_contradict_the_pulse_are_named():
    # the pulse alone says 0.75 N s; half of that would need a restitution above 1
    found = identify(TIME, PULSE.force(TIME), {"mass": 0.1, "speed": 3.0})
    assert any("do not agree with the pulse" in words and "mass, speed" in words for words in found.words)
    assert not found.described


def test_mass_and_speed_together_tell_the_restitution_much_better(rng):
    force = PULSE.force(TIME) + rng.normal(size=TIME.size) * 0.02 * PULSE.peak
    less, more = identify(TIME, force, {"mass": 0.1}), identify(TIME, force, {"mass": 0.1, "speed": 7.5})
    assert more.values["restitution"].standard_error < 0.8 * less.values["restitution"].standard_error
    assert less.combinations["momentum"].standard_error > 0.0
    assert more.combinations["momentum"].standard_error == pytest.approx(0.0, abs=1e-6)


def test_shapes_of_low_and_high_restitution_that_noise_hides_are_named(rng):
    force = ForcePulse(1e-4, 2e4, 60e-6, 1.4, 0.1).force(TIME) + rng.normal(size=TIME.size) * 0.04 * PULSE.peak
    found = identify(TIME, force, {"mass": 0.1})
    assert any("fits about as well" in words for words in found.words)


def test_the_largest_of_several_blows_is_taken_or_that_in_the_window():
    later = ForcePulse(6e-4, 1.2e4, 50e-6, 1.5, 0.8)
    t = np.arange(2000) * STEP
    force = PULSE.force(t) + later.force(t) - 40.0
    one = identify(t, force, {"mass": 0.1})
    assert one.pulse.restitution == pytest.approx(0.6, abs=1e-3)
    assert one.offset == pytest.approx(-40.0)
    two = identify(t, force, {"mass": 0.1}, window=(5e-4, 9e-4))
    assert two.pulse.restitution == pytest.approx(0.8, abs=1e-3)
    assert two.time[0] >= 5e-4


def replaced(index, value):
    force = PULSE.force(TIME)
    force[index] = value
    return force


@pytest.mark.parametrize(
    ("time", "force", "more", "said"),
    [
        (TIME, replaced(300, math.nan), {}, "not finite"),
        (TIME[::-1], PULSE.force(TIME), {}, "ascend"),
        (TIME[:-1], PULSE.force(TIME), {}, "equal length"),
        (TIME[:5], np.ones(5), {}, "at least 8"),
        (TIME, np.zeros(800), {}, "no pulse"),
        (TIME, -PULSE.force(TIME), {}, "turn the sign"),
        (TIME[:300], PULSE.force(TIME[:300]), {}, "cut at the end"),
        (TIME[280:], PULSE.force(TIME[280:]), {}, "cut at the beginning"),
        (TIME[::60], PULSE.force(TIME[::60]), {}, "sample faster"),
        (TIME, PULSE.force(TIME), {"window": (0.1, 0.2)}, "within the window"),
        (TIME, PULSE.force(TIME), {"known": {"masse": 1.0}}, "did you mean"),
        (TIME, PULSE.force(TIME), {"known": {"mass": -1.0}}, "above zero"),
        (TIME, PULSE.force(TIME), {"known": {"restitution": 1.2}}, "within 0.001 to 1"),
        (TIME, PULSE.force(TIME), {"noise": 0.0}, "above zero"),
        (TIME, PULSE.force(TIME), {"known": {"mass": 100.0, "speed": 7.5}}, "check their units"),
        (TIME, PULSE.force(TIME), {"known": {"stiffness": 1.0, "speed": 1e-9}}, "check their units"),
        (TIME, np.random.default_rng(1).normal(size=800), {}, "noise|negative"),
    ],
)
def test_what_cannot_be_used_is_refused_with_what_to_do(time, force, more, said):
    with pytest.raises(ValueError, match=said):
        identify(time, force, **more)


def test_a_record_that_begins_with_the_blow_has_its_noise_from_the_residual(rng):
    t = TIME[190:]
    found = identify(t, PULSE.force(t) + rng.normal(size=t.size) * 100.0, {"mass": 0.1})
    assert cut_out(t, PULSE.force(t)).noise is None
    # 10 % of a standard deviation of some 300 samples is 2.4 standard errors
    assert found.noise == pytest.approx(100.0, rel=0.1)


@pytest.mark.parametrize("number", ["13", "25", "41"])
def test_a_real_board_that_rings_is_not_described_by_the_law(measured, number):
    time, values = np.genfromtxt(measured("smd-5kg-impacts") / f"impact_{number}.lvm", usecols=(0, 1)).T
    found = identify(time, values)
    assert not found.described
    assert "does not describe this pulse" in found.words[-1]
    assert all(found.values[name].value is None for name in SCALES)


@pytest.mark.parametrize("start", [-3.0, 1e4, 1e6])
def test_absolute_time_stamps_change_nothing_but_the_begin(start):
    """Time is counted from the first sample; stamps of 1e6 s are 1e-10 s coarse."""
    t = np.arange(300) * 1e-6
    force = ForcePulse(50e-6, 2e4, 60e-6, 1.5, 0.6).force(t)
    found = identify(t + start, force, {"mass": 0.1})
    assert found.values["exponent"].value == pytest.approx(1.5, rel=1e-3)
    assert found.values["restitution"].value == pytest.approx(0.6, rel=1e-3)
    assert found.begin.value - start == pytest.approx(50e-6, abs=1e-8)


def test_a_window_on_the_second_blow_takes_its_zero_from_within():
    t = np.arange(4000) * 1e-6
    force = ForcePulse(500e-6, 2e4, 60e-6, 1.5, 0.9).force(t) + ForcePulse(3e-3, 1e4, 60e-6, 1.5, 0.6).force(t)
    found = identify(t, force, {"mass": 0.1}, window=(2e-3, 1.0))
    assert found.offset == 0.0
    assert found.values["restitution"].value == pytest.approx(0.6, rel=1e-4)
