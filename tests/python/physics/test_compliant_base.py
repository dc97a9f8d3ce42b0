"""Wall on a base that gives, slides and crushes: closed forms, invariances, a second program.

The second program is `support/compliant_wall.py`; docs/theory/base.md has the equations.
"""

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import rwmf
from base_scenes import base_scene
from checkout import ROOT
from compliant_wall import CompliantWall, Device

G = 9.81


def scene(groups: str, **solver: object) -> rwmf.Case:
    """Return a case with a tight tolerance."""
    case = rwmf.Case.from_text(groups + "\n&solver rtol=1e-11, t_end=3.0 /\n")
    return case.replace(solver=solver) if solver else case


def run(case: rwmf.Case, dt: float | None = None) -> rwmf.Response:
    """Run a case with energies, without sensitivities."""
    output: dict[str, object] = {"energy": True, "reactions": True, "conditioning": False}
    if dt is not None:
        output["dt"] = dt
    return rwmf.simulate(case.replace(output=output))


def sine(a_max: float, period: float) -> Callable[[float], float]:
    """One sine with its peak over g."""
    return lambda t: a_max * G * math.sin(2 * math.pi * t / period) if t <= period else 0.0


def delay(xi: float, b: float, kappa: float) -> float:
    """Return the damping over the stiffness."""
    return 2 * xi / math.sqrt(2 * b * kappa)


FREE = "&wall h=2.0, b=0.5 /\n&base k_t_over_m_w=2.0e4"
PULSE = "&motion kind='one_sine', a_max_g=0.5, T_p=1.2 /"
LOOSE = (
    "&wall h=1.0, b=0.8 /\n&base k_t_over_m_w=5.0e3, xi=0.05{} /\n&vertical ratio=0.9 /\n"
    "&motion kind='one_sine', a_max_g=1.6, T_p=0.8 /"
)


@pytest.mark.parametrize(
    ("frame", "omega"),
    [
        ("", 17.43760745762313),
        (
            "&frame gamma=2.0, T_s=0.5, xi_s=0.0 /",
            math.sqrt(
                (2 * 0.5**3 * 2e4 / 3 - G * 2 + 16 * 2 * (2 * math.pi / 0.5) ** 2)
                / ((16 + 0.25) / 3 + 16 * 2)
            ),
        ),
    ],
)
def test_rocking_in_full_contact(frame: str, omega: float) -> None:
    """A small rotation vibrates with the frequency of the linear system."""
    case = scene(f"{FREE} /\n{frame}\n&initial theta_over_alpha=1e-7 /")
    response = run(case, dt=0.01)
    start = 1e-7 * math.atan2(0.5, 2.0)
    expected = start * np.cos(omega * response["time"].values)
    assert response["theta"].values == pytest.approx(expected, abs=1e-6 * start)


def test_rest_under_a_held_rotation() -> None:
    """The strip bears the weight at the start, on the contact length of the static moment."""
    response = run(scene(f"{FREE} /\n&initial theta_over_alpha=0.5 /", t_end=0.1), dt=0.1)
    s = math.sin(0.5 * math.atan2(0.5, 2.0))
    assert float(response["base_normal_over_m_w_g"][0]) == pytest.approx(1.0, rel=1e-13)
    assert float(response["contact_length"][0]) == pytest.approx(
        math.sqrt(2 * G / (2e4 * s)), rel=1e-12
    )


@pytest.mark.parametrize("d_y", [1.0, 1.2e-3])
def test_rest_on_strips(d_y: float) -> None:
    """Strips bear weight, tendon and fuses at the start, those beyond their strength as well."""
    case = scene(
        f"{FREE}, d_y={d_y}, strips=40 /\n&cable eta_0=0.5, eta_alpha=1.5, law='truss' /\n"
        "&fuse offset=-0.5, 0.1, eta_y=0.1, stroke_y=0.3, 0.005 /\n"
        "&initial theta_over_alpha=0.2 /",
        t_end=0.1,
    )
    response = run(case, dt=0.1)
    force = float(response["cable_force_over_m_w_g"][0])
    theta, z = 0.2 * math.atan2(0.5, 2.0), float(response["base_height"][0])
    span = np.array([4 * math.sin(theta), z + 4 * math.cos(theta)])
    fuses = [float(response[f"fuse_{i}_force_over_m_w_g"][0]) for i in (1, 2)]
    lift = (z + 9.81 * 1.5 / 2e4) * math.cos(theta / 2)
    assert fuses[0] == pytest.approx((lift + math.sin(theta / 2)) / 3, rel=1e-12)
    expected = 1 + force * span[1] / math.hypot(*span) + sum(fuses) * math.cos(theta / 2)
    assert float(response["base_normal_over_m_w_g"][0]) == pytest.approx(expected, rel=1e-12)
    assert (float(response.crushed_right) > 0) == (d_y < 1)


