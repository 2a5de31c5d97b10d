"""A page that plays by itself: its own script, style and data inside, and a policy that lets nothing else run."""

from __future__ import annotations

import base64
import hashlib
import json
from importlib import resources
from typing import Any

import numpy as np
from numpy.typing import NDArray

from strikewave._version import __version__


def moving_page(package: str, document: dict[str, Any], title: str, name: str, **words: Any) -> str:
    """Return a page made of the files ``animation.html`` and ``animation.js`` of a package, and our ``animation.css``.

    Parameters
    ----------
    package : str
        That holds template and script; ours, no input.
    document : dict
        What the script draws from; its texts must be `printable`.
    title, name : str
        Of the page, and of the case; plain text.
    **words
        What else the template shows; escaped.
    """
    from jinja2 import Environment, StrictUndefined
    from markupsafe import Markup

    folder = resources.files(package)
    script = (folder / "animation.js").read_text("utf-8")
    style = (resources.files("strikewave.reporting") / "animation.css").read_text("utf-8")
    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, keep_trailing_newline=True)
    return environment.from_string((folder / "animation.html").read_text("utf-8")).render(
        title=printable(title),
        name=printable(name),
        version=__version__,
        style=Markup(style),  # our own, no input
        script=Markup(script),
        style_hash=Markup(_source_hash(style)),
        script_hash=Markup(_source_hash(script)),
        data=Markup(script_safe(json.dumps(document, allow_nan=False, separators=(",", ":")))),
        **words,
    )


def packed(values: Any, kind: str) -> str:
    """Return an array as base 64 of numbers of a kind, such as ``<f4``.

    Examples
    --------
    >>> packed([1.0, 2.0], "<f4")
    'AACAPwAAAEA='
    """
    return base64.b64encode(np.asarray(values).astype(kind).tobytes()).decode("ascii")


def script_safe(text: str) -> str:
    r"""Return JSON that cannot end the script element it stands in.

    Examples
    --------
    >>> script_safe('"</script><!--"')
    '"\\u003c/script\\u003e\\u003c!--"'
    """
    for letter in "<>&\u2028\u2029":
        text = text.replace(letter, f"\\u{ord(letter):04x}")
    return text


def printable(text: str) -> str:
    """Return text in which what cannot be shown, or turns lines round, is replaced."""
    return "".join(letter if letter.isprintable() else "\ufffd" for letter in text)


def _source_hash(text: str) -> str:
    """Return the hash by which a content security policy knows a script or a style sheet."""
    return "sha256-" + base64.b64encode(hashlib.sha256(text.encode("utf-8")).digest()).decode("ascii")


def even_rows(count: int, most: int) -> NDArray[np.int64]:
    """Return evenly chosen rows, at most so many, the first and the last one among them."""
    return np.unique(np.linspace(0, count - 1, min(count, most)).round().astype(np.int64))
