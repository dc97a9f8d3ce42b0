"""Reactions, accelerations and drifts of lanes that advance by series, beside another method."""

import numpy as np
import pytest
import rwmf

_WALL = "&wall h = 4.0, b = 0.9 {wall}/\n&model formulation = 'exact' /\n"
_FRAME = "&frame T_s = 1.0, gamma = 4.0, xi_s = 0.03 /\n"
_PULSE = "&motion kind = 'one_cosine', a_max_g = 0.6, omega_p = 7.0 /\n"
_AXIS = "&cable eta_0 = 0.4, eta_alpha = 1.9, law = 'linear' /\n"
_LINE = "&cable eta_0 = 0.4, eta_alpha = 1.9, law = 'truss' /\n"
_PAIR = (
    "&cable offset = -0.5 0.3, height = 8.0 6.5, eta_0 = 0.2 0.2, eta_alpha = 1.9, law = 'truss',"
    " eta_y = 0.3 0.5, hardening = 0.05 /\n"
)
_ASIDE = "&cable offset = 1.2, eta_0 = 0.1, eta_alpha = 1.9, law = 'truss' /\n"
_DEVICES = "&fuse eta_y = 0.12, stroke_y = 0.004, hardening = 0.04 /\n&damper c_over_m_w = 0.4 /\n"
_RESTRAINT = (
    "&restraint offset = -0.9 0.9, height = 8.0, eta_y = 0.05, stroke_y = 0.004,"
    " hardening = 0.1 /\n"
)
_YIELDING = "&yielding f_y_over_m_s_g = 0.15, hardening = 0.05 /\n"
_STOREYS = (
    "&frame xi_s = 0.05 /\n&storeys m_over_m_w = 1.5 1.5, k_over_m_w = 900.0 900.0,"
    " height = 4.0 4.0, coupling = 'reduced' /\n"
)
_SCENES = {
    "wall": _WALL,
    "axis": _WALL + _FRAME + _AXIS,
    "line": _WALL + _FRAME + _LINE,
    "pair": _WALL + _FRAME + _PAIR + _DEVICES,
    "aside": _WALL + _FRAME + _ASIDE,
    "devices": _WALL + _FRAME + _LINE + _DEVICES,
    "restraint": _WALL + _FRAME + _AXIS + _RESTRAINT,
    "yielding": _WALL + _FRAME + _YIELDING + _DEVICES,
    "vertical": _WALL + _FRAME + _LINE + "&vertical ratio = 0.6 /\n",
    "storeys": _WALL + _STOREYS,
}
_KEYS = (
    "base_shear_max_over_weight", "pivot_normal_min_over_m_w_g", "friction_demand_max",
    "shear_key_force_max_over_m_w_g", "floor_acceleration_max_g", "storey_drift_max",
    "pivot_normal_max_over_m_w_g", "link_1_force_max_over_m_w_g", "link_2_force_max_over_m_w_g",
)  # fmt: skip
_RTOL = 1e-8
_TIMES = (0.0, 0.1, 0.25, 0.4, 0.5, 0.7, 1.2, 1.9, 2.5, 3.0)
_ACCELERATIONS = (0.0, 3.0, -5.0, 6.0, -4.0, 3.0, -5.0, 4.0, -2.0, 0.0)


@pytest.mark.parametrize("is_record", [False, True], ids=["pulse", "record"])
@pytest.mark.parametrize("has_key", [False, True], ids=["friction", "key"])
@pytest.mark.parametrize("scene", _SCENES)
def test_as_by_another_method(scene: str, has_key: bool, is_record: bool) -> None:
    """Together and alone, each lane gives the demand of an explicit pair at a tight tolerance."""
    text = _SCENES[scene].format(wall=", shear_key = .true. " if has_key else "")
    case = rwmf.Case.from_text(text + _PULSE + f"&solver t_end = 5.0, rtol = {_RTOL} /\n")
    if is_record:
        case = case.replace(motion=rwmf.Motion(_ACCELERATIONS, times=_TIMES, unit="m/s2"))
    tight = case.replace(solver={"rtol": 1e-12, "method": "dop853"})
    sizes = {"b": list(np.linspace(0.85, 0.95, 9))}
    applicable = set(case.kernel.applicable())
    keys = [key for key in _KEYS if key in applicable]
    assert len(keys) >= 2
    right = rwmf.sweep(tight, sizes, quantities=keys)
    together = rwmf.sweep(case, sizes, quantities=keys)
    assert not np.any(right.status)
    for name in (name for name in right.data_vars if name != "status"):
        assert np.allclose(together[name], right[name], rtol=10 * _RTOL, atol=0), name
    for key in keys:
        alone = rwmf.sweep(case, sizes, quantities=[key])
        (name,) = (name for name in alone.data_vars if name != "status")
        assert np.allclose(alone[name], right[name], rtol=10 * _RTOL, atol=0), name
