"""A stack in the frequency domain, with layers that lose energy, disperse, or are thin; loss in the time domain.

Each frequency is followed through the stack by the reflection recursion, in which all exponentials fall, so that
neither many layers nor thin or lossy ones overflow. The spectrum is taken along s = sigma + i w (exponential window):
a signal that wraps around the end of the period has died to `WRAPPED` of itself, whatever rings on. All joints must be
linear. The load is rounded over one step to either side (weights 1/4, 1/2, 1/4), which keeps jumps from ringing.

A gasket's loss factor (tangent of the loss angle) is a number at a frequency; in the time domain it needs a causal
model, springs and dashpots whose loss factor is constant over a band. The generalised standard linear solid is a spring
beside a few Maxwell branches, and passive for every input because no spring and no dashpot is negative.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

from strikewave.waves._spectral_kernels import SpectralTables, StackPlaces, respond
from strikewave.waves.dispersion import Rod, wave_number
from strikewave.waves.layers import END_KINDS, Branch, Layer, LossFit, Stack
from strikewave.waves.load import PRESCRIBED, Impactor, Load, LoadPulse, Sampled

GOOD_ENOUGH = 0.05  # loss factors of materials are known no better
"""Deviation of the loss factor at which no further branch is added."""
FARTHEST = 0.25  # beyond, it is the loss of another material
"""Largest deviation of the loss factor of a fit."""
MOST_BRANCHES = 4  # four hold a loss factor of 1 over two decades to 5 %, and each costs a state of a joint
"""Most Maxwell branches."""
WIDTHS = np.geomspace(0.3, 2.0, 50)
"""Widths of the relaxation times over that of the band, in logarithms, 4 % apart: the best one is found to 2 %."""
USUAL_BAND = 1e3, 1e5  # chosen: most of a blow of 10 us to 1 ms lies in it
"""Band of a constant loss factor where none is given, Hz."""
LEAST_REST = 1e-3  # a solid without it would creep without end
"""Least share of the storage stiffness that stays for long times."""
POINTS, ROUNDS, SCALE_WEIGHT = 121, 6, 1e4
"""Frequencies of the least squares, 60 a decade in the usual band; rounds, after four of which the storage stiffness in
the weights changes by less than 1e-5 (measured); and weight of the row that sets the scale, whose size does not matter,
since its misfit is divided away (measured, from 100 to a million)."""


def dynamic_stiffness(k: float, branches: tuple[Branch, ...], frequency: ArrayLike) -> NDArray[np.complex128]:
    """Return the complex stiffness of a spring with Maxwell branches, N/m.

    K(w) = k + sum k_i (i w tau_i) / (1 + i w tau_i), with w = 2 pi f, f in Hz, complex where a signal grows or falls,
    k and k_i in N/m and tau_i in s. The real part is the storage stiffness,
    and imaginary over real part the loss factor. Source: Emmerich & Korn 1987 (generalised Maxwell body).
    """
    s = 2j * np.pi * np.asarray(frequency)
    total = np.full(s.shape, complex(k))
    for branch in branches:
        x = s * branch.relaxation
        total += branch.stiffness * x / (1.0 + x)
    return total


def fit_loss(stiffness: float, loss_factor: float, low: float, high: float) -> LossFit:
    """Return the spring and Maxwell branches whose loss factor is constant over a band.

    Relaxation times are spaced evenly in the logarithm, symmetric about the geometric mean of the band; k and
    the k_i follow by non-negative least squares of Im K - eta Re K = 0 over the band, weighted by 1/Re K,
    and the width of the times is the one that leaves the smallest largest deviation. The fewest branches, at
    most 4, that hold the loss factor to 5 % are taken, or else the best. Two decades need three branches up
    to a loss factor of 0.25 and four up to 1. Outside the band the loss falls off as it must in a solid.
    Source: Emmerich & Korn 1987; the width is a search of this project.

    Parameters
    ----------
    stiffness : float
        Storage stiffness at the geometric mean of the band, N/m.
    loss_factor : float
        eta, at least 0; with 0 there are no branches.
    low, high : float
        The band, Hz.

    Raises
    ------
    ValueError
        If a value makes no sense, or no fit comes within 25 % of the loss factor.
    """
    if not 0.0 < stiffness < math.inf:
        raise ValueError(f"the stiffness must be above zero and finite, got {stiffness!r}")
    if not 0.0 <= loss_factor < math.inf:
        raise ValueError(f"the loss factor must be zero or above and finite, got {loss_factor!r}")
    if not 0.0 < low < high < math.inf:
        raise ValueError(f"the band must rise from above zero to a finite frequency, got {low!r} to {high!r} Hz")
    if loss_factor == 0.0:
        return LossFit(float(stiffness), (), 0.0, (float(low), float(high)))
    share, branches, error = _shares(float(loss_factor), float(low), float(high))
    scaled = tuple(Branch(stiffness * branch.stiffness, branch.relaxation) for branch in branches)
    return LossFit(stiffness * share, scaled, error, (float(low), float(high)))


@functools.lru_cache(maxsize=256)
def _shares(eta: float, low: float, high: float) -> tuple[float, tuple[Branch, ...], float]:
    """Return k, branches and error for a storage stiffness of one."""
    best: tuple[float, NDArray[np.float64], NDArray[np.float64]] | None = None
    for count in range(1, MOST_BRANCHES + 1):
        for width in WIDTHS if count > 1 else [1.0]:
            error, shares, times = _least_squares(eta, low, high, count, width)
            if shares[0] > LEAST_REST and (best is None or error < best[0]):
                best = error, shares, times
        if best is not None and best[0] <= GOOD_ENOUGH:
            break
    if best is None or best[0] > FARTHEST:
        closest = "" if best is None else f" (the closest is {100 * best[0]:.0f} % off)"
        raise ValueError(
            f"a loss factor of {eta:g} over {low:g} to {high:g} Hz cannot be held by {MOST_BRANCHES} Maxwell "
            f"branches{closest}: take a smaller loss factor or a narrower band"
        )
    error, shares, times = best
    branches = tuple(Branch(float(k), float(tau)) for k, tau in zip(shares[1:], times, strict=True) if k > 0.0)
    return float(shares[0]), branches, error


def _least_squares(
    eta: float, low: float, high: float, count: int, width: float
) -> tuple[float, NDArray[np.float64], NDArray[np.float64]]:
    """Return largest deviation, k with the k_i, and the relaxation times, for one width of the times."""
    middle = math.sqrt(low * high)
    half = 0.5 * width * math.log(high / low)
    times = np.exp(np.linspace(half, -half, count) if count > 1 else np.zeros(1)) / (2.0 * np.pi * middle)
    x = 2.0 * np.pi * np.append(np.geomspace(low, high, POINTS), middle)[:, None] * times
    K = np.column_stack([np.ones(x.shape[0]), x * (x + 1j) / (1.0 + x * x)])
    from scipy import optimize

    K, K_middle = K[:-1], K[-1].real
    storage = np.ones(K.shape[0])
    right = np.append(np.zeros(K.shape[0]), SCALE_WEIGHT)
    for _ in range(ROUNDS):
        rows = (K.imag / eta - K.real) / storage[:, None]
        shares = optimize.nnls(np.vstack([rows, SCALE_WEIGHT * K_middle]), right)[0]
        shares = shares / (K_middle @ shares)
        storage = K.real @ shares
    return float(np.max(np.abs(K.imag @ shares / (eta * storage) - 1.0))), shares, times


Array = NDArray[np.float64]

WRAPPED = 1e-8
"""Share of a signal left after one period of the transform; rounding errors grow by its inverse square root, to 1e-12
in the kept half of a period."""
MOST_LAYER_FREQUENCIES = 1e9  # more would take above a minute
"""Most layers times frequencies of a run."""
MOST_CONSTANTS = 5e7  # 0.8 GB
"""Most travel constants at once."""
MOST_VALUES = 2e6  # 32 MB, more would not be faster
"""Most values of a spectrum at once, for each quantity."""


def nonlinear_parts(stack: Stack, load: Load) -> list[str]:
    """Return the parts of a stack and its load that have no spectrum of their own, in words."""
    parts = [f"the joint behind {stack.layers[k].name} can open" for k, x in enumerate(stack.joints) if x.unilateral]
    parts += [f"layer {layer.name} comes with a speed" for layer in stack.layers if layer.speed]
    return [*parts, "a striker touches and parts"] if isinstance(load, Impactor) else parts


def is_linear(stack: Stack, load: Load) -> bool:
    """Return whether the spectral solver can follow a stack under its load."""
    return not nonlinear_parts(stack, load)


def refuse_nonlinear(stack: Stack, load: Load) -> None:
    """Refuse joints that can open, layers with a speed, and strikers: they have no spectrum of their own."""
    cannot = nonlinear_parts(stack, load)
    if cannot:
        raise ValueError(
            f"{cannot[0]}, but the spectral solver, which layers with loss or dispersion need, is linear: take delay "
            "lines without loss and dispersion, or follow the part behind the contact under a force or an incident wave"
        )


def travel_constants(layer: Layer, s: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """Return the travel constant g of a layer at complex frequencies, 1/m: waves run as exp(s t - g x).

    Without loss and dispersion g = s/c. A loss makes the modulus E m(s), with m that of springs and Maxwell
    branches; dispersion takes the wave number k(w) of its theory at w = -i s, g = i k.
    """
    speed = np.full(s.shape, complex(layer.bar_speed))
    if layer.loss is not None:
        shares = dynamic_stiffness(layer.loss.stiffness, layer.loss.branches, s / (2j * np.pi))
        speed = layer.bar_speed * np.sqrt(shares)
    if layer.dispersion == "none":
        return np.asarray(s / speed)
    assert layer.poissons_ratio is not None
    rod = Rod(0.5 * layer.diameter, layer.bar_speed, layer.poissons_ratio)
    return 1j * wave_number(-1j * s, rod, layer.dispersion, speed)


class Histories(NamedTuple):
    """Force, velocity, acceleration at places, N, m/s, m/s^2, shape (places, times)."""

    force: Array
    velocity: Array
    acceleration: Array


@dataclass(frozen=True)
class SpectralStack:
    """A linear stack under its load from rest, in the frequency domain; `look` gives histories at places."""

    stack: Stack
    load: LoadPulse | Sampled
    """Load on the first face, from time 0 on."""
    step: float
    """Time step, s; the error is of second order in it where the load is smooth."""
    steps: int
    """Number of samples of a history."""

    def __post_init__(self) -> None:
        refuse_nonlinear(self.stack, self.load)
        bins, layers, kinds = self.count // 2 + 1, len(self.stack.layers), len(self._tables[1])
        if bins * layers > MOST_LAYER_FREQUENCIES or bins * kinds > MOST_CONSTANTS:
            raise ValueError(
                f"{layers} layers ({kinds} of them different) at {bins} frequencies are too many for the spectral "
                f"solver: follow a shorter time than {self.steps * self.step:.3g} s, or take a longer step than "
                f"{self.step:.3g} s"
            )

    @property
    def count(self) -> int:
        """Samples of a period: at least twice those that are kept."""
        return int(scipy.fft.next_fast_len(2 * (self.steps + 2), real=True))

    @property
    def sigma(self) -> float:
        """Rate of the exponential window, 1/s."""
        return -math.log(WRAPPED) / (self.count * self.step)

    @functools.cached_property
    def s(self) -> NDArray[np.complex128]:
        """Complex frequencies, 1/s."""
        return np.asarray(self.sigma + 2j * math.pi * scipy.fft.rfftfreq(self.count, self.step))

    @functools.cached_property
    def _tables(self) -> tuple[SpectralTables, list[Layer]]:
        return _tables_of(self.stack)

    @functools.cached_property
    def _travel(self) -> NDArray[np.complex128]:
        return np.array([travel_constants(layer, self.s) for layer in self._tables[1]])

    @functools.cached_property
    def _speed(self) -> NDArray[np.complex128]:
        return np.asarray(self.s / self._travel)

    def travel(self, layer: int) -> NDArray[np.complex128]:
        """Return the travel constants of a layer at the frequencies, 1/m."""
        return np.asarray(self._travel[self._tables[0].group[layer]])

    @functools.cached_property
    def _loaded(self) -> NDArray[np.complex128]:
        time = self.step * np.arange(self.count, dtype=float)
        rounding = 0.5 * (1.0 + np.cosh(self.step * self.s))
        return np.asarray(scipy.fft.rfft(self.load.at(time) * np.exp(-self.sigma * time)) * rounding)

    def history(self, spectra: NDArray[np.complex128]) -> Array:
        """Return the histories of spectra along the last axis."""
        grow = np.exp(self.sigma * self.step * np.arange(self.steps))
        return np.asarray(scipy.fft.irfft(spectra, self.count)[..., : self.steps] * grow)

    def look(self, places: Sequence[tuple[int, float]], accelerated: bool = True) -> Histories:
        """Return the histories at places: layer, and fraction of the layer from its loaded side."""
        order = np.argsort([layer for layer, _ in places], kind="stable")
        histories = np.empty((3 if accelerated else 2, len(places), self.steps))
        batch = max(1, int(MOST_VALUES / self.s.size))
        for begin in range(0, len(places), batch):
            chosen = order[begin : begin + batch]
            force, velocity, _, _ = self._respond([places[k] for k in chosen])
            histories[0, chosen], histories[1, chosen] = self.history(force), self.history(velocity)
            if accelerated:
                histories[2, chosen] = self.history(self.s * velocity)
        return Histories(histories[0], histories[1], histories[2] if accelerated else np.empty((len(places), 0)))

    def ends(self) -> tuple[Array, Array, tuple[float, float, float]]:
        """Return the force on the first face and of the stack on its end, N; their impulses and the momentum, N s.

        Impulses and momentum are those at the last sample.
        """
        _, _, ends, momentum = self._respond([])
        face, end = self.history(ends[0]), self.history(ends[1])
        entered, through, moved = (float(self.history(x)[-1]) for x in (ends[0] / self.s, ends[1] / self.s, momentum))
        return face, end, (entered, through, moved)

    def _respond(self, places: Sequence[tuple[int, float]]) -> tuple[NDArray[np.complex128], ...]:
        """Return the spectra at places that are sorted by layer."""
        where = StackPlaces(
            np.array([layer for layer, _ in places], dtype=np.int64),
            np.array([part * self.stack.layers[layer].length for layer, part in places], dtype=float),
        )
        by = PRESCRIBED.index(self.load.kind)
        spectra: tuple[NDArray[np.complex128], ...] = respond(
            self._tables[0], self.s, self._travel, self._speed, self._loaded, by, where
        )
        return spectra


def _tables_of(stack: Stack) -> tuple[SpectralTables, list[Layer]]:
    """Return the stack as the kernels take it, and one layer of each kind of travel."""
    groups: dict[object, int] = {}
    kinds: list[Layer] = []
    group = np.empty(len(stack.layers), dtype=np.int64)
    for i, layer in enumerate(stack.layers):
        size = 0.0 if layer.dispersion == "none" else layer.diameter
        key = (layer.bar_speed, layer.loss, layer.dispersion, size, layer.poissons_ratio)
        if key not in groups:
            groups[key] = len(kinds)
            kinds.append(layer)
        group[i] = groups[key]
    joint = np.zeros((max(len(stack.joints), 1), 4))
    most = max((len(x.branches) for x in stack.joints), default=0)
    branch = np.zeros((max(len(stack.joints), 1), most, 2))
    for i, part in enumerate(stack.joints):
        joint[i] = part.stiffness, part.damping, part.mass, part.attached
        for k, maxwell in enumerate(part.branches):
            branch[i, k] = maxwell.stiffness, maxwell.relaxation
    end = stack.end
    tables = SpectralTables(
        np.array([layer.length for layer in stack.layers]),
        np.array([layer.density * layer.area for layer in stack.layers]),
        group,
        joint,
        branch,
        np.array([END_KINDS.index(end.kind), end.value, end.stiffness, end.damping]),
    )
    return tables, kinds
