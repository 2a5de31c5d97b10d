"""Histories of what was simulated: of a case that is run, or of a result that was kept.

This module alone of the comparison knows other analyses: it runs them, and reads what they keep.
"""

from __future__ import annotations

import functools
import re
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from strikewave.analyses.compare.agreement import QUANTITIES, ComparedCurve, even_history
from strikewave.base.datasets import LabelledArrays, is_sealed, open_result
from strikewave.base.errors import InputError, nearest
from strikewave.base.result import FAILED, RUN_BROKEN, VERDICT, Band, Notice, Result, status_of
from strikewave.cases.case import load_case
from strikewave.reporting.terminal import say
from strikewave.signal.alignment import EvenHistory
from strikewave.signal.motion import zero_before
from strikewave.signal.pulse import FOOT

Array = NDArray[np.float64]

_READING = re.compile(r"(?:what sensor|reading of the sensor) (.*?)(?: reads)?", re.DOTALL)
_AXIS = re.compile(r"\.[xyz]$")
_OF_PULSE = {"peak": "peak", "width": "width", "velocity_change": "area"}  # names in `Pulse` of the figures of bands
MOST_NAMED = 12  # parts that a line names
# Quantities that are means over intervals, and what they are of
_FEM = {"mean_acceleration": "acceleration", "mean_force": "force"}


class SimulatedPart(NamedTuple):
    """One history of what was simulated."""

    part: str  # sensor, tap, body or contact; ``rigid`` for the struck object as one body
    quantity: str  # name of the quantity, such as ``acceleration``
    unit: str  # SI
    time: Array  # s, SI
    values: Array
    blow: int = 0  # its number; 0 where it is not of one blow
    band: Mapping[str, Band] = {}  # bands of its peak, width and velocity change
    zero: float = 0.0  # reading of a sensor there that counts as zero: its baseline is taken before the first blow


def simulated_curve(option: str, place: str, part: str, blow: int, unit: str, band: bool) -> ComparedCurve:
    """Return a history of a case, which is run, or of the file of a result."""
    if place.lower().endswith(".nc"):
        name, parts, checked = _kept(place)
    else:
        name, parts, checked = _run(place, band)
    return _curve(option, name, parts, checked, part, blow, unit)


def solution_curve(option: str, solution: Result, part: str, blow: int, unit: str) -> ComparedCurve:
    """Return a history of a solution of run, wave or fem; the arguments are those of `simulated_curve`."""
    arrays = solution.arrays
    if arrays is None or not {"pulse_acceleration", "tap_acceleration", "momentum"} & set(arrays.variables):
        raise InputError(option, type(solution).__name__, "a solution of run, wave or fem, or a name")
    return _curve(
        option, solution.source.name, list(_parts(arrays, solution.band)), checked_run(solution), part, blow, unit
    )


class CheckedRun(NamedTuple):
    """Outcome of the checks of a simulation: its verdict, and the checks that failed."""

    verdict: str = ""
    notices: tuple[Notice, ...] = ()


def checked_run(solution: Result) -> CheckedRun:
    """Return what the checks of a solution came to."""
    failed = tuple(notice for notice in solution.notices if notice.broken)
    return CheckedRun(solution.own_verdict.text, failed)


def arrays_curve(option: str, name: str, arrays: LabelledArrays, part: str, blow: int, unit: str) -> ComparedCurve:
    """Return a history of the arrays of a run of a case of this name, without bands; see `simulated_curve`."""
    return _curve(option, name, list(_parts(arrays, {})), CheckedRun(), part, blow, unit)


def _parts(arrays: LabelledArrays, bands: Mapping[str, Band]) -> Iterator[SimulatedPart]:
    """Yield the histories of a machine, a bar or elements."""
    if "pulse_acceleration" in arrays:
        return _machine_parts(arrays, bands)
    return _wave_parts(arrays, bands) if "tap_acceleration" in arrays else _fem_parts(arrays)


