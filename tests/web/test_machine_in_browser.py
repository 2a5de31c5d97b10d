"""The page of machines in a real browser."""

import csv
from urllib.parse import parse_qs, urlsplit

import pytest

from strikewave import load_case, run_case

pytestmark = pytest.mark.verify

QUICK = "jesd22-b111-b"
"""A case whose full run takes a fraction of a second."""


def settings_of(page):
    return parse_qs(urlsplit(page.url).query)


def downloaded(visitor, button):
    with visitor.page.expect_download() as arrived:
        visitor.page.get_by_role("button", name=button).click()
    return arrived.value.path()


def test_a_slider_moves_the_plot_and_a_download_runs_again_to_the_same_numbers(visit):
    one = visit(f"/?case={QUICK}")
    one.shows_full_run()
    before, peak = one.options()["series"][0]["data"], one.number("first rigid peak")
    slider = one.page.get_by_role("slider", name="machine.height")
    slider.press("ArrowRight")  # the keyboard alone will do
    one.until(lambda: one.options()["series"][0]["data"] != before, "the plot does not move")
    one.shows_full_run()
    assert one.number("first rigid peak") != peak
    height = settings_of(one.page)["set"][0]
    assert height.startswith("machine.height=")
    case, blows = downloaded(one, "case (.toml)"), downloaded(one, "blows (.csv)")
    expected = run_case(load_case(QUICK, [height]))
    again = run_case(load_case(str(case.rename(case.with_suffix(".toml")))))
    assert again.blows == expected.blows
    assert blows.read_text("utf-8") == expected.tables()["blows.csv"]
    assert float(next(csv.DictReader(blows.open()))["rigid_peak [m/s^2]"]) == expected.blows[0].rigid_peak


def test_a_link_and_a_reload_give_the_view_again_and_undo_goes_back(visit):
    one = visit(f"/?case={QUICK}&set=machine.height%3D1.2+m")
    one.shows_full_run()
    box = one.page.get_by_label("machine.height").first
    assert box.input_value() == "1.2 m"
    box.fill("1 m")
    box.press("Enter")
    one.until(lambda: settings_of(one.page).get("set") == ["machine.height=1 m"], "the address does not follow")
    one.shows_full_run()
    peak, address = one.number("first rigid peak"), one.page.url
    one.page.reload()
    one.shows_full_run()
    assert one.number("first rigid peak") == peak
    other = visit(urlsplit(address)._replace(scheme="", netloc="").geturl())
    other.shows_full_run()
    assert other.number("first rigid peak") == peak
    box = other.page.get_by_label("machine.height").first
    box.fill("2 furlongs per fortnight")
    box.press("Enter")
    other.page.get_by_text("refused: machine.height").wait_for()
    assert box.input_value() == "1 m"
    box.fill("1.1 m")
    box.press("Enter")
    other.until(lambda: settings_of(other.page).get("set") == ["machine.height=1.1 m"], "not set")
    other.page.get_by_role("button", name="undo").click()
    other.until(lambda: settings_of(other.page).get("set") == ["machine.height=1 m"], "not undone")


def test_settings_are_found_for_what_is_filled_in_and_a_link_opens_one(visit):
    one = visit("/?case=li-ma-2019&set=feed.blows%3D3")
    one.shows("the fast engine")
    one.page.get_by_text("Find settings: match the period").click()
    vary = one.page.get_by_label("settings to vary, a line each")
    one.until(lambda: "object.damper=20..120 N s/m" in vary.input_value(), "nothing is filled in")
    assert one.page.get_by_label("interval of the blows").input_value().endswith(" ms")
    one.page.get_by_label("goals, a line each").fill("cv < 20 %")
    one.page.get_by_label("runs", exact=True).fill("20")
    one.page.get_by_role("button", name="equal blows", exact=True).click()
    found = one.page.get_by_role("region", name="Open on its page").get_by_role("link")
    found.first.wait_for()
    assert one.page.evaluate("document.documentElement.scrollWidth") == 1280  # a wide table scrolls by itself
    wanted = dict(pair.split(" = ") for pair in found.first.inner_text().split(", "))
    found.first.click()
    one.until(lambda: "object.damper" in urlsplit(one.page.url).query, "the link leads nowhere")
    asked = dict(change.split("=") for change in settings_of(one.page)["set"])
    assert asked == {"feed.blows": "3", **wanted}


def test_a_dropped_case_is_shown_and_one_that_is_none_is_refused_in_words(visit):
    one = visit(f"/?case={QUICK}")
    one.shows("shown")
    text = "schema = 1\nname = '<img src=x onerror=alert(1)>'\n"
    drop = one.page.locator("input[type=file]")
    drop.set_input_files({"name": "../../<b>lie</b>.toml", "mimeType": "text/plain", "buffer": text.encode()})
    one.page.get_by_text("refused:").first.wait_for()
    drop.set_input_files({"name": "binary.toml", "mimeType": "text/plain", "buffer": bytes(range(256))})
    one.page.get_by_text("a text file in UTF-8 is wanted").wait_for()
    from strikewave import dump_case

    mine = dump_case(load_case(QUICK, ["machine.height=1.3 m"]))
    drop.set_input_files({"name": "mine.toml", "mimeType": "text/plain", "buffer": mine.encode()})
    one.page.get_by_text("save the case as mine.toml first").wait_for()
    one.shows_full_run()
    assert settings_of(one.page)["case"] == ["mine"]


def test_files_dropped_one_right_after_the_other_all_arrive(visit):
    one = visit("/record")
    drop = one.page.locator("input[type=file]").first
    for number in range(12):  # the next as soon as the field takes one again
        drop.set_input_files({"name": f"no_{number}.toml", "mimeType": "text/plain", "buffer": b"schema = 1"})
    for number in range(12):
        one.page.get_by_text(f"no_{number}.toml", exact=True).wait_for(timeout=20_000)


def test_two_people_do_not_see_one_another_and_a_case_that_is_too_large_is_refused(visit):
    one, two = visit(f"/?case={QUICK}&set=recorder.memory%3D40000000000"), visit(f"/?case={QUICK}")
    two.shows_full_run()
    one.page.get_by_text("refused.").wait_for()
    assert "set" not in settings_of(two.page)
    two.page.get_by_role("button", name="keep beside").click()
    two.page.get_by_role("columnheader", name="kept beside").wait_for()


def test_a_narrow_screen_shows_all_without_scrolling_sideways(visit):
    one = visit(f"/?case={QUICK}", width=390)
    one.shows_full_run()
    assert one.page.evaluate("document.documentElement.scrollWidth") == 390


def test_a_connection_that_is_cut_goes_on_where_it_was(visit):
    one = visit(f"/?case={QUICK}")
    one.shows_full_run()
    one.context.set_offline(True)
    one.page.evaluate("window.socket.io.engine.close()")
    one.page.wait_for_timeout(300)  # as a train in a tunnel
    one.context.set_offline(False)
    one.faults.clear()  # the browser reports that it was offline
    box = one.page.get_by_label("machine.height").first
    one.until(lambda: one.page.evaluate("window.socket.connected"), "no connection")
    box.fill("1.1 m")
    box.press("Enter")
    one.until(lambda: settings_of(one.page).get("set") == ["machine.height=1.1 m"], "nothing follows")
    one.faults.clear()
