"""What the page of machines shows is what the commands give, the first look within the tolerance of its engine."""

import numpy as np
import pytest

from strikewave import dump_case, load_case, run_case
from strikewave.analyses.machine.band import MOST_PASSES, quick_look
from strikewave.base.constants import STANDARD_GRAVITY
from strikewave.base.errors import StrikewaveError
from strikewave.web.case_state import CaseSource, CaseState, EditedField
from strikewave.web.case_values import edited_fields, loaded, opened, saved
from strikewave.web.pages.case.machine_view import PUBLISHED, compared, full, look

ENGINE = 1e-3
"""What the fast engine may change of a result: its tolerance of 1e-4 gave at most 6e-4 over the inputs of li-ma-2019."""


@pytest.mark.parametrize("name", ["li-ma-2019", "jesd22-b111-b"])
def test_a_first_look_shows_the_blows_and_the_first_pulse_of_the_full_run(name):
    case = load_case(name)
    seen, whole = quick_look(case), run_case(case)
    assert [blow.kind for blow in seen.blows] == [blow.kind for blow in whole.blows]
    for quick, blow in zip(seen.blows, whole.blows, strict=True):
        for quantity in ("rigid_peak", "width", "velocity_change", "time"):
            assert getattr(quick, quantity) == pytest.approx(getattr(blow, quantity), rel=ENGINE)
    time, acceleration = whole.arrays["pulse_time"].values, whole.arrays["pulse_acceleration"].values[0]
    inside = (seen.since >= time[0]) & (seen.since <= time[-1])
    expected = np.interp(seen.since[inside], time, acceleration)
    assert seen.acceleration[inside] == pytest.approx(expected, abs=ENGINE * np.abs(expected).max())


def test_a_first_look_at_a_long_train_stops_where_a_picture_does():
    seen = quick_look(load_case("li-ma-2019", ["feed.blows=200"]))
    assert len(seen.blows) == MOST_PASSES


def test_no_striker_that_touches_is_a_view_without_a_pulse():
    view = look(CaseSource("li-ma-2019", "", ("machine.engagement=1 um", "feed.blows=2"), ""))
    assert view["figures"] == []
    assert {bar["name"] for bar in view["charts"][2]["series"][0]["data"]} == {"missed"}
    assert view["charts"][0]["series"][0]["data"] == []


def test_one_blow_has_no_diagram_of_a_train():
    drop, train = (look(CaseSource(name, "", (), "")) for name in ("jesd22-b111-b", "li-ma-2019"))
    assert [len(view["charts"]) for view in (drop, train)] == [2, 3]


def test_published_values_stand_beside_those_that_were_computed():
    """With units: a difference alone cannot be judged."""
    solution = run_case(load_case("jesd22-b111-b"))
    rows = {row[0]: row for row in compared(solution)}
    assert all(len(row) == len(PUBLISHED) for row in rows.values())
    entry = next(one for one in solution.comparisons if one.quantity == "first.rigid_peak")
    assert rows["first.rigid_peak"][3] == f"{entry.published / STANDARD_GRAVITY:.4g} g"
    assert rows["first.rigid_peak"][4] == f"{entry.computed / STANDARD_GRAVITY:.4g} g"


@pytest.mark.verify
def test_the_full_view_holds_the_numbers_of_the_command():
    source = CaseSource("jesd22-b111-b", "", ("machine.height=1.2 m",), "")
    view = full(source)
    solution = run_case(load_case("jesd22-b111-b", ["machine.height=1.2 m"]))
    assert view["texts"]["blows.csv"] == solution.tables()["blows.csv"]
    assert view["important"]
    assert view["balance"] == [check.words for check in solution.balance_checks]
    assert [words.partition(" ")[0] for words in view["balance"]] == ["energy", "momentum"]


def test_a_saved_case_gives_the_same_numbers(tmp_path):
    source = CaseSource("jesd22-b111-b", "", ("machine.height=1.2 m",), "")
    path = tmp_path / "saved.toml"
    path.write_text(saved(source))
    assert run_case(load_case(str(path))).blows == run_case(loaded(source)).blows


def test_a_case_opens_no_file_that_was_not_dropped(tmp_path):
    secret = tmp_path / "secret.csv"
    secret.write_text("time [us],force [kN]\n0,0\n10,1\n20,0\n")
    text = dump_case(load_case("li-ma-2019-fig13-bar"))
    changes = ("load.shape=file", f"load.file={secret}")
    session = tmp_path / "session"
    session.mkdir()
    with pytest.raises(StrikewaveError, match="a file dropped here"):
        loaded(CaseSource("bar", text, changes, str(session)))
    (session / "secret.csv").write_text(secret.read_text())
    assert loaded(CaseSource("bar", text, changes, str(session))).load.file == str(session / "secret.csv")


@pytest.mark.parametrize("name", ["/etc/passwd", "../li-ma-2019", "", "li-ma-2109"])
def test_an_address_names_built_in_cases_alone(name):
    with pytest.raises(StrikewaveError, match="a built-in case"):
        loaded(CaseSource(name, "", (), ""))


@pytest.mark.verify
def test_what_a_page_needs_is_there_for_every_machine():
    first = opened(CaseSource("li-ma-2019", "", (), ""), "run")
    assert len(first["titles"]) > 10
    for name in first["titles"]:
        fields = edited_fields(load_case(name))
        assert fields
        for one in fields.values():
            assert isinstance(one, EditedField)
            assert one.step > 0.0
            if one.high > one.low:
                # where the slider stands at first is on it, to a step
                assert one.low - one.step <= one.value <= one.high + one.step, (name, one)


@pytest.mark.parametrize("packed", ["!!!", "eJw=", "A" * 40])
def test_a_damaged_link_is_refused_in_words(packed):
    with pytest.raises(StrikewaveError, match="drop the file instead"):
        CaseState.read([("toml", packed)], "li-ma-2019")


def test_a_link_that_unpacks_to_gigabytes_is_refused():
    import base64
    import zlib

    bomb = base64.urlsafe_b64encode(zlib.compress(b" " * (1 << 24), 9)).decode()
    with pytest.raises(StrikewaveError, match="drop the file instead"):
        CaseState.read([("toml", bomb)], "li-ma-2019")


def test_a_link_asks_for_a_bounded_number_of_changes():
    with pytest.raises(StrikewaveError, match="at most"):
        CaseState.read([("set", "machine.speed=1 rpm")] * 1000, "li-ma-2019")


def test_a_field_says_what_it_is_in_this_kind_of_machine():
    """The object of a drop table is its carriage; that of a rotary machine is no such thing."""
    words = [edited_fields(load_case(name))["object.mass"].what for name in ("jesd22-b111-b", "li-ma-2019")]
    assert ["carriage" in one for one in words] == [True, False]
