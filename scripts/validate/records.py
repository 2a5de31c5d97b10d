"""Records with planted blows and faults: what is reported of them against their truth; two minutes.

    python scripts/validate/records.py [--output FOLDER]
    python scripts/validate/records.py --only ringing --seed 7 --show

draws from the classes of benchmarks/planted, clean and faulty, and writes records.md and records.csv (out/validate):
for each class bias and spread of the figures, the share of draws with a silent miss (a figure more than 5 % off the
truth that is stated as sound), and the share of clean records with a finding. ``--show`` draws one again, prints its
truth and what is reported, and writes a picture.
"""

import argparse
import os
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # for the processes: matrices are small
sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))

import planted_judge
import planted_show
from planted import classes

CLEAN = {"clean-single": 300, "clean-train": 160, "clean-campaign": 40}
FAULTY = {"campaign": 20, "single": 40}
"""Draws of a class: of one record, of a campaign."""


def counted(kind, scale):
    """Return how many draws of a class are made."""
    plain = CLEAN.get(kind) or FAULTY["campaign" if kind.endswith("-files") else "single"]
    return max(round(plain * scale), 1)


def main():
    """Judge all classes, or show one draw."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", action="append", choices=classes.CLASSES, help="a class; may be given again")
    parser.add_argument("--seed", type=int, default=0, help="the first seed, or the one to show")
    parser.add_argument("--scale", type=float, default=1.0, help="times as many draws")
    parser.add_argument(
        "--show", action="store_true", help="one draw of --only: its truth, what is reported, a picture"
    )
    parser.add_argument("--output", type=Path, default=Path("out/validate"))
    words = parser.parse_args()
    if words.show:
        print(planted_show.show(words.only[0], words.seed, words.output))
        return
    kinds = words.only or list(classes.CLASSES)
    items = [(kind, words.seed + k) for kind in kinds for k in range(counted(kind, words.scale))]
    begin = time.perf_counter()
    with ProcessPoolExecutor(os.cpu_count() or 1) as pool:
        verdicts = list(pool.map(planted_judge.judged_seed, items, chunksize=8))
    text = [planted_judge.markdown(verdicts), "", *planted_judge.totals(verdicts)]
    text += ["", "Worst draws:", "", *planted_judge.worst(verdicts)]
    words.output.mkdir(parents=True, exist_ok=True)
    (words.output / "records.md").write_text("\n".join(text) + "\n", "utf-8")
    planted_judge.write_csv(verdicts, words.output / "records.csv")
    print("\n".join(text))
    print(f"{time.perf_counter() - begin:.0f} s")


if __name__ == "__main__":
    main()
