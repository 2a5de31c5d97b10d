"""Build the package, look into it, and run it where its source is not: `make package`.

What is built twice, from the tree and from the source distribution, must be equal to the bit. The wheel must hold every
file of `src/strikewave` as git has it, and nothing else; the source distribution every file of the project but the
tests. In an empty environment of each Python it must give the numbers that the tree gives, to the last digit.
`--python 3.12` (or a path; may be repeated) names one; a Python that is not at hand is named. `--platforms` asks the
index whether there are wheels of everything for other systems.
"""

import argparse
import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
import tarfile
import tempfile
import zipfile
from collections.abc import Sequence
from pathlib import Path

from metadata import readme_of_index

ROOT = Path(__file__).parents[2]
PLACE = ROOT / "dist"
DEMO = ("run", "li-ma-2019", "--json", "--no-band")
"""The command whose numbers must be equal."""
PLATFORMS = {
    "Linux": "x86_64-unknown-linux-gnu",
    "Linux on ARM": "aarch64-unknown-linux-gnu",
    "Windows": "x86_64-pc-windows-msvc",
    "macOS": "aarch64-apple-darwin",
}
"""Systems for which there must be wheels of everything. Not macOS on Intel: numba 0.63 and later has none for it."""
OLDEST = "3.11"
"""Python of the pinned versions, for which wheels must be found on all systems."""
NEWEST = "3.14"
"""Python for which wheels must be found on Linux: others mostly follow by the same release."""


