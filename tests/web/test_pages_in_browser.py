"""The other pages in a real browser: each loads without an error, and does what it is for."""

from urllib.parse import parse_qs, urlsplit

import numpy as np
import pytest

pytestmark = pytest.mark.verify


def shots(count):
    """Return files of half sines of 3000 g and more, as they are dropped."""
    time = np.arange(0.0, 2e-3, 2e-6)
    files = []
    for place in range(count):
        pulse = (3000.0 + place) * np.sin(np.pi * (time - 5e-4) / 2e-4) * ((time > 5e-4) & (time < 7e-4))
        rows = "".join(f"{t:.6f},{a:.4f}\n" for t, a in zip(time, pulse, strict=True))
        text = f"time [s],acceleration [g]\n{rows}".encode()
        files.append({"name": f"shot-{place:02d}.csv", "mimeType": "text/csv", "buffer": text})
    return files


FITS = """width => {
    const now = performance.now(), wide = document.documentElement.scrollWidth;
    if (wide !== window.wide) [window.wide, window.since] = [wide, now];
    return wide === width && now - window.since > 1000;
}"""
"""Whether the page has been as wide as its screen for a second: while it is laid out it is wider for a moment."""


@pytest.mark.parametrize("width", [1280, 390])
@pytest.mark.parametrize("place", ["/target", "/record", "/study", "/elements"])
def test_a_page_loads_without_an_error_and_fits_its_screen(visit, place, width):
    one = visit(place, width=width)
    one.page.locator("main").wait_for()
    one.page.wait_for_function(FITS, arg=width)
    assert one.page.locator("nav a[aria-current=page]").count() == 1


def test_twenty_files_are_dropped_at_once_and_judged(visit):
    one = visit("/record?spectrum=no")
    drop = one.page.locator("input[type=file]")
    drop.wait_for(state="attached")
    drop.set_input_files([*shots(19), {"name": "../<i>lie.tdms", "mimeType": "text/plain", "buffer": b"no TDMS"}])
    one.shows("20 files read and judged")
    assert one.number("blows") == "19"
    health = one.page.get_by_role("table", name="Health of the files")
    assert health.locator("tbody tr").first.inner_text().split("\t")[:2] == ["_i_lie.tdms", "bad"]
    one.page.get_by_text("strikewave record").first.wait_for()


def test_a_study_is_begun_stopped_and_gone_on_with(visit):
    one = visit("/study?case=jesd22-b111-b&study=sweep&vary=machine.height%3D0.2..0.4+m%3A3&keep=first.rigid_peak")
    one.page.get_by_role("button", name="begin, or go on").click()
    one.shows("shown: sweep; every check passed")
    rows = one.page.get_by_role("table", name="Sweep").locator("tbody tr")
    assert rows.count() == 3
    assert parse_qs(urlsplit(one.page.url).query)["study"] == ["sweep"]
    one.page.get_by_label("settings to vary, a line each").fill("machine.height=0.2..0.4 m:300")
    one.page.get_by_role("button", name="begin, or go on").click()
    one.shows("under way")
    one.page.get_by_role("button", name="stop").click()
    one.shows("stopped; what was there before is still shown")
    assert rows.count() == 3
    one.page.get_by_label("settings to vary, a line each").fill("load.file=/etc/passwd")
    one.page.get_by_role("button", name="begin, or go on").click()
    one.page.get_by_text("files dropped on this page by name").wait_for()


def test_a_bar_is_changed_and_its_link_shows_it_again(visit):
    one = visit("/target")
    one.shows("a full run; every check passed")
    force = one.number("force at sensor")
    box = one.page.get_by_label("load.peak").first
    box.fill("10 kN")
    box.press("Enter")
    one.until(lambda: one.number("force at sensor") != force, "nothing changes")
    two = visit(urlsplit(one.page.url)._replace(scheme="", netloc="").geturl())
    two.shows("a full run; every check passed")
    assert two.number("force at sensor") == one.number("force at sensor")


def test_elements_run_by_a_button_and_are_stopped(visit):
    one = visit("/elements?case=two-bars-fem")
    one.shows("press run")
    one.page.get_by_role("button", name="run", exact=True).click()
    one.shows("under way")
    one.page.get_by_role("button", name="stop").click()
    one.shows("stopped")
