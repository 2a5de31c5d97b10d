"""Uncertainty of the figures of a blow, and of a shock response spectrum, from what the channel may have done to it.

That of a spectrum is by the law of propagation: the whole record is changed by each contribution to both sides, and its
spectrum computed again. What lies before the first blow is its noise: stretches of it, rolled at random, are laid on
the record.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import astuple, dataclass, field, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.base import declare
from strikewave.base.constants import COVERAGE
from strikewave.base.declare import Quantity
from strikewave.base.shock_quantities import OF_FIGURE, RATIO
from strikewave.records.budget import (
    GAINS,
    RECORD,
    BlowStretch,
    Budget,
    Contribution,
    InputQuantity,
    Model,
    Propagated,
    Simulated,
    changed,
    factors_of,
    law_of_propagation,
    monte_carlo,
    sampling,
)
from strikewave.records.measuring import RecordedPulse
from strikewave.records.pulse_shape import BUDGETED, figures_of, without_noise
from strikewave.records.record import Array, Channel

BESIDE = 0.5  # lengths of a blow to either side of it that are changed and measured again
# Samples of a blow that are: more are averaged, as one of so many loses 1e-4 of its peak between two
MOST_SAMPLES = 200
LARGEST = 2_000_000  # numbers of a block of trials: some 16 MB
# Kinds that change the shape of a record
CHANGING = ("linearity", "response", "resonance", "filter", "sampling", "offset", "drift", "coupling")
# Kinds that replace the record's own noise and baseline where too little lies before the blow
IN_PLACE = {
    "peak": ("acceleration", "offset", "noise"),
    "width": ("offset", "noise"),
    "velocity_change": ("acceleration", "offset", "noise"),
}
BY_LAW, BY_TRIALS = "law of propagation", "Monte Carlo"


@declare.dataclass
class BudgetLine:
    """Effect of one contribution on a figure; NaN where it is not known."""

    name: str = declare.word("what contributes")
    standard: float = declare.number(OF_FIGURE, "its part of the standard uncertainty")
    share: float = declare.number(RATIO, "its share of the variance")


@declare.dataclass
class FigureUncertainty:
    """The uncertainty of one figure.

    Attributes
    ----------
    value : float
        The figure.
    """

    value: float
    standard: float = declare.number(OF_FIGURE, "its standard uncertainty")
    expanded: float = declare.number(OF_FIGURE, "its expanded uncertainty")
    coverage: float = declare.number(RATIO, "coverage factor of that")
    method: str = declare.word("law of propagation, or Monte Carlo where that does not validate it")
    contributions: tuple[BudgetLine, ...] = declare.rows(BudgetLine, "what contributes, the largest first")

    @property
    def by_law(self) -> float:
        """The standard uncertainty by the law of propagation."""
        return math.sqrt(math.fsum(line.standard**2 for line in self.contributions if math.isfinite(line.standard)))


@dataclass(frozen=True)
class BlowUncertainty:
    """The uncertainty of the figures of a blow."""

    figures: Mapping[str, FigureUncertainty]  # uncertainties of peak, width and velocity change
    trials: int = 0  # trials of Monte Carlo, where it was done for this blow; else 0
    # True if Monte Carlo validates the law of propagation, by figure; empty where it was not done
    validated: Mapping[str, bool] = field(default_factory=dict)
    # Standard uncertainty of any acceleration by amounts that are added to it, in the unit of the record
    amount: float = 0.0

    def alike(self, checked: BlowUncertainty) -> BlowUncertainty:
        """Return it as Monte Carlo has it, where that did not validate the law of propagation for a blow like this one.

        Both standard uncertainties are as far apart, and the coverage factor is that of the trials.
        """
        figures = {}
        for name, figure in self.figures.items():
            other = checked.figures[name]
            if other.method == BY_TRIALS and other.by_law > 0.0:
                standard, k = figure.by_law * other.standard / other.by_law, other.coverage
                figure = replace(figure, standard=standard, expanded=k * standard, coverage=k, method=BY_TRIALS)
            figures[name] = figure
        return replace(self, figures=figures)


class ReadOff(NamedTuple):
    """Bounds for reading figures off changed stretches: those of the peak, and those of the area."""

    inside: slice
    begin: float
    end: float
    step: float


def read_off(values: Array, where: ReadOff) -> Array:
    """Return peak, width at 10 % and area of each row, as a record is measured.

    The peak is that of a parabola through three samples, the width lies between crossings of straight lines, and the
    area between the feet of the measured blow.
    """
    weights = _trapezoid(values.shape[1], where.begin, where.end)
    _, peak, _, width = figures_of(values, where.inside).T
    return np.column_stack([peak, width * where.step, values @ weights * where.step])


def _trapezoid(size: int, begin: float, end: float) -> Array:
    """Return weights of samples whose sum is the integral between two places, straight lines between samples."""
    weights = np.zeros(size)
    grid = np.unique(np.concatenate([[begin], np.arange(math.ceil(begin), math.floor(end) + 1), [end]]))
    halves = 0.5 * np.diff(grid)
    share = np.append(halves, 0.0) + np.append(0.0, halves)
    low = np.minimum(grid.astype(int), size - 2)
    np.add.at(weights, low, share * (1.0 - (grid - low)))
    np.add.at(weights, low + 1, share * (grid - low))
    return weights


class _Measured(NamedTuple):
    """A blow ready to be changed and measured again."""

    stretch: BlowStretch
    where: ReadOff
    figures: Array
    factor: int
    sign: float


def _prepared(channel: Channel, pulse: RecordedPulse) -> _Measured:
    """Return the stretch around a blow, noise smoothed; of a fitted one, the smooth pulse."""
    step, sign = channel.step, math.copysign(1.0, pulse.peak)
    length = pulse.end - pulse.begin
    begin, end = ((time - channel.start) / step for time in (pulse.begin, pulse.end))
    beside = BESIDE * length / step + 2.0
    low = max(math.floor(begin - beside), 0)
    high = min(math.ceil(end + beside) + 1, channel.values.size)
    figures = np.array([abs(pulse.peak), pulse.width, sign * pulse.velocity_change])
    fitted = sign * pulse.smooth.at(np.asarray(channel.start + step * np.arange(low, high), dtype=np.float64))
    if pulse.method == "record":
        raw = sign * (channel.values[low:high] - pulse.offset)
        white = pulse.noise * np.random.default_rng(0).normal(size=raw.size)
        values = without_noise(raw, fitted, white, max(round(length / step), 2))
    else:
        values = fitted
    factor = max(math.floor(length / step / MOST_SAMPLES), 1)
    values = values[: values.size // factor * factor].reshape(-1, factor).mean(axis=1)
    first, last, top = (
        min(max((place - low - 0.5 * (factor - 1)) / factor, 0.0), values.size - 1.0)
        for place in (begin, end, (pulse.time - channel.start) / step)
    )
    near = max(0.25 * (last - first), 2.0)
    inside = slice(max(math.floor(top - near), 0), min(math.ceil(top + near) + 1, values.size))
    stretch = BlowStretch(values, step * factor, abs(pulse.peak), first, last)
    return _Measured(stretch, ReadOff(inside, first, last, step * factor), figures, factor, sign)


def _model(measured: _Measured, contributions: Sequence[Contribution]) -> Model:
    """Return the model of a blow: draws of the contributions, then an error a figure, in; figures out."""
    count = len(contributions)
    stretch, where = measured.stretch, measured.where
    plain = read_off(stretch.values[None, :], where)
    shaping = [k for k, contribution in enumerate(contributions) if contribution.kind in CHANGING]

    def figures(drawn: Array) -> Array:
        rows_of_figures = np.empty((drawn.shape[0], len(BUDGETED)))
        block = max(LARGEST // stretch.values.size, 1)
        for first in range(0, drawn.shape[0], block):
            rows = drawn[first : first + block, :count]
            shapes = plain
            if shaping:
                chosen = [contributions[k] for k in shaping]
                shapes = read_off(changed(stretch, chosen, rows[:, shaping]), where)
            gain, clock = (factors_of(kinds, contributions, rows) for kinds in (GAINS, ("clock",)))
            scale = np.column_stack([gain, clock, gain * clock])
            rows_of_figures[first : first + block] = (measured.figures + shapes - plain) * scale
        return np.asarray(rows_of_figures + drawn[:, count:])

    return figures


def _by_noise(measured: _Measured, noise: float) -> Array:
    """Return the standard uncertainty of the figures by white noise of each sample, added to what is in the record."""
    stretch, where = measured.stretch, measured.where
    size, noise = stretch.values.size, noise / math.sqrt(measured.factor)
    total = np.zeros(len(BUDGETED))
    block = max(LARGEST // size, 1)
    for first in range(0, size, block):
        bump = noise * np.eye(min(block, size - first), size, first)
        pair = [read_off(stretch.values + sign * bump, where) for sign in (1.0, -1.0)]
        total += np.sum((0.5 * (pair[0] - pair[1])) ** 2, axis=0)
    return np.sqrt(total)


class _Inputs(NamedTuple):
    """Inputs of a blow's model: its contributions, and amounts added to each figure."""

    contributions: tuple[Contribution, ...]
    added: tuple[tuple[str, Array], ...]
    unknown: NDArray[np.bool_]

    @property
    def quantities(self) -> list[InputQuantity]:
        """All inputs, those added to each figure last."""
        together = np.sqrt(np.sum([np.nan_to_num(each) ** 2 for _, each in self.added], axis=0))
        added = [InputQuantity(name, float(each)) for name, each in zip(BUDGETED, together, strict=True)]
        return [contribution.input for contribution in self.contributions] + added


