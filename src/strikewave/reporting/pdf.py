"""A report as PDF: the page as print has it, on numbered sheets, set by WeasyPrint (the extra ``pdf``).

Nothing is fetched, whatever the page names: fonts are those that matplotlib brings, so that sheets look alike on every
machine, and the same page gives the same bytes.
"""

from __future__ import annotations

import contextlib
import functools
import io
import re
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal
from xml.etree import ElementTree

from strikewave.base.errors import InputErrors, MissingPackageError

if TYPE_CHECKING:
    from matplotlib.ft2font import FT2Font

Paper = Literal["A4", "letter"]
_SHEETS = {"A4": (210.0, 297.0), "letter": (215.9, 279.4)}
"""Width and height, mm."""
_SIDE = 13.0  # as in style.css
"""Margin at the left and at the right, mm."""
_CELL_PADDING = 2.3
"""Padding of a cell, both sides and the line, mm."""
_LARGEST, _SMALLEST_UPRIGHT, _SMALLEST = 7.6, 5.8, 4.4  # as in style.css; chosen: read with ease; read at all
"""Letters of a table, points: below the second it gets a sheet across, below the third words break."""
_LONGEST_WORD = 16.0  # words of English are shorter; hashes and paths may break
"""Length of words in a column of words, ems, that do not break."""
_TALLEST = 0.7  # head and caption stand on the same sheet
"""Height of a picture, in heights of a sheet, at most."""
_LONGEST_UNIT = 12  # longer brackets hold words, which may break
"""Letters of a unit that stays on one line."""
_OPTION = re.compile(r"(--[a-z][\w-]*)")
_POINT = 25.4 / 72.0
_SVG = "{http://www.w3.org/2000/svg}"
_MATH = "{http://www.w3.org/1998/Math/MathML}math"
_LETTERS = 10.0
"""Size at which an equation is drawn, points; it scales with the letters beside it."""
_FONTS = {
    "DejaVuSans.ttf": ("DejaVu Sans", "normal", "normal"),
    "DejaVuSans-Bold.ttf": ("DejaVu Sans", "bold", "normal"),
    "DejaVuSans-Oblique.ttf": ("DejaVu Sans", "normal", "italic"),
    "DejaVuSansMono.ttf": ("DejaVu Sans Mono", "normal", "normal"),
}
_OWN = "report-font:"
_NEEDED = "Debian, Ubuntu: apt-get install libpango-1.0-0 libpangoft2-1.0-0 libharfbuzz-subset0"


def check_pdf(field: str, word: str) -> None:
    """Refuse an option where PDF cannot be written."""
    try:
        with contextlib.redirect_stdout(io.StringIO()):  # what it says there would spoil a JSON document
            import weasyprint  # noqa: F401
    except ImportError:
        raise MissingPackageError(field, "WeasyPrint", "pdf") from None
    except OSError:
        raise InputErrors([f"{field} needs the library Pango: {_NEEDED}"]) from None


def write_pdf(page: Path, paper: Paper) -> str:
    """Write the PDF of a report beside it, and return the name of the file."""
    place = page.with_suffix(".pdf")
    place.write_bytes(pdf_of(page.read_text("utf-8"), paper))
    return place.name


def pdf_of(page: str, paper: Paper) -> bytes:
    """Return the HTML of a page of `strikewave.reporting.chapters` as PDF."""
    from weasyprint import HTML

    width, height = _SHEETS[paper]
    document = HTML(string=page, url_fetcher=_fetcher())
    root = document.etree_element
    _draw_equations(root)
    _keep_options_whole(root)
    for picture in root.iter(f"{_SVG}svg"):
        _lower(picture, _TALLEST * height)
    for table in root.iter("table"):
        _keep_units_whole(table)
        _fit(table, width - 2.0 * _SIDE, height - 2.0 * _SIDE)
    head = root.find("head")
    own = ElementTree.SubElement(root if head is None else head, "style")
    own.text = _sheets(paper)
    with _quiet():
        return bytes(document.write_pdf(pdf_identifier=None, pdf_version="1.7"))


