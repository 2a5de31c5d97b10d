"""Measured files of others that the tests read: whose they are, under which licence, and that they stay small."""

import zlib
from pathlib import Path

import pytest

DATA = Path(__file__).parents[1] / "data"
SETS = sorted(path.name for path in DATA.iterdir())
LIMIT = 6e6
"""Bytes of all files, packed as git packs them: what everyone who clones has to fetch."""


@pytest.mark.parametrize("name", SETS)
def test_each_set_names_source_credit_and_licence(name):
    told = (DATA / name / "README.md").read_text("utf-8")
    for heading in ("- Source:", "- Credit:", "- Licence:", "- Done to it:"):
        assert heading in told
    licence = (DATA / name / "LICENSE").read_text("utf-8")
    assert len(licence) > 1000


def test_all_sets_together_stay_small():
    packed = [len(zlib.compress(path.read_bytes())) for path in DATA.rglob("*") if path.is_file()]
    assert sum(packed) < LIMIT


@pytest.mark.parametrize("name", SETS)
def test_each_set_unpacks_whole(measured, name):
    """The checksum within each xz file is checked as it is unpacked."""
    carried = {path.name.removesuffix(".xz") for path in (DATA / name).iterdir()}
    assert {path.name for path in measured(name).iterdir()} == carried
