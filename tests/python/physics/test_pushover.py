"""Static curves: closed forms, slow motions, energy, invariances, marks, branches."""

import math
from typing import Any

import numpy as np
import pytest
import rwmf
import scipy.linalg
import xarray as xr
from refused import refusals

G = 9.81
H, B = 2.0, 0.5
R, ALPHA = math.hypot(H, B), math.atan2(B, H)
STOREYS: dict[str, Any] = {
    "m_over_m_w": [1.5, 1.4, 1.0],
    "k_over_m_w": [900.0, 800.0, 500.0],
    "height": [1.5, 1.3, 1.2],
}
EXACT = 1e-12


def _case(**changes: dict[str, Any] | None) -> rwmf.Case:
    groups: dict[str, Any] = {
        "wall": {"h": H, "b": B},
        "frame": {"T_s": 0.8, "gamma": 5.0, "xi_s": 0.05},
        "cable": {"eta_0": 1.0, "eta_alpha": 4.0},
        "model": {"formulation": "exact"},
        "motion": {"kind": "one_sine", "a_max_g": 0.45, "T_p": 0.7},
        "solver": {"t_end": 0.4},
    }
    for name, keys in changes.items():
        if keys is None:
            groups.pop(name, None)
        else:
            merged = groups.get(name, {}) | keys
            groups[name] = {key: value for key, value in merged.items() if value is not None}
    return rwmf.Case(**groups)


def _storeys(coupling: str, **changes: dict[str, Any] | None) -> rwmf.Case:
    storeys = STOREYS | {"coupling": coupling}
    if coupling == "springs":
        storeys["k_link_over_m_w"] = 2000.0
    return _case(frame={"T_s": None, "gamma": None}, storeys=storeys, **changes)


def _rotation(drift: np.ndarray) -> np.ndarray:
    """Rotation at a drift of the left top corner, positive and negative."""
    u = 2 * H * drift
    right = ALPHA - np.arcsin(math.sin(ALPHA) - u / (2 * R))
    return np.where(u > 0, right, np.arcsin(u / (2 * H)))


def _frame_force(u: np.ndarray) -> np.ndarray:
    return 5.0 * (2 * math.pi / 0.8) ** 2 * u


def _resisting(curve: xr.Dataset, tendon: Any, extra: Any = None) -> np.ndarray:  # noqa: ANN401
    """Return the base shear over the weight by the moment about the pivot.

    `tendon` and `extra` are functions of |theta|, moments over m_w.
    """
    drift = curve["roof_drift"].values
    theta = _rotation(drift)
    side, phi = np.where(theta >= 0, 1.0, -1.0), np.abs(theta)
    lever = 2 * R * np.where(theta >= 0, np.cos(ALPHA - phi), math.cos(ALPHA) * np.cos(phi))
    moment = G * R * np.sin(ALPHA - phi) + tendon(phi)
    if extra is not None:
        moment = moment + extra(phi)
    force = side * moment / lever + _frame_force(2 * H * drift)
    return force / (6.0 * G)


def _linear(phi: np.ndarray) -> np.ndarray:
    return G * B * (1.0 + 3.0 * phi / ALPHA)


def _marked(curve: xr.Dataset, name: str) -> list[int]:
    return [
        int(step)
        for mark, step in zip(curve["mark"].values, curve["mark_step"].values, strict=True)
        if mark == name
    ]


@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_corner_model(direction: float) -> None:
    """Gravity, tendon and frame against the moment about the pivot, on both sides."""
    curve = rwmf.pushover(_case(), direction * 0.06)
    after = slice(_marked(curve, "uplift")[0] + 1, None)
    found = curve["base_shear_over_weight"].values[after]
    expected = _resisting(curve, _linear)[after]
    assert np.abs(found / expected - 1).max() < EXACT
    theta = _rotation(curve["roof_drift"].values[after])
    assert np.abs(curve["theta"].values[after] / theta - 1).max() < EXACT
    assert float(curve["roof_drift"][-1]) == pytest.approx(direction * 0.06, abs=1e-15)


