"""Dimensional keys: the same scene as by its ratios, in every way of changing a number."""

import dataclasses
import json
import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rwmf
from combinations import combination
from dimensional import (
    SCENES,
    STRAND_AREA,
    STRANDS,
    G,
    groups_of,
    in_both,
    in_units,
)
from rwmf.cli import main
from rwmf.kernel import tables


@pytest.fixture(params=SCENES)
def both(request: pytest.FixtureRequest) -> tuple[rwmf.Case, rwmf.Case]:
    """Make a case in ratios, and the same in units."""
    return in_both(request.param)


def _numbers(case: rwmf.Case) -> dict[str, Any]:
    """Every number by group and key, dimensional keys left out."""
    plain = {f"{row[0]}.{row[1]}" for row in tables.schema() if re.search("[gNa]", row[3]) is None}
    return {
        f"{name}.{key}": value
        for name, group in case.groups.items()
        for key, value in group.items()
        if f"{name}.{key}" in plain and not isinstance(value, str)
    }


def test_each_key_is_its_ratio(both: tuple[rwmf.Case, rwmf.Case]) -> None:
    """Ratios derived from dimensional keys equal those converted by hand."""
    ratios, units = (_numbers(case) for case in both)
    assert set(ratios) - set(units) <= {"yielding.u_y"}
    # the strain at which the tendon breaks is that over its own length
    for key in set(ratios) & set(units) - {"cable.rupture_strain"}:
        np.testing.assert_allclose(units[key], ratios[key], rtol=1e-14, err_msg=key)


def test_same_motion(both: tuple[rwmf.Case, rwmf.Case]) -> None:
    """Peaks and forces, as ratios and in N."""
    output = {"reactions": True, "conditioning": False}
    runs = [rwmf.simulate(case.replace(output=output)) for case in both]
    for key in runs[0].data_vars:
        if runs[0][key].ndim == 0 and runs[0][key].dtype.kind == "f":
            if key == "tendon_strain_max" and "rupture_strain" in both[0].groups.get("cable", {}):
                continue  # over its own length, as above
            # a flat peak determines its value well, but its time and place poorly
            rtol = 1e-6 if re.search("^t_|_height$", str(key)) else 1e-9
            np.testing.assert_allclose(
                runs[1][key], runs[0][key], rtol=rtol, atol=1e-12, err_msg=str(key)
            )
    in_newtons = [key for key in runs[1].data_vars if runs[1][key].attrs.get("units") == "N"]
    assert in_newtons


def test_text_gives_the_same_case(both: tuple[rwmf.Case, rwmf.Case]) -> None:
    """A case is unchanged by writing and reading, and by setting the same numbers."""
    _, case = both
    again = rwmf.Case.from_text(case.to_namelist())
    assert again == case
    changed = again.replace(motion={"a_max_g": 0.3})
    if "cable" in case.groups:
        changed = changed.replace(cable={"initial_stress": 0.9 * case.cable.initial_stress})
        assert changed.cable.eta_0 == pytest.approx(0.9 * case.cable.eta_0, rel=1e-14)
    assert _numbers(changed) == _numbers(rwmf.Case.from_text(changed.to_namelist()))


# of the first 120 these two magnify round-off a thousand times
_SENSITIVE = {18: 1e-9, 58: 1e-9}


@pytest.mark.parametrize("number", [*range(20), 58])
def test_combinations(number: int, tmp_path: Path) -> None:
    """Random scenes in units move as in ratios."""
    scene = combination(number)
    cases = [
        dataclasses.replace(scene, groups=groups).build(tmp_path)
        for groups in (scene.groups, in_units(scene.groups))
    ]
    ratios, units = map(_numbers, cases)
    for key in set(ratios) & set(units) - {"cable.rupture_strain"}:
        np.testing.assert_allclose(units[key], ratios[key], rtol=1e-14, err_msg=key)
    runs = [rwmf.simulate(case) for case in cases]
    for key in ("u_s_max", "theta_max_over_alpha"):
        if key in runs[0]:
            rtol = _SENSITIVE.get(number, 1e-12)
            np.testing.assert_allclose(runs[1][key], runs[0][key], rtol=rtol)


def _refused(scene: str, **changes: dict[str, Any] | None) -> str:
    """Message of a scene in units with other keys; those of the scene stay."""
    groups = in_units(groups_of(scene))
    for group, keys in changes.items():
        both = groups.pop(group, {}) | (keys or {})
        if keys is not None:
            groups[group] = {key: value for key, value in both.items() if value is not None}
    with pytest.raises(rwmf.InputError) as found:
        rwmf.Case(**groups)
    return str(found.value)


