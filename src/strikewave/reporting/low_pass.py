"""The low-pass that commands on histories take, as options."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, ClassVar

from strikewave.base.errors import InputError
from strikewave.base.units import si_value, typed_number
from strikewave.reporting.options.kinds import Typed, bare_number, quantity

if TYPE_CHECKING:
    from strikewave.signal.filters import Filter


ALLOWED_FILTER = 'a cutoff above zero such as "10 kHz", a class such as "CFC 1000", or a filter'


@dataclass(frozen=True)
class LowPassOptions:
    """A zero-phase low-pass, by its cutoff or by its channel frequency class."""

    panel: ClassVar[str] = "Filters"

    cutoff: Annotated[
        float | None,
        quantity("--filter", si="Hz", help="Zero-phase low-pass, -3 dB for both passes; none by default."),
    ] = None
    cfc: Annotated[
        Typed | None,
        bare_number(
            "--cfc",
            high=1e6,
            allowed="a channel frequency class, such as 60, 180, 600 or 1000",
            help="SAE J211 filter of this channel frequency class, such as 1000; none by default.",
        ),
    ] = None

    def low_pass(self) -> Filter | None:
        """Return the low-pass; None where none is asked for.

        Raises
        ------
        InputError
            If two are.
        """
        from strikewave.signal.filters import Filter

        if self.cutoff is not None and self.cfc is not None:
            raise InputError("--cfc", self.cfc.word, "either --filter or --cfc", "leave one out")
        if self.cutoff is not None:
            return Filter(self.cutoff)
        return None if self.cfc is None else Filter.sae_j211(self.cfc)


def cutoff_of(value: str | float, field: str, allowed: str) -> float:
    """Return a cutoff that a call names, Hz.

    Raises
    ------
    InputError
        If it is none.

    Examples
    --------
    >>> cutoff_of("5 kHz", "high_pass", "a cutoff"), cutoff_of(5.0, "high_pass", "a cutoff")
    (5000.0, 5.0)
    """
    try:
        cutoff = si_value(value, "Hz", field)
    except (InputError, TypeError, ValueError) as error:
        raise InputError(field, value, allowed) from error
    if not 0.0 < cutoff < math.inf:
        raise InputError(field, value, allowed)
    return cutoff


def low_pass_of(value: str | float | Filter | None) -> Filter | None:
    """Return the low-pass that a call names by its cutoff or its class.

    Raises
    ------
    InputError
        If it names none.

    Examples
    --------
    >>> str(low_pass_of("CFC 1000")), low_pass_of("10 kHz").cutoff, low_pass_of(None)
    ('CFC 1000 (SAE J211)', 10000.0, None)
    """
    from strikewave.signal.filters import Filter

    if value is None or isinstance(value, Filter):
        return value
    if isinstance(value, str) and value.strip()[:3].upper() == "CFC":
        number = typed_number(value.strip()[3:])
        if number is None or not number > 0.0:
            raise InputError("filter", value, ALLOWED_FILTER)
        return Filter.sae_j211(number)
    return Filter(cutoff_of(value, "filter", ALLOWED_FILTER))
