"""Results of shock response spectra: frequencies, tables, documents."""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strikewave.analyses.record.options import Spectra
from strikewave.base import declare
from strikewave.base.declare import GivenUnits, Quantity
from strikewave.base.shock_quantities import FREQUENCY, LENGTH, MICROSECONDS, RATIO, VELOCITY
from strikewave.records import ChannelReading, Options, Request
from strikewave.records.budget import Budget
from strikewave.records.health_notice import HealthNotice, worst
from strikewave.records.measured_uncertainty import AS_SPECTRUM, SpectrumUncertainty, spectrum_uncertainty
from strikewave.reporting import measured_files as measured
from strikewave.reporting.columns import HISTORY_DIGITS, Column, csv_table
from strikewave.reporting.faces import heads_and_cells, text_of
from strikewave.reporting.measured_files import Filtering, MeasurementOptions
from strikewave.reporting.numbers import axis_unit, hertz
from strikewave.reporting.shown_result import Curve
from strikewave.signal.srs import (
    FEWEST,
    Scope,
    Spectrum,
    all_srs,
    envelope,
    response_history,
    rms_spectrum,
    tolerance_limit,
)
from strikewave.specifications.judged_records import SpectraVerdict

Array = NDArray[np.float64]

# Kinds of spectrum, with their units for an acceleration
KINDS = {
    "absolute": Quantity("m/s^2", "g"),
    "displacement": LENGTH,
    "relative-velocity": VELOCITY,
    "pseudo-velocity": VELOCITY,
    "equivalent-static": Quantity("m/s^2", "g"),
}
ACCELERATION = "m/s^2"
# Text behind the name of a kind where the record is no acceleration: its values are in the file's own numbers
NO_ACCELERATION = f" for a record in {ACCELERATION}"
AS_CHANNEL = Quantity.of_data("as the channel")
# Findings with which a record enters no envelope, as with one that is bad: its spectrum is wrong as a whole
LEFT_OUT = ("gain-differs",)


@dataclass(frozen=True)
class SpectraAsked:
    """Request for the spectra of measured files."""

    files: Sequence[str]
    # What is stated of the channels, how the files are read, and a request with the filters that are taken
    stated: dict[str, dict[str, Any]]
    options: Options
    filters: Request
    spectra: Spectra
    budget: Budget | None = None  # by which the uncertainties of the spectra are found
    # True if each of several is computed up to what its own sampling carries too, to be judged by itself
    own_range: bool = False

    @classmethod
    def of(
        cls,
        files: Sequence[str],
        spectra: Spectra,
        measurement: MeasurementOptions,
        filtering: Filtering,
        budget: Budget | None,
    ) -> SpectraAsked:
        """Return what the options say."""
        return cls(files, measurement.calibration(), measurement.reading(), filtering.on(Request()), spectra, budget)


@declare.dataclass
class OscillatorResponse:
    """Response of one oscillator while the record lasts."""

    frequency: float = declare.number(FREQUENCY, "its natural frequency")
    time: Array = declare.history("s", "times of the record")
    histories: Mapping[str, Array] = declare.history(AS_SPECTRUM, "its response; so for each kind", inline=True)


@declare.dataclass
class ChannelRolling:
    """Spectra of windows that slide over a channel."""

    kind: str = declare.word("kind of spectrum")
    time: Array = declare.history("s", "middle of each window")
    values: Array = declare.history(AS_SPECTRUM, "its spectrum, a row a window")
    frequency: Array


@declare.dataclass
class ChannelSpectra:
    """Spectra of a channel, and the other results asked for."""

    spectra: list[Spectrum]  # one a kind
    side: str

    @declare.computed(declare.history(AS_SPECTRUM, "the spectrum; so for each kind asked for", inline=True))
    def values(self) -> dict[str, Array]:
        """Spectra of the side that was asked for, by kind."""
        return {one.kind: one.side(self.side) for one in self.spectra}

    rms: Mapping[str, Array] | None = declare.word(
        "root mean squares of the responses, by kind", default=None, optional=True
    )
    response: OscillatorResponse | None = declare.part(
        OscillatorResponse, "what one oscillator does", default=None, optional=True
    )
    rolling: ChannelRolling | None = declare.part(
        ChannelRolling, "the first kind in windows that slide over the record", default=None, optional=True
    )
    # Uncertainties of each kind, where a budget was stated, or a verdict asked for
    uncertainties: Sequence[SpectrumUncertainty] = ()

    @declare.computed(declare.named(SpectrumUncertainty, "uncertainty of each kind", optional=True))
    def uncertainty(self) -> dict[str, SpectrumUncertainty] | None:
        """Uncertainties by kind, at the same frequencies."""
        pairs = zip(self.spectra, self.uncertainties, strict=False)
        return {one.kind: each.lowest(len(one.frequency)) for one, each in pairs} or None


