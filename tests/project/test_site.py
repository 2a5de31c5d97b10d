"""The site and the code know of each other: numbered equations, public names, pages."""

import json
import re
from pathlib import Path

import strikewave

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"


def test_every_equation_leads_to_code_and_is_named_there():
    labels = re.findall(r":label: ([\w-]+)", (DOCS / "theory.md").read_text("utf-8"))
    sources = "\n".join(path.read_text("utf-8") for path in (ROOT / "src").rglob("*.py"))
    assert len(labels) == len(set(labels)) > 10
    assert set(re.findall(r":eq:`([\w-]+)`", sources)) == set(labels)


def test_the_reference_has_every_public_name():
    listed = set(re.findall(r"^   strikewave\.(\w+)$", (DOCS / "reference.md").read_text("utf-8"), re.MULTILINE))
    assert listed == {*strikewave.__all__, "map"} - {"__version__"}


def test_every_page_and_notebook_stands_in_the_table_of_contents():
    text = (DOCS / "index.md").read_text("utf-8")
    entries = {line for block in re.findall(r"```\{toctree\}(.*?)```", text, re.DOTALL) for line in block.split()}
    pages = {path.stem for path in DOCS.glob("*.md")} - {"index"}
    notebooks = {path.stem for path in (ROOT / "src/strikewave/examples/notebooks").glob("*.ipynb")}
    assert pages | {f"examples/notebooks/{name}" for name in notebooks} <= entries


def test_the_validation_page_is_what_its_record_says(monkeypatch):
    monkeypatch.syspath_prepend(ROOT / "scripts" / "validate")
    from published import PAGE, RECORD, page

    assert PAGE.read_text("utf-8") == page(json.loads(RECORD.read_text("utf-8")))
