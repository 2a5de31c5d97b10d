"""A verdict in words: for the screen and the report."""

from __future__ import annotations

import math

from strikewave.reporting.numbers import listed, shown, with_unit
from strikewave.reporting.parts import NONE, Cell, Tag, written
from strikewave.specifications.decisions import CANNOT_TELL, FAIL, NOT_JUDGED, PASS
from strikewave.specifications.judged_records import JudgedShock, RecordsVerdict
from strikewave.specifications.judging import Clause

SHOWN = {PASS: "PASS", FAIL: "FAIL", CANNOT_TELL: "CANNOT TELL", NOT_JUDGED: "not judged"}
"""Verdicts as they are written."""
LOOKS = {PASS: "good", FAIL: "bad", CANNOT_TELL: "warned", NOT_JUDGED: ""}
"""How they look on a page."""
INDICATIVE_WORDS = " (by indicative limits)"
MOST_NAMED = 3
"""Shocks that a sentence names."""


def verdict_words(verdict: str, by_indicative: bool) -> str:
    """Return a verdict as it is written, with what it rests on.

    Examples
    --------
    >>> verdict_words("pass", True), verdict_words("cannot-tell", False)
    ('PASS (by indicative limits)', 'CANNOT TELL')
    """
    return SHOWN[verdict] + (INDICATIVE_WORDS if by_indicative else "")


def usual_unit(clause: Clause) -> str:
    """Return the unit in which a clause is shown as a rule."""
    if clause.unit == "s":
        largest = max((abs(one) for one in (clause.low, clause.high) if math.isfinite(one)), default=0.0)
        return "ms" if largest >= 1e-3 else "us"
    return {"m/s^2": "g"}.get(clause.unit, clause.unit)


def amount(clause: Clause, value: float, digits: int = 4) -> str:
    """Write a value of a clause with its unit; a share in percent, a count alone."""
    if not math.isfinite(value):
        return NONE
    if clause.unit == "1":
        return f"{written(100.0 * value, 3)} %" if clause.clause.startswith("share") else written(value)
    return with_unit(abs(value), clause.unit, usual_unit(clause), digits) if value >= 0.0 else _below(clause, value)


def _below(clause: Clause, value: float) -> str:
    return f"−{with_unit(-value, clause.unit, usual_unit(clause), 3)}"


def limit_words(clause: Clause) -> str:
    """Write the limits of a clause.

    Examples
    --------
    >>> from strikewave.specifications.judging import Limits, judged
    >>> limit_words(judged("peak", 1.0, Limits(392.266, 588.399, "quoted"), "m/s^2"))
    '40 to 60 g'
    """
    low, high = (math.isfinite(one) for one in (clause.low, clause.high))
    if clause.clause == "band":
        return "inside"
    if low and high and clause.low == clause.high:
        return amount(clause, clause.low)
    if low and high:
        unit = usual_unit(clause)
        first = written(shown(clause.low, clause.unit, unit)) if clause.unit != "1" else amount(clause, clause.low)
        return f"{first} to {amount(clause, clause.high)}"
    if low:
        return f"at least {amount(clause, clause.low)}"
    return f"at most {amount(clause, clause.high)}" if high else NONE


def value_words(clause: Clause) -> str:
    """Write the value of a clause; of a band, which side of it the record is on."""
    if clause.clause == "band" and math.isfinite(clause.value):
        return "inside" if clause.value >= 0.0 else "outside"
    return amount(clause, clause.value)


def margin_words(clause: Clause) -> str:
    """Write the margin of a clause, below zero outside."""
    return amount(clause, clause.margin, 3)


def share_words(clause: Clause) -> str:
    """Write the margin as a share of half the tolerance, where that means something."""
    shared = clause.clause != "band" and clause.unit not in ("1", "Hz") and math.isfinite(clause.share)
    return f"{100.0 * clause.share:.0f} %".replace("-", "−") if shared else NONE


def name_of_shock(shock: JudgedShock | None, names: dict[str, str], several: bool) -> str:
    """Return how a shock is called: file, channel where there are several, number of its blow."""
    if shock is None:
        return NONE
    channel = f", {shock.reading.channel.name}" if several else ""
    return f"{names[shock.file]}{channel}, blow {shock.number}"


def sentence(found: RecordsVerdict, names: dict[str, str]) -> str:
    """Say what the verdict is, by what, and why."""
    count = len(found.shocks)
    words = [
        f"{verdict_words(found.verdict, found.by_indicative)}: {'one shock' if count == 1 else f'{count} shocks'} by "
        f"{found.specification.title} ({found.specification.file.edition})."
    ]
    several = len({shock.reading.channel.name for shock in found.shocks}) > 1
    wrong = [(c, s) for c, s in found.clauses if c.verdict == found.verdict and c.verdict in (FAIL, CANNOT_TELL)]
    for clause, shock in wrong[:MOST_NAMED]:
        where = f" of {name_of_shock(shock, names, several)}" if shock is not None and count > 1 else ""
        words.append(f"{_first_upper(clause.clause)}{where}: {_why(clause)}.")
    if found.verdict == PASS:
        tight = [(c, s) for c, s in found.clauses if c.verdict == PASS and math.isfinite(c.share)]
        if tight:
            clause, shock = min(tight, key=lambda one: one[0].share)
            where = f", {name_of_shock(shock, names, several)}" if shock is not None and count > 1 else ""
            words.append(f"Least margin: {clause.clause}{where}, {share_words(clause)} of the tolerance.")
    failed = sum(shock.found.verdict == FAIL for shock in found.shocks)
    if count > 1 and failed:
        words.append(f"{failed} of {count} shocks fail.")
    skipped = list(dict.fromkeys(clause.clause for clause, _ in found.clauses if clause.verdict == NOT_JUDGED))
    if skipped:
        words.append(f"Not judged: {listed(skipped)}.")
    return " ".join(words)


def _first_upper(text: str) -> str:
    return text[:1].upper() + text[1:]


def _why(clause: Clause) -> str:
    """Say why a clause did not pass."""
    if clause.reason and clause.verdict == CANNOT_TELL:
        return clause.reason
    where = f", {clause.reason}" if clause.reason else ""
    if clause.clause == "band":
        return f"{amount(clause, -clause.margin, 3)} outside{where}"
    return f"{value_words(clause)}; limit {limit_words(clause)}{where}"


def clause_words(clause: Clause) -> str:
    """Say what a clause that did not pass comes to."""
    return f"{_first_upper(clause.clause)}: {_why(clause)}"


def tag_of(verdict: str) -> Tag:
    """Return a verdict as a tag."""
    return Tag(SHOWN[verdict], LOOKS[verdict])


def clause_cells(clause: Clause) -> list[Cell]:
    """Return the cells of a row of a table, see `CLAUSE_HEADS`."""
    return [
        clause.clause,
        limit_words(clause),
        value_words(clause),
        margin_words(clause),
        share_words(clause),
        tag_of(clause.verdict),
        clause.status,
    ]


CLAUSE_HEADS = ("clause", "limit", "value", "margin", "of tolerance", "verdict", "limit is")
