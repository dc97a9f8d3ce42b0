"""Required items of Fortran docstrings, from FORD's reading of the sources.

A public procedure or type has a docstring. Each argument that is a number, text or logical has a
`!!` below its declaration. Reals, including components of types, give a unit in brackets.
Otherwise they state that they are a state, part or number of something, a sign or a flag. The type
explains arguments of a derived type. A module whose docstring declares "in the caller's units"
needs no further units. For an argument `error`, docstring or `!!` give the conditions.
include/rwmf.h explains the procedures for C, the Python package those for f2py.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ford.fortran_project import Project
    from ford.sourceform import FortranBase, FortranVariable

# a unit; or a vector of mixed units (states, rates, coefficients, units of a table or the caller);
# or a sign, or the numeric form of a logical in loops over lanes: 1 for true, 0 for false
_UNIT = re.compile(
    r"\[[^\]]*\]|\((\w+ )*(states?|rates?|coefficients?)\b"
    r"|\b(states?|unit|units|coefficients|constants)\b|(^|\s)[+-]?1 (where|or -1)\b",
    re.IGNORECASE,
)
_WHEN = re.compile(
    r"\b(fail|fails|failed|failure|error|errors|err_\w+|refuse[sd]?|wrong|cannot)\b", re.IGNORECASE
)


def faults_of(project: Project) -> Iterator[str]:
    """Yield the missing items."""
    for module in project.modules:
        if module.name.startswith("rwmf_bindings_python"):
            continue
        needs_unit = "in the caller's units" not in _doc(module)
        for item in (*module.functions, *module.subroutines, *module.types):
            if item.permission != "public":
                continue
            faults = [] if _doc(item) else ["no docstring"]
            if item.obj == "type":
                has_units = not needs_unit or "[" in _doc(item)
                faults += [
                    f"component {one.name} has no unit"
                    for one in item.variables
                    if one.vartype == "real" and not has_units and not _UNIT.search(_doc(one))
                ]
            else:
                faults += [x for one in item.args for x in _of_argument(one, item, needs_unit)]
            yield from (f"{module.filename}: {item.name}: {fault}" for fault in faults)


def _of_argument(one: FortranVariable, of: FortranBase, needs_unit: bool) -> Iterator[str]:
    kind = getattr(one, "vartype", "procedure")
    if kind == "real" and needs_unit and not _UNIT.search(_doc(one)):
        yield f"argument {one.name} has no unit"
    elif kind in ("integer", "logical", "character") and not _doc(one):
        yield f"argument {one.name} is not explained"
    elif one.name.lower() == "error" and not _doc(one) and not _WHEN.search(_doc(of)):
        yield "argument error does not say when it is set"


def _doc(item: FortranBase) -> str:
    return " ".join(" ".join(item.doc_list).split())
