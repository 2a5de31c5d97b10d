"""Whether kernels have to be compiled, by the files of the cache."""

import ast
import os
import shutil
import stat
import subprocess
import sys

import pytest

from strikewave.base import compiled
from strikewave.base.compiled import own_folder
from strikewave.base.errors import InputError


def test_cold_without_a_kernel_of_that_name(tmp_path, monkeypatch):
    monkeypatch.setattr(compiled, "cache_folder", lambda: str(tmp_path))
    assert compiled.is_cold()
    assert compiled.is_cold("run_train")
    (tmp_path / "a").mkdir()
    (tmp_path / "a" / "_kernels.advance-12.py311.nbi").write_bytes(b"")
    assert not compiled.is_cold()
    assert not compiled.is_cold("advance")
    assert compiled.is_cold("run_train")


def test_a_compiler_that_is_switched_off_is_refused(monkeypatch):
    monkeypatch.setattr(compiled.numba.config, "DISABLE_JIT", 1)
    with pytest.raises(InputError, match=r"^NUMBA_DISABLE_JIT: got 1; allowed: 0, or unset"):
        compiled.leaf_kernel(lambda x: x)


def test_a_kernel_runs_whose_code_was_not_handed_over_and_is_not_kept(tmp_path, monkeypatch):
    """What an interrupt leaves that comes while LLVM hands the code over: numba's own words, then."""

    def not_there(library):
        raise RuntimeError(f"no compiled object yet for {library}")

    def twice(x):
        return 2.0 * x

    monkeypatch.setattr(compiled, "cache_folder", lambda: str(tmp_path))
    monkeypatch.setattr(compiled.JITCodeLibrary, "_get_compiled_object", not_there)
    assert compiled.kernel(twice)(2.0) == 4.0
    assert not list(tmp_path.rglob("*.nbi"))


@pytest.mark.verify
def test_a_package_that_lies_elsewhere_takes_the_same_compiled_kernels(tmp_path, environment):
    """A fresh clone, or a second environment, compiles nothing that this machine has compiled."""
    program = (
        "from strikewave.contact import _kernels, factor\n"
        "import strikewave\n"
        "factor('exact', 0.5)\n"
        "found = [f for f in vars(_kernels).values() if hasattr(f, 'stats') and f.signatures]\n"
        "print(strikewave.__file__, sum(sum(f.stats.cache_hits.values()) for f in found), "
        "sum(sum(f.stats.cache_misses.values()) for f in found))\n"
    )
    copy = tmp_path / "elsewhere" / "strikewave"
    shutil.copytree(compiled.PACKAGE, copy, ignore=shutil.ignore_patterns("__pycache__"))
    for path in copy.rglob("*.py"):
        os.utime(path)  # a clone writes its files anew
    counts = []
    for place in (compiled.PACKAGE.parent, copy.parent):
        own = {**environment, "PYTHONPATH": str(place), "NUMBA_CACHE_DIR": str(tmp_path / "cache")}
        done = subprocess.run([sys.executable, "-c", program], env=own, capture_output=True, text=True, check=True)
        file, hits, misses = done.stdout.split()
        assert file.startswith(str(place))
        counts.append((int(hits), int(misses)))
    (_, compiled_first), (taken, compiled_again) = counts
    assert compiled_first > 0
    assert taken > 0
    assert compiled_again == 0


def test_a_part_called_by_python_gives_what_it_gives_within_a_kernel():
    """Python has no entry to what was compiled as a part: it is compiled once more, and never called at address 0."""
    squared, cubed = compiled.leaf_kernel(_squared), compiled.inner_kernel(_cubed)
    both = compiled.kernel(lambda x: (squared(x), cubed(x)))
    assert both(3.0) == (9.0, 27.0)
    assert (squared(3.0), cubed(3.0)) == (9.0, 27.0)