@declare.dataclass
class SpectrumRecord:
    """Record of a spectrum."""

    file: str = declare.word("measured file")
    channel: str = declare.word("channel")
    status: str = declare.word("good, suspect or bad")

    @property
    def name(self) -> str:
        """File and channel."""
        return f"{Path(self.file).name}, {self.channel}"


@declare.dataclass
class ShockSpectra(SpectrumRecord):
    """Spectra of one channel of a file among several."""

    left_out: str | None = declare.word("why it is not in the envelope; null where it is")
    zero_line: float = declare.number(AS_CHANNEL, "baseline that was taken off")
    found: ChannelSpectra = declare.part(ChannelSpectra, "its spectra", inline=True)
    judged: Spectrum | None = None  # the first kind, up to what the sampling of this record carries, where it is judged
    harmed: str = ""  # why the spectrum is not to be judged; empty where it may be


@declare.dataclass
class SpectrumAsked:
    """Settings of spectra."""

    q: float | str = declare.number(RATIO, "quality factor of the oscillators; inf without damping")
    side: str = declare.word("maximax, positive or negative")
    part: str = declare.word("total, primary (while the shock lasts) or residual")


@declare.dataclass
class SpectraOfOne(SpectrumRecord):
    """Document of the spectra of one channel."""

    calibration: Mapping[str, Any] = declare.word("what was stated of it, as typed")
    zero_line: float = declare.number(AS_CHANNEL, "baseline that was taken off")
    asked: SpectrumAsked = declare.part(SpectrumAsked, "what was asked", inline=True)
    end: float | None = declare.number(MICROSECONDS, "end of the shock; null where it was not needed")
    frequency: Array = declare.history(FREQUENCY, "natural frequencies")
    initial: str = declare.word("how the record begins: rest, shifted or steady")
    found: ChannelSpectra = declare.part(ChannelSpectra, "its spectra", inline=True)


@declare.dataclass
class CommonSpectra:
    """Envelope and limit of several spectra, by kind; or their resultant."""

    resultant: Mapping[str, Array] = declare.word("vector sum of all axes at each frequency, by kind")
    envelope: Mapping[str, Array] = declare.word("largest of all spectra at each frequency, by kind")
    p95_50: Mapping[str, Array] = declare.word("tolerance limit P95/50 at each frequency, by kind")


@declare.dataclass
class SpectraOfSeveral:
    """Document of the spectra of several channels."""

    asked: SpectrumAsked = declare.part(SpectrumAsked, "what was asked", inline=True)
    initial: str = declare.word("how the records begin: rest, shifted or steady")
    frequency: Array = declare.history(FREQUENCY, "natural frequencies")
    spectra: Sequence[ShockSpectra] = declare.rows(ShockSpectra, "spectra of several channels")
    together: Mapping[str, Mapping[str, Array]] = declare.part(CommonSpectra, "what they come to", inline=True)


@declare.dataclass
class LargestResponse:
    """Largest response of a spectrum."""

    kind: str
    of: str
    frequency: float
    given_units: GivenUnits  # unit of its value
    value: float = declare.number(AS_SPECTRUM, "largest value", headline="largest {name}")

    @property
    def name(self) -> str:
        """Kind and frequency of the largest response."""
        return f"{self.kind} {self.of}, at {self.place}"

    @property
    def place(self) -> str:
        """Frequency as a sentence says it."""
        return hertz(self.frequency)

    @property
    def text(self) -> str:
        """Value as a sentence says it."""
        return text_of(self, "value", self.given_units)


def spectrum_findings(reading: ChannelReading) -> list[HealthNotice]:
    """Return what was found on a record, without that it swings rather than being struck: so does a pyroshock."""
    return [finding for finding in reading.findings if finding.code != "no-pulse" or "spectrum" in finding.harms]


def status_of(reading: ChannelReading) -> str:
    """Return how good a record is for a spectrum."""
    return worst(spectrum_findings(reading))


def harm_of(reading: ChannelReading) -> str:
    """Return why a spectrum is not to be judged; that no one-sided blow stands out is how a pyroshock is."""
    for finding in spectrum_findings(reading):
        if finding.severity == "bad" or finding.code in LEFT_OUT or "spectrum" in finding.harms:
            return finding.message
    return ""


