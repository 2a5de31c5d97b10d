"""Machines that are alike strike alike: in other units, on another scale; and what a run keeps belongs together."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from strikewave import load_case
from strikewave.analyses.machine.build import build_machine
from strikewave.machines import blows, run_machine

from ...random_cases import KINDS, changed, on_scale, other_units

LAUNCHED = sorted(kind for kind in KINDS if kind != "rotary")
FALLING = ("amplifier", "drop", "dual-mass-amplifier")
POWERS = {
    "time": (0, 0, 1),
    "approach_speed": (0, 1, -1),
    "rebound_speed": (0, 1, -1),
    "blow_velocity_change": (0, 1, -1),
    "contact_impulse": (1, 1, -1),
    "indentation": (0, 1, 0),
    "duration": (0, 0, 1),
}
"""What is compared of a blow, with its powers of mass, length and time: all that is integrated, nothing sampled."""


def measured(case, tolerance=1e-10):
    """Return run and, blow by blow, what `POWERS` names; the time of a launched machine from its release."""
    run = run_machine(build_machine(case), tolerance)
    launch, rows, table = run.machine.launch, [], run.contacts()
    for blow in blows(run):
        begin, end = table[np.searchsorted(table[:, 0], blow.time - 1e-12), :2]
        row = {key: getattr(blow, key) for key in POWERS if key != "duration"}
        time = blow.time if launch is None else launch.travel
        rows.append({**row, "time": time, "duration": end - begin})
    return run, rows


def assert_alike(first, second, scale=(1.0, 1.0, 1.0), rel=1e-6):
    """Blows are the same but for the scale; 1e-6: ten thousand times the tolerance of a step.

    A speed after a blow is the difference of two that may be fifty times larger, so that its error is a share of these.
    """
    assert len(first) == len(second)
    for one, other in zip(first, second, strict=True):
        for key, powers in POWERS.items():
            factor = math.prod(s**p for s, p in zip(scale, powers, strict=True))
            size = rel * abs(one["approach_speed"]) * factor if key == "rebound_speed" else 0.0
            assert other[key] == pytest.approx(one[key] * factor, rel=rel, abs=size), key


@pytest.mark.parametrize("kind", sorted(KINDS))
@settings(max_examples=2)
@given(data=st.data())
def test_units_change_no_blow(kind, data):
    """To 1e-9: the last digit of a unit's factor makes other steps, at 1e-12 each, and contacts a hundred times that."""
    changes = data.draw(changed(KINDS[kind]))
    case = load_case(KINDS[kind], changes)
    again = load_case(KINDS[kind], [*changes, *data.draw(other_units(case))])
    assert_alike(measured(case, 1e-12)[1], measured(again, 1e-12)[1], rel=1e-9)


@pytest.mark.parametrize("kind", ["gas-gun", "rotary"])
@settings(max_examples=3)
@given(size=st.floats(0.2, 5.0), data=st.data())
def test_a_machine_of_the_same_materials_and_shape_strikes_as_fast_and_as_much_longer(kind, size, data):
    """Cauchy's similarity: lengths and times by s, masses by s^3; moduli and densities, speeds and stresses stay.

    Gravity, typed in the case, goes by 1/s. All contact laws of materials keep it; so do damping by restitution, frame,
    mount, feed and drive.
    """
    changes = data.draw(changed(KINDS[kind]))
    case = load_case(KINDS[kind], changes)
    scale = size**3, size, size
    model = load_case(KINDS[kind], [*changes, *on_scale(case, *scale)])
    assert_alike(measured(case)[1], measured(model)[1], scale)


@pytest.mark.parametrize("kind", ["drop", "pendulum", "dual-mass-amplifier"])
@settings(max_examples=4)
@given(mass=st.floats(0.1, 10.0), time=st.floats(0.3, 3.0), data=st.data())
def test_machines_that_fall_are_alike_where_lengths_go_as_squares_of_times(kind, mass, time, data):
    """Froude's similarity, by gravity that stays: masses by any factor, with the contact given by a point of its curve.

    An amplifier's released energy and the time of its fall go along.
    """
    changes = data.draw(changed(KINDS[kind]))
    case = load_case(KINDS[kind], changes)
    scale = mass, time**2, time
    model = load_case(KINDS[kind], [*changes, *on_scale(case, *scale)])
    assert_alike(measured(case)[1], measured(model)[1], scale)


@pytest.mark.parametrize("kind", LAUNCHED)
def test_the_limit_of_no_loss_is_continuous(kind):
    """A tenth of the loss changes a tenth as much, down to e = 1; so the restitution asked for, e, does what it says."""
    found = [measured(load_case(KINDS[kind], [f"contact.restitution={1.0 - d!r}"]))[1][0] for d in (1e-2, 1e-3, 0.0)]
    for key in ("blow_velocity_change", "contact_impulse"):
        far, near = (abs(row[key] - found[-1][key]) for row in found[:2])
        assert near == pytest.approx(0.1 * far, rel=0.05, abs=1e-9 * found[-1][key]), key


@pytest.mark.parametrize("kind", LAUNCHED)
def test_nothing_is_lost_where_nothing_has_loss(kind):
    """e = 1, frame and mount without damping, nothing that holds the object: what dissipates is nought at any time."""
    changes = ["contact.restitution=1", "object.frame_damping=0 N s/m"]
    case = load_case(KINDS[kind])
    changes += ["striker.mount_damping=0 N s/m"] if case.striker.mount_damping is not None else []
    changes += ["object.damper=0 N s/m"] if case.object.damper is not None else []
    changes += ["contact.yield_pressure=900 GPa"] if case.contact.yield_pressure is not None else []  # never borne
    run, (blow,) = measured(load_case(KINDS[kind], changes))
    lost = run.spans[-1].motion.end.y[run.spans[-1].layout.dissipated]
    whole = 0.5 * run.machine.struck.mass * blow["approach_speed"] ** 2
    # the integrator's tolerance, 1e-10 of the scale of a step, over some hundred steps
    assert np.abs(lost).max() < 1e-8 * whole
    assert run.energy_error < 1e-6


@pytest.mark.parametrize("kind", sorted(KINDS))
@settings(max_examples=2)
@given(data=st.data(), ends=st.tuples(st.floats(0.0, 1.0), st.floats(0.0, 1.0)))
def test_rigid_acceleration_adds_up_to_the_change_of_speed(kind, data, ends):
    """Over any part of a blow: the frame's force over the mass of the assembly, against the integrated speed.

    By the trapezoidal rule at 50 ns: the frame rings with some 10 us, so it errs by some (w h)^2/12 = 1e-4 of a swing.
    """
    run, (first, *_) = measured(load_case(KINDS[kind], data.draw(changed(KINDS[kind]))))
    touch = run.contacts()[0, 0]
    low, high = sorted(touch - 2e-6 + share * 400e-6 for share in ends)
    time = np.arange(low, high, 50e-9)
    if time.size < 2:
        return
    moments = run.sample(time)
    added = np.trapezoid(moments.rigid_acceleration, dx=50e-9)
    change = moments.assembly_speed[-1] - moments.assembly_speed[0]
    falling = 9.80665 if kind in FALLING else 0.0  # the zero of a sensor that falls
    assert added == pytest.approx(change + falling * (time[-1] - time[0]), abs=1e-4 * first["blow_velocity_change"])
