"""A report: its page, pictures in it, and the sections that reports of different analyses share.

A matplotlib figure as an SVG element that stands in an HTML page among others. Text stays text (``svg.fonttype``
none): it can be searched and copied, stays sharp at any size, shows letters that matplotlib's font lacks, and a
picture takes half the room. matplotlib sets DejaVu Sans; where that is absent, Verdana has nearly the same widths and
any other face is narrower, so nothing runs into anything, and anchors keep centred labels centred.

The page: head and sections in, HTML text out. Everything on it is a `Section`; the template knows four kinds of parts
and nothing of machines.
"""

from __future__ import annotations

import functools
import io
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from html import unescape
from importlib import resources
from typing import TYPE_CHECKING, Any, NamedTuple
from warnings import catch_warnings, filterwarnings
from xml.etree import ElementTree

from pydantic import BaseModel

from strikewave._version import __version__
from strikewave.base import texts
from strikewave.base.citations import SOURCES
from strikewave.base.quantities import PROVENANCES, Value
from strikewave.base.result import (
    FAILED,
    INFO,
    RUN_PASSED,
    WARNING,
    BalanceCheck,
    Comparison,
    Notice,
    Result,
    failed_words,
)
from strikewave.base.texts import command_line, file_word, percent
from strikewave.cases.case import Case, dump_case, load_case
from strikewave.cases.files import bundled_cases
from strikewave.cases.paths import row_name
from strikewave.reporting.bands import banded_words
from strikewave.reporting.layout import tokens
from strikewave.reporting.numbers import NO_BREAK, headed, in_shown_units, listed, shown
from strikewave.reporting.parts import NONE, Cell, Code, Formula, Photo, Picture, Section, Table, Tag, written

if TYPE_CHECKING:
    from jinja2 import Template
    from matplotlib.figure import Figure

WIDEST_SHARED = 5.5  # a page is 9.8 inches wide: two of them stand side by side
"""Width of a figure, inches, up to which it shares its line with the next."""
LONGEST_WHOLE = 16  # words of English and names of most files are shorter
"""Letters of the longest word of a table that no line ever breaks."""


@dataclass(frozen=True)
class Head:
    """Content above the sections of a page."""

    title: str
    kicker: str
    """Kind of report."""
    subject: str
    """Kind of input that was run or read, such as ``Case``."""
    name: str
    """Name of the input."""
    digest: str
    """SHA-256 of the input; empty where there is none."""
    status: Tag
    summary: Sequence[str]
    """Summary of the result, in paragraphs."""
    numbers: Sequence[tuple[str, str]]
    """Key numbers: label and value with its unit; a band in brackets behind it is set smaller."""
    foot: str
    test: Mapping[str, str] = field(default_factory=dict)
    """Statements about the test, by the keys of the table [test]."""


def whole_page(head: Head, sections: Sequence[Section]) -> str:
    """Return a page: its head, a summary, the sections in their order."""
    from markupsafe import Markup

    css = Markup((resources.files("strikewave.reporting") / "style.css").read_text("utf-8"))  # our own, no input
    page = _template().render(vars(head), version=__version__, css=css, sections=list(_numbered(sections)))
    return texts.shown(page)


@functools.cache
def _template() -> Template:
    from jinja2 import Environment, FunctionLoader, StrictUndefined

    folder = resources.files("strikewave.reporting")
    environment = Environment(
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        finalize=_finalized,
        loader=FunctionLoader(lambda name: (folder / name).read_text("utf-8")),
    )
    environment.filters["mathml"] = _mathml
    environment.filters["unbroken"] = _unbroken
    environment.tests["long"] = _long
    return environment.get_template("template.html")


def _finalized(value: Any) -> Any:
    """Return the value of an expression of the template, quantities of a text in the units that are shown."""
    return in_shown_units(value) if type(value) is str else value  # markup is finished


