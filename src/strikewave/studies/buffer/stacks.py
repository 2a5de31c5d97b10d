"""Gasket stacks of a buffer design: which are tried, what the sensor reads on one, and its place among others."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby, product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strikewave.base import declare
from strikewave.base.constants import STANDARD_GRAVITY, material
from strikewave.base.declare import KEY, MAIN, MORE, NO_UNIT, Quantity
from strikewave.base.errors import InputError, nearest
from strikewave.base.quantities import Value
from strikewave.base.shock_quantities import LENGTH, PULSE_WIDTH, RATIO, STRESS
from strikewave.reporting.options import read_value
from strikewave.sensors import Mounting, Sensor, SensorReading, output
from strikewave.sensors.mounting import PassBand, band
from strikewave.sensors.trial import sensor_pulse
from strikewave.signal.motion import integral
from strikewave.studies.buffer import LAYERS, THICKEST, THICKNESSES
from strikewave.studies.buffer.mounting_site import (
    SOFTEST,
    STIFFEST,
    BaseMotion,
    GasketLayer,
    GasketStack,
    MountingSite,
    confined,
    loads,
    moduli,
    read_on,
    reading_of,
    spread,
    usual_materials,
    variants,
)

Array = NDArray[np.float64]

READING = Quantity("m/s^2", "g", "reading", digits=5)
OTHER_PEAK = Quantity("m/s^2", "g")
CUT_OFF = "cut off"
"""Name of a reading that is cut off at the range."""
ALIKE = 0.05
"""Stacks whose peak and bandwidth differ by less are not distinct: the moduli of a gasket are known within a factor of
two at best, which moves both by far more."""
SMALL_CHANGE = 1e-3
"""Velocity change over the integral of |a| below which no relative error of it is stated: what is left of so much
cancellation is mostly rounding and baseline."""
RINGING = 0.02
"""Swing of the velocity at the end, over its change, beyond which no error of that change is stated: the error is read
at the last sample, and the swing moves it by as much. Chosen: 2 %, the error that such a reading is wanted for."""
SHOWN_PERIODS = 0.5
"""Periods of the resonance that a history must last after the surface's largest value: an oscillator swings to one side
within half a period, and answers a blow with its largest value by then."""
BANDWIDTH_DIGITS = 2
"""Significant digits to which bandwidths are compared in a ranking: those that differ by less go by the number of
gaskets, since a thinner stack is worth more than a per cent of bandwidth."""
RANKS = ("bandwidth", "peak", "robust")
"""Criteria by which stacks that keep the limit may be ranked; see `ranked`."""


@dataclass(frozen=True)
class BufferGoal:
    """The largest reading, m/s^2, and what stacks that keep it are ranked by: bandwidth, peak or robust.

    Raises
    ------
    InputError
        If the limit is not above zero, or the rank is no known one.
    """

    limit: float
    rank: str = "bandwidth"

    def __post_init__(self) -> None:
        if not 0.0 < self.limit < math.inf:
            raise InputError("--limit", self.limit, "an acceleration above zero")
        if self.rank not in RANKS:
            raise InputError("--rank", self.rank, "one of " + ", ".join(RANKS), nearest(self.rank, RANKS))


@declare.dataclass
class Leading:
    """Numbers of the first of a ranking and of Pareto-optimal stacks alone; peaks as `true_peak`."""

    softer: float = declare.number(
        OTHER_PEAK,
        "peak with the moduli of all gaskets at the low end of their spread",
        column=MORE,
        tables="screen moduli",
    )
    stiffer: float = declare.number(
        OTHER_PEAK,
        "peak with the moduli of all gaskets at the high end of their spread",
        column=MAIN,
        tables="screen moduli",
    )
    confined: float | None = declare.number(
        OTHER_PEAK,
        "peak with the moduli of the table where the faces of elastomers cannot slip; null without elastomers",
        label="no slip",
        column=MORE,
        tables="screen moduli",
    )
    robust: bool = declare.word(
        "whether all variants keep the limit, in a history that is long enough for the softest",
        column=MAIN,
        tables="screen page",
        is_tag=True,
    )
    stress: tuple[float, ...] = declare.history(
        STRESS, "largest of each gasket: force of what lies above its middle over its area"
    )
    strain: tuple[float, ...] = declare.history(NO_UNIT, "that over the modulus")


@declare.dataclass
class StackGasket:
    """A gasket of a stack: what it is, what it bears, what is known of its modulus."""

    material: str = declare.word("material of a gasket", column=KEY)
    thickness: float = declare.number(LENGTH, "its thickness", column=MAIN)
    stress: float | None = declare.number(
        Quantity("Pa", "MPa", digits=3), "what it bears at most", label="largest stress", column=MAIN, in_document=False
    )
    strain: float | None = declare.number(
        Quantity(NO_UNIT, "%", digits=3), "that over the modulus", column=MAIN, in_document=False
    )
    moduli: str = declare.word("moduli that are tried", label="modulus, times", column=MAIN, in_document=False)
    source: str = declare.word("where the modulus is from", column=MAIN, in_document=False)


@declare.dataclass(eq=False)
class BufferCandidate:
    """A stack, and what the sensor reads on it; see `Leading` for what is computed only of some.

    Attributes
    ----------
    stack : tuple of GasketLayer
        From the surface to the sensor.
    label : str
        Name of the stack, where it is not named by its gaskets.
    """

    stack: GasketStack
    place: int | None = declare.count("in the ranking, from 1", optional=True)

    @declare.phrase("#", column=KEY, tables="screen page moduli")
    def marked_place(self) -> str:
        """Return its place, with the mark of Pareto-optimal ones."""
        return f"{self.place or ''}{'*' if self.pareto else ''}"

    @declare.computed(
        declare.word(
            "materials and thicknesses from the surface up",
            label="stack, from the surface up",
            column=MAIN,
            tables="screen page moduli",
            headline="first",
        )
    )
    def name(self) -> str:
        """Name of the stack: its gaskets from the surface to the sensor."""
        return self.label or " | ".join(str(layer) for layer in self.stack) or "direct"

    @declare.computed(declare.rows(StackGasket, "gaskets, from the surface up", optional=True))
    def gaskets(self) -> list[StackGasket] | None:
        """The gaskets, with what each bears where that was computed."""
        if self.label:
            return None
        listed = list[StackGasket]()
        for k, layer in enumerate(self.stack):
            row = material(layer.material)
            low, high = spread(row)
            stress, strain = (self.leading.stress[k], self.leading.strain[k]) if self.leading else (None, None)
            listed.append(
                StackGasket(layer.material, layer.thickness.si, stress, strain, f"{low:g} to {high:g}", row.source)
            )
        return listed

    height: float = declare.number(LENGTH._replace(digits=3), "of the whole stack")
    peak: float = declare.number(READING, "of the reading, with its sign")
    width: float = declare.number(PULSE_WIDTH, "of the reading at 10 % of its peak")
    clipped: bool = declare.word(
        "whether sensor or recorder cut it off", label=CUT_OFF, column=MAIN, tables="screen page"
    )
    element_peak: float = declare.number(READING, "what the element would put out without its range")
    true_peak: float = declare.number(
        READING,
        "largest magnitude of the reading; of the element where the reading is cut off",
        column=MAIN,
        tables="screen page",
        headline="reading on the first",
    )
    keeps: bool = declare.word(
        "whether the reading keeps the limit without being cut off", column=MAIN, tables="notebook", is_tag=True
    )
    margin: float = declare.number(
        Quantity(NO_UNIT, "%", decimals=1, digits=0),
        "one less the true peak over the limit, or over the range of sensor or recorder where that is lower",
        column=MAIN,
        tables="screen page",
    )
    pareto: bool = declare.word(
        "whether it is Pareto-optimal: no other stack has both a lower true peak and more bandwidth"
    )
    rigid_ratio: float = declare.number(RATIO, "peak over that of the rigid body; null where that is unknown")
    velocity_error: float = declare.number(
        Quantity(NO_UNIT, "%", "velocity change off by", digits=2),
        "velocity change against that of the surface, relative; null where the sensor still rings (see ringing) or the "
        "surface hardly changes its speed",
        column=MORE,
        tables="page",
    )
    ringing: float = declare.number(
        RATIO, "half the swing of sensor against surface in the last period of the resonance, over the velocity change"
    )
    loss_error: float = declare.number(RATIO, "deviation of the loss factors over their band")
    sag: float = declare.number(
        Quantity("m", "um", digits=3), "compression by the weight of what lies above, at the moduli of the table"
    )
    whole: bool = declare.word(
        "whether the history lasts half a period of the resonance after the surface's largest value: else the largest "
        "reading may come after its end"
    )
    band: PassBand = declare.part(PassBand, "what the mounting passes", inline=True)
    leading: Leading | None = declare.part(
        Leading, "what is computed only of the first ones, and of the Pareto-optimal ones", inline=True, default=None
    )
    label: str = ""

    @property
    def robust(self) -> bool:
        """True if it is known to keep the limit whatever the moduli."""
        return self.leading is not None and self.leading.robust


def true_peak(reading: SensorReading) -> float:
    """Return the largest magnitude of a reading; of the element where the reading is cut off, m/s^2.

    Examples
    --------
    >>> from strikewave.sensors import Recorder, read
    >>> true_peak(read(Sensor(range=5.0), Recorder(), [0.0, -9.0, 2.0], 1e-6))
    9.0
    """
    return reading.peak_before_clip if reading.clipped else abs(sensor_pulse(reading).peak)


def assess(site: MountingSite, stack: GasketStack, motion: BaseMotion, goal: BufferGoal) -> BufferCandidate:
    """Run one stack in time and find what it costs."""
    return dataclasses.replace(assess_mounting(site, site.mounting(stack), motion, goal), stack=stack)


def assess_mounting(
    site: MountingSite, mounting: Mounting, motion: BaseMotion, goal: BufferGoal, label: str = ""
) -> BufferCandidate:
    """Run any mounting in time and find what it costs."""
    reading, passed = read_on(site, mounting, motion), band(mounting)
    pulse, highest = sensor_pulse(reading), true_peak(reading)
    is_whole = not motion.after_peak * passed.resonance < SHOWN_PERIODS
    error, ringing = _velocity(reading, motion, passed.resonance)
    return BufferCandidate(
        stack=(),
        place=None,
        height=sum(layer.thickness for layer in mounting.gaskets),
        peak=pulse.peak,
        width=pulse.width,
        clipped=reading.clipped,
        element_peak=reading.peak_before_clip,
        true_peak=highest,
        keeps=bool(highest <= goal.limit and not reading.clipped),
        margin=1.0 - highest / min(goal.limit, site.range),
        pareto=False,
        band=passed,
        rigid_ratio=pulse.peak / motion.rigid_peak if motion.rigid_peak else math.nan,
        velocity_error=error if is_whole and ringing <= RINGING else math.nan,
        ringing=ringing,
        loss_error=max((mounting.loss(layer).error for layer in mounting.gaskets), default=0.0),
        sag=sum(STANDARD_GRAVITY * mass / layer.stiffness for mass, layer in loads(mounting)),
        whole=is_whole,
        label=label,
    )


def _velocity(reading: SensorReading, motion: BaseMotion, resonance: float) -> tuple[float, float]:
    """Return how far the velocity change is off at the end, and half its swing in the last period, both relative."""
    change = motion.velocity_change
    if abs(change) <= SMALL_CHANGE * float(np.sum(np.abs(motion.acceleration))) * motion.step or reading.time.size < 2:
        return math.nan, math.nan
    lag = integral(reading.values, float(reading.time[1] - reading.time[0]))
    error = float(lag[-1]) / change - 1.0
    if math.isnan(resonance):
        return error, 0.0
    surface = motion.start + motion.step * np.arange(motion.acceleration.size)
    lag -= np.interp(reading.time, surface, integral(motion.acceleration, motion.step))
    last = lag[reading.time >= reading.time[-1] - 1.0 / resonance]
    return error, 0.5 * float(np.ptp(last)) / abs(change)


def look_closer(site: MountingSite, candidate: BufferCandidate, motion: BaseMotion, goal: BufferGoal) -> Leading:
    """Return the sensitivity of a candidate to the moduli, and the stress and strain of its gaskets."""
    stack = candidate.stack
    mounting = site.mounting(stack)
    softer, stiffer = (_peak(site, stack, motion, moduli(stack, place)) for place in (SOFTEST, STIFFEST))
    factors = confined(stack, site.area)
    no_slip = _peak(site, stack, motion, factors) if any(factor != 1.0 for factor in factors) else None
    largest_acceleration = float(np.max(np.abs(output(Sensor(mounting=mounting), motion.acceleration, motion.step))))
    stress = tuple(mass * largest_acceleration / layer.area for mass, layer in loads(mounting))
    strain = tuple(s / layer.modulus for s, layer in zip(stress, mounting.gaskets, strict=True))
    robust = max(softer, stiffer, no_slip or 0.0) <= goal.limit and withstands(site, candidate, motion, goal)
    return Leading(softer, stiffer, no_slip, robust, stress, strain)


def withstands(site: MountingSite, candidate: BufferCandidate, motion: BaseMotion, goal: BufferGoal) -> bool:
    """Return whether a stack keeps the limit with all `variants` of its moduli; it ends at the first that does not.

    The history must last half a period of the softest variant after the surface's largest value.
    """
    stack = candidate.stack
    if not candidate.keeps or candidate.band.resonance < slowest_shown(stack, motion):
        return False
    return all(_peak(site, stack, motion, factors) <= goal.limit for factors in variants(stack, site.area))


def slowest_shown(stack: GasketStack, motion: BaseMotion) -> float:
    """Return the lowest resonance of which a history lasts `SHOWN_PERIODS` with the softest moduli, Hz."""
    softest = min((spread(material(layer.material))[0] for layer in stack), default=1.0)
    return SHOWN_PERIODS / (motion.after_peak * math.sqrt(softest)) if motion.after_peak > 0.0 else math.inf


def _peak(site: MountingSite, stack: GasketStack, motion: BaseMotion, factors: Sequence[float]) -> float:
    return true_peak(reading_of(site, stack, motion, factors))


def carries(candidate: BufferCandidate, width: float) -> bool:
    """Tell whether a stack passes within 10 % what a pulse of a width needs: one over its width, Hz.

    Else the reading is the buffer's own swing. A width of NaN, where there is no pulse, asks for nothing.
    """
    return not candidate.band.within_10 * width < 1.0


def ranked(candidates: Sequence[BufferCandidate], goal: BufferGoal, width: float = math.nan) -> list[BufferCandidate]:
    """Return candidates in order: those that keep the limit first, the others by their true peak.

    Of those that keep it the ones that carry a pulse of the width come first; see `carries`. By ``bandwidth`` the one
    that passes the highest frequency within 10 % comes first; what is equal to `BANDWIDTH_DIGITS` goes by fewer
    gaskets, then by the lower peak. By ``peak`` the lowest peak comes first. By ``robust`` those known to be robust
    come first, then by bandwidth.
    """

    def key(candidate: BufferCandidate) -> tuple[Any, ...]:
        peak = candidate.true_peak if math.isfinite(candidate.true_peak) else math.inf
        layers, bandwidth = len(candidate.stack), candidate.band.within_10
        lost = candidate.keeps and not carries(candidate, width)
        first = (not candidate.keeps, lost, goal.rank == "robust" and not candidate.robust)
        if candidate.keeps and goal.rank != "peak":
            return (*first, -float(f"{bandwidth:.{BANDWIDTH_DIGITS - 1}e}"), layers, peak)
        return (*first, peak, layers, -bandwidth)

    return sorted(candidates, key=key)


def with_pareto(candidates: Sequence[BufferCandidate]) -> list[BufferCandidate]:
    """Return candidates in the same order, those marked that are Pareto-optimal in true peak and bandwidth."""
    # by rising peak, each with more bandwidth than all before it is beaten by none
    order = sorted(range(len(candidates)), key=lambda k: (candidates[k].true_peak, -candidates[k].band.within_10))
    marked, widest = set(), -math.inf
    for k in order:
        if candidates[k].band.within_10 > widest and not math.isnan(candidates[k].true_peak):
            widest = candidates[k].band.within_10
            marked.add(k)
    return [dataclasses.replace(candidate, pareto=k in marked) for k, candidate in enumerate(candidates)]


def alike(one: BufferCandidate, other: BufferCandidate) -> bool:
    """Return whether true peak and bandwidth of two stacks are the same within `ALIKE`."""
    pairs = ((one.band.within_10, other.band.within_10), (one.true_peak, other.true_peak))
    return all(math.isclose(*pair, rel_tol=ALIKE) for pair in pairs)


def distinct(candidates: Sequence[BufferCandidate], count: int) -> list[BufferCandidate]:
    """Return the first of a ranking, those left out that are `alike` to one before."""
    first: list[BufferCandidate] = []
    for candidate in candidates:
        if len(first) == count:
            break
        if not any(alike(candidate, other) for other in first):
            first.append(candidate)
    return first


MOST_CANDIDATES = 20_000
"""More stacks than this are refused before one is tried: at about 6 ms each (measured with two
layers and a history of 2 ms) they take two minutes."""
MOST_LAYERS = 10
"""More gaskets than this in a stack are refused. Chosen: even two kinds of gasket give 2047 stacks there."""
THICKNESS_DIGITS = 12
"""Decimals of a thickness, m, by which stacks are compared: a picometre, above the rounding of a sum (1e-16 m) and
below every thickness that can be typed with sense."""


@dataclass(frozen=True)
class StackChoices:
    """Gaskets that stacks may be made of.

    Attributes
    ----------
    materials : sequence of str
        Materials by name; all polymers and elastomers by default.
    thicknesses : sequence of str or Value
        Thicknesses with units; 0.5, 1 and 2 mm by default.
    layers : int
        Largest number of gaskets in a stack.

    Examples
    --------
    >>> import strikewave
    >>> strikewave.StackChoices(["PTFE"], ["1 mm"], layers=1).layers
    1
    """

    materials: Sequence[str] = ()
    thicknesses: Sequence[str | Value] = ()
    layers: int = LAYERS


def chosen(value: Value) -> Value:
    """Return a value that says in the case where it comes from."""
    return value.model_copy(update={"note": "chosen by strikewave buffer"})


def all_stacks(choice: StackChoices) -> list[GasketStack]:
    """Return all stacks of a choice, none first; those that another one equals are left out.

    Neighbours of one material are bonded and are as one gasket of both thicknesses: 0.5 + 1 mm is 1 + 0.5 mm.

    Examples
    --------
    >>> [" | ".join(map(str, stack)) for stack in all_stacks(StackChoices(["PTFE"], ["1 mm", "2 mm"], 2))]
    ['', 'PTFE 1 mm', 'PTFE 2 mm', 'PTFE 1 mm | PTFE 2 mm', 'PTFE 2 mm | PTFE 2 mm']
    """
    names = tuple(dict.fromkeys(material(name, "--material").name for name in choice.materials or usual_materials()))
    typed = choice.thicknesses or THICKNESSES
    read = [size if isinstance(size, Value) else read_value(size, "thicknesses", "m", THICKEST) for size in typed]
    sizes = {value.si: chosen(value) for value in read}
    kinds, layers = len(names) * len(sizes), choice.layers
    if not 0 <= layers <= MOST_LAYERS:
        raise InputError("--layers", layers, f"a whole number from 0 to {MOST_LAYERS}")
    count = sum(kinds**k for k in range(layers + 1))
    if count > MOST_CANDIDATES:
        hint = "take fewer materials, thicknesses or layers"
        raise InputError("--layers", f"{layers} of {kinds} gaskets: {count} stacks", f"at most {MOST_CANDIDATES}", hint)
    single = [GasketLayer(name, value) for name in names for value in sizes.values()]
    distinct: dict[tuple[tuple[str, float], ...], GasketStack] = {}
    for count in range(choice.layers + 1):
        for stack in product(single, repeat=count):
            merged = tuple((name, round(thickness, THICKNESS_DIGITS)) for name, thickness in _bonded(stack))
            distinct.setdefault(merged, stack)
    return list(distinct.values())


def _bonded(stack: GasketStack) -> Iterator[tuple[str, float]]:
    """Yield material and whole thickness of neighbours of one material."""
    for name, group in groupby(stack, key=lambda layer: layer.material):
        yield name, sum(layer.thickness.si for layer in group)
