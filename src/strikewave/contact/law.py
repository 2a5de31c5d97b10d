"""The force law of a contact: an elastic base, hysteresis or a damper, and a cap on the pressure."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strikewave.base.errors import IntegrationError, nearest
from strikewave.base.texts import plain
from strikewave.contact import _law_kernels as kernels
from strikewave.contact import _pair_kernels

Array = NDArray[np.float64]

STYLES = {
    "never-pulls": kernels.NEVER_PULLS,
    "on-approach": kernels.ON_APPROACH,
    "pulls": kernels.PULLS,
    "retarded": kernels.RETARDED,
}
"""Styles of a damper: it ends where it would pull; acts on approach alone; may pull; or goes as the slope of the
elastic force, c F'(d) d', and ends where it would pull."""
SHAPES = {"line": kernels.LINE, "point": kernels.POINT}
"""Shapes of a contact whose pressure is capped."""
CAPS = {**SHAPES, "crush": kernels.CRUSH}
"""Caps of a force: the pressure of a contact of a shape, or the plateau of a cushion that crushes."""
FORMS = {"tangent": kernels.TANGENT, "elastomer": kernels.ELASTOMER, "plateau": kernels.PLATEAU}
"""Forms of a cushion that hardens; see `strikewave.contact._law_kernels.hardening`."""
EXPONENT_RANGE = 0.1, 10.0  # chosen far beyond contacts, 1 to 3 or so, so that only a slip is refused
"""Range of the exponent of a power law."""


@dataclass(frozen=True)
class Damper:
    """Damper beside the elastic force of a contact: c d^p d', or c F'(d) d' where it is retarded."""

    coefficient: ArrayLike
    """c, N s/m^(p + 1); s where it is retarded."""
    exponent: ArrayLike = 0.0
    """p, at least 0."""
    style: str = "never-pulls"
    """One of `STYLES`."""


@dataclass(frozen=True)
class PressureCap:
    """Cap on the contact pressure: the contact yields above a load, and unloads on a flattened radius.

    `strikewave.contact.elastoplastic` makes one from a pressure.
    """

    yield_load: ArrayLike
    """F_y, N."""
    shape: str
    """One of `CAPS`."""
    limit: ArrayLike = math.inf
    """Depth towards which a crushed cushion densifies, m; infinite where it does not."""


@dataclass(frozen=True)
class RequestedDamping:
    """A damping law by name, and the restitution asked of it."""

    law: str
    restitution: ArrayLike


@dataclass(frozen=True)
class Contact:
    """The force law of a contact, F = K d^n (1 + chi d'/v0), never negative.

    Theory: :eq:`contact-force`.

    Parameters
    ----------
    stiffness : array_like
        K, N/m^n.
    exponent : array_like
        n, from 0.1 to 10.
    hysteresis_factor : array_like, optional
        chi; 0 is elastic. v0 is the approach speed of the contact.
    damper : Damper, optional
        A damper instead of the hysteresis.
    cap : PressureCap, optional
        A cap on the pressure.
    asked : RequestedDamping, optional
        Origin of the hysteresis: a law and the restitution requested of it. `named_contact` fills it.
    """

    stiffness: ArrayLike
    exponent: ArrayLike
    hysteresis_factor: ArrayLike = 0.0
    damper: Damper | None = None
    cap: PressureCap | None = None
    asked: RequestedDamping | None = None


@dataclass(frozen=True)
class LogarithmicContact:
    """Force law of a line contact of long bodies, d = (F/G) ln(B/F) (1 + chi d'/v0)^-1, never negative.

    Holds while F is below B/e, where the indentation is B/(G e). The other fields are those of a `Contact`.
    """

    slope: ArrayLike
    """G, N/m."""
    load: ArrayLike
    """B, N."""
    hysteresis_factor: ArrayLike = 0.0
    cap: PressureCap | None = None
    asked: RequestedDamping | None = None

    @property
    def end_depth(self) -> Array:
        """Indentation at which the law ends, B/(G e), m."""
        return np.asarray(np.asarray(self.load, dtype=float) / np.asarray(self.slope, dtype=float) / math.e)


@dataclass(frozen=True)
class HardeningContact:
    """Force law of a cushion that hardens towards a limit, F(d) (1 + chi d'/v0), never negative.

    `strikewave.contact.cushions` makes one from area, thickness and properties. The other fields are those of a
    `Contact`.
    """

    form: str
    """One of `FORMS`."""
    stiffness: ArrayLike
    """Slope at first touch k, N/m."""
    limit: ArrayLike
    """Depth that it never reaches L, m; infinite for a plateau that does not densify."""
    plateau: ArrayLike = 0.0
    """Force of the plateau P, N; the form ``plateau`` needs it."""
    hysteresis_factor: ArrayLike = 0.0
    damper: Damper | None = None
    asked: RequestedDamping | None = None

    @property
    def end_depth(self) -> Array:
        """Indentation at which the law ends, 0.99 L, m."""
        return np.asarray(kernels.FOLLOWED * np.asarray(self.limit, dtype=float))

    @property
    def cap(self) -> PressureCap | None:
        """None: it gives back what it stores."""
        return None