def test_uplift_and_decompression() -> None:
    """At lift-off the moment about the ground is (weight + tendon) b; a third decompresses."""
    curve = rwmf.pushover(_case())
    moment = curve["overturning_moment_over_weight"].values * 6.0
    assert moment[_marked(curve, "uplift")[0]] == pytest.approx(2.0 * B, rel=EXACT)
    assert moment[_marked(curve, "decompression")[0]] == pytest.approx(2.0 * B / 3, rel=EXACT)
    assert curve.attrs["ending"] == "complete"


@pytest.mark.parametrize("coupling", ["full", "every_floor"])
@pytest.mark.parametrize("eta_0", [30.0, 1000.0])
def test_a_strong_tendon_holds_until_its_moment(coupling: str, eta_0: float) -> None:
    """Free floors move for a long time before the wall lifts off."""
    case = _storeys(coupling, cable={"eta_0": eta_0, "eta_alpha": 2 * eta_0})
    curve = rwmf.pushover(case, (0.002, -0.002), "roof", steps=10)
    assert curve.attrs["ending"] == "complete"
    uplift = _marked(curve, "uplift")[0]
    assert float(curve["wall_moment_base_over_m_w_g"][uplift]) == pytest.approx(
        -(1 + eta_0) * B, rel=1e-9
    )


@pytest.mark.parametrize("base", ["rocking", "pinned"])
def test_block_alone(base: str) -> None:
    """Without a frame the load acts on the top; a hinged wall without tendon has no strength."""
    case = _case(frame=None, cable=None, wall={"base": base})
    curve = rwmf.pushover(case, 0.05)
    theta = curve["theta"].values[-1]
    lever = 2 * R * math.cos(ALPHA - theta) if base == "rocking" else 2 * H * math.cos(theta)
    arm = R * math.sin(ALPHA - theta) if base == "rocking" else -H * math.sin(theta)
    assert float(curve["base_shear_over_weight"][-1]) == pytest.approx(arm / lever, rel=EXACT)


def test_tendon_yields_and_breaks() -> None:
    """The truss tendon: length of the straight line, bilinear force, nothing after rupture."""
    length = 2 * H
    rate = 3.0 / (math.sqrt(4 * H**2 + _rise(ALPHA)) - length)

    def stretch(phi: np.ndarray) -> np.ndarray:
        return np.sqrt(4 * H**2 + _rise(phi)) - length

    cable = {"law": "truss", "eta_y": 1.5, "hardening": 0.1, "rupture_strain": 0.018}
    curve = rwmf.pushover(_case(cable=cable), 0.08)
    x_y, x_r = 0.5 / rate, 4.0 * 0.018 - 1.0 / rate
    theta = curve["theta"].values
    assert stretch(theta[_marked(curve, "tendon_yield")[0]]) == pytest.approx(x_y, rel=EXACT)
    assert stretch(theta[_marked(curve, "tendon_rupture")[0]]) == pytest.approx(x_r, rel=EXACT)
    x = stretch(theta)
    force = np.where(x <= x_y, 1.0 + rate * x, 1.5 + 0.1 * rate * (x - x_y))
    force[_marked(curve, "tendon_rupture")[0] + 1 :] = 0.0
    assert np.abs(curve["cable_force_over_m_w_g"].values - force).max() < EXACT
    arm = B * (B * np.sin(theta) + 2 * H * np.cos(theta)) / np.sqrt(4 * H**2 + _rise(theta))
    after = slice(_marked(curve, "uplift")[0] + 1, None)
    expected = _resisting(curve, lambda _: G * force * arm)[after]
    found = curve["base_shear_over_weight"].values[after]
    assert np.abs(found - expected).max() < EXACT


def _rise(phi: Any) -> Any:  # noqa: ANN401
    return 2 * B**2 * (1 - np.cos(phi)) + 4 * H * B * np.sin(phi)


