"""Vertical elements at any offset, walls side by side, restraints: closed forms, independent runs.

The independent program is `support/held_walls.py`; docs/theory/elements.md has the equations.
"""

import math
from collections.abc import Callable

import numpy as np
import pytest
import rwmf
from held_walls import Element, G, Walls

PULSE = {"kind": "one_sine", "a_max_g": 0.55, "T_p": 0.8}


def simulate(case: rwmf.Case, **output: object) -> rwmf.Response:
    """Run a case with some keys of `&output`."""
    return rwmf.simulate(case.replace(output=output))


def scene(
    groups: str = "", wall: str = "", release: float | None = None, **solver: object
) -> rwmf.Case:
    """Return a wall with a frame, under a pulse or let go at theta/alpha."""
    start = (
        f"&motion kind='one_sine', a_max_g={PULSE['a_max_g']}, T_p={PULSE['T_p']} /"
        if release is None
        else f"&motion kind='none' /\n&initial theta_over_alpha={release} /"
    )
    case = rwmf.Case.from_text(
        f"&wall h=4.0, b=1.0{wall} /\n&frame T_s=0.6, gamma=3.0, xi_s=0.05 /\n{groups}\n{start}\n"
        "&model formulation='exact' /\n&solver t_end=3.0, rtol=1e-11 /\n"
    )
    return case.replace(solver=solver) if solver else case


def tendon(kind: str, d: float, eta_0: float, eta_alpha: float, z: float = 8.0) -> Element:
    """Return a tendon whose stiffness is that of the same tendon on the axis."""
    alpha = math.atan2(1.0, 4.0)
    x = Element(kind, 0.0, z).stroke(1.0, 1, alpha)[0]
    return Element(kind, d, z, G * eta_0, G * (eta_alpha - eta_0) / x, is_tendon=True)


def walls(*elements: Element, n: int = 1) -> Walls:
    """Return the same scene for the independent program."""
    return Walls(4.0, 1.0, 3.0, 0.6, 0.05, list(elements), n)


