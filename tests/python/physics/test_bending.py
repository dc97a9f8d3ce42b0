"""The bending wall of the kernel: against the independent program, closed forms and balances."""

import math

import bending
import numpy as np
import pytest
import rwmf
from bending import BentWall
from bending_parts import Groups, Shapes
from bending_scenes import Record, bending_scene, compare, ground_of
from bending_scenes import bent_case as _case
from refused import refusals

# scenes with all couplings, cable laws, devices, vertical motion; the reference misses a flight of
# 0.15 ms in scene 0
SCENES = range(1, 12, 2)
VARIANTS: list[tuple[int, Groups]] = [
    (7, {"p_delta": {"m_g_over_m_s": 1.0}}),
    (7, {"bending": {"damping": "stiffness", "nu": 0.2}}),
    (5, {"bending": {"modes": 4, "nu": 0.2}}),
    (1, {"fuse": {"eta_y": 0.2, "stroke_y": 0.004, "hardening": 0.05}}),
    (8, {"damper": {"c_over_m_w": 0.5}, "vertical": {"ratio": 0.4}}),
    # the shear has its largest value next to an extremum of the other sign, both near the base
    (1019, {"bending": {"modes": 3}}),
    (1028, {"bending": {"modes": 2}}),
]
H, B = 6.0, 1.2


def _block(modes: int = 2, **groups: object) -> Groups:
    block = {
        "wall": {"h": H, "b": B},
        "impact": {"rule": "coupled"},
        "bending": {"EI_over_m_w": 1.5e5, "modes": modes},
        "motion": {"kind": "one_sine", "a_max_g": 0.5, "T_p": 0.7},
        "solver": {"t_end": 2.0},
    }
    return block | groups


def _compare(groups: Groups, record: Record) -> None:
    needed = {"tip_deflection_max_m", "wall_moment_max_over_m_w_g_m", "wall_drift_max"}
    if "frame" in groups:
        floor = len(groups["storeys"]["height"]) if "storeys" in groups else 1
        needed |= {f"floor_{floor}_acceleration_max_g", f"link_{floor}_force_max_over_m_w_g"}
        needed |= {f"floor_{floor}_velocity_max_m_s", f"wall_shear_{floor}_max_over_m_w_g"}
    compare(groups, record, needed)


@pytest.mark.parametrize("number", SCENES)
def test_random_scenes_agree_with_the_independent_program(number: int) -> None:
    groups, record = bending_scene(number)
    _compare(groups, record)


@pytest.mark.parametrize(("number", "changed"), VARIANTS)
def test_variants_agree_with_the_independent_program(number: int, changed: Groups) -> None:
    groups, record = bending_scene(number)
    for name, group in changed.items():
        groups[name] = groups.get(name, {}) | group
    _compare(groups, record)


@pytest.mark.parametrize("nu", [None, 0.2])
def test_a_wall_on_its_base_vibrates_in_its_modes(nu: float | None) -> None:
    bending = {"EI_over_m_w": 1.5e5, "modes": 3} | ({} if nu is None else {"nu": nu})
    motion = {"kind": "one_sine", "a_max_g": 0.01, "T_p": 0.7}
    scene = _block(bending=bending, motion=motion, output={"dt": 0.01})
    run = rwmf.simulate(_case(scene, None, rtol=1e-13))
    assert run.flat()["lift_offs"] == 0
    shear = 0.0 if nu is None else (2 * B) ** 2 / 12 * 2 * (1 + nu) / (5 / 6 * (2 * H) ** 2)
    shapes = Shapes(3, 2 * H, shear)
    omega = np.sqrt(shapes.squares * 1.5e5 / (2 * H) ** 3)
    a, w, xi = 0.01 * 9.81, 2 * math.pi / 0.7, 0.02
    t = run["time"].values
    t = t[t <= 0.7]
    for i in range(3):
        # forced vibration, and the free one that starts from rest with it
        steady = -shapes.area[i] / shapes.mass[i] * a
        steady /= omega[i] ** 2 - w**2 + 2j * xi * omega[i] * w
        damped = omega[i] * math.sqrt(1 - xi**2)
        cosine = -steady.imag
        sine = (xi * omega[i] * cosine - w * steady.real) / damped
        free = cosine * np.cos(damped * t) + sine * np.sin(damped * t)
        expected = np.imag(steady * np.exp(1j * w * t)) + np.exp(-xi * omega[i] * t) * free
        found = run[f"q_{i + 1}"].values[: t.size]
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-10 * np.abs(expected).max())