@declare.dataclass
class SpectrumResult(measured.AskedResult):
    """Spectra of one channel of a file, or of several; see `Result` for what it shares with others.

    Attributes
    ----------
    first : ShockSpectra
        Spectra of one channel alone; of several, those of the first that is not left out.
    reading : ChannelReading
        Examined channel of these spectra.
    scope : Scope
        Part of the response that counts, and how the record is read.
    shocks : sequence of ShockSpectra
        All of several; empty for one.
    resultant : mapping
        Vector sums of all axes by kind, where asked for.
    bounded_by : str
        Sampling rate that bounds the frequencies that several channels have in common, where they differ in it.
    """

    command: ClassVar[str] = "srs"
    main_rows: ClassVar[str] = "spectrum_columns"

    first: ShockSpectra
    reading: ChannelReading
    scope: Scope
    shocks: Sequence[ShockSpectra] = ()
    resultant: Mapping[str, Array] = field(default_factory=dict)
    bounded_by: str = ""

    @declare.computed(declare.part(SpectraOfOne, "spectra of one channel", inline=True, optional=True))
    def of_one(self) -> SpectraOfOne | None:
        """Part of the document on one channel alone."""
        if self.shocks:
            return None
        first, reading, scope = self.first, self.reading, self.scope
        end = None if scope.end is None else scope.end + reading.channel.start
        record = (first.file, first.channel, first.status, reading.calibration.stated(), first.zero_line)
        return SpectraOfOne(*record, self._asked, end, self.frequency, scope.initial, first.found)

    @declare.computed(declare.part(SpectraOfSeveral, "spectra of several channels", inline=True, optional=True))
    def of_several(self) -> SpectraOfSeveral | None:
        """Part of the document on several channels."""
        if not self.shocks:
            return None
        return SpectraOfSeveral(self._asked, self.scope.initial, self.frequency, self.shocks, self.together)

    verdict: SpectraVerdict | None = declare.part(
        SpectraVerdict, "the verdict by a specification", key="spec", default=None, optional=True
    )
    budget: Budget | None = declare.part(Budget, "budget of the uncertainties", default=None, optional=True)

    count = declare.computed(declare.count("how many of several", headline="spectra", in_document=False))(
        lambda result: len(result.shocks) or None
    )

    @declare.computed(declare.rows(LargestResponse, "largest responses", headline="each", in_document=False))
    def largest(self) -> list[LargestResponse]:
        """Largest responses of one channel, or of the envelope or resultant of several."""
        of, kinds = next(iter(self.together.items()), ("response", self.first.found.values))
        return self.largest_of(kinds, of)

    quality = declare.phrase("quality factor", headline="quality factor")(
        lambda result: "undamped" if math.isinf(result.spectra[0].q) else f"{result.spectra[0].q:g}"
    )

    @declare.computed(declare.table("spectra over natural frequency"))
    def spectrum_columns(self) -> list[Column]:
        """Spectra, after envelope and limit of several."""
        each = [one for shock in self.shocks for one in self.channel_columns(shock.found, f" of {shock.name}")]
        return [*self.main_columns, *each]

    @property
    def title(self) -> str:
        """File, channel, and the part of the shock where that is not the whole."""
        part = "" if self.scope.part == "total" else f", {self.scope.part} part"
        return f"{f'{self.counted} of {self.origin.name}' if self.shocks else self.first.name}{part}"

    @property
    def counted(self) -> str:
        """Number of spectra, in words."""
        return f"{len(self.shocks)} shock response {'spectra' if len(self.shocks) > 1 else 'spectrum'}"

    @property
    def spectra(self) -> list[Spectrum]:
        """Spectra of the first channel, one a kind."""
        return self.first.found.spectra

    @property
    def side(self) -> str:
        """Side of the spectra: maximax, positive or negative."""
        return self.first.found.side

    @property
    def frequency(self) -> Array:
        """Natural frequencies."""
        return np.asarray(self.spectra[0].frequency)

    @property
    def damping(self) -> str:
        """Quality factor as a sentence says it."""
        return self.quality if math.isinf(self.spectra[0].q) else f"Q = {self.quality}"

    @property
    def is_acceleration(self) -> bool:
        """True if the records are accelerations: the spectra have units then."""
        return self.reading.channel.unit == ACCELERATION

    @property
    def used(self) -> list[ShockSpectra]:
        """Spectra that enter the envelope."""
        return [shock for shock in self.shocks if not shock.left_out]

    @property
    def responses(self) -> list[tuple[ShockSpectra, OscillatorResponse]]:
        """Response of one oscillator on each channel, where asked for."""
        return [(shock, shock.found.response) for shock in self.channels if shock.found.response is not None]

    @property
    def rollings(self) -> list[tuple[ShockSpectra, ChannelRolling]]:
        """Rolling spectrum of each channel, where asked for."""
        return [(shock, shock.found.rolling) for shock in self.channels if shock.found.rolling is not None]

    @property
    def channels(self) -> Sequence[ShockSpectra]:
        """All channels; one alone, too."""
        return self.shocks or (self.first,)

    @property
    def _asked(self) -> SpectrumAsked:
        one = self.spectra[0]
        return SpectrumAsked(one.q if math.isfinite(one.q) else "inf", self.side, one.part)

    def expanded(self, place: int) -> Array | None:
        """Return the expanded uncertainty of a spectrum of one channel; None where no budget gives one."""
        known = self.first.found.uncertainty or {}
        kind = self.spectra[place].kind
        return None if self.shocks or kind not in known else known[kind].expanded

    @functools.cached_property
    def together(self) -> dict[str, dict[str, Array]]:
        """Common spectra of several channels, by name and kind: ``resultant``, or ``envelope`` and ``p95_50``."""
        if self.resultant:
            return {"resultant": dict(self.resultant)}
        rows = {kind: [shock.found.values[kind] for shock in self.used] for kind in self.first.found.values}
        common = {"envelope": {kind: envelope(of) for kind, of in rows.items()}} if self.used else {}
        if len(self.used) >= FEWEST:
            common["p95_50"] = {kind: tolerance_limit(of) for kind, of in rows.items()}
        return common

    @functools.cached_property
    def velocity(self) -> Spectrum:
        """Spectrum of the pseudo-velocity for the four-coordinate picture, computed where it is drawn."""
        first = next((s for s in self.spectra if s.kind == "pseudo-velocity"), None)
        shown = self.spectra[0]
        return first or spectra_of_kinds(self.reading, ["pseudo-velocity"], shown.frequency, shown.q, self.scope)[0]

    def largest_of(self, kinds: Mapping[str, Array], of: str = "response") -> list[LargestResponse]:
        """Return where spectra, by kind, are largest."""
        rows = []
        for kind, values in kinds.items():
            place = int(np.nanargmax(values)) if np.any(np.isfinite(values)) else 0
            units = {AS_SPECTRUM.given_by: self.shown_in(kind)}
            rows.append(LargestResponse(kind, of, float(self.frequency[place]), units, float(values[place])))
        return rows

    def shown_in(self, kind: str) -> tuple[str, str]:
        """Return SI unit and shown unit of a kind; none where the record is no acceleration."""
        return (KINDS[kind].si, KINDS[kind].usual) if self.is_acceleration else ("", "")

    @property
    def given_units(self) -> GivenUnits:
        """Unit of the channel."""
        unit = self.reading.channel.unit or "the file's own numbers"
        return {AS_CHANNEL.given_by: (unit, unit)}

    @property
    def named_units(self) -> Mapping[str, str]:
        """Unit of each kind."""
        has = self.reading.channel.unit or "the file's own numbers"
        of = "" if self.is_acceleration else f"{NO_ACCELERATION}; this one is in {has}"
        return {kind: KINDS[kind].si + of for kind in self.first.found.values}

    def preview(self) -> Curve:
        """Return the first spectrum over the logarithm of natural frequency."""
        kind, values = next(iter(self.first.found.values.items()))
        size, unit = axis_unit(*self.shown_in(kind))
        words = f"{kind} ({unit})" if unit not in ("", "1") else kind
        return Curve(np.log10(self.frequency), values / size, "log10 of frequency in Hz", words)

    def tables(self) -> dict[str, str]:
        """Return the spectra as CSV text."""
        tables = {"spectrum.csv": csv_table(self.columns())}
        if self.responses:
            tables["response.csv"] = csv_table(self._response_columns(), HISTORY_DIGITS)
        if self.rollings:
            tables["rolling.csv"] = csv_table(self._rolling_columns(), HISTORY_DIGITS)
        return tables

    def _response_columns(self) -> list[Column]:
        """Return responses over time, those of several channels under one another."""
        responses = self.responses
        columns = self._places([(shock, one.time.size) for shock, one in responses])
        columns.append(Column("time", np.concatenate([one.time for _, one in responses]), "s"))
        histories = [one.histories for _, one in responses]
        return columns + [self._column(kind, np.concatenate([one[kind] for one in histories])) for kind in histories[0]]

    def _rolling_columns(self) -> list[Column]:
        """Return rolling spectra over time and frequency, those of several channels under one another."""
        rollings = self.rollings
        time = [np.repeat(one.time, one.frequency.size) for _, one in rollings]
        return [
            *self._places([(shock, one.time.size * one.frequency.size) for shock, one in rollings]),
            Column("time", np.concatenate(time), "s"),
            Column("frequency", np.concatenate([np.tile(one.frequency, one.time.size) for _, one in rollings]), "Hz"),
            self._column(rollings[0][1].kind, np.concatenate([np.ravel(one.values) for _, one in rollings])),
        ]

    def _places(self, counts: Sequence[tuple[ShockSpectra, int]]) -> list[Column]:
        """Return file and channel of so many lines each; nothing for one channel."""
        if not self.shocks:
            return []
        return [
            Column(name, [getattr(shock, name) for shock, count in counts for _ in range(count)])
            for name in ("file", "channel")
        ]

    def _column(self, kind: str, values: Array, of: str = "") -> Column:
        """Return a column of a kind, with its units; of records that are no acceleration with what these are for."""
        si, usual = KINDS[kind].si, KINDS[kind].usual
        name = f"{kind}{of}" + ("" if self.is_acceleration else NO_ACCELERATION)
        return Column(name, values, si, shown=usual if self.is_acceleration else si)

    @property
    def main_columns(self) -> list[Column]:
        """Columns of one channel, or of the common spectra of several."""
        columns = [Column.of("frequency", self.frequency, FREQUENCY)]
        if not self.shocks:
            return columns + self.channel_columns(self.first.found)
        together = self.together.items()
        return columns + [self._column(kind, each, f" {name}") for name, by in together for kind, each in by.items()]

    def channel_columns(self, found: ChannelSpectra, whose: str = "") -> list[Column]:
        """Return spectra, their expanded uncertainties and root mean squares of a channel as columns."""
        doubts = [(kind, one.expanded) for kind, one in (found.uncertainty or {}).items()]
        return [
            *(self._column(kind, values, whose) for kind, values in found.values.items()),
            *(self._column(kind, values, f" expanded uncertainty{whose}") for kind, values in doubts),
            *(self._column(kind, values, f" rms{whose}") for kind, values in (found.rms or {}).items()),
        ]

    def shown_every(self, step: int, columns: Sequence[Column]) -> tuple[list[str], list[list[str]]]:
        """Return heads and cells of columns at every so many of the frequencies, as screen and page show them."""
        shown = []
        for column in columns:
            name = column.name.replace("p95_50", "P95/50").replace("expanded uncertainty", "± U")
            no_unit: dict[str, Any] = {} if self.is_acceleration or column.si == "Hz" else {"si": "", "shown": ""}
            own = name.replace(NO_ACCELERATION, " (file's own)")
            shown.append(column._replace(name=own, values=column.values[::step], **no_unit))
        return heads_and_cells(shown)


