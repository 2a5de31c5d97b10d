"""Keys of runs: what a result depends on, as one number that tells it from all others."""

from __future__ import annotations

import functools
import hashlib
from pathlib import Path

from strikewave._version import __version__
from strikewave.base.compiled import PACKAGE, kernel_key
from strikewave.base.result import SCHEMA
from strikewave.cases.case import Case


@functools.cache
def program_key() -> str:
    """Return what a result depends on beside its case: version, meaning of its figures, source of the kernels."""
    return f"{__version__} {SCHEMA} {kernel_key(PACKAGE)}"


def run_key(case: Case, evaluation: object) -> bytes:
    """Return the key of a run: the SHA-256 of its case with the files it names, its evaluation, and the version.

    Examples
    --------
    >>> from strikewave import load_case
    >>> from strikewave.studies.engine.case_evaluation import CaseEvaluation
    >>> case, peak = load_case("li-ma-2019"), CaseEvaluation("run", ("first.rigid_peak",))
    >>> run_key(case, peak) == run_key(load_case("li-ma-2019"), peak)
    True
    >>> run_key(case, peak) == run_key(load_case("li-ma-2019", ["machine.speed=700 rpm"]), peak)
    False
    """
    digest = hashlib.sha256(f"{program_key()} {evaluation!r}\n{case_text(case)}".encode())
    for file in case_files(case):
        digest.update(_file_digest(file, file.stat().st_mtime_ns))
    return digest.digest()


def case_text(case: Case) -> str:
    """Return all values of a case as a text that tells it from others; a field of a table's own kind counts too."""
    return case.model_dump_json(serialize_as_any=True)


def case_files(case: Case) -> list[Path]:
    """Return the files that a case names: of its load, and of parts of its mesh."""
    names = [case.load.file] if case.load is not None else []
    names += [getattr(part, "file", "") for part in (case.mesh.part if case.mesh is not None else ())]
    return [path for path in map(Path, filter(None, names)) if path.is_file()]


@functools.lru_cache(maxsize=64)
def _file_digest(path: Path, changed: int) -> bytes:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").digest()
