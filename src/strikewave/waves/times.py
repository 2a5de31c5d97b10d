"""The shortest time in which a load or a joint changes: what a time step must resolve."""

from __future__ import annotations

import math

from strikewave.contact.law import AnyContact, indentation_under
from strikewave.waves.layers import Stack
from strikewave.waves.load import Impactor, Load, LoadPulse, Sampled

MOST_SAMPLES = 4e6
"""Samples of all taps: 160 MB with force, velocity and what an acceleration is made of."""
FEWEST_STEPS = 2.0
"""Steps that a load, and a run, must last: a shorter one would fall between two samples."""
RELAXATION_STEPS = 20.0
"""Relaxation times of a joint or an end that 50 steps may cover: one takes 2.5 steps at least."""


def load_time(load: LoadPulse | Sampled) -> float:
    """Return the time in which a prescribed load changes most, s."""
    return min(load.rise_time or load.duration, load.steepest_time)


def refuse_coarse(load: LoadPulse | Sampled, step: float) -> None:
    """Refuse a step that is too long for the load.

    Raises
    ------
    ValueError
        If so.
    """
    if load.duration < FEWEST_STEPS * step and load.largest > 0.0:
        raise ValueError(
            f"a step of {step:g} s is too long for a load of {load.duration:g} s: take one below "
            f"{load.duration / FEWEST_STEPS:.3g} s"
        )


def refuse_few_steps(step: float, duration: float) -> None:
    """Refuse a step that leaves hardly a sample of the run.

    Raises
    ------
    ValueError
        If so.
    """
    if step * FEWEST_STEPS > duration:
        raise ValueError(
            f"a step of {step:g} s is too long to follow {duration:g} s: take one below {duration / FEWEST_STEPS:g} s"
        )


def refuse_samples(duration: float, step: float, taps: int, advice: str) -> None:
    """Refuse histories that would not fit in memory.

    Raises
    ------
    ValueError
        If there would be too many samples.
    """
    if duration / step * taps > MOST_SAMPLES:
        raise ValueError(
            f"{duration:g} s at one sample every {step:.3g} s make {duration / step * taps:.1e} samples at {taps} "
            f"taps; at most {MOST_SAMPLES:.0e}: {advice}"
        )


def resolved_period(period: float, duration: float, taps: int, steps: float) -> float:
    """Return the period of what listens, s, or the shortest one of which so many steps leave `MOST_SAMPLES` at most."""
    return max(period, steps * duration * taps / MOST_SAMPLES)


def shortest_time(stack: Stack, load: Load) -> float:
    """Return the shortest time, s, that 50 steps must resolve: rise of the load, relaxation of joints and end."""
    times: list[float] = []
    if isinstance(load, Impactor):
        if load.contact is None:
            times.append(load.mass / stack.layers[0].impedance)
        else:
            times.append(_indentation_time(stack, load))
    else:
        times.append(load_time(load))
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
