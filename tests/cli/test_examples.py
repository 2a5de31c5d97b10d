"""What `strikewave examples` copies is whole, and what `strikewave doctor` reports is what the metadata ask for."""

import json
import tomllib
from pathlib import Path

import pytest

from strikewave.cases.files import bundled_cases, read_case_text
from strikewave.cli import program_commands

ROOT = Path(__file__).parents[2]
BOARD = ROOT / "tests" / "data" / "smd-5kg-impacts"


def test_examples_are_the_files_of_the_package_and_all_cases(strikewave):
    code, out, err = strikewave("examples", "mine")
    assert (code, out) == (0, "")
    assert "mine" in err
    assert {path.stem for path in Path("mine/cases").iterdir()} == set(bundled_cases())
    assert Path("mine/cases/li-ma-2019.toml").read_text("utf-8") == read_case_text("li-ma-2019")[0]
    notebooks = {path.name for path in Path("mine/notebooks").iterdir()}
    assert notebooks == {path.name for path in (program_commands.EXAMPLES / "notebooks").iterdir()}
    assert len(notebooks) == 6
    assert {path.name for path in Path("mine/studies").iterdir()} == {
        "bar-end.toml",
        "bar-pulse-fem.toml",
        "equal-blows.toml",
    }
    assert Path("mine/records/impact_02.lvm").stat().st_size > 500_000
    assert {"LICENSE", "README.md"} <= {path.name for path in Path("mine/records").iterdir()}


def test_the_sample_record_is_the_measured_file():
    assert (program_commands.EXAMPLES / "records" / "impact_02.lvm.xz").read_bytes() == (
        BOARD / "impact_02.lvm.xz"
    ).read_bytes()


@pytest.mark.parametrize("name", ["taken", "file", "away/mine"])
def test_examples_replace_nothing_and_leave_nothing(strikewave, name):
    Path("taken").mkdir()
    Path("taken/mine.txt").write_text("mine")
    Path("file").write_text("mine")
    code, out, err = strikewave("examples", name)
    assert (code, out) == (2, "")
    assert err.startswith(f"{name} cannot be used; needed: ")
    assert {path.name for path in Path().iterdir()} == {"taken", "file"}
    assert Path("taken/mine.txt").read_text() == "mine"


def test_doctor_lists_what_the_project_asks_for(strikewave):
    document = json.loads(strikewave("doctor", "--no-speed", "--json")[1])
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    asked = {(one["extra"], f"{one['name']}{one['asked']}".lower()) for one in document["packages"]}
    core = {("core", line.lower()) for line in project["dependencies"]}
    assert core <= asked
    assert not {extra for extra, _ in asked} & set(program_commands.DEVELOPERS)
    assert all(one["found"] for one in document["packages"] if one["extra"] == "core")
    assert document["speeds"] == []


def test_a_package_that_is_missing_is_named_with_the_way_to_get_it(strikewave, monkeypatch):
    lines = ["numpy>=2.0", 'no-such-package-of-strikewave>=1; extra == "formats"', 'pytest>=8; extra == "dev"']
    monkeypatch.setattr("importlib.metadata.requires", lambda name: lines)
    code, out, err = strikewave("doctor", "--no-speed")
    assert code == 0
    assert "missing" in next(line for line in out.splitlines() if "no-such-package" in line)
    assert "strikewave[formats]" in err
    assert "pytest" not in out


@pytest.mark.verify
def test_speeds_are_of_every_kernel_and_positive():
    assert [one.work for one in program_commands.speeds() if one.rate > 1e3] == [
        "impacts",
        "samples of a spectrum, each frequency",
        "layer steps of a bar",
        "element steps",
    ]
