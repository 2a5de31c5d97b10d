"""Modules that lie beside the data are never executed, by no command, and in none of the processes it starts."""

import importlib.metadata
import subprocess
import sys
from pathlib import Path

import pytest

from strikewave.cli.group import entries

from .each_command import CHEAP, DEAR, SERVED, write_inputs

SCRIPT = "import sys\nfrom strikewave.cli.app import main\nif __name__ == '__main__':\n    sys.exit(main())\n"
"""What an installer writes for the program: a file in a folder of its own."""
PROCESSES = dict.fromkeys(("map", "scatter"), ("--workers", "2"))
"""Commands that share their work among processes."""


def planted() -> set[str]:
    """Names of all modules of Python and of all installed packages, but for our own."""
    return {*sys.stdlib_module_names, *importlib.metadata.packages_distributions()} - {"strikewave"}


@pytest.fixture
def begun_in_data(strikewave, tmp_path, environment):
    """Run a command as installed in a folder with data and planted modules; return exit code, stderr, what ran."""
    write_inputs(strikewave)
    home = tmp_path.with_name(f"{tmp_path.name}-home")
    home.mkdir()
    (home / "strikewave").write_text(SCRIPT)
    for name in planted():
        note = f"open({str(home / 'executed')!r}, 'a').write({name + ' '!r})\nraise ImportError('planted')\n"
        Path(f"{name}.py").write_text(note)

    def call(start, *words):
        own = {key: value for key, value in environment.items() if key != "PYTHONSAFEPATH"}
        command = [sys.executable, *(start or [home / "strikewave"]), *map(str, words)]
        done = subprocess.run(command, env=own, capture_output=True, text=True, timeout=300.0, check=False)
        executed = home / "executed"
        return done.returncode, done.stderr, executed.read_text() if executed.exists() else ""

    return call


@pytest.mark.verify
@pytest.mark.parametrize("name", sorted(entries().keys() - SERVED))
def test_no_planted_module_is_executed(begun_in_data, name):
    words = (*{**CHEAP, **DEAR}[name], *PROCESSES.get(name, ()))
    code, err, executed = begun_in_data((), name, *words)
    assert code in (0, 3), err
    assert executed == ""


@pytest.mark.verify
def test_python_with_safe_path_executes_none(begun_in_data):
    code, err, executed = begun_in_data(["-P", "-m", "strikewave"], "map", *CHEAP["map"], *PROCESSES["map"])
    assert code in (0, 3), err
    assert executed == ""
