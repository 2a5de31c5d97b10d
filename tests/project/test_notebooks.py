"""The notebooks of docs run as they stand, and show what they promise."""

import xml.etree.ElementTree as ElementTree
from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient

import strikewave

pytestmark = pytest.mark.verify

NOTEBOOKS = sorted((Path(strikewave.__file__).parent / "examples" / "notebooks").glob("*.ipynb"))


@pytest.fixture(scope="module")
def first_run(tmp_path_factory):
    """Return the executed cells of the first notebook by their ids, and the folder in which they ran."""
    folder = tmp_path_factory.mktemp("notebook")
    notebook = nbformat.read(next(path for path in NOTEBOOKS if path.stem == "first-blow"), 4)
    client = NotebookClient(notebook, timeout=300, kernel_name="python3", resources={"metadata": {"path": str(folder)}})
    client.execute()
    return {cell.id: cell for cell in notebook.cells}, folder


def shown(cell):
    """Return what a cell's value was shown as, by type of content."""
    (result,) = [output for output in cell.outputs if output.output_type == "execute_result"]
    return result.data


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_notebooks_are_valid_and_kept_without_outputs(path):
    notebook = nbformat.read(path, 4)
    nbformat.validate(notebook)
    for cell in notebook.cells:
        if cell.cell_type == "code":
            assert not cell.outputs
            assert cell.execution_count is None


@pytest.mark.verify
def test_a_result_and_a_study_show_a_table_and_a_curve(first_run):
    cells, _ = first_run
    for name in ("run", "record", "scatter"):
        page = shown(cells[name])["text/html"]
        assert "<table" in page
        drawing = page[page.index("<svg") : page.index("</svg>") + len("</svg>")]
        (line,) = [part for part in ElementTree.fromstring(drawing).iter() if part.tag.endswith("polyline")]
        assert len(line.attrib["points"].split()) >= 3, name  # the mean of each of three blows; a pulse has hundreds
    assert "4151" in shown(cells["run"])["text/html"]


def test_a_change_of_speed_shows_in_the_line_of_a_result(first_run):
    cells, _ = first_run
    before, after = shown(cells["change"])["text/plain"].splitlines()
    assert "first rigid peak 4151 g" in before
    assert "Solution li-ma-2019" in after
    assert "first rigid peak 4151 g" not in after


def test_the_recorded_blows_are_those_of_the_run(first_run):
    """Written by the recorder of the run, read and judged as a measured file: as many blows as the machine made."""
    cells, _ = first_run
    assert "files 1, blows 3" in shown(cells["record"])["text/plain"]


def test_a_plot_is_drawn_once_as_an_image(first_run):
    cells, _ = first_run
    images = [output.data["image/png"] for output in cells["plot"].outputs if "image/png" in output.get("data", {})]
    assert len(images) == 1
    assert len(images[0]) > 10_000


def test_dataframe_and_report_are_there(first_run):
    cells, folder = first_run
    assert "rigid_peak" in shown(cells["dataframe"])["text/html"]
    assert shown(cells["units"])["text/plain"] == "'m/s^2'"
    assert (folder / "first-blow.html").read_text("utf-8").startswith("<!")


def test_nothing_of_a_notebook_warns(first_run):
    cells, _ = first_run
    said = [
        output.text for cell in cells.values() for output in cell.get("outputs", []) if output.output_type == "stream"
    ]
    assert "Warning" not in "".join(said)  # cold kernels say that they are compiled
