"""Look up the packages of requirements/dev.txt among known vulnerabilities, by pip-audit, where PyPI's list is reached.

`make lint` runs it. It ends with 1 where there is one that is not among `ACCEPTED`; what is not looked up is named.
"""

from __future__ import annotations

import json
import subprocess
import sys
import urllib.request
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]
PACKAGES = ROOT / "requirements/dev.txt"
LIST = "https://pypi.org/pypi/pip/24.0/json"
"""A page of PyPI that names vulnerabilities, as each page of a version does; mirrors often lack these pages."""
PATIENCE = 10.0
"""Seconds to wait for it."""
ACCEPTED: Mapping[str, str] = {}
"""Vulnerabilities by their identifier that do not concern us, each with its reason."""


def main() -> int:
    """Look the packages up and print what was found; return the exit code."""
    try:
        with urllib.request.urlopen(LIST, timeout=PATIENCE) as page:
            json.load(page)["vulnerabilities"]
    except (OSError, ValueError, KeyError) as error:
        print(f"known vulnerabilities: not looked up, as {LIST} cannot be reached: {error}")
        return 0
    audit = ROOT / ".audit"
    subprocess.run([sys.executable, "-m", "venv", audit], check=True)
    subprocess.run([audit / "bin/python", "-m", "pip", "install", "--quiet", "pip-audit"], check=True)
    command = [audit / "bin/pip-audit", "--disable-pip", "--format", "json", "--requirement", PACKAGES]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if not done.stdout:
        print(f"known vulnerabilities: not looked up, pip-audit ended with {done.returncode}: {done.stderr[-300:]}")
        return 0
    lines, count = told(json.loads(done.stdout)["dependencies"])
    print(*lines, sep="\n")
    return min(count, 1)


def told(packages: Sequence[Mapping[str, Any]]) -> tuple[list[str], int]:
    """Return what is to be said of the packages in a report of pip-audit, and how many vulnerabilities count."""
    looked_up = [one for one in packages if "vulns" in one]
    left_out = [one["name"] for one in packages if "vulns" not in one]
    found = [(one, flaw) for one in looked_up for flaw in one["vulns"] if flaw["id"] not in ACCEPTED]
    lines = [f"known vulnerabilities: {len(found)} in {len(looked_up)} packages"]
    lines += [
        f"{one['name']} {one['version']}: {flaw['id']}, mended in {', '.join(flaw['fix_versions']) or 'no version'}"
        for one, flaw in found
    ]
    lines += [f"not looked up: {', '.join(left_out)}"] if left_out else []
    return lines, len(found)


if __name__ == "__main__":
    sys.exit(main())
