"""Markers by folder, fixed seeds, and one run of the published case shared by all tests."""

import contextlib
import gc
import html
import importlib
import itertools
import lzma
import os
import re
import shutil
import signal
import sys
from pathlib import Path
from types import SimpleNamespace

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # as the command line does, before numpy is imported

import numpy as np
import pytest
from hypothesis import HealthCheck, settings

SEED = 20190321
"""Every random number of the tests starts here (the publication date of the machine's paper)."""

settings.register_profile(
    "strikewave", derandomize=True, deadline=None, max_examples=25, suppress_health_check=[HealthCheck.too_slow]
)
settings.load_profile("strikewave")

gc.set_threshold(
    50_000, *gc.get_threshold()[1:]
)  # as the command line does: a thousand walks while modules are imported

HERE = Path(__file__).parent
NUMBERS = itertools.count()
"""Of the folders of tests."""

collect_ignore = ["fem/simulated_gpu.py"]
"""A script that leaves kernels as they are written: imported here, it would do so for all tests."""


def pytest_report_header() -> str:
    return f"strikewave: numpy seed {SEED}; hypothesis derandomized (its examples follow from the test's source)"


def pytest_configure(config: pytest.Config) -> None:
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        # a shell has its jobs in the background ignore it, and what they start too: no test of Ctrl-C could pass
        signal.signal(signal.SIGINT, signal.default_int_handler)
    if os.environ.get("CI") == "true":
        # CI installs every extra: a test that cannot import one fails there instead of passing for a skip
        pytest.importorskip = lambda module, **_: importlib.import_module(module)
    for name in sorted({part for folder in HERE.rglob("*/") for part in folder.relative_to(HERE).parts}):
        config.addinivalue_line("markers", f"{name}: what lies in folders of that name")


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    for item in items:
        if item.path.is_relative_to(HERE):
            for folder in item.path.relative_to(HERE).parts[:-1]:
                item.add_marker(folder)
    if "verify" not in config.option.markexpr:
        config.hook.pytest_deselected(items=[item for item in items if item.get_closest_marker("verify")])
        items[:] = [item for item in items if not item.get_closest_marker("verify")]


def pytest_collection_finish(session: pytest.Session) -> None:
    gc.collect()
    gc.freeze()  # 14 000 items and all modules are walked by each whole collection otherwise


@pytest.fixture
def tmp_path(tmp_path_factory: pytest.TempPathFactory, request: pytest.FixtureRequest) -> Path:
    """A new folder, as pytest's own, which looks through the folders of all tests before and makes a link to it."""
    name = re.sub(r"\W", "_", request.node.name)[:30]
    folder = tmp_path_factory.getbasetemp() / f"{name}{next(NUMBERS)}"
    folder.mkdir(mode=0o700)
    return folder


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(SEED)


@pytest.fixture(scope="session")
def interpreting():
    """Return what lets Python run every kernel as it is written, in our modules and another one, until it is undone."""
    from numba.core.registry import CPUDispatcher

    def interpret(monkeypatch, module):
        ours = [module for name, module in list(sys.modules.items()) if name.startswith("strikewave.")]
        for names in (vars(module) for module in [*ours, module]):
            for name, value in [*names.items()]:
                if isinstance(value, CPUDispatcher):
                    monkeypatch.setitem(names, name, value.py_func)

    return interpret


@pytest.fixture
def interpreted(monkeypatch, request, interpreting) -> None:
    """Let Python run every kernel as it is written: nothing is compiled, for arguments of no type."""
    interpreting(monkeypatch, request.module)


@pytest.fixture(scope="session")
def read_page():
    """Return what reads a report: key numbers by label, sections, pictures, tables; nothing is fetched or run."""

    def read(path):
        text = Path(path).read_text("utf-8")
        assert text.startswith("<!doctype html>")
        assert "<script" not in text
        assert not re.search(
            r"""(src|href)=["']?(https?:)?//(?!doi\.org)""", text.replace("https://doi.org", "//doi.org")
        )
        pairs = re.findall(r"<div><dt>(.*?)</dt><dd>(.*?)</dd></div>", text, re.S)
        return SimpleNamespace(
            text=text,
            numbers={html.unescape(label): html.unescape(value).replace("\xa0", " ") for label, value in pairs},
            sections=[html.unescape(head) for head in re.findall(r"<h2 id=[^>]*>(.*?)</h2>", text)],
            pictures=text.count("<svg"),
            tables=len(re.findall("<table", text)),
        )

    return read


BLANK = '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {:g} {:g}"><g/></svg>'


@pytest.fixture(scope="session")
def without_lines():
    """Return a context in which figures are made and their files written, but nothing is drawn: half the time of a page."""

    @contextlib.contextmanager
    def context():
        from matplotlib.figure import Figure

        def blank(figure, target, **_):
            text = BLANK.format(*72.0 * figure.get_size_inches())
            target.write(text) if hasattr(target, "write") else Path(target).write_text(text)

        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(Figure, "savefig", blank)
            yield

    return context


@pytest.fixture
def undrawn(without_lines):
    """Leave the lines out of pictures, where words and tables of a page or the files of a folder are what is asked."""
    with without_lines():
        yield


@pytest.fixture(scope="session")
def measured(tmp_path_factory):
    """Return the unpacked copy of a folder of tests/data: one a session, so tests write elsewhere."""
    unpacked = {}

    def folder(name):
        if name not in unpacked:
            unpacked[name] = tmp_path_factory.mktemp(name, numbered=False)
            for file in (HERE / "data" / name).iterdir():
                if file.suffix == ".xz":
                    (unpacked[name] / file.stem).write_bytes(lzma.decompress(file.read_bytes()))
                else:
                    shutil.copy(file, unpacked[name])
        return unpacked[name]

    return folder


@pytest.fixture(scope="session")
def published():
    """The published case as it comes along."""
    from strikewave import load_case

    return load_case("li-ma-2019")


@pytest.fixture(scope="session")
def solution(published):
    """Its solution."""
    from strikewave import run_case

    return run_case(published)


@pytest.fixture
def environment(tmp_path):
    """An environment for child processes that keeps the kernel cache of this machine."""
    return {**os.environ, "PYTHONDONTWRITEBYTECODE": "1", "COLUMNS": "160"}


@pytest.fixture
def strikewave(monkeypatch, capsys, tmp_path):
    """Run a command in this process, in an empty folder; return exit code, stdout, stderr."""
    from strikewave.cli import app

    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "160")

    def call(*words):
        monkeypatch.setattr(sys, "argv", ["strikewave", *map(str, words)])
        with pytest.raises(SystemExit) as stopped:
            app.main()
        captured = capsys.readouterr()
        return stopped.value.code, captured.out, captured.err

    return call


@pytest.fixture
def result_of(strikewave, monkeypatch):
    """Run a command that writes a folder; return its result and the folder."""

    def call(*words):
        from strikewave.reporting import run_and_write

        results = []
        write = run_and_write.write_files
        monkeypatch.setattr(
            run_and_write, "write_files", lambda result, folder: results.append(result) or write(result, folder)
        )
        code, _, err = strikewave(*words, "--out", "written", "--xlsx")
        assert code in (0, 3), err
        return results[0], Path("written")

    return call
