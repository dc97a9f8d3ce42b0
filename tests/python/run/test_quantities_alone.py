"""A quantity is the same by itself and among all, in every path, for every row of the table."""

from pathlib import Path

import numpy as np
import pytest
import rwmf
from alone import differences
from rwmf.errors import InputError
from rwmf.run.quantities import QUANTITIES, find

# 2 by method fast, 9 without a wall, 19 with storeys that yield; bench/quantities_alone.py has more
_QUICK = (2, 9, 19)


@pytest.mark.parametrize("number", _QUICK)
def test_alone_is_among_all(number: int, tmp_path: Path) -> None:
    assert not list(differences(number, tmp_path))


def test_ductility_alone(tmp_path: Path) -> None:
    """Storeys that slip one by one: the largest ductility is inside a step."""
    path = tmp_path / "slip.nml"
    path.write_text(_SLIP, encoding="utf-8")
    case = rwmf.Case.from_namelist(path)
    alone = rwmf.spectrum(case, quantities=["ductility"]).ductility
    among = rwmf.spectrum(case, quantities=["ductility", "storey_1_ductility"]).ductility
    assert float(alone.squeeze()) == float(among.squeeze()) == pytest.approx(2.11596575, abs=1e-6)


_SLIP = """\
&wall h = 1.0, b = 0.92 /
&impact rule = 'table', table_theta_dot = 0.02 0.2 0.6, table_e = 0.93 0.85 0.7 /
&storeys m_over_m_w = 1.8 2.0 0.7, k_over_m_w = 808.0 723.0 624.0, height = 0.83 0.58 0.59
   coupling = 'full' /
&frame xi_s = 0.05 /
&cable eta_0 = 1.0, eta_alpha = 1.0, law = 'truss' /
&inerter inertance_over_m_w = 2.7 /
&yielding hardening = 0.3, law = 'friction', breakaway = 2.5, storey_u_y = 0.0061 0.0058 0.0118 /
&motion kind = 'one_sine', a_max_g = -0.36, T_p = 1.137 /
&spectrum T_s = 0.58 /
&solver t_end = 3.0 /
"""


def _wall(**more: dict[str, object]) -> rwmf.Case:
    return rwmf.Case(
        wall={"h": 2.0, "b": 0.5, "m_w": 1000.0},
        impact={"e": 0.9},
        motion={"kind": "one_sine", "a_max_g": 0.5, "T_p": 0.5},
        solver={"t_end": 3.0},
        **more,
    )


def test_both_names_come_back() -> None:
    """A quantity with two names in a dataset appears under each requested name."""
    case = _wall(frame={"T_s": 1.0, "gamma": 2.0, "xi_s": 0.05})
    pairs = [row.names("ordinate") for row in QUANTITIES.values() if "ordinate" in row.outputs]
    pairs = [names for names in pairs if len(names) > 1 and names[1].startswith("energy")]
    assert pairs
    keys = case.kernel.applicable()
    names = [name for pair in pairs if pair[1] in keys for name in pair]
    swept = rwmf.sweep(case, {"T_s": [1.0]}, quantities=tuple(names))
    assert set(swept) == {*names, "status"}
    assert {*names, "status"} == set(rwmf.spectrum(case, T_s=[1.0], quantities=names))
    for first, second in (pair for pair in pairs if pair[1] in keys):
        assert float(swept[first].squeeze()) == float(swept[second].squeeze())
    with pytest.raises(InputError, match="given twice"):
        rwmf.spectrum(case, T_s=[1.0], quantities=[names[0], names[0]])


def test_forces_of_storeys_in_newtons_in_sweeps() -> None:
    storeys = {"m_over_m_w": [1.0, 1.0], "k_over_m_w": [500.0] * 2, "height": [2.0, 2.0]}
    case = _wall(frame={"xi_s": 0.05}, storeys={**storeys, "coupling": "full"})
    names = ("storey_1_shear_max_N", "Storey_2_shear_max", "storey_2_shear_max_over_m_w_g")
    found = rwmf.sweep(case, {"motion.a_max_g": [0.5]}, quantities=names)
    assert list(found.data_vars)[:3] == ["storey_1_shear_max", *map(str.lower, names[1:])]
    ratio = float(found[names[2]].squeeze())
    force = float(found["storey_2_shear_max"].squeeze())
    np.testing.assert_allclose(force, ratio * 1000.0 * case.model.g, rtol=1e-14)


