"""The commands of the how-to page do what it says, section by section, typed as they stand there."""

import glob
import re
import shlex
import shutil
from pathlib import Path

import numpy as np
import pytest

PAGE = (Path(__file__).parents[2] / "docs" / "howto.md").read_text("utf-8")
RESULTS = Path(__file__).parents[1] / "exchange" / "data"
"""Files as LS-DYNA writes them."""
SECTIONS = {
    head: text
    for head, text in re.findall(r"^## (.+?)\n(.*?)(?=^## |\Z)", PAGE, re.MULTILINE | re.DOTALL)
    if "    strikewave" in text
}
ELSEWHERE = ("tcp://HOST", "--install-completion")
"""What needs a cluster, or changes the shell of who runs it."""
EDITS = {
    "test.toml": ('\nitem = ""', '\nitem = "a box"'),
    "my-srs.toml": ("\n[srs]\n", "\n[srs]\n" + re.findall(r"`(points = .+?)`", PAGE)[0] + "\n"),
    "my-bars.toml": ('"60 us"', '"6 us"'),
}
"""In a new file: what stands there, and what is written in its place."""
GROUND = (31.4, 11e-3)
"""Peak (g) and width (s) of a half-sine that is within ``mil-std-810h:ground``."""
DROP = (1500.0, 0.5e-3)
"""Those of one that the drop table ``my-drop.toml`` gives."""
FAILED = 3
"""Exit code of a verdict: a half-sine of 31 g is below the spectra of spacecraft."""


def half_sine(peak: float, width: float) -> np.ndarray:
    """Return time (s) and acceleration (g) of a pulse between two stretches of rest."""
    time = np.linspace(0.0, 5.0 * width, 8000)
    pulse = np.where((time > width) & (time < 2.0 * width), np.sin(np.pi * (time / width - 1.0)), 0.0)
    return np.column_stack([time, peak * pulse])


def commands(section: str) -> list[str]:
    """Return the lines of a section that call the program."""
    return re.findall(r"^    (strikewave .+)$", SECTIONS[section], re.MULTILINE)


def typed(line: str) -> list[str]:
    """Return the words that a shell hands over: names of files for an asterisk outside quotes, no comment."""
    words = []
    for word in shlex.split(line, comments=True)[1:]:
        words += sorted(glob.glob(word)) if "*" in word and f'"{word}"' not in line else [word]
    return words


def edit(name: str) -> None:
    """Do in a new file what the page leaves to the reader, and shorten what takes long."""
    old, new = EDITS[name]
    text = Path(name).read_text("utf-8")
    assert old in text
    Path(name).write_text(text.replace(old, new, 1), "utf-8")


@pytest.mark.verify
@pytest.mark.parametrize("section", SECTIONS)
def test_each_command_of_the_page_does_its_work(strikewave, section):
    Path("shots").mkdir()
    fitted = section == "Fit my machine"
    for name in ("shots/1.csv",) if fitted else ("shot.csv", "shots/1.csv", "shots/2.csv"):
        np.savetxt(name, half_sine(*(DROP if fitted else GROUND)), delimiter=",")
    shutil.copytree(RESULTS, "results")
    if not fitted:
        strikewave("new", "my-drop", "--from", "jesd22-b111-b")
    for name, text in re.findall(r"Save as `(.+?)`:\n\n```toml\n(.*?)```", SECTIONS[section], re.DOTALL):
        Path(name).write_text(text, "utf-8")
    for line in commands(section):
        if not any(word in line for word in ELSEWHERE):
            words = typed(line)
            code, _, err = strikewave(*words)
            assert code == (FAILED if words[0] == "srs" else 0), err
            for name in EDITS.keys() & {*words, f"{words[1]}.toml"} if "new" in words else ():
                edit(name)
