"""What a terminal gets: colours where it shows them, no command where it does not, and no trace of a bar of progress."""

import os
import re
import subprocess
import sys

import pytest

pty = pytest.importorskip("pty", reason="terminals of POSIX")

WIDTH = 80
RUN = ("run", "li-ma-2019", "--set", "feed.blows=1", "--no-band")
PROGRAM = """
from strikewave.cli import app
from strikewave.reporting.output_options import Output, Place
Output.place = lambda self, usual: Place(None, False)  # draws nothing, which would take most of the time
app.main()
"""
STYLE = re.compile(r"\x1b\[[0-9;]*m")
COMMAND = re.compile(r"\x1b\[\??([0-9;]*)([A-Za-z])")


def on_terminal(environment, folder, streams, **more):
    """Run the command with some of its streams on a terminal; return what terminal and pipe got."""
    ours, theirs = pty.openpty()
    child = subprocess.Popen(
        [sys.executable, "-c", PROGRAM, *RUN],
        cwd=folder,
        env={**environment, "TERM": "xterm-256color", "COLUMNS": str(WIDTH), **more},
        stdin=subprocess.DEVNULL,
        **{name: theirs if name in streams else subprocess.PIPE for name in ("stdout", "stderr")},
    )
    os.close(theirs)
    got = b""
    while True:
        try:
            piece = os.read(ours, 65536)
        except OSError:  # the terminal is closed at the other end
            break
        if not piece:
            break
        got += piece
    piped = b"".join(stream.read() for stream in (child.stdout, child.stderr) if stream is not None)
    assert child.wait() == 0
    os.close(ours)
    return got.decode(), piped.decode()


def left_on_screen(got):
    """Return the lines that a terminal shows at the end, and all that it showed on the way."""
    lines, row, column, seen = [""], 0, 0, []
    place = 0
    while place < len(got):
        command = COMMAND.match(got, place)
        if command:
            count, letter = int(command[1].split(";")[0] or 1), command[2]
            row = max(row - count, 0) if letter == "A" else row
            lines[row] = "" if letter == "K" else lines[row]
            assert letter in "AKmhl", command[0]
            place = command.end()
            continue
        character = got[place]
        place += 1
        if character == "\r":
            column = 0
        elif character == "\n":
            row += 1
            lines += [""] * (row + 1 - len(lines))
        else:
            lines[row] = lines[row][:column].ljust(column) + character + lines[row][column + 1 :]
            column += 1
            seen.append(lines[row])
    return lines, seen


@pytest.fixture
def environment(environment):
    return {name: value for name, value in environment.items() if name not in ("NO_COLOR", "FORCE_COLOR", "CI")}


@pytest.mark.verify
def test_a_bar_of_progress_goes_to_stderr_and_leaves_no_trace(environment, tmp_path):
    got, piped = on_terminal(environment, tmp_path, ("stderr",))
    assert piped.startswith("One blow")
    assert "\x1b" not in piped
    assert "One blow" not in got
    lines, seen = left_on_screen(got)
    assert any("━" in line for line in seen)
    assert not any("━" in line or "blows" in line for line in lines)
    assert lines[0].startswith("warning")
    assert max(map(len, lines)) <= WIDTH


@pytest.mark.verify
def test_a_terminal_gets_bold_titles_and_a_pipe_beside_it_nothing_but_letters(environment, tmp_path):
    got, piped = on_terminal(environment, tmp_path, ("stdout",))
    assert "\x1b[1m" in got
    assert piped.startswith("warning")
    assert not {"\x1b", "\r"} & set(piped)


@pytest.mark.verify
def test_without_colours_a_terminal_gets_no_styles(environment, tmp_path):
    got, _ = on_terminal(environment, tmp_path, ("stdout", "stderr"), NO_COLOR="1")
    assert "One blow" in got
    assert not STYLE.search(got)


@pytest.mark.verify
def test_a_dumb_terminal_gets_letters_only(environment, tmp_path):
    got, _ = on_terminal(environment, tmp_path, ("stdout", "stderr"), TERM="dumb")
    assert got.isascii()
    assert not {"\x1b", "\r"} & set(got.replace("\r\n", "\n"))
