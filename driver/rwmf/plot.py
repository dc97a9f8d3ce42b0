"""Figures of datasets and results: each function takes and returns axes; none simulates.

`history`, `profile`, `envelope` and `ground_motion` draw results of `rwmf.simulate`, `loops` the
hysteresis of springs, as `find_loops` returns it. `spectrum` draws results of `rwmf.spectrum`,
`work_precision` those of `rwmf.cost`, `pushover` curves of `rwmf.pushover`. `ida` and `cloud` draw
tables of runs, `fragility` curves of `rwmf.fragility`, `hazard` and `deaggregation` the parts of
`rwmf.risk`. `checks` draws the result of `rwmf.checks`. The other functions draw the studies of the
same name.
"""

from typing import TYPE_CHECKING

from rwmf._renamed import of_module
from rwmf.figures.ground import ground_motion
from rwmf.figures.histories import history, spectrum
from rwmf.figures.loops import draw as loops
from rwmf.figures.loops import find_loops
from rwmf.figures.profiles import envelope, envelope_quantities, profile
from rwmf.figures.results import checks, pushover, work_precision
from rwmf.figures.risk_figures import cloud, deaggregation, fragility, hazard, ida
from rwmf.figures.study_figures import equal_response, overturning_map, wall_effect
from rwmf.figures.styles import make_panels, style

__all__ = [
    "checks",
    "cloud",
    "deaggregation",
    "envelope",
    "envelope_quantities",
    "equal_response",
    "find_loops",
    "fragility",
    "ground_motion",
    "hazard",
    "history",
    "ida",
    "loops",
    "make_panels",
    "overturning_map",
    "profile",
    "pushover",
    "spectrum",
    "style",
    "wall_effect",
    "work_precision",
]

if not TYPE_CHECKING:
    __getattr__ = of_module("plot")
