"""Validation cases in MuJoCo, an independent rigid-body engine with contact.

``python bench/mujoco_cases.py [CASE ...]`` reads ``validation/CASE.nml`` and writes
``validation/mujoco/CASE.csv``. It prints base reactions beside the engine's contact forces. Needs
``pip install '.[validation]'``.

The engine gets masses, sizes, spring, damper, cable, link, friction and the motion. It gets neither
the kinematics of rocking (pivot corner and lever arm) nor a restitution factor. Both follow from
contact between a box and a plane. That contact is a stiff spring and damper: forces are averaged
over windows. Windows at an impact or a jump of the motion are omitted, because the engine spreads
an impulse or a sudden force over some time.
"""

import math
from dataclasses import asdict, dataclass
from pathlib import Path

import mujoco
import numpy as np
import rwmf
from common import table
from engines import Array, Pulse, cable_of, case_of, frame_of, pulse_of, slip, store_cases
from reproduce.engines import write

CASES = ("free", "block", "g5", "g1800", "disc")
THICKNESS = 0.2  # m
WINDOW = 0.01  # s
AROUND_JUMPS = 0.05  # s before and after
HISTORY_DT = 5e-4  # s
LEAST_PRESSURE = 0.05  # of the weight: below, a ratio of forces of the engine says nothing


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


def _store(name: str, folder: Path) -> None:
    case, engine = case_of(name), Engine()
    rows, forces = simulate(case, engine)
    facts = {"engine": f"MuJoCo {mujoco.__version__}", "slip_max_m": slip(rows), **asdict(engine)}
    stride = round(engine.stored_interval / engine.dt)
    write(folder / f"{name}.csv", facts, rows[::stride, :6])
    heads = ("case", "windows", "rms N", "difference", "rms H", "difference", "friction", "MuJoCo")
    print(table(heads, [[name, *(f"{x:.4g}" for x in reactions(case, forces, engine))]]))


def simulate(case: rwmf.Case, engine: Engine) -> tuple[Array, Array]:
    """Return rows of the history with the place of the corner down, and forces over m_w g."""
    model = mujoco.MjModel.from_xml_string(scene(case, engine))
    data = mujoco.MjData(model)
    _start(case, model, data)
    pulse = pulse_of(case)
    n_settling = round(engine.settling / engine.dt) if case.initial is None else 0
    n = round(case.solver.t_end / engine.dt)
    rows, forces = np.empty((n + 1, 7)), np.zeros((n + 1, 2))
    force = np.zeros(6)
    for i in range(-n_settling, n + 1):
        if i >= 0:
            rows[i] = _observe(case, data, i * engine.dt)
        _push(case, pulse, model, data, (i + 0.5) * engine.dt if i >= 0 else -1.0)
        mujoco.mj_step(model, data)
        for k in range(data.ncon if i >= 0 else 0):
            mujoco.mj_contactForce(model, data, k, force)
            # the normal points from the ground into the wall
            world = data.contact[k].frame.reshape(3, 3).T @ force[:3]
            forces[i] += world[2], world[0]
    # the zero of the frame's displacement is its position on the settled contact
    if case.frame is not None:
        rows[:, 5] -= rows[0, 5]
    return rows, forces[:-1] / (case.wall.m_w * case.model.g)


def scene(case: rwmf.Case, engine: Engine) -> str:
    """Describe wall, frame, link and cable in the engine's own language."""
    h, b = case.wall.h, case.wall.b
    contact = f'solref="{engine.contact_time} 1" solimp="0.98 0.999 1e-5"'
    body, tendons, rigid, top = "", "", "", ""
    if frame := frame_of(case):
        x = -b - engine.link_length
        body = f"""
    <body name="frame" pos="{x!r} 0 {2 * h!r}">
      <joint name="u_s" type="slide" axis="1 0 0" stiffness="{frame.k!r}" damping="{frame.c!r}"/>
      <geom type="sphere" size="0.1" mass="{frame.m!r}" contype="0" conaffinity="0"/>
      <site name="roof"/>
    </body>"""
        tendons = '<spatial name="link"><site site="roof"/><site site="corner"/></spatial>'
        # the link keeps its length in tension and in compression
        rigid = ('<equality><tendon tendon1="link" solref="0.0002 1" '
                 'solimp="0.9999 0.9999 1e-5"/></equality>')  # fmt: skip
    if cable := cable_of(case):
        stiffness, force = cable
        top = f'<site name="top" pos="0 0 {h!r}"/>'
        tendons = (
            f'<spatial name="cable" stiffness="{stiffness!r}" '
            f'springlength="{2 * h - force / stiffness!r}">'
            f'<site site="bottom"/><site site="top"/></spatial>{tendons}'
        )
    return f"""
<mujoco>
  <option timestep="{engine.dt}" gravity="0 0 -{case.model.g!r}" integrator="implicitfast"
          solver="Newton" iterations="200" tolerance="1e-12" cone="elliptic" impratio="100"/>
  <worldbody>
    <geom name="ground" type="plane" size="5 5 0.1" friction="{engine.friction} 0 0" condim="3"
          {contact}/>
    <site name="bottom" pos="0 0 0"/>
    <body name="wall" pos="0 0 {h!r}">
      <joint name="x" type="slide" axis="1 0 0"/>
      <joint name="z" type="slide" axis="0 0 1"/>
      <joint name="theta" type="hinge" axis="0 1 0"/>
      <geom name="wall" type="box" size="{b!r} {THICKNESS / 2} {h!r}" mass="{case.wall.m_w!r}"
            friction="{engine.friction} 0 0" condim="3" {contact}/>
      <site name="corner" pos="{-b!r} 0 {h!r}"/>{top}
    </body>{body}
  </worldbody>
  <tendon>{tendons}</tendon>{rigid}
</mujoco>"""


