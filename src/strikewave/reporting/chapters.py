"""The sections that reports of different analyses share: inputs, published numbers, warnings, balances, sources.

Each function takes what it shows and returns one `Section`.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

from pydantic import BaseModel

from strikewave._version import __version__
from strikewave.base.citations import SOURCES
from strikewave.base.command_line import command_line, file_word
from strikewave.base.percents import percent
from strikewave.base.quantities import PROVENANCES, Value
from strikewave.base.result import FAILED, INFO, RUN_PASSED, WARNING, BalanceCheck, failed_words
from strikewave.cases.case import Case, load_case
from strikewave.cases.files import bundled_cases
from strikewave.cases.paths import row_name
from strikewave.cases.written_case import dump_case
from strikewave.reporting.bands import banded_words
from strikewave.reporting.numbers import headed, listed, shown
from strikewave.reporting.page import Head, whole_page
from strikewave.reporting.parts import NONE, Cell, Code, Section, Table, Tag, written

if TYPE_CHECKING:
    from strikewave.base.result import Comparison, Notice, Result, Source


_PROVENANCE_WORDS = {
    "published": "printed in the source that the note names",
    "measured": "read from a measurement",
    "user": "typed or set by the user",
    "inferred": "follows from published or measured numbers, as the note says",
    "assumed": "chosen without a source; the note may say why",
    "fitted": "adjusted until a result met a published number, as the note says",
}

_SEVERITY_LOOKS = {INFO: "", WARNING: "warned", FAILED: "bad"}
"""Look of a notice by its severity."""

_PUBLISHED_WORDS = {
    "first": "first blow",
    "typical": "later full blows, median",
    "count": "number of blows",
    "window": "first to last blow",
    "interval": "interval of the blows, median",
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
    """List every value of a case or a set-up, as typed, with provenance and note; without those of an unused table.

    The tables begin folded away.
    """
    fits = _fits(case) if isinstance(case, Case) else []
    groups = [group for group in input_groups(case) if group[0] != unused]
    quantities = [
        (f"{path}.{key}", entry) for path, _, rows in groups for key, entry in rows if isinstance(entry, Value)
    ]
    counts: list[list[Cell]] = [
        [Tag(p, p), sum(value.provenance == p for _, value in quantities), _PROVENANCE_WORDS.get(p, NONE)]
        for p in PROVENANCES
    ]
    fitted = [f"{path} = {value.typed}" for path, value in quantities if value.provenance == "fitted"]
    text = f"{len(quantities)} values, as they were typed; g is standard gravity. " + (
        f"Fitted: {listed(fitted)}." if fitted else "No value is fitted."
    )
    tables = [Table("Where the values come from", ["provenance", "values", "meaning"], counts), *fits]
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
    return Section("Inputs", text, tables, folded=f"Show {len(quantities)} values with their provenance")


def _fits(case: Case) -> list[Table]:
    """Return a table of what was fitted, to what, and whether it still applies; none where nothing was."""
    stale = {one.field: one for one in case.stale_fits()}
    values = case.values()
    rows: list[list[Cell]] = []
    for fit in case.fit:
        for path in fit.fields:
            if path in values and values[path].provenance == "fitted":
                state = stale[path].since if path in stale else Tag("applies", "good")
                rows.append([path, fit.to or NONE, state])
    return [Table("What was fitted", ["value", "to", "the fit"], rows)] if rows else []


def input_groups(model: BaseModel, path: str = "") -> Iterator[tuple[str, str, list[tuple[str, Any]]]]:
    """Yield path, description and entries of each table of a case; an array of tables is one table.

    A value whose fit no longer applies is assumed, and its note says why.
    """
    model = model.with_stale_fits_assumed() if isinstance(model, Case) else model
    inner: list[tuple[str, str, list[tuple[str, Any]]]] = []
    rows: list[tuple[str, Any]] = []
    for key, entry in model:
        below = f"{path}.{key}" if path else key
        if path and (isinstance(entry, Value) or not isinstance(entry, BaseModel | tuple)):
            rows.append((key, entry))
        elif isinstance(entry, BaseModel) and (path or _quantities(entry)):
            inner += input_groups(entry, below)
        elif isinstance(entry, tuple) and entry and key not in ("published", "fit"):
            inner.append((below, _about(entry[0]), list(_flat(entry, ""))))
    rows = [(key, entry) for key, entry in rows if entry is not None and entry != ""]
    if rows:
        yield path, _about(model), rows
    yield from inner


def _about(table: Any) -> str:
    """Return what the docstring of a table of a case says after its name."""
    first_line = (type(table).__doc__ or "").strip().partition("\n")[0]
    match = re.match(r"\[[^\]]*\]+: (.*?)\.?$", first_line)
    return match[1].replace("``", "") if match else ""


def _flat(part: Any, path: str) -> Iterator[tuple[str, Any]]:
    """Yield all entries below a part of a case, named as their paths are."""
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
    return any(isinstance(entry, Value) for _, entry in _flat(part, ""))


def published(comparisons: Sequence[Comparison]) -> list[Section]:
    """Compare computed values with published ones; nothing where there are none."""
    if not comparisons:
        return []
    rows: list[list[Cell]] = []
    for entry in comparisons:
        which, _, quantity = entry.quantity.partition(".")
        label = _PUBLISHED_WORDS.get(which, which) + (f": {quantity.replace('_', ' ')}" if quantity else "")
        label += f" of {entry.sensor}" if entry.sensor else ""
        values = [
            NONE if v is None or math.isnan(v) else written(shown(v, *entry.measured.units), 6)
            for v in (entry.published, entry.computed)
        ]
        difference = NONE if entry.difference is None else percent(entry.difference, 1, "+")
        origin = entry.measured_or_simulated
        rows.append(
            [headed(label, *entry.measured.units), *values, difference, origin, Tag(entry.role, entry.role), entry.note]
        )
    heads = ["quantity", "published", "computed", "difference", "origin", "role", "note"]
    table = Table("Comparison with published values", heads, rows)
    text = (
        "A fitted value is no evidence, because the case was adjusted to it. A predicted value is evidence. A value "
        "that is only shown cannot be compared; its note says why."
    )
    return [Section("Comparison with published values", text, [table])]


def warnings(notices: Sequence[Notice]) -> Section:
    """List all notices: the value that raised each, its limit, and its case where there are several."""
    of_cases = any(notice.case for notice in notices)
    rows: list[list[Cell]] = [
        [
            *([notice.case] if of_cases else []),
            Tag(notice.code, _SEVERITY_LOOKS[notice.severity]),
            notice.message,
            *(NONE if math.isnan(number) else f"{number:.6g}" for number in (notice.value, notice.limit)),
            Tag("check failed", "bad") if notice.broken else Tag(notice.severity, _SEVERITY_LOOKS[notice.severity]),
        ]
        for notice in notices
    ]
    heads = [*(["case"] if of_cases else []), "code", "message", "value", "limit", "severity"]
    table = Table("Warnings; value and limit in SI units", heads, rows, empty="No warning was raised.")
    return Section("Warnings", "", [table])


def sources(keys: Sequence[str]) -> Section:
    """List the sources of the models used, by their keys."""
    rows: list[list[Cell]] = [[key, SOURCES.get(key, NONE)] for key in keys]
    table = Table("Sources of the models used", ["key", "source"], rows, empty="No source is named.")
    return Section("Sources", "", [table])


def reproduction(result: Result) -> Section:
    """Show how to reproduce the result: the command, the whole text of the inputs, the files that were read."""
    source = result.source
    files: list[list[Cell]] = [[name, digest] for name, digest in source.digests.items()]
    read = [Table("Files read", ["file", "SHA-256"], files)] if files else []
    if not source.whole:
        text = f"This command gives the same numbers again with strikewave {__version__}, from the same files."
        command = [Code(source.asked)] if source.asked else []
        return Section("How to run this again", text if command else "The command is not known.", [*read, *command])
    inputs_text = Code(source.text, f"The whole {source.kind}, {source.file}")
    if source.asked:
        text = f"This command gives the same numbers again with strikewave {__version__}."
        return Section("How to run this again", text, [*read, Code(source.asked), inputs_text])
    names = ([source.name] if _is_published(source) else []) + [source.file]
    either = "Either of these commands" if len(names) > 1 else "This command"
    text = (
        f"{either} gives the same numbers again with strikewave {__version__}; {source.file} is the text below, which "
        f"is also in the folder of this report. The text has the SHA-256 {source.digest}."
    )
    commands = "\n".join(command_line([result.command, file_word(name)]) for name in names)
    return Section("How to run this again", text, [*read, Code(commands), inputs_text])


def _is_published(source: Source) -> bool:
    """Tell whether the inputs are a built-in case without any change."""
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
        Key numbers: label and value with its unit, and in brackets behind it its band.
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
        status=summary.status or status(result),
        summary=[summary.words, *banded_words(result)],
        numbers=summary.numbers,
        foot=f"{source.kind} {source.name or 'without name'}"
        + (f" · SHA-256 of the {sealed} {source.digest}" if source.digest else ""),
        test={key: text for key, text in result.test.items() if isinstance(text, str)},
    )
    return whole_page(head, [*sections, sources(result.citations), reproduction(result)])


def status(result: Result) -> Tag:
    """Return which checks of a result failed, or how many warnings there are, or that all checks passed."""
    if result.own_verdict.status != RUN_PASSED:
        return Tag(result.state, "bad")
    warned = any(notice.severity == WARNING for notice in result.notices)
    return Tag(f"{result.state}, see below", "warned") if warned else Tag(result.state, "good")


def failed_checks(codes: Sequence[str]) -> Tag:
    """Return the status of a result of which some checks failed.

    Examples
    --------
    >>> failed_checks(["energy-balance", "no-blow"]).text
    'checks failed: energy-balance, no-blow'
    """
    return Tag(failed_words(codes), "bad")


def balance_table(checks: Sequence[BalanceCheck]) -> Table:
    """List the balance errors with their limits, and what they are shares of where that is stated."""
    stated = any(check.share_of for check in checks)
    rows: list[list[Cell]] = [
        [
            check.name,
            f"{check.error:.1e}",
            check.limit_text,
            Tag("holds", "good") if check.holds else Tag("broken", "bad"),
            *([check.share_of] if stated else []),
        ]
        for check in checks
    ]
    heads = ["balance", "balance error (share)", "limit", "result", *(["share of"] if stated else [])]
    return Table("Balances", heads, rows, empty="No balance was computed.")
