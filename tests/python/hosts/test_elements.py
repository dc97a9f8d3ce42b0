"""Elements of a host in Python: forces of the stepping wall, bits of C, state, errors."""

import copy
import ctypes
import math
from pathlib import Path
from typing import Any

import c_host
import numpy as np
import pytest
import rwmf

WALL = "&wall h = 4.0, b = 0.8, m_w = 2.0e4 / &impact rule = 'coupled' /"
FRAME = "&frame T_s = 1.0, gamma = 5.0, xi_s = 0.05 /"
EFFECTS = {
    "wall": "",
    "tendon that yields": "&cable eta_0 = 0.8, eta_alpha = 5.0, law = 'truss', eta_y = 0.85 /",
    "tendon that breaks": "&cable eta_0 = 0.8, eta_alpha = 5.0, law = 'truss', "
    "rupture_strain = 0.004 /",
    "fuses": "&fuse F_y = 4e4, k = 2e7, hardening = 0.02 /",
    "flag": "&fuse F_y = 4e4, k = 2e7, hardening = 0.02, law = 'flag' /",
    "damper": "&damper c = 4e4 /",
    "inerters": "&damper c = 4e4 / &inerter inertance = 3e4 /",
    "vertical": "&vertical ratio = 0.5 / &motion kind = 'one_sine', a_max_g = 0.6, T_p = 1.0 /",
}
BENDING = "&bending EI = 3e9, xi = 0.02, modes = 2 /"


def element(effects: str = "", frame: str = FRAME) -> rwmf.Element:
    return rwmf.Element(rwmf.Case.from_text(WALL + frame + effects + "&solver t_end = 3.0 /"))


