"""Values of a case: a number in SI with the text it was typed as, its provenance and a note.

The provenance of a value is one of published, measured, inferred, assumed, fitted; a value typed
without one is assumed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Any, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict

from strikewave.errors import InputError, nearest
from strikewave.units import DIMENSIONS, parse_quantity

PROVENANCES = ("published", "measured", "inferred", "assumed", "fitted")
Provenance = Literal["published", "measured", "inferred", "assumed", "fitted"]


class Value(BaseModel):
    """A number in SI and where it comes from.

    Attributes
    ----------
    si : float
        The number in SI.
    typed : str or float
        What was typed, written back unchanged so that a saved case gives the same numbers.
    provenance : str
        published, measured, inferred, assumed or fitted.
    note : str
        Why, or from where.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    si: float
    typed: str | int | float
    provenance: Provenance = "assumed"
    note: str = ""

    def document(self) -> Any:
        """Return what stands in a case file: the plain value, or a table with provenance and note."""
        if self.provenance == "assumed" and not self.note:
            return self.typed
        table: dict[str, Any] = {"value": self.typed, "provenance": self.provenance}
        return {**table, "note": self.note} if self.note else table


@dataclass(frozen=True)
class Range:
    """What a value may be: its SI unit ("" for a number, "count" for a whole number) and its limits."""

    unit: str
    low: float = -math.inf
    high: float = math.inf
    open_low: bool = False

    def allowed(self) -> str:
        """Return the range in words, for an error line."""
        if self.unit in DIMENSIONS:
            name, example = DIMENSIONS[self.unit]
            what = f'{name} with its unit, such as "{example}"'
            unit = f" {self.unit}"
        else:
            what, unit = ("a whole number" if self.unit == "count" else "a number without unit"), ""
        limits = []
        if self.low > -math.inf:
            limits.append(f"{'above' if self.open_low else 'at least'} {self.low:g}{unit}")
        if self.high < math.inf:
            limits.append(f"at most {self.high:g}{unit}")
        return ", ".join([what, *limits])

    def read(self, raw: Any) -> Value:
        """Turn what a case file holds, plain or as a table, into a `Value`.

        Raises
        ------
        InputError
            Its field is empty here; the case fills in the path.
        """
        if isinstance(raw, Value):
            return raw
        provenance: Provenance = "assumed"
        note, typed = "", raw
        if isinstance(raw, dict):
            unknown = [key for key in raw if key not in ("value", "provenance", "note")]
            if unknown:
                raise InputError(
                    str(unknown[0]),
                    raw[unknown[0]],
                    "value, provenance, note",
                    nearest(str(unknown[0]), ("value", "provenance", "note")),
                )
            if "value" not in raw:
                raise InputError("", raw, "a table with value, provenance, note", "give the table a value")
            typed, provenance, note = raw["value"], raw.get("provenance", "assumed"), raw.get("note", "")
            if provenance not in PROVENANCES:
                raise InputError(
                    "provenance", provenance, "one of " + ", ".join(PROVENANCES), nearest(str(provenance), PROVENANCES)
                )
            if not isinstance(note, str):
                raise InputError("note", note, "text")
        si = self._number(typed)
        outside = si < self.low or si > self.high or (self.open_low and si <= self.low)
        if outside:
            raise InputError("", typed, self.allowed())
        return Value(si=si, typed=typed, provenance=provenance, note=note)

    def _number(self, typed: Any) -> float:
        if self.unit in DIMENSIONS:
            return parse_quantity(typed, self.unit, "")
        if isinstance(typed, str):
            try:
                typed = float(typed)
            except ValueError:
                raise InputError("", typed, self.allowed(), "this quantity has no unit") from None
        if isinstance(typed, bool) or not isinstance(typed, int | float):
            raise InputError("", typed, self.allowed())
        try:
            number = float(typed)
        except OverflowError:
            number = math.inf
        if not math.isfinite(number) or (self.unit == "count" and number != int(number)):
            raise InputError("", typed, self.allowed())
        return number