AnyContact = Contact | LogarithmicContact | HardeningContact


def refuse(name: str, values: ArrayLike, good: NDArray[np.bool_], allowed: str) -> None:
    """Raise ValueError for the first value that is not good, with its index where there are several."""
    if np.all(good):
        return
    array = np.asarray(values, dtype=float)
    at = np.unravel_index(int(np.argmin(np.broadcast_to(good, array.shape))), array.shape)
    index = ", ".join(str(int(i)) for i in at)
    where = f" at index {'(' + index + ')' if len(at) > 1 else index}" if array.ndim else ""
    raise ValueError(f"{name} must be {allowed}, got {float(array[at])!r}{where}")


def positive(name: str, values: ArrayLike, allowed: str = "positive and finite") -> Array:
    """Return values as an array, or raise ValueError where one is not positive and finite."""
    array = np.asarray(values, dtype=float)
    refuse(name, array, (array > 0.0) & np.isfinite(array), allowed)
    return array


def not_negative(name: str, values: ArrayLike) -> Array:
    """Return values as an array, or raise ValueError where one is negative or not finite."""
    array = np.asarray(values, dtype=float)
    refuse(name, array, (array >= 0.0) & np.isfinite(array), "finite and >= 0")
    return array


def check(contact: AnyContact) -> dict[int, Any]:
    """Return the numbers of a law by their place in a row of the kernels; refuse one out of range, with its index."""
    row: dict[int, Any] = {kernels.DAMPING: not_negative("the hysteresis factor", contact.hysteresis_factor)}
    if isinstance(contact, LogarithmicContact):
        row |= {kernels.FORM: kernels.LOGARITHMIC, kernels.STIFFNESS: positive("the slope", contact.slope)}
        row[kernels.EXPONENT] = positive("the load", contact.load)
        if contact.cap is not None:
            over = np.asarray(contact.cap.yield_load, dtype=float)
            refuse(
                "the yield load",
                over,
                over * math.e < row[kernels.EXPONENT],
                "below the end of the logarithmic law, B/e",
            )
    elif isinstance(contact, HardeningContact):
        row |= _hardening(contact) | _damper(contact)
    else:
        n = np.asarray(contact.exponent, dtype=float)
        low, high = EXPONENT_RANGE
        refuse("the exponent", n, (n >= low) & (n <= high), f"within {low:g} to {high:g}")
        row |= {
            kernels.FORM: kernels.POWER,
            kernels.STIFFNESS: positive("the stiffness", contact.stiffness),
            kernels.EXPONENT: n,
        }
        row |= _damper(contact)
    row[kernels.YIELD_LOAD] = np.inf
    if contact.cap is not None:
        row |= {
            kernels.YIELD_LOAD: positive("the yield load", contact.cap.yield_load),
            kernels.SHAPE: _one_of(CAPS, contact.cap.shape),
        }
        if contact.cap.shape == "crush":
            if not isinstance(contact, Contact) or np.any(np.asarray(contact.exponent) != 1.0):
                raise ValueError("what crushes is linear before: the exponent must be 1")
            row[kernels.LIMIT] = limit = np.asarray(contact.cap.limit, dtype=float)
            first = np.asarray(contact.cap.yield_load) / contact.stiffness
            # the plateau ends at the share 1 - 1/D of the limit: it must begin before
            allowed = f"at least {kernels.STEEPNESS:g} times the depth at which it begins to crush, load/stiffness"
            refuse("the limit of the crush", limit, limit >= kernels.STEEPNESS * first, allowed)
    return row


def _hardening(contact: HardeningContact) -> dict[int, Any]:
    """Return the numbers of a cushion by their place in a row."""
    row: dict[int, Any] = {
        kernels.FORM: _one_of(FORMS, contact.form),
        kernels.STIFFNESS: positive("the stiffness", contact.stiffness),
    }
    row[kernels.LIMIT] = limit = np.asarray(contact.limit, dtype=float)
    plateau = contact.form == "plateau"
    refuse("the limit", limit, (limit > 0.0) & (plateau | np.isfinite(limit)), "positive")
    if plateau:
        row[kernels.EXPONENT] = load = positive("the force of the plateau", contact.plateau)
        begins = load / row[kernels.STIFFNESS]
        allowed = "beyond the begin of the plateau: limit (1 - 1/D) > plateau/stiffness"
        refuse("the limit", limit, limit * (1.0 - 1.0 / kernels.STEEPNESS) > begins, allowed)
    return row