def _inputs(channel: Channel, pulse: RecordedPulse, budget: Budget, measured: _Measured) -> _Inputs:
    of_record = np.array(astuple(pulse.uncertainty), dtype=np.float64)
    peak = measured.stretch.peak
    added = [(RECORD, of_record)]
    for noise in (c for c in budget.contributions if c.kind == "noise"):
        added.append((noise.name, _by_noise(measured, noise.input.standard * (peak if noise.relative else 1.0))))
    others = tuple(c for c in budget.contributions if c.kind != "noise")
    kinds = {c.kind for c in budget.contributions}
    stated = [bool(kinds & set(IN_PLACE[name])) for name in BUDGETED]
    return _Inputs((sampling(channel.step), *others), tuple(added), np.isnan(of_record) & ~np.array(stated))


def blow_uncertainty(
    channel: Channel, pulse: RecordedPulse, budget: Budget, trials: bool = False, seed: int = 0
) -> BlowUncertainty:
    """Return the uncertainty of the figures of a blow.

    With ``trials``, Monte Carlo validates the law of propagation, and its interval counts where that fails.
    """
    measured = _prepared(channel, pulse)
    inputs = _inputs(channel, pulse, budget, measured)
    model, quantities = _model(measured, inputs.contributions), inputs.quantities
    propagated = law_of_propagation(model, quantities)
    simulated = monte_carlo(model, quantities, seed) if trials else None
    return replace(_summed(measured, inputs, propagated, simulated), amount=budget.amount)


