"""Rules of tools/words, each on a small text."""

from __future__ import annotations

import sys

import pytest
from checkout import ROOT

sys.path.append(str(ROOT / "tools"))

from prose import __main__ as command
from prose.limits import LIMITS
from prose.rules import LONGEST_SENTENCE, RULES, count_words
from prose.texts import KINDS, Text, read_fortran, read_page, read_python

LONG = " ".join(["word"] * (LONGEST_SENTENCE + 1)) + "."
SHORT = " ".join(["word"] * LONGEST_SENTENCE) + "."


def _lines(rule: str, text: str, kind: str = "comments", is_docstring: bool = False) -> list[int]:
    return [line for line, _ in RULES[rule](Text(kind, 1, text, is_docstring))]


@pytest.mark.parametrize(
    ("rule", "text", "lines"),
    [
        ("what", "Write\nwhat is there; What else.", [2, 2]),
        ("what", "Write `what` and\n``what``, whatever happens.", []),
        ("banned", "The table\nstands for nobody.", [2, 2]),
        ("banned", "What the text is about.", [1]),
        ("banned", "A module of\nits own.", [1]),
        ("banned", "The block comes to rest, the load\ncomes to 3 N.", [2]),
        ("banned", "A module in the end\nof its own in company.", [1, 2, 2]),
        ("banned", "The accompanying text; `nobody`.", []),
        ("long", f"{SHORT} {SHORT}\n{LONG}", [2]),
        ("long", f"{LONG[:-1]}, e.g. more.", [1]),
        ("long", f"* {SHORT[:-1]}\n* {SHORT[:-1]}", []),
        ("long", f"x : float\n    {SHORT}", []),
        ("long", f"Names with `{LONG}` in them.", []),
    ],
)
def test_rule(rule: str, text: str, lines: list[int]) -> None:
    assert _lines(rule, text) == lines


@pytest.mark.parametrize("word", ["What", "How", "Does", "May", "The same", "Is", "Whether"])
def test_docstring_with_a_question_word(word: str) -> None:
    text = f"{word} a case."
    assert _lines("question", text, "docstrings", is_docstring=True) == [1]
    assert _lines("question", text) == []
    assert _lines("question", "Return whether.", "docstrings", is_docstring=True) == []


def test_width_of_prose_and_code() -> None:
    page = (
        f"{'x' * 120}\n{'x' * 121}\n\n| {'x' * 130} |\n\n```\n{'x' * 101}\n{'x' * 100}\n```\nend\n"
    )
    found = {(text.kind, line) for text in read_page(page) for line, _ in RULES["wide"](text)}
    assert found == {("pages", 2), ("code", 7)}


def test_texts_of_python() -> None:
    source = (
        '"""One module."""\n\nN = 1  # number of\n\n\ndef f(x):\n    """Return it."""\n'
        '    raise ValueError(f"x = {x}: must be a number")\n# first\n# second\n'
    )
    found = [(text.kind, text.line, text.is_docstring) for text in read_python(source)]
    assert sorted(found) == [
        ("comments", 3, False),
        ("comments", 9, False),
        ("docstrings", 1, True),
        ("docstrings", 7, True),
        ("messages", 8, False),
    ]


def test_texts_of_fortran() -> None:
    source = (
        "!> A module.\n!> More of it.\nmodule m\n   integer :: n !! Number of it's rows.\n"
        "   !$ call f()\n   call fail('no rows ! in the table')\n   ! why\nend module m\n"
    )
    found = [(text.kind, text.line, text.is_docstring, text.text) for text in read_fortran(source)]
    assert found == [
        ("fortran", 1, True, "A module.\nMore of it."),
        ("fortran", 4, False, "Number of it's rows."),
        ("messages", 6, False, "no rows ! in the table"),
        ("fortran", 7, False, "why"),
    ]


def test_code_counts_as_one_word() -> None:
    assert count_words(Text("pages", 1, "Call `rwmf run CASE.nml` now: $a + b$")) == 4


def test_limits_cover_all_kinds_and_rules() -> None:
    assert set(LIMITS) == set(KINDS)
    assert all(set(row) == set(RULES) for row in LIMITS.values())


def test_command_fails_above_a_limit(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    row = {"words": 1000, "what": 1, "banned": 0, "question": 1, "wide": 0, "long": 0}
    counts = {("driver", "docstrings"): row}
    monkeypatch.setattr(command, "LIMITS", {kind: dict.fromkeys(RULES, 1e9) for kind in KINDS})
    assert command._compare(counts) == 0
    command.LIMITS["docstrings"]["question"] = 0
    assert command._compare(counts) == 1
    assert "docstrings: question 1, limit 0" in capsys.readouterr().out
