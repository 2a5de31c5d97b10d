"""The uncertainty of a shock response spectrum, from what its channel may have done to the record.

It is that of the law of propagation: the whole record is changed by each contribution to both sides, and its spectrum
computed again. What lies before the first blow is its noise: stretches of it, rolled at random, are laid on the record.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from strikewave.base import declare
from strikewave.base.constants import COVERAGE
from strikewave.base.declare import Quantity
from strikewave.base.shock_quantities import RATIO
from strikewave.records.budget.contributions import (
    GAINS,
    RECORD,
    BlowStretch,
    Budget,
    Contribution,
    changed,
    sampling,
)
from strikewave.records.measuring import RecordedPulse
from strikewave.records.record import Channel

Array = NDArray[np.float64]
AS_SPECTRUM = Quantity.of_data("as the spectrum")
SpectrumOf = Callable[[Array], Array]
"""Spectrum of a record whose baseline is taken off, or several of them, a row each."""

DRAWS = 24
"""Rolls of the noise: its standard deviation at a frequency is then known to 15 %, 1/sqrt(2 x 23)."""
WIDTHS = 7.0
"""Widths of a blow that must lie before it so that noise and baseline are known, as for the figures of blows."""


@declare.dataclass
class SpectrumPart:
    """What one contribution does to a spectrum."""

    name: str = declare.word("what contributes")
    standard: Array = declare.history(AS_SPECTRUM, "its part at each frequency")


@declare.dataclass(eq=False)
class SpectrumUncertainty:
    """The uncertainty of a spectrum, or of several, a row each; NaN where noise and baseline are not known."""

    standard: Array = declare.history(AS_SPECTRUM, "standard uncertainty at each frequency")
    expanded = declare.computed(declare.history(AS_SPECTRUM, "expanded uncertainty at each frequency"))(
        lambda one: COVERAGE * one.standard
    )
    coverage: float = declare.number(RATIO, "coverage factor of that", default=COVERAGE)
    contributions: Sequence[SpectrumPart] = declare.rows(SpectrumPart, "what contributes", default=())

    def lowest(self, count: int) -> SpectrumUncertainty:
        """Return that of the lowest natural frequencies alone."""
        return self._only(slice(count))

    def of_row(self, row: int) -> SpectrumUncertainty:
        """Return that of one of several spectra."""
        return self._only(row)

    def _only(self, which: int | slice) -> SpectrumUncertainty:
        parts = [SpectrumPart(one.name, one.standard[which]) for one in self.contributions]
        return SpectrumUncertainty(self.standard[which], contributions=parts)


def spectrum_uncertainty(
    channel: Channel,
    baseline: float,
    pulses: Sequence[RecordedPulse],
    budget: Budget,
    frequency: Array,
    spectrum: SpectrumOf,
) -> SpectrumUncertainty:
    """Return the uncertainty of a spectrum.

    Parameters
    ----------
    channel : Channel
        Its record.
    baseline : float
        What is taken off it.
    pulses : sequence of RecordedPulse
        Its blows.
    budget : Budget
        Contributions beyond those that the record itself tells.
    frequency : ndarray
        Natural frequencies, Hz.
    spectrum : callable
        Spectrum of a record whose baseline is taken off, or several of them, a row each.

    Examples
    --------
    >>> from strikewave.records.budget.contributions import of_share
    >>> from strikewave.records.measuring import find_pulses
    >>> t = np.arange(4000) * 1e-6
    >>> record = Channel("a", np.where(abs(t - 2e-3) < 1e-4, 5e3 * np.cos(np.pi * (t - 2e-3) / 2e-4), 0.0), 1e-6)
    >>> pulses = find_pulses(record.values, record.step)
    >>> peak = lambda values: np.max(values, keepdims=True)
    >>> found = spectrum_uncertainty(record, 0.0, pulses, of_share(0.04), np.ones(1), peak)
    >>> (found.expanded / 5e3).round(4).tolist()
    [0.04]
    """
    values = channel.values - baseline
    plain = spectrum(values)
    blow = pulses[0] if pulses else None
    begin, end = (0.0, 1.0) if blow is None else ((t - channel.start) / channel.step for t in (blow.begin, blow.end))
    stretch = BlowStretch(values, channel.step, float(np.max(np.abs(values))), begin, end)

    def by(one: Contribution) -> Array:
        """Return the standard uncertainty by a contribution."""
        size = one.input.standard
        if one.kind in GAINS:
            return size * plain
        if one.kind == "clock":
            slope = np.gradient(plain, np.log(frequency), axis=-1) if frequency.size > 1 else np.zeros_like(plain)
            return size * np.abs(slope)
        if one.kind == "noise":
            size *= stretch.peak if one.relative else 1.0
            return _by_draws(values, spectrum, lambda generator: size * generator.standard_normal(values.size))
        pair = changed(stretch, [one], np.array([[size], [-size]]))
        return 0.5 * np.abs(spectrum(pair[0]) - spectrum(pair[1]))

    own = _of_record(channel, values, blow, spectrum, plain.shape)
    rows = [(RECORD, own), *((one.name, by(one)) for one in (sampling(channel.step), *budget.contributions))]
    stated = any(one.kind in ("acceleration", "offset", "noise") for one in budget.contributions)
    together = np.sqrt(np.sum([np.nan_to_num(each) ** 2 if stated else each**2 for _, each in rows], axis=0))
    return SpectrumUncertainty(together, contributions=[SpectrumPart(name, each) for name, each in rows])


def _of_record(
    channel: Channel, values: Array, blow: RecordedPulse | None, spectrum: SpectrumOf, shape: tuple[int, ...]
) -> Array:
    """Return what noise and baseline before the first blow do to a spectrum; NaN where too little lies there."""
    width = 0.0 if blow is None else (blow.end - blow.begin) / channel.step
    before = 0 if blow is None else math.floor((blow.begin - channel.start) / channel.step - 0.5 * width)
    if blow is None or before < WIDTHS * width or math.isnan(blow.baseline.wander):
        return np.full(shape, math.nan)
    noise = values[:before] - float(np.mean(values[:before]))
    rows = math.ceil(values.size / before) + 1

    def drawn(generator: np.random.Generator) -> Array:
        start = int(generator.integers(before))
        return np.tile(noise, rows)[start : start + values.size]

    wander = blow.baseline.wander
    shifted = 0.5 * np.abs(spectrum(values + wander) - spectrum(values - wander))
    return np.hypot(_by_draws(values, spectrum, drawn), shifted)


def _by_draws(values: Array, spectrum: SpectrumOf, drawn: Callable[[np.random.Generator], Array]) -> Array:
    """Return the standard deviation of the spectra of a record with noise laid on it."""
    generator = np.random.default_rng(0)
    return np.asarray(np.std([spectrum(values + drawn(generator)) for _ in range(DRAWS)], axis=0, ddof=1))
