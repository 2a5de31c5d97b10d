"""Shock response spectra of measured files in plain values, for Python."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

from strikewave.analyses.record.chosen import name_of
from strikewave.analyses.record.file_spectra import FilesAsked, judged_spectra_of
from strikewave.analyses.record.filter_options import filtered
from strikewave.analyses.record.rolling_window import ALLOWED_Q, Rolling, read_rolling
from strikewave.analyses.record.spectrum import KINDS, SpectrumOptions, SpectrumRequest, SpectrumResult
from strikewave.analyses.record.verdicts.options import SpecificationOptions
from strikewave.base.errors import InputError
from strikewave.base.units import si_value
from strikewave.records import Request
from strikewave.reporting import measured_files as measured
from strikewave.reporting.options import Typed, wrong_choice
from strikewave.signal.filters import Filter
from strikewave.signal.srs import INITIAL, PARTS, SIDES
from strikewave.specifications.judging import Rule

LOWEST = 10.0
"""Lowest natural frequency where none is stated, Hz."""


def shock_spectra(
    paths: str | Path | Sequence[str | Path],
    *,
    channels: Sequence[str | int] = (),
    unit: measured.Stated | None = None,
    sensitivity: measured.Stated | None = None,
    gain: measured.Stated | None = None,
    excitation: measured.Stated | None = None,
    rated_excitation: measured.Stated | None = None,
    count: measured.Stated | None = None,
    polarity: measured.Stated | None = None,
    rate: str | float | None = None,
    time: str | int | None = None,
    time_unit: str | None = None,
    measurement: int | None = None,
    filter: str | float | Filter | None = None,
    ac_coupling: str | float | None = None,
    high_pass: str | float | None = None,
    q: float = 10.0,
    frequencies: Sequence[str | float] = (),
    low: str | float = LOWEST,
    high: str | float | None = None,
    per_octave: float = 12.0,
    kinds: Sequence[str] = ("absolute",),
    side: str = "maximax",
    part: str = "total",
    end: str | float | None = None,
    resultant: bool = False,
    rolling: str | float | tuple[float, float] | None = None,
    initial: str = "rest",
    rms: bool = False,
    response: str | float | None = None,
    spec: str | None = None,
    decision: Rule = "simple",
    uncertainty: str | float | Path | None = None,
    strict: bool = False,
    test: str | Path | None = None,
) -> SpectrumResult:
    """Compute the shock response spectra of measured files, their baselines taken off.

    It is what ``strikewave srs`` does; `strikewave.srs` takes arrays. Of several files, or channels, the envelope is
    given and, from three on, the limit P95/50.

    Parameters
    ----------
    paths, channels, unit, sensitivity, gain, excitation, rated_excitation, count, polarity, rate, time
        As for `strikewave.record`; the first channel of each file by default.
    time_unit, measurement
        As for `strikewave.record`.
    filter, ac_coupling, high_pass, test
        As for `strikewave.record`.
    q : float, optional
        Quality factor 1 / (2 damping ratio), or `math.inf`.
    frequencies : sequence of str or float, optional
        Natural frequencies, with a unit or in Hz, instead of a range.
    low, high : str or float, optional
        Lowest and highest natural frequency; the highest is 100 kHz, or 2/5 of the lowest sampling rate, by default.
    per_octave : float, optional
        Number of natural frequencies in an octave.
    kinds : sequence of str, optional
        ``absolute``, ``displacement``, ``relative-velocity``, ``pseudo-velocity``, ``equivalent-static``.
    side : str, optional
        ``maximax``, ``positive`` or ``negative``.
    part : str, optional
        ``total``, ``primary`` (while the shock lasts) or ``residual`` (after it).
    end : str or float, optional
        End of the shock in the time of the files, with a unit or in s; the end of the last blow by default.
    resultant : bool, optional
        Whether the vector sum of 2 or 3 perpendicular channels of a file is given.
    rolling : str, float or (float, float), optional
        Window, or window and hop, of spectra that slide over the records: ``"20 ms,5 ms"``, or in s.
    initial : str, optional
        How the records begin: ``rest``, ``shifted`` or ``steady``.
    rms : bool, optional
        Whether root mean squares of the responses are given.
    response : str or float, optional
        Natural frequency of an oscillator whose response is given, with a unit or in Hz.
    spec, decision, uncertainty, strict
        As for `strikewave.record`; a specification states frequencies, quality factor and side.

    Returns
    -------
    SpectrumResult
        A spectrum for each channel and kind, with verdicts where a specification is given.

    Raises
    ------
    InputError, StrikewaveError
        If not one file can be read, or a value is none that it can be.

    Examples
    --------
    >>> import tempfile
    >>> import numpy as np
    >>> import strikewave
    >>> time = np.arange(4000) * 1e-5
    >>> pulse = 500.0 * np.sin(np.pi * (time - 0.01) / 1e-3) * ((time > 0.01) & (time < 0.011))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = Path(folder) / "shot.csv"
    ...     np.savetxt(file, np.column_stack([time, pulse]), delimiter=",", header="time (s),frame (g)", comments="")
    ...     found = strikewave.shock_spectra(file, q=math.inf, frequencies=["810 Hz", "8 kHz"])
    >>> found.highlights()
    [('largest absolute response, at 810 Hz', '884.2 g'), ('quality factor', 'undamped')]
    """
    calibration = {
        "unit": unit,
        "sensitivity": sensitivity,
        "gain": gain,
        "excitation": excitation,
        "rated_excitation": rated_excitation,
        "count": count,
        "polarity": polarity,
    }
    with measured.named_for_python():
        files = measured.files_of(paths)
        stated = measured.MeasurementOptions.in_python(channels, calibration, rate, time, time_unit, measurement)
        for field, word, choices in (
            *(("kinds", kind, tuple(KINDS)) for kind in kinds),
            *(("side", side, SIDES), ("part", part, PARTS), ("initial", initial, INITIAL)),
        ):
            if word not in choices:
                raise wrong_choice(word, field, choices)
        for field, number, allowed in (
            ("q", q, ALLOWED_Q),
            ("per_octave", per_octave, "a number of frequencies above zero, at most 100 000"),
        ):
            if not number > 0.0:
                raise InputError(field, number, allowed)
        named = [_typed(one, "Hz", "frequencies") for one in frequencies]
        lowest = low if low == LOWEST else _typed(low, "Hz", "low")  # the default is nothing that was asked for
        ends = (lowest, None if high is None else _typed(high, "Hz", "high"), per_octave)
        options = SpectrumOptions(
            initial,
            rms,
            resultant,
            None if response is None else _typed(response, "Hz", "response"),
            None if rolling is None else _rolling_of(rolling),
        )
        judging = SpecificationOptions.in_python(spec, decision, uncertainty, strict)
        options = options._replace(budget=judging.uncertainty)
        last = None if end is None else _typed(end, "s", "end")
        wanted = SpectrumRequest(q, named, ends, tuple(dict.fromkeys(kinds)), side, part, last, options)
        asked = FilesAsked(
            files, stated.calibration(), stated.reading(), filtered(Request(), filter, ac_coupling, high_pass)
        )
        origin = measured.source_in_python(name_of([Path(file) for file in files]), test)
        return judged_spectra_of(asked, wanted, origin, judging.spectra_judge())


def _typed(value: str | float, si: str, field: str) -> Typed:
    """Return a quantity that knows how it was written; only a time may be zero or below."""
    found = si_value(value, si, field)
    if not math.isfinite(found) or (si == "Hz" and not found > 0.0):
        raise InputError(field, value, "a frequency above zero" if si == "Hz" else "a time")
    return Typed(found, str(value))


def _rolling_of(value: str | float | tuple[float, float]) -> Rolling:
    """Return window and hop."""
    if isinstance(value, str):
        return read_rolling(value, "rolling")
    times = value if isinstance(value, tuple | list) else (value,)
    return read_rolling(",".join(f"{time} s" for time in times), "rolling")
