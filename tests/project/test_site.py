"""The site and the code know of each other: numbered equations, public names, pages."""

import ast
import csv
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


def test_the_validation_page_and_the_parts_of_the_readme_are_what_the_record_says(evidence):
    """An edit by hand of the page, of the README's tables, or of the sentence above them is found."""
    for path, text in evidence.pages(evidence.read_record()).items():
        assert path.read_text("utf-8") == text, f"{path.name} is not what docs/validation.json makes of it"


@pytest.mark.parametrize(
    ("was", "by_hand"),
    [("0 of 17 blows", "17 of 17 blows"), ("| 11 of 14 |", "| 14 of 14 |"), ("is not yet predicted", "is predicted")],
)
def test_an_edit_of_the_readme_by_hand_is_found(evidence, monkeypatch, tmp_path, was, by_hand):
    text = evidence.README.read_text("utf-8")
    assert was in text
    edited = tmp_path / "README.md"
    edited.write_text(text.replace(was, by_hand), "utf-8")
    monkeypatch.setattr(evidence, "README", edited)
    assert evidence.pages(evidence.read_record())[edited] == text


def test_predictions_of_the_felt_tower_that_were_written_down_stand_beside_its_blows(evidence):
    """Those of 28 November 2026 and the measured means, none of 17 peaks in its band: an edit of the record is found."""
    kept = next(study for study in evidence.latest(evidence.read_record()) if study.study == "felt")
    rows = [row for row in kept.rows if row.written and row.quantity == "peak"]
    assert [row.computed for row in rows] == [4741, 7789, 6322]
    with (ROOT / "tests/data/drop-tower-felt/more_shots_series.csv").open(encoding="utf-8", newline="") as file:
        blows = [row for row in csv.DictReader(file) if row["tape_layers"] == "0"]
    settings = [("15.5", "0.125"), ("19", "0.0625"), ("27.5", "0.25")]
    for setting, row in zip(settings, rows, strict=True):
        peaks = [float(blow["peak_g"]) for blow in blows if (blow["height_in"], blow["felt_in"]) == setting]
        inside = sum(row.band[0] <= peak <= row.band[1] for peak in peaks)
        assert row.reference == pytest.approx(sum(peaks) / len(peaks), rel=1e-5)  # the record has six digits
        assert (row.role, row.written, row.within) == ("predicted", "2026-11-28", (inside, len(peaks)))
        assert row.held is False
    assert sum(row.within[1] for row in rows) == 17
    assert sum(row.within[0] for row in rows) == 0


def test_shock_pulses_are_counted_apart_from_bars(evidence):
    """A Taylor bar that is met says nothing of the peak of a machine."""
    lines = evidence.totals_by_kind(evidence.latest(evidence.read_record())).splitlines()
    predicted = {cells[1].strip(): int(cells[2]) for cells in (line.split("|") for line in lines[2:])}
    shots = {name: study for name, study in evidence.STUDIES.items() if study.measured != evidence.SHOCKS}
    assert set(shots) == {"hopkinson", "strikers", "taylor"}
    record = evidence.read_record()[strikewave.__version__]
    pulses = [
        row
        for name, study in record.items()
        if name not in shots
        for row in study["rows"]
        if (row["against"], row["role"]) == ("measured", "predicted")
    ]
    assert predicted["Measured shock pulses"] == len(pulses)


def test_every_study_has_its_script_and_each_script_that_keeps_comparisons_its_study(evidence):
    scripts = {path.name: path.read_text("utf-8") for path in (ROOT / "scripts" / "validate").glob("*.py")}
    keeping = {(name, script) for script, text in scripts.items() for name in re.findall(r'keep\("([\w ]+)"', text)}
    assert keeping == {(name, study.script) for name, study in evidence.STUDIES.items()}


def test_no_prediction_misses_by_more_than_a_tenth_without_a_reason(evidence):
    with pytest.raises(ValueError, match="say why"):
        evidence.Comparison("bar", "length", "measured", "predicted", 1.0, 1.2)
    assert evidence.Comparison("bar", "length", "measured", "predicted", 4.0, 4.2).miss == pytest.approx(0.05)
    assert evidence.Comparison("bar", "length", "measured", "fitted", 1.0, 1.2, band=(1.1, 1.3)).held is False
