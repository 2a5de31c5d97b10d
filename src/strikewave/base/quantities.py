"""Values of a case: a number in SI with the text it was typed as, its provenance and a note.

The provenance of a value is one of published, measured, user, inferred, assumed, fitted; a value typed
without one is assumed. A value may carry a tolerance, of which `strikewave.studies.scatter.study` makes use.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Any, Literal, get_args

from pydantic import BaseModel, BeforeValidator, ConfigDict

from strikewave.base import declare
from strikewave.base.errors import InputError, nearest
from strikewave.base.units import DIMENSIONS, parse_quantity, take_apart, typed_number

Provenance = Literal["published", "measured", "user", "inferred", "assumed", "fitted"]
PROVENANCES: tuple[Provenance, ...] = get_args(Provenance)
"""Allowed provenances of a value."""
Distribution = Literal["normal", "uniform"]
DISTRIBUTIONS: tuple[Distribution, ...] = get_args(Distribution)
"""Allowed distributions of a value within its tolerance."""
DEVIATIONS, TRUNCATION = 2.0, 3.0  # 95 % lie within; an inspection sorts out the three in a thousand beyond
"""Standard deviations that a normal tolerance stands for, and at which draws end."""
TABLE = ("value", "provenance", "note", "tolerance", "distribution")
"""Keys that the table of a quantity may hold."""


class ToleranceBand(BaseModel):
    """Tolerance of a value."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    size: float
    """Half width of the band in SI, or share of the value where it is relative."""
    typed: str | int | float
    """Value as typed, such as ``"2 %"`` or ``"20 um"``."""
    relative: bool
    """True if it is a share of the value."""
    distribution: Distribution = "normal"
    """Distribution: uniform, or normal with a half width of two standard deviations, cut off at three."""


@declare.dataclass
class StatedValue:
    """A value of a case or of a set-up, as documents have it."""

    value: float = declare.word("SI")
    typed: str | int | float = declare.word("as typed")
    provenance: str = declare.word("where it comes from: published, measured, inferred, assumed, fitted or user")
    note: str = declare.word("what the file says of it")
    tolerance: float | None = declare.word("half width of its tolerance, SI", default=None, optional=True)
    distribution: str | None = declare.word("of the tolerance: normal or uniform", default=None, optional=True)


