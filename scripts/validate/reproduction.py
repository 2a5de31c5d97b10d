"""The whole reproduction of the machine's paper, with all its element runs (ten minutes on two cores).

    python scripts/validate/reproduction.py [--quick]

Its balances must close, the wave model must converge, the numbers that the paper took from LS-DYNA must come from
element runs, and what the docs say of three findings must still be what the elements decide. Writes the page into
out/validate/reproduction. ``--quick`` takes coarser elements and no studies (a minute): it only keeps the comparisons,
which say so. Models with non-reflecting faces are also run at `SLOWER`: the page shows the range between both speeds.
"""

from __future__ import annotations

import argparse
import math
import os
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from kit import Comparison, keep

from strikewave import load_case, run_fem
from strikewave.analyses.fem.result import FemSolution
from strikewave.papers.li_ma_2019 import compared_numbers
from strikewave.papers.li_ma_2019.compared_numbers import Computed, si_unit
from strikewave.papers.li_ma_2019.element_studies import MeshRow
from strikewave.papers.li_ma_2019.published import PublishedNumber
from strikewave.papers.li_ma_2019.report import reproduction_report
from strikewave.papers.li_ma_2019.reproduce import reproduce
from strikewave.papers.li_ma_2019.result import Reproduction
from strikewave.papers.li_ma_2019.runs import ELEMENT_CASES, NON_REFLECTING, WAVE_ELEMENTS, Effort, coarser

DECIDED = {"reflecting": ["not"], "yielding": ["partly"], "mean": ["partly"]}
"""Verdicts of findings that element runs show, by a word of their topic: those of docs/reproduction.md."""
FOLDER = Path("out/validate/reproduction")


WHY = (
    "bodies and joints are not published, those of the case are assumed; in the simulation the contact force stands "
    "for an acceleration that its non-reflecting faces do not leave ([why](reproduction.md#the-two-simulations)). A "
    "drawing of the frame would decide"
)


SLOWER = "-2.74 m/s"
"""Approach speed, of which nothing is published, at which the model with non-reflecting faces has the impulse of a
half-sine of LS-DYNA's peak and width, 2.73 for 2.76 N s; the cases have the 4.062 m/s fitted without those faces."""


def slower_runs(whole: Reproduction) -> dict[str, FemSolution]:
    """Run the models with non-reflecting faces at `SLOWER`, on the meshes of the others."""
    threads, solutions = os.cpu_count() or 1, {}
    for name in NON_REFLECTING:
        mesh = coarser(load_case(name)) if whole.effort.quick else []
        changes = [
            *mesh,
            f"mesh.part.striker.velocity.z={SLOWER}",
            "fem.duration=300 us",
            "fem.frames=0",
            "compare=true",
        ]
        solutions[name] = run_fem(load_case(name, changes), threads)
    return solutions


def speed_range(
    number: PublishedNumber, computed: Computed, slower: Mapping[str, FemSolution]
) -> tuple[float, float] | None:
    """Return what a model computes at both speeds of a number that follows them; a prediction hardly does."""
    if computed.by not in slower or computed.value is None or computed.role == "predicted":
        return None
    for entry in slower[computed.by].compared():
        if entry.computed is not None and math.isclose(entry.published, number.value, rel_tol=1e-6):
            low, high = sorted((entry.computed, computed.value))
            return low, high
    return None


def comparisons(whole: Reproduction, slower: Mapping[str, FemSolution]) -> Iterator[Comparison]:
    """Yield what the elements say of each published number."""
    for row in whole.numbers:
        number = row.number
        for one in row.computed:
            if one.by.startswith("li-ma-2019-fem") and one.value is not None:
                mesh = ", coarse elements" if whole.effort.quick else ""
                note = one.note or (WHY if one.role == "predicted" else "")
                yield Comparison(
                    f"{one.by}{mesh}",
                    number.name,
                    number.origin,
                    one.role,
                    number.value,
                    one.value,
                    si_unit(number.unit),
                    band=speed_range(number, one, slower),
                    note=note,
                )


def wave_misses(rows: Sequence[MeshRow]) -> Iterator[str]:
    """Yield what of the wave model changes by more from mesh to mesh than is left to the second touch, at 155 us."""
    finest = rows[-1].answer
    for row, peak, impulse in zip(rows, (0.1, 0.06), (math.inf, 0.07), strict=False):
        if abs(row.answer.body_peak / finest.body_peak - 1.0) > peak:
            yield f"peak of the wave model on elements of {row.size:g} times the size: {row.answer.body_peak:g} m/s^2"
        if abs(row.answer.impulse / finest.impulse - 1.0) > impulse:
            yield f"impulse of the wave model on elements of {row.size:g} times the size: {row.answer.impulse:g} N s"
    if any(abs(row.energy_error) > 1e-3 or row.hourglass_share > 0.05 for row in rows):
        yield "energy of the wave model"


def main() -> None:
    """Run all, compare, write the page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true", help="coarser elements, no studies; comparisons alone")
    quick = parser.parse_args().quick
    whole = reproduce(Effort(quick=quick, threads=os.cpu_count() or 1))
    keep("paper", list(comparisons(whole, slower_runs(whole))))
    if quick:
        return
    wrong = ["an equation or a check does not hold: the page says which"] if whole.broken else []
    for name in (compared_numbers.DYNA_PEAK, compared_numbers.DYNA_FORCE, compared_numbers.DYNA_WAVE_PEAK):
        best = whole.row(name).best
        if best is None or not best.by.startswith("li-ma-2019-fem"):
            wrong.append(f"{name} is not from elements")
    shown = {row.topic: row.verdict for row in whole.findings if "elements" in row.shown_by or "fem" in row.shown_by}
    found = {word: [verdict for topic, verdict in shown.items() if word in topic] for word in DECIDED}
    wrong += [f"{word}: {found[word]}, not {wanted}" for word, wanted in DECIDED.items() if found[word] != wanted]
    wrong += wave_misses(whole.element_studies.meshes[WAVE_ELEMENTS])
    FOLDER.mkdir(parents=True, exist_ok=True)
    (FOLDER / "report.html").write_text(reproduction_report(whole), encoding="utf-8")
    print(f"{len(ELEMENT_CASES)} element cases, {len(whole.findings)} findings; written: {FOLDER / 'report.html'}")
    if wrong:
        raise SystemExit("\n".join(wrong))


if __name__ == "__main__":
    main()