def _unbroken(text: str) -> Any:
    """Return a text in which no line ends between a number and its unit."""
    from markupsafe import Markup, escape

    return Markup(" ").join(escape(token.replace(" ", NO_BREAK)) for token in tokens(in_shown_units(text)))


def _long(value: object) -> bool:
    """Tell whether a cell has a word that would make its column too wide: a path, a checksum; such words may be broken.

    Examples
    --------
    >>> _long("impact_02.lvm, blow 1"), _long("measurements/2026/impact_02.lvm")
    (False, True)
    """
    return isinstance(value, str) and max(map(len, value.split()), default=0) > LONGEST_WHOLE


def _mathml(formula: Formula) -> Any:
    """Return an equation as an element that browsers typeset, without any script or font of ours."""
    from latex2mathml.converter import convert_to_element
    from markupsafe import Markup

    element = convert_to_element(formula.tex, display="block")
    for inner in element.iter():
        inner.text = unescape(inner.text or "") or None  # the library writes letters as entities
    element.set("alttext", formula.text)
    element.set("data-tex", formula.tex)  # for what cannot set MathML: PDF
    return Markup(ElementTree.tostring(element, encoding="unicode"))  # what a formula holds is escaped there


def _numbered(listing: Sequence[Section]) -> Iterator[dict[str, Any]]:
    """Yield the blocks of each section for the template: tables and pictures are counted through the whole page."""
    from markupsafe import Markup

    count = {"table": 0, "picture": 0}
    for place, section in enumerate(listing, 1):
        blocks: list[dict[str, Any]] = []
        for part in section.parts:
            if part.kind in count:
                count[part.kind] += 1
            block: dict[str, Any] = {"kind": part.kind, "part": part, "number": count.get(part.kind, 0)}
            if isinstance(part, Picture | Photo):
                if isinstance(part, Photo):
                    drawn, wide = Markup('<img src="{}" alt="{}">').format(part.address, part.caption), False
                else:
                    drawn = Markup(inline_svg(part.figure, f"p{count['picture']}", part.label or part.caption))
                    wide = part.figure.get_figwidth() > WIDEST_SHARED
                block = {**block, "kind": "pictures", "shown": [{**block, "drawn": drawn, "wide": wide}]}
                if blocks and blocks[-1]["kind"] == "pictures":
                    blocks[-1]["shown"] += block["shown"]
                    continue
            blocks.append(block)
        paragraphs = section.paragraphs()
        yield {**vars(section), "id": f"section-{place}", "paragraphs": paragraphs, "blocks": blocks}


_SETTINGS: dict[Any, Any] = {
    "svg.fonttype": "none",
    "svg.hashsalt": "strikewave",
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans", "Verdana", "Arial", "sans-serif"],
}
_LONG_FRACTION = re.compile(r"-?\d+\.\d{3,}")
_NAMED = re.compile(r"url\(#([^)]+)\)")


def inline_svg(figure: Figure, name: str, label: str = "") -> str:
    """Return a figure as an ``svg`` element: no prolog, no metadata, every identifier begins with ``name``.

    The name is unique in the page: clip paths and markers of several pictures would share their names otherwise. The
    same figure gives the same text; ``label`` stands for the picture where a reader cannot see it.
    """
    import matplotlib

    buffer = io.StringIO()
    with matplotlib.rc_context(_SETTINGS), catch_warnings():
        filterwarnings("ignore", "Glyph .* missing")  # the browser has a font for it
        no_metadata = dict.fromkeys(("Creator", "Date", "Format", "Type"))
        figure.savefig(buffer, format="svg", metadata=no_metadata)
    root = ElementTree.fromstring(texts.shown(buffer.getvalue()))
    _tidy(root, name)
    box, width = root.get("viewBox", ""), figure.get_figwidth() * 96.0
    style = f"max-width:{width:.0f}px;stroke-linejoin:round;stroke-linecap:butt"
    root.attrib.clear()
    root.attrib.update({"viewBox": box, "role": "img", "aria-label": label, "style": style})
    return ElementTree.tostring(root, encoding="unicode")


