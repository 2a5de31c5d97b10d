"""What is asked of a bar under a load, and what comes out, by either solver."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from strikewave.waves.layers import Stack
from strikewave.waves.load import Load
from strikewave.waves.transit import ErrorBound, TimeGrid

Array = NDArray[np.float64]
STILL = 1e-9
"""Share of F/Z below which a tap stands still: a thousand times the rounding of waves that cancel."""
_TINY = 1e-300
"""Stands for zero below a fraction: where nothing flowed nothing is missing."""
Method = Literal["auto", "delay lines", "spectral"]


@dataclass(frozen=True)
class Tap:
    """Where a stack is watched: layer index and fraction of the layer from its loaded side."""

    layer: int
    position: float


@dataclass(frozen=True)
class WantedError:
    """How exact a run shall be: largest error over the largest value at the taps; or a step, s, that is kept.

    The method is "auto": delay lines, but the spectral solver where a layer loses energy or disperses. ``period`` is
    the shortest period of what listens, as of a sensor, s: what is kept resolves it.
    """

    velocity: float = 1e-3
    acceleration: float = 1e-2
    step: float | None = None
    method: Method = "auto"
    period: float = math.inf


@dataclass(frozen=True)
class BarRun:
    """What a stack did under its load.

    Attributes
    ----------
    stack : Stack
        What ran.
    load : LoadPulse, Sampled or Impactor
        By what it was loaded.
    grid : TimeGrid
        Time step, and the steps of each layer; by the spectral solver no layer is cut into steps.
    time : ndarray
        Times of the samples, s, shape (N,).
    face_force : ndarray
        Force on the first face, N, shape (N,).
    end_force : ndarray
        Force of the stack on its end, N, shape (N,).
    force : ndarray
        At the taps, N, shape (N, taps).
    velocity : ndarray
        At the taps, m/s, shape (N, taps).
    acceleration : ndarray
        At the taps, m/s^2, shape (N, taps). By delay lines it is the average about each sample, as
        `strikewave.waves.averages` says: its integral, from one sample before the first, is the change of velocity.
    mean_push : ndarray
        Force on the first face less that on the end, average about each sample, N, shape (N,).
    hung_acceleration : ndarray
        Of the masses on springs in the order of `Stack.hung`, m/s^2, shape (N, masses): the average force on each
        over it.
    bound : ErrorBound
        Largest error: from rounding the transits, and what half the step changes where springs or masses take
        part; infinite where joints open or a striker comes. By the spectral solver what half the step changes.
        Where all is bonded, that of an acceleration is the error of the average, not what an average takes off a peak.
    places : tuple of (int, float)
        Layer and fraction of each tap.
    duration : float
        How long it was followed, s.
    field_time : ndarray
        Times of the x-t field, s.
    field_position : ndarray
        Its places, m from the first face.
    field_force : ndarray
        Force there, N, shape (times, places).
    field_velocity : ndarray
        Velocity there, m/s, shape (times, places).
    field_layer : ndarray
        Index of the layer of each place.
    field_least : ndarray
        Least force at the places of the field over all steps, N.
    field_greatest : ndarray
        Greatest force there, N.
    face_least : ndarray
        Least force at both faces of each layer, N, shape (layers, 2); NaN where a spectrum of many layers was not
        looked at.
    face_greatest : ndarray
        Greatest force there, N, alike.
    events : ndarray
        Openings and closings of joints: index of the joint, time (s), 1 where it opened; shape (n, 3).
    touches : ndarray
        Contacts with an impactor: begin, end, approach speed; shape (n, 3).
    impulse : float
        Of the load, N s.
    end_impulse : float
        Of the stack on its end, N s.
    momentum : float
        Gained by the stack, N s.
    energy_lost : float
        In the contact with an impactor, J.
    striker_speed : float
        Speed of the impactor at the end, m/s.
    deepest : float
        Its deepest indentation, m.
    """

    stack: Stack
    load: Load
    grid: TimeGrid
    time: Array = field(repr=False)
    face_force: Array = field(repr=False)
    end_force: Array = field(repr=False)
    force: Array = field(repr=False)
    velocity: Array = field(repr=False)
    acceleration: Array = field(repr=False)
    mean_push: Array = field(repr=False)
    hung_acceleration: Array = field(repr=False)
    bound: ErrorBound
    places: tuple[tuple[int, float], ...]
    duration: float
    field_time: Array = field(repr=False)
    field_position: Array = field(repr=False)
    field_force: Array = field(repr=False)
    field_velocity: Array = field(repr=False)
    field_layer: NDArray[np.int64] = field(repr=False)
    field_least: Array = field(repr=False)
    field_greatest: Array = field(repr=False)
    face_least: Array = field(repr=False)
    face_greatest: Array = field(repr=False)
    events: Array = field(repr=False)
    touches: Array = field(repr=False)
    impulse: float
    end_impulse: float
    momentum: float
    energy_lost: float
    striker_speed: float = math.nan
    deepest: float = math.nan

    @property
    def momentum_error(self) -> float:
        """Impulses less momentum, over the impulse of the load or the momentum that the layers came with."""
        moving = sum(abs(layer.mass * layer.speed) for layer in self.stack.layers)
        flowed = max(abs(self.impulse), abs(self.end_impulse), moving, _TINY)
        return abs(self.impulse - self.end_impulse - self.momentum) / flowed

    @property
    def relative_bound(self) -> tuple[float, float]:
        """Bounds of velocity and acceleration over their largest values at the taps.

        Where all taps stand still, as at a rigid end, over those that their forces would give in one wave, F/Z.
        """
        velocity, acceleration = self.velocity, self.acceleration
        if self.force.size and not np.abs(velocity).max() > STILL * np.abs(self.waves).max():
            velocity, acceleration = self.waves, np.gradient(self.waves, self.time, axis=0)
        pairs = ((self.bound.velocity, velocity), (self.bound.acceleration, acceleration))
        largest = [(bound, float(np.abs(values).max(initial=0.0))) for bound, values in pairs]
        over_velocity, over_acceleration = (bound / most if most > 0.0 else math.inf for bound, most in largest)
        return over_velocity, over_acceleration

    @property
    def waves(self) -> Array:
        """F/Z at the taps, m/s, shape (N, taps)."""
        return self.force / np.array([self.stack.layers[layer].impedance for layer, _ in self.places])


def faces_of_hung(stack: Stack) -> list[tuple[int, float]]:
    """Return the places before and behind each mass on a spring between layers: layer, fraction of the layer."""
    return [place for k, _ in stack.hung if k < len(stack.joints) for place in ((k, 1.0), (k + 1, 0.0))]


def hung_acceleration(stack: Stack, faces: Array, end_force: Array) -> Array:
    """Return the accelerations of masses on springs, m/s^2, shape (N, masses).

    ``faces`` are the forces at `faces_of_hung`, shape (N, 2 per mass between layers): what is lost from face to face
    pushes the mass.
    """
    pushes = [faces[:, 2 * k] - faces[:, 2 * k + 1] for k in range(faces.shape[1] // 2)]
    if stack.end.kind == "oscillator":
        pushes.append(end_force)
    columns = [push / mass for push, (_, mass) in zip(pushes, stack.hung, strict=True)]
    return np.column_stack(columns) if columns else np.empty((len(end_force), 0))
