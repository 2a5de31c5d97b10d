"""A launched machine followed over its rebounds: which contacts are one blow, when it rests, where a brake catches it.

Between two blows striker and object fly apart and come together again, by gravity, spring or arm. With a restitution e
and gravity g a ball that comes with v rises to the heights h e^(2n), flies 2 v e^n/g between the blows n and n + 1, and
would rest after v/g (1 + e)/(1 - e) of time from its release.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from strikewave.machines.spans import ChainSpan

Array = NDArray[np.float64]

REST_SHARE = 0.02
"""An object rests once it comes with less than this share of its first approach speed. Chosen: 4e-4 of the energy is
left then, and the number of blows stays finite, ln(0.02)/ln(e) of them."""
FLIGHT_SHARE = 5.0
"""A touch begins another blow where the two were apart for so many times as long as the blow before it lasted. A frame
that rings touches again within about one such time; a flight of 20 mm/s, the slowest that is followed after a fall of
50 mm, takes 4 ms, twenty times a contact of 200 us."""
FLIGHT_SAMPLES = 4001
"""Times among which the top of a flight is looked for before it is located."""


@dataclass(frozen=True)
class Rebounds:
    """How long a launched machine is followed after its first blow.

    Parameters
    ----------
    brake_after : int, optional
        Blows after which a brake catches it, at the top of its rebound; without one it is followed until it rests.
    """

    brake_after: int | None = None


def blow_numbers(contacts: Array) -> NDArray[np.int64]:
    """Return the number, from 0, of the blow that each contact belongs to; rows of begin and end, in order of time.

    Examples
    --------
    >>> blow_numbers(np.array([[0.0, 1e-4], [1.2e-4, 2e-4], [0.3, 0.3001]])).tolist()
    [0, 0, 1]
    """
    numbers = np.zeros(len(contacts), dtype=np.int64)
    begin = contacts[0, 0] if len(contacts) else 0.0
    for row in range(1, len(contacts)):
        numbers[row] = numbers[row - 1]
        if is_flight(begin, contacts[row - 1, 1], contacts[row, 0]):
            numbers[row] += 1
            begin = contacts[row, 0]
    return numbers


def is_flight(begin: float, released: float, touched: float) -> bool:
    """Tell whether a touch begins another blow than the one that began and was released at these times, s."""
    return touched - released > FLIGHT_SHARE * (released - begin)


def end_at_touch(rebounds: Rebounds, contacts: Array, time: float, approach: float) -> str:
    """Return how following ends at a touch: "rest" or "brake"; empty where it goes on.

    Parameters
    ----------
    rebounds : Rebounds
        How far to follow.
    contacts : ndarray
        Begin, end (s) and approach speed (m/s) of the contacts before, in order of time.
    time, approach : float
        Of the touch, s and m/s.
    """
    if not len(contacts):
        return ""
    numbers = blow_numbers(contacts)
    begin = contacts[numbers == numbers[-1]][0, 0]
    if not is_flight(begin, contacts[-1, 1], time):
        return ""
    if rebounds.brake_after is not None:
        return "brake" if numbers[-1] + 1 >= rebounds.brake_after else ""
    return "rest" if approach < REST_SHARE * contacts[0, 2] else ""


def top_of_flight(span: ChainSpan, released: float) -> float:
    """Return when striker and object are farthest apart in a flight that ends with a span, s."""

    def parting(times: Array) -> Array:
        speeds = span.motion.sample(times)[0][:, span.layout.speeds]
        moving = span.sample(times).object_speed
        return np.asarray(moving - speeds[:, span.layout.strikers][:, 0])

    times = np.linspace(max(released, span.begin), span.end, FLIGHT_SAMPLES)
    rates = parting(times)
    last = int(np.flatnonzero(rates > 0.0)[-1])
    return float(
        scipy.optimize.brentq(lambda t: float(parting(np.array([t]))[0]), times[last], times[last + 1], xtol=1e-12)
    )
