"""Validation cases in MuJoCo, an independent rigid-body engine with contact.

``python bench/mujoco_cases.py [CASE ...]`` reads ``validation/CASE.nml`` and writes
``validation/mujoco/CASE.csv``. Needs ``pip install '.[validation]'``.

The engine gets masses, sizes, spring, damper, cable, link, friction and the motion. It gets neither
the kinematics of rocking (pivot corner and lever arm) nor a restitution factor. Both follow from
contact between a box and a plane.
"""

from __future__ import annotations

import argparse
import math
import time
from dataclasses import asdict, dataclass
from pathlib import Path

import mujoco
import numpy as np
import numpy.typing as npt
import rwmf
from reproduce.engines import COLUMNS, write

Array = npt.NDArray[np.float64]

ROOT = Path(__file__).resolve().parents[1]
CASES = ("free", "block", "g5", "g1800", "disc")
THICKNESS = 0.2  # m


@dataclass(frozen=True)
class Engine:
    """Numbers of the computation: none of them belongs to the structure.

    Attributes
    ----------
    dt : float
        Time step [s].
    settling : float
        Time at rest before the motion begins [s]; the contact finds its penetration.
    stored_interval : float
        Interval of the stored history [s].
    friction : float
        Coefficient of friction [-].
    link_length : float
        Length of the link from the left top corner to the frame [m].
    contact_time : float
        Time constant of the critically damped contact [s].
    """

    dt: float = 5e-5
    settling: float = 0.5
    stored_interval: float = 2e-3
    friction: float = 0.35
    link_length: float = 100.0
    contact_time: float = 3e-4


def main() -> None:
    """Compute the cases that the command line names, all of them otherwise."""
    parser = argparse.ArgumentParser(
        description=__doc__.splitlines()[0], epilog="example: python bench/mujoco_cases.py g5"
    )
    parser.add_argument("cases", nargs="*", metavar="CASE", help=f"any of {', '.join(CASES)}")
    parser.add_argument("--friction", type=float, default=Engine.friction, help="coefficient")
    parser.add_argument("--out", type=Path, default=ROOT / "validation" / "mujoco")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    for name in options.cases or CASES:
        started = time.perf_counter()
        case = rwmf.Case.from_namelist(ROOT / "validation" / f"{name}.nml")
        facts, history = simulate(case, Engine(friction=options.friction))
        write(options.out / f"{name}.csv", facts, history)
        print(f"{name}: {time.perf_counter() - started:.1f} s, slip {facts['slip_max_m']:.1e} m")


def simulate(case: rwmf.Case, engine: Engine) -> tuple[dict[str, object], Array]:
    """Compute one case."""
    model = mujoco.MjModel.from_xml_string(scene(case, engine))
    data = mujoco.MjData(model)
    start(case, model, data)
    n_settling = round(engine.settling / engine.dt) if case.initial is None else 0
    n = round(case.solver.t_end / engine.dt)
    rows = np.empty((n + 1, len(COLUMNS) + 1))
    for i in range(-n_settling, n + 1):
        if i >= 0:
            rows[i] = observe(case, model, data, i * engine.dt)
        push(case, model, data, (i + 0.5) * engine.dt if i >= 0 else -1.0)
        mujoco.mj_step(model, data)
    # the zero of the frame's displacement is its position on the settled contact
    if case.frame is not None:
        rows[:, 5] -= rows[0, 5]
    stride = round(engine.stored_interval / engine.dt)
    facts: dict[str, object] = {
        "engine": f"MuJoCo {mujoco.__version__}",
        "slip_max_m": float(f"{slip(rows):.3g}"),
        **asdict(engine),
    }
    return facts, rows[::stride, :6]


def scene(case: rwmf.Case, engine: Engine) -> str:
    """Describe wall, frame, link and cable in the engine's own language."""
    h, b = case.wall.h, case.wall.b
    frame, link = _frame(case, engine) if case.frame is not None else ("", "")
    top = f'<site name="top" pos="0 0 {h!r}"/>' if case.cable is not None else ""
    cable = _cable(case) if case.cable is not None else ""
    tendons = f"<tendon>{cable}{link}</tendon>" if cable or link else ""
    # the link keeps its length in tension and in compression
    rigid = (
        '<equality><tendon tendon1="link" solref="0.0002 1" solimp="0.9999 0.9999 1e-5"/>'
        "</equality>"
        if link
        else ""
    )
    return f"""
<mujoco>
  <option timestep="{engine.dt}" gravity="0 0 -{case.model.g!r}" integrator="implicitfast"
          solver="Newton" iterations="200" tolerance="1e-12" cone="elliptic" impratio="100"/>
  <worldbody>
    <geom name="ground" type="plane" size="5 5 0.1" friction="{engine.friction} 0 0" condim="3"
          solref="{engine.contact_time} 1" solimp="0.98 0.999 1e-5"/>
    <site name="bottom" pos="0 0 0"/>
    <body name="wall" pos="0 0 {h!r}">
      <joint name="x" type="slide" axis="1 0 0"/>
      <joint name="z" type="slide" axis="0 0 1"/>
      <joint name="theta" type="hinge" axis="0 1 0"/>
      <geom name="wall" type="box" size="{b!r} {THICKNESS / 2} {h!r}" mass="{case.wall.m_w!r}"
            friction="{engine.friction} 0 0" condim="3" solref="{engine.contact_time} 1"
            solimp="0.98 0.999 1e-5"/>
      <site name="corner" pos="{-b!r} 0 {h!r}"/>{top}
    </body>{frame}
  </worldbody>{tendons}{rigid}
</mujoco>"""


