"""The sections that reports of different analyses share: inputs, published numbers, warnings, balances, sources.

Each function takes what it shows and returns one `Section`.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

from strikewave._version import __version__
from strikewave.base.result import LEDGER_LIMIT
from strikewave.base.units import in_unit
from strikewave.reporting.numbers import SHOWN_UNITS, listed, spelled
from strikewave.reporting.page import Head, whole_page
from strikewave.reporting.parts import NONE, Cell, Code, Section, Table, Tag, written

if TYPE_CHECKING:
    from pydantic import BaseModel

    from strikewave.base.result import Comparison, Notice, Result, Source
    from strikewave.cases.case import Case


_PROVENANCE_WORDS = {
    "published": "printed in the source that the note names",
    "measured": "read from a measurement",
    "inferred": "follows from published or measured numbers, as the note says",
    "assumed": "chosen without a source; the note may say why",
    "fitted": "adjusted until a result met a published number, as the note says",
}

_PUBLISHED_WORDS = {
    "first": "first blow",
    "typical": "later full blows, median",
    "count": "number of blows",
    "window": "first to last blow",
}


def layer_steps(case: Case) -> list[str]:
    """Return the layers of a stack in their order, with every joint that is not bonded, and the far end."""
    stack = case.stack
    if not stack.layer:
        return []
    joints = {joint.after: joint.kind for joint in stack.joint if joint.kind != "bonded"}
    steps = []
    for layer in stack.layer:
        steps += [layer.name] + ([f"{joints[layer.name]} joint"] if layer.name in joints else [])
    return [*steps, f"{stack.end.kind} end"]


def inputs(case: BaseModel, unused: str = "") -> Section:
    """List every value of a case or a set-up, as typed, with provenance and note; but for those of an unused table."""
    from strikewave.base.quantities import PROVENANCES, Value

    groups = [group for group in _groups(case) if group[0] != unused]
    found = [(f"{path}.{key}", entry) for path, _, rows in groups for key, entry in rows if isinstance(entry, Value)]
    counts: list[list[Cell]] = [
        [Tag(p, p), sum(value.provenance == p for _, value in found), _PROVENANCE_WORDS.get(p, NONE)]
        for p in PROVENANCES
    ]
    fitted = [f"{path} = {value.typed}" for path, value in found if value.provenance == "fitted"]
    text = f"{len(found)} values, as they were typed; g is standard gravity. " + (
        f"Fitted: {listed(fitted)}." if fitted else "No value is fitted."
    )
    tables = [Table("Where the values come from", ["provenance", "values", "meaning"], counts)]
    for path, about, rows in groups:
        shown: list[list[Cell]] = []
        for key, entry in rows:
            if isinstance(entry, Value):
                shown.append([key, str(entry.typed), Tag(entry.provenance, entry.provenance), entry.note or NONE])
            else:
                shown.append([key, str(entry), Tag("choice"), NONE])
        tables.append(
            Table(
                f"[{path}]" + (f": {about}" if about else ""),
                ["input", "value", "provenance", "note"],
                shown,
                empty="No input.",
            )
        )
    return Section("Inputs", text, tables)


def _groups(model: BaseModel, path: str = "") -> Iterator[tuple[str, str, list[tuple[str, Any]]]]:
    """Yield path, description and entries of each table of a case; an array of tables is one table."""
    from pydantic import BaseModel

    from strikewave.base.quantities import Value

    inner: list[tuple[str, str, list[tuple[str, Any]]]] = []
    rows: list[tuple[str, Any]] = []
    for key, entry in model:
        below = f"{path}.{key}" if path else key
        if path and (isinstance(entry, Value) or not isinstance(entry, BaseModel | tuple)):
            rows.append((key, entry))
        elif isinstance(entry, BaseModel) and (path or _quantities(entry)):
            inner += _groups(entry, below)
        elif isinstance(entry, tuple) and entry and key != "published":
            inner.append((below, _about(entry[0]), list(_flat(entry, ""))))
    rows = [(key, entry) for key, entry in rows if entry is not None and entry != ""]
    if rows:
        yield path, _about(model), rows
    yield from inner


def _about(table: Any) -> str:
    """Return what the docstring of a table of a case says after its name."""
    found = re.match(r"\[[^\]]*\]+: (.*?)\.?$", (type(table).__doc__ or "").strip().partition("\n")[0])
    return found[1].replace("``", "") if found else ""


def _flat(part: Any, path: str) -> Iterator[tuple[str, Any]]:
    """Yield all entries below a part of a case, named as their paths are."""
    from pydantic import BaseModel

    from strikewave.base.quantities import Value
    from strikewave.cases.case import row_name

    start = f"{path}." if path else ""
    if isinstance(part, tuple):
        for place, row in enumerate(part):
            yield from _flat(row, f"{start}{row_name(row, place)}")
    elif isinstance(part, BaseModel) and not isinstance(part, Value):
        for key, entry in part:
            if not (path and key in ("name", "after")):  # the path says it
                yield from _flat(entry, f"{start}{key}")
    elif part is not None and part != "":
        yield path, part


def _quantities(part: Any) -> bool:
    from strikewave.base.quantities import Value

    return any(isinstance(entry, Value) for _, entry in _flat(part, ""))


def published(comparisons: Sequence[Comparison]) -> Section:
    """Set published numbers beside computed ones."""
    from strikewave.cases.case import PUBLISHED_QUANTITIES

    rows: list[list[Cell]] = []
    for entry in comparisons:
        si = PUBLISHED_QUANTITIES.get(entry.quantity, "")
        unit = SHOWN_UNITS.get(si, si)
        which, _, quantity = entry.quantity.partition(".")
        words = _PUBLISHED_WORDS.get(which, which) + (f": {quantity.replace('_', ' ')}" if quantity else "")
        words += f" of {entry.sensor}" if entry.sensor else ""
        values = [
            NONE if v is None or math.isnan(v) else written(float(in_unit(v, si, unit)) if si else v, 6)
            for v in (entry.published, entry.computed)
        ]
        difference = NONE if entry.difference is None else f"{100.0 * entry.difference:+.1f} %"
        unit = f" ({spelled(unit)})" if unit else ""
        rows.append(
            [words + unit, *values, difference, entry.measured_or_simulated, Tag(entry.role, entry.role), entry.note]
        )
    heads = ["quantity", "published", "computed", "difference", "origin", "role", "note"]
    table = Table("Published beside computed", heads, rows, empty="The case names no published number.")
    text = (
        "A fitted number is no evidence: the case was adjusted to it. A predicted one is. One that is only shown "
        "cannot be compared; its note says why."
    )
    return Section("Published beside computed", text if rows else "", [table])


def warnings(notices: Sequence[Notice]) -> Section:
    """List what the user should know, with the number that raised it, its limit, and the case if there are several."""
    of_cases = any(notice.case for notice in notices)
    rows: list[list[Cell]] = [
        [
            *([notice.case] if of_cases else []),
            Tag(notice.code, "bad" if notice.broken else "warned"),
            notice.message,
            *(NONE if math.isnan(number) else f"{number:.6g}" for number in (notice.value, notice.limit)),
            Tag("limit broken", "bad") if notice.broken else Tag("info"),
        ]
        for notice in notices
    ]
    heads = [*(["case"] if of_cases else []), "code", "message", "number", "limit", "severity"]
    table = Table("Warnings; number and limit in SI units", heads, rows, empty="No warning was raised.")
    return Section("Warnings", "", [table])


def sources(keys: Sequence[str]) -> Section:
    """List the sources of the models used, by their keys."""
    from strikewave.base.citations import SOURCES

    rows: list[list[Cell]] = [[key, SOURCES.get(key, NONE)] for key in keys]
    table = Table("Sources of the models used", ["key", "source"], rows, empty="No source is named.")
    return Section("Sources", "", [table])


def reproduction(result: Result) -> Section:
    """Say how the same numbers come again: the command, the whole text of the inputs, the files that were read."""
    source = result.source
    files: list[list[Cell]] = [[name, digest] for name, digest in source.digests.items()]
    read = [Table("Files read", ["file", "SHA-256"], files)] if files else []
    if not source.whole:
        words = f"This command gives the same numbers again with strikewave {__version__}, from the same files."
        asked = [Code(source.asked)] if source.asked else []
        return Section("How to run this again", words if asked else "The command is not known.", [*read, *asked])
    names = ([source.name] if _is_published(source) else []) + [source.file]
    either = "Either of these commands" if len(names) > 1 else "This command"
    words = (
        f"{either} gives the same numbers again with strikewave {__version__}; {source.file} is the text below, which "
        f"also lies beside this report. The text has the SHA-256 {source.digest}."
    )
    commands = "\n".join(f"strikewave {result.command} {name}" for name in names)
    text = Code(source.text, f"The whole {source.kind}, {source.file}")
    return Section("How to run this again", words, [*read, Code(commands), text])


def _is_published(source: Source) -> bool:
    """Tell whether the inputs are a bundled case without any change."""
    from strikewave.cases.case import bundled_cases, dump_case, load_case

    return source.name in bundled_cases() and dump_case(load_case(source.name)) == source.text


class Summary(NamedTuple):
    """What stands above the sections of a page.

    Attributes
    ----------
    kicker : str
        What kind of report it is.
    words : str
        What happened.
    numbers : sequence of (str, str)
        Key numbers: label and value with its unit.
    status : Tag or None
        How it went, where that is more than what `status` says of the notices.
    """

    kicker: str
    words: str
    numbers: Sequence[tuple[str, str]] = ()
    status: Tag | None = None


def result_page(result: Result, summary: Summary, sections: Sequence[Section]) -> str:
    """Return the page of a result: its head, its sections, sources, and how to run it again."""
    source = result.source
    sealed = f"{source.kind} text" if source.whole else "files, taken together,"
    head = Head(
        title=result.title,
        kicker=summary.kicker,
        subject=source.kind.capitalize(),
        name=source.name,
        digest=source.digest,
        status=summary.status or status(result.notices),
        summary=summary.words,
        numbers=summary.numbers,
        foot=f"{source.kind} {source.name or 'without name'}"
        + (f" · SHA-256 of the {sealed} {source.digest}" if source.digest else ""),
    )
    return whole_page(head, [*sections, sources(result.citations), reproduction(result)])


def status(notices: Sequence[Notice]) -> Tag:
    """Say whether a stated limit is broken, and how many warnings there are."""
    broken = [notice.code for notice in notices if notice.broken]
    if broken:
        return Tag(f"stated limit broken: {listed(broken)}", "bad")
    many = len(notices)
    warned = f"; {many} warning{'s' if many > 1 else ''}, see below" if many else ""
    return Tag(f"no stated limit broken{warned}", "warned" if many else "good")


def ledger_table(ledger: Mapping[str, float]) -> Table:
    """List the errors of a ledger beside their limit."""
    rows: list[list[Cell]] = [
        [
            name.removesuffix("_error"),
            f"{error:.1e}",
            f"{LEDGER_LIMIT:.0e}",
            Tag("closes", "good") if error <= LEDGER_LIMIT else Tag("broken", "bad"),
        ]
        for name, error in ledger.items()
    ]
    return Table("Ledgers", ["ledger", "error, share", "limit", "result"], rows, empty="No ledger was kept.")
