"""Subcommand ``rwmf records``."""

from __future__ import annotations

import argparse

from rwmf import records

__all__ = ["export", "show"]


def show(_: argparse.Namespace) -> int:
    """List the records (``rwmf records list``).

    Parameters
    ----------
    _ : argparse.Namespace
        Unused.

    Returns
    -------
    int
        Exit status.

    Raises
    ------
    InputError
        When a file of the package cannot be read.
    """
    print("\n".join(records.list_records()))
    return 0


def export(options: argparse.Namespace) -> int:
    """Write a record into a file (``rwmf records export``).

    Parameters
    ----------
    options : argparse.Namespace
        As the parser of the command line makes them.

    Returns
    -------
    int
        Exit status.

    Raises
    ------
    InputError, NumericalError, OutputError, Interrupted
        As the computation and the writers of files.
    """
    print(records.export(options.name, options.file, force=options.force))
    return 0
