"""The shortest time in which a load or a joint changes: what a time step must resolve."""

from __future__ import annotations

import math

from strikewave.contact.law import AnyContact, indentation_under
from strikewave.waves.layers import Stack
from strikewave.waves.load import Impactor, Load

RELAXATION_STEPS = 20.0
"""Relaxation times of a joint or an end that 50 steps may cover: one takes 2.5 steps at least."""


def shortest_time(stack: Stack, load: Load) -> float:
    """Return the shortest time, s, that 50 steps must resolve: rise of the load, relaxation of joints and end."""
    times: list[float] = []
    if isinstance(load, Impactor):
        if load.contact is None:
            times.append(load.mass / stack.layers[0].impedance)
        else:
            times.append(_indentation_time(stack, load))
    else:
        times.append(load.rise_time or load.duration)
    z = [layer.impedance for layer in stack.layers]
    slow = []
    for joint, before, after in zip(stack.joints, z, z[1:], strict=False):
        if joint.mass > 0.0:
            slow.append(joint.mass / (before + after))
        elif joint.contact is not None:
            slow.append(_contact_time(joint.contact, before, after, load, z[0]))
        elif joint.attached > 0.0:
            slow.append(math.sqrt(joint.attached / joint.stiffness))
        elif math.isfinite(joint.stiffness):
            slow.append(1.0 / (joint.stiffness * (1.0 / before + 1.0 / after)))
    if stack.end.kind in ("mass", "spring"):
        slow.append(stack.end.value / z[-1] if stack.end.kind == "mass" else z[-1] / stack.end.value)
    if stack.end.kind == "oscillator":
        slow.append(math.sqrt(stack.end.value / stack.end.stiffness))
    return min([*times, *(RELAXATION_STEPS * time for time in slow)])


def _contact_time(contact: AnyContact, before: float, after: float, load: Load, face: float) -> float:
    """Return the time in which waves of the load press a nonlinear contact to their force, s."""
    if isinstance(load, Impactor):
        force = face * load.speed
    else:
        scale = face if load.kind == "speed" else 1.0
        force = scale * load.largest or 1.0
    return indentation_under(contact, force) / force / (1.0 / before + 1.0 / after)


def _indentation_time(stack: Stack, load: Impactor) -> float:
    """Return the time in which the contact force would reach what the bar can take, Z v0, s."""
    assert load.contact is not None
    return indentation_under(load.contact, stack.layers[0].impedance * load.speed) / load.speed