class Value(BaseModel):
    """A number in SI and where it comes from.

    Attributes
    ----------
    si : float
        The number in SI.
    typed : str or float
        Value as typed, written back unchanged so that a saved case gives the same numbers.
    provenance : str
        published, measured, user (typed or set by the user), inferred, assumed or fitted.
    note : str
        Reason, or source.
    tolerance : ToleranceBand, optional
        Tolerance of the value.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    si: float
    typed: str | int | float
    provenance: Provenance = "assumed"
    note: str = ""
    tolerance: ToleranceBand | None = None

    @property
    def typed_unit(self) -> str:
        """The unit in which it was typed; empty for a bare number, and for a word."""
        parts = take_apart(self.typed)
        return "" if parts is None else parts.unit

    @property
    def half_width(self) -> float:
        """Half width of its tolerance in SI, 0 where it has none."""
        band = self.tolerance
        if band is None:
            return 0.0
        return band.size * abs(self.si) if band.relative else band.size

    def document(self) -> Any:
        """Return its table in a case file, with provenance, tolerance and note."""
        band = self.tolerance
        table: dict[str, Any] = {"value": self.typed, "provenance": self.provenance}
        if band is not None:
            table["tolerance"] = band.typed
        if band is not None and band.distribution != "normal":
            table["distribution"] = band.distribution
        return {**table, "note": self.note} if self.note else table


@dataclass(frozen=True)
class Range:
    """Range of a value: its SI unit ("" for a number, "count" for a whole number), its limits, and a usual one."""

    unit: str
    low: float = -math.inf
    high: float = math.inf
    open_low: bool = False
    usual: str = ""

    def allowed(self) -> str:
        """Return the range in words, for an error line."""
        if self.unit in DIMENSIONS:
            name, example = DIMENSIONS[self.unit]
            what = f'{name} with its unit, such as "{self.usual or example}"'
            unit = f" {self.unit}"
        else:
            what, unit = ("a whole number" if self.unit == "count" else "a number without unit"), ""
        limits = []
        if self.low > -math.inf:
            limits.append(f"{'above' if self.open_low else 'at least'} {self.low:g}{unit}")
        if self.high < math.inf:
            limits.append(f"at most {self.high:g}{unit}")
        return ", ".join([what, *limits])

    def example(self) -> str:
        """Return a value as a case file has it: ``"200 us"``."""
        return f'"{self.usual or DIMENSIONS[self.unit][1]}"' if self.unit in DIMENSIONS else "1"

    def read(self, raw: Any) -> Value:
        """Turn an entry of a case file, plain or a table, into a `Value`; of an error the case fills in the field."""
        if isinstance(raw, Value):
            return raw
        if not isinstance(raw, dict):
            return Value(si=self._within(raw), typed=raw)
        _check_keys(raw)
        typed, provenance, note = raw["value"], raw.get("provenance", "assumed"), raw.get("note", "")
        si = self._within(typed)
        return Value(si=si, typed=typed, provenance=provenance, note=note, tolerance=self._band(raw, si))

    def _within(self, typed: Any) -> float:
        """Return a typed value in SI; refuse one outside the range."""
        si = self._number(typed)
        if si < self.low or si > self.high or (self.open_low and si <= self.low):
            raise InputError("", typed, self.allowed())
        return si

    def _band(self, raw: dict[str, Any], si: float) -> ToleranceBand | None:
        """Return the tolerance of a value, checked against it."""
        distribution = raw.get("distribution", "normal")
        if "tolerance" not in raw:
            if "distribution" in raw:
                raise InputError("distribution", distribution, "only beside a tolerance", 'such as tolerance = "2 %"')
            return None
        typed = raw["tolerance"]
        if distribution not in DISTRIBUTIONS:
            allowed = "one of " + ", ".join(DISTRIBUTIONS)
            raise InputError("distribution", distribution, allowed, nearest(str(distribution), DISTRIBUTIONS))
        if self.unit == "count":
            raise InputError("tolerance", typed, "no tolerance on a whole number", "remove it")
        share = _percent(typed)
        size = self._absolute(typed) if share is None else share
        if not size > 0.0:
            raise InputError("tolerance", typed, "above 0", "leave it out where there is none")
        if share is not None and (share > 1.0 or si == 0.0):
            hint = f"the value is 0: give the tolerance {self._example()}" if si == 0.0 else ""
            raise InputError("tolerance", typed, "at most 100 % of a value that is not 0", hint)
        if share is None and self.low >= 0.0 and 0.0 < si < size:
            raise InputError("tolerance", typed, f"at most the value itself ({raw['value']}), which cannot be below 0")
        return ToleranceBand(size=size, typed=typed, relative=share is not None, distribution=distribution)

    def _absolute(self, typed: Any) -> float:
        """Return a tolerance in the unit of the quantity."""
        try:
            return self._number(typed)
        except InputError as error:
            raise InputError("tolerance", typed, f'a share such as "2 %", or {self._example()}', error.hint) from None

    def _example(self) -> str:
        return f'with its unit, such as "{DIMENSIONS[self.unit][1]}"' if self.unit in DIMENSIONS else "as a number"

    def _number(self, typed: Any) -> float:
        if self.unit in DIMENSIONS:
            return parse_quantity(typed, self.unit, "", self.usual)
        if isinstance(typed, str):
            bare = typed_number(typed)
            if bare is None:
                raise InputError("", typed, self.allowed(), "this quantity has no unit")
            typed = bare
        if isinstance(typed, bool) or not isinstance(typed, int | float):
            raise InputError("", typed, self.allowed())
        try:
            number = float(typed)
        except OverflowError:
            number = math.inf
        if not math.isfinite(number) or (self.unit == "count" and number != int(number)):
            raise InputError("", typed, self.allowed())
        return number


AUTO: Literal["auto"] = "auto"
"""Word in place of a quantity that is found from others."""


@dataclass(frozen=True)
class RangeOrAuto(Range):
    """Range of a value, or the word `AUTO`, which alone has no provenance: the values that it is found from have."""

    def read(self, raw: Any) -> Any:
        """Turn an entry of a case file into a `Value`, or the word; see `Range.read`."""
        word = raw.get("value") if isinstance(raw, dict) else raw
        return AUTO if word == AUTO else super().read(raw)

    def _within(self, typed: Any) -> float:
        """Return a typed value in SI; an error names the word too."""
        try:
            return super()._within(typed)
        except InputError as error:
            raise InputError(error.field, error.got, f'{error.allowed}, or "{AUTO}"', error.hint) from None


def _check_keys(raw: dict[str, Any]) -> None:
    """Refuse the table of a quantity without a value, with unknown keys or with an unknown provenance."""
    unknown = [key for key in raw if key not in TABLE]
    if unknown:
        raise InputError(str(unknown[0]), raw[unknown[0]], ", ".join(TABLE), nearest(str(unknown[0]), TABLE))
    if "value" not in raw:
        raise InputError("", raw, "a table with value, provenance, note", "give the table a value")
    provenance = raw.get("provenance", "assumed")
    if provenance not in PROVENANCES:
        allowed = "one of " + ", ".join(PROVENANCES)
        raise InputError("provenance", provenance, allowed, nearest(str(provenance), PROVENANCES))
    if not isinstance(raw.get("note", ""), str):
        raise InputError("note", raw["note"], "text")


def _percent(typed: Any) -> float | None:
    """Return the share that "2 %" says; None where it is no share."""
    number = typed_number(typed, "%") if isinstance(typed, str) else None
    return None if number is None else number / 100.0


def _limited(unit: str, low: float = -math.inf, high: float = math.inf, open_low: bool = False) -> Any:
    return BeforeValidator(Range(unit, low, high, open_low).read)


def positive(unit: str, high: float = math.inf) -> Any:
    """Return the pydantic validator of a quantity above zero."""
    return _limited(unit, 0.0, high, open_low=True)


def not_negative(unit: str, high: float = math.inf) -> Any:
    """Return the pydantic validator of a quantity of at least zero."""
    return _limited(unit, 0.0, high)


# A limit here is far beyond any shock test: it refuses a wrong unit or a slip of the exponent, and keeps powers of the
# value from overflow. Others bound what is computed: a restitution from 0.01, below which a pulse hardly ends; a
# tolerance that the integrator can keep; Poisson's ratios and ratios of heats as physics has them; steps that fill no
# memory; a solid as light as an aerogel and as soft as a gel, which refuses a modulus of "30" without its GPa; an area
# of a square micrometre.
Mass = Annotated[Value, positive("kg", 1e6)]
Inertia = Annotated[Value, positive("kg m^2", 1e5)]
Length = Annotated[Value, positive("m", 1e4)]
DropHeight = Annotated[Value, BeforeValidator(Range("m", 0.0, 1e4, open_low=True, usual="1.2 m").read)]
Duration = Annotated[Value, not_negative("s", 1e5)]
FeedTime = Annotated[Value, positive("s", 10.0)]
OutputStep = Annotated[Value, _limited("s", 1e-7, 1.0)]
Rotation = Annotated[Value, positive("rad/s", 1e5)]
Torque = Annotated[Value, positive("N m", 1e7)]
RotationGain = Annotated[Value, positive("N m s/rad", 1e7)]
RotationDrag = Annotated[Value, not_negative("N m s/rad", 1e5)]
SpringRate = Annotated[Value, positive("N/m", 1e12)]
Damping = Annotated[Value, not_negative("N s/m", 1e9)]
Force = Annotated[Value, not_negative("N", 1e6)]
Speed = Annotated[Value, positive("m/s", 1e4)]
Acceleration = Annotated[Value, _limited("m/s^2", -1e9, 1e9)]
Frequency = Annotated[Value, positive("Hz", 1e12)]
Share = Annotated[Value, _limited("", 0.0, 1.0)]
Restitution = Annotated[Value, _limited("", 0.01, 1.0)]
Tolerance = Annotated[Value, _limited("", 1e-12, 1e-5)]
Count = Annotated[Value, _limited("count", 1, 100)]
BlowCount = Annotated[Value, _limited("count", 1, 1000)]
MaybeBlowCount = Annotated[Value | None, _limited("count", 1, 1000)]
SampleCount = Annotated[Value, _limited("count", 10, 10_000_000)]

MaybeAngle = Annotated[Value | None, _limited("rad", -2.0 * math.pi, 2.0 * math.pi)]
MaybeOffset = Annotated[Value | None, _limited("m", -1.0, 1.0)]
MaybeInertia = Annotated[Value | None, not_negative("kg m^2", 1e5)]
MaybeRotationRate = Annotated[Value | None, _limited("N m/rad", 1.0, 1e12)]
MaybeRotationDrag = Annotated[Value | None, not_negative("N m s/rad", 1e7)]
MaybeRipple = Annotated[Value | None, _limited("", 0.0, 0.2)]
MaybeRatio = Annotated[Value | None, positive("", 1e3)]
MaybeRestitution = Annotated[Value | None, _limited("", 0.01, 1.0)]
MaybeShare = Annotated[Value | None, _limited("", 0.0, 1.0)]
MaybeStrokeShare = Annotated[Value | None, _limited("", 0.01, 0.99)]
MaybeTurns = Annotated[Value | None, _limited("count", 1, 1000)]
MaybeFriction = Annotated[Value | None, not_negative("N", 1e6)]
MaybeHold = Annotated[Value | None, positive("s", 1e4)]
StrikerNumber = Annotated[Value, _limited("count", 1, 100)]
MaybeMass = Annotated[Value | None, positive("kg", 1e6)]
MaybeLength = Annotated[Value | None, positive("m", 1e4)]
MaybeArea = Annotated[Value | None, _limited("m^2", 1e-12, 1e4)]
MaybeDensity = Annotated[Value | None, _limited("kg/m^3", 0.1, 1e6)]
MaybeModulus = Annotated[Value | None, _limited("Pa", 1e3, 1e15)]
MaybePressure = Annotated[Value | None, positive("Pa", 1e12)]
ContactPressure = Value | Literal["auto"] | None
"""Largest pressure that a contact bears: a value, the word `AUTO`, or none."""
MaybeContactPressure = Annotated[ContactPressure, BeforeValidator(RangeOrAuto("Pa", 0.0, 1e12, open_low=True).read)]
MaybeSpringRate = Annotated[Value | None, positive("N/m", 1e15)]
MaybeDamping = Annotated[Value | None, not_negative("N s/m", 1e9)]
MaybeGap = Annotated[Value | None, not_negative("m", 1.0)]
MaybePreload = Annotated[Value | None, not_negative("N", 1e9)]
MaybeLoss = Annotated[Value | None, not_negative("", 10.0)]
MaybePoisson = Annotated[Value | None, _limited("", -0.999, 0.5)]
MaybeFrequency = Annotated[Value | None, positive("Hz", 1e12)]
MaybeQuality = Annotated[Value | None, positive("", 1e6)]
MaybeForce = Annotated[Value | None, _limited("N", -1e12, 1e12)]
MaybeTime = Annotated[Value | None, positive("s", 10.0)]
MaybeStep = Annotated[Value | None, _limited("s", 1e-12, 1e-3)]
MaybeSpeed = Annotated[Value | None, positive("m/s", 1e4)]
MaybeAcceleration = Annotated[Value | None, positive("m/s^2", 1e12)]
MaybeBits = Annotated[Value | None, _limited("count", 2, 32)]
MaybeOrder = Annotated[Value | None, _limited("count", 1, 12)]
MaybeError = Annotated[Value | None, _limited("", 1e-8, 1.0)]
MaybeShift = Annotated[Value | None, _limited("m/s^2", -1e9, 1e9)]
MaybeLayerSpeed = Annotated[Value | None, _limited("m/s", -1e4, 1e4)]

FollowTime = Annotated[Value, _limited("s", 1e-6, 1.0)]
MaybeLongest = Annotated[Value | None, _limited("s", 1e-6, 100.0)]
SwingAngle = Annotated[Value, positive("rad", math.pi)]
MaybeTorque = Annotated[Value | None, not_negative("N m", 1e7)]
MaybeVolume = Annotated[Value | None, positive("m^3", 1e4)]
MaybeAmbient = Annotated[Value | None, not_negative("Pa", 1e12)]
MaybeHeatRatio = Annotated[Value | None, _limited("", 1.0, 5.0 / 3.0 + 1e-9)]
MaybeExponent = Annotated[Value | None, _limited("", 1.0, 10.0)]
MaybePositiveForce = Annotated[Value | None, positive("N", 1e12)]
MaybeGravity = Annotated[Value | None, _limited("m/s^2", -1e9, 1e9)]

ElementSize = Annotated[Value, positive("m", 10.0)]
MaybeElementSize = Annotated[Value | None, positive("m", 10.0)]
MaybeGrowth = Annotated[Value | None, _limited("", 1.0, 2.0, open_low=True)]
MaybePlace = Annotated[Value | None, _limited("m", -1e4, 1e4)]
MaybeVelocity = Annotated[Value | None, _limited("m/s", -1e4, 1e4)]
MaybeNumber = Annotated[Value | None, _limited("", -1e9, 1e9)]
MaybeStrength = Annotated[Value | None, positive("Pa", 1e12)]
MaybeHardening = Annotated[Value | None, not_negative("Pa", 1e12)]
MaybeTemperature = Annotated[Value | None, positive("K", 1e5)]
MaybeHeatCapacity = Annotated[Value | None, positive("J/kg/K", 1e6)]
PerKelvin = Annotated[Value, not_negative("1/K", 1.0)]
MaybeStrainRate = Annotated[Value | None, positive("1/s", 1e9)]
Strength = Annotated[Value, positive("Pa", 1e12)]
Hardening = Annotated[Value, not_negative("Pa", 1e12)]
Angle = Annotated[Value, _limited("rad", -2.0 * math.pi, 2.0 * math.pi)]
Coefficient = Annotated[Value, not_negative("", 10.0)]
MaybeCoefficient = Annotated[Value | None, not_negative("", 10.0)]
SafetyFactor = Annotated[Value, _limited("", 0.0, 1.0, open_low=True)]
RunTime = Annotated[Value, positive("s", 10.0)]
LeastStep = Annotated[Value, not_negative("s", 1.0)]
FrameCount = Annotated[Value, _limited("count", 0, 10_000)]
RepeatedBlows = Annotated[Value, _limited("count", 1, 20)]
Instants = tuple[Annotated[Value, not_negative("s", 10.0)], ...]
Pressures = tuple[Annotated[Value, _limited("Pa", -1e12, 1e12)], ...]
Velocities = tuple[Annotated[Value, _limited("m/s", -1e4, 1e4)], ...]
