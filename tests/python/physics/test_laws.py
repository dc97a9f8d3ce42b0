"""Laws of frame, storeys and fuses beyond the bilinear one: friction, flag, loss of strength.

Independent laws give the force along the displacements of a run's history. OpenSees is a further
reference where ``RWMF_OPENSEES`` names a Python with ``openseespy``, which needs neither NumPy nor
rwmf. Closed forms point by point are in ``tests/unit/model/test_laws.f90``.
"""

import json
import math
import os
import subprocess
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import rwmf
from checkout import ROOT
from refused import refusals
from scenes import bare_frame, coupled, record

G = 9.81
METHODS = ("adams", "bdf", "taylor", "dop853")
Array = np.ndarray
Group = dict[str, object]
WEAR: Group = {"lambda": [100.0, 40.0, 70.0, 50.0], "lambda_exponent": [1.0, 1.5, 1.2, 2.0]}
LOSES: Group = {"hardening": 0.05, "cap": 4.0, "post_cap": 20.0, "residual": 0.1}
PINCH: Group = {"pinch_force": 0.4, "pinch_displacement": 0.3}
LAWS: dict[str, Group] = {
    "friction": {"law": "friction", "breakaway": 1.3, "hardening": 0.04},
    "softening": {"hardening": -0.02, "ultimate": 30.0},
    "flag": {"law": "flag", "hardening": 0.05, "flag_height": 0.8},
    "peak_oriented": {"law": "peak_oriented"} | LOSES | WEAR,
    "pinched": {"law": "pinched"} | LOSES | PINCH | WEAR,
}
MOTION: Group = {"kind": "sine", "a_max_g": 0.25, "omega_p": 5.0, "cycles": 6.0}
T_END = 8.0
SOLVER: Group = {"t_end": T_END, "rtol": 1e-10}
STOREYS: Group = {"m_over_m_w": [2.0, 2.0], "k_over_m_w": [500.0, 400.0], "height": [2.0, 2.0]}


def frame(law: str, **more: Group) -> rwmf.Case:
    """Frame of 1 s that yields at 0.03 m."""
    groups: dict[str, Group] = {"yielding": {"u_y": 0.03} | LAWS[law], "motion": MOTION}
    groups |= {"solver": SOLVER, "frame": {"T_s": 1.0, "xi_s": 0.03}}
    return bare_frame(**groups).replace(**more)


def scene(kind: str, law: str) -> rwmf.Case:
    """Return a scene in which a law acts: on the frame, on storeys, under the corners."""
    both: dict[str, Group | None] = {"motion": MOTION | {"a_max_g": 0.35}, "solver": SOLVER}
    if kind == "alone":
        return frame(law)
    if kind == "fuses":
        keys = {k: v for k, v in LAWS[law].items() if k != "ultimate"}
        return coupled(fuse={"eta_y": 0.3, "stroke_y": 0.003} | keys, **both)
    if kind == "wall":
        return coupled(yielding={"u_y": 0.02} | LAWS[law], **both)
    both |= {"yielding": {"storey_u_y": [0.012, 0.008]} | LAWS[law]}
    both |= {"frame": {"T_s": None, "gamma": None}, "storeys": STOREYS | {"coupling": kind}}
    return coupled(**both)


SCENES = [
    (kind, law)
    for kind in ("alone", "wall", "full", "every_floor", "fuses")
    for law in LAWS
    if kind != "fuses" or law in ("friction", "flag")
]


# the laws along the displacements of a run


def by_flag(x: Array, u_y: float, hardening: float, height: float) -> Array:
    """Force over the stiffness: the elastic trial force, kept between both lines."""

    def line(d: float, share: float) -> float:
        beyond = max(0.0, abs(d) - share * u_y)
        return math.copysign(abs(d) - (1 - hardening) * beyond, d)

    force = np.zeros_like(x)
    for i in range(1, len(x)):
        d = float(x[i])
        inner, outer = sorted((line(d, 1 - height), line(d, 1.0)), key=abs)
        low, high = min(inner, outer), max(inner, outer)
        force[i] = min(high, max(low, force[i - 1] + d - x[i - 1]))
    return force


