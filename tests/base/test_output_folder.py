"""Kernel cache: an unwritable place is survived with a word. Result folders: whole or not at all, and never another's."""

import contextlib
import errno
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from strikewave.base.compiled import PACKAGE, kernel_key
from strikewave.base.errors import InputError
from strikewave.base.output_folder import (
    atomic_folder,
    check_place,
    check_unchanged,
    claimed,
    keep_true_files,
    mark_text,
)


def test_unwritable_kernel_cache_is_survived_with_a_word(tmp_path, environment):
    (tmp_path / "file").write_text("")
    program = (
        "from strikewave.base.compiled import kernel, cache_folder\n"
        "assert cache_folder() is None\n"
        "double = kernel(lambda x: 2 * x)\n"
        "assert double(2) == 4\n"
    )
    # a folder below a file cannot be made, whoever runs this
    done = subprocess.run(
        [sys.executable, "-W", "always", "-c", program],
        env={**environment, "NUMBA_CACHE_DIR": str(tmp_path / "file" / "cache")},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert "Set NUMBA_CACHE_DIR" in done.stderr


def test_changed_kernel_source_has_another_cache(tmp_path):
    copy = tmp_path / "strikewave"
    shutil.copytree(PACKAGE, copy, ignore=shutil.ignore_patterns("__pycache__"))
    assert kernel_key(copy) == kernel_key(PACKAGE)
    for changed in ("contact/_integrator.py", "machines/_kernels.py", "base/compiled.py"):
        before = kernel_key(copy)
        with (copy / changed).open("a") as file:
            file.write("# changed\n")
        assert kernel_key(copy) != before


@pytest.mark.parametrize(
    ("identity", "table", "axis", "kept", "removed"),
    [
        ("a", "1", "g", ["machine.html"], ["report.html"]),
        ("b", "1", "g", [], ["machine.html", "report.html"]),
        ("a", "2", "g", [], ["machine.html", "report.html"]),
        ("a", "1", "m/s²", [], ["machine.html", "report.html"]),  # CSV is in SI either way, the animation was in g
    ],
)
def test_rerun_keeps_the_animation_of_the_same_numbers_and_units_and_names_what_goes(
    tmp_path, identity, table, axis, kept, removed
):
    old, new = tmp_path / "old", tmp_path / "new"
    for folder, text in ((old, "a"), (new, identity)):
        folder.mkdir()
        (folder / "case.toml").write_text(text)
        (folder / "blows.csv").write_text("1" if folder == old else table)
        (folder / "summary.svg").write_text("g" if folder == old else axis, "utf-8")
    for name in ("machine.html", "report.html"):
        (old / name).write_text("before")
    assert keep_true_files(old, new, identity) == (kept, removed)
    assert (new / "machine.html").exists() == bool(kept)
    assert (old / "machine.html").read_text() == "before"


def names(folder: Path) -> list[str]:
    return sorted(p.name for p in folder.iterdir())


@contextlib.contextmanager
def written(folder, identity, force=False):
    """A result folder written as a command does."""
    check_place(folder, identity, force)
    with claimed(folder) as claim, atomic_folder(claim, identity, force) as place:
        yield place


@pytest.mark.parametrize("error", [KeyboardInterrupt, RuntimeError, OSError(errno.ENOSPC, "No space left on device")])
def test_an_interrupted_result_leaves_nothing(tmp_path, error):
    with pytest.raises((KeyboardInterrupt, RuntimeError, InputError)), written(tmp_path / "out", "x") as place:
        (place / "half").write_text("half")
        raise error
    assert names(tmp_path) == []


def test_an_interrupted_result_keeps_the_old_one(tmp_path):
    with written(tmp_path / "out", "x") as place:
        (place / "case.toml").write_text("x")
    with pytest.raises(KeyboardInterrupt), written(tmp_path / "out", "x") as place:
        (place / "case.toml").write_text("half")
        raise KeyboardInterrupt
    assert names(tmp_path) == ["out"]
    assert mark_text(tmp_path / "out" / "case.toml") == "x"


def test_another_result_is_only_replaced_by_force(tmp_path):
    def write(identity, force=False):
        with written(tmp_path / "out", identity, force) as place:
            (place / "case.toml").write_text(identity)

    write("one")
    write("one")
    with pytest.raises(InputError, match="--force"):
        write("two")
    write("two", force=True)
    assert mark_text(tmp_path / "out" / "case.toml") == "two"
    assert names(tmp_path) == ["out"]


def test_a_result_with_files_of_others_is_never_replaced(tmp_path):
    with written(tmp_path / "out", "x") as place:
        (place / "case.toml").write_text("x")
    (tmp_path / "out" / "notes.txt").write_text("mine")
    for force in (False, True):
        with pytest.raises(InputError, match=r"notes\.txt"), written(tmp_path / "out", "x", force):
            pass
    assert (tmp_path / "out" / "notes.txt").read_text() == "mine"


def test_a_place_taken_meanwhile_is_not_replaced(tmp_path):
    with pytest.raises(InputError, match=r"thesis"), written(tmp_path / "out", "x") as place:
        (place / "case.toml").write_text("x")
        (tmp_path / "out").mkdir()
        (tmp_path / "out" / "thesis.txt").write_text("years of work")
    assert names(tmp_path) == ["out"]


def test_what_is_no_result_is_never_replaced(tmp_path):
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "thesis.docx").write_text("years of work")
    (tmp_path / "file").write_text("")
    for place in ("out", "file"):
        with pytest.raises(InputError), written(tmp_path / place, "x", force=True):
            pass
    assert (tmp_path / "out" / "thesis.docx").read_text() == "years of work"


