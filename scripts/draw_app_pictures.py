"""The pictures of the app in docs/app.md: each page at the width of a desk and of a telephone, by a Chromium.

Needs the extra `app`, playwright (of the extra `dev`) and a Chromium. Run it by `make pictures`.
"""

import argparse
import lzma
import os
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

from draw_pictures import BLOWS, BROWSERS, IMAGES, found_browser, make_small
from playwright.sync_api import Page, sync_playwright

WIDTHS = {"": (1280, 720), "-narrow": (390, 844)}
"""Ending of the name of a picture, and width and height of the screen in pixels."""
SOFTWARE_GL = "--enable-unsafe-swiftshader"
"""Three dimensions drawn by the processor."""
COLOURS = 128
"""Of a picture: text, lines and a few curves."""
PATIENCE = 300_000.0
"""Longest time of a run, ms."""
SWEEP = "vary=machine.height%3D0.1..0.5+m%3A9&keep=first.rigid_peak"


def drop(page: Page) -> None:
    """Drop shocks of a circuit board, the first two taken before the sensor had settled."""
    with tempfile.TemporaryDirectory() as folder:
        paths = []
        for packed in sorted(BLOWS.glob("impact_0*.xz"))[:5]:
            paths.append(Path(folder) / packed.stem)
            paths[-1].write_bytes(lzma.decompress(packed.read_bytes()))
        page.locator("input[type=file]").set_input_files(paths)
        page.get_by_text(f"{len(paths)} files", exact=True).wait_for()


def press(name: str):
    """Return what presses a button."""
    return lambda page: page.get_by_role("button", name=name, exact=True).click()


PAGES = {
    "app-machine": ("/", None, "a full run"),
    "app-target": ("/target", None, "a full run"),
    "app-record": ("/record?unit=g&channel=1", drop, "read and judged"),
    "app-study": (f"/study?case=jesd22-b111-b&study=sweep&{SWEEP}", press("begin, or go on"), "sweep"),
    "app-elements": ("/elements?case=two-bars-fem", press("run"), "a full run"),
}
"""Address of each page, what is done there, and what it then says."""


def main() -> None:
    """Draw all of them, or those that are named."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", choices=[[], *PAGES])
    names = parser.parse_args().names or list(PAGES)
    browser = found_browser()
    if browser is None:
        print(f"the pictures of the app stay as they are: there is none of {', '.join(BROWSERS)}")
        return
    command = [sys.executable, "-m", "strikewave", "app", "--no-browser", "--port", "0"]
    with (
        tempfile.TemporaryDirectory() as place,
        subprocess.Popen(command, cwd=place, stderr=subprocess.PIPE, text=True, env=os.environ) as server,
        sync_playwright() as play,
    ):
        address = server.stderr.readline().split()[2].rstrip("/")
        chromium = play.chromium.launch(executable_path=browser, args=["--no-sandbox", SOFTWARE_GL])
        for name in names:
            draw(chromium.new_context(), address, name)
        chromium.close()
        server.send_signal(signal.SIGINT)


def draw(context, address: str, name: str) -> None:
    """Write the pictures of a page."""
    where, do, says = PAGES[name]
    page = context.new_page()
    page.set_default_timeout(PATIENCE)
    page.set_viewport_size(dict(zip(("width", "height"), WIDTHS[""], strict=True)))
    page.goto(address + where)
    state = page.locator(".sw-state")
    state.first.wait_for(state="attached")
    if do is not None:
        do(page)
    page.locator(".sw-state", has_text=f"shown: {says}").or_(page.locator(".sw-state", has_text=says)).first.wait_for()
    page.wait_for_function("() => !document.querySelector('.sw-state').innerText.includes('under way')")
    if name == "app-elements":
        page.get_by_text("drag to turn").wait_for()
    for ending, (width, height) in WIDTHS.items():
        page.set_viewport_size({"width": width, "height": height})
        page.evaluate("() => { document.activeElement?.blur(); window.scrollTo(0, 0); }")
        page.wait_for_timeout(1000)
        place = IMAGES / f"{name}{ending}.png"
        page.screenshot(path=place)
        make_small(place, COLOURS)
    context.close()


if __name__ == "__main__":
    main()
