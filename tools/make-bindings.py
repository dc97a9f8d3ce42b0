#!/usr/bin/env python3
"""Write the bindings of the kernel from their tables.

    make-bindings.py c HEADER TABLE TYPES FUNCTIONS   Fortran side of the C header
    make-bindings.py client HEADER TABLE MODULE       Fortran interface of the C header for hosts
    make-bindings.py python TABLE MODULE              procedures for f2py

A table has lines `use ...` and lines `HANDLE_OR_STRUCTURE = TYPE_OF_THE_KERNEL`. Components that
differ stand below; `%x` is component x of the kernel. A procedure is NAME(ARGUMENTS). Declarations
and statements stand below it. A statement with `error` ends the procedure after a failure, one with
`finally` runs in any case. In statements each argument is a value of the kernel: the object behind
a handle, a text, an array.

Some arguments of the C header need more. `x(n, 3)` is the shape of an array. `x?` may be NULL.
`n >= 1 'keys'` is a bound and a name. `keys(n) 'key'` are texts. `snapshot reused` is created where
it is NULL.

An argument for f2py is `x: real(:) in`, where `in` may be left out. `x` alone is the object behind
a handle, `new x` the handle of a new object. `text` is returned as bytes. `control` is progress and
cancel, `error` status and message. `threadsafe` behind it releases the interpreter lock.
"""

import re
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

# results of one number, and arrays of structures; the other addresses are arrays of numbers
_SCALARS = {"tau", "count", "number", "rests", "side"}
_STRUCTURES = {"events"}
_TEXTS = {"namelist": "namelist text"}
_NUMBERS = {
    "double": "real(c_double)",
    "int": "integer(c_int)",
    "int32_t": "integer(c_int32_t)",
    "int64_t": "integer(c_int64_t)",
    "size_t": "integer(c_size_t)",
}
_F2PY = {
    "real": "real(c_double)",
    "int": "integer(c_int)",
    "int64": "integer(c_int64_t)",
    "int8": "integer(c_int8_t)",
    "char": "character(*)",
}
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
_HINT = re.compile(
    r"(?P<name>\w+)(?P<optional>\?)?(?:\((?P<shape>.*)\))?(?: >= (?P<least>\d+))?"
    r"(?: '(?P<label>[^']*)')?(?P<reused> reused)?"
)


def _split(arguments: str) -> list[str]:
    """Split at the commas outside parentheses."""
    found, depth = [""], 0
    for letter in arguments:
        depth += (letter == "(") - (letter == ")")
        if letter == "," and depth == 0:
            found.append("")
        else:
            found[-1] += letter
    return [word.strip() for word in found if word.strip()]


def _wrapped(line: str) -> Iterator[str]:
    """Break a line at a comma."""
    margin = len(line) - len(line.lstrip()) + 3
    while len(line) > _WIDTH:
        place = line.rindex(", ", 0, _WIDTH - 1) + 1
        yield f"{line[:place]} &"
        line = " " * margin + line[place:].lstrip()
    yield line


@dataclass
class _Entry:
    """A procedure of a table."""

    name: str
    arguments: list[str]
    is_threadsafe: bool
    docs: list[str]
    declarations: list[str] = field(default_factory=list)
    statements: list[str] = field(default_factory=list)
    finals: list[str] = field(default_factory=list)

    def take(self, line: str) -> None:
        """Take a declaration or a statement, with the lines that continue it."""
        line = line.removeprefix("   ")
        if line.startswith("finally "):
            self.finals.append(line.removeprefix("finally "))
        elif re.match(r"(type|real|integer|character|logical)\b[^'\"]*::", line):
            self.declarations.append(line)
        else:
            self.statements.append(line)


class _Table:
    """A table of procedures."""

    def __init__(self, path: str) -> None:
        self.uses: list[str] = []
        self.types: dict[str, tuple[str, dict[str, str]]] = {}
        self.entries: list[_Entry] = []
        docs: list[str] = []
        last = ""
        text = re.sub(r"^#.*\n", "", _read(path), flags=re.MULTILINE)
        for statement in re.findall(r"(?:.*&\n)*.+", text):
            head = re.match(r"(\w+)\((.*)\)( threadsafe)?$", _joined(statement))
            if statement.startswith("use"):
                self.uses.append(statement)
            elif statement.startswith("!>"):
                docs.append(f"   {statement}")
            elif match := re.fullmatch(r"(\w+) = (\w+)", statement):
                last = match[1]
                self.types[last] = (match[2], {})
            elif head:
                self.entries.append(_Entry(head[1], _split(head[2]), bool(head[3]), docs))
                docs = []
            elif self.entries:
                self.entries[-1].take(statement)
            else:
                name, _, value = statement.strip().partition(" = ")
                self.types[last][1][name] = value


