"""Drifts in static equilibrium after the motion, against long damped free vibrations.

A run until complete rest has nothing to relax: its last row is the equilibrium. A run that ends
earlier, with overcritical damping, reaches the same state.
"""

import itertools

import numpy as np
import pytest
import rwmf

LAWS: dict[str, dict[str, object]] = {
    "elastic_plastic": {"hardening": 0.02},
    "friction": {"breakaway": 1.3},
    "flag": {"flag_height": 0.6},
    "peak_oriented": {"hardening": 0.05, "cap": 4.0, "post_cap": 6.0, "lambda": 60.0},
    "pinched": {
        "hardening": 0.05, "cap": 4.0, "post_cap": 6.0, "residual": 0.1, "lambda": 60.0,
        "pinch_force": 0.4, "pinch_displacement": 0.5,
    },
    "bouc_wen": {"exponent": 2.0, "hardening": 0.05},
}  # fmt: skip
CABLE = {"eta_0": 4.0, "eta_alpha": 8.0}
LONG, SHORT, N, HEIGHT = 50.0, 2.5, 3, 3.2
ROOF = N * HEIGHT
SCENES = [
    (law, coupling, wall)
    for law, coupling, wall in itertools.product(
        LAWS, ("single", "full", "every_floor", "reduced"), (True, False)
    )
    if wall or coupling != "every_floor"
]


def _scene(law: str, coupling: str, *, wall: bool, xi: float) -> rwmf.Case:
    dice = np.random.default_rng([SCENES.index((law, coupling, wall))])
    one_by_one = coupling == "full" or (coupling == "every_floor" and law != "bouc_wen")
    groups: dict[str, dict[str, object]] = {
        "frame": {"xi_s": xi},
        "yielding": {"law": law} | LAWS[law],
        "motion": {"kind": "one_sine", "a_max_g": dice.uniform(0.3, 0.6), "T_p": 0.9},
        "solver": {"t_end": LONG},
        "output": {"reactions": True, "dt": LONG},
    }
    if coupling == "single":
        groups["frame"] |= {"T_s": 0.8} | ({"gamma": 4.0} if wall else {})
    else:
        groups["storeys"] = {
            "n": N, "m": 2e5, "k": 1e8, "height": HEIGHT, "T_1": 0.8, "coupling": coupling,
        }  # fmt: skip
    if one_by_one:
        groups["yielding"]["storey_u_y"] = list(dice.uniform(0.004, 0.01, N))
    else:
        groups["yielding"]["u_y"] = dice.uniform(0.012, 0.03)
    if wall:
        groups["wall"] = {"h": ROOF / 2, "b": 0.9, "m_w": 1e5}
        groups["impact"] = {"rule": "constant", "e": 0.5}
        groups["fuse"] = {"eta_y": dice.uniform(0.1, 0.4), "stroke_y": 0.002}
    groups["p_delta"] = {"m_g_over_m_s": 1.0, "drift_limit": 0.3}
    if coupling == "single" and not wall:
        groups["p_delta"]["h_f"] = ROOF
    return rwmf.Case(**groups)


def _at_rest(run: object) -> np.ndarray:
    found = [float(run["roof_residual_drift_at_rest"])]
    keys = [f"storey_{i}_residual_drift_at_rest" for i in range(1, N + 1)]
    return np.array(found + [float(run[key]) for key in keys if key in run])


def _last(run: object) -> np.ndarray:
    found = [float(run["u_s"][-1]) / ROOF]
    if "storey_1_residual_drift" in run:
        found += [float(run[f"storey_{i}_drift"][-1]) for i in range(1, N + 1)]
    return np.array(found)


@pytest.mark.parametrize(("law", "coupling", "wall"), SCENES)
def test_long_runs_end_at_rest(law: str, coupling: str, wall: bool) -> None:
    """A run that ends at rest ends at its equilibrium; overdamped ones reach it."""
    run = rwmf.simulate(_scene(law, coupling, wall=wall, xi=0.3))
    if bool(run["collapsed"]) or ("overturned" in run and bool(run["overturned"])):
        assert "roof_residual_drift_at_rest" not in run
    elif abs(float(run["u_s_dot"][-1])) < 1e-9:
        assert _at_rest(run) == pytest.approx(_last(run), abs=1e-9)
    case = _scene(law, coupling, wall=wall, xi=2.0)
    run = rwmf.simulate(case)
    early = rwmf.simulate(case.replace(solver={"t_end": SHORT}, output={"dt": None}))
    if abs(float(run["u_s_dot"][-1])) < 1e-8:
        assert _at_rest(early) == pytest.approx(_last(run), abs=1e-6)


def test_the_wall_recentres_what_stays_without_it() -> None:
    """Storeys that unloading leaves displaced are straight again beside the wall."""
    case = _scene("elastic_plastic", "every_floor", wall=True, xi=0.05).replace(
        fuse=None, cable=CABLE
    )
    run = rwmf.simulate(case)
    assert abs(float(run["roof_residual_drift"])) > 1e-5
    assert _at_rest(run) == pytest.approx(0.0, abs=1e-15)
    case = _scene("elastic_plastic", "full", wall=True, xi=0.05).replace(fuse=None, cable=CABLE)
    found = _at_rest(rwmf.simulate(case))
    assert found[0] == pytest.approx(0.0, abs=1e-15)
    assert sum(found[1:]) == pytest.approx(0.0, abs=1e-12)
    assert abs(found[1]) > 1e-5


def test_fuses_hold_an_elastic_frame_up() -> None:
    case = _scene("elastic_plastic", "single", wall=True, xi=3.0)
    still = {"kind": "none", "a_max_g": None, "T_p": None}
    start = {"theta_over_alpha": 0.3}
    case = case.replace(
        yielding=None,
        fuse={"eta_y": 0.9},
        motion=still,
        initial=start,
        solver={"t_end": 25.0},
        output={"dt": 25.0},
    )
    run = rwmf.simulate(case)
    assert "roof_residual_drift" not in run
    assert abs(float(run["roof_residual_drift_at_rest"])) > 1e-4
    assert _at_rest(run) == pytest.approx(_last(run), abs=1e-9)


def test_rows_and_spectra_report_it() -> None:
    case = _scene("elastic_plastic", "full", wall=True, xi=0.05)
    keys = ("storey_2_residual_drift_at_rest", "roof_residual_drift_at_rest")
    run = rwmf.simulate(case)
    rows = rwmf.sweep(case, {"a_max_g": [case.motion.a_max_g, 0.1]}, quantities=keys)
    spectrum = rwmf.spectrum(case, T_s=[0.8], quantities=list(keys))
    for key in keys:
        assert float(rows[key].isel(a_max_g=0).squeeze()) == float(run[key])
        assert float(spectrum[key].squeeze()) == pytest.approx(float(run[key]), abs=1e-9)
        alone = rwmf.sweep(case, {"a_max_g": [case.motion.a_max_g]}, quantities=(key,))
        assert float(alone[key].squeeze()) == float(run[key])
