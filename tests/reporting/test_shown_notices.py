"""What stands below a result: warnings, whole in a pipe or a file; and why a published value is not comparable."""

import pytest

from strikewave.base.errors import InputError
from strikewave.base.result import Comparison, Notice
from strikewave.reporting.output_options import Shown
from strikewave.reporting.terminal import print_published, show_notices

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


def test_a_published_value_that_is_not_comparable_says_why_below_its_difference(capsys):
    shown = Comparison("first.rigid_peak", 2e5, "measured", 4e4, -0.8, "shown", "of another joint")
    fitted = Comparison("first.width", 2e-4, "measured", 2e-4, 0.0, "fitted", "chose the pad")
    print_published([shown, fitted, shown])
    out = capsys.readouterr().out
    assert out.count("shown, not comparable: of another joint") == 1
    assert "chose the pad" not in out
    assert out.index("-80.0 %") < out.index("not comparable")
