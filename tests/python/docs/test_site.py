"""The documentation site: every page opens, every link leads somewhere, nothing is fetched."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import quote

import pytest
from checkout import ROOT

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page, Request

sys.path.append(str(ROOT / "tools"))

from pages import check

SITE = ROOT / "build" / "site"


@pytest.fixture(scope="module")
def site() -> check.Site:
    """Build the changed pages; tools/test installs the requirements."""
    done = subprocess.run(
        [sys.executable, "-m", "pages"],
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": str(ROOT / "tools")},
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return check.Site(SITE)


def test_no_page_is_at_fault(site: check.Site) -> None:
    assert not site.faults()


def test_every_source_is_a_page(site: check.Site) -> None:
    sources = {path.relative_to(ROOT / "docs") for path in (ROOT / "docs").rglob("*.md")}
    assert {path.with_suffix(".html") for path in sources} <= {
        path.relative_to(SITE) for path in site.pages
    }


@pytest.mark.usefixtures("site")
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


@pytest.mark.slow
def test_pages_open_in_a_browser(site: check.Site, page: Page) -> None:
    """Every page by Sphinx, and one of each kind by FORD, whose pages are made by few templates."""
    fortran = SITE / "fortran"
    by_sphinx = [path for path in site.pages if fortran not in path.parents]
    kinds = {path.parent: path for path in site.pages if fortran in path.parents}
    assert len(by_sphinx) > 40
    assert len(kinds) > 5
    for path in (*by_sphinx, *kinds.values()):
        page.goto(path.as_uri(), wait_until="load")
        assert "rwmf" in page.locator("body").inner_text(), path


@pytest.mark.usefixtures("site")
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


@pytest.mark.usefixtures("site")
@pytest.mark.parametrize(("query", "answer"), QUESTIONS.items())
def test_a_question_finds_its_page(query: str, answer: tuple[str, str], page: Page) -> None:
    """Among the first five results, with an excerpt that shows the word."""
    address, word = answer
    page.goto(f"{(SITE / 'search.html').as_uri()}?q={quote(query)}")
    results = page.locator("#search-results li").all()[:5]
    links = [result.locator("a").get_attribute("href") or "" for result in results]
    assert any(link.startswith(address) for link in links), links
    shown = [result.locator("p").inner_text().lower() for result in results]
    assert any(word.lower() in text for text in shown), shown


@pytest.mark.usefixtures("site")
def test_a_search_without_result_says_so(page: Page) -> None:
    page.goto((SITE / "search.html").as_uri() + "?q=zyzzyva")
    page.get_by_text("Nothing found").wait_for()


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("<title>a</title><a href='other.html'>b</a>", "other.html leads nowhere"),
        ("<title>a</title><a href='#below'>b</a>", "#below leads nowhere"),
        ("<title>a</title><script src='https://host/x.js'></script>", "loads https://host/x.js"),
        ("<title>a</title><img src='//host/x.png'>", "loads //host/x.png"),
        ("<p>a</p>", "has no title"),
    ],
)
def test_a_fault_is_found(text: str, fault: str, tmp_path: Path) -> None:
    (tmp_path / "page.html").write_text(text, encoding="utf-8")
    assert any(fault in line for line in check.faults_of(tmp_path))


def test_a_remote_font_is_found(tmp_path: Path) -> None:
    (tmp_path / "page.css").write_text("@import 'https://host/font.css';", encoding="utf-8")
    assert check.faults_of(tmp_path) == ["page.css: loads something remote"]
