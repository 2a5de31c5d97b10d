"""What the spectra of a record are: their frequencies, tables, documents."""

from __future__ import annotations

import functools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strikewave.analyses.record.rolling_window import Rolling
from strikewave.base import declare
from strikewave.records import ChannelReading
from strikewave.records.budget.spectra import SpectrumUncertainty, spectrum_uncertainty
from strikewave.records.health_notice import HealthNotice, worst
from strikewave.reporting import measured_files as measured
from strikewave.reporting.columns import HISTORY_DIGITS, Column, csv_table
from strikewave.reporting.numbers import axis_unit, with_unit
from strikewave.reporting.options.kinds import Typed
from strikewave.reporting.shown_result import Curve
from strikewave.signal.envelopes import FEWEST, envelope, tolerance_limit
from strikewave.signal.srs import RollingSpectrum, Scope, Spectrum, all_srs, response_history, rms_spectrum

if TYPE_CHECKING:
    from strikewave.records.budget.contributions import Budget
    from strikewave.specifications.judged_spectra import SpectraVerdict

Array = NDArray[np.float64]

KIND_UNITS = {
    "absolute": "m/s^2",
    "displacement": "m",
    "relative-velocity": "m/s",
    "pseudo-velocity": "m/s",
    "equivalent-static": "m/s^2",
}
"""Kinds of spectrum, with their SI unit for an acceleration."""
SHOWN_UNITS = {kind: {"m/s^2": "g", "m": "mm"}.get(unit, unit) for kind, unit in KIND_UNITS.items()}
"""The units in which they are shown on the screen."""
LEFT_OUT = ("gain-differs",)
"""Findings with which a record enters no envelope, as with one that is bad: its spectrum is wrong as a whole."""


class SpectrumOptions(NamedTuple):
    """What else was asked: how the record begins, and what is given beside the spectra."""

    initial: str
    rms: bool
    resultant: bool
    response: Typed | None
    rolling: Rolling | None
    budget: Budget | None = None


class SpectrumRequest(NamedTuple):
    """What was asked of the spectra: quality factor, frequencies, kinds, side, part of the shock and its end.

    ``own_range``: whether each of several is computed up to what its own sampling carries too, to be judged by itself.
    """

    q: float
    frequencies: list[Typed] | None
    grid: tuple[float, Typed | None, float]
    kinds: tuple[str, ...]
    side: str
    part: str
    end: Typed | None
    options: SpectrumOptions
    own_range: bool = False


class OscillatorResponse(NamedTuple):
    """What one oscillator does while the record lasts, by kind of response."""

    frequency: float
    time: Array
    histories: Mapping[str, Array]


class ShockSpectra(NamedTuple):
    """The spectra of one channel of a file among several.

    Attributes
    ----------
    file, channel, status : str
        Of what, and whether it is good.
    zero_line : float
        Baseline that was taken off.
    spectra : list of Spectrum
        One a kind.
    rms : mapping
        Root mean squares by kind, where asked for.
    left_out : str
        Why it does not enter the envelope; empty where it does.
    response : OscillatorResponse or None
        Of one oscillator, where asked for.
    rolling : RollingSpectrum or None
        Of windows that slide over the record, of the first kind, where asked for.
    judged : Spectrum or None
        The first kind, up to what the sampling of this record carries, where it is judged.
    harmed : str
        Why the spectrum is not to be judged; empty where it may be.
    uncertainties : sequence of SpectrumUncertainty
        Of each kind, where a budget was stated, or a verdict asked for.
    """

    file: str
    channel: str
    status: str
    zero_line: float
    spectra: list[Spectrum]
    rms: Mapping[str, Array]
    left_out: str = ""
    response: OscillatorResponse | None = None
    rolling: RollingSpectrum | None = None
    judged: Spectrum | None = None
    harmed: str = ""
    uncertainties: Sequence[SpectrumUncertainty] = ()

    @property
    def name(self) -> str:
        """File and channel."""
        return f"{Path(self.file).name}, {self.channel}"


def spectrum_findings(reading: ChannelReading) -> list[HealthNotice]:
    """Return what was found on a record, without that it swings rather than being struck: so does a pyroshock."""
    return [one for one in reading.findings if one.code != "no-pulse" or "spectrum" in one.harms]


def status_of(reading: ChannelReading) -> str:
    """Return how good a record is for a spectrum."""
    return worst(spectrum_findings(reading))


def harm_of(reading: ChannelReading) -> str:
    """Return why a spectrum is not to be judged; that no one-sided blow stands out is how a pyroshock is."""
    for one in spectrum_findings(reading):
        if one.severity == "bad" or one.code in LEFT_OUT or "spectrum" in one.harms:
            return one.message
    return ""


