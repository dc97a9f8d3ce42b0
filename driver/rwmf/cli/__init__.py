"""Command ``rwmf``: one module per subcommand, and shared modules."""

from rwmf.cli.main import main

__all__ = ["main"]
