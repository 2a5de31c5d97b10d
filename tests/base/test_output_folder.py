"""Kernel cache: an unwritable place is survived with a word."""

import shutil
import subprocess
import sys

from strikewave.base.compiled import PACKAGE, kernel_key


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
