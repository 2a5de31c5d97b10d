"""Loads on the first face of a stack, and the shortest time in which a load or a joint changes."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from strikewave.base.errors import nearest
from strikewave.contact.law import AnyContact, indentation_under
from strikewave.waves.layers import Stack

Array = NDArray[np.float64]

Prescribed = Literal["force", "speed", "incident"]
PRESCRIBED: tuple[Prescribed, ...] = ("force", "speed", "incident")
"""Quantities that a load prescribes at the first face, by their numbers in the kernels."""
SHAPES = ("half-sine", "sine-squared", "rectangle", "triangle", "trapezoid")
"""Shapes of a force pulse; the table of `LoadPulse` holds their equations."""
LOW, HIGH = 0.1, 0.9
"""Shares of the peak of a rise time, by the field's definition; a history that begins or ends above the lower one jumps
there."""


@dataclass(frozen=True)
class LoadPulse:
    """A force pulse of a named shape: 0 before time 0 and after its duration T, peak F0 between.

    ====================  =============================================================
    half-sine             F0 sin(pi t/T)
    sine-squared          F0 sin^2(pi t/T)
    rectangle             F0
    triangle              rises to F0 at ``rise`` (T/2), falls to 0 at T
    trapezoid             rises to F0 in ``rise`` (T/4), stays, falls in the same time
    ====================  =============================================================
    """

    shape: str
    """One of `SHAPES`."""
    peak: float
    """F0, N."""
    duration: float
    """T, s."""
    rise: float = 0.0
    """Rise time of triangle and trapezoid, s."""
    kind: Prescribed = "force"
    """"force" on the first face; "incident": the wave that comes along an endless bar like the first layer, N."""

    def __post_init__(self) -> None:
        if self.shape not in SHAPES:
            raise ValueError(f"unknown shape {self.shape!r}; {nearest(self.shape, SHAPES)}")
        if not 0.0 < self.duration < math.inf or not math.isfinite(self.peak):
            raise ValueError(f"a pulse needs a finite peak and a duration above zero, got {self}")
        if self.shape in ("triangle", "trapezoid"):
            most = self.duration if self.shape == "triangle" else 0.5 * self.duration
            if self.rise == 0.0:
                object.__setattr__(self, "rise", self.duration / (2.0 if self.shape == "triangle" else 4.0))
            if not 0.0 < self.rise <= most:
                raise ValueError(f"the rise must be above zero and at most {most:g} s, got {self.rise:g} s")

    def at(self, time: Array) -> Array:
        """Return the force at times, N."""
        t, end = np.asarray(time, dtype=float), self.duration
        x = np.pi * t / end
        if self.shape == "half-sine":
            force = np.sin(x)
        elif self.shape == "sine-squared":
            force = np.sin(x) ** 2
        elif self.shape == "rectangle":
            force = np.ones_like(t)
        else:
            fall = end - self.rise
            corners, heights = [0.0, self.rise, fall, end], [0.0, 1.0, 1.0, 0.0]
            if self.shape == "triangle":
                corners, heights = [0.0, self.rise, end], [0.0, 1.0, 0.0]
            force = np.interp(t, corners, heights)
        return np.where((t >= 0.0) & (t < end), self.peak * force, 0.0)

    @property
    def largest(self) -> float:
        """Largest magnitude, N."""
        return abs(self.peak)

    @property
    def steepest_time(self) -> float:
        """Largest magnitude over the largest slope, s; jumps do not count."""
        if self.shape == "rectangle":
            return self.duration
        if self.shape in ("half-sine", "sine-squared"):
            return self.duration / math.pi
        fall = self.duration - self.rise if self.shape == "triangle" else self.rise
        return min(self.rise, fall or self.rise)

    @property
    def impulse(self) -> float:
        """Integral of the force, N s."""
        share = {
            "half-sine": 2.0 / math.pi,
            "sine-squared": 0.5,
            "rectangle": 1.0,
            "triangle": 0.5,
            "trapezoid": 1.0 - self.rise / self.duration,
        }[self.shape]
        return self.peak * self.duration * share

    @property
    def rise_time(self) -> float:
        """Time from 10 to 90 % of the peak, s; 0 for a jump."""
        if self.shape == "rectangle":
            return 0.0
        if self.shape == "half-sine":
            return self.duration * (math.asin(HIGH) - math.asin(LOW)) / math.pi
        if self.shape == "sine-squared":
            return self.duration * (math.asin(math.sqrt(HIGH)) - math.asin(math.sqrt(LOW))) / math.pi
        return (HIGH - LOW) * self.rise


@dataclass(frozen=True)
class Sampled:
    """A measured load: force (N), speed of the face (m/s) or incident wave (N) at times, straight between.

    Times are shifted so that the first is 0. After the last one the force is 0, and the face keeps its speed. ``told``
    is false where the file did not name its unit.
    """

    time: Array = field(repr=False)
    values: Array = field(repr=False)
    kind: Prescribed = "force"
    told: bool = True

    def __post_init__(self) -> None:
        t, f = np.asarray(self.time, dtype=float), np.asarray(self.values, dtype=float)
        if t.ndim != 1 or t.shape != f.shape or t.size < 2:
            raise ValueError(f"a load needs at least two times and as many values, got {t.shape} and {f.shape}")
        if not (np.all(np.isfinite(t)) and np.all(np.isfinite(f)) and np.all(np.diff(t) > 0.0)):
            raise ValueError("the times of a load must rise, and all its values be finite")
        object.__setattr__(self, "time", t - t[0])
        object.__setattr__(self, "values", f)

    def at(self, time: Array) -> Array:
        """Return the load at times."""
        after = float(self.values[-1]) if self.kind == "speed" else 0.0
        return np.interp(time, self.time, self.values, left=0.0, right=after)

    @property
    def largest(self) -> float:
        """Largest magnitude, in the unit of the values."""
        return float(np.abs(self.values).max())

    @property
    def duration(self) -> float:
        """Time of the last sample, s."""
        return float(self.time[-1])

    @property
    def steepest_time(self) -> float:
        """Largest magnitude over the largest slope, s."""
        slope = float(np.abs(np.diff(self.values) / np.diff(self.time)).max())
        return min(self.largest / slope, self.duration) if slope > 0.0 else self.duration

    @property
    def rise_time(self) -> float:
        """Time from 10 to 90 % of the largest value, s; 0 where it begins or ends with a jump."""
        peak = int(np.argmax(np.abs(self.values)))
        share = np.abs(self.values[: peak + 1]) / abs(self.values[peak]) if self.values[peak] else np.ones(1)
        ends = abs(self.values[-1]) > LOW * abs(self.values[peak]) and self.kind != "speed"
        if share[0] > LOW or ends:
            return 0.0
        low, high = (int(np.flatnonzero(share >= level)[0]) for level in (LOW, HIGH))

        def place(k: int, level: float) -> float:
            part = (level - share[k - 1]) / (share[k] - share[k - 1])
            return float(self.time[k - 1] + part * (self.time[k] - self.time[k - 1]))

        return place(high, HIGH) - place(low, LOW)


@dataclass(frozen=True)
class Impactor:
    """A rigid striker that hits the first face by a contact law; it may come back and touch again."""

    mass: float
    """kg."""
    speed: float
    """Speed towards the face, m/s."""
    contact: AnyContact | None = None
    """Law of the contact; None for a rigid one, where striker and face move together while they push."""
    slowest_approach: float = 1e-6
    """Lowest approach speed that the hysteresis factor uses, m/s."""

    def __post_init__(self) -> None:
        if not (0.0 < self.mass < math.inf and 0.0 < self.speed < math.inf):
            raise ValueError(f"an impactor needs a mass and a speed above zero, got {self}")


Load = LoadPulse | Sampled | Impactor


MOST_SAMPLES = 4e6  # 160 MB with force, velocity and the sums of an acceleration
"""Most samples of all taps."""
FEWEST_STEPS = 2.0  # a shorter one would fall between two samples
"""Fewest steps of a load, and of a run."""
RELAXATION_STEPS = 20.0  # one takes 2.5 steps at least
"""Relaxation times of a joint or an end that 50 steps may cover."""


def load_time(load: LoadPulse | Sampled) -> float:
    """Return the time in which a prescribed load changes most, s."""
    return min(load.rise_time or load.duration, load.steepest_time)


def refuse_coarse(load: LoadPulse | Sampled, step: float) -> None:
    """Refuse a step that is too long for the load."""
    if load.duration < FEWEST_STEPS * step and load.largest > 0.0:
        raise ValueError(
            f"a step of {step:g} s is too long for a load of {load.duration:g} s: take one below "
            f"{load.duration / FEWEST_STEPS:.3g} s"
        )


def refuse_few_steps(step: float, duration: float) -> None:
    """Refuse a step that leaves hardly a sample of the run."""
    if step * FEWEST_STEPS > duration:
        raise ValueError(
            f"a step of {step:g} s is too long to follow {duration:g} s: take one below {duration / FEWEST_STEPS:g} s"
        )


def refuse_samples(duration: float, step: float, taps: int, advice: str) -> None:
    """Refuse histories with too many samples for the memory."""
    if duration / step * taps > MOST_SAMPLES:
        raise ValueError(
            f"{duration:g} s at one sample every {step:.3g} s make {duration / step * taps:.1e} samples at {taps} "
            f"taps; at most {MOST_SAMPLES:.0e}: {advice}"
        )


def resolved_period(period: float, duration: float, taps: int, steps: float) -> float:
    """Return the period of a sensor, s, or the shortest one of which so many steps leave `MOST_SAMPLES` at most."""
    return max(period, steps * duration * taps / MOST_SAMPLES)


def shortest_time(stack: Stack, load: Load) -> float:
    """Return the shortest time, s, that 50 steps must resolve: rise of the load, relaxation of joints and end."""
    times: list[float] = []
    if isinstance(load, Impactor):
        z0 = stack.layers[0].impedance
        if load.contact is None:
            times.append(load.mass / z0)
        else:  # the force reaches at most what the bar can take, Z v0
            times.append(indentation_under(load.contact, z0 * load.speed) / load.speed)
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
