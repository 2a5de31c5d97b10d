"""Linear systems driven by an acceleration, solved exactly between samples.

x' = A x + b u, y = c x + d u. Where u is linear between samples (first-order hold, "ramp-invariant"), the
state at the samples follows exactly, whatever the step:

    x_(n+1) = Phi x_n + Gamma_1 u_n + Gamma_2 (u_(n+1) - u_n)

with Phi, Gamma_1, Gamma_2 in the first row of exp [[A h, b h, 0], [0, 0, 1], [0, 0, 0]] (Van Loan 1978). With
z_n = x_n - Gamma_2 u_n it reads z_(n+1) = Phi z_n + g u_n, y_n = c z_n + (d + c Gamma_2) u_n.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

BLOCK = 256  # samples of one product. Chosen: longer blocks cost products, shorter ones loops; Phi's power takes eight
GROUP = 4  # blocks of one product: few enough for one thread; waking those of the library doubles processor time


class LinearSystem(NamedTuple):
    """A system x' = A x + b u, y = c x + d u with one input and one output.

    Attributes
    ----------
    A : ndarray
        Square, 1/s.
    b, c : ndarray
        One entry a state.
    d : float
        Direct feedthrough from the input to the output.
    """

    A: Array
    b: Array
    c: Array
    d: float


IDENTITY = LinearSystem(np.zeros((0, 0)), np.zeros(0), np.zeros(0), 1.0)  # output is input: what nothing lies between


def seismic(resonance: float, quality: float) -> LinearSystem:
    """Return the mass on a spring inside an accelerometer: y'' + (w/Q) y' + w^2 y = w^2 a, w = 2 pi f.

    y is the reading, f the resonance (Hz) and Q its quality, the magnification at resonance. An infinite
    resonance reads a itself.
    """
    if not resonance > 0.0 or not quality > 0.0:
        raise ValueError(f"resonance and quality must be above zero, got {resonance!r} Hz and {quality!r}")
    if math.isinf(resonance):
        return IDENTITY
    w = 2.0 * math.pi * resonance
    return LinearSystem(np.array([[0.0, w], [-w, -w / quality]]), np.array([0.0, w]), np.array([1.0, 0.0]), 0.0)


def series(first: LinearSystem, second: LinearSystem) -> LinearSystem:
    """Return the system in which the output of the first drives the second.

    Examples
    --------
    >>> series(IDENTITY, seismic(1e5, 10.0)).c
    array([1., 0.])
    """
    A = np.block([[first.A, np.zeros((first.b.size, second.b.size))], [np.outer(second.b, first.c), second.A]])
    b = np.concatenate([first.b, second.b * first.d])
    return LinearSystem(A, b, np.concatenate([second.d * first.c, second.c]), second.d * first.d)


class Recursion(NamedTuple):
    """A linear system at one step, ready to answer histories; made by `ramp_invariant`.

    Attributes
    ----------
    first : ndarray
        State before the first sample, per unit of the first input: the system is at rest.
    onward : ndarray
        Phi to the power of the block.
    gather, watch, through : ndarray
        Inputs of a block to the state after it; state before a block to its outputs; inputs of a block to its
        outputs.
    """

    first: Array
    onward: Array
    gather: Array
    watch: Array
    through: Array

    def run(self, values: Array) -> Array:
        """Return the output for inputs from rest."""
        size, states = values.size, self.first.size
        if states == 0:
            return self.through[0, 0] * values
        groups = -(-size // (GROUP * BLOCK))
        inputs = np.zeros((groups, GROUP, BLOCK))
        inputs.ravel()[:size] = values
        kicks = (inputs @ self.gather.T).reshape(-1, states)
        state = self.first * values[0]
        before = np.empty(kicks.shape)
        for k, kick in enumerate(kicks):
            before[k] = state
            state = self.onward @ state + kick
        outputs = before.reshape(groups, GROUP, states) @ self.watch.T + inputs @ self.through.T
        return np.asarray(outputs).ravel()[:size]


def ramp_invariant(system: LinearSystem, step: float) -> Recursion:
    """Return the recursion that is exact for an input linear between samples.

    Samples go in blocks: powers of Phi carry the state over a block, and one product of matrices answers all
    samples. No eigenvalue is sought, so that critical damping needs no care.
    Source: Van Loan 1978 for the exponential; first-order hold as in Smallwood 1981.

    Parameters
    ----------
    system : LinearSystem
        With A passive or damped, so that powers of Phi stay bounded.
    step : float
        Time between samples, s; it may exceed the shortest period of the system.
    """
    if not 0.0 < step < math.inf:
        raise ValueError(f"the step must be above zero and finite, got {step!r}")
    from scipy import linalg

    states = system.b.size
    block = np.zeros((states + 2, states + 2))
    block[:states, :states] = system.A * step
    block[:states, states] = system.b * step
    block[states, states + 1] = 1.0
    solved = linalg.expm(block)
    phi, gamma1, gamma2 = solved[:states, :states], solved[:states, states], solved[:states, states + 1]
    drive, watch = np.empty((BLOCK, states)), np.empty((BLOCK, states))
    drive[0], watch[0] = gamma1 - gamma2 + phi @ gamma2, system.c
    for k in range(1, BLOCK):
        drive[k], watch[k] = phi @ drive[k - 1], watch[k - 1] @ phi
    pulse = np.append(system.d + system.c @ gamma2, drive[:-1] @ system.c)
    through = linalg.toeplitz(pulse, np.zeros(BLOCK))
    onward = np.linalg.matrix_power(phi, BLOCK)
    return Recursion(-gamma2, onward, np.ascontiguousarray(drive[::-1].T), watch, through)


def respond(system: LinearSystem, values: ArrayLike, step: float) -> Array:
    """Return the output of a system that is at rest before the first sample.

    Parameters
    ----------
    system : LinearSystem
        System that responds.
    values : array_like
        Input at even steps, taken as linear between them.
    step : float
        Time between samples, s.

    Raises
    ------
    ValueError
        If the input is not one finite history.
    """
    return ramp_invariant(system, step).run(history(values))


def history(values: ArrayLike) -> Array:
    """Return values as one finite history, or raise ValueError."""
    array = np.asarray(values, dtype=float)
    if array.ndim != 1 or array.size == 0:
        raise ValueError(f"one history with samples is needed, got shape {array.shape}")
    if not np.all(np.isfinite(array)):
        raise ValueError("the history holds values that are not finite")
    return array
