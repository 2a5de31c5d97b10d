"""Launched machines followed over their rebounds: a bouncing ball in closed form, a brake, the energy balance."""

import math

import numpy as np
import pytest

from strikewave import load_case, run_case
from strikewave.analyses.by_tables import check_case
from strikewave.analyses.machine.build import build_machine
from strikewave.base.errors import InputErrors
from strikewave.machines import blows, run_machine
from strikewave.machines.spans import REST_SHARE

G = 9.80665
BALL, TABLE, ARM = "iso-16063-22-dropball", "jesd22-b111-b", "mil-s-901d-hammer"
BALANCE = 1e-6
"""The stated limit of every balance."""


def bouncing(until, *changes, height=1.0, e=0.7):
    """Return a ball on a face that is next to rigid, too heavy to move, and too hard to yield."""
    stiff = ["object.mass=2000 kg", "object.nose_mass=1000 kg", "object.frame_stiffness=1e12 N/m"]
    stiff += ["object.frame_damping=1e6 N s/m", "contact.slowest_approach=1 mm/s", f"contact.restitution={e}"]
    stiff += ["contact.yield_pressure=900 GPa"]
    stiff += [f"machine.height={height} m", f"machine.until={until}", "solver.output_step=1 ms"]
    return load_case(BALL, [*stiff, *changes])


def followed(case):
    run = run_machine(build_machine(case))
    return run, blows(run)


@pytest.mark.parametrize("e", [0.5, 0.8])
@pytest.mark.parametrize("height", [0.1, 1.0])
def test_a_ball_bounces_as_its_restitution_says(e, height):
    """Speeds v e^n, heights h e^(2n), flights 2 v e^n/g."""
    run, found = followed(bouncing("rest", height=height, e=e))
    v = math.sqrt(2.0 * G * height)
    for n, blow in enumerate(found):
        if v * e**n < 0.15:
            break
        # 1e-3 a bounce: the frame gives way, 1e-4 of the indentation, and is damped; G T: weight over a contact of 200 us
        near = max(1e-3 * (n + 1), G * 2e-4 / (v * e**n))
        assert blow.approach_speed == pytest.approx(v * e**n, rel=near)
        assert blow.approach_speed**2 / (2.0 * G) == pytest.approx(height * e ** (2 * n), rel=2.1 * near)
        assert blow.kind == "full"
        if n + 1 < len(found):
            flight = found[n + 1].time - blow.time
            assert flight == pytest.approx(2.0 * v * e ** (n + 1) / G, rel=1e-3 * (n + 2), abs=2e-4)
    assert run.energy_error < BALANCE


def test_a_ball_rests_when_its_series_of_flights_is_over():
    """From first touch the flights add up to 2 v e/(g (1 - e)), less what is left below the speed of rest."""
    run, found = followed(bouncing("rest", e=0.6))
    v, e = math.sqrt(2.0 * G), 0.6
    assert run.ended == "rest"
    assert dict(run.phases)["rest"] == run.end
    last = found[-1].approach_speed
    assert REST_SHARE * v <= last
    assert last * e <= 1.02 * REST_SHARE * v
    series = 2.0 * v * e / (G * (1.0 - e)) * (1.0 - e ** len(found))
    assert run.end - found[0].time == pytest.approx(series, rel=2e-3)
    assert len(found) == math.floor(math.log(REST_SHARE) / math.log(e)) + 1


@pytest.mark.parametrize("count", [1, 2, 4])
def test_a_brake_leaves_so_many_blows_and_catches_at_the_top(count):
    run, found = followed(bouncing("brake", f"machine.brake_after={count}", e=0.8))
    v, e = math.sqrt(2.0 * G), 0.8
    assert [blow.index for blow in found] == list(range(1, count + 1))
    assert run.ended == "brake"
    # the top lies v e^n/g after the last blow; the contact of 100 us lies between
    assert run.end - found[-1].time == pytest.approx(v * e**count / G, rel=1e-3 * count, abs=2e-4)
    assert run.energy_error < BALANCE


def test_the_energy_that_a_brake_takes_is_booked():
    """At the top striker and object part no further; what the brake takes is their common motion, that of the anvil.

    The anvil, free, has got m (1 + e) v/M: the table goes down as fast when they are farthest apart.
    """
    case = load_case(TABLE, ["machine.until=brake", "contact.restitution=0.6", "solver.output_step=1 ms"])
    machine = build_machine(case)
    run = run_machine(machine)
    (blow,) = blows(run)
    ratio = machine.struck.mass / machine.strikers.mass
    anvil = ratio * blow.blow_velocity_change
    # 2e-3: the weight of the table during the contact
    assert run.braked == pytest.approx(0.5 * machine.struck.mass * anvil**2, rel=5e-3)
    assert run.energy_error < BALANCE


def test_speeds_go_on_where_one_span_meets_the_next():
    run, _ = followed(bouncing("rest", e=0.6))
    for one, other in zip(run.spans, run.spans[1:], strict=False):
        before, after = one.motion.end.y, other.motion.sample(np.array([other.begin]))[0][0]
        assert one.end == other.begin
        assert after == pytest.approx(before, rel=1e-12, abs=1e-15)


def test_an_arm_swings_back():
    run, found = followed(load_case(ARM, ["machine.until=brake", "machine.brake_after=2", "solver.output_step=1 ms"]))
    assert len(found) == 2
    assert run.energy_error < BALANCE


def test_what_never_comes_again_is_followed_to_the_end():
    solution = run_case(load_case("en-166-ball", ["machine.until=rest", "machine.longest=0.1 s"]))
    assert len(solution.blows) == 1
    (notice,) = [notice for notice in solution.notices if notice.code == "follow-ended"]
    assert "machine.longest" in notice.message
    assert dict(solution.phases)["end"] == pytest.approx(0.1, abs=2e-5)


def test_a_run_tells_how_it_ended():
    solution = run_case(bouncing("brake", "machine.brake_after=2"))
    assert not solution.broken
    assert [name for name, _ in solution.phases] == ["release", "blows", "brake", "end"]
    assert "brake" in [notice.code for notice in solution.notices]
    assert "first-blow-only" not in [notice.code for notice in solution.notices]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ("machine.until=never", "'time', 'rest' or 'brake'"),
        ("machine.brake_after=2", 'only with machine.until = "brake"'),
        ("machine.longest=2 s", 'only with machine.until = "rest" or "brake"'),
    ],
)
def test_what_does_not_fit_is_refused(change, words):
    with pytest.raises(InputErrors) as caught:
        check_case(load_case(TABLE, [change]))
    assert words in str(caught.value)
