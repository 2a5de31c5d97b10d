"""The three waves on one clock at the specimen.

geometric
    Each pulse is carried over its known distance at the known speed, and nothing is chosen. A wrong distance or speed
    shows as forces that do not balance in the rise.
onset
    The reflected and the transmitted wave are moved besides, so that they rise out of zero when they should. It
    mends a wrong distance or speed, but a front that the specimen or the bar rounded off counts as late.
balance
    They are moved so that the forces on both faces differ least while the incident wave lasts. The force balance is
    then no evidence of equilibrium: it was imposed.

What onset and balance would move is reported in any case; it is done only when asked for, and never beyond the rise
time of the incident pulse.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from strikewave.base.errors import nearest
from strikewave.hopkinson.bars import Bar
from strikewave.hopkinson.onset import first_above, noise_ceiling
from strikewave.hopkinson.pulses import Pulses
from strikewave.hopkinson.shifting import Carrier, carried, highest_frequency
from strikewave.waves.dispersion import THEORIES, Theory

Array = NDArray[np.float64]

Method = Literal["geometric", "onset", "balance"]
METHODS: tuple[Method, ...] = get_args(Method)
"""All of them, for checks and messages."""
ONSET_LEVEL = 0.05
"""Share of the incident plateau at which a wave counts as begun, where its noise allows.

Lower, the oscillations before a dispersed front count; higher, how steep a front is."""
PER_RISE = 40
"""Samples that the rise time keeps where forces are balanced: moves are then found to a hundredth of it, and noise does
not pull the fit to half samples."""
FEWEST_BALANCED = 4
"""Samples under load without which two moves are not fitted: as many again as are sought."""
INSIDE = 0.999
"""Share of the window within which a move was found, not stopped by its edge."""
FIRST_MOVE = 1e-3
"""Share of the window from which the fit begins: chosen: next to no move, and not 0, of which
differences can take no share."""


@dataclass(frozen=True)
class FaceWaves:
    """The three waves at the specimen.

    Attributes
    ----------
    time : ndarray
        After the incident wave comes to the first face, s, shape (N,).
    incident, reflected, transmitted : ndarray
        Strain, compression positive, shape (N,).
    step : float
        s.
    loaded : float
        Time at which the incident wave ends, s.
    theory, method : str
        Dispersion and alignment.
    band : float
        Highest frequency at which the incident pulse stands out of the noise, up to which dispersion is turned, Hz.
    window : float
        Largest move that an alignment may make: the rise time of the incident pulse, s.
    late_onset, late_balance : (float, float)
        How late the reflected and the transmitted wave are by their onsets and by the balance of forces, s; NaN
        where an onset is not found.
    applied : (float, float)
        Times by which they were moved forward, s; 0 by geometry.
    noise : (float, float)
        Standard deviation of both traces before their pulses.
    """

    time: Array = field(repr=False)
    incident: Array = field(repr=False)
    reflected: Array = field(repr=False)
    transmitted: Array = field(repr=False)
    step: float
    loaded: float
    theory: Theory
    method: Method
    band: float
    window: float
    late_onset: tuple[float, float]
    late_balance: tuple[float, float]
    applied: tuple[float, float]
    noise: tuple[float, float]

    @property
    def beyond(self) -> bool:
        """Whether the alignment asked for lies outside the window, so that geometry was kept."""
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

    Parameters
    ----------
    pulses : Pulses
        As found at the gauges.
    bars : (Bar, Bar)
        Incident and transmitted bar.
    theory : str, optional
        Of dispersion.
    method : str, optional
        "geometric", "onset" or "balance".
    transit : float, optional
        Time of an elastic wave through the specimen, by which the transmitted wave should begin later, s.

    Raises
    ------
    ValueError
        If a theory or method is not known.
    """
    _check(method, theory)

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


def _check(method: str, theory: str) -> None:
    if method not in METHODS:
        raise ValueError(f"unknown alignment {method!r}; {nearest(str(method), METHODS)}")
    if theory not in THEORIES:
        raise ValueError(f"unknown theory of dispersion {theory!r}; {nearest(str(theory), THEORIES)}")


def _within(late: tuple[float, float], window: float) -> bool:
    """Tell whether both moves are known and lie inside the window, not at its edge."""
    return all(abs(move) < INSIDE * window for move in late)


def _late_by_onset(waves: FaceWaves, plateau: float, transit: float) -> tuple[float, float]:
    """Return how much later than the incident wave the others stay above one level, less the transit expected, s."""
    level = max(ONSET_LEVEL * plateau, noise_ceiling(max(waves.noise), waves.time.size))
    begun = []
    for wave in (waves.incident, waves.reflected, waves.transmitted):
        k = first_above(wave, level)
        if k is None or k == 0:
            begun.append(np.nan)
            continue
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
