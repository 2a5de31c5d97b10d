"""Chains of bodies look alike to other observers: one behind a mirror, one that moves along, one with another clock."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from strikewave.contact import Chain, ChainContact, Contact, Spring, simulate

from ..random_cases import chains

TIMES = np.linspace(0.0, 5e-4, 6)
"""When they are compared, s: some contacts long; soon after, every rounding has grown by each contact."""


def compared(one, other):
    """The integrator takes other steps of 1e-11 of the scale each; contacts make some ten times that of them."""
    largest = max(np.abs(one).max(), 1e-12)
    assert other == pytest.approx(one, abs=1e-7 * largest)


@settings(max_examples=6)
@given(drawn=chains())
def test_a_chain_behind_a_mirror_moves_mirrored(drawn):
    chain, speeds = drawn
    turned = []
    for link in chain.links:
        if isinstance(link, Spring):
            turned.append(Spring(link.ahead, link.behind, link.stiffness, link.damping))
        else:
            turned.append(ChainContact(link.ahead, link.behind, link.contact, slowest_approach=link.slowest_approach))
    bodies = dict(reversed(chain.bodies.items()))
    motion = simulate(chain, {}, speeds, TIMES[-1], 1e-11)
    mirrored = simulate(Chain(bodies, links=turned), {}, {k: -v for k, v in speeds.items()}, TIMES[-1], 1e-11)
    compared(motion.speeds(TIMES), -mirrored.speeds(TIMES)[:, ::-1])
    compared(motion.positions(TIMES), -mirrored.positions(TIMES)[:, ::-1])


@settings(max_examples=6)
@given(drawn=chains(), drift=st.floats(-20.0, 20.0))
def test_a_moving_observer_sees_the_same_forces(drawn, drift):
    chain, speeds = drawn
    motion = simulate(chain, {}, speeds, TIMES[-1], 1e-11)
    other = simulate(chain, {}, {name: speed + drift for name, speed in speeds.items()}, TIMES[-1], 1e-11)
    fastest = 1.0 + abs(drift)
    assert other.speeds(TIMES) - drift == pytest.approx(motion.speeds(TIMES), abs=1e-7 * fastest)


@settings(max_examples=6)
@given(drawn=chains(), mass=st.floats(0.1, 10.0), length=st.floats(0.1, 10.0), time=st.floats(0.1, 10.0))
def test_a_chain_on_another_scale_moves_alike(drawn, mass, length, time):
    """Masses, lengths and times by any factors: each constant by the powers of its dimension, N/m^n that of K."""
    chain, speeds = drawn
    links = []
    for link in chain.links:
        if isinstance(link, Spring):
            stiffness, damping = link.stiffness * mass / time**2, link.damping * mass / time
            links.append(Spring(link.behind, link.ahead, stiffness, damping))
        else:
            law = link.contact
            stiffness = law.stiffness * mass * length ** (1.0 - law.exponent) / time**2
            contact = Contact(stiffness, law.exponent, law.hysteresis_factor)
            slowest = link.slowest_approach * length / time
            links.append(ChainContact(link.behind, link.ahead, contact, slowest_approach=slowest))
    bodies = {name: kg * mass for name, kg in chain.bodies.items()}
    other = Chain(bodies, links=links)
    motion = simulate(chain, {}, speeds, TIMES[-1], 1e-11)
    scaled = {name: speed * length / time for name, speed in speeds.items()}
    grown = simulate(other, {}, scaled, TIMES[-1] * time, 1e-11)
    compared(motion.speeds(TIMES), grown.speeds(TIMES * time) * time / length)
