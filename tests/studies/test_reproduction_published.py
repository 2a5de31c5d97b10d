"""Published numbers of Li & Ma 2019, their checks, and the closing table."""

import math

import pytest

from strikewave.errors import InputError
from strikewave.materials import material
from strikewave.studies.reproduction.equations import equation_rows
from strikewave.studies.reproduction.findings import ELASTIC, QUIET, REFLECTING, WAVE, findings
from strikewave.studies.reproduction.published import (
    consistency_checks,
    elastic_stiffness,
    printed_material,
    published_number,
    published_numbers,
)
from strikewave.studies.reproduction.types import ElementNumbers
from strikewave.units import DIMENSIONS, convertible, in_unit

G = 9.80665
AS_PRINTED = {
    "direct peak": 9707.12,
    "buffered peak": 6353.22,
    "comparison count": 7,
    "comparison time": 150,
    "speed": 730,
    "count": 11,
    "typical peak": 4000,
    "typical width": 200,
    "smallest element": 0.5,
    "gravity": 9.8,
    "simulated time": 1,
    "output interval": 1,
    "rigid peak": 4151.25,
    "rigid width": 200,
    "rigid peak simulated": 4374.52,
    "rigid width simulated": 220,
    "force simulated": 19685.34,
    "wave peak": 21909.89,
    "wave width": 252,
    "peak ratio": 4,
    "wave peak simulated": 22841.7,
    "palmgren factor": 3.81,
    "integral": 0.3,
    "exponent": 10 / 9,
    "least transits": 3,
    "most transits": 5,
}


@pytest.mark.parametrize(("name", "printed"), AS_PRINTED.items())
def test_numbers_read_back_as_printed(name, printed):
    number = published_number(name)
    si = "1" if number.unit == "1" else convertible(number.unit, DIMENSIONS)[0]
    back = number.value if number.unit == "1" else in_unit(number.value, si, number.unit)
    assert back == pytest.approx(printed, rel=1e-14)


def test_every_number_once():
    names = [number.name for number in published_numbers()]
    assert len(names) == len(set(names)) == len(AS_PRINTED) + 12
    assert not set(AS_PRINTED) - set(names)


def test_origins():
    simulated = {number.name for number in published_numbers() if number.origin == "simulated"}
    assert simulated == {"rigid peak simulated", "rigid width simulated", "force simulated", "wave peak simulated"}


@pytest.mark.parametrize(
    ("name", "row"),
    [
        ("65Mn", (7820, 211e9, 0.288, 430e6)),
        ("2A12", (2780, 72e9, 0.33, 345e6)),
        ("45 steel", (7850, 210e9, 0.31, 355e6)),
    ],
)
def test_tables_1_and_2(name, row):
    for body in (printed_material(name), material(name)):
        assert (body.density, body.youngs_modulus, body.poissons_ratio, body.yield_strength) == pytest.approx(row)


def test_unknown_number_is_refused_with_the_nearest():
    with pytest.raises(InputError, match="rigid peak"):
        published_number("rigid peek")


def check(quantity, used):
    return next(one for one in consistency_checks() if one.quantity == quantity and used in one.uses)


def test_checks_of_the_errata():
    assert check("struck mass", "force simulated").value == pytest.approx(19685.34 / (4374.52 * G), rel=1e-14)
    assert round(check("struck mass", "force simulated").value, 3) == 0.459
    ratio = check("ratio of the peaks", "peak ratio")
    assert (round(ratio.value, 2), ratio.stated, ratio.agrees) == (5.28, 4.0, False)
    assert check("period of the turntable", "speed").value == pytest.approx(60.0 / 730.0, rel=1e-14)
    assert round(check("period of the turntable", "speed").value * 1e3, 2) == 82.19
    assert check("velocity change", "rigid peak").value == pytest.approx(2 * 4151.25 * G * 200e-6 / math.pi)
    assert check("impulse", "force simulated").value == pytest.approx(2 * 19685.34 * 220e-6 / math.pi)
    assert check("F_II, equal areas", "45 steel density").value == pytest.approx(2.3e-4, rel=0.01)


def test_impulse_is_mass_times_velocity_change():
    mass = check("struck mass", "force simulated").value
    change = check("velocity change", "rigid peak simulated").value
    assert check("impulse", "force simulated").value == pytest.approx(mass * change, rel=1e-12)


