"""A verdict on records in words: for the screen and the report."""

from __future__ import annotations

import math

from strikewave.base.texts import first_few
from strikewave.cases.stated_test import StatedTest
from strikewave.reporting.clause_words import (
    clause_name,
    first_upper,
    not_judged_names,
    share_words,
    verdict_sentence,
    verdict_tag,
    why_words,
)
from strikewave.reporting.numbers import listed
from strikewave.reporting.parts import NONE, Tag
from strikewave.specifications.judged_records import JudgedShock, RecordsVerdict
from strikewave.specifications.judging import CANNOT_TELL, FAIL, PASS

WHY_HEAD = "fails, or why nothing can be said"
"""Head of a column of `why_of_shock`."""
MOST_NAMED = 3
"""Shocks that a sentence names."""


def name_of_shock(shock: JudgedShock | None, names: dict[str, str], several: bool) -> str:
    """Return how a shock is called: file, channel where there are several, number of its blow."""
    if shock is None:
        return NONE
    channel = f", {shock.reading.channel.name}" if several else ""
    return f"{names[shock.file]}{channel}, blow {shock.number}"


def why_of_shock(shock: JudgedShock) -> str:
    """Say which clauses a shock fails or, where it fails none, of which nothing can be said, and why."""
    for verdict in (FAIL, CANNOT_TELL):
        clauses = [clause for clause in shock.found.clauses if clause.verdict == verdict]
        if clauses:
            names = ", ".join(clause.clause for clause in clauses)
            return f"{names}: {clauses[0].reason}" if verdict == CANNOT_TELL and clauses[0].reason else names
    return NONE


def tag_of_records(found: RecordsVerdict, stated: StatedTest | None = None) -> Tag:
    """Return the verdict as a tag, with what it rests on; equipment without a valid calibration takes its green."""
    tag = verdict_tag(found.verdict, found.by_indicative, [clause for clause, _ in found.clauses])
    if stated is None or not stated.lapses:
        return tag
    return Tag(f"{tag.text}; calibration overdue", "warned" if found.verdict == PASS else tag.look)


def sentence(found: RecordsVerdict, names: dict[str, str]) -> str:
    """Say what the verdict is, by what, and why."""
    count = len(found.shocks)
    many = {0: "no shock", 1: "one shock"}.get(count, f"{count} shocks")
    clauses = [clause for clause, _ in found.clauses]
    of_what = f": {many} by {found.specification.title} ({found.specification.file.edition})."
    words = [verdict_sentence(found.verdict, found.by_indicative, clauses, of_what)]
    several = len({shock.reading.channel.name for shock in found.shocks}) > 1
    wrong = [(c, s) for c, s in found.clauses if c.verdict == found.verdict and c.verdict in (FAIL, CANNOT_TELL)]
    for clause, shock in wrong[:MOST_NAMED]:
        where = f" of {name_of_shock(shock, names, several)}" if shock is not None and count > 1 else ""
        words.append(f"{first_upper(clause_name(clause.clause))}{where}: {why_words(clause)}.")
    if found.verdict == PASS:
        tight = [(c, s) for c, s in found.clauses if c.verdict == PASS and math.isfinite(c.share)]
        if tight:
            clause, shock = min(tight, key=lambda one: one[0].share)
            where = f", {name_of_shock(shock, names, several)}" if shock is not None and count > 1 else ""
            words.append(f"Least margin: {clause.clause}{where}, {share_words(clause)} of the tolerance.")
    failed = sum(shock.found.verdict == FAIL for shock in found.shocks)
    if count > 1 and failed:
        words.append(f"{failed} of {count} shocks fail.")
    unclear = [shock for shock in found.shocks if shock.found.verdict == CANNOT_TELL]
    if count > 1 and unclear and found.verdict != CANNOT_TELL:
        where = first_few([name_of_shock(shock, names, several) for shock in unclear], MOST_NAMED, "; ")
        words.append(f"Of {len(unclear)} of {count} nothing can be said ({where}): {why_of_shock(unclear[0])}.")
    skipped = not_judged_names(clauses)
    if skipped and found.verdict != PASS:
        words.append(f"Not judged: {listed(skipped)}.")
    return " ".join(words)
