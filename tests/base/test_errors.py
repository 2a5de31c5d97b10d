"""Errors as they go from process to process."""

import pickle
from pathlib import Path

import pytest

from strikewave.base.errors import MISSING, InputError, InputErrors, MissingPackageError


@pytest.mark.parametrize(
    "error",
    [
        InputError("machine.speed", "730", "a rotational speed with its unit", 'write "730 rpm"'),
        InputError("striker", MISSING, "a striker"),
        InputError("--out", Path("out/map"), "a new folder"),
        MissingPackageError("--xlsx", "openpyxl", "formats"),
        InputErrors(["striker: missing; add [striker]", "object: missing; add [object]"]),
    ],
)
def test_an_error_of_another_process_is_the_same(error):
    again = pickle.loads(pickle.dumps(error))
    assert type(again) is type(error)
    assert str(again) == str(error)
    assert vars(again) == vars(error)
