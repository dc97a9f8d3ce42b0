"""A folder of Fortran sources as the tests of the architecture see it: modules, arrows, sizes.

An arrow is a `use`, inside any `#ifdef`; no macro names a module. tools/join-sources.py names
further copies of a file by a suffix: number of lanes, order or instruction set (`_l16`, `_o8`,
`_v3`).
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

# Modules that no source of ours contains.
INTRINSIC = re.compile(r"(iso_c_binding|iso_fortran_env|ieee_\w+|omp_lib)$")
LANES = re.compile(r"(?=_[lov]\d)(_[lo]\d+)?(_v\d+)?$")
# The structures of include/rwmf.h, which tools/make-bindings.py writes.
OF_HEADER = re.compile(r"rwmf_bindings_c_types$")
SUNDIALS = re.compile(r"f(cvode|kinsol|ida|nvector|sun)\w*_mod$")

_USE = re.compile(r"use\b\s*(?:,\s*(?:non_)?intrinsic\s*)?(?:::)?\s*(\w+)", re.IGNORECASE)
_MODULE = re.compile(r"module\s+(?!procedure\b|subroutine\b|function\b)(\w+)$", re.IGNORECASE)
_SUBMODULE = re.compile(r"submodule\s*\(\s*(\w+)", re.IGNORECASE)
_INCLUDE = re.compile(r"#?\s*include\s*['\"<]", re.IGNORECASE)
_PROCEDURE = re.compile(
    r"(?P<prefix>(?:(?:(?:pure|elemental|impure|recursive|non_recursive|module)\b|"
    r"(?:integer|real|complex|logical|character|type|class|double\s+precision)\b"
    r"\s*(?:\((?:[^()]|\([^()]*\))*\))?)\s*)*)"
    r"\b(?P<kind>subroutine|function|(?<=module )procedure)\s+(?P<name>\w+)"
    r"\s*(?:\((?P<arguments>[^()]*)\))?",
    re.IGNORECASE,
)
_END_PROCEDURE = re.compile(r"end\s*(subroutine|function|procedure)\b", re.IGNORECASE)
_TYPE = re.compile(r"type\s*(?:,[^:]*)?(?:::\s*|\s+)(\w+)$", re.IGNORECASE)


@dataclass(frozen=True)
class Statement:
    """A statement without comments, its continuation lines joined, its texts empty."""

    line: int  # number of its first line
    last: int  # and of its last
    text: str


@dataclass
class Procedure:
    """A subroutine or function with a body."""

    name: str
    arguments: int
    statements: list[Statement] = field(default_factory=list)
    code_lines: int = 0  # between its head and its end, without internal procedures


@dataclass
class DerivedType:
    """A derived type."""

    name: str
    parent: str  # that it extends, or ''
    components: dict[str, str] = field(default_factory=dict)  # and their declarations


@dataclass
class Source:
    """One Fortran file."""

    path: Path  # from the root of the sources
    lines: list[str]

    @cached_property
    def code(self) -> dict[int, str]:
        """Lines that are neither blank nor comment nor directive, without texts, by number."""
        return {number: text for number, text in _strip(self.lines) if text.strip()}

    @cached_property
    def statements(self) -> list[Statement]:
        """All statements in their order."""
        return _join(self.code)

    @cached_property
    def module(self) -> str:
        """Name of its module; that of the program where there is none."""
        for statement in self.statements:
            if found := _MODULE.match(statement.text) or re.match(
                r"program\s+(\w+)", statement.text, re.IGNORECASE
            ):
                return found[1].lower()
        return ""

    @cached_property
    def is_program(self) -> bool:
        """Return True for a file with a main program instead of a module."""
        return not any(_MODULE.match(part.text) for part in self.statements)

    @cached_property
    def used(self) -> dict[str, int]:
        """Modules that it uses, with the line of the first `use`."""
        found: dict[str, int] = {}
        for statement in self.statements:
            if match := _USE.match(statement.text) or _SUBMODULE.match(statement.text):
                found.setdefault(LANES.sub("", match[1].lower()), statement.line)
        return found

    @cached_property
    def includes(self) -> list[int]:
        """List the lines that include a file, whose arrows would be missed."""
        return [i for i, line in enumerate(self.lines, 1) if _INCLUDE.match(line.strip())]

    @cached_property
    def head(self) -> list[Statement]:
        """Statements of the module above its procedures, without those inside types."""
        found: list[Statement] = []
        depth = 0
        for statement in self.statements:
            word = statement.text.lower()
            if re.match(r"contains$", word) and depth == 0:
                break
            if re.match(r"end\s*(type|interface|enum)\b", word):
                depth -= 1
            elif _opens_block(word):
                depth += 1
            elif depth == 0:
                found.append(statement)
        return found

    @cached_property
    def types(self) -> list[DerivedType]:
        """Derived types in their order."""
        found: list[DerivedType] = []
        is_open = False
        for statement in self.statements:
            word = statement.text
            if match := _TYPE.match(word):
                parent = re.search(r"extends\s*\(\s*(\w+)", word, re.IGNORECASE)
                found.append(DerivedType(match[1].lower(), parent[1].lower() if parent else ""))
                is_open = True
            elif re.match(r"(contains$|end\s*type\b)", word, re.IGNORECASE):
                is_open = False
            elif is_open and "::" in word:
                declaration, names = word.split("::", 1)
                found[-1].components |= dict.fromkeys(names_in(names), declaration)
        return found

    @cached_property
    def procedures(self) -> list[Procedure]:
        """Procedures with a body, internal ones too."""
        return _find_procedures(self.statements, self.code)


@dataclass
class Tree:
    """All sources below a folder."""

    root: Path
    sources: list[Source]

    @cached_property
    def owners(self) -> dict[str, Source]:
        """The file of a module."""
        return {source.module: source for source in self.sources}


def read_tree(root: Path) -> Tree:
    """Read all Fortran sources below a folder, and the `use` lines of tables of modules."""
    paths = sorted(path for path in root.rglob("*") if path.suffix.lower() == ".f90")
    sources = [
        Source(path.relative_to(root), path.read_text(encoding="utf-8").splitlines())
        for path in paths
    ]
    for path in sorted(root.rglob("*.table")):
        parts = path.relative_to(root).with_suffix("").parts
        name = "_".join(parts if parts[0] == "rwmf" else ("rwmf", *parts))
        uses = re.findall(r"^use (?:.*&\n)*.*", path.read_text(encoding="utf-8"), re.MULTILINE)
        lines = "\n".join([f"module {name}", *uses, f"end module {name}"]).splitlines()
        sources.append(Source(path.relative_to(root).with_suffix(".f90"), lines))
    return Tree(root, sources)


def build_lines(text: str) -> str:
    """Text of a meson.build without comments."""
    return "\n".join(
        re.sub(r"#(?=[^']*(?:'[^']*'[^']*)*$).*", "", line) for line in text.split("\n")
    )


def _strip(lines: list[str]) -> list[tuple[int, str]]:
    """Yield numbered lines without comments, directives and quoted text."""
    stripped = []
    quote = ""  # of a text that goes on from the line before
    for number, line in enumerate(lines, 1):
        if not quote and line.lstrip().startswith("#"):
            continue
        kept = []
        for character in line.lstrip().removeprefix("&") if quote else line:
            if quote:
                quote = "" if character == quote else quote
                kept += [character] if not quote else []
            elif character == "!":
                break
            else:
                quote = character if character in "'\"" else ""
                kept.append(character)
        if quote:
            goes_on = line.rstrip().endswith("&")
            kept.append("&" if goes_on else "")
            quote = quote if goes_on else ""
        stripped.append((number, "".join(kept).rstrip()))
    return stripped


def _join(code: dict[int, str]) -> list[Statement]:
    """Statements from lines: continuations joined, several in a line apart."""
    statements: list[Statement] = []
    begun: tuple[int, str] | None = None
    for number, line in code.items():
        first, text = begun or (number, "")
        text += line.strip().removeprefix("&") if begun else line.strip()
        if text.endswith("&"):
            begun = (first, text[:-1] + " ")
            continue
        begun = None
        parts = [part.strip() for part in text.split(";")]
        statements += [Statement(first, number, part) for part in parts if part]
    return statements


def names_in(entities: str) -> list[str]:
    """Return the names in a declaration from the text after its `::`."""
    bare = entities
    while (shorter := re.sub(r"\([^()]*\)|\[[^\[\]]*\]", "", bare)) != bare:
        bare = shorter
    return [name[0].lower() for part in bare.split(",") if (name := re.findall(r"\w+", part))]


def _opens_block(word: str) -> bool:
    """Tell whether a statement of a module's head begins a type, interface or enumeration."""
    return bool(
        re.match(r"type\s*(,|::|\s+\w+$)", word)
        or re.match(r"(abstract\s+)?interface\b", word)
        or re.match(r"enum\s*,", word)
    )


def _find_procedures(statements: list[Statement], code: dict[int, str]) -> list[Procedure]:
    done: list[Procedure] = []
    is_interface = False
    open_: list[tuple[Procedure, Statement]] = []
    inner = [0]  # lines of internal procedures at every depth
    for statement in statements:
        word = statement.text
        if re.match(r"((abstract\s+)?interface\b)", word, re.IGNORECASE):
            is_interface = True
        elif re.match(r"end\s*interface\b", word, re.IGNORECASE):
            is_interface = False
        elif is_interface:
            continue
        elif _END_PROCEDURE.match(word) or (open_ and word.lower() == "end"):
            procedure, head = open_.pop()
            body = sum(head.last < number < statement.line for number in code)
            procedure.code_lines = body - inner.pop()
            inner[-1] += sum(head.line <= number <= statement.line for number in code)
            done.append(procedure)
        elif found := _PROCEDURE.match(word):
            open_.append((_begin(found), statement))
            inner.append(0)
        elif open_:
            open_[-1][0].statements.append(statement)
    return done


def _begin(found: re.Match[str]) -> Procedure:
    names = [name for name in (found["arguments"] or "").split(",") if name.strip()]
    return Procedure(found["name"], len(names))
