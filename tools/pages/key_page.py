"""The namelist reference of the documentation, made from the kernel's table of keys."""

from __future__ import annotations

from itertools import groupby

from rwmf import _library

_INTRODUCTION = """\
# Namelist reference

Made by `tools/docs --made` from the one table that also validates a case
(`src/rwmf/input/schema.f90`).

One group, one effect: a group that is absent is an effect that is not simulated. Names of groups
and keys may be written in small or capital letters, texts stand in quotes, `!` begins a comment. An
unknown group or key, a key given twice, a wrong type or a value that is not allowed is an error
that names file, group, key, line, value and what is allowed. A value whose magnitude is outside
the range of real buildings, *usual*, is no error: `check`, runs, spectra and sweeps warn. Zero is
always usual.
"""


def make() -> str:
    """Make the page in Markdown.

    Returns
    -------
    str
        One table for each group, in the order of the kernel's table.
    """
    parts = [_INTRODUCTION]
    for group, keys in groupby(_library.schema(), key=lambda row: row.group):
        parts.append(
            f"\n## `&{group}`\n\n| key | type | unit | default | allowed | usual | meaning |"
        )
        parts.append("|---|---|---|---|---|---|---|")
        parts.extend(_row(key) for key in keys)
    return "\n".join(parts) + "\n"


def _row(row: _library.KeyRow) -> str:
    _, name, kind, unit, default, allowed, meaning, usual = row
    if kind == "choice":
        allowed = ", ".join(f"'{word}'" for word in allowed.split())
    return f"| `{name}` | {kind} | {unit} | {default} | {allowed} | {usual} | {meaning} |"
