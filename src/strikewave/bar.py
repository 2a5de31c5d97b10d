"""A bar alone: case in, solution out."""

from __future__ import annotations

import csv
import dataclasses
import functools
import io
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from strikewave._version import __version__
from strikewave.build import build_channels, build_load, build_stack, build_taps, check_route, wanted
from strikewave.build.losses import Loss, fitted_losses
from strikewave.build.stack import checked, need
from strikewave.case import Case, dump_case
from strikewave.dataset import quantity
from strikewave.documents import head, plain, without
from strikewave.errors import InputError
from strikewave.notices import LEDGER_LIMIT, law_notices, yield_notices
from strikewave.readings import Channel, SensorPulse, front, largest, sensor_pulse, sensor_sources, stated
from strikewave.sensors import Reading, read
from strikewave.signal.pulse import measure_pulse
from strikewave.solution import SCHEMA, Notice, WaveSetup, wave_setup
from strikewave.validity import (
    bar_extremes,
    channel_notices,
    end_notices,
    grid_notices,
    joint_notices,
    layer_notices,
    loss_notices,
    rise_in_diameters,
    rise_limits,
    rise_notices,
)
from strikewave.waves import BarRun, Impactor, Pulse, Sampled, Stack, Tap, run_bar
from strikewave.waves.li_ma import ROUTES
from strikewave.waves.routes import EXACT, RouteHistory, route_history, specimen_of

if TYPE_CHECKING:
    import xarray

Array = NDArray[np.float64]

LOAD_OFFSET = 0.005
"""Share of its largest value with which a measured load may begin without a word."""


