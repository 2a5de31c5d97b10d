"""Hold the code to its budgets: lines and files of each room, imports, repeated runs of lines, what commands enter.

    python scripts/budget.py              # a table; exit code 1 where something is above its budget
    python scripts/budget.py --commands   # also files and functions that commands enter, half a minute

The budgets stand in ``scripts/budgets.toml``; raising one there needs a sentence beside it.
"""

from __future__ import annotations

import argparse
import ast
import contextlib
import keyword
import os
import re
import subprocess
import sys
import tempfile
import tomllib
from collections import Counter, defaultdict
from collections.abc import Iterator
from itertools import combinations
from pathlib import Path

ROOT = Path(__file__).parents[1]
PACKAGE = ROOT / "src" / "strikewave"
REPEATED = 12
"""Lines of a run that stands twice: shorter ones are often a signature, or a table with a row more."""
DIFFERENT = 4
"""Shapes among these lines: rows of a table are alike, and each shift of it would count."""
COMMON = 8
"""Places of a run beyond which it is a shape of the language, not code that was written again."""
TOKEN = re.compile(r"\"[^\"]*\"|\b[A-Za-z_]\w*|\b\d[\w.]*")
WATCH = """
import os, sys
import strikewave
from strikewave.cli.app import app
root = os.path.dirname(strikewave.__file__) + os.sep
files, functions = set(), set()

def imports(frame):
    while frame is not None:
        code = frame.f_code
        if code.co_name == "<module>" and code.co_filename.startswith(root) and "__main__" not in code.co_filename:
            return True
        frame = frame.f_back
    return False

def watch(frame, event, _):
    code = frame.f_code
    if event == "call" and code.co_filename.startswith(root) and code.co_name != "<module>" and not imports(frame):
        files.add(code.co_filename)
        functions.add((code.co_filename, code.co_qualname))

sys.setprofile(watch)
try:
    app(sys.argv[1:], standalone_mode=False)
except SystemExit:
    pass
finally:
    sys.setprofile(None)
    print(len(files), len(functions), file=sys.stderr)
"""
"""Counts what a command calls, not what is called while modules are imported."""


def room_sizes(package: Path) -> dict[str, tuple[int, int]]:
    """Return lines and files of each room; what lies above all rooms is called top."""
    lines, files = Counter[str](), Counter[str]()
    for path in package.rglob("*.py"):
        parts = path.relative_to(package).parts
        room = parts[0] if len(parts) > 1 else "top"
        lines[room] += len(path.read_text("utf-8").splitlines())
        files[room] += 1
    return {room: (lines[room], files[room]) for room in sorted(lines)}


def import_share(package: Path) -> float:
    """Return the share of lines that are imports, in percent."""
    lines = imports = 0
    for path in package.rglob("*.py"):
        text = path.read_text("utf-8")
        lines += len(text.splitlines())
        nodes = [node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Import | ast.ImportFrom)]
        imports += sum((node.end_lineno or node.lineno) - node.lineno + 1 for node in nodes)
    return 100.0 * imports / lines


def lone_modules(package: Path) -> list[str]:
    """Return the modules that one other imports, and no more."""
    importers = defaultdict(set)
    modules = {}
    for path in package.rglob("*.py"):
        parts = path.relative_to(package.parent).with_suffix("").parts
        modules[".".join(parts)] = path
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.ImportFrom) and node.module:
                for name in (node.module, *(f"{node.module}.{each.name}" for each in node.names)):
                    importers[name].add(path)
            elif isinstance(node, ast.Import):
                for each in node.names:
                    importers[each.name].add(path)
    named = {name: path for name, path in modules.items() if path.name != "__init__.py"}
    return sorted(name for name, path in named.items() if len(importers[name] - {path}) == 1)


