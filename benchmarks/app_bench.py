"""The app: from a movement of a slider to the new curve on the screen, in a real browser."""

import os
import shutil
import signal
import statistics
import subprocess
import sys
import tempfile

from timing import table

MOVES = 100
GOAL = "150 ms"
BROWSERS = ("chromium-headless-shell", "chromium", "google-chrome")
MOVE = """
async key => {
  const drawn = document.querySelector('.sw-chart');
  const chart = getElement(Number(drawn.id.slice(1))).chart;
  const shown = () => JSON.stringify(chart.getOption().series[0].data);
  const before = shown();
  const slider = document.querySelector('.sw-side .q-slider__track-container');
  slider.focus();
  const begun = performance.now();
  slider.dispatchEvent(new KeyboardEvent('keydown', { keyCode: key, bubbles: true }));
  while (shown() === before) {
    await new Promise(requestAnimationFrame);
    if (performance.now() - begun > 20000) throw new Error('nothing is drawn');
  }
  await new Promise(requestAnimationFrame);
  return performance.now() - begun;
}
"""
"""Press an arrow key on the first slider, and wait until the first diagram holds another curve and a frame is drawn."""
LEFT, RIGHT = 37, 39


def moved(browser, case):
    """Return the times of the movements, ms."""
    from playwright.sync_api import sync_playwright

    command = [sys.executable, "-m", "strikewave", "app", "--no-browser", "--port", "0"]
    with (
        tempfile.TemporaryDirectory() as place,
        subprocess.Popen(command, cwd=place, stderr=subprocess.PIPE, text=True, env=os.environ) as server,
        sync_playwright() as play,
    ):
        try:
            address = server.stderr.readline().split()[2].rstrip("/")
            page = play.chromium.launch(executable_path=browser, args=["--no-sandbox"]).new_page()
            page.set_default_timeout(120_000)
            page.goto(f"{address}/?case={case}")
            page.locator(".sw-state", has_text="a full run").wait_for()
            page.evaluate(MOVE, RIGHT)
            times = []
            for place_of_move in range(MOVES):
                times.append(page.evaluate(MOVE, RIGHT if place_of_move % 20 < 10 else LEFT))
                page.wait_for_timeout(100)  # the full run begins later, so that none is under way
            return times
        finally:
            server.send_signal(signal.SIGINT)


def section():
    """Return the section of the page."""
    browser = next((found for found in map(shutil.which, BROWSERS) if found), None)
    if browser is None:
        return f"## The app: slider to plot\n\nNot measured: there is none of {', '.join(BROWSERS)}."
    heading = ["case", "median", "95th percentile"]
    rows = []
    for case in ("li-ma-2019", "jesd22-b111-b"):
        times = moved(browser, case)
        rows.append([case, f"{statistics.median(times):.0f} ms", f"{statistics.quantiles(times, n=20)[-1]:.0f} ms"])
    text = f"{MOVES} movements of a slider by an arrow key, until the new curve is drawn; headless Chromium on the same cores."
    return f"## The app: slider to plot\n\n{text} Target: {GOAL}.\n\n{table(heading, rows)}"


if __name__ == "__main__":
    print(section())