def _tidy(root: ElementTree.Element, name: str) -> None:
    """Drop namespaces, metadata, style sheets, unused names and needless digits; give all names a prefix."""
    used = set()
    for element in root.iter():
        for key, value in list(element.attrib.items()):
            plain = key.rpartition("}")[2]
            if plain != key:
                element.attrib[plain] = element.attrib.pop(key)
            used.update(_NAMED.findall(value))
            if plain == "href" and value.startswith("#"):
                used.add(value[1:])
        element.tag = element.tag.rpartition("}")[2]
    for parent in list(root.iter()):
        for child in list(parent):
            if child.tag in ("metadata", "style"):
                parent.remove(child)
        if parent.text and not parent.text.strip() and parent.tag not in ("text", "tspan"):
            parent.text = None
        parent.tail = (
            parent.tail.strip() or None if parent.tail and parent.tag not in ("text", "tspan") else parent.tail
        )
    for element in root.iter():
        for key, value in list(element.attrib.items()):
            if key == "id":
                if value in used:
                    element.set("id", f"{name}-{value}")
                else:
                    del element.attrib["id"]
            elif key == "href" and value.startswith("#"):
                element.set(key, f"#{name}-{value[1:]}")
            elif key in ("d", "x", "y", "transform", "points"):
                element.set(key, _LONG_FRACTION.sub(_short, " ".join(value.split())))
            elif "url(#" in value:
                element.set(key, _NAMED.sub(rf"url(#{name}-\1)", value))


def _short(number: re.Match[str]) -> str:
    """Return a number with two decimals at most: a hundredth of a point cannot be seen."""
    return f"{float(number[0]):.2f}".rstrip("0").rstrip(".")


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
        [Tag(p, p), sum([value.provenance == p for _, value in quantities]), _PROVENANCE_WORDS.get(p, NONE)]
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
        caption = f"[{path}]" + (f": {about}" if about else "")
        tables.append(Table(caption, ["input", "value", "provenance", "note"], shown, empty="No input."))
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
        elif isinstance(entry, BaseModel) and (path or any(isinstance(part, Value) for _, part in _flat(entry, ""))):
            inner += input_groups(entry, below)
        elif isinstance(entry, tuple) and entry and key not in ("published", "fit"):
            inner.append((below, _about(entry[0]), list(_flat(entry, ""))))
    rows = [(key, entry) for key, entry in rows if entry is not None and entry != ""]
    if rows:
        yield path, _about(model), rows
    yield from inner


def _about(table: Any) -> str:
    """Return the words of the docstring of a table of a case behind its name."""
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
    is_built_in = source.name in bundled_cases() and dump_case(load_case(source.name)) == source.text
    names = ([source.name] if is_built_in else []) + [source.file]
    either = "Either of these commands" if len(names) > 1 else "This command"
    text = (
        f"{either} gives the same numbers again with strikewave {__version__}; {source.file} is the text below, which "
        f"is also in the folder of this report. The text has the SHA-256 {source.digest}."
    )
    commands = "\n".join(command_line([result.command, file_word(name)]) for name in names)
    return Section("How to run this again", text, [*read, Code(commands), inputs_text])


class Summary(NamedTuple):
    """Summary of a result above the sections of its page; a status of its own replaces that of the notices."""

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
    warned = WARNING in [notice.severity for notice in result.notices]
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


def plain_page(
    result: Result, numbers: Sequence[tuple[str, str]], figure: Figure | None, heads: list[str], rows: list[list[str]]
) -> str:
    """Return the page of a result that has none of its own: key numbers, picture, main table."""
    parts: list[Picture | Table] = [] if figure is None else [Picture(figure, result.title)]
    parts += [Table("The main table", heads, rows)] if heads else []
    summary = Summary(f"Report of {result.command}", "", numbers)
    return result_page(result, summary, [Section("Result", "", parts), warnings(result.notices)])