def _frame(case: rwmf.Case, engine: Engine) -> tuple[str, str]:
    """Moment frame as mass, spring and damper, and its link to the left top corner."""
    omega_s = 2 * math.pi / case.frame.T_s
    m_s = case.frame.gamma * case.wall.m_w
    k_s, c_s = m_s * omega_s**2, 2 * case.frame.xi_s * m_s * omega_s
    x, z = -case.wall.b - engine.link_length, 2 * case.wall.h
    body = f"""
    <body name="frame" pos="{x!r} 0 {z!r}">
      <joint name="u_s" type="slide" axis="1 0 0" stiffness="{k_s!r}" damping="{c_s!r}"/>
      <geom type="sphere" size="0.1" mass="{m_s!r}" contype="0" conaffinity="0"/>
      <site name="roof"/>
    </body>"""
    return body, '<spatial name="link"><site site="roof"/><site site="corner"/></spatial>'


def _cable(case: rwmf.Case) -> str:
    """Elastic cable with P(0) = eta_0 m_w g and P(alpha) = eta_alpha m_w g."""
    h, b = case.wall.h, case.wall.b
    weight = case.wall.m_w * case.model.g
    alpha = math.atan(b / h)
    # about a corner, the middle of the top rises and moves sideways
    length = math.hypot(
        b * (1 - math.cos(alpha)) + 2 * h * math.sin(alpha),
        2 * h * math.cos(alpha) + b * math.sin(alpha),
    )
    stiffness = (case.cable.eta_alpha - case.cable.eta_0) * weight / (length - 2 * h)
    slack = 2 * h - case.cable.eta_0 * weight / stiffness
    return (
        f'<spatial name="cable" stiffness="{stiffness!r}" springlength="{slack!r}">'
        '<site site="bottom"/><site site="top"/></spatial>'
    )


def start(case: rwmf.Case, model: mujoco.MjModel, data: mujoco.MjData) -> None:
    """Turn the wall about a bottom corner to its initial rotation."""
    if case.initial is not None:
        h, b = case.wall.h, case.wall.b
        theta = case.initial.theta_over_alpha * math.atan(b / h)
        data.joint("theta").qpos = theta
        data.joint("x").qpos = b + h * math.sin(theta) - b * math.cos(theta)
        data.joint("z").qpos = h * math.cos(theta) + b * math.sin(theta) - h
    mujoco.mj_forward(model, data)


def push(case: rwmf.Case, model: mujoco.MjModel, data: mujoco.MjData, t: float) -> None:
    """Apply the ground motion as a force of inertia on each mass."""
    acceleration = ground_acceleration(case, t)
    for name, body in (("x", "wall"), ("u_s", "frame")):
        if name == "x" or case.frame is not None:
            data.joint(name).qfrc_applied = -model.body(body).mass * acceleration


def ground_acceleration(case: rwmf.Case, t: float) -> float:
    """Acceleration of the ground by Eqs (16) and (17) and for several cycles [m/s2]."""
    motion = case.motion
    if motion.kind == "none":
        return 0.0
    cycles = motion.cycles if motion.kind == "sine" else 1.0
    if not 0.0 <= t <= cycles * 2 * math.pi / motion.omega_p:
        return 0.0
    wave = math.cos if motion.kind == "one_cosine" else math.sin
    return motion.a_max_g * case.model.g * wave(motion.omega_p * t)


def observe(case: rwmf.Case, model: mujoco.MjModel, data: mujoco.MjData, t: float) -> Array:
    """Row of the history: `COLUMNS` and the position of the corner that is down [m]."""
    h, b = case.wall.h, case.wall.b
    x, z = float(data.joint("x").qpos[0]), h + float(data.joint("z").qpos[0])
    theta, rate = float(data.joint("theta").qpos[0]), float(data.joint("theta").qvel[0])
    sine, cosine = math.sin(theta), math.cos(theta)
    left = np.array([x - b * cosine - h * sine, z + b * sine - h * cosine])
    right = np.array([x + b * cosine - h * sine, z - b * sine - h * cosine])
    u_s = float(data.joint("u_s").qpos[0]) if case.frame is not None else math.nan
    down = right[0] - b if theta > 0 else left[0] + b
    return np.array([t, theta, rate, left[1], right[1], u_s, down])


def slip(rows: Array) -> float:
    """Return the range of the position of the corner on the ground [m]."""
    standing = rows[np.abs(rows[:, 1]) > 1e-4, 6]
    return float(np.ptp(standing)) if standing.size else 0.0


if __name__ == "__main__":
    main()
