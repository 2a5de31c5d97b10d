"""What a bar alone did: histories, tables, documents."""

from __future__ import annotations

import dataclasses
import functools
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from strikewave._version import __version__
from strikewave.base.result import SCHEMA, Source
from strikewave.base.variables import LabelledArrays, quantity
from strikewave.cases.case import Case
from strikewave.cases.comparisons import stale_fits_document
from strikewave.cases.losses_of_case import FittedLoss, fitted_losses
from strikewave.cases.written_case import dump_case
from strikewave.reporting.banded_numbers import with_band
from strikewave.reporting.columns import HISTORY_DIGITS, Column, csv_table
from strikewave.reporting.numbers import with_unit
from strikewave.reporting.shown_result import Curve, ShownResult, columns_of, history_curve
from strikewave.sensors import Reading
from strikewave.sensors.channel import SensorChannel, SensorPulse, sensor_pulse
from strikewave.signal.pulse import largest
from strikewave.waves import BarRun, Impactor, Tap
from strikewave.waves.routes import EXACT, RouteHistory
from strikewave.waves.setup import WaveSetup

Array = NDArray[np.float64]


def load_peak(run: BarRun) -> float:
    """Return the largest force that the load puts on the first face, N."""
    return float(np.abs(run.face_force).max(initial=0.0))


