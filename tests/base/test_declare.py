"""What a field declares is what the document, its units and its documentation hold, and nothing else."""

import dataclasses
import pickle

import numpy as np
import pytest

from strikewave.base import declare
from strikewave.base.declare import KEY, MAIN, NO_UNIT, Quantity

FORCE, TIME, SHARE = Quantity("N", "kN"), Quantity("s", "us"), Quantity(NO_UNIT, "%")


@declare.dataclass
class Touch:
    """A contact."""

    begin: float = declare.number(TIME, "when it begins", column=KEY)
    force: float | None = declare.number(FORCE, "largest force")


@declare.dataclass
class Body:
    """A body.

    Attributes
    ----------
    hidden : int
        What no face shows.
    """

    hidden: int
    touches: tuple[Touch, ...] = declare.rows(Touch, "its contacts", key="contacts")
    first: Touch | None = declare.part(Touch, "the first one; null where it was not touched")
    other: Touch | None = declare.part(Touch, "the other", optional=True)
    again: Touch = declare.part(Touch, "the same as its own keys", inline=True)
    by_name: dict[str, Touch] = declare.named(Touch, "by their names")
    speed: np.ndarray = declare.history("m/s", "its speed")
    inner: str = declare.word("of no document", in_document=False, default="x")

    @declare.computed(declare.number(SHARE, "share of them that have a force"))
    def share(self) -> float:
        """Share of contacts with a force."""
        return sum(touch.force is not None for touch in self.touches) / len(self.touches)


@declare.dataclass
class Heavy(Body):
    """A body with a mass."""

    mass: float = declare.number(Quantity("kg", "kg"), "its mass", default=2.0)


@pytest.fixture
def body():
    one, two = Touch(1.0, 10.0), Touch(2.0, None)
    return Body(7, (one, two), one, None, two, {"a": one}, np.array([1.0, 2.0]))


def test_the_document_has_each_declared_field_by_its_key(body):
    held = declare.content(body)
    assert held.pop("speed") is body.speed
    assert held == {
        "contacts": [{"begin": 1.0, "force": 10.0}, {"begin": 2.0, "force": None}],
        "first": {"begin": 1.0, "force": 10.0},
        "begin": 2.0,
        "force": None,
        "by_name": {"a": {"begin": 1.0, "force": 10.0}},
        "share": 0.5,
    }
    there = dataclasses.replace(body, first=None, other=body.again)
    assert declare.content(there)["first"] is None
    assert declare.content(there)["other"] == {"begin": 2.0, "force": None}


def test_a_part_that_is_not_there_leaves_its_keys_null_unless_it_is_optional():
    @declare.dataclass
    class Looked:
        """A contact that was looked at, or not."""

        more: Touch | None = declare.part(Touch, "what was found", inline=True)
        rest: Touch | None = declare.part(Touch, "what else", inline=True, optional=True)

    assert declare.content(Looked(None, None)) == {"begin": None, "force": None}
    assert declare.content(Looked(None, Touch(1.0, 2.0))) == {"begin": 1.0, "force": 2.0}


def test_units_are_those_of_all_keys_within():
    assert declare.units(Body) == {"begin": "s", "force": "N", "speed": "m/s", "share": "1"}
    assert declare.units(Heavy) == {**declare.units(Body), "mass": "kg"}


def test_the_unit_of_a_part_is_that_of_the_numbers_within_it():
    @declare.dataclass
    class Balance:
        """Two parts with the same keys and different units."""

        force: Touch = declare.part(Touch, "forces", quantity=FORCE)
        again: dict[str, Touch] = declare.named(Touch, "by their names", quantity=FORCE)
        shares: Body = declare.part(Body, "what has units of its own", quantity=SHARE)

    assert declare.units(Balance) == {"force": "N", "begin": "s", "again": "N", "shares": "1", "speed": "m/s"}


def test_a_band_of_two_units_is_refused():
    @declare.dataclass
    class Inner:
        """A row of stresses."""

        stress: float = declare.number(Quantity("Pa", "MPa"), "a stress", band="peak")

    @declare.dataclass
    class Torn:
        """A force whose band is called as that of a stress."""

        force: float = declare.number(Quantity("N", "kN"), "a force", band="peak")
        again: float = declare.number(Quantity("N", "kN", digits=5), "the same quantity", band="peak")
        rows: tuple[Inner, ...] = declare.rows(Inner, "stresses")

    with pytest.raises(TypeError, match=r"Torn: the band peak is in N shown in kN and in Pa shown in MPa"):
        declare.banded_quantities(Torn)


def test_numbers_of_one_quantity_may_share_the_name_of_a_band():
    @declare.dataclass
    class Both:
        """A force in two digits."""

        force: float = declare.number(Quantity("N", "kN"), "a force", band="peak")
        again: float = declare.number(Quantity("N", "kN", digits=5), "the same quantity", band="peak")

    assert declare.banded_quantities(Both)["peak"].units == ("N", "kN")


