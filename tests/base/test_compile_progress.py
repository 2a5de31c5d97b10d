"""Kernels that are compiled are counted and shown, once, by whoever stands closest; what the cache holds is not."""

import io
import re
import subprocess
import sys

import numba
import pytest

import strikewave
from strikewave.base.compiling import WORDS, compiling_shown
from strikewave.reporting.terminal import progress_bar


class Terminal(io.StringIO):
    def isatty(self):
        return True


def compile_two():
    """Compile a kernel that calls another."""
    inner = numba.njit(lambda x: 2.0 * x)
    numba.njit(lambda x: inner(x) + 1.0)(3.0)


def test_each_kernel_counts_once_and_the_end_is_told():
    told = []
    with compiling_shown(lambda *what: told.append(what)):
        compile_two()
        assert told == [(0, False), (1, False), (2, False)]
    assert told[-1] == (2, True)


def test_an_inner_context_of_its_own_shows_and_one_without_leaves_it_to_the_outer():
    outer, inner = [], []
    with compiling_shown(lambda *what: outer.append(what)):
        with compiling_shown():
            compile_two()
        with compiling_shown(lambda *what: inner.append(what)):
            compile_two()
    assert outer == inner == [(0, False), (1, False), (2, False), (2, True)]


def test_a_terminal_sees_one_line_and_a_script_none(monkeypatch):
    for stderr, lines in ((Terminal(), 1), (io.StringIO(), 0)):
        monkeypatch.setattr(sys, "stderr", stderr)
        with compiling_shown():
            compile_two()
        text = stderr.getvalue()
        assert text.count("\n") == lines
        assert text.count(f"\r{WORDS}: ") == 4 * lines
        assert re.search(r"2 compiled in \d+ s\n", text) or not lines  # however long it took


def test_the_line_ends_where_a_run_fails(monkeypatch):
    monkeypatch.setattr(sys, "stderr", Terminal())
    with pytest.raises(ZeroDivisionError), compiling_shown():
        compile_two()
        raise ZeroDivisionError
    assert sys.stderr.getvalue().endswith(" s\n")
    with compiling_shown():
        pass
    assert sys.stderr.getvalue().count("\n") == 1


@pytest.mark.verify
def test_kernels_in_the_cache_are_loaded_without_a_word():
    program = """
import strikewave
from strikewave.base.compiling import compiling_shown

told = []
with compiling_shown(lambda *what: told.append(what)):
    strikewave.run_case(strikewave.load_case("li-ma-2019", ["feed.blows=1"]))
print(told)
"""
    strikewave.run_case(strikewave.load_case("li-ma-2019", ["feed.blows=1"]))  # fills the cache, where it is empty
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert run.stdout == "[]\n"


def test_a_command_says_it_once_in_a_log(capsys):
    with progress_bar("blows") as report:
        compile_two()
        report(1.0)
    assert capsys.readouterr().err.count(WORDS) == 1