def _read(path: str) -> str:
    return Path(path).read_text(encoding="utf-8")


def _joined(lines: str) -> str:
    return re.sub(r"\s*&\s*", " ", lines)


class _Procedure:
    """Procedure in the making: lines before, in and after the statements of its entry."""

    def __init__(self, head: str, tail: str) -> None:
        self.head = head
        self.tail = tail
        self.names: list[str] = []
        self.dummies: list[str] = []
        self.locals: list[str] = []
        self.first: list[str] = []
        self.last: list[str] = []
        self.after: list[str] = []

    def dummy(self, name: str, attributes: str, shape: str = "") -> None:
        """Add an argument."""
        self.names.append(name)
        self.dummies.append(f"{attributes} :: {name}{shape}")

    def lines(self, entry: _Entry, context: str = "") -> Iterator[str]:
        """Yield the procedure with the statements of its entry."""
        yield from entry.docs
        yield from _wrapped(f"   {self.head.format(', '.join(self.names))}")
        for line in [*self.dummies, *self.locals, *entry.declarations]:
            yield f"      {line}"
        # not `block`, which f2py does not parse
        yield "\n      body: if (.true.) then"
        for line in self.first:
            yield from _checked(line)
        for line in entry.statements:
            yield from _checked(line, context)
        yield from (part for line in self.last for part in _wrapped(f"         {line}"))
        yield "      end if body"
        yield from (f"      {line}" for line in [*entry.finals, *self.after])
        yield f"   end {self.tail}\n"


def _checked(line: str, context: str = "") -> Iterator[str]:
    """Yield a statement, which ends the procedure after an error."""
    yield f"         {line}"
    if re.search(r"\berror\b", line):
        if context and "call require_" not in line:
            yield f"         {context}"
        yield "         if (allocated(error)) exit body"


class _Header:
    """Declarations of a C header with their table, translated one after the other."""

    def __init__(self, header: str, table: str) -> None:
        text = re.sub(r"/\*.*?\*/", "", _read(header), flags=re.DOTALL)
        text = re.sub(r"^#.*$|^extern \"C\" \{$|^\}$", "", text, flags=re.MULTILINE)
        self.tokens = list(_TOKEN.finditer(text))
        rest = _TOKEN.sub("", text).strip()
        if rest:
            raise SystemExit(f"no declaration that this program knows: {rest[:200]}")
        self.handles = {token["handle"] for token in self.tokens if token["handle"]}
        self.structures = {
            token["type"]: [_parts(word) for word in token["fields"].split(";") if word.strip()]
            for token in self.tokens
            if token["type"]
        }
        self.prototypes = [token for token in self.tokens if token["name"]]
        self.table = _Table(table)
        self.hints: dict[str, dict[str, re.Match[str]]] = {}
        for entry in self.table.entries:
            hints = [_HINT.fullmatch(word) for word in entry.arguments]
            self.hints[entry.name] = {hint["name"]: hint for hint in hints if hint}
            if None in hints or len(hints) > len(self.hints[entry.name]):
                raise SystemExit(f"{table}: {entry.name}: no argument that this program knows")

    def constants(self) -> Iterator[str]:
        """Yield the numbers of all enumerations."""
        for token in self.tokens:
            for name, value in re.findall(r"(\w+)\s*=\s*(\d+)", token["enum"] or ""):
                yield f"   integer(c_int), parameter :: {name} = {value}"

    def types(self) -> Iterator[str]:
        """Yield the derived types."""
        for name, fields in self.structures.items():
            yield f"\n   type, bind(c) :: {name}"
            for kind, stars, component, size, _ in fields:
                shape = f"({size})" if size else ""
                yield f"      {'type(c_ptr)' if stars else _known(kind)} :: {component}{shape}"
            yield f"   end type {name}"

    def client(self) -> Iterator[str]:
        """Yield the interfaces of the procedures."""
        for token in self.prototypes:
            name = token["name"]
            hints = self.hints.get(name, {}).values()
            absent = {hint["name"] for hint in hints if hint["optional"]}
            words = _split(token["arguments"])
            arguments = [self._client_argument(word, {"message"} | absent) for word in words]
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

    def _client_argument(self, word: str, absent: set[str]) -> tuple[str, str]:
        """Return the name of an argument and its attributes."""
        if "(*" in word:
            return re.findall(r"\(\*(\w+)\)", word)[0], "type(c_funptr), value"
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
        array = "" if name in _SCALARS | _STRUCTURES else ", dimension(*)"
        if kind in self.structures:
            array = ", dimension(*)" if name in _STRUCTURES else ""
            return name, f"type({kind}), {intent}{optional}{array}"
        kinds = _NUMBERS | {"char": "character(kind=c_char)"}
        return name, f"{_known(kind, kinds)}, {intent}{optional}{array}"

    def functions(self) -> Iterator[str]:
        """Yield the functions of the library."""
        entries = {entry.name: entry for entry in self.table.entries}
        for token in self.prototypes:
            entry = entries.pop(token["name"], None)
            if entry is None:
                raise SystemExit(f"{token['name']}: not in the table")
            yield from _Function(self, token, self.hints[entry.name]).lines(entry)
        if entries:
            raise SystemExit(f"not in the header: {', '.join(entries)}")