@pytest.mark.parametrize(
    ("scene", "changes", "message"),
    [
        ("frame", {"frame": {"gamma": 4.0}}, "&frame: m_s = .* beside gamma"),
        ("frame", {"frame": {"T_s": 1.0}}, "&frame: k_s = .* beside T_s"),
        ("frame", {"frame": {"m_s": None, "gamma": 4.0}}, "&frame: k_s = .* without m_s"),
        ("frame", {"wall": {"m_w": 1.0}}, "&wall: density = .* beside m_w"),
        ("frame", {"wall": {"thickness": None}}, "&wall: density = .* without thickness"),
        ("frame", {"wall": {"density": None}}, "&wall: thickness = .* without density"),
        (
            "frame",
            {"wall": {"density": None, "thickness": None}},
            "&frame: m_s = .* needs the mass of the wall: m_w, or density and thickness",
        ),
        ("bare", {"frame": {"k_s": None}}, "&frame: the key T_s is missing"),
        ("bare yielding", {"frame": {"m_s": None, "k_s": None, "T_s": 1.0}}, "&frame m_s"),
        ("storeys full", {"storeys": {"k": None}}, "&storeys: m = .* without k or T_1"),
        ("storeys full", {"storeys": {"m": None, "m_over_m_w": [1.0] * 3}}, "k = .* without m$"),
        ("storeys full", {"storeys": {"m_over_m_w": [1.0] * 3}}, "m = .* beside m_over_m_w"),
        ("storeys full", {"storeys": {"k": [1e7, 1e7]}}, "&storeys: k = .*: has 2 values"),
        ("storeys full", {"storeys": {"n": 4}}, "&storeys: height = .* n = 4 storeys"),
        ("storeys full", {"storeys": {"distribution": "linear"}}, "distribution = .* without n"),
        ("storeys full", {"storeys": {"n": 3, "distribution": "linear"}}, "than one stiffness"),
        ("storeys full", {"yielding": {"storey_u_y": [0.01]}}, "storey_F_y = .* storey_u_y"),
        ("storeys full", {"yielding": {"storey_F_y": [1e5, 1e5]}}, "storey_F_y = .* has 2 values"),
        ("storeys reduced", {"yielding": {"u_y": None, "F_y": 1e5}}, "F_y = .* storey_F_y says"),
        ("corners", {"fuse": {"eta_y": 0.2}}, "&fuse: F_y = .* beside eta_y"),
        ("corners", {"fuse": {"F_y": None, "eta_y": 0.2}}, "&fuse: k = .* without F_y"),
        ("corners", {"fuse": {"k": 1e30}}, r"&fuse: k = 1e\+30: stroke_y = .*: the period"),
        ("corners", {"damper": {"c_over_m_w": 1.0}}, "&damper: c = .* beside c_over_m_w"),
        ("corners", {"inerter": {"inertance": None}}, "the key inertance_over_m_w is missing"),
        ("corners", {"cable": {"eta_0": 1.0}}, "&cable: strands = .* beside eta_0"),
        ("corners", {"cable": {"eta_alpha": 1.0}}, "&cable: modulus = .* beside eta_alpha"),
        ("corners", {"cable": {"eta_y": 1.0}}, "&cable: yield_stress = .* beside eta_y"),
        ("corners", {"cable": {"modulus": None}}, "&cable: strands = .* without modulus"),
        ("corners", {"cable": {"yield_stress": 1e6}}, r"yield_stress = 1.*: eta_y = .*> eta_0"),
        ("corners", {"cable": {"strand_area": 1e-320}}, "&cable: .* must be"),
        ("corners", {"p_delta": {"m_g": 1.0, "m_g_over_m_s": 1.0}}, "m_g = .* beside m_g_over_m_s"),
    ],
)
def test_what_is_refused(scene: str, changes: dict[str, Any], message: str) -> None:
    """Two ways at once, half of one, a wall without mass; by the key that is given."""
    assert re.search(message, _refused(scene, **changes)), _refused(scene, **changes)


def test_length_belongs_to_strands() -> None:
    groups = groups_of("corners")
    groups["cable"] = groups["cable"] | {"length": 3.0}
    with pytest.raises(
        rwmf.InputError, match=r"length = 3.0: .* without strands or rupture_strain"
    ):
        rwmf.Case(**groups)