def rms_of(reading: ChannelReading, kind: str, frequencies: ArrayLike, q: float, initial: str) -> Array:
    """Return the root mean squares of the responses to a channel, its baseline taken off."""
    channel = reading.channel
    return rms_spectrum(channel.values - reading.baseline, channel.step, frequencies, q, kind, initial)


def response_of(
    reading: ChannelReading, kinds: Sequence[str], frequency: float, q: float, initial: str
) -> OscillatorResponse:
    """Return what an oscillator does on a channel, its baseline taken off."""
    channel = reading.channel
    values = channel.values - reading.baseline
    histories = {kind: response_history(values, channel.step, frequency, q, kind, initial) for kind in kinds}
    return OscillatorResponse(frequency, channel.time, histories)


def spectra_of_kinds(
    reading: ChannelReading, kinds: Sequence[str], frequencies: ArrayLike, q: float, scope: Scope
) -> list[Spectrum]:
    """Return the spectra of a channel, its baseline taken off: one a kind."""
    channel = reading.channel
    return all_srs(channel.values - reading.baseline, channel.step, frequencies, [(kind, q) for kind in kinds], scope)


def uncertainties_of(
    reading: ChannelReading, spectra: Sequence[Spectrum], side: str, scope: Scope, budget: Budget
) -> list[SpectrumUncertainty]:
    """Return the uncertainties of spectra of a channel, over the same frequencies, by a budget."""
    frequency, asked = np.asarray(spectra[0].frequency), [(one.kind, one.q) for one in spectra]

    def rows(values: Array) -> Array:
        """Return the spectra of a record, a row each."""
        return np.stack([one.side(side) for one in all_srs(values, reading.channel.step, frequency, asked, scope)])

    known = spectrum_uncertainty(reading.channel, reading.baseline, reading.pulses, budget, frequency, rows)
    return [known.of_row(k) for k in range(len(spectra))]
