"""Method 'paper': Eq. (15) by CVODE with its own root search, for scenes of the paper only."""

from pathlib import Path

import numpy as np
import pytest
import rwmf
from refused import refusals
from scenes import bare_frame, block, coupled, record

PUBLISHED = {"formulation": "published"}
PAPER = {"method": "paper"}


def _scene(**changes: dict[str, object] | None) -> rwmf.Case:
    return coupled(model=PUBLISHED, solver=PAPER).replace(**changes)


def _is_close(case: rwmf.Case) -> rwmf.Response:
    """Compare a run with one by `dop853` and return it."""
    ours = rwmf.simulate(case.replace(solver={"rtol": 1e-9}))
    trusted = rwmf.simulate(case.replace(solver={"method": "dop853", "rtol": 1e-9}))
    assert ours.attrs["method"] == "paper"
    for key in ("theta_max_over_alpha", "theta_dot_max", "pivot_normal_min_over_m_w_g"):
        assert float(ours[key]) == pytest.approx(float(trusted[key]), rel=1e-6), key
    if "u_s_max" in trusted:
        assert float(ours.u_s_max) == pytest.approx(float(trusted.u_s_max), rel=1e-6)
        assert float(ours.t_u_s_max) == pytest.approx(float(trusted.t_u_s_max), abs=1e-6)
    if "time" in trusted.sizes:
        largest = float(abs(trusted.theta).max())
        assert np.abs(ours.theta.values - trusted.theta.values).max() < 1e-6 * largest
        times = [run.event_time[run.event == "impact"].values[:3] for run in (ours, trusted)]
        np.testing.assert_allclose(*times, rtol=0, atol=1e-6)
    return ours


@pytest.mark.parametrize("kind", ["one_sine", "one_cosine", "ricker"])
@pytest.mark.parametrize("gamma", [5.0, 1800.0])
def test_pulse(kind: str, gamma: float) -> None:
    _is_close(_scene(motion={"kind": kind}, frame={"gamma": gamma}, output={"dt": 0.02}))


@pytest.mark.parametrize("T_s", [0.4, 1.0, 2.0])
def test_record(elcentro: Path, T_s: float) -> None:
    case = _scene(
        motion=record(elcentro), solver={"t_end": None}, frame={"T_s": T_s}, output={"dt": 0.02}
    )
    _is_close(case)


def test_block_comes_to_rest() -> None:
    """A released block rocks by Eq. (12); rest ends its infinitely many impacts."""
    solver = PAPER | {"t_end": 20.0}
    case = block(model=PUBLISHED, solver=solver, initial={"theta_over_alpha": 0.4})
    run = _is_close(case.replace(output={"dt": 1.0}))
    assert run.event.values[-1] == "rest"
    assert float(run.theta[-1]) == 0


def test_quarter_period() -> None:
    """Eq. (12) of a slender block: the quarter period of Housner."""
    alpha, start = np.arctan2(0.05, 5.0), 0.5
    wall = {"h": 5.0, "b": 0.05}
    case = block(wall=wall, model=PUBLISHED, initial={"theta_over_alpha": start}, solver=PAPER)
    run = rwmf.simulate(case.replace(output={"dt": 1.0}))
    p = np.sqrt(3 * 9.81 / (4 * np.hypot(5.0, 0.05)))
    assert run.event.values[0] == "impact"
    expected = np.arccosh(1 / (1 - start)) / p
    assert float(run.event_time[0]) == pytest.approx(expected, rel=alpha**2)


def test_overturning() -> None:
    case = block(model=PUBLISHED, solver=PAPER | {"t_end": 10.0}, output={"dt": 0.1}).replace(
        motion={"kind": "one_sine", "a_max_g": 1.5, "omega_p": 3.0}
    )
    ours, trusted = (
        rwmf.simulate(case.replace(solver={"method": method})) for method in ("paper", "dop853")
    )
    assert bool(ours.overturned)
    assert ours.event.values[-1] == "overturned"
    assert ours.event_time[-1] == pytest.approx(float(trusted.event_time[-1]), rel=1e-6)


