"""What the calibration of a bar by its echoes gave: table, files."""

from __future__ import annotations

import functools
import math
from typing import ClassVar

from strikewave.analyses.hopkinson.outcome import Outcome
from strikewave.base import declare
from strikewave.base.declare import declarations
from strikewave.base.shock_quantities import KILOHERTZ, RATIO, VELOCITY
from strikewave.base.variables import LabelledArrays, quantity
from strikewave.hopkinson.bars import Bar
from strikewave.hopkinson.echoes import Echoes
from strikewave.reporting.columns import HISTORY_DIGITS, Column, csv_table
from strikewave.reporting.numbers import with_unit
from strikewave.reporting.shown_result import Curve, history_curve


@declare.dataclass
class EchoSolution(Outcome):
    """A bar calibrated by its echoes.

    Attributes
    ----------
    bar : Bar
        As stated.
    """

    data_file: ClassVar[str] = "echoes.nc"

    bar: Bar

    @declare.phrase("bar speed", headline="bar speed")
    def speed_words(self) -> str:
        """Return the bar speed with its standard error."""
        return self._fitted("speed")

    echoes: Echoes = declare.part(Echoes, "what was found", inline=True, headline="first")

    @declare.phrase("length", headline="length")
    def length_words(self) -> str:
        """Return the length with its standard error, where it was not given."""
        return self._fitted("length")

    @declare.phrase("attenuation", headline="attenuation")
    def attenuation_words(self) -> str:
        """Return the attenuation with its standard error."""
        return self._fitted("attenuation")

    def _fitted(self, name: str) -> str:
        """Write a value by least squares with its standard error."""
        fitted, (si, usual, _, _, digits, *_) = getattr(self.echoes, name), declarations(Echoes)[name].quantity
        error = "" if math.isnan(fitted.error) else f" ± {with_unit(fitted.error, si, usual, 2)}"
        return with_unit(fitted.value, si, usual, digits) + error

    def preview(self) -> Curve:
        """Return the strain at the gauge."""
        trace = self.echoes.quiet.trace
        return history_curve(trace.time, trace.strain, *RATIO.units, "strain at the gauge")

    def tables(self) -> dict[str, str]:
        """Return speed and attenuation over frequency as CSV text."""
        return {"echoes.csv": csv_table(self.columns(), HISTORY_DIGITS)}

    @declare.computed(declare.table("speed and attenuation over frequency"))
    def histories(self) -> list[Column]:
        """Speed and attenuation over frequency."""
        echoes = self.echoes
        return [
            Column.of("frequency", echoes.frequency, KILOHERTZ),
            Column.of("phase speed", echoes.phase_speed, VELOCITY),
            Column.of("standard error of phase speed", echoes.phase_speed_error, VELOCITY),
            Column(echoes.theory, echoes.theory_speed, "m/s"),
            Column("attenuation", echoes.losses, "1/m", shown="1/m"),
            Column("standard error of attenuation", echoes.losses_error, "1/m"),
        ]

    @functools.cached_property
    def arrays(self) -> LabelledArrays:
        """Speed and attenuation over frequency, and the trace, with units."""
        echoes, trace = self.echoes, self.echoes.quiet.trace
        variables = {
            "phase_speed": quantity("frequency", echoes.phase_speed, "m/s", "phase speed by the echoes"),
            "phase_speed_error": quantity("frequency", echoes.phase_speed_error, "m/s", "its standard error"),
            "theory_speed": quantity("frequency", echoes.theory_speed, "m/s", f"phase speed, {echoes.theory}"),
            "attenuation": quantity("frequency", echoes.losses, "1/m", "attenuation over a round trip"),
            "attenuation_error": quantity("frequency", echoes.losses_error, "1/m", "its standard error"),
            "strain": quantity("time", trace.strain, "1", "strain at the gauge, first pulse positive"),
        }
        coordinates = {
            "frequency": quantity("frequency", echoes.frequency, "Hz", "frequency"),
            "time": quantity("time", trace.time, "s", "time of the record"),
        }
        return LabelledArrays.of(variables, coordinates, self.attributes())
