"""Faults that befall commands: see `campaign`. The whole campaign is that program; here it tries a part of them."""

import subprocess
import sys
from pathlib import Path

import pytest

CAMPAIGN = Path(__file__).with_name("campaign.py")


def fates(environment, *words):
    """Return what became of each fault that could be tried here, by fault and command."""
    done = subprocess.run(
        [sys.executable, CAMPAIGN, *words], env=environment, capture_output=True, text=True, check=False
    )
    rows = [line.split(" | ") for line in done.stdout.partition("| Fault |")[0].splitlines()]
    return {(fault, name): fate for fault, name, fate in rows if fate != "not tried"}, done.stderr


AT_START = (
    "a disk to be read only",
    "few file handles",
    "no HOME",
    "stdout closed",
    "stdout on a full disk",
    "settings of libraries beside the data",
    "compiled kernels damaged",
)


def asked(*faults):
    """Return the options that ask for these faults alone."""
    return tuple(word for fault in faults for word in ("--only", fault))


@pytest.mark.verify
@pytest.mark.parametrize(
    "words",
    [
        ("impact", "--only", "chance"),
        ("fem", *asked("kill -9 at a random moment", "files limited to a few kB")),
        ("impact", *asked(*AT_START)),
    ],
    ids=["commands that run", "long runs", "commands that start"],
)
def test_nothing_is_lost(environment, words):
    found, told = fates(environment, *words)
    assert found, told
    assert {where: fate for where, fate in found.items() if fate != "survived"} == {}
