"""Sketches of the theory pages, drawn in the style of the project's figures."""

from pages.sketches.command import SKETCHES, write_all

__all__ = ["SKETCHES", "write_all"]
