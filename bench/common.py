"""Parts that the programs of this folder share: places, stored tables, alternating times."""

import csv
import sys
import time
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

from reproduce.markdown import fill as fill
from reproduce.markdown import table as table

ROOT = Path(__file__).resolve().parent.parent
RECORD = {
    "kind": "record",
    "file": str(ROOT / "inputs" / "records" / "elcentro.csv"),
    "unit": "g",
}
# scenes of the tests
sys.path.append(str(ROOT / "tests" / "support"))


def read_rows(path: Path, kinds: Sequence[Callable[[str], object]]) -> list[list[object]]:
    """Read the rows of a stored table, each column by its kind."""
    with path.open(encoding="utf-8", newline="") as stream:
        _, *rows = csv.reader(stream)
    return [[kind(x) for kind, x in zip(kinds, row, strict=True)] for row in rows]


def write_rows(path: Path, heads: Sequence[str], rows: Iterable[Sequence[object]]) -> None:
    """Store rows, numbers to three digits."""
    with path.open("w", encoding="utf-8", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(heads)
        for row in rows:
            writer.writerow([f"{x:.3g}" if isinstance(x, float) else x for x in row])


def least(calls: dict[str, Callable[[], float]], rounds: int = 5) -> dict[str, float]:
    """Return the least of the times [s] that each call gives, measured in turn."""
    times = [[call() for call in calls.values()] for _ in range(rounds)]
    return dict(zip(calls, map(min, zip(*times, strict=True)), strict=True))


def spent(call: Callable[[], object], clock: Callable[[], float] = time.process_time) -> float:
    """Return the time that a call takes [s]."""
    begin = clock()
    call()
    return clock() - begin
