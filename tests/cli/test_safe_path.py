"""Modules that lie beside the data are never executed, by no command, and in none of the processes it starts."""

import importlib.metadata
import json
import subprocess
import sys
from pathlib import Path

import pytest

from strikewave.cli.group import entries

from .each_command import CHEAP, DEAR, SERVED, write_inputs

SCRIPT = """
import json, sys
from pathlib import Path
from strikewave.cli.app import main

def fate(words):
    sys.argv = ["strikewave", *words]
    try:
        main()
    except SystemExit as end:
        return int(end.code or 0), executed.read_text() if executed.exists() else ""

if __name__ == "__main__":
    executed = Path(__file__).with_name("executed")
    print(json.dumps([fate(words) for words in json.load(sys.stdin)]), file=sys.__stdout__)
"""
"""What an installer writes for the program, a file in a folder of its own; here it runs a command after another."""
PROCESSES = dict.fromkeys(("map", "scatter"), ("--workers", "2"))
"""Commands that share their work among processes."""


def planted() -> set[str]:
    """Names of all modules of Python and of all installed packages, but for our own."""
    return {*sys.stdlib_module_names, *importlib.metadata.packages_distributions()} - {"strikewave"}


@pytest.fixture
def begun_in_data(strikewave, tmp_path, environment):
    """Run commands as installed in a folder with data and planted modules; return the exit code of each, what ran."""
    write_inputs(strikewave)
    home = tmp_path.with_name(f"{tmp_path.name}-home")
    home.mkdir()
    (home / "strikewave").write_text(SCRIPT)
    for name in planted():
        note = f"open({str(home / 'executed')!r}, 'a').write({name + ' '!r})\nraise ImportError('planted')\n"
        Path(f"{name}.py").write_text(note)

    def call(commands, *options):
        own = {key: value for key, value in environment.items() if key != "PYTHONSAFEPATH"}
        done = subprocess.run(
            [sys.executable, *options, home / "strikewave"],
            input=json.dumps(commands),
            env=own,
            capture_output=True,
            text=True,
            timeout=300.0,
            check=False,
        )
        return json.loads(done.stdout.splitlines()[-1]), done.stderr

    return call


@pytest.mark.verify
def test_no_planted_module_is_executed(begun_in_data):
    """A module that one command has imported is not looked for again by the next, from wherever it came."""
    names = sorted(entries().keys() - SERVED)
    commands = [[name, *map(str, {**DEAR, **CHEAP}[name]), *PROCESSES.get(name, ())] for name in names]
    fates, err = begun_in_data(commands)
    assert [name for name, (code, _) in zip(names, fates, strict=True) if code not in (0, 3)] == [], err
    assert {name: executed for name, (_, executed) in zip(names, fates, strict=True) if executed} == {}
