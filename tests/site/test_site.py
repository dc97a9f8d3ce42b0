"""The site that tools/docs has built, in a browser: pages, searches and the read-only explorer."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING
from urllib.parse import quote

import pytest
import rwmf
from checkout import ROOT
from explorer_page import DESK, Opened
from rwmf.explorer.questions import case_of_preset

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page, Request


SITE = ROOT / "build" / "site"


def test_searches_find_a_tendon() -> None:
    assert "tendon" in (SITE / "_static" / "sections.js").read_text(encoding="utf-8")
    assert "tendon" in (SITE / "fortran/search/search_database.json").read_text(encoding="utf-8")


@pytest.fixture
def page(browser: Browser) -> Iterator[Page]:
    """Open a page without network; console messages and requests fail the test."""
    context = browser.new_context(offline=True)
    page = context.new_page()
    said: list[str] = []

    def take_note(request: Request) -> None:
        if not request.url.startswith(("file:", "data:")):
            said.append(f"{page.url}: asks for {request.url}")

    page.on("console", lambda message: said.append(f"{page.url}: {message.text}"))
    page.on("pageerror", lambda error: said.append(f"{page.url}: {error}"))
    page.on("request", take_note)
    yield page
    context.close()
    assert not said


def test_pages_open_in_a_browser(page: Page) -> None:
    """Every page by Sphinx, and one of each kind by FORD, whose pages are made by few templates."""
    pages = sorted(SITE.rglob("*.html"))
    fortran = SITE / "fortran"
    by_sphinx = [path for path in pages if fortran not in path.parents]
    kinds = {path.parent: path for path in pages if fortran in path.parents}
    assert len(by_sphinx) > 40
    assert len(kinds) > 5
    for path in (*by_sphinx, *kinds.values()):
        page.goto(path.as_uri(), wait_until="load")
        assert "rwmf" in page.locator("body").inner_text(), path


def test_a_reader_finds_a_word(page: Page) -> None:
    """By the field beside the text, and in the pages of the kernel."""
    page.goto((SITE / "index.html").as_uri())
    field = page.get_by_placeholder("Search").first
    field.fill("tendon")
    field.press("Enter")
    found = page.locator("#search-results li a")
    found.filter(has_text="Effects").first.click()
    page.get_by_role("heading", name="Effects", exact=False, level=1).wait_for()
    page.goto((SITE / "fortran" / "search.html").as_uri() + "?q=tendon")
    page.get_by_text("proc/tendon_group.html").first.wait_for()


QUESTIONS = {
    **dict.fromkeys(
        ("install", "Windows", "conda", "pip", "cite", "docker"), ("howto/install.html", "install")
    ),
    "API": ("reference/python.html", "public name"),
    "CSV": ("howto/sweeps.html#many-files-one-table", "csv"),
    "damping": ("theory/bending.html#damping", "damping"),
    "hazard": ("tutorials/retrofit-to-risk.html#annual-frequency", "hazard"),
    "many cases into one table": ("howto/sweeps.html#many-files-one-table", "table"),
    "Figure 13": ("validation/claims.html#figures", "figure"),
    "full screen for a lecture": ("howto/explore.html", "full screen"),
    "two walls": ("tutorials/two-walls.html", "walls"),
    "IDR": ("howto/buildings.html", "drift"),
    "PFA": ("howto/buildings.html", "acceleration"),
    "interstorey drift": ("howto/buildings.html", "drift"),
    "interstory": ("howto/buildings.html", "drift"),
    "tendon": ("howto/units.html", "tendon"),
    "uplift": ("tutorials/wall-and-frame.html", "lift"),
    "fragility": ("howto/studies.html#fragility", "limit"),
    "peak floor acceleration of storey 3": ("howto/buildings.html", "acceleration"),
    "how much prestress do I lose": ("howto/units.html#how-much-prestress", "prestress"),
    "compare two walls": ("howto/buildings.html#compare-two-walls", "walls"),
    "my record is in cm/s2": ("howto/units.html#a-record", "cm/s"),
    "toe crushing": ("howto/checks.html", "toe"),
    "demand capacity ratio": ("howto/checks.html", "limit"),
    "pushover": ("howto/pushover.html", "base shear"),
    "capacity curve": ("howto/pushover.html", "base shear"),
    "UFP": ("howto/checks.html", "plate"),
    "will the wall slide": ("howto/studies.html#required-friction", "friction"),
    "residual drift of the roof": ("reference/outputs.html", "residual"),
    "residual drift": ("reference/outputs.html", "residual"),
    "is my wall going to slide": ("howto/studies.html#required-friction", "friction"),
    "how do I link it with CMake": ("howto/embedding.html", "cmake"),
    "what is gamma": ("reference/glossary.html", "mass ratio"),
    "fragility curve": ("howto/studies.html#fragility", "fragility"),
    "which numbers can I trust": ("howto/design-numbers.html", "trust"),
    "base shear in kN": ("reference/outputs.html", "base shear"),
    "tendon stress in MPa": ("howto/units.html", "stress"),
    "theta_max_over_alpha": ("reference/outputs.html", "theta_max_over_alpha"),
    "k_link": ("reference/namelist.html", "k_link"),
    "rtol": ("reference/namelist.html", "tolerance"),
    "p-delta": ("theory/storeys.html", "leans"),
    "vertical ground motion": ("reference/effects.html", "vertical"),
    "optimise the tendon": ("howto/design.html", "strands"),
    "moment in the wall": ("tutorials/six-storeys.html#forces-in-the-wall", "moment"),
    "which tolerance": ("tutorials/method.html", "tolerance"),
    "run on a cluster": ("howto/sweeps.html", "cluster"),
    "convert Steel01": ("howto/opensees.html", "Steel01"),
    "use it in Simulink": ("howto/fmu.html", "co-simulation"),
    "does the building collapse": ("tutorials/six-storeys.html", "collapse"),
    "make a film": ("howto/buildings.html#film-it", "film"),
}


def test_a_question_finds_its_page(page: Page) -> None:
    """Among the first five results, with an excerpt that shows the word."""
    for query, (address, word) in QUESTIONS.items():
        page.goto(f"{(SITE / 'search.html').as_uri()}?q={quote(query)}")
        results = page.locator("#search-results li").all()[:5]
        links = [result.locator("a").get_attribute("href") or "" for result in results]
        assert any(link.startswith(address) for link in links), (query, links)
        assert not any(link.startswith("developer/") for link in links[:3]), (query, links)
        shown = [result.locator("p").inner_text().lower() for result in results]
        assert any(word.lower() in text for text in shown), (query, shown)


def test_a_search_without_result_says_so(page: Page) -> None:
    page.goto((SITE / "search.html").as_uri() + "?q=zyzzyva")
    page.get_by_text("Nothing found").wait_for()


def test_the_explorer_shows_three_cases_from_files(browser: Browser) -> None:
    copy = SITE / "explorer"
    context = browser.new_context(viewport=DESK, reduced_motion="reduce", offline=True)
    opened = Opened(context, (copy / "index.html").as_uri())
    # a page of files may load its own folder only
    own = copy.as_uri()
    assert [url for url in opened.foreign if not url.startswith(own)] == []
    for name, key in (
        ("", "storey_drift_max"),
        ("wall_and_frame", "u_s_max_m"),
        ("block", "theta_max_over_alpha"),
    ):
        opened.page.select_option("#preset", name)
        opened.settle()
        opened.page.wait_for_timeout(400)
        assert opened.problem == ""
        case = case_of_preset(name or "six_storeys")
        run = rwmf.simulate(case.replace(output={"reactions": True}))
        assert opened.number(key) == repr(float(run[key.removesuffix("_m")]))
        assert opened.page.locator("#sentence").text_content() != ""
        assert opened.page.locator("#u_s canvas").count() == (name != "block")
    # comparison and history work, it has no sliders
    opened.page.locator("#undo").click()
    opened.page.wait_for_timeout(200)
    opened.settle()
    assert opened.page.locator("#preset").input_value() == "wall_and_frame"
    opened.page.locator("#pin").click()
    opened.page.select_option("#preset", "")
    opened.settle()
    assert opened.page.evaluate("explorer.stage.ghost !== null")
    assert not opened.page.locator("#groups").is_visible()
    assert not opened.page.locator("#upload").is_visible()
    assert opened.page.locator("#stage").get_attribute("role") == "img"
    assert not opened.page.locator("#measure").is_visible()
    assert opened.console == []
    context.close()