def test_strands() -> None:
    """Forces follow from stresses; the steel ruptures at its strain over the tendon's length."""
    groups = in_units(groups_of("rupture"))
    case = rwmf.Case(**groups)
    cable, weight = case.cable, G * case.wall.m_w
    area = STRANDS * STRAND_AREA
    assert cable.eta_0 * weight == pytest.approx(area * cable.initial_stress, rel=1e-14)
    alpha = math.atan2(2.0, 9.0)
    stress = cable.initial_stress + cable.modulus * 2.0 * alpha / cable.length
    assert cable.eta_alpha * weight == pytest.approx(area * stress, rel=1e-14)
    # the wall is released at the rotation of the cable's rupture, or beyond it
    own = cable.initial_stress / cable.modulus
    theta = (cable.rupture_strain - own) * cable.length / 2.0
    for factor, breaks in ((0.999, False), (1.001, True)):
        start = {"theta_over_alpha": factor * theta / alpha}
        free = case.replace(
            initial=start, motion={"a_max_g": 1e-9}, frame=None, solver={"t_end": 1e-3}
        )
        assert bool(rwmf.simulate(free)["cable_ruptured"]) == breaks


@pytest.mark.parametrize("distribution", ["uniform", "linear", "straight_mode"])
@pytest.mark.parametrize("unit", ["kg", "m_w"])
def test_storeys_by_rule(distribution: str, unit: str) -> None:
    """One number each gives the stiffnesses of the rule or of the period."""
    numbers = {"m": 5e4, "k": 8e7} if unit == "kg" else {"m_over_m_w": 0.7, "k_over_m_w": 1100.0}
    mass, stiffness = numbers
    groups = in_units(groups_of("storeys full")) | {"yielding": None}
    rule = {"n": 6, "height": 3.0, "distribution": distribution, "coupling": "full"}
    del groups["yielding"]
    case = rwmf.Case(**groups | {"storeys": rule | numbers})
    k = np.array(case.storeys.k_over_m_w)
    height = np.full(6, 3.0).cumsum()
    expected = {
        "uniform": np.ones(6),
        "linear": 1 - (height - 3.0) / 18.0,
        "straight_mode": height[::-1].cumsum()[::-1] / height.sum(),
    }[distribution]
    np.testing.assert_allclose(k / k[0], expected, rtol=1e-14)
    factor = case.wall.m_w if unit == "kg" else 1.0
    assert k[0] == pytest.approx(numbers[stiffness] / factor, rel=1e-15)
    assert case.storeys.as_given()[stiffness] == (numbers[stiffness],)
    shape, omega = _first_mode(np.array(case.storeys.m_over_m_w), k)
    if distribution == "straight_mode":
        np.testing.assert_allclose(shape / shape[-1], height / 18.0, rtol=1e-12)
    timed = {"T_1": 0.9, mass: numbers[mass]}
    period = rwmf.Case(**groups | {"storeys": rule | timed})
    np.testing.assert_allclose(
        period.storeys.k_over_m_w, k * (2 * math.pi / 0.9 / omega) ** 2, rtol=1e-12
    )
    assert period.kernel.axes()["T_s"].value == pytest.approx(0.9, rel=1e-13)


def _first_mode(m: np.ndarray, k: np.ndarray) -> tuple[np.ndarray, float]:
    """Shape and frequency of a chain of masses."""
    matrix = np.diag(k + np.append(k[1:], 0.0)) - np.diag(k[1:], 1) - np.diag(k[1:], -1)
    values, vectors = np.linalg.eigh(matrix / np.sqrt(np.outer(m, m)))
    return vectors[:, 0] / np.sqrt(m), math.sqrt(values[0])


def test_period_scales_lists() -> None:
    """Lists give the proportions, in kg and N/m or as ratios."""
    groups = groups_of("bare storeys")
    groups["storeys"] = groups["storeys"] | {"T_1": 0.7}
    plain, units = rwmf.Case(**groups), rwmf.Case(**in_units(groups))
    for case in (plain, units):
        k = np.array(case.storeys.k_over_m_w)
        np.testing.assert_allclose(k / k[0], [1.0, 7 / 9, 5 / 9], rtol=1e-14)
        assert case.kernel.axes()["T_s"].value == pytest.approx(0.7, rel=1e-13)


