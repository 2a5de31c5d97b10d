"""The report of a layered bar alone as one HTML page, and its tables for the screen."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple

from strikewave.analyses.wave.field import field_of_solution
from strikewave.base.first_few import first_few
from strikewave.reporting import chapters
from strikewave.reporting.banded_numbers import fixed_within, with_band
from strikewave.reporting.bands import band_sections, bands_of
from strikewave.reporting.curves import Trace, traces
from strikewave.reporting.layout import KEY, MORE
from strikewave.reporting.numbers import headed, listed, shown, shown_heads, spelled, with_unit
from strikewave.reporting.parts import NONE, Flow, Part, Picture, Section, Table, Tag, written
from strikewave.reporting.shown_units import shown_unit
from strikewave.reporting.stack_chapters import (
    MOST_LAYERS,
    field_pictures,
    fit_table,
    layer_table,
    route_section,
    sensor_part,
)
from strikewave.reporting.table_columns import TableColumn, page_table
from strikewave.reporting.wave_curves import staircase_diagram
from strikewave.reporting.wave_field import WaveField, sandwiched

if TYPE_CHECKING:
    from strikewave.analyses.wave.result import WaveSolution
    from strikewave.base.result import Band
    from strikewave.cases.case import Case
    from strikewave.sensors.channel import SensorPulse


_SINCE_LOAD = "time after the start of the load"
_DATA_FLOW = ("case file", "checks of units and fits", "stack", "stress waves", "taps and sensors")
_TAP_UNITS: Sequence[tuple[str, str, str, int]] = (
    ("force", "N", "kN", 3),
    ("stress", "Pa", "MPa", 2),
    ("velocity", "m/s", "m/s", 3),
    ("acceleration", "m/s^2", "g", 0),
)
"""What a tap shows, its SI unit, the unit shown as a rule, and decimals."""
MOST_OPENINGS = 5
"""Openings, and closings, of a joint that a table lists (chosen: a row stays one line; the JSON has them all)."""
MOST_CURVES = 4
"""Taps that a picture draws: as many as there are dashes, so that no two curves look alike in print."""


class TapPeak(NamedTuple):
    """What a tap shows at most: what, its signed value, its band, SI unit, unit shown as a rule, decimals."""

    what: str
    value: float | None
    band: Band | None
    si: str
    usual: str
    decimals: int

    def shown(self) -> str:
        """Return the value in the unit shown, in the digits that a table has beside its band."""
        bands = [] if self.band is None else [self.band]
        return fixed_within(self.value, bands, self.si, self.usual, self.decimals)


def tap_peaks(solution: WaveSolution, k: int) -> list[TapPeak]:
    """Return the peak values at a tap, for the route of the case. The stress is the force over the area."""
    name, tap = solution.taps[k]
    area = solution.run.stack.layers[tap.layer].area
    values = solution.peaks(k, solution.route)
    bands = {what: solution.band.get(f"tap.{name}.peak_{what}") for what in values}
    force, band = values["force"], bands["force"]
    values = {**values, "stress": None if force is None else force / area}
    bands["stress"] = band and dataclasses.replace(band, low=band.low / area, high=band.high / area)
    return [TapPeak(one[0], values[one[0]], bands[one[0]], *one[1:]) for one in _TAP_UNITS]


class TapRow(NamedTuple):
    """A tap: its name, the route, its layer and place in it, and what it shows at most."""

    name: str
    route: str
    layer: str
    position: float
    peaks: Mapping[str, TapPeak]


def tap_rows(solution: WaveSolution) -> list[TapRow]:
    """Return a row a tap, for the route of the case."""
    layers = solution.run.stack.layers
    return [
        TapRow(name, solution.route, layers[tap.layer].name, tap.position, {p.what: p for p in tap_peaks(solution, k)})
        for k, (name, tap) in enumerate(solution.taps)
    ]


def _peak_column(what: str, si: str, usual: str) -> TableColumn[TapRow]:
    return TableColumn(what, lambda row: row.peaks[what].shown(), si, usual)


TAP_COLUMNS: tuple[TableColumn[TapRow], ...] = (
    TableColumn("tap", lambda row: row.name, priority=KEY, words=True),
    TableColumn("route", lambda row: row.route, priority=MORE + 1, words=True),
    TableColumn("layer", lambda row: row.layer, priority=MORE, words=True),
    TableColumn("position", lambda row: f"{row.position:g}", priority=MORE),
    *(_peak_column(what, si, usual) for what, si, usual, _ in _TAP_UNITS),
)
"""Of the largest values at the taps, for screen and page."""


def sensor_columns(band: Mapping[str, Band]) -> tuple[TableColumn[tuple[str, SensorPulse]], ...]:
    """Return the columns of what sensors, by name, read; with the digits that their bands leave."""

    def peak(row: tuple[str, SensorPulse]) -> str:
        return fixed_within(row[1].peak, bands_of(band, f"{row[0]} peak"), "m/s^2", "g", 0)

    return (
        TableColumn("sensor", lambda row: row[0], priority=KEY, words=True),
        TableColumn("peak", peak, "m/s^2", "g"),
        TableColumn("pulse width at 10 %", lambda row: row[1].width, "s", "us", decimals=1),
        TableColumn("clipped", lambda row: Tag("clipped", "bad") if row[1].clipped else Tag("no"), words=True),
    )


def wave_words(solution: WaveSolution) -> str:
    """Return the peak values at the taps as a sentence."""
    at_taps = []
    for k, (name, tap) in enumerate(solution.taps):
        peaks = [peak for peak in tap_peaks(solution, k) if peak.value is not None]
        words = listed([f"{peak.shown()} {spelled(shown_unit(peak.si, peak.usual))}" for peak in peaks])
        at_taps.append(f"{name} (in {solution.run.stack.layers[tap.layer].name}): {words}")
    return f"A layered bar under its load, route {solution.route}. Signed peak values: {'; '.join(at_taps)}."


def key_numbers(solution: WaveSolution) -> list[tuple[str, str]]:
    """Return the peak values at the first tap, each with its band where it has one, and what the sensors read."""
    band, numbers = solution.band, list[tuple[str, str]]()
    if solution.taps:
        name = solution.taps[0][0]
        for peak in tap_peaks(solution, 0):
            if peak.value is not None:
                shown_peak = with_band(peak.value, peak.band, peak.si, peak.usual)
                numbers.append((f"{peak.what} at {name}", shown_peak))
    for name, pulse in solution.sensors.items():
        numbers.append((f"sensor {name}", with_band(pulse.peak, band.get(f"sensor.{name}.peak"), "m/s^2", "g")))
    return numbers


def error_words(solution: WaveSolution) -> str:
    """Say how exact the waves of a bar are."""
    velocity, acceleration = solution.accuracy
    bounds = "no bound" if math.isinf(velocity) else f"velocity {velocity:.1e}, acceleration {acceleration:.1e}"
    step = with_unit(solution.waves.step, "s", "ns")
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


def joint_rows(solution: WaveSolution, most: int = MOST_OPENINGS) -> list[list[str]]:
    """List the joints that can open, and their first openings and closings."""

    def times(values: Sequence[float]) -> str:
        return first_few([written(shown(t, "s", "us"), 5) for t in values], most) or NONE

    return [
        [row["after"], row["kind"], f"{shown(row['preload'], 'N', 'N'):g}", times(row["opened"]), times(row["closed"])]
        for row in solution.joints()
    ]


def contact_rows(solution: WaveSolution) -> list[list[str]]:
    """List peak force, indentation, impulse and losses of the contact of a striker; nothing without one."""
    contact = solution.contact()
    if contact is None:
        return []
    touches = contact["contacts"]
    last = written(shown(touches[-1]["end"], "s", "us"), 5) if touches else NONE
    return [
        [headed("peak force", "N", "kN"), written(shown(contact["peak_force"], "N", "kN"), 5)],
        [headed("deepest indentation", "m", "um"), written(shown(contact["max_indentation"], "m", "um"))],
        [headed("contacts, the last one until", "s", "us"), f"{len(touches)}, {last}"],
        [headed("impulse", "N s", "N s"), written(shown(contact["impulse"], "N s", "N s"), 5)],
        [headed("rebound speed of the striker", "m/s", "m/s"), written(shown(contact["rebound_speed"], "m/s", "m/s"))],
        [headed("energy lost in the contact", "J", "J"), written(shown(contact["energy_lost"], "J", "J"))],
    ]


def oscillator_rows(solution: WaveSolution) -> list[list[str]]:
    """List the masses on springs and their largest acceleration, without any filter."""
    return [
        [row["where"], written(shown(row["mass"], "kg", "gram")), written(shown(row["peak"], "m/s^2", "g"), 5)]
        for row in solution.oscillators()
    ]


def _staircase(field: WaveField, layer: int, solution: WaveSolution) -> Picture:
    """Show how force grows at both faces of a layer between two others."""
    name, run = field.stack.layers[layer].name, solution.run
    caption = (
        f"Force at both faces of {name} over the largest load. Dashed: the closed form for bonded joints and endless "
        "neighbours under this load, until the first echo from beyond them arrives (vertical line); dotted: its steps "
        "for a load that jumps."
    )
    return Picture(staircase_diagram(field, layer, run.time, run.face_force), caption)


def wave_tables(solution: WaveSolution) -> list[tuple[str, list[str], list[list[str]]]]:
    """Return the further tables of a bar, captions, heads and rows: contact, masses on springs, joints, layers."""
    layers = [
        [layer.name, written(shown(stress, "Pa", "MPa"))]
        for layer, stress in zip(solution.waves.layers, solution.layer_stress, strict=False)
    ]
    tables = [
        ("Contact of the striker", ["contact of the striker", "value"], contact_rows(solution)),
        (
            "Masses on springs",
            shown_heads("mass on a spring", "mass (gram)", "largest acceleration (g)"),
            oscillator_rows(solution),
        ),
        (
            "Joints that can open",
            shown_heads("after", "kind", "preload (N)", "opens at (us)", "closes at (us)"),
            joint_rows(solution),
        ),
        ("Largest stress in each layer", ["layer", "stress (MPa)"], layers[:MOST_LAYERS]),
    ]
    return [(caption, shown_heads(*heads), rows) for caption, heads, rows in tables if rows]


def wave_sections(solution: WaveSolution, quantity: str = "stress") -> list[Section]:
    """Show waves at the taps, the field of a quantity, staircase, sensors, routes, then peak values of a bar alone."""
    run, time = solution.run, solution.run.time
    names = [name for name, _ in solution.taps[:MOST_CURVES]]
    parts: list[Part] = []
    force = [Trace(name, time, run.force[:, k]) for k, name in enumerate(names)]
    speed = [Trace(name, time, run.velocity[:, k]) for k, name in enumerate(names)]
    total = [Trace(name, time, run.acceleration[:, k]) for k, name in enumerate(names)]
    parts += [
        Picture(
            traces("Force", [*force, Trace("first face", time, run.face_force)], "kN", _SINCE_LOAD),
            "Force at the taps, and on the first face (exact).",
        ),
        Picture(traces("Velocity", speed, "m/s", _SINCE_LOAD), "Velocity at the taps (exact)."),
        Picture(
            traces("Acceleration", [*total, Trace("rigid body", time, solution.rigid)], "g", _SINCE_LOAD),
            "Acceleration at the taps (exact), and of the bar as one rigid body."
            + ("" if solution.quoted else " Its peaks are not to be quoted: see the warnings."),
        ),
    ]
    field = field_of_solution(solution)
    parts += field_pictures(field, quantity)
    layer = sandwiched(field)
    if layer is not None:
        parts.append(_staircase(field, layer, solution))
    sections = [Section("Stress waves", "", parts)]
    if solution.channels:
        readings = [
            Trace(channel.sensor.name, reading.time, reading.values)
            for channel, reading in zip(solution.channels, solution.readings, strict=True)
        ]
        picture = traces("Sensor readings", readings, "g", _SINCE_LOAD)
        table = page_table("Sensor readings", sensor_columns(solution.band), solution.sensors.items())
        sections.append(sensor_part(solution.channels, picture, table))
    tap = next((k for k, (name, _) in enumerate(solution.taps) if (name, "corrected") in solution.routes), None)
    if tap is not None:
        name = solution.taps[tap][0]
        waves = [solution.routes[name, route].acceleration for route in ("as printed", "corrected")]
        sections.append(
            route_section(name, solution.quoted, time, run.acceleration[:, tap], solution.rigid, waves, _SINCE_LOAD)
        )
    return [*sections, _peak_section(solution)]


def _peak_section(solution: WaveSolution) -> Section:
    """List the peak values at the taps, of contact, masses, joints and layers."""
    taps = page_table("Peak values at the taps", TAP_COLUMNS, tap_rows(solution))
    others = [Table(caption, heads, [list(row) for row in rows]) for caption, heads, rows in wave_tables(solution)]
    return Section("Peak values", "", [taps, *others])


def _accuracy_section(solution: WaveSolution) -> Section:
    """Say how exact the waves are."""
    accuracy = error_words(solution)
    accuracy = accuracy[0].upper() + accuracy[1:]
    tables: list[Part] = [] if solution.method == "spectral" else [layer_table(solution.waves)]
    if solution.losses:
        tables.append(fit_table(solution.losses))
    return Section("Accuracy of the waves", f"{accuracy}.", tables)


def wave_report(solution: WaveSolution, quantity: str = "stress") -> str:
    """Return the report of a bar alone as one HTML page.

    ``quantity`` is what the pictures of the whole field show: stress, force or velocity.

    Examples
    --------
    >>> from strikewave import load_case, run_wave
    >>> "x-t" in wave_report(run_wave(load_case("li-ma-2019-fig13-bar")))
    False
    """
    case = solution.case
    parts = [
        *wave_sections(solution, quantity),
        *band_sections(solution),
        chapters.warnings(solution.notices),
        _setup(case),
        chapters.inputs(case),
        _accuracy_section(solution),
        Section(
            "Momentum balance",
            "Balance error: impulses at both ends less the momentum of the bar, over the greater impulse.",
            [chapters.balance_table(solution.balance_checks)],
        ),
    ]
    summary = chapters.Summary("Report of waves in a layered bar", wave_words(solution), key_numbers(solution))
    return chapters.result_page(solution, summary, parts)


def _setup(case: Case) -> Section:
    flows = [
        Flow(chapters.layer_steps(case), "The layers, from the loaded face to the far end"),
        Flow(_DATA_FLOW, "From the case to this report"),
    ]
    return Section("Set-up", "A layered bar, loaded at its first face; no machine.", flows)