def test_block_that_slides_without_rocking() -> None:
    """A flat block on a stiff base slides as a mass on a plane, x'' = mu g - u_g''."""
    mu, a, omega, end = 0.2, 0.5, 2 * math.pi, 0.4
    case = scene(
        f"&wall h=1.0e-3, b=5.0 /\n&base k_t_over_m_w=1.0e7, xi=1.0, mu={mu} /\n"
        f"&motion kind='one_sine', a_max_g={a}, T_p=1.0 /",
        t_end=end,
    )
    begin = math.asin(mu / a) / omega
    slide = (a * G / omega**2) * (math.sin(omega * end) - math.sin(omega * begin)) - (
        a * G / omega
    ) * (end - begin) * math.cos(omega * begin)
    slide += mu * G * (end - begin) ** 2 / 2
    response = run(case)
    assert float(response.slide_end) == pytest.approx(slide, rel=1e-9)
    assert float(response.slips) == 1


SCENES: dict[str, tuple[str, CompliantWall, list[float]]] = {
    "frame, tendon, slip": (
        "&wall h=4.0, b=1.0 /\n&frame gamma=5.0, T_s=0.8, xi_s=0.05 /\n"
        "&cable eta_0=0.5, eta_alpha=1.5, law='truss' /\n"
        f"&base k_t_over_m_w=2.0e4, xi=0.2, mu=0.12 /\n{PULSE}",
        CompliantWall(
            4.0,
            1.0,
            2e4,
            delay(0.2, 1.0, 2e4),
            0.12,
            5.0,
            2 * math.pi / 0.8,
            0.05,
            0.5,
            1.5,
            ground=sine(0.5, 1.2),
        ),
        [1.2],
    ),
    "flights": (
        LOOSE.format(""),
        CompliantWall(
            1.0,
            0.8,
            5e3,
            delay(0.05, 0.8, 5e3),
            ground=sine(1.6, 0.8),
            upward=lambda t: 0.9 * sine(1.6, 0.8)(t),
        ),
        [0.8],
    ),
    "flights and slip": (
        LOOSE.format(", mu=0.3"),
        CompliantWall(
            1.0,
            0.8,
            5e3,
            delay(0.05, 0.8, 5e3),
            0.3,
            ground=sine(1.6, 0.8),
            upward=lambda t: 0.9 * sine(1.6, 0.8)(t),
        ),
        [0.8],
    ),
    "heavy frame": (
        "&wall h=4.0, b=1.0 /\n&frame gamma=1800.0, T_s=0.6, xi_s=0.05 /\n"
        f"&base k_t_over_m_w=2.0e5, xi=1.0 /\n{PULSE}",
        CompliantWall(
            4.0,
            1.0,
            2e5,
            delay(1.0, 1.0, 2e5),
            None,
            1800.0,
            2 * math.pi / 0.6,
            0.05,
            ground=sine(0.5, 1.2),
        ),
        [1.2],
    ),
}


FUSES = "&fuse eta_y=0.2, stroke_y=0.005, hardening=0.02 /\n&damper c_over_m_w=2.0 /"
PLACED = "&fuse offset=-0.5, 0.2, 1.4, eta_y=0.2, stroke_y=0.005 /"


def devices(placed: bool) -> list[Device]:
    """Return the devices of `FUSES` or `PLACED`."""
    if placed:
        return [Device(d, strength=0.2 * G, stroke_y=0.005) for d in (-0.5, 0.2, 1.4)]
    fuses = [Device(d, strength=0.2 * G, stroke_y=0.005, hardening=0.02) for d in (-1, 1)]
    return [*fuses, Device(-1, c=2.0), Device(1, c=2.0)]


def with_devices(placed: bool, base: str = "", **options: float) -> tuple[str, CompliantWall, list]:
    """Return a scene with devices under the base."""
    text = (
        "&wall h=4.0, b=1.0 /\n&frame gamma=5.0, T_s=0.8, xi_s=0.05 /\n"
        f"&base k_t_over_m_w=2.0e4, xi=0.2{base} /\n{PLACED if placed else FUSES}\n{PULSE}"
    )
    wall = CompliantWall(
        4.0,
        1.0,
        2e4,
        delay(0.2, 1.0, 2e4),
        gamma=5.0,
        omega_s=2 * math.pi / 0.8,
        xi_s=0.05,
        ground=sine(0.5, 1.2),
        devices=devices(placed),
        **options,
    )
    return text, wall, [1.2]