class _Function(_Procedure):
    """A function of the header, on the side of the library."""

    def __init__(
        self, header: _Header, token: re.Match[str], hints: dict[str, re.Match[str]]
    ) -> None:
        kind = "function" if token["result"] in _NUMBERS else "subroutine"
        result = f"{_NUMBERS[token['result']]} " if kind == "function" else ""
        tail = " result(answer) bind(c)" if result else " bind(c)"
        super().__init__(f"{result}{kind} {token['name']}({{}}){tail}", f"{kind} {token['name']}")
        self.header = header
        self.hints = hints
        self.made: list[str] = []
        self.context = ""
        if result:
            self.locals.append("type(error_t), allocatable :: error")
        words = _split(token["arguments"])
        self.has_message = words[-2:] == ["char *message", "size_t size"]
        destroys = token["name"].startswith("rwmf_destroy")
        for word in words:
            (self._destroyed if destroys else self._take)(word)
        self.first += self.made
        if self.has_message:
            self.after.append("answer = put_message(error, message, room)")
        elif token["result"] == "int":
            self.first.insert(0, "answer = 0")
            self.after.append("if (allocated(error)) answer = int(error%stat, c_int)")
        elif token["result"] == "double":
            self.first.insert(0, "answer = ieee_value(answer, ieee_quiet_nan)")

    def lines(self, entry: _Entry, context: str = "") -> Iterator[str]:
        """Yield the function."""
        return super().lines(entry, context or self.context)

    def _destroyed(self, word: str) -> None:
        """Free the object behind a handle."""
        kind, _, name, _, _ = _parts(word)
        self.dummy(f"at_{name}", "type(c_ptr), intent(inout), optional")
        self.locals += ["type(c_ptr) :: address", self._object(kind, name)]
        self.first += [
            f"address = take_handle(at_{name})",
            "if (.not. c_associated(address)) return",
            f"call c_f_pointer(address, {name})",
        ]
        self.last.append(f"deallocate ({name})")

    def _object(self, kind: str, name: str) -> str:
        return f"type({self.header.table.types[kind][0]}), pointer :: {name}"

    def _take(self, word: str) -> None:
        """Take an argument."""
        if "(*" in word:
            self.dummy(re.findall(r"\(\*(\w+)\)", word)[0], "type(c_funptr), value")
            return
        kind, stars, name, _, is_const = _parts(word)
        hint = self.hints.get(name)
        if name == "size":
            self.dummy("room", "integer(c_size_t), value")
        elif stars == 0:
            self.dummy(name, f"{_known(kind)}, value")
            if hint:
                self.first.append(
                    f"call require_count({name}, {hint['least']}, '{hint['label']}', error)"
                )
        elif kind == "void" or (kind == "char" and not is_const):
            self.dummy(name, "type(c_ptr), value")
        elif kind == "char":
            self._text(name, hint)
        elif kind in self.header.handles:
            self._handle(kind, stars, name, hint)
        elif kind in self.header.structures and name not in _STRUCTURES:
            self._structure(kind, name, is_const, hint is None)
        elif name in _SCALARS:
            self._scalar(kind, name)
        else:
            self._array(kind, name, hint)

    def _text(self, name: str, hint: re.Match[str] | None) -> None:
        at, what = f"at_{name}", _TEXTS.get(name, name)
        self.dummy(at, "type(c_ptr), value")
        if hint and hint["shape"]:
            self.locals.append(f"character(:), allocatable :: {name}(:)")
            self.first += [
                f"call require_argument(c_associated({at}), '{name}', error)",
                f"call get_names({at}, {hint['shape']}, '{hint['label']}', {name}, error)",
            ]
            return
        self.locals.append(f"character(:), allocatable :: {name}")
        if hint:
            self.first.append(f"{name} = ''")
        condition = f"if (c_associated({at})) " if hint else ""
        self.first.append(f"{condition}call get_text({at}, '{what}', {name}, error)")

    def _handle(self, kind: str, stars: int, name: str, hint: re.Match[str] | None) -> None:
        at, what = f"at_{name}", kind.removeprefix("rwmf_")
        self.locals.append(self._object(kind, name))
        if stars == 1:
            self.dummy(at, "type(c_ptr), value")
            self.first += [
                f"call require_handle({at}, '{what}', error)",
                f"call c_f_pointer({at}, {name})",
            ]
            if kind == "rwmf_case":
                self.context = f"call name_file({name}, error)"
            return
        self.dummy(at, "type(c_ptr), intent(inout), optional")
        if hint:
            self.first.append(f"call require_argument(present({at}), '{name}', error)")
            self.made.append(f"if (c_associated({at})) call c_f_pointer({at}, {name})")
        else:
            self.first.insert(0, f"call require_empty({at}, '{what}', error)")
        self.first.insert(0, f"nullify ({name})")
        self.made.append(f"if (.not. associated({name})) allocate ({name})")
        self.last.append(f"{at} = c_loc({name})")
        self.after += [
            f"if (allocated(error) .and. associated({name})) then",
            f"   if (.not. c_associated({at})) deallocate ({name})",
            "end if",
        ]

    def _structure(self, kind: str, name: str, is_const: bool, is_needed: bool) -> None:
        at = name if is_const else f"at_{name}"
        self.dummy(at, f"type({kind}), intent({'in' if is_const else 'inout'}), optional")
        if is_needed:
            self.first.append(f"call require_argument(present({at}), '{name}', error)")
        if is_const:
            return
        of_kernel, special = self.header.table.types.get(kind, (kind, {}))
        self.locals.append(f"type({of_kernel}) :: {name}")
        value = name
        if of_kernel != kind:
            fields = (component for _, _, component, _, _ in self.header.structures[kind])
            values = (special.get(component, f"%{component}") for component in fields)
            value = f"{kind}({', '.join(values).replace('%', f'{name}%')})"
        condition = "" if is_needed else f"if (present({at})) "
        self.last.append(f"{condition}{at} = {value}")

    def _scalar(self, kind: str, name: str) -> None:
        at = f"at_{name}"
        self.dummy(at, f"{_known(kind)}, intent(inout), optional")
        self.locals.append(f"{_known(kind)} :: {name}")
        self.first.append(f"call require_argument(present({at}), '{name}', error)")
        self.last.append(f"{at} = {name}")

    def _array(self, kind: str, name: str, hint: re.Match[str] | None) -> None:
        shape = hint and hint["shape"]
        at = f"at_{name}" if shape else name
        self.dummy(at, "type(c_ptr), value")
        if shape:
            colons = ", ".join(":" * len(_split(shape)))
            self.locals.append(f"{_known(kind)}, pointer, contiguous :: {name}({colons})")
        if not (hint and hint["optional"]):
            what = (hint and hint["label"]) or name
            self.first.append(f"call require_argument(c_associated({at}), '{what}', error)")
            condition = ""
        else:
            condition = f"if (c_associated({at})) "
        if shape:
            if condition:
                self.made.append(f"nullify ({name})")
            self.made.append(f"{condition}call c_f_pointer({at}, {name}, [{shape}])")


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


