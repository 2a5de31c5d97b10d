"""Kernel cache: an unwritable place is survived with a word."""

import subprocess
import sys


def test_unwritable_kernel_cache_is_survived_with_a_word(tmp_path, environment):
    (tmp_path / "file").write_text("")
    program = (
        "from strikewave.compiled import kernel, cache_folder\n"
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


def test_changed_kernel_source_has_another_cache(tmp_path, environment):
    program = "from strikewave.compiled import cache_folder; print(cache_folder())"
    env = {**environment, "NUMBA_CACHE_DIR": str(tmp_path)}
    one = subprocess.run([sys.executable, "-c", program], env=env, capture_output=True, text=True, check=True).stdout
    assert one.strip().startswith(str(tmp_path))
    assert (tmp_path / one.strip().rsplit("/", 1)[-1]).is_dir()
