#!/usr/bin/env python3
"""Write the Fortran interface of the C header: a module of constants, types and procedures.

fortran-interface.py HEADER MODULE

Module files fit one compiler; this source fits all. The header is the only definition. Names
that the tables below do not know, and declarations of a new form, are errors.
"""

import re
import sys
from collections.abc import Iterator
from pathlib import Path

# addresses that may be NULL, as every `message`; the others are refused by the library
_MAY_BE_NULL = {
    "rwmf_read_case": {"folder"},
    "rwmf_read_case_with": {"folder", "motion", "vertical"},
    "rwmf_change_case": {"sizes"},
    "rwmf_respond_member": {"tangents", "response"},
    "rwmf_land_member": {"host_mass"},
    "rwmf_member_settles": {"host_mass"},
}
# results of one number; the other addresses are arrays
_SCALARS = {"tau", "count", "number", "rests", "side"}
_NUMBERS = {
    "double": "real(c_double)",
    "int": "integer(c_int)",
    "int32_t": "integer(c_int32_t)",
    "int64_t": "integer(c_int64_t)",
    "size_t": "integer(c_size_t)",
}
_TEXTS = {"char": "character(kind=c_char)"}
_HEAD = """\
!> Interface of the library for every Fortran compiler, made from rwmf.h, which describes the
!> procedures. Handles are `type(c_ptr)`, null before they are created; texts end with c_null_char.
module rwmf_c
   use, intrinsic :: iso_c_binding, only: c_char, c_double, c_funptr, c_int, c_int32_t, c_int64_t, &
      c_ptr, c_size_t
   implicit none
   public
"""
_WIDTH = 100
_TOKEN = re.compile(
    r"enum\s*\{(?P<enum>[^}]*)\}\s*;"
    r"|typedef\s+struct\s+(?P<handle>\w+)\s+\w+\s*;"
    r"|typedef\s+struct\s*\{(?P<fields>[^}]*)\}\s*(?P<type>\w+)\s*;"
    r"|(?P<result>void|int|double)\s+(?P<name>rwmf_\w+)\((?P<arguments>.*?)\)\s*;",
    re.DOTALL,
)
_DECLARATION = re.compile(
    r"(?P<const>const\s+)?(?P<kind>\w+)\s*(?P<stars>\*\s*(?:const\s*\*)?\*?)?\s*(?P<name>\w+)"
    r"(?:\[(?P<size>\d+)\])?"
)


