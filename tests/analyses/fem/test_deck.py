"""strikewave deck writes decks whole, says what they leave out, and refuses what it cannot say."""

import json

import pytest


@pytest.mark.parametrize(
    ("code", "names"),
    [("ls-dyna", {"taylor-bar-fem.k"}), ("openradioss", {"taylor-bar-fem_0000.rad", "taylor-bar-fem_0001.rad"})],
)
def test_deck_and_its_case_are_written(strikewave, tmp_path, code, names):
    status, out, _ = strikewave("deck", "taylor-bar-fem", "--code", code, "--units", "mm-g-us", "--out", "deck")
    assert status == 0
    assert {path.name for path in (tmp_path / "deck").iterdir()} == {*names, "case.toml"}
    assert "mm, g, mus" in out
    assert "left out: section middle" in out


def test_written_case_is_the_case(strikewave, tmp_path):
    from strikewave import load_case

    strikewave("deck", "taylor-bar-fem", "--set", "fem.duration=20 us", "--out", "deck")
    assert load_case(str(tmp_path / "deck" / "case.toml")).fem.duration.si == 20e-6
    assert "*CONTROL_TERMINATION\n    2.0e-5" in (tmp_path / "deck" / "taylor-bar-fem.k").read_text("ascii")


def test_json_is_one_document_and_writes_nothing_unasked(strikewave, tmp_path):
    status, out, _ = strikewave("deck", "taylor-bar-fem", "--json")
    document = json.loads(out)
    assert status == 0
    assert document["files"] == ["taylor-bar-fem.k"]
    assert (document["code"], document["system"], document["parts"]) == ("ls-dyna", "mm-t-s", ["bar"])
    assert any(line.startswith("section middle") for line in document["left_out"])
    assert not list(tmp_path.iterdir())


def test_a_deck_in_other_units_replaces_one_only_by_force(strikewave, tmp_path):
    strikewave("deck", "taylor-bar-fem", "--out", "deck")
    before = (tmp_path / "deck" / "taylor-bar-fem.k").read_bytes()
    status, _, err = strikewave("deck", "taylor-bar-fem", "--units", "SI", "--out", "deck")
    assert status == 2
    assert "--force" in err
    assert (tmp_path / "deck" / "taylor-bar-fem.k").read_bytes() == before
    assert strikewave("deck", "taylor-bar-fem", "--code", "openradioss", "--out", "deck", "--force")[0] == 0
    assert not (tmp_path / "deck" / "taylor-bar-fem.k").exists()


def test_a_folder_with_files_of_others_is_never_replaced(strikewave, tmp_path):
    strikewave("deck", "taylor-bar-fem", "--out", "deck")
    (tmp_path / "deck" / "mine.k").write_text("*KEYWORD")
    status, _, err = strikewave("deck", "taylor-bar-fem", "--out", "deck", "--force")
    assert status == 2
    assert "mine.k" in err
    assert (tmp_path / "deck" / "mine.k").read_text() == "*KEYWORD"


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["taylor-bar-fem", "--units", "mm-tonne-s"], '--units: got "mm-tonne-s"'),
        (["taylor-bar-fem", "--code", "openradios"], 'did you mean "openradioss"?'),
        (["li-ma-2019"], "mesh"),
        (["taylor-bar-fem", "--set", "fem.safety=2"], "fem.safety"),
    ],
)
def test_what_cannot_be_said_is_refused_by_its_field(strikewave, tmp_path, words, said):
    status, _, err = strikewave("deck", *words, "--out", "deck")
    assert status == 2
    assert said in err
    assert not (tmp_path / "deck").exists()


def test_names_of_files_are_those_that_every_code_takes(strikewave, tmp_path):
    from strikewave import load_case
    from strikewave.cases.case import dump_case

    renamed = load_case("taylor-bar-fem").model_copy(update={"name": "mein fünfter", "title": "Stoß µ"})
    (tmp_path / "mine.toml").write_text(dump_case(renamed), "utf-8")
    assert strikewave("deck", "mine.toml", "--code", "openradioss", "--out", "deck")[0] == 0
    starter, engine = (tmp_path / "deck" / f"mein-f-nfter_{k}.rad" for k in ("0000", "0001"))
    assert "\n/BEGIN\nmein-f-nfter\n" in starter.read_text("ascii")
    assert engine.read_text("ascii").startswith("/RUN/mein-f-nfter/1\n")


def test_a_cut_that_nothing_holds_is_warned_of(strikewave):
    status, out, _ = strikewave("deck", "two-bars-fem", "--json", "--set", "fem.boundary.0.side=bar.x-")
    assert status == 0
    (warning,) = json.loads(out)["warnings"]
    assert warning["code"] == "cut-without-symmetry"
    assert "striker.x-" in warning["message"]
    assert "striker.x-" in strikewave("deck", "two-bars-fem", "--set", "fem.boundary.0.side=bar.x-")[2]


@pytest.mark.parametrize("code", ["ls-dyna", "openradioss"])
@pytest.mark.parametrize(
    ("case", "field"),
    [
        (["taylor-copper-fem"], "mesh.part.bar.solid.law"),
        (["taylor-steel-fem", "--set", "mesh.part.bar.solid.preheat=100 K"], "mesh.part.bar.solid.preheat"),
    ],
)
def test_solids_that_no_deck_holds_are_refused(strikewave, code, case, field):
    status, _, err = strikewave("deck", *case, "--code", code, "--set", "mesh.part.bar.size=2 mm", "--out", "deck")
    assert (status, f"{field}: got" in err) == (2, True)