def _sheets(paper: Paper) -> str:
    """Return the style of the sheets, behind that of the page."""
    faces = "".join(
        f'@font-face {{ font-family: "{family}"; font-weight: {weight}; font-style: {style}; '
        f'src: url("{_OWN}{file}"); }}\n'
        for file, (family, weight, style) in _FONTS.items()
    )
    return f"""{faces}
@page {{
  size: {paper}; margin: 15mm {_SIDE}mm 17mm;
  font: 7pt "DejaVu Sans"; color: #4d5760;
  @bottom-left {{ content: string(title); width: 82%; vertical-align: top; padding-top: 4mm; }}
  @bottom-right {{
    content: "page " counter(page) " of " counter(pages); width: 18%; vertical-align: top; padding-top: 4mm;
  }}
}}
@page across {{ size: {paper} landscape; }}
html {{ font-size: 9.5pt; }}
body {{ font-family: "DejaVu Sans"; }}
pre, code {{ font-family: "DejaVu Sans Mono"; }}
h1 {{ string-set: title content(); }}
.across {{ page: across; }}
.scroll {{ border: 0; }}
.whole {{ white-space: nowrap; }}
.pictures {{ display: block; }}
.picture {{ display: inline-block; width: 49%; vertical-align: top; }}
.picture.wide {{ display: block; width: auto; }}
.signatures li {{ display: block; }}
.signed {{ display: inline-block; width: 58%; margin-right: 4%; padding-top: 13mm; }}
.signed.day {{ width: 34%; margin-right: 0; }}
.flow ol {{ display: block; }}
.flow li {{ display: inline-block; margin-bottom: 1.5mm; }}
.words td:not(.number) {{ overflow-wrap: break-word; min-width: 0; }}
.words td.long {{ overflow-wrap: anywhere; }}
.broken th, .broken td, .broken td:not(.number) {{ white-space: normal; overflow-wrap: anywhere; min-width: 0; }}
.equation {{ display: inline-block; }}
.equation svg {{ display: block; }}
"""


def _fetcher() -> Any:
    """Return a fetcher that gives our fonts and data within the page to WeasyPrint, and refuses everything else."""
    from matplotlib import get_data_path
    from weasyprint.urls import URLFetcher, URLFetcherResponse

    class OwnFiles(URLFetcher):  # type: ignore[misc,unused-ignore]
        """Fetches nothing from outside the page."""

        def fetch(self, url: str, headers: dict[str, str] | None = None) -> Any:
            """Return a font of ours, or data that the page holds itself."""
            name = url.removeprefix(_OWN)
            if url.startswith(_OWN) and name in _FONTS:
                font = (Path(get_data_path()) / "fonts" / "ttf" / name).read_bytes()
                return URLFetcherResponse(url, font, {"Content-Type": "font/ttf"})
            return super().fetch(url, headers)

    return OwnFiles(allowed_protocols=("data",), allow_redirects=False)


@contextlib.contextmanager
def _quiet() -> Iterator[None]:
    """Keep WeasyPrint and fontTools from saying which properties for screens they leave out."""
    import logging

    loggers = [logging.getLogger(name) for name in ("weasyprint", "fontTools")]
    levels = [logger.level for logger in loggers]
    for logger in loggers:
        logger.setLevel(logging.CRITICAL + 1)
    try:
        yield
    finally:
        for logger, level in zip(loggers, levels, strict=True):
            logger.setLevel(level)


def _draw_equations(root: ElementTree.Element) -> None:
    """Put a drawing in the place of every equation of MathML, which WeasyPrint would write as a row of letters."""
    for parent in list(root.iter()):
        for place, child in enumerate(list(parent)):
            if child.tag == _MATH:
                drawn = _equation(child.get("data-tex", ""), child.get("alttext", ""))
                drawn.tail = child.tail
                parent[place] = drawn