@dataclass(frozen=True)
class SpectrumResult(measured.AskedResult):
    """Spectra of one channel of a file, or of several; see `Result` for what it shares with others.

    Attributes
    ----------
    file : str
        The measured file; the first of several.
    reading : ChannelReading
        The channel, examined.
    spectra : list of Spectrum
        One a kind.
    side : str
        maximax, positive or negative.
    scope : Scope
        Which part of the shock.
    rms : mapping
        Root mean squares of the responses by kind, where asked for.
    shocks : sequence of ShockSpectra
        All of several; empty for one.
    resultant : mapping
        Vector sums of all axes by kind, where asked for.
    response : OscillatorResponse or None
        Of one oscillator, where asked for of one channel; those of several stand in ``shocks``.
    rolling : RollingSpectrum or None
        Of windows that slide over the record, of the first kind, where asked for of one channel.
    bounded_by : str
        Which sampling rate bounds the frequencies that several channels have in common, where they differ in it.
    verdict : SpectraVerdict or None
        By a specification, where one was asked for.
    uncertainties : sequence of SpectrumUncertainty
        Of each kind of one channel, where a budget was stated, or a verdict asked for.
    budget : Budget or None
        By which they were found; without contributions where none was stated.
    """

    command: ClassVar[str] = "srs"

    file: str
    reading: ChannelReading
    spectra: list[Spectrum]
    side: str
    scope: Scope
    rms: Mapping[str, Array] = field(default_factory=dict)
    shocks: Sequence[ShockSpectra] = ()
    resultant: Mapping[str, Array] = field(default_factory=dict)
    response: OscillatorResponse | None = None
    rolling: RollingSpectrum | None = None
    bounded_by: str = ""
    verdict: SpectraVerdict | None = None
    uncertainties: Sequence[SpectrumUncertainty] = ()
    budget: Budget | None = None

    @property
    def title(self) -> str:
        """File, channel, and the part of the shock where that is not the whole."""
        part = "" if self.scope.part == "total" else f", {self.scope.part} part"
        if self.shocks:
            return f"{self.counted} of {self.origin.name}{part}"
        return f"{Path(self.file).name}, {self.reading.channel.name}{part}"

    @property
    def counted(self) -> str:
        """How many spectra there are."""
        return f"{len(self.shocks)} shock response {'spectra' if len(self.shocks) > 1 else 'spectrum'}"

    @property
    def used(self) -> list[ShockSpectra]:
        """Those of several that enter the envelope."""
        return [shock for shock in self.shocks if not shock.left_out]

    @property
    def responses(self) -> list[tuple[ShockSpectra, OscillatorResponse]]:
        """What one oscillator does on each channel, where asked for."""
        return [(shock, shock.response) for shock in self._all if shock.response is not None]

    @property
    def rollings(self) -> list[tuple[ShockSpectra, RollingSpectrum]]:
        """The rolling spectrum of each channel, where asked for."""
        return [(shock, shock.rolling) for shock in self._all if shock.rolling is not None]

    @property
    def _all(self) -> Sequence[ShockSpectra]:
        """All channels; one alone, too."""
        reading = self.reading
        of = (self.file, reading.channel.name, status_of(reading), reading.baseline, self.spectra, self.rms, "")
        return self.shocks or (ShockSpectra(*of, self.response, self.rolling, uncertainties=self.uncertainties),)

    def expanded(self, place: int) -> Array | None:
        """Return the expanded uncertainty of a spectrum of one channel; None where no budget gives one."""
        if self.shocks or place >= len(self.uncertainties):
            return None
        return self.uncertainties[place].lowest(len(self.spectra[place].frequency)).expanded

    @functools.cached_property
    def together(self) -> dict[str, dict[str, Array]]:
        """What several spectra come to, by name and kind: ``resultant``, or ``envelope`` and ``p95_50``."""
        if self.resultant:
            return {"resultant": dict(self.resultant)}
        rows = {
            one.kind: [shock.spectra[k].side(self.side) for shock in self.used] for k, one in enumerate(self.spectra)
        }
        found = {"envelope": {kind: envelope(of) for kind, of in rows.items() if of}} if self.used else {}
        if len(self.used) >= FEWEST:
            found["p95_50"] = {kind: tolerance_limit(of) for kind, of in rows.items()}
        return found

    @functools.cached_property
    def velocity(self) -> Spectrum:
        """The spectrum of the pseudo-velocity, which the four-coordinate picture shows; computed where it is drawn."""
        first = next((s for s in self.spectra if s.kind == "pseudo-velocity"), None)
        shown = self.spectra[0]
        return first or spectra_of_kinds(self.reading, ["pseudo-velocity"], shown.frequency, shown.q, self.scope)[0]

    def units(self) -> dict[str, str]:
        """Return the unit of each key of the JSON document."""
        has = self.reading.channel.unit or "the file's own numbers"
        of = "" if has == "m/s^2" else f" for a record in m/s^2; this one is in {has}"
        kinds = {spectrum.kind: KIND_UNITS[spectrum.kind] + of for spectrum in self.spectra}
        more = {"time": "s", "window": "s", "hop": "s"} if self.responses or self.rollings else {}
        kinds |= {} if self.budget is None else {"standard": "as the spectrum", "expanded": "as the spectrum"}
        return {"frequency": "Hz", "q": "1", "zero_line": has, **more, **kinds}

    def content(self) -> dict[str, Any]:
        """Return what the JSON document holds beside its head."""
        first, reading = self.spectra[0], self.reading
        judged: dict[str, Any] = {} if self.verdict is None else {"spec": declare.content(self.verdict)}
        judged |= {} if self.budget is None else {"budget": self.budget.document()}
        if self.shocks:
            return {**self._several(), **judged}
        return {
            "file": self.file,
            "channel": reading.channel.name,
            "status": status_of(reading),
            "calibration": reading.calibration.stated(),
            "zero_line": reading.baseline,
            "q": first.q if math.isfinite(first.q) else "inf",
            "side": self.side,
            "part": first.part,
            "end": None if self.scope.end is None else self.scope.end + reading.channel.start,
            "frequency": first.frequency,
            "initial": self.scope.initial,
            **{spectrum.kind: spectrum.side(self.side) for spectrum in self.spectra},
            **({"rms": dict(self.rms)} if self.rms else {}),
            **self._over_time(self.response, self.rolling),
            **self._uncertain(self.uncertainties),
            **judged,
        }

    def _several(self) -> dict[str, Any]:
        """Return what the document of several spectra holds."""
        first = self.spectra[0]
        return {
            "q": first.q if math.isfinite(first.q) else "inf",
            "side": self.side,
            "part": first.part,
            "initial": self.scope.initial,
            "frequency": first.frequency,
            "spectra": [
                {
                    "file": shock.file,
                    "channel": shock.channel,
                    "status": shock.status,
                    "left_out": shock.left_out or None,
                    "zero_line": shock.zero_line,
                    **{one.kind: one.side(self.side) for one in shock.spectra},
                    **({"rms": dict(shock.rms)} if shock.rms else {}),
                    **self._over_time(shock.response, shock.rolling),
                    **self._uncertain(shock.uncertainties),
                }
                for shock in self.shocks
            ],
            **self.together,
        }

    def _over_time(self, response: OscillatorResponse | None, rolling: RollingSpectrum | None) -> dict[str, Any]:
        """Return what the document holds of a response history and a rolling spectrum."""
        found: dict[str, Any] = {}
        if response is not None:
            found["response"] = {"frequency": response.frequency, "time": response.time, **response.histories}
        if rolling is not None:
            values = getattr(rolling, self.side)
            found["rolling"] = {"kind": self.spectra[0].kind, "time": rolling.time, "values": values}
        return found

    def _uncertain(self, known: Sequence[SpectrumUncertainty]) -> dict[str, Any]:
        """Return what the document holds of the uncertainty of the spectra of a channel."""
        pairs = zip(self.spectra, known, strict=False)
        found = {one.kind: declare.content(each.lowest(len(one.frequency))) for one, each in pairs}
        return {"uncertainty": found} if found else {}

    def highlights(self) -> list[tuple[str, str]]:
        """Return the quality factor, and the largest value of each spectrum with its frequency."""
        first = self.spectra[0]
        numbers = [("Q", "undamped" if math.isinf(first.q) else f"{first.q:g}")]
        of, whole = next(iter(self.together.items()), ("", {})) if self.shocks else ("", {})
        for spectrum in self.spectra:
            values = whole.get(spectrum.kind, spectrum.side(self.side))
            at = int(np.argmax(values))
            where = with_unit(float(spectrum.frequency[at]), "Hz", "Hz", 3)
            numbers.append(
                (f"{spectrum.kind} {of}".strip(), f"{with_unit(float(values[at]), *self._shown(spectrum))} at {where}")
            )
        return numbers

    def preview(self) -> Curve:
        """Return the first spectrum over the logarithm of natural frequency."""
        first = self.spectra[0]
        size, unit = axis_unit(*self._shown(first))
        words = f"{first.kind} ({unit})" if unit not in ("", "1") else first.kind
        return Curve(np.log10(first.frequency), first.side(self.side) / size, "log10 of frequency in Hz", words)

    def _shown(self, spectrum: Spectrum) -> tuple[str, str]:
        """Return SI unit and shown unit of a spectrum; none where the record is no acceleration."""
        if self.reading.channel.unit != "m/s^2":
            return "", ""
        return KIND_UNITS[spectrum.kind], SHOWN_UNITS[spectrum.kind]

    def tables(self) -> dict[str, str]:
        """Return the spectra as CSV text."""
        tables = {"spectrum.csv": csv_table(self.columns())}
        if self.responses:
            tables["response.csv"] = csv_table(self._response_columns(), HISTORY_DIGITS)
        if self.rollings:
            tables["rolling.csv"] = csv_table(self._rolling_columns(), HISTORY_DIGITS)
        return tables

    @property
    def _of(self) -> str:
        """What follows the name of a kind where the record is no acceleration."""
        return "" if self.reading.channel.unit == "m/s^2" else " for a record in m/s^2"

    def _response_columns(self) -> list[Column]:
        """Return responses over time, those of several channels under one another."""
        found = self.responses
        columns = self._places([(shock, one.time.size) for shock, one in found])
        columns.append(Column("time", np.concatenate([one.time for _, one in found]), "s"))
        for kind in found[0][1].histories:
            values = np.concatenate([one.histories[kind] for _, one in found])
            columns.append(Column(f"{kind}{self._of}", values, KIND_UNITS[kind]))
        return columns

    def _rolling_columns(self) -> list[Column]:
        """Return rolling spectra over time and frequency, those of several channels under one another."""
        found, kind = self.rollings, self.spectra[0].kind
        time = [np.repeat(one.time, one.frequency.size) for _, one in found]
        values = [np.ravel(getattr(one, self.side)) for _, one in found]
        return [
            *self._places([(shock, one.time.size * one.frequency.size) for shock, one in found]),
            Column("time", np.concatenate(time), "s"),
            Column("frequency", np.concatenate([np.tile(one.frequency, one.time.size) for _, one in found]), "Hz"),
            Column(f"{kind}{self._of}", np.concatenate(values), KIND_UNITS[kind]),
        ]

    def _places(self, counts: Sequence[tuple[ShockSpectra, int]]) -> list[Column]:
        """Return file and channel of so many lines each; nothing for one channel."""
        if not self.shocks:
            return []
        return [
            Column(name, [getattr(shock, name) for shock, count in counts for _ in range(count)])
            for name in ("file", "channel")
        ]

    def columns(self) -> list[Column]:
        """Return the spectra over natural frequency."""
        of = self._of
        columns = [Column("frequency", self.spectra[0].frequency, "Hz")]
        for s in () if self.shocks else self.spectra:
            columns.append(Column(f"{s.kind}{of}", s.side(self.side), KIND_UNITS[s.kind]))
        for k, s in enumerate(self.spectra):
            if (expanded := self.expanded(k)) is not None:
                columns.append(Column(f"{s.kind} expanded uncertainty{of}", expanded, KIND_UNITS[s.kind]))
        for kind, values in self.rms.items() if not self.shocks else ():
            columns.append(Column(f"{kind} rms{of}", values, KIND_UNITS[kind]))
        for name, kinds in self.together.items() if self.shocks else ():
            for kind, values in kinds.items():
                columns.append(Column(f"{kind} {name}{of}", values, KIND_UNITS[kind]))
        for shock in self.shocks:
            for s in shock.spectra:
                columns.append(Column(f"{s.kind} of {shock.name}{of}", s.side(self.side), KIND_UNITS[s.kind]))
            for s, known in zip(shock.spectra, shock.uncertainties, strict=False):
                name = f"{s.kind} expanded uncertainty of {shock.name}{of}"
                columns.append(Column(name, known.lowest(len(s.frequency)).expanded, KIND_UNITS[s.kind]))
            for kind, values in shock.rms.items():
                columns.append(Column(f"{kind} rms of {shock.name}{of}", values, KIND_UNITS[kind]))
        return columns

    def brief(self) -> dict[str, str]:
        """Return all columns."""
        return {"frequency": "Hz"} | {column.name: self._unit(column.name) for column in self.columns()[1:]}

    def _unit(self, name: str) -> str:
        kind = name.partition(" ")[0]
        return SHOWN_UNITS[kind] if self.reading.channel.unit == "m/s^2" else KIND_UNITS[kind]


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

    found = spectrum_uncertainty(reading.channel, reading.baseline, reading.pulses, budget, frequency, rows)
    return [found.of_row(k) for k in range(len(spectra))]
