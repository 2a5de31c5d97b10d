"""Collisions of a line that take time, by contact laws."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from strikewave.contact.chain import Chain, ChainContact, ChainMotion, simulate
from strikewave.contact.law import AnyContact
from strikewave.machines.amplifier.line import BodyLine

Array = NDArray[np.float64]


@dataclass(frozen=True)
class SoftCollisions:
    """A line whose contacts take time.

    Attributes
    ----------
    motion : ChainMotion
        All of it; bodies are named 1, 2 ... from the bottom, infinite ones are bases.
    speeds : ndarray
        At the end, m/s; of an infinite body 0.
    contacts : tuple of ndarray
        Begin, end (s) and approach speed (m/s) of the contacts of each pair, shape (N, 3).
    """

    motion: ChainMotion
    speeds: Array
    contacts: tuple[Array, ...]

    @property
    def overlap(self) -> float:
        """Longest time that two contacts of one body last together, s: pairwise theory asks for 0."""
        longest = 0.0
        for one, other in itertools.pairwise(self.contacts):
            begin = np.maximum(one[:, None, 0], other[None, :, 0])
            end = np.minimum(one[:, None, 1], other[None, :, 1])
            longest = max(longest, float(np.max(end - begin, initial=0.0)))
        return longest


def collide_softly(
    line: BodyLine, contacts: Sequence[AnyContact], duration: float, tolerance: float = 1e-10
) -> SoftCollisions:
    """Follow a line whose bodies meet by contact laws; its restitutions are not asked.

    Parameters
    ----------
    line : BodyLine
        Bodies, gaps, speeds; an infinite one must stand still.
    contacts : sequence of Contact or LogarithmicContact
        Law of each pair of neighbours.
    duration : float
        How long, s.
    tolerance : float, optional
        Of `strikewave.contact.chain.simulate`.

    Raises
    ------
    ValueError
        If there is not one contact for each pair, or an infinite body moves.

    Examples
    --------
    >>> from strikewave.contact import Contact
    >>> pair = BodyLine((1.0, 1.0), (1.0,), gaps=(0.0,), speeds=(1.0, 0.0), gravity=0.0)
    >>> run = collide_softly(pair, [Contact(1e9, 1.5)], duration=1e-3)
    >>> print(abs(run.speeds).round(6))
    [0. 1.]
    """
    if len(contacts) != len(line.gaps):
        raise ValueError(f"{len(line.masses)} bodies take {len(line.gaps)} contacts, got {len(contacts)}")
    places = np.concatenate([[0.0], np.cumsum(line.gaps)])
    names = [str(k + 1) for k in range(len(places))]
    infinite = np.isinf(line.masses)
    if np.any(np.asarray(line.speeds)[infinite] != 0.0):
        raise ValueError("a body of infinite mass must stand still among finite contacts")
    bodies = {name: mass for name, mass, fixed in zip(names, line.masses, infinite, strict=True) if not fixed}
    bases = {name: float(x) for name, x, fixed in zip(names, places, infinite, strict=True) if fixed}
    touches = [ChainContact(*pair, contact) for pair, contact in zip(itertools.pairwise(names), contacts, strict=True)]
    chain = Chain(bodies, touches, bases, -line.gravity)
    start = dict(zip(names, places, strict=True)), dict(zip(names, line.speeds, strict=True))
    at, moving = ({name: float(values[name]) for name in bodies} for values in start)
    motion = simulate(chain, at, moving, duration, tolerance)
    speeds = np.zeros(len(names))
    speeds[~infinite] = motion.speeds(duration)
    return SoftCollisions(motion, speeds, tuple(motion.contacts(k) for k in range(len(touches))))
