"""Rules of style, each a function from a text to the places that break it."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator

from prose.texts import Text, blank_code

__all__ = ["LONGEST_SENTENCE", "RULES", "count_words"]

LONGEST_SENTENCE = 25
_WIDTH, _CODE_WIDTH = 120, 100

_WORD = re.compile(r"[^\W\d_][\w'-]*")
_WHAT = re.compile(r"\bwhat\b", re.IGNORECASE)
_BANNED = re.compile(
    r"\b(whoever|nobody|somebody|stands? for"
    r"|as it stands"
    r"|in the end"
    r"|comes? to"
    r"|what\b[^.;:]{0,40}\b(?:is|are) about"
    r"|of (?:its|their) own"
    r"|to be had"
    r"|company)\b",
    re.IGNORECASE,
)
_QUESTION = re.compile(
    r"\W*(what|whatever|how|does|do|did|may|might|can|could|should|must|has|have|is|are|was|were"
    r"|will|would|whether|which|who|whom|whose|where|when|why|the same)\b",
    re.IGNORECASE,
)
# an abbreviation, or a letter of a name, ends no sentence
_END = re.compile(
    r"(?<!\be\.g)(?<!\bi\.e)(?<!\bEqs)(?<!\bEq)(?<!\bFig)(?<!\bvs)(?<!\b[A-Z])[.?!]\s"
)
# blank lines, items of a list, underlines, names of arguments and changed indentation
_BREAK = re.compile(r"\n\s*\n|\n\s*(?:[-*+]|\d+\.)\s|\n\s*[-=~]{3,}\s*\n|\n(?= *[\w, *]+ : )")

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
    start = 0
    plain = blank_code(text.text)
    ends = [found.start() for found in _BREAK.finditer(plain)]
    ends += [found.start() + 1 for found in _END.finditer(plain)]
    for end in sorted({*ends, len(plain)}):
        sentence = plain[start:end]
        if len(_WORD.findall(sentence)) > LONGEST_SENTENCE:
            blank = len(sentence) - len(sentence.lstrip())
            yield text.line + plain.count("\n", 0, start + blank), " ".join(sentence.split())[:90]
        start = end


RULES: dict[str, Callable[[Text], Found]] = {
    "what": _what,
    "banned": _banned,
    "question": _question,
    "wide": _wide,
    "long": _long,
}
