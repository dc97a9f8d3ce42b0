"""The reference of outputs in the documentation, made from the kernel's table of quantities."""

from __future__ import annotations

from rwmf.quantities import QUANTITIES, SENSITIVITY, Quantity

_INTRODUCTION = """\
# Outputs

For users who read results: this page gives key, name, unit and meaning of every output, and the
condition under which a run reports it. `tools/docs --made` generates it from
`src/rwmf/problem/quantity_table.f90`. The [glossary](glossary.md) explains the terms.

A **key** appears in CSV and JSON and ends with its unit. `over_...` names the divisor, and `{i}` is
the number of a floor or storey, from the ground up. A run omits quantities that do not apply.

A **name** is a variable in a Python dataset, with its unit in `attrs['units']` and its meaning in
`attrs['long_name']`. A final value whose history has the same name ends with `_end`. Two names in
one row give the same numbers. You may request a quantity by name or key, in capital or small
letters.

Quantities that describe the computation have no name: they are attributes of the dataset, and
variables over a grid. In the dataset of a run, a name with `{i}` is one variable over `storey` or
`floor`: `storeys_drift_max` holds every `storey_{i}_drift_max`
([storeys](../howto/buildings.md)). `rwmf.sweep` accepts every named quantity that a spectrum can
report. For the axes `T_s_s`, `gamma` and `b_m` of storeys see
[theory](../theory/storeys.md#axes).

The column *found* uses these words:

| word | meaning |
|---|---|
| row | at the time of each row of a history |
| peak | largest or smallest value at any time, located between the steps of the integrator |
| time | first time of a peak |
| end | at the end of the simulation |
| count | number of events |
| whether | yes or no |
| before | known before the simulation begins |
| axis | dimension of a grid |
| work | effort of the computation |
| error | estimated error, or difference from a more accurate result |

## Sensitivity and digits of a peak

Errors depend on `&solver rtol` and on the sensitivity S, the relative change of a quantity per
relative change of the motion, at least 1. Each peak of a run has a real number
`sensitivity_KEY`, in Python `sensitivity_NAME`, beside it, if the case has a motion.
`&output conditioning = .false.` omits these numbers; spectra and sweeps have them with
`conditioning = .true.`, or by name. The tables below do not repeat them.

* A second run with a stronger motion gives its value. The motion changes by 1e-5, or by 100 times
  `rtol` or `accuracy` if that is larger, at most 1 %. S is at most the inverse of this change.
* From S = 100 a run has a warning that begins with `sensitive`: a motion that is 1 % stronger may
  change a peak by its own size. The status does not change.
* `rwmf run` prints the digits of a peak that hold: against an error of 10 `rtol` S, and against a
  change of the motion by 1e-7. Times and final values have the digits of the worst peak.
* Where the second run changes a peak by more than 1 %, one digit or two remain. JSON and CSV have
  all digits.

Largest errors:

| quantity | largest error |
|---|---|
| peak of a floor acceleration | 100 `rtol` S of its value |
| part of the energy ledger | 100 `rtol` S of the largest part: a small part has fewer digits |

The peak of the friction demand is infinite if the pivot lifts, and S is large if its vertical
reaction nearly vanishes.
"""
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
    parts = [_INTRODUCTION.rstrip("\n")]
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
