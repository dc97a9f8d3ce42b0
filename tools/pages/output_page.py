"""The reference of outputs in the documentation, made from the kernel's table of quantities."""

from __future__ import annotations

from rwmf.quantities import QUANTITIES, Quantity

_INTRODUCTION = """\
# Outputs

Made by `tools/docs --made` from the one table that also orders and labels them
(`src/rwmf/problem/quantity_table.f90`).

A **key** stands in CSV and JSON and ends with its unit; `over_...` says what a number is divided
by, `{i}` is the number of a floor or storey, from the ground up. What does not apply to a scene is
absent.

A **name** is that of a variable in a dataset of Python. It has no unit: `attrs['units']` of the
variable says it, `attrs['long_name']` the meaning. A number at the end that has a history under the
same name ends with `_end`. Where two names stand, both lead to the same numbers; the second one
has a unit and is there for programs that know it. Names and keys are taken alike wherever
quantities are asked for, in any letters; a sweep calls its variable by the one of two names that it
was asked for by.

A number that describes the response is a variable. How the whole computation was done and what it
took is without a name: an attribute of the dataset under its key, and over a grid a variable under
its key. `rwmf.sweep` keeps any named quantity that a spectrum may be asked for.

Axes of a grid (`T_s_s`, `gamma`, `b_m`) may be more than a key of the case: of `&storeys` and of a
wall without a frame other numbers follow them. What they are in a scene is the `long_name` of the
coordinate and stands above the columns of a CSV file ([theory](../theory/theory.md), "Axes").

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

Errors depend on `&solver rtol` and on the sensitivity S, the relative change of a quantity per
relative change of the motion, at least 1:

| quantity | largest error |
|---|---|
| peak of a floor acceleration | 100 `rtol` S of its value |
| part of the energy ledger | 100 `rtol` S of the largest part: a small part has fewer digits |

A peak of the friction demand is infinite where the pivot lifts, and S is large where it hardly
does not.
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
