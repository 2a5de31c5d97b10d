"""The maps behind the ranges of Li & Ma 2019 in finer steps: gaskets of Figure 5, joints of Figure 13; some minutes.

    python scripts/validate/li_ma_2019_maps.py [FOLDER]

writes gaskets.csv, joints.csv and both pictures into FOLDER (out/validate), and prints the ranges.
"""

import csv
import itertools
import os
import sys
from dataclasses import astuple, fields
from pathlib import Path

import numpy as np

from strikewave.papers.li_ma_2019.figures import gasket_figure, joint_figure
from strikewave.papers.li_ma_2019.published import published_number
from strikewave.papers.li_ma_2019.report_tables import span_text
from strikewave.papers.li_ma_2019.runs import executing
from strikewave.papers.li_ma_2019.unknowns import (
    RIGID,
    FixtureBlow,
    GasketCell,
    GasketGrid,
    JointGrid,
    Unknowns,
    gasket_study,
    joint_study,
)
from strikewave.studies.engine.pools import ProcessPool

FINE_GASKETS = GasketGrid(
    tuple(float(f"{modulus:.3g}") for modulus in np.geomspace(5e6, 1e9, 13)),
    (0.05, 0.1, 0.2, 0.3, 0.4, 0.6, 0.8, 1.0),
    (1e-3, 2e-3, 3e-3, 4.5e-3, 6e-3),
)
"""The gaskets of the command in finer steps: minutes."""
FINE_JOINTS = JointGrid(
    tuple(float(f"{preload:.3g}") for preload in np.geomspace(30.0, 30e3, 13)),
    (*(float(f"{stiffness:.3g}") for stiffness in np.geomspace(0.2e9, 20e9, 13)), RIGID),
    tuple(itertools.product((100.0, 300.0, 1e3, 3e3), (0.5e9, 1e9, 2e9, 5e9))),
)
"""The joints of the command in finer steps."""


def main() -> None:
    """Run both maps and write them."""
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else "out/validate")
    folder.mkdir(parents=True, exist_ok=True)
    with executing(pool=ProcessPool(os.cpu_count() or 1)) as execution:
        unknowns = Unknowns(gasket_study(execution, FINE_GASKETS), joint_study(execution, FINE_JOINTS))
    heads = [field.name for field in fields(GasketCell)]
    _write(folder / "gaskets.csv", heads, [astuple(cell) for cell in unknowns.gaskets.cells])
    heads = ["preload", "stiffness", *(field.name for field in fields(FixtureBlow))]
    rows = [(cell.preload, cell.stiffness, *astuple(cell.blow)) for cell in unknowns.joints.cells]
    _write(folder / "joints.csv", heads, rows)
    gasket_figure(unknowns.gaskets).savefig(folder / "gaskets.png", dpi=120)
    joint_figure(unknowns.joints).savefig(folder / "joints.png", dpi=120)
    for name, span in unknowns.ranges().items():
        unit = published_number(name).unit
        print(f"{name}: {span_text(span.low, span.high, unit)}, left open by {span.left_by}")
    scatter = [one.sensor for one in unknowns.joints.trains]
    print(f"scatter of peaks, {len(scatter)} trains with joints that chatter: {min(scatter):.1%} to {max(scatter):.1%}")


def _write(path: Path, heads: list[str], rows: list[tuple[object, ...]]) -> None:
    """Write a table, SI."""
    with path.open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(heads)
        writer.writerows(rows)


if __name__ == "__main__":
    main()