@pytest.mark.parametrize("force", [False, True])
@pytest.mark.parametrize("mine", ["histories.csv", "report.html", "case-2.toml", "of-mine/shot.csv"])
def test_a_folder_that_only_looks_like_a_result_is_never_replaced(tmp_path, force, mine):
    """A case of the user's own with measurements beside it, under names that results have too."""
    folder = tmp_path / "bench"
    (folder / mine).parent.mkdir(parents=True)
    (folder / "case.toml").write_text("x")
    (folder / mine).write_text("measured")
    with pytest.raises(InputError, match="has no list of the files of a result"), written(folder, "x", force):
        pass
    assert (folder / mine).read_text() == "measured"
    assert (folder / "case.toml").read_text() == "x"


@pytest.mark.parametrize("identity", ["x", "another"])
@pytest.mark.parametrize("mine", ["histories.csv", "blows.csv", "of-mine/shot.csv"])
def test_what_was_added_to_a_result_or_changed_in_it_is_never_replaced(tmp_path, mine, identity):
    folder = tmp_path / "out"

    def write():
        with written(folder, identity, force=True) as place:
            (place / "blows.csv").write_text("1")
            (place / "case.toml").write_text("x")

    write()
    (folder / mine).parent.mkdir(exist_ok=True)
    (folder / mine).write_text("mine")
    with pytest.raises(InputError, match=f"added or changed since its run .*{mine}"):
        write()
    assert (folder / mine).read_text() == "mine"
    (folder / mine).unlink()
    if mine.startswith("of-mine"):
        with pytest.raises(InputError, match="of-mine"):
            write()
        (folder / "of-mine").rmdir()
    write()
    assert names(folder) == ["blows.csv", "case.toml"]


def test_a_link_in_a_result_is_the_users(tmp_path):
    with written(tmp_path / "out", "x") as place:
        (place / "case.toml").write_text("x")
    (tmp_path / "shot.csv").write_text("measured")
    (tmp_path / "out" / "shot.csv").symlink_to(tmp_path / "shot.csv")
    with pytest.raises(InputError, match=r"shot\.csv"), written(tmp_path / "out", "x", force=True):
        pass


def test_a_case_changed_by_hand_in_a_result_is_not_replaced_unasked(tmp_path):
    folder = tmp_path / "out"
    with written(folder, "x") as place:
        (place / "blows.csv").write_text("1")
        (place / "case.toml").write_text("x")
    check_unchanged(folder, "another case of that name")  # as its run wrote it
    mark = folder / "case.toml"
    mark.write_text(mark.read_text().replace("x", "y", 1))
    with pytest.raises(InputError, match="was changed after the run"):
        check_unchanged(folder, "x")
    check_unchanged(folder, "y")  # what would be written is what stands there


def test_what_was_written_behind_the_list_of_a_result_is_a_change_too(tmp_path):
    """The end of the file, where somebody adds a table, is behind the list."""
    folder = tmp_path / "out"
    with written(folder, "x") as place:
        (place / "case.toml").write_text("x")
    mark = folder / "case.toml"
    with mark.open("a") as file:
        file.write("\n[[tap]]\nname = 'mine'\n")
    before = mark.read_text()
    with pytest.raises(InputError, match="another result"), written(folder, "x"):
        pass
    with pytest.raises(InputError, match="was changed after the run"):
        check_unchanged(folder, "x")
    assert mark.read_text() == before