@pytest.mark.parametrize("method", ["auto", "taylor", "adams"])
def test_a_hinged_wall_says_that_it_overturned(method: str) -> None:
    """By itself, in runs and in rows, requested alone and not at all."""
    case = rwmf.Case(
        wall={"h": 2.0, "b": 0.5, "base": "pinned"},
        motion={"kind": "one_sine", "a_max_g": 0.1, "T_p": 0.5},
        solver={"t_end": 5.0, "method": method, "rtol": 1e-6},
    )
    assert bool(rwmf.simulate(case).overturned)
    assert "overturned" in case.kernel.applicable()
    found = rwmf.sweep(case, {"motion.a_max_g": [0.1, 1e-300]}, quantities=("overturned",))
    assert list(found.overturned.values.ravel()) == [1.0, 0.0]


def _let_go(seed: int) -> rwmf.Case:
    """Give a wall that is let go: the largest forces may lie in the first step."""
    dice = np.random.default_rng(seed)
    h = float(dice.uniform(1.5, 8.0))
    n = int(dice.integers(1, 6))
    groups: dict[str, dict[str, object]] = {
        "wall": {"h": h, "b": h * float(dice.uniform(0.15, 0.5))},
        "impact": {"rule": "coupled"},
        "motion": {"kind": "none"},
        "initial": {
            "theta_over_alpha": float(dice.uniform(0.01, 0.5)),
            "theta_dot": float(dice.uniform(-0.3, 0.3)),
        },
        "frame": {"xi_s": 0.05},
        "storeys": {
            "m_over_m_w": dice.uniform(0.3, 6.0, n).tolist(),
            "k_over_m_w": dice.uniform(500.0, 4000.0, n).tolist(),
            "height": [2 * h / n] * n,
            "coupling": ("full", "every_floor", "reduced", "springs")[seed % 4],
        },
        "model": {"formulation": "exact"},
        "solver": {"t_end": float(dice.uniform(0.02, 0.8)), "rtol": 1e-7},
        "output": {"reactions": True, "conditioning": False},
    }
    if seed % 4 == 3:
        groups["storeys"]["k_link_over_m_w"] = 5e3
    if seed % 3:
        groups["cable"] = {"eta_0": 1.0, "eta_alpha": 1.0 + float(dice.uniform(0, 5))}
    if seed % 5 == 0:
        groups["fuse"] = {"eta_y": 0.1, "stroke_y": 0.06}
    return rwmf.Case(**groups)


def _is_peak(key: str) -> bool:
    return find(key).found == "peak" and "_height" not in key


@pytest.mark.parametrize("seed", range(12))
def test_a_peak_in_the_first_step(seed: int) -> None:
    """Alone, among all and in a run whose every step is searched."""
    case = _let_go(seed)
    peaks = [key for key in case.kernel.applicable() if _is_peak(key)]
    every = rwmf.simulate(case.replace(solver={"method": "adams", "rtol": 1e-10})).flat()
    run = rwmf.simulate(case).flat()
    among = rwmf.sweep(case, {"xi_s": [0.05]}, quantities=peaks)
    for key in peaks:
        assert run[key] == pytest.approx(every[key], rel=2e-6, abs=1e-9), key
    for key in peaks[seed::12]:
        alone = rwmf.sweep(case, {"xi_s": [0.05]}, quantities=[key])
        name = next(name for name in alone.data_vars if name != "status")
        assert float(alone[name].squeeze()) == pytest.approx(run[key], rel=2e-6, abs=1e-9), key
        assert float(alone[name].squeeze()) == pytest.approx(float(among[name].squeeze()), rel=1e-6)
