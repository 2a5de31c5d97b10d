"""The plan of the code: what CONTRIBUTING and the docs say of rooms and names is what the folders hold."""

import ast
import importlib
import pkgutil
import re
import subprocess
import sys
from pathlib import Path

import pytest

import strikewave

ROOT = Path(__file__).parents[2]
PACKAGE = ROOT / "src" / "strikewave"
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("*.md"))]
NOT_ROOMS = {"data", "faults", "project"}
"""Folders of tests that mirror no room: what was measured, and the project as a whole."""
GROUPS = {"strikewave.damping_laws", "strikewave.damper_laws", "strikewave.stiffness_laws", "strikewave.cushion_laws"}
"""Entry points under which other packages add laws: names, no modules."""
FAMILIES = ("analyses", "exchange", "papers", "studies")
"""Rooms that hold a folder for each of their members, which stands in the table by itself."""


def folders(place):
    """Return the folders of code below a place, without those that hold no module."""
    return {path.parent.relative_to(place).as_posix() for path in place.rglob("*.py")} - {"."}


def rooms_of_the_table():
    text = (ROOT / "CONTRIBUTING.md").read_text("utf-8")
    return {name.strip("/") for name in re.findall(r"^\| `([a-z_0-9/]+)/` \|", text, re.MULTILINE)}


def test_the_table_of_rooms_is_that_of_the_folders():
    top = {path.name for path in PACKAGE.iterdir() if (path / "__init__.py").exists()}
    members = {
        f"{family}/{path.name}"
        for family in FAMILIES
        for path in (PACKAGE / family).iterdir()
        if (path / "__init__.py").exists()
    }
    assert rooms_of_the_table() == top | members


def test_every_room_of_the_layers_contract_is_a_folder_and_every_folder_stands_there():
    text = (ROOT / "pyproject.toml").read_text("utf-8")
    layers = re.search(r"layers = \[(.*?)\n\]", text, re.DOTALL)[1]
    named = set(re.findall(r"strikewave\.([a-z_]+)", layers))
    assert named == {path.name for path in PACKAGE.iterdir() if (path / "__init__.py").exists()}


def test_no_analysis_is_left_out_of_the_independence_contract():
    text = (ROOT / "pyproject.toml").read_text("utf-8")
    named = set(re.findall(r'"strikewave\.analyses\.([a-z_]+)"', text.partition('type = "independence"')[2]))
    assert named == {path.name for path in (PACKAGE / "analyses").iterdir() if (path / "__init__.py").exists()}


def test_nothing_but_rooms_lies_at_the_top():
    loose = {path.name for path in PACKAGE.glob("*.py")}
    assert loose == {"__init__.py", "__main__.py", "_version.py"}


def test_folders_of_tests_mirror_the_rooms():
    mirrored = {name for name in folders(ROOT / "tests") if name.split("/")[0] not in NOT_ROOMS}
    assert mirrored <= folders(PACKAGE)


def test_no_folder_has_a_name_that_tools_pass_over():
    """Test runners and packers leave out folders called build or dist."""
    assert not {"build", "dist"} & {part for name in folders(PACKAGE) for part in name.split("/")}


@pytest.mark.verify
def test_doctests_of_all_modules_are_collected():
    """Every module whose docstrings hold an example, counted by their text, is among those that pytest collects."""
    wanted = set()
    for path in PACKAGE.rglob("*.py"):
        tree = ast.parse(path.read_text("utf-8"))
        parts = [n for n in ast.walk(tree) if isinstance(n, ast.Module | ast.ClassDef | ast.FunctionDef)]
        if any(">>>" in (ast.get_docstring(part) or "") for part in parts):
            wanted.add(path.relative_to(ROOT).as_posix())
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "--collect-only", "-p", "no:cacheprovider", "src"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    collected = set(re.findall(r"^(src/\S+?\.py)::", done.stdout, re.MULTILINE))
    assert done.returncode == 0, done.stdout[-2000:]
    assert len(wanted) > 150
    assert collected == wanted


@pytest.mark.parametrize("page", PAGES, ids=lambda path: path.name)
def test_names_on_a_page_can_be_imported(page):
    text = page.read_text("utf-8")
    for name in set(re.findall(r"`(strikewave(?:\.[A-Za-z_][A-Za-z_0-9]*)+)", text)):
        assert resolved(name) or name in GROUPS, name
    for module, listed in re.findall(r"^ *from (strikewave[\w.]*) import ([\w, ]+)$", text, re.MULTILINE):
        for name in listed.split(","):
            what = name.split(" as ")[0].strip()
            assert resolved(f"{module}.{what}"), f"{module}.{what}"
    for path in set(re.findall(r"`(src/strikewave/[\w/.]+)`", text)):
        assert (ROOT / path).exists(), path


def resolved(name):
    """Tell whether a dotted name is a module, or what one holds."""
    found, rest = strikewave, name.split(".")[1:]
    path = "strikewave"
    for part in rest:
        path = f"{path}.{part}"
        if not hasattr(found, part):
            try:
                found = importlib.import_module(path)
            except ModuleNotFoundError:
                return False
        else:
            found = getattr(found, part)
    return True


def test_every_module_imports_by_itself():
    """None waits for one that waits for it, and none needs an extra to be imported."""
    for module in pkgutil.walk_packages([str(PACKAGE)], "strikewave."):
        if not module.name.endswith(("__main__", "meshio_child")):
            importlib.import_module(module.name)
