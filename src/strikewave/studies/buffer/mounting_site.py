"""The site of a buffer: sensor, footprint, motion of the surface in each blow, and moduli of gaskets."""

from __future__ import annotations

import dataclasses
import hashlib
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import groupby
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.analyses.machine.notices import balance_of, notices, wave_notices
from strikewave.analyses.machine.observe import contact_answers, observe
from strikewave.analyses.wave.run import run_wave
from strikewave.base import declare
from strikewave.base.constants import Material, material, materials
from strikewave.base.declare import KEY, MAIN, Quantity
from strikewave.base.errors import MISSING, InputError, checked, nearest
from strikewave.base.quantities import Value
from strikewave.base.result import Notice, Verdict, balance_notices
from strikewave.base.shock_quantities import MICROSECONDS, PULSE_WIDTH
from strikewave.cases.case import Case
from strikewave.cases.stack_of_case import area_of, build_channels, need
from strikewave.cases.tables.stack import GasketTable, SensorTable
from strikewave.sensors import Gasket, Mounting, Recorder, Sensor, SensorReading, accelerometer, read
from strikewave.sensors.mounting import RESOLVED
from strikewave.sensors.trial import SensorChannel, shortest_period
from strikewave.signal.pulse import largest, measure_pulse

if TYPE_CHECKING:
    from strikewave.records.measuring import RecordedPulse

Array = NDArray[np.float64]

SURFACE = Quantity("m/s^2", "g")
MOST_LISTED = 40
"""Blows that an error lists: more would not stand in a line of a screen."""


class GasketLayer(NamedTuple):
    """One gasket of a stack: material of the table, and thickness."""

    material: str
    thickness: Value

    def __str__(self) -> str:
        """Return what it is called."""
        return f"{self.material} {self.thickness.typed}"


GasketStack = tuple[GasketLayer, ...]
"""Gaskets from the surface to the sensor; none is a direct mounting."""


def usual_materials() -> tuple[str, ...]:
    """Return the polymers and elastomers of the table that have a loss factor.

    Examples
    --------
    >>> usual_materials()
    ('PMMA', 'polycarbonate', 'PTFE', 'rubber')
    """
    soft = ("polymer", "elastomer")
    return tuple(name for name, row in materials().items() if row.kind in soft and row.loss_factor is not None)


class ExistingBuffer(NamedTuple):
    """The buffer that a case has before the search: what it is called, and the mounting."""

    name: str
    mounting: Mounting


@dataclass(frozen=True)
class MountingSite:
    """A sensor, its recorder, and what is the same below it whatever the stack.

    Attributes
    ----------
    channel : SensorChannel
        Sensor, tap and recorder; the mounting in it does not count.
    table : SensorTable
        Table of the sensor in a case.
    footprint : dict
        ``diameter`` or ``area`` of its gaskets.
    mass, area : float
        Mass of the sensor, kg, and area of the gaskets, m^2.
    present : ExistingBuffer or None
        The buffer that the case has now.
    """

    channel: SensorChannel
    table: SensorTable
    footprint: dict[str, Value]
    mass: float
    area: float
    present: ExistingBuffer | None = None

    @property
    def range(self) -> float:
        """Largest reading of sensor and recorder, m/s^2."""
        full_scale = self.channel.recorder.full_scale
        return min(self.channel.sensor.range, math.inf if full_scale is None else full_scale)

    def mounting(self, stack: GasketStack, stiffer: Sequence[float] = ()) -> Mounting:
        """Return sensor and gaskets on the edge contact; ``stiffer`` multiplies the modulus of each gasket."""
        if not stack:
            return Mounting()
        edge = self.table.edge_stiffness.si if self.table.edge_stiffness else math.inf
        damping = self.table.edge_damping.si if self.table.edge_damping else 0.0
        factors = stiffer or [1.0] * len(stack)
        gaskets = [gasket(layer, self.area, factor) for layer, factor in zip(stack, factors, strict=True)]
        return Mounting(tuple(gaskets), self.mass, edge, damping)

    def sensor(self, mounting: Mounting) -> Sensor:
        """Return the sensor on a mounting."""
        return dataclasses.replace(self.channel.sensor, mounting=mounting)