def yielding_frame() -> tuple[str, CompliantWall, list]:
    """Return a scene with a frame that yields, a slip and fuses."""
    text, wall, knots = with_devices(False, ", mu=0.12", mu=0.12)
    wall.roof = Device(0.0, strength=0.05 * wall.omega_s**2, stroke_y=0.05, hardening=0.1)
    wall.springs = [*wall.fuses, wall.roof]
    return f"{text}\n&yielding u_y=0.05, hardening=0.1 /", wall, knots


SCENES |= {
    "fuses and dampers": with_devices(False),
    "fuses, dampers, slip": with_devices(False, ", mu=0.12", mu=0.12),
    "placed fuses, slip": with_devices(True, ", mu=0.12", mu=0.12),
    "yielding frame": yielding_frame(),
    "placed fuses, crushing": with_devices(True, ", d_y=1.2e-3, strips=16", strips=16, d_y=1.2e-3),
}


@pytest.mark.parametrize("name", SCENES)
def test_second_program(name: str) -> None:
    """Newton and Euler's equations in SciPy give the same motion; errors follow the tolerance."""
    text, wall, knots = SCENES[name]
    # one of the walls overturns after a second
    times = np.round(np.arange(0.0, 1.01, 0.05), 9)
    pieces = np.unique([*times, *(knot for knot in knots if knot < times[-1])])
    rows, slips = wall.run(pieces)
    rows = rows[np.isin(pieces, times)]
    for rtol in (1e-6, 1e-9, 1e-12):
        response = run(scene(text, t_end=1.0, rtol=rtol), dt=0.05)
        # the second program itself is exact to some 1e-9 after flights
        bound = 30 * rtol + 1e-9
        assert response["theta"].values == pytest.approx(
            rows[:, 4], abs=bound * np.max(np.abs(rows[:, 4]))
        )
        assert response["base_height"].values == pytest.approx(
            rows[:, 2], abs=bound * np.max(np.abs(rows[:, 2]))
        )
        if wall.mu is not None:
            assert float(response.slips) == slips
            assert response["base_slip"].values == pytest.approx(
                rows[:, 0], abs=bound * np.max(np.abs(rows[:, 0]))
            )
        if wall.roof:
            assert float(response.ductility) == pytest.approx(wall.peaks["u"] / 0.05, rel=bound)
        if wall.fuses:
            assert float(response.fuse_stroke_max) == pytest.approx(wall.peaks["stroke"], rel=bound)


@pytest.mark.filterwarnings("ignore::rwmf.RwmfWarning")
# 3, 7 and 13 take long
@pytest.mark.parametrize("number", sorted({*range(22)} - {3, 7, 13}))
def test_random_scene(number: int, tmp_path: Path) -> None:
    """The peaks of random scenes are those of the second program."""
    scene_ = base_scene(number, tmp_path)
    truth = scene_.second_peaks()
    for name, peak in scene_.peaks(1e-9, tmp_path).items():
        assert peak == pytest.approx(truth[name], rel=3e-8)


@pytest.mark.filterwarnings("ignore::rwmf.RwmfWarning")
def test_round_off_gives_no_order_of_contacts(tmp_path: Path) -> None:
    """Both conditions of contact are the same for a wall that slides without rocking."""
    scene_ = base_scene(37, tmp_path)
    expected = scene_.peaks(1e-9, tmp_path)
    assert scene_.peaks(1e-12, tmp_path) == pytest.approx(expected, rel=1e-9)


CRUSHING = (
    f"&wall h=4.0, b=1.0 /\n&base k_t_over_m_w=2.0e4, xi=0.2, d_y=1.2e-3, strips=16 /\n{PULSE}"
)


@pytest.mark.parametrize(
    "text",
    [
        SCENES["frame, tendon, slip"][0],
        LOOSE.format(", mu=0.3"),
        CRUSHING.replace("0.5, T", "0.3, T"),
        *(SCENES[name][0] for name in SCENES if "fuses" in name or "yielding" in name),
        SCENES["yielding frame"][0].replace("u_y", "law='pinched', cap=4.0, post_cap=20.0, u_y"),
        f"{CRUSHING}\n&fuse eta_y=0.2, stroke_y=0.005, law='flag', hardening=0.03 /",
        f"{CRUSHING}\n&fuse eta_y=0.2, stroke_y=0.005, law='friction', breakaway=1.3 /",
    ],
)
def test_ledger(text: str) -> None:
    """The energies close with friction, flights and crushing."""
    response = run(scene(text, rtol=1e-12))
    assert float(response.energy_balance_relative) < 1e-10
    assert float(response.energy_base) > 0
    if "&fuse" in text:
        assert float(response.energy_hysteretic_end) > 0