def _equation(tex: str, words: str) -> ElementTree.Element:
    r"""Return an equation as a drawing, or in words where matplotlib cannot set it.

    Examples
    --------
    >>> drawn = _equation(r"F = K \delta^n", "F = K d^n")
    >>> drawn[0].get("aria-label"), drawn[0].get("style")
    ('F = K d^n', 'width:3.33em;height:0.75em')
    >>> _equation(r"\unknown", "in words").text
    'in words'
    """
    box = ElementTree.Element("span", {"class": "equation"})
    try:
        lines = [_line(line) for line in _lines(tex)]
    except ValueError:
        lines = []
    if not lines:
        box.text = words
        return box
    gap = 0.4 * _LETTERS
    width, height = max(line[1] for line in lines), sum(line[2] + gap for line in lines) - gap
    size = f"width:{width / _LETTERS:.2f}em;height:{height / _LETTERS:.2f}em"
    look = {"viewBox": f"0 0 {width:.2f} {height:.2f}", "style": size, "role": "img", "aria-label": words}
    drawing = ElementTree.SubElement(box, f"{_SVG}svg", look)
    top = 0.0
    for d, _, tall, depth in lines:
        place = f"translate(0 {top + tall - depth:.2f}) scale(1 -1)"
        ElementTree.SubElement(drawing, f"{_SVG}path", {"d": d, "transform": place})
        top += tall + gap
    return box


def _lines(tex: str) -> list[str]:
    r"""Return the lines of an equation, in words that matplotlib knows.

    Examples
    --------
    >>> _lines(r"\begin{array}{l} a \le b, \\ c \end{array}")
    ['a \\leq b,', 'c']
    """
    body = tex.strip()
    if body.startswith(r"\begin{array}{l}"):
        body = body.removeprefix(r"\begin{array}{l}").removesuffix(r"\end{array}")
    body = body.replace(r"\le ", r"\leq ").replace(r"\frac", r"\dfrac")  # numerators as large as what stands beside
    return [line.strip() for line in body.split(r"\\") if line.strip()]


def _line(tex: str) -> tuple[str, float, float, float]:
    """Return the outline of a line of an equation, its width, its height in all, and the depth of that, points."""
    from matplotlib.font_manager import FontProperties
    from matplotlib.textpath import TextPath, text_to_path

    font, words = FontProperties(family="DejaVu Sans", math_fontfamily="stix", size=_LETTERS), f"${tex}$"
    path = TextPath((0.0, 0.0), words, prop=font)
    width, height, depth = text_to_path.get_text_width_height_descent(words, font, ismath=True)
    letters = {1: "M", 2: "L", 3: "Q", 4: "C", 79: "Z"}
    parts = [
        letters[int(code)] + ("" if code == 79 else " ".join(f"{value:.2f}" for value in points))
        for points, code in path.iter_segments(simplify=False, curves=True)
    ]
    return "".join(parts), float(width), float(height), float(depth)


def _fit(table: ElementTree.Element, upright: float, across: float) -> None:
    """Set a table in letters in which no word of it breaks, on a sheet across where they would be too small upright.

    ``upright`` and ``across`` are the widths that sheets have for it, mm.
    """
    ems: list[float] = []
    for row in table.iter("tr"):
        for place, cell in enumerate(row):
            ems += [0.0] * (place + 1 - len(ems))
            ems[place] = max(ems[place], _least_width(cell, row))
    padding, needed = _CELL_PADDING * len(ems), sum(ems)
    if not needed:
        return

    def letters(width: float) -> float:
        return min(_LARGEST, (width - padding) / (needed * _POINT))

    size, looks = letters(upright), table.get("class", "").split()
    if size < _SMALLEST_UPRIGHT:
        size = letters(across)
        looks.append("across")
    if size < _SMALLEST:
        size = _SMALLEST
        looks.append("broken")
    table.set("class", " ".join(looks))
    table.set("style", f"font-size:{size:.2f}pt")


