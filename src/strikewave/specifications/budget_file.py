"""Uncertainty budgets read: one expanded uncertainty for the whole channel, or a TOML file with its contributions.

Each [[contribution]] has a kind, which says what it does to a record, a number, how that is distributed, and from where
it is known: as the numbers of a specification, normative where it was read in the certificate or data sheet itself.
"""

from __future__ import annotations

import math
from importlib import resources
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple, Self, get_args

from pydantic import BeforeValidator, Field, model_validator

from strikewave.base.errors import MISSING, InputError
from strikewave.base.texts import sign_needed
from strikewave.base.units import typed_number
from strikewave.cases.files import read_small_file
from strikewave.cases.paths import Form
from strikewave.cases.tables.common import Line
from strikewave.records.budget import (
    DIVISORS,
    NORMAL,
    RECORD,
    RECTANGULAR,
    SAMPLING,
    U_SHAPED,
    Budget,
    Contribution,
    of_share,
)
from strikewave.specifications.tables import (
    MaybePart,
    MaybeRate,
    NumberReader,
    Part,
    SpecificationTable,
    StatedNumber,
    Status,
    Words,
    standing,
)

ALLOWED = 'a share such as "5 %", or a TOML file with [[contribution]]'
# Contributions of a budget, and bands of a response, at most: no data sheet comes near
MOST_CONTRIBUTIONS, MOST_BANDS = 100, 200
Kind = Literal[
    "sensitivity",
    "amplifier",
    "linearity",
    "temperature",
    "transverse",
    "response",
    "resonance",
    "filter",
    "offset",
    "drift",
    "coupling",
    "noise",
    "clock",
]
DistributionName = Literal["normal", "rectangular", "triangular", "u-shaped"]


class KindFields(NamedTuple):
    """Fields that a kind needs, and the distribution that it has by its nature; empty where the file states it."""

    needs: tuple[str, ...] = ("value",)
    distribution: str = ""


# Fields of the kinds that are not one share, or amount, alone
FIELDS_OF_KINDS: dict[str, KindFields] = {
    "temperature": KindFields(("per_kelvin", "range")),
    "transverse": KindFields(("value", "motion"), U_SHAPED),
    "response": KindFields(("bands",)),
    "resonance": KindFields(("frequency", "quality"), RECTANGULAR),
    "filter": KindFields(("value", "cutoff", "order")),
    "coupling": KindFields(("time_constant",), RECTANGULAR),
}
FIELDS = ("value", "per_kelvin", "range", "motion", "bands", "frequency", "quality", "cutoff", "order", "time_constant")


def _value(raw: Any) -> StatedNumber:
    """Return a share, or an acceleration."""
    typed = raw.get("value", "") if isinstance(raw, dict) else raw
    if isinstance(typed, str) and not typed.strip().endswith("%"):
        return NumberReader("m/s^2", 0.0, 1e7).read(raw)
    return NumberReader("%", 0.0, 1.0).read(raw)


def _bands(raw: Any) -> Any:
    """Return pairs of frequency and share."""
    if not isinstance(raw, list | tuple) or not all(isinstance(one, list | tuple) and len(one) == 2 for one in raw):
        raise InputError("", raw, 'pairs of frequency and share, such as [["1 kHz", "1 %"], ["10 kHz", "5 %"]]')
    if not 2 <= len(raw) <= MOST_BANDS:
        raise InputError("", f"{len(raw)} pairs", f"2 to {MOST_BANDS}")
    return tuple(tuple(one) for one in raw)


def _reader(unit: str, low: float, high: float) -> Any:
    return BeforeValidator(NumberReader(unit, low, high, open_low=True).read)


Frequency = Annotated[StatedNumber, _reader("Hz", 0.0, 1e9)]


class ContributionTable(SpecificationTable):
    """[[contribution]]: what one thing may have done to the record.

    ``value`` is the half-width of its ``distribution``, or ``coverage`` times its standard uncertainty.
    """

    kind: Kind
    name: Line = ""
    value: Annotated[StatedNumber | None, BeforeValidator(_value)] = None
    coverage: Annotated[StatedNumber | None, _reader("", 0.5, 10.0)] = None
    distribution: DistributionName | None = None
    per_kelvin: MaybePart = None
    range: Annotated[StatedNumber | None, _reader("K", 0.0, 1e3)] = None
    motion: Annotated[StatedNumber | None, BeforeValidator(NumberReader("%", 0.0, 10.0).read)] = None
    bands: Annotated[tuple[tuple[Frequency, Part], ...], BeforeValidator(_bands)] = ()
    frequency: MaybeRate = None
    quality: Annotated[StatedNumber | None, _reader("", 0.5, 1e6)] = None
    cutoff: MaybeRate = None
    order: Annotated[StatedNumber | None, BeforeValidator(NumberReader("count", 1, 20).read)] = None
    time_constant: Annotated[StatedNumber | None, _reader("s", 0.0, 1e6)] = None

    @model_validator(mode="after")
    def _whole(self) -> Self:
        fields = FIELDS_OF_KINDS.get(self.kind, KindFields())
        for name in FIELDS:
            stated = bool(getattr(self, name))
            if stated and name not in fields.needs:
                typed = getattr(getattr(self, name), "typed", name)
                raise InputError(name, typed, f"with kind {self.kind} only {', '.join(fields.needs)}", "leave it out")
            if name in fields.needs and not stated:
                raise InputError(name, MISSING, f"with kind {self.kind}: {', '.join(fields.needs)}")
        amount = self.kind in ("offset", "drift", "noise")
        if self.value is not None and not amount and not _is_share(self.value):
            raise InputError("value", self.value.typed, f'a share with kind {self.kind}, such as "2 %"')
        frequencies = [one.si for one, _ in self.bands]
        if frequencies != sorted(set(frequencies)):
            raise InputError("bands", [one.typed for one, _ in self.bands], "frequencies upwards")
        self._check_distribution(fields)
        return self

    def _check_distribution(self, fields: KindFields) -> None:
        """Refuse a number of which nobody said how it is distributed, and two that say it differently."""
        if fields.distribution and self.coverage is None:
            return
        if fields.distribution:
            assert self.coverage is not None
            raise InputError("coverage", self.coverage.typed, f"none with kind {self.kind}", "leave it out")
        if self.coverage is None and self.distribution in (None, NORMAL):
            allowed = 'coverage = 2 of an expanded uncertainty, or distribution = "rectangular" of bounds'
            raise InputError("coverage", MISSING, allowed)
        if self.coverage is not None and self.distribution not in (None, NORMAL):
            raise InputError("distribution", self.distribution, "normal beside coverage", "state one of both")