def by_friction(x: Array, u_y: float, hardening: float, breakaway: float) -> Array:
    """Force over the stiffness: the spring sticks at reversals, and slips beyond the breakaway."""
    modulus = hardening / (1 - hardening)
    force, p, slides = np.zeros_like(x), 0.0, 0
    for i in range(1, len(x)):
        if slides * (x[i] - x[i - 1]) < 0:
            slides = 0
        over = float(x[i]) - (1 + modulus) * p
        if not slides and abs(over) > breakaway * u_y:
            slides = int(math.copysign(1, over))
        if slides:
            p = (float(x[i]) - slides * u_y) / (1 + modulus)
        force[i] = x[i] - p
    return force


FORCES: dict[str, Callable[[Array, float], Array]] = {
    "flag": lambda x, u_y: by_flag(x, u_y, 0.05, 0.8),
    "friction": lambda x, u_y: by_friction(x, u_y, 0.04, 1.3),
    "softening": lambda x, u_y: by_friction(x, u_y, -0.02, 1.0),
}


@pytest.mark.parametrize("law", FORCES)
def test_force_of_the_frame(law: str) -> None:
    run = rwmf.simulate(frame(law), dt=2e-4)
    u = run["u_s"].to_numpy()
    assert abs(u).max() > 5 * 0.03
    force = run["frame_force_over_m_s_g"].to_numpy() * G / (2 * math.pi) ** 2
    # turns lie between two rows
    assert force == pytest.approx(FORCES[law](u, 0.03), abs=2e-6 * 0.03)


@pytest.mark.parametrize("law", FORCES)
def test_force_of_storeys(law: str) -> None:
    """Each follows its own law; the lower one goes far."""
    run = rwmf.simulate(scene("full", law), dt=2e-4)
    for i, (k, u_y) in enumerate(((500.0, 0.012), (400.0, 0.008)), 1):
        d = 2.0 * run[f"storey_{i}_drift"].to_numpy()
        force = run[f"storey_{i}_shear_over_m_w_g"].to_numpy() * G / k
        assert force == pytest.approx(FORCES[law](d, u_y), abs=1e-5 * u_y)
        assert float(run[f"storey_{i}_ductility"]) == pytest.approx(abs(d).max() / u_y, rel=1e-4)
    assert float(run["storey_1_ductility"]) > 1.3


@pytest.mark.parametrize("law", ["flag", "friction"])
def test_force_of_fuses(law: str) -> None:
    run = rwmf.simulate(scene("fuses", law), dt=2e-4)
    assert int(run["impacts"]) > 3
    for side, name in ((1, "left"), (-1, "right")):
        stroke = 4 * 0.5 * np.sin(np.maximum(0.0, side * run["theta"].to_numpy()) / 2)
        force = run[f"fuse_{name}_force_over_m_w_g"].to_numpy() * 0.003 / 0.3
        expected = (
            by_flag(stroke, 0.003, 0.05, 0.8) if law == "flag" else FORCES[law](stroke, 0.003)
        )
        assert stroke.max() > 2 * 0.003
        assert force == pytest.approx(expected, abs=2e-5 * 0.003)


# OpenSees

OPENSEES = """
import json, sys
import openseespy.opensees as ops
given = json.load(sys.stdin)
ops.uniaxialMaterial(given["material"][0], 1, *given["material"][1:])
ops.testUniaxialMaterial(1)
forces = []
for u in given["u"]:
    ops.setStrain(u)
    forces.append(ops.getStress())
json.dump(forces, open(sys.argv[1], "w"))
"""


def opensees(material: list[object], u: Array, folder: Path) -> Array:
    """Return the forces of a material of OpenSees along displacements."""
    python = os.environ.get("RWMF_OPENSEES")
    if not python:
        pytest.skip("no OpenSees: RWMF_OPENSEES names no Python that has openseespy")
    given = json.dumps({"material": material, "u": u.tolist()})
    file = folder / "forces.json"
    subprocess.run(
        [python, "-c", OPENSEES, str(file)], input=given, text=True, capture_output=True, check=True
    )
    return np.array(json.loads(file.read_text(encoding="utf-8")))


def with_corners(u: Array, levels: list[float]) -> tuple[Array, Array]:
    """Displacements and those levels that they pass, in their order; where the former are.

    `SelfCentering` takes the state at the end of a step for that at the corner inside it.
    """
    full, places = [u[0]], [0]
    for a, b in pairwise(u):
        passed = [level for level in levels if min(a, b) < level < max(a, b)]
        full += [*sorted(passed, reverse=bool(b < a)), b]
        places.append(len(full) - 1)
    return np.array(full), np.array(places)