def _start(case: rwmf.Case, model: mujoco.MjModel, data: mujoco.MjData) -> None:
    """Turn the wall about a bottom corner to its initial rotation."""
    if case.initial is not None:
        h, b = case.wall.h, case.wall.b
        theta = case.initial.theta_over_alpha * math.atan(b / h)
        data.joint("theta").qpos = theta
        data.joint("x").qpos = b + h * math.sin(theta) - b * math.cos(theta)
        data.joint("z").qpos = h * math.cos(theta) + b * math.sin(theta) - h
    mujoco.mj_forward(model, data)


def _push(
    case: rwmf.Case, pulse: Pulse | None, model: mujoco.MjModel, data: mujoco.MjData, t: float
) -> None:
    """Apply the ground motion as a force of inertia on each mass."""
    for name, body in (("x", "wall"), ("u_s", "frame")):
        if pulse and (name == "x" or case.frame is not None):
            data.joint(name).qfrc_applied = -model.body(body).mass * pulse.at(t)


def _observe(case: rwmf.Case, data: mujoco.MjData, t: float) -> list[float]:
    """Row of the history: the stored columns and the position of the corner that is down [m]."""
    h, b = case.wall.h, case.wall.b
    x, z = float(data.joint("x").qpos[0]), h + float(data.joint("z").qpos[0])
    theta, rate = float(data.joint("theta").qpos[0]), float(data.joint("theta").qvel[0])
    sine, cosine = math.sin(theta), math.cos(theta)
    left, right = z + b * sine - h * cosine, z - b * sine - h * cosine
    u_s = float(data.joint("u_s").qpos[0]) if case.frame is not None else math.nan
    down = x - h * sine + math.copysign(b, theta) * (cosine - 1)
    return [t, theta, rate, left, right, u_s, down]


def reactions(case: rwmf.Case, forces: Array, engine: Engine) -> list[float]:
    """Compare base reactions with contact forces, as root mean squares over m_w g."""
    run = rwmf.simulate(case.replace(output={"dt": HISTORY_DT, "reactions": True}))
    own = np.stack([run["pivot_normal_over_m_w_g"], run["pivot_horizontal_over_m_w_g"]], axis=1)
    own, found = _windows(own[:-1], HISTORY_DT), _windows(forces, engine.dt)
    n = min(len(own), len(found))
    middle = (np.arange(n) + 0.5) * WINDOW
    jumps = run["event_time"].values[run["event"].values == "impact"]
    if case.motion.kind == "one_cosine":
        # the pulse begins and ends with a jump, which the engine's contact follows in its own time
        jumps = np.append(jumps, [0.0, 2 * np.pi / float(case.motion.omega_p)])
    far = np.array([np.all(np.abs(jumps - t) > AROUND_JUMPS) for t in middle])
    own, found = own[:n][far], found[:n][far]
    size, difference = (np.sqrt(np.mean(part**2, axis=0)) for part in (own, own - found))
    pressed = found[:, 0] > LEAST_PRESSURE
    demand = [np.max(np.abs(part[pressed, 1]) / part[pressed, 0]) for part in (own, found)]
    return [far.sum(), size[0], difference[0], size[1], difference[1], *demand]


def _windows(rows: Array, dt: float) -> Array:
    """Return means over windows."""
    n = round(WINDOW / dt)
    m = len(rows) // n
    return rows[: m * n].reshape(m, n, -1).mean(axis=1)


if __name__ == "__main__":
    store_cases(__doc__, "mujoco", CASES, _store)
