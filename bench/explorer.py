"""Latency of the page of `rwmf explore`: from slider to picture, in a real browser.

    .venv/bin/python bench/explorer.py [CASE.nml ...]      (tools/test installs its requirements)

Without a case: Fig. 12, and six storeys that yield, with spectra of displacement and interstorey
drift (IDR). One slider is stepped. Each slider is dragged for two seconds over its whole range. The
times are from the event to the frame with the picture, beside the time of the kernel.
"""

from __future__ import annotations

import shutil
import statistics
import sys
import threading
import time
from pathlib import Path
from typing import Any

from playwright.sync_api import Browser, Page, sync_playwright
from rwmf import Case
from rwmf._explore.presets import case_of_preset
from rwmf._explore.server import PageServer

STEPS = 30
DRAG_SECONDS = 2.0
EVENTS_PER_SECOND = 60

# one slider over its whole range in two seconds. The result is the time from the last event to the
# last picture
DRAG = """
async ({ name, seconds, rate }) => {
  const slider = document.getElementById(name + ':slider');
  const steps = Math.round(seconds * rate);
  const before = slider.value;
  const most = Number(slider.max);
  const set = (x) => {
    slider.value = x;
    slider.dispatchEvent(new Event('input', { bubbles: true }));
  };
  performance.clearMeasures();
  for (let i = 0; i <= steps; i++) {
    set(Math.round(most * i / steps));
    await new Promise((done) => setTimeout(done, 1000 / rate));
  }
  const stopped = performance.now();
  const pictures = performance.getEntriesByName('history').length;
  const first = {};
  const wait = async (name, test) => {
    while (!test() && performance.now() - stopped < 30000)
      await new Promise((done) => setTimeout(done, 5));
    first[name] = performance.now() - stopped;
  };
  const { explorer } = window;
  await wait('history', () => explorer.shown.history === explorer.version);
  const { version } = explorer;
  await wait('spectrum', () => [explorer.coarse, explorer.shown.spectrum].includes(version));
  await wait('full', () => !explorer.running);
  const problem = document.getElementById('problem').textContent;
  set(before);
  return { ...first, pictures, problem };
}
"""
STEP = """
async ({ name, by }) => {
  const slider = document.getElementById(name + ':slider');
  performance.clearMeasures();
  slider.value = Number(slider.value) + by;
  slider.dispatchEvent(new Event('input', { bubbles: true }));
  const last = (name) => performance.getEntriesByName(name).at(-1);
  while (!(last('history') && last('spectrum')?.detail.points === 200))
    await new Promise((done) => setTimeout(done, 2));
  return ['history', 'spectrum'].map((name) => [last(name).duration, last(name).detail.kernel]);
}
"""
SETTLE = """
async () => {
  for (let still = 0; still < 5; still = window.explorer?.running === false ? still + 1 : 0)
    await new Promise((done) => setTimeout(done, 20));
}
"""


def main() -> None:
    """Measure the cases of the command line, or Fig. 12 and six storeys."""
    paths = [Path(word) for word in sys.argv[1:]]
    cases = {str(path): Case.from_namelist(path) for path in paths} or {
        name: case_of_preset(name) for name in ("fig12_one_sine", "six_storeys")
    }
    with sync_playwright() as driver:
        browser = driver.chromium.launch(
            executable_path=shutil.which("chromium"),
            args=["--no-sandbox", "--disable-dev-shm-usage"],
        )
        for name, case in cases.items():
            _measure(browser, name, case)
        browser.close()


def _measure(browser: Browser, name: str, case: Case) -> None:
    server = PageServer(case)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    page = browser.new_page(viewport={"width": 1440, "height": 1000}, reduced_motion="reduce")
    begun = time.perf_counter()
    page.goto(server.address)
    page.locator("#spectrum canvas").wait_for()
    print(f"{name}: first spectrum {1e3 * (time.perf_counter() - begun):.0f} ms after the call")
    # all sliders at hand
    page.evaluate("document.querySelectorAll('details').forEach((box) => { box.open = true; })")
    page.evaluate(SETTLE)
    _print_steps(page, "")
    if case.storeys is not None:
        _print_steps(page, "storey_drift_max")
    _print_drags(page)
    page.close()
    server.shutdown()
    server.end()


def _print_steps(page: Page, quantity: str) -> None:
    if quantity:
        page.select_option("#quantity", quantity)
        page.evaluate(SETTLE)
    name = "frame.T_s" if page.locator('[id="frame.T_s"]').count() else "wall.b"
    found = []
    for i in range(STEPS):
        found.append(page.evaluate(STEP, {"name": name, "by": 1 if i % 2 else -1}))
        page.evaluate(SETTLE)
    shown = page.locator("#quantity").input_value()
    print(f"step of {name}, median of {STEPS} [ms]: to the screen, of it in the kernel; aim")
    for i, (picture, aim) in enumerate((("history", 50), (f"spectrum of {shown}", 100))):
        total, kernel = (statistics.median(row[i][j] for row in found) for j in (0, 1))
        print(f"  {picture:28s} {total:7.1f} {kernel:7.1f}  {aim}")


def _print_drags(page: Page) -> None:
    names: list[str] = page.evaluate(
        "[...document.querySelectorAll('input[type=range]')].map((x) => x.id)"
        ".filter((id) => id.endsWith(':slider')).map((id) => id.slice(0, -7))"
    )
    print("drag of 2 s over the whole range, then ms to: history, a spectrum, that of 200 periods")
    for name in names:
        words: dict[str, Any] = {
            "name": name, "seconds": DRAG_SECONDS, "rate": EVENTS_PER_SECOND
        }  # fmt: skip
        found = page.evaluate(DRAG, words)
        page.evaluate(SETTLE)
        times = " ".join(f"{found[picture]:6.0f}" for picture in ("history", "spectrum", "full"))
        print(f"  {name:26s} {times}  {found['pictures']:3d} pictures  {found['problem'][:60]}")


if __name__ == "__main__":
    main()
