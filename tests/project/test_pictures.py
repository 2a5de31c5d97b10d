"""The screens that README and docs show, against what the commands print now."""

import importlib.util
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


def drawing():
    """Return the script that draws them."""
    spec = importlib.util.spec_from_file_location("draw_pictures", ROOT / "scripts" / "draw_pictures.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_every_picture_of_a_page_is_there_and_fetches_nothing():
    pages = [ROOT / "README.md", *(ROOT / "docs").glob("*.md")]
    shown = [
        page.parent / place
        for page in pages
        for place in re.findall(r"\]\(((?:docs/)?images/[^)]+)\)", page.read_text("utf-8"))
    ]
    assert {ROOT / "docs" / "images" / f"{name}.svg" for name in drawing().SCREENS} <= set(shown)
    for path in shown:
        assert path.exists(), path
        if path.suffix == ".svg":
            assert not re.search(r"(href|src|url)\W{1,3}https?:", path.read_text("utf-8"))


@pytest.mark.verify
def test_screens_of_the_docs_are_what_the_commands_print_now(tmp_path):
    """Where they are not, `make pictures` draws them anew."""
    draw = drawing()
    for name in draw.SCREENS:
        assert draw.screen_svg(name, tmp_path) == (draw.IMAGES / f"{name}.svg").read_text("utf-8"), name
