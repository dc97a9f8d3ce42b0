"""FORD's pages of the kernel: offline, with every warning and incomplete docstring fatal.

FORD's templates load Bootstrap, MathJax and lunr from content delivery networks. Here they come
from Debian's packages libjs-bootstrap5 and libjs-lunr; no comment has formulas for MathJax.
"""

from __future__ import annotations

import contextlib
import dataclasses
import io
import re
import shutil
import sys
from pathlib import Path

import ford
import ford.fortran_project
import ford.sourceform

from pages.blocks import text_of
from pages.docstrings import faults_of

ROOT = Path(__file__).resolve().parents[2]
_LIBRARIES = Path("/usr/share/javascript")
_MEDIA = {
    "bootstrap.min.css": _LIBRARIES / "bootstrap5" / "css" / "bootstrap.min.css",
    "bootstrap.bundle.min.js": _LIBRARIES / "bootstrap5" / "js" / "bootstrap.bundle.min.js",
    "lunr.js": _LIBRARIES / "lunr" / "lunr.js",
}
_REMOTE = re.compile(
    r"""(?P<head><(?:link|script)\b[^>]*?(?:href|src)=)"https://[^"]*?/(?P<file>[\w.@-]+?)"""
    r"""(?:\?[^"]*)?"(?P<tail>[^>]*>)""",
    re.DOTALL,
)


def build(output: Path, work: Path, version: str) -> list[str]:
    """Build the pages; return warnings and missing items of docstrings."""
    shutil.rmtree(work, ignore_errors=True)
    (work / "media").mkdir(parents=True)
    for name, path in _MEDIA.items():
        shutil.copyfile(path, work / "media" / name)
    _make_templates(work / "templates")
    settings = work / "project.md"
    settings.write_text(
        text_of("ford.md").format(root=ROOT, output=output, work=work, version=version),
        encoding="utf-8",
    )
    ford.sourceform.parse_type = _parse_type
    faults: list[str] = []
    correlate = ford.fortran_project.Project.correlate

    def check(project: ford.fortran_project.Project) -> None:
        faults.extend(faults_of(project))
        correlate(project)

    ford.fortran_project.Project.correlate = check
    printed = io.StringIO()
    ford.console.console.file = printed
    ford.console.console.width = 400
    sys.argv = ["ford", str(settings)]
    with contextlib.redirect_stdout(printed):
        ford.run()
    text = printed.getvalue()
    return faults + re.findall(r"^(?:Warning|Error).*(?:\n[ \t]+.*)*", text, re.MULTILINE)


def _make_templates(folder: Path) -> None:
    """Copy the templates that load remote files, with links to our copies."""
    shutil.copytree(Path(ford.__file__).parent / "templates", folder)
    for path in folder.glob("*.html"):
        text = path.read_text(encoding="utf-8")
        text = re.sub(r"<!-- MathJax -->.*?(?=<!-- Other)", "", text, flags=re.DOTALL)
        path.write_text(_REMOTE.sub(_localize, text), encoding="utf-8")


def _localize(match: re.Match[str]) -> str:
    if match["file"] not in _MEDIA:
        raise SystemExit(f"FORD's templates load {match['file']}, of which there is no copy here")
    tail = re.sub(r"""\s*(?:integrity|crossorigin)="[^"]*\"""", "", match["tail"])
    return f'{match["head"]}"{{{{ project_url }}}}/media/{match["file"]}"{tail}'


_their_parse_type = ford.sourceform.parse_type
_HIDDEN_COMMA = "\N{SINGLE LOW-9 QUOTATION MARK}"


def _parse_type(string: str, *arguments: object) -> ford.sourceform.ParsedType:
    """FORD takes every comma in `character(...)` for one between arguments, nested ones too."""
    found = re.match(r"\s*character\s*\(", string, re.IGNORECASE)
    if not found:
        return _their_parse_type(string, *arguments)
    depth, text = 1, list(string)
    for i in range(found.end(), len(text)):
        depth += {"(": 1, ")": -1}.get(text[i], 0)
        if depth == 0:
            break
        if depth > 1 and text[i] == ",":
            text[i] = _HIDDEN_COMMA
    parsed = _their_parse_type("".join(text), *arguments)
    length = parsed.strlen and parsed.strlen.replace(_HIDDEN_COMMA, ",")
    return dataclasses.replace(parsed, strlen=length)
