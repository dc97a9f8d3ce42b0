"""Subcommand ``rwmf reproduce``, which runs code of the project's checkout.

The package in the folder ``plots`` makes the paper's figures and tables from cases and stored
histories of the checkout; none of them is installed.
"""

from __future__ import annotations

import argparse
import sys
from importlib import import_module
from pathlib import Path

import rwmf
from rwmf.errors import InputError

__all__ = ["find_checkout", "run"]

# files that identify the checkout
_MARK = Path("plots", "reproduce", "command.py")


def find_checkout() -> Path:
    """Find the project's checkout."""
    package = Path(rwmf.__path__[0]).resolve()
    current = Path.cwd()
    for folder in (*package.parents, current, *current.parents):
        if (folder / _MARK).is_file():
            return folder
    raise InputError(
        "reproduce needs the checkout of the project, with its cases and stored histories: run it "
        f"there; neither {current} nor {package} lies in one"
    )


def run(options: argparse.Namespace) -> int:
    """Draw figures and write tables (``rwmf reproduce``)."""
    checkout = find_checkout()
    for name in ("inputs", "validation"):
        setattr(options, name, getattr(options, name) or checkout / name)
    options.out = options.out or checkout / "build" / "plots"
    sys.path.insert(0, str(checkout / "plots"))
    status: int = import_module("reproduce.command").run(options)
    return status
