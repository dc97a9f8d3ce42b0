"""Looks at a built site: titles, links, pictures, and nothing that a browser would fetch."""

from __future__ import annotations

import re
from functools import cached_property
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

_FETCHED = {"script": "src", "link": "href", "img": "src", "iframe": "src", "source": "src"}
_REMOTE_STYLE = re.compile(r"(?:url\(|@import)\s*['\"]?(?:https?:)?//")


class Page(HTMLParser):
    """A page with its targets, its links and its loaded files."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.path = path
        self.names: set[str] = set()
        self.links: list[str] = []
        self.loads: list[str] = []
        self.is_called = False
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Take note of a tag."""
        values = dict(attrs)
        self.is_called |= tag == "title"
        self.names.update(filter(None, (values.get("id"), values.get("name"))))
        if tag == "a" and values.get("href"):
            self.links.append(values["href"] or "")
        if values.get(_FETCHED.get(tag, "")):
            self.loads.append(values[_FETCHED[tag]] or "")


class Site:
    """A folder of pages."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    @cached_property
    def pages(self) -> dict[Path, Page]:
        """All pages, by their files."""
        return {path: Page(path) for path in sorted(self.folder.rglob("*.html"))}

    def faults(self) -> list[str]:
        """Find the errors of the page."""
        found = []
        for page in self.pages.values():
            where = page.path.relative_to(self.folder)
            if not page.is_called:
                found.append(f"{where}: has no title")
            found += [f"{where}: loads {url}" for url in page.loads if urlsplit(url).netloc]
            local = [url for url in page.links + page.loads if not urlsplit(url).scheme]
            found += [
                f"{where}: {url} leads nowhere" for url in local if not self._leads(page, url)
            ]
        for path in self.folder.rglob("*.css"):
            if _REMOTE_STYLE.search(path.read_text(encoding="utf-8")):
                found.append(f"{path.relative_to(self.folder)}: loads something remote")
        return sorted(set(found))

    def _leads(self, page: Page, url: str) -> bool:
        parts = urlsplit(url)
        target = page.path
        if parts.path:
            target = (page.path.parent / unquote(parts.path)).resolve()
        if not target.is_file():
            return False
        if not parts.fragment or target.suffix != ".html" or "fortran" in target.parts:
            return True  # FORD links to places in its pages that it does not make
        return unquote(parts.fragment) in self.pages[target].names


def faults_of(folder: Path) -> list[str]:
    """Find the errors of a site."""
    return Site(folder.resolve()).faults()