@pytest.mark.parametrize("a_max_g", [0.12, 0.25, 0.5])
@pytest.mark.parametrize("law", ["flag", "peak_oriented", "pinched"])
def test_force_against_opensees(law: str, a_max_g: float, tmp_path: Path) -> None:
    """Equal histories of displacement have equal histories of force."""
    u_y, k = 0.03, (2 * math.pi) ** 2
    run = rwmf.simulate(frame(law, motion={"a_max_g": a_max_g}), dt=5e-4)
    u = run["u_s"].to_numpy()
    places = np.arange(len(u))
    if law == "flag":
        material: list[object] = ["SelfCentering", k, 0.05 * k, k * u_y, 0.8]
        u, places = with_corners(u, [-u_y, -0.2 * u_y, 0.2 * u_y, u_y])
    else:
        side = [3 * u_y, 20 * u_y, 1e3, k * u_y, 1.15, 0.1]
        wear = [x * u_y for x in WEAR["lambda"]] + WEAR["lambda_exponent"] + [1.0, 1.0]
        name = "IMKPeakOriented" if law == "peak_oriented" else "IMKPinching"
        pinch = [] if law == "peak_oriented" else list(PINCH.values())
        material = [name, k, *side, *side, *wear, *pinch]
    force = run["frame_force_over_m_s_g"].to_numpy() * G
    expected = opensees(material, u, tmp_path)[places]
    # OpenSees adds up energies in trapezoids, and takes the last row for the turn
    assert force == pytest.approx(expected, abs=1e-5 * k * u_y)


# closed forms


def constant(tmp_path: Path, a: float, t_end: float) -> Group:
    """`&motion` of a constant acceleration [m/s2]."""
    file = tmp_path / "constant.csv"
    file.write_text(f"0.0 {a!r}\n{2 * t_end!r} {a!r}\n", encoding="utf-8")
    return record(file, unit="m/s2")


def suddenly(law: Group, share: float, tmp_path: Path, t_end: float = 3.0) -> rwmf.Case:
    """Undamped frame of 1 s and 0.03 m under a sudden push of a share of its strength."""
    a = -share * 0.03 * (2 * math.pi) ** 2
    return bare_frame(
        frame={"T_s": 1.0, "xi_s": 0.0},
        yielding={"u_y": 0.03} | law,
        motion=constant(tmp_path, a, t_end),
        solver={"t_end": t_end, "rtol": 1e-11},
    )


def test_friction_lets_go(tmp_path: Path) -> None:
    """Check a u = mu^2 F u_y/2 + F (u - mu u_y) at the peak, and the residual u - u_y."""
    share, mu = 0.9, 1.2
    run = rwmf.simulate(suddenly({"law": "friction", "breakaway": mu}, share, tmp_path))
    peak = (mu - mu**2 / 2) / (1 - share) * 0.03
    assert float(run["u_s_max"]) == pytest.approx(peak, rel=1e-9)
    assert float(run["residual_displacement"]) == pytest.approx(peak - 0.03, rel=1e-9)


def test_flag_comes_back(tmp_path: Path) -> None:
    """The peak is that of the bilinear one; the least is where the way back has given as much."""
    share, h = 0.7, 0.4
    run = rwmf.simulate(suddenly({"law": "flag", "flag_height": h}, share, tmp_path), dt=1e-4)
    u = run["u_s"].to_numpy() / 0.03
    peak = 0.5 / (1 - share)
    assert float(run["ductility"]) == pytest.approx(peak, rel=1e-9)
    # from the peak: down by h, along 1 - h, elastic below; work of the push: share per u_y
    first = int(u.argmax())
    least = u[first : first + 12000].min()
    stored = (1 - (1 - h) ** 2) / 2 + (1 - h) * (peak - h - least)
    assert least > 1 - h
    assert stored == pytest.approx(share * (peak - least), rel=1e-6)
    assert float(run["residual_displacement"]) == 0


