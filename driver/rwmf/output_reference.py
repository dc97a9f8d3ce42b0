"""The reference of outputs in the documentation, made from the kernel's table of quantities.

``python -m rwmf.output_reference > docs/reference/outputs.md`` makes the page.
"""

from __future__ import annotations

from rwmf.quantities import QUANTITIES, Quantity

_INTRODUCTION = """\
# Outputs

Made by `python -m rwmf.output_reference` from the one table that also orders and labels them
(`src/rwmf/simulation/quantities.f90`).

A key ends with its unit, `over_...` names what a number is divided by; `{i}` is the number of a
floor or storey, from the ground up. What does not apply to a scene is absent. `rwmf.simulate`
returns variables of a dataset under the name in the second column; without one a scalar is an
attribute of the dataset. `rwmf.sweep` keeps any that a spectrum may be asked for, but those of
single storeys.

How a number is found:

| word | meaning |
|---|---|
| row | at the time of each row of a history |
| peak | largest or smallest value at any time, located between the steps of the integrator |
| time | when a peak is reached first |
| end | in the end of the simulation |
| count | number of events |
| whether | yes or no |
| before | known before the simulation begins |
| axis | dimension of a grid |
| work | what the computation took |
| error | estimate, or comparison with something better |
"""
_SECTIONS = {
    "history": "Columns of the history\n\n`CASE.history.csv`, with `&output dt`",
    "run": "Scalars of a run\n\n`rwmf run --json`, `CASE.summary.csv`",
    "spectrum": "Spectra\n\n`rwmf spectrum --json`, `CASE.spectrum.csv`",
    "ordinate": "Ordinates of a spectrum\n\nWhat `&spectrum quantities`, `rwmf spectrum "
    "--quantity`, `rwmf.spectrum(case, quantities=[...])`\nand `values` of a Fortran `spectrum_t` "
    "report of each ordinate when asked: each as a number, 1 for\nyes, 0 for no, NaN for the time "
    "of what did not happen. `&output` need not ask for it as well, only\n`friction_limit` has to "
    "be given there. In Python it is a variable under its name, or under its key",
    "sweep": "Sweeps\n\nBeside the scalars of a run that were asked for",
    "cost": "Comparison of methods\n\n`rwmf cost --json`",
}


def make() -> str:
    """Make the page in Markdown.

    Returns
    -------
    str
        One table for each output, in the order of the kernel's table.
    """
    parts = [_INTRODUCTION.rstrip("\n")]
    for output, title in _SECTIONS.items():
        parts.append(f"\n## {title}.\n\n| key | name | type | unit | meaning | found | present |")
        parts.append("|---|---|---|---|---|---|---|")
        rows = (item for item in QUANTITIES.values() if output in item.outputs.split())
        parts.extend(_row(item, "row" if output == "history" else item.found) for item in rows)
    return "\n".join(parts) + "\n"


def _row(item: Quantity, found: str) -> str:
    conditions = (
        item.group and f"`&{item.group}`",
        item.needs,
        item.asked_by and f"`&output {item.asked_by}`",
    )
    present = ", ".join(filter(None, conditions)) or "always"
    name = f"`{item.name}`" if item.name else ""
    return (
        f"| `{item.key}` | {name} | {item.kind} | {item.unit} | {item.meaning} | {found} "
        f"| {present} |"
    )


if __name__ == "__main__":
    print(make(), end="")
