"""The result of a bar alone: histories, tables, documents."""

from __future__ import annotations

import dataclasses
import functools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import field
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from strikewave._version import __version__
from strikewave.analyses.layered_bars import MOST_LAYERS
from strikewave.base import declare
from strikewave.base.datasets import LabelledArrays, quantity
from strikewave.base.declare import KEY, MAIN, MORE, Quantity, declarations
from strikewave.base.result import SCHEMA, Band
from strikewave.base.shock_quantities import (
    ACCELERATION,
    ENERGY,
    FORCE,
    FREQUENCY,
    IMPULSE,
    INDENTATION,
    LENGTH,
    MASS,
    MICROSECONDS,
    RATIO,
    STEP,
    STRESS,
    VELOCITY,
)
from strikewave.cases.stack_of_case import FittedLoss, fitted_losses
from strikewave.reporting.case_result import CaseResult
from strikewave.reporting.columns import HISTORY_DIGITS, Column, csv_table
from strikewave.reporting.faces import amount, face_rows, face_table, numbers_of, part_tables
from strikewave.reporting.numbers import listed, spelled
from strikewave.reporting.parts import Table
from strikewave.reporting.shown_result import Curve, history_curve
from strikewave.sensors import SensorReading
from strikewave.sensors.trial import SensorChannel, SensorPulse, sensor_pulse
from strikewave.signal.pulse import largest
from strikewave.waves import BarRun, Impactor, Tap
from strikewave.waves.li_ma import EXACT, RouteHistory
from strikewave.waves.transit import LayerUsed, WaveSetup

Array = NDArray[np.float64]


def load_peak(run: BarRun) -> float:
    """Return the largest force that the load puts on the first face, N."""
    return float(np.abs(run.face_force).max(initial=0.0))


@declare.dataclass
class TapPeaks:
    """The values of largest magnitude at a tap, with their signs; None where theory allows none to be quoted."""

    force: float | None = declare.number(
        FORCE, "largest force, with its sign", band="peak_force", column=MAIN, headline="force at {name}"
    )
    stress: float | None = declare.number(
        STRESS,
        "largest stress, with its sign",
        band="peak_stress",
        column=MAIN,
        headline="stress at {name}",
        in_document=False,
    )
    velocity: float | None = declare.number(
        VELOCITY, "largest velocity, with its sign", band="peak_velocity", column=MAIN, headline="velocity at {name}"
    )
    acceleration: float | None = declare.number(
        ACCELERATION,
        "largest acceleration; null where theory allows none to be quoted",
        band="peak_acceleration",
        column=MAIN,
        headline="acceleration at {name}",
    )


@declare.dataclass
class TapHistory:
    """Histories at a tap by the route of the case."""

    name: str = declare.word("what the tap is called", label="tap", column=KEY)
    route: str = declare.word("exact, or as printed", column=MORE + 1)
    layer: str = declare.word("its layer", column=MORE)
    position: float = declare.number(RATIO, "as a fraction of the layer, from its loaded side", column=MORE)
    peaks: TapPeaks = declare.part(TapPeaks, "largest values")
    time: Array = declare.history("s", "from the start of the load at the first face")
    force: Array = declare.history("N", "force, pressure positive")
    stress: Array = declare.history("Pa", "stress, pressure positive")
    velocity: Array = declare.history("m/s", "velocity")
    acceleration: Array = declare.history("m/s^2", "acceleration")

    def further_bands(self, bands: Mapping[str, Sequence[Band]]) -> dict[str, list[Band]]:
        """Return the band of the stress: that of the force, over the area."""
        peaks, forces = self.peaks, bands.get("peak_force", ())
        if not peaks.force or peaks.stress is None:
            return {}
        area = peaks.force / peaks.stress
        scaled = [dataclasses.replace(band, low=band.low / area, high=band.high / area) for band in forces]
        return {"peak_stress": scaled} if scaled else {}


@declare.dataclass
class StressedLayer(LayerUsed):
    """A layer, and the largest stress in it."""

    stress: float = declare.number(STRESS, "largest magnitude of the stress in it", column=MAIN, tables="stress")


@declare.dataclass
class ContactInterval:
    """One contact of the striker with the first face."""

    begin: float = declare.number(MICROSECONDS, "begin of the contact")
    end: float = declare.number(MICROSECONDS, "end of the contact")
    approach_speed: float = declare.number(VELOCITY, "closing speed at its begin")


