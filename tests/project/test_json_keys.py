"""Every key of the JSON documents is declared, with its meaning, by the class of the result that prints it."""

import re
from pathlib import Path

import pytest

from strikewave.cli.group import entries, whole_command

DOCS = Path(__file__).parents[2] / "docs"


@pytest.fixture
def meanings(monkeypatch):
    monkeypatch.syspath_prepend(DOCS / "_extensions")
    import json_meanings

    return json_meanings


@pytest.fixture
def commands(meanings):
    page = (DOCS / "json.md").read_text("utf-8")
    return meanings.commands_of(page.partition("```{json-keys}\n")[2].partition("```")[0])


@pytest.mark.verify
def test_every_key_of_a_document_is_declared(meanings, commands):
    documents = meanings.check_documents(commands)
    assert {one.title for one in commands} >= {"run", "wave", "fem", "record", "fit", "map"}
    assert documents["wave li-ma-2019-fig13-bar"]["units"]["force"] == "N"


NOT_DESCRIBED = {"doctor", "examples", "new"}
"""Commands without a result: their documents say what is installed, and what was written."""


def test_every_command_that_prints_a_document_has_a_table(commands):
    described = {re.split("[, ]", one.title)[0] for one in commands}
    printing = {
        name
        for name, entry in entries().items()
        if any("--json" in option.opts for option in whole_command(name, entry.module).params)
    }
    assert printing - described == NOT_DESCRIBED
    kinds = {one.kind.__name__ for one in commands}
    assert kinds >= {"SensorSolution", "EchoSolution", "LsDynaResult", "Reproduction"}


def test_a_key_that_is_not_declared_is_found(meanings, commands):
    run = commands[0].kind
    document = {"case": "x", "blows": [{"time": 0.5, "sensors": {"end": {"peak": 1.0, "hue": 2.0}}}], "colour": 1}
    assert meanings.unknown_keys([run], document) == ["blows[].sensors.*.hue", "colour"]
    assert meanings.unknown_keys([meanings.DocumentHead], {"schema": 1, "units": {"any": "N"}, "warnings": []}) == []


def test_tables_have_unit_and_meaning_of_each_key_and_lead_to_what_several_share(meanings, commands):
    from strikewave.base.result import Band

    shared = meanings.shared_classes(commands)
    assert Band in shared
    run = {
        one.path: one for kind in meanings.described_with(commands[0].kind) for one in meanings.keys_of(kind, shared)
    }
    assert (run["blows[].rigid_peak"].unit, run["band.*"].leads_to) == ("m/s^2", Band)
    assert {one.path: one.meaning for one in meanings.keys_of(Band, shared)}["high"] == "its upper end"
    assert meanings.heading_of(Band) == "The range of a result when inputs move within what is known of them"
