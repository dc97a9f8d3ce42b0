"""Pages of the documentation that consist of measured results."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from pathlib import Path

import numpy as np
from rwmf import simulate

from reproduce import six_storeys
from reproduce.claims import CLAIMS, evaluate
from reproduce.engines import (
    ENGINES,
    RIGID,
    VALIDATION,
    agrees,
    fitted_restitution,
    measure,
    read,
    stored,
    tolerance,
)
from reproduce.markdown import fill, table
from reproduce.responses import (
    COARSE,
    FORMULATIONS,
    Responses,
    View,
)

__all__ = ["claims_page", "validation_page"]


# scenes and periods [s] of the table of benefits: stiff, mild and flexible frames of the paper
_SCENES = {
    "fig12_one_sine": "one-sine",
    "fig12_one_cosine": "one-cosine",
    "fig13_elcentro_slender_wall": "El Centro, tan alpha = 0.5/2",
    "fig13_elcentro_squat_wall": "El Centro, tan alpha = 1/2",
}
_RANGES = ((0.0, 0.6), (0.6, 1.5), (1.5, 3.0))


def claims_page(of: Responses) -> str:
    """Write the page on the paper's claims."""
    published, exact = (form.label for form in FORMULATIONS)
    heads = ("#", "place", "claim", "counts as reproduced if", published, "verdict", exact,
             "verdict, exact")  # fmt: skip
    rows = []
    for i, claim in enumerate(CLAIMS, start=1):
        found = evaluate(of, claim)
        rows.append((str(i), *claim[:3], found.published.number, found.verdict,
                     found.exact.number, found.exact_verdict))  # fmt: skip
    columns = [[row[i].split(" (")[0] for row in rows] for i in (5, 7)]
    words = ("reproduced", "not reproduced", "depends on Table 1")
    counts = [(word, *(str(column.count(word)) for column in columns)) for word in words]

    def numbers(*beginnings: str) -> str:
        found = [row[0] for row in rows if row[2].startswith(beginnings)]
        if len(found) != len(beginnings):
            raise ValueError(f"claims that begin with {beginnings}: found {found}")
        return _listed(found)

    return fill(
        Path(__file__).with_name("claims.md"),
        count=table(("verdict", published, exact), counts),
        claims=table(heads, rows),
        benefit=_benefit_table(of),
        **{f"of_{n}": _listed(row[0] for row in rows if _shows(row[1], n)) for n in range(4, 14)},
        fig04=numbers("Displacement agrees", "Eq. (15) is a global"),
        assumed=numbers("A restitution of 0.9"),
        dissipates=numbers("The wall dissipates energy"),
        el_centro=numbers("T_s = 0.6 to 1.5 s: the wall amplifies", "T_s > 1.5 s: only gamma"),
    )


def _listed(numbers: Iterable[str]) -> str:
    """Name claims by their numbers."""
    found = list(numbers)
    return ("claim " if len(found) == 1 else "claims ") + ", ".join(found)


def _shows(place: str, figure: int) -> bool:
    """Tell whether a place in the paper, such as 'Sec. 4, Figs 5, 6', is that figure."""
    return str(figure) in re.findall(r"\d+", place.partition("Fig")[2])


def _benefit_table(of: Responses) -> str:
    """Average the ratio of the largest displacements over ranges of periods."""
    rows, T_s = [], np.array(COARSE)
    for name, scene in _SCENES.items():
        alone = of.spectrum_alone(name, COARSE)
        for form in FORMULATIONS:
            found = View(of, form).spectrum(name, COARSE)["u_s_max"].isel(b=0)
            for gamma in (5.0, 10.0, 100.0, 2000.0):
                ratio = found.sel(gamma=gamma).values / alone
                parts = [ratio[(low + 1e-9 < T_s) & (high + 1e-9 >= T_s)] for low, high in _RANGES]
                cells = [f"{x.mean():.2f} ({x.min():.2f} to {x.max():.2f})" for x in parts]
                rows.append((scene, form.label, f"{gamma:g}", *cells))
    heads = ("motion and wall", "form", "gamma", *(f"T_s {a:g} to {b:g} s" for a, b in _RANGES))
    return table(heads, rows)


def validation_page(of: Responses) -> str:
    """Write the page on the validation against engines."""
    return fill(
        Path(__file__).with_name("validation.md"),
        tolerances=_tolerances_table(of),
        differences=_differences_table(of),
        restitution=_restitution_table(of),
        storeys=_storeys_table(of),
        variants=_variants_table(of),
        engines=_engines_table(of),
    )


def _engine_name(engine: str) -> str:
    return ENGINES[engine].split(",")[0]