def _of(unit: str, low: float = -math.inf, high: float = math.inf, open_low: bool = False) -> Any:
    return BeforeValidator(Range(unit, low, high, open_low).read)


def positive(unit: str, high: float = math.inf) -> Any:
    """Return the pydantic validator of a quantity above zero."""
    return _of(unit, 0.0, high, open_low=True)


def not_negative(unit: str, high: float = math.inf) -> Any:
    """Return the pydantic validator of a quantity of at least zero."""
    return _of(unit, 0.0, high)


Mass = Annotated[Value, positive("kg", 1e6)]
Inertia = Annotated[Value, positive("kg m^2", 1e5)]
Length = Annotated[Value, positive("m", 1e4)]
Duration = Annotated[Value, not_negative("s", 1e5)]
FeedTime = Annotated[Value, positive("s", 10.0)]
OutputStep = Annotated[Value, _of("s", 1e-7, 1.0)]
Rotation = Annotated[Value, positive("rad/s", 1e5)]
Torque = Annotated[Value, positive("N m", 1e7)]
RotationGain = Annotated[Value, positive("N m s/rad", 1e7)]
RotationDrag = Annotated[Value, not_negative("N m s/rad", 1e5)]
SpringRate = Annotated[Value, positive("N/m", 1e12)]
Damping = Annotated[Value, not_negative("N s/m", 1e9)]
Force = Annotated[Value, not_negative("N", 1e6)]
Speed = Annotated[Value, positive("m/s", 1e4)]
Acceleration = Annotated[Value, _of("m/s^2", -1e9, 1e9)]
Frequency = Annotated[Value, positive("Hz", 1e12)]
Share = Annotated[Value, _of("", 0.0, 1.0)]
Restitution = Annotated[Value, _of("", 0.01, 1.0)]
Tolerance = Annotated[Value, _of("", 1e-12, 1e-5)]
Count = Annotated[Value, _of("count", 1, 100)]
BlowCount = Annotated[Value, _of("count", 1, 1000)]
SampleCount = Annotated[Value, _of("count", 10, 10_000_000)]

MaybeMass = Annotated[Value | None, positive("kg", 1e6)]
MaybeLength = Annotated[Value | None, positive("m", 1e4)]
MaybeArea = Annotated[Value | None, positive("m^2", 1e4)]
MaybeDensity = Annotated[Value | None, positive("kg/m^3", 1e6)]
MaybeModulus = Annotated[Value | None, positive("Pa", 1e15)]
MaybePressure = Annotated[Value | None, positive("Pa", 1e12)]
MaybeSpringRate = Annotated[Value | None, positive("N/m", 1e15)]
MaybeDamping = Annotated[Value | None, not_negative("N s/m", 1e9)]
MaybeGap = Annotated[Value | None, not_negative("m", 1.0)]
MaybePreload = Annotated[Value | None, not_negative("N", 1e9)]
MaybeLoss = Annotated[Value | None, not_negative("", 10.0)]
MaybePoisson = Annotated[Value | None, _of("", -0.999, 0.5)]
MaybeFrequency = Annotated[Value | None, positive("Hz", 1e12)]
MaybeQuality = Annotated[Value | None, positive("", 1e6)]
MaybeForce = Annotated[Value | None, _of("N", -1e12, 1e12)]
MaybeTime = Annotated[Value | None, positive("s", 10.0)]
MaybeStep = Annotated[Value | None, _of("s", 1e-12, 1e-3)]
MaybeSpeed = Annotated[Value | None, positive("m/s", 1e4)]
MaybeAcceleration = Annotated[Value | None, positive("m/s^2", 1e12)]
MaybeBits = Annotated[Value | None, _of("count", 2, 32)]
MaybeOrder = Annotated[Value | None, _of("count", 1, 12)]
MaybeError = Annotated[Value | None, _of("", 1e-8, 1.0)]
MaybeShift = Annotated[Value | None, _of("m/s^2", -1e9, 1e9)]
MaybeLayerSpeed = Annotated[Value | None, _of("m/s", -1e4, 1e4)]
