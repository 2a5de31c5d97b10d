"""A run of a bar that ends before its waves arrive says where; arrival is way over wave speed, layer by layer."""

import numpy as np
import pytest

from strikewave import load_case
from strikewave.analyses.wave.run import run_wave
from strikewave.cases.case import parse_case

LENGTHS = {"first": 0.100, "second": 0.060, "last": 0.040}
STEEL, ALLOY = 7820.0, 2780.0
SPEEDS = {"first": (211e9 / STEEL) ** 0.5, "second": (72e9 / ALLOY) ** 0.5, "last": (211e9 / STEEL) ** 0.5}
SECOND = LENGTHS["first"] / SPEEDS["first"]
TAP = SECOND + 0.5 * LENGTHS["second"] / SPEEDS["second"]
LAST = SECOND + LENGTHS["second"] / SPEEDS["second"]
"""Times at which the first wave reaches the second layer, the tap in its middle, and the last layer, s."""
QUIET = 1e-6
"""Speed below which nothing moves, m/s: the wave brings some 0.3, rounding of the spectral solver 1e-9."""
BAR = "schema = 1\n" + "".join(
    f'[[stack.layer]]\nname = "{name}"\nmaterial = "{material}"\nlength = "{1e3 * LENGTHS[name]} mm"\n'
    'diameter = "10 mm"\n'
    for name, material in zip(LENGTHS, ("65Mn", "2A12", "65Mn"), strict=True)
)
TAPS = '[[tap]]\nname = "gauge"\nlayer = "second"\nposition = 0.5\n'
PULSE = '[load]\nshape = "half-sine"\npeak = "1 kN"\nduration = "4 us"\n'
STRIKER = """
[striker]
mass = "10 gram"
material = "65Mn"
contact_length = "10 mm"
nose_radius = "20 mm"
mount_stiffness = "1 MN/m"
mount_damping = "60 N s/m"
[contact]
law = "hertz"
damping = "exact"
restitution = 1
slowest_approach = "0.1 m/s"
[load]
shape = "contact"
speed = "5 m/s"
"""


def run(load, duration, more=""):
    """Return a run of the bar, and its notices by their codes."""
    text = f'{BAR}{TAPS}{load}{more}[solver]\nduration = "{duration * 1e6!r} us"\n'
    solution = run_wave(parse_case(text))
    return solution, {notice.code: notice for notice in solution.notices}


@pytest.mark.parametrize("load", [PULSE, STRIKER], ids=["pulse", "striker"])
def test_a_run_that_ends_before_the_wave_arrives_names_tap_and_layers(load):
    solution, codes = run(load, 0.99 * TAP)
    message = codes["not-reached"].message
    assert message.startswith("solver.duration = ")
    assert f"tap gauge ({TAP * 1e6:.4g}\xa0us), layer last ({LAST * 1e6:.4g}\xa0us)" in message
    assert codes["not-reached"].limit == pytest.approx(LAST, rel=1e-9)
    assert np.abs(solution.run.velocity).max() < QUIET


@pytest.mark.parametrize("load", [PULSE, STRIKER], ids=["pulse", "striker"])
def test_a_tap_that_the_wave_reaches_is_not_named(load):
    """One hundredth later it moves, and only the last layer is named."""
    solution, codes = run(load, 1.01 * TAP)
    assert "gauge" not in codes["not-reached"].message
    assert np.abs(solution.run.velocity).max() > 1e3 * QUIET


def test_a_run_that_ends_before_the_top_of_the_pulse_arrives_says_so():
    """The top of a half sine of 4 us comes 2 us after its front."""
    after = LAST + 1e-6
    _, codes = run(PULSE, TAP + 1.9e-6)
    assert f"tap gauge ({(TAP + 2e-6) * 1e6:.4g}\xa0us)" in codes["peak-not-reached"].message
    solution, codes = run(PULSE, max(TAP + 2.1e-6, after))
    assert not {"not-reached", "peak-not-reached"} & set(codes)
    assert int(np.argmax(solution.run.force[:, 0])) < len(solution.run.time) - 1


