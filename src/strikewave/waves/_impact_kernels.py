"""Compiled blow of a striker on the first face of a stack: contact law and delay lines, step by step.

With the force F of this step unknown, the striker has the speed u - h F and the face (F - 2 M)/Z + V, so that the
indentation rate is c0 - c1 F: see `strikewave.waves._press_kernels`.
"""

import numpy as np

from strikewave.base.compiled import kernel
from strikewave.contact._law_kernels import depth_at_yield
from strikewave.waves import _press_kernels
from strikewave.waves._kernels import advance, arriving_at_face, force_and_velocity, gather, record, watch, widen
from strikewave.waves._press_kernels import CLOSED, CONTACT_SIZE, COUNT, begin_contact, press


@kernel
def strike(tables, state, law, mass, speed, steps, recordings, averages, extremes, integrals, touches):
    """Let a rigid striker hit the stack at step 0, and follow both for so many steps.

    Fills ``touches`` (begin, end, approach speed of each contact) and returns how many there were, the speed
    of the striker, the impulse on the stack, that on its end, the energy lost in the contact, and the deepest
    indentation.
    """
    dt, z = tables.step, tables.impedance[0]
    histories, norms, contact = np.zeros((4, 4)), np.zeros(3), np.empty(CONTACT_SIZE)
    last = tables.nodes.size - 1
    begin_contact(law, contact, speed, depth_at_yield(law))
    v, entered, through = speed, 0.0, 0.0
    for n in range(steps):
        m = arriving_at_face(tables, state)
        inertia = 0.5 * dt / mass if n > 0 else 0.0
        free = v - inertia * contact[_press_kernels.FORCE]
        force = press(law, contact, touches, n * dt, dt, free + 2.0 * m / z, inertia + 1.0 / z)
        v = free - inertia * force
        f = advance(tables, state, force - m)
        entered += force * dt
        through += f * dt
        for recording in recordings:
            record(tables, state, recording, n)
        gather(tables, state, averages, n)
        widen(tables, state, extremes, n)
        f_end, v_end = force_and_velocity(tables, state, last, tables.nodes[last] - 1)
        ze = tables.impedance[last]
        watch(tables, force - m, m, 0.5 * (f_end + ze * v_end), 0.5 * (f_end - ze * v_end), histories, norms, integrals)
    count = int(contact[COUNT])
    if contact[CLOSED] > 0.0 and count <= touches.shape[0]:
        touches[count - 1, 1] = steps * dt
    return count, v, entered, through, contact[_press_kernels.LOST], contact[_press_kernels.DEEPEST]
