"""The files of a result as the docs list them, against what the commands write."""

import re
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[2] / "docs"
LINK = "reports.md#the-files-of-a-result"
PAGES = (
    "compare",
    "design",
    "exchange",
    "fit",
    "fem",
    "hopkinson",
    "machines",
    "map",
    "records",
    "scatter",
    "sensors",
    "settings",
    "specifications",
    "sweep",
    "waves",
)
"""Pages of the commands that write folders."""


FEW = ("--set", "feed.blows=2")


def listed() -> list[tuple[set[str], str]]:
    """Return the files of each row of the table of the docs, with its commands."""
    section = (DOCS / "reports.md").read_text("utf-8").partition("## The files of a result")[2].partition("\n## ")[0]
    rows = [line.strip("|").split(" | ") for line in section.splitlines() if line.startswith("| `")]
    return [(set(re.findall(r"`([^`]+)`", files)), commands) for files, _, commands in rows]


BUILT = re.compile(
    r"(run-)?histories(-\w+)?\.(csv|parquet)|[a-z]+-(laws|given)\.(svg|png)|test-report\.pdf"
    r"|(sweep|map|scatter|settings|design)\.(json|svg|png)"
)
"""Names that the code puts together of a stem and an ending."""


def test_the_docs_list_no_file_that_nothing_writes():
    """That they list each file is a test of `make verify`, which runs the commands."""
    files = set().union(*(files for files, _ in listed()))
    code = "\n".join(path.read_text("utf-8") for path in (DOCS.parent / "src").rglob("*.py"))
    assert not [name for name in files if name not in code and not BUILT.fullmatch(name)]


@pytest.mark.parametrize("page", PAGES)
def test_the_page_of_a_command_leads_to_the_list_of_files(page):
    assert LINK in (DOCS / f"{page}.md").read_text("utf-8")


@pytest.mark.verify
def test_a_command_writes_only_what_the_docs_list_for_it(strikewave):
    """The measured record is the one that ``new`` brings."""
    assert strikewave("new", "shot", "--from", "hopkinson")[0] == 0
    impact = ["--law", "palmgren", "--length", "40 mm", "--m1", 0.2, "--m2", 0.459, "--speed", 20, "-e", 0.5]
    calls = {
        "run": ["li-ma-2019", "--no-band", "--histories", "csv", "--xlsx", *FEW],
        "wave": ["li-ma-2019-fig13-bar", "--no-band", "--xlsx"],
        "fem": ["two-bars-fem", "--set", "fem.duration=20 us", "--set", "fem.frames=3", "--xlsx"],
        "hopkinson": ["shot.toml", "--xlsx"],
        "record": ["shot.csv", "--unit", "g", "--motion", "--pair", "1,2", "--xlsx"],
        "srs": ["shot.csv", "--unit", "g", "--rolling", "0.1 ms", "--response", "2 kHz", "--xlsx"],
        "compare": ["shot.csv", "shot.csv", "--unit", "g", "--xlsx"],
        "laws": ["--xlsx"],
        "spec": ["show", "jesd22-b110:B"],
        "impact": [*impact, "--xlsx"],
        "map": ["li-ma-2019", "--points", "2x2", "--train", 0, "--xlsx", *FEW],
        "fit": ["jesd22-b111-b", "--to", "first.width=0.4 ms", "--free", "contact.reference_force", "--xlsx"],
        "sweep": ["li-ma-2019", "--vary", "machine.speed=600..700rpm:2", "--keep", "blows", "--xlsx", *FEW],
        "scatter": ["li-ma-2019-equal-blows", "--runs", 10, "--xlsx", *FEW],
    }
    for command, words in calls.items():
        code, _, err = strikewave(command, *words, "--out", f"of-{command}", "-q")
        assert code in (0, 3), err
        written = {path.name for path in Path(f"of-{command}").iterdir()}
        written = {re.sub(r"-\d+(?=\.parquet)", "", name) for name in written}
        assert len(written) > 2
        rows = [files for files, commands in listed() if re.search(rf"`{command}`|^ ?(all|the same)", commands)]
        assert written <= set().union(*rows), command
