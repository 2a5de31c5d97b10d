"""The site and the code know of each other: numbered equations, public names, pages."""

import ast
import re
from pathlib import Path

import pytest

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


def reference_docstrings():
    """Docstrings of the functions that the reference shows, by their names; read, since to import them all takes seconds."""
    text = (DOCS / "reference.md").read_text("utf-8")
    members = re.findall(r"automodule:: (\S+)\n   :members: (.*)", text)
    public = re.findall(r"^   strikewave\.(\w+)$", text, re.MULTILINE)
    asked = [(f"strikewave.{strikewave._HOMES[name]}", name) for name in public]
    asked += [(module, name) for module, names in members for name in names.split(", ")]
    found = {}
    for module, name in asked:
        place = ROOT.joinpath("src", *module.split("."))
        source = place.with_suffix(".py") if place.with_suffix(".py").is_file() else place / "__init__.py"
        for entry in ast.parse(source.read_text("utf-8")).body:
            if isinstance(entry, ast.FunctionDef) and entry.name == name:
                found[f"{module}.{name}"] = ast.get_docstring(entry)
    return found


def test_every_function_of_the_reference_says_what_it_returns():
    docstrings = reference_docstrings()
    assert len(docstrings) > 40
    assert [name for name, text in docstrings.items() if "\nReturns\n-------\n" not in text] == []


def test_no_sentence_stands_where_a_docstring_lists_fields():
    """Napoleon takes it for a field: a source below `Raises` became an exception, a remark a parameter."""
    section = re.compile(
        r'^( *)(?:Parameters|Attributes|Returns|Raises)\n\1-+\n(.*?)(?=^\1\S[^\n]*\n\1-+\n|""")',
        re.MULTILINE | re.DOTALL,
    )
    lost = [
        f"{path.name}: {line}"
        for path in (ROOT / "src").rglob("*.py")
        for indent, body in section.findall(path.read_text("utf-8"))
        for line in re.findall(rf"^{indent}(\S.*\.)$", body, re.MULTILINE)
    ]
    assert lost == []


def test_every_page_and_notebook_stands_in_the_table_of_contents():
    text = (DOCS / "index.md").read_text("utf-8")
    entries = {line for block in re.findall(r"```\{toctree\}(.*?)```", text, re.DOTALL) for line in block.split()}
    pages = {path.stem for path in DOCS.glob("*.md")} - {"index"}
    notebooks = {path.stem for path in (ROOT / "src/strikewave/examples/notebooks").glob("*.ipynb")}
    assert pages | {f"examples/notebooks/{name}" for name in notebooks} <= entries


@pytest.fixture
def evidence(monkeypatch):
    """The record of comparisons, as the studies keep it."""
    monkeypatch.syspath_prepend(ROOT / "scripts" / "validate")
    from kit import evidence

    return evidence


def test_the_validation_page_and_the_summary_are_what_the_record_says(evidence):
    record = evidence.read_record()
    assert evidence.PAGE.read_text("utf-8") == evidence.page(record)
    readme = evidence.README.read_text("utf-8")
    summary = evidence.totals(evidence.latest(record))
    assert re.search(r"<!-- how well it is known -->\n(.*?)<!-- end -->", readme, re.DOTALL)[1].strip() == summary


def test_every_study_has_its_script_and_each_script_that_keeps_comparisons_its_study(evidence):
    scripts = {path.name: path.read_text("utf-8") for path in (ROOT / "scripts" / "validate").glob("*.py")}
    keeping = {(name, script) for script, text in scripts.items() for name in re.findall(r'keep\("([\w ]+)"', text)}
    assert keeping == {(name, script) for name, (_, script) in evidence.STUDIES.items()}


def test_no_prediction_misses_by_more_than_a_tenth_without_a_reason(evidence):
    with pytest.raises(ValueError, match="say why"):
        evidence.Comparison("bar", "length", "measured", "predicted", 1.0, 1.2)
    assert evidence.Comparison("bar", "length", "measured", "predicted", 4.0, 4.2).miss == pytest.approx(0.05)
    assert evidence.Comparison("bar", "length", "measured", "fitted", 1.0, 1.2, band=(1.1, 1.3)).held is False
