"""What the project is made of: each package pinned by its files, none of the core under GPL, known flaws looked up."""

import importlib.metadata
import re
import runpy
import tomllib
from pathlib import Path

import pytest
from packaging.requirements import Requirement

ROOT = Path(__file__).parents[2]


def usual(name):
    """Return the name of a package as indexes compare it."""
    return re.sub(r"[-_.]+", "-", name).lower()


def pinned(path):
    """Return the versions that a file pins, by package, but for those that other systems need."""
    text = path.read_text("utf-8").replace("\\\n", " ")
    pins = [Requirement(line.partition(" --hash")[0]) for line in text.splitlines() if line and line[0] not in "#"]
    return {usual(pin.name): str(pin.specifier) for pin in pins if pin.marker is None or pin.marker.evaluate()}


def core():
    """Return the installed packages that the core needs, by name: those it names, those that these name, and so on."""
    found, asked = {}, ["strikewave"]
    while asked:
        name = usual(asked.pop())
        if name not in found:
            found[name] = importlib.metadata.distribution(name)
            needs = map(Requirement, found[name].requires or ())
            asked += [need.name for need in needs if need.marker is None or need.marker.evaluate({"extra": ""})]
    return found


def licence(package):
    """Return what a package says of its licence: an expression or the first line of a text, and its classifiers."""
    words = package.metadata
    stated = words.get("License-Expression") or (words.get("License") or "").partition("\n")[0]
    return " ".join([stated, *(one for one in words.get_all("Classifier") or () if one.startswith("License"))])


@pytest.mark.parametrize("file", ["core.txt", "dev.txt", "docs.txt", "package.txt"])
def test_requirements_are_the_constraints_with_the_sums_of_their_files(file):
    text = (ROOT / "requirements" / file).read_text("utf-8")
    assert "://" not in text
    for entry in text.replace("\\\n", " ").splitlines():
        assert re.search(r" --hash=sha256:[0-9a-f]{64}", entry)
    versions = pinned(ROOT / "constraints.txt")
    for name, version in pinned(ROOT / "requirements" / file).items():
        assert versions[name] == version


def test_what_the_peers_bring_is_pinned_once():
    """Two pins of one package that differ keep a peer out of the benchmarks."""
    peers = pinned(ROOT / "benchmarks/constraints.txt")
    assert peers
    assert peers.keys().isdisjoint(pinned(ROOT / "constraints.txt"))


def test_requirements_hold_each_package_that_the_project_asks_for():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    extras = project["optional-dependencies"]
    written = re.findall(r"\$\(COMPILE\)(.*) -o requirements/(\S+)", (ROOT / "Makefile").read_text("utf-8"))
    assert len(written) == len(list((ROOT / "requirements").glob("*.txt")))
    for words, file in written:
        names = [
            *project["dependencies"],
            *(one for extra in re.findall(r"--extra (\w+)", words) for one in extras[extra]),
        ]
        held = pinned(ROOT / "requirements" / file)
        for requirement in map(Requirement, names):
            assert requirement.specifier.contains(held[usual(requirement.name)].removeprefix("==")), requirement


def test_requirements_of_the_core_hold_what_its_packages_need():
    held = pinned(ROOT / "requirements/core.txt")
    assert {name for name in core() if name not in held} == {"strikewave"}


def test_nothing_of_the_core_is_under_gpl_or_agpl():
    licences = {name: licence(package) for name, package in core().items()}
    assert [name for name, words in licences.items() if not words.strip()] == []
    assert {name: words for name, words in licences.items() if re.search(r"\bA?GPL|GNU (Affero )?General", words)} == {}


def test_what_is_known_of_packages_is_told_and_what_is_not_is_named():
    told = runpy.run_path(str(ROOT / "scripts/known_vulnerabilities.py"))["told"]
    flaw = {"id": "PYSEC-2014-1", "fix_versions": ["2.3.1"]}
    lines, count = told(
        [
            {"name": "jinja2", "version": "2.3", "vulns": [flaw]},
            {"name": "numpy", "version": "2.0", "vulns": []},
            {"name": "own", "skip_reason": "not found"},
        ]
    )
    assert count == 1
    assert lines == [
        "known vulnerabilities: 1 in 2 packages",
        "jinja2 2.3: PYSEC-2014-1, mended in 2.3.1",
        "not looked up: own",
    ]
