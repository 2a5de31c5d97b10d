"""The project itself: what it promises about its files."""

import ast
import graphlib
import re
import tomllib
from pathlib import Path

import pytest

import strikewave

ROOT = Path(__file__).parents[2]
BENCHMARKS = ROOT / "benchmarks"


def test_public_names_import():
    for name in strikewave.__all__:
        assert getattr(strikewave, name) is not None
    with pytest.raises(AttributeError):
        strikewave.nothing  # noqa: B018


def test_constraints_pin_every_dependency_and_name_no_host():
    text = (ROOT / "constraints.txt").read_text()
    assert "://" not in text
    pinned = {re.split("==", line)[0].lower().replace("_", "-") for line in text.splitlines() if "==" in line}
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    extras = project["optional-dependencies"]
    wanted = project["dependencies"] + extras["dev"] + extras["formats"]
    for requirement in wanted:
        assert re.split("[>=<]", requirement)[0].lower().replace("_", "-") in pinned


def test_the_peers_of_the_benchmarks_are_pinned_and_name_no_host():
    lines = [
        line
        for name in ("requirements.txt", "constraints.txt")
        for line in (BENCHMARKS / name).read_text("utf-8").splitlines()
        if not line.startswith("#")
    ]
    assert lines
    for line in lines:
        assert re.fullmatch(r"[\w.-]+==[\w.]+", line)


def test_no_module_of_the_benchmarks_needs_itself():
    """Imports within functions count too: no module may wait for one that waits for it."""
    needed = {}
    for path in BENCHMARKS.glob("*.py"):
        found = [
            node
            for node in ast.walk(ast.parse(path.read_text("utf-8")))
            if isinstance(node, ast.Import | ast.ImportFrom)
        ]
        names = [
            node.module if isinstance(node, ast.ImportFrom) else alias.name for node in found for alias in node.names
        ]
        needed[path.stem] = {name for name in names if (BENCHMARKS / f"{name}.py").exists()}
    list(graphlib.TopologicalSorter(needed).static_order())


def test_changelog_knows_the_version():
    assert strikewave.__version__ in (ROOT / "CHANGELOG.md").read_text()


def test_the_citation_names_the_version():
    assert f"version: {strikewave.__version__}\n" in (ROOT / "CITATION.cff").read_text("utf-8")
