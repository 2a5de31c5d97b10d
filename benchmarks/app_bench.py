"""The app: from a movement of a slider to the new curve on the screen, in a real browser, beside Streamlit and Dash."""

import contextlib
import os
import shutil
import signal
import socket
import statistics
import subprocess
import sys
import tempfile
import time
import urllib.error
import urllib.request
from pathlib import Path

import peers
from timing import table

from strikewave.web.case_values import titles

MOVES = 100
GOAL = "150 ms"
SHARED = ("li-ma-2019", "jesd22-b111-b")
"""Cases that the peers show too."""
BROWSERS = ("chromium-headless-shell", "chromium", "google-chrome")
PAGES = Path(__file__).parent / "app_peers"
PAUSE = 100
"""Between two movements, ms: the full run of the app begins later, so that none is under way."""
SLIDER = "input[type=range], [role=slider]"
ROOM = """
() => [...document.querySelectorAll('.sw-side input[type=range]')]
  .findIndex((one) => Number(one.max) - Number(one.value) > 12 * Number(one.step))
"""
"""The first slider of a page of the app that can go on to the right: a restitution may stand at its end."""
WATCH = """
() => {
  const frame = () => new Promise(requestAnimationFrame);
  const places = (data) => Array.from({ length: data.count() }, (_, i) => [data.get('x', i), data.get('y', i)]);
  const series = (drawn) => getElement(Number(drawn.id.slice(1))).chart.getModel().getSeries();
  const charts = [...document.querySelectorAll('.sw-chart')];
  const curve = () => charts.length
    ? charts.flatMap((drawn) => series(drawn).map((one) => places(one.getRawData()))).join()
    : document.querySelector('.js-plotly-plot .js-line')?.getAttribute('d');
  const before = curve();
  const pressed = new Promise((now) =>
    addEventListener('keydown', () => now(performance.now()), { once: true, capture: true }));
  window.watched = pressed.then(async (begun) => {
    while ([before, undefined].includes(curve())) {
      await frame();
      if (performance.now() - begun > 20000) throw new Error('nothing is drawn');
    }
    await frame();
    return performance.now() - begun;
  });
}
"""
"""From the press of a key, wait until a diagram has another curve and a frame is drawn. The whole of each curve is
watched: one point of it, such as that behind the end of a pulse, may stay where it is."""


@contextlib.contextmanager
def served(words, address=""):
    """Run a server, and give its address: the one it prints, where none is given, once it answers."""
    with tempfile.TemporaryDirectory() as place:
        quiet = subprocess.PIPE if not address else subprocess.DEVNULL
        server = subprocess.Popen(
            words, cwd=place, stdout=subprocess.DEVNULL, stderr=quiet, text=True, env=os.environ, start_new_session=True
        )
        try:
            address = address or server.stderr.readline().split()[2].rstrip("/")
            for _ in range(1200):
                with contextlib.suppress(urllib.error.URLError, ConnectionError):
                    urllib.request.urlopen(address, timeout=5)
                    break
                time.sleep(0.1)
            yield address
        finally:
            server.send_signal(signal.SIGINT)
            try:
                server.wait(10)
            except subprocess.TimeoutExpired:
                server.kill()
                server.wait()


def free_port():
    """Return a port that is free now."""
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


def moves(page, slider=0):
    """Return the times of the movements, ms; the first, which is not counted, finds all code loaded."""
    page.locator(SLIDER).nth(slider).focus()
    times = []
    for place in range(MOVES + 1):
        page.wait_for_timeout(PAUSE)
        page.evaluate(WATCH)
        page.keyboard.press("ArrowRight" if place % 20 < 10 else "ArrowLeft")
        times.append(page.evaluate("() => window.watched"))
    return times[1:]


def of_app(browser, address, case):
    """Return the times of the app, and the field that was slid."""
    page = browser.new_page()
    page.set_default_timeout(120_000)
    page.goto(f"{address}/?case={case}")
    page.locator(".sw-state", has_text="shown: a full run").wait_for()
    page.wait_for_timeout(500)
    slider = page.evaluate(ROOM)
    field = page.locator(SLIDER).nth(slider).get_attribute("aria-label")
    times = moves(page, slider)
    page.close()
    return times, field


def of_peer(browser, peer, case, field):
    """Return the times of a peer that shows the same."""
    port = free_port()
    page = str(PAGES / f"{peer}_page.py")
    options = ["--server.port", str(port), "--server.headless", "true", "--browser.gatherUsageStats", "false"]
    words = {
        "streamlit": ["-m", "streamlit", "run", page, *options, "--", case, field],
        "dash": [page, case, field, str(port)],
    }[peer]
    with served([sys.executable, *words], f"http://127.0.0.1:{port}") as address:
        page = browser.new_page()
        page.set_default_timeout(120_000)
        page.goto(address)
        page.locator(".js-plotly-plot .js-line").first.wait_for(state="attached")
        page.wait_for_timeout(1000)
        times = moves(page)
        page.close()
    return times


def row(how, case, field, times):
    """Return a row of the table."""
    return [how, case, field, f"{statistics.median(times):.0f} ms", f"{statistics.quantiles(times, n=20)[-1]:.0f} ms"]


def section():
    """Return the section of the page."""
    title = "## The app: slider to plot"
    program = next((found for found in map(shutil.which, BROWSERS) if found), None)
    if program is None:
        return f"{title}\n\nNot measured: there is none of {', '.join(BROWSERS)}."
    try:
        from playwright.sync_api import sync_playwright
    except ImportError:
        return f"{title}\n\nNot measured: playwright is not installed."
    rows, fields, missing = [], {}, []
    with sync_playwright() as play:
        browser = play.chromium.launch(executable_path=program, args=["--no-sandbox"])
        with served([sys.executable, "-m", "strikewave", "app", "--no-browser", "--port", "0"]) as address:
            for case in titles("run"):
                times, fields[case] = of_app(browser, address, case)
                rows.append(row("strikewave app", case, fields[case], times))
        for peer in ("streamlit", "dash"):
            why = peers.absent(peer)
            if why is not None:
                missing.append(f"{peer}: {why}.")
                continue
            name = f"{peer} {peers.version(peer)}"
            rows += [row(name, case, fields[case], of_peer(browser, peer, case, fields[case])) for case in SHARED]
        browser.close()
    text = (
        f"{MOVES} movements of a slider by an arrow key, until a new curve is drawn, for every built-in machine; headless Chromium on the "
        "same cores. The slider is the first that can go on, of the field to which the results owe most. The peers show "
        "the same three diagrams of the same first look, computed in their own process, by Plotly, from a page of ten lines each "
        f"(benchmarks/app_peers). Target: {GOAL}."
    )
    shown = table(["how", "case", "slider", "median", "95th percentile"], rows)
    return "\n\n".join([title, text, shown, *missing])


if __name__ == "__main__":
    print(section())
