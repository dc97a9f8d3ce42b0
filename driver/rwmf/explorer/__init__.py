"""Browser page for a case: sliders, figures and numbers (``rwmf explore``).

`server` serves HTTP to this machine only and passes requests to the processes of `workers`. There
`model` computes the answers with the kernel. `controls` describes the control of each key; the
browser loads ``page``.
"""

from rwmf.explorer.server import explore

__all__ = ["explore"]
