"""The whole reproduction of the machine's paper, with all its element runs (ten minutes on two cores).

Its balances must close, the numbers that the paper took from LS-DYNA must come from element runs, and what the docs say
of three findings must still be what the elements decide. Writes the page into out/validate/reproduction.
"""

from __future__ import annotations

import os
from pathlib import Path

from strikewave.papers.li_ma_2019 import answers
from strikewave.papers.li_ma_2019.report.page import reproduction_report
from strikewave.papers.li_ma_2019.reproduce import reproduce
from strikewave.papers.li_ma_2019.runs import ELEMENT_CASES, Effort

DECIDED = {"reflecting": ["not"], "yielding": ["partly"], "mean": ["partly"]}
"""Verdicts of findings that element runs show, by a word of their topic: those of docs/reproduction.md."""
FOLDER = Path("out/validate/reproduction")


def main() -> None:
    """Run all, compare, write the page."""
    whole = reproduce(Effort(threads=os.cpu_count() or 1))
    wrong = ["an equation or a check does not hold: the page says which"] if whole.broken else []
    for name in (answers.DYNA_PEAK, answers.DYNA_FORCE, answers.DYNA_WAVE_PEAK):
        best = whole.row(name).best
        if best is None or not best.by.startswith("li-ma-2019-fem"):
            wrong.append(f"{name} is not from elements")
    shown = {row.topic: row.verdict for row in whole.findings if "elements" in row.shown_by or "fem" in row.shown_by}
    found = {word: [verdict for topic, verdict in shown.items() if word in topic] for word in DECIDED}
    wrong += [f"{word}: {found[word]}, not {wanted}" for word, wanted in DECIDED.items() if found[word] != wanted]
    FOLDER.mkdir(parents=True, exist_ok=True)
    (FOLDER / "report.html").write_text(reproduction_report(whole), encoding="utf-8")
    print(f"{len(ELEMENT_CASES)} element cases, {len(whole.findings)} findings; written: {FOLDER / 'report.html'}")
    if wrong:
        raise SystemExit("\n".join(wrong))


if __name__ == "__main__":
    main()
