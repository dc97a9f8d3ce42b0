"""Requests of the page, converted to a case, and the example cases of the page."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

from rwmf.case import Case
from rwmf.explorer.controls import editable

_MOST_POINTS = 2000
_WORD = re.compile(r"\w{1,60}", re.ASCII)
_NUMBER = re.compile(r"([0-9]{1,9})?", re.ASCII)


class BadQuestionError(ValueError):
    """The request is malformed."""


class Question(NamedTuple):
    """A request of the page.

    Attributes
    ----------
    groups : dict
        Keys and values of each group.
    record : str
        Number of an uploaded record, '' for the record of the case.
    points : int
        Number of periods of the spectrum.
    quantity : str
        Key of the spectrum's quantity, '' for the default of the scene.
    quick : bool
        Leave out periods that need many steps.
    """

    groups: dict[str, dict[str, Any]]
    record: str
    points: int
    quantity: str
    quick: bool = False


def given(case: Case) -> dict[str, dict[str, Any]]:
    """List the given values of a case, in the form in which the page returns them."""
    pairs = editable()
    return {
        name: {
            key: list(value) if isinstance(value := group[key], tuple) else value
            for key in group
            if key in group.given and (name, key) in pairs
        }
        for name, group in case.groups.items()
    }


def read(body: object) -> Question:
    """Validate a request."""
    if not isinstance(body, dict):
        raise BadQuestionError("a request must be an object")
    unknown = body.keys() - {"groups", "record", "points", "quantity", "quick"}
    if unknown:
        raise BadQuestionError(f"a request has no key {min(map(str, unknown))!r}")
    groups = body.get("groups")
    if not isinstance(groups, dict):
        raise BadQuestionError("a request must have groups")
    pairs = editable()
    known = {group for group, _ in pairs}
    for name, keys in groups.items():
        if name not in known or not isinstance(keys, dict):
            raise BadQuestionError(f"{name[:40]!r} is no group, or has no keys")
        for key in keys:
            if (name, key) not in pairs:
                raise BadQuestionError(f"&{name} has no key {key[:40]!r} that the page may set")
    record, points = body.get("record", ""), body.get("points", 200)
    quantity, quick = body.get("quantity", ""), body.get("quick", False)
    if not isinstance(record, str) or not isinstance(quantity, str):
        raise BadQuestionError("record and quantity are texts")
    if not isinstance(quick, bool):
        raise BadQuestionError("quick: must be true or false")
    if not _NUMBER.fullmatch(record):
        raise BadQuestionError("record is the number of an uploaded record")
    if type(points) is not int or not 2 <= points <= _MOST_POINTS:
        raise BadQuestionError(f"points: must be a whole number in [2, {_MOST_POINTS}]")
    values = {
        name: {key: _typed(f"{name}.{key}", keys[key], *pairs[name, key]) for key in keys}
        for name, keys in groups.items()
    }
    return Question(values, record, points, quantity, quick)


def _typed(name: str, value: object, kind: str, words: tuple[str, ...]) -> Any:  # noqa: ANN401
    """Convert a value to the type of its key."""
    if kind == "real" or (kind == "reals" and not isinstance(value, list)):
        return _real(name, value)
    if kind == "integer" or (kind == "integers" and not isinstance(value, list)):
        number = _real(name, value)
        if number != math.floor(number) or abs(number) >= 2**31:
            raise BadQuestionError(f"{name}: must be a whole number")
        return int(number)
    single = {
        "logical": (isinstance(value, bool), "true or false"),
        "choice": (value in words, f"one of {', '.join(words)}"),
        "text": (isinstance(value, str) and _WORD.fullmatch(value) is not None, "a word"),
    }
    if kind in single:
        is_good, wanted = single[kind]
        if not is_good:
            raise BadQuestionError(f"{name}: must be {wanted}")
        return value
    if not isinstance(value, list) or not value:
        raise BadQuestionError(f"{name}: must be a list")
    if kind in ("reals", "real list"):
        return [_real(name, item) for item in value]
    if not all(isinstance(item, str) and _WORD.fullmatch(item) for item in value):
        raise BadQuestionError(f"{name}: must be words")
    return value


def _real(name: str, value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise BadQuestionError(f"{name}: must be a number")
    try:
        number = float(value)
    except OverflowError:
        number = math.inf
    if not math.isfinite(number):
        raise BadQuestionError(f"{name}: must be a finite number")
    return number


def case_of(question: Question, base: Case) -> Case:
    """Make the case of a request."""
    changes: dict[str, Mapping[str, object] | None] = {}
    before = given(base)
    for name in before.keys() - question.groups.keys():
        changes[name] = None
    for name, keys in question.groups.items():
        old = before.get(name, {})
        new: dict[str, object] = dict.fromkeys(old.keys() - keys.keys())
        new |= {key: value for key, value in keys.items() if key not in old or old[key] != value}
        # the page must not set the name of a record's file, but may omit it
        has_file = name in base.groups and bool(base.groups[name].get("file"))
        names_file = keys.get("kind") == "record" if name == "motion" else "ratio" not in keys
        if has_file and not names_file:
            new["file"] = None
        if new or name not in before:
            changes[name] = new
    return base.replace(**changes) if changes else base


_FOLDER = Path(__file__).parent / "presets"


class Preset(NamedTuple):
    """An example case.

    Attributes
    ----------
    name : str
        File of the case without ``.nml``.
    title : str
        Title in the list.
    sentence : str
        Content of the case.
    """

    name: str
    title: str
    sentence: str


PRESETS = (
    Preset(
        "block",
        "Rocking block",
        "A free-standing block rocks under a pulse of 0.35 g; one of 0.40 g overturns it.",
    ),
    Preset(
        "wall_and_frame",
        "Wall and frame",
        "A tendon pulls a wall of 4 m back to its base, and the frame of one storey sways with it.",
    ),
    Preset(
        "six_storeys",
        "Six storeys",
        "Six storeys in kg and N yield beside a bending wall with twelve strands and two fuses.",
    ),
    Preset(
        "fig12_one_sine",
        "The paper's case",
        "Fig. 12 (a) of the paper: its equation as printed, and a forward pulse of 0.4 g.",
    ),
)
# case of `rwmf explore` without a file
FIRST = PRESETS[-1]


@cache
def case_of_preset(name: str) -> Case:
    """Read the case of a preset."""
    text = (_FOLDER / f"{name}.nml").read_text(encoding="utf-8")
    return Case.from_text(text, f"{name}.nml")
