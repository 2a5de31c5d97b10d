"""Declarations of the values of a result, once where each field stands: unit, label, meaning, places on faces.

A result and its rows are classes decorated with `dataclass`; their fields and computed values have a `Declaration`, and
every face is a walk over these: the JSON document with its units and the documentation of its keys here, tables, key
numbers and columns in `strikewave.reporting.faces`.
"""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Callable, Container, Iterator, Mapping
from typing import Any, Generic, Literal, NamedTuple, TypeVar, dataclass_transform, overload

T = TypeVar("T")
GivenUnits = Mapping[str, "tuple[str, str] | Quantity"]
"""SI unit and unit shown as a rule, by what `Quantity.given_by` says: of numbers whose unit the data decide."""
Kind = Literal["number", "count", "word", "history", "part", "rows", "named", "table"]
NO_UNIT = "1"
"""SI unit of a ratio, which documents name; words and counts have none."""
KEY, MAIN, MORE = 0, 1, 2
"""Priority of a column: it names the row, it matters, it is shown where there is room."""
HEADLINES = ("first", "each", "count")
"""Choices of the rows that give key numbers: see `Declaration`."""
_METADATA = "declaration"
PLACES = {"rows": "[]", "named": ".*", "part": ""}
"""End of the path of a key, before the keys within it: each row of a list, any name, a part."""


class Quantity(NamedTuple):
    """A measured quantity: SI unit ("1" of a ratio), unit shown as a rule, label, decimals in that unit or digits.

    Where no label is given the name of the field is one. Where no decimals are, so many significant digits are shown;
    beside decimals they are the fewest of a cell, and those of a sentence (0: no fewest, and four in a sentence).
    Where the data decide about the unit, ``given_by`` says which it is ("as the field"): the row, or else the result,
    has it among its `given_units`. One that is ``signed`` and has decimals has a plus where it is not below zero.
    """

    si: str
    usual: str
    label: str = ""
    decimals: int | None = None
    digits: int = 4
    given_by: str = ""
    signed: bool = False

    @property
    def units(self) -> tuple[str, str]:
        """SI unit and unit shown as a rule, for numbers, heads and axes: ``headed("peak", *FORCE.units)``."""
        return self.si, self.usual

    @classmethod
    def of_data(cls, given_by: str, label: str = "", decimals: int | None = None, digits: int = 4) -> Quantity:
        """Return a quantity whose unit the data decide.

        Examples
        --------
        >>> Quantity.of_data("as the channel", "peak").within({"as the channel": ("m/s^2", "g")}).usual
        'g'
        """
        return cls("", "", label, decimals, digits, given_by)

    def within(self, given: GivenUnits) -> Quantity:
        """Return it with its unit, where that is among those given; of a whole quantity with its digits too.

        Examples
        --------
        >>> share = Quantity(NO_UNIT, "%", "CV", 2, 0)
        >>> Quantity.of_data("as the number", "median").within({"as the number": share})[1:5]
        ('%', 'median', 2, 0)
        """
        units = given.get(self.given_by)
        if isinstance(units, Quantity):
            return units._replace(label=self.label, given_by=self.given_by)
        return self if units is None else self._replace(si=units[0], usual=units[1])


NOT_MEASURED = Quantity("", "")
"""Quantity of words, and of numbers with the unit of the value that they belong to, such as a warning's limit."""