@pytest.mark.parametrize("number", [1, 2, 3, 4, 5, 6, 7, 9])
def test_base_shear_and_moment_balance_the_pivot(number: int) -> None:
    groups, record = bending_scene(number)
    for device in ("damper", "inerter", "fuse"):
        groups.pop(device, None)
    groups["output"] = {"dt": 0.01}
    run = rwmf.simulate(_case(groups, record, rtol=1e-8))
    theta = run["theta"].values
    rocking = np.abs(theta) > 0
    assert rocking.sum() > 20
    sine, cosine = np.sin(theta), np.cos(theta)
    normal = run["pivot_normal_over_m_w_g"].values
    horizontal = run["pivot_horizontal_over_m_w_g"].values
    shear = horizontal * cosine - normal * sine
    arm = -np.sign(theta) * groups["wall"]["b"]
    moment = arm * (horizontal * sine + normal * cosine)
    for name, expected in (("shear", shear), ("moment", moment)):
        key = next(k for k in run.variables if str(k).startswith(f"wall_{name}_base_over"))
        size = np.abs(expected).max()
        assert np.abs(run[key].values - expected)[rocking].max() < 1e-12 * size


@pytest.mark.parametrize("coupling", ["single", "full", "every_floor"])
def test_a_stiff_wall_tends_to_the_rigid_wall(coupling: str) -> None:
    """Up to the first impact the difference falls with the reciprocal of the stiffness."""
    frame: Groups = {"frame": {"T_s": 0.8, "gamma": 3.0, "xi_s": 0.05}}
    if coupling != "single":
        storeys = {"m_over_m_w": [1.5, 1.5], "k_over_m_w": [400.0, 300.0], "height": [H, H]}
        frame = {"frame": {"xi_s": 0.05}, "storeys": storeys | {"coupling": coupling}}
    scene = _block(**frame, output={"dt": 0.005}, solver={"t_end": 0.35})
    scene["motion"] = {"kind": "sine", "cycles": 2, "a_max_g": 0.7, "T_p": 1.4}
    rigid = rwmf.simulate(_case({k: v for k, v in scene.items() if k != "bending"}, None))
    assert rigid.flat()["impacts"] == 0
    assert float(np.abs(rigid["theta"].values[-1])) > 1e-4
    errors = []
    for stiffness in (1e8, 1e10):
        scene["bending"] = {"EI_over_m_w": stiffness, "modes": 1, "xi": 1.0}
        run = rwmf.simulate(_case(scene, None))
        errors.append(float(np.abs(run["u_s"].values - rigid["u_s"].values).max()))
    assert errors[0] < 1e-2 * float(np.abs(rigid["u_s"].values).max())
    assert errors[1] == pytest.approx(errors[0] / 100, rel=0.3)


@pytest.mark.parametrize("number", [2, 4, 9])
def test_a_delayed_motion_gives_the_same_maxima(number: int) -> None:
    groups = bending_scene(number)[0]
    groups["motion"] = {"kind": "one_sine", "a_max_g": 0.6, "T_p": 0.6}
    runs = [rwmf.simulate(_case(groups, None)).flat()]
    groups["motion"]["t_0"] = 0.375
    groups["solver"]["t_end"] += 0.375
    runs.append(rwmf.simulate(_case(groups, None)).flat())
    assert runs[0]["impacts"] > 0
    keys = [key for key in runs[0] if "_max" in key and not key.startswith(("sensitivity", "t_"))
            and not key.endswith(("_t_s", "height_m"))]  # fmt: skip
    assert len(keys) > 10
    for key in keys:
        assert runs[1][key] == pytest.approx(runs[0][key], rel=1e-8, abs=1e-12), key


@pytest.mark.parametrize("method", ["adams", "bdf", "taylor"])
def test_methods_agree(method: str) -> None:
    groups, record = bending_scene(6)
    expected = rwmf.simulate(_case(groups, record))
    found = rwmf.simulate(_case(groups, record, rtol=1e-9, method=method))
    for key in ("u_s_max_m", "tip_deflection_max_m", "wall_moment_max_over_m_w_g_m"):
        assert found.flat()[key] == pytest.approx(expected.flat()[key], rel=1e-7)


