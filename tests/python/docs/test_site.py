"""The documentation site: every page opens, every link leads somewhere, nothing is fetched."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from checkout import ROOT

sys.path.append(str(ROOT / "tools"))

from pages import check

SITE = ROOT / "build" / "site"


@pytest.fixture(scope="module")
def site() -> check.Site:
    """Build what has changed since tools/docs; tools/test installs what that needs."""
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
    assert '"tendon"' in (SITE / "searchindex.js").read_text(encoding="utf-8")
    assert "tendon" in (SITE / "fortran/search/search_database.json").read_text(encoding="utf-8")


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
