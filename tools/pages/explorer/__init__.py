"""Read-only copy of the page of ``rwmf explore`` for the site."""

from pages.explorer.copy import write

__all__ = ["write"]