def _tolerances_table(of: Responses) -> str:
    """List the criteria of agreement for every stored history."""
    rows = []
    for name in VALIDATION:
        for engine, history in stored(of, name).items():
            allowed = tolerance(engine, name)
            rows.append((name, _engine_name(engine), f"{history['t_s'][-1]:g} s",
                         f"{allowed.relative:.1%}", f"{allowed.u_s_rms:.1%}",
                         f"{1e3 * allowed.impact_time:g} ms"))  # fmt: skip
    heads = ("case", "engine", "duration", "peaks, theta rms", "u_s rms", "impact time")
    return table(heads, rows)


def _differences_table(of: Responses) -> str:
    """Compare all variants with all engines."""
    rows = []
    for name, engine, variant, found in measure(of):
        sizes = (found.theta_rms, found.u_s_rms, found.theta_peak, found.u_s_peak)
        same = math.isfinite(found.impact_time)
        rows.append(
            (
                name,
                _engine_name(engine),
                variant,
                *(f"{x:.3%}" if math.isfinite(x) else "-" for x in sizes),
                f"{found.impacts} of {found.engine_impacts}",
                f"{1e3 * found.impact_time:.2f} ms" if same else "-",
                "yes" if agrees(found, tolerance(engine, name)) else "no",
            )
        )
    heads = ("case", "engine", "variant", "theta rms", "u_s rms", "theta peak", "u_s peak",
             "impacts", "impact time", "within tolerance")  # fmt: skip
    return table(heads, rows)


def _restitution_table(of: Responses) -> str:
    """Compare the restitution of engines with a rigid wall with the momentum balance."""
    rows = []
    for name in VALIDATION:
        case, histories = of.engine_case(name), stored(of, name)
        engines = [histories[engine] for engine in RIGID]
        fits = (f"{fitted_restitution(case, history):.5f}" for history in engines)
        slips = (f"{1e3 * float(history.facts['slip_max_m']):.3f} mm" for history in engines)
        rows.append((name, *fits, f"{float(simulate(case)['e_max']):.5f}", *slips))
    names = [_engine_name(engine) for engine in RIGID]
    heads = ("case", *(f"e that fits {name} best" for name in names), "momentum balance",
             *(f"slip of the base, {name}" for name in names))  # fmt: skip
    return table(heads, rows)


def _storeys_table(of: Responses) -> str:
    """Compare drifts and accelerations storey by storey."""
    rows = []
    for name in six_storeys.CASES:
        case, folder = of.engine_case(name), of.validation / "opensees"
        peaks = six_storeys.read_peaks(folder / f"{name}_peaks.csv")[six_storeys.FULL]
        found = six_storeys.compare_frame(case, read(folder / f"{name}.csv"), peaks)
        n = len(peaks) // 2
        for i in range(n):
            cells = [name, str(i + 1)]
            for k, form in ((i, "{:.3%}"), (n + i, "{:.4f} g")):
                cells += [form.format(found.ours[k]), form.format(peaks[k])]
                cells += [f"{found.peak[k]:.4%}", f"{found.history[k]:.4%}"]
            rows.append(cells)
    each = ("of OpenSees", "difference", "over time")
    return table(("case", "storey", "drift", *each, "acceleration", *each), rows)


def _variants_table(of: Responses) -> str:
    """Print the effects of yielding and P-Delta, and the differences without them."""
    rows = []
    for name in six_storeys.CASES:
        case = of.engine_case(name)
        engine = six_storeys.read_peaks(of.validation / "opensees" / f"{name}_peaks.csv")
        for words in six_storeys.VARIANTS:
            peaks = six_storeys.peaks_of(six_storeys.variant(case, words))
            cells = [name, words]
            for values, theirs, shown, end in zip(
                np.split(peaks, 2), np.split(engine[words], 2), ("{:.3%}", "{:.4f} g"), (0, -1),
                strict=True,
            ):  # fmt: skip
                cells += [shown.format(values.max()), shown.format(values[end])]
                cells.append(f"{np.abs(values / theirs - 1).max():.4%}")
            rows.append(cells)
    heads = ("case", "with", "largest drift", "first storey's", "drifts differ by",
             "largest acceleration", "roof's", "accelerations differ by")  # fmt: skip
    return table(heads, rows)


def _engines_table(of: Responses) -> str:
    """List the stored histories with the engine's version and parameters."""
    histories = [(name, x) for name in VALIDATION for x in stored(of, name).values()]
    histories += [(name, read(of.validation / "opensees" / f"{name}.csv"))
                  for name in six_storeys.CASES]  # fmt: skip
    rows = []
    for name, history in histories:
        facts = dict(history.facts)
        engine = str(facts.pop("engine"))
        rows.append((name, engine, ", ".join(f"{k} = {v}" for k, v in facts.items())))
    return table(("case", "engine", "parameters"), rows)
