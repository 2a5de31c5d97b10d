"""Buffer design: gasket stacks under a sensor, ranked by what it then reads of a given blow.

The motion of the surface is given, and drives each stack of gaskets with the sensor on it; as everywhere in
`strikewave.sensors` the sensor does not load the surface back. Each candidate is run in time through the whole
chain: gaskets with mass and causal loss, resonance of the element, its range, the recorder. What it costs is
bandwidth: see `strikewave.sensors.bandwidth`.
"""

from __future__ import annotations

import csv
import dataclasses
import io
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby, product
from typing import Any

import numpy as np

from strikewave.citations import citation
from strikewave.documents import head, plain
from strikewave.errors import MISSING, InputError, nearest
from strikewave.materials import material
from strikewave.quantities import Value
from strikewave.readings import Channel, sensor_pulse, sensor_sources
from strikewave.sensors import Mounting, Reading, Sensor, output
from strikewave.sensors.bandwidth import Band, band
from strikewave.sensors.mounting import mounting_system
from strikewave.solution import Notice
from strikewave.studies.buffer_seat import Blows, Motion, Seat, Sheet, Sheets, confined, loads, read_on, reading_of
from strikewave.units import STANDARD_GRAVITY
from strikewave.validity import channel_notices

MOST_CANDIDATES = 20_000
"""More stacks than this are refused before one is tried."""
MOST_STATES = 800
"""A stack with more states is left out of the search: each would take seconds."""
LEADING = 10
"""First distinct ones of the ranking that are also tried softer and stiffer, as is the front where it keeps the limit.
"""
ALIKE = 0.05
"""Stacks whose peak and bandwidth differ by less are not distinct."""
SOFTER, STIFFER = 0.5, 2.0
"""Moduli of the gaskets are tried at these shares of their values."""
LARGE_STRAIN = 0.1
"""Compression of a gasket over its thickness beyond which small-strain values are stretched."""
FITTED_LOSS = 0.05
"""Deviation of the loss factor over its band beyond which it is warned of."""
COARSE = 0.02
"""Share of the limit beyond which a step of the recorder's bits is worth a word."""
SMALL_CHANGE = 1e-3
"""Velocity change over the integral of |a| below which no relative error of it is stated."""
RANKS = ("bandwidth", "peak")


@dataclass(frozen=True)
class Choice:
    """What stacks may be made of: materials, thicknesses, and the most layers."""

    materials: tuple[str, ...]
    thicknesses: tuple[Value, ...]
    layers: int = 3