def _of_f2py(entry: _Entry) -> _Procedure:
    """Return a procedure for f2py, without its statements."""
    made = _Procedure(f"subroutine {entry.name}({{}})", f"subroutine {entry.name}")
    error = "error" if "error" in entry.arguments else "none"
    made.locals.append(f"type(error_t), allocatable :: {error}")
    for word in entry.arguments:
        name, _, rest = word.removeprefix("new ").partition(": ")
        at = f"at_{name}"
        if rest:
            kind, _, intent = rest.partition(" ")
            kind, _, shape = kind.partition("(")
            made.dummy(name, f"{_F2PY[kind]}, intent({intent or 'in'})", shape and f"({shape}")
        elif name == "text":
            made.dummy("buffer", "integer(c_int8_t), intent(inout)", "(:)")
            made.dummy("length", "integer(c_int), intent(out)")
            made.locals.append("character(:), allocatable :: text")
            made.first.append("length = 0_c_int")
            made.last.append("call put_text(text, buffer, length)")
        elif name == "control":
            made.dummy("counters", "integer(c_int64_t), intent(inout), target", "(2)")
            made.locals.append("type(control_t) :: control")
            made.first.append("control = make_control(counters)")
        elif name == "error":
            made.dummy("status", "integer(c_int), intent(out)")
            made.dummy("message", "integer(c_int8_t), intent(inout)", "(:)")
            made.dummy("message_length", "integer(c_int), intent(out)")
            made.after.append("call put_error(error, status, message, message_length)")
        else:
            is_new = word.startswith("new ")
            made.dummy(at, f"integer(c_int64_t), intent({'out' if is_new else 'in'})")
            made.locals.append(f"type(kept_t), pointer :: {name}")
            made.first.append(f"allocate ({name})" if is_new else f"{name} => find({at})")
            if is_new:
                made.after.insert(0, f"call keep({name}, {error}, {at})")
    # f2py declares the C type of int8 only when it is written this way at least once
    made.dummies += [f"!f2py integer*1 :: {x}" for x in made.names if x in ("buffer", "message")]
    if entry.is_threadsafe:
        made.locals.append("!f2py threadsafe")
    return made


