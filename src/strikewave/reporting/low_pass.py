"""The low-pass that commands on histories take, as options."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, ClassVar

from strikewave.base.errors import InputError
from strikewave.reporting.options import Typed, bare_number, quantity

if TYPE_CHECKING:
    from strikewave.signal.filters import Filter


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