def _lower(picture: ElementTree.Element, tallest: float) -> None:
    """Keep a picture from growing taller than ``tallest``, mm: it stands on one sheet with its head and caption."""
    _, _, width, height = (float(number) for number in picture.get("viewBox", "0 0 0 0").split())
    if height and picture.get("role") == "img":
        widest = min(width * _POINT, tallest * width / height)
        picture.set("style", f"{picture.get('style', '')};max-width:{widest:.1f}mm")


def _keep_units_whole(table: ElementTree.Element) -> None:
    """Keep a unit in brackets at the end of a head on one line: (m/s) may break behind its stroke otherwise."""
    for head in table.iterfind("thead/tr/th"):
        name, bracket, unit = (head.text or "").rpartition("(")
        if bracket and not len(head) and len(unit) <= _LONGEST_UNIT:
            head.text = name
            ElementTree.SubElement(head, "span", {"class": "whole"}).text = bracket + unit


def _keep_options_whole(root: ElementTree.Element) -> None:
    """Keep an option such as --uncertainty on one line: it may break behind its strokes otherwise.

    Examples
    --------
    >>> cell = ElementTree.fromstring("<td>named by <b>it</b> (--cross-axis)</td>")
    >>> _keep_options_whole(cell)
    >>> ElementTree.tostring(cell, "unicode")
    '<td>named by <b>it</b> (<span class="whole">--cross-axis</span>)</td>'
    """
    for parent in list(root.iter()):
        if not isinstance(parent.tag, str) or parent.tag in ("style", "script", "title") or "}" in parent.tag:
            continue
        texts = [parent.text, *(child.tail for child in parent)]
        for place in range(len(texts) - 1, -1, -1):
            first, *rest = _OPTION.split(texts[place] or "")
            if not rest:
                continue
            spans = []
            for option, tail in zip(rest[::2], rest[1::2], strict=True):
                span = ElementTree.Element("span", {"class": "whole"})
                span.text, span.tail = option, tail
                spans.append(span)
            if place:
                parent[place - 1].tail = first
            else:
                parent.text = first
            parent[place:place] = spans


def _least_width(cell: ElementTree.Element, row: ElementTree.Element) -> float:
    """Return the width of the longest part of a cell that may not break, ems."""
    equations = [box[0].get("style", "") for box in cell.iter("span") if box.get("class") == "equation" and len(box)]
    if equations:  # a picture shrinks with its column, an equation does not
        return 1.1 * max(float(style.split("width:")[1].split("em")[0]) for style in equations)
    looks, head = cell.get("class", "").split(), all(other.tag == "th" for other in row)
    words = " ".join("".join(cell.itertext()).split())
    tags = [inner for inner in cell.iter("span") if "tag" in inner.get("class", "").split()]
    if tags:
        return 0.92 * _set_width(words, bold=True) + 1.6  # its frame, in letters of their own
    if "number" in looks and not head:
        return _set_width(words)
    longest = max((_set_width(word, bold=head) for word in words.replace("-", "- ").split()), default=0.0)
    if longest > _LONGEST_WORD and not head:
        cell.set("class", " ".join([*looks, "long"]))
        return _LONGEST_WORD
    return longest


def _set_width(words: str, bold: bool = False) -> float:
    """Return the width of words in DejaVu Sans, ems.

    Examples
    --------
    >>> round(_set_width("1"), 3), round(_set_width("11"), 3)
    (0.636, 1.272)
    """
    return sum(_advance(letter, bold) for letter in words)


@functools.cache
def _advance(letter: str, bold: bool) -> float:
    from matplotlib.ft2font import LoadFlags

    font = _font("DejaVuSans-Bold.ttf" if bold else "DejaVuSans.ttf")
    glyph = font.load_char(ord(letter), flags=LoadFlags.NO_HINTING | LoadFlags.NO_SCALE)
    return float(glyph.horiAdvance) / float(font.units_per_EM)


@functools.cache
def _font(file: str) -> FT2Font:
    from matplotlib import get_data_path
    from matplotlib.ft2font import FT2Font

    return FT2Font(str(Path(get_data_path()) / "fonts" / "ttf" / file))
