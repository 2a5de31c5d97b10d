"""The other pages in a real browser: each loads without an error, and does what it is for."""

from urllib.parse import parse_qs, urlsplit

import numpy as np
import pytest

from strikewave import load_case

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


UNNAMED = """() => [...document.querySelectorAll("button, a, input, select, textarea, iframe, [role=button], [role=img]")]
    .filter(one => one.getClientRects().length && one.type !== "file")
    .filter(one => {
        const seen = one.cloneNode(true);
        seen.querySelectorAll("[aria-hidden=true]").forEach(icon => icon.remove());
        const label = one.closest("label") || document.querySelector(`label[for="${one.id}"]`);
        return !(one.getAttribute("aria-label") || one.title || seen.textContent.trim() || label?.textContent.trim());
    })
    .map(one => one.outerHTML.slice(0, 200))"""
"""What can be seen and has no name for who hears the page: icons are words of a font, and are not read."""


@pytest.mark.parametrize("width", [1280, 390])
@pytest.mark.parametrize("place", ["/target", "/record", "/study", "/elements"])
def test_a_page_loads_without_an_error_and_fits_its_screen(visit, place, width):
    one = visit(place, width=width)
    one.page.locator("main").wait_for()
    one.page.wait_for_function(FITS, arg=width)
    assert one.page.locator("nav a[aria-current=page]").count() == 1
    assert one.page.evaluate(UNNAMED) == []
    assert one.page.evaluate("document.documentElement.lang") == "en-US"
    one.page.keyboard.press("Tab")
    assert one.page.evaluate("document.activeElement.innerText") == "to the content"


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


def test_files_are_removed_and_dropped_again_and_old_results_are_marked(visit):
    one = visit("/record?spectrum=no")
    drop = one.page.locator("input[type=file]")
    drop.wait_for(state="attached")
    files = [*shots(2), {**shots(3)[2], "name": "SHOT-00.csv"}]
    drop.set_input_files(files)
    one.shows("3 files read and judged")
    stale, busy = one.page.locator(".sw-stale"), one.page.locator(".sw-stale[aria-busy=true]")
    assert stale.count() == 0
    one.page.get_by_role("button", name="remove shot-00.csv", exact=True).click()
    busy.wait_for()
    drop.set_input_files([*files, *({**file, "name": "x.csv"} for file in files[:2])])
    one.shows("5 files read and judged")
    assert stale.count() == 0
    assert "refused" not in " ".join(one.page.locator(".q-notification").all_inner_texts())
    one.page.get_by_label("channel", exact=True).fill("1")
    one.shows("what is shown is of the settings before: press judge")
    assert (stale.count(), busy.count()) == (1, 0)
    one.page.get_by_role("button", name="remove all").click()
    one.page.locator(".sw-empty").wait_for()
    assert one.page.locator(".sw-card").count() == 0


def test_a_study_is_begun_stopped_and_gone_on_with(visit):
    one = visit("/study?case=jesd22-b111-b&study=sweep&vary=machine.height%3D0.2..0.4+m%3A3&keep=first.rigid_peak")
    one.page.get_by_role("button", name="begin, or go on").click()
    one.shows("shown: sweep; all checks passed")
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
    one.shows_full_run()
    force = one.number("force at sensor")
    assert one.page.locator(".sw-stale").count() == 0
    box = one.page.get_by_label("load.peak").first
    box.fill("10 kN")
    box.press("Enter")
    one.page.locator(".sw-stale[aria-busy=true]").wait_for()  # till the numbers of the new setting come
    one.until(lambda: one.number("force at sensor") != force, "nothing changes")
    one.page.wait_for_function("() => !document.querySelector('.sw-stale')")
    two = visit(urlsplit(one.page.url)._replace(scheme="", netloc="").geturl())
    two.shows_full_run()
    assert two.number("force at sensor") == one.number("force at sensor")


def test_a_section_is_moved_and_the_link_holds_it(visit):
    one = visit("/target")
    one.shows_full_run()
    before = one.options(3)["series"][0]["data"]
    one.page.get_by_role("slider", name="section").press("Home")
    one.until(lambda: one.options(3)["series"][0]["data"] != before, "the readings do not follow")
    one.until(lambda: parse_qs(urlsplit(one.page.url).query).get("section") == ["0 mm"], "the address does not follow")
    two = visit(urlsplit(one.page.url)._replace(scheme="", netloc="").geturl())
    two.shows_full_run()
    assert two.options(3)["series"][0]["data"] == one.options(3)["series"][0]["data"]


def test_layers_are_put_in_another_order_by_the_keyboard_and_by_dragging(visit):
    one = visit("/target")
    one.shows_full_run()
    names = one.page.locator(".sw-layer .sw-grow")
    assert [text.split(":")[0] for text in names.all_inner_texts()] == ["upper", "sensor", "lower"]
    one.page.get_by_role("button", name="layer sensor up").press("Enter")
    one.page.get_by_text("save the case as li-ma-2019-fig13-bar-layers.toml first").wait_for()
    one.shows_full_run()
    assert [text.split(":")[0] for text in names.all_inner_texts()] == ["sensor", "upper", "lower"]
    one.page.locator(".sw-grip").nth(2).drag_to(one.page.locator(".sw-layer").nth(0))
    one.until(lambda: names.first.inner_text().startswith("lower"), "nothing was dragged")
    one.shows_full_run()


