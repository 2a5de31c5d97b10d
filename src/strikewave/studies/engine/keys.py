"""Keys of runs: what a result depends on, as one number that tells it from all others."""

from __future__ import annotations

import functools
import hashlib
from collections.abc import Mapping
from enum import Enum
from pathlib import Path
from types import BuiltinFunctionType, FunctionType, MethodType
from typing import Any

import numpy as np

from strikewave._version import __version__
from strikewave.base.compiled import PACKAGE, kernel_key
from strikewave.base.declare import ComputedField
from strikewave.base.result import ELEMENTS_SCHEMA, SCHEMA
from strikewave.cases.case import Case


@functools.cache
def program_key() -> str:
    """Return what a result depends on beside its case: version, meaning of its numbers, source of the kernels."""
    return f"{__version__} {SCHEMA} {ELEMENTS_SCHEMA} {kernel_key(PACKAGE)}"


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


def content_key(thing: object) -> bytes:
    """Return the SHA-256 of the content of an object, of a function with what it is bound to, or of a tuple of these.

    What is computed once and remembered (`functools.cached_property`, `ComputedField`) is no content.

    Raises
    ------
    TypeError
        If it holds something whose content is not known, such as a file or a lambda.

    Examples
    --------
    >>> content_key(("a", 1.0)) == content_key(("a", 1.0)), content_key((1, (2,))) == content_key(((1, 2),))
    (True, False)
    """
    digest = hashlib.sha256(program_key().encode())
    _add_content(digest, thing)
    return digest.digest()


def _add_content(digest: Any, thing: Any) -> None:
    """Add the kind of a thing, how much it holds, and all that."""
    parts: list[Any] = []
    words = f"{type(thing).__module__}.{type(thing).__qualname__}"
    if isinstance(thing, Case):
        words += run_key(thing, "").hex()
    elif isinstance(thing, np.ndarray):
        words += f" {thing.dtype} {thing.shape} {hashlib.sha256(thing.tobytes()).hexdigest()}"
    elif thing is None or isinstance(thing, str | bytes | int | float | complex | Path | Enum | np.generic):
        words += f" {thing!r}"
    elif isinstance(thing, type | FunctionType | BuiltinFunctionType):
        if "<" in thing.__qualname__:  # a lambda, or a function within one: what it holds is not seen
            raise TypeError(f"the content of {thing.__qualname__} is not known")
        words += f" {thing.__module__}.{thing.__qualname__}"
    elif isinstance(thing, MethodType):
        parts = [thing.__func__, thing.__self__]
    elif isinstance(thing, functools.partial):
        parts = [thing.func, thing.args, thing.keywords]
    elif isinstance(thing, tuple | list):
        parts = [*thing]
    elif isinstance(thing, Mapping):
        parts = [part for item in thing.items() for part in item]
    elif hasattr(thing, "__dict__"):
        remembered = functools.cached_property | ComputedField
        own = {k: v for k, v in vars(thing).items() if not isinstance(getattr(type(thing), k, None), remembered)}
        parts = [own]
    else:
        raise TypeError(f"the content of a {words} is not known")
    digest.update(f"{words} {len(parts)}\n".encode())
    for part in parts:
        _add_content(digest, part)


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
