"""The maps behind the ranges of Li & Ma 2019 in finer steps: gaskets of Figure 5, joints of Figure 13; some minutes.

    python scripts/validate/li_ma_2019_maps.py [FOLDER]

writes gaskets.csv, joints.csv and both pictures into FOLDER (out/validate), and prints the ranges.
"""

import csv
import os
import sys
from dataclasses import astuple, fields
from pathlib import Path

from strikewave.papers.li_ma_2019.figures import gasket_figure, joint_figure
from strikewave.papers.li_ma_2019.published import published_number
from strikewave.papers.li_ma_2019.report_tables import span_text
from strikewave.papers.li_ma_2019.runs import executing
from strikewave.papers.li_ma_2019.unknowns import FINE_GASKETS as FINE_GASKETS
from strikewave.papers.li_ma_2019.unknowns import FINE_JOINTS as FINE_JOINTS
from strikewave.papers.li_ma_2019.unknowns import FixtureBlow, GasketCell, Unknowns, gasket_study, joint_study
from strikewave.studies.engine.pools import ProcessPool


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