def gasket(layer: GasketLayer, area: float, stiffer: float = 1.0) -> Gasket:
    """Return a gasket of a material of the table.

    Examples
    --------
    >>> gasket(GasketLayer("PTFE", Value(si=1e-3, typed="1 mm")), 1e-4).stiffness
    47500000.0
    """
    row = material(layer.material)
    modulus = stiffer * row.youngs_modulus
    return Gasket(row.density, modulus, area, layer.thickness.si, row.loss_factor or 0.0)


@declare.dataclass(eq=False)
class BaseMotion:
    """The motion of the surface below the sensor in one blow.

    Attributes
    ----------
    acceleration : ndarray
        m/s^2, at even steps, from rest.
    step, start : float
        Time between samples, and of the first one, s.
    touched : float
        Time of first touch after a sampling instant of the recorder, s; the first sample where ``start`` is 0.
    rigid_width : float or None
        Pulse width of the rigid-body acceleration, where it is known, at 10 % of its peak, s.
    recorded : RecordedPulse or None
        The blow as `strikewave record` measures it, where it was measured: above its own baseline, without noise.
    """

    name: str = declare.word("blow at which the stacks are compared", label="blow", column=KEY)
    acceleration: Array = field(repr=False)
    step: float
    start: float = 0.0
    touched: float = 0.0

    @declare.computed(
        declare.number(
            SURFACE,
            "peak of the acceleration of the surface",
            key="surface_peak",
            label="peak of the surface",
            column=MAIN,
        )
    )
    def peak(self) -> float:
        """Peak of the surface: of a record that of its blow, else the value of largest magnitude."""
        return self.largest_sample if self.recorded is None else self.recorded.peak

    largest_sample = declare.computed(
        declare.number(SURFACE, "largest value of the surface: of a record with its noise, of which its peak is free")
    )(lambda one: largest(one.acceleration))

    @declare.computed(
        declare.number(
            Quantity("m/s", "m/s", digits=3),
            "velocity change of the surface",
            key="surface_velocity_change",
            label="velocity change of the surface",
            column=MAIN,
        )
    )
    def surface_change(self) -> float:
        """Velocity change of the surface: of a record that of its blow, else over the history."""
        return self.velocity_change if self.recorded is None else self.recorded.velocity_change

    rigid_peak: float | None = declare.number(
        SURFACE, "peak of the rigid-body acceleration", label="rigid-body peak", column=MAIN, default=None
    )

    @declare.computed(declare.number(PULSE_WIDTH, "width of that pulse", key="pulse_width"))
    def width(self) -> float:
        """Width of the pulse at 10 % of its peak: of the rigid body where it is known, else of the surface."""
        if self.recorded is not None:
            return self.recorded.width
        return pulse_width(self.acceleration, self.step) if self.rigid_width is None else self.rigid_width

    duration = declare.computed(declare.number(MICROSECONDS, "length of the history"))(
        lambda one: one.step * (one.acceleration.size - 1)
    )

    rigid_width: float | None = None
    recorded: RecordedPulse | None = field(default=None, repr=False)

    @cached_property
    def text(self) -> str:
        """All that it is, as a text."""
        return f"{self} {hashlib.sha256(np.asarray(self.acceleration, '<f8').tobytes()).hexdigest()}"

    @property
    def after_peak(self) -> float:
        """Time from the value of largest magnitude to the end, s."""
        return self.step * (self.acceleration.size - 1 - int(np.argmax(np.abs(self.acceleration))))

    @property
    def velocity_change(self) -> float:
        """Integral over the history, m/s."""
        return float(np.trapezoid(self.acceleration, dx=self.step))

    def phase(self, rate: float) -> float:
        """Return the share of a sampling interval from the start to the recorder's first instant."""
        samples = 0.0 if math.isinf(rate) else (self.touched + self.start) * rate
        return min(math.ceil(samples) - samples, 1.0 - 1e-9)  # below 1: rounding may put a start just after an instant


def pulse_width(values: Array, step: float) -> float:
    """Return the width at 10 % of the value of largest magnitude, s; NaN where there is none.

    Examples
    --------
    >>> pulse_width(-np.sin(np.pi * np.linspace(0.0, 1.0, 201)), 5e-3).__round__(3)
    0.936
    """
    upright = values * math.copysign(1.0, largest(values)) if values.size > 2 else values
    return measure_pulse(upright, step).width if upright.size > 2 and upright.max() > 0.0 else math.nan