def shapes(text: str) -> Iterator[tuple[int, str]]:
    """Yield lines of code with their numbers, names and values taken out.

    Imports, comments, empty lines and strings that describe what stands before them are left out.
    """
    for number, line in enumerate(text.splitlines(), 1):
        code = line.partition("#")[0].strip()
        if re.search(r"\w", code) and not code.startswith(("import ", "from ", '"""')):
            yield number, TOKEN.sub(lambda found: found[0] if keyword.iskeyword(found[0]) else "x", code)


def repeats(package: Path) -> list[tuple[str, str]]:
    """Return the places, two by two, that share a run of lines of one shape."""
    places = defaultdict(list)
    for path in sorted(package.rglob("*.py")):
        lines = list(shapes(path.read_text("utf-8")))
        for first in range(len(lines) - REPEATED + 1):
            run = tuple(code for _, code in lines[first : first + REPEATED])
            if len(set(run)) >= DIFFERENT:
                places[run].append((path, first, lines[first][0]))
    shared = {}
    for found in places.values():
        if len(found) <= COMMON:
            for one, other in combinations(found, 2):
                if one[0] != other[0] or other[1] - one[1] >= REPEATED:
                    shared[one[:2], other[:2]] = one[2], other[2]
    begins = [pair for pair in shared if tuple((path, first - 1) for path, first in pair) not in shared]
    return [
        (f"{one.relative_to(package)}:{lines[0]}", f"{other.relative_to(package)}:{lines[1]}")
        for (one, other), lines in ((tuple(path for path, _ in pair), shared[pair]) for pair in begins)
    ]


def entered(words: str) -> tuple[int, int]:
    """Return how many files and functions of the package a command enters in its process."""
    with tempfile.TemporaryDirectory() as folder:
        sys.path.insert(0, str(Path(__file__).parent))
        from corpus.samples import write_samples

        write_samples(Path(folder))
        quiet = {**os.environ, "COLUMNS": "80"}
        command = [sys.executable, "-c", WATCH, *words.split(), "--out", "out"]
        ended = subprocess.run(command, cwd=folder, env=quiet, capture_output=True, text=True, check=True)
    files, functions = ended.stderr.split()[-2:]
    return int(files), int(functions)


def main() -> int:
    """Print the table, and return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--commands", action="store_true")
    parser.add_argument("--list", action="store_true", help="also list repeated runs and modules with one importer")
    asked = parser.parse_args()
    budgets = tomllib.loads((ROOT / "scripts" / "budgets.toml").read_text("utf-8"))
    sizes = room_sizes(PACKAGE)
    alone, twice = lone_modules(PACKAGE), repeats(PACKAGE)
    rows: list[tuple[str, float, float]] = []
    for k, what in enumerate(("lines", "files")):
        limits = {room: budgets["rooms"].get(room, {}).get(what, 0) for room in sizes}
        rows += [(f"{room}, {what}", both[k], limits[room]) for room, both in sizes.items()]
        rows.append((f"all, {what}", sum(both[k] for both in sizes.values()), sum(limits.values())))
    rows.append(("imports, percent of lines", round(import_share(PACKAGE), 1), budgets["imports"]))
    rows.append(("modules with one importer", len(alone), budgets["one_importer"]))
    rows.append((f"repeated runs of {REPEATED} lines", len(twice), budgets["repeats"]))
    if asked.commands:
        for words, limits in budgets["commands"].items():
            for what, count in zip(("files", "functions"), entered(words), strict=True):
                rows.append((f"{words} enters {what}", count, limits[what]))
    with contextlib.suppress(BrokenPipeError):
        if asked.list:
            print("\n".join([*alone, *(" ~ ".join(pair) for pair in twice)]))
        for label, size, budget in rows:
            over = "  above its budget: make it less, or raise the budget with a sentence why" if size > budget else ""
            print(f"{label:36} {size:>8} of {budget:>8}{over}")
    return 1 if any(size > budget for _, size, budget in rows) else 0


if __name__ == "__main__":
    sys.exit(main())