ELASTIC: dict[str, tuple[str, str, Callable[[], Walls]]] = {
    "two straight tendons": (
        "&cable offset=-0.5, 0.7, height=8.0, 6.5, eta_0=0.4, 0.5, eta_alpha=5.0, law='truss' /",
        "",
        lambda: walls(tendon("line", -0.5, 0.4, 5.0), tendon("line", 0.7, 0.5, 5.0, 6.5)),
    ),
    "two tendons along the axis": (
        "&cable offset=-0.5, 0.7, eta_0=0.4, 0.5, eta_alpha=2.0, 3.0 /", "",
        lambda: walls(tendon("axis", -0.5, 0.4, 2.0), tendon("axis", 0.7, 0.5, 3.0)),
    ),
    "a tendon beside the wall goes slack": (
        "&cable offset=-1.6, 0.0, eta_0=0.05, 0.5, eta_alpha=2.0, 3.0, law='truss' /", "",
        lambda: walls(tendon("line", -1.6, 0.05, 2.0), tendon("line", 0.0, 0.5, 3.0)),
    ),
    "one damper": (
        "&damper offset=0.4, c_over_m_w=0.9 /", "", lambda: walls(Element("chord", 0.4, c=0.9)),
    ),
    "nonlinear dampers": (
        "&nl_damper offset=-1.0, 0.3, eta_1=0.1, exponent=0.6 /", "",
        lambda: walls(*(Element("chord", d, force_1=0.1 * G, exponent=0.6) for d in (-1.0, 0.3))),
    ),
    "restraints at the edge and on an arm": (
        "&restraint offset=-1.0, 4.0, height=4.0, 8.0, k_over_m_w=8.0, 3.0, c_over_m_w=0.0, 0.2 /",
        "",
        lambda: walls(Element("rise", -1.0, 4.0, k=8.0), Element("rise", 4.0, 8.0, k=3.0, c=0.2)),
    ),
    "restraints that turn though the wall goes on": (
        "&restraint offset=0.0, 0.3, height=8.0, k_over_m_w=8.0, 3.0 /", "",
        lambda: walls(Element("rise", 0.0, 8.0, k=8.0), Element("rise", 0.3, 8.0, k=3.0)),
    ),
    "three coupled walls": (
        "&coupling k_over_m_w=10.0, span=0.5, c_over_m_w=0.3 /", ", walls=3",
        lambda: walls(Element("pair", 2.5, k=10.0, c=0.3, weight=2 / 3), n=3),
    ),
    "everything": (
        "&coupling k_over_m_w=5.0 /\n&cable eta_0=0.5, eta_alpha=2.0 /\n"
        "&restraint offset=-1.5, 1.0, height=0.0, 6.0, k_over_m_w=4.0 /", ", walls=2",
        lambda: walls(
            Element("pair", 2.0, k=5.0, weight=0.5), tendon("axis", 0.0, 0.5, 2.0),
            Element("rise", -1.5, k=4.0, weight=0.5), Element("rise", 1.0, 6.0, k=4.0, weight=0.5),
            n=2,
        ),
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", ELASTIC)
def test_release_against_an_independent_program(name: str) -> None:
    groups, wall, reference = ELASTIC[name]
    run = simulate(scene(groups, wall, release=0.6, t_end=1.7), dt=1.7)
    theta, impacts = reference().let_go(0.6 * math.atan2(1.0, 4.0), 1.7)
    assert int(run.impacts) == impacts
    assert float(run.theta[-1]) == pytest.approx(theta, abs=1e-10)


YIELDING: dict[str, tuple[str, str, Callable[[], Walls]]] = {
    "devices outside the edges": (
        "&fuse offset=-1.6, 1.2, eta_y=0.2, 0.1, stroke_y=0.005, hardening=0.03 /", "",
        lambda: walls(
            *(
                Element("chord", d, k=f * G / 0.005, strength=f * G, hardening=0.03)
                for d, f in ((-1.6, 0.2), (1.2, 0.1))
            )
        ),
    ),
    "four fuses": (
        "&fuse offset=-1.0, -0.4, 0.4, 1.0, eta_y=0.15, stroke_y=0.005, hardening=0.03 /", "",
        lambda: walls(
            *(
                Element("chord", d, k=30 * G, strength=0.15 * G, hardening=0.03)
                for d in (-1.0, -0.4, 0.4, 1.0)
            )
        ),
    ),
    "two walls and plates between them": (
        "&coupling eta_y=0.2, stroke_y=0.005, hardening=0.03 /", ", walls=2",
        lambda: walls(
            Element("pair", 2.0, k=40 * G, strength=0.2 * G, hardening=0.03, weight=0.5), n=2
        ),
    ),
    "restraints on the axis": (
        "&restraint offset=0.0, 0.3, height=8.0, eta_y=0.03, stroke_y=0.004, hardening=0.03 /", "",
        lambda: walls(
            *(
                Element("rise", d, 8.0, k=7.5 * G, strength=0.03 * G, hardening=0.03)
                for d in (0.0, 0.3)
            )
        ),
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", YIELDING)
def test_springs_that_yield_against_fixed_steps(name: str) -> None:
    """The springs are loaded by the slow push to the release, as `&initial` has it."""
    groups, wall, reference = YIELDING[name]
    run = simulate(scene(groups, wall, release=0.4, t_end=1.4), dt=1.4)
    found = [reference() for _ in range(2)]
    for walls_ in found:
        for i in range(1001):
            walls_._flow(1, 0.4 * walls_.alpha * i / 1000)
    coarse, fine = (
        item.push_and_let_go(0.4 * item.alpha, 1.4, dt)
        for item, dt in zip(found, (2e-4, 1e-4), strict=True)
    )
    assert int(run.impacts) == fine[1]
    # the steps have a first-order error
    assert float(run.theta[-1]) == pytest.approx(2 * fine[0] - coarse[0], abs=3e-6)


def test_closed_forms_of_uplift_and_restitution() -> None:
    run = rwmf.simulate(scene("&cable offset=0.5, eta_0=1.0, eta_alpha=2.0 /"))
    assert float(run.uplift_right_g) == pytest.approx(0.05357142857142857, rel=1e-15)
    assert float(run.uplift_left_g) == pytest.approx(0.08928571428571429, rel=1e-15)
    published = (0.9950819672131147, 0.9906832298136646, 0.9867256637168141, 0.9831460674157303)
    for n, e in enumerate(published, 1):
        case = scene(wall=f", walls={n}").replace(frame={"gamma": 6.0})
        assert float(rwmf.simulate(case).e) == pytest.approx(e, rel=1e-15)


def test_strokes_of_a_release() -> None:
    """The largest strokes of an outrigger held at phi = 0.02 are those of its closed form."""
    case = rwmf.Case.from_text(
        "&wall h=8.0, b=1.5 /\n&restraint offset=-7.0, 7.0, height=16.0, k_over_m_w=1e-6 /\n"
        "&motion kind='none' /\n&solver t_end=0.001 /\n"
        f"&initial theta_over_alpha={0.02 / math.atan2(1.5, 8.0)!r} /\n"
        "&model formulation='exact' /\n"
    )
    run = rwmf.simulate(case)
    assert float(run["restraint_1_stroke_max"]) == pytest.approx(0.16678877355857527, rel=1e-12)
    assert float(run["restraint_2_stroke_min"]) == pytest.approx(-0.11319256014808785, rel=1e-12)


def test_walls_without_coupling_are_one_wall_with_its_part_of_the_frame() -> None:
    four = rwmf.simulate(scene(wall=", walls=4"))
    one = rwmf.simulate(scene().replace(frame={"gamma": 0.75}))
    for name in ("u_s_max", "theta_max_over_alpha", "floor_acceleration_max_g", "impacts"):
        assert float(four[name]) == float(one[name])
    assert float(four.base_shear_max_over_weight) == pytest.approx(
        float(one.base_shear_max_over_weight), rel=1e-13
    )


@pytest.mark.parametrize(
    ("given", "same"),
    [
        ("&fuse offset=-1.0, 1.0, eta_y=0.2, stroke_y=0.01 /", "&fuse eta_y=0.2, stroke_y=0.01 /"),
        ("&damper offset=-1.0, 1.0, c_over_m_w=0.3 /", "&damper c_over_m_w=0.3 /"),
        ("&cable offset=0.0, eta_0=1.0, eta_alpha=3.0 /", "&cable eta_0=1.0, eta_alpha=3.0 /"),
        (
            "&cable offset=0.3, 0.3, eta_0=0.5, eta_alpha=1.5, law='truss' /",
            "&cable offset=0.3, eta_0=1.0, eta_alpha=3.0, law='truss' /",
        ),
        # a pair at +-d turns like one tendon on the axis with K (1 + d**2/b**2)
        (
            "&cable offset=-0.6, 0.6, eta_0=0.5, eta_alpha=1.5 /",
            "&cable eta_0=1.0, eta_alpha=3.72 /",
        ),
    ],
)  # fmt: skip
def test_equal_descriptions(given: str, same: str) -> None:
    runs = [rwmf.simulate(scene(text)) for text in (given, same)]
    for name in ("u_s_max", "theta_max_over_alpha", "theta_dot_max"):
        assert float(runs[0][name]) == pytest.approx(float(runs[1][name]), rel=1e-12)


def test_mirror() -> None:
    """Without a frame, d to -d and u_g to -u_g mirror the rotation."""
    text = (
        "&wall h=4.0, b=1.0 /\n&cable offset={0}, eta_0=0.8, eta_alpha=3.0, law='truss' /\n"
        "&fuse offset={1}, eta_y=0.1, stroke_y=0.004 /\n&model formulation='exact' /\n"
        "&motion kind='one_sine', a_max_g=0.9, T_p=0.8 /\n&solver t_end=3.0, rtol=1e-11 /\n"
    )
    one = simulate(rwmf.Case.from_text(text.format("0.4", "-1.0, 0.3")), dt=0.01)
    case = rwmf.Case.from_text(text.format("-0.4", "-0.3, 1.0"))
    # the negative pulse is its second half, one half period earlier
    mirrored = simulate(case.replace(motion={"a_max_g": -0.9}), dt=0.01)
    assert np.allclose(one.theta, -mirrored.theta, rtol=0, atol=1e-12)


def test_normal_forces_of_the_outer_walls() -> None:
    """The mean force over two walls is that of weight, links and inertia; the couplings move it."""
    groups = "&coupling eta_y=0.2, stroke_y=0.005 /"
    run = simulate(scene(groups, ", walls=2"), dt=0.001, reactions=True)
    normal = run.pivot_normal_over_m_w_g
    force = np.abs(run.coupling_force_over_m_w_g)
    assert float(run.pivot_normal_max_over_m_w_g) >= float((normal + force).max()) - 1e-9
    assert float(run.pivot_normal_min_over_m_w_g) <= float((normal - force).min()) + 1e-9
    assert "wall_shear_max_over_m_w_g" not in run


def test_every_method_and_the_spectrum() -> None:
    groups = (
        "&cable offset=-0.5, 0.7, eta_0=0.4, 0.5, eta_alpha=5.0, law='truss', eta_y=0.6, 0.7 /\n"
        "&coupling eta_y=0.2, stroke_y=0.01, span=1.0, c_over_m_w=0.1 /\n"
        "&restraint offset=-1.5, 1.0, height=2.0, 6.0, k_over_m_w=4.0 /"
    )
    case = scene(groups, ", walls=2", rtol=1e-9)
    trusted = rwmf.simulate(case.replace(solver={"rtol": 1e-12}))
    for method in ("taylor", "adams", "bdf"):
        run = rwmf.simulate(case.replace(solver={"method": method}))
        assert float(run.u_s_max) == pytest.approx(float(trusted.u_s_max), rel=3e-9)
    names = ["u_s_max", "coupling_force_max_over_m_w_g", "restraint_2_stroke_sum"]
    row = rwmf.spectrum(case, T_s=[0.5, 0.6], quantities=names)
    run = simulate(case, reactions=True, energy=True)
    for name in names:
        assert float(row[name].values.ravel()[1]) == float(run[name])
    assert float(run.energy_balance_relative) < 1e-9


@pytest.mark.parametrize(
    ("groups", "wall", "message"),
    [
        ("&cable offset=-5.0, 0.0, eta_0=0.5 /", "", r"&cable: offset .* must be in \[-4"),
        ("&cable offset=-0.5, 0.5, eta_0=0.5, 0.4, 0.3 /", "", "eta_0 .* has 3 numbers"),
        ("&coupling eta_y=0.2, stroke_y=0.01 /", "", "&coupling .* needs walls"),
        ("&coupling eta_y=0.2 /", ", walls=2", "eta_y .* needs stroke_y"),
        ("&coupling span=1.0 /", ", walls=2", "needs a spring"),
        ("&restraint offset=0.5, height=4.0, k_over_m_w=2.0 /", ", walls=2", "must be >= b"),
        ("&restraint offset=1.0, height=9.0, k_over_m_w=2.0 /", "", "height .* must be in"),
        ("&damper offset=-1.0, c_over_m_w=1.0 /\n&model formulation='published' /", "", "publi"),
        ("", ", walls=2, base='pinned'", "pinned"),
    ],
)  # fmt: skip
def test_refusals(groups: str, wall: str, message: str) -> None:
    text = f"&wall h=4.0, b=1.0{wall} /\n&frame T_s=0.6, gamma=3.0, xi_s=0.05 /\n{groups}\n"
    with pytest.raises(rwmf.InputError, match=message):
        rwmf.Case.from_text(text + "&motion kind='none' /\n&solver t_end=1.0 /\n")


def test_tendons_that_tip_the_wall_at_rest() -> None:
    case = scene("&cable offset=3.0, eta_0=2.0, eta_alpha=3.0 /")
    with pytest.raises(rwmf.InputError, match="tip the wall at rest to the right"):
        rwmf.simulate(case)


@pytest.mark.parametrize(
    ("groups", "wall", "release", "end"),
    [
        # at rest where the moment of the plates is that of the weight
        ("&coupling eta_y=0.8, stroke_y=0.01 /", ", walls=2", 0.7, 0.63104422),
        ("&coupling eta_y=0.7, stroke_y=0.01 /", ", walls=3", -0.7, -0.65153566),
        # a hundred impacts, then rest with forces left in the springs
        ("&coupling eta_y=0.2, stroke_y=0.01 /", ", walls=2", 0.5, 0.0),
        ("&fuse offset=0.4, eta_y=0.2, stroke_y=0.01 /", "", 0.5, 0.0),
    ],
)
def test_held_up_or_come_to_rest(groups: str, wall: str, release: float, end: float) -> None:
    """Elastic unloading after the slow release: all methods end at the same rotation."""
    case = rwmf.Case.from_text(
        f"&wall h=4.0, b=1.0{wall} /\n{groups}\n&motion kind='none' /\n"
        f"&initial theta_over_alpha={release} /\n&model formulation='exact' /\n"
        "&solver t_end=20.0, rtol=1e-10 /\n&output energy=.true. /\n"
    )
    for method in ("taylor", "dop853", "adams"):
        run = rwmf.simulate(case.replace(solver={"method": method}))
        assert float(run.theta_end_over_alpha) == pytest.approx(end, abs=1e-8)
        assert float(run.energy_balance_relative) < 1e-9
        assert (int(run.impacts) > 100) == (end == 0.0)