def test_elastic_stiffness_gives_its_pulse_back():
    """The blow with that stiffness and speed, integrated: force and duration are those asked for."""
    from scipy.integrate import solve_ivp

    force, duration, mass, n = 19685.34, 220e-6, 0.459, 10 / 9
    stiffness = elastic_stiffness(force, duration, mass)
    depth = (force / stiffness) ** (1 / n)
    speed = math.sqrt(2 * stiffness * depth ** (n + 1) / ((n + 1) * mass))

    def release(t, y):
        return y[0] if t > 1e-7 else 1.0

    release.terminal = True
    run = solve_ivp(
        lambda t, y: [y[1], -stiffness * max(y[0], 0.0) ** n / mass],
        (0.0, 1e-3),
        [0.0, speed],
        method="DOP853",
        rtol=1e-11,
        atol=1e-15,
        events=release,
    )
    assert run.t_events[0][0] == pytest.approx(duration, rel=1e-6)
    assert round(stiffness / 1e8, 2) == 2.46


@pytest.fixture(scope="module")
def rows():
    return equation_rows()


def table(rows, elements=None):
    return {row.topic: row for row in findings(rows, consistency_checks(), elements)}


OF_ELEMENTS = {
    "non-reflecting faces on the struck body",
    "slope of the pulse",
    "yielding",
    "mean acceleration of the specimen between two cylinders",
}


def test_what_was_not_run_is_open(rows):
    found = table(rows)
    assert {topic for topic, row in found.items() if row.verdict == "open"} == OF_ELEMENTS
    assert table(rows, {QUIET: None, WAVE: ElementNumbers()}) == found


def test_verdicts_without_elements(rows):
    found = {topic: row.verdict for topic, row in table(rows).items()}
    assert found["form of the contact force, balances of energy and momentum"] == "right"
    assert found["transmission, reflection and speed of waves"] == "right"
    assert found["a sensor reads more than the rigid body's acceleration"] == "right"
    assert found["restitution"] == found["stiffness of the line contact"] == "partly"
    for topic in (
        "arrival of echoes",
        "acceleration from strain",
        "force of the machine's blow from the contact alone",
    ):
        assert found[topic] == "not"


def test_findings_follow_the_rows_they_are_given(rows):
    """A restitution that came out as asked, and echoes in time, would be right."""
    from dataclasses import replace

    mended = [replace(row, printed=row.exact) for row in rows]
    found = {topic: row.verdict for topic, row in table(mended).items()}
    assert found["arrival of echoes"] == found["acceleration from strain"] == found["energy lost by damping"] == "right"


@pytest.mark.parametrize(
    ("topic", "elements", "verdict", "says"),
    [
        (
            "non-reflecting faces on the struck body",
            {QUIET: ElementNumbers(rigid_peak=G * 3000.0), REFLECTING: ElementNumbers(rigid_peak=G * 4000.0)},
            "partly",
            "3000 g with them, 4000 g without",
        ),
        (
            "non-reflecting faces on the struck body",
            {
                QUIET: ElementNumbers(rigid_peak=G * 4000.0, impulse=2.0, momentum=0.5),
                REFLECTING: ElementNumbers(rigid_peak=G * 4000.0),
            },
            "right",
            "25% of the impulse",
        ),
        ("slope of the pulse", {QUIET: ElementNumbers(slope_early=2e8, slope_late=1e8)}, "not", "does not steepen"),
        ("slope of the pulse", {QUIET: ElementNumbers(slope_early=1e8, slope_late=2e8)}, "partly", "was not run"),
        (
            "slope of the pulse",
            {
                QUIET: ElementNumbers(slope_early=1e8, slope_late=2e8),
                ELASTIC: ElementNumbers(slope_early=1e8, slope_late=1.9e8),
            },
            "partly",
            "not yielding",
        ),
        (
            "slope of the pulse",
            {
                QUIET: ElementNumbers(slope_early=1e8, slope_late=2e8),
                ELASTIC: ElementNumbers(slope_early=1e8, slope_late=1e8),
            },
            "right",
            "it is yielding",
        ),
        ("yielding", {REFLECTING: ElementNumbers(plastic_strain=0.01)}, "right", "1.00%"),
        ("yielding", {QUIET: ElementNumbers(plastic_strain=0.0)}, "not", "0.00%"),
        (
            "mean acceleration of the specimen between two cylinders",
            {WAVE: ElementNumbers(mean_peak=G * 22000.0, section_peak=G * 30000.0)},
            "right",
            "30000 g in its mid section",
        ),
        (
            "mean acceleration of the specimen between two cylinders",
            {WAVE: ElementNumbers(mean_peak=G * 60000.0)},
            "not",
            "60000 g",
        ),
    ],
)
def test_verdicts_of_elements(rows, topic, elements, verdict, says):
    row = table(rows, elements)[topic]
    assert row.verdict == verdict
    assert says in row.found
