"""Compare the JSON documents of two installed versions of strikewave, command by command.

    python scripts/compare_documents.py OLD/.venv/bin/strikewave .venv/bin/strikewave

Runs every built-in case, and each other command on samples that this script writes. Documents must be equal but for
version, times that ran and rates; each difference is printed with its path. Exit code 1 where there is one.
``--rename old=new`` (repeated) tells of keys that were renamed, ``--added KEY`` of keys that the old version had not,
``--words KEY`` of keys whose sentences may read otherwise; ``--only WORD`` takes the commands that hold a word.
"""

import argparse
import json
import math
import random
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

VOLATILE = {"version", "elapsed", "seconds", "wall", "cpu", "element_steps_per_second", "elapsed_seconds", "rate"}
"""Keys that tell how long a run took, not what it gave."""

SETUP = """
schema = 1
title = "Sample shot"
[bar.incident]
density = "7800 kg/m^3"
modulus = "210 GPa"
diameter = "20 mm"
gauge_distance = "0.8 m"
[bar.incident.gauge]
file = "shot.csv"
channel = "incident"
[bar.transmitted]
gauge_distance = "0.5 m"
[bar.transmitted.gauge]
file = "shot.csv"
channel = "transmitted"
[specimen]
length = "8 mm"
diameter = "12 mm"
density = "2700 kg/m^3"
modulus = "70 GPa"
[solver]
dispersion = "none"
"""

COMMANDS = (
    "run li-ma-2019 --set machine.speed=700rpm --set feed.blows=4",
    "validate li-ma-2019",
    "validate li-ma-2019-fem-wave",
    "validate setup.toml",
    "diff li-ma-2019 li-ma-2019-equal-blows",
    "cases",
    "materials",
    "laws",
    "impact --stiffness 4.7e9 --exponent 1.1111 --damping exact -e 0.5 --m1 0.2 --m2 0.459 --speed 20",
    "impact --law palmgren --length 40mm --material1 65Mn --material2 65Mn -e 0.6 --m1 0.2 --m2 inf --speed 5",
    "record blows.csv",
    "record blows.csv force.csv drifting.csv",
    "srs blows.csv",
    "srs drifting.csv --kind pseudo-velocity --q 25",
    "identify force.csv --mass 0.14 --speed 2",
    "hopkinson setup.toml",
    "buffer li-ma-2019-fig5 --sensor buffered --limit 5000g --layers 1",
    "scatter li-ma-2019-equal-blows --runs 12",
    "map li-ma-2019 --points 4x4 --train 20",
    "settings --interval 20ms --peak 4000g --width 200us --blows 5 --strikers 4 --striker-mass 0.2kg",
    "reproduce li-ma-2019 --without elements",
    "deck two-bars-fem",
    "deck two-bars-fem --code openradioss",
)


def write_samples(folder: Path) -> None:
    """Write records and a set-up that need nothing but this script."""
    draw = random.Random(1)
    rows = ["time [s],acceleration [g],hum [g]"]
    for i in range(40_000):
        t = i * 5e-6
        pulse = sum(
            (4000.0 + 10.0 * k) * max(math.sin(math.pi * (t - b) / 2e-4), 0.0) if 0.0 <= t - b < 2e-4 else 0.0
            for k, b in enumerate((0.02, 0.06, 0.10, 0.14))
        )
        rows.append(f"{t:.6f},{pulse + draw.gauss(0.0, 3.0):.6g},{5.0 * math.sin(2 * math.pi * 50.0 * t):.6g}")
    (folder / "blows.csv").write_text("\n".join(rows) + "\n")
    rows = ["time [s],acceleration [g]"]
    for i in range(20_000):
        t = i * 5e-6
        pulse = 900.0 * math.sin(math.pi * (t - 0.03) / 5e-4) if 0.0 <= t - 0.03 < 5e-4 else 0.0
        rows.append(f"{t:.6f},{pulse + 40.0 * t / 0.1 + draw.gauss(0.0, 1.0):.6g}")
    (folder / "drifting.csv").write_text("\n".join(rows) + "\n")
    rows = ["time [s],force [N]"]
    for i in range(4000):
        t = i * 1e-6
        shape = math.sin(math.pi * (t - 5e-4) / 8e-4) ** 1.3 if 0.0 < t - 5e-4 < 8e-4 else 0.0
        rows.append(f"{t:.7f},{9000.0 * shape + draw.gauss(0.0, 5.0):.6g}")
    (folder / "force.csv").write_text("\n".join(rows) + "\n")

    def trapezoid(t: float) -> float:
        return min(max(t / 2e-5, 0.0), 1.0) * min(max((1.2e-4 - t) / 2e-5, 0.0), 1.0)

    rows = ["time [us],incident [ustrain],transmitted [ustrain]"]
    speed = math.sqrt(210e9 / 7800.0)
    for i in range(9000):
        t = i * 1e-7
        back, on = t - 1e-4 - 2 * 0.8 / speed, t - 1e-4 - 1.3 / speed - 1.6e-6
        rows.append(
            f"{t * 1e6:.1f},{300 * trapezoid(t - 1e-4) - 120 * trapezoid(back) + draw.gauss(0.0, 0.2):.6g},"
            f"{180 * trapezoid(on) + draw.gauss(0.0, 0.2):.6g}"
        )
    (folder / "shot.csv").write_text("\n".join(rows) + "\n")
    (folder / "setup.toml").write_text(SETUP)


