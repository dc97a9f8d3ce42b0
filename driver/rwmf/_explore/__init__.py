"""A case in the browser: a local page with sliders, pictures and numbers (``rwmf explore``).

`model` answers questions of the page from the kernel, `controls` says how each key is shown,
`server` speaks HTTP with this machine only, and ``page`` is what the browser loads.
"""

from rwmf._explore.server import explore

__all__ = ["explore"]