@pytest.mark.parametrize("offset", ["", "offset={}0.4, {}1.2, "])
def test_mirror(offset: str) -> None:
    """The reversed motion mirrors a wall without a frame, its fuses at mirrored places."""
    fuse = f"\n&fuse {offset}eta_y=0.1, stroke_y=0.005 /"
    weak = CRUSHING.replace("0.5, T", "0.3, T")
    one = run(scene(weak + fuse.format("", "-")))
    other = run(scene(weak.replace("0.3, T", "-0.3, T") + fuse.format("-", "")))
    forces = [response.fuses_force_end_over_m_w_g.values for response in (one, other)]
    assert forces[0] == pytest.approx(forces[1] if offset else forces[1][::-1], rel=1e-8)
    assert float(other.crushed_left) == pytest.approx(float(one.crushed_right), rel=1e-9)
    assert float(other.theta_end_over_alpha) == pytest.approx(-float(one.theta_end_over_alpha))


def test_scale() -> None:
    """Lengths times four and times times two give the same rotations."""
    device = "&fuse eta_y=0.05, stroke_y={} /\n&damper c_over_m_w={} /\n"
    one = run(scene(f"{FREE}, xi=0.2, mu=0.3 /\n{device.format(0.005, 0.4)}{PULSE}"))
    other = run(
        scene(
            "&wall h=8.0, b=2.0 /\n&base k_t_over_m_w=1.25e3, xi=0.2, mu=0.3 /\n"
            f"{device.format(0.02, 0.2)}&motion kind='one_sine', a_max_g=0.5, T_p=2.4 /",
            t_end=6.0,
        )
    )
    assert float(other.theta_max_over_alpha) == pytest.approx(
        float(one.theta_max_over_alpha), rel=1e-8
    )
    assert float(other.slide_max) == pytest.approx(4 * float(one.slide_max), rel=1e-8)


def test_limits_of_friction_and_strength() -> None:
    """High friction is a key; strips that never crush approach the closed integrals."""
    text = f"&wall h=4.0, b=1.0 /\n&base k_t_over_m_w=2.0e4, xi=0.2{{}} /\n{PULSE}"
    key = run(scene(text.format("")))
    rough = run(scene(text.format(", mu=3.0")))
    assert float(rough.slips) == 0
    assert float(rough.theta_max_over_alpha) == float(key.theta_max_over_alpha)
    errors = []
    for strips in (12, 48, 192):
        strong = run(scene(text.format(f", d_y=1.0, strips={strips}")))
        assert float(strong.crushed_depth_max) == 0
        errors.append(abs(float(strong.theta_max_over_alpha / key.theta_max_over_alpha) - 1))
    assert errors[0] < 0.05
    assert errors[2] < errors[1] / 4 < errors[0] / 16


@pytest.mark.parametrize(
    "device", ["", "&fuse eta_y=0.2, stroke_y=1.0 /\n&damper c_over_m_w=2.0 /"]
)
def test_stiff_base(device: str) -> None:
    """The response converges with the root of the stiffness, like the contact length.

    The limit is a wall whose middle moves vertically only: it differs from one that turns about a
    rigid corner by the versine of the rotation.
    """
    wall = f"&wall h=4.0, b=1.0 /\n&initial theta_over_alpha=0.5 /\n{device}\n"
    last = np.array(
        [
            float(run(scene(wall + base, t_end=0.4), dt=0.4)["theta"][-1])
            for base in ("", *(f"&base k_t_over_m_w={kappa} /" for kappa in (1e4, 1e5, 1e6, 1e7)))
        ]
    )
    changes = np.diff(last[1:])
    assert changes[:-1] / changes[1:] == pytest.approx(math.sqrt(10), rel=0.02)
    assert last[4] / last[0] == pytest.approx(1.0, abs=1e-2)


def test_rows_are_runs() -> None:
    """Every row of a sweep has the bits of its run."""
    case = scene(f"{FREE}, xi=0.2, mu=0.3 /\n{PULSE}", rtol=1e-7)
    stiffness = [1e3, 2e4, 3e5]
    keys = ["toe_settlement_max", "slide_max", "theta_max_over_alpha"]
    table = rwmf.sweep(case, {"base.k_t_over_m_w": stiffness}, quantities=keys)
    for i, kappa in enumerate(stiffness):
        response = run(case.replace(base={"k_t_over_m_w": kappa}))
        for key in keys:
            assert float(table[key].values.ravel()[i]) == float(getattr(response, key))


