"""Uncertainty budget of the channel of a record: a list of contributions, each a change of the record.

    motion → sensor (transverse motion, sensitivity, linearity, temperature, response) → filter → recorder (gain, clock)

Each contribution is one number that is not known, drawn about zero: a share of a gain, a filter's cutoff that is off, a
zero that shifts under the blow. Changes of the spectrum are taken without phase: a delay moves no figure.

Uncertainty goes from inputs to figures by the law of propagation, and by Monte Carlo. Both take the same model: rows of
inputs in, rows of quantities out. The law of propagation (JCGM 100:2008, 5.1.2) takes the sensitivity to each input
from a change by its standard uncertainty to both sides (5.1.3, note 2). Monte Carlo (JCGM 101:2008, clause 7) draws all
inputs at once; trials are added until mean, standard uncertainty and both ends of the coverage interval are known to a
tolerance (7.9.4). The first is validated by the second (8.1).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.base import declare
from strikewave.base.constants import COVERAGE
from strikewave.records.record import Array

Model = Callable[[Array], Array]
"""Rows of inputs in, rows of quantities out."""

NORMAL, RECTANGULAR, TRIANGULAR, U_SHAPED = "normal", "rectangular", "triangular", "u-shaped"
# Half-width of a distribution over its standard uncertainty (JCGM 100, 4.3.7 and 4.3.9; JCGM 101, 6.4.6 for the
# U-shaped one, which is the arc sine distribution); of a normal one, its standard uncertainty is stated.
DIVISORS = {NORMAL: 1.0, RECTANGULAR: math.sqrt(3.0), TRIANGULAR: math.sqrt(6.0), U_SHAPED: math.sqrt(2.0)}
PROBABILITY = 0.95  # coverage probability of intervals
NORMAL_FACTOR = 1.959964  # coverage factor of a normal distribution for it
TRIALS = 10_000  # trials that are added at a time: JCGM 101, 7.9.4 b, asks for max(100/(1 - p), 10 000)
# Trials after which it ends in any case: as many as JCGM 101, 7.2.1, expects to do for an interval of 95 %
MOST_TRIALS = 1_000_000
# Tolerance of the ends of a coverage interval by the law of propagation, in standard uncertainties: JCGM 101, 7.9.2,
# takes half a unit of the last digit of the standard uncertainty that counts; this is that of one digit, a 2.
TOLERANCE = 0.25
FINER = 5.0  # times that Monte Carlo is better than that (JCGM 101, 8.2)


@dataclass(frozen=True)
class InputQuantity:
    """An uncertain input, about an estimate."""

    name: str  # name of the quantity
    spread: float  # half-width of its distribution; of a normal one, its standard uncertainty
    distribution: str = NORMAL  # ``normal``, ``rectangular``, ``triangular`` or ``u-shaped``
    estimate: float = 0.0  # its middle

    @property
    def standard(self) -> float:
        """Standard uncertainty of the input."""
        return self.spread / DIVISORS[self.distribution]

    def drawn(self, generator: np.random.Generator, count: int) -> Array:
        """Return as many draws of it."""
        if self.distribution == NORMAL:
            unit = generator.standard_normal(count)
        elif self.distribution == RECTANGULAR:
            unit = generator.uniform(-1.0, 1.0, count)
        elif self.distribution == TRIANGULAR:
            unit = generator.uniform(-0.5, 0.5, count) + generator.uniform(-0.5, 0.5, count)
        else:
            unit = np.cos(np.pi * generator.uniform(0.0, 1.0, count))
        return np.asarray(self.estimate + self.spread * unit, dtype=np.float64)


class Propagated(NamedTuple):
    """Result of the law of propagation."""

    estimate: Array  # the quantities at the estimates of the inputs
    contributions: Array  # inputs x quantities: sensitivity coefficient times standard uncertainty, with its sign

    @property
    def standard(self) -> Array:
        """Combined standard uncertainties of the quantities."""
        return np.asarray(np.sqrt(np.sum(self.contributions**2, axis=0)))


class Simulated(NamedTuple):
    """Result of Monte Carlo, one number for each quantity."""

    # Mean and standard deviation of the trials
    mean: Array
    standard: Array
    # Ends of the probabilistically symmetric coverage interval of 95 %
    low: Array
    high: Array
    trials: int  # how many there were
    stable: bool  # True if all four are known to the tolerance, where they are numbers

    def validates(self, propagated: Propagated) -> NDArray[np.bool_]:
        """Tell of which quantities both intervals agree within `TOLERANCE` (JCGM 101, 8.1)."""
        half = NORMAL_FACTOR * propagated.standard
        ends = np.abs(propagated.estimate - half - self.low), np.abs(propagated.estimate + half - self.high)
        return np.asarray(np.maximum(*ends) <= TOLERANCE * self.standard)


def law_of_propagation(model: Model, inputs: Sequence[InputQuantity]) -> Propagated:
    """Return estimate and contributions by the law of propagation of uncertainty.

    Theory: :eq:`uncertainty-propagation`.

    Parameters
    ----------
    model : callable
        Rows of inputs in, rows of quantities out.
    inputs : sequence of InputQuantity
        Independent inputs, in the order of its columns.

    Returns
    -------
    Propagated
        Estimate of each quantity, and the contribution of each input to its standard uncertainty.

    Examples
    --------
    >>> both = law_of_propagation(lambda x: x[:, :1] * x[:, 1:], [InputQuantity("a", 0.3, "normal", 3.0),
    ...                                                           InputQuantity("b", 0.4, "normal", 4.0)])
    >>> both.estimate.tolist(), both.contributions.round(9).tolist()
    ([12.0], [[1.2], [1.2]])
    """
    middle = np.array([quantity.estimate for quantity in inputs])
    changes = np.diag([quantity.standard for quantity in inputs])
    rows = model(np.vstack([middle[None, :], middle + changes, middle - changes]))
    count = len(inputs)
    return Propagated(rows[0], 0.5 * (rows[1 : count + 1] - rows[count + 1 :]))


def monte_carlo(
    model: Model,
    inputs: Sequence[InputQuantity],
    seed: int = 0,
    tolerance: float = TOLERANCE / FINER,
    most: int = MOST_TRIALS,
) -> Simulated:
    """Return mean, standard uncertainty and coverage interval by the adaptive Monte Carlo procedure.

    Trials end where all four are known to ``tolerance`` standard uncertainties, or after ``most`` of them.
    """
    generator = np.random.default_rng(seed)
    batches: list[Array] = []
    figures: list[Array] = []
    stable = False
    tail = 0.5 * (1.0 - PROBABILITY)
    while not stable and TRIALS * len(batches) < most:
        batch = model(np.column_stack([quantity.drawn(generator, TRIALS) for quantity in inputs]))
        batches.append(batch)
        ends = np.quantile(batch, [tail, 1.0 - tail], axis=0)
        figures.append(np.array([np.mean(batch, axis=0), np.std(batch, axis=0, ddof=1), *ends]))
        count = len(figures)
        if count > 1:
            over = np.std(figures, axis=0, ddof=1) / math.sqrt(count)
            spread = np.std(np.concatenate(batches), axis=0, ddof=1)
            stable = bool(np.all((2.0 * over <= tolerance * spread) | np.isnan(spread)))
    every = np.concatenate(batches)
    low, high = np.quantile(every, [tail, 1.0 - tail], axis=0)
    return Simulated(np.mean(every, axis=0), np.std(every, axis=0, ddof=1), low, high, every.shape[0], stable)


GAINS = ("acceleration", "sensitivity", "amplifier", "temperature", "transverse")  # kinds that multiply the record
SPECTRAL = ("response", "resonance", "filter", "sampling")  # kinds that change its spectrum
ADDED = ("offset", "drift", "noise")  # kinds that are added to it: an amount, or a share of the peak
KINDS = (*GAINS, "linearity", *SPECTRAL, *ADDED, "coupling", "clock")
# Topics that a budget of a shock measurement holds (ISO 16063-1 and -21, from memory), with the kinds that state each
TOPICS = {
    "calibration of the sensor": ("sensitivity",),
    "gain of amplifier and recorder": ("amplifier",),
    "amplitude linearity": ("linearity",),
    "temperature": ("temperature",),
    "transverse motion": ("transverse",),
    "frequency response and mounting": ("response", "resonance"),
    "filter of the recorder": ("filter",),
    "zero shift under the blow": ("offset", "drift"),
    "AC coupling": ("coupling",),
    "clock of the recorder": ("clock",),
}
RECORD, SAMPLING = "noise and baseline", "instants of sampling"  # names of what the record itself tells
# Times its length that a stretch is lengthened to for its spectrum, so that its end does not reach its begin
PADDED = 1.25


@dataclass(frozen=True)
class Contribution:
    """One contribution of a budget, in SI."""

    kind: str  # kind of contribution; one of `KINDS`
    name: str  # name of the contribution
    # Half-width of its distribution, standard uncertainty of a normal one: a share; of offset, drift and noise the unit
    # of the record unless ``relative``; of a whole effect that is not corrected (resonance, AC coupling) 1
    spread: float
    distribution: str = NORMAL  # see `InputQuantity`
    relative: bool = True  # true if an added amount is a share of the peak
    # How its number is known, and from whom
    status: str = ""
    source: str = ""
    typed: str = ""  # the number as it stands in the budget
    frequency: float = math.nan  # cutoff of a filter, lowest resonance, Hz
    # Poles of the filter; quality factor of the resonance
    order: float = math.nan
    quality: float = math.nan
    tolerances: tuple[tuple[float, float], ...] = ()  # frequency, Hz, and share by which the response may be off there
    time_constant: float = math.nan  # time constant of an AC coupling that is not taken off, s

    @property
    def input(self) -> InputQuantity:
        """The uncertain number."""
        return InputQuantity(self.name, self.spread, self.distribution)

    def logarithm(self, drawn: Array, frequency: Array) -> Array:
        """Return by how much the logarithm of the spectrum rises, a row a draw."""
        e = drawn[:, None]
        if self.kind == "response":
            places, shares = np.array(self.tolerances).T
            with np.errstate(divide="ignore"):
                at = np.interp(np.log(np.maximum(frequency, places[0])), np.log(places), shares)
            return np.asarray(np.log1p(e * at))
        over = frequency / self.frequency
        if self.kind == "resonance":
            size = -0.5 * np.log((1.0 - over**2) ** 2 + (over / self.quality) ** 2)
            return np.asarray(e * np.maximum(size, 0.0))
        power = 2.0 * self.order
        with np.errstate(over="ignore", invalid="ignore"):
            bent = np.log1p(over**power), np.log1p((over / (1.0 + e)) ** power)
            return np.asarray(0.5 * np.where(np.isfinite(bent[0]), bent[0] - bent[1], power * np.log1p(e)))


@declare.dataclass
class BudgetEntry:
    """A contribution as a document has it."""

    name: str = declare.word("what contributes")
    kind: str = declare.word("what it changes; record, what the record itself tells")


@declare.dataclass
class StatedEntry(BudgetEntry):
    """A contribution that is stated."""

    stated: str = declare.word("its number as it stands in the budget")
    distribution: str = declare.word("its distribution")
    standard: float = declare.word("its standard uncertainty, in the unit of what it changes")
    status: str | None = declare.word("how its number is known")
    source: str | None = declare.word("from whom")


@declare.dataclass
class Budget:
    """The contributions of a channel, and what they are called together.

    Examples
    --------
    >>> Budget((Contribution("sensitivity", "certificate", 0.01),)).not_stated[:2]
    ('gain of amplifier and recorder', 'amplitude linearity')

    Attributes
    ----------
    contributions : tuple of Contribution
        As they are stated.
    """

    contributions: tuple[Contribution, ...]
    title: str | None = declare.word("its title", default=None)
    file: str | None = declare.word("file that states it; null where one share for all was stated", default=None)

    @declare.computed(declare.rows(StatedEntry, "what contributes", key="contributions"))
    def entries(self) -> list[BudgetEntry]:
        """Entries of the budget: those from the record, then those stated."""
        stated = [
            StatedEntry(c.name, c.kind, c.typed, c.distribution, c.input.standard, c.status or None, c.source or None)
            for c in self.contributions
        ]
        return [BudgetEntry(RECORD, "record"), BudgetEntry(SAMPLING, "record"), *stated]

    @property
    def amount(self) -> float:
        """Standard uncertainty of an acceleration of any size by what is added to it in amounts, not in shares."""
        return math.hypot(*(c.input.standard for c in self.contributions if c.kind in ADDED and not c.relative))

    @declare.computed(declare.word("what nobody stated"))
    def not_stated(self) -> tuple[str, ...]:
        """Topics of a usual budget that this one lacks."""
        stated = {contribution.kind for contribution in self.contributions}
        if "acceleration" in stated:
            return ()
        return tuple(topic for topic, kinds in TOPICS.items() if not stated & set(kinds))

    @property
    def indicative(self) -> tuple[str, ...]:
        """Names of contributions whose numbers are from memory."""
        return tuple(contribution.name for contribution in self.contributions if contribution.status == "indicative")

    @property
    def share(self) -> float | None:
        """The expanded uncertainty of the acceleration, k = 2, where it is all that is stated; else None."""
        only = self.contributions[0] if len(self.contributions) == 1 else None
        return COVERAGE * only.spread if only is not None and only.kind == "acceleration" else None

    @property
    def names(self) -> tuple[str, ...]:
        """Names of its contributions, those that the record tells first."""
        return RECORD, SAMPLING, *(contribution.name for contribution in self.contributions)


def of_share(share: float) -> Budget:
    """Return the budget of one expanded uncertainty of the acceleration, k = 2, for the whole channel."""
    typed = f"{100.0 * share:g} %, k = {COVERAGE:g}"
    name = f"{100.0 * share:g} % of the acceleration, as stated"
    return Budget((Contribution("acceleration", name, share / COVERAGE, NORMAL, typed=typed),))


def sampling(step: float) -> Contribution:
    """Return that of the instants of sampling: a blow falls anywhere between two of them."""
    return Contribution("sampling", SAMPLING, 0.5 * step, RECTANGULAR, typed=f"half of {step:.4g} s")


class BlowStretch(NamedTuple):
    """A stretch of a record, baseline taken off, the blow upwards."""

    values: Array  # samples
    step: float  # time between them, s
    peak: float  # peak of which added amounts are a share
    # Places of the feet of the blow, in samples
    begin: float
    end: float


def changed(stretch: BlowStretch, contributions: Sequence[Contribution], drawn: Array) -> Array:
    """Return a stretch as it would be with each row of draws; gains and clock, which change no shape, are left out.

    ``drawn`` has a column for each of the contributions.
    """
    values = np.broadcast_to(stretch.values, (drawn.shape[0], stretch.values.size))
    columns: dict[str, list[tuple[Contribution, Array]]] = {kind: [] for kind in KINDS}
    for contribution, column in zip(contributions, drawn.T, strict=True):
        columns[contribution.kind].append((contribution, column))
    spectral = [pair for kind in SPECTRAL for pair in columns[kind]]
    if spectral:
        values = _filtered(stretch, spectral)
    for _, e in columns["linearity"]:
        values = values * (1.0 + e[:, None] * values / stretch.peak)
    for contribution, e in columns["coupling"]:
        before = np.cumsum(values, axis=1) * stretch.step
        values = values + e[:, None] * before / contribution.time_constant
    place = np.arange(stretch.values.size)
    ramp = np.clip((place - stretch.begin) / (stretch.end - stretch.begin), 0.0, 1.0)
    for kind, shape in (("offset", np.ones(place.size)), ("drift", ramp)):
        for contribution, e in columns[kind]:
            values = values + e[:, None] * (stretch.peak if contribution.relative else 1.0) * shape
    return np.asarray(values)


def _filtered(stretch: BlowStretch, spectral: Sequence[tuple[Contribution, Array]]) -> Array:
    """Return a stretch with its spectrum changed, a row a draw; the padding leads from its end back to its begin."""
    from scipy.fft import irfft, next_fast_len, rfft, rfftfreq

    size = stretch.values.size
    length = next_fast_len(math.ceil(PADDED * size), real=True)
    back = np.linspace(stretch.values[-1], stretch.values[0], length - size + 2)[1:-1]
    spectrum = rfft(np.concatenate([stretch.values, back]))
    frequency = rfftfreq(length, stretch.step)
    logarithm: Array = np.zeros((1, frequency.size))
    phase: Array = np.ones((1, 1))
    for contribution, e in spectral:
        if contribution.kind == "sampling":
            phase = phase * np.exp(-2.0j * np.pi * frequency * e[:, None])
        else:
            logarithm = logarithm + contribution.logarithm(e, frequency)
    return np.asarray(irfft(spectrum * np.exp(logarithm) * phase, length, axis=1)[:, :size])


def factors_of(kinds: Sequence[str], contributions: Sequence[Contribution], drawn: Array) -> Array:
    """Return what contributions of some kinds multiply the record, or its time, by: a factor for each row of draws."""
    factors = [1.0 + e for contribution, e in zip(contributions, drawn.T, strict=True) if contribution.kind in kinds]
    return np.asarray(np.prod(factors, axis=0)) if factors else np.ones(drawn.shape[0])