def document_of(program: str, command: str, folder: Path) -> tuple[int, object]:
    """Run a command with --json in a folder; return exit code and document (words where there is none)."""
    words = [Path(program).absolute(), *command.split(), "--json"]
    done = subprocess.run(words, cwd=folder, capture_output=True, text=True, check=False)
    try:
        return done.returncode, json.loads(done.stdout)
    except json.JSONDecodeError:
        return done.returncode, done.stderr.strip()


def differences(old: object, new: object, renamed: dict[str, str], aside: set[str], path: str = "") -> list[str]:
    """Return where two documents differ; keys of ``aside`` may."""
    if isinstance(old, dict) and isinstance(new, dict):
        old = {renamed.get(k, k): v for k, v in old.items() if k not in VOLATILE}
        new = {k: v for k, v in new.items() if k not in VOLATILE}
        old, new = ({k: v for k, v in one.items() if k not in aside} for one in (old, new))
        found = [f"{path}.{k}: only in the {'old' if k in old else 'new'}" for k in old.keys() ^ new.keys()]
        return found + [
            d for k in old.keys() & new.keys() for d in differences(old[k], new[k], renamed, aside, f"{path}.{k}")
        ]
    if isinstance(old, list) and isinstance(new, list) and len(old) == len(new):
        rows = (
            differences(a, b, renamed, aside, f"{path}[{k}]") for k, (a, b) in enumerate(zip(old, new, strict=True))
        )
        return [difference for row in rows for difference in row]
    return [] if old == new else [f"{path}: {str(old)[:80]} -> {str(new)[:80]}"]


def main() -> int:
    """Compare, print a line a command, and return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("old")
    parser.add_argument("new")
    parser.add_argument("--only", default="")
    parser.add_argument("--rename", action="append", default=[])
    parser.add_argument("--added", action="append", default=[])
    parser.add_argument("--words", action="append", default=[])
    asked = parser.parse_args()
    renamed = dict(pair.split("=") for pair in asked.rename)
    aside = {*asked.added, *asked.words}
    broken = 0
    with tempfile.TemporaryDirectory() as made, ThreadPoolExecutor(2) as pool:
        folder = Path(made)
        write_samples(folder)
        _, listed = document_of(asked.old, "cases", folder)
        cases = [f"{row['command']} {row['name']}" for row in listed["cases"]]
        for command in [c for c in (*cases, *COMMANDS) if asked.only in c]:
            pair = pool.map(lambda program, c=command: document_of(program, c, folder), (asked.old, asked.new))
            (old_code, old), (new_code, new) = pair
            found = differences(old, new, renamed, aside)
            found += [f"exit code {old_code} -> {new_code}"] if old_code != new_code else []
            found += [] if isinstance(new, dict) else ["no document: the command is refused"]
            kind = "document" if isinstance(new, dict) else f"words: {new}"
            print(f"{'DIFFERS' if found else 'equal':8}{command} (exit {new_code}, {kind})"[:160], flush=True)
            for line in found[:20]:
                print(f"        {line}")
            broken += bool(found)
    print(f"{broken} commands differ")
    return 1 if broken else 0


if __name__ == "__main__":
    sys.exit(main())