@pytest.mark.parametrize("scene", ["frame", "corners", "storeys full", "storeys reduced"])
def test_width(scene: str) -> None:
    """An ordinate, a point and a run of another width have the same bits."""
    case = rwmf.Case(**in_units(groups_of(scene))).replace(solver={"method": "dop853"})
    T_s = case.kernel.axes()["T_s"].value
    widths = [1.8, 2.0, 2.3]
    runs = [rwmf.simulate(case.replace(wall={"b": b})) for b in widths]
    assert len({float(run["u_s_max"]) for run in runs}) == 3
    for columns in ({"b": widths}, {"wall.b": widths, "wall.h": [9.0] * 3}):
        points = rwmf.sweep(case, points=columns)
        np.testing.assert_array_equal(points["u_s_max"], [run["u_s_max"] for run in runs])
    swept = rwmf.sweep(case, {"b": widths})
    assert dict(swept.sizes) == {"b": 3}
    np.testing.assert_array_equal(swept["u_s_max"], [run["u_s_max"] for run in runs])
    with_period = case
    if "storeys" not in case.groups:
        with_period = case.replace(frame={"T_s": T_s, "k_s": None})
    ordinates = rwmf.spectrum(with_period, [T_s], b=widths)
    assert ordinates["gamma"].attrs["long_name"].endswith("at the width of the case")
    for i, b in enumerate(widths):
        found = float(ordinates["u_s_max"].isel(b=i).squeeze())
        run = with_period.replace(wall={"b": b}).replace(spectrum={"T_s": [T_s]})
        expected = float(rwmf.spectrum(run)["u_s_max"].squeeze())
        assert found == expected


def test_width_in_lanes() -> None:
    """Method `auto` has the bits of a spectrum of that width, masses and cable included."""
    groups = in_units(groups_of("yielding"))
    del groups["yielding"]
    case = rwmf.Case(**groups).replace(solver={"method": "auto", "rtol": 1e-7})
    found = rwmf.spectrum(case, [0.5, 0.8], b=[1.8, 2.3])["u_s_max"]
    for i, b in enumerate((1.8, 2.3)):
        alone = rwmf.spectrum(case.replace(wall={"b": b}), [0.5, 0.8])["u_s_max"]
        np.testing.assert_array_equal(found.isel(b=i), alone.isel(b=0))
    assert not np.array_equal(found.isel(b=0), found.isel(b=1))


def test_cable_force_of_a_width() -> None:
    """The largest force is that at rest and its increment, both over the weight of that width."""
    case = rwmf.Case(**in_units(groups_of("yielding")))
    name = "tendon_force_max_over_m_w_g"
    found = rwmf.sweep(case, {"b": [1.8, 2.3]}, quantities=name)[name].squeeze()
    for i, b in enumerate((1.8, 2.3)):
        wide = case.replace(wall={"b": b})
        increment = rwmf.simulate(wide)["cable_force_increment_max_over_m_w_g"]
        assert float(found[i]) == pytest.approx(wide.cable.eta_0 + float(increment), rel=1e-9)


def test_axes_of_period_and_mass_ratio() -> None:
    """An axis sets T_s or gamma directly; values in N remain ratios."""
    case = rwmf.Case(**in_units(groups_of("yielding"))).replace(solver={"method": "dop853"})
    found = rwmf.sweep(case, {"T_s": [0.6, 0.9], "gamma": [3.0, 5.0]})["u_s_max"]
    ratio = case.yielding.f_y_over_m_s_g
    for T_s, gamma in ((0.6, 3.0), (0.9, 5.0)):
        frame = {"T_s": T_s, "gamma": gamma, "k_s": None, "m_s": None}
        same = case.replace(frame=frame, yielding={"F_y": None, "f_y_over_m_s_g": ratio})
        at = found.sel(T_s=T_s, gamma=gamma)
        assert float(at.squeeze()) == float(rwmf.simulate(same)["u_s_max"])


def test_sizes_of_a_block() -> None:
    """The period of a block sets its size, and the size its mass."""
    case = rwmf.Case(**in_units(groups_of("block"))).replace(solver={"method": "dop853"})
    own = case.kernel.axes()["T_s"].value
    found = rwmf.spectrum(case, [own, 1.1 * own], b=[2.0, 2.2])["theta_max_over_alpha"]
    assert float(found[0, 0]) == float(rwmf.simulate(case)["theta_max_over_alpha"])
    for k, b in enumerate((2.0, 2.2)):
        factor = (1.1 * own / case.replace(wall={"b": b}).kernel.axes()["T_s"].value) ** 2
        large = case.replace(wall={"h": factor * 9.0, "b": factor * b})
        run = float(rwmf.simulate(large)["theta_max_over_alpha"])
        assert float(found[k, 1]) == pytest.approx(run, rel=1e-9)
    points = rwmf.sweep(case, points={"T_s": [1.1 * own], "b": [2.2], "damper.c": [1e3]})
    assert points.sizes == {"point": 1}


