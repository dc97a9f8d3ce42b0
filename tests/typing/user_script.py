"""A user's script: without `Any`, with the types that an editor shows; tools/lint checks it.

`tests/python/case/test_types.py` runs it.
"""

from typing import TYPE_CHECKING, Literal, assert_type

import numpy as np
import rwmf
import xarray as xr
from matplotlib.axes import Axes
from rwmf import plot, studies

pulse = rwmf.Motion([0.0, 1.0, -1.0, 0.5] * 15, dt=0.02, unit="m/s2", name="pulse")
case = rwmf.Case(
    wall={"h": 2.0, "b": 0.5, "m_w": 9000.0},
    frame={"T_s": 0.8, "gamma": 5.0, "xi_s": 0.05},
    cable={"eta_0": 1.0, "eta_alpha": 5.0},
    motion=pulse,
    solver={"t_end": 2.0},
    output={"reactions": True},
)
height: float = 2 * case.wall.h
rule: str = case.model.formulation
heavier = case.replace(frame={"gamma": 2 * case.frame.gamma}).without("cable")
alone = case.without_wall()
history = rwmf.simulate(case, dt=0.01)
peak = float(history["u_s_max"]) / height
drift = float(history.roof_drift_max)
floors = history["floors_acceleration_max_g"].sel(floor=1)
spectra = rwmf.spectrum(case, T_s=[0.5, 1.0], quantities=("u_s_max", "friction_demand_max"))
found = rwmf.sweep(case, {"T_s": [0.5, 1.0], "eta": [(1.0, 5.0)]}, records=[pulse])
limit = float(rwmf.quantile(found, "u_s_max", 0.84).max())
ratio = float(studies.wall_effect(case, {"T_s": [0.5]})["ratio"].max())
panels = plot.history(history, case=case, color="k")
axes = plot.spectrum(spectra, bare=rwmf.spectrum(alone, T_s=[0.5, 1.0]))
springs = [loop.work for loop in plot.find_loops(history, case)]
curve = rwmf.pushover(case, 0.01, steps=2)
stripes = rwmf.stripes({"wall": case, "none": alone}, [pulse], [0.1, 0.4], "u_s_max")
met: bool = rwmf.checks(case.replace(limits={"u_s_max_m": 1.0}), history).is_met
slope = rwmf.gradient(case, ["frame.xi_s"], "u_s_max")
wall = rwmf.Wall(case)
wall.advance(0.1)
link: float = wall.forces.link
page = rwmf.explore(case) if link > 1e9 else None
keys: list[str] = [key for key in case.groups["wall"] if key in case.wall.given]
rwmf.plot.profile(rwmf.simulate("six.nml")) if peak > 1.0 else None
print(curve.sizes, stripes.sizes, met, slope, page.address if page else "")
print(history.headline(), rule, drift, limit, ratio, springs, keys, panels.size, float(floors))

if TYPE_CHECKING:
    assert_type(case.wall.h, float)
    assert_type(case.storeys.m, tuple[float, ...])
    assert_type(case.solver.max_steps, int)
    assert_type(case.output.energy, bool)
    assert_type(case.motion.file, str)
    assert_type(case.spectrum.quantities, tuple[str, ...])
    assert_type(case.wall.base, Literal["rocking", "pinned"])
    assert_type(case.without_wall(), rwmf.Case)
    assert_type(heavier, rwmf.Case)
    assert_type(history, rwmf.Response)
    assert_type(history["u_s_max"], xr.DataArray)
    assert_type(history.storeys_drift_max, xr.DataArray)
    assert_type(history.isel(time=0), rwmf.Response)
    assert_type(spectra, xr.Dataset)
    assert_type(rwmf.quantile(found), xr.DataArray)
    assert_type(panels, np.ndarray[tuple[int], np.dtype[np.object_]])
    assert_type(axes, Axes)
    assert_type(springs, list[float])
    # a mistyped key is an error: strict checking complains of ignored lines without one
    case.wall.H0  # type: ignore[attr-defined]
    case.waal  # type: ignore[attr-defined]
    case.wall.h + case.motion.file  # type: ignore[operator]
