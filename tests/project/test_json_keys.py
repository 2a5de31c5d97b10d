"""Every key of the JSON documents has its meaning in the docs, and every meaning a key."""

from pathlib import Path

import pytest

EXTENSIONS = Path(__file__).parents[2] / "docs" / "_extensions"


@pytest.fixture
def meanings(monkeypatch):
    monkeypatch.syspath_prepend(EXTENSIONS)
    import json_meanings

    return json_meanings


@pytest.mark.verify
def test_every_key_of_a_document_has_its_meaning_and_every_meaning_a_key(meanings):
    commands, shared = meanings.key_tables()
    assert {"run", "wave", "fem", "record", "fit", "map"} <= {one.title for one in commands}
    assert shared["blow"].seen["rigid_peak"] == "m/s^2"
    assert next(one for one in commands if one.title == "record").seen["sensor.range"] == "m/s^2"


def test_a_key_without_a_meaning_is_refused(meanings):
    known = meanings.KeyTable("run", {"blows[].time": "first touch", "masses.*": "of each body"})
    meanings._look(known, {"blows": [{"time": 0.5}], "masses": {"striker": 1.0}}, {"time": "s", "masses": "kg"}, {})
    assert known.seen == {"blows[].time": "s", "masses.*": "kg"}
    with pytest.raises(ValueError, match=r"no meaning of 'blows\[\]\.kind' in \[run\]"):
        meanings._look(known, {"blows": [{"time": 0.5, "kind": "full"}]}, {}, {})


def test_meanings_of_fields_are_those_of_their_class(meanings):
    from strikewave.base.result import Band

    assert meanings._of_class(Band)["high"] == "its ends, in the SI unit of the result"
