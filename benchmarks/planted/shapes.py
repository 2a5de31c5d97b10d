"""Shapes of pulses over 0 < u < 1, height 1: more families than any fit knows."""

import functools
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

FINE = np.linspace(0.0, 1.0, 8001)


@dataclass(frozen=True)
class Shape:
    """A family and its parameters."""

    name: str
    parameters: tuple = ()

    def at(self, u):
        """Return the pulse, scaled to a height of 1; zero outside."""
        u = np.asarray(u, dtype=float)
        inside = (u > 0.0) & (u < 1.0)
        return np.where(inside, FAMILIES[self.name][0](np.clip(u, 0.0, 1.0), *self.parameters), 0.0) / self.height

    @functools.cached_property
    def height(self):
        """Largest value before scaling."""
        return float(np.max(FAMILIES[self.name][0](FINE, *self.parameters)))

    @functools.cached_property
    def width(self):
        """Share of the length above 10 % of the peak."""
        high = FINE[self.at(FINE) >= 0.1]
        return float(high[-1] - high[0])

    @functools.cached_property
    def width_error(self):
        """By how much of itself the width changes where noise of 1, over the peak, stands at both its ends."""
        at, slopes = self.at(FINE), np.abs(np.gradient(self.at(FINE), FINE))
        ends = np.flatnonzero(np.diff((at >= 0.1).astype(int)))
        return float(np.sqrt(np.sum(slopes[ends] ** -2.0))) / self.width


def half_sine(u):
    """One arch of a sine."""
    return np.sin(np.pi * u)


def haversine(u):
    """Its square."""
    return np.sin(np.pi * u) ** 2


def versed_sine(u, power):
    """Raise 1 - cos to a power."""
    return (0.5 - 0.5 * np.cos(2.0 * np.pi * u)) ** power


def saw_tooth(u, tip):
    """Straight up to a terminal peak, then a finite fall, a quarter of a cosine to either side of its steepest place."""
    fall = np.clip((u - tip) / (1.0 - tip), 0.0, 1.0)
    return np.where(u < tip, u / tip, 0.5 + 0.5 * np.cos(np.pi * fall))


def leaning(u, power, bend):
    """Bend the time of a sine and raise it to a power: early or late peaks, smooth everywhere."""
    return np.sin(np.pi * u**bend) ** power


def gamma_like(u, order):
    """x^a exp(a (1 - x)): a steep rise and a long tail, faded out over its last tenth."""
    x = 1.0 + 7.0 / np.sqrt(order) + 3.0 / order
    x = u * x
    fade = 0.5 + 0.5 * np.cos(np.pi * np.clip((u - 0.9) / 0.1, 0.0, 1.0))
    return np.where(x > 0.0, np.maximum(x, 1e-300) ** order * np.exp(order * (1.0 - x)), 0.0) * fade


def trapezoid(u, up, down, crown):
    """Nearly flat between two ramps of half a cosine: no real top stands at one value, as that of a clipped record."""
    rise, fall = np.clip(u / up, 0.0, 1.0), np.clip((1.0 - u) / down, 0.0, 1.0)
    top = 1.0 + crown * np.sin(np.pi * u)
    return (0.5 - 0.5 * np.cos(np.pi * rise)) * (0.5 - 0.5 * np.cos(np.pi * fall)) * top


@functools.lru_cache(maxsize=64)
def _contact(damping):
    """Force of a mass on a Hertz spring with a damper that grows with it (Hunt and Crossley), over its contact."""

    def motion(_, y):
        return [y[1], -(max(y[0], 0.0) ** 1.5) * (1.0 + damping * y[1])]

    def apart(_, y):
        return y[0]

    apart.terminal, apart.direction = True, -1
    run = solve_ivp(motion, (0.0, 50.0), [0.0, 1.0], events=apart, rtol=1e-9, atol=1e-12, dense_output=True)
    y = run.sol(np.linspace(0.0, run.t[-1], FINE.size))
    return np.maximum(np.maximum(y[0], 0.0) ** 1.5 * (1.0 + damping * y[1]), 0.0)


def contact(u, damping):
    """Of a contact of two bodies, integrated in time."""
    return np.interp(u, FINE, _contact(damping))


FAMILIES = {
    "half-sine": (half_sine, lambda rng: ()),
    "haversine": (haversine, lambda rng: ()),
    "versed-sine": (versed_sine, lambda rng: (rng.uniform(0.6, 2.5),)),
    "saw-tooth": (saw_tooth, lambda rng: (rng.uniform(0.7, 0.93),)),
    "leaning": (leaning, lambda rng: (rng.uniform(0.9, 2.2), rng.uniform(0.6, 1.6))),
    "gamma-like": (gamma_like, lambda rng: (rng.uniform(1.5, 6.0),)),
    "trapezoid": (trapezoid, lambda rng: (rng.uniform(0.15, 0.4), rng.uniform(0.15, 0.4), rng.uniform(0.02, 0.1))),
    "contact": (contact, lambda rng: (round(rng.uniform(0.0, 0.6), 2),)),
}
"""Each family with how its parameters are drawn."""


def draw_shape(rng, names=tuple(FAMILIES)):
    """Return a random shape."""
    name = str(rng.choice(names))
    return Shape(name, tuple(float(value) for value in FAMILIES[name][1](rng)))
