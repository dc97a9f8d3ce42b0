"""The namelist reference of the documentation, made from the kernel's table of keys."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby

from rwmf import _library

_INTRODUCTION = """\
# Namelist reference

For users who write a case file: this page lists every group and key, its unit, default and range.

`tools/docs --made` generates it from the table that also validates a case
(`src/rwmf/input/schema.f90`).

Each effect is one group; the program does not simulate an absent group. Only `&impact` holds by
default: a rocking wall without it has the momentum balance at its impacts, in every formulation;
`rule = 'none'` gives e = 1. Write names in small or capital letters, texts in quotes, and comments
after `!`. An unknown or repeated key, a wrong type or a forbidden value is an error with file,
line, group, key and the allowed values. A magnitude outside the range of real buildings (*usual*)
gives a warning only; zero never does. So does a record with a peak below 1e-5 g or above 5 g, an
interval above 0.1 s or a duration above one hour.

Leave out a *required* key if you give the dimensional keys named after "or". Beside a wall these
keys need its mass: `m_w`, or `density` and `thickness`, of `&wall`.
"""


def make() -> str:
    """Make the page in Markdown."""
    parts = [_INTRODUCTION]
    for group, found in groupby(_library.schema(), key=lambda row: row.group):
        keys = list(found)
        parts.append(
            f"\n## `&{group}`\n\n| key | type | unit | default | allowed | usual | meaning |"
        )
        parts.append("|---|---|---|---|---|---|---|")
        parts.extend(_row(key, keys) for key in keys)
    return "\n".join(parts) + "\n"


def _row(row: _library.KeyRow, group: Sequence[_library.KeyRow]) -> str:
    _, name, kind, unit, default, allowed, meaning, usual, _ = row
    if kind == "choice":
        allowed = ", ".join(f"'{word}'" for word in allowed.split())
    instead = [f"`{key.key}`" for key in group if key.gives == name]
    if default == "required" and instead:
        default = f"required, or {', '.join(instead)}"
    return f"| `{name}` | {kind} | {unit} | {default} | {allowed} | {usual} | {meaning} |"
