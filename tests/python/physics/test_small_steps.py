"""Bare frames whose storeys yield one by one against small sampled steps in SciPy."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
import rwmf
from rwmf.quantities import find
from yielding_steps import Frame

RTOL = 1e-8
MOST = 100.0  # error over rtol and sensitivity
CHANGE = 1e-6
T_END = 3.6
# straight lines much longer than a step, in s and m/s2
PAIRS = [(0.0, 0.0), (0.48, -3.9), (0.79, 0.01), (1.03, 3.3), (1.39, -3.4), (1.45, 1.6),
         (1.51, -0.3), (1.6, 2.2), (1.9, 0.0)]  # fmt: skip
SCENES: dict[str, dict[str, Any]] = {
    "softening": {
        "frame": {"xi_s": 0.0},
        "storeys": {"m_over_m_w": [0.43, 0.73, 1.17], "k_over_m_w": [253.1, 2033.0, 411.7],
                    "height": [4.4, 3.3, 4.0]},
        "yielding": {"storey_u_y": [0.032, 0.0031, 0.0075], "hardening": -0.0327,
                     "ultimate": 17.2},
        "p_delta": {"m_g_over_m_s": 0.66, "drift_limit": 0.05},
    },
    "friction": {
        "frame": {"xi_s": 0.0},
        "storeys": {"m_over_m_w": [0.99, 0.91], "k_over_m_w": [3100.0, 661.3],
                    "height": [2.9, 4.2]},
        "yielding": {"storey_u_y": [0.00063, 0.0018], "law": "friction", "breakaway": 1.5},
    },
    "bouc_wen": {
        "frame": {"xi_s": 0.02},
        "storeys": {"m_over_m_w": [0.79, 0.38], "k_over_m_w": [968.5, 818.2],
                    "height": [3.9, 3.7]},
        "yielding": {"storey_u_y": [0.00057, 0.0024], "law": "bouc_wen", "hardening": 0.1,
                     "exponent": 1.5, "beta": 0.5},
    },
}  # fmt: skip


def _case(groups: dict[str, Any], path: Path, **solver: object) -> rwmf.Case:
    path.write_text("".join(f"{t!r} {a!r}\n" for t, a in PAIRS), encoding="utf-8")
    return rwmf.Case(
        **groups,
        motion={"kind": "record", "file": str(path), "unit": "m/s2"},
        solver={"t_end": T_END, "max_steps": 400_000} | solver,
        output={"reactions": True},
    )


def _run(case: rwmf.Case) -> dict[str, float]:
    values = rwmf.simulate(case).flat()
    return {find(key).name: x for key, x in values.items() if isinstance(x, float)}


@pytest.mark.parametrize("name", SCENES)
def test_every_quantity_by_every_method(name: str, tmp_path: Path) -> None:
    """Demands, ductilities and residual drifts are within 100 rtol times their sensitivity."""
    groups, path = SCENES[name], tmp_path / "record.txt"
    groups["storeys"]["coupling"] = "full"
    truth = Frame(groups | {"solver": {"t_end": T_END}}, PAIRS).follow()
    tight = _case(groups, path, method="dop853", rtol=1e-13)
    runs = [_run(tight.replace(motion={"scale": 1 + d})) for d in (0.0, CHANGE, -CHANGE)]
    found = {
        method: _run(_case(groups, path, method=method, rtol=RTOL))
        for method in ("dop853", "taylor", "adams")
    }
    lanes = _case(groups, path, method="dop853", rtol=RTOL)
    rows = rwmf.sweep(lanes, points={"scale": [1.0, 0.9]}, quantities=list(truth))
    found["row"] = {str(key): rows[key].values.ravel()[0] for key in rows.data_vars}
    largest = max(abs(value) for key, value in truth.items() if "drift" in key)
    assert max(value for key, value in truth.items() if "ductility" in key) > 2
    for key, value in truth.items():
        change = max(abs(run[key] - runs[0][key]) for run in runs[1:]) / CHANGE
        sensitivity = max(1.0, change / abs(value))
        assert sensitivity < 1e5, key
        size = max(abs(value), 1e-2 * largest if "residual" in key else 1e-9)
        for method, values in found.items():
            name = key if key in values else find(key).name
            assert abs(values[name] - value) < MOST * RTOL * sensitivity * size, (method, key)