def _summed(
    measured: _Measured, inputs: _Inputs, propagated: Propagated, simulated: Simulated | None
) -> BlowUncertainty:
    """Return figures with their uncertainty, by the law of propagation where it is validated, else by Monte Carlo."""
    sound = [True] * len(BUDGETED) if simulated is None else simulated.validates(propagated).tolist()
    figures = {}
    for k, name in enumerate(BUDGETED):
        standard, method = math.nan if inputs.unknown[k] else float(propagated.standard[k]), BY_LAW
        expanded = COVERAGE * standard
        if simulated is not None and not sound[k] and math.isfinite(standard + float(simulated.standard[k])):
            standard, method = float(simulated.standard[k]), BY_TRIALS
            middle = float(measured.figures[k])
            expanded = max(middle - float(simulated.low[k]), float(simulated.high[k]) - middle)
        rows = [(c.name, abs(float(propagated.contributions[i, k]))) for i, c in enumerate(inputs.contributions)]
        rows += [(source, float(each[k])) for source, each in inputs.added]
        total = math.fsum(u**2 for _, u in rows if math.isfinite(u)) or math.inf
        shares = [BudgetLine(source, u, u**2 / total) for source, u in rows]
        shares.sort(key=lambda row: -row.standard if math.isfinite(row.standard) else 0.0)
        coverage = expanded / standard if standard > 0.0 else COVERAGE
        value = float(measured.figures[k]) * (1.0 if name == "width" else measured.sign)
        figures[name] = FigureUncertainty(value, standard, expanded, coverage, method, tuple(shares))
    checked = {} if simulated is None else dict(zip(BUDGETED, sound, strict=True))
    return BlowUncertainty(figures, 0 if simulated is None else simulated.trials, checked)


AS_SPECTRUM = Quantity.of_data("as the spectrum")
SpectrumOf = Callable[[Array], Array]
"""Spectrum of a record whose baseline is taken off, or several of them, a row each."""

DRAWS = 24  # rolls of the noise: its standard deviation at a frequency is then known to 15 %, 1/sqrt(2 x 23)
# Widths of a blow that must lie before it so that noise and baseline are known, as for the figures of blows
WIDTHS = 7.0


@declare.dataclass
class SpectrumPart:
    """Effect of one contribution on a spectrum."""

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
        parts = [SpectrumPart(part.name, part.standard[which]) for part in self.contributions]
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
    channel, pulses
        Its record, and the blows in it.
    baseline : float
        Baseline that is taken off it.
    budget : Budget
        Contributions beyond those that the record itself tells.
    frequency : ndarray
        Natural frequencies, Hz.
    spectrum : callable
        Spectrum of a record whose baseline is taken off, or several of them, a row each.
    """
    values = channel.values - baseline
    plain = spectrum(values)
    blow = pulses[0] if pulses else None
    begin, end = (0.0, 1.0) if blow is None else ((t - channel.start) / channel.step for t in (blow.begin, blow.end))
    stretch = BlowStretch(values, channel.step, float(np.max(np.abs(values))), begin, end)

    def by(contribution: Contribution) -> Array:
        """Return the standard uncertainty by a contribution."""
        size = contribution.input.standard
        if contribution.kind in GAINS:
            return size * plain
        if contribution.kind == "clock":
            slope = np.gradient(plain, np.log(frequency), axis=-1) if frequency.size > 1 else np.zeros_like(plain)
            return size * np.abs(slope)
        if contribution.kind == "noise":
            size *= stretch.peak if contribution.relative else 1.0
            return _by_draws(values, spectrum, lambda generator: size * generator.standard_normal(values.size))
        pair = changed(stretch, [contribution], np.array([[size], [-size]]))
        return 0.5 * np.abs(spectrum(pair[0]) - spectrum(pair[1]))

    own = _of_record(channel, values, blow, spectrum, plain.shape)
    rows = [(RECORD, own), *((c.name, by(c)) for c in (sampling(channel.step), *budget.contributions))]
    stated = any(c.kind in ("acceleration", "offset", "noise") for c in budget.contributions)
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
