"""Cases as input of other programs: functional mock-up units and scripts for OpenSeesPy."""

from rwmf.hosts.fmu import export_fmu
from rwmf.hosts.opensees_script import compare_with_opensees, opensees_script, run_opensees

__all__ = [
    "compare_with_opensees",
    "export_fmu",
    "opensees_script",
    "run_opensees",
]
