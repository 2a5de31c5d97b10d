"""What set-up and files say of the kind of a shot: each first pulse is taken as compression, whatever its sign."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from strikewave.analyses.hopkinson.build import Gauged
from strikewave.analyses.hopkinson.setup_file import HopkinsonCase
from strikewave.base.result import INFO, WARNING, Notice
from strikewave.hopkinson.pulses import Quiet
from strikewave.records.readers.columns import decode, encoding_of

HEAD = 8192
"""Bytes of a text file in which its head is looked for."""
_LONGEST = 300
"""Characters of a line that are looked at: bounds the time of patterns."""
_TENSION = (
    r"tension|tensile|pull(?:ed|ing)?|zug(?:versuch|probe|stab|spannung|welle|belastung|beanspruchung)?|gezogen|traction|"
    r"shtb|thpb|tshb|拉伸"
)
_COMPRESSION = r"compress(?:ion|ive|ed)|druck(?:versuch|probe|spannung|welle|belastung|beanspruchung)?|gestaucht|压缩"
"""Words for the kind of a shot in English, German, French and Chinese. The name of the pressure bar itself is none: it
is used of tensile bars too."""
_SIGN_WORD = r"positive?|pos\.|negative?|neg\.|plus|minus"
_SIGN_MARK = r"\+|[-−]"
_WORD = {
    kind: re.compile(rf"(?:(?<![^\W_])|(?<=[一-鿿]))(?:{words})(?:(?![^\W_])|(?=[一-鿿]))", re.IGNORECASE)
    for kind, words in (("tension", _TENSION), ("compression", _COMPRESSION))
}
_STATED = [
    re.compile(
        rf"(?<![^\W_])(?:(?P<tension>{_TENSION})|{_COMPRESSION})[\s:=(,]{{0,3}}(?:is|ist|are)?\s{{0,2}}"
        rf"(?P<sign>(?:{_SIGN_WORD})(?![^\W_])|(?:{_SIGN_MARK})(?=\s{{0,9}}(?:$|[),;\]])))",
        re.IGNORECASE,
    ),
    re.compile(
        rf"(?<![^\W_])(?:(?P<sign>{_SIGN_WORD}|(?:{_SIGN_MARK})(?=\s{{0,2}}(?:is|ist|=|:)))\s{{0,2}}(?:is|ist|=|:|in)?)\s{{0,2}}"
        rf"(?:(?P<tension>{_TENSION})|{_COMPRESSION})(?![^\W_])",
        re.IGNORECASE,
    ),
]
"""A sign that is stated: ``tension positive``, ``compression (-)``, ``+ = tension``. A mark is a sign where nothing
follows it, or where it is said to mean something: in ``compression - shot 3`` it is a dash."""


class StatedKind(NamedTuple):
    """What texts say: the sign of tension, 0 for none; where a word for tension stands; whether compression is named.

    Examples
    --------
    >>> stated_kind({"title": "tension positive"}).tension_sign, stated_kind({"title": "compression +"}).tension_sign
    (1, -1)
    >>> stated_kind({"title": "SHTB 18CrNiMo7-6", "file": "attention.csv"}).tension
    'title says SHTB'
    """

    tension_sign: int
    sign_words: str
    tension: str
    compression: bool


def stated_kind(texts: Mapping[str, str]) -> StatedKind:
    """Return what texts, by where they stand, say of the kind of a shot; contradicting signs say nothing."""
    signs: dict[int, str] = {}
    tension, compression = "", False
    for where, text in texts.items():
        for line in text.splitlines():
            part = line[:_LONGEST]
            for pattern in _STATED:
                for match in pattern.finditer(part):
                    sign = -1 if match["sign"].lower().startswith(("neg", "min", "-", "−")) else 1
                    signs.setdefault(sign if match["tension"] else -sign, f"{where} says {match[0].strip()}")
                part = pattern.sub(" ", part)
            word = _WORD["tension"].search(part)
            tension = tension or (f"{where} says {word[0]}" if word else "")
            compression = compression or _WORD["compression"].search(part) is not None
    sign, words = next(iter(signs.items())) if len(signs) == 1 else (0, "")
    return StatedKind(sign, words, tension, compression)


def stated_texts(case: HopkinsonCase, gauged: Sequence[Gauged]) -> dict[str, str]:
    """Return what set-up, names of channels and heads of files say, by where it stands."""
    texts = {f"the {path} of the set-up": text for path, text in texts_of(case.setup).items()}
    for one in gauged:
        file, name = one.source
        texts |= {f"the channel {name}": name, f"the head of {file.name}": head_of(file)}
    return texts


def texts_of(table: Any, path: str = "") -> dict[str, str]:
    """Return all texts of a set-up by their paths, such as its title and the names of its files."""
    if isinstance(table, str):
        return {path: table}
    items = table.items() if isinstance(table, Mapping) else getattr(table, "__dict__", {}).items()
    return {
        place: text
        for key, value in items
        for place, text in texts_of(value, f"{path}.{key}" if path else str(key)).items()
        if text
    }


def head_of(file: Path) -> str:
    """Return the lines of words at the beginning of a text file; nothing of another one."""
    try:
        with file.open("rb") as opened:
            raw = opened.read(HEAD)
    except OSError:
        return ""
    encoding = encoding_of(raw)
    lines = decode(raw, encoding).splitlines() if encoding else []
    return "\n".join(line for line in lines if re.search(r"[^\W\d_eE]", line))


def sign_notices(kind: StatedKind, traces: Sequence[tuple[Quiet, str]], in_strain: bool) -> Iterator[Notice]:
    """Yield what contradicts that each first pulse is compression.

    Parameters
    ----------
    kind : StatedKind
        What set-up and files say.
    traces : sequence of (Quiet, str)
        Each trace, turned so that its first pulse is positive, with the name of its gauge.
    in_strain : bool
        Whether the files hold strain, whose sign is not that of a wiring.
    """
    for trace, name in traces:
        if kind.tension_sign and trace.polarity == kind.tension_sign:
            sign = "positive" if trace.polarity > 0 else "negative"
            message = (
                f"{kind.sign_words}, and the first pulse of {name} is {sign}: that is tension, while it is taken as "
                "compression; the curve of a tensile shot is wrong"
            )
            yield Notice("tension", message, float(trace.polarity), severity=WARNING)
    if not kind.tension_sign and kind.tension and not kind.compression:
        message = (
            f"{kind.tension}, while each first pulse is taken as compression: the curve of a tensile shot is wrong"
        )
        yield Notice("tension", message, severity=WARNING)
    polarities = {trace.polarity for trace, _ in traces}
    if len(polarities) > 1:
        message = (
            f"the first pulses of {' and '.join(name for _, name in traces)} have opposite signs, while in "
            "compression as in tension they have the same sign: is a gauge turned round, or a channel not of this shot?"
        )
        yield Notice("signs-differ", message, float("nan"), severity=WARNING if in_strain else INFO)