def test_fuse() -> None:
    """A fuse under the lifting corner: stroke 4 b sin(theta/2) and its arm, bilinear."""
    case = _case(fuse={"eta_y": 0.5, "stroke_y": 0.004, "hardening": 0.05})
    curve = rwmf.pushover(case)

    def moment(phi: np.ndarray) -> np.ndarray:
        stroke = 4 * B * np.sin(phi / 2)
        force = np.where(stroke < 0.004, 0.5 * stroke / 0.004, 0.5 + 0.025 * (stroke / 0.004 - 1))
        return G * force * 2 * B * np.cos(phi / 2)

    after = slice(_marked(curve, "uplift")[0] + 1, None)
    found = curve["base_shear_over_weight"].values[after]
    assert np.abs(found / _resisting(curve, _linear, moment)[after] - 1).max() < EXACT
    theta = curve["theta"].values[_marked(curve, "fuse_left_yield")[0]]
    assert 4 * B * math.sin(theta / 2) == pytest.approx(0.004, rel=EXACT)


def test_link_of_finite_length() -> None:
    """The tilt of the link adds to the displacement, and its slope is the arm of the force."""
    case = _case(link={"L": 5.0})
    curve = rwmf.pushover(case, 0.05)
    theta = curve["theta"].values[-1]

    def u(phi: float) -> float:
        v = _rise_of_corner(phi)
        return 2 * R * (math.sin(ALPHA) - math.sin(ALPHA - phi)) + 5.0 - math.sqrt(25.0 - v**2)

    v = _rise_of_corner(theta)
    v_1 = 2 * R * math.sin(ALPHA - theta)
    slope = 2 * R * math.cos(ALPHA - theta) + v * v_1 / math.sqrt(25.0 - v**2)
    assert u(theta) == pytest.approx(0.2, rel=EXACT)
    moment = G * R * math.sin(ALPHA - theta) + float(_linear(np.array(theta)))
    expected = (moment / slope + _frame_force(np.array(0.2))) / (6.0 * G)
    assert float(curve["base_shear_over_weight"][-1]) == pytest.approx(float(expected), rel=EXACT)


def _rise_of_corner(phi: float) -> float:
    return 2 * R * (math.cos(ALPHA - phi) - math.cos(ALPHA))


CYCLE = (0.01, -0.012, 0.02, -0.02, 0.0)
LAWS: list[dict[str, Any]] = [
    {},
    {"law": "friction", "breakaway": 1.2},
    {"law": "flag", "flag_height": 0.8},
    {"law": "peak_oriented", "cap": 4.0, "post_cap": 8.0, "lambda": 30.0},
    {"law": "pinched", "cap": 4.0, "post_cap": 8.0, "pinch_force": 0.3, "pinch_displacement": 0.5},
    {"law": "bouc_wen", "exponent": 2.0},
    {"law": "bouc_wen", "exponent": 1.5, "beta": 0.7},
]


# a frame held straight has no smooth springs
LOOPS = [
    (coupling, law)
    for coupling in ("single", "every_floor", "full", "springs", "bending")
    for law in (LAWS if coupling == "full" else LAWS[::3])
    if (coupling, law.get("law")) != ("every_floor", "bouc_wen")
]


@pytest.mark.parametrize(("coupling", "law"), LOOPS)
def test_loops_dissipate_the_ledger(coupling: str, law: dict[str, Any]) -> None:
    """Cyclic, with fuses and a tendon that yields: work = stored + dissipated + released energy.

    The work is integrated along the path, by cubics between the rows: exact but for smooth laws.
    Only a drop of the force that moves free floors releases energy.
    """
    case = _yielding(coupling, law)
    jumps = coupling in ("full", "springs", "bending") and "breakaway" in law
    if jumps and coupling == "full":
        # a storey without hardening would creep to the drift limit
        case = case.replace(p_delta=None)
    curve = rwmf.pushover(case, CYCLE, steps=100)
    assert curve.attrs["ending"] == "complete"
    work, stored = curve["energy_work"].values, curve["energy_stored"].values
    spent, freed = curve["energy_hysteretic"].values, curve["energy_released"].values
    assert np.diff(freed).min() > -1e-12 * spent[-1]
    assert (freed[-1] > 1e-3 * spent[-1]) == jumps
    # laws that wear split the work anew as their unloading stiffness falls
    if "cap" not in law:
        assert np.diff(spent).min() > -1e-11 * spent[-1]
    size = float(spent[-1])
    assert size > 0
    most = 1e-6 if "exponent" in law else 1e-10
    assert abs(work - (stored - stored[0]) - spent - freed).max() < most * size


