"""Every command at every width: no line is longer than the screen, and no number or word is broken."""

import re
import sys
from pathlib import Path

import numpy as np
import pytest

from strikewave.cli.group import entries
from strikewave.reporting import run_and_write
from strikewave.reporting.layout import length
from strikewave.reporting.options import Output, Place
from strikewave.reporting.terminal import Screen, screen

WIDTHS = (60, 80, 100, 160)
ENDLESS = 5000
"""A width at which nothing needs to be broken: what stands there has all words and numbers whole."""
GOAL = ("--interval", "20 ms", "--peak", "4000 g", "--width", "200 us", "--strikers", "4", "--striker-mass", "1 kg")
GASKETS = ("--material", "PTFE", "--thickness", "1 mm", "--layers", "1")
TWO = ("--set", "feed.blows=2")
BLOCK = """
schema = 1
[[mesh.part]]
name = "rod"
shape = "block"
material = "2A12"
width = "4 mm"
depth = "4 mm"
height = "20 mm"
size = "2 mm"
velocity = { z = "-60 m/s" }
solid = { law = "bilinear", tangent_modulus = "1 GPa" }
[fem]
duration = "30 us"
interval = "0.5 us"
[[fem.wall]]
side = "rod.z-"
normal = "z"
"""
"""A block on a wall."""
CHEAP = {
    "run": ("jesd22-b111-b", "--no-band"),
    "wave": ("li-ma-2019-fig13-bar", "--no-band"),
    "fem": ("block.toml", "--no-report"),
    "impact": ("--m1", "0.2", "--m2", "0.4", "--speed", "3", "--stiffness", "4.7e9", "-n", "1.1", "-e", "0.5"),
    "laws": (),
    "record": ("pulse.csv",),
    "srs": ("pulse.csv", "--per-octave", "1"),
    "spec": ("show", "jesd22-b110:B"),
    "hopkinson": ("shot.toml",),
    "identify": ("pulse.csv", "--m1", "0.2", "--m2", "0.4"),
    "compare": ("pulse.csv", "pulse.csv", "--limit", "iso18571 > 0.8"),
    "fit": ("jesd22-b111-b", "--to", "first.rigid_peak=1500 g", "--free", "contact.reference_force"),
    "map": ("li-ma-2019", "--points", "3x2", "--workers", "1", "--train", "0", *TWO),
    "buffer": ("li-ma-2019-fig5", "--sensor", "buffered", "--limit", "7000 g", *GASKETS),
    "deck": ("block.toml",),
    "ls-dyna": (Path(__file__).parents[1] / "exchange/data", "--units", "mm-t-s"),
    "new": ("mine", "--force"),
    "validate": ("li-ma-2019-fig5",),
    "diff": ("li-ma-2019", "li-ma-2019-equal-blows"),
    "cases": (),
    "materials": (),
}
DEAR = {
    "run": ("li-ma-2019-fig5", *TWO),  # with bands of a stack and its sensors
    "wave": ("togami-1996-bar",),
    "reproduce": ("li-ma-2019", "--without", "elements", "--without", "studies"),
    "settings": (*GOAL, "--blows", "3"),
    "scatter": ("li-ma-2019-equal-blows", "--runs", "10", "--workers", "1", "--shares", "none", *TWO),
}
COMMANDS = [
    *(pytest.param(name, words, id=name) for name, words in CHEAP.items()),
    *(pytest.param(name, words, id=f"{name}-dear", marks=pytest.mark.verify) for name, words in DEAR.items()),
]


@pytest.fixture
def inputs(strikewave):
    """Files that the commands take: a half sine of 3000 g, a block, a measured shot."""
    time = np.arange(0.0, 1e-3, 2e-6)
    pulse = 3000.0 * np.clip(np.sin(np.pi * (time - 2e-4) / 2e-4), 0.0, None) * ((time > 2e-4) & (time < 4e-4))
    lines = [f"{t:.6f},{a:.4f}" for t, a in zip(time, pulse, strict=True)]
    Path("pulse.csv").write_text("\n".join(["time [s],acceleration [g]", *lines]) + "\n")
    Path("block.toml").write_text(BLOCK)
    assert strikewave("new", "shot", "--from", "hopkinson")[0] == 0


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
    assert {*CHEAP, *DEAR} == set(entries())


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


@pytest.mark.parametrize("name", SHOWABLE)
def test_what_is_shown_has_the_units_chosen(at_widths, name):
    shown = at_widths(name, *CHEAP[name], "--show", "m/s2,ms,N,in,Pa")
    lines = [line.replace(TYPED, "") for line in shown[ENDLESS, True].splitlines()]
    # a warning is worded where it is found, in units of its own
    assert USUAL.findall("\n".join(line for line in lines if not re.match(r"[a-z ]+ \[", line))) == []
