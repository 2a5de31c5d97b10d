"""The three waves on one clock at the specimen, each carried along its bar from the gauge.

geometric
    Each pulse is carried over its known distance at the known speed, and nothing is chosen. A wrong distance or speed
    shows as forces that do not balance in the rise.
onset
    The reflected and the transmitted wave are also moved so that they rise out of zero when they should. It mends a
    wrong distance or speed, but a front that the specimen or the bar rounded off counts as late.
balance
    They are moved so that the forces on both faces differ least while the incident wave lasts. The force balance is
    then no evidence of equilibrium: it was imposed.

The moves by onset and balance are always reported; they are applied only on request, and never beyond the rise time of
the incident pulse.

Each frequency runs at its own speed: over a distance x the component exp(i w t) is turned by exp(-i k(w) x). Without
the plain delay x/c0, the rest is the change of shape. A bar that loses energy has a complex k; carried back, the wave
grows by its loss. Only the strain at the gauge's own place in the section is carried: the strain of the first mode at
the surface is not the mean one at high frequencies, which is not corrected here.

Source: P. S. Follansbee, C. Frantz, Wave Propagation in the Split Hopkinson Pressure Bar, Journal of Engineering
Materials and Technology 105 (1983) 61-66.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Literal, NamedTuple, get_args

import numpy as np
import scipy
from numpy.typing import NDArray

from strikewave.base.errors import nearest
from strikewave.hopkinson.bars import Bar
from strikewave.hopkinson.pulses import Pulses, first_above, noise_ceiling
from strikewave.waves.dispersion import THEORIES, Rod, Theory, wave_number

Array = NDArray[np.float64]

SLOWEST = 0.5
"""Slowest phase speed over the bar speed, 0.576 for the first mode in steel; padding leaves room for its delay."""
ABOVE_NOISE = 4.0
"""Amplitude of a signal over that of noise alone, which reaches it once in ten million frequencies."""
MOST_NODES = 2000
"""Frequencies at which the wave number is solved for; a cubic between them errs far less than noise."""


class Carrier(NamedTuple):
    """The bar, the theory of dispersion, and the highest frequency that it turns (Hz).

    Above that frequency a record holds noise, and waves of higher modes that no theory of the first one carries: they
    keep the turn of that frequency, which does not move them in time.
    """

    rod: Rod
    theory: Theory = "pochhammer-chree"
    highest: float = math.inf


def carried(pulse: Array, step: float, distance: float, carrier: Carrier, advance: float = 0.0) -> Array:
    """Return a pulse after a distance along a bar, with the delay distance/c0 taken off.

    Parameters
    ----------
    pulse : array
        Samples, shape (N,), about zero at its begin; half a cosine in the padding leads its end to zero.
    step : float
        s.
    distance : float
        m; below zero it is carried back.
    carrier : Carrier
        Bar, theory and highest frequency.
    advance : float, optional
        Time by which the result is also moved forward, s; need not be whole steps.

    Returns
    -------
    ndarray
        Shape (N,), on the clock of the pulse plus distance/c0.

    Examples
    --------
    >>> t = 1e-7 * np.arange(4000)
    >>> pulse = np.exp(-(((t - 1e-4) / 8e-6) ** 2))
    >>> steel = Carrier(Rod(0.01, 5000.0, 0.29))
    >>> there = carried(pulse, 1e-7, 0.5, steel)
    >>> back = carried(there, 1e-7, -0.5, steel)
    >>> float(there.max().round(3)), bool(abs(back - pulse).max() < 1e-6)
    (0.99, True)
    """
    size, rod = pulse.size, carrier.rod
    # room for the slowest component, which would else wrap round to the begin
    slack = int(abs(distance) / rod.bar_speed * (1.0 / SLOWEST - 1.0) / step)
    total = scipy.fft.next_fast_len(2 * size + 2 * slack, real=True)
    padded = np.zeros(total)
    padded[:size] = pulse
    # a jump at the end would ring through the whole transform
    padded[size : 2 * size] = pulse[-1] * 0.5 * (1.0 + np.cos(np.pi * np.arange(1, size + 1) / size))
    w = 2.0 * np.pi * scipy.fft.rfftfreq(total, step)
    turned = np.minimum(w, 2.0 * np.pi * carrier.highest)
    turn = (_wave_numbers(turned, rod, carrier.theory) - turned / rod.bar_speed) * distance - w * advance
    return np.asarray(scipy.fft.irfft(scipy.fft.rfft(padded) * np.exp(-1j * turn), total)[:size])


def highest_frequency(pulse: Array, step: float, noise: float, width: float) -> float:
    """Return the frequency from which on a pulse no longer stands out of white noise, Hz.

    Its spectrum is taken by the largest value within 2/width, since that of a plateau has zeros each 1/width.

    Parameters
    ----------
    pulse : array
        Samples, shape (N,).
    step, noise, width : float
        Sampling step (s), standard deviation of the noise, duration of the pulse (s).
    """
    amplitude = np.abs(scipy.fft.rfft(pulse))
    wide = max(round(2.0 / width * pulse.size * step), 1)
    envelope = scipy.ndimage.maximum_filter1d(amplitude, 2 * wide + 1)
    sunk = np.flatnonzero(envelope <= ABOVE_NOISE * noise * math.sqrt(pulse.size))
    place = int(sunk[0]) if sunk.size else amplitude.size - 1
    return float(scipy.fft.rfftfreq(pulse.size, step)[place])


def _wave_numbers(w: Array, rod: Rod, theory: Theory) -> NDArray[np.complex128]:
    """Return k at ascending frequencies, solved at nodes and interpolated by a cubic between them."""
    if theory == "none" or w.size <= MOST_NODES:
        return _running(w, rod, theory)
    from scipy.interpolate import CubicSpline

    nodes = np.linspace(0.0, float(w.max()), MOST_NODES)
    return np.asarray(CubicSpline(nodes, _running(nodes, rod, theory))(w))


def _running(w: Array, rod: Rod, theory: Theory) -> NDArray[np.complex128]:
    """Return k; where the Love-Rayleigh theory lets nothing run, that of the plain bar."""
    k = np.asarray(wave_number(w, rod, theory))
    if theory == "love-rayleigh":
        k = np.where(np.abs(k.imag) > 0.0, w / rod.bar_speed, k)
        limit = w / (rod.bar_speed * SLOWEST)
        return np.where(k.real > limit, limit, k)
    return k


Method = Literal["geometric", "onset", "balance"]
METHODS: tuple[Method, ...] = get_args(Method)
"""All methods, for checks and messages."""
ONSET_LEVEL = 0.05
"""Share of the incident plateau at which a wave counts as begun: below, oscillations before a dispersed front count;
above, the steepness of a front."""
PER_RISE = 40
"""Samples in the rise time where forces are balanced: moves are found to a hundredth of it, and noise does not pull the
fit to half samples."""
FEWEST_BALANCED = 4
"""Least number of samples under load for a fit of two moves: twice as many as are sought."""
INSIDE = 0.999
"""Share of the window within which a move is a result, not a stop at the edge."""
FIRST_MOVE = 1e-3
"""Share of the window from which the fit begins. Chosen: nearly no move, yet not 0, of which differences can take no
share."""


@dataclass(frozen=True)
class FaceWaves:
    """The three waves at the specimen; strains of shape (N,), compression positive."""

    time: Array = field(repr=False)
    """Time after the incident wave comes to the first face, s."""
    incident: Array = field(repr=False)
    reflected: Array = field(repr=False)
    transmitted: Array = field(repr=False)
    step: float
    loaded: float
    """Time at which the incident wave ends, s."""
    theory: Theory
    method: Method
    band: float
    """Highest frequency at which the incident pulse stands out of the noise, up to which dispersion is turned, Hz."""
    window: float
    """Largest move of an alignment: the rise time of the incident pulse, s."""
    late_onset: tuple[float, float]
    """Delay of the reflected and the transmitted wave by their onsets, s; NaN without an onset."""
    late_balance: tuple[float, float]
    """Delay of both by the balance of forces, s."""
    applied: tuple[float, float]
    """Times by which they were moved forward, s; 0 by geometry."""
    noise: tuple[float, float]
    """Standard deviation of both traces before their pulses."""

    @property
    def beyond(self) -> bool:
        """True if the requested alignment lies outside the window, so that geometry was kept."""
        late = self.late_onset if self.method == "onset" else self.late_balance
        return self.method != "geometric" and not _within(late, self.window)


def align(
    pulses: Pulses,
    bars: tuple[Bar, Bar],
    theory: Theory = "pochhammer-chree",
    method: Method = "geometric",
    transit: float = 0.0,
) -> FaceWaves:
    """Carry the three pulses to the specimen.

    ``transit`` is the time of an elastic wave through the specimen, by which the transmitted wave should begin later,
    s. Raises `ValueError` for an unknown theory or method.
    """
    if method not in METHODS:
        raise ValueError(f"unknown alignment {method!r}; {nearest(str(method), METHODS)}")
    if theory not in THEORIES:
        raise ValueError(f"unknown theory of dispersion {theory!r}; {nearest(str(theory), THEORIES)}")

    def carry(values: Array, bar: Bar, way: float, advance: float) -> Array:
        carrier = Carrier(bar.rod, theory, band)
        return carried(values, pulses.step, way * bar.gauge_distance, carrier, advance)

    late, (first, second) = pulses.late, pulses.traces
    band = highest_frequency(pulses.incident, pulses.step, first.noise, pulses.width)
    waves = FaceWaves(
        time=np.asarray(pulses.step * np.arange(pulses.incident.size) - pulses.lead),
        incident=carry(pulses.incident, bars[0], 1.0, -late[0]),
        reflected=carry(pulses.reflected, bars[0], -1.0, -late[1]),
        transmitted=carry(pulses.transmitted, bars[1], -1.0, -late[2]),
        step=pulses.step,
        loaded=pulses.end - pulses.onset,
        theory=theory,
        method=method,
        band=band,
        window=max(pulses.rise, pulses.step),
        late_onset=(np.nan, np.nan),
        late_balance=(0.0, 0.0),
        applied=(0.0, 0.0),
        noise=(first.noise, second.noise),
    )
    waves = replace(
        waves,
        late_onset=_late_by_onset(waves, pulses.plateau, transit),
        late_balance=_late_by_balance(waves, (bars[0].stiffness, bars[1].stiffness)),
    )
    moves = waves.late_onset if method == "onset" else waves.late_balance
    if method == "geometric" or waves.beyond:
        return waves
    return replace(
        waves,
        reflected=carry(pulses.reflected, bars[0], -1.0, moves[0] - late[1]),
        transmitted=carry(pulses.transmitted, bars[1], -1.0, moves[1] - late[2]),
        applied=moves,
    )


def _within(late: tuple[float, float], window: float) -> bool:
    """Tell whether both moves are known and lie inside the window, not at its edge."""
    return all(abs(move) < INSIDE * window for move in late)


def _late_by_onset(waves: FaceWaves, plateau: float, transit: float) -> tuple[float, float]:
    """Return the delay of the other waves after the incident one at one level, less the expected transit, s."""
    level = max(ONSET_LEVEL * plateau, noise_ceiling(max(waves.noise), waves.time.size))
    begun = []
    for wave in (waves.incident, waves.reflected, waves.transmitted):
        k = first_above(wave, level)
        if k is None or k == 0:
            begun.append(np.nan)
            continue
        # between samples, for delays below a step
        before, at = abs(wave[k - 1]), abs(wave[k])
        begun.append((k - (at - level) / (at - before)) * waves.step)
    return begun[1] - begun[0], begun[2] - begun[0] - transit


def _late_by_balance(waves: FaceWaves, stiffness: tuple[float, float]) -> tuple[float, float]:
    """Return the moves of the reflected and the transmitted wave with the least mean square of F1 - F2, s.

    Least squares from no move at all, within the window, over the time that the incident wave lasts.
    """
    from scipy.optimize import least_squares

    every = max(round(waves.window / (PER_RISE * waves.step)), 1)
    time = _averaged(waves.time, every)
    on = (time >= 0.0) & (time <= waves.loaded)
    if np.count_nonzero(on) < FEWEST_BALANCED:
        return 0.0, 0.0
    at, incident = time[on], stiffness[0] * _averaged(waves.incident, every)[on]
    scale = float(np.abs(incident).max()) or 1.0
    reflected, transmitted = (_spline(time, _averaged(w, every)) for w in (waves.reflected, waves.transmitted))

    def apart(late: Array) -> Array:
        first = incident + stiffness[0] * reflected(at + late[0] * waves.window)
        return np.asarray((first - stiffness[1] * transmitted(at + late[1] * waves.window)) / scale)

    moves = least_squares(apart, np.full(2, FIRST_MOVE), bounds=(-1.0, 1.0), jac="3-point").x
    return float(moves[0]) * waves.window, float(moves[1]) * waves.window


def _averaged(values: Array, every: int) -> Array:
    """Return means of so many samples, so that noise does not pull a fit to half samples."""
    count = values.size // every
    return np.asarray(values[: count * every].reshape(count, every).mean(axis=1))


def _spline(time: Array, values: Array) -> Callable[[Array], Array]:
    """Return a wave as a smooth function of time, with its ends kept beyond them."""
    from scipy.interpolate import CubicSpline

    curve = CubicSpline(time, values)
    return lambda at: np.asarray(curve(np.clip(at, time[0], time[-1])))
