"""The two published numbers of Li & Ma 2019, refitted from elsewhere, and what they leave open of the machine.

    python scripts/validate/li_ma_2019_fit.py

Engagement and frame stiffness begin 10, 30 and 50 % off, in all four ways; they are fitted to 4151.25 g and 200 us.
Then each value that the paper does not give is moved over what is plausible of it, both are fitted anew, and the fitted
machine makes its eleven blows: all of these machines give the two numbers. Last, each is fitted together with the two.
Prints the tables, writes them into docs/fit-measured.md and the picture beside it. Three minutes of one core.
"""

from __future__ import annotations

import functools
import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from kit import IMAGES, PAGE, table, write_into

from strikewave import FitStudy, fit, load_case
from strikewave.base.constants import STANDARD_GRAVITY
from strikewave.cases.plausible import PLAUSIBLE, PlausibleRange
from strikewave.reporting.style import BLUE, GREY, RED, new_figure, quiet, save
from strikewave.studies.engine.case_evaluation import CaseEvaluation
from strikewave.studies.fit.result import combination_words, separating_words

NAME = "li-ma-2019"
FREE = ("machine.engagement", "object.frame_stiffness")
HEADS, UNITS = ("engagement (mm)", "frame stiffness (MN/m)"), (1e-3, 1e6)
"""How they are shown."""
BOUNDS = (f"{FREE[0]}=1 mm..20 mm", f"{FREE[1]}=10 MN/m..1 GN/m")
"""The same wherever a search begins."""
OFF = (0.1, 0.3, 0.5)
"""By how much the values are off where a search begins."""
NOT_GIVEN = {
    "striker.mass": PlausibleRange("factor", 1.5, "the paper gives no mass of a striker"),
    "object.mass": PlausibleRange("share", 0.1, "inferred from a force and an acceleration of its simulation"),
} | {
    path: PLAUSIBLE[path]
    for path in (
        "striker.mount_stiffness",
        "striker.mount_damping",
        "object.nose_mass",
        "object.frame_damping",
        "contact.restitution",
        "machine.inertia",
    )
}
"""What the paper does not give and the first pulse feels, and how far it may be off."""
PREDICTED = {
    "first.blow_velocity_change": ("velocity change of the blow (m/s)", 1.0),
    "typical.rigid_peak": ("later peaks (g)", STANDARD_GRAVITY),
}
"""What the fitted machines are asked for: heading, and its unit."""
STEPS = 2
"""Fits from the middle of a range to each end: each begins where the last one ended."""


def fitted(changes: Sequence[str], free: Sequence[str] = BOUNDS) -> FitStudy:
    """Return the two numbers fitted by a machine that is changed."""
    return fit(load_case(NAME, changes), (), free)


def starts() -> str:
    """Return the table of searches that begin elsewhere."""
    case, rows = load_case(NAME), []
    for off, signs in itertools.product(OFF, itertools.product((1.0, -1.0), repeat=2)):
        changes = [
            f"{path}={case.values()[path].si * (1.0 + sign * off)!r}" for path, sign in zip(FREE, signs, strict=True)
        ]
        study = fitted(changes)
        values = [one.value / case.values()[one.field.path].si - 1.0 for one in study.parameters]
        cells = [f"{100.0 * sign * off:+.0f} %" for sign in signs]
        cells += [f"{one.value / unit:.5f}" for one, unit in zip(study.parameters, UNITS, strict=True)]
        cells += [f"{100.0 * max(map(abs, values)):.1g} %"]
        cells += [f"{study.computed[0] / STANDARD_GRAVITY:.2f}", f"{study.computed[1] * 1e6:.3f}"]
        rows.append([*cells, str(study.solved.runs)])
        print(" | ".join(rows[-1]), flush=True)
    heads = ["engagement begins", "frame stiffness begins", *HEADS]
    return table([*heads, "off the stored ones", "peak (g)", "pulse width (µs)", "runs"], rows)


@dataclass(frozen=True)
class Machine:
    """A machine with another value of what is not given: fitted values and predictions, SI; whether it gives both."""

    values: tuple[float, float]
    predicted: tuple[float, ...]
    met: bool

    @property
    def shown(self) -> list[float]:
        """All of it in the units of the picture."""
        units = [*UNITS, *(size for _, size in PREDICTED.values())]
        return [value / unit for value, unit in zip((*self.values, *self.predicted), units, strict=True)]


