"""Clauses of a specification in words: limits, values, margins and verdicts, for screens and reports."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

from strikewave.base.declare import KEY, MORE
from strikewave.base.result import Notice
from strikewave.base.shock_quantities import usual_unit
from strikewave.records.budget import Budget
from strikewave.reporting.columns import Column
from strikewave.reporting.faces import capitalized
from strikewave.reporting.numbers import doubted, listed, shown, shown_unit, spelled, with_unit
from strikewave.reporting.parts import NONE, Tag, written
from strikewave.specifications.judging import CANNOT_TELL, FAIL, NOT_JUDGED, PASS, Clause

SHOWN = {PASS: "PASS", FAIL: "FAIL", CANNOT_TELL: "CANNOT TELL", NOT_JUDGED: "not judged"}
"""Verdicts as they are written."""
LOOKS = {PASS: "good", FAIL: "bad", CANNOT_TELL: "warned", NOT_JUDGED: ""}
"""Style of each verdict on a page."""
INDICATIVE_WORDS = " (by indicative limits)"


def verdict_words(verdict: str, by_indicative: bool, clauses: Iterable[Clause] = ()) -> str:
    """Return the words of a verdict, and whether it rests on indicative limits; a pass names clauses not judged.

    Examples
    --------
    >>> from strikewave.specifications.judging import Limits, not_judged
    >>> verdict_words("pass", True), verdict_words("cannot-tell", False)
    ('PASS (by indicative limits)', 'CANNOT TELL')
    >>> verdict_words("pass", False, [not_judged("cross-axis", Limits(0.0, 1.0, "quoted"), "m/s^2", "")])
    'PASS for the clauses judged; 1 not judged: cross-axis'
    """
    left = not_judged_names(clauses) if verdict == PASS else []
    partly = " for the clauses judged" if left else ""
    named = f"; {len(left)} not judged: {listed(left)}" if left else ""
    return SHOWN[verdict] + partly + (INDICATIVE_WORDS if by_indicative else "") + named


def verdict_sentence(verdict: str, by_indicative: bool, clauses: Iterable[Clause], what: str) -> str:
    """Return the sentence that begins with a verdict and names its subject, such as ``: one shock by ...``."""
    words = verdict_words(verdict, by_indicative, clauses)
    return f"{words}. {capitalized(what.lstrip(': '))}" if ";" in words else f"{words}{what}"


def verdict_tag(verdict: str, by_indicative: bool, clauses: Iterable[Clause] = ()) -> Tag:
    """Return a verdict as the tag of a page: what was not judged is named in the sentence beside it."""
    return Tag(verdict_words(verdict, by_indicative, clauses).partition(";")[0], LOOKS[verdict])


def not_judged_names(clauses: Iterable[Clause]) -> list[str]:
    """Return the names of the clauses that were not judged, each once."""
    return list(dict.fromkeys(clause.clause for clause in clauses if clause.verdict == NOT_JUDGED))


def clause_name(clause: str) -> str:
    """Return the name of a clause beside numbers of records, whose velocity change is another.

    Examples
    --------
    >>> clause_name("velocity change"), clause_name("peak")
    ("velocity change (specification's window)", 'peak')
    """
    return f"{clause} (specification's window)" if clause == "velocity change" else clause


def unit_of_clause(clause: Clause) -> str:
    """Return the unit in which a clause is shown as a rule: a long time in ms."""
    if clause.unit == "s":
        largest = max((abs(limit) for limit in (clause.low, clause.high) if math.isfinite(limit)), default=0.0)
        return "ms" if largest >= 1e-3 else "us"
    return usual_unit(clause.unit)


def amount(clause: Clause, value: float, digits: int = 4) -> str:
    """Write a value of a clause with its unit; a share in percent, a count alone."""
    if not math.isfinite(value):
        return NONE
    if clause.unit == "1":
        text = f"{written(100.0 * value, min(digits, 3))} %" if clause.clause.startswith("share") else written(value)
        return text.replace("-", "−")
    minus, digits = ("", digits) if value >= 0.0 else ("−", 3)  # below zero it is a margin: three do
    return minus + with_unit(abs(value), clause.unit, unit_of_clause(clause), digits)


def limit_words(clause: Clause) -> str:
    """Write the limits of a clause with their unit.

    Examples
    --------
    >>> from strikewave.specifications.judging import Limits, judged
    >>> limit_words(judged("peak", 1.0, Limits(392.266, 588.399, "quoted"), "m/s^2"))
    '40 to 60 g'
    """
    low, high = math.isfinite(clause.low), math.isfinite(clause.high)
    if clause.clause == "band":
        return "inside"
    if low and high and clause.low == clause.high:
        return amount(clause, clause.low)
    if low and high:
        unit = unit_of_clause(clause)
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


def doubted_words(clause: Clause) -> str:
    """Write the value of a clause with its expanded uncertainty, k = 2, where one is known.

    Examples
    --------
    >>> from strikewave.specifications.judging import Limits, judged
    >>> doubted_words(judged("peak", 490.0, Limits(392.266, 588.399, "quoted"), "m/s^2", uncertainty=9.80665))
    '50.0 ± 1.0 g'
    """
    value = value_words(clause)
    if not (clause.uncertainty > 0.0 and math.isfinite(clause.value)):
        return value
    doubt = amount(clause, clause.uncertainty, 2)
    if clause.clause == "band":
        return f"{value} (± {doubt})"
    if clause.unit != "1" and math.isfinite(clause.uncertainty):
        usual = unit_of_clause(clause)
        ends = doubted(shown(clause.value, clause.unit, usual), shown(clause.uncertainty, clause.unit, usual))
        return f"{' ± '.join(ends)} {spelled(shown_unit(clause.unit, usual))}".replace("-", "−")
    number, unit = value.rpartition("\N{NO-BREAK SPACE}" if "\N{NO-BREAK SPACE}" in value else " ")[::2]
    return f"{number} ± {doubt}" if doubt.endswith(unit) else f"{value} ± {doubt}"


def decision_words(rule: str, holds: Sequence[str], not_stated: Sequence[str]) -> str:
    """Name the decision rule, the contributions that the uncertainty holds, and those that nobody stated.

    Examples
    --------
    >>> decision_words("guarded", ["noise", "a gain"], ["clock"])
    'Decision rule: guarded, U on both sides of each limit. U (k = 2) holds noise and a gain; not stated: clock.'
    """
    rules = {"simple": "simple acceptance, U plays no part", "guarded": "guarded, U on both sides of each limit"}
    if not holds:
        return f"Decision rule: {rules[rule]}."
    return f"Decision rule: {rules[rule]}. {held_words(holds, not_stated)}"


def held_words(holds: Sequence[str], not_stated: Sequence[str]) -> str:
    """Name the contributions that expanded uncertainties hold, and those that nobody stated.

    Examples
    --------
    >>> held_words(["noise and baseline"], [])
    'U (k = 2) holds noise and baseline only.'
    """
    only = " only" if len(holds) == 1 else ""
    left = f"; not stated: {listed(list(not_stated))}" if not_stated else ""
    return f"U (k = 2) holds {listed(list(holds))}{only}{left}."


def budget_notices(budget: Budget) -> tuple[Notice, ...]:
    """Return a warning that names the contributions of a budget whose numbers are from memory."""
    names = budget.indicative
    if not names:
        return ()
    many = f"{len(names)} contribution{'s' * (len(names) > 1)} of the uncertainty budget"
    message = f"{many} rest on numbers from memory: {listed(list(names))}; state those of your certificates"
    return (Notice("budget-from-memory", message, float(len(names)), 0.0),)


def share_words(clause: Clause) -> str:
    """Write the margin as a share of half the tolerance, where that means something."""
    shared = clause.clause != "band" and clause.unit not in ("1", "Hz") and math.isfinite(clause.share)
    return f"{100.0 * clause.share:.0f} %".replace("-", "−") if shared else NONE


def why_words(clause: Clause) -> str:
    """Return the reason why a clause did not pass."""
    if clause.reason and clause.verdict == CANNOT_TELL:
        return clause.reason
    where = f", {clause.reason}" if clause.reason else ""
    if clause.clause == "band":
        return f"{amount(clause, -clause.margin, 3)} outside{where}"
    return f"{value_words(clause)}; limit {limit_words(clause)}{where}"


def clause_words(clause: Clause) -> str:
    """Return a clause that did not pass with its reason."""
    return f"{capitalized(clause_name(clause.clause))}: {why_words(clause)}"


def tag_of(verdict: str) -> Tag:
    """Return a verdict as a tag."""
    return Tag(SHOWN[verdict], LOOKS[verdict])


def clause_columns(clauses: Sequence[Clause]) -> list[Column]:
    """Return the columns of clauses for screen and page.

    Examples
    --------
    >>> from strikewave.specifications.judging import Limits, judged
    >>> clause = judged("peak", 490.0, Limits(392.266, 588.399, "quoted"), "m/s^2")
    >>> [column.texts() for column in clause_columns([clause])][:4]
    [['peak'], ['PASS'], ['40 to 60 g'], ['49.97 g']]
    """
    return [
        Column("clause", [clause_name(clause.clause) for clause in clauses], priority=KEY, words=True),
        Column("verdict", [tag_of(clause.verdict) for clause in clauses], words=True),
        Column("limit", list(map(limit_words, clauses))),
        Column("value ± U", list(map(doubted_words, clauses))),
        Column("margin", [amount(clause, clause.margin, 3) for clause in clauses]),
        Column("of tolerance", list(map(share_words, clauses)), priority=MORE),
        Column("limit is", [clause.status for clause in clauses], priority=MORE, words=True),
    ]


def why_column(clauses: Sequence[Clause]) -> Column:
    """Return the reasons why clauses cannot be judged, or fail."""
    return Column("why", [clause.reason or None for clause in clauses], priority=MORE, words=True)