def test_a_sensor_at_such_a_tap_is_named():
    sensor = '[[sensor]]\nname = "quartz"\ntap = "gauge"\nresonance = "100 kHz"\n'
    _, codes = run(PULSE, 0.9 * TAP, sensor)
    assert "tap gauge with sensor quartz" in codes["not-reached"].message


def test_waves_of_layers_that_meet_begin_where_they_meet():
    """The last layer flies against the second one: the wave comes from there, in both directions."""
    moving = BAR.replace('name = "last"', 'name = "last"\nspeed = "-3 m/s"')
    way = 0.5 * LENGTHS["second"] / SPEEDS["second"]
    for duration, named in ((0.98 * way, True), (1.02 * way, False)):
        text = f'{moving}{TAPS}[solver]\nduration = "{duration * 1e6!r} us"\n'
        found = [notice.message for notice in run_wave(parse_case(text)).notices if notice.code == "not-reached"]
        assert any("tap gauge" in message for message in found) is named
        assert any("layer first" in message for message in found)


def test_a_record_that_rests_at_first_loads_the_bar_later(tmp_path):
    """Five microseconds of rest before the pulse of the file delay the wave by as much."""
    times = np.arange(0.0, 12.0, 0.05)
    force = np.where((times > 5.0) & (times < 9.0), np.sin(np.pi * (times - 5.0) / 4.0), 0.0)
    rows = "\n".join(f"{1e-6 * time},{1e3 * value}" for time, value in zip(times, force, strict=True))
    path = tmp_path / "pulse.csv"
    path.write_text(f"time (s),force (N)\n{rows}\n", "utf-8")
    load = f'[load]\nshape = "file"\nfile = "{path}"\n'
    for duration, named in ((3e-6, True), (TAP + 4.8e-6, True), (TAP + 5.3e-6, False)):
        _, codes = run(load, duration)
        assert ("tap gauge" in codes["not-reached"].message) is named
        assert codes["not-reached"].limit == pytest.approx(LAST + 5e-6, rel=1e-3)  # to a sample of the file


def test_the_built_in_bar_is_followed_long_enough():
    codes = {notice.code for notice in run_wave(load_case("li-ma-2019-fig13-bar")).notices}
    assert not {"not-reached", "peak-not-reached", "material-far", "strain-large", "faster-than-wave"} & codes


def test_layers_that_meet_faster_than_a_wave_are_named():
    moving = BAR.replace('name = "last"', 'name = "last"\nspeed = "-6 km/s"')
    text = f'{moving}{TAPS}[solver]\nduration = "40 us"\n'
    (notice,) = [notice for notice in run_wave(parse_case(text)).notices if notice.code == "faster-than-wave"]
    assert "stack.layer.last.speed = -6 km/s: second and last meet at 6000\xa0m/s" in notice.message
    assert notice.limit == pytest.approx(SPEEDS["second"])


def test_a_striker_faster_than_a_wave_is_named():
    _, codes = run(STRIKER.replace('speed = "5 m/s"', 'speed = "5.2 km/s"'), 60e-6)
    assert codes["faster-than-wave"].message.startswith("load.speed = 5.2 km/s: ")
    assert codes["faster-than-wave"].limit == pytest.approx(SPEEDS["first"])
    assert "approach-fast" not in codes


def test_a_stress_near_the_modulus_of_a_layer_without_a_yield_strength_is_named():
    """F/A of a load of 2 MN on a bar of its own modulus, whose yield nobody states."""
    own = BAR.replace('material = "65Mn"', 'density = "7820 kg/m^3"\nmodulus = "211 GPa"')
    text = f'{own}{TAPS}{PULSE.replace("1 kN", "2 MN")}[solver]\nduration = "60 us"\n'
    notices = [notice for notice in run_wave(parse_case(text)).notices if notice.code == "strain-large"]
    area = 0.25 * np.pi * 0.01**2
    assert notices[0].value == pytest.approx(2e6 / area, rel=1e-3)  # the grid samples the top of the pulse
    assert "stress in first" in notices[0].message
