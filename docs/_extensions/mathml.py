"""Equations of the site as MathML, which browsers typeset without any script or font of ours."""

import html
import xml.etree.ElementTree as ElementTree
from typing import Any

from docutils import nodes
from latex2mathml.converter import convert_to_element
from sphinx.util.math import get_node_equation_number


def mathml(tex: str, display: str) -> str:
    """Return an equation as an element; what reads it aloud gets its source, as does what draws it in the manual."""
    element = convert_to_element(tex, display=display)
    for inner in element.iter():
        inner.text = html.unescape(inner.text or "") or None  # the library writes letters as entities
    element.set("alttext", tex)
    element.set("data-tex", tex)
    return ElementTree.tostring(element, encoding="unicode")


def visit_inline(writer: Any, node: nodes.Element) -> None:
    """Write an equation within a line."""
    writer.body.append(mathml(node.astext(), "inline"))
    raise nodes.SkipNode


def visit_block(writer: Any, node: nodes.Element) -> None:
    """Write an equation of its own, with its number and what links lead to."""
    writer.body.append(writer.starttag(node, "div", CLASS="math"))
    if node["number"]:
        number = get_node_equation_number(writer, node)
        writer.body.append(f'<span class="eqno">({number})')
        writer.add_permalink_ref(node, "Link to this equation")
        writer.body.append("</span>")
    writer.body.append(f'<div class="equation">{mathml(node.astext(), "block")}</div></div>')
    raise nodes.SkipNode


def setup(app: Any) -> dict[str, bool]:
    """Offer them to Sphinx as `html_math_renderer = "mathml"`."""
    app.add_html_math_renderer("mathml", (visit_inline, None), (visit_block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