@pytest.mark.verify
def test_parts_are_kept_for_the_kernels_of_another_process(tmp_path, environment):
    """As bitcode alone, in files of their own: those of the same kernels as a whole hold machine code."""
    program = (
        "from strikewave.contact import _integrator\n"
        "from numba import float64\n"
        "part = _integrator.evaluate\n"
        "part.compile((float64[:, ::1], float64, float64[::1]))\n"
        "print(sum(part.stats.cache_hits.values()), sum(part.stats.cache_misses.values()))\n"
    )
    own = {**environment, "NUMBA_CACHE_DIR": str(tmp_path)}
    counts = [
        subprocess.run([sys.executable, "-c", program], env=own, capture_output=True, text=True, check=True).stdout
        for _ in range(2)
    ]
    assert [one.split() for one in counts] == [["0", "1"], ["1", "0"]]
    assert [".part." in path.name for path in tmp_path.rglob("*evaluate*.nbc")] == [True]


@pytest.mark.verify
def test_a_kernel_from_disk_runs_raises_and_is_linked_by_one_compiled_after_it(tmp_path, environment):
    """Of a kernel that is kept only what runs is read at once: its code for linking, and its words, must still be there."""
    (tmp_path / "kept.py").write_text(
        "import numpy as np\n"
        "from strikewave.base.compiled import called_kernel, kernel\n"
        "@called_kernel\n"
        "def squared(x):\n"
        "    return x * x\n"
        "@kernel\n"
        "def roots(values):\n"
        "    if values[0] < 0.0:\n"
        "        raise ValueError('below zero', 7)\n"
        "    return np.sqrt(values)\n"
        "@kernel\n"
        "def both(values):\n"
        "    return roots(values), squared(values[0])\n"
    )
    program = (
        "import sys\n"
        "import numpy as np, kept\n"
        "own, values = sys.argv[1:], np.array([4.0])\n"
        "print([getattr(kept, name)(values if name != 'squared' else 4.0) for name in own])\n"
        "for name in own[-1:]:\n"
        "    try:\n"
        "        getattr(kept, name)(-values)\n"
        "    except ValueError as error:\n"
        "        print(error.args, sum(getattr(kept, name).stats.cache_hits.values()))\n"
    )
    own = {**environment, "NUMBA_CACHE_DIR": str(tmp_path / "cache")}
    own["PYTHONPATH"] = os.pathsep.join(filter(None, [str(tmp_path), own.get("PYTHONPATH")]))
    said = []
    for names in (["squared", "roots"], ["squared", "roots"], ["both"], ["both"]):
        command = [sys.executable, "-c", program, *names]
        said.append(subprocess.run(command, env=own, capture_output=True, text=True, check=True).stdout.splitlines())
    alone, together = "[16.0, array([2.])]", "[(array([2.]), 16.0)]"
    error = "('below zero', 7)"
    assert said == [[alone, f"{error} 0"], [alone, f"{error} 1"], [together, f"{error} 0"], [together, f"{error} 1"]]


KEPT = """
from strikewave.base.compiled import called_kernel, inner_kernel, kernel
@inner_kernel
def cubed(x):
    return x * x * x
@kernel
def both(x):
    return cubed(x) + 1.0
"""
PROGRAM = "import kept; print(kept.both(2.0), sum(kept.both.stats.cache_hits.values()))"


@pytest.fixture
def run_kept(tmp_path, environment):
    """Return what calls a kernel that is kept in a process of its own, and gives what it printed and warned."""
    (tmp_path / "kept.py").write_text(KEPT)
    own = {**environment, "NUMBA_CACHE_DIR": str(tmp_path / "cache")}
    own["PYTHONPATH"] = os.pathsep.join(filter(None, [str(tmp_path), own.get("PYTHONPATH")]))

    def run(before=""):
        command = [sys.executable, "-W", "always", "-c", before + PROGRAM]
        done = subprocess.run(command, env=own, capture_output=True, text=True, check=True)
        return done.stdout.strip(), done.stderr.count("StrikewaveWarning: compiled kernels"), done.stderr

    return run


