"""Makes docs/validation/accuracy.md and its figures on the cost of accuracy.

.venv/bin/python bench/accuracy.py     (about two minutes)
"""

import math
import platform
import re
from collections.abc import Callable
from pathlib import Path

import rwmf
from common import ROOT, fill, table
from rwmf.assess.cost import METHODS, PAPER, PRACTICES, Cost, Row, cheapest
from rwmf.figures import image_files as figures
from rwmf.figures import results as plot_cost
from rwmf.figures.styles import legend_below, new_figure

# namelist in inputs/ without suffix, description
CASES = {
    "fig05_stiff_frame_one_sine": "one-sine, γ = 1800, T_s = 0.4 s",
    "accuracy_sine_flexible_frame": "one-sine, γ = 1800, T_s = 2 s",
    "fig08_mild_frame_mass_ratio_5": "one-cosine, γ = 5, T_s = 1 s",
    "accuracy_elcentro_0p4s": "El Centro, γ = 5, T_s = 0.4 s",
    "accuracy_elcentro_1s": "El Centro, γ = 5, T_s = 1 s",
    "accuracy_elcentro_2s": "El Centro, γ = 5, T_s = 2 s",
    "accuracy_pacoima": "Pacoima Dam, γ = 5, T_s = 1 s",
    "accuracy_block_near_overturning": "free block, 0.1 % below overturning",
}
# the two of the README's figure
SHORT = ("fig05_stiff_frame_one_sine", "accuracy_elcentro_1s")
TARGETS = (1e-3, 1e-6, 1e-9, 1e-12)
TEXT = Path(__file__).with_name("accuracy_text.md")


def main() -> None:
    """Measure, draw, write."""
    found: dict[str, Cost] = {}
    sensitivity: dict[str, float] = {}
    for name in CASES:
        case = rwmf.Case.from_namelist(ROOT / "inputs" / f"{name}.nml")
        found[name] = rwmf.cost(case)
        sensitivity[name] = _sensitivity(case)
        print(f"{name}: reference {found[name].reference['relative_error']:.0e}", flush=True)
    _draw(found, tuple(CASES), 2, ROOT / "plots" / "accuracy_cases.png")
    _draw(found, SHORT, 2, ROOT / "plots" / "accuracy.png")
    parts = {
        "machine": _machine(),
        "settings": _settings_table(found, sensitivity),
        "practices": table(
            ["case", "`paper`, 1e-3", *(label for label, _, _ in PRACTICES), "`dop853`, 1e-9"],
            _rows(found, _practices),
        ),
        "digits": _by_method(found, _digit),
        "floors": _by_method(found, _floor),
    }
    (ROOT / "docs" / "validation" / "accuracy.md").write_text(fill(TEXT, **parts), encoding="utf-8")


def _sensitivity(case: rwmf.Case) -> float:
    """Relative change of the peak per relative change of the motion [-]."""
    verified = case.replace(solver={"method": "dop853", "rtol": 1e-9, "verify": True})
    return float(rwmf.simulate(verified).attrs["sensitivity"])


def _machine() -> str:
    """Name of the processor, as far as the system tells."""
    path = Path("/proc/cpuinfo")
    names = re.findall(
        r"model name\s*: (.*)", path.read_text(encoding="utf-8") if path.exists() else ""
    )
    return names[0] if names else platform.machine()


def _draw(found: dict[str, Cost], names: tuple[str, ...], columns: int, path: Path) -> None:
    """Panels with one legend below."""
    rows = math.ceil(len(names) / columns)
    with new_figure(2.9 * rows + 0.6) as figure:
        axes = figure.subplots(rows, columns, sharey=True, squeeze=False)
        for ax, name in zip(axes.ravel(), names, strict=True):
            plot_cost.work_precision(found[name], ax, legend=False)
            ax.set_title(CASES[name].replace("T_s", "$T_s$"))
            ax.label_outer()
            ax.tick_params(labelbottom=True)
            ax.set_ylabel(ax.get_ylabel() if ax in axes[:, 0] else "")
        legend_below(figure, axes[0, 0])
        figures.save(figure, path)


def _rows(found: dict[str, Cost], cells: Callable[[Cost], list[str]]) -> list[list[str]]:
    """Return the rows of a table: a case, and cells from its cost."""
    return [[CASES[name], *cells(cost)] for name, cost in found.items()]


def _settings_table(found: dict[str, Cost], sensitivity: dict[str, float]) -> str:
    """Cheapest setting for each target."""
    heads = ["case", "κ", "error of the reference", *(f"for {target:.0e}" for target in TARGETS)]
    rows = _rows(
        found,
        lambda cost: [
            f"{cost.reference['relative_error']:.0e}",
            *(_setting(cheapest(cost.rows, target)) for target in TARGETS),
        ],
    )
    kappas = (f"{value:.2g}" for value in sensitivity.values())
    return table(heads, ([row[0], x, *row[1:]] for row, x in zip(rows, kappas, strict=True)))


def _setting(row: Row | None) -> str:
    if row is None:
        return "not reached"
    return f"`{row.method}` {row.rtol:.0e}: {_milliseconds(row)}"


def _milliseconds(row: Row) -> str:
    return f"{1e3 * row.seconds:.2g} ms"


def _practices(cost: Cost) -> list[str]:
    """Error and time of common procedures beside one of ours."""
    loose, tight = (
        [row for row in cost.rows if row.method == method and 0.5 < row.rtol / rtol < 2]
        for method, rtol in ((PAPER, 1e-3), ("dop853", 1e-9))
    )
    cells = [_error(row, cost) for row in [*loose, *cost.practices, *tight]]
    return [*([] if loose else ["-"]), *cells]


def _error(row: Row, cost: Cost) -> str:
    if row.status != "ok":
        return "fails"
    if row.overturned != cost.reference["overturned"]:
        return f"**overturns**, {_milliseconds(row)}"
    percent = 100 * row.relative_error
    size = f"{percent:.2g} %" if percent >= 0.001 else f"{row.relative_error:.0e}"
    return f"{size}, {_milliseconds(row)}"


def _digit(rows: list[Row]) -> str:
    """Factor on the time for another digit: tolerance 1e-4 against 1e-10."""
    fine = [row for row in rows if row.status == "ok"]
    loose, tight = (min(fine, key=lambda row: abs(row.rtol - rtol)) for rtol in (1e-4, 1e-10))
    return f"{(tight.seconds / loose.seconds) ** (1 / 6):.2f}"


def _floor(rows: list[Row]) -> str:
    """Smallest error that a method reaches."""
    return f"{min(row.relative_error for row in rows):.0e}"


def _by_method(found: dict[str, Cost], cell: Callable[[list[Row]], str]) -> str:
    """Return a table with a column for each method."""
    rows = _rows(
        found,
        lambda cost: [cell([row for row in cost.rows if row.method == method])
                      for method in METHODS],
    )  # fmt: skip
    return table(["case", *(f"`{method}`" for method in METHODS)], rows)


if __name__ == "__main__":
    main()
