"""The filters of the commands on records: options, and what they are on a request."""

from __future__ import annotations

import dataclasses
import hashlib
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

from strikewave.base.errors import InputError
from strikewave.base.units import parse_quantity, take_apart
from strikewave.reporting.options import LowPassOptions, cutoff_of, low_pass_of, parsed, quantity

if TYPE_CHECKING:
    from strikewave.records import Request
    from strikewave.signal.filters import Filter

ALLOWED_HIGH_PASS = 'a cutoff above zero such as "5 Hz"'
ALLOWED_COUPLING = 'auto, a time constant above zero such as "1.6 ms", or a cutoff such as "100 Hz"'


def _time_constant(word: str, field: str) -> str | float:
    """Return the time constant of AC coupling, s, or ``auto``.

    Examples
    --------
    >>> _time_constant("auto", ""), _time_constant("1.6 ms", ""), round(_time_constant("100 Hz", ""), 6)
    ('auto', 0.0016, 0.001592)
    """
    if word.strip() == "auto":
        return "auto"
    typed = take_apart(word)
    unit = "" if typed is None else typed.unit
    try:
        value = parse_quantity(word, "Hz" if "Hz" in unit else "s", field)
    except InputError as error:
        raise InputError(field, word, ALLOWED_COUPLING) from error
    if not 0.0 < value < math.inf:
        raise InputError(field, word, ALLOWED_COUPLING)
    return 1.0 / (2.0 * math.pi * value) if "Hz" in unit else value


@dataclass(frozen=True)
class FilterOptions(LowPassOptions):
    """What is taken off a record, or smoothed, before it is measured."""

    ac_coupling: Annotated[
        str | None,
        parsed(
            "--ac-coupling",
            read=_time_constant,
            help='AC coupling to take off: auto, a time constant such as "1.6 ms", or a cutoff such as "100 Hz"; '
            "none by default.",
            metavar="auto|TIME|FREQUENCY",
        ),
    ] = None
    high_pass: Annotated[
        float | None,
        quantity("--high-pass", si="Hz", help="Zero-phase high-pass, -3 dB for both passes; none by default."),
    ] = None

    def on(self, request: Request) -> Request:
        """Return a request with these filters.

        Raises
        ------
        InputError
            If two of them exclude one another.
        """
        from strikewave.signal.filters import HighPass

        high_pass = None if self.high_pass is None else HighPass(self.high_pass)
        coupling = "" if self.ac_coupling is None else self.ac_coupling
        return dataclasses.replace(request, filter=self.low_pass(), ac_coupling=coupling, high_pass=high_pass)


def filtered_folder(usual: str, request: Request) -> str:
    """Return the usual folder of a result: what is filtered gets one of its own beside what is not.

    Examples
    --------
    >>> from strikewave.records import Request
    >>> from strikewave.signal.filters import HighPass
    >>> filtered_folder("srs-a", Request()), filtered_folder("srs-a", Request(high_pass=HighPass(5.0)))
    ('srs-a', 'srs-a-82cd0941')
    """
    filters = (request.filter, request.ac_coupling, request.high_pass)
    return usual + (f"-{hashlib.sha256(repr(filters).encode()).hexdigest()[:8]}" if any(filters) else "")


def filtered(
    request: Request,
    filter: str | float | Filter | None,
    ac_coupling: str | float | None,
    high_pass: str | float | None,
) -> Request:
    """Return a request with the filters that a call names; a bare number is in Hz, of a time constant in s.

    Raises
    ------
    InputError
        If a value is none that it can be.

    Examples
    --------
    >>> from strikewave.records import Request
    >>> wanted = filtered(Request(), "CFC 1000", "100 Hz", 5.0)
    >>> str(wanted.filter), round(wanted.ac_coupling, 6), wanted.high_pass.cutoff
    ('CFC 1000 (SAE J211)', 0.001592, 5.0)
    """
    from strikewave.signal.filters import HighPass

    word = "" if ac_coupling is None else ac_coupling if isinstance(ac_coupling, str) else f"{ac_coupling} s"
    return dataclasses.replace(
        request,
        filter=low_pass_of(filter),
        ac_coupling="" if ac_coupling is None else _time_constant(word, "ac_coupling"),
        high_pass=None if high_pass is None else HighPass(cutoff_of(high_pass, "high_pass", ALLOWED_HIGH_PASS)),
    )