@dataclasses.dataclass(frozen=True, slots=True, kw_only=True)
class Declaration:
    """The declaration of a value: its kind, meaning and quantity, and its places on faces."""

    kind: Kind
    """Kind: a number; a count; a word or a truth; a history, an array of numbers; a part, rows, or parts by their
    names, all of a declared class; a table, columns that the data decide about."""
    meaning: str
    """Meaning in a phrase, which the documentation of the JSON documents and of the class shows."""
    quantity: Quantity = NOT_MEASURED
    """Quantity of a number or a history; of a part that of all its numbers, where the document says it once; of a word
    that of the numbers in it, such as bounds."""
    key: str = ""
    """Key in the JSON document, and name of its column in files and Python; the name of the field if empty."""
    column: int | None = None
    """Priority of its column in the tables of screen, page, notebook and app: `KEY`, `MAIN`, `MORE` or more. Without
    one it stands in none of them; files and Python have every number."""
    tables: str = ""
    """Names of its tables, where its rows have several; a table that is asked for without a name has all."""
    band: str = ""
    """Name of its band, or its last part; of a part, rows and named parts the first part, such as ``tap.{name}``."""
    headline: str = ""
    """Label among the key numbers, with ``{name}`` of its row; of a part, rows and named parts whether key numbers are
    taken of the "first", of "each", or of so many, such as "3"; "count" is their number. Empty where there are none."""
    is_tag: bool = False
    """True if a word stands in a coloured box, whose colour is its own; of a truth that is wanted, yes is good (of
    another, yes is bad)."""
    order: int = 0
    """Order of the column: those of a larger number stand further to the right than their fields do."""
    in_document: bool = True
    """True if the JSON document holds it; words of a column that it does not hold are in no file either."""
    optional: bool = False
    """True if the document leaves the key out where there is nothing (None), instead of null, and of an inline part all
    keys; Python and files then leave out a column in which no row has anything."""
    inline: bool = False
    """True if the keys of a part, or of parts or numbers by their names, stand among those around it."""
    of: type | None = None
    """Declared class of a part, of rows, of named parts."""
    label: str = ""
    """Label on faces, where neither its quantity nor the name of the field gives one; of a part the text behind the
    labels of its values, such as who gave them."""
    error: str = ""
    """Name of the field beside a share with its standard error: its cell then has both."""
    bounds: str = ""
    """Names of the fields beside it with its bounds at 95 %, such as "low high": a column of them follows its own."""


def _field(declaration: Declaration, default: Any, **rest: Any) -> Any:
    """Return the field of a declaration; a type as its default, such as `dict`, makes each its own."""
    start = {"default_factory": default} if isinstance(default, type) else {"default": default}
    return dataclasses.field(**start, metadata={_METADATA: declaration}, **rest)


def number(quantity: Quantity, meaning: str, *, default: Any = dataclasses.MISSING, **rest: Any) -> Any:
    """Return the field of a number; see `Declaration` for ``rest``.

    Examples
    --------
    >>> @dataclass
    ... class Tap:
    ...     '''A place in a bar.'''
    ...     name: str = word("what it is called", column=KEY)
    ...     peak: float = number(Quantity("m/s^2", "g"), "largest acceleration", column=MAIN)
    >>> content(Tap("mid", 9806.65)), units(Tap)
    ({'name': 'mid', 'peak': 9806.65}, {'peak': 'm/s^2'})
    """
    return _field(Declaration(kind="number", quantity=quantity, meaning=meaning, **rest), default)


def count(meaning: str, *, default: Any = dataclasses.MISSING, **rest: Any) -> Any:
    """Return the field of a whole number of things, or of their order."""
    return _field(Declaration(kind="count", meaning=meaning, **rest), default)


def word(meaning: str, *, default: Any = dataclasses.MISSING, **rest: Any) -> Any:
    """Return the field of a word or a truth, or of what a document holds as it is."""
    return _field(Declaration(kind="word", meaning=meaning, **rest), default)


def history(
    si: str | Quantity, meaning: str, *, usual: str = "", default: Any = dataclasses.MISSING, **rest: Any
) -> Any:
    """Return the field of an array of numbers in an SI unit, shown in a usual one."""
    measured = si if isinstance(si, Quantity) else Quantity(si, usual or si)
    return _field(Declaration(kind="history", quantity=measured, meaning=meaning, **rest), default, repr=False)


def table(meaning: str, *, default: Any = dataclasses.MISSING, **rest: Any) -> Any:
    """Return the field of columns that the data decide about (`reporting.columns.Column`): no document has them."""
    return _field(Declaration(kind="table", meaning=meaning, in_document=False, **rest), default)


def part(of: type, meaning: str, *, default: Any = dataclasses.MISSING, **rest: Any) -> Any:
    """Return the field of a part, which is of a declared class, or None."""
    return _field(Declaration(kind="part", of=of, meaning=meaning, **rest), default)


def rows(of: type, meaning: str, *, default: Any = dataclasses.MISSING, **rest: Any) -> Any:
    """Return the field of rows of a declared class."""
    return _field(Declaration(kind="rows", of=of, meaning=meaning, **rest), default)


def named(of: type, meaning: str, *, default: Any = dataclasses.MISSING, **rest: Any) -> Any:
    """Return the field of parts of a declared class by their names."""
    return _field(Declaration(kind="named", of=of, meaning=meaning, **rest), default)


