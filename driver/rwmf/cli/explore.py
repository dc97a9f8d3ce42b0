"""Subcommand ``rwmf explore``."""

from __future__ import annotations

import argparse

from rwmf._explore import explore


def run(options: argparse.Namespace) -> int:
    """Show a case in the browser."""
    explore(options.case, options.port, not options.no_browser)
    return 0
