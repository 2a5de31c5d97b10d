"""A server of the app in a process of its own, and a real browser on it."""

import contextlib
import os
import re
import signal
import subprocess
import sys
import time

import pytest

from ..chromium import chromium

SOFTWARE_GL = "--enable-unsafe-swiftshader"
"""Three dimensions drawn by the processor: a test machine has no card for them."""
PATIENCE = 90.0
"""Longest time that a page waits for a run while other tests take both cores, s."""


@contextlib.contextmanager
def serving(place, *options):
    """Yield the address of an app that runs in an empty folder, as it prints it."""
    command = [sys.executable, "-m", "strikewave", "app", "--no-browser", "--port", "0", *options]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    server = subprocess.Popen(command, cwd=place, stderr=subprocess.PIPE, text=True, env=environment)
    try:
        line = next((line for line in server.stderr if line.startswith("strikewave app: ")), "")
        assert "http://127.0.0.1:" in line, line
        yield line.split()[2].rstrip("/")
        assert server.poll() is None, "the server ended"
    finally:
        server.send_signal(signal.SIGINT)
        server.wait(30)
    assert os.listdir(place) == []  # nothing is left where it was started


@pytest.fixture(scope="session")
def app_address(tmp_path_factory):
    """Return the address of the app that the tests share."""
    with serving(tmp_path_factory.mktemp("app")) as address:
        yield address


@pytest.fixture
def crowded_address(tmp_path):
    """Return the address of an app of one test alone, which fills it."""
    with serving(tmp_path) as address:
        yield address


@pytest.fixture(scope="session")
def browser():
    """Return the system's own Chromium, driven by playwright, which downloads nothing."""
    program = chromium()
    sync_api = pytest.importorskip("playwright.sync_api")
    with sync_api.sync_playwright() as play:
        opened = play.chromium.launch(executable_path=program, args=["--no-sandbox", SOFTWARE_GL])
        yield opened
        opened.close()


class Visitor:
    """A person with a browser of its own: what it sees is watched for errors, and for requests to other hosts."""

    def __init__(self, browser, address, width=1280, height=720):
        self.context = browser.new_context(
            viewport={"width": width, "height": height}, accept_downloads=True, base_url=address
        )
        self.page = self.context.new_page()
        self.page.set_default_timeout(1000.0 * PATIENCE)
        self.faults, self.foreign = [], []
        self.page.on("console", lambda said: self.faults.append(said.text) if said.type == "error" else None)
        self.page.on("pageerror", lambda error: self.faults.append(str(error)))
        self.page.on("request", lambda sent: self._note(sent.url, address))

    def _note(self, url, address):
        if not url.startswith((address, "data:", "blob:")):
            self.foreign.append(url)

    def open(self, place):
        self.page.goto(place)
        return self.page

    def shows(self, text):
        """Wait until the page says that it shows this."""
        self.page.locator(".sw-state", has_text=text).wait_for()

    def shows_full_run(self):
        """Wait until the page shows a full run; no check of it failed."""
        state = self.page.locator(".sw-state", has_text="a full run; ").inner_text()  # waits: it may soon be another
        assert re.fullmatch(r"shown: a full run; (all checks passed|[1-9]\d* warnings?)", state), state

    def options(self, place=0):
        """Return what a diagram draws, as ECharts holds it."""
        return self.page.evaluate(
            "place => { const drawn = document.querySelectorAll('.sw-chart')[place];"
            " return getElement(Number(drawn.id.slice(1))).chart.getOption(); }",
            place,
        )

    def number(self, name):
        """Return the text of a key number."""
        return self.page.locator(".sw-card", has_text=name).locator("dd").inner_text()

    def until(self, found, what):
        """Wait until something holds."""
        end = time.monotonic() + PATIENCE
        while not found():
            assert time.monotonic() < end, what
            self.page.wait_for_timeout(50)

    def leave(self):
        self.context.close()
        assert self.faults == []
        assert self.foreign == []


@pytest.fixture
def visit(browser, app_address):
    """Return what opens a page for one more person; none of their pages had an error or asked another host."""
    there = []

    def opened(place, width=1280):
        there.append(Visitor(browser, app_address, width))
        there[-1].open(place)
        return there[-1]

    yield opened
    for one in there:
        one.leave()
