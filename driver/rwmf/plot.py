"""Figures of datasets and results: each function takes and returns axes; none simulates.

`history`, `profile`, `envelope` and `ground_motion` draw results of `rwmf.simulate`, `spectrum`
those of `rwmf.spectrum`, `work_precision` those of `rwmf.cost`, `pushover` curves of
`rwmf.pushover`. `ida` and `cloud` draw tables of runs, `fragility` curves of `rwmf.fragility`,
`hazard` and `deaggregation` the parts of `rwmf.risk`. `checks` draws the result of `rwmf.checks`.
The other functions draw the studies of the same name.
"""

from rwmf.plotting.checks_figure import checks
from rwmf.plotting.cost_figure import work_precision
from rwmf.plotting.envelope import envelope, envelope_quantities
from rwmf.plotting.ground import ground_motion
from rwmf.plotting.overturning_map import draw_overturning
from rwmf.plotting.profile import profile
from rwmf.plotting.pushover_figure import pushover
from rwmf.plotting.response import PANELS, history, spectrum
from rwmf.plotting.risk_figures import cloud, deaggregation, fragility, hazard, ida
from rwmf.plotting.risk_figures import fragility as draw_fragility
from rwmf.plotting.studies import (
    draw_bands,
    draw_equal_response,
    draw_friction,
    draw_suite,
    draw_wall_effect,
)
from rwmf.plotting.style import make_panels, style

__all__ = [
    "PANELS",
    "checks",
    "cloud",
    "deaggregation",
    "draw_bands",
    "draw_equal_response",
    "draw_fragility",
    "draw_friction",
    "draw_overturning",
    "draw_suite",
    "draw_wall_effect",
    "envelope",
    "envelope_quantities",
    "fragility",
    "ground_motion",
    "hazard",
    "history",
    "ida",
    "make_panels",
    "profile",
    "pushover",
    "spectrum",
    "style",
    "work_precision",
]
