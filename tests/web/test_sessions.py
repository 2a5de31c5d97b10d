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

    from strikewave.web.parts import kept

    session = Session(tmp_path)
    pages = [nicegui.Client(page("/elements")) for _ in range(2)]
    for place, one in enumerate(pages):
        with one:
            kept(session, "field.bin", bytes([place]))
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