def loads(mounting: Mounting) -> list[tuple[float, Gasket]]:
    """Return each gasket with the mass above its middle, kg, from the surface up."""
    above, masses = mounting.sensor_mass, []
    for layer in reversed(mounting.gaskets):
        masses.append((above + 0.5 * layer.mass, layer))
        above += layer.mass
    return masses[::-1]


def reading_of(
    site: MountingSite, stack: GasketStack, motion: BaseMotion, stiffer: Sequence[float] = ()
) -> SensorReading:
    """Return what the recorder keeps of a blow with a stack under the sensor.

    Raises
    ------
    InputErrors
        If the recorder's filter or rate does not fit the history.
    """
    return read_on(site, site.mounting(stack, stiffer), motion)


def read_on(site: MountingSite, mounting: Mounting, motion: BaseMotion) -> SensorReading:
    """Return what the recorder keeps of a blow on a mounting."""
    recorder = site.channel.recorder
    phase = motion.phase(recorder.sampling_rate)
    return checked(
        f"sensor.{site.table.name}",
        lambda: read(site.sensor(mounting), recorder, motion.acceleration, motion.step, motion.start, phase),
    )


class Blows(NamedTuple):
    """All blows that a design knows of.

    Attributes
    ----------
    motions : tuple of BaseMotion
        One a blow.
    chosen : int
        Place of the one that stacks are designed for.
    warnings : tuple of Notice
        Warnings of the run that they come from.
    assembly_mass : float
        Mass of the assembly that the sensor sits on, kg; infinite where it is not known.
    verdict : str
        Outcome of the checks of that run, `strikewave.base.result.Verdict.text`; empty for a measured blow.
    """

    motions: tuple[BaseMotion, ...]
    chosen: int = 0
    warnings: tuple[Notice, ...] = ()
    assembly_mass: float = math.inf
    verdict: str = ""

    @property
    def motion(self) -> BaseMotion:
        """The chosen one."""
        return self.motions[self.chosen]


def choose_sensor(case: Case, name: str | None = None) -> SensorTable:
    """Return the sensor of a case by its name; the only one needs none."""
    names = [sensor.name for sensor in case.sensor]
    if not names:
        hint = "add [[sensor]] with name, tap, mass and a [[sensor.gasket]]; see docs/sensors.md"
        raise InputError("sensor", MISSING, "a [[sensor]] in the case", hint)
    if name is None and len(names) > 1:
        raise InputError("--sensor", MISSING, "the name of a sensor", nearest("", names))
    if name is not None and name not in names:
        raise InputError("--sensor", name, "the name of a sensor of the case", nearest(name, names))
    return case.sensor[0 if name is None else names.index(name)]


def mounting_site_of(
    table: SensorTable, case: Case | None = None, footprint: Mapping[str, Value] | None = None
) -> MountingSite:
    """Return the site of a sensor; its footprint is that of its first gasket where none is given.

    Without a case the recorder is ideal.
    """
    bare = table.model_copy(update={"gasket": ()})
    if case is not None:
        (channel,) = build_channels(case.model_copy(update={"sensor": (bare,)}))
    else:
        known = accelerometer(table.model, "--model").mounted() if table.model else Sensor()
        channel = SensorChannel(dataclasses.replace(known, name=table.name), None, Recorder())
    shape = dict(footprint or {})
    for key in ("diameter", "area") if table.gasket and not shape else ():
        value = getattr(table.gasket[0], key)
        shape |= {key: value} if value is not None else {}
    path = f"sensor.{table.name}"
    mass = need(table.mass, f"{path}.mass", "the mass of the sensor", 'add --mass "5 gram"')
    if not shape:
        raise InputError(f"{path}.gasket", MISSING, "the footprint of the sensor", 'add --diameter "15 mm"')
    gasket_table = GasketTable(material="", thickness=Value(si=1.0, typed="1 m"), **shape)
    return MountingSite(channel, bare, shape, mass, area_of(gasket_table, f"{path}.gasket"), _present(case, table))


def _present(case: Case | None, table: SensorTable) -> ExistingBuffer | None:
    """Return the buffer that a sensor of a case has now; None where it has none."""
    if case is None or not table.gasket:
        return None
    (channel,) = build_channels(case.model_copy(update={"sensor": (table,)}))
    name = " | ".join(f"{layer.material or 'gasket'} {layer.thickness.typed}" for layer in table.gasket)
    return ExistingBuffer(f"now: {name}", channel.sensor.mounting)


