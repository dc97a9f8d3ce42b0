"""Damping ratios of a wall that bends, with its floors: shapes integrated by NumPy, and a decay."""

import numpy as np
import pytest
import rwmf
from rwmf.hosts.opensees_script import opensees_script
from scenes import coupled
from scipy.linalg import eigh

H, B, EI = 9.6, 2.0, 8.3e5
ROOTS = [1.8751040687119611, 4.694091132974174, 7.854757438237613, 10.995540734875467]
FLOORS = {"m_over_m_w": [1.0, 0.8, 0.5], "k_over_m_w": [20.0, 15.0, 10.0],
          "height": [6.4, 6.4, 6.4]}  # fmt: skip


def wall(n: int, bending: dict[str, object], **changes: dict[str, object] | None) -> rwmf.Case:
    """Return a wall with modes, by default without a frame."""
    given: dict[str, dict[str, object] | None] = {
        "wall": {"h": H, "b": B},
        "frame": None,
        "bending": {"EI_over_m_w": EI, "modes": n} | bending,
        "impact": {"rule": "coupled", "e": None},
        "model": {"formulation": "exact"},
        "solver": {"t_end": 0.01},
    }
    return coupled(**given).replace(**changes)


def shapes(z: np.ndarray, n: int) -> np.ndarray:
    """Modes of a cantilever over the share of its height, 1 at the top."""
    found = []
    for root in ROOTS[:n]:
        ratio = (np.cosh(root) + np.cos(root)) / (np.sinh(root) + np.sin(root))
        curve = [
            np.cosh(root * x) - np.cos(root * x) - ratio * (np.sinh(root * x) - np.sin(root * x))
            for x in (z, 1.0)
        ]
        found.append(curve[0] / curve[1])
    return np.array(found)


def ratios(n: int, damping: str, masses: dict[float, float], beta: float = 0.0) -> np.ndarray:
    """Damping ratios for a ratio of 1, in contact and rocking, from the full eigenproblem."""
    node, weight = np.polynomial.legendre.leggauss(80)
    z, weight = (node + 1) / 2, weight / 2
    # rows: rotation about the corner, then modes; the width turns as well
    rows = np.vstack([2 * H * z, shapes(z, n)])
    mass = (rows * weight) @ rows.T
    mass[0, 0] += B**2 + B**2 / 3 + beta * (2 * B) ** 2
    for share, m in masses.items():
        column = np.concatenate([[2 * H * share], shapes(np.array([share]), n)[:, 0]])
        mass += m * np.outer(column, column)
    own = (shapes(z, n) ** 2) @ weight
    omega = np.array(ROOTS[:n]) ** 2 * np.sqrt(EI / (2 * H) ** 3)
    c = 2 * own * omega * (omega / omega[0] if damping == "stiffness" else 1.0)
    stiffness, damper = np.diag([0.0, *own * omega**2]), np.diag([0.0, *c])
    found = []
    for first in (1, 0):
        square, modes = eigh(stiffness[first:, first:], mass[first:, first:])
        modal = np.einsum("ji,jk,ki->i", modes, damper[first:, first:], modes)
        # rocking begins with the rotation as a rigid body
        kept = slice(1 - first, 1 - first + min(3, n))
        found.append(modal[kept] / (2 * np.sqrt(square[kept])))
    return np.array(found)


def found(case: rwmf.Case) -> np.ndarray:
    """Damping ratios that a run reports."""
    run = rwmf.simulate(case)
    keys = ("modes_damping_contact", "modes_damping_rocking")
    return np.array([run[key].dropna("mode").values for key in keys])


@pytest.mark.parametrize("damping", ["modal", "stiffness"])
@pytest.mark.parametrize("n", [1, 2, 4])
@pytest.mark.parametrize("floors", ["none", "single", "every_floor", "full", "springs"])
def test_ratios_of_the_built_wall(floors: str, n: int, damping: str) -> None:
    changes: dict[str, dict[str, object] | None] = {}
    masses: dict[float, float] = {}
    if floors == "single":
        changes["frame"] = {"T_s": 1.0, "gamma": 2.5, "xi_s": 0.05}
        masses = {1.0: 2.5}
    elif floors != "none":
        links: dict[str, object] = {"k_link_over_m_w": 1e4} if floors == "springs" else {}
        changes["frame"] = {"T_s": None, "gamma": None, "xi_s": 0.05}
        changes["storeys"] = FLOORS | {"coupling": floors} | links
        masses = {1.0: 0.5} if floors == "full" else {1 / 3: 1.0, 2 / 3: 0.8, 1.0: 0.5}
    given = {"xi": 0.02, "damping": damping}
    expected = ratios(n, damping, masses)
    case = wall(n, given, **changes)
    assert found(case) == pytest.approx(0.02 * expected, rel=1e-9)
    scaled = found(wall(n, given | {"xi_of": "rocking"}, **changes))
    assert scaled == pytest.approx(0.02 * expected / expected[1, 0], rel=1e-9)
    assert scaled[1, 0] == pytest.approx(0.02, rel=1e-12)


def test_inerters_and_no_damping() -> None:
    inerter = {"inertance_over_m_w": 3.0}
    expected = ratios(3, "modal", {}, beta=3.0)
    case = wall(3, {"xi": 0.05, "damping": "modal"}, inerter=inerter)
    assert found(case) == pytest.approx(0.05 * expected, rel=1e-9)
    assert not found(wall(2, {"xi": 0.0, "xi_of": "rocking"})).any()


@pytest.mark.parametrize("xi_of", ["cantilever", "rocking"])
def test_a_wall_in_contact_decays_with_its_ratio(xi_of: str) -> None:
    """A frame on a soft spring adds its mass; the tendon holds the wall down."""
    case = wall(
        1,
        {"xi": 0.02, "xi_of": xi_of},
        frame={"T_s": 100.0, "gamma": 2.5, "xi_s": 0.0},
        cable={"eta_0": 100.0, "eta_alpha": 100.0},
        solver={"t_end": 12.0},
        motion={"kind": "one_sine", "a_max_g": 0.1, "T_p": 1.0, "omega_p": None},
    )
    run = rwmf.simulate(case, dt=1e-3)
    assert int(run.lift_offs) == 0
    q = run["q_1"].values[run["time"].values > 2.0]
    peaks = q[1:-1][(q[1:-1] > q[:-2]) & (q[1:-1] >= q[2:])]
    zeta = np.log(peaks[0] / peaks[8]) / (16 * np.pi)
    assert zeta == pytest.approx(float(run["mode_1_damping_contact"]), rel=2e-3)


def test_elements_of_a_building_with_its_ratio_are_not_exported() -> None:
    case = wall(1, {"damping": "stiffness", "xi_of": "rocking"})
    with pytest.raises(rwmf.InputError, match="xi_of = 'rocking'; use 'cantilever'"):
        opensees_script(case)