@pytest.mark.parametrize("method", ["adams", "bdf"])
def test_methods_pass_a_lift_off_beside_smooth_storeys(method: str) -> None:
    """The first step after this lift-off lasts a hundred spacings of the time."""
    groups, record = bending_scene(98)
    groups["bending"]["modes"] = 2
    groups["cable"] = {"eta_0": 0.5, "eta_alpha": 2.0, "eta_y": 0.993}
    groups["yielding"] = {"storey_u_y": [0.0466, 0.0189], "law": "bouc_wen"}
    peaks = []
    for given in (method, "dop853"):
        case = _case(groups, record, method=given, rtol=1e-9, t_end=1.0, max_steps=10_000)
        run = rwmf.simulate(case)
        assert int(run["lift_offs"]) == 1
        peaks.append([float(run[name]) for name in ("theta_dot_max", "tip_deflection_max")])
    assert peaks[0] == pytest.approx(peaks[1], rel=1e-8)


def test_a_nonlinear_damper_lets_the_wall_lift_off_once() -> None:
    """The damper ends a step at each turn, and the acceleration at lift-off is round-off."""
    groups = _block(
        3, wall={"h": 7.80785, "b": 1.42688}, cable={"eta_0": 0.663457, "eta_alpha": 3.4616},
        motion={"kind": "one_cosine", "a_max_g": 0.434013, "T_p": 0.893528},
        vertical={"ratio": 0.473646}, nl_damper={"eta_1": 0.14397, "exponent": 1.5},
        solver={"t_end": 1.5},
    )  # fmt: skip
    groups["bending"]["EI_over_m_w"] = 143409.0
    events, peaks = [], []
    for method in ("dop853", "taylor", "adams", "bdf"):
        run = rwmf.simulate(_case(groups, None, method=method, rtol=1e-9, max_steps=100_000))
        events.append([int(run[name]) for name in ("impacts", "lift_offs")])
        peaks.append([float(run[name]) for name in ("theta_dot_max", "tip_deflection_max")])
    assert events == 4 * [events[0]]
    assert events[0][1] == events[0][0] + 1
    for found in peaks[1:]:
        assert found == pytest.approx(peaks[0], rel=1e-7)


def test_peaks_do_not_depend_on_the_end_of_a_chatter() -> None:
    groups, record = bending_scene(2022)
    groups["cable"] = {
        "eta_0": 0.766611, "eta_alpha": 5.52294, "law": "truss",
        "eta_y": 0.825181, "hardening": 0.013149,
    }  # fmt: skip
    runs = [rwmf.simulate(_case(groups, record, rtol=rtol)) for rtol in (1e-12, 1e-10, 1e-8)]
    assert len({int(run["impacts"]) for run in runs}) == 3
    for run in runs[1:]:
        assert float(run["floors_velocity_max"][0]) == pytest.approx(
            float(runs[0]["floors_velocity_max"][0]), rel=1e-9
        )


