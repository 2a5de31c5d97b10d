"""Make small faults in the code of a room, one at a time, and see whether a test beside it fails.

    python scripts/mutate.py contact --seed 1 --count 30

A sample of the faults of the room (`scripts/mutation/sites.py`) is drawn by its seed. A fault is run by the tests of
`tests/<room>` that enter its line (doctests, and those of ``make verify``, do not count), the shortest first, until one
fails. What comes of each is kept in ``.mutants``: a killed one is not tried again as long as its file stands, a
survivor is tried on the files of tests that have changed. Kept libraries do not fit: mutmut puts every version of a
function into its module, which the compiler of the kernels does not follow, and cosmic-ray starts the tests anew for
each fault, some ten times as long. Linux and macOS only: a fault is run in a copy of the process.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import random
import sys
import tomllib
from collections import Counter
from collections.abc import Iterable, Sequence
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # before numpy is imported
ROOT = Path(__file__).resolve().parents[1]

import pytest  # noqa: E402
from mutation.session import Runner  # noqa: E402
from mutation.sites import Site, sites_of  # noqa: E402
from scipy.stats import binomtest  # noqa: E402

FOLDERS = "contact waves machines signal records sensors fem uncertainty specifications hopkinson studies/fit"
ROOMS = {folder.rpartition("/")[2]: folder for folder in FOLDERS.split()}
"""Folders by their rooms, in src/strikewave and in tests."""
PLUGINS = [word for name in ("cacheprovider", "xdist", "doctest") for word in ("-p", f"no:{name}")]
"""Of pytest, that are left out."""
EQUIVALENT = ROOT / "scripts" / "mutation" / "equivalent.toml"


def sampled(room: str, seed: int, count: int, kernels: bool = True) -> dict[str, Site]:
    """Return a sample of the faults of a room by their names, in the order they are drawn in."""
    found = []
    for path in sorted((ROOT / "src/strikewave" / ROOMS[room]).rglob("*.py")):
        text = path.read_text("utf-8")
        found += [(site.name(text), site) for site in sites_of(path, ROOT) if kernels or not site.kernel]
    return dict(random.Random(f"{room} {seed}").sample(found, min(count, len(found))))


def digest(paths: Iterable[Path]) -> str:
    """Return a key of the contents of files."""
    key = hashlib.sha256()
    for path in sorted(paths):
        key.update(path.as_posix().encode() + path.read_bytes())
    return key.hexdigest()[:16]


def digests(tests: Path) -> dict[str, str]:
    """Return keys of the files of tests, by their paths; each has what they share in it."""
    files = sorted(tests.rglob("*.py"))
    of_tests = [file for file in files if file.name.startswith("test_")]
    shared = [ROOT / "tests/conftest.py", *(file for file in files if file not in of_tests)]
    return {file.relative_to(ROOT).as_posix(): digest([file, *shared]) for file in of_tests}


def known(file: Path) -> dict[str, dict[str, object]]:
    """Return what came of faults, the last by name."""
    if not file.exists():
        return {}
    return {line["name"]: line for line in map(json.loads, file.read_text("utf-8").splitlines())}


def equivalents() -> dict[str, str]:
    """Return reasons of faults that change nothing anybody could see, by name."""
    return tomllib.loads(EQUIVALENT.read_text("utf-8")) if EQUIVALENT.exists() else {}


def run(room: str, sample: dict[str, Site], jobs: int, folder: Path) -> list[dict]:
    """Try faults of a room, by their names; return what came of each."""
    tests = ROOT / "tests" / ROOMS[room]
    of_tests, of_source = digests(tests), digest((ROOT / "src").rglob("*.py"))
    kept_file = folder / f"{room}.jsonl"
    before = known(kept_file)
    files = {site.file: digest([ROOT / site.file]) for site in sample.values()}
    folder.mkdir(parents=True, exist_ok=True)

    def same_source(name: str, site: Site) -> bool:
        return name in before and before[name]["source"] == files[site.file]

    def stands(name: str, site: Site) -> bool:
        return same_source(name, site) and (before[name]["state"] == "killed" or before[name]["tests"] == of_tests)

    names = {site: name for name, site in sample.items() if not stands(name, site)}
    survived = [site for site, name in names.items() if same_source(name, site) and before[name]["state"] == "survived"]
    tried = {site: before[names[site]]["tests"] for site in survived if isinstance(before[names[site]]["tests"], dict)}
    if names:
        with kept_file.open("a", encoding="utf-8") as out:

            def report(site: Site, state: str, test: str, seconds: float, ran: int) -> None:
                line = {
                    "name": names[site],
                    "state": state,
                    "file": site.file,
                    "line": site.line,
                    "scope": site.scope,
                    "kind": site.kind,
                    "before": site.before,
                    "after": site.after,
                    "test": test,
                    "ran": ran,
                    "seconds": round(seconds, 2),
                    "source": files[site.file],
                    "tests": of_tests,
                }
                out.write(json.dumps(line) + "\n")
                out.flush()
                print(worded(line), flush=True)

            cover = folder / f"cover-{room}-{of_source}"
            runner = Runner(ROOT, list(names), cover, of_tests, tried, jobs, report)
            words = [
                "-q",
                *PLUGINS,
                "-o",
                "addopts=--import-mode=importlib",
                "-W",
                "ignore::pytest.PytestConfigWarning",
            ]
            pytest.main([*words, str(tests)], plugins=[runner])
    came = known(kept_file)
    return [came[name] for name in sample if name in came]


def worded(line: dict) -> str:
    """Return one fault and what came of it in a line."""
    seen = f" by {line['test']}" if line["state"] == "killed" else ""
    change = f"{line['before'] or 'nothing'!r} -> {line['after'] or 'nothing'!r}"
    place = f"{line['file']}:{line['line']} {line['scope']}"
    return f"{line['state']}: {place}, {line['kind']} {change}{seen} ({line['seconds']} s)"


def summed(room: str, seed: int, lines: Sequence[dict], alike: int) -> str:
    """Return the score of a room in a line, with its 95 % interval (Wilson)."""
    killed = sum(line["state"] == "killed" for line in lines)
    low, high = binomtest(killed, len(lines)).proportion_ci(method="wilson") if lines else (0.0, 1.0)
    share = 100.0 * killed / max(len(lines), 1)
    states = ", ".join(f"{count} {state}" for state, count in Counter(line["state"] for line in lines).items())
    score = f"{killed} of {len(lines)} killed, {share:.0f} % ({100 * low:.0f} to {100 * high:.0f} %)"
    return f"{room}, seed {seed}: {score}; {states or 'none tried'}; {alike} equivalent"


def main() -> int:
    """Try the faults that are asked for, and print the score and the survivors."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("rooms", nargs="*", metavar="ROOM", help=f"any of {', '.join(ROOMS)}; all if none is named")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=30, help="faults of each room")
    parser.add_argument("--jobs", type=int, default=2, help="copies that run at a time")
    parser.add_argument("--without-kernels", action="store_true", help="which are compiled anew for each fault")
    parser.add_argument("--folder", type=Path, default=ROOT / ".mutants", help="where what came of each is kept")
    asked = parser.parse_args()
    wrong = sorted({*asked.rooms} - {*ROOMS})
    if wrong:
        parser.error(f"no room of that name: {', '.join(wrong)}; there are {', '.join(ROOMS)}")
    texts = []
    alike = equivalents()
    for room in asked.rooms or ROOMS:
        drawn = sampled(room, asked.seed, asked.count, not asked.without_kernels)
        sample = {name: site for name, site in drawn.items() if name not in alike}
        lines = run(room, sample, asked.jobs, asked.folder)
        texts += [summed(room, asked.seed, lines, len(drawn) - len(sample))]
        texts += [f"  {worded(line)}" for line in lines if line["state"] != "killed"]
    print("\n".join(texts))
    return 0


if __name__ == "__main__":
    sys.exit(main())
