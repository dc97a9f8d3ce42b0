"""Subcommand ``rwmf gradient``."""

from __future__ import annotations

import argparse

from rwmf._gradient.gradient import gradient
from rwmf.case import Case
from rwmf.cli.gradient_output import print_gradient
from rwmf.cli.output import print_json


def run(options: argparse.Namespace) -> int:
    """Print derivatives (``rwmf gradient``)."""
    case = Case.from_namelist(options.case)
    found = gradient(
        case,
        _words(options.parameters) or None,
        _words(options.quantities) or None,
        records=options.records,
        statistic=options.statistic,
        unit=options.unit,
        threads=options.threads,
    )
    if options.json:
        names = [*found.data_vars, "parameter_value", "parameter_scale"]
        print_json(
            {"quantity": found["quantity"].values.tolist()}
            | {"parameter": found["parameter"].values.tolist()}
            | {str(name): found[name].values for name in names}
            | ({"record": found["record"].values.tolist()} if "record" in found.dims else {})
            | {"runs": int(found.attrs["runs"])}
        )
    else:
        print_gradient(found)
    return 0


def _words(items: list[str] | None) -> list[str]:
    return [word for item in items or [] for word in item.split(",") if word]
