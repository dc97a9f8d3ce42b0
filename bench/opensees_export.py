"""Exported scripts in OpenSees beside rwmf: each group alone, and ten buildings.

``python bench/opensees_export.py [NAME ...]`` exports the cases of
``tests/support/exported_scenes.py``, runs the scripts, writes ``validation/opensees/export.csv``
and prints it as a table. It needs RWMF_OPENSEES, a Python that has ``openseespy``; it may be this
one.
"""

import sys
import tempfile
from pathlib import Path
from typing import NamedTuple

import numpy as np
from common import ROOT, read_rows, table, write_rows
from rwmf.hosts.opensees_script import Demand, compare_with_opensees, opensees_script, run_opensees

from exported_scenes import CASES, case_of  # isort: skip

STORE = ROOT / "validation" / "opensees" / "export.csv"


class Row(NamedTuple):
    """Largest differences of a case, NaN without a value; contacts and their time left out."""

    case: str
    drift_percent: float
    acceleration_percent: float
    impacts: int
    impact_ms: float
    contacts: int
    left_out_ms: float


def largest(found: list[Demand], words: str) -> float:
    """Return the largest difference of the demands whose names have a word."""
    sizes = [abs(demand.difference) for demand in found if words in demand.name]
    return max(sizes, default=np.nan)


def compare(name: str) -> Row:
    """Export and run a case."""
    case = case_of(CASES[name])
    with tempfile.TemporaryDirectory() as folder:
        script = Path(folder) / "script.py"
        script.write_text(opensees_script(case), encoding="utf-8")
        answer = run_opensees(script)
    found = compare_with_opensees(case, answer)
    left_out = dict(answer["left_out"])
    # a single mass has no storeys
    drift = "drift" if case.storeys is not None else "u_s_max"
    row = Row(
        name,
        1e2 * largest(found, drift),
        1e2 * largest(found, "acceleration"),
        sum("impact" in demand.name for demand in found),
        1e3 * largest(found, "impact"),
        left_out["contacts"],
        1e3 * left_out["time_s"],
    )
    print(row, file=sys.stderr, flush=True)
    return row


def cells(row: Row) -> list[str]:
    """Write a row of the table of a page."""
    drift, acceleration = (
        "-" if np.isnan(x) else f"{x:.2g}" for x in (row.drift_percent, row.acceleration_percent)
    )
    impact = f"{row.impact_ms:.2g} ({row.impacts})" if row.impacts else "-"
    left_out = f"{row.left_out_ms:.0f} ({row.contacts})" if row.contacts else "-"
    return [row.case, drift, acceleration, impact, left_out]


def main() -> None:
    """Compute all cases, or those given; print the table."""
    kinds = (str, float, float, int, float, int, float)
    rows = {str(row[0]): Row(*row) for row in read_rows(STORE, kinds)}
    for name in sys.argv[1:] or CASES:
        rows[name] = compare(name)
        write_rows(STORE, Row._fields, (rows[known] for known in CASES if known in rows))
    heads = ("case", "drift [%]", "acceleration [%]", "impacts [ms] (compared)",
             "left out [ms] (contacts)")  # fmt: skip
    print(table(heads, (cells(rows[known]) for known in CASES if known in rows)))


if __name__ == "__main__":
    main()
