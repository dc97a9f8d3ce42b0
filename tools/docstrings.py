"""Required items of Fortran docstrings: public procedures and types.

A public procedure has a docstring. Each argument that is a number, text or logical has a `!!` below
its declaration. Reals, including components of public types, give a unit in brackets. Otherwise
they state that they are a state, part or number of something, a sign or a flag. The type explains
arguments of a derived type. A file whose docstring declares "in the caller's units" needs no
further units. For an
argument `error`, docstring or `!!` give the conditions. include/rwmf.h explains the procedures for
C. No explanation may begin with a word and a colon.

`python -m docstrings` lists missing items with file and line. Docstrings of Python are those of
numpydoc's validation (docs/conf.py).
"""

import re
import sys
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

_PROCEDURE = re.compile(
    r"^\s*(?:(?!end\b|module\s+procedure|abstract)[\w()=:,*\s]*?\s)??(subroutine|function)\s+(\w+)"
    r"\s*(?:\(([^)]*)\))?",
    re.IGNORECASE,
)
_END = re.compile(r"^\s*end\s*(subroutine|function|type|interface)\b", re.IGNORECASE)
_TYPE = re.compile(r"^\s*type\s*(?:,[^:]*)?(?:::\s*|\s+)(\w+)\s*$", re.IGNORECASE)
_DECLARATION = re.compile(
    r"^\s*(real|integer|logical|character|complex|type|class|procedure)\b(.*?)::\s*(.*)$",
    re.IGNORECASE,
)
_UNIT = re.compile(r"\[[^\]]*\]")
# a vector of mixed units: states, rates, coefficients, or units of a table or the caller
_MIXED = re.compile(
    r"\((\w+ )*(states?|rates?|coefficients?)\b"
    r"|\b(states?|unit|units|coefficients|constants)\b",
    re.IGNORECASE,
)
# a sign, or the numeric form of a logical in loops over lanes: 1 for true, 0 for false
_FLAG = re.compile(r"(^|\s)[+-]?1 (where|or -1)\b")
# FORD takes such a beginning for metadata and drops the line
_METADATA = re.compile(r"^\s*[\w-]+:(\s|$)")
_WHEN = re.compile(
    r"\b(fail|fails|failed|failure|error|errors|err_\w+|refuse[sd]?|wrong|cannot)\b", re.IGNORECASE
)


@dataclass
class _Statement:
    """A statement with the comments below it."""

    line: int
    text: str
    doc: str = ""


@dataclass
class _Scope:
    """A procedure or type: its head, its docstring, its declarations."""

    kind: str
    name: str
    line: int
    doc: str
    arguments: list[str] = field(default_factory=list)
    statements: list[_Statement] = field(default_factory=list)


def main() -> int:
    """Look at all sources; the exit status is 1 when an item is missing."""
    n, status = 0, 0
    root = Path(__file__).resolve().parents[1]
    for path in sorted((root / "src").rglob("*.[fF]90")):
        for line, text in _check(path):
            if not text:
                n += 1
            else:
                print(f"{path.relative_to(root)}:{line}: {text}")
                status = 1
    print(f"docstrings of Fortran: {n} public procedures and types")
    return status


def _check(path: Path) -> Iterator[tuple[int, str]]:
    """Yield missing items, and an empty text for each checked procedure and type."""
    statements = list(_read(path.read_text(encoding="utf-8").splitlines()))
    has_units = not statements or "in the caller's units" not in statements[0].doc
    public = _public_names(statements)
    for statement in statements:
        if _METADATA.match(statement.doc):
            yield statement.line, f"begins as metadata of FORD: {statement.doc.strip()}"
    for scope in _scopes(statements):
        if scope.name.lower() in public and not scope.name.startswith("c_"):
            yield scope.line, ""
            missing = _of_type(scope) if scope.kind == "type" else _of_procedure(scope)
            for line, fault in missing:
                if has_units or not fault.endswith("has no unit"):
                    yield line, f"{scope.name}: {fault}"