@dataclass(frozen=True)
class Goal:
    """The largest reading, m/s^2, and what stacks that keep it are ranked by: bandwidth or peak.

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


@dataclass(frozen=True)
class Leading:
    """What is found only of the first of a ranking, and of the front.

    Attributes
    ----------
    softer, stiffer : float
        Largest magnitude of the reading, or of the element where that is cut off, with the moduli of all gaskets at
        `SOFTER` and `STIFFER`, m/s^2.
    confined : float or None
        The same where the faces of elastomers cannot slip (see `confinement`); None without elastomers.
    robust : bool
        Whether all of these keep the limit, in a history that is long enough.
    stress, strain : tuple of float
        Largest of each gasket: force of what lies above its middle over its area, Pa, and that over the modulus.
    """

    softer: float
    stiffer: float
    confined: float | None
    robust: bool
    stress: tuple[float, ...]
    strain: tuple[float, ...]


@dataclass(frozen=True, eq=False)
class Candidate:
    """A stack, and what the sensor reads on it.

    Attributes
    ----------
    sheets : tuple of Sheet
        From the surface to the sensor.
    peak, width : float
        Of the reading, with its sign, m/s^2, and at 10 % of the peak, s.
    clipped : bool
        Whether sensor or recorder cut it off.
    element_peak : float
        What the element would put out without its range, m/s^2.
    keeps : bool
        Whether the reading keeps the limit without being cut off.
    margin : float
        One less |peak| over the limit.
    band : Band
        What the mounting passes.
    rigid_ratio, velocity_error : float
        Peak over that of the rigid body; velocity change against that of the surface, relative; NaN where unknown.
    loss_error : float
        Deviation of the loss factors over their band.
    sag : float
        Compression by the weight of what lies above, at the moduli of the table, m.
    whole : bool
        Whether the history lasts half a period of the resonance after the surface's largest value: else the largest
        reading may come after its end.
    pareto : bool
        Whether no other stack has both a lower peak and more bandwidth.
    leading : Leading or None
        What is found only of the first ones, and of those on the front.
    """

    sheets: Sheets
    peak: float
    width: float
    clipped: bool
    element_peak: float
    keeps: bool
    margin: float
    band: Band
    rigid_ratio: float
    velocity_error: float
    loss_error: float
    sag: float
    whole: bool
    pareto: bool = False
    leading: Leading | None = None

    @property
    def name(self) -> str:
        """What it is called: its gaskets from the surface to the sensor."""
        return " | ".join(str(sheet) for sheet in self.sheets) or "direct"

    @property
    def height(self) -> float:
        """Of the whole stack, m."""
        return float(sum(sheet.thickness.si for sheet in self.sheets))


@dataclass(frozen=True, eq=False)
class BufferStudy:
    """Ranked stacks for one sensor and one blow; see `design_buffer`."""

    seat: Seat
    blows: Blows
    goal: Goal
    candidates: tuple[Candidate, ...]
    warnings: tuple[Notice, ...]

    @property
    def motion(self) -> Motion:
        """The blow that the stacks are designed for."""
        return self.blows.motion

    @property
    def best(self) -> Candidate | None:
        """First of the ranking that keeps the limit; None where none does."""
        return self.candidates[0] if self.candidates[0].keeps else None

    @property
    def broken(self) -> bool:
        """Whether no stack keeps the limit."""
        return self.best is None

    @property
    def robust(self) -> Candidate | None:
        """First of the ranking that is known to keep the limit with softer and stiffer gaskets; None where none is."""
        return next((c for c in self.candidates if c.leading is not None and c.leading.robust), None)

    @property
    def held(self) -> Channel:
        """The sensor on the first stack, and its recorder."""
        mounting = self.seat.mounting(self.candidates[0].sheets)
        return self.seat.channel._replace(sensor=self.seat.sensor(mounting))

    @property
    def direct(self) -> Candidate:
        """The sensor without gaskets."""
        return next(candidate for candidate in self.candidates if not candidate.sheets)

    def reading(self, candidate: Candidate) -> Reading:
        """Return what the recorder keeps with a stack."""
        return reading_of(self.seat, candidate.sheets, self.motion)

    def document(self) -> dict[str, Any]:
        """Return the JSON document."""
        motion, sensor = self.motion, self.seat.channel.sensor
        blow = {
            "name": motion.name,
            "surface_peak": motion.peak,
            "surface_velocity_change": motion.velocity_change,
            "rigid_peak": motion.rigid_peak,
            "duration": motion.step * (motion.acceleration.size - 1),
        }
        held = {
            "name": self.seat.table.name,
            "mass": self.seat.mass,
            "area": self.seat.area,
            **{key: getattr(sensor, key) for key in ("resonance", "quality", "range")},
            "sampling_rate": self.seat.channel.recorder.sampling_rate,
        }
        rows = [_row(place, candidate) for place, candidate in enumerate(self.candidates, 1)]
        used = {sheet.material: material(sheet.material) for c in self.candidates for sheet in c.sheets}
        origin = {name: {"status": row.status, "source": row.source, "note": row.note} for name, row in used.items()}
        warnings = [{k: v for k, v in dataclasses.asdict(n).items() if k != "broken"} for n in self.warnings]
        return dict(
            plain(
                {
                    **head(UNITS, warnings),
                    "limit": self.goal.limit,
                    "rank": self.goal.rank,
                    "kept": not self.broken,
                    "robust": None if self.robust is None else self.robust.name,
                    "back_effect": "none: the motion of the surface is given, the sensor does not load it back",
                    "sources": [citation(key) for key in (*sensor_sources([self.held]), "gent-lindley-1959")],
                    "materials": origin,
                    "sensor": held,
                    "blow": blow,
                    "candidates": rows,
                }
            )
        )

    def table(self) -> str:
        """Return all candidates as CSV text, every column with its unit."""
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        rows = [_row(place, candidate) for place, candidate in enumerate(self.candidates, 1)]
        columns = [key for key in rows[0] if key not in ("gaskets", "stress", "strain")]
        writer.writerow([f"{key} [{UNITS[key]}]" if key in UNITS else key for key in columns])
        for row in rows:
            writer.writerow(["" if row[key] in (None, math.inf) else _cell(row[key]) for key in columns])
        return text.getvalue()


UNITS = {
    "limit": "m/s^2", "mass": "kg", "area": "m^2", "resonance": "Hz", "quality": "1", "range": "m/s^2",
    "sampling_rate": "Hz", "surface_peak": "m/s^2", "surface_velocity_change": "m/s", "rigid_peak": "m/s^2",
    "duration": "s", "thickness": "m", "height": "m", "peak": "m/s^2", "width": "s", "element_peak": "m/s^2",
    "margin": "1", "within_5": "Hz", "within_10": "Hz", "half_power": "Hz", "largest": "1", "largest_at": "Hz",
    "rigid_ratio": "1", "velocity_error": "1", "loss_error": "1", "sag": "m", "softer": "m/s^2",
    "stiffer": "m/s^2", "confined": "m/s^2", "stress": "Pa", "strain": "1",
}  # fmt: skip
"""SI unit of each quantity of the document."""


def _row(place: int, candidate: Candidate) -> dict[str, Any]:
    """Return a candidate as one flat row."""
    found = candidate.leading
    own = {key: getattr(candidate, key) for key in _OWN}
    leading = {f.name: getattr(found, f.name, None) for f in dataclasses.fields(Leading)}
    gaskets = [{"material": sheet.material, "thickness": sheet.thickness.si} for sheet in candidate.sheets]
    return {
        "place": place,
        "name": candidate.name,
        "gaskets": gaskets,
        **own,
        **candidate.band._asdict(),
        **leading,
    }


_OWN = (
    "height", "peak", "width", "clipped", "element_peak", "keeps", "margin", "pareto", "rigid_ratio",
    "velocity_error", "loss_error", "sag", "whole",
)  # fmt: skip


def _cell(value: Any) -> Any:
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return "" if math.isnan(value) else f"{value:.9g}"
    return value


def stacks(choice: Choice) -> list[Sheets]:
    """Return all stacks of a choice, none first; those that another one equals are left out.

    Neighbours of one material are bonded and are as one gasket of both thicknesses: 0.5 + 1 mm is 1 + 0.5 mm.

    Raises
    ------
    InputError
        If there is nothing to choose from, or far too much.

    Examples
    --------
    >>> thin, thick = Value(si=1e-3, typed="1 mm"), Value(si=2e-3, typed="2 mm")
    >>> [" | ".join(map(str, found)) for found in stacks(Choice(("PTFE",), (thin, thick), 2))]
    ['', 'PTFE 1 mm', 'PTFE 2 mm', 'PTFE 1 mm | PTFE 2 mm', 'PTFE 2 mm | PTFE 2 mm']
    """
    names = tuple(dict.fromkeys(material(name, "--material").name for name in choice.materials))
    sizes = {value.si: value for value in choice.thicknesses}
    _check_count(len(names) * len(sizes), choice.layers)
    sheets = [Sheet(name, value) for name in names for value in sizes.values()]
    found: dict[tuple[tuple[str, float], ...], Sheets] = {}
    for layers in range(choice.layers + 1):
        for stack in product(sheets, repeat=layers):
            merged = tuple((name, round(size, 12)) for name, size in _runs(stack))
            found.setdefault(merged, stack)
    return list(found.values())


def _check_count(kinds: int, layers: int) -> None:
    """Refuse nothing to choose from, and more stacks than may be tried."""
    if not kinds:
        raise InputError("--thickness", MISSING, "at least one material and one thickness")
    if not 0 <= layers <= 10:
        raise InputError("--layers", layers, "a whole number from 0 to 10")
    count = sum(kinds**k for k in range(layers + 1))
    if count > MOST_CANDIDATES:
        hint = "take fewer materials, thicknesses or layers"
        raise InputError("--layers", f"{layers} of {kinds} gaskets: {count} stacks", f"at most {MOST_CANDIDATES}", hint)


def _runs(sheets: Sheets) -> Iterator[tuple[str, float]]:
    """Yield material and whole thickness of neighbours of one material."""
    for name, group in groupby(sheets, key=lambda sheet: sheet.material):
        yield name, sum(sheet.thickness.si for sheet in group)


def assess(seat: Seat, sheets: Sheets, motion: Motion, goal: Goal) -> Candidate:
    """Run one stack in time and find what it costs."""
    mounting = seat.mounting(sheets)
    reading, passed = read_on(seat, mounting, motion), band(mounting)
    pulse, change = sensor_pulse(reading), motion.velocity_change
    known = abs(change) > SMALL_CHANGE * float(np.sum(np.abs(motion.acceleration))) * motion.step
    kept = float(np.trapezoid(reading.values, reading.time))
    clipped = reading.clipped
    return Candidate(
        sheets=sheets,
        peak=pulse.peak,
        width=pulse.width,
        clipped=clipped,
        element_peak=reading.peak_before_clip,
        keeps=bool(abs(pulse.peak) <= goal.limit and not clipped),
        margin=1.0 - abs(pulse.peak) / goal.limit,
        band=passed,
        rigid_ratio=pulse.peak / motion.rigid_peak if motion.rigid_peak else math.nan,
        velocity_error=kept / change - 1.0 if known else math.nan,
        loss_error=max((mounting.loss(layer).error for layer in mounting.gaskets), default=0.0),
        sag=sum(STANDARD_GRAVITY * mass / layer.stiffness for mass, layer in loads(mounting)),
        whole=not motion.after_peak * passed.resonance < 0.5,
    )


def look_closer(seat: Seat, candidate: Candidate, motion: Motion, goal: Goal) -> Candidate:
    """Return a candidate with its sensitivity to the moduli, and the stress and strain of its gaskets."""
    sheets = candidate.sheets
    mounting = seat.mounting(sheets)

    def peak(factors: Sequence[float]) -> float:
        reading = reading_of(seat, sheets, motion, factors)
        return reading.peak_before_clip if reading.clipped else abs(sensor_pulse(reading).peak)

    softer, stiffer = (peak([factor] * len(sheets)) for factor in (SOFTER, STIFFER))
    factors = confined(sheets, seat.area)
    held = peak(factors) if any(factor != 1.0 for factor in factors) else None
    moved = float(np.max(np.abs(output(Sensor(mounting=mounting), motion.acceleration, motion.step))))
    stress = tuple(mass * moved / layer.area for mass, layer in loads(mounting))
    strain = tuple(s / layer.modulus for s, layer in zip(stress, mounting.gaskets, strict=True))
    worst = max(abs(candidate.peak), softer, stiffer, held or 0.0)
    robust = candidate.keeps and candidate.whole and worst <= goal.limit
    return dataclasses.replace(candidate, leading=Leading(softer, stiffer, held, robust, stress, strain))


def ranked(candidates: Sequence[Candidate], goal: Goal) -> list[Candidate]:
    """Return candidates in order: those that keep the limit first, the others by their peak.

    By ``bandwidth`` the one that passes the highest frequency within 10 % comes first; what is equal to two digits
    goes by fewer gaskets, then by the lower peak. By ``peak`` the lowest peak comes first. A reading that was cut
    off counts with the peak of the element.
    """

    def key(candidate: Candidate) -> tuple[Any, ...]:
        height = candidate.element_peak if candidate.clipped else abs(candidate.peak)
        height = height if math.isfinite(height) else math.inf
        layers, wide = len(candidate.sheets), candidate.band.within_10
        if candidate.keeps and goal.rank == "bandwidth":
            return (False, -float(f"{wide:.1e}"), layers, height)
        return (not candidate.keeps, height, layers, -wide)

    return sorted(candidates, key=key)


def with_front(candidates: Sequence[Candidate]) -> list[Candidate]:
    """Return candidates with those marked that no other one beats in both peak and bandwidth, in the same order."""
    order = sorted(range(len(candidates)), key=lambda k: (abs(candidates[k].peak), -candidates[k].band.within_10))
    marked, widest = set(), -math.inf
    for k in order:
        if candidates[k].band.within_10 > widest and not math.isnan(candidates[k].peak):
            widest = candidates[k].band.within_10
            marked.add(k)
    return [dataclasses.replace(candidate, pareto=k in marked) for k, candidate in enumerate(candidates)]


def distinct(candidates: Sequence[Candidate], count: int) -> list[Candidate]:
    """Return the first of a ranking, those left out that have peak and bandwidth of one before within `ALIKE`."""

    def alike(one: Candidate, other: Candidate) -> bool:
        pairs = ((one.band.within_10, other.band.within_10), (one.element_peak, other.element_peak))
        return all(math.isclose(*pair, rel_tol=ALIKE) for pair in pairs)

    found: list[Candidate] = []
    for candidate in candidates:
        if len(found) == count:
            break
        if not any(alike(candidate, other) for other in found):
            found.append(candidate)
    return found


def design_buffer(
    seat: Seat, blows: Blows, choice: Choice, goal: Goal, progress: Callable[[float], None] | None = None
) -> BufferStudy:
    """Rank all stacks of a choice for a sensor, a blow, and a limit on what it may read.

    Parameters
    ----------
    seat : Seat
        The sensor.
    blows : Blows
        The blow, and the others of its run, which the best stack is tried on too.
    choice : Choice
        What stacks may be made of.
    goal : Goal
        The limit, and what decides among those that keep it.
    progress : callable, optional
        Called with the share done, 0 to 1.

    Raises
    ------
    InputError, InputErrors
        If there are too many stacks, or the sensor's recorder does not fit the history.
    """
    found, skipped, every = [], 0, stacks(choice)
    for k, sheets in enumerate(every):
        if _too_large(seat.mounting(sheets)):
            skipped += 1
        else:
            found.append(assess(seat, sheets, blows.motion, goal))
        if progress is not None:
            progress((k + 1) / len(every))
    order = ranked(with_front(found), goal)
    looked = distinct(order, LEADING)
    order = [
        look_closer(seat, one, blows.motion, goal) if one in looked or (one.pareto and one.keeps) else one
        for one in order
    ]
    study = BufferStudy(seat, blows, goal, tuple(order), ())
    return dataclasses.replace(study, warnings=(*blows.warnings, *_notices(study, skipped)))


def _g(acceleration: float) -> str:
    """Write an acceleration in g."""
    return f"{acceleration / STANDARD_GRAVITY:.0f} g"


def _too_large(mounting: Mounting) -> bool:
    try:
        return mounting_system(mounting).b.size > MOST_STATES
    except ValueError:
        return True


def _notices(study: BufferStudy, skipped: int) -> Iterator[Notice]:
    """Yield what to know of the search, of the first stack, and of its materials."""
    if skipped:
        message = f"{skipped} stacks are left out: too many wavelengths thick, each would take seconds to try"
        yield Notice("stack-left-out", message, float(skipped), 0.0)
    first, limit = study.candidates[0], study.goal.limit
    if study.broken:
        yield _why_none(study)
    if first.sheets:
        yield from _gasket_notices(study, first)
    yield from _other_blows(study, first)
    reading = study.reading(first)
    pulses = [{study.held.sensor.name: sensor_pulse(reading)}]
    yield from channel_notices([study.held], pulses, study.blows.assembly_mass)
    if not first.whole:
        message = (
            f"the history ends {study.motion.after_peak * 1e6:.4g} us after the surface's largest value, before "
            f"{first.name} has swung to one side at {first.band.resonance:.4g} Hz: its largest reading may come later"
        )
        yield Notice("short-history", message, study.motion.after_peak, 0.5 / first.band.resonance)
    if reading.quantum > COARSE * limit:
        message = f"a step of the recorder is {_g(reading.quantum)} for a limit of {_g(limit)}: take a smaller range"
        yield Notice("coarse-steps", message, reading.quantum, COARSE * limit)
    found = first.leading
    if found is not None and first.keeps and not found.robust:
        most, firm = max(found.softer, found.stiffer, found.confined or 0.0), study.robust
        message = (
            f"{first.name} keeps the limit only with the moduli of the table: at {SOFTER:g} or {STIFFER:g} times, or "
            f"with elastomers that cannot slip, the sensor reads up to {_g(most)}; measure the "
            "gaskets, or take one that is robust: "
        )
        message += f"{firm.name} is" if firm else "none of the first ones and of the front is"
        yield Notice("not-robust", message, most, limit)


def _why_none(study: BufferStudy) -> Notice:
    """Say that no stack keeps the limit, which comes nearest, and what stands against it."""
    first, motion, limit = study.candidates[0], study.motion, study.goal.limit
    value = first.element_peak if first.clipped else abs(first.peak)
    bound = study.seat.channel.sensor.range if first.clipped else limit
    message = (
        f"no stack keeps {_g(limit)}: the nearest, {first.name}, gives "
        f"{_g(value)} at the {'element' if first.clipped else 'reading'}"
    )
    if first.clipped and value > bound:
        message += f", beyond the range of {_g(bound)}"
    if motion.rigid_peak is not None and abs(motion.rigid_peak) > limit:
        message += (
            f"; the rigid-body pulse itself has {_g(abs(motion.rigid_peak))}, so that a buffer "
            "that keeps the limit no longer reads it"
        )
    return Notice("limit-not-kept", message + "; try softer or thicker gaskets, or more layers", value, bound, True)


def _gasket_notices(study: BufferStudy, first: Candidate) -> Iterator[Notice]:
    """Yield what the gaskets of the first stack are taken beyond, and where their numbers come from."""
    assert first.leading is not None
    for sheet, stress, strain in zip(first.sheets, first.leading.stress, first.leading.strain, strict=True):
        strength = material(sheet.material).yield_strength
        if strength is not None and stress > strength:
            message = f"{sheet} carries {stress / 1e6:.3g} MPa, beyond its yield strength of {strength / 1e6:.3g} MPa"
            yield Notice("gasket-yield", message, stress, strength)
        if strain > LARGE_STRAIN:
            message = f"{sheet} is compressed by {strain:.0%}: its modulus is that of small strain; it stiffens"
            yield Notice("gasket-strain", message, strain, LARGE_STRAIN)
    if first.loss_error > FITTED_LOSS:
        message = f"the loss factor of {first.name} is held to {first.loss_error:.0%} over its band only"
        yield Notice("loss-fit", message, first.loss_error, FITTED_LOSS)
    stiffer = max(confined(first.sheets, study.seat.area))
    if stiffer > STIFFER:
        message = (
            f"the elastomer is thin for its width: where its faces cannot slip it is up to {stiffer:.3g} times as "
            "stiff as reckoned (Gent & Lindley); no slip shows what is then read"
        )
        yield Notice("elastomer-confined", message, stiffer, STIFFER)
    for name in dict.fromkeys(sheet.material for sheet in first.sheets):
        row = material(name)
        if row.status != "checked":
            yield Notice("material-from-memory", f"{name}: {row.note}", 1.0, 0.0)


def _other_blows(study: BufferStudy, first: Candidate) -> Iterator[Notice]:
    """Yield whether the first stack breaks the limit in another blow of the run."""
    others = [motion for motion in study.blows.motions if motion is not study.motion]
    peaks = [(abs(sensor_pulse(reading_of(study.seat, first.sheets, m)).peak), m.name) for m in others]
    worst, name = max(peaks, default=(0.0, ""))
    if first.keeps and worst > study.goal.limit:
        message = f"in {name} the sensor reads {_g(worst)} with {first.name}: try --blow"
        yield Notice("other-blow", message, worst, study.goal.limit)