def _yielding(coupling: str, law: dict[str, Any]) -> rwmf.Case:
    """Return a scene in which all springs yield."""
    changes: dict[str, Any] = {
        "cable": {"law": "truss", "eta_y": 1.2, "hardening": 0.05},
        "fuse": {"eta_y": 0.3, "stroke_y": 0.004, "hardening": 0.02},
        "p_delta": {"m_g_over_m_s": 1.0},
    }
    hardening = {} if law.get("law") == "friction" else {"hardening": 0.03}
    if coupling == "single":
        changes["yielding"] = {"u_y": 0.02} | hardening | law
        return _case(**changes)
    changes["yielding"] = {"storey_u_y": 0.008} | hardening | law
    if coupling == "bending":
        changes |= {"bending": {"EI_over_m_w": 2e4, "modes": 2}, "impact": {"rule": "coupled"}}
    return _storeys("springs" if coupling == "bending" else coupling, **changes)


@pytest.mark.slow
@pytest.mark.parametrize("coupling", ["single", "full"])
def test_slow_motion(coupling: str) -> None:
    """A slow ramp of the ground, up and back, extrapolated to zero rate, follows the curve.

    To the right, the inertia of the rigid wall acts like half its mass on the roof.
    """
    changes: dict[str, Any] = {
        "cable": {"law": "truss", "eta_y": 1.3, "hardening": 0.2},
        "fuse": {"eta_y": 0.3, "stroke_y": 0.004, "hardening": 0.1},
        "yielding": {"hardening": 0.2},
    }
    if coupling == "single":
        changes["yielding"] |= {"u_y": 0.02}
        case = _case(**changes, wall={"h": H, "b": B})
        masses = np.array([5.0])
    else:
        changes["yielding"] |= {"storey_u_y": 0.008}
        case = _storeys(coupling, **changes)
        masses = np.array(STOREYS["m_over_m_w"])
    frame = {"xi_s": 1.0}
    case = case.replace(frame=frame, impact={"rule": "coupled"})
    loads = masses.copy()
    loads[-1] += 0.5
    a_max = 3.2
    static = rwmf.pushover(case, (0.05, 0.0), loads.tolist(), steps=400)
    shear = static["base_shear_over_weight"].values * (1 + masses.sum()) * G / loads.sum()
    drift = static["roof_drift"].values
    top = int(np.argmax(drift))
    assert shear[:top].max() > a_max
    found = []
    times = (300.0, 600.0)
    for time in times:
        t = np.array([0.0, time, 1.5 * time])
        a = -a_max / G * np.array([0.0, 1.0, 0.5])
        motion = rwmf.Motion(G * a, times=t, unit="m/s2")
        run = rwmf.simulate(
            case.replace(
                motion=motion, solver={"t_end": t[-1]}, output={"dt": t[-1] / 12, "reactions": True}
            )
        )
        found.append(run["frame_drift"].values)
    dynamic = (2 * found[1] - found[0])[2:9]
    assert dynamic.max() > 0.009
    loading = np.interp(a_max * np.array([2, 3, 4, 5, 6, 7, 8]) / 8, shear[:top], drift[:top])
    assert np.abs(dynamic - loading).max() < 1e-3 * dynamic.max()


