"""Records with planted blows and faults: what is reported of them against their truth; two minutes.

    python scripts/validate/records.py [--output FOLDER]
    python scripts/validate/records.py --only ringing --seed 7 --show

draws from the classes of benchmarks/planted, clean and faulty, and writes records.md and records.csv (out/validate):
for each class bias and spread of the figures, the share of draws with a silent miss (a figure more than 5 % off the
truth that is stated as sound), and the share of clean records with a finding. ``--show`` draws one again, prints its
truth and what is reported, and writes a picture.

    python scripts/validate/records.py --measured FOLDER [--channel 1] [--unit g] [--earlier measured.csv]

plants faults in copies of measured records of one test instead, prints whether each is judged right, and writes the
figures of the records as they are to measured.csv, to be compared with by a later run.
"""

import argparse
import os
import sys
import time
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # for the processes: matrices are small
sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))

import planted_in_measured
import planted_judge
import planted_show
from planted import classes


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
    parser.add_argument("--measured", type=Path, help="a folder of records of one test")
    parser.add_argument("--channel", default="1", help="of the measured records")
    parser.add_argument("--unit", default="g", help="of the measured records")
    parser.add_argument("--earlier", type=Path, help="measured.csv of an earlier run")
    words = parser.parse_args()
    words.output.mkdir(parents=True, exist_ok=True)
    if words.measured:
        written = words.output / "measured.csv"
        lines = planted_in_measured.report(words.measured, words.channel, words.unit, words.earlier, written)
        (words.output / "measured.md").write_text("\n".join(lines) + "\n", "utf-8")
        print("\n".join(lines))
        return
    if words.show:
        print(planted_show.show(words.only[0], words.seed, words.output))
        return
    kinds = words.only or list(classes.CLASSES)
    begin = time.perf_counter()
    verdicts = planted_judge.judged_classes(kinds, words.scale, words.seed)
    text = [
        planted_judge.markdown(verdicts),
        "",
        *planted_judge.totals(verdicts),
        *planted_judge.sorted_misses(verdicts),
    ]
    text += ["", "Worst draws:", "", *planted_judge.worst(verdicts)]
    (words.output / "records.md").write_text("\n".join(text) + "\n", "utf-8")
    planted_judge.write_csv(verdicts, words.output / "records.csv")
    print("\n".join(text))
    print(f"{time.perf_counter() - begin:.0f} s")


if __name__ == "__main__":
    main()
