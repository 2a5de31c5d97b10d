"""Compiled blow of a striker on the first face of a stack: contact law and delay lines, step by step.

With the force F of this step unknown, the striker has the speed u - h F and the face (F - 2 M)/Z + V, so the
indentation rate is c0 - c1 F, the indentation follows by the trapezoidal rule, and the contact law is one
equation for F whose right side falls with F: it has one root.
"""

from typing import NamedTuple

import numpy as np

from strikewave.compiled import kernel, leaf_kernel
from strikewave.waves._kernels import advance, arriving_at_face, force_and_velocity, record, watch

_ITERATIONS = 60


class Law(NamedTuple):
    """A contact law F = K d^n (1 + chi d'/v0); an infinite K is a rigid contact."""

    stiffness: float
    exponent: float
    hysteresis_factor: float
    slowest_approach: float


@leaf_kernel
def law_force(law, d, rate, approach):
    """Return the force of the law and its derivatives by d and by the rate; never below zero."""
    if d <= 0.0:
        return 0.0, 0.0, 0.0
    spring = law.stiffness * d**law.exponent
    chi = law.hysteresis_factor / max(approach, law.slowest_approach)
    push = 1.0 + chi * rate
    if push <= 0.0:
        return 0.0, 0.0, 0.0
    return spring * push, law.exponent * spring / d * push, spring * chi


@leaf_kernel
def contact_force(law, d, half, approach, c0, c1, guess):
    """Return F = law(d + half (c0 - c1 F), c0 - c1 F): Newton steps, bisection where they leave the bracket."""
    low, high = 0.0, law_force(law, d + half * c0, c0, approach)[0]
    if high <= 0.0:
        return 0.0
    f = min(max(guess, low), high)
    for _ in range(_ITERATIONS):
        rate = c0 - c1 * f
        pushed, by_depth, by_rate = law_force(law, d + half * rate, rate, approach)
        miss = f - pushed
        if miss > 0.0:
            high = f
        else:
            low = f
        new = f - miss / (1.0 + c1 * (by_depth * half + by_rate))
        if not low < new < high:
            new = 0.5 * (low + high)
        if abs(new - f) <= 1e-14 * high:
            return new
        f = new
    return f


@kernel
def strike(tables, state, law, mass, speed, steps, recordings, integrals, touches):
    """Let a rigid striker hit the stack at step 0, and follow both for so many steps.

    Fills ``touches`` (begin, end, approach speed of each contact) and returns how many there were, the speed
    of the striker, the impulse on the stack, that on its end, and the energy lost in the contact.
    """
    dt, z = tables.step, tables.impedance[0]
    histories, norms = np.zeros((4, 4)), np.zeros(3)
    last = tables.nodes.size - 1
    rigid = law.stiffness == np.inf
    d, rate, force, v, approach = 0.0, speed, 0.0, speed, speed
    count, closed = 0, False
    entered, through, lost, spent = 0.0, 0.0, 0.0, 0.0
    for n in range(steps):
        m = arriving_at_face(tables, state)
        inertia = 0.5 * dt / mass if n > 0 else 0.0
        free = v - inertia * force
        c0, c1 = free + 2.0 * m / z, inertia + 1.0 / z
        moved = 0.5 * dt if n > 0 else 0.0
        was = d
        if rigid:
            force = max((c0 + d / dt) / c1, 0.0)
            rate_new = c0 - c1 * force
            d = min(d + dt * rate_new, 0.0) if n > 0 else 0.0
            touching = force > 0.0
        else:
            ahead = d + moved * rate
            if not closed and ahead + moved * c0 > 0.0:
                approach = max(rate, 0.0)
            force = contact_force(law, ahead, moved, approach, c0, c1, force)
            rate_new = c0 - c1 * force
            d = ahead + moved * rate_new
            touching = d > 0.0 or n == 0
        if touching and not closed:
            if count < touches.shape[0]:
                touches[count, 0] = n * dt - (dt * d / (d - was) if d > was else 0.0)
                touches[count, 1] = steps * dt
                touches[count, 2] = rate
            count += 1
        if closed and not touching and count <= touches.shape[0]:
            touches[count - 1, 1] = n * dt - (dt * d / (d - was) if d < was else 0.0)
        closed = touching
        v = free - inertia * force
        rate = rate_new
        if not rigid and d > 0.0:
            power = (force - law.stiffness * d**law.exponent) * rate
            lost += 0.5 * dt * (power + spent)
            spent = power
        f = advance(tables, state, force - m)
        entered += force * dt
        through += f * dt
        for recording in recordings:
            record(tables, state, recording, n)
        f_end, v_end = force_and_velocity(tables, state, last, tables.nodes[last] - 1)
        ze = tables.impedance[last]
        watch(tables, force - m, m, 0.5 * (f_end + ze * v_end), 0.5 * (f_end - ze * v_end), histories, norms, integrals)
    return count, v, entered, through, lost
