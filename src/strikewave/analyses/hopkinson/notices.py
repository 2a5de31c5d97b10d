"""Notices on split bars: digests and sources, the sign of the first pulse, echoes, what reading and constants say."""

from __future__ import annotations

import contextlib
import hashlib
import math
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from strikewave.analyses.hopkinson.build import Gauged, HopkinsonCase, recorded_file
from strikewave.base.result import INFO, WARNING, Notice
from strikewave.base.texts import percent, plain
from strikewave.cases.materials_of_case import far_numbers
from strikewave.cases.tables.hopkinson import HopkinsonSetup, RecordedTable
from strikewave.hopkinson import Bar, BarMaterial
from strikewave.hopkinson.echoes import Echoes, Way
from strikewave.hopkinson.pulses import Quiet
from strikewave.records.health_notice import HealthNotice
from strikewave.records.readers.columns import decode, encoding_of

MISMATCH = 0.005
"""Share by which stated density, modulus and speed may disagree with no warning. Chosen: a bar's speed is measured to a
few thousandths, where the modulus of a table holds to a per cent."""
DRIFT = 4.0
"""Standard errors by which means of parts of a quiet head may differ with no warning: noise alone comes so far in fewer
than one of ten thousand."""
DRIFT_SHARE = 1e-3
"""Share of the largest strain of the record below which such a difference is not warned of: it changes no result that
is shown."""


def digests(case: HopkinsonCase) -> dict[str, str]:
    """Return the SHA-256 of the files that a set-up names, by these names; none of one that cannot be read."""
    setup, by_name = case.setup, {}
    records: list[RecordedTable | None] = [setup.bar.incident.gauge, setup.accelerometer]
    records.append(None if setup.bar.transmitted is None else setup.bar.transmitted.gauge)
    for record in records:
        if record is not None:
            with contextlib.suppress(OSError, ValueError), recorded_file(case, record).open("rb") as file:
                by_name[record.file] = hashlib.file_digest(file, "sha256").hexdigest()
    return by_name


def citations(theory: str, others: list[str]) -> tuple[str, ...]:
    """Return the keys of the sources, with that of the theory of dispersion."""
    return tuple(others if theory == "none" else [*others, "follansbee-frantz-1983"])


def reading_notices(findings: Iterable[HealthNotice]) -> Iterator[Notice]:
    """Yield the findings of reading the records."""
    for finding in findings:
        if finding.severity != "good":
            yield Notice(f"record-{finding.code}", finding.message, float(finding.value), 0.0)


def constant_notices(setup: HopkinsonSetup, constants: dict[str, BarMaterial]) -> Iterator[Notice]:
    """Yield densities and moduli far from those of any known material, and bars whose modulus belies their speed."""
    yield from far_numbers(setup)
    for name, elastic in constants.items():
        if abs(elastic.mismatch) > MISMATCH:
            message = (
                f"the modulus stated for the {name} bar differs by {percent(elastic.mismatch, 1, '+')} from rho c^2 = "
                f"{plain(elastic.modulus / 1e9, 4)}\xa0GPa of its density and speed, which is used"
            )
            yield Notice("constants-disagree", message, elastic.mismatch, MISMATCH)


def drift_notices(quiets: Iterable[Quiet], names: Iterable[str]) -> Iterator[Notice]:
    """Yield gauges whose baseline moves before the pulse."""
    for quiet, name in zip(quiets, names, strict=True):
        difference, error = quiet.drift
        limit = max(DRIFT * error, DRIFT_SHARE * float(abs(quiet.trace.strain).max()))
        if difference > limit:
            message = (
                f"the baseline of {name} moves by {plain(difference * 1e6)} ustrain before the pulse, more than noise "
                "does: forces and impulses are no surer than that"
            )
            yield Notice("baseline-drifts", message, difference, limit)


LENGTH_MISMATCH = 0.01
"""Share by which a stated length may differ from round trips and speed with no warning: a bar is measured better, and a
wrong gauge distance shows itself here."""
GAIN = 1e-3
"""Share of amplitude that passes may seem to gain in a round trip with no warning: no bar gains any; a thousandth is
what noise leaves of a good record."""
OTHER_WAY = 0.5
"""Misfit of the times, or difference of the speed, with the other way over that with the stated one, below which the
other way is proposed: it must be clearly better."""


def echo_notices(found: Echoes, bar: Bar, way: Way) -> Iterator[Notice]:
    """Yield what does not fit: speed, length, losses, the way of the first pulse, passes at the begin."""
    yield from _speed_notices(found, bar, way)
    yield from _length_notices(found, bar)
    gained = -2.0 * found.length.value * found.attenuation.value
    if gained > max(GAIN, 2.0 * found.length.value * 2.0 * found.attenuation.error):
        message = (
            f"passes gain {percent(gained, 2)} of amplitude in a round trip: do pulses overlap, or was "
            "one met on its way?"
        )
        yield Notice("attenuation-negative", message, found.attenuation.value, 0.0)
    if found.odd is not None:
        number = found.odd.number
        message = (
            f"pass {number} does not go with those after it: {plain(found.odd.late * 1e6, sign='+')}\xa0us late, "
            f"{plain(found.odd.strength)} times as "
            f"strong as they say; did it meet a specimen? echoes.skip = {number} leaves it out"
        )
        yield Notice("first-passes-differ", message, float(number), math.nan)


def _speed_notices(found: Echoes, bar: Bar, way: Way) -> Iterator[Notice]:
    speed, other = found.speed, found.other_way
    off = found.difference
    limit = max(MISMATCH, speed.student * speed.error / bar.speed if speed.freedom > 0 else 0.0)
    turned = "away" if way == "towards" else "towards"
    ask = f'echoes.way = "{turned}" would give {plain(other.speed, 5)}\xa0m/s: which way does the first pulse run?'
    if other.misfit < OTHER_WAY:
        message = f"the times of the passes fit the other way of the first pulse better; {ask}"
        yield Notice("way-differs", message, other.misfit, OTHER_WAY)
    if abs(off) > limit:
        message = (
            f"the speed by echoes, {plain(speed.value, 5)}\xa0m/s, is {percent(off, 2, '+')} off the stated "
            f"{plain(bar.speed, 5)}\xa0m/s"
        )
        if not other.misfit < OTHER_WAY and abs(other.speed / bar.speed - 1.0) < OTHER_WAY * abs(off):
            message += f"; {ask}"
        yield Notice("speed-differs", message, off, limit)
    if speed.freedom < 1:
        yield Notice("no-scatter", "the speed stands on as few passes as tell it: it has no error", 0.0, 1.0)


def _length_notices(found: Echoes, bar: Bar) -> Iterator[Notice]:
    off = found.round_trip.value / bar.length - 1.0 if math.isfinite(bar.length) else 0.0
    if abs(off) > LENGTH_MISMATCH:
        message = (
            f"the stated length of {plain(bar.length * 1e3, 5)}\xa0mm is {percent(-off / (1.0 + off), 1, '+')} off the "
            f"{plain(found.round_trip.value * 1e3, 5)}\xa0mm by round trips and turns at the near end: is it, or "
            "the gauge distance, off?"
        )
        yield Notice("length-differs", message, off, LENGTH_MISMATCH)


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
        Sign of tension that set-up and files state.
    traces : sequence of (Quiet, str)
        Each trace, turned so that its first pulse is positive, with the name of its gauge.
    in_strain : bool
        True if the files hold strain, whose sign is not that of a wiring.
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
