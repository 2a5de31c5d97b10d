"""``strikewave laws``: every law with status, source and what it gives; laws that other packages add."""

import json
import os
from dataclasses import replace
from xml.etree import ElementTree

import pytest

from strikewave.base.citations import CHECKED, FROM_MEMORY, QUOTED, SOURCES
from strikewave.contact import CAP_LAWS, damper_laws, damping_laws, registry, restitution, stiffness_laws
from strikewave.contact.cushions import cushion_laws

ASKED = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9]
ENTRY = {"name", "equation", "symbols", "limits", "status", "source", "reference", "seen", "note"}


@pytest.fixture
def document(strikewave):
    """Run ``strikewave laws --json`` and return its document."""

    def call(*words):
        code, out, err = strikewave("laws", *words, "--json")
        assert (code, err) == (0, "")
        return json.loads(out)

    return call


def test_every_law_with_status_and_source(document):
    told = document()
    assert set(told) == {
        "schema",
        "version",
        "units",
        "warnings",
        "exponent",
        "damping",
        "dampers",
        "stiffness",
        "caps",
        "cushions",
    }
    tables = {"damping": damping_laws(), "dampers": damper_laws(), "stiffness": stiffness_laws(), "caps": CAP_LAWS}
    tables["cushions"] = cushion_laws()
    for kind, laws in tables.items():
        more = {"stiffness": {"needs"}, "caps": set(), "cushions": {"needs", "options"}}.get(kind, {"asked", "given"})
        assert [row["name"] for row in told[kind]] == list(laws)
        for row in told[kind]:
            law = laws[row["name"]]
            assert set(row) == ENTRY | more
            assert row["status"] == law.status
            assert row["status"] in (CHECKED, QUOTED, FROM_MEMORY)
            assert row["reference"] == SOURCES[row["source"]]
            assert row["equation"] == law.equation != ""
            assert row["limits"] == law.limits != ""
            assert row["symbols"] == dict(law.symbols)
    assert [row["needs"] for row in told["stiffness"]] == [list(law.needs) for law in stiffness_laws().values()]


def test_given_is_what_comes_out(document):
    told = document()
    for row in told["damping"]:
        assert row["asked"] == ASKED
        assert row["given"] == restitution(damping_laws()[row["name"]].function(ASKED)).tolist()
    for row in told["dampers"]:
        law = damper_laws()[row["name"]]
        assert row["given"] == (None if law.given is None else list(law.given(ASKED, told["exponent"])))
        assert row["asked"] == (None if law.given is None else ASKED)


def test_laws_from_memory_are_warned_of(document):
    told = document()
    assert [warning["code"] for warning in told["warnings"]] == ["law-from-memory"]
    message = told["warnings"][0]["message"]
    for row in told["damping"] + told["dampers"] + told["stiffness"] + told["cushions"]:
        assert (f"{row['name']} (" in message) == (row["status"] == "from memory")


def test_tables_on_the_screen(strikewave):
    code, out, _ = strikewave("laws")
    assert code == 0
    assert [title in out for title in ("Damping laws", "Dampers", "Stiffness laws")] == [True] * 3
    lines = {line.split()[0]: line for line in reversed(out.splitlines()) if line.strip()}
    for name, law in damping_laws().items():
        given = restitution(law.function(ASKED[::2]))
        assert lines[name].split()[-5:] == [f"{value:.4f}" for value in given]
        assert ("! FROM MEMORY !" in lines[name]) == (law.status == "from memory")
    assert lines["tsuji"].rstrip().endswith("gives e")
    assert lines["jankowski"].rstrip().endswith("0.5 comes out as 0.4946")
    assert lines["kuwabara-kono"].rstrip().endswith("cannot be prescribed")
    assert lines["palmgren"].rstrip().endswith("length")
    assert "strikewave laws NAME" in out
    assert "entry point" in out


def test_one_law_in_full(strikewave):
    code, out, err = strikewave("laws", "li-ma-printed")
    assert (code, err) == (0, "")
    law = damping_laws()["li-ma-printed"]
    text = " ".join(out.split())
    for part in (law.equation, law.limits, law.note, "checked", "5139137", "restitution asked for, -", "v0"):
        assert part in text
    for value in restitution(law.function(ASKED)):
        assert f"{value:.4f}" in text


def test_one_law_from_memory_says_so(strikewave):
    code, out, err = strikewave("laws", "hu-guo")
    assert code == 0
    assert "! FROM MEMORY !" in out
    assert err.startswith("info [law-from-memory]")


def test_a_damper_without_a_restitution_says_so(strikewave):
    code, out, _ = strikewave("laws", "kuwabara-kono")
    assert code == 0
    assert "cannot be prescribed" in out
    assert "Restitution of the damper" not in out


def test_a_name_of_two_kinds_shows_both(document):
    told = document("lankarani-nikravesh")
    assert [len(told[kind]) for kind in ("damping", "dampers", "stiffness")] == [1, 0, 1]