def test_layers_and_joints_are_added_and_removed_and_undo_takes_it_back(visit, tmp_path):
    one = visit("/target")
    one.shows_full_run()
    rows, joints = one.page.locator(".sw-layer"), one.page.locator(".sw-joint")

    def has(layers, of_joints, line):
        one.until(lambda: (rows.count(), joints.count()) == (layers, of_joints), "the list does not follow")
        lines = one.page.locator(".sw-code")
        one.until(lambda: f"strikewave wave {line}" in lines.all_inner_texts(), "the command line does not follow")
        one.shows_full_run()

    one.page.get_by_role("button", name="layer sensor remove").press("Enter")
    has(2, 0, "li-ma-2019-fig13-bar-layers.toml")
    assert "sensor" not in rows.all_inner_texts()[1]
    one.page.get_by_text("Add a joint").click()
    one.page.get_by_role("button", name="add joint").click()
    has(2, 1, "li-ma-2019-fig13-bar-layers.toml")
    one.page.get_by_text("Add a layer").click()
    add = one.page.get_by_role("button", name="add layer")
    add.click()
    one.page.get_by_text("refused:").first.wait_for()  # it has no name yet
    one.page.get_by_label("name of the layer").fill("pad")
    one.page.get_by_label("density of its own").fill("1850 kg/m^3")
    one.page.get_by_label("modulus of its own").fill("24 GPa")
    add.click()
    has(3, 1, "li-ma-2019-fig13-bar-layers.toml")
    with one.page.expect_download() as arrived:
        one.page.get_by_role("button", name="case (.toml)").click()
    saved = load_case(str(arrived.value.path().rename(tmp_path / "saved.toml")))
    assert [layer.name for layer in saved.stack.layer] == ["upper", "lower", "pad"]
    assert (saved.stack.layer[2].density.si, saved.stack.layer[2].modulus.si) == (1850.0, 24e9)
    for layers, of_joints in ((2, 1), (2, 0)):
        one.page.get_by_role("button", name="undo").click()
        has(layers, of_joints, "li-ma-2019-fig13-bar-layers.toml")
    one.page.get_by_role("button", name="undo").click()
    has(3, 0, "li-ma-2019-fig13-bar")
    one.until(lambda: "toml" not in parse_qs(urlsplit(one.page.url).query), "the address does not follow")


def test_a_filter_is_moved_by_its_handle_and_its_cost_and_line_are_shown(visit):
    one = visit("/record?spectrum=no")
    drop = one.page.locator("input[type=file]")
    drop.wait_for(state="attached")
    drop.set_input_files(shots(2))
    one.shows("2 files read and judged")
    handle = one.page.get_by_role("slider", name="filter")
    for _ in range(10):  # a decade of ten steps below the end, where nothing is filtered
        handle.press("ArrowLeft")
    cost = one.page.get_by_role("table", name="What filter and baseline cost")
    cost.wait_for()
    one.page.get_by_text("--filter '10 kHz'").first.wait_for()

    def widened():
        name, _, _, change = cost.locator("tbody tr").nth(1).inner_text().split("\t")
        return name == "pulse width at 10 %" and float(change.split()[0]) > 1.0

    one.until(widened, "a pulse of 200 us becomes no wider by 10 kHz")


def test_a_point_of_a_study_opens_its_machine(visit):
    one = visit("/study?case=jesd22-b111-b&study=sweep&vary=machine.height%3D0.2..0.4+m%3A3&keep=first.rigid_peak")
    one.page.get_by_role("button", name="begin, or go on").click()
    one.shows("shown: sweep; all checks passed")
    at = one.page.evaluate(
        "() => getElement(Number(document.querySelector('.sw-chart').id.slice(1))).chart.convertToPixel("
        "{ seriesIndex: 0 }, getElement(Number(document.querySelector('.sw-chart').id.slice(1))).chart.getOption()"
        ".series[0].data[1].slice(0, 2))"
    )
    one.page.locator(".sw-chart canvas").first.click(position={"x": at[0], "y": at[1]})
    one.until(lambda: "machine.height" in urlsplit(one.page.url).query.partition("set=")[2], "nothing opens")
    assert parse_qs(urlsplit(one.page.url).query)["set"] == ["machine.height=0.3 m"]


def test_elements_run_by_a_button_and_are_stopped(visit):
    one = visit("/elements?case=two-bars-fem")
    one.shows("press run")
    one.page.get_by_role("button", name="run", exact=True).click()
    one.shows("under way")
    one.page.get_by_role("button", name="stop").click()
    one.shows("stopped")


def test_bodies_are_turned_cut_and_shown_at_any_instant(visit):
    one = visit("/elements?case=two-bars-fem")
    one.shows("press run")
    one.page.get_by_role("button", name="run", exact=True).click()
    one.shows_full_run()
    canvas = one.page.locator(".sw-view canvas")
    one.page.get_by_text("drag to turn").wait_for()
    seen = [canvas.screenshot()]
    canvas.press("ArrowRight")
    seen.append(canvas.screenshot())
    one.page.get_by_label("time", exact=True).fill("40")
    seen.append(canvas.screenshot())
    one.page.get_by_label("cut across").select_option("z")
    seen.append(canvas.screenshot())
    assert len(set(seen)) == 4  # each shows another picture
