"""The project itself: what it promises about its files."""

import re
import tomllib
from pathlib import Path

import pytest

import strikewave

ROOT = Path(__file__).parents[2]
SOURCES = sorted((ROOT / "src").rglob("*.py"))


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


@pytest.mark.parametrize("path", SOURCES, ids=lambda p: str(p.relative_to(ROOT)))
def test_no_file_is_longer_than_600_lines(path):
    assert len(path.read_text().splitlines()) <= 600


def test_changelog_knows_the_version():
    assert strikewave.__version__ in (ROOT / "CHANGELOG.md").read_text()
