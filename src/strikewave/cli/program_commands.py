"""Commands on the program itself: ``help``, ``doctor``, ``examples``."""

from __future__ import annotations

import importlib.metadata
import lzma
import os
import platform
import re
import shutil
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, NamedTuple

import typer

from strikewave._version import __version__
from strikewave.base.constants import material
from strikewave.base.documents import head
from strikewave.base.errors import InputError
from strikewave.cases.files import bundled_cases, read_case_text
from strikewave.cli.group import entries
from strikewave.reporting.layout import keys, numerals, texts
from strikewave.reporting.output_options import Shown
from strikewave.reporting.pdf import check_pdf
from strikewave.reporting.terminal import print_json, say, table, tell


def _names(incomplete: str) -> list[tuple[str, str]]:
    """Return the commands that begin so, with their summaries."""
    return [(name, entry.summary) for name, entry in entries().items() if name.startswith(incomplete)]


def show_help(
    context: typer.Context,
    name: Annotated[
        str | None,
        typer.Argument(metavar="COMMAND", help="A command; the list of all by default.", autocompletion=_names),
    ] = None,
) -> int:
    """Show the help of a command."""
    root = context.find_root()
    words = ["--help"] if name is None else [name, "--help"]
    return int(root.command.main(words, prog_name=root.info_name, standalone_mode=False) or 0)


CORE = "core"
DEVELOPERS = ("dev", "docs", "package")
"""Extras for work on strikewave itself: no user misses them."""
PROGRAMS = {
    "CalculiX": (("ccx",), "the same elements by another code, in tests"),
    "gmsh": (("gmsh",), "meshes of solids from CAD (strikewave fem)"),
    "Jupyter": (("jupyter-lab", "jupyter"), "notebooks"),
}
"""Programs that are called by name: their commands, and their purpose."""
REPEATS = 3  # other work on the machine only makes a time longer
"""Times of which the shortest counts."""


class Package(NamedTuple):
    """A package that strikewave, or an extra of it, asks for: the versions that do, and the one at hand or nothing."""

    extra: str
    name: str
    asked: str
    found: str


def packages() -> list[Package]:
    """Return the packages that strikewave asks for, by its own metadata.

    Examples
    --------
    >>> next(package for package in packages() if package.name == "numpy").extra
    'core'
    """
    listed = []
    for line in importlib.metadata.requires("strikewave") or ():
        requirement, _, marker = line.partition(";")
        name, asked = re.fullmatch(r"([\w.-]+)(.*)", requirement.strip()).groups()  # type: ignore[union-attr]
        extra = re.search(r"extra == ['\"]([\w-]+)['\"]", marker)
        if extra and extra[1] in DEVELOPERS:
            continue
        try:
            version = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:
            version = ""
        listed.append(Package(extra[1] if extra else CORE, name, asked.strip(), version))
    return listed


def programs() -> dict[str, str]:
    """Return where the programs are, by their names; empty where one is missing."""
    return {
        name: next((place for word in words if (place := shutil.which(word))), "")
        for name, (words, _) in PROGRAMS.items()
    }


def pdf_library() -> bool:
    """Tell whether reports can be written as PDF: WeasyPrint with the libraries of the system that it needs."""
    try:
        check_pdf("pdf", "PDF")
    except InputError:
        return False
    return True


def kept_kernels() -> tuple[str | None, int, int]:
    """Return the folder of compiled kernels, how many it holds, and its bytes."""
    from strikewave.base.compiled import cache_folder

    folder = cache_folder()
    files = list(Path(folder).rglob("*.nb[ic]")) if folder else []
    return folder, sum(path.suffix == ".nbi" for path in files), sum(path.stat().st_size for path in files)


class Speed(NamedTuple):
    """Speed of a kernel: units of its work a second, on one core."""

    work: str
    rate: float


def _shortest(call: Callable[[], object]) -> float:
    """Return the shortest time of the processor in a call, after one that compiles, s."""
    call()
    times = []
    for _ in range(REPEATS):
        begun = time.process_time()
        call()
        times.append(time.process_time() - begun)
    return min(times)


def speeds() -> list[Speed]:
    """Measure the kernels of impacts, spectra, layered bars and elements, on one core."""
    import numpy as np

    from strikewave import load_case, run_fem, solve_impact, srs
    from strikewave.contact import Contact, exact
    from strikewave.waves import BONDED, End, LoadPulse, Stack, Tap, WantedError, round_bar, run_bar

    contact, speed = Contact(4.7e9, 10 / 9, float(exact(0.5))), np.linspace(1.0, 20.0, 20_000)
    impacts = _shortest(lambda: solve_impact(contact, 0.2, 0.459, speed))
    pulse, frequencies = np.sin(np.linspace(0.0, np.pi, 100_000)), np.geomspace(10.0, 1e4, 100)
    spectrum = _shortest(lambda: srs(pulse, 1e-6, frequencies))
    layers = tuple(round_bar(f"layer {k}", material("65Mn" if k % 2 else "2A12"), 0.02, 0.03) for k in range(20))
    stack = Stack(layers, (BONDED,) * 19, End("free"))
    load, step, duration = LoadPulse("half-sine", 1e4, 20e-6), 20e-9, 2e-3
    bar = _shortest(lambda: run_bar(stack, load, [Tap(0, 0.5)], duration, WantedError(step=step)))
    element_run = load_case("two-bars-fem", ["fem.duration=10 us"])
    elements = max(run_fem(element_run).run.speed for _ in range(REPEATS))
    return [
        Speed("impacts", speed.size / impacts),
        Speed("samples of a spectrum, each frequency", pulse.size * frequencies.size / spectrum),
        Speed("layer steps of a bar", len(layers) * duration / step / bar),
        Speed("element steps", elements),
    ]