@pytest.mark.parametrize(("typed", "near"), [("flore", "flores"), ("jankowsky", "jankowski"), ("herz", "hertz")])
def test_an_unknown_law_has_its_nearest_of_all_kinds(strikewave, typed, near):
    code, out, err = strikewave("laws", typed)
    assert (code, out) == (2, "")
    assert err == f'NAME: got "{typed}"; allowed: a contact law; did you mean "{near}"?\n'


class Point:
    """An entry point of an installed package."""

    def __init__(self, name, made):
        self.name, self.made = name, made

    def load(self):
        if isinstance(self.made, Exception):
            raise self.made
        return self.made


@pytest.fixture
def install(monkeypatch):
    """Install entry points of damping laws, as a package would."""

    def call(**made):
        points = [Point(name, what) for name, what in made.items()]
        ours = registry.DampingLaw.group
        monkeypatch.setattr(registry, "entry_points", lambda group: points if group == ours else [])
        registry._added.cache_clear()

    yield call
    registry._added.cache_clear()


OWN = replace(damping_laws()["flores"], name="own", source="A. Person, A law, 2026", status="from memory")


def test_a_law_of_an_installed_package_appears(strikewave, document, install):
    install(own=OWN)
    row = document("own")["damping"][0]
    assert (row["reference"], row["status"]) == ("A. Person, A law, 2026", "from memory")
    assert row["given"] == document("flores")["damping"][0]["given"]
    assert "own " in strikewave("laws")[1]
    words = ("--m1", "1", "--m2", "1", "--speed", "1", "--stiffness", "1e9", "--exponent", "1.5")
    told = json.loads(strikewave("impact", *words, "-e", "0.5", "--damping", "own", "--json")[1])
    assert told["restitution"] == pytest.approx(row["given"][4], rel=1e-12)


@pytest.mark.filterwarnings("default::strikewave.base.errors.StrikewaveWarning")
def test_a_broken_law_is_told_and_left_out(strikewave, install):
    install(broken=ImportError("no such module"), number=3.0, own=OWN)
    code, out, err = strikewave("laws", "--json")
    assert code == 0
    names = [row["name"] for row in json.loads(out)["damping"]]
    assert names == ["own", *(name for name in damping_laws() if name != "own")]
    assert "'broken' of an installed package is left out (ImportError: no such module)" in err
    assert "'number' of an installed package is left out (it is a float" in err


def ends(restitution):
    raise SystemExit(0)


@pytest.mark.parametrize(
    ("function", "words"),
    [
        (lambda e: "much", "is no hysteresis factor"),
        (lambda e: None, "is no hysteresis factor"),
        (lambda e: 1.0 + 2.0j, "is no hysteresis factor"),
        (ends, "failed (SystemExit: 0)"),
        (lambda e: 1.0 / 0.0, "failed (ZeroDivisionError"),
    ],
)
def test_a_law_of_a_package_that_gives_no_number_is_named(strikewave, install, function, words):
    install(own=replace(OWN, function=function))
    contact = ("--m1", "1", "--m2", "1", "--speed", "1", "--stiffness", "1e9", "--exponent", "1.5")
    code, out, err = strikewave("impact", *contact, "-e", "0.5", "--damping", "own")
    assert (code, out, len(err.splitlines())) == (2, "", 1)
    assert "the contact law 'own' of an installed package" in err
    assert words in err


@pytest.mark.verify
@pytest.mark.parametrize("function", [lambda e: 1.0 / 0.0, lambda e: -1.0, lambda e: "much"])
def test_a_law_that_fails_is_told_and_left_out(strikewave, install, function):
    install(own=replace(OWN, function=function))
    code, out, err = strikewave("laws", "--json", "--out", "a")
    assert code == 0
    assert "own" not in [row["name"] for row in json.loads(out)["damping"]]
    assert err.count("the damping law 'own' is left out") == 1


@pytest.mark.verify
def test_out_holds_the_document_and_three_pictures(strikewave, tmp_path):
    code, out, _ = strikewave("laws", "--out", "a", "--json")
    assert code == 0
    pictures = [
        f"{name}.{kind}" for name in ("asked-given", "stiffness-laws", "cushion-laws") for kind in ("png", "svg")
    ]
    assert sorted(os.listdir("a")) == sorted(["laws.json", "record.toml", *pictures])
    assert os.listdir(tmp_path) == ["a"]
    assert json.loads(open("a/laws.json", encoding="utf-8").read()) == json.loads(out)
    for name in pictures:
        if name.endswith(".svg"):
            ElementTree.parse(f"a/{name}")
        else:
            assert open(f"a/{name}", "rb").read(4) == b"\x89PNG"


@pytest.mark.verify
def test_out_is_replaced_by_force(strikewave):
    assert strikewave("laws", "--out", "a")[0] == 0
    assert strikewave("laws", "hertz", "--out", "a")[0] == 2
    assert strikewave("laws", "hertz", "--out", "a", "--force")[0] == 0