def test_rows_are_runs() -> None:
    """A spectrum and a sweep integrate row by row, with the bits of single runs."""
    case = _scene(solver={"t_end": 3.0})
    rows = rwmf.spectrum(case, T_s=[0.5, 1.0], gamma=[5.0, 100.0])
    swept = rwmf.sweep(case, grid={"T_s": [0.5, 1.0], "gamma": [5.0, 100.0]})
    for T_s in (0.5, 1.0):
        for gamma in (5.0, 100.0):
            run = rwmf.simulate(case.replace(frame={"T_s": T_s, "gamma": gamma}))
            for found in (rows, swept):
                peak = found.u_s_max.sel(T_s=T_s, gamma=gamma).item()
                assert peak == float(run.u_s_max)


test_refusals = refusals(
    lambda changes: _scene(**changes),
    ({"model": {"formulation": "exact"}}, "&model: formulation = 'exact': must be 'published'"),
    ({"wall": {"base": "pinned"}, "impact": None, "cable": None}, "&wall: base = 'pinned'"),
    ({"impact": {"rule": "coupled", "e": None}}, "&impact: rule = 'coupled': must be 'con"),
    ({"impact": None}, "&impact: rule = coupled: must be 'constant'"),
    (
        {"damper": {"c_over_m_w": 0.1}},
        "&damper: must not be given with &solver method = 'paper'",
    ),
    ({"vertical": {"ratio": 0.5}}, "&vertical: must not be given with &solver method"),
    ({"yielding": {"u_y": 0.02}}, "&yielding: must not be given with &solver method"),
)


def test_a_bare_frame_is_no_scene_of_the_paper() -> None:
    with pytest.raises(rwmf.InputError, match="&solver: method = 'paper': needs &wall"):
        bare_frame(solver=PAPER)


def test_a_host_needs_another_method() -> None:
    with pytest.raises(rwmf.InputError, match=r"&solver: method = 'paper'.*: integrates"):
        rwmf.Wall(_scene())


def test_coefficients() -> None:
    """Equations (15), (8) and (10) as printed, at both signs of theta."""
    gamma, omega, xi, g = 5.0, 2 * np.pi, 0.05, 9.81
    alpha, R = np.arctan2(0.5, 2.0), np.hypot(0.5, 2.0)
    sin, cos = np.sin, np.cos
    left, right = -0.05, 0.07
    A, B = coupled().paper_coefficients([left, right])
    tension = [np.sin(alpha) * (1 + 4 * theta / alpha) for theta in (left, right)]
    a_1 = 1 / (4 / 3 + 4 * gamma * cos(alpha) * cos(left) * cos(-alpha - left))
    a_2 = -4 * gamma * cos(alpha) * cos(left)
    a_3 = -(2 * gamma * cos(alpha) * cos(left) + cos(-alpha - left)) / R
    a_7 = -(omega**2) * (sin(-alpha - left) + sin(alpha))
    expected = [
        a_1 * a_2 * sin(-alpha - left),
        a_1 * a_2 * 2 * omega * xi * cos(-alpha - left),
        a_1 * a_3,
        a_1 * a_2 * a_7 - g / R * a_1 * (sin(-alpha - left) - tension[0]),
    ]
    np.testing.assert_allclose(A, expected, rtol=1e-12)
    s, c = sin(alpha - right), cos(alpha - right)
    b_1 = 1 / (4 / 3 + 4 * gamma * c**2)
    expected = [
        -4 * gamma * c * s * b_1,
        -8 * gamma * omega * xi * c**2 * b_1,
        -(2 * gamma + 1) / R * c * b_1,
        b_1 * (-4 * gamma * c * omega**2 * (sin(alpha) - s) - g / R * (s + tension[1])),
    ]
    np.testing.assert_allclose(B, expected, rtol=1e-12)
    with pytest.raises(rwmf.InputError, match="needs &wall"):
        bare_frame().paper_coefficients(0.1)
