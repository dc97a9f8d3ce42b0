"""Numbers of a CSV file without those that vary from run to run."""

from __future__ import annotations

import csv
from pathlib import Path

# columns of a summary, keys of JSON objects and attributes: times, a machine, texts
VOLATILE = frozenset({"seconds", "estimate_seconds", "threads", "version", "effects", "warnings"})


def csv_text(path: Path) -> str:
    """Read the numbers of a CSV file of rwmf."""
    with path.open(encoding="utf-8", errors="surrogateescape", newline="") as file:
        rows = list(csv.reader(line for line in file if not line.startswith("#")))
    kept = [i for i, name in enumerate(rows[0]) if name not in VOLATILE]
    lines = ["\t".join(row[i] for i in kept) for row in rows]
    return "\n".join([f"[{path.name}]", *lines]) + "\n"
