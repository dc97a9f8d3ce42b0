"""Commands with their arguments: one table for parsing, help, completion and the page.

This module imports no computation, so that help and error messages appear at once.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

from rwmf.cli import words

GROUPS = {
    "one": "One case",
    "many": "Many cases",
    "risk": "Records and risk",
    "files": "Files of other programs",
}


class Word(NamedTuple):
    """An argument or option.

    Attributes
    ----------
    names : list of str
        The option and its other spellings, or the name of the argument.
    settings : dict
        Further arguments of `argparse.ArgumentParser.add_argument`.
    """

    names: list[str]
    settings: dict[str, Any]


class Command(NamedTuple):
    """A command.

    Attributes
    ----------
    group : str
        Key of `GROUPS`.
    run : str
        Module of this package and function.
    text : str
        Description.
    example : str
        Words of an example after those of the command.
    words : list of Word
        Arguments and options.
    """

    group: str
    run: str
    text: str
    example: str
    words: list[Word]


def _blocks() -> Iterator[list[str]]:
    """Yield the entries of each block of the table below its comments."""
    text = Path(__file__).with_name("commands.table").read_text(encoding="utf-8")
    for block in re.sub(r"\n {6}", " ", text).strip().split("\n\n")[1:]:
        yield [line.strip() for line in block.splitlines()]


_BLOCKS = list(_blocks())
_SHARED = {name: entries for name, *entries in _BLOCKS if name.startswith("@")}


def _words(entries: list[str]) -> Iterator[Word]:
    for entry in entries:
        if entry.startswith("@"):
            yield from _words(_SHARED[entry])
        else:
            yield _word(*(cell.strip() for cell in entry.split("|")))


def _word(called: str, reading: str, text: str) -> Word:
    """Make a word from the cells of its entry."""
    names = called.split()
    settings: dict[str, Any] = {"help": text, "metavar": None, "type": str}
    if len(names) > 1 and not names[-1].startswith("-"):
        metavar = names.pop()
        settings["metavar"] = metavar.rstrip("+?")
        if metavar[-1] in "+?":
            settings["nargs"] = metavar[-1]
    for kind, *parts in map(str.split, filter(None, reading.split(", "))):
        settings |= _setting(kind, parts)
    if settings.get("action") == "store_true":
        del settings["metavar"], settings["type"]
    return Word(names, settings)


def _setting(kind: str, parts: list[str]) -> dict[str, Any]:
    """Return arguments of `add_argument`."""
    match kind:
        case "=":
            # argparse converts a text by the type
            return {"default": [] if parts == ["[]"] else parts[0]}
        case "flag":
            return {"action": "store_true"}
        case "figure":
            further = {"has_data": False} if parts else {}
            return {"type": words.written_file, "action": words.Outputs} | further
        case "parts":
            return {"action": words.Parts, "parts": parts}
        case "required":
            return {"required": True}
        case "choices":
            return {"choices": parts}
        case "action" | "dest":
            return {kind: parts[0]}
        case "whole":
            return {"type": words.whole(*map(int, parts))}
        case "number":
            return {"type": words.number(*map(float, parts))}
    return {"type": str if kind == "str" else getattr(words, kind)}


COMMANDS = {
    name: Command(group, run, text, example, list(_words(entries)))
    for head, *texts in _BLOCKS
    if not head.startswith("@")
    for text, example, *entries in [texts]
    for name, group, run in [(head.partition(":")[0], *head.partition(": ")[2].split())]
}
