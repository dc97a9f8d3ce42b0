"""The namelist reference of the documentation, made from the kernel's table of keys."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby

from rwmf import _library

from pages.blocks import text_of


def make() -> str:
    """Make the page in Markdown."""
    parts = [text_of("namelist.md")]
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