@declare.dataclass
class StrikerContact:
    """Results of the contact of a striker."""

    peak_force: float = declare.number(FORCE, "largest force", column=MAIN)
    impulse: float = declare.number(IMPULSE, "impulse on the first face", column=MAIN)
    rebound_speed: float = declare.number(VELOCITY, "speed of the striker afterwards, away from the stack", column=MAIN)
    max_indentation: float = declare.number(INDENTATION, "deepest indentation; 0 of a rigid contact", column=MAIN)
    energy_lost: float = declare.number(ENERGY, "energy lost in the contact", column=MAIN)
    contacts: tuple[ContactInterval, ...] = declare.rows(ContactInterval, "its contacts")


@declare.dataclass
class HungMass:
    """A mass on a spring."""

    where: str = declare.word("after which layer, or at the end", label="mass on a spring", column=KEY)
    mass: float = declare.number(MASS, "its mass", column=MAIN)
    peak: float = declare.number(
        ACCELERATION, "its largest acceleration, without any filter", label="largest acceleration", column=MAIN
    )
    acceleration: Array = declare.history("m/s^2", "its acceleration")


@declare.dataclass
class OpeningJoint:
    """A joint that can open, and the times at which it did."""

    after: str = declare.word("the layer before it", column=KEY)
    kind: str = declare.word("what kind of joint it is", column=MAIN)
    preload: float = declare.number(Quantity("N", "N"), "force that presses it together", column=MAIN)
    gap: float = declare.number(LENGTH, "gap before it closes for the first time")
    opened: Array = declare.history("s", "when it opened", usual="us", label="opens at", column=MAIN)
    closed: Array = declare.history("s", "when it closed", usual="us", label="closes at", column=MAIN)


