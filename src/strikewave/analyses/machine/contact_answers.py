"""What a contact says of the first blow where it is taken as elastic, and where it yields."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from strikewave.cases.yield_pressure import ELASTIC, HIGH, LOW, WORTH_SHOWING

ANSWER_UNITS = {
    "asked_restitution": "1",
    "first_yield": "N",
    "times_first_yield": "1",
    "yield_pressure": "Pa",
    "rigid_peak": "m/s^2",
    "peak_force": "N",
    "width": "s",
    "restitution": "1",
}
"""SI unit of each number of the answers."""


@dataclass(frozen=True)
class ContactAnswer:
    """The first blow with its contact elastic, or yielding at a largest pressure (None where elastic), SI."""

    name: str
    yield_pressure: float | None
    rigid_peak: float
    peak_force: float
    width: float
    restitution: float


@dataclass(frozen=True)
class ContactAnswers:
    """The first blow by each answer of its contact.

    Attributes
    ----------
    asked_restitution : float
        Restitution asked of the damping; what comes out is that of each row, what yields included.
    first_yield : float or None
        Load at which the weaker material first yields inside, N; None where it is not known.
    taken : str
        Name of the answer that the run took.
    rows : tuple of ContactAnswer
        From elastic to the highest pressure; the others stand beside the one taken where the contact yields.
    """

    asked_restitution: float
    first_yield: float | None
    taken: str
    rows: tuple[ContactAnswer, ...]

    def row(self, name: str) -> ContactAnswer | None:
        """Return an answer by its name; None where it was not found."""
        return next((row for row in self.rows if row.name == name), None)

    @property
    def times_first_yield(self) -> float | None:
        """Elastic peak force over the load of first yield."""
        elastic = self.row(ELASTIC)
        return None if elastic is None or self.first_yield is None else elastic.peak_force / self.first_yield

    @property
    def spread(self) -> float:
        """Largest over smallest answer less 1, of the peak of acceleration or of force, whichever is more."""
        peaks = ([getattr(row, name) for row in self.rows] for name in ("rigid_peak", "peak_force"))
        return max(max(values) / min(values) - 1.0 if min(values) > 0.0 else 0.0 for values in peaks)

    @property
    def differ(self) -> bool:
        """Whether the answers differ by so much that all are shown."""
        return self.spread > WORTH_SHOWING

    @property
    def band(self) -> tuple[float, float] | None:
        """Least and largest rigid peak over what is known of the pressure, m/s^2; None where it was given."""
        if self.row(LOW) is None and self.row(HIGH) is None:
            return None
        peaks = [row.rigid_peak for row in self.rows if row.name != ELASTIC]
        return min(peaks), max(peaks)

    def document(self) -> dict[str, Any]:
        """Return what the JSON document holds of it."""
        taken = self.row(self.taken)
        return {
            "asked_restitution": self.asked_restitution,
            "restitution": None if taken is None else taken.restitution,
            "first_yield": self.first_yield,
            "times_first_yield": self.times_first_yield,
            "taken": self.taken,
            "differ": self.differ,
            "answers": [vars(row) for row in self.rows],
        }
