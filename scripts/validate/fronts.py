"""Fronts that are known in closed form, searched for by each search of `design`, by as many runs.

    python scripts/validate/fronts.py

Problems of Zitzler, Deb & Thiele 2000 (Evolutionary Computation 8, 173-195) with three settings. What is found is the
share of the area that the known front dominates. Writes the table into docs/design.md. Two minutes of one core.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np
from kit import ROOT, table, write_into
from numpy.typing import NDArray

from strikewave.studies.search.evolution import DesignRuns
from strikewave.studies.search.goals import Objective
from strikewave.studies.search.ranking import ranking, trade_off_search

Array = NDArray[np.float64]

PAGE = ROOT / "docs" / "design.md"
SETTINGS, SEEDS = 3, 5
SEARCHES = 5
"""Of the ends of a front of two objectives, and of three points between."""
CORNER = 1.1
"""Of both objectives, below which areas are dominated: a tenth beyond the front, as is usual."""
SHAPES: dict[str, Callable[[Array, Array], Array]] = {
    "ZDT1, convex": lambda a, g: 1.0 - np.sqrt(a / g),
    "ZDT2, concave": lambda a, g: 1.0 - (a / g) ** 2,
    "ZDT3, in pieces": lambda a, g: 1.0 - np.sqrt(a / g) - a / g * np.sin(10.0 * np.pi * a),
}


def values_of(name: str, x: Array) -> Array:
    """Return both objectives at places (n, settings)."""
    g = 1.0 + 9.0 * x[:, 1:].mean(axis=1)
    return np.column_stack([x[:, 0], g * SHAPES[name](x[:, 0], g)])


class ClosedForm(DesignRuns):
    """Runs of a problem, without an engine."""

    def __init__(self, name: str, runs: int, seed: int) -> None:
        self.name, self.rows, self.failures, self.most = name, [], [], runs
        self._numbers, self._places = [], {}
        plan: Any = SimpleNamespace(
            variables=[SimpleNamespace(path=f"x{k}", is_range=True, words=()) for k in range(SETTINGS)],
            bounds=[(0.0, 1.0)] * SETTINGS,
            whole=[False] * SETTINGS,
            objectives=(Objective("a smallest", "a", 1.0), Objective("b smallest", "b", 1.0)),
            goals=(),
            runs=runs,
            seed=seed,
            search="evolution",
            by_surrogate=False,
            evaluation=SimpleNamespace(names=["a", "b"]),
            row_at=lambda place: tuple(map(float, place)),
            place_of=np.array,
        )
        self.plan = plan

    def of(self, rows: Sequence[Any]) -> Array:
        """Return the objectives of rows."""
        new = [row for row in dict.fromkeys(rows) if row not in self._places]
        for row, values in zip(new, values_of(self.name, np.array(new).reshape(len(new), SETTINGS)), strict=True):
            self._places[row] = len(self.rows)
            self.rows.append(row)
            self._numbers.append(values)
        return np.array([self._numbers[self._places[row]] for row in rows])

    def meet(self) -> bool:
        """All do: there is no goal."""
        return True


def dominated(points: Array) -> float:
    """Return the area that points dominate below the corner."""
    area, last = 0.0, CORNER
    for a, b in sorted(map(tuple, points)):
        if a < CORNER and b < last:
            area, last = area + (CORNER - a) * (last - b), b
    return area


def main() -> None:
    """Search, print and write."""
    rows = []
    for name in SHAPES:
        first = np.linspace(0.0, 1.0, 100_001)
        whole = dominated(values_of(name, np.column_stack([first, 0.0 * first, 0.0 * first])))
        for runs in (160, 480):
            shares = []
            for seed in range(SEEDS):
                evolved = ClosedForm(name, runs // SEARCHES, seed)
                ranking(evolved)
                found = ClosedForm(name, len(evolved.rows), seed)
                trade_off_search(found, 0)
                shares.append([dominated(one.numbers) / whole for one in (evolved, found)])
            by_evolution, by_optuna = 100.0 * np.mean(shares, axis=0)
            rows.append([name, f"{len(found.rows)}", f"{by_evolution:.0f} %", f"{by_optuna:.0f} %"])
            print(rows[-1], flush=True)
    write_into(PAGE, "fronts", table(["problem", "runs", "five searches by evolution", "optuna"], rows))


if __name__ == "__main__":
    main()
