"""Every built-in case against its published numbers: what each run computes, its miss, its band, and its role.

The runs are written to `docs/validation.json`, an entry a version with its date: the history is kept, and a version
that runs again replaces its own. `docs/validation.md` is made from that file alone, never by hand.
"""

import datetime
import json
import subprocess
import sys
from pathlib import Path
from typing import Any

from strikewave import __version__, load_case
from strikewave.cases.case import bundled_cases

ROOT = Path(__file__).parents[2]
RECORD = ROOT / "docs" / "validation.json"
PAGE = ROOT / "docs" / "validation.md"
WEAKEST = 3
"""Rows of predictions with the largest misses that the page names first."""
HEAD = """\
# Validation: built-in cases against published numbers

Made by `python scripts/validate/published.py` (`make validate`) from runs, never by hand; the numbers are in
`docs/validation.json`. A row is one published number. Its role: predicted (nothing was fitted to it), fitted (used
to choose a value of the case, so that agreement shows nothing), shown (not comparable; the note of the case has the
reason). The band is the range when inputs move within what is known of them. What was compared with measured
records and by elements has pages of its own: [fits to records](fit-measured.md), [Taylor bars](taylor-bars.md),
[split Hopkinson bars](hopkinson.md#real-shots), [the paper](reproduction.md).
"""


def rows_of(name: str) -> list[dict[str, Any]]:
    """Run a case as its command does, and return its comparisons, each with the band of its quantity."""
    words = [sys.executable, "-m", "strikewave", "run", name, "--json"]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    if done.returncode not in (0, 3):
        raise SystemExit(f"{name}: {done.stderr}")
    document = json.loads(done.stdout)
    bands = document.get("band") or {}
    return [
        {
            "case": name,
            "quantity": row["quantity"],
            "role": row["role"],
            "published": row["published"],
            "computed": row["computed"],
            "difference": row["difference"],
            "band": [bands[row["quantity"]][end] for end in ("low", "high")] if row["quantity"] in bands else None,
        }
        for row in document["published"]
    ]


def has_numbers(name: str) -> bool:
    """Tell whether a case has published numbers and runs in seconds: elements have pages of their own."""
    case = load_case(name)
    return bool(case.published) and case.fem is None


def line(row: dict[str, Any]) -> str:
    """Return a row of the table."""
    band = "-" if row["band"] is None else f"{row['band'][0]:.4g} to {row['band'][1]:.4g}"
    within = "-"
    if row["band"] is not None:
        within = "yes" if row["band"][0] <= row["published"] <= row["band"][1] else "no"
    miss = "-" if row["difference"] is None else f"{100 * row['difference']:+.1f} %"
    computed = "-" if row["computed"] is None else f"{row['computed']:.5g}"
    cells = (row["case"], f"`{row['quantity']}`", row["role"], f"{row['published']:.5g}", computed, miss, band, within)
    return f"| {' | '.join(cells)} |"


def page(history: dict[str, Any]) -> str:
    """Return the page of the newest version, with the totals of all."""
    version = max(history, key=lambda one: history[one]["date"])
    rows = history[version]["rows"]
    predicted = sorted(
        (row for row in rows if row["role"] == "predicted" and row["difference"] is not None),
        key=lambda row: -abs(row["difference"]),
    )
    table = [
        "| Case | Quantity | Role | Published (SI) | Computed (SI) | Miss | Band (SI) | Published within |",
        "| --- | --- | --- | ---: | ---: | ---: | --- | --- |",
    ]
    parts = [HEAD, "## The weakest predictions\n", *table, *map(line, predicted[:WEAKEST]), ""]
    parts += ["## History\n", "| Version | Date | Predicted | within 5 % | Fitted | Shown |"]
    parts += ["| --- | --- | ---: | ---: | ---: | ---: |"]
    for name, one in history.items():
        count = {role: [row for row in one["rows"] if row["role"] == role] for role in ("predicted", "fitted", "shown")}
        near = sum(row["difference"] is not None and abs(row["difference"]) <= 0.05 for row in count["predicted"])
        cells = (name, one["date"], len(count["predicted"]), near, len(count["fitted"]), len(count["shown"]))
        parts.append(f"| {' | '.join(map(str, cells))} |")
    return "\n".join([*parts, "", "## All rows\n", *table, *map(line, rows), ""])


def main() -> None:
    """Run the cases, keep what they gave, and write the page."""
    rows = [row for name in bundled_cases() if has_numbers(name) for row in rows_of(name)]
    history = json.loads(RECORD.read_text("utf-8")) if RECORD.exists() else {}
    history[__version__] = {"date": datetime.date.today().isoformat(), "rows": rows}
    RECORD.write_text(json.dumps(history, indent=1) + "\n", "utf-8")
    PAGE.write_text(page(history), "utf-8")
    print(f"{len(rows)} published numbers: {PAGE.relative_to(ROOT)}")


if __name__ == "__main__":
    main()