def _curve(
    option: str, name: str, parts: Sequence[SimulatedPart], checked: CheckedRun, part: str, blow: int, unit: str
) -> ComparedCurve:
    """Return one of some histories."""
    chosen = _chosen(option, name, parts, part, blow, unit)
    words = f"{name}:{chosen.part}" + (f".{chosen.quantity}" if chosen.quantity != "acceleration" else "")
    words += f"@{chosen.blow}" if chosen.blow and len({one.blow for one in parts}) > 1 else ""
    history = even_history(chosen.time, chosen.values - chosen.zero)
    curve = ComparedCurve(words, "simulation", _from_rest(history), chosen.unit)
    curve = replace(curve, notices=checked.notices, verdict=checked.verdict)
    return replace(curve, band=_of_sensor(chosen, curve) if chosen.zero else chosen.band)


def _of_sensor(part: SimulatedPart, curve: ComparedCurve) -> Mapping[str, Band]:
    """Return bands moved by as much as the zero of a sensor moves each figure."""
    if not part.band:
        return part.band
    pulse = curve.pulse
    unmoved = replace(curve, history=even_history(part.time, part.values)).pulse
    moved = {key: getattr(pulse, name) - getattr(unmoved, name) for key, name in _OF_PULSE.items()}
    return {
        key: replace(band, low=band.low + moved[key], high=band.high + moved[key]) for key, band in part.band.items()
    }


def _from_rest(history: EvenHistory) -> EvenHistory:
    """Return a history that begins below the feet of its pulse with as much of that rest before it as it lasts."""
    values, count = history.values, history.values.size
    if count == 0 or not abs(values[0]) <= FOOT * np.max(np.abs(values)):
        return history
    held = np.concatenate([np.full(count, values[0]), values])
    return history._replace(values=held, start=history.start - count * history.step)


def _chosen(option: str, name: str, parts: Sequence[SimulatedPart], part: str, blow: int, unit: str) -> SimulatedPart:
    """Return the history that is wanted; of several quantities the one in the preferred unit, or an acceleration."""
    known = list(dict.fromkeys(history.part for history in parts))
    if not known:
        raise InputError(option, name, "a result with histories")
    wanted, quantity = part or known[0], ""
    if wanted not in known:
        wanted, _, quantity = part.rpartition(".")
        if wanted not in known:
            raise InputError(option, f"{name}:{part}", "a part of the simulation", nearest(part, known))
    elif not part and len(known) > 1:
        others = [history for history in known[1:] if not _AXIS.search(history)]
        say(f"{option} is {known[0]} of {name}; {name}:PART takes another: {', '.join(others[:MOST_NAMED])}")
    histories = [history for history in parts if history.part == wanted]
    quantities = list(dict.fromkeys(history.quantity for history in histories))
    if quantity and quantity not in quantities:
        raise InputError(option, f"{name}:{part}", f"a quantity of {wanted}", nearest(quantity, quantities))
    blows = sorted({history.blow for history in histories})
    if blow and blow not in blows:
        allowed = f"a blow that struck, {', '.join(map(str, blows))}" if any(blows) else "no blow: there is only one"
        raise InputError(option, f"{name}@{blow}", allowed)
    histories = [history for history in histories if history.blow == (blow or blows[0])]
    for how in (
        lambda history: history.quantity == quantity,
        lambda history: history.unit == unit,
        lambda history: history.unit == "m/s^2",
    ):
        for history in histories:
            if how(history):
                return history
    return histories[0]


@functools.lru_cache(maxsize=2)
def _run(place: str, band: bool) -> tuple[str, list[SimulatedPart], CheckedRun]:
    """Run a case and return its name, its histories, and what was noticed."""
    case = load_case(place)
    solution: Any
    say(f"running {case.name}")
    if case.command == "fem":
        from strikewave.analyses.fem.run import run_fem

        solution = run_fem(case)
    elif case.command == "wave":
        from strikewave.analyses.wave.run import run_wave, with_bands

        solution = run_wave(case)
        solution = with_bands(solution) if band else solution
    else:
        from strikewave.analyses.machine.run import run_case

        solution = run_case(case, band=band)
    return case.name, list(_parts(solution.arrays, solution.band)), checked_run(solution)


