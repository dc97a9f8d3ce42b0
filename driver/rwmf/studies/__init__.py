"""Engineering studies: each computes a labelled dataset from a case."""

from rwmf._risk.level_statistics import demand_percentiles
from rwmf.studies.bands import sensitivity_bands
from rwmf.studies.capacities import annual_frequency, fragility_median
from rwmf.studies.displacement_design import displacement_based_prestress
from rwmf.studies.earlier_names import fragility, incremental_dynamic_analysis
from rwmf.studies.equal_response import equal_response
from rwmf.studies.friction import friction_spectra
from rwmf.studies.overturning import overturning_map
from rwmf.studies.statistics import cumulative_distribution, percentiles
from rwmf.studies.suite_spectra import suite_spectra
from rwmf.studies.wall_effect import wall_effect, without_wall

__all__ = [
    "annual_frequency",
    "cumulative_distribution",
    "demand_percentiles",
    "displacement_based_prestress",
    "equal_response",
    "fragility",
    "fragility_median",
    "friction_spectra",
    "incremental_dynamic_analysis",
    "overturning_map",
    "percentiles",
    "sensitivity_bands",
    "suite_spectra",
    "wall_effect",
    "without_wall",
]