def ran(*words: str | Path, **options: object) -> str:
    """Run a command and return what it printed; where it fails, what it said ends this program."""
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, check=False, **options)
    if done.returncode:
        raise SystemExit(f"{' '.join(map(str, words))} ended with {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout


def require(held: bool, what: str) -> None:
    """End with a line where something does not hold."""
    if not held:
        raise SystemExit(f"package: {what}")


def digest(path: Path) -> str:
    """Return the SHA-256 of a file."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


UNREACHED = "error sending request"
"""In what uv says where it finds no way to the index."""


def built() -> tuple[Path, Path]:
    """Build the source distribution, the wheel of it, and the wheel of the tree; return the first two."""
    shutil.rmtree(PLACE, ignore_errors=True)
    build = (sys.executable, "-m", "build", "--no-isolation")
    ran(*build, "--outdir", PLACE, ROOT)
    with tempfile.TemporaryDirectory() as other:
        ran(*build, "--wheel", "--outdir", other, ROOT)
        (wheel,), (again,) = PLACE.glob("*.whl"), Path(other).glob("*.whl")
        require(digest(wheel) == digest(again), "the wheels of the tree and of the source distribution differ")
    (sdist,) = PLACE.glob("*.tar.gz")
    ran(sys.executable, "-m", "twine", "check", "--strict", wheel, sdist)
    return sdist, wheel


def tracked(*below: str) -> set[str]:
    """Return the files that git has below a folder."""
    return set(ran("git", "ls-files", *below, cwd=ROOT).split("\n")) - {""}


def check_contents(sdist: Path, wheel: Path) -> None:
    """Compare what is in both with the files of the project."""
    with zipfile.ZipFile(wheel) as opened:
        held = {name: opened.read(name) for name in opened.namelist()}
    wanted = {name.removeprefix("src/"): ROOT / name for name in tracked("src/strikewave")}
    require(bool(wanted), "git names no files below src/strikewave")
    ours = {name for name in held if name.startswith("strikewave/")}
    require(ours == set(wanted), f"the wheel differs in {sorted(ours ^ set(wanted))[:9]}")
    for name, path in wanted.items():
        require(held[name] == path.read_bytes(), f"{name} differs in the wheel")
    info = {name.partition("/")[2] for name in set(held) - ours}
    wanted_info = {"METADATA", "WHEEL", "RECORD", "entry_points.txt", "licenses/LICENSE"}
    require(info == wanted_info, f"beside the package the wheel has {sorted(info)}")
    with tarfile.open(sdist) as opened:
        there = {name.partition("/")[2] for name in opened.getnames()}
    require("PKG-INFO" in there, "the source distribution lacks PKG-INFO")
    expected = {name for name in tracked() if not name.startswith(("tests/", ".ci/"))}
    require(expected <= there, f"the source distribution lacks {sorted(expected - there)[:9]}")
    require(there <= expected | {".gitignore", "PKG-INFO"}, f"and has {sorted(there - expected)[:9]}")


def check_version(wheel: Path) -> None:
    """Compare the version with the tag of this commit, where it has one."""
    tags = [tag for tag in ran("git", "tag", "--points-at", "HEAD", cwd=ROOT).split() if re.match(r"v\d", tag)]
    version = wheel.name.split("-")[1]
    require(not tags or tags == [f"v{version}"], f"version {version}, but the tag {tags}")


def check_readme() -> None:
    """Look for links and pictures of the README that would lead nowhere on an index."""
    text = (ROOT / "README.md").read_text("utf-8")
    for repository in ("", "https://host/owner/strikewave"):
        left = re.findall(r"\]\((?!https?:)[^)]*\)", readme_of_index(text, repository, "1.0.0"))
        require(not left, f"the README of the index leads to {left[:3]}")


def numbers(program: Path | str, folder: Path, *words: str) -> dict[str, object]:
    """Return the document that the demo prints, run in a folder from which no source is seen."""
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    return json.loads(ran(program, *words, *DEMO, cwd=folder, env=environment))


def check_installed(wheel: Path, python: str, folder: Path, wanted: dict[str, object]) -> None:
    """Install the wheel with one Python in an empty environment; run it and compare its numbers."""
    place = Path(tempfile.mkdtemp(dir=folder)) / "venv"
    find = (sys.executable, "-m", "uv", "python", "find", "--no-project", python)
    found = subprocess.run(find, capture_output=True, text=True, check=False)
    if found.returncode:
        print(f"Python {python}: not at hand, left out")
        return
    binary = place / ("Scripts" if os.name == "nt" else "bin")
    ran(found.stdout.strip(), "-m", "venv", place)
    pip = (
        binary / "python",
        "-m",
        "pip",
        "install",
        "-q",
        "--disable-pip-version-check",
    )  # as users do, by their index
    ran(*pip, "-c", ROOT / "constraints.txt", wheel)
    where = ran(binary / "python", "-I", "-c", "import strikewave; print(strikewave.__file__)", cwd=folder).strip()
    require(Path(where).is_relative_to(place), f"{where} is not of the environment")
    size = sum(path.lstat().st_size for path in place.rglob("*") if path.is_file() and not path.is_symlink())
    found_numbers = numbers(binary / "strikewave", folder)
    require(found_numbers == wanted, f"other numbers with Python {python} than those of the tree")
    peak = found_numbers["blows"][0]["rigid_peak"]  # type: ignore[index]
    print(f"Python {python}: {size / 1e6:.0f} MB installed; first peak {peak!r} m/s^2, equal to the digit")


def check_platforms() -> None:
    """Ask the index for wheels of everything for other systems; where it cannot be reached, say so."""
    environment = {**os.environ, "UV_SYSTEM_CERTS": "true"}
    pinned = [(name, OLDEST, ("-c", "constraints.txt")) for name in PLATFORMS]
    for name, python, pins in [*pinned, ("Linux", NEWEST, ())]:
        target = ("--python-platform", PLATFORMS[name], "--python-version", python)
        compiled = (sys.executable, "-m", "uv", "pip", "compile", "-q", "--only-binary", ":all:", *target, *pins)
        words = [*compiled, "pyproject.toml"]
        found = subprocess.run(words, cwd=ROOT, env=environment, capture_output=True, text=True, check=False)
        if UNREACHED in found.stderr:
            print("SKIPPED: the index cannot be reached by uv, so wheels for other systems were not looked for")
            return
        require(found.returncode == 0, f"{name}, Python {python}: {found.stderr.strip()}")
        print(f"wheels of everything: {name}, Python {python}")


def main(words: Sequence[str] | None = None) -> None:
    """Do all of it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--python", action="append", help="install and run with this Python: 3.12, or a path")
    parser.add_argument("--platforms", action="store_true", help="ask the index for wheels for other systems")
    asked = parser.parse_args(words)
    sdist, wheel = built()
    check_contents(sdist, wheel)
    check_version(wheel)
    check_readme()
    print(f"{wheel.name}: {wheel.stat().st_size / 1e3:.0f} kB; {sdist.name}: {sdist.stat().st_size / 1e3:.0f} kB")
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        wanted = numbers(sys.executable, folder, "-m", "strikewave")
        for python in asked.python or [".".join(map(str, sys.version_info[:2]))]:
            check_installed(wheel, python, folder, wanted)
    if asked.platforms:
        check_platforms()


if __name__ == "__main__":
    main()
