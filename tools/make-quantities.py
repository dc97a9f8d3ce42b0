#!/usr/bin/env python3
"""Write the module of output quantities from their table.

make-quantities.py TABLE MODULE
"""

import re
import sys
from collections.abc import Iterator
from pathlib import Path

# rows of an array: a statement has at most 255 continuation lines
_MOST = 80
# columns of a line without its margins
_WIDTH = 80


def _literal(text: str) -> str:
    quoted = text.replace("'", "''")
    return f"'{quoted}'"


def _name(key: str) -> str:
    """Return the component of `id` with the number of a quantity."""
    return key.replace("{i}", "i")


def _filled(words: list[str]) -> str:
    """Join words by commas, in lines of limited width."""
    lines = [""]
    for word in words:
        if lines[-1] and len(lines[-1]) + len(word) > _WIDTH:
            lines.append("")
        lines[-1] += f"{word}, "
    return "&\n         ".join(lines).removesuffix(", ")


def _rows(text: str) -> Iterator[tuple[str, str]]:
    """Read the key and the constructor of each quantity."""
    text = re.sub(r"^#.*\n", "", text, flags=re.MULTILINE)
    for row in re.findall(r"^\S.*(?:\n .*)+", text, flags=re.MULTILINE):
        head, body = row.split("\n", 1)
        key, unit, found, outputs, group, observed = re.split(r"[|,]", head)
        meaning, needs, options = [*body.split("|"), "", ""][:3]
        fields = [key, unit, found, outputs, group, observed, needs, meaning]
        components = [f"id%{_name(key)}"]
        components += [_literal(" ".join(field.split())) for field in fields]
        for option in filter(str.strip, options.split(",")):
            name, value = (word.strip() for word in option.split("="))
            number = f"id%{_name(value)}"
            components.append(f"{name}={number if name == 'ratio' else _literal(value)}")
        yield key, f"quantity_t({_filled(components)})"


def main(table: str, module: str) -> None:
    """Write the numbers and the rows of all quantities."""
    rows = dict(_rows(Path(table).read_text(encoding="utf-8")))
    lines = [
        "module rwmf_problem_quantity_rows", "   use rwmf_problem_quantity, only: quantity_t",
        "   implicit none", "   private", "", "   public :: id, all_quantities", "",
        "   type :: ids_t",
        *(f"      integer :: {_name(key)} = {place}" for place, key in enumerate(rows, 1)),
        "   end type ids_t", "", "   type(ids_t), parameter :: id = ids_t()",
    ]  # fmt: skip
    parts = []
    for first in range(0, len(rows), _MOST):
        part = list(rows.values())[first : first + _MOST]
        parts.append(f"part_{first}")
        lines.append(f"   type(quantity_t), parameter :: {parts[-1]}(*) = [ &")
        lines.append("      " + ", &\n      ".join(part) + "]")
    lines.append(f"   type(quantity_t), parameter :: all_quantities(*) = [{', '.join(parts)}]")
    lines += ["", "end module rwmf_problem_quantity_rows", ""]
    Path(module).write_text("\n".join(lines), encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