@declare.dataclass
class WaveSolution(CaseResult):
    """Results of a bar under its load; see `Result` for what it shares with others.

    Attributes
    ----------
    run : BarRun
        Histories, field, bounds.
    taps : tuple of (str, Tap)
        Names and places.
    waves : WaveSetup
        Step, mismatch, layers as used.
    rigid : ndarray
        Acceleration of the stack as one rigid body, m/s^2, at the times of the run.
    routes : dict
        Histories by the paper's routes, by tap and route, where the tap lies between two fixtures.
    channels : tuple of SensorChannel
        The sensors.
    readings : tuple of SensorReading
        Recorded readings of the sensors; a sensor gets the acceleration before any filter.
    accuracy : (float, float)
        Error bounds of velocity and of acceleration (before any filter) over their largest values at the taps.
    layer_stress : tuple of float
        Largest magnitude of the stress in each layer, Pa.
    quoted : bool
        True if one-dimensional theory allows peak accelerations to be quoted.
    """

    command: ClassVar[str] = "wave"
    table_name: ClassVar[str] = "taps"
    main_rows: ClassVar[str] = "tap_histories"
    data_file: ClassVar[str] = "waves.nc"
    may_have_bands: ClassVar[bool] = True

    run: BarRun = field(repr=False)
    taps: tuple[tuple[str, Tap], ...]
    waves: WaveSetup
    rigid: Array = field(repr=False)
    routes: dict[tuple[str, str], RouteHistory] = field(repr=False)
    channels: tuple[SensorChannel, ...]
    readings: tuple[SensorReading, ...] = field(repr=False)
    accuracy: tuple[float, float]
    layer_stress: tuple[float, ...]
    quoted: bool

    @property
    def title(self) -> str:
        """The title of the case, with its route where that is not the exact one."""
        route = "" if self.route == EXACT else f"; route {self.route}"
        return (self.case.title or self.case.name) + route

    @property
    def balance(self) -> dict[str, float]:
        """Momentum of the stack against the impulses on it, as a share."""
        return {"momentum_error": self.run.momentum_error}

    def stress(self, k: int) -> Array:
        """Return the stress at tap k, compression above zero, Pa."""
        return np.asarray(self.run.force[:, k] / self.run.stack.layers[self.taps[k][1].layer].area)

    def peaks(self, k: int, route: str = EXACT) -> TapPeaks:
        """Return the values of largest magnitude at tap k; no acceleration where theory allows none to be quoted."""
        history = self.by_route(k, route)
        if history is None:
            return TapPeaks(None, None, None, None)
        force, velocity, acceleration = (largest(values) for values in history)
        stress = force / self.run.stack.layers[self.taps[k][1].layer].area
        return TapPeaks(force, stress, velocity, acceleration if self.quoted else None)

    @property
    def figures(self) -> dict[str, float]:
        """The results that may have a band, by name, SI: as sizes, as they may be of either sign, and none that are 0.

        Examples
        --------
        >>> from strikewave import load_case, run_wave
        >>> list(run_wave(load_case("li-ma-2019-fig13-bar")).figures)[:2]
        ['tap.sensor.peak_force', 'tap.sensor.peak_velocity']
        """
        rows = [(name, row.band) for name, row in declarations(TapPeaks).items() if row.in_document]
        figures: dict[str, float | None] = {}
        for k, (tap, _) in enumerate(self.taps):
            peaks = self.peaks(k, self.route)
            for name, band in rows:
                figures[f"tap.{tap}.{band}"] = getattr(peaks, name)
        for name, pulse in self.sensors.items():
            figures[f"sensor.{name}.peak"] = pulse.peak
        return {name: abs(value) for name, value in figures.items() if value and math.isfinite(value)}

    @property
    def route(self) -> str:
        """The route that was chosen: exact, as printed, corrected."""
        return self.case.solver.route

    @declare.computed(declare.word("how the waves were followed"))
    def method(self) -> str:
        """The solver that ran: delay lines, or spectral."""
        return "delay lines" if any(layer.steps for layer in self.waves.layers) else "spectral"

    @declare.computed(declare.number(STEP, "time between the samples of the taps"))
    def step(self) -> float:
        """Time between the samples of the taps."""
        return float(self.run.time[1]) if self.run.time.size > 1 else self.waves.step

    @declare.computed(declare.number(STEP, "time step of the waves"))
    def solver_step(self) -> float:
        """Time step of the waves."""
        return self.waves.step

    @declare.computed(declare.number(RATIO, "largest relative error of a transit time by whole steps"))
    def mismatch(self) -> float:
        """Largest relative error of a transit time."""
        return self.waves.mismatch

    @declare.computed(declare.number(FREQUENCY, "low-pass by which peaks are quoted"))
    def bandwidth(self) -> float | None:
        """The low-pass of accelerations; None without one."""
        return self.case.solver.bandwidth.si if self.case.solver.bandwidth else None

    @declare.computed(declare.number(RATIO, "bound of the error of velocities, over the largest at the taps"))
    def error_bound(self) -> float:
        """Bound of the error of velocities."""
        return self.accuracy[0]

    @declare.computed(declare.number(RATIO, "the same of accelerations, before any filter"))
    def acceleration_error_bound(self) -> float:
        """Bound of the error of accelerations."""
        return self.accuracy[1]

    @declare.computed(declare.number(RATIO, "momentum that the balance misses, as a share"))
    def momentum_error(self) -> float:
        """Error of the momentum balance."""
        return self.run.momentum_error

    @declare.computed(declare.word("theory by which short waves run slower; none"))
    def dispersion(self) -> str:
        """The theory of dispersion."""
        return self.case.solver.dispersion

    @declare.computed(declare.rows(FittedLoss, "what loses energy, and how well its loss factor is fitted"))
    def losses(self) -> tuple[FittedLoss, ...]:
        """Losses of the stack, and the error of each fitted loss factor over its band."""
        return fitted_losses(self.case)

    @declare.computed(declare.part(StrikerContact, "what the contact of a striker came to; null without one"))
    def contact(self) -> StrikerContact | None:
        """Force, times, speeds, indentation of the contact of a striker; None without one."""
        run = self.run
        if not isinstance(run.load, Impactor):
            return None
        deepest = run.deepest if run.load.contact is not None else 0.0
        contacts = tuple(ContactInterval(*row) for row in run.touches)
        return StrikerContact(load_peak(run), run.impulse, -run.striker_speed, deepest, run.energy_lost, contacts)

    @declare.computed(declare.rows(HungMass, "masses on springs: where, and their acceleration"))
    def oscillators(self) -> list[HungMass]:
        """The masses on springs, with their acceleration (without any filter)."""
        stack, masses = self.run.stack, list[HungMass]()
        for column, (k, mass) in zip(self.run.hung_acceleration.T, stack.hung, strict=True):
            where = f"after {stack.layers[k].name}" if k < len(stack.joints) else "end"
            masses.append(HungMass(where, mass, largest(column), column))
        return masses

    @declare.computed(declare.rows(OpeningJoint, "joints that can open, and when they opened and closed"))
    def joints(self) -> list[OpeningJoint]:
        """The joints that can open."""
        listed = []
        for k, joint in enumerate(self.run.stack.joints):
            if joint.unilateral:
                mine = self.run.events[self.run.events[:, 0] == k]
                opened, closed = mine[mine[:, 2] == 1.0, 1], mine[mine[:, 2] == 0.0, 1]
                after = self.run.stack.layers[k].name
                listed.append(OpeningJoint(after, joint.kind, joint.preload, joint.gap, opened, closed))
        return listed

    @declare.computed(declare.rows(StressedLayer, "the layers as the time step makes them"))
    def layers(self) -> list[StressedLayer]:
        """The layers as the time step makes them, with their largest stress."""
        pairs = zip(self.waves.layers, self.layer_stress, strict=True)
        return [StressedLayer(**vars(layer), stress=stress) for layer, stress in pairs]

    @declare.computed(
        declare.rows(
            TapHistory, "what the taps see, by the route of the case", key="taps", band="tap.{name}", headline="first"
        )
    )
    def tap_histories(self) -> list[TapHistory]:
        """Histories at each tap that the route of the case knows."""
        taps = []
        for k, (name, tap) in enumerate(self.taps):
            layer, history = self.run.stack.layers[tap.layer], self.by_route(k, self.route)
            if history is not None:
                place = (name, self.route, layer.name, tap.position, self.peaks(k, self.route))
                stress = history.force / layer.area
                taps.append(
                    TapHistory(*place, self.run.time, history.force, stress, history.velocity, history.acceleration)
                )
        return taps

    @declare.computed(
        declare.named(SensorPulse, "what each sensor reads", label="sensor", band="sensor.{name}", headline="each")
    )
    def sensors(self) -> dict[str, SensorPulse]:
        """Peak, width and clipping of each sensor's reading."""
        pairs = zip(self.channels, self.readings, strict=True)
        return {channel.sensor.name: sensor_pulse(reading) for channel, reading in pairs}

    @declare.computed(declare.count("how many taps there are", headline="taps", in_document=False))
    def tap_count(self) -> int:
        """Number of taps."""
        return len(self.taps)

    def by_route(self, k: int, route: str) -> RouteHistory | None:
        """Return force, velocity and acceleration at tap k by a route; None where that knows no such tap."""
        if route == EXACT:
            return RouteHistory(self.run.force[:, k], self.run.velocity[:, k], self.run.acceleration[:, k])
        return self.routes.get((self.taps[k][0], route))

    def _histories(self) -> Iterator[tuple[Array, Array, Array, Array]]:
        """Yield force, stress, velocity, acceleration at each tap by the route of the case; NaN where it has none."""
        for k, (_, tap) in enumerate(self.taps):
            nothing = np.full(self.run.time.size, np.nan)
            history = self.by_route(k, self.route) or RouteHistory(nothing, nothing, nothing)
            stress = history.force / self.run.stack.layers[tap.layer].area
            yield history.force, stress, history.velocity, history.acceleration

    @functools.cached_property
    def arrays(self) -> LabelledArrays:
        """All histories and the x-t field with units, and the case."""
        attributes = {"strikewave_schema": SCHEMA, "strikewave_version": __version__}
        attributes |= {"case": self.source.text, "route": self.route}
        return dataclasses.replace(self.labelled_histories(), attrs=attributes)

    def labelled_histories(self) -> LabelledArrays:
        """Return all histories and the x-t field with units."""
        run, where = self.run, ("time", "tap")
        force, stress, velocity, acceleration = (np.column_stack(c) for c in zip(*self._histories(), strict=True))
        variables = {
            "face_force": quantity("time", run.face_force, "N", "force on the first face"),
            "rigid_acceleration": quantity("time", self.rigid, "m/s^2", "acceleration of the stack as one body"),
            "tap_force": quantity(where, force, "N", "force at each tap"),
            "tap_stress": quantity(where, stress, "Pa", "stress at each tap"),
            "tap_velocity": quantity(where, velocity, "m/s", "velocity at each tap"),
            "tap_acceleration": quantity(where, acceleration, "m/s^2", "acceleration at each tap"),
            "field_force": quantity(("field_time", "field_place"), run.field_force, "N", "force along the stack"),
            "field_velocity": quantity(
                ("field_time", "field_place"), run.field_velocity, "m/s", "velocity along the stack"
            ),
            "field_position": quantity("field_place", run.field_position, "m", "distance from the first face"),
        }
        if run.stack.hung:
            words = "acceleration of each mass on a spring"
            variables["hung_acceleration"] = quantity(("time", "hung_mass"), run.hung_acceleration, "m/s^2", words)
        for k, (channel, reading) in enumerate(zip(self.channels, self.readings, strict=True)):
            name, clock = f"reading_{k + 1}", f"reading_{k + 1}_time"
            variables[name] = quantity(clock, reading.values, "m/s^2", f"what sensor {channel.sensor.name} reads")
            variables[clock] = quantity(clock, reading.time, "s", "time after the start of the load")
        coordinates = {
            "time": quantity("time", run.time, "s", "time after the start of the load"),
            "field_time": quantity("field_time", run.field_time, "s", "time after the start of the load"),
            "tap": ("tap", np.array([name for name, _ in self.taps], dtype=object)),
        }
        return LabelledArrays.of(variables, coordinates, {})

    def preview(self) -> Curve | None:
        """Return the acceleration at the first tap, the velocity where theory allows none to be quoted."""
        seen = self.by_route(0, self.route) if self.taps else None
        if seen is None:
            return history_curve(self.run.time, self.run.face_force, *FORCE.units, "force on the first face")
        name = self.taps[0][0]
        if self.quoted:
            return history_curve(self.run.time, seen.acceleration, *ACCELERATION.units, f"acceleration at {name}")
        return history_curve(self.run.time, seen.velocity, *VELOCITY.units, f"velocity at {name}")

    def tables(self) -> dict[str, str]:
        """Return the histories of all taps as CSV text, every column with its unit."""
        units = (("force", "N"), ("stress", "Pa"), ("velocity", "m/s"), ("acceleration", "m/s^2"))
        by = "" if self.route == EXACT else f" ({self.route})"
        columns = [Column("time", self.run.time, "s")]
        for (name, _), histories in zip(self.taps, self._histories(), strict=True):
            for (what, si), values in zip(units, histories, strict=True):
                columns.append(Column(f"{name} {what}{by}", values, si))
        return {"taps.csv": csv_table(columns, HISTORY_DIGITS)}