@pytest.mark.parametrize("scene", ["frame", "storeys reduced", "storeys every_floor"])
def test_frame_without_its_wall(scene: str) -> None:
    """Masses in kg need no wall: the frame equals that of the ratios."""
    groups = groups_of(scene)
    groups.pop("yielding", None)
    free = [rwmf.Case(**item).without_wall() for item in (groups, in_units(groups))]
    assert "wall" not in free[1].groups
    peaks = [float(rwmf.simulate(case)["u_s_max"]) for case in free]
    assert peaks[1] == pytest.approx(peaks[0], rel=1e-9)


def test_intensity_of_a_frame_in_kg() -> None:
    """Incremental dynamic analysis scales to the spectral acceleration at the frame's period."""
    samples = 0.2 * np.sin(7.0 * np.arange(0.0, 3.0, 0.02))
    quake = rwmf.Motion(samples, dt=0.02, unit="g", name="sine")
    found = [
        rwmf.stripes(rwmf.Case(**groups), [quake], [0.2, 0.4])
        for groups in (groups_of("frame"), in_units(groups_of("frame")))
    ]
    np.testing.assert_allclose(found[1]["u_s_max"], found[0]["u_s_max"], rtol=1e-7)


def test_forces_in_newtons() -> None:
    """Each force over a weight is that weight times it, in runs, histories and ordinates."""
    case = rwmf.Case(**in_units(groups_of("corners"))).replace(
        output={"dt": 0.05, "reactions": True}
    )
    run = rwmf.simulate(case)
    weight = G * case.wall.m_w
    total = weight * (1 + case.frame.gamma)
    for name, ratio, unit in (
        ("wall_shear_max", "wall_shear_max_over_m_w_g", weight),
        ("wall_moment_max", "wall_moment_max_over_m_w_g", weight),
        ("overturning_moment_max", "overturning_moment_max_over_weight", total),
        ("base_shear_max", "base_shear_max_over_weight", total),
        ("pivot_normal_min", "pivot_normal_min_over_m_w_g", weight),
        ("cable_force_increment_max", "cable_force_increment_max_over_m_w_g", weight),
        ("fuse_left_force", "fuse_left_force_over_m_w_g", weight),
        ("base_shear", "base_shear_over_weight", total),
        ("overturning_moment", "overturning_moment_over_weight", total),
    ):
        np.testing.assert_allclose(run[name], unit * run[ratio], rtol=1e-14, err_msg=name)
    # Newton's second law of all floors and the wall, in N
    keys = ["base_shear_max_N", "wall_moment_max_N_m"]
    found = rwmf.spectrum(case, [case.frame.T_s], quantities=keys)
    assert float(found["base_shear_max"].squeeze()) == pytest.approx(
        float(run["base_shear_max"]), rel=1e-9
    )


@pytest.mark.parametrize("coupling", ["reduced", "full"])
def test_base_shear_of_a_bare_frame(coupling: str) -> None:
    """In N it is the sum of mass times acceleration, all in kg: of no weight at all."""
    groups = in_units(groups_of("bare storeys"))
    groups["storeys"]["coupling"] = coupling
    run = rwmf.simulate(rwmf.Case(**groups, output={"dt": 0.05, "reactions": True}))
    masses = groups["storeys"]["m"]
    force = sum(m * G * run[f"floor_{i + 1}_acceleration_g"] for i, m in enumerate(masses))
    np.testing.assert_allclose(np.abs(run["base_shear"]), np.abs(force), rtol=1e-6, atol=1e-3)


def test_check_shows_both_ways(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    path = tmp_path / "case.nml"
    rwmf.Case(**in_units(groups_of("corners"))).to_namelist(path)
    assert main(["check", str(path)]) == 0
    text = capsys.readouterr().out
    assert re.search(r"F_y = .* N, k = .* N/m .*\(eta_y = 0\.2.* \[.* N\], stroke_y", text)
    assert main(["check", "--json", str(path)]) == 0
    found = json.loads(capsys.readouterr().out)["values"]
    assert found["damper"]["c"]["origin"] == "given"
    back = found["damper"]["c_over_m_w"]
    assert back["origin"] == "derived"
    assert back["unit_of_in_si"] == "N s/m"
    assert back["in_si"] == pytest.approx(found["damper"]["c"]["value"], rel=1e-15)
    # a case of ratios with a mass reports their values in SI units
    groups = groups_of("corners")
    plain = rwmf.Case(**groups | {"wall": groups["wall"] | {"m_w": 1000.0}})
    assert plain.frame.in_si["gamma"] == (4000.0, "kg")
    assert plain.cable.in_si["eta_0"][0] == pytest.approx(0.5 * 1000.0 * G)
    assert "gamma = 4.0 [4000.0 kg]" in repr(plain)
    assert not rwmf.Case(**groups).frame.in_si
