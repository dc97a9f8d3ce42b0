"""Extreme numbers of `&solver` and of the frame: a right result or an error, no wrong `ok`."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import rwmf
import xarray as xr
from c_host import run as run_in_c
from c_host import stepping
from checkout import Runner
from rwmf.errors import InputError, NumericalError
from scenes import bare_frame, coupled, merged
from yielding import exact_peak

METHODS = ("adams", "bdf", "dop853", "taylor", "auto")
PULSE_END = 10.0


def _peak(case: rwmf.Case, T_s: float) -> float:
    found = rwmf.spectrum(case, T_s=[T_s])
    assert str(found.status.values.item()) == "ok"
    return float(found.u_s_max.values.item())


@pytest.mark.parametrize("xi_s", [0.0, 0.05, 0.999, 1.0, 1.001, 5.0, 8.0, 30.0, 100.0])
def test_a_frame_with_any_damping_is_exact(xi_s: float) -> None:
    """Against the matrix exponential; a step has to resolve the faster root."""
    t = 0.1 * np.arange(21)
    a = np.random.default_rng(8).normal(size=t.size)
    motion = rwmf.Motion(a, dt=0.1, unit="m/s2")
    solver = {"t_end": 2.0, "rtol": 1e-12}
    case = bare_frame(frame={"xi_s": xi_s}, solver=solver).replace(motion=motion)
    for T_s in (0.08, 9.0):
        assert _peak(case, T_s) == pytest.approx(exact_peak(T_s, xi_s, t, a), rel=1e-10)


@pytest.mark.parametrize(
    ("frame", "damper"), [({"xi_s": 8.0}, None), ({"xi_s": 60.0}, None), ({}, {"c_over_m_w": 3e4})]
)
def test_a_wall_with_strong_damping_keeps_the_tolerance(
    frame: dict[str, object], damper: dict[str, object] | None
) -> None:
    case = coupled(frame=frame, damper=damper, solver={"t_end": 4.0})
    for T_s in (0.1, 1.0):
        expected = _peak(case.replace(solver={"method": "dop853", "rtol": 1e-12}), T_s)
        assert _peak(case, T_s) == pytest.approx(expected, rel=1e-8)


def test_a_wall_on_a_frame_of_any_period_keeps_the_tolerance() -> None:
    for T_s in (1e-1, 1e-2, 1e-3):
        case = coupled(frame={"gamma": 100.0}, solver={"t_end": 2.0})
        expected = _peak(case.replace(solver={"method": "dop853", "rtol": 1e-12}), T_s)
        assert _peak(case, T_s) == pytest.approx(expected, rel=1e-7)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("xi_s", [0.0, 0.05, 1.0, 3.0])
def test_the_rest_after_a_pulse_takes_no_steps(method: str, xi_s: float) -> None:
    """A free vibration gains nothing: the same maximum for every `t_end`, in few steps."""
    solver = {"method": method, "max_steps": 20_000}
    case = bare_frame(frame={"xi_s": xi_s}, solver=solver)
    short = _peak(case.replace(solver={"t_end": PULSE_END}), 1.0)
    for t_end in (2e3, 1e6, 3e7, 1e12, 1e300):
        assert _peak(case.replace(solver={"t_end": t_end}), 1.0) == pytest.approx(short, rel=1e-8)


@pytest.mark.parametrize("method", ["auto", "dop853"])
def test_a_rocking_wall_at_rest_takes_no_steps(method: str) -> None:
    case = coupled(solver={"method": method, "max_steps": 20_000})
    short = _peak(case, 1.0)
    for t_end in (1e6, 3e7, 1e300):
        assert _peak(case.replace(solver={"t_end": t_end}), 1.0) == pytest.approx(short, rel=1e-9)


def test_energies_of_a_long_rest_are_those_of_a_short_one() -> None:
    case = bare_frame(solver={"max_steps": 20_000}, output={"energy": True, "reactions": True})
    short, long = (rwmf.simulate(case.replace(solver={"t_end": end})) for end in (200.0, 1e7))
    for name in ("energy_input", "energy_viscous", "base_shear_max_over_weight"):
        for key in (key for key in short if str(key).startswith(name)):
            assert float(long[key]) == pytest.approx(float(short[key]), rel=1e-9)
    assert float(long["energy_balance_relative"]) < 1e-9


def test_max_steps_is_honoured() -> None:
    for case in (bare_frame(), coupled()):
        few = case.replace(solver={"max_steps": 10, "t_end": 1e3})
        found = rwmf.spectrum(few, T_s=[1.0])
        assert found.status.values.item() == "too_many_steps"
        assert np.isnan(found.u_s_max.values.item())


@pytest.mark.parametrize("key", ["rtol", "accuracy"])
def test_a_tolerance_below_round_off_is_refused_everywhere(
    key: str, tmp_path: Path, batch: Runner
) -> None:
    """Test namelist, Python, tables, batch program and C; another test has the Fortran facade."""
    low = {"rtol": "9e-15", "accuracy": "1.9e-14"}[key]
    least = {"rtol": "1.0e-14", "accuracy": "2.0e-14"}[key]
    case = coupled()
    text = case.to_namelist().replace("t_end", f"{key} = {low}, t_end")
    path = tmp_path / "low.nml"
    path.write_text(text, encoding="utf-8")
    table = {f"solver.{key}": [float(low)]}
    ways: list[Callable[[], object]] = [
        lambda: rwmf.Case.from_namelist(path),
        lambda: rwmf.Case.from_text(text),
        lambda: case.replace(solver={key: float(low)}),
        lambda: run_in_c(text),
        lambda: rwmf.sweep(case, points=table),
    ]
    for way in ways:
        with pytest.raises(InputError, match=f"{key}.*must be a number in .{least}, 0.1"):
            way()
    done = batch(path)
    assert done.returncode == 2
    assert least in done.stderr


SCENES = {
    "huge pulse": {"motion": {"a_max_g": 1e300}},
    "huge pulse on a stiff frame": {"motion": {"a_max_g": 1e300}, "frame": {"T_s": 1e-3}},
    "huge damping": {"frame": {"xi_s": 1e200}},
    "tiny period": {"frame": {"T_s": 1e-150}},
    "long period": {"frame": {"T_s": 1e150}},
    "short pulse": {"motion": {"omega_p": 1e160}},
    "huge wall": {"wall": {"h": 1e160, "b": 1e159}},
    "tight": {"solver": {"rtol": 1e-14}},
}


@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize("has_wall", [True, False])
def test_no_path_reports_a_number_that_is_not_finite(name: str, has_wall: bool) -> None:
    """Runs, ordinates by lanes and alone, rows of a table, stepping."""
    changes = merged({"solver": {"t_end": 2.0, "max_steps": 20_000}}, SCENES[name])
    if not has_wall and "wall" in changes:
        return
    try:
        case = coupled(**changes) if has_wall else bare_frame(**changes)
    except InputError:
        return
    for method in METHODS:
        own = case.replace(solver={"method": method})
        try:
            run = rwmf.simulate(own)
        except (NumericalError, InputError):
            pass
        else:
            numbers = [value for value in run.data_vars.values() if value.dtype.kind == "f"]
            assert all(np.isfinite(value).all() for value in numbers), method
        for quantities in (("u_s_max",), ("u_s_max", "floor_acceleration_max_g")):
            _check_ordinates(own, quantities)
    _step(case)


def _check_ordinates(case: rwmf.Case, quantities: tuple[str, ...]) -> None:
    """Check one ordinate of a spectrum, and the same as a row of a table."""
    T_s = case.frame.T_s
    ways: tuple[Callable[[], xr.Dataset], ...] = (
        lambda: rwmf.spectrum(case, T_s=[T_s], quantities=quantities),
        lambda: rwmf.sweep(case, points={"T_s": [T_s]}, quantities=quantities),
    )
    for way in ways:
        try:
            found = way()
        except (NumericalError, InputError):
            continue
        if found.status.values.item() in ("ok", "overturned", "collapsed"):
            assert np.isfinite([found[key].values.item() for key in quantities]).all()


def _step(case: rwmf.Case) -> None:
    """Advance the scene in C, if a host may."""
    try:
        with stepping(case.to_namelist()) as wall:
            for t in (0.5, 1.0):
                wall.advance(t)
                state, forces = wall.state(), wall.forces()
                numbers = [state.theta, state.theta_dot, state.theta_ddot, state.u_s, forces.link]
                assert np.isfinite(numbers).all()
    except (NumericalError, InputError):
        pass
