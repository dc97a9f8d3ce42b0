"""Rules of style, each a function from a text to the places that break it."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator

from prose.texts import Text, blank_code

__all__ = ["LONGEST_SENTENCE", "RULES", "count_words"]

LONGEST_SENTENCE = 25
_WIDTH, _CODE_WIDTH = 120, 100

_WORD = re.compile(r"[^\W\d_][\w'-]*")
# the brackets keep the patterns from finding themselves
_WHAT = re.compile(r"\bwha[t]\b", re.IGNORECASE)
_BANNED = re.compile(
    r"\b(whoeve[r]|nobod[y]|somebod[y]|stands?\s+for"
    r"|as\s+it\s+stands"
    r"|in\s+the\s+end"
    r"|comes?\s+to(?!\s+rest)"
    r"|wha[t]\b[^.;:]{0,40}\b(?:is|are)\s+about"
    r"|of\s+(?:its|their)\s+own"
    r"|to\s+be\s+had"
    r"|compan[y])\b",
    re.IGNORECASE,
)
_QUESTION = re.compile(
    r"\W*(what|whatever|how|does|did|may|might|can|could|should|must|has|is|are|was|were"
    r"|will|would|whether|which|who|whom|whose|where|when|why|the same)\b",
    re.IGNORECASE,
)
# an abbreviation, or a letter of a name, ends no sentence
_END = re.compile(
    r"(?<!\be\.g)(?<!\bi\.e)(?<!\bEqs)(?<!\bEq)(?<!\bFig)(?<!\bvs)(?<!\b[A-Z])[.?!]\s"
)
# an item of a list, an underline, and the line of an argument with its type
_ITEM = re.compile(r"\s*(?:[-*+]|\d+\.)\s+")
_NO_PROSE = re.compile(r"\s*$|\s*[-=~]{3,}|\s*[\w, *]+ : ")

Found = Iterator[tuple[int, str]]


def count_words(text: Text) -> int:
    """Count the words of a text, each piece of code as one.

    Parameters
    ----------
    text : Text
        The text.

    Returns
    -------
    int
        Number of words.
    """
    return len(_WORD.findall(blank_code(text.text)))


def _matches(pattern: re.Pattern[str], text: Text) -> Found:
    plain = blank_code(text.text)
    for found in pattern.finditer(plain):
        line = plain.count("\n", 0, found.start())
        yield text.line + line, plain.splitlines()[line].strip()


def _what(text: Text) -> Found:
    return _matches(_WHAT, text)


def _banned(text: Text) -> Found:
    for line, _ in _matches(_BANNED, text):
        yield line, text.text.splitlines()[line - text.line].strip()


def _question(text: Text) -> Found:
    if text.is_docstring and _QUESTION.match(text.text):
        yield text.line, text.text.strip().splitlines()[0]


def _wide(text: Text) -> Found:
    widths = {"pages": _WIDTH, "code": _CODE_WIDTH}
    for number, line in enumerate(text.text.splitlines()):
        if len(line) > widths.get(text.kind, len(line)):
            yield text.line + number, line[:60] + "..."


def _long(text: Text) -> Found:
    for line, paragraph in _paragraphs(text):
        start = 0
        for end in [found.start() + 1 for found in _END.finditer(paragraph)] + [len(paragraph)]:
            sentence = paragraph[start:end]
            if len(_WORD.findall(sentence)) > LONGEST_SENTENCE:
                first = start + len(sentence) - len(sentence.lstrip())
                yield line + paragraph.count("\n", 0, first), " ".join(sentence.split())[:90]
            start = end


def _paragraphs(text: Text) -> Found:
    """Split a text at blank lines, items of lists and changes of indentation."""
    first, lines, indent = 0, [""], -1
    for number, line in enumerate(blank_code(text.text).splitlines(), text.line):
        item = _ITEM.match(line)
        own = item.end() if item else len(line) - len(line.lstrip())
        if item or own != indent or _NO_PROSE.match(line):
            yield first, "\n".join(lines)
            first, lines = number, []
        if _NO_PROSE.match(line):
            lines, own = [""], -1
        else:
            lines.append(line)
        indent = own
    yield first, "\n".join(lines)


RULES: dict[str, Callable[[Text], Found]] = {
    "what": _what,
    "banned": _banned,
    "question": _question,
    "wide": _wide,
    "long": _long,
}
