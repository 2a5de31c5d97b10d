"""Whether a measured value lies within its limits: by the value alone, or with its uncertainty.

Simple acceptance takes the value as it is. Guarded decisions (ISO 14253-1, JCGM 106) leave a guard band of the expanded
uncertainty U, k = 2, on both sides of a limit, within which neither is stated.

Source: JCGM 106:2012, 8.2 (simple acceptance), 8.3 (guard bands, w = r U with r = 1); ISO 14253-1:2017.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Literal

Rule = Literal["simple", "guarded"]
PASS, FAIL, CANNOT_TELL, NOT_JUDGED = "pass", "fail", "cannot-tell", "not-judged"
"""Verdicts; what is not judged lacks what only the user can say, such as the directions of the shocks."""
WORST_FIRST = (FAIL, CANNOT_TELL, PASS)


def decide(margin: float, uncertainty: float = 0.0, rule: Rule = "simple") -> str:
    """Return the verdict on a margin to the nearest limit, positive inside.

    Parameters
    ----------
    margin : float
        Distance to the nearest limit.
    uncertainty : float, optional
        Expanded uncertainty of the value; where it is not known (NaN), a guarded decision states nothing.
    rule : str, optional
        ``simple`` or ``guarded``.

    Examples
    --------
    >>> [decide(margin, 2.0, "guarded") for margin in (3.0, 1.0, -1.0, -3.0)]
    ['pass', 'cannot-tell', 'cannot-tell', 'fail']
    >>> decide(1.0, 2.0), decide(0.0), decide(-1e-9), decide(1.0, math.nan, "guarded")
    ('pass', 'pass', 'fail', 'cannot-tell')
    """
    guard = uncertainty if rule == "guarded" else 0.0
    if math.isnan(margin) or math.isnan(guard):
        return CANNOT_TELL
    if margin >= guard:
        return PASS
    return FAIL if margin < -guard or guard == 0.0 else CANNOT_TELL


def together(verdicts: Iterable[str]) -> str:
    """Return the verdict of several: what fails one fails all, and of nothing nothing can be said.

    Examples
    --------
    >>> together(["pass", "cannot-tell"]), together(["pass", "not-judged"]), together([])
    ('cannot-tell', 'pass', 'cannot-tell')
    """
    found = set(verdicts)
    return next((verdict for verdict in WORST_FIRST if verdict in found), CANNOT_TELL)
