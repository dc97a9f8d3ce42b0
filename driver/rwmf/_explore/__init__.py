"""A case in the browser: a local page with sliders, pictures and numbers (``rwmf explore``).

`server` speaks HTTP with this machine only. It hands questions to the processes of `workers`, where
`model` answers them from the kernel. `controls` describes how each key is shown, and ``page`` is
loaded by the browser.
"""

from rwmf._explore.server import explore

__all__ = ["explore"]
