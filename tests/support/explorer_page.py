"""The page of `rwmf explore` in a real browser, with its console and its requests."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from checkout import ROOT

if TYPE_CHECKING:
    from playwright.sync_api import BrowserContext, Locator, Page, Route

FIG12 = ROOT / "inputs" / "fig12_one_sine.nml"
DESK = {"width": 1440, "height": 1000}
PHONE = {"width": 400, "height": 850}
SETTLED = """
async () => {
  const begun = performance.now();
  for (let still = 0; still < 3; still = window.explorer?.running === false ? still + 1 : 0) {
    if (performance.now() - begun > 60000) throw new Error('the page does not come to rest');
    await new Promise((done) => setTimeout(done, 10));
  }
}
"""


def _with_fewer_periods(route: Route) -> None:
    """Spectra of a quarter of the periods: a wall of storeys has them in a third of the time."""
    answer = route.fetch()
    source = answer.text()
    assert "FULL = 200;" in source
    route.fulfill(response=answer, body=source.replace("FULL = 200;", "FULL = 50;"))


class Opened:
    """An open page with its console messages and requests."""

    def __init__(self, context: BrowserContext, address: str) -> None:
        context.route("**/main.js", _with_fewer_periods)
        self.page: Page = context.new_page()
        self.console: list[str] = []
        self.foreign: list[str] = []
        self.page.on("console", lambda message: self._hear(message.type, message.text))
        self.page.on("pageerror", lambda error: self.console.append(str(error)))
        own = address.split("#")[0]
        self.page.on("request", lambda request: self._see(request.url, own))
        self.page.goto(address)
        self.page.locator("#numbers td").first.wait_for()
        self.settle()

    def _hear(self, kind: str, text: str) -> None:
        # the browser logs refusals of the kernel, which are valid answers
        if kind in ("error", "warning") and "422 (" not in text:
            self.console.append(text)

    def _see(self, url: str, own: str) -> None:
        if not url.startswith((own, "data:", "blob:")):
            self.foreign.append(url)

    def settle(self) -> None:
        """Wait until everything is shown."""
        self.page.evaluate(SETTLED)

    def field(self, name: str) -> Locator:
        """Field, list or box of a key."""
        return self.page.locator(f'[id="{name}"]')

    def set(self, name: str, value: object) -> None:
        """Type a value of a key."""
        self.field(name).fill(str(value))
        self.field(name).press("Enter")
        self.settle()

    def choose(self, name: str, value: str) -> None:
        """Choose from the list with an identifier."""
        self.page.select_option(f"#{name}", value)
        self.settle()

    def slider(self, name: str) -> Locator:
        """Slider of a key."""
        return self.page.locator(f'[id="{name}:slider"]')

    def open_all(self) -> None:
        """Open collapsed sections."""
        self.page.evaluate("document.querySelectorAll('details').forEach((x) => { x.open = true })")

    def number(self, key: str) -> str:
        """All digits of a key number."""
        found = self.page.locator(f'[data-key="{key}"]').get_attribute("data-exact")
        assert found is not None
        return found

    @property
    def problem(self) -> str:
        """Return the page's message about its sliders, '' for none."""
        return str(self.page.locator("#problem").text_content())


Open = Callable[..., Opened]