def c_response(text: str, side: int, motions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Commit motions in C; forces and tangents at the last one."""
    member = ctypes.c_void_p()
    c_host._call("rwmf_create_member", ctypes.c_char_p(text.encode()), ctypes.byref(member))
    c_host._library().rwmf_destroy_member.restype = None
    n = motions.shape[2]
    force, tangents = np.empty(n), np.empty((3, n, n))
    pointer = ctypes.POINTER(ctypes.c_double)
    ground = np.array([1.0, 0.0])
    try:
        c_host._call("rwmf_place_member", member, ctypes.c_int(side))
        for motion in motions:
            data = np.ascontiguousarray(motion)
            arrays = [x.ctypes.data_as(pointer) for x in (data, ground, force, tangents)]
            c_host._call("rwmf_respond_member", member, *arrays, None)
            c_host._call("rwmf_commit_member", member)
    finally:
        c_host._library().rwmf_destroy_member(ctypes.byref(member))
    return force, tangents


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("name", EFFECTS)
def test_the_bits_of_c(name: str, side: int) -> None:
    text = WALL + FRAME + EFFECTS[name] + "&solver t_end = 3.0 /"
    motions = np.array([[[side * u], [0.3], [-1.0]] for u in (0.02, 0.05, 0.01, 0.03)])
    force, tangents = c_response(text, side, motions)
    with rwmf.Element(rwmf.Case.from_text(text)) as ours:
        ours.place(side)
        for motion in motions:
            u, u_dot, u_ddot = motion[:, 0].tolist()
            r = ours.respond(u, u_dot, u_ddot, 1.0)
            ours.commit()
        assert [r.force, r.stiffness, r.damping, r.mass] == [force[0], *tangents[:, 0, 0]]


@pytest.mark.parametrize("name", [*EFFECTS, "bending"])
def test_trials_never_change_the_path(name: str) -> None:
    effects = BENDING if name == "bending" else EFFECTS[name]
    random = np.random.default_rng(5)
    with element(effects) as straight, element(effects) as tried:
        n = tried.dofs
        assert n == (3 if name == "bending" else 1)
        for one in (straight, tried):
            one.place(1)

        def motion(size: float) -> tuple[Any, Any, Any, float]:
            values = random.uniform(-size, size, (3, n)) * np.array([1.0, 1e-3, 1e-3])[:n]
            values[0, 0] = abs(values[0, 0])
            u, u_dot, u_ddot = values[:, 0].tolist() if n == 1 else values
            return u, u_dot, u_ddot, float(random.uniform(-3, 3))

        for _ in range(100):
            step = motion(0.3)
            snapshot = tried.save()
            for _ in range(random.integers(0, 4)):
                tried.respond(*motion(0.4))
                if random.random() < 0.3:
                    tried.commit()
                    tried.restore(snapshot)
                else:
                    tried.revert()
            ours, theirs = tried.respond(*step), straight.respond(*step)
            for a, b in zip(ours, theirs, strict=True):
                assert np.array_equal(a, b, equal_nan=True)
            straight.commit()
            tried.commit()
            assert tried.side == straight.side == 1
            assert tried.is_broken == straight.is_broken
        tried.restart()
        assert tried.side == 0


def test_many_motions_are_those_of_each() -> None:
    with element(EFFECTS["fuses"]) as wall:
        u = np.linspace(0.01, 0.2, 6).reshape(2, 3)
        many = wall.respond(u, 0.1, [[1.0], [2.0]], 0.5, side=1)
        assert many.force.shape == (2, 3) and many.hold.shape == (2, 3, 2)
        assert wall.side == 0
        for i in range(2):
            for j in range(3):
                one = wall.respond(float(u[i, j]), 0.1, 1.0 + i, 0.5, side=1)
                assert [one.force, one.mass, one.cable] == [
                    many.force[i, j], many.mass[i, j], many.cable[i, j],
                ]  # fmt: skip


def test_tangents_are_derivatives() -> None:
    with element(BENDING) as wall:
        wall.place(1)
        at = np.array([[0.1, 0.01, 0.002], [0.5, 0.1, 0.1], [1.0, -2.0, 3.0]])

        def force(q: np.ndarray) -> np.ndarray:
            return np.asarray(wall.respond(q[0], q[1], q[2], 1.0).force)

        here = wall.respond(at[0], at[1], at[2], 1.0)
        for kind, name in enumerate(("stiffness", "damping", "mass")):
            for j in range(3):
                step = np.zeros((3, 3))
                step[kind, j] = 1e-5
                change = force(at + step) - force(at - step)
                tangent = getattr(here, name)
                scale = np.abs(tangent).max()
                assert change / 2e-5 == pytest.approx(tangent[:, j], abs=2e-6 * scale)


def test_rest_lift_off_and_impact() -> None:
    with element() as wall:
        low, high = wall.respond(0.0, 0.0, 0.0, 0.0).hold
        still = np.zeros(3)
        assert wall.next_event(0.1, still, still, (0.0, 0.0), push=(0.0, 0.9 * high)) is None
        event = wall.next_event(0.1, still, still, (0.0, 0.0), push=(0.0, 2 * high))
        assert event is not None
        assert event[::2] == ("lift_off", 1)
        assert event.tau == pytest.approx(0.05)
        assert low == pytest.approx(-high)
        wall.place(1)
        event = wall.next_event(0.1, (0.01, -0.3, 0.0), (-0.02, -0.3, 0.0), (0.0, 0.0))
        assert event is not None and event.kind == "impact"
        assert event.tau == pytest.approx(0.1 / 3)
        wall.respond(0.0, -0.3, 0.0, 0.0)
        wall.commit()
        after = wall.land(0.0, -0.3, 1e5)
        assert wall.side == -1
        # balance of the moment of momentum about the new corner
        h, b, m, mass = 4.0, 0.8, 2e4, 1e5
        inertia = 4 / 3 * m * (h**2 + b**2) + 4 * mass * h**2
        expected = (inertia - 2 * m * b**2) / inertia
        assert after[0] / -0.3 == pytest.approx(expected, rel=1e-12)
        assert wall.settles(0.1, (0.0, -1e-6, 0.0), 0.0, 0.0, 1e5)
        assert not wall.settles(1e-3, (0.0, -0.3, 0.0), 0.0, 0.0, 1e5)
        wall.place(0)
        assert wall.side == 0


def test_links_of_every_floor() -> None:
    storeys = (
        "&frame xi_s = 0.03 / &storeys n = 4, m = 25e3, k = 25e6, height = 2.0, "
        "coupling = 'every_floor' /"
    )
    with element(frame=storeys) as wall:
        assert (wall.dofs, wall.links) == (1, 4)
        wall.place(1)
        links = wall.motion_of_links(0.1, 0.2, 0.3)
        assert links[0] == pytest.approx(0.1 * np.array([0.25, 0.5, 0.75, 1.0]), rel=1e-3)
        assert links.shape == (4, 4)


def test_bad_calls_are_named() -> None:
    bad = rwmf.InputError
    with element() as wall, element(BENDING) as bent:
        for match, call in (
            ("more than the wall can follow", lambda: wall.respond(50.0, 0.0, 0.0, 0.0, side=1)),
            ("motion 2", lambda: wall.respond([0.1, 50.0], 0.0, 0.0, 0.0, side=1)),
            ("u = nan", lambda: wall.respond(float("nan"), 0.0, 0.0, 0.0)),
            ("u = 'a'", lambda: wall.respond("a", 0.0, 0.0, 0.0)),
            ("side = 2", lambda: wall.respond(0.1, 0.0, 0.0, 0.0, side=2)),
            ("u: has the shape", lambda: bent.respond([0.1, 0.2], [0, 0], [0, 0], 0.0)),
            ("side = 7", lambda: wall.place(7)),
            ("snapshot = ", lambda: wall.restore(bent.save())),
            ("no impact|rest", lambda: wall.land(0.0, 0.1)),
            ("begin: has the shape", lambda: wall.next_event(0.1, (0, 0), (0, 0, 0), (0, 0))),
            ("dt = -1", lambda: wall.next_event(-1.0, (0, 0, 0), (0, 0, 0), (0, 0))),
            ("host_mass: has the shape", lambda: bent.land([0, 0, 0], [0, 0, 0], [[1.0]])),
        ):
            with pytest.raises(bad, match=match):
                call()
        with pytest.raises(TypeError, match="Element cannot be pickled or copied"):
            copy.deepcopy(wall)
    with pytest.raises(bad, match="Element is closed"):
        wall.respond(0.1, 0.0, 0.0, 0.0)
    with pytest.raises(bad, match="&wall"):
        rwmf.Element(rwmf.Case.from_text(FRAME + "&solver t_end = 1.0 /"))


BRACED = (
    "&frame xi_s = 0.03 / &storeys n = 2, m = 2e4, k = 2e7, height = 4.0, coupling = 'springs', "
    "k_link = 1e7 /"
)


@pytest.mark.parametrize(
    ("frame", "velocity", "host_mass", "words"),
    [
        (FRAME, 0.1, None, "away from its base"),
        (FRAME, -0.1, -1.0, "negative mass"),
        (FRAME, -0.1, math.inf, "host_mass"),
        (BRACED, [-1.0, 0.0, 0.0], np.ones((3, 3)), "couples the wall"),
        (BRACED, [-1.0, 0.0, 0.0], np.triu(np.ones((3, 3))), "not symmetric"),
    ],
)
def test_landings_that_cannot_be(
    frame: str,
    velocity: float | list[float],
    host_mass: float | np.ndarray | None,
    words: str,
) -> None:
    with element(frame=frame) as wall:
        wall.place(1)
        with pytest.raises(rwmf.InputError, match=words):
            wall.land(0.0 * np.array(velocity), velocity, host_mass)
        assert wall.side == 1
        still = 0.0 * np.array(velocity)
        wall.respond(still + 0.1, still, still, 0.0)
        wall.commit()
        with pytest.raises(rwmf.InputError, match="not on its base"):
            wall.place(0)


def test_a_hinged_wall_has_no_side() -> None:
    hinged = WALL.replace(" /", ", base = 'pinned' /", 1).partition("&impact")[0]
    with (
        rwmf.Element(rwmf.Case.from_text(hinged + FRAME + "&solver t_end = 1.0 /")) as wall,
        pytest.raises(rwmf.InputError, match="hinged"),
    ):
        wall.place(1)


@pytest.mark.parametrize("form", ["file", "groups"])
def test_an_element_needs_no_keys_of_a_run(form: str, tmp_path: Path) -> None:
    """Neither period and damping of the frame nor the end of a simulation."""
    path = tmp_path / "wall.nml"
    path.write_text(WALL + " &frame gamma = 5.0 /", encoding="utf-8")
    groups = {"wall": {"h": 4.0, "b": 0.8, "m_w": 2e4}, "frame": {"gamma": 5.0}, "impact": {}}
    short = rwmf.Element(path if form == "file" else groups)
    long = element()
    found, expected = (one.respond(0.1, 0.2, 0.3, 0.4, 1)[:8] for one in (short, long))
    assert found == pytest.approx(expected)
    with pytest.raises(rwmf.InputError, match=r"&frame.*\bgamme\b.*gamma"):
        rwmf.Element({"wall": {"h": 4.0, "b": 0.8}, "frame": {"gamme": 5.0}})
