"""The page: head and sections in, HTML text out.

Everything on it is a `Section`; the template knows four kinds of parts and nothing of machines.
"""

from __future__ import annotations

import functools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from html import unescape
from importlib import resources
from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree

from strikewave._version import __version__
from strikewave.base import control_characters
from strikewave.reporting.layout import tokens
from strikewave.reporting.numbers import NO_BREAK, in_shown_units
from strikewave.reporting.parts import Formula, Photo, Picture, Section, Tag

if TYPE_CHECKING:
    from jinja2 import Template


WIDEST_SHARED = 5.5
"""Width of a figure, inches, up to which it shares its line with the next: a page is 9.8 wide."""
LONGEST_WHOLE = 16
"""Letters of the longest word of a table that no line ever breaks: words of English, names of most files."""


@dataclass(frozen=True)
class Head:
    """What stands above the sections of a page.

    Attributes
    ----------
    title : str
        Of the page.
    kicker : str
        What kind of report it is.
    subject, name : str
        What was run or read, such as ``Case``, and what it is called.
    digest : str
        SHA-256 of it; empty where there is none.
    status : Tag
        How it went.
    summary : sequence of str
        What happened, in paragraphs.
    numbers : sequence of (str, str)
        Key numbers: label and value with its unit; what stands in brackets behind it, such as its band, is set smaller.
    foot : str
        What the foot of the page says.
    test : mapping of str to str
        What is stated of the test, by the keys of the table [test].
    """

    title: str
    kicker: str
    subject: str
    name: str
    digest: str
    status: Tag
    summary: Sequence[str]
    numbers: Sequence[tuple[str, str]]
    foot: str
    test: Mapping[str, str] = field(default_factory=dict)


def whole_page(head: Head, sections: Sequence[Section]) -> str:
    """Return a page: its head, a summary, the sections in their order."""
    page = _template().render(vars(head), version=__version__, css=_css(), sections=list(_numbered(sections)))
    return control_characters.shown(page)


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
    """Return what an expression of the template gives, a text with its quantities in the units that are shown."""
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
    return isinstance(value, str) and any(len(word) > LONGEST_WHOLE for word in value.split())


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


def _css() -> Any:
    from markupsafe import Markup

    return Markup((resources.files("strikewave.reporting") / "style.css").read_text("utf-8"))  # our own, no input


def _numbered(listing: Sequence[Section]) -> Iterator[dict[str, Any]]:
    """Yield what the template shows of each section: tables and pictures are counted through the whole page."""
    from markupsafe import Markup

    from strikewave.reporting.inline import inline_svg

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
        shown = {
            "title": section.title,
            "paragraphs": section.paragraphs(),
            "folded": section.folded,
            "alone": section.alone,
        }
        yield {"id": f"section-{place}", **shown, "blocks": blocks}