def wave_words(solution: WaveSolution) -> str:
    """Return the peak values at the taps as a sentence."""
    at_taps = []
    for row in face_rows(solution, "tap_histories"):
        words = listed([f"{text} {spelled(unit)}" for text, unit in numbers_of(row.value.peaks, row.bands)])
        at_taps.append(f"{row.name} (in {row.value.layer}): {words}")
    return f"A layered bar under its load, route {solution.route}. Signed peak values: {'; '.join(at_taps)}."


def error_words(solution: WaveSolution) -> str:
    """Return the accuracy of the waves of a bar in words."""
    velocity, acceleration = solution.accuracy
    bounds = "no bound" if math.isinf(velocity) else f"velocity {velocity:.1e}, acceleration {acceleration:.1e}"
    step = amount(STEP, solution.waves.step)
    if solution.method == "spectral":
        dispersion = solution.case.solver.dispersion
        return (
            f"spectral solver, dispersion: {dispersion}; error over the largest value at the taps, estimated from half "
            f"the step: {bounds}; time step {step}"
        )
    return (
        f"error bound over the largest value at the taps: {bounds}; time step {step}, largest mismatch of a transit "
        f"{solution.waves.mismatch:.1e}"
    )


def wave_tables(solution: WaveSolution) -> list[Table]:
    """Return the further tables of a bar: contact, masses on springs, joints, layers."""
    tables = [
        face_table(solution, "oscillators", caption="Masses on springs"),
        face_table(solution, "joints", caption="Joints that can open"),
        face_table(solution, "layers", "stress", "Largest stress in each layer"),
    ]
    tables = [dataclasses.replace(table, rows=table.rows[:MOST_LAYERS]) for table in tables if table.rows]
    return [*part_tables(solution, "contact"), *tables]
