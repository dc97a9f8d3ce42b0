"""Tables of the claims and of the validation, as cells of text."""

from __future__ import annotations

import csv
import math
from collections.abc import Sequence
from dataclasses import dataclass

from rwmf._simulation import simulate
from rwmf.case import Case
from rwmf.errors import InputError

from reproduce.claims import Judgement, evaluate
from reproduce.claims_histories import CLAIMS as HISTORY_CLAIMS
from reproduce.claims_spectra import CLAIMS as SPECTRUM_CLAIMS
from reproduce.engines import Difference, EngineHistory
from reproduce.histories import ENGINES, RIGID, VALIDATION, stored
from reproduce.response_cache import ResponseCache
from reproduce.six_storeys import CASES as FRAMES
from reproduce.six_storeys import frame_history
from reproduce.validation import Row, agrees, fitted_restitution, measure, tolerance

__all__ = [
    "Table",
    "claims_table",
    "contact_table",
    "differences_table",
    "engines_table",
    "markdown",
    "restitution_table",
    "tolerances_table",
    "verdicts_table",
]


@dataclass(frozen=True)
class Table:
    """Cells of text under heads.

    Attributes
    ----------
    heads : tuple of str
        One a column.
    rows : list of tuple of str
        The cells.
    """

    heads: tuple[str, ...]
    rows: list[tuple[str, ...]]


def markdown(table: Table) -> str:
    """Write a table for a Markdown page."""
    rows: list[Sequence[str]] = [table.heads, ["---"] * len(table.heads), *table.rows]
    lines = ("| " + " | ".join(cell.replace("|", r"\|") for cell in row) + " |" for row in rows)
    return "\n".join(lines) + "\n"


def claims_table(cache: ResponseCache) -> Table:
    """Judge every claim."""
    heads = (
        "#",
        "place",
        "claim",
        "counts as reproduced if",
        "as published, e = 0.9",
        "verdict",
        "exact, momentum balance",
        "verdict, exact",
    )
    verdicts = [evaluate(cache, claim) for claim in (*HISTORY_CLAIMS, *SPECTRUM_CLAIMS)]
    return Table(heads, [_claim_row(i, found) for i, found in enumerate(verdicts, start=1)])


def _claim_row(i: int, found: Judgement) -> tuple[str, ...]:
    claim = found.claim
    return (
        str(i),
        claim.place,
        claim.text,
        claim.criterion,
        found.published.number,
        found.verdict,
        found.exact.number,
        found.exact_verdict,
    )


def verdicts_table(claims: Table) -> Table:
    """Count the verdicts."""
    columns = [[row[i].split(" (")[0] for row in claims.rows] for i in (5, 7)]
    words = ("reproduced", "not reproduced", "depends on Table 1")
    rows = [(word, *(str(column.count(word)) for column in columns)) for word in words]
    return Table(("verdict", claims.heads[4], claims.heads[6]), rows)


def differences_table(cache: ResponseCache) -> Table:
    """Compare all variants with all engines."""
    heads = (
        "case",
        "engine",
        "variant",
        "theta rms",
        "u_s rms",
        "theta peak",
        "u_s peak",
        "impacts",
        "impact time",
        "within tolerance",
    )
    return Table(heads, [_difference_row(row) for row in measure(cache)])


def _difference_row(row: Row) -> tuple[str, ...]:
    found: Difference = row.difference
    same = math.isfinite(found.impact_time)
    return (
        row.case,
        _engine_name(row.engine),
        row.variant,
        _percent(found.theta_rms),
        _percent(found.u_s_rms),
        _percent(found.theta_peak),
        _percent(found.u_s_peak),
        f"{found.impacts} of {found.engine_impacts}",
        f"{1e3 * found.impact_time:.2f} ms" if same else "-",
        "yes" if agrees(found, tolerance(row.engine, row.case)) else "no",
    )


def tolerances_table(cache: ResponseCache) -> Table:
    """List the criteria of agreement for every stored history."""
    heads = ("case", "engine", "duration", "peaks, theta rms", "u_s rms", "impact time")
    rows: list[tuple[str, ...]] = []
    for name in VALIDATION:
        for engine, history in stored(cache, name).items():
            allowed = tolerance(engine, name)
            rows.append(
                (
                    name,
                    _engine_name(engine),
                    f"{history['t_s'][-1]:g} s",
                    f"{allowed.relative:.1%}",
                    f"{allowed.u_s_rms:.1%}",
                    f"{1e3 * allowed.impact_time:g} ms",
                )
            )
    return Table(heads, rows)


def contact_table(cache: ResponseCache, name: str) -> Table:
    """Read how far the exact form is from an engine with other settings of the contact."""
    path = cache.validation / name
    try:
        with path.open(encoding="utf-8", newline="") as stream:
            heads, *rows = csv.reader(stream)
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: not a table of variants: {error}") from error
    return Table(tuple(heads), [tuple(row) for row in rows])


def restitution_table(cache: ResponseCache) -> Table:
    """Compare the restitution of engines with a rigid wall with the momentum balance."""
    rows: list[tuple[str, ...]] = []
    for name in VALIDATION:
        case = Case.from_namelist(cache.validation / f"{name}.nml")
        histories = stored(cache, name)
        engines = [histories[engine] for engine in RIGID]
        rows.append(
            (
                name,
                *(f"{fitted_restitution(case, history):.5f}" for history in engines),
                f"{float(simulate(case)['e_max']):.5f}",
                *(f"{1e3 * float(history.facts['slip_max_m']):.3f} mm" for history in engines),
            )
        )
    names = [_engine_name(engine) for engine in RIGID]
    fits = (f"e that fits {name} best" for name in names)
    slips = (f"slip of the base, {name}" for name in names)
    return Table(("case", *fits, "momentum balance", *slips), rows)


def engines_table(cache: ResponseCache) -> Table:
    """List the stored histories with the engine's version and parameters."""
    rows: list[tuple[str, ...]] = []
    for name in VALIDATION:
        rows += [_engine_row(name, history) for history in stored(cache, name).values()]
    rows += [_engine_row(name, frame_history(cache, name)) for name in FRAMES]
    return Table(("case", "engine", "parameters"), rows)


def _engine_row(name: str, history: EngineHistory) -> tuple[str, ...]:
    facts = dict(history.facts)
    engine = str(facts.pop("engine"))
    return name, engine, ", ".join(f"{k} = {v}" for k, v in facts.items())


def _engine_name(engine: str) -> str:
    return ENGINES[engine].split(",")[0]


def _percent(value: float) -> str:
    return f"{value:.3%}" if math.isfinite(value) else "-"
