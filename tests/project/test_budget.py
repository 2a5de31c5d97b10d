"""The code stays within its budgets, and what counts it sees what it counts."""

import importlib.util
import sys
from pathlib import Path

import pytest

SCRIPT = Path(__file__).parents[2] / "scripts" / "budget.py"
RUN = ["    value = first" + " + other" * k for k in range(13)]


@pytest.fixture(scope="module")
def budget():
    spec = importlib.util.spec_from_file_location("budget", SCRIPT)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture
def package(tmp_path):
    """A package of two rooms: a run of lines stands twice, with other names; `used` has one importer, `open` two."""
    files = {
        "room/used.py": ["def f(x):", *RUN],
        "room/open.py": ["from plan.room.used import f", "import math", "def g(x):", *(line.replace("first", "b") for line in RUN)],
        "hall/one.py": ["from plan.room.open import g"],
        "hall/other.py": ["from plan.room import open"],
        "top.py": ["x = 1"],
    }  # fmt: skip
    for name, lines in files.items():
        path = tmp_path / "plan" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("\n".join(lines) + "\n")
    return tmp_path / "plan"


def test_lines_files_imports_and_modules_with_one_importer_are_counted(budget, package):
    assert budget.room_sizes(package) == {"hall": (2, 2), "room": (30, 2), "top": (1, 1)}
    assert budget.import_share(package) == pytest.approx(100.0 * 4 / 33)
    assert budget.lone_modules(package) == ["plan.room.used"]


def test_a_run_of_lines_that_stands_twice_is_found_once_whatever_its_names(budget, package):
    assert budget.repeats(package) == [("room/open.py:3", "room/used.py:1")]
    (package / "room" / "used.py").write_text("\n".join(["def f(x):", *RUN[:10]]))
    assert budget.repeats(package) == []


def test_a_room_above_its_budget_ends_with_1(budget, package, monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["budget.py"])
    monkeypatch.setattr(budget, "PACKAGE", package)
    assert budget.main() == 1
    assert "plan" not in capsys.readouterr().err
    monkeypatch.setattr(budget, "ROOT", package)
    (package / "scripts").mkdir()
    rooms = {"hall": (2, 2), "room": (29, 2), "top": (1, 1)}
    table = "".join(f"{name} = {{ lines = {lines}, files = {files} }}\n" for name, (lines, files) in rooms.items())
    limits = "imports = 20\none_importer = 1\nrepeats = 1\n[commands]\n[rooms]\n"
    (package / "scripts" / "budgets.toml").write_text(limits + table)
    assert budget.main() == 1
    assert "room, lines                                30 of       29  above its budget" in capsys.readouterr().out
    (package / "scripts" / "budgets.toml").write_text(limits + table.replace("29", "30"))
    assert budget.main() == 0


@pytest.mark.verify
def test_the_code_and_what_commands_enter_stay_within_their_budgets(budget, monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["budget.py", "--commands"])
    code = budget.main()
    assert code == 0, capsys.readouterr().out
