"""A matplotlib figure as an SVG element that stands in an HTML page among others.

Text stays text (``svg.fonttype`` none): it can be searched and copied, stays sharp at any size, shows
letters that matplotlib's font lacks, and a picture takes half the room. matplotlib sets DejaVu Sans;
where that is absent, Verdana has nearly the same widths and any other face is narrower, so nothing
runs into anything, and anchors keep centred labels centred.
"""

from __future__ import annotations

import io
import re
import warnings
from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree

from strikewave.base import control_characters

if TYPE_CHECKING:
    from matplotlib.figure import Figure

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

    The same figure gives the same text.

    Parameters
    ----------
    figure : matplotlib.figure.Figure
        What to draw.
    name : str
        Unique in the page; clip paths and markers of several pictures would share their names otherwise.
    label : str, optional
        What the picture shows, for those who cannot see it.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> text = inline_svg(Figure(figsize=(2, 1)), "p1", "nothing")
    >>> text[:40]
    '<svg viewBox="0 0 144 72" role="img" ari'
    """
    import matplotlib

    buffer = io.StringIO()
    with matplotlib.rc_context(_SETTINGS), warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Glyph .* missing")  # the browser has a font for it
        no_metadata = dict.fromkeys(("Creator", "Date", "Format", "Type"))
        figure.savefig(buffer, format="svg", metadata=no_metadata)
    root = ElementTree.fromstring(control_characters.shown(buffer.getvalue()))
    _tidy(root, name)
    box, width = root.get("viewBox", ""), figure.get_figwidth() * 96.0
    root.attrib.clear()
    root.attrib.update(
        {
            "viewBox": box,
            "role": "img",
            "aria-label": label,
            "style": f"max-width:{width:.0f}px;stroke-linejoin:round;stroke-linecap:butt",
        }
    )
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
                element.set(key, _LONG_FRACTION.sub(lambda m: _short(m[0]), " ".join(value.split())))
            elif "url(#" in value:
                element.set(key, _NAMED.sub(rf"url(#{name}-\1)", value))


def _short(number: str) -> str:
    return f"{float(number):.2f}".rstrip("0").rstrip(".")
