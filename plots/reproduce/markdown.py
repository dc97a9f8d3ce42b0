"""Tables and pages in Markdown."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

__all__ = ["fill", "table"]


def table(heads: Sequence[object], rows: Iterable[Sequence[object]]) -> str:
    """Write a table in Markdown."""
    cells = ([str(cell).replace("|", r"\|") for cell in line] for line in (heads, *rows))
    first, *others = (f"| {' | '.join(line)} |" for line in cells)
    return "\n".join([first, f"|{'---|' * len(heads)}", *others])


def fill(path: Path, **parts: str) -> str:
    """Read the text of a page and put parts in the place of its comments."""
    text = path.read_text(encoding="utf-8")
    for name, part in parts.items():
        text = text.replace(f"<!-- {name} -->", part)
    return text
