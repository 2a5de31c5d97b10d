"""Where and how fast noses meet the face: blow angle, finite face, strikers with errors of their own."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from strikewave import load_case
from strikewave.analyses.machine.build import build_machine
from strikewave.base.errors import InputError, InputErrors, IntegrationError
from strikewave.machines import blows, run_machine

RIGID = ("striker.mount_stiffness=1e12", "striker.mount_damping=0", "feed.blows=1")
"""Without the mount's stretch a nose runs on the circle itself."""


def machine_of(*changes):
    return build_machine(load_case("li-ma-2019", changes))


@pytest.mark.verify
@settings(max_examples=12)
@given(angle=st.floats(0.0, 90.0), engagement=st.floats(0.2e-3, 4e-3), speed=st.floats(20.0, 90.0))
def test_first_touch_is_where_circle_and_plane_cross(angle, engagement, speed):
    """R (cos(p - a) - cos a) = -q, and the approach speed is w R sin(a - p): the speed of the nose along the blow."""
    a = math.radians(angle)
    across = abs(math.sin(a) - math.sin(math.acos(math.cos(a) - engagement / 0.2)))
    machine = machine_of(
        *RIGID,
        f"machine.blow_angle={angle} deg",
        # no wider than the noses need, or one would meet the object on its way in
        f"machine.face_width={0.2 * 2.1 * across + 1e-3}",
        f"machine.engagement={engagement}",
        f"machine.speed={speed}",
        "machine.strikers=1",
        # the object stands still whenever the striker comes
        "object.stop_restitution=0.1",
        "feed.stroke_time=10 ms",
        "feed.stroke=120 mm",
    )
    run = run_machine(machine)
    first = blows(run)[0]
    radius, a = machine.drive.turntable.radius, machine.drive.blow_angle
    touch = a - math.acos(math.cos(a) - engagement / radius)
    assert machine.drive.first_touch == pytest.approx(touch, abs=1e-15)
    turned = run.sample(np.array([first.time])).turntable_angle[0]
    # the object still rests on a stop that moves by 1e-6 of a metre, and 1e-5 of the speed
    assert turned % (2.0 * math.pi) == pytest.approx(touch % (2.0 * math.pi), abs=2e-3)
    assert first.approach_speed == pytest.approx(first.turntable_speed * radius * math.sin(a - touch), rel=2e-2)
    assert run.energy_error < 1e-6


def test_blow_along_the_path_has_the_speed_of_the_rim():
    machine = machine_of(
        *RIGID,
        "machine.blow_angle=90 deg",
        "machine.face_width=10 mm",
        "feed.stroke=60 mm",
        "machine.engagement=0.1 mm",
        "machine.speed=200 rpm",
        "machine.strikers=1",
    )
    first = blows(run_machine(machine))[0]
    assert machine.nominal_approach == pytest.approx(machine.drive.turntable.speed * 0.2, rel=1e-6)
    assert first.approach_speed == pytest.approx(first.turntable_speed * 0.2, rel=1e-3)


def test_nose_that_pushes_slips_off_the_edge_of_the_face():
    """Along the path a heavy object is pushed until R sin(p - a) + R sin a is half the face; then nothing touches."""
    machine = machine_of(
        "machine.blow_angle=90 deg",
        "machine.face_width=8 mm",
        "feed.stroke=60 mm",
        "machine.engagement=0.1 mm",
        "machine.speed=130 rpm",
        "machine.strikers=1",
        "machine.inertia=200 kg m^2",
        "object.mass=60 kg",
        "object.nose_mass=1 kg",
        "object.preload=200 kN",
        "object.spring=10 MN/m",
        "object.stop_stiffness=1 GN/m",
        "feed.blows=1",
        "contact.restitution=0.1",
    )
    run = run_machine(machine)
    rows = run.contacts()
    angle = run.sample(rows[:, 1]).turntable_angle.max() % (2.0 * math.pi)
    half = 0.5 * machine.drive.face_width / machine.drive.turntable.radius
    assert machine.drive.leaves == pytest.approx(math.acos(1.0 - half), rel=1e-12)
    assert angle == pytest.approx(machine.drive.leaves, abs=1e-9)
    assert run.energy_error < 1e-6
    later = run.sample(np.linspace(rows[:, 1].max() + 1e-6, run.end, 2000))
    assert np.all(later.contact_force == 0.0)


