"""What a contact says of the first blow where it is taken as elastic, and where it yields."""

from __future__ import annotations

from strikewave.base import declare
from strikewave.base.declare import KEY, MAIN, MORE, NO_UNIT, Quantity
from strikewave.base.shock_quantities import ACCELERATION, PEAK_FORCE, PULSE_WIDTH, RATIO, RESTITUTION
from strikewave.cases.yield_pressure import ELASTIC, HIGH, LOW, WORTH_SHOWING


@declare.dataclass
class ContactAnswer:
    """The first blow with its contact elastic, or yielding at a largest pressure (None where elastic), SI."""

    name: str = declare.word("answer of the contact: elastic, or yielding at a largest pressure", column=KEY)
    yield_pressure: float | None = declare.number(
        Quantity("Pa", "GPa", "largest pressure", 3, 0), "that pressure; null where elastic", column=MORE
    )
    rigid_peak: float = declare.number(
        ACCELERATION, "peak of the rigid-body acceleration of the first blow then", band="rigid_peak", column=MAIN
    )
    peak_force: float = declare.number(PEAK_FORCE, "its largest contact force", column=MAIN)
    width: float = declare.number(PULSE_WIDTH, "its width at 10 % of the peak", band="width", column=MAIN)
    restitution: float = declare.number(
        Quantity(NO_UNIT, NO_UNIT, "coefficient of restitution", 3, 0), "its coefficient of restitution", column=MORE
    )


@declare.dataclass
class ContactAnswers:
    """The first blow by each answer of its contact.

    Beside what documents have:

    Attributes
    ----------
    rows : tuple of ContactAnswer
        From elastic to the highest pressure; the others stand beside the one taken where the contact yields.
    """

    asked_restitution: float = declare.number(RESTITUTION, "coefficient of restitution asked of the damping")
    first_yield: float | None = declare.number(
        Quantity("N", "N", digits=3),
        "load at which the weaker material first yields inside; null where it is not known",
    )
    taken: str = declare.word("name of the answer that the run took")
    rows: tuple[ContactAnswer, ...] = declare.rows(
        ContactAnswer, "the answers, from elastic to the highest pressure", key="answers"
    )

    def row(self, name: str) -> ContactAnswer | None:
        """Return an answer by its name; None where it was not found."""
        return next((row for row in self.rows if row.name == name), None)

    @declare.computed(declare.number(RATIO, "elastic peak force over that load"))
    def times_first_yield(self) -> float | None:
        """Elastic peak force over the load of first yield."""
        elastic = self.row(ELASTIC)
        return None if elastic is None or self.first_yield is None else elastic.peak_force / self.first_yield

    @property
    def spread(self) -> float:
        """Largest over smallest answer less 1, of the peak of acceleration or of force, whichever is more."""
        peaks = ([getattr(row, name) for row in self.rows] for name in ("rigid_peak", "peak_force"))
        return max(max(values) / min(values) - 1.0 if min(values) > 0.0 else 0.0 for values in peaks)

    @declare.computed(declare.number(RESTITUTION, "what came out of the first blow"))
    def restitution(self) -> float | None:
        """Coefficient of restitution of the answer that was taken."""
        taken = self.row(self.taken)
        return None if taken is None else taken.restitution

    @declare.computed(declare.word("whether the answers differ so much that all are shown"))
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