def _damper(contact: Contact | HardeningContact) -> dict[int, Any]:
    damper = contact.damper
    if damper is None:
        return {}
    if contact.cap is not None or np.any(np.asarray(contact.hysteresis_factor) != 0.0):
        raise ValueError("a contact has a damper, or hysteresis and a cap, not both")
    return {
        kernels.DAMPER: not_negative("the coefficient of the damper", damper.coefficient),
        kernels.DAMPER_EXPONENT: not_negative("the exponent of the damper", damper.exponent),
        kernels.STYLE: _one_of(STYLES, damper.style),
    }


def _one_of(choices: dict[str, float], word: str) -> float:
    if word not in choices:
        raise ValueError(f"{word!r} is not known; {nearest(word, choices)}")
    return choices[word]


def rows(contact: AnyContact, shape: tuple[int, ...] = ()) -> Array:
    """Return a law as rows of numbers for the kernels, shape (N, COLUMNS) for the N values of a broadcast shape."""
    return rows_beside(contact, np.empty(shape))[0]


def rows_beside(contact: AnyContact, *others: ArrayLike) -> tuple[Array, tuple[int, ...]]:
    """Return a law as rows of numbers for the broadcast shape of its own numbers and others, and that shape."""
    numbers = check(contact)
    shape = np.broadcast_shapes(*(np.shape(value) for value in (*numbers.values(), *others)))
    table = np.zeros((math.prod(shape), kernels.COLUMNS))
    for place, value in numbers.items():
        table[:, place] = np.broadcast_to(value, shape).reshape(-1)
    return table, shape


def flat(values: ArrayLike, shape: tuple[int, ...]) -> Array:
    """Return values broadcast to a shape, as a flat array of their own."""
    return np.array(np.broadcast_to(np.asarray(values, dtype=float), shape)).reshape(-1)


def single(contact: AnyContact) -> Array:
    """Return one law as a row of numbers, or raise ValueError where the contact holds several."""
    numbers = check(contact)
    if all(np.ndim(value) == 0 for value in numbers.values()):  # without broadcasting: bands take thousands of these
        row = np.zeros(kernels.COLUMNS)
        for place, value in numbers.items():
            row[place] = value
        return row
    table = rows(contact)
    if len(table) != 1:
        raise ValueError(f"one contact law is wanted here, got {len(table)}: its numbers are arrays")
    return np.asarray(table[0])


def elastic_indentation(contact: AnyContact, mass: float, speed: float) -> float:
    """Return the largest indentation without losses, [(n + 1) m v0^2 / (2 K)]^(1/(n + 1)) of a power law, m."""
    out = np.empty(1)
    _pair_kernels.elastic_depths(single(contact)[None], np.array([0.5 * mass * speed**2]), out)
    return float(out[0])


def indentation_under(contact: AnyContact, force: float) -> float:
    """Return the indentation at which the elastic force of a contact has a value, m; up to the end of its law."""
    if isinstance(contact, LogarithmicContact):
        slope, load = float(np.asarray(contact.slope)), float(np.asarray(contact.load))
        borne = min(force, load / math.e)
        return borne / slope * math.log(load / borne)
    if isinstance(contact, HardeningContact):
        out = np.empty(1)
        _pair_kernels.cushion_depths_under(single(contact)[None], np.array([force]), out)
        return float(out[0])
    return float((force / float(np.asarray(contact.stiffness))) ** (1.0 / float(np.asarray(contact.exponent))))


def check_end(contact: AnyContact, deepest: float) -> None:
    """Raise IntegrationError where an indentation, m, lies beyond the end of its law."""
    if isinstance(contact, Contact) or deepest < float(contact.end_depth):
        return
    end = f"{plain(float(contact.end_depth) * 1e3)} mm"
    if isinstance(contact, HardeningContact):
        raise IntegrationError(
            f"a cushion is pressed {plain(deepest * 1e3)} mm deep: it bottoms out, its law ends at {end}; take a "
            "thicker or larger one, or one that bears more"
        )
    raise IntegrationError(
        f"a contact is pressed {plain(deepest * 1e3)} mm deep, beyond the end of its logarithmic law at {end}: "
        "take a power law"
    )


def striking_law(contact: AnyContact) -> Array:
    """Return the law of a striker on a stack of layers as a row of numbers; refuse one that pulls."""
    row = single(contact)
    if row[kernels.DAMPER] and row[kernels.STYLE] == kernels.PULLS:
        raise ValueError("a striker on a stack takes a damper that never pulls, or one that acts on approach")
    return row