def examine(
    *,
    speed: Annotated[bool, typer.Option("--speed/--no-speed", help="Measure the kernels; on by default.")] = True,
    shown: Shown,
) -> int:
    """Say what is installed, missing and cached.

    Also how fast the kernels are on one core. The first time compiles them, which takes a minute at most.
    """
    asked, found, pdf = packages(), programs(), pdf_library()
    folder, kernels, size = kept_kernels()
    measured = speeds() if speed else []
    if shown.json:
        document = {
            **head({"cache.bytes": "byte", "speeds.rate": "1/s"}),
            "python": platform.python_version(),
            "system": platform.platform(),
            "cores": os.cpu_count(),
            "packages": [one._asdict() for one in asked],
            "programs": found,
            "pdf": pdf,
            "cache": {"folder": folder, "kernels": kernels, "bytes": size},
            "speeds": [one._asdict() for one in measured],
        }
        print_json(document)
        return 0
    tell(
        f"strikewave {__version__}, Python {platform.python_version()}, {platform.platform()}, {os.cpu_count()} cores. "
        f"Compiled kernels: {kernels} in {folder or 'no folder that can be written'} ({size / 1e6:.0f}\xa0MB)."
    )
    rows = [[one.extra, one.name, one.found or "missing", one.asked] for one in asked]
    table("Packages", [*keys("of"), *texts("package", "version", "asked for")], rows)
    places = [[name, place or "missing", PROGRAMS[name][1]] for name, place in found.items()]
    places.append(["PDF (WeasyPrint, Pango)", "there" if pdf else "missing", "reports as PDF (--pdf)"])
    table("Programs", [*keys("program"), *texts("where", "for")], places)
    if measured:
        table("Kernels, one core", [*keys("work"), *numerals("a second")], [[w, f"{rate:.3g}"] for w, rate in measured])
    missing = sorted({one.extra for one in asked if not one.found})
    if missing:
        say(f"to add what is missing: pip install 'strikewave[{','.join(missing)}]'")
    return 0


EXAMPLES = Path(__file__).parents[1] / "examples"
PACKED = ".xz"
"""Ending of a file that is packed here and unpacked where it is copied to."""


def copy_examples(folder: Path) -> list[Path]:
    """Copy notebooks, sample records with their credit, studies, and the built-in cases, and return the files.

    The folder, which is not there yet or empty, appears whole.
    """
    if folder.is_symlink() or (folder.exists() and (not folder.is_dir() or any(folder.iterdir()))):
        raise InputError("FOLDER", folder, "a folder that is not there yet, or empty", "choose another name")
    if not folder.absolute().parent.is_dir():
        raise InputError("FOLDER", folder, "a folder in one that exists")
    with tempfile.TemporaryDirectory(dir=folder.absolute().parent, prefix=f".{folder.name}.") as place:
        whole = Path(place) / "whole"
        _fill(whole)
        files = sorted(path.relative_to(whole) for path in whole.rglob("*") if path.is_file())
        if folder.exists():
            folder.rmdir()
        whole.rename(folder)
    return files


def _fill(whole: Path) -> None:
    for kept in sorted(path for path in EXAMPLES.rglob("*") if path.is_file()):
        place = whole / kept.relative_to(EXAMPLES)
        place.parent.mkdir(parents=True, exist_ok=True)
        if kept.suffix == PACKED:
            place.with_suffix("").write_bytes(lzma.decompress(kept.read_bytes()))
        else:
            shutil.copyfile(kept, place)
    (whole / "cases").mkdir()
    for name in bundled_cases():
        (whole / "cases" / f"{name}.toml").write_text(read_case_text(name)[0], "utf-8")


def write_examples(
    folder: Annotated[Path, typer.Argument(help="The folder to make, which holds them.", show_default=False)],
    *,
    shown: Shown,
) -> int:
    """Copy notebooks, a record, studies and cases.

    Notebooks need `pip install "strikewave[notebooks]"`; records come with source and licence; cases are the built-in
    ones, to change; studies are files of `strikewave design`.
    """
    files = copy_examples(folder)
    if shown.json:
        print_json({**head({}), "written": [str(folder / path) for path in files]})
        return 0
    counts = ", ".join(
        f"{name} {sum(path.parts[0] == name for path in files)}" for name in ("notebooks", "cases", "studies")
    )
    say(f"written: {folder} ({counts}, a measured record); then: jupyter lab {folder / 'notebooks'}")
    return 0
