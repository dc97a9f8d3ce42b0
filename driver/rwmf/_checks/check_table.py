"""Tables of checks as text and CSV."""

from __future__ import annotations

import csv
import io
import math
import os
from collections.abc import Iterable
from itertools import groupby
from typing import Any

from rwmf._checks.checks import PERCENTILES, Checks, LimitCheck
from rwmf._files import files
from rwmf.quantities import find_numbered

# ratios from here on have four digits
_LONG = 1e4


def text_of(found: Checks, *, is_all: bool = False) -> str:
    """Return checks as a table."""
    rows = [_title_row(found)]
    for at, part in groupby(found.rows, key=lambda row: row.at):
        if at:
            rows.append([", ".join(f"{name} = {_show(value)}" for name, value in at.items())])
        rows += [_cells(row, number) for row, number in _shown(part, is_all=is_all)]
    widths = [max(len(row[i]) for row in rows if len(row) > 1) for i in range(len(rows[0]))]
    lines = [
        row[0]
        if len(row) == 1
        else "  ".join(
            [f"{row[0]:{widths[0]}s}"]
            + [f"{cell:>{width}s}" for cell, width in zip(row[1:], widths[1:], strict=True)]
        ).rstrip()
        for row in rows
    ]
    return "\n".join([*lines, _verdict(found)])


def _title_row(found: Checks) -> list[str]:
    if found.rows[0].demands:
        ends = ["max" if q == PERCENTILES[-1] else f"{q:g} %" for q in PERCENTILES]
        return ["ratios over limits", "limit", *ends, "above", ""]
    drift = [] if found.rows[0].drift_at_limit is None else ["reached at"]
    return ["checks", "demand", "limit", "ratio", *drift, ""]


def _shown(rows: Iterable[LimitCheck], *, is_all: bool) -> list[tuple[LimitCheck, str]]:
    """Choose the rows of a table, each with a note on its floor or storey."""
    shown = []
    for (key, level), part in groupby(rows, key=lambda row: _pattern(row.key)):
        members = list(part)
        if is_all or not level:
            shown += [(row, "") for row in members]
            continue
        worst = max(members, key=lambda row: -1.0 if math.isnan(row.ratio) else row.ratio)
        note = f" ({level} {worst.number})" if len(members) > 1 else ""
        shown.append((worst, f"{key}{note}"))
    return shown


def _pattern(key: str) -> tuple[str, str]:
    quantity, _ = find_numbered(key)
    return quantity.limit_key, quantity.level


def _cells(row: LimitCheck, label: str) -> list[str]:
    name = label or row.key
    verdict = "" if row.is_met else ("no demand" if math.isnan(row.ratio) else "EXCEEDED")
    if not row.demands:
        drift = []
        if row.drift_at_limit is not None:
            is_reached = not math.isnan(row.drift_at_limit)
            drift = [f"{100 * row.drift_at_limit:.4g} %" if is_reached else ""]
        return [name, f"{row.demand:.5g}", f"{row.limit:.5g}", _ratio(row.ratio), *drift, verdict]
    ratios = [_ratio(row.ratios[q]) for q in PERCENTILES]
    above = f"{100 * row.share_above:.3g} %"
    return [name, f"{row.limit:.5g}", *ratios, above, verdict]


def _verdict(found: Checks) -> str:
    """Summarise all checks in one line."""
    worst = found.worst
    missed = sum(not row.is_met for row in found.rows)
    text = f"all {len(found.rows)} limits are met" if not missed else (
        f"{missed} of {len(found.rows)} limits are not met"
    )  # fmt: skip
    text += f"; largest ratio {_ratio(worst.ratio)} of {worst.key}"
    if found.ended and worst.drift_at_limit is not None:
        text += "; THE CURVE ENDS EARLY, demands are those until then"
    elif found.ended:
        text += f"; {found.ended} runs overturned or collapsed" if found.runs > 1 else (
            "; THE RUN OVERTURNED OR COLLAPSED, demands are those until then"
        )  # fmt: skip
    if found.absent:
        text += f"\nno demand of a static curve: {', '.join(found.absent)}"
    return text + (f"; {found.failed} runs failed and are not counted" if found.failed else "")


def _ratio(ratio: float) -> str:
    return f"{ratio:.3f}" if not abs(ratio) >= _LONG else f"{ratio:.4g}"


def _show(value: Any) -> str:  # noqa: ANN401 (a number or a text)
    return f"{value:g}" if isinstance(value, float) else str(value)


def write_csv(found: Checks, path: str | os.PathLike[str]) -> None:
    """Write checks as CSV, one row for each limit, floor, storey and point of a grid."""
    rows = [row.to_dict() for row in found.rows]
    text = io.StringIO()
    writer = csv.DictWriter(text, list(dict.fromkeys(key for row in rows for key in row)))
    writer.writeheader()
    writer.writerows(
        {key: repr(value) if isinstance(value, float) else value for key, value in row.items()}
        for row in rows
    )
    files.write_bytes(path, text.getvalue().encode())