@dataclass(frozen=True)
class WaveSolution(ShownResult):
    """What a bar under its load did; see `Result` for what it shares with others.

    Attributes
    ----------
    case : Case
        What ran.
    run : BarRun
        Histories, field, bounds.
    taps : tuple of (str, Tap)
        Names and places.
    waves : WaveSetup
        Step, mismatch, layers as used.
    rigid : ndarray
        Acceleration of the stack as one rigid body, m/s^2, at the times of the run.
    routes : dict
        By tap and route: what the paper's routes say, where the tap lies between two fixtures.
    channels : tuple of SensorChannel
        The sensors.
    readings : tuple of Reading
        What their recorders kept; a sensor gets the acceleration before any filter.
    accuracy : (float, float)
        Error bounds of velocity and of acceleration (before any filter) over their largest values at the taps.
    layer_stress : tuple of float
        Largest magnitude of the stress in each layer, Pa.
    quoted : bool
        Whether one-dimensional theory allows peak accelerations to be quoted.
    """

    command: ClassVar[str] = "wave"
    table_name: ClassVar[str] = "taps"
    data_file: ClassVar[str] = "waves.nc"

    case: Case
    run: BarRun = field(repr=False)
    taps: tuple[tuple[str, Tap], ...]
    waves: WaveSetup
    rigid: Array = field(repr=False)
    routes: dict[tuple[str, str], RouteHistory] = field(repr=False)
    channels: tuple[SensorChannel, ...]
    readings: tuple[Reading, ...] = field(repr=False)
    accuracy: tuple[float, float]
    layer_stress: tuple[float, ...]
    quoted: bool

    @property
    def title(self) -> str:
        """The title of the case, with its route where that is not the exact one."""
        route = "" if self.route == EXACT else f"; route {self.route}"
        return (self.case.title or self.case.name) + route

    @property
    def sensors(self) -> dict[str, SensorPulse]:
        """Peak, width and clipping of each sensor's reading."""
        pairs = zip(self.channels, self.readings, strict=True)
        return {channel.sensor.name: sensor_pulse(reading) for channel, reading in pairs}

    @property
    def test(self) -> Mapping[str, str]:
        """What the case says of the test."""
        return self.case.test.stated()

    @functools.cached_property
    def source(self) -> Source:
        """The case."""
        return Source("case", self.case.name, dump_case(self.case))

    @property
    def balance(self) -> dict[str, float]:
        """Momentum of the stack against the impulses on it, as a share."""
        return {"momentum_error": self.run.momentum_error}

    def stress(self, k: int) -> Array:
        """Return the stress at tap k, compression above zero, Pa."""
        return np.asarray(self.run.force[:, k] / self.run.stack.layers[self.taps[k][1].layer].area)

    def peaks(self, k: int, route: str = EXACT) -> dict[str, float | None]:
        """Return the values of largest magnitude at tap k; no acceleration where theory allows none to be quoted."""
        history = self.by_route(k, route)
        if history is None:
            return dict.fromkeys(RouteHistory._fields)
        peaks: dict[str, float | None] = {key: largest(values) for key, values in history._asdict().items()}
        return peaks if self.quoted else {**peaks, "acceleration": None}

    @property
    def figures(self) -> dict[str, float]:
        """The results that may have a band, by name, SI: as sizes, as they may be of either sign, and none that are 0.

        Examples
        --------
        >>> from strikewave import load_case, run_wave
        >>> list(run_wave(load_case("li-ma-2019-fig13-bar")).figures)[:2]
        ['tap.sensor.peak_force', 'tap.sensor.peak_velocity']
        """
        figures: dict[str, float | None] = {}
        for k, (name, _) in enumerate(self.taps):
            figures |= {f"tap.{name}.peak_{what}": peak for what, peak in self.peaks(k, self.route).items()}
        figures |= {f"sensor.{name}.peak": pulse.peak for name, pulse in self.sensors.items()}
        return {name: abs(value) for name, value in figures.items() if value and math.isfinite(value)}

    @property
    def route(self) -> str:
        """The route that was chosen: exact, as printed, corrected."""
        return self.case.solver.route

    @property
    def method(self) -> str:
        """The solver that ran: delay lines, or spectral."""
        return "delay lines" if any(layer.steps for layer in self.waves.layers) else "spectral"

    @functools.cached_property
    def losses(self) -> tuple[FittedLoss, ...]:
        """Where the stack loses energy, and how well the loss factor is held over its band."""
        return fitted_losses(self.case)

    def contact(self) -> dict[str, Any] | None:
        """Return what the contact of a striker came to: force, times, speeds, indentation; None without one."""
        run = self.run
        if not isinstance(run.load, Impactor):
            return None
        contacts = [{"begin": begin, "end": end, "approach_speed": speed} for begin, end, speed in run.touches]
        return {
            "peak_force": load_peak(run),
            "impulse": run.impulse,
            "rebound_speed": -run.striker_speed,
            "max_indentation": run.deepest if run.load.contact is not None else 0.0,
            "energy_lost": run.energy_lost,
            "contacts": contacts,
        }

    def oscillators(self) -> list[dict[str, Any]]:
        """Return the masses on springs: where, kg, and their acceleration (without any filter)."""
        rows = []
        for column, (k, mass) in zip(self.run.hung_acceleration.T, self.run.stack.hung, strict=True):
            where = f"after {self.run.stack.layers[k].name}" if k < len(self.run.stack.joints) else "end"
            rows.append({"where": where, "mass": mass, "peak": largest(column), "acceleration": column})
        return rows

    def joints(self) -> list[dict[str, Any]]:
        """Return the joints that can open, and when they opened and closed, s."""
        listed = []
        for k, joint in enumerate(self.run.stack.joints):
            if joint.unilateral:
                mine = self.run.events[self.run.events[:, 0] == k]
                opened, closed = mine[mine[:, 2] == 1.0, 1], mine[mine[:, 2] == 0.0, 1]
                after = self.run.stack.layers[k].name
                row = {"after": after, "kind": joint.kind, "preload": joint.preload, "gap": joint.gap}
                listed.append({**row, "opened": opened, "closed": closed})
        return listed

    def by_route(self, k: int, route: str) -> RouteHistory | None:
        """Return force, velocity and acceleration at tap k by a route; None where that knows no such tap."""
        if route == EXACT:
            return RouteHistory(self.run.force[:, k], self.run.velocity[:, k], self.run.acceleration[:, k])
        return self.routes.get((self.taps[k][0], route))

    def units(self) -> dict[str, str]:
        """Return the unit of each key of the JSON document."""
        units = {"step": "s", "length_asked": "m", "length_used": "m", "position": "1", "time": "s", "force": "N"}
        units |= {"stress": "Pa", "velocity": "m/s", "acceleration": "m/s^2", "error_bound": "1", "bandwidth": "Hz"}
        units |= {
            "acceleration_error_bound": "1",
            "solver_step": "s",
            "mismatch": "1",
            "momentum_error": "1",
            "peak": "m/s^2",
            "width": "s",
            "loss_factor": "1",
            "error": "1",
            "low": "Hz",
            "high": "Hz",
            "preload": "N",
            "gap": "m",
            "opened": "s",
            "closed": "s",
            "begin": "s",
            "end": "s",
            "mass": "kg",
            "peak_force": "N",
            "impulse": "N s",
            "approach_speed": "m/s",
            "rebound_speed": "m/s",
            "max_indentation": "m",
            "energy_lost": "J",
        }
        return units

    def content(self) -> dict[str, Any]:
        """Return what the JSON document holds beside its head: each tap by the route of the case."""
        velocity, acceleration = self.accuracy
        taps = []
        for k, (name, tap) in enumerate(self.taps):
            layer, history = self.run.stack.layers[tap.layer], self.by_route(k, self.route)
            if history is not None:
                place = {"name": name, "layer": layer.name, "position": tap.position, "route": self.route}
                place["peaks"] = self.peaks(k, self.route)
                taps.append({**place, "time": self.run.time, **history._asdict(), "stress": history.force / layer.area})
        return {
            "case": self.case.name,
            "fitted_fields": self.case.fitted_fields(),
            "stale_fits": stale_fits_document(self.case),
            "step": float(self.run.time[1]) if self.run.time.size > 1 else self.waves.step,
            "solver_step": self.waves.step,
            "mismatch": self.waves.mismatch,
            "bandwidth": self.case.solver.bandwidth.si if self.case.solver.bandwidth else None,
            "error_bound": velocity,
            "acceleration_error_bound": acceleration,
            "momentum_error": self.run.momentum_error,
            "method": self.method,
            "dispersion": self.case.solver.dispersion,
            "losses": [loss._asdict() for loss in self.losses],
            "contact": self.contact(),
            "oscillators": self.oscillators(),
            "joints": self.joints(),
            "layers": [
                {**dataclasses.asdict(layer), "stress": stress}
                for layer, stress in zip(self.waves.layers, self.layer_stress, strict=True)
            ],
            "taps": taps,
            "sensors": {name: dataclasses.asdict(pulse) for name, pulse in self.sensors.items()},
            **self.band_content(),
        }

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
        attributes = {
            "strikewave_schema": SCHEMA,
            "strikewave_version": __version__,
            "case": self.source.text,
            "route": self.route,
        }
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

    def highlights(self) -> list[tuple[str, str]]:
        """Return the peaks at the first tap, and what each sensor reads."""
        numbers = [("taps", str(len(self.taps)))]
        for k, (name, _) in enumerate(self.taps[:1]):
            peaks = self.peaks(k, self.route)
            numbers += [
                (f"force at {name}", with_unit(peaks["force"], "N", "kN")),
                (f"velocity at {name}", with_unit(peaks["velocity"], "m/s", "m/s")),
            ]
            if peaks["acceleration"] is not None:
                numbers.append((f"acceleration at {name}", with_unit(peaks["acceleration"], "m/s^2", "g")))
        for name, pulse in self.sensors.items():
            band = self.band.get(f"sensor.{name}.peak")
            numbers.append((f"sensor {name}", with_band(pulse.peak, band, "m/s^2", "g")))
        return numbers

    def columns(self) -> list[Column]:
        """Return the taps with their peaks."""
        return columns_of(self.content()["taps"], self.units())

    def brief(self) -> dict[str, str]:
        """Return name, layer and peaks of each tap."""
        return {"name": "", "layer": "", "peaks.force": "kN", "peaks.velocity": "m/s", "peaks.acceleration": "g"}

    def preview(self) -> Curve | None:
        """Return the acceleration at the first tap, the velocity where theory allows none to be quoted."""
        seen = self.by_route(0, self.route) if self.taps else None
        if seen is None:
            return history_curve(self.run.time, self.run.face_force, "N", "kN", "force on the first face")
        name = self.taps[0][0]
        if self.quoted:
            return history_curve(self.run.time, seen.acceleration, "m/s^2", "g", f"acceleration at {name}")
        return history_curve(self.run.time, seen.velocity, "m/s", "m/s", f"velocity at {name}")

    def tables(self) -> dict[str, str]:
        """Return the histories of all taps as CSV text, every column with its unit."""
        return {"taps.csv": self._tap_table()}

    def _tap_table(self) -> str:
        units = (("force", "N"), ("stress", "Pa"), ("velocity", "m/s"), ("acceleration", "m/s^2"))
        by = "" if self.route == EXACT else f" ({self.route})"
        columns = [Column("time", self.run.time, "s")]
        for (name, _), histories in zip(self.taps, self._histories(), strict=True):
            for (what, si), values in zip(units, histories, strict=True):
                columns.append(Column(f"{name} {what}{by}", values, si))
        return csv_table(columns, HISTORY_DIGITS)