def _read(lines: list[str]) -> Iterator[_Statement]:
    """Join continued lines; documentation comments become separate statements or docs."""
    current: _Statement | None = None
    continued = False
    for number, line in enumerate(lines, 1):
        text = line.strip()
        if text.startswith("!!") and current is not None and not continued:
            current.doc += " " + text[2:].strip()
        elif text.startswith("!>") and not continued:
            if current is not None and current.text:
                yield current
                current = None
            above = "" if current is None else current.doc + " "
            current = _Statement(number, "", above + text[2:].strip())
        elif text and not text.startswith(("!", "#")):
            code = re.sub(r"!.*$", "", text) if "'" not in text else text
            if continued and current is not None:
                current.text += " " + code.strip().lstrip("&").strip()
            else:
                if current is not None:
                    yield current
                current = _Statement(number, code.strip())
            continued = current.text.endswith("&")
            current.text = current.text.rstrip("&").rstrip()
        elif not text and current is not None and not current.text:
            # a docstring is directly above the explained code
            current = None
    if current is not None:
        yield current


def _public_names(statements: list[_Statement]) -> set[str]:
    names: set[str] = set()
    for statement in statements:
        if found := re.match(r"public\s*::\s*(.*)$", statement.text, re.IGNORECASE):
            names |= {name.strip().lower() for name in found[1].split(",")}
    return names


def _scopes(statements: list[_Statement]) -> Iterator[_Scope]:
    """Yield procedures of the module and derived types, with their direct declarations."""
    above = ""
    open_scopes: list[_Scope | None] = []
    for statement in statements:
        text = statement.text
        if not text:
            above = statement.doc
            continue
        if _END.match(text) and open_scopes:
            closed = open_scopes.pop()
            if closed is not None:
                yield closed
        elif re.match(r"(abstract\s+)?interface\b", text, re.IGNORECASE):
            open_scopes.append(None)
        elif head := _PROCEDURE.match(text):
            arguments = [name.strip().lower() for name in (head[3] or "").split(",")]
            named = _Scope("procedure", head[2], statement.line, above, arguments)
            # internal procedures and interfaces are private
            open_scopes.append(None if open_scopes else named)
        elif head := _TYPE.match(text):
            open_scopes.append(_Scope("type", head[1], statement.line, above))
        elif open_scopes and open_scopes[-1] is not None:
            open_scopes[-1].statements.append(statement)
        above = ""


def _of_type(scope: _Scope) -> Iterator[tuple[int, str]]:
    if not scope.doc:
        yield scope.line, "no docstring"
    for statement in scope.statements:
        if re.match(r"contains\b", statement.text, re.IGNORECASE):
            return
        kind, names = _declared(statement)
        # items in the docstring for all components need not be repeated
        if kind == "real" and not _has_unit(statement.doc) and not _UNIT.search(scope.doc):
            yield statement.line, f"component {', '.join(names)} has no unit"


def _of_procedure(scope: _Scope) -> Iterator[tuple[int, str]]:
    if not scope.doc:
        yield scope.line, "no docstring"
    for statement in scope.statements:
        kind, names = _declared(statement)
        for name in names:
            if name.lower() not in scope.arguments:
                continue
            if kind == "real" and not _has_unit(statement.doc):
                yield statement.line, f"argument {name} has no unit"
            elif kind in ("integer", "logical", "character") and not statement.doc:
                yield statement.line, f"argument {name} is not explained"
            elif name.lower() == "error" and not statement.doc and not _WHEN.search(scope.doc):
                yield statement.line, "argument error does not say when it is set"


def _declared(statement: _Statement) -> tuple[str, list[str]]:
    found = _DECLARATION.match(statement.text)
    if found is None:
        return "", []
    bare = re.sub(r"\([^()]*(\([^()]*\)[^()]*)*\)", "", found[3])
    return found[1].lower(), [item.split("=")[0].strip() for item in bare.split(",")]


def _has_unit(doc: str) -> bool:
    return bool(_UNIT.search(doc) or _MIXED.search(doc) or _FLAG.search(doc))


if __name__ == "__main__":
    sys.exit(main())
