"""Commands ``rwmf check`` and ``rwmf new``: contents of a case, and a new one."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

from rwmf.case import Case
from rwmf.case.group import Group
from rwmf.case.json_schema import make_schema
from rwmf.cli.output import print_json, print_written
from rwmf.cli.words import not_negative, number, whole
from rwmf.errors import InputError
from rwmf.kernel import files

# lines of `rwmf check`: word of the kernel's inventory, label, and text for an empty list
_INVENTORY = (
    ("effects", "effects", "none"),
    ("absent", "not simulated", "nothing is left out"),
    ("states", "states", "none"),
    ("events", "events", "none"),
    ("scalars", "outputs", "none"),
    ("columns", "history", "none (&output dt)"),
)


def run_check(options: argparse.Namespace) -> int | None:
    """Validate a case and print its contents, or the schema of all (``rwmf check``)."""
    if options.schema:
        print_json(make_schema())
        return None
    if options.case is None:
        raise InputError("CASE.nml, or --schema: is missing")
    try:
        case = Case.from_namelist(options.case)
    except InputError as error:
        if not options.json:
            raise
        print_json({"valid": False, "error": str(error)})
        return error.exit_status
    found = case.kernel.inventory()
    if options.json:
        inventory = {word: found[word] for word, *_ in _INVENTORY if word in found}
        values = {name: _values_of(group) for name, group in case.groups.items()}
        print_json(
            {
                "valid": True,
                **inventory,
                "notes": found["notes"],
                "warnings": case.kernel.warnings(),
                "values": values,
            }
        )
        return None
    print(f"{options.case}: valid")
    for word, shown, nothing in _INVENTORY:
        print(f"{shown}: {', '.join(found.get(word, [])) or nothing}")
    n = case.kernel.ordinates()
    if n > 0:
        print(f"spectrum: {n} simulations")
    for kind, lines in (("note", found["notes"]), ("warning", case.kernel.warnings())):
        print("".join(f"{kind}: {line}\n" for line in lines), end="")
    print("values, those that the case does not give in parentheses:")
    for name, group in case.groups.items():
        print(f"  {name:8s} {group!r}")
    return None


def _values_of(group: Group) -> dict[str, dict[str, Any]]:
    """Return each key with value and unit, dimensional where a case with a mass has ratios."""
    found: dict[str, dict[str, Any]] = {}
    for key, value in group.items():
        origin = "given" if key in group.given else "default"
        found[key] = {
            "value": list(value) if isinstance(value, tuple) else value,
            "unit": group.units[key],
            "origin": "derived" if key in group.derived else origin,
        }
        if key in group.in_si:
            number, unit = group.in_si[key]
            found[key]["in_si"] = list(number) if isinstance(number, tuple) else number
            found[key]["unit_of_in_si"] = unit
    return found


# option, question, default, and what its answer may be
_QUESTIONS: tuple[tuple[str, str, float, Callable[[str], float]], ...] = (
    ("storeys", "How many storeys?", 6, whole(1, 100)),
    ("mass", "Mass of a floor in kg?", 150e3, number(above=0)),
    ("period", "First period of the frame alone in s?", 1.0, number(above=0)),
    ("width", "Width of the wall in m (0: no wall)?", 4.0, not_negative),
)
_HEIGHT = 3.2
_TEMPLATE = Path(__file__).parent / "building.txt"
# groups of the template that a building without a wall lacks
_OF_WALL = ("&wall", "&bending", "&cable")


def run_new(options: argparse.Namespace) -> None:
    """Write a commented case from four answers (``rwmf new``)."""
    path = Path(options.out)
    if path.exists() and not options.force:
        raise InputError(f"{path}: exists; --force replaces it")
    answers = {
        name: _answer(getattr(options, name), question, default, read)
        for name, question, default, read in _QUESTIONS
    }
    text = _text(**answers)
    Case.from_text(text)
    files.write_bytes(path, text.encode())
    print_written([path])
    print(f"next: rwmf run {path}")


def _answer(
    given: float | None, question: str, default: float, read: Callable[[str], float]
) -> float:
    """Return the value of an option, or ask for it on a terminal."""
    if given is not None:
        return given
    if not sys.stdin.isatty():
        return default
    while True:
        try:
            word = input(f"{question} [{default:g}] ").strip()
            return read(word) if word else default
        except argparse.ArgumentTypeError as error:
            print(error)
        except EOFError:
            return default


def _text(storeys: float, mass: float, period: float, width: float) -> str:
    top = storeys * _HEIGHT
    values: dict[str, float] = {
        "storeys": int(storeys),
        "mass": mass,
        "period": period,
        "width": width,
        "top": top,
    }
    values |= {"h": top / 2, "b": width / 2, "height": _HEIGHT, "pulse": round(1.2 * period, 3)}
    # strands with about half the weight of the wall
    weight = width * 0.3 * top * 2500.0 * 9.81
    values |= {"strands": max(1, round(weight / (2 * 150e-6 * 700e6))), "t_end": 10.0 * period}
    has_wall = width > 0
    links = "'springs' ! struts between floors and wall\n   k_link = 100.0e6 ! N/m"
    blocks = _TEMPLATE.read_text(encoding="utf-8").split("\n\n")
    kept = [block for block in blocks if has_wall or not block.startswith(_OF_WALL)]
    text = "\n\n".join(kept).format(
        beside=" beside a rocking wall" if has_wall else "",
        links=links if has_wall else "'full'",
        **values,
    )
    return "\n".join(_aligned(line) for line in text.splitlines()) + "\n"


def _aligned(line: str) -> str:
    """Put the comment after a value into its column."""
    code, mark, comment = line.partition("!")
    return f"{code.rstrip():30} ! {comment.strip()}" if code and mark else line
