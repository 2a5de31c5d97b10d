"""A session a browser: names that lead nowhere, bounds, and an end."""

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from strikewave.web import sessions
from strikewave.web.sessions import KEPT, FullError, Session, Sessions, clean_name


@given(st.text(st.characters(max_codepoint=0x2FFF), max_size=120))
def test_a_cleaned_name_is_one_visible_file_of_its_folder(name):
    cleaned = clean_name(name)
    assert Path("/x", cleaned).resolve().parent == Path("/x")
    assert cleaned not in ("", ".", "..")
    assert not cleaned.startswith(".")
    assert len(cleaned) <= sessions.LONGEST_NAME
    assert len(cleaned.encode()) <= sessions.LONGEST_BYTES
    assert cleaned.isprintable()
    assert not set(cleaned) & set("<>&\"'/\\")
    assert clean_name(cleaned) == cleaned


def test_a_session_keeps_no_more_than_it_may(tmp_path, monkeypatch):
    monkeypatch.setattr(sessions, "MOST_KEPT", 100)
    session = Session(tmp_path / "one")
    assert session.keep("../a.csv", b"x" * 60).read_bytes() == b"x" * 60
    with pytest.raises(FullError, match=r"b\.csv"):
        session.keep("b.csv", b"x" * 60)
    assert [path.name for path in session.folder.iterdir()] == ["a.csv"]


def test_a_file_that_takes_the_place_of_its_older_self_takes_its_room_too(tmp_path, monkeypatch):
    monkeypatch.setattr(sessions, "MOST_KEPT", 100)
    session = Session(tmp_path / "one")
    session.keep("a.csv", b"x" * 60)
    assert session.keep("a.csv", b"y" * 90).read_bytes() == b"y" * 90


def dropped(session, *files):
    """Return what is kept of files that are dropped together, and what is said of each."""
    taken = session.take(files, "records")
    kept = {path.name: path.read_bytes() for path in session.place("records").iterdir()}
    return kept, [file.remark for file in taken if file.remark]


def test_no_file_of_a_drop_takes_the_place_of_another(tmp_path):
    """Of two folders, or names that are the same once they are cleaned."""
    session = Session(tmp_path)
    kept, remarks = dropped(
        session, ("a/shot.csv", b"1"), ("b/shot.csv", b"2"), ("c/shot.csv", b"3"), ("d:e.csv", b"4")
    )
    assert kept == {"shot.csv": b"1", "shot-2.csv": b"2", "shot-3.csv": b"3", "d_e.csv": b"4"}
    assert len(remarks) == 2
    assert dropped(session, ("shot.csv", b"1")) == (kept, [])  # the same once more
    assert dropped(session, ("shot.csv", b"5")) == (
        kept | {"shot.csv": b"5"},
        ["shot.csv: the file that was dropped now is in the place of the one before"],
    )


@pytest.mark.parametrize("together", [True, False])
@pytest.mark.parametrize("tells_capitals_apart", [True, False])
def test_names_that_differ_in_case_alone_are_two_files_on_every_disk(
    tmp_path, monkeypatch, together, tells_capitals_apart
):
    session = Session(tmp_path)
    if not tells_capitals_apart:
        monkeypatch.setattr(
            sessions,
            "is_there",
            lambda path: path.name.lower() in {other.name.lower() for other in path.parent.iterdir()},
        )
    files = ("Shot.csv", b"1"), ("shot.csv", b"2")
    for drop in [files] if together else [files[:1], files[1:]]:
        kept, _ = dropped(session, *drop)
    other = "shot.csv" if tells_capitals_apart else "shot-2.csv"
    assert kept == {"Shot.csv": b"1", other: b"2"}


def test_a_file_called_as_a_folder_of_the_session_is_refused_in_words(tmp_path):
    session = Session(tmp_path)
    (session.place("studies") / "sweep-1").mkdir()
    with pytest.raises(FullError, match="sweep-1: a folder of this page is called so"):
        session.take([("sweep-1", b"1")], "studies")


def test_the_oldest_session_that_nobody_looks_at_ends_first(monkeypatch):
    monkeypatch.setattr(sessions, "MOST_SESSIONS", 2)
    kept = Sessions()
    try:
        first, second = kept.of("one"), kept.of("two")
        first.pages = 1
        place = second.keep("a", b"1").parent
        third = kept.of("three")
        assert len(kept) == 2
        assert not place.exists()
        third.pages = 1
        with pytest.raises(FullError, match="try again later"):
            kept.of("four")
        assert kept.of("one") is first
    finally:
        kept.end()


def test_an_idle_session_ends_and_takes_its_files_and_its_work_with_it(monkeypatch):
    class Work:
        stopped = False

        def cancel(self):
            self.stopped = True

    kept, work = Sessions(), Work()
    session = kept.of("one")
    place = session.keep("a", b"1")
    session.jobs.add(work)
    monkeypatch.setattr(sessions, "IDLE", -1.0)
    kept.end_idle()
    assert (len(kept), place.exists(), work.stopped) == (0, False, True)
    kept.end()


@pytest.mark.verify
def test_what_two_pages_of_one_browser_keep_is_apart_and_goes_with_its_page(tmp_path):
    nicegui = pytest.importorskip("nicegui")  # which takes seconds to import
    from nicegui.page import page

    from strikewave.web.parts import page_file

    session = Session(tmp_path)
    pages = [nicegui.Client(page("/elements")) for _ in range(2)]
    for place, one in enumerate(pages):
        with one:
            page_file(session, "field.bin", bytes([place]))
    files = {path.name: path.read_bytes() for path in session.place(KEPT).iterdir()}
    assert files == {f"{one.id}-field.bin": bytes([place]) for place, one in enumerate(pages)}
    pages[0].delete()
    assert [path.name for path in session.place(KEPT).iterdir()] == [f"{pages[1].id}-field.bin"]
    session.end()
    assert not (tmp_path / KEPT).exists()


def test_a_folder_of_results_survives_and_the_same_browser_finds_it_again(tmp_path):
    one = Sessions(tmp_path)
    one.of("browser").keep("a.csv", b"1")
    one.end()
    again = Sessions(tmp_path)
    assert again.secret == one.secret
    assert (again.of("browser").folder / "a.csv").read_bytes() == b"1"
    assert (tmp_path / sessions.SECRET).stat().st_mode & 0o077 == 0
