"""Tables of the frame of six storeys against OpenSees, as cells of text."""

from __future__ import annotations

import numpy as np
from rwmf.case import Case

from reproduce.response_cache import ResponseCache
from reproduce.six_storeys import (
    CASES,
    FULL,
    VARIANTS,
    compare_frame,
    frame_history,
    peaks_of,
    read_peaks,
    variant,
)
from reproduce.tables import Table

__all__ = ["storeys_table", "variants_table"]


def storeys_table(cache: ResponseCache) -> Table:
    """Compare drifts and accelerations storey by storey."""
    heads = (
        "case",
        "storey",
        "drift",
        "of OpenSees",
        "difference",
        "over time",
        "acceleration",
        "of OpenSees",
        "difference",
        "over time",
    )
    rows: list[tuple[str, ...]] = []
    for name in CASES:
        case = Case.from_namelist(cache.validation / f"{name}.nml")
        peaks = read_peaks(cache.validation / "opensees" / f"{name}_peaks.csv")[FULL]
        found = compare_frame(case, frame_history(cache, name), peaks)
        n = len(peaks) // 2
        for i in range(n):
            cells = [name, str(i + 1)]
            for k, form in ((i, "{:.3%}"), (n + i, "{:.4f} g")):
                cells += [form.format(found.ours[k]), form.format(found.theirs[k])]
                cells += [f"{found.peak[k]:.4%}", f"{found.history[k]:.4%}"]
            rows.append(tuple(cells))
    return Table(heads, rows)


def variants_table(cache: ResponseCache) -> Table:
    """Print the effects of yielding and P-Delta, and the differences without them."""
    heads = (
        "case",
        "with",
        "largest drift",
        "first storey's",
        "drifts differ by",
        "largest acceleration",
        "roof's",
        "accelerations differ by",
    )
    rows: list[tuple[str, ...]] = []
    for name in CASES:
        case = Case.from_namelist(cache.validation / f"{name}.nml")
        engine = read_peaks(cache.validation / "opensees" / f"{name}_peaks.csv")
        for words in VARIANTS:
            peaks = peaks_of(variant(case, words))
            drifts, floors = np.split(peaks, 2)
            differences = np.split(peaks / engine[words] - 1, 2)
            rows.append(
                (
                    name,
                    words,
                    f"{drifts.max():.3%}",
                    f"{drifts[0]:.3%}",
                    f"{np.abs(differences[0]).max():.4%}",
                    f"{floors.max():.4f} g",
                    f"{floors[-1]:.4f} g",
                    f"{np.abs(differences[1]).max():.4%}",
                )
            )
    return Table(heads, rows)
