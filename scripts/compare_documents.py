"""Compare what two versions of strikewave leave, command by command: documents, files, screens, messages, pages.

    python scripts/compare_documents.py OLD/.venv/bin/strikewave .venv/bin/strikewave
    python scripts/compare_documents.py OLD/.venv/bin/strikewave --keep old.json      # for later; goes on where it was
    python scripts/compare_documents.py old.json .venv/bin/strikewave

Takes the commands of ``scripts/corpus/commands.txt`` on the samples of ``scripts/corpus/samples.py``. Everything must
be equal but for version, times that ran and rates; each difference is printed with its path. Exit code 1 where there is
one. ``--rename old=new`` (repeated) names keys that were renamed, ``--added KEY`` keys that the old version had not,
``--words KEY`` keys whose sentences may read otherwise; ``--only WORD`` takes the commands that hold a word, ``--slow``
also those that take minutes, ``--without KIND`` leaves a kind out, such as app. Run it in an environment that has the
extras of tests (xarray, openpyxl, playwright).
"""

from __future__ import annotations

import argparse
import json
import shutil
import sys
import tempfile
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import NamedTuple

sys.path.insert(0, str(Path(__file__).parent))

from corpus.faces import VOLATILE, command_faces, served_pages
from corpus.samples import write_samples

SHOWN = 20
"""Differences of a command that are printed."""


class CorpusCommand(NamedTuple):
    """A line of the corpus."""

    faces: frozenset[str]
    words: str

    @property
    def label(self) -> str:
        """Return the line as it is printed and kept."""
        return f"{' '.join(sorted(self.faces - {'slow'}))} | {self.words}"


def corpus_commands(only: str, slow: bool, without: set[str]) -> list[CorpusCommand]:
    """Return the commands that were asked for."""
    lines = Path(__file__).parent.joinpath("corpus/commands.txt").read_text().splitlines()
    parted = (line.partition(" | ") for line in lines if line.strip() and not line.startswith("#"))
    commands = [CorpusCommand(frozenset(faces.split()), words) for faces, _, words in parted]
    return [
        c for c in commands if only in c.label and (slow or "slow" not in c.faces) and not (c.faces & without)
    ]  # fmt: skip


def leavings(program: Path, commands: list[CorpusCommand], jobs: int) -> Iterator[tuple[str, dict[str, object]]]:
    """Run the commands; yield each with what it left, in their order."""
    with tempfile.TemporaryDirectory() as made, ThreadPoolExecutor(jobs) as pool:
        samples = Path(made) / "samples"
        samples.mkdir()
        write_samples(samples)

        def run(number: int, command: CorpusCommand) -> dict[str, object]:
            folder = Path(made) / f"{number:03}" / "records"  # results are called by the folder of their files
            shutil.copytree(samples, folder)
            try:
                return command_faces(program, command.words, set(command.faces), folder)
            finally:
                shutil.rmtree(folder)

        plain = [c for c in commands if "app" not in c.faces]
        yield from zip((c.label for c in plain), pool.map(run, range(len(plain)), plain), strict=True)
        if pages := [c for c in commands if "app" in c.faces]:
            with served_pages(program, samples) as text_of:
                for c in pages:
                    yield c.label, {"page": text_of(c.words)}


def differences(old: object, new: object, renamed: dict[str, str], aside: set[str], path: str = "") -> list[str]:
    """Return where two documents differ; keys of ``aside`` may."""
    if isinstance(old, dict) and isinstance(new, dict):
        old = {renamed.get(k, k): v for k, v in old.items() if k not in VOLATILE}
        new = {k: v for k, v in new.items() if k not in VOLATILE}
        old, new = ({k: v for k, v in each.items() if k not in aside} for each in (old, new))
        alone = [f"{path}.{k}: only in the {'old' if k in old else 'new'}" for k in sorted(old.keys() ^ new.keys())]
        return alone + [d for k in old if k in new for d in differences(old[k], new[k], renamed, aside, f"{path}.{k}")]
    if isinstance(old, list) and isinstance(new, list):
        if len(old) == len(new):
            pairs = enumerate(zip(old, new, strict=True))
            return [d for k, (a, b) in pairs for d in differences(a, b, renamed, aside, f"{path}[{k}]")]
        gone = [f"{path}: - {str(value)[:160]}" for value in old if value not in new]
        come = [f"{path}: + {str(value)[:160]}" for value in new if value not in old]
        return [f"{path}: {len(old)} -> {len(new)} entries", *gone[:SHOWN], *come[:SHOWN]]
    same = old == new or (old != old and new != new)  # what is not a number is so in both
    return [] if same else [f"{path}: {str(old)[:100]} -> {str(new)[:100]}"]


def main() -> int:
    """Compare, print a line a command, and return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("old", type=Path)
    parser.add_argument("new", type=Path, nargs="?")
    parser.add_argument("--keep", type=Path)
    parser.add_argument("--only", default="")
    parser.add_argument("--slow", action="store_true")
    parser.add_argument("--jobs", type=int, default=2)
    for option in ("--rename", "--added", "--words", "--without"):
        parser.add_argument(option, action="append", default=[])
    asked = parser.parse_args()
    commands = corpus_commands(asked.only, asked.slow, set(asked.without))

    def states(source: Path) -> Iterator[tuple[str, dict[str, object]]]:
        if source.suffix == ".json":
            kept = json.loads(source.read_text())
            return ((c.label, kept[c.label]) for c in commands if c.label in kept)
        return leavings(source.absolute(), commands, asked.jobs)

    if asked.keep:
        kept = json.loads(asked.keep.read_text()) if asked.keep.exists() else {}
        commands = [c for c in commands if c.label not in kept]
        for label, left in states(asked.old):
            kept[label] = left
            print(f"exit {left.get('exit', '-')}  {label}"[:160], flush=True)
            asked.keep.write_text(json.dumps(kept, default=str))
        return 0
    if asked.new is None:
        parser.error("give OLD and NEW, or OLD and --keep FILE")
    renamed = dict(pair.split("=") for pair in asked.rename)
    aside = {*asked.added, *asked.words}
    old, broken = dict(states(asked.old)), 0
    for label, left in states(asked.new):
        if label not in old:
            print(f"new     {label}"[:160], flush=True)
            continue
        left = json.loads(json.dumps(left, default=str))  # as the old ones were kept
        lines = differences(old[label], left, renamed, aside)
        print(f"{'DIFFERS' if lines else 'equal':8}{label} (exit {left.get('exit', '-')})"[:160], flush=True)
        for line in lines[:SHOWN]:
            print(f"        {line}")
        if len(lines) > SHOWN:
            print(f"        and {len(lines) - SHOWN} more")
        broken += bool(lines)
    print(f"{broken} of {len(commands)} commands differ")
    return 1 if broken else 0


if __name__ == "__main__":
    sys.exit(main())