@functools.cache
def machine(path: str, size: float, begin: tuple[float, float] | None = None) -> Machine:
    """Return the machine with one value, fitted from where another ended."""
    changes = [f"{path}={size!r}", *(f"{one}={value!r}" for one, value in zip(FREE, begin or (), strict=False))]
    study = fitted(changes)
    whole = load_case(NAME, [changes[0], *(f"{one.field.path}={one.value!r}" for one in study.parameters)])
    values = study.parameters[0].value, study.parameters[1].value
    met = all(one.size < 1e-3 for one in study.solved.misfits)
    return Machine(values, CaseEvaluation("fast", tuple(PREDICTED))(whole).numbers, met)


def moved(path: str) -> list[Machine]:
    """Return the machines along the range of what is not given, from its low end to its high one."""
    values, first, sides = load_case(NAME).values(), next(iter(NOT_GIVEN)), []
    middle = values[path]
    for end in NOT_GIVEN[path].ends(middle.si):
        side = [machine(first, values[first].si)]  # that of the case, whatever moves
        for step in range(1, STEPS + 1):
            share = step / STEPS
            size = middle.si + share * (end - middle.si)
            if NOT_GIVEN[path].form == "factor":
                size = middle.si * (end / middle.si) ** share
            side.append(machine(path, size, side[-1].values))
        sides.append(side)
    return [*sides[0][:0:-1], *sides[1]]


def words(path: str, found: list[Machine]) -> list[str]:
    """Return the row of what is not given."""
    value = load_case(NAME).values()[path]
    low, high = (value.model_copy(update={"si": end}) for end in NOT_GIVEN[path].ends(value.si))
    study = fitted([], [*BOUNDS, path])
    field = study.parameters[2].field
    said = [
        f"{combination_words(study, group)}; {separating_words(study, group)}"
        for group in study.solved.estimate.groups()
    ]
    spans = [f"{min(own):.4g} to {max(own):.4g}" for own in zip(*(one.shown for one in found), strict=True)]
    met = "" if all(one.met for one in found) else " (not met at an end)"
    print(path, spans, said, flush=True)
    return [f"`{path}` {field.shown(low.si, 3)} to {field.shown(high.si, 3)}{met}", *spans, "; ".join(said)]


def draw(study: FitStudy, found: dict[str, list[Machine]]) -> None:
    """Draw how both values and the predictions go with each value that is not given."""
    figure = new_figure((9.0, 3.6))
    heads = [*HEADS, *(head for head, _ in PREDICTED.values())]
    order = sorted(found, key=lambda path: np.ptp([one.shown[0] for one in found[path]]))
    for column, (axes, head) in enumerate(zip(figure.subplots(1, 4, sharey=True), heads, strict=True)):
        for place, path in enumerate(order):
            line = [one.shown[column] for one in found[path]]
            axes.plot(line, [place] * len(line), color=BLUE, linewidth=2.0, clip_on=False)
            axes.plot(line[0], place, "o", color=BLUE, markerfacecolor="white", markersize=6, clip_on=False)
            axes.plot(line[-1], place, "o", color=BLUE, markersize=6, clip_on=False)
        nominal = found[order[0]][STEPS].shown[column]
        axes.axvline(nominal, color=GREY, linewidth=0.8)
        if column < 2:
            one, unit = study.parameters[column], UNITS[column]
            axes.axvspan(one.low / unit, one.high / unit, color=RED, alpha=0.15, linewidth=0.0)
        axes.set_yticks(range(len(order)), [path.replace(".", ": ").replace("_", " ") for path in order])
        quiet(axes, "", head, "")
    save(figure, IMAGES / "fit-li-ma-2019.svg")


def main() -> None:
    """Fit, print and write."""
    texts = {"starts": starts()}
    found = {path: moved(path) for path in NOT_GIVEN}
    heads = ["what is not given, and its range", *HEADS]
    heads += [*(head for head, _ in PREDICTED.values()), "the fit of all three says"]
    texts["not given"] = table(heads, [words(path, own) for path, own in found.items()])
    for name, text in texts.items():
        print(f"\n{text}")
        write_into(PAGE, name, text)
    draw(fitted([]), found)


if __name__ == "__main__":
    main()