def table_with(site: MountingSite, stack: GasketStack) -> SensorTable:
    """Return what a case says of the sensor with a stack under it."""
    layers = tuple(GasketTable(material=layer.material, thickness=layer.thickness, **site.footprint) for layer in stack)
    return site.table.model_copy(update={"gasket": layers})


def case_with(case: Case, site: MountingSite, stack: GasketStack) -> Case:
    """Return a case with a stack under its sensor."""
    buffered = table_with(site, stack)
    sensors = tuple(buffered if sensor.name == buffered.name else sensor for sensor in case.sensor)
    return case.model_copy(update={"sensor": sensors})


def blows_of(
    case: Case, table: SensorTable, blow: str = "worst", progress: Callable[[float], None] | None = None
) -> Blows:
    """Run a case and return how the surface below a sensor moves in each blow.

    An ideal sensor in the place of the others reads the motion of the surface, before any filter.

    Parameters
    ----------
    case : Case
        A machine, or a bar alone, which has one blow.
    table : SensorTable
        The sensor: where it sits.
    blow : str, optional
        ``worst`` (largest magnitude at the surface), ``first``, or a number from 1.
    progress : callable, optional
        Called with the share of a machine's run done.
    """
    bare = case.model_copy(update={"sensor": (SensorTable(name=table.name, tap=table.tap),)})
    _check_blow(blow, case)
    if case.machine is None:
        solution = run_wave(bare, min(1.0 / RESOLVED, shortest_period(build_channels(case))))
        motion = _motion("the load of the bar", solution.readings[0])
        width = pulse_width(solution.rigid, motion.step)
        motion = dataclasses.replace(motion, rigid_peak=largest(solution.rigid), rigid_width=width)
        return Blows((motion,), 0, solution.warnings, solution.run.stack.mass, solution.own_verdict.text)
    observed = observe(bare, progress)
    pairs = [(blow, h) for blow, h in zip(observed.blows, observed.histories, strict=True) if h is not None]
    motions = tuple(
        dataclasses.replace(
            _motion(f"blow {struck.index}", history.readings[0]),
            touched=struck.time - observed.view.recorder_begin,
            rigid_peak=struck.rigid_peak,
            rigid_width=struck.width,
        )
        for struck, history in pairs
    )
    if not motions:
        raise InputError("--blow", blow, "a case in which a striker touches the object", "see `strikewave run`")
    first = next(struck for struck, _ in pairs)
    warnings = (
        *balance_notices(balance_of(observed.run, observed.blows)),
        *notices(case, observed.blows, contact_answers(case, first)),
        *wave_notices(case, observed.run, observed.histories, observed.readings, observed.view.bandwidth),
    )
    verdict = Verdict.of(warnings).text
    return Blows(motions, _chosen(blow, motions), warnings, observed.machine.struck.assembly_mass, verdict)


def _motion(name: str, reading: SensorReading) -> BaseMotion:
    """Return the motion that an ideal sensor read."""
    time = reading.time
    step = float(time[-1] - time[0]) / (time.size - 1)
    return BaseMotion(name, reading.values, step, float(time[0]))


def _check_blow(blow: str, case: Case) -> None:
    """Refuse a blow that a case cannot have before it runs."""
    most = 1 if case.feed is None or case.machine is None else round(case.feed.blows.si)
    if blow not in ("worst", "first", *map(str, range(1, most + 1))):
        raise InputError("--blow", blow, f"worst, first, or a number from 1 to {most}")


def _chosen(blow: str, motions: Sequence[BaseMotion]) -> int:
    """Return the place of a blow by what it is called; one that missed cannot be chosen."""
    if blow == "worst":
        return int(np.argmax([abs(motion.peak) for motion in motions]))
    names = [motion.name.removeprefix("blow ") for motion in motions]
    if blow != "first" and blow not in names:
        raise InputError("--blow", blow, f"worst, first, or a number of {', '.join(names[:MOST_LISTED])}")
    return 0 if blow == "first" else names.index(blow)