def test_softening_runs_away(tmp_path: Path) -> None:
    """Elastic up to u_y, then a sum of exponentials up to the ultimate displacement."""
    share, a, ultimate, omega = 0.9, 0.05, 6.0, 2 * math.pi
    law: Group = {"hardening": -a, "ultimate": ultimate}
    run = rwmf.simulate(suddenly(law, share, tmp_path))
    # u = share (1 - cos(omega t)) u_y
    t_y = math.acos(1 - 1 / share) / omega
    rate = share * omega * math.sin(omega * t_y)
    slow = math.sqrt(a) * omega
    # u'' = omega^2 (share - 1 + a (u - 1)), u = 1 + x
    level = (1 - share) / a

    def x(t: float) -> float:
        return level + (0 - level) * math.cosh(slow * t) + rate / slow * math.sinh(slow * t)

    times = np.linspace(0.0, 3.0, 300001)
    ways = np.array([x(float(t)) for t in times])
    passes = ways >= ultimate - 1
    assert bool(run["collapsed"])
    t = float(np.interp(ultimate - 1, ways[: passes.argmax() + 1], times[: passes.argmax() + 1]))
    assert float(run["t_collapse"]) == pytest.approx(t_y + t, abs=1e-8)
    assert float(run["u_s_max"]) == pytest.approx(ultimate * 0.03, rel=1e-12)


# every scene


@pytest.mark.parametrize(("kind", "law"), SCENES)
def test_methods_ledger_and_mirror(kind: str, law: str) -> None:
    case = scene(kind, law).replace(output={"energy": True})
    runs = {method: rwmf.simulate(case.replace(solver={"method": method})) for method in METHODS}
    trusted = runs["dop853"]
    for method, run in runs.items():
        assert abs(float(run["energy_balance_relative"])) < 1e-7, method
        assert float(run["u_s_max"]) == pytest.approx(float(trusted["u_s_max"]), rel=1e-7), method
        if "residual_displacement" in run:
            assert float(run["residual_displacement"]) == pytest.approx(
                float(trusted["residual_displacement"]), abs=1e-7
            ), method
    assert float(trusted["energy_hysteretic_J_per_kg"]) > 0
    size = -float(case.motion.a_max_g)
    mirrored = rwmf.simulate(case.replace(motion={"a_max_g": size}, solver={"method": "dop853"}))
    assert float(mirrored["u_s_max"]) == pytest.approx(float(trusted["u_s_max"]), rel=1e-12)
    for name in ("residual_displacement", "ductility"):
        if name in trusted:
            assert abs(float(mirrored[name])) == pytest.approx(
                abs(float(trusted[name])), rel=1e-9, abs=1e-13
            )


@pytest.mark.parametrize("kind", ["alone", "wall"])
@pytest.mark.parametrize("law", LAWS)
def test_spectrum_is_the_runs(law: str, kind: str) -> None:
    """Sixteen lanes, and one: to the last bit."""
    T_s = [0.3, 0.5, 0.8, 1.1, 1.5, 2.0, 2.5]
    case = scene(kind, law).replace(solver={"rtol": 1e-8, "method": "dop853"})
    quantities = ["u_s_max_m", "ductility", "residual_displacement_m"]
    found = rwmf.spectrum(case.replace(spectrum={"T_s": T_s, "quantities": quantities}))
    for i, period in enumerate(T_s):
        run = rwmf.simulate(case.replace(frame={"T_s": period}))
        for name in (name.removesuffix("_m") for name in quantities):
            ordinate = float(found[name].values.ravel()[i])
            assert ordinate == float(run[name]), (name, period)
        status = str(found["status"].values.ravel()[i])
        assert status == ("collapsed" if bool(run.get("collapsed", False)) else "ok")


def test_limits() -> None:
    """Laws that are the bilinear one in a limit, or one another."""
    plain = rwmf.simulate(bare_frame(**_of({"hardening": 0.05})))
    for law in (
        {"law": "friction", "hardening": 0.05},
        {"hardening": 0.05, "ultimate": 1e6},
    ):
        run = rwmf.simulate(bare_frame(**_of(law)))
        assert float(run["u_s_max"]) == float(plain["u_s_max"])
        assert float(run["residual_displacement"]) == float(plain["residual_displacement"])
    loses = LOSES | {"law": "pinched", "pinch_displacement": 1.0, "pinch_force": 1.0}
    straight = rwmf.simulate(bare_frame(**_of(LOSES | {"law": "peak_oriented"})))
    pinched = rwmf.simulate(bare_frame(**_of(loses)))
    assert float(pinched["u_s_max"]) == pytest.approx(float(straight["u_s_max"]), rel=1e-8)


def _of(law: Group) -> dict[str, Group]:
    return {
        "yielding": {"u_y": 0.03} | law,
        "motion": MOTION,
        "solver": SOLVER,
        "frame": {"T_s": 1.0, "xi_s": 0.03},
    }


