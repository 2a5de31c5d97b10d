"""Response channels with planted faults: what is reported of them against their truth; ten minutes.

    python scripts/validate/response_channels.py [--output FOLDER] [--only board-hum] [--seed 0] [--draws 100]

draws boards from benchmarks/planted/boards.py, clean and faulty, and writes response-channels.md (out/validate): for
each class the share of draws with a silent miss (a figure off the truth that is stated as sound), on which the fault is
named, and the false alarms on clean ones.
"""

import argparse
import os
import sys
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # matrices are small
sys.path.insert(0, str(Path(__file__).parents[2] / "benchmarks"))

import planted_boards
from planted import boards


def main():
    """Judge all classes, or some."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", action="append", choices=boards.CLASSES, help="a class; may be given again")
    parser.add_argument("--seed", type=int, default=0, help="the first seed")
    parser.add_argument("--draws", type=int, default=100, help="of each class")
    parser.add_argument("--output", type=Path, default=Path("out/validate"))
    words = parser.parse_args()
    lines = planted_boards.table(words.only or list(boards.CLASSES), words.draws, words.seed)
    words.output.mkdir(parents=True, exist_ok=True)
    (words.output / "response-channels.md").write_text("\n".join(lines) + "\n", "utf-8")
    print("\n".join(lines))


if __name__ == "__main__":
    main()
