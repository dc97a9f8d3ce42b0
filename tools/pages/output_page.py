"""The reference of outputs in the documentation, made from the kernel's table of quantities."""

from __future__ import annotations

from rwmf.quantities import QUANTITIES, SENSITIVITY, Quantity

from pages.blocks import text_of

_SECTIONS = {
    "history": "Columns of the history\n\n`CASE.history.csv`, with `&output dt`",
    "run": "Scalars of a run\n\n`rwmf run --json`, `CASE.summary.csv`",
    "spectrum": "Spectra\n\n`rwmf spectrum --json`, `CASE.spectrum.csv`",
    "ordinate": "Ordinates of a spectrum\n\nRequest them by `&spectrum quantities`, `rwmf spectrum "
    "--quantities` or\n`rwmf.spectrum(case, quantities=[...])`; a Fortran host finds them in "
    "`values` of `spectrum_t`.\nYes is 1, no is 0, and the time of an event that did not happen is "
    "NaN. `&output` needs only\n`friction_limit`. In Python each quantity is a variable under its "
    "name, or under its key",
    "sweep": "Sweeps\n\nA sweep adds these to the requested scalars of a run",
    "cost": "Comparison of methods\n\n`rwmf cost --json`, where `seconds` is processor time",
}


def make() -> str:
    """Make the page in Markdown."""
    parts = [text_of("outputs.md").rstrip("\n")]
    for output, title in _SECTIONS.items():
        parts.append(f"\n## {title}.\n\n| key | name | type | unit | meaning | found | present |")
        parts.append("|---|---|---|---|---|---|---|")
        rows = (
            item
            for item in QUANTITIES.values()
            if output in item.outputs.split() and not item.key.startswith(SENSITIVITY)
        )
        parts.extend(_row(item, output) for item in rows)
    return "\n".join(parts) + "\n"


def _row(item: Quantity, output: str) -> str:
    conditions = (
        item.group and f"`&{item.group}`",
        item.needs,
        item.asked_by and f"`&output {item.asked_by}`",
    )
    present = ", ".join(filter(None, conditions)) or "always"
    name = ", ".join(f"`{name}`" for name in item.names(output))
    found = "row" if output == "history" else item.found
    return (
        f"| `{item.key}` | {name} | {item.kind} | {item.unit} | {item.meaning} | {found} "
        f"| {present} |"
    )