def _is_share(number: StatedNumber) -> bool:
    return not isinstance(number.typed, str) or number.typed.strip().endswith("%")


class BudgetFile(SpecificationTable):
    """A budget file."""

    schema_: Annotated[Literal[1], Field(alias="schema")]
    title: Line
    status: Status
    note: Words = ""
    contribution: tuple[ContributionTable, ...]

    @model_validator(mode="after")
    def _counted(self) -> Self:
        if not 1 <= len(self.contribution) <= MOST_CONTRIBUTIONS:
            raise InputError("contribution", f"{len(self.contribution)} tables", f"1 to {MOST_CONTRIBUTIONS}")
        names = [_name(one) for one in self.contribution]
        twice = next((name for name in names if names.count(name) > 1), "")
        if twice:
            raise InputError("contribution", twice, "a name for each contribution", 'add name = "..."')
        taken = next((name for name in names if name in (RECORD, SAMPLING)), "")
        if taken:
            raise InputError("contribution", taken, "another name", "the record itself tells what is called so")
        return self


FORM = Form(BudgetFile, "budget", 'contribution.sensitivity.value="2 %"')


def _name(table: ContributionTable) -> str:
    return table.name or table.kind


def load_budget(asked: str, field: str = "--uncertainty") -> Budget:
    """Return the budget of a share, an expanded uncertainty with k = 2, or of a file that ends in ``.toml``."""
    word = asked.strip()
    if not word.lower().endswith(".toml"):
        bare, number = typed_number(word), typed_number(word, "%")
        if bare is not None:
            raise InputError(field, asked, ALLOWED, sign_needed(bare))
        if number is None or not 0.0 < number < 100.0:
            raise InputError(field, asked, ALLOWED)
        return of_share(0.01 * number)
    path = Path(word)
    document = read_small_file(path, field, ALLOWED)
    file = FORM.read(document, f"{field} {path}: ")
    return Budget(tuple(_contribution(table, file) for table in file.contribution), file.title, str(path))


def example_budget() -> str:
    """Return a budget to fill in: each kind with its fields, numbers with the status that they have.

    Examples
    --------
    >>> "[[contribution]]" in example_budget()
    True
    """
    return (resources.files(__package__) / "budget_example.toml").read_text("utf-8")


def _contribution(table: ContributionTable, file: BudgetFile) -> Contribution:
    """Return what a table states, in SI."""
    stated = [number for name in FIELDS[:-1] if isinstance(number := getattr(table, name), StatedNumber)]
    stated += [table.time_constant] if table.time_constant is not None else []
    stated += [number for pair in table.bands for number in pair]
    known = [standing(number, table, file) for number in stated]
    status, source = max(known, key=lambda pair: get_args(Status).index(pair[0]))
    spread = 1.0
    if table.per_kelvin is not None and table.range is not None:
        spread = table.per_kelvin.si * table.range.si
    elif table.value is not None:
        spread = table.value.si * (table.motion.si if table.motion is not None else 1.0)
    distribution = FIELDS_OF_KINDS.get(table.kind, KindFields()).distribution or table.distribution or NORMAL
    if table.coverage is not None:
        spread /= table.coverage.si
    return Contribution(
        table.kind,
        _name(table),
        spread,
        distribution,
        table.value is None or _is_share(table.value),
        status,
        source,
        _typed(table, stated),
        _si(table.frequency or table.cutoff),
        _si(table.order),
        _si(table.quality),
        tuple((frequency.si, share.si) for frequency, share in table.bands),
        _si(table.time_constant),
    )


def _si(number: StatedNumber | None) -> float:
    return math.nan if number is None else number.si


def _typed(table: ContributionTable, stated: list[StatedNumber]) -> str:
    """Return what is stated, as it was typed, with its distribution."""
    words = ", ".join(str(number.typed) for number in stated[:4]) + (", ..." if len(stated) > 4 else "")
    return words + ("" if table.coverage is None else f", k = {table.coverage.si:g}")


assert set(DIVISORS) == set(get_args(DistributionName))