def _module(name: str, uses: list[str], contents: Iterator[str]) -> str:
    """Return a module of procedures."""
    return "\n".join([
        f"module {name}", *(f"   {use}" for use in uses), "   implicit none", "   public", "",
        "contains", "", *contents, f"end module {name}", "",
    ])  # fmt: skip


def _write_c(header: str, table: str, types: str, functions: str) -> None:
    found = _Header(header, table)
    name = "rwmf_bindings_c_types"
    lines = [
        f"module {name}", "   use, intrinsic :: iso_c_binding", "   implicit none", "   public",
        *found.types(), "", f"end module {name}", "",
    ]  # fmt: skip
    Path(types).write_text("\n".join(lines), encoding="utf-8")
    uses = [
        "use, intrinsic :: iso_c_binding",
        f"use {name}",
        "use rwmf_bindings_c_arguments",
        "use rwmf_bindings_c_strings",
        "use rwmf_core_error, only: err_input, error_t, fail",
        *found.table.uses,
    ]
    text = _module("rwmf_bindings_c_functions", uses, found.functions())
    Path(functions).write_text(text, encoding="utf-8")


def _write_client(header: str, table: str, module: str) -> None:
    found = _Header(header, table)
    lines = [
        _HEAD, *found.constants(), *found.types(), "", "   interface", *found.client(),
        "", "   end interface", "", "end module rwmf_c", "",
    ]  # fmt: skip
    Path(module).write_text("\n".join(lines), encoding="utf-8")


def _write_python(table: str, module: str) -> None:
    found = _Table(table)
    uses = [
        "use, intrinsic :: iso_c_binding, only: c_double, c_int, c_int64_t, c_int8_t, c_loc, &",
        "   c_null_funptr, c_null_ptr",
        "use rwmf_bindings_python_handles",
        "use rwmf_core_error, only: error_t",
        *found.uses,
    ]
    lines = (line for entry in found.entries for line in _of_f2py(entry).lines(entry))
    text = _module(f"rwmf_bindings_python_{Path(module).stem}", uses, lines)
    Path(module).write_text(text, encoding="utf-8")


_WRITERS: dict[str, Callable[..., None]] = {
    "c": _write_c,
    "client": _write_client,
    "python": _write_python,
}

if __name__ == "__main__":
    _WRITERS[sys.argv[1]](*sys.argv[2:])
