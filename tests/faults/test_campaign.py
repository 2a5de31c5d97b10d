"""Faults that befall commands: see `campaign`. The whole campaign is that program; here stands a sample of it."""

import importlib.util
import sys
from pathlib import Path

import pytest

FILE = Path(__file__).with_name("campaign.py")


@pytest.fixture(scope="module")
def campaign():
    spec = importlib.util.spec_from_file_location("campaign", FILE)
    module = sys.modules["campaign"] = importlib.util.module_from_spec(spec)  # dataclasses look for theirs there
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def bench(campaign, tmp_path_factory):
    return campaign.Bench(tmp_path_factory.mktemp("faults"))


def fate(campaign, bench, name, words):
    """Return what was lost; skip what cannot be tried here, such as a disk of one's own without being root."""
    lost = bench.survives(name, campaign.FAULTS[words])
    if lost == "not tried":
        pytest.skip(f"{words}: cannot be tried here")
    return lost


@pytest.mark.verify
def test_an_impact_survives_a_limit_on_files(campaign, bench):
    assert fate(campaign, bench, "impact", "files limited to a few kB") == ""


FAULTS = (
    "kill -9 at a random moment",
    "SIGTERM at a random moment",
    "a real disk that is full",
    "files limited to a few kB",
    "a disk to be read only",
    "few file handles",
    "no HOME",
    "a TMPDIR that is not there",
    "another locale, stdout in ASCII",
    "stdout closed",
    "stdout on a full disk",
    "compiled kernels damaged",
    "compiled kernels on a full disk",
)


OF_KERNELS = ("compiled kernels damaged", "compiled kernels on a full disk")
"""Tried with the command that compiles the fewest."""
TRIED = [
    (name, words)
    for name in ("impact", "run", "fem")
    for words in FAULTS
    if name == "impact" or words not in OF_KERNELS
]


@pytest.mark.verify
@pytest.mark.parametrize(("name", "words"), TRIED)
def test_nothing_is_lost(campaign, bench, name, words):
    assert fate(campaign, bench, name, words) == ""