def test_a_headline_that_does_not_say_of_which_rows_it_is_is_refused_with_the_fields_that_have_one():
    @declare.dataclass
    class Row:
        """A row with key numbers."""

        peak: float = declare.number(Quantity("N", "kN"), "a force", headline="peak")
        width: float = declare.number(Quantity("s", "us"), "a time")

    with pytest.raises(
        TypeError, match=r'Result.rows: headline is "frist"; allowed: first, each, count, .*Row.*\(peak\)'
    ):

        @declare.dataclass
        class Result:
            """Rows with a typing error."""

            rows: tuple[Row, ...] = declare.rows(Row, "rows", headline="frist")


def test_a_key_with_two_units_is_refused():
    @declare.dataclass
    class Torn:
        """A body whose force is a stress elsewhere."""

        force: float = declare.number(Quantity("Pa", "MPa"), "a stress")
        touches: tuple[Touch, ...] = declare.rows(Touch, "contacts")

    with pytest.raises(TypeError, match=r"force is in Pa and, as touches\[\]\.force, in N"):
        declare.units(Torn)


def test_a_unit_that_the_data_decide_is_said_by_what_gives_it():
    @declare.dataclass
    class Read:
        """A value as it was typed, and more by their names."""

        value: float = declare.number(Quantity.of_data("as the field"), "what was typed")
        more: dict[str, float] = declare.number(Quantity("N", "N"), "by name", inline=True)
        shown: list[str] = declare.table("of no document")

    assert declare.units(Read) == {"value": "as the field"}
    assert [path for path, _ in declare.keys(Read)] == ["value", "*"]
    assert declare.content(Read(1.0, {"a": 2.0, "b": 3.0}, [])) == {"value": 1.0, "a": 2.0, "b": 3.0}


def test_paths_of_keys_lead_through_rows_names_and_parts():
    paths = [path for path, _ in declare.keys(Body)]
    assert paths == [
        *("contacts", "contacts[].begin", "contacts[].force", "first", "first.begin", "first.force"),
        *("other", "other.begin", "other.force", "begin", "force"),
        *("by_name", "by_name.*.begin", "by_name.*.force", "speed", "share"),
    ]


def test_parts_by_their_names_may_stand_among_the_keys_around_them():
    @declare.dataclass
    class Named:
        """Contacts by their names, and one more key."""

        of: dict[str, Touch] = declare.named(Touch, "by their names", inline=True)
        count: int = declare.count("how many")

    @declare.dataclass
    class Outer:
        """Two of them by their names."""

        groups: dict[str, Named] = declare.named(Named, "groups")

    outer = Outer({"a": Named({"x": Touch(1.0, 2.0)}, 1)})
    assert declare.content(outer) == {"groups": {"a": {"x": {"begin": 1.0, "force": 2.0}, "count": 1}}}
    assert [path for path, _ in declare.keys(Outer)] == [
        "groups", "groups.*.*.begin", "groups.*.*.force", "groups.*.count",
    ]  # fmt: skip


def test_docstrings_say_what_fields_declare_once():
    assert Touch.__doc__.count("begin : float\n        when it begins, s.") == 1
    text = Body.__doc__
    assert text.count("Attributes\n") == 1
    assert text.index("hidden : int") < text.index("share : computed\n        share of them that have a force.")
    assert "Heavy" not in text
    assert "begin" not in Heavy.__doc__


def test_what_is_computed_is_computed_once_and_counts_for_no_equality(body):
    calls = []

    @declare.dataclass
    class Counted:
        """A value that is asked for twice."""

        size: float = declare.number(FORCE, "size")

        @declare.computed(declare.number(FORCE, "twice"))
        def twice(self) -> float:
            """Twice the size."""
            calls.append(self.size)
            return 2.0 * self.size

    one, other = Counted(3.0), Counted(3.0)
    assert [one.twice, one.twice] == [6.0, 6.0]
    assert calls == [3.0]
    assert one == other
    assert dataclasses.replace(one, size=4.0).twice == 8.0
    with pytest.raises(dataclasses.FrozenInstanceError):
        one.size = 5.0


def test_what_stands_elsewhere_is_declared_in_a_line():
    @declare.dataclass
    class Outer:
        """A contact with more room."""

        touch: Touch
        force = declare.computed(declare.number(FORCE, "largest force"))(lambda outer: outer.touch.force)

    assert declare.content(Outer(Touch(1.0, 2.0))) == {"force": 2.0}
    assert (Outer.force.name, Outer.force.__doc__) == ("force", "largest force")
    assert "force : computed\n        largest force, N." in Outer.__doc__


def test_declared_values_are_pickled():
    touch = Touch(1.0, 2.0)
    assert pickle.loads(pickle.dumps(touch)) == touch
    assert MAIN > KEY


def test_a_class_that_holds_arrays_may_be_equal_to_itself_alone():
    @declare.dataclass(eq=False)
    class Curve:
        """A history."""

        values: np.ndarray = declare.history("N", "its values")

    one, other = Curve(np.zeros(3)), Curve(np.zeros(3))
    assert one == one
    assert one != other
    assert len({one, other}) == 2