@pytest.mark.parametrize(
    ("groups", "message"),
    [
        ("&base k_t_over_m_w=5.0 /", r"k_t_over_m_w = 5.*\[10, 1e7\]"),
        ("&base k=1e9 /", "needs the mass of the wall"),
        ("&base k_t_over_m_w=1e4, d_y=0.5e-3 /", r"d_y = .*must be > .*1\.2 times"),
        ("&base k_t_over_m_w=1e4, mu=0.3, d_y=1.0 /", "either slides or crushes"),
        ("&base k_t_over_m_w=1e4, delay=1.0 /", r"delay = .*xi = .*\[0, 3\]"),
        ("&base k_t_over_m_w=1e4 /\n&impact e=0.9 /", "contact takes the place of impacts"),
        (
            "&base k_t_over_m_w=1e4 /\n&model formulation='symmetric' /",
            "must be 'exact' with &base",
        ),
        (
            "&base k_t_over_m_w=1e4 /\n&solver t_end=1.0, method='adams' /",
            "'auto' or 'taylor' with &base",
        ),
        ("&base k_t_over_m_w=1e4 /\n&cable eta_0=0.5 /", "law.*'truss' with &base"),
        (
            "&base k_t_over_m_w=1e4 /\n&nl_damper eta_1=1.0, exponent=0.5 /",
            "&nl_damper.*must not be given with",
        ),
        (
            "&base k_t_over_m_w=1e4 /\n&frame gamma=1.0, T_s=1.0, xi_s=0.05 /\n"
            "&yielding u_y=0.05, law='bouc_wen' /",
            "&yielding.*must not be given with &base beside &storeys, ultimate or law",
        ),
    ],
)
def test_refusals(groups: str, message: str) -> None:
    """Each exclusion names group, key and the allowed values."""
    solver = "" if "&solver" in groups else "&solver t_end=1.0 /"
    with pytest.raises(rwmf.InputError, match=message):
        run(rwmf.Case.from_text(f"&wall h=4.0, b=1.0 /\n{groups}\n&motion kind='none' /\n{solver}"))


def test_static_curves_are_refused() -> None:
    """An analysis on rigid corners says so."""
    case = scene(f"{FREE} /\n&frame gamma=1.0, T_s=1.0, xi_s=0.05 /")
    with pytest.raises(rwmf.InputError, match="&base: must not be given for a static curve"):
        rwmf.pushover(case, [0.01])


@pytest.mark.parametrize(
    ("kappa", "xi", "factor"),
    [(2e4, 0.0, 0.999), (2e4, 0.2, 0.982), (2e4, 1.0, 0.947), (2e5, 1.0, 0.961), (2e5, 3.0, 0.958)],
)
def test_restitution(kappa: float, xi: float, factor: float) -> None:
    """A free block on a damped base loses less than in Housner's impact."""
    case = scene(
        f"&wall h=2.0, b=0.5 /\n&base k_t_over_m_w={kappa}, xi={xi} /\n&motion kind='none' /"
    )
    found = rwmf.studies.restitution(case)
    assert float(found.e) == pytest.approx(factor, abs=6e-4)
    assert float(found.e_housner) == pytest.approx(1 - 1.5 / 17)
    # neither a start with a velocity nor a tolerance by accuracy counts
    moving = case.replace(initial={"theta_over_alpha": 0.1, "theta_dot": 0.3},
                          solver={"rtol": None, "accuracy": 1e-4})  # fmt: skip
    assert rwmf.studies.restitution(moving).identical(found)


@pytest.mark.parametrize("kappa", [1e5, 1e7])
def test_wall_of_the_paper_does_not_slide(kappa: float) -> None:
    """Fig. 4 with the friction of the paper's finite elements; rigid corners ask for 758."""
    case = rwmf.Case.from_namelist(ROOT / "inputs" / "fig04_against_finite_elements.nml")
    rigid = rwmf.simulate(case)
    soft = case.replace(
        impact=None,
        model={"formulation": "exact"},
        base={"k_t_over_m_w": kappa, "xi": 0.3, "mu": 0.35},
        cable={"law": "truss"},
        solver={"rtol": 1e-8},
    )
    response = rwmf.simulate(soft)
    assert float(response.slips) == 0
    assert float(response.u_s_max) == pytest.approx(float(rigid.u_s_max), rel=1e-4)
    assert float(rigid.friction_demand_impact_max) == pytest.approx(758, abs=1)
