"""A folder of Fortran sources as the tests of the architecture see it: modules, arrows, sizes.

An arrow is a `use`, inside any `#ifdef`. Where a macro names the module, the arrow goes to every
module that the macro can mean: its `#define` in the same file, and the `-D` of the `meson.build`
beside it. tools/join-sources.py names further copies of a file by a suffix: number of
lanes, order or instruction set (`_l16`, `_o8`, `_v3`).
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
    build_macros: dict[str, set[str]]  # definitions -D in the meson.build beside it

    @cached_property
    def code(self) -> dict[int, str]:
        """Lines that are neither blank nor comment nor directive, without texts, by number."""
        return {number: text for number, text in _strip(self.lines) if text.strip()}

    @cached_property
    def statements(self) -> list[Statement]:
        """All statements in their order."""
        return _join(self.code)

    @cached_property
    def macros(self) -> dict[str, set[str]]:
        """Return the possible values of a macro; a definition in the file comes first."""
        found = {name: set(values) for name, values in self.build_macros.items()}
        for name, value in self._defined.items():
            found.setdefault(name, set()).add(value)
        return found

    @cached_property
    def _defined(self) -> dict[str, str]:
        defines = [re.match(r"\s*#\s*define\s+(\w+)\s+(\w+)\s*$", line) for line in self.lines]
        return {found[1]: found[2] for found in defines if found}

    @cached_property
    def module(self) -> str:
        """Name of its module; that of the program where there is none."""
        for statement in self.statements:
            if found := _MODULE.match(statement.text) or re.match(
                r"program\s+(\w+)", statement.text, re.IGNORECASE
            ):
                return self._defined.get(found[1], found[1]).lower()
        return ""

    @cached_property
    def is_program(self) -> bool:
        """Return True for a file with a main program instead of a module."""
        return not any(_MODULE.match(part.text) for part in self.statements)

    @cached_property
    def variants(self) -> set[str]:
        """Names under which the file is compiled, `module` among them."""
        names = {self.module}
        for statement in self.statements:
            if found := _MODULE.match(statement.text):
                names |= {name.lower() for name in self.macros.get(found[1], {found[1]})}
        return names

    @cached_property
    def used(self) -> dict[str, int]:
        """Modules that it uses, with the line of the first `use`."""
        found: dict[str, int] = {}
        for statement in self.statements:
            if match := _USE.match(statement.text) or _SUBMODULE.match(statement.text):
                for name in self.macros.get(match[1], {match[1]}):
                    found.setdefault(LANES.sub("", name.lower()), statement.line)
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
        """The file of a module, by every name under which it is compiled."""
        return {name: source for source in self.sources for name in source.variants}

    @cached_property
    def arrows(self) -> dict[str, set[str]]:
        """Modules that a module uses; a file that is compiled several times counts once."""
        return {
            source.module: {self.owners[name].module for name in source.used if name in self.owners}
            - {source.module}
            for source in self.sources
        }

    @cached_property
    def cycle(self) -> list[str]:
        """Modules that are in a circle or use one that is; empty where there is none."""
        waiting = dict(self.arrows)
        while ready := [name for name, used in waiting.items() if not used & waiting.keys()]:
            for name in ready:
                del waiting[name]
        return sorted(waiting)


def read_tree(root: Path) -> Tree:
    """Read all Fortran sources below a folder, and the `use` lines of tables of modules."""
    macros: dict[Path, dict[str, set[str]]] = {}
    sources = []
    for path in sorted(path for path in root.rglob("*") if path.suffix.lower() == ".f90"):
        folder = path.parent
        if folder not in macros:
            build = folder / "meson.build"
            macros[folder] = build_macros(build.read_text("utf-8")) if build.is_file() else {}
        lines = path.read_text(encoding="utf-8").splitlines()
        sources.append(Source(path.relative_to(root), lines, macros[folder]))
    for path in sorted(root.rglob("*.table")):
        parts = path.relative_to(root).with_suffix("").parts
        name = "_".join(parts if parts[0] == "rwmf" else ("rwmf", *parts))
        uses = re.findall(r"^use (?:.*&\n)*.*", path.read_text(encoding="utf-8"), re.MULTILINE)
        lines = "\n".join([f"module {name}", *uses, f"end module {name}"]).splitlines()
        sources.append(Source(path.relative_to(root).with_suffix(".f90"), lines, {}))
    return Tree(root, sources)


def build_macros(text: str) -> dict[str, set[str]]:
    """Find the definitions `-DNAME=value` of a meson.build, including loops over such names.

    Only assignments of texts, lists and dictionaries are followed; whatever else stands there
    defines no names of modules.
    """
    found: dict[str, set[str]] = {}
    _follow(_build_statements(text), {}, found)
    return found


def build_lines(text: str) -> str:
    """Text of a meson.build without comments."""
    return "\n".join(
        re.sub(r"#(?=[^']*(?:'[^']*'[^']*)*$).*", "", line) for line in text.split("\n")
    )


class _Text(str):
    """A text with the methods that it has in meson."""

    def to_upper(self) -> _Text:
        return _Text(self.upper())

    def to_lower(self) -> _Text:
        return _Text(self.lower())


def _build_statements(text: str) -> list[str]:
    """Statements of a meson.build; those in brackets joined."""
    statements = [""]
    for line in build_lines(text).split("\n"):
        statements[-1] += line + " "
        bare = re.sub(r"'[^']*'", "", statements[-1])
        if all(bare.count(a) <= bare.count(b) for a, b in ("()", "[]", "{}")):
            statements.append("")
    return [statement.strip() for statement in statements if statement.strip()]


def _follow(statements: list[str], values: dict[str, object], found: dict[str, set[str]]) -> None:
    """Carry out statements as far as they are understood and note the definitions in them."""
    position = 0
    while position < len(statements):
        statement = statements[position]
        position += 1
        if loop := re.match(r"foreach\s+([\w\s,]+):(.*)$", statement):
            end = _end_of_loop(statements, position)
            names = [name.strip() for name in loop[1].split(",")]
            items = _evaluate(loop[2], values)
            for item in items.items() if isinstance(items, dict) else items or ():
                parts = item if isinstance(item, tuple) else (item,)
                values.update(zip(names, map(_as_text, parts), strict=False))
                _follow(statements[position:end], values, found)
            position = end + 1
        elif assignment := re.match(r"(\w+)\s*\+?=(?!=)(.*)$", statement):
            value = _evaluate(assignment[2], values)
            if "+=" not in statement.split("'")[0]:
                values[assignment[1]] = _as_text(value)
            for part in value if isinstance(value, list) else [value]:
                if definition := re.match(r"-D(\w+)=(\w+)$", str(part)):
                    found.setdefault(definition[1], set()).add(definition[2])


def _end_of_loop(statements: list[str], position: int) -> int:
    depth = 1
    while depth:
        depth += bool(re.match(r"foreach\b", statements[position]))
        depth -= statements[position] == "endforeach"
        position += 1
    return position - 1


def _as_text(value: object) -> object:
    return _Text(value) if isinstance(value, str) else value


def _evaluate(expression: str, values: dict[str, object]) -> object:
    """Value of an expression, None where it is more than texts, lists and dictionaries."""
    try:
        return eval(expression.strip(), {"__builtins__": {}}, values)
    except Exception:
        return None


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