@pytest.mark.parametrize(
    ("number", "key"),
    [
        (10, "pivot_normal_min_over_m_w_g"),
        (178, "wall_shear_base_max_over_m_w_g"),
        (133, "pivot_normal_min_over_m_w_g"),
    ],
)
def test_peaks_at_the_end_of_a_chatter_are_its_limit(
    number: int, key: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Bounces become ever shorter; the peak is that of the last one, which has no duration."""
    groups, record = bending_scene(number)
    runs = [rwmf.simulate(_case(groups, record, rtol=rtol)).flat() for rtol in (1e-8, 1e-12)]
    values = [run[key] for run in runs]
    assert values[0] == pytest.approx(values[1], rel=2e-7)
    errors = []
    for duration in (1e-7, 1e-9):
        monkeypatch.setattr(bending, "CHATTER", duration)
        wall = BentWall(groups, ground_of(record))
        errors.append(abs(wall.largest(wall.follow())[key] - values[1]))
    assert errors[1] < 0.02 * errors[0] < 1e-3 * abs(values[1])


def test_stiffness_from_the_modulus_of_elasticity() -> None:
    wall = {"h": H, "b": B, "thickness": 0.3, "density": 2500.0}
    mass = 2500.0 * 0.3 * 2 * B * 2 * H
    stiffness = 0.5 * 3e10 * 0.3 * (2 * B) ** 3 / 12 / mass
    by_modulus = _block(wall=wall, bending={"E": 3e10, "cracking": 0.5, "modes": 2})
    by_ratio = _block(wall=wall, bending={"EI_over_m_w": stiffness, "modes": 2})
    by_force = _block(wall=wall, bending={"EI": stiffness * mass, "modes": 2})
    runs = [rwmf.simulate(_case(g, None, rtol=1e-9)) for g in (by_modulus, by_ratio, by_force)]
    tips = [run.flat()["tip_deflection_max_m"] for run in runs]
    assert tips == pytest.approx([tips[1]] * 3, rel=1e-9)


LAWS: list[dict[str, object]] = [
    {"hardening": 0.05},
    {"law": "bouc_wen", "hardening": 0.05},
    {"law": "pinched", "cap": 4.0, "post_cap": 10.0, "pinch_force": 0.5},
]


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("load", [{}, {"m_g_over_m_s": 1.2}])
def test_a_yielding_mass_is_a_frame_of_one_storey(
    law: dict[str, object], load: dict[str, object]
) -> None:
    T_s, gamma, u_y = 0.6, 2.0, 0.01
    k = gamma * (2 * math.pi / T_s) ** 2
    storey = {"m_over_m_w": [gamma], "k_over_m_w": [k], "height": [2 * H], "coupling": "full"}
    beside: Groups = {"p_delta": load} if load else {}
    common = {"frame": {"xi_s": 0.03}, "output": {"energy": True, "reactions": True}}
    mass = {"frame": {"T_s": T_s, "gamma": gamma, "xi_s": 0.03}}
    scenes = [
        _block(**beside, **common, storeys=storey, yielding={**law, "storey_u_y": u_y}),
        _block(**beside, **(common | mass), yielding={**law, "u_y": u_y}),
        _block(
            **beside, **(common | mass), yielding={**law, "f_y_over_m_s_g": u_y * k / gamma / 9.81}
        ),
    ]
    runs = [rwmf.simulate(_case(scene, None)) for scene in scenes]
    assert float(runs[0].ductility) > 2
    for run in runs:
        assert float(run.energy_balance_relative) < 1e-10
        for key, value in runs[0].data_vars.items():
            if value.ndim == 0 and value.dtype.kind == "f" and key != "energy_balance_relative":
                # a sensitivity is a difference of two runs over a step of 1e-5: 1e-13 of a peak
                # changes it by 1e-8
                is_quotient = key.startswith("sensitivity")
                rel, least = (1e-5, 1e-8) if is_quotient else (1e-7, 1e-12)
                assert float(run[key]) == pytest.approx(float(value), rel=rel, abs=least), key


@pytest.mark.parametrize("key", ["u_y", "f_y_over_m_s_g"])
def test_the_spectrum_of_a_yielding_mass_agrees_with_runs(key: str) -> None:
    def case(**groups: object) -> rwmf.Case:
        strength = {key: 0.02 if key == "u_y" else 0.3, "law": "bouc_wen"}
        frame = {"gamma": 2.0, "xi_s": 0.05} | groups.pop("frame", {})
        return rwmf.Case(**_block(frame=frame, yielding=strength, **groups))

    grid = case(spectrum={"T_s": [0.3, 0.7], "gamma": [1.0, 3.0]})
    found = rwmf.spectrum(grid, quantities=("u_s_max", "ductility"))
    for T_s in (0.3, 0.7):
        for gamma in (1.0, 3.0):
            run = rwmf.simulate(case(frame={"T_s": T_s, "gamma": gamma}))
            ordinate = found.sel(T_s=T_s, gamma=gamma).squeeze()
            assert float(ordinate.u_s_max) == pytest.approx(float(run.u_s_max), rel=1e-7)
            assert float(ordinate.ductility) == pytest.approx(float(run.ductility), rel=1e-7)


test_refusals_name_the_group = refusals(
    lambda changed: rwmf.Case(**{k: v for k, v in (_block() | changed).items() if v}),
    ({"bending": {"modes": 2}}, "EI_over_m_w"),
    ({"bending": {"EI_over_m_w": 1e5, "modes": 13}}, "modes"),
    ({"bending": {"EI_over_m_w": -1.0}}, "EI_over_m_w"),
    ({"bending": {"EI_over_m_w": 1e5, "nu": 0.7}}, "nu"),
    ({"bending": {"EI_over_m_w": 1e5, "damping": "rayleigh"}}, "modal"),
    ({"bending": {"EI_over_m_w": 1e5, "cracking": 0.5}}, "cracking"),
    ({"bending": {"E": 3e10}}, "thickness"),
    ({"impact": {"rule": "constant", "e": 0.9}}, "coupled"),
    ({"model": {"formulation": "published"}}, "exact"),
    ({"wall": {"h": H, "b": B, "base": "pinned"}, "impact": {}}, "pinned"),
    ({"frame": {"T_s": 1.0, "gamma": 2.0}, "link": {"length": 3.0}}, "link"),
)  # fmt: skip