SPREAD = {"elastomer": (0.5, 5.0)}
"""Lowest and highest modulus over that of the table, by kind of material. Elastomers: the table gives the static one,
and its note expects 2 to 5 times that from 1 to 100 kHz (assumed); half is a softer compound (assumed)."""
OTHERS = (0.5, 2.0)
"""The same of all other kinds: grade, temperature, rate, and how flat the faces lie (assumed)."""
SOFTEST, STIFFEST = -1.0, 1.0
"""Places of the ends of the spread, where the modulus of the table is at 0."""
BETWEEN = (2.0 / 3.0, 1.0 / 3.0, -0.5)
"""Places between the table's modulus (0) and the ends of the spread (-1, 1) that are tried too: no step is beyond
1.8 times the modulus, 1.3 times the resonance."""


def spread(row: Material) -> tuple[float, float]:
    """Return the lowest and the highest modulus that a gasket is tried with, over that of the table.

    Examples
    --------
    >>> spread(material("rubber")), spread(material("PTFE"))
    ((0.5, 5.0), (0.5, 2.0))
    """
    return SPREAD.get(row.kind, OTHERS)


def moduli(stack: GasketStack, place: float) -> list[float]:
    """Return the modulus of each gasket over that of the table, at a place from `SOFTEST` to `STIFFEST`; 0 is one.

    Examples
    --------
    >>> from strikewave.base.quantities import Value
    >>> from strikewave.studies.buffer.mounting_site import GasketLayer
    >>> stack = GasketLayer("rubber", Value(si=1e-3, typed="1 mm")), GasketLayer("PTFE", Value(si=1e-3, typed="1 mm"))
    >>> moduli(stack, SOFTEST), moduli(stack, 0.0), moduli(stack, STIFFEST)
    ([0.5, 0.5], [1.0, 1.0], [5.0, 2.0])
    """
    ends = [spread(material(layer.material)) for layer in stack]
    return [(high if place > 0.0 else low) ** abs(place) for low, high in ends]


def confinement(row: Material, area: float, thickness: float, stiffer: float = 1.0) -> float:
    """Return the modulus of a disc of an elastomer whose faces cannot slip over that of the table, at most.

    1/E_a = 1/(E (1 + 2 S^2)) + 1/K, E_a at least E, with S = sqrt(A/pi) / (2 h), the loaded area of a disc over its
    free one, and K = E / (3 (1 - 2 nu)). Filled rubbers stiffen less: 2 S^2 is then multiplied by 0.5 to 1.
    Source: Gent & Lindley 1959, appendix I, eq. 5 for a disc, E (1 + 2 S^2), as quoted by R. Holland; 1/K beside it,
    the usual correction, leaves the bulk modulus where S is large.

    Parameters
    ----------
    row : Material
        E in Pa, nu.
    area, thickness : float
        A in m^2, h in m, of neighbours of this material together.
    stiffer : float, optional
        E over that of the table; K stays.

    Examples
    --------
    >>> round(confinement(material("rubber"), math.pi * 0.01**2, 5e-3), 2)
    2.97
    """
    shape = math.sqrt(area / math.pi) / (2.0 * thickness)
    bulk = 1.0 / (3.0 * (1.0 - 2.0 * row.poissons_ratio))
    return max(1.0 / (1.0 / (stiffer * (1.0 + 2.0 * shape**2)) + 1.0 / bulk), stiffer)


def confined(stack: GasketStack, area: float, factors: Sequence[float] = ()) -> list[float]:
    """Return the modulus of each gasket over that of the table where elastomers cannot slip.

    ``factors`` are those of the free gaskets, 1 by default.
    """
    ratios: list[float] = []
    for name, group in groupby(stack, key=lambda layer: layer.material):
        bonded, row = tuple(group), material(name)
        thickness = sum(layer.thickness.si for layer in bonded)
        free = factors[len(ratios)] if factors else 1.0
        ratios += [confinement(row, area, thickness, free) if row.kind == "elastomer" else free] * len(bonded)
    return ratios


def variants(stack: GasketStack, area: float) -> Iterator[list[float]]:
    """Yield the moduli that a robust stack must bear, over those of the table: free to slip, and not.

    The moduli of all gaskets go together, from the stiff end to the soft one, the table's left out where the faces
    slip.
    """
    places = (STIFFEST, SOFTEST, *BETWEEN)
    yield from (moduli(stack, place) for place in places)
    if any(material(layer.material).kind == "elastomer" for layer in stack):
        yield from (confined(stack, area, moduli(stack, place)) for place in (STIFFEST, 0.0, *BETWEEN, SOFTEST))