def test_storey_that_collapses() -> None:
    """The run ends where the first storey has its ultimate ductility."""
    case = scene("full", "friction").replace(yielding={"ultimate": 1.5})
    run = rwmf.simulate(case)
    assert bool(run["collapsed"])
    ductilities = [float(run[f"storey_{i}_ductility"]) for i in (1, 2)]
    assert max(ductilities) == pytest.approx(1.5, rel=1e-9)
    straight = rwmf.simulate(scene("every_floor", "friction").replace(yielding={"ultimate": 1.5}))
    assert bool(straight["collapsed"])
    assert float(straight["ductility"]) == pytest.approx(1.5, rel=1e-9)


# the shipped cases, and refusals


def test_shipped_flag(elcentro: Path) -> None:
    """Check the statement in the namelist's first comment."""
    case = rwmf.Case.from_namelist(ROOT / "inputs" / "what_does_a_self_centring_frame_pay.nml")
    case = case.replace(motion={"file": str(elcentro)})
    run = rwmf.simulate(case)
    assert float(run["ductility"]) == pytest.approx(3.86, abs=5e-3)
    assert float(run["residual_displacement"]) == 0
    half = rwmf.simulate(case.replace(yielding={"flag_height": 0.5}))
    assert float(half["ductility"]) == pytest.approx(3.91, abs=5e-3)
    plastic = rwmf.simulate(case.replace(yielding={"law": "elastic_plastic", "flag_height": None}))
    assert float(plastic["ductility"]) == pytest.approx(4.42, abs=5e-3)
    assert abs(float(plastic["residual_displacement"])) == pytest.approx(3e-3, abs=1e-4)


def test_shipped_collapse(elcentro: Path) -> None:
    """Check the statement in the namelist's first comment."""
    name = "does_the_loss_of_strength_bring_it_down.nml"
    case = rwmf.Case.from_namelist(ROOT / "inputs" / name)
    case = case.replace(motion={"file": str(elcentro)})
    assert float(rwmf.simulate(case)["t_collapse"]) == pytest.approx(11.38, abs=5e-3)
    fresh = rwmf.simulate(case.replace(yielding={"lambda": None}))
    assert float(fresh["t_collapse"]) == pytest.approx(15.41, abs=5e-3)
    pinched = rwmf.simulate(case.replace(yielding={"law": "pinched"} | PINCH))
    assert float(pinched["t_collapse"]) == pytest.approx(8.97, abs=5e-3)
    plastic = dict.fromkeys(("cap", "post_cap", "lambda")) | {"law": "elastic_plastic"}
    stands = rwmf.simulate(case.replace(yielding=plastic))
    assert not bool(stands["collapsed"])
    assert float(stands["u_s_max"]) == pytest.approx(0.156, abs=5e-4)


test_refusals = refusals(
    lambda law: rwmf.simulate(bare_frame(yielding={"u_y": 0.03} | law)),
    ({"law": "flag", "breakaway": 1.2}, "breakaway"),
    ({"flag_height": 0.5}, "'flag'"),
    ({"law": "flag", "flag_height": 0.0}, "flag_height"),
    ({"law": "flag", "hardening": -0.1, "ultimate": 5.0}, "hardening"),
    ({"hardening": -0.1}, "ultimate"),
    ({"law": "peak_oriented", "post_cap": 5.0}, "cap"),
    ({"law": "pinched", "cap": 5.0}, "post_cap"),
    ({"law": "pinched", "cap": 5.0, "post_cap": 5.0, "lambda": [1.0, 2.0]}, "lambda"),
    ({"law": "peak_oriented", "cap": 5.0, "post_cap": 5.0, "pinch_force": 0.5}, "'pinched'"),
    ({"law": "bouc_wen", "cap": 5.0}, "'peak_oriented' or 'pinched'"),
    ({"ultimate": 1.0}, "ultimate"),
)


def test_keys_of_fuses() -> None:
    for keys, words in (
        ({"law": "flag", "breakaway": 1.2}, "'friction'"),
        ({"flag_height": 0.5}, "'flag'"),
        ({"law": "pinched"}, "law"),
    ):
        with pytest.raises(rwmf.InputError, match=words):
            rwmf.simulate(coupled(fuse={"eta_y": 0.3, "stroke_y": 0.003} | keys))
