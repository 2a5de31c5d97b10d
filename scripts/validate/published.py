"""Every built-in case against its published numbers: what each run computes, its miss, its band, and its role.

Runs each case as its command does; cases of elements are those of `reproduction.py`. A minute.
"""

import json
import subprocess
import sys

from kit import Comparison, keep

from strikewave import load_case
from strikewave.cases.files import bundled_cases
from strikewave.cases.tables.common import published_unit


def rows_of(name: str) -> list[Comparison]:
    """Return the comparisons of a case, each with the band of its quantity."""
    words = [sys.executable, "-m", "strikewave", "run", name, "--json"]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    if done.returncode not in (0, 3):
        raise SystemExit(f"{name}: {done.stderr}")
    document = json.loads(done.stdout)
    bands, rows = document.get("band") or {}, []
    for row, entry in zip(document["published"], load_case(name).published, strict=True):
        band, own = bands.get(row["quantity"]), row["quantity"]
        rows.append(
            Comparison(
                what=name,
                quantity=own if not entry.sensor else f"{own} {entry.sensor}",
                against=row["measured_or_simulated"],
                role=row["role"],
                reference=row["published"],
                computed=row["computed"],
                unit=published_unit(own),
                band=None if band is None else (band["low"], band["high"]),
                note=entry.note,
            )
        )
    return rows


def runs_in_seconds(name: str) -> bool:
    """Tell whether a case has published numbers and no elements."""
    case = load_case(name)
    return bool(case.published) and case.fem is None


def main() -> None:
    """Run the cases and keep what they gave."""
    keep("machines", [row for name in bundled_cases() if runs_in_seconds(name) for row in rows_of(name)])


if __name__ == "__main__":
    main()
