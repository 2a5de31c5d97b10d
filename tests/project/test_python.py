"""What Python, its type checkers and its editors know of the package."""

import ast
import builtins
import importlib.resources
import subprocess
import sys
from pathlib import Path

import jedi
import pytest

import strikewave

PROGRAM = """
import strikewave

solution = strikewave.run_case(strikewave.load_case("li-ma-2019"))
"""


def completed(last):
    """Return what an editor offers after the last line of a program that ran a case."""
    lines = (PROGRAM + last).split("\n")
    offered = jedi.Script("\n".join(lines)).complete(len(lines), len(lines[-1]))
    return {name.name for name in offered if not name.name.startswith("_")}


def test_the_names_that_type_checkers_see_are_those_that_are_imported_when_used():
    tree = ast.parse(Path(strikewave.__file__).read_text("utf-8"))
    block = next(node for node in tree.body if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING")
    typed = {
        alias.asname: node.module.removeprefix("strikewave.")
        for node in block.body
        for alias in node.names
        if alias.name == alias.asname  # as type checkers ask of names that a module passes on
    }
    assert typed == strikewave._HOMES


def test_dir_lists_the_public_names_and_nothing_else():
    assert dir(strikewave) == sorted(["__version__", *strikewave._HOMES])


def test_a_star_import_hides_no_function_of_python():
    assert not set(strikewave.__all__) & set(dir(builtins))


def test_the_package_says_that_it_is_typed():
    assert (importlib.resources.files("strikewave") / "py.typed").is_file()


def test_editors_complete_the_names_a_run_and_its_blows():
    assert set(strikewave._HOMES) <= completed("strikewave.")
    assert {"blows", "band", "data", "plot", "report", "to_dataframe"} <= completed("solution.")
    assert {"rigid_peak", "width", "velocity_change"} <= completed("solution.blows[0].")
    assert {"low", "high", "level", "inputs"} <= completed('solution.band["first.rigid_peak"].')


@pytest.mark.verify  # a type checker reads numpy, xarray and pydantic first: 12 s
def test_type_checkers_know_a_run_its_blows_its_data_and_a_misspelled_name(tmp_path):
    revealed = {
        "solution": "strikewave.analyses.machine.result.Solution",
        "solution.blows[0].rigid_peak": "float",
        "solution.band": "typing.Mapping[str, strikewave.base.result.Band]",
        "solution.data": "xarray.core.dataset.Dataset",
    }
    program = PROGRAM + "".join(f"reveal_type({what})\n" for what in revealed) + "strikewave.run_cose\n"
    (tmp_path / "program.py").write_text(program)
    command = [sys.executable, "-m", "mypy", "--strict", "--cache-dir", str(tmp_path / "cache"), "program.py"]
    told = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False).stdout
    for type_ in revealed.values():
        assert f'Revealed type is "{type_}"' in told
    assert told.count("error:") == 1
    assert 'has no attribute "run_cose"' in told
