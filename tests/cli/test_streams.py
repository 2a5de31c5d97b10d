"""What is printed where nobody takes it: a full disk, a closed stream, a reader that has seen enough; and Ctrl-C."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

IMPACT = ("impact", "--stiffness", "4.7e9", "--exponent", "1.5", "-e", "0.5", "--m1", "1", "--m2", "2", "--speed", "1")


def shell(line, environment):
    words = f'"{sys.executable}" -m strikewave'
    return subprocess.run(
        line.replace("strikewave", words), check=False, shell=True, env=environment, capture_output=True, text=True
    )


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="a disk without room, of Linux")
def test_a_full_disk_under_stdout_is_one_line(environment):
    done = shell("strikewave materials > /dev/full", environment)
    assert done.returncode == 2
    assert done.stderr == "the system refused what was to be printed or written: No space left on device\n"


@pytest.mark.verify
@pytest.mark.skipif(not Path("/dev/full").exists(), reason="a disk without room, of Linux")
def test_a_full_disk_under_stderr_costs_words_and_no_result(environment, tmp_path):
    command = "strikewave impact --m1 0.2 --m2 0.4 --speed 20 -e 0.5 --stiffness 1e9 --exponent 1.5"
    whole = shell(f"{command} --out {tmp_path}/a", environment)
    done = shell(f"{command} --out {tmp_path}/b 2> /dev/full", environment)
    assert (done.returncode, done.stdout) == (whole.returncode, whole.stdout) == (0, whole.stdout)
    assert "written: " in whole.stderr
    assert {path.name for path in (tmp_path / "b").iterdir()} == {path.name for path in (tmp_path / "a").iterdir()}


def test_closed_streams_are_no_fault(environment):
    done = shell("strikewave materials <&- >&-", environment)
    assert (done.returncode, done.stderr) == (0, "")


def test_a_reader_that_has_seen_enough_ends_it_quietly(environment):
    reader, writer = os.pipe()
    os.close(reader)
    words = [sys.executable, "-m", "strikewave", "materials", "--json"]
    done = subprocess.run(words, env=environment, stdout=writer, stderr=subprocess.PIPE, check=False)
    os.close(writer)
    assert (done.returncode, done.stderr) == (0, b"")


@pytest.mark.verify
def test_ctrl_c_after_the_result_says_that_it_is_whole(strikewave, monkeypatch):
    def stopped(*_):
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr("strikewave.reporting.run_and_write.print_result", stopped)
        assert strikewave(*IMPACT, "--out", "x") == (130, "", "stopped; the result is whole: x\n")
    assert Path("x/impact.json").is_file()
    with monkeypatch.context() as patch:
        patch.setattr("strikewave.reporting.run_and_write.write_files", stopped)
        assert strikewave(*IMPACT, "--out", "y") == (130, "", "stopped; nothing was written\n")
    assert [path.name for path in Path().iterdir()] == ["x"]


def test_a_case_that_begins_with_a_byte_order_mark_is_read(strikewave):
    """As an editor of Windows saves it."""
    assert strikewave("new", "a.toml")[0] == 0
    Path("a.toml").write_bytes(b"\xef\xbb\xbf" + Path("a.toml").read_bytes())
    assert strikewave("validate", "a.toml")[0] == 0