class ComputedField(Generic[T]):
    """A value that a declared class computes when it is asked for, with its declaration; it is remembered.

    Words and rows that no document holds are not: they may say numbers in units that are chosen later.
    """

    def __init__(self, declaration: Declaration, function: Callable[[Any], T]) -> None:
        self.declaration, self.function = declaration, function
        self.__doc__ = function.__doc__ or declaration.meaning

    def __set_name__(self, owner: type, name: str) -> None:
        """Take the name that it has in its class."""
        self.name = name

    @overload
    def __get__(self, instance: None, owner: type) -> ComputedField[T]: ...
    @overload
    def __get__(self, instance: object, owner: type) -> T: ...
    def __get__(self, instance: object | None, owner: type) -> T | ComputedField[T]:
        """Return the value; of the class itself what declares it."""
        if instance is None:
            return self
        value, declaration = self.function(instance), self.declaration
        if declaration.kind in ("word", "rows") and not declaration.in_document:
            return value
        return vars(instance).setdefault(self.name, value)  # found there before this descriptor, as of cached_property


def computed(field: Any) -> Callable[[Callable[[Any], T]], ComputedField[T]]:
    """Declare a computed value as a field is: ``@computed(number(TIME, "time step"))`` above its method.

    What only stands elsewhere takes one line: ``step = computed(number(TIME, "time step"))(lambda one: one.run.step)``.
    """
    return lambda function: ComputedField(field.metadata[_METADATA], function)


def phrase(label: str, **rest: Any) -> Callable[[Callable[[Any], T]], ComputedField[T]]:
    """Declare words that faces write of several fields, and no document holds; their docstring says what they mean.

    Examples
    --------
    >>> @dataclass
    ... class Span:
    ...     low: float = number(Quantity("s", "us"), "begin")
    ...     @phrase("lasts", column=MAIN)
    ...     def text(self) -> str:
    ...         '''Return from when on.'''
    ...         return f"from {self.low} s"
    >>> Span(2.0).text, content(Span(2.0)), declarations(Span)["text"].meaning
    ('from 2.0 s', {'low': 2.0}, 'from when on')
    """

    def declared(function: Callable[[Any], T]) -> ComputedField[T]:
        meaning = (function.__doc__ or label).removeprefix("Return ").rstrip(".")
        return ComputedField(
            Declaration(kind="word", meaning=meaning, label=label, in_document=False, **rest), function
        )

    return declared


@overload
def dataclass(kind: type[T]) -> type[T]: ...
@overload
def dataclass(*, eq: bool) -> Callable[[type[T]], type[T]]: ...
@dataclass_transform(
    frozen_default=True, field_specifiers=(number, count, word, history, table, part, rows, named, dataclasses.field)
)
def dataclass(kind: type[T] | None = None, *, eq: bool = True) -> type[T] | Callable[[type[T]], type[T]]:
    """Make a frozen dataclass that faces are made of; a field without a declaration stands on none of them.

    With ``eq=False``, for one that holds arrays, it is equal to itself alone.
    """
    return functools.partial(_declared, eq=eq) if kind is None else _declared(kind, eq)


def _declared(kind: type[T], eq: bool) -> type[T]:
    own = {name: value for name, value in vars(kind).items() if isinstance(value, ComputedField | dataclasses.Field)}
    found = {name: one for base in reversed(kind.__mro__[1:]) for name, one in _own(base).items()}
    for name, value in own.items():
        one = value.declaration if isinstance(value, ComputedField) else value.metadata.get(_METADATA)
        if one is not None:
            _check_headline(kind, name, one)
            found[name] = one
    made = dataclasses.dataclass(frozen=True, eq=eq)(kind)
    made.__declarations__ = found  # type: ignore[attr-defined]
    made.__doc__ = _documented(made.__doc__ or "", {name: found[name] for name in own if name in found}, kind)
    return made


def _check_headline(kind: type, name: str, one: Declaration) -> None:
    """Refuse a headline of a part or of rows that does not say of which the key numbers are."""
    if one.of is None or one.headline in ("", *HEADLINES) or one.headline.isdecimal():
        return
    fields = ", ".join(field for field, leaf in declarations(one.of).items() if leaf.headline) or "none yet"
    raise TypeError(
        f'{kind.__name__}.{name}: headline is "{one.headline}"; allowed: {", ".join(HEADLINES)}, or how many rows, '
        f'such as "3": the key numbers are those fields of {one.of.__name__} that have a headline ({fields})'
    )


