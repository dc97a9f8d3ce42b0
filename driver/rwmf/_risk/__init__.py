"""From records to risk: analyses at levels of intensity, fragility curves, annual frequencies."""

from rwmf._risk.analyses import cloud, ida, stripes
from rwmf._risk.annual import risk
from rwmf._risk.fragility_curves import fragility
from rwmf._risk.table import read_table, write_table

__all__ = ["cloud", "fragility", "ida", "read_table", "risk", "stripes", "write_table"]
