"""Random cases at the edge of what is valid close their balances or are refused; scripts/validate/extremes.py makes more."""

import runpy
from pathlib import Path

import pytest

SCRIPTS = Path(__file__).parents[2] / "scripts/validate"
CASES = 8


@pytest.fixture
def fate(monkeypatch):
    monkeypatch.syspath_prepend(SCRIPTS)
    return runpy.run_path(str(SCRIPTS / "extremes.py"))["fate"]


@pytest.mark.verify
@pytest.mark.parametrize("analysis", ["run", "wave", "fem", "impact", "srs", "record"])
def test_random_extremes_close_or_are_refused(fate, analysis):
    fates = [fate(analysis, k) for k in range(CASES)]
    assert [what for what in fates if what.partition(":")[0] not in ("closed", "reported", "refused")] == []