@pytest.mark.parametrize("coupling", ["springs", "bending"])
def test_slow_stairs(coupling: str) -> None:
    """At the end of slow stairs of the ground acceleration the floors stand on the curve.

    The wall is light: its distributed inertia is no load of floors. Storeys and a fuse yield.
    """
    light = 40.0
    heavy = {key: [light * value for value in STOREYS[key]] for key in ("m_over_m_w", "k_over_m_w")}
    case = _storeys(
        "springs",
        cable={"law": "truss", "eta_0": light, "eta_alpha": 4 * light},
        fuse={"eta_y": 0.3 * light, "stroke_y": 0.004, "hardening": 0.1},
        yielding={"storey_u_y": 0.008, "hardening": 0.2},
        impact={"rule": "coupled"},
    ).replace(storeys=heavy | {"k_link_over_m_w": 2000.0 * light}, frame={"xi_s": 1.0})
    if coupling == "bending":
        case = case.replace(bending={"EI_over_m_w": 4e3 * light, "modes": 1})
    loads = np.array(heavy["m_over_m_w"])
    loads[-1] += 0.5
    curve = rwmf.pushover(case, 0.02, loads.tolist(), steps=400)
    weight = 1 + sum(heavy["m_over_m_w"])
    acceleration = curve["base_shear_over_weight"].values * weight * G / loads.sum()
    for mark in ("fuse_left_yield", "storey_1_yield", "storey_3_yield"):
        assert 2.2 < acceleration[_marked(curve, mark)[0]] < 3.4
    levels = np.array([0.4, 2.2, 3.4])
    times = np.cumsum([0.0, 5.0, 5.0, 5.0, 5.0, 5.0, 9.0])
    motion = rwmf.Motion(-np.array([0.0, *np.repeat(levels, 2)]), times=times, unit="m/s2")
    run = rwmf.simulate(
        case.replace(motion=motion, solver={"t_end": times[-1]}, output={"dt": 1.0})
    )
    at = [int(t) for t in times[2::2]]
    found = run["floors"].sel(time=at, method="nearest").values
    for i in range(3):
        drift = curve["floors"].values[:, i]
        expected = np.interp(levels, acceleration, drift)
        assert np.abs(found[:, i] - expected).max() < 1e-3 * expected.max()


@pytest.mark.parametrize("coupling", ["every_floor", "full", "springs"])
def test_first_mode(coupling: str) -> None:
    """The pattern is mass times first mode of the frame, by SciPy or the straight line."""
    m, k = np.array(STOREYS["m_over_m_w"]), np.array(STOREYS["k_over_m_w"])
    stiffness = np.diag(k + np.append(k[1:], 0.0)) - np.diag(k[1:], 1) - np.diag(k[1:], -1)
    shape = scipy.linalg.eigh(stiffness, np.diag(m))[1][:, 0]
    if coupling == "every_floor":
        shape = np.cumsum(STOREYS["height"])
    curve = rwmf.pushover(_storeys(coupling), 0.01)
    expected = m * shape / (m * shape).sum()
    assert np.allclose(curve.attrs["pattern_shares"], expected, rtol=1e-9, atol=0.0)


def test_first_mode_of_a_frame_alone() -> None:
    """Under the load of its first mode an elastic frame takes the shape of this mode."""
    case = _storeys("full", wall=None, cable=None)
    curve = rwmf.pushover(case, 0.01)
    m, k = np.array(STOREYS["m_over_m_w"]), np.array(STOREYS["k_over_m_w"])
    stiffness = np.diag(k + np.append(k[1:], 0.0)) - np.diag(k[1:], 1) - np.diag(k[1:], -1)
    square, shapes = scipy.linalg.eigh(stiffness, np.diag(m))
    shape = shapes[:, 0] / shapes[-1, 0]
    assert np.allclose(curve["floors"].values[-1], 0.04 * shape, rtol=1e-9)
    base = square[0] * (m * shape).sum() * 0.04 / (m.sum() * G)
    assert float(curve["base_shear_over_weight"][-1]) == pytest.approx(base, rel=1e-9)
    assert curve.attrs["weight"] == "weight of the frame"


