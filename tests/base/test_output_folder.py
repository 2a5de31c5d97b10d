"""Kernel cache: an unwritable place is survived with a word."""

import shutil
import subprocess
import sys

import pytest

from strikewave.base.compiled import PACKAGE, kernel_key
from strikewave.base.output_folder import keep_true_files


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
