"""Warnings: a screen gets the begin of a long one, a pipe or a file all of it."""

import pytest

from strikewave.base.errors import InputError
from strikewave.base.result import Notice
from strikewave.reporting.options.output import Shown
from strikewave.reporting.terminal import show_notices

LONG = [Notice("code", "word " * 60 + "end")]


def test_a_pipe_gets_a_warning_whole(monkeypatch, capsys):
    monkeypatch.delenv("COLUMNS", raising=False)
    show_notices(LONG)
    [line] = capsys.readouterr().err.splitlines()
    assert line.endswith("word end")


def test_a_terminal_gets_a_line_and_the_way_to_the_rest(monkeypatch, capsys):
    monkeypatch.setenv("COLUMNS", "80")
    show_notices(LONG)
    first, last = capsys.readouterr().err.splitlines()
    assert (first[-1], len(first) <= 80) == ("…", True)
    assert "-v shows all of it" in last


def test_all_and_nothing_exclude_each_other():
    with pytest.raises(InputError, match="either --quiet or --verbose; leave one out"):
        Shown(verbose=True, quiet=True).in_force()