DAMAGE = (
    lambda data: b"",
    lambda data: data[: len(data) // 2],
    lambda data: data[:-50] + bytes([data[-50] ^ 4]) + data[-49:],
)
"""A file emptied, cut, and with another bit."""


@pytest.mark.verify
@pytest.mark.parametrize("first", [0, 1, 2])
def test_damaged_kernels_are_dropped_with_a_word_and_the_next_run_has_none_to_say(run_kept, tmp_path, first):
    assert run_kept()[:2] == ("9.0 0", 0)
    files = sorted(path for path in (tmp_path / "cache").rglob("*") if path.suffix in (".nbi", ".nbc"))
    assert len(files) == 4  # an index and the data of the kernel, and of its part
    for k, path in enumerate(files):
        path.write_bytes(DAMAGE[(first + k) % 3](path.read_bytes()))
    printed, warnings, words = run_kept()
    assert (printed, warnings) == ("9.0 0", 1), words
    assert "dropped, and compiled anew" in words
    assert run_kept()[:2] == ("9.0 1", 0)


@pytest.mark.verify
def test_a_full_disk_of_the_cache_is_survived_with_a_word(run_kept):
    """RLIMIT_FSIZE refuses a write as a full disk does."""
    limit = "import resource; resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000)); "
    printed, warnings, words = run_kept(limit)
    assert (printed, warnings) == ("9.0 0", 1), words
    assert "cannot be kept" in words
    assert run_kept()[:2] == ("9.0 0", 0)


def test_the_folder_of_compiled_kernels_is_the_users_own(tmp_path, monkeypatch):
    """They are pickles: what others could put there would be run."""
    folder = tmp_path / "a" / "kernels"
    own_folder(folder)
    assert stat.S_IMODE(folder.stat().st_mode) == 0o700
    (folder / "mine").touch()
    for mode, left in ((0o755, ["mine"]), (0o777, []), (0o720, [])):
        folder.chmod(mode)
        own_folder(folder)
        assert stat.S_IMODE(folder.stat().st_mode) == 0o700
        assert [path.name for path in folder.iterdir()] == left
    (tmp_path / "link").symlink_to(folder)
    with pytest.raises(PermissionError, match="a link"):
        own_folder(tmp_path / "link")
    user = os.geteuid()
    monkeypatch.setattr(os, "geteuid", lambda: user + 1)
    with pytest.raises(PermissionError, match="another user"):
        own_folder(folder)


def _squared(x):
    return x * x


def _cubed(x):
    return x * x * x


def test_all_that_is_compiled_stands_in_files_whose_text_is_the_key_of_the_cache():
    """What a kernel is made of stands in files of the key: a change elsewhere would be answered from an old cache."""
    own = {path.relative_to(compiled.PACKAGE.parent) for path in compiled.PACKAGE.rglob("_[a-z]*.py")}
    sources = {path.relative_to(compiled.PACKAGE.parent) for path in compiled.kernel_sources(compiled.PACKAGE)}
    modules = {".".join(path.with_suffix("").parts) for path in sources}
    for path in compiled.PACKAGE.rglob("*.py"):
        if "strikewave.base.compiled" not in (text := path.read_text("utf-8")):
            continue
        imports = [node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.ImportFrom)]
        makes = {
            name.name
            for node in imports
            if node.module == "strikewave.base.compiled"
            for name in node.names
            if name.name.endswith("kernel")
        }
        key = path.relative_to(compiled.PACKAGE.parent)
        assert not makes or key in own, key
        if makes:
            used = {
                f"{node.module}.{name.name}" if f"{node.module}.{name.name}" in modules else node.module
                for node in imports
                if (node.module or "").startswith("strikewave")
                for name in node.names
            }
            assert used <= modules, (key, used - modules)
