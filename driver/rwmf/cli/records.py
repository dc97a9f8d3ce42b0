"""What ``rwmf records`` does."""

from __future__ import annotations

import argparse

from rwmf import records

__all__ = ["export", "show"]


def show(_: argparse.Namespace) -> int:
    """List the records (``rwmf records list``)."""
    print("\n".join(records.list_records()))
    return 0


def export(options: argparse.Namespace) -> int:
    """Write a record into a file (``rwmf records export``)."""
    print(records.export(options.name, options.file))
    return 0
