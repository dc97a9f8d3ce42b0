"""Rows of sweeps and studies, small ones."""

from __future__ import annotations

import contextlib
import io
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import rwmf
import xarray as xr
from rwmf import studies

from bitwise import scenes
from bitwise.dump import dump_dataset
from bitwise.rows import Row

_QUICK = {"method": "dop853", "rtol": 1e-6, "t_end": 4.0}
_PERIODS = [0.5, 1.0, 2.0]
_GRID = {"T_s": [0.5, 1.0], "gamma": [5.0, 100.0]}
_ASKED = (
    "u_s_max",
    "theta_max_over_alpha",
    "impacts",
    "friction_demand_max",
    "base_shear_max_over_weight",
    "energy_impact_J_per_kg",
)
_SWEEP_FILE = """&sweep
   case = 'case.nml'
   records = 'noise0.txt', 'noise1.txt'
   unit = 'g'
   dt = 0.04
   file = 'found.nc'
/
&grid
   e = 0.85, 0.9
   T_s = 0.5, 1.0
   eta = 1, 5, 0, 0
/
"""


def rows() -> Iterator[Row]:
    """List the rows of sweeps and studies."""
    for name in _SWEEPS:
        yield Row(f"python/sweep/{name}", partial(sweep, name))
    yield Row("python/sweep/file", sweep_file, False)
    for i, name in enumerate(_STUDIES):
        yield Row(f"python/studies/{name}", partial(study, name), i == 0)


def sweep(name: str) -> str:
    """Run one of the sweeps in memory."""
    return _dump(_SWEEPS[name])


def study(name: str) -> str:
    """Run one of the studies."""
    return _dump(_STUDIES[name])


def sweep_file() -> str:
    """Run a sweep from its file by the command, into a file."""
    from rwmf.__main__ import main

    _records()
    _case().to_namelist("case.nml")
    Path("sweep.nml").write_text(_SWEEP_FILE, encoding="ascii")
    with contextlib.redirect_stdout(io.StringIO()):
        status = main(["sweep", "sweep.nml"])
    with xr.open_dataset("found.nc", engine="h5netcdf") as found:
        return f"status {status}\n{dump_dataset(found)}"


def _dump(make: Callable[[], xr.Dataset]) -> str:
    try:
        return dump_dataset(make())
    except rwmf.RwmfError as error:
        return f"{type(error).__name__}\n"


def _case(name: str = "plain", **changes: dict[str, object]) -> rwmf.Case:
    """Make a scene quick: `dop853`, a short motion, no output."""
    scene = next(s for s in scenes.read_scenes() if s.name == f"special-{name}")
    case = rwmf.Case.from_text(scene.text).replace(output=None, solver=_QUICK)
    return case.replace(**changes)


def _records() -> list[str]:
    """Write two records of one column into the current folder."""
    for i in range(2):
        t = 0.04 * np.arange(120)
        a = 0.3 * (i + 1) * np.sin((5 + 3 * i) * t) * np.exp(-0.3 * t)
        text = "".join(f"{value:.6f}\n" for value in a)
        Path(f"noise{i}.txt").write_text(text, encoding="ascii")
    return ["noise0.txt", "noise1.txt"]


def _suite() -> dict[str, Any]:
    return {"records": _records(), "unit": "g", "dt": 0.04}


_SWEEPS: dict[str, Callable[[], xr.Dataset]] = {
    "displacements": lambda: rwmf.sweep(
        _case(), {"T_s": _PERIODS, "e": [0.8, 0.9], "formulation": ["exact", "published"]}
    ),
    "auto": lambda: rwmf.sweep(
        _case(solver={"method": "auto"}), {"T_s": _PERIODS, "gamma": [5.0, 100.0], "b": [0.4, 0.5]}
    ),
    "quantities": lambda: rwmf.sweep(_case(), {"T_s": _PERIODS}, quantities=_ASKED),
    "scale-and-eta": lambda: rwmf.sweep(
        _case(), {"T_s": [1.0], "scale": [0.5, 2.0], "eta": [(1, 5), (0, 0)]}
    ),
    "records": lambda: rwmf.sweep(_case(), {"T_s": [0.5, 1.0]}, **_suite()),
    "block": lambda: rwmf.sweep(
        _case("block"), {"b": [0.4, 0.6], "scale": [1.0, 4.0]}, quantities=_ASKED[1:3]
    ),
    "yielding": lambda: rwmf.sweep(
        _case("bare-yields"), {"T_s": _PERIODS}, quantities=("ductility", "residual_displacement")
    ),
    "failures": lambda: rwmf.sweep(_case(), {"max_steps": [20.0], "T_s": _PERIODS}),
    "storeys": lambda: rwmf.sweep(_case("storeys-full"), {"scale": [1.0, 2.0]}),
}
_STUDIES: dict[str, Callable[[], xr.Dataset]] = {
    "overturning-map": lambda: studies.overturning_map(
        _case("block"), [2.0, 5.0], [1.0, 3.0, 7.0], tolerance=1e-3
    ),
    "wall-effect": lambda: studies.wall_effect(_case(), _GRID),
    "equal-response": lambda: studies.equal_response(_case(), [0.5, 1.0], 0.1, tolerance=1e-4),
}
