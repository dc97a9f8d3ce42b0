"""The types of a case's groups in Python, made from the kernel's table of keys."""

from __future__ import annotations

import keyword
import textwrap
from collections.abc import Iterator, Sequence
from itertools import groupby

from rwmf.kernel import tables

__all__ = ["make"]

_HEAD = '''\
"""Groups of a case with the types of their keys.

`tools/docs --made` generates this module from the kernel's table of keys.
"""

from __future__ import annotations

from typing import Literal

from rwmf.case.group import Group

__all__ = ["TYPES", "Groups"]
'''
_GROUPS = '''

class Groups:
    """The groups as attributes.

    An attribute is None where the case lacks the group. The declared types are those of a group
    that is present; ``"wall" in case.groups`` tests for it.
'''
_ATTRIBUTES = "\n    Attributes\n    ----------\n"
_TYPES = {
    "real": "float",
    "reals": "float | tuple[float, ...]",
    "integer": "int",
    "integers": "int | tuple[int, ...]",
    "logical": "bool",
    "text": "str",
}
_WIDTH = 100


def make() -> str:
    """Make the module."""
    parts = [_HEAD]
    names = {}
    for name, rows in groupby(tables.schema(), key=lambda row: row.group):
        names[name] = "".join(word.capitalize() for word in name.split("_"))
        # a keyword of Python is no attribute; group["lambda"] has its value
        keys = [row for row in rows if not keyword.iskeyword(row.key)]
        parts.append(f'\n\nclass {names[name]}(Group):\n    """Group ``&{name}``.\n{_ATTRIBUTES}')
        parts += [_meaning(row) for row in keys]
        parts.append('    """\n\n    __slots__ = ()\n')
        parts += [f"    {row.key}: {_type(row.kind, row.allowed.split())}\n" for row in keys]
    parts += [_GROUPS, _ATTRIBUTES]
    parts += [f"    {name} : {kind}\n        Group ``&{name}``.\n" for name, kind in names.items()]
    parts.append('    """\n\n    __slots__ = ()\n')
    parts += [f"    {name}: {kind}\n" for name, kind in names.items()]
    parts.append("\n\nTYPES: dict[str, type[Group]] = {\n")
    parts += [f'    "{name}": {kind},\n' for name, kind in names.items()]
    return "".join([*parts, "}\n"])


def _meaning(row: tables.KeyRow) -> str:
    """Return the entry of a key in the docstring."""
    unit = "" if row.unit in ("", "-") else f" [{row.unit}]"
    kind = "str" if row.kind == "choice" else _type(row.kind, ())
    lines = textwrap.wrap(
        f"{row.meaning[:1].upper()}{row.meaning[1:]}{unit}.", _WIDTH - 8, break_on_hyphens=False
    )
    return f"    {row.key} : {kind}\n" + textwrap.indent("\n".join(lines), 8 * " ") + "\n"


def _type(kind: str, words: Sequence[str]) -> str:
    if kind == "choice":
        line = ", ".join(f'"{word}"' for word in words)
        if len(line) < _WIDTH - 30:
            return f"Literal[{line}]"
        return "Literal[\n" + "".join(_lines(words)) + "    ]"
    item = _TYPES[kind.removesuffix(" list")]
    return f"tuple[{item}, ...]" if kind.endswith("list") else item


def _lines(words: Sequence[str]) -> Iterator[str]:
    return (f'        "{word}",\n' for word in words)