def is_solution(path: Path) -> bool:
    """Tell whether a NetCDF file is one that run, wave or fem wrote."""
    try:
        return is_sealed(path)
    except OSError:
        return False


def _kept(place: str) -> tuple[str, list[SimulatedPart], CheckedRun]:
    """Return the histories of a result that was kept."""
    path = Path(place)
    name = path.parent.name or path.stem
    if path.name == "solution.nc":
        from strikewave.analyses.machine.result import load_solution

        solution = load_solution(path)
        return name, list(_parts(solution.arrays, solution.band)), checked_run(solution)
    allowed = "the file of a result that `strikewave run`, `wave` or `fem` wrote"
    with open_result(path, allowed) as opened:
        if "strikewave_schema" not in opened.attrs:
            raise InputError("solution", path, allowed)
        old = int(opened.attrs["strikewave_schema"]) < 2
        meshed = tomllib.loads(str(opened.attrs.get("case", ""))).get("mesh", {}).get("part", []) if old else []
        if any(part.get("sector", "whole") != "whole" for part in meshed):
            hint = "its forces are those of the meshed sector; run the case again for those of whole bodies"
            raise InputError("solution", path, "histories of whole bodies", hint)
        arrays = LabelledArrays.of_xarray(opened.load())
        parts = list(_parts(arrays, {}))  # within, so that arrays that are none of a result are refused
    verdict = str(arrays.attrs.get(VERDICT, ""))  # what its checks came to when it was made; nothing in older files
    notices: tuple[Notice, ...] = ()
    if status_of(verdict) == RUN_BROKEN:
        message = f"{name} failed a check when it was made: {verdict.partition(': ')[2]}"
        notices = (Notice("simulation-broken", message, severity=FAILED),)
    return name, parts, CheckedRun(verdict, notices)


def _machine_parts(arrays: LabelledArrays, bands: Mapping[str, Band]) -> Iterator[SimulatedPart]:
    """Yield the object as one body, then sensors and taps, blow by blow as far as they struck, and the whole train."""
    time, numbers = arrays["pulse_time"].values, [int(one) for one in arrays["blow"].values]
    names = {"peak": "rigid_peak", "width": "width", "velocity_change": "velocity_change"}
    first = True
    zeros: dict[str, float] = {}  # one of each part for all blows, as `strikewave record` takes one baseline

    def sensed(part: SimulatedPart) -> SimulatedPart:
        return part._replace(zero=zeros.setdefault(part.part, zero_before(part.time, part.values)))

    for row, blow in enumerate(numbers):
        if not np.any(np.isfinite(arrays["pulse_acceleration"].values[row])):
            continue
        of = {key: bands[f"first.{name}"] for key, name in names.items() if first and f"first.{name}" in bands}
        for quantity, unit in (("acceleration", "m/s^2"), ("force", "N")):
            values = arrays[f"pulse_{quantity}"].values[row]
            known = of if quantity == "acceleration" else {}
            part = SimulatedPart("rigid", quantity, unit, *_span(time, values), blow, known)
            yield sensed(part) if quantity == "acceleration" else part
        for variable, key, sensor in _sensors(arrays):
            values, begin = variable.values[row], float(arrays[f"{key}_start"].values[row])
            clock = begin + float(variable.attrs["step"]) * np.arange(values.size)
            peak = _peak_band(bands if first else {}, f"sensor.{sensor}.peak")
            if np.any(np.isfinite(values)):
                yield sensed(SimulatedPart(sensor, "acceleration", "m/s^2", *_span(clock, values), blow, peak))
        for k, tap in enumerate(arrays["tap"].values if "tap" in arrays else ()):
            for quantity, unit in (("acceleration", "m/s^2"), ("force", "N"), ("velocity", "m/s")):
                values = arrays[f"tap_{'speed' if quantity == 'velocity' else quantity}"].values[row, k]
                if np.any(np.isfinite(values)):
                    part = SimulatedPart(str(tap), quantity, unit, *_span(time, values), blow)
                    yield sensed(part) if quantity == "acceleration" else part
        first = False


