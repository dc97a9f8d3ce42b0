"""Standard calls and their cases."""

from __future__ import annotations

import re
from pathlib import Path
from typing import NamedTuple

SECONDS_OF_RECORD = 5.0
"""El Centro up to here [s]; its strongest part begins at 2 s."""
RECORD = "elcentro.csv"
"""Its file beside the cases."""


class Call(NamedTuple):
    """A standard call.

    Attributes
    ----------
    name : str
        Name of the count.
    kind : str
        ``run``, ``spectrum``, ``stepping``, ``element`` (``bench/standard_calls.f90``), ``batch``
        (the batch program), ``simulate``, ``sweep``, ``sweep_runs`` (``in_python.py``).
    case : str
        Its groups.
    """

    name: str
    kind: str
    case: str

    @property
    def program(self) -> str:
        """Program that makes the call: ``host``, ``batch`` or ``python``."""
        if self.kind in ("run", "spectrum", "stepping", "element"):
            return "host"
        return "batch" if self.kind == "batch" else "python"

    def write(self, folder: Path) -> Path:
        """Write the case."""
        path = folder / f"{self.name}.nml"
        path.write_text(self.case, encoding="utf-8")
        return path


CALLS = tuple(
    Call(*found)
    for found in re.findall(
        r"^! (\w+) (\w+)\n((?:.+\n)+)",
        Path(__file__).with_suffix(".nml").read_text(encoding="utf-8"),
        re.MULTILINE,
    )
)
NAMES = tuple(call.name for call in CALLS)


def write_record(source: Path, folder: Path) -> None:
    """Cut the exported record of El Centro (two columns, time in s) for the cases in a folder."""
    lines = source.read_text(encoding="utf-8").splitlines()
    kept = [line for line in lines if not line.startswith("#")]
    head, samples = kept[0], kept[1:]
    short = [line for line in samples if float(line.split(",")[0]) <= SECONDS_OF_RECORD]
    (folder / RECORD).write_text("\n".join([head, *short]) + "\n", encoding="utf-8")
