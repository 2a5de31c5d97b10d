"""Balls and cylinders against Hertz (Johnson 1985, Contact Mechanics, ch. 4 and 11.4)."""

import math
from dataclasses import replace

import numpy as np
import pytest

from strikewave.fem.solids import Elastic
from strikewave.fem.solve import RunOptions, solve

from .bodies import THICK, Ball, Roller, ball_on_base, roller_on_block
from .test_bars import tensors


def peak_of(time, values):
    """Largest value, by a parabola through the samples around it."""
    k = int(values.argmax())
    c, b, a = np.polynomial.polynomial.polyfit(time[k - 2 : k + 3] - time[k], values[k - 2 : k + 3], 2)
    return c - b * b / (4.0 * a)


def struck(case, **options):
    """Run, whole peak force, indentation and time of contact by the force."""
    run = solve(ball_on_base(case, **options))
    axis = np.array([0.0, -math.sin(case.angle), math.cos(case.angle)])
    force = 4.0 * run.force["ball.round-base.top"] @ axis
    deepest = -float((run.parts["ball"].displacement @ axis).min())
    return run, peak_of(run.time, force), deepest


def assert_balanced(run):
    assert not run.stopped
    assert abs(run.energy_error).max() < 1e-5
    assert run.energy["contact"].min() > -0.01 * run.initial_energy
    assert run.energy["hourglass"].max() < 0.05 * run.energy["internal"].max()
    assert run.momentum_error < 1e-9


@pytest.mark.verify
def test_steel_ball_of_10_mm_at_1_m_s_strikes_with_1744_n_and_goes_in_by_23_um():
    """Johnson's 1744 N, 23.5 um to 2 % with elements of 0.2 mm (contact radius 0.485 mm), half-space cut at 20 mm."""
    case = Ball(size=2e-4)
    force, deepest, _ = case.hertz
    assert force == pytest.approx(1744.0, rel=1e-3)
    assert deepest == pytest.approx(23.5e-6, rel=5e-3)
    run, peak, indentation = struck(case, reach=20.0)
    assert peak == pytest.approx(force, rel=0.02)
    assert indentation == pytest.approx(deepest, rel=0.02)
    assert_balanced(run)


def pressed(case):
    """Root mean square error of sigma_zz below the contact, as a share of p0, at the instant of the largest force.

    The exact stress on the axis is -p0 / sqrt(1 + (z/a)^2) (McEwen 1949; Johnson 4.46), a and p0 those of the force
    that the run has.
    """
    model = roller_on_block(case)
    run = solve(model, RunOptions(frames=25))
    assert_balanced(run)
    up = case.turn[:, 2]
    force = 2.0 * (run.force["roller.round-ground.z+"] @ up) / THICK
    k = int(force.argmax())
    assert 0 < k < len(force) - 1
    half_width, p0 = case.half_width(force[k])
    depth, stress = below(model, run, k, case)
    exact = -p0 / np.sqrt(1.0 + (depth / half_width) ** 2)
    return float(np.sqrt(np.mean((stress - exact) ** 2))) / p0


def below(model, run, instant, case):
    """Depth and normal stress of the elements of the ground next to the plane of symmetry, to 0.15 radii."""
    frame = min(run.frames, key=lambda f: abs(f.time - run.time[instant]))
    assert frame.time == pytest.approx(run.time[instant])
    chosen, up = model.mesh.elements_of("ground"), case.turn[:, 2]
    middle = model.mesh.points[model.mesh.hexahedra[chosen]].mean(axis=1) @ case.turn
    near = (middle[:, 0] < 1.01 * middle[:, 0].min()) & (middle[:, 2] > -0.15 * case.radius)
    return -middle[near, 2], np.einsum("i,nij,j->n", up, tensors(frame.stress[chosen][near]), up)


@pytest.mark.verify
def test_line_contact_has_the_stress_of_mcewen_below_it_with_rate_2():
    """The stress of a one-point element is that of its middle, and a linear field is exact: second order."""
    errors = [pressed(Roller(size)) for size in (2e-4, 1e-4, 5e-5)]
    rates = np.log2(np.array(errors[:-1]) / errors[1:])
    assert errors[-1] < 0.01
    assert rates.min() > 1.6, f"errors {errors}, rates {rates}"


ALUMINIUM = Elastic(2780.0, 72e9, 0.33)
ROLLERS = [
    Roller(radius=0.03, size=3e-4),
    Roller(speed=8.0),
    Roller(base=ALUMINIUM),
    Roller(solid=ALUMINIUM),
    Roller(angle=math.radians(30.0)),
]


@pytest.mark.verify
@pytest.mark.parametrize("case", ROLLERS)
def test_line_contact_of_other_radii_speeds_moduli_and_angles(case):
    """3 % of p0 with four or more elements in the contact, as in the case above."""
    assert pressed(case) < 0.03


OTHERS = [
    Ball(radius=0.02, size=4e-4),
    Ball(speed=4.0, size=3e-4),
    Ball(base=ALUMINIUM, size=3e-4),
    Ball(solid=ALUMINIUM),
    Ball(angle=math.radians(30.0)),
]


@pytest.mark.verify
@pytest.mark.parametrize("case", OTHERS)
def test_other_balls_speeds_moduli_and_angles(case):
    """Peak force and indentation of Hertz to 2 % for another radius, speed, ratio of moduli, and a turned mesh.

    Of the rest, waves take some: Hunter 1957 gives 1 to 2 % of the energy of these blows.
    """
    run, peak, indentation = struck(case, reach=40.0, threads=1)
    force, deepest, _ = case.hertz
    assert peak == pytest.approx(force, rel=0.02)
    assert indentation == pytest.approx(deepest, rel=0.03)
    assert_balanced(run)


@pytest.mark.verify
def test_ball_converges_to_hertz():
    """Indentation on meshes of 0.4, 0.28, 0.2 mm: within 1 % on the finest, at a rate above 1.

    The peak force is within 1 % on each: it hardly feels the size.
    """
    case = Ball()
    force, deepest, _ = case.hertz
    errors = []
    for size in (4e-4, 2.8e-4, 2e-4):
        run, peak, indentation = struck(replace(case, size=size), reach=40.0, threads=1)
        errors.append(abs(indentation / deepest - 1.0))
        assert peak == pytest.approx(force, rel=0.01)
        assert_balanced(run)
    assert errors[-1] < 0.01
    assert math.log2(errors[0] / errors[-1]) > 1.0, f"errors {errors}"
