"""The command ``rwmf``: a module for each of its words, and what they share."""

from rwmf.cli.main import main

__all__ = ["main"]
