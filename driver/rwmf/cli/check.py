"""Subcommand ``rwmf check``."""

from __future__ import annotations

import argparse
from typing import Any

from rwmf.case import Case
from rwmf.case.group import Group
from rwmf.case.json_schema import make_schema
from rwmf.cli.output import print_json
from rwmf.errors import InputError

# lines of `rwmf check`: word of the kernel's inventory, label, and text for an empty list
_INVENTORY = (
    ("effects", "effects", "none"),
    ("absent", "not simulated", "nothing is left out"),
    ("states", "states", "none"),
    ("events", "events", "none"),
    ("scalars", "outputs", "none"),
    ("columns", "history", "none (&output dt)"),
)


def run(options: argparse.Namespace) -> int:
    """Validate a case and print its contents, or the schema of all (``rwmf check``)."""
    if options.schema:
        print_json(make_schema())
        return 0
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
        return 0
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
    return 0


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