def test_nose_that_comes_behind_the_face_is_named():
    """An object pressed beyond the edge of its narrow face is still away when the next nose comes across it."""
    changes = ["machine.face_width=94 mm", "object.mass=0.459 kg"]
    with pytest.raises(IntegrationError, match="met the edge of the face"):
        run_machine(machine_of(*changes))


def test_face_too_narrow_for_its_cam_is_refused_with_the_width_it_needs():
    """A cam first touches sqrt(2 R q - q^2) from the middle: 46.59 mm here."""
    with pytest.raises(InputErrors, match=r"machine\.face_width: got \"80 mm\"; allowed: more than 93\.18 mm"):
        machine_of("machine.face_width=80 mm")


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ("machine.blow_angle=100 deg", "from 0"),
        ("machine.blow_angle=45 deg", "face_width"),
        ("machine.strikers=80", "overlap"),
    ],
)
def test_impossible_strikes_are_named(change, words):
    with pytest.raises(InputErrors, match=words):
        machine_of(change)


@pytest.mark.parametrize("error", [-0.02, 0.015])
def test_angle_error_moves_one_blow_in_time(error, tmp_path):
    """A striker that stands ahead by d strikes earlier by d/w; the others do not move."""
    base = machine_of("object.stop_restitution=0.05", "machine.inertia=1000 kg m^2", "feed.blows=8")
    text = (tmp_path / "case.toml").write_text  # the row is given in a case file
    from strikewave import dump_case

    text(
        dump_case(load_case("li-ma-2019"))
        + f'\n[[striker.each]]\nnumber = 2\nangle_error = "{error} rad"\nmass = "1.5 kg"\n'
    )
    changes = ["object.stop_restitution=0.05", "machine.inertia=1000 kg m^2", "feed.blows=8"]
    changed = build_machine(load_case(str(tmp_path / "case.toml"), changes))
    assert changed.strikers.each[1].mass == 1.5
    assert changed.strikers.each[0] == base.strikers.each[0]
    plain, moved = blows(run_machine(base)), blows(run_machine(changed))
    for a, b in zip(plain, moved, strict=True):
        expected = -error / a.turntable_speed if b.striker == 2 else 0.0
        # the heavier striker pushes the object farther: it comes back another way by some microseconds
        assert b.time - a.time == pytest.approx(expected, abs=2e-5)


def test_reach_error_is_engagement(tmp_path):
    """All noses 0.4 mm farther out is the face 0.4 mm nearer, on a larger circle."""
    from strikewave import dump_case

    engagement = load_case("li-ma-2019").machine.engagement.si
    rows = "".join(f'\n[[striker.each]]\nnumber = {i}\nreach_error = "0.4 mm"\n' for i in (1, 2, 3, 4))
    (tmp_path / "case.toml").write_text(dump_case(load_case("li-ma-2019", ["feed.blows=3"])) + rows)
    farther = blows(run_machine(build_machine(load_case(str(tmp_path / "case.toml")))))
    nearer = blows(
        run_machine(machine_of("feed.blows=3", "machine.radius=200.4 mm", f"machine.engagement={engagement + 0.4e-3}"))
    )
    for a, b in zip(farther, nearer, strict=True):
        # the object rests 0.4 mm farther out relative to the carriage's stroke: only rounding differs
        assert a.approach_speed == pytest.approx(b.approach_speed, rel=1e-6)
        assert a.rigid_peak == pytest.approx(b.rigid_peak, rel=1e-6)


def test_row_for_a_striker_that_there_is_not_is_named(tmp_path):
    from strikewave import dump_case

    text = dump_case(load_case("li-ma-2019")) + '\n[[striker.each]]\nnumber = 7\nmass = "1 kg"\n'
    (tmp_path / "case.toml").write_text(text)
    with pytest.raises(InputError, match=r"striker\.each\.7\.number.*strikers 1 to 4"):
        build_machine(load_case(str(tmp_path / "case.toml")))


def test_times_of_touch_converge_with_the_tolerance():
    """Each switch is located on dense output of order 7: its error falls as the tolerance of a step does."""
    machine = machine_of("feed.blows=3", "object.friction=30", "object.stiction=45")
    best = run_machine(machine, 1e-11).contacts()[:, 0]
    tolerances = np.array([1e-4, 1e-5, 1e-6, 1e-7, 1e-8])
    errors = []
    for tolerance in tolerances:
        found = run_machine(machine, tolerance).contacts()[:, 0]
        assert found.size == best.size
        errors.append(np.abs(found - best).max())
    rate = np.polyfit(np.log(tolerances), np.log(errors), 1)[0]
    assert 0.8 < rate < 1.3, (rate, errors)
