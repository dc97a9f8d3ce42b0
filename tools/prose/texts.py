"""Texts of the repository by kind: docstrings, comments, messages, Fortran comments, pages."""

from __future__ import annotations

import ast
import io
import re
import tokenize
from collections.abc import Iterator
from typing import NamedTuple

__all__ = ["KINDS", "Text", "blank_code", "read_fortran", "read_page", "read_python"]

KINDS = ("docstrings", "comments", "fortran", "messages", "pages", "code")

_CODE = re.compile(r"``[^`]+``|`[^`]+`|\$\$.+?\$\$|\$[^$\n]+\$|https?://\S+", re.DOTALL)
_WORDS = re.compile(r"[^\W\d_]{2,} +[^\W\d_]+ +[^\W\d_]+")
_FENCE = re.compile(r"^\s*(```+|~~~+|:::+)")
_LITERAL = re.compile(r"'((?:[^']|'')*)'|\"((?:[^\"]|\"\")*)\"")
_ABOUT = ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef


class Text(NamedTuple):
    """A docstring, comment, message or piece of a page.

    Attributes
    ----------
    kind : str
        One of `KINDS`.
    line : int
        First line in its file.
    text : str
        The words, without quotes and comment signs.
    is_docstring : bool
        True for a docstring of Python or Fortran.
    """

    kind: str
    line: int
    text: str
    is_docstring: bool = False


def blank_code(text: str) -> str:
    """Replace inline code, formulas and addresses by one letter each.

    Parameters
    ----------
    text : str
        A text.

    Returns
    -------
    str
        The text with its line breaks.
    """
    return _CODE.sub(lambda found: "x" + "\n" * found[0].count("\n"), text)


def read_python(source: str) -> Iterator[Text]:
    """Find docstrings, comments and messages of a Python source.

    Parameters
    ----------
    source : str
        Contents of the file.

    Yields
    ------
    Text
        Docstrings, messages (literals of three words or more) and blocks of comments.
    """
    tree = ast.parse(source)
    known: set[int] = set()
    for node in ast.walk(tree):
        if isinstance(node, _ABOUT) and (text := ast.get_docstring(node)) is not None:
            constant = node.body[0].value  # type: ignore[attr-defined]
            known.add(id(constant))
            yield Text("docstrings", constant.lineno, text, is_docstring=True)
    for node in ast.walk(tree):
        if isinstance(node, ast.JoinedStr):
            known |= {id(part) for part in node.values}
            parts = [part.value if isinstance(part, ast.Constant) else "x" for part in node.values]
            yield from _message(node.lineno, "".join(str(part) for part in parts))
        elif isinstance(node, ast.Constant) and id(node) not in known:
            yield from _message(node.lineno, str(node.value))
    yield from _comments(source)


def _message(line: int, text: str) -> Iterator[Text]:
    if _WORDS.search(text):
        yield Text("messages", line, text)


def _comments(source: str) -> Iterator[Text]:
    """Join comments on whole lines below each other."""
    first, lines, last = 0, [""], -1
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        text = token.string
        if token.type != tokenize.COMMENT or text.startswith(("# noqa", "# type:", "# fmt:", "#!")):
            continue
        is_whole = not token.line[: token.start[1]].strip()
        if not is_whole or token.start[0] != last + 1:
            yield from _comment(first, lines)
            first, lines = token.start[0], []
        lines.append(text.lstrip("# "))
        last = token.start[0] if is_whole else -1
    yield from _comment(first, lines)


def _comment(line: int, lines: list[str]) -> Iterator[Text]:
    if any(lines):
        yield Text("comments", line, "\n".join(lines))


def read_fortran(source: str) -> Iterator[Text]:
    """Find comments and messages of a Fortran source.

    Parameters
    ----------
    source : str
        Contents of the file.

    Yields
    ------
    Text
        Blocks of comments, those with ``!>`` as docstrings, and messages.
    """
    first, mark = 0, ""
    lines: list[str] = []
    for number, line in enumerate([*source.splitlines(), ""], 1):
        code, sign, text = _split_comment(line)
        new = sign if not code else ""
        if lines and new != mark:
            yield Text("fortran", first, "\n".join(lines), is_docstring=mark == "!>")
            lines = []
        if new:
            first, mark = (first if lines else number), new
            lines.append(text)
        elif sign:
            yield Text("fortran", number, text)
        if not line.lstrip().startswith("#"):
            for found in _LITERAL.finditer(code):
                yield from _message(number, found[1] or found[2] or "")


def _split_comment(line: str) -> tuple[str, str, str]:
    """Split a line into code, sign of the comment and comment; `!$` belongs to the code."""
    blanked = _LITERAL.sub(lambda found: " " * len(found[0]), line)
    found = re.search(r"!(?!\$)[>!]?", blanked)
    if found is None:
        return line.strip(), "", ""
    return line[: found.start()].strip(), found[0], line[found.end() :].strip()


def read_page(source: str) -> Iterator[Text]:
    """Find prose and code of a page; tables have neither.

    Parameters
    ----------
    source : str
        Contents of a Markdown file.

    Yields
    ------
    Text
        Pieces of prose and blocks of code.
    """
    kind, first, fence = "pages", 1, ""
    lines: list[str] = []
    for number, line in enumerate(source.splitlines(), 1):
        mark = _FENCE.match(line)
        is_edge = bool(mark) and (not fence or line.strip() == fence)
        if is_edge or (not fence and line.lstrip().startswith("|")):
            yield from _piece(kind, first, lines)
            first, lines = number + 1, []
            if is_edge and mark:
                fence = "" if fence else mark[1]
                kind = "code" if fence and not fence.startswith(":") else "pages"
                # the lines of a directive are prose: only its closing line ends it
                fence = fence if kind == "code" else ""
        else:
            lines.append(line)
    yield from _piece(kind, first, lines)


def _piece(kind: str, first: int, lines: list[str]) -> Iterator[Text]:
    if any(line.strip() for line in lines):
        yield Text(kind, first, "\n".join(lines))