class _Header:
    """Declarations of a C header, translated one after the other."""

    def __init__(self, text: str) -> None:
        text = re.sub(r"/\*.*?\*/", "", text, flags=re.DOTALL)
        text = re.sub(r"^#.*$|^extern \"C\" \{$|^\}$", "", text, flags=re.MULTILINE)
        self.tokens = list(_TOKEN.finditer(text))
        rest = _TOKEN.sub("", text).strip()
        if rest:
            raise SystemExit(f"no declaration that this program knows: {rest[:200]}")
        self.handles = {token["handle"] for token in self.tokens if token["handle"]}
        self.types = {token["type"] for token in self.tokens if token["type"]}

    def constants(self) -> Iterator[str]:
        """Yield the numbers of all enumerations."""
        for token in self.tokens:
            for name, value in re.findall(r"(\w+)\s*=\s*(\d+)", token["enum"] or ""):
                yield f"   integer(c_int), parameter :: {name} = {value}"

    def structures(self) -> Iterator[str]:
        """Yield the derived types."""
        for token in self.tokens:
            if token["type"]:
                yield f"\n   type, bind(c) :: {token['type']}"
                for field in filter(None, map(str.strip, token["fields"].split(";"))):
                    yield f"      {self._component(field)}"
                yield f"   end type {token['type']}"

    def _component(self, field: str) -> str:
        kind, stars, name, size, _ = _parts(field)
        if stars:
            return f"type(c_ptr) :: {name}"
        return f"{_known(kind)} :: {name}" + (f"({size})" if size else "")

    def procedures(self) -> Iterator[str]:
        """Yield the interfaces of the procedures."""
        for token in self.tokens:
            if token["name"]:
                yield from self._procedure(token)

    def _procedure(self, token: re.Match[str]) -> Iterator[str]:
        name = token["name"]
        absent = {"message"} | _MAY_BE_NULL.get(name, set())
        arguments = [self._argument(word, absent) for word in _split(token["arguments"])]
        result = _NUMBERS.get(token["result"], "")
        what = f"{result} function" if result else "subroutine"
        names = ", ".join(argument for argument, _ in arguments)
        yield ""
        yield from _wrapped(f"      {what} {name}({names}) bind(c)")
        used = " ".join([result, *(text for _, text in arguments)])
        names = ", ".join(sorted(set(re.findall(r"\bc_\w+|\brwmf_\w+", used))))
        yield from _wrapped(f"         import :: {names}")
        yield from (f"         {text} :: {argument}" for argument, text in arguments)
        yield f"      end {what.split()[-1]} {name}"

    def _argument(self, word: str, absent: set[str]) -> tuple[str, str]:
        """Return the name of an argument and its attributes."""
        if "(*" in word:
            pointer = re.search(r"\(\*(\w+)\)", word)
            assert pointer
            return pointer[1], "type(c_funptr), value"
        kind, stars, name, size, is_const = _parts(word)
        if size:
            raise SystemExit(f"no argument that this program knows: {word}")
        if stars == 0:
            return name, f"{_known(kind)}, value"
        intent = "intent(in)" if is_const else "intent(inout)"
        if kind == "void" or (kind in self.handles and stars == 1):
            return name, "type(c_ptr), value"
        if kind in self.handles:
            return name, f"type(c_ptr), {intent}"
        if stars == 2:
            return name, f"type(c_ptr), {intent}, dimension(*)"
        optional = ", optional" if name in absent else ""
        if kind in self.types:
            array = ", dimension(*)" if name == "events" else ""
            return name, f"type({kind}), {intent}{optional}{array}"
        array = "" if name in _SCALARS else ", dimension(*)"
        return name, f"{_known(kind, _NUMBERS | _TEXTS)}, {intent}{optional}{array}"


def _known(kind: str, kinds: dict[str, str] = _NUMBERS) -> str:
    if kind not in kinds:
        raise SystemExit(f"no type that this program knows: {kind}")
    return kinds[kind]


def _parts(word: str) -> tuple[str, int, str, str | None, bool]:
    """Return type, number of asterisks, name, size and `const` of a C declaration."""
    found = _DECLARATION.fullmatch(" ".join(word.split()))
    if not found:
        raise SystemExit(f"no declaration that this program knows: {word}")
    return (
        found["kind"], (found["stars"] or "").count("*"), found["name"], found["size"],
        bool(found["const"]),
    )  # fmt: skip


def _split(arguments: str) -> list[str]:
    """Split at the commas outside parentheses."""
    return [word.strip() for word in re.split(r",(?![^(]*\))", arguments)]


def _wrapped(line: str) -> Iterator[str]:
    """Break a line of names at a comma."""
    margin = len(line) - len(line.lstrip()) + 3
    while len(line) > _WIDTH:
        place = line.rindex(", ", 0, _WIDTH - 1) + 1
        yield f"{line[:place]} &"
        line = " " * margin + line[place:].lstrip()
    yield line


def main() -> None:
    """Write the module."""
    header, module = map(Path, sys.argv[1:])
    found = _Header(header.read_text(encoding="utf-8"))
    lines = [
        _HEAD, *found.constants(), *found.structures(), "", "   interface", *found.procedures(),
        "", "   end interface", "", "end module rwmf_c", "",
    ]  # fmt: skip
    module.write_text("\n".join(lines), encoding="utf-8")


if __name__ == "__main__":
    main()
