"""Looks at a built site: titles, links, pictures, and nothing that a browser would fetch."""

from __future__ import annotations

import re
from pathlib import Path
from urllib.parse import unquote, urlsplit

from lxml import html

_LOADED = "//script/@src | //link/@href | //img/@src | //iframe/@src | //source/@src"
_REMOTE_STYLE = re.compile(r"(?:url\(|@import)\s*['\"]?(?:https?:)?//")


def faults_of(folder: Path) -> list[str]:
    """Find the errors of a site."""
    folder = folder.resolve()
    pages = {
        path: html.fromstring(path.read_bytes(), parser=html.HTMLParser(encoding="utf-8"))
        for path in sorted(folder.rglob("*.html"))
    }
    names = {path: set(page.xpath("//@id | //@name")) for path, page in pages.items()}
    found = []
    for path, page in pages.items():
        where = path.relative_to(folder)
        loads = page.xpath(_LOADED)
        local = [url for url in (*loads, *page.xpath("//a/@href")) if not urlsplit(url).scheme]
        if not page.xpath("//title"):
            found.append(f"{where}: has no title")
        found += [f"{where}: loads {url}" for url in loads if urlsplit(url).netloc]
        found += [f"{where}: {url} leads nowhere" for url in local if not _leads(path, url, names)]
    for path in folder.rglob("*.css"):
        if _REMOTE_STYLE.search(path.read_text(encoding="utf-8")):
            found.append(f"{path.relative_to(folder)}: loads something remote")
    return sorted(set(found))


def _leads(page: Path, url: str, names: dict[Path, set[str]]) -> bool:
    """Tell whether a file of the site, and the place in it, exist."""
    parts = urlsplit(url)
    target = (page.parent / unquote(parts.path)).resolve() if parts.path else page
    if not target.is_file():
        return False
    if not parts.fragment or target.suffix != ".html" or "fortran" in target.parts:
        return True  # FORD links to places in its pages that it does not make
    return unquote(parts.fragment) in names[target]