@pytest.mark.parametrize("coupling", ["reduced", "every_floor", "full", "springs"])
def test_balance_of_the_storeys(coupling: str) -> None:
    """Links and columns carry the load: each floor is in equilibrium, and so is the wall."""
    curve = rwmf.pushover(_storeys(coupling), 0.02)
    weight = 1 + sum(STOREYS["m_over_m_w"])
    load = weight * curve["base_shear_over_weight"].values
    columns = curve["storeys_shear_over_m_w_g"].values[:, 0]
    # the base of the wall and the lowest storey bear the load together
    if coupling != "reduced":
        # the cable along the axis of the wall leans as well
        anchor = curve["cable_force_over_m_w_g"].values * np.sin(curve["theta"].values)
        base = anchor - curve["pivot_horizontal_over_m_w_g"].values
        assert np.allclose(columns + base, load, atol=1e-11)
    shares = np.outer(load, curve.attrs["pattern_shares"])
    shears = curve["storeys_shear_over_m_w_g"].values
    shears = np.column_stack([shears, np.zeros(len(load))])
    links = shares - shears[:, :-1] + shears[:, 1:]
    if coupling in ("every_floor", "springs"):
        assert np.allclose(curve["links_force_over_m_w_g"].values, links, atol=1e-11)
    elif coupling == "full":
        assert np.allclose(links[:, :-1], 0.0, atol=1e-10)


def test_mirror() -> None:
    """`symmetric`: the curve to the left is the mirror image."""
    case = _yielding("single", {})
    assert case is not None
    case = case.replace(model={"formulation": "symmetric"})
    right = rwmf.pushover(case, CYCLE)
    left = rwmf.pushover(case, [-drift for drift in CYCLE])
    for name in ("roof_drift", "base_shear_over_weight", "theta"):
        assert np.allclose(right[name].values, -left[name].values, rtol=1e-12, atol=1e-15)
    swapped = [name.replace("left", "right") for name in right["mark"].values]
    assert swapped == [name.replace("left", "right") for name in left["mark"].values]


def test_newtons() -> None:
    """Keys in kg and N give the same curve, and forces in N."""
    ratios = _case(wall={"m_w": 2.0e4})
    m_w = 2.0e4
    newtons = _case(
        wall={"m_w": m_w},
        frame={"gamma": None, "m_s": 5.0 * m_w},
    )
    first, second = rwmf.pushover(ratios), rwmf.pushover(newtons)
    assert np.allclose(
        first["base_shear"].values, second["base_shear"].values, rtol=1e-12, atol=0.0
    )
    expected = first["base_shear_over_weight"].values * 6.0 * m_w * G
    assert np.allclose(first["base_shear"].values, expected, rtol=1e-14)
    assert np.allclose(
        first["cable_force"].values, first["cable_force_over_m_w_g"].values * m_w * G, rtol=1e-14
    )
    plain = rwmf.pushover(_case())
    assert np.array_equal(
        plain["base_shear_over_weight"].values, first["base_shear_over_weight"].values
    )
    assert "base_shear" not in plain


def test_scale_of_length() -> None:
    """Lengths times 4, accelerations unchanged: the same drifts and shears."""
    small = rwmf.pushover(_case())
    large = rwmf.pushover(_case(wall={"h": 4 * H, "b": 4 * B}, frame={"T_s": 1.6}))
    for name in ("roof_drift", "base_shear_over_weight", "theta"):
        assert np.allclose(small[name].values, large[name].values, rtol=1e-11, atol=1e-14)


def test_softening_turns_back() -> None:
    """A weak storey that softens while the others unload: the roof turns back and goes on."""
    yielding = {
        "storey_u_y": [0.05, 0.004, 0.05],
        "law": "peak_oriented",
        "cap": 2.0,
        "post_cap": 0.6,
        "residual": 0.1,
        "hardening": 0.05,
    }
    case = _storeys("full", wall=None, cable=None, yielding=yielding)
    curve = rwmf.pushover(case, 0.02, "roof")
    assert curve.attrs["ending"] == "complete"
    drift, shear = curve["roof_drift"].values, curve["base_shear_over_weight"].values
    assert np.diff(drift).min() < 0
    m = np.array(STOREYS["m_over_m_w"])
    weight, k = m.sum() * G, np.array(STOREYS["k_over_m_w"])
    capping = _marked(curve, "storey_2_capping")[0]
    residual = _marked(curve, "storey_2_residual")[0]
    f_y = k[1] * 0.004
    f_cap = f_y * 1.05
    assert shear[capping] * weight == pytest.approx(f_cap, rel=EXACT)
    assert shear[residual] * weight == pytest.approx(0.1 * f_y, rel=EXACT)
    elastic = f_cap / k[0] + f_cap / k[2]
    assert drift[capping] * 4.0 == pytest.approx(0.008 + elastic, rel=EXACT)
    assert shear[-1] * weight == pytest.approx(0.1 * f_y, rel=1e-10)


