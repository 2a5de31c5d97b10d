"""Compiled contact law pressed by waves: the force of a step that is not yet known, and what the contact remembers.

With the force F of this step unknown, the indentation rate is c0 - c1 F, the indentation follows by the trapezoidal
rule, and the contact law is one equation for F whose right side falls with F: it has one root.
"""

import numpy as np

from strikewave.base.compiled import leaf_kernel
from strikewave.contact._law_kernels import (
    DAMPER,
    DAMPER_EXPONENT,
    ON_APPROACH,
    STIFFNESS,
    STYLE,
    YIELD_LOAD,
    base_force,
    base_slope,
    damper_force,
    flattening,
    hysteresis,
    residual,
    unyielding,
    unyielding_force,
    yielding,
)

_ITERATIONS, _ROUNDING = 60, 1e-14
"""Newton steps for the force of a time step, and the change over the largest possible force that ends them: some bits
of it. Where the law has a corner, bisection takes over: 60 halvings leave less than rounding."""

DEPTH, RATE, FORCE, APPROACH, CLOSED, POWER, LOST, COUNT, QUIET, DEEPEST, GROWTH = range(11)
"""Places in the state of a contact: d, d', F, v0 of this interval, 1 while it touches, power lost, energy lost,
intervals so far, time since the last one, deepest indentation, and how much the radius has grown by yielding, s."""
CONTACT_SIZE = 11
"""Number of these places."""


@leaf_kernel
def law_force(law, d, rate, approach, deepest, s):
    """Return the force of the law and its derivatives by d and by the rate; never below zero.

    ``law`` is a row of `strikewave.contact._law_kernels`, of a law that never pulls; an infinite stiffness is a
    rigid contact.
    """
    if law[DAMPER] > 0.0:
        return damped_force(law, d, rate)
    if d > deepest and law[YIELD_LOAD] < np.inf:
        spring, slope, _ = yielding(law, d)
    else:
        spring, slope = unyielding(law, d, deepest, s)
    push = hysteresis(law, rate, approach)
    if push <= 0.0 or spring <= 0.0:  # never a pull
        return 0.0, 0.0, 0.0
    return spring * push, slope * push, spring * (hysteresis(law, 1.0, approach) - 1.0)


@leaf_kernel
def damped_force(law, d, rate):
    """Return the force of an elastic law with a damper and its derivatives; where it falls through zero it is lost."""
    force = base_force(law, d) + damper_force(law, d, rate)
    if d < 0.0 or force <= 0.0:
        return 0.0, 0.0, 0.0
    by_rate = damper_force(law, d, 1.0) if rate > 0.0 or law[STYLE] != ON_APPROACH else 0.0
    # a retarded law has no exponent here: without its curvature the steps are shorter, the root is the same
    by_depth = law[DAMPER_EXPONENT] * by_rate * rate / d if d > 0.0 else 0.0
    return force, base_slope(law, d) + by_depth, by_rate


@leaf_kernel
def losses(law, d, rate, force, deepest, s):
    """Return the power that hysteresis takes, W, and the energy that yielding from ``deepest`` to d takes, J."""
    if d <= deepest or law[YIELD_LOAD] == np.inf:
        return (force - unyielding_force(law, d, deepest, s)) * rate, 0.0
    before, _, stored_before = yielding(law, deepest)
    here, _, stored_here = yielding(law, d)
    return (force - here) * rate, 0.5 * (before - stored_before + here - stored_here) * (d - deepest)


@leaf_kernel
def contact_force(law, d, half, approach, deepest, s, c0, c1, guess):
    """Return F = law(d + half (c0 - c1 F), c0 - c1 F): Newton steps, bisection where they leave the bracket."""
    low, high = 0.0, law_force(law, d + half * c0, c0, approach, deepest, s)[0]  # its own push only makes it smaller
    if high <= 0.0:
        return 0.0
    f = min(max(guess, low), high)
    for _ in range(_ITERATIONS):
        rate = c0 - c1 * f
        pushed, by_depth, by_rate = law_force(law, d + half * rate, rate, approach, deepest, s)
        miss = f - pushed
        if miss > 0.0:
            high = f
        else:
            low = f
        new = f - miss / (1.0 + c1 * (by_depth * half + by_rate))
        if not low < new < high:
            new = 0.5 * (low + high)
        if abs(new - f) <= _ROUNDING * high:
            return new
        f = new
    return f


@leaf_kernel
def begin_contact(law, contact, approach, deepest):
    """Set a contact to first touch at an approach speed, after it has yielded to a depth."""
    contact[:] = 0.0
    contact[RATE] = contact[APPROACH] = approach
    contact[DEEPEST], contact[GROWTH] = deepest, flattening(law, deepest)
    contact[DEPTH] = residual(deepest, contact[GROWTH])


@leaf_kernel
def press(law, contact, touches, t, dt, c0, c1):
    """Move a contact on to time t and return its force, N; c0 - c1 F is the indentation rate.

    ``touches`` gets begin, end and approach speed of each interval of contact. The very first step, in which
    nothing has moved yet, counts as touching.
    """
    first = contact[COUNT] == 0.0
    half = 0.0 if first else 0.5 * dt
    was, closed, left = contact[DEPTH], contact[CLOSED] > 0.0, 0.0
    if law[STIFFNESS] == np.inf:
        force = max((c0 + was / dt) / c1, 0.0)  # that which just closes what is left of the gap
        rate = c0 - c1 * force
        d = 0.0 if first else min(was + dt * rate, 0.0)
        touching, power = force > 0.0, 0.0
    else:
        ahead, deepest, s = was + half * contact[RATE], contact[DEEPEST], contact[GROWTH]
        left = residual(deepest, s)
        if not closed and ahead + half * c0 > left:  # it would touch in this step: a new interval, with its own v0
            contact[APPROACH] = max(contact[RATE], 0.0)
        force = contact_force(law, ahead, half, contact[APPROACH], deepest, s, c0, c1, contact[FORCE])
        rate = c0 - c1 * force
        d = ahead + half * rate
        touching = d > left or first
        power, yielded = losses(law, d, rate, force, deepest, s) if d > left else (0.0, 0.0)
        contact[LOST] += yielded
        if d > deepest:
            contact[DEEPEST], contact[GROWTH] = d, flattening(law, d)
    contact[LOST] += half * (power + contact[POWER])
    if touching != closed:
        at = t - (dt * (d - left) / (d - was) if d != was else 0.0)  # straight between the two steps
        if touching:
            contact[COUNT] += 1.0
        k = int(contact[COUNT]) - 1
        if k < touches.shape[0]:
            touches[k, 1] = at
            if touching:
                touches[k, 0], touches[k, 2] = at, contact[RATE]
    contact[DEPTH], contact[RATE], contact[FORCE], contact[POWER] = d, rate, force, power
    contact[CLOSED] = 1.0 if touching else 0.0
    contact[QUIET] = 0.0 if touching else contact[QUIET] + dt
    return force
