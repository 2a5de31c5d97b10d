"""Every command at every width: no line is longer than the screen, and no number or word is broken."""

import re
import sys

import pytest

from strikewave.cli.group import entries
from strikewave.reporting import run_and_write
from strikewave.reporting.layout import length
from strikewave.reporting.output_options import Output, Place
from strikewave.reporting.terminal import Screen, screen

from .each_command import CHEAP, COMMANDS, DEAR, SERVED, write_inputs

WIDTHS = (60, 80, 100, 160)
ENDLESS = 5000
"""A width at which nothing needs to be broken: what stands there has all words and numbers whole."""


@pytest.fixture
def inputs(strikewave):
    write_inputs(strikewave)


@pytest.fixture
def at_widths(strikewave, monkeypatch, capsys, inputs):
    """Run a command once and print its result at each width, with and without ``--wide``; return what is shown.

    A command that prints by itself runs anew for each. Warnings go to a terminal without colours; files are not drawn.
    """
    shown = {}
    monkeypatch.setenv("NO_COLOR", "1")
    kinds = [*((width, False) for width in WIDTHS), (WIDTHS[0], True), (ENDLESS, False), (ENDLESS, True)]
    once = run_and_write.print_result

    def each(command, result):
        for width, wide in kinds:
            monkeypatch.setenv("COLUMNS", str(width))
            capsys.readouterr()
            with screen(Screen(wide)):
                once(command, result)
            shown[width, wide] = "".join(capsys.readouterr())

    def call(*words):
        monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
        monkeypatch.setattr(run_and_write, "print_result", each)
        monkeypatch.setattr(Output, "place", lambda self, usual: Place(None, False))
        code, out, err = strikewave(*words)
        assert code in (0, 3), err
        for width, wide in kinds if not shown else ():
            monkeypatch.setenv("COLUMNS", str(width))
            code, out, err = strikewave(*words, *(["--wide"] if wide else []))
            shown[width, wide] = out + err
        return shown

    return call


def words_of(text: str) -> set[str]:
    """Return words and numbers without the marks between them, and without rules."""
    return {word for part in text.split() if (word := part.strip(",;:()[]")) and not re.fullmatch("[─…-]+", word)}


SAID_OF_WIDTH = words_of("not shown: (--wide) shortened to a line each: -v shows all of it")
"""What only a narrow screen shows."""


def test_every_command_is_shown_here():
    assert {*CHEAP, *DEAR, *SERVED} == set(entries())


@pytest.mark.verify
@pytest.mark.parametrize(("name", "words"), COMMANDS)
def test_no_line_is_longer_than_the_screen_and_nothing_is_broken(at_widths, name, words):
    shown = at_widths(name, *words)
    whole = SAID_OF_WIDTH.union(*(words_of(shown[ENDLESS, wide]) for wide in (False, True)))
    for (width, wide), text in shown.items():
        assert text.strip()
        longest = max(text.splitlines(), key=length)
        assert length(longest) <= width or " " not in longest.strip(), (width, wide, longest)
        assert words_of(text) <= whole, (width, wide, sorted(words_of(text) - whole))


@pytest.mark.parametrize("name", [*entries(), "--help"])
def test_help_breaks_nothing(strikewave, monkeypatch, name):
    from typer._click import formatting

    words = [name] if name == "--help" else [name, "--help"]
    monkeypatch.setattr(formatting, "FORCED_WIDTH", ENDLESS)
    whole = words_of(strikewave(*words)[1])
    monkeypatch.setattr(formatting, "FORCED_WIDTH", None)
    for width in WIDTHS:
        monkeypatch.setenv("COLUMNS", str(width))
        text = strikewave(*words)[1]
        longer = [line for line in text.splitlines() if length(line) > width]
        assert all("|" in line for line in longer), longer  # the choices of an option are one word
        assert words_of(text) <= whole, (width, sorted(words_of(text) - whole))


SHOWABLE = (
    "wave",
    "fem",
    "impact",
    "record",
    "srs",
    "hopkinson",
    "identify",
    "compare",
    "map",
    "buffer",
    "ls-dyna",
    "materials",
)
USUAL = re.compile(r"[^\n]{0,40}(?:\d (?:g|µs|us|kN|µm|MPa)(?![\w/])|\((?:g|µs|us|kN|mm|µm|GPa|MPa)\)).{0,20}")
"""A number, or a head, in the usual unit of an acceleration, a time, a force, a length or a stress."""
TYPED = "under a front of 5 us"
"""Stands in the title of a case."""


@pytest.mark.verify
@pytest.mark.parametrize("name", SHOWABLE)
def test_what_is_shown_has_the_units_chosen(at_widths, name):
    shown = at_widths(name, *CHEAP[name], "--show", "m/s2,ms,N,in,Pa")
    lines = [line.replace(TYPED, "") for line in shown[ENDLESS, True].splitlines()]
    # a warning is worded where it is found, in units of its own
    assert USUAL.findall("\n".join(line for line in lines if not re.match(r"[a-z ]+ \[", line))) == []