def test_overturning_and_limits() -> None:
    """The path ends where a run would: at the overturning angle, or at the drift limit."""
    case = _case(frame=None, model={"overturning_angle": 0.2})
    curve = rwmf.pushover(case, 1.0)
    assert curve.attrs["ending"] == "overturned" == str(curve["mark"].values[-1])
    assert float(curve["theta"][-1]) == pytest.approx(0.2, rel=1e-15)
    curve = rwmf.pushover(_case(p_delta={"drift_limit": 0.013}))
    assert curve.attrs["ending"] == "collapsed"
    assert float(curve["roof_drift"][-1]) == pytest.approx(0.013, rel=EXACT)


test_errors = refusals(
    lambda arguments: rwmf.pushover(_case(), **arguments),
    ({"drifts": []}, "drifts"),
    ({"drifts": [0.01, 0.01]}, "must differ from the drift before it"),
    ({"drifts": 1.5}, "must be between -1 and 1"),
    ({"drifts": float("nan")}, "drifts"),
    ({"drifts": 0.0}, "must differ"),
    ({"pattern": "second_mode"}, "pattern = 'second_mode'"),
    ({"pattern": "floors"}, "needs forces"),
    ({"pattern": [1.0, 2.0]}, "has 2 values, must have one for each floor"),
    ({"pattern": [-1.0]}, "must be a finite number > 0"),
    ({"pattern": "roof", "forces": [1.0]}, "must only be given with the pattern 'floors'"),
    ({"pattern": [1.0], "forces": [1.0]}, "must not be given"),
    ({"steps": 0}, "steps"),
)


def test_height_is_needed() -> None:
    case = _case(wall=None, cable=None, frame={"gamma": None}, model=None)
    with pytest.raises(rwmf.InputError, match="needs the height of the frame"):
        rwmf.pushover(case)
    curve = rwmf.pushover(case.replace(p_delta={"h_f": 3.0, "m_g_over_m_s": 1.0}), 0.01)
    stiffness = (2 * math.pi / 0.8) ** 2 - G / 3.0
    assert float(curve["base_shear_over_weight"][-1]) == pytest.approx(
        stiffness * 0.03 / G, rel=EXACT
    )


@pytest.mark.parametrize("exponent", [1.0, 2.0])
def test_smooth_law(exponent: float) -> None:
    """Bouc and Wen: z = 1 - exp(-x) or tanh(x) on loading, a straight line back to z = 0."""
    u_y, a, height = 0.02, 0.1, 4.0
    case = _case(
        wall=None,
        cable=None,
        model=None,
        frame={"gamma": None},
        p_delta={"h_f": height, "m_g_over_m_s": 0.0},
        yielding={"law": "bouc_wen", "u_y": u_y, "hardening": a, "exponent": exponent, "beta": 0.5},
    )
    curve = rwmf.pushover(case, (0.03, 0.0))
    u = height * curve["roof_drift"].values
    top = int(np.argmax(u))
    law = np.tanh if exponent == 2 else (lambda x: -np.expm1(-x))
    z = law(u / u_y)
    # with beta = 1/2 nothing is lost while |z| falls
    back = z[top] - (u[top] - u) / u_y
    z = np.where(np.arange(len(u)) <= top, z, back)
    known = z >= 0
    force = (2 * math.pi / 0.8) ** 2 * (a * u + (1 - a) * u_y * z) / G
    found = curve["base_shear_over_weight"].values
    assert known.sum() > top + 10
    assert np.abs(found - force)[known].max() < EXACT
