"""Buffers: closed forms of layers and masses, and time against frequency domain."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from strikewave.sensors import Gasket, Mounting, Sensor, insertion_loss, output, transmission
from strikewave.sensors.mounting import band, mounting_system
from strikewave.waves.spectral import fit_loss

RUBBER = Gasket(1100.0, 10e6, 1e-4, 2e-3, 0.3)
PTFE = Gasket(2200.0, 0.5e9, 1e-4, 1e-3, 0.08)
ALUMINIUM = Gasket(2780.0, 72e9, 1e-4, 1e-3, 0.001)
BUFFERS = {
    "rubber": Mounting((RUBBER,), 5e-3),
    "layers of different impedance": Mounting((PTFE, ALUMINIUM, PTFE), 5e-3),
    "edge contact below": Mounting((PTFE, ALUMINIUM), 2e-3, 2e7, 30.0),
    "no mass": Mounting((RUBBER,)),
}


def test_nothing_between_reads_the_surface_exactly(rng):
    surface = rng.normal(size=5000) * 1e5
    assert np.array_equal(output(Sensor(), surface, 1e-7), surface)
    # without mass nothing moves on the edge contact
    assert np.array_equal(output(Sensor(mounting=Mounting((), 0.0, 1e6, 3.0)), surface, 1e-7), surface)
    assert np.array_equal(insertion_loss(Mounting(), [0.0, 1e3, 1e6]), [0.0, 0.0, 0.0])


@given(st.floats(1e3, 1e5), st.floats(0.0, 3.0))
def test_mass_on_an_edge_contact_has_the_transmissibility_of_the_textbook(natural, zeta):
    # |T|^2 = (1 + (2 zeta r)^2) / ((1 - r^2)^2 + (2 zeta r)^2), r = f/f0
    m, w = 5e-3, 2.0 * math.pi * natural
    mounting = Mounting((), m, m * w**2, 2.0 * zeta * m * w)
    f = np.geomspace(1e2, 1e6, 60)
    r = f / natural
    expected = np.sqrt((1 + (2 * zeta * r) ** 2) / ((1 - r**2) ** 2 + (2 * zeta * r) ** 2))
    assert np.allclose(np.abs(transmission(mounting, f)), expected, rtol=1e-9)


@pytest.mark.parametrize("zeta", [0.01, 0.3, 1.0])
@pytest.mark.parametrize("step", [1e-7, 1.3e-4])
def test_mass_on_an_edge_contact_answers_a_step_in_closed_form(zeta, step):
    # 1 - e^(-zeta w t) (cos wd t - (zeta w / wd) sin wd t): the damper lifts the mass at once
    m, w = 5e-3, 2.0 * math.pi * 2e4
    sensor = Sensor(mounting=Mounting((), m, m * w**2, 2.0 * zeta * m * w))
    t = np.arange(2000) * step
    got = output(sensor, np.ones(t.size), step)
    if zeta < 1.0:
        wd = w * math.sqrt(1.0 - zeta**2)
        expected = 1.0 - np.exp(-zeta * w * t) * (np.cos(wd * t) - zeta * w / wd * np.sin(wd * t))
    else:
        expected = 1.0 - np.exp(-w * t) * (1.0 - w * t)
    assert np.allclose(got, expected, atol=1e-9)


@given(st.floats(0.05, 0.95))
def test_layer_with_a_free_face(share):
    # 1 / cos(k h): without bound where the layer is a quarter of a wave thick
    quarter = RUBBER_SPEED / (4.0 * RUBBER.thickness)
    got = transmission(Mounting((LOSSLESS,)), share * quarter)
    assert got.real == pytest.approx(1.0 / math.cos(0.5 * math.pi * share), rel=1e-10)
    assert got.imag == 0.0


LOSSLESS = Gasket(1100.0, 10e6, 1e-4, 2e-3)
RUBBER_SPEED = math.sqrt(10e6 / 1100.0)


def test_quarter_wave_layer_magnifies_most():
    quarter = RUBBER_SPEED / (4.0 * RUBBER.thickness)
    assert insertion_loss(Mounting((LOSSLESS,)), quarter) < -200.0


@given(st.floats(0.0, 20e-3), st.floats(1e3, 2e5))
def test_layer_with_a_mass(mass, f):
    # 1 / (cos k h - (m/m_layer) k h sin k h), from the boundary condition E A u' = m w^2 u
    kh = 2.0 * math.pi * f * RUBBER.thickness / RUBBER_SPEED
    expected = 1.0 / (math.cos(kh) - mass / LOSSLESS.mass * kh * math.sin(kh))
    # near a resonance the difference of the two terms is small and loses digits
    assert transmission(Mounting((LOSSLESS,), mass), f) == pytest.approx(
        expected, rel=1e-10 * (1 + abs(expected) * kh * (1 + mass / LOSSLESS.mass))
    )


@pytest.mark.parametrize("eta", [0.05, 0.3, 0.8])
def test_insertion_loss_of_a_mass_on_a_lossy_spring(eta):
    # a gasket almost without mass is a spring K (1 + i eta); |T|^2 = (1 + eta^2) / ((1 - r^2)^2 + eta^2)
    m, stiffness = 5e-3, 1e7
    fit = fit_loss(1.0, eta, 1e3, 1e5)
    spring = Gasket(1e-6, stiffness * 1e-3 / 1e-4, 1e-4, 1e-3, eta)
    f = 1e4  # the geometric mean, where the storage stiffness is the one asked for
    wt = 2.0 * math.pi * f * np.array([b.relaxation for b in fit.branches])
    got_eta = float(np.sum(np.array([b.stiffness for b in fit.branches]) * wt / (1 + wt**2)))
    assert got_eta == pytest.approx(eta, rel=0.05)
    r2 = m * (2.0 * math.pi * f) ** 2 / stiffness
    expected = -10.0 * math.log10((1 + got_eta**2) / ((1 - r2) ** 2 + got_eta**2))
    # the gasket's mass is 2e-11 of the sensor's
    assert insertion_loss(Mounting((spring,), m), f) == pytest.approx(expected, abs=1e-8)


@pytest.mark.parametrize("mounting", BUFFERS.values(), ids=BUFFERS)
def test_cutting_a_gasket_in_two_changes_nothing(mounting):
    half = tuple(
        Gasket(g.density, g.modulus, g.area, g.thickness / 2, g.loss_factor) for g in mounting.gaskets for _ in "ab"
    )
    halved = Mounting(half, mounting.sensor_mass, mounting.edge_stiffness, mounting.edge_damping)
    f = np.geomspace(1e2, 1e6, 200)
    assert np.allclose(transmission(mounting, f), transmission(halved, f), rtol=1e-9)


@pytest.mark.parametrize("mounting", BUFFERS.values(), ids=BUFFERS)
@pytest.mark.parametrize("f", [1e3, 3.3e3, 1e4, 33e3, 1e5])
def test_sine_in_time_agrees_with_the_insertion_loss(mounting, f):
    # elements leave 2e-5 dB in these buffers below 100 kHz; chords lower a sine by sinc(f h)^2 and add overtones beyond 399 f
    step, settled = 1.0 / (400.0 * f), 12e-3
    periods = math.ceil(settled * f) + 4
    t = np.arange(400 * periods + 1) * step
    answer = output(Sensor(mounting=mounting), np.sin(2.0 * np.pi * f * t), step)
    last = slice(-1600, None)  # four whole periods
    got = 2.0 * np.mean(answer[last] * np.exp(-2j * np.pi * f * t[last])) * 1j
    got /= np.sinc(f * step) ** 2
    assert -20.0 * math.log10(abs(got)) == pytest.approx(float(insertion_loss(mounting, f)), abs=2e-5)
    assert abs(got / transmission(mounting, f) - 1.0) < 3e-6


@pytest.mark.parametrize("mounting", BUFFERS.values(), ids=BUFFERS)
def test_pulse_in_time_is_the_fourier_sum_of_the_continuous_layers(mounting):
    # a Gaussian pulse of 16 kHz bandwidth, long enough for the buffer to come to rest; no shared step
    step, size = 5e-7, 2**16
    t = np.arange(size) * step
    pulse = np.exp(-0.5 * ((t - 200e-6) / 10e-6) ** 2)
    got = output(Sensor(mounting=mounting), pulse, step)
    f = np.fft.rfftfreq(size, step)
    expected = np.fft.irfft(np.fft.rfft(pulse) * np.sinc(f * step) ** 2 * transmission(mounting, f), size)
    # the spectrum of the chords is that of the samples times sinc(f h)^2; the pulse holds nothing beyond 100 kHz
    assert np.max(np.abs(got - expected)) < 1e-9 * np.max(np.abs(expected))


def test_light_gasket_under_a_mass_is_the_maxwell_spring_of_the_integrator():
    # the step of 1 us is thousands of the gasket's own periods, whose mass is 1e-8 of the sensor's
    m, K, eta = 5e-3, 1e7, 0.3
    fit = fit_loss(K, eta, 1e3, 1e5)
    gasket = Gasket(5e-4, K * 1e-3 / 1e-4, 1e-4, 1e-3, eta)
    shares = np.array([b.stiffness for b in fit.branches])
    tau = np.array([b.relaxation for b in fit.branches])
    step, size, width = 1e-6, 301, 100

    def surface(t):  # a triangle, linear between samples
        return max(0.0, 1.0 - abs(t / step - width) / width)

    def rates(t, y):  # stretch, its rate, and the branches' forces
        z, speed, branch = y[0], y[1], y[2:]
        pull = fit.stiffness * z + np.sum(branch)
        return np.concatenate([[speed, -pull / m - surface(t)], shares * speed - branch / tau])

    y, expected = np.zeros(2 + tau.size), []
    for a, b in [(0, width), (width, 2 * width), (2 * width, size - 1)]:
        times = np.arange(a, b + 1) * step
        solved = solve_ivp(rates, (times[0], times[-1]), y, method="DOP853", rtol=1e-11, atol=1e-16, t_eval=times)
        y = solved.y[:, -1]
        expected.extend(-(fit.stiffness * solved.y[0] + solved.y[2:].sum(axis=0))[(0 if a == 0 else 1) :] / m)
    got = output(Sensor(mounting=Mounting((gasket,), m)), [surface(k * step) for k in range(size)], step)
    assert np.allclose(got, expected, atol=2e-7)


gaskets = st.builds(
    Gasket,
    st.floats(500.0, 8000.0),
    st.floats(5e7, 2e11),
    st.floats(1e-5, 1e-3),
    st.floats(1e-4, 2e-3),
    st.sampled_from([0.0, 0.01, 0.3, 0.8]),
)


@given(st.lists(gaskets, min_size=1, max_size=4), st.floats(0.0, 0.02), st.sampled_from([math.inf, 1e6, 1e9]))
def test_every_buffer_is_passive(layers, mass, edge):
    A = mounting_system(Mounting(tuple(layers), mass, edge)).A
    assert np.max(np.linalg.eigvalsh(A + A.T)) <= 1e-12 * np.max(np.abs(A))


@given(st.floats(-1e3, 1e3), st.integers(0, 20))
def test_linear(scale, seed):
    rng = np.random.default_rng(seed)
    one, other = rng.normal(size=(2, 300))
    sensor = Sensor(mounting=BUFFERS["edge contact below"], resonance=80e3)
    both = output(sensor, one + scale * other, 1e-6)
    assert np.allclose(
        both, output(sensor, one, 1e-6) + scale * output(sensor, other, 1e-6), atol=1e-10 * (1 + abs(scale))
    )


@pytest.mark.parametrize("mounting", BUFFERS.values(), ids=BUFFERS)
def test_slow_motion_passes_as_it_is(mounting):
    # what is left at 1 Hz is (f/f0)^2 of the softest resonance near 1.5 kHz
    assert abs(transmission(mounting, 1.0) - 1.0) < 2e-6
    assert transmission(mounting, 0.0) == 1.0
    assert output(Sensor(mounting=mounting), np.ones(40001), 1e-6)[-1] == pytest.approx(1.0, abs=1e-6)


@pytest.mark.parametrize(
    ("make", "word"),
    [
        (lambda: Gasket(0.0, 1e9, 1e-4, 1e-3), "density"),
        (lambda: Gasket(1e3, 1e9, 1e-4, math.inf), "thickness"),
        (lambda: Gasket(1e3, 1e9, 1e-4, 1e-3, -0.1), "loss factor"),
        (lambda: Mounting(sensor_mass=-1.0), "sensor mass"),
        (lambda: Mounting(edge_stiffness=0.0), "edge contact"),
        (lambda: Mounting(edge_stiffness=1e6, edge_damping=-1.0), "damping"),
        (lambda: Mounting(edge_damping=1e-3), "infinite stiffness"),
        (lambda: Mounting((Gasket(1e3, 1e7, 1e-4, 1e-3, 4.0),), band=(1e2, 1e6)), "narrower band"),
        (lambda: Mounting((RUBBER,), band=(1e5, 1e3)), "band"),
        (lambda: transmission(Mounting(), [-1.0]), "frequencies"),
        (lambda: transmission(Mounting(), [1.0, -1.0]), "frequencies"),
        (lambda: transmission(Mounting(), [1.0, math.nan]), "frequencies"),
        (lambda: mounting_system(Mounting((Gasket(1e3, 1e6, 1e-4, 0.05, 0.3),))), "thinner or stiffer"),
        # 8 states an element, 260 of them: 2080
        (lambda: mounting_system(Mounting((Gasket(1e3, 1e7, 1e-4, 259.5 / 3e5 * 100.0),))), "thinner or stiffer"),
    ],
)
def test_bad_values_are_refused_in_words(make, word):
    with pytest.raises(ValueError, match=word):
        make()


@pytest.mark.parametrize("mounting", BUFFERS.values(), ids=BUFFERS)
def test_elements_are_as_fine_as_is_stated(mounting):
    """1e-4 dB up to 100 kHz and 0.03 dB at 200 kHz, of c (i w - A)^-1 b + d, beside the continuous layers."""
    system = mounting_system(mounting)
    for f, most in ((1e4, 1e-4), (1e5, 1e-4), (2e5, 0.03)):
        solved = np.linalg.solve(2j * math.pi * f * np.eye(system.b.size) - system.A, system.b.astype(complex))
        ratio = (system.c @ solved + system.d) / transmission(mounting, f)
        assert abs(20.0 * math.log10(abs(ratio))) < most
        assert abs(np.angle(ratio)) < 0.2 * most


def test_finer_elements_than_are_stated_would_be_too_many():
    """Rubber of 2 mm at 95 m/s: 6.3 elements, each of four nodes, and of four springs and those of its loss."""
    lossless = mounting_system(Mounting((LOSSLESS,), 5e-3))
    assert lossless.b.size == 7 * (4 + 4)
    assert mounting_system(BUFFERS["rubber"]).b.size == 7 * (4 + 4 * (1 + len(BUFFERS["rubber"].loss(RUBBER).branches)))


def test_what_loses_nothing_gives_back_everything():
    """A + A^T = 0 to the last bit, and with a dashpot -2 c/m of the first node at its place alone."""
    layers = LOSSLESS, Gasket(2200.0, 0.5e9, 1e-4, 1e-3)
    A = mounting_system(Mounting(layers, 5e-3, 2e7)).A
    assert np.all(A + A.T == 0.0)
    # 3 elements of the first layer, of 7 in 2 mm: a tenth of half its first one
    damped = mounting_system(Mounting(layers, 5e-3, 2e7, 3e-3)).A
    expected = np.zeros_like(A)
    expected[0, 0] = -2.0 * 3e-3 / (LOSSLESS.mass / 7 * 0.05)
    assert damped + damped.T == pytest.approx(expected, rel=1e-12)


def test_a_gasket_has_the_stiffness_of_its_block_and_the_mass_of_its_volume():
    assert Gasket(3.0, 5.0, 7.0, 11.0).stiffness == pytest.approx(5.0 * 7.0 / 11.0, rel=1e-15)
    assert Gasket(3.0, 5.0, 7.0, 11.0).mass == 231.0


@pytest.mark.parametrize("mounting", [BUFFERS["rubber"], BUFFERS["edge contact below"], Mounting((RUBBER, PTFE), 1e-3)])
def test_a_mounting_with_more_states_than_it_may_have_is_refused(monkeypatch, mounting):
    """The node that moves with the surface counts too."""
    states = mounting_system(mounting).b.size
    monkeypatch.setattr("strikewave.sensors.mounting.MOST_STATES", states + 1)
    assert mounting_system.__wrapped__(mounting).b.size == states
    monkeypatch.setattr("strikewave.sensors.mounting.MOST_STATES", states)
    with pytest.raises(ValueError, match="too many wavelengths"):
        mounting_system.__wrapped__(mounting)


def test_small_values_are_taken():
    Mounting((), 1e-3, 1e-3, 1e-3)
    Gasket(1e-3, 1e-3, 1e-3, 1e-3, 1e-3)


def on_spring(natural, zeta=0.0, mass=5e-3):
    w = 2.0 * math.pi * natural
    return Mounting((), mass, mass * w**2, 2.0 * zeta * mass * w)


@given(st.floats(200.0, 1e5))
def test_mass_on_a_spring_without_loss_leaves_the_band_as_its_closed_form_says(natural):
    # |H| = 1 / |1 - r^2|: 1.05 and 1.1 below resonance, 1/sqrt(2) above; 2e-7 of a frequency is left by the zooms
    found = band(on_spring(natural))
    assert found.within_5 == pytest.approx(natural * math.sqrt(1.0 - 1.0 / 1.05), rel=1e-6)
    assert found.within_10 == pytest.approx(natural * math.sqrt(1.0 - 1.0 / 1.1), rel=1e-6)
    assert found.half_power == pytest.approx(natural * math.sqrt(1.0 + math.sqrt(2.0)), rel=1e-6)
    assert found.resonance == pytest.approx(natural, rel=2e-6)  # a summit is looked for on both sides


@given(st.floats(200.0, 1e5), st.floats(0.005, 0.4))
def test_resonance_and_quality_of_a_damped_mass(natural, zeta):
    # the largest |H| of a base-excited mass stands at r^2 = (sqrt(1 + 8 zeta^2) - 1) / (4 zeta^2)
    found, r2 = band(on_spring(natural, zeta)), (math.sqrt(1.0 + 8.0 * zeta**2) - 1.0) / (4.0 * zeta**2)
    height = math.sqrt((1.0 + 4.0 * zeta**2 * r2) / ((1.0 - r2) ** 2 + 4.0 * zeta**2 * r2))
    # a summit is flat: what is left of its frequency is a share of its width, of its height the square of that
    assert found.resonance == pytest.approx(natural * math.sqrt(r2), rel=1e-4)
    assert found.quality == pytest.approx(height, rel=1e-7)
    assert (found.largest, found.largest_at) == (found.quality, found.resonance)


def test_layer_with_a_free_face_leaves_10_percent_where_its_cosine_says():
    # |H| = 1 / |cos k h|
    layer = Gasket(1100.0, 10e6, 1e-4, 2e-3)
    speed = math.sqrt(10e6 / 1100.0)
    expected = math.acos(1.0 / 1.1) * speed / (2.0 * math.pi * 2e-3)
    assert band(Mounting((layer,))).within_10 == pytest.approx(expected, rel=1e-6)


def test_a_direct_mounting_passes_everything():
    found = band(Mounting())
    assert (found.within_5, found.within_10, found.half_power) == (math.inf,) * 3
    assert math.isnan(found.resonance)
    assert found.largest == 1.0


def test_what_lies_above_200_khz_is_not_claimed():
    found = band(on_spring(1e6))
    assert found.half_power == math.inf
    assert math.isnan(found.resonance)
    assert found.within_5 == math.inf  # 5 % is left at 218 kHz
    assert found.largest_at == pytest.approx(200e3)


@given(st.floats(0.01, 0.5), st.floats(2e-4, 3e-3), st.floats(1e-3, 2e-2))
def test_inside_the_band_nothing_is_further_from_one(eta, thickness, mass):
    mounting = Mounting((Gasket(2170.0, 0.475e9, 1.8e-4, thickness, eta),), mass, 2e8, 50.0)
    found = band(mounting)
    for edge, share in ((found.within_5, 0.05), (found.within_10, 0.10)):
        inside = np.linspace(0.0, edge * (1.0 - 1e-6), 500)
        assert np.max(np.abs(np.abs(transmission(mounting, inside)) - 1.0)) <= share
        assert abs(abs(transmission(mounting, edge)) - 1.0) >= share


def test_the_5_percent_band_of_an_overdamped_mounting_ends_below_one():
    """Four times critical: |H|^2 = (1 + (2 z r)^2) / ((1 - r^2)^2 + (2 z r)^2) stays below 1.05 and leaves at 0.95."""
    k, m, z = 4e5, 1e-2, 4.0
    found = band(Mounting((Gasket(1.0, 1e12, 1e-4, 1e-4),), m, k, 2.0 * z * math.sqrt(k * m)))
    r = found.within_5 / (math.sqrt(k / m) / (2.0 * math.pi))
    height = math.sqrt((1.0 + (2.0 * z * r) ** 2) / ((1.0 - r * r) ** 2 + (2.0 * z * r) ** 2))
    assert found.largest < 1.05
    assert height == pytest.approx(0.95, abs=1e-5)
    r = found.within_10 / (math.sqrt(k / m) / (2.0 * math.pi))
    height = math.sqrt((1.0 + (2.0 * z * r) ** 2) / ((1.0 - r * r) ** 2 + (2.0 * z * r) ** 2))
    assert height == pytest.approx(0.9, abs=1e-5)


def test_one_lossy_gasket_of_two_keeps_the_quality_finite():
    layers = [Gasket(1100.0, 10e6, 1e-4, 2e-3, eta) for eta in (0.0, 0.1)]
    assert band(Mounting(tuple(layers), 5e-3)).quality == pytest.approx(2.0 / 0.1, rel=0.2)


@pytest.mark.parametrize(("eta", "damping"), [(0.0, 0.0), (0.01, 0.0), (0.0, 5e3)])
def test_quality_is_infinite_where_nothing_has_loss_and_only_there(eta, damping):
    found = band(Mounting((Gasket(1100.0, 10e6, 1e-4, 2e-3, eta),), 5e-3, 2e8, damping))
    assert math.isinf(found.quality) == (eta == damping == 0.0)
    assert (found.largest, found.largest_at) == (found.quality, found.resonance) or eta + damping > 0.0
    # of the gasket a third moves along
    natural = math.sqrt(5e5 / (5e-3 + 0.22e-3 / 3.0)) / (2.0 * math.pi)
    assert found.resonance == pytest.approx(natural, rel=0.01)


def test_a_mounting_too_soft_to_pass_10_hz_leaves_every_band_there():
    """|H| = 1/3 at twice its resonance and less above: looked at from 10 Hz on, it is largest there."""
    found = band(on_spring(5.0))
    assert (found.within_5, found.within_10, found.half_power) == (10.0, 10.0, 10.0)
    assert math.isnan(found.resonance)
    assert math.isnan(found.quality)
    assert (found.largest, found.largest_at) == (pytest.approx(1.0 / 3.0, rel=1e-12), 10.0)