@dataclass(frozen=True)
class BarSolution:
    """What a bar under its load did.

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
    channels : tuple of Channel
        The sensors.
    readings : tuple of Reading
        What their recorders kept; a sensor gets the acceleration before any filter.
    accuracy : (float, float)
        Error bounds of velocity and of acceleration (before any filter) over their largest values at the taps.
    layer_stress : tuple of float
        Largest magnitude of the stress in each layer, Pa.
    quoted : bool
        Whether one-dimensional theory allows peak accelerations to be quoted.
    warnings : tuple of Notice
        What to know.
    citations : tuple of str
        Keys of the sources of the models used.
    """

    case: Case
    run: BarRun = field(repr=False)
    taps: tuple[tuple[str, Tap], ...]
    waves: WaveSetup
    rigid: Array = field(repr=False)
    routes: dict[tuple[str, str], RouteHistory] = field(repr=False)
    channels: tuple[Channel, ...]
    readings: tuple[Reading, ...] = field(repr=False)
    accuracy: tuple[float, float]
    layer_stress: tuple[float, ...]
    quoted: bool
    warnings: tuple[Notice, ...]
    citations: tuple[str, ...]

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
    def broken(self) -> bool:
        """Whether a stated limit was broken."""
        return any(notice.broken for notice in self.warnings)

    @property
    def ledger(self) -> dict[str, float]:
        """Momentum of the stack against the impulses on it, as a share."""
        return {"momentum_error": self.run.momentum_error}

    def stress(self, k: int) -> Array:
        """Return the stress at tap k, compression above zero, Pa."""
        return np.asarray(self.run.force[:, k] / self.run.stack.layers[self.taps[k][1].layer].area)

    def peaks(self, k: int, route: str = EXACT) -> dict[str, float | None]:
        """Return the values of largest magnitude at tap k; no acceleration where theory allows none to be quoted."""
        found = self.by_route(k, route)
        if found is None:
            return dict.fromkeys(RouteHistory._fields)
        peaks: dict[str, float | None] = {key: largest(values) for key, values in found._asdict().items()}
        return peaks if self.quoted else {**peaks, "acceleration": None}

    @property
    def route(self) -> str:
        """The route that was chosen: exact, as printed, corrected."""
        return self.case.solver.route

    @property
    def method(self) -> str:
        """The solver that ran: delay lines, or spectral."""
        return "delay lines" if any(layer.steps for layer in self.waves.layers) else "spectral"

    @property
    def losses(self) -> tuple[Loss, ...]:
        """Where the stack loses energy, and how well the loss factor is held over its band."""
        return fitted_losses(self.case)

    def contact(self) -> dict[str, Any] | None:
        """Return what the contact of a striker came to: force, times, speeds, indentation; None without one."""
        run = self.run
        if not isinstance(run.load, Impactor):
            return None
        contacts = [{"begin": begin, "end": end, "approach_speed": speed} for begin, end, speed in run.touches]
        return {
            "peak_force": _load_peak(run),
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

    def document(self) -> dict[str, Any]:
        """Return the JSON document: each tap by the route of the case."""
        velocity, acceleration = self.accuracy
        taps = []
        for k, (name, tap) in enumerate(self.taps):
            layer, found = self.run.stack.layers[tap.layer], self.by_route(k, self.route)
            if found is not None:
                place = {"name": name, "layer": layer.name, "position": tap.position, "route": self.route}
                place["peaks"] = self.peaks(k, self.route)
                taps.append({**place, "time": self.run.time, **found._asdict(), "stress": found.force / layer.area})
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
        return plain(
            {
                **head(units, [without(dataclasses.asdict(n), "broken") for n in self.warnings]),
                "case": self.case.name,
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
            }
        )

    def _histories(self) -> Iterator[tuple[Array, Array, Array, Array]]:
        """Yield force, stress, velocity, acceleration at each tap by the route of the case; NaN where it has none."""
        for k, (_, tap) in enumerate(self.taps):
            nothing = np.full(self.run.time.size, np.nan)
            found = self.by_route(k, self.route) or RouteHistory(nothing, nothing, nothing)
            stress = found.force / self.run.stack.layers[tap.layer].area
            yield found.force, stress, found.velocity, found.acceleration

    def dataset(self) -> xarray.Dataset:
        """Return all histories and the x-t field with units."""
        import xarray

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
        attributes = {
            "strikewave_schema": SCHEMA,
            "strikewave_version": __version__,
            "case": dump_case(self.case),
            "route": self.route,
        }
        return xarray.Dataset(variables, coordinates, attributes)

    def table(self) -> str:
        """Return the histories of all taps as CSV text, every column with its unit."""
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        units = (("force", "N"), ("stress", "Pa"), ("velocity", "m/s"), ("acceleration", "m/s^2"))
        by = "" if self.route == EXACT else f", {self.route}"
        heads = [f"{name} {what} [{unit}]{by}" for name, _ in self.taps for what, unit in units]
        writer.writerow(["time [s]", *heads])
        columns = [self.run.time]
        for force, stress, velocity, acceleration in self._histories():
            columns += [force, stress, velocity, acceleration]
        for row in zip(*columns, strict=True):
            writer.writerow(["" if math.isnan(value) else f"{value:.9g}" for value in row])
        return text.getvalue()

    def save(self, path: Path) -> None:
        """Write all histories as NetCDF."""
        self.dataset().to_netcdf(path, engine="h5netcdf")


def run_wave(case: Case) -> BarSolution:
    """Run the stack of a case under its load.

    Raises
    ------
    InputError, InputErrors
        If the case has no stack or load, or parts of it do not fit together.

    Examples
    --------
    >>> from strikewave import load_case
    >>> solution = run_wave(load_case("li-ma-2019-fig13-bar"))
    >>> solution.run.momentum_error < 1e-9
    True
    """
    stack, taps, channels = build_stack(case), build_taps(case), build_channels(case)
    load = build_load(case, stack)
    check_route(case, taps, channels)
    duration = need(case.solver.duration, "solver.duration", "how long to follow", 'add duration = "300 us"')
    run = checked("solver", lambda: run_bar(stack, load, [tap for _, tap in taps], duration, wanted(case)))
    bandwidth, step = case.solver.bandwidth.si if case.solver.bandwidth else math.inf, float(run.time[1])
    if not math.isinf(bandwidth) and not 1.0 / duration <= bandwidth < 0.5 / step:
        allowed = f"{1.0 / duration:.3g} to {0.5 / step:.3g} Hz: one over the duration, half the sampling rate"
        raise InputError("solver.bandwidth", f"{bandwidth:g} Hz", allowed)
    routes = _routes(stack, taps, run) if _of_the_paper(case) else {}
    carried = stack.end.value if stack.end.kind in ("mass", "oscillator") else 0.0
    rigid = (run.face_force - run.end_force) / (stack.mass - carried)
    accuracy, felt = run.relative_bound, _felt(case.solver.route, taps, run, routes)
    readings = tuple(
        checked(
            f"sensor.{sensor.name}",
            functools.partial(read, sensor, recorder, rigid if tap is None else felt[tap], step),
        )
        for sensor, tap, recorder in channels
    )
    rise = min([load_rise(run), *(front(values, step) for values in run.acceleration.T)])
    peak = largest(run.acceleration.ravel())
    run = dataclasses.replace(run, acceleration=_from_rest(run.acceleration.T, step, bandwidth).T)
    for key, wave in routes.items():
        routes[key] = wave._replace(acceleration=_from_rest(wave.acceleration, step, bandwidth))
    most, least, greatest = bar_extremes(run)
    lasting = load.duration if isinstance(load, Pulse | Sampled) else float(run.touches[:, 1].max(initial=0.0))
    solution = BarSolution(
        case=case,
        run=run,
        taps=taps,
        waves=wave_setup(stack, run.grid),
        rigid=_from_rest(rigid, step, bandwidth),
        routes=routes,
        channels=channels,
        readings=readings,
        accuracy=accuracy,
        layer_stress=tuple(float(force / layer.area) for force, layer in zip(most, stack.layers, strict=True)),
        quoted=rise > 0.0 and rise_in_diameters(stack, rise, bandwidth)[0] >= rise_limits(stack)[0],
        warnings=(),
        citations=_citations(case, stack, channels),
    )
    listed = [
        *_ledger(run),
        *grid_notices(run.grid),
        *_file_notices(run),
        *_jump(rise),
        *(rise_notices(stack, rise, bandwidth, peak) if rise > 0.0 else ()),
        *layer_notices(stack, most),
        *_not_reached(run, taps, accuracy),
        *joint_notices(stack, least, greatest, _load_peak(run)),
        *loss_notices(solution.losses),
        *end_notices(stack, lasting),
        *channel_notices(channels, [solution.sensors], stack.mass),
        *_missed_accuracy(case, run, accuracy),
        *_contact_notices(case, run),
    ]
    return dataclasses.replace(solution, warnings=tuple(listed))


def _of_the_paper(case: Case) -> bool:
    """Tell whether a case is one of Li & Ma 2019, or asks for a route of theirs."""
    return case.source.startswith("li-ma-2019") or case.solver.route != EXACT


def _incident_force(run: BarRun) -> Array:
    """Return the force that goes down the first layer, as if nothing came back, N."""
    load = run.load
    if isinstance(load, Impactor) or load.kind == "force":
        return run.face_force
    scale = run.stack.layers[0].impedance if load.kind == "speed" else 1.0
    return np.asarray(scale * load.at(run.time))


def _routes(stack: Stack, taps: Sequence[tuple[str, Tap]], run: BarRun) -> dict[tuple[str, str], RouteHistory]:
    """Return what the paper's routes say of each tap in a layer between two others."""
    came = _incident_force(run)
    return {
        (name, route): route_history(stack, tap.layer, tap.position, run.time, came, route)
        for name, tap in taps
        if specimen_of(stack, tap.layer) is not None
        for route in ROUTES
    }


def _felt(
    route: str, taps: Sequence[tuple[str, Tap]], run: BarRun, routes: dict[tuple[str, str], RouteHistory]
) -> list[Array]:
    """Return the acceleration that a sensor at each tap feels, by the route of the case."""
    found = []
    for k, (name, _) in enumerate(taps):
        wave = routes.get((name, route))
        found.append(run.acceleration[:, k] if wave is None else wave.acceleration)
    return found


def _from_rest(values: Array, step: float, bandwidth: float) -> Array:
    """Return histories (rows) at a bandwidth; before the load nothing accelerates."""
    if math.isinf(bandwidth):
        return values
    rest = min(math.ceil(2.0 / (bandwidth * step)), 4 * values.shape[-1])
    led = np.concatenate([np.zeros((*values.shape[:-1], rest)), values], axis=-1)
    return stated(led, step, bandwidth)[..., rest:]


def _citations(case: Case, stack: Stack, channels: Sequence[Channel]) -> tuple[str, ...]:
    origin = ("li-ma-2019",) if _of_the_paper(case) else ()
    theory = {"none": (), "love-rayleigh": ("love-1927",), "pochhammer-chree": ("graff-1975",)}[case.solver.dispersion]
    lossy = any(x.loss for x in stack.layers) or any(x.branches for x in stack.joints)
    loss = ("emmerich-korn-1987",) if lossy else ()
    return (*origin, "kolsky-1963", *theory, *loss, *sensor_sources(channels))


def load_rise(run: BarRun) -> float:
    """Return the rise of the load from 10 to 90 % of its peak, s; 0 for a jump."""
    if not isinstance(run.load, Impactor):
        return run.load.rise_time
    if run.load.contact is None:
        return 0.0
    force = np.concatenate([[0.0], run.face_force])
    return measure_pulse(force, float(run.time[1])).rise if force.max() > 0.0 else 0.0


def _jump(rise: float) -> list[Notice]:
    if rise > 0.0:
        return []
    message = "the load jumps: velocities jump with it, and no finite peak acceleration exists; none is quoted"
    return [Notice("discontinuous-load", message, rise, 0.0)]


def _file_notices(run: BarRun) -> list[Notice]:
    """Say where a measured load may not be what it is taken for."""
    load = run.load
    if not isinstance(load, Sampled):
        return []
    found = []
    if not load.told:
        message = f"the load file names no unit: taken as N and s, {load.largest:.4g} N over {load.duration:.4g} s"
        found.append(Notice("load-unit", message, load.largest, 0.0))
    if load.duration > 10.0 * run.duration:
        message = f"the load lasts {load.duration:.4g} s, the run {run.duration:.4g} s: most of it is not followed"
        found.append(Notice("load-long", message, load.duration, run.duration))
    begins = abs(float(load.values[0]))
    if load.kind != "speed" and begins > LOAD_OFFSET * load.largest:
        message = (
            f"the load begins with {begins:.4g} N, {begins / load.largest:.1%} of its largest: it jumps there; take "
            "off its zero line, and cut away what lies before the blow"
        )
        found.append(Notice("load-offset", message, begins, LOAD_OFFSET * load.largest))
    return found


def _ledger(run: BarRun) -> list[Notice]:
    if run.momentum_error <= LEDGER_LIMIT:
        return []
    message = f"the momentum ledger misses {run.momentum_error:.1e}"
    return [Notice("momentum-ledger", message, run.momentum_error, LEDGER_LIMIT, broken=True)]


def _load_peak(run: BarRun) -> float:
    """Return the largest force that the load puts on the first face, N."""
    return float(np.abs(run.face_force).max(initial=0.0))


def _not_reached(run: BarRun, taps: Sequence[tuple[str, Tap]], accuracy: tuple[float, float]) -> list[Notice]:
    """Name the taps that the waves of the load do not reach within the run."""
    if isinstance(run.load, Impactor) or not math.isfinite(max(accuracy)) or any(x.speed for x in run.stack.layers):
        return []
    transits = [layer.transit for layer in run.stack.layers]
    late = [(name, sum(transits[: tap.layer]) + tap.position * transits[tap.layer]) for name, tap in taps]
    late = [(name, time) for name, time in late if time > run.duration]
    if not late:
        return []
    names = ", ".join(f"{name} ({time * 1e6:.4g} us)" for name, time in late)
    message = f"the run of {run.duration * 1e6:.4g} us ends before the wave comes to {names}"
    return [Notice("not-reached", message, run.duration, max(time for _, time in late))]


def _contact_notices(case: Case, run: BarRun) -> list[Notice]:
    """Say what the contact of a striker with the first face does beyond its law."""
    if not isinstance(run.load, Impactor) or case.striker is None or case.contact is None:
        return []
    face = case.stack.layer[0].material
    return [*law_notices(case), *yield_notices(case.striker, case.contact, face, _load_peak(run))]


def _missed_accuracy(case: Case, run: BarRun, accuracy: tuple[float, float]) -> list[Notice]:
    """Say where the wanted error could not be promised."""
    asked, (velocity, acceleration) = wanted(case), accuracy
    if velocity <= asked.velocity and acceleration > asked.acceleration and case.solver.bandwidth is None:
        message = (
            f"the error bound of acceleration is {acceleration:.2g} of its peak instead of {asked.acceleration:g}: "
            "where the load has a corner it jumps, and no step bounds it; round the load, or state a solver.bandwidth"
        )
        return [Notice("error-bound", message, acceleration, asked.acceleration)]
    if velocity <= asked.velocity:
        return []
    if math.isinf(velocity):
        if not np.any(run.velocity):
            message = "nothing moves at the taps: the load is zero, or has not reached them by the end"
        else:
            message = "no error bound: a striker, joints that open, and layers with a speed are beyond its theorem"
        return [Notice("no-error-bound", message, math.inf, asked.velocity)]
    why = "the step is that of the case" if asked.step else "a finer step would take too long, or the load jumps"
    message = f"the error bound of velocity is {velocity:.2g} of its peak instead of {asked.velocity:g}: {why}"
    return [Notice("error-bound", message, velocity, asked.velocity)]