def _documented(text: str, own: dict[str, Declaration], kind: type) -> str:
    """Return a docstring with what is declared among its attributes, so that it is said once."""
    lines = []
    for name, one in own.items():
        unit = f", {one.quantity.si}" if one.quantity.si not in ("", NO_UNIT) else ""
        of = kind.__annotations__.get(name, "computed")
        lines.append(f"    {name} : {of.__name__ if isinstance(of, type) else of}\n        {one.meaning}{unit}.")
    if not lines:
        return text
    head = [] if "\n    Attributes\n" in text else ["", "    Attributes", "    ----------"]
    return "\n".join([text.rstrip(), *head, *lines, "    "])


def _own(kind: type) -> dict[str, Declaration]:
    found: dict[str, Declaration] = vars(kind).get("__declarations__", {})
    return found


def declarations(kind: type) -> dict[str, Declaration]:
    """Return the declarations of a class by the names of its fields, in their order; none where it is not declared."""
    found: dict[str, Declaration] = getattr(kind, "__declarations__", {})
    return found


def content(value: Any) -> dict[str, Any]:
    """Return the keys of the JSON document of a declared value; `documents.plain` makes them fit for JSON."""
    document: dict[str, Any] = {}
    for name, one in declarations(type(value)).items():
        if not one.in_document:
            continue
        inner = getattr(value, name)
        if one.of is not None and inner is not None:
            if one.kind == "rows":
                inner = [content(row) for row in inner]
            elif one.kind == "named":
                inner = {key: None if row is None else content(row) for key, row in inner.items()}
            elif not isinstance(inner, Mapping):  # a part kept as a dictionary is its own document
                inner = content(inner)
        if one.inline and inner is not None:
            document |= inner
        elif one.inline:
            if one.kind == "part" and one.of is not None and not one.optional:
                leaves = declarations(one.of).items()
                document |= {leaf.key or key: None for key, leaf in leaves if leaf.in_document and not leaf.optional}
        elif inner is not None or not one.optional:
            document[one.key or name] = inner
    return document


def keys(kind: type, path: str = "", apart: Container[type | None] = ()) -> Iterator[tuple[str, Declaration]]:
    """Yield path and declaration of each key of a document: ``[]`` is each row of a list, ``*`` any name.

    Keys within the classes ``apart`` are left out, unless they stand among those around them.
    """
    for name, one in declarations(kind).items():
        if not one.in_document:
            continue
        is_part = one.inline and one.kind == "part"
        here = path if is_part else f"{path}*" if one.inline else f"{path}{one.key or name}"
        if not is_part and (not one.inline or one.of is None or one.of in apart):
            yield here, one
        if one.of is not None and (is_part or one.of not in apart):
            yield from keys(one.of, here if is_part else f"{here}{'' if one.inline else PLACES[one.kind]}.", apart)


@functools.cache
def units(kind: type) -> dict[str, str]:
    """Return the SI unit of each key of the document of a declared class, or `Quantity.given_by` where the data decide.

    The unit of a part is that of the numbers within it, which then have none of their own. A key of two units is a
    `TypeError`.
    """
    found: dict[str, str] = {}
    within: dict[str, str] = {}
    for path, one in keys(kind):
        (place, _, key), si = path.rpartition("."), one.quantity.si or one.quantity.given_by
        if one.of is not None and si:
            within[path + PLACES[one.kind]] = si
        if si and key != "*" and within.get(place) != si and found.setdefault(key, si) != si:
            raise TypeError(f"{kind.__name__}: {key} is in {found[key]} and, as {path}, in {si}: give one another key")
    return found


@functools.cache
def banded_quantities(kind: type) -> dict[str, Quantity]:
    """Return the quantities of numbers that may have a band, by the last part of its name, of a class and those within.

    Numbers of one name that have two units are a `TypeError`.
    """
    found: dict[str, Quantity] = {}
    for one in declarations(kind).values():
        within = banded_quantities(one.of) if one.of is not None else {one.band: one.quantity} if one.band else {}
        for name, quantity in within.items():
            if (first := found.setdefault(name, quantity)).units != quantity.units:
                both = f"{' shown in '.join(first.units)} and in {' shown in '.join(quantity.units)}"
                raise TypeError(f"{kind.__name__}: the band {name} is in {both}: give one another name")
    return found