def _peak_band(bands: Mapping[str, Band], name: str) -> dict[str, Band]:
    """Return the band of a peak, where there is one."""
    return {"peak": bands[name]} if name in bands else {}


def _sensors(arrays: LabelledArrays) -> Iterator[tuple[Any, str, str]]:
    """Yield the readings of sensors, with their keys and the names of the sensors."""
    for key, variable in arrays.data_vars.items():
        match = _READING.fullmatch(str(variable.attrs.get("long_name", "")))
        if re.fullmatch(r"reading_\d+", key) and match:
            yield variable, key, match[1]


def _wave_parts(arrays: LabelledArrays, bands: Mapping[str, Band]) -> Iterator[SimulatedPart]:
    """Yield sensors, then taps with all their quantities, the stack as one body, and the force on its face."""
    time = arrays["time"].values
    for variable, key, sensor in _sensors(arrays):
        band = _peak_band(bands, f"sensor.{sensor}.peak")
        clock = arrays[f"{key}_time"].values
        yield SimulatedPart(sensor, "acceleration", "m/s^2", *_span(clock, variable.values), 0, band)
    sensors = {sensor for _, _, sensor in _sensors(arrays)}
    for k, tap in enumerate(map(str, arrays["tap"].values)):
        for quantity, unit in (("acceleration", "m/s^2"), ("force", "N"), ("velocity", "m/s"), ("stress", "Pa")):
            values = arrays[f"tap_{quantity}"].values[:, k]
            band = _peak_band(bands, f"tap.{tap}.peak_{quantity}")
            if np.any(np.isfinite(values)) and not (tap in sensors and quantity == "acceleration"):
                yield SimulatedPart(tap, quantity, unit, *_span(time, values), 0, band)
    yield SimulatedPart("rigid", "acceleration", "m/s^2", *_span(time, arrays["rigid_acceleration"].values))
    yield SimulatedPart("face", "force", "N", *_span(time, arrays["face_force"].values))


def _fem_parts(arrays: LabelledArrays) -> Iterator[SimulatedPart]:
    """Yield bodies, groups, points, sections and contacts along the axis on which each moves most, and along each."""
    kinds = ("part", "group", "point", "section", "contact")
    variables = {key: variable for key, variable in arrays.data_vars.items() if key.partition(".")[0] in kinds}
    for key, variable in sorted(variables.items(), key=lambda pair: kinds.index(pair[0].partition(".")[0])):
        kind, _, rest = key.partition(".")
        name, _, what = rest.rpartition(".")
        quantity = _FEM.get(what, what)
        body = kind in ("part", "group")
        if not name or variable.dims[1:] != ("axis",) or quantity not in QUANTITIES.values():
            continue
        if (body and what == "acceleration") or (kind == "contact" and what == "force"):
            continue  # the means over the intervals are the ones that do not depend on the step
        time = arrays[variable.dims[0]].values
        unit = str(variable.attrs["units"])
        columns = np.asarray(variable.values, dtype=float)
        most = int(np.argmax(np.nanmax(np.abs(columns), axis=0)))
        yield SimulatedPart(name, quantity, unit, *_span(time, columns[:, most]))
        for axis, values in zip("xyz", columns.T, strict=True):
            yield SimulatedPart(f"{name}.{axis}", quantity, unit, *_span(time, values))


def _span(time: Array, values: Array) -> tuple[Array, Array]:
    """Return times and values from the first that is a number to the last."""
    known = np.flatnonzero(np.isfinite(values))
    between = slice(int(known[0]), int(known[-1]) + 1) if known.size else slice(0, 0)
    return time[between], values[between]
