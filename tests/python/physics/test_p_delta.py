"""Gravity on the displaced frame: closed forms, equilibrium of forces and the end by a collapse.

A massless leaning column carries the weight of m_g = m_g_over_m_s times the mass of each floor, and
is held by the floors. Its part beside storey i carries W_i, the weight at floor i and above. Its
ends are d_i = u_i - u_(i-1) apart over the height h_i. They push the floor above outwards and the
floor below inwards with the force W_i d_i/h_i. The shear of an undamped storey is therefore
k_i d_i - W_i d_i/h_i. The run collapses where an |d_i|/h_i passes the limit.
`test_demands_of_walls.py` follows collapses of frames that yield, alone and beside walls, with
another program.
"""

import json
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import c_host
import numpy as np
import pytest
import rwmf
import xarray as xr
from checkout import ROOT, Runner
from refused import refusals
from scenes import bare_frame, coupled
from scipy.integrate import solve_ivp
from scipy.linalg import eigh, expm
from scipy.optimize import brentq

G = 9.81
METHODS = ("adams", "bdf", "taylor", "dop853")
TIGHT = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-14}
SOLVER = {"rtol": 1e-12, "method": "dop853"}
FORMULATIONS = ("published", "symmetric", "exact")
# two programs: same physics, other numbers
SAME = 1e-8
H, B = 6.0, 1.5
Array = np.ndarray
Event = Callable[[float, Array], float]


@dataclass
class Pulse:
    """Sine waves of ground acceleration."""

    a_max_g: float
    omega: float
    cycles: int = 1

    @property
    def end(self) -> float:
        """Time at which it is over [s]."""
        return self.cycles * 2 * math.pi / self.omega

    def __call__(self, t: float, *, is_over: bool) -> float:
        """Ground acceleration [m/s2]."""
        return 0.0 if is_over else self.a_max_g * G * math.sin(self.omega * t)

    def group(self) -> dict[str, object]:
        """`&motion` of a case."""
        size = {"a_max_g": self.a_max_g, "omega_p": self.omega}
        return {"kind": "sine", "cycles": float(self.cycles)} | size


@dataclass
class Wall:
    """Rigid wall on its corners, with a cable of constant force."""

    h: float = H
    b: float = B
    formulation: str = "exact"
    e: float = 0.9
    eta: float = 0.0

    def __post_init__(self) -> None:
        """Derive the constants of the geometry."""
        self.R, self.alpha = math.hypot(self.h, self.b), math.atan2(self.b, self.h)


@dataclass
class Frame:
    """Shear frame with a leaning column, with or without wall; masses over any one mass.

    ``shape`` is the one displacement that is left to all floors; without it they are free.
    """

    m: Sequence[float]
    k: Sequence[float]
    heights: Sequence[float]
    mu: float
    limit: float = 0.1
    xi: float = 0.05
    u_y: Sequence[float] | None = None
    hardening: float = 0.0
    shape: Sequence[float] | None = None
    wall: Wall | None = None

    def __post_init__(self) -> None:
        """Derive masses and weights."""
        m, k = np.array(self.m), np.array(self.k)
        self.mass, self.stiffness, self.n = m, k, len(m)
        self.push = self.mu * G * np.cumsum(m[::-1])[::-1] / np.array(self.heights)
        last = np.append(np.zeros(self.n - 1), 1.0)
        self.s = last if self.shape is None else np.array(self.shape) / self.shape[-1]
        self.free = 0 if self.shape is not None else self.n - 1
        self.M = self.s @ (m * self.s)


def single(T_s: float, height: float, mu: float, gamma: float = 1.0, **more: object) -> Frame:
    """One degree of freedom."""
    return Frame([gamma], [gamma * (2 * math.pi / T_s) ** 2], [height], mu, **more)


def case_of(frame: Frame, motion: dict[str, object], t_end: float, **more: object) -> rwmf.Case:
    """Make the case of a frame: storeys, or one degree of freedom where it has one floor."""
    coupling = more.pop("coupling", None)
    wall = frame.wall
    column: dict[str, object] = {"m_g_over_m_s": frame.mu, "drift_limit": frame.limit}
    groups: dict[str, Any] = {"motion": motion, "solver": SOLVER | {"t_end": t_end}}
    if coupling:
        groups["frame"] = {"T_s": None, "gamma": None, "xi_s": frame.xi}
        groups["storeys"] = {
            "m_over_m_w": list(frame.m),
            "k_over_m_w": list(frame.k),
            "height": list(frame.heights),
            "coupling": coupling,
        }
    else:
        T_s = 2 * math.pi / math.sqrt(frame.k[0] / frame.m[0])
        column["h_f"] = frame.heights[0]
        groups["frame"] = {"T_s": T_s, "xi_s": frame.xi}
        if wall:
            groups["frame"]["gamma"] = frame.m[0]
    if frame.u_y is not None:
        key = "storey_u_y" if coupling else "u_y"
        groups["yielding"] = {key: list(frame.u_y) if coupling else frame.u_y[0]}
        groups["yielding"]["hardening"] = frame.hardening
    groups["p_delta"] = column
    groups["output"] = {"dt": t_end / 50, "energy": True}
    if not wall:
        return bare_frame(**groups, **more)
    groups["wall"] = {"h": wall.h, "b": wall.b}
    groups["cable"] = {"eta_0": wall.eta, "eta_alpha": wall.eta} if wall.eta else None
    groups["impact"] = {"rule": "constant", "e": wall.e}
    groups["model"] = {"formulation": wall.formulation}
    return coupled(**groups, **more)


def events_of(run: xr.Dataset, kind: str) -> Array:
    """Return the times of the events of a kind [s]."""
    return run["event_time"].to_numpy()[run["event"].to_numpy() == kind]


# (a) one degree of freedom, elastic: closed forms


@pytest.mark.parametrize("xi", [0.0, 0.05])
@pytest.mark.parametrize("Q", [0.01, 0.3, 0.9])
def test_period(Q: float, xi: float) -> None:
    """T_s/sqrt(1 - Q); damped: omega_d^2 = omega_s^2 (1 - Q - xi_s^2), its xi_s without gravity."""
    T_s, h_f, pulse = 0.8, 3.0, Pulse(0.02, 9.0)
    mu = Q * 4 * math.pi**2 * h_f / (G * T_s**2)
    frame = single(T_s, h_f, mu, xi=xi, limit=1.0)
    period = T_s / math.sqrt(1 - Q - xi**2)
    case = case_of(frame, pulse.group(), pulse.end + 12 * period)
    peaks = events_of(rwmf.simulate(case), "peak")
    peaks = peaks[peaks > pulse.end]
    assert peaks.size >= 20
    assert np.diff(peaks) == pytest.approx(period / 2, rel=SAME)
    assert not bool(rwmf.simulate(case)["collapsed"])


@pytest.mark.parametrize("xi", [0.0, 0.05])
@pytest.mark.parametrize("Q", [1.02, 1.5, 4.0])
@pytest.mark.parametrize("method", METHODS)
def test_growth(Q: float, xi: float, method: str) -> None:
    """Q > 1: exponential growth up to the limit, by the exponential of a matrix."""
    T_s, h_f, pulse = 0.8, 3.0, Pulse(0.05, 9.0)
    mu = Q * 4 * math.pi**2 * h_f / (G * T_s**2)
    omega = 2 * math.pi / T_s
    # u, u', sin(omega_p t), cos(omega_p t)
    matrix = np.zeros((4, 4))
    matrix[0, 1] = 1
    matrix[1, :3] = -(omega**2) * (1 - Q), -2 * xi * omega, -pulse.a_max_g * G
    matrix[2, 3], matrix[3, 2] = pulse.omega, -pulse.omega
    after = matrix.copy()
    after[1, 2] = 0

    def u(t: float) -> float:
        state = expm(matrix * min(t, pulse.end)) @ [0, 0, 0, 1]
        return (expm(after * max(0.0, t - pulse.end)) @ state)[0]

    high = next(t for t in np.arange(0.05, 60, 0.05) if abs(u(t)) > 0.1 * h_f)
    t_collapse = brentq(lambda t: abs(u(t)) - 0.1 * h_f, high - 0.05, high, xtol=1e-14)
    case = case_of(single(T_s, h_f, mu, xi=xi), pulse.group(), 60.0)
    rtol = {"rtol": 1e-11 if method in ("adams", "bdf") else 1e-12, "method": method}
    run = rwmf.simulate(case.replace(solver=rtol))
    assert float(run["t_collapse"]) == pytest.approx(t_collapse, rel=SAME)
    assert float(run["u_s_max"]) == pytest.approx(0.1 * h_f, rel=1e-10)
    # a row every 60/50 s
    assert t_collapse - 1.2 <= float(run["time"][-1]) <= t_collapse
    assert np.isfinite(run["u_s"].to_numpy()).all()


@pytest.mark.parametrize(
    ("formulation", "base"),
    [(word, "rocking") for word in (None, *FORMULATIONS)]
    + [("symmetric", "pinned"), ("exact", "pinned")],
)
def test_equals_a_softer_frame(formulation: str | None, base: str) -> None:
    """Q < 1, elastic: the frame of period T_s/sqrt(1 - Q) and the same damper.

    The link transmits forces beside the softer frame, and so does the pivot.
    """
    Q, T_s, h_f = 0.25, 1.1, 4.0
    mu = Q * 4 * math.pi**2 * h_f / (G * T_s**2)
    factor = 1 / math.sqrt(1 - Q)
    make = bare_frame if formulation is None else coupled
    common: dict[str, Any] = {"solver": SOLVER | {"rtol": 1e-11}}
    if formulation:
        common["model"] = {"formulation": formulation}
    same = {"u_s_max": SAME, "t_u_s_max": SAME}
    if formulation in ("symmetric", "exact"):
        common["output"] = {"reactions": True}
        same |= {"base_shear_max_over_weight": 1e-7, "pivot_normal_min_over_m_w_g": 1e-7,
                 "friction_demand_max": 1e-7}  # fmt: skip
    if base == "pinned":
        common |= {"wall": {"base": base}, "cable": None, "impact": None}
    column = {"m_g_over_m_s": mu, "h_f": h_f, "drift_limit": 9.0}
    leaning = rwmf.simulate(make(frame={"T_s": T_s, "xi_s": 0.04}, p_delta=column, **common))
    softer = {"T_s": T_s * factor, "xi_s": 0.04 * factor}
    other = rwmf.simulate(make(frame=softer, **common))
    for key, rel in same.items():
        assert float(leaning[key]) == pytest.approx(float(other[key]), rel=rel), key
    for key in ("impacts", "lift_offs"):
        assert key not in leaning or int(leaning[key]) == int(other[key])


@pytest.mark.parametrize("coupling", [None, "full", "reduced", "every_floor"])
def test_forces(coupling: str | None) -> None:
    """Links and foundation give wall and floors the momentum that they have after the pulse."""
    t, make = 2.9, {"wall": Wall(), "limit": 0.2, "xi": 0.0}
    frame = frame_of(coupling, 5.0, **make) if coupling else single(1.2, 8.0, 4.0, 4.0, **make)
    case = case_of(frame, Pulse(0.35, 4.0).group(), t, coupling=coupling)
    case = case.replace(output={"reactions": True})
    run = rwmf.simulate(case)
    last = {str(name): float(run[name][-1]) for name in run if run[name].dims == ("time",)}
    with c_host.stepping(case.to_namelist()) as host:
        host.advance(t)
        state, link = host.state(), host.forces().link
    below = [float(run[f"floor_{i + 1}"][-1]) for i in range(frame.free)]
    u = np.array([*below, last["u_s"]]) if coupling == "full" else frame.s * last["u_s"]
    shear = (frame.stiffness - frame.push) * np.diff(u, prepend=0.0)
    f = shear - np.append(shear[1:], 0.0)
    momentum = frame.mass * frame.s * state.u_s_ddot
    pulled = {"full": momentum[-1] + f[-1], "every_floor": momentum.sum() + shear[0]}
    expected = pulled.get(str(coupling), frame.M * state.u_s_ddot + frame.s @ f)
    assert link == pytest.approx(expected, rel=1e-6)
    x, side, wall = last["theta"], math.copysign(1, last["theta"]), Wall()
    lift = wall.alpha - side * x
    a = math.cos(lift) * state.theta_ddot + side * math.sin(lift) * state.theta_dot**2
    horizontal = last["pivot_horizontal_over_m_w_g"] * G
    assert horizontal == pytest.approx(wall.R * a + expected, rel=1e-6)
    if coupling == "full":
        momentum[:-1] = -f[:-1]
    weight = (1 + frame.mass.sum()) * G
    base_shear = last["base_shear_over_weight"] * weight
    assert base_shear == pytest.approx(wall.R * a + momentum.sum(), rel=1e-6)


def test_defaults_and_no_weight() -> None:
    """h_f is 2h with a wall, m_g_over_m_s is 1, drift_limit 0.1; without weight nothing changes."""
    given = {"m_g_over_m_s": 1.0, "h_f": 4.0, "drift_limit": 0.1}
    motion = {"a_max_g": 0.2}
    short = rwmf.simulate(coupled(p_delta={}, motion=motion))
    long = rwmf.simulate(coupled(p_delta=given, motion=motion))
    assert float(short["u_s_max"]) == float(long["u_s_max"])
    light = rwmf.simulate(coupled(p_delta={"m_g_over_m_s": 0.0, "drift_limit": 9.0}))
    assert float(light["u_s_max"]) == pytest.approx(
        float(rwmf.simulate(coupled())["u_s_max"]), rel=1e-9
    )


# (b) one degree of freedom that yields


def test_smooth_hysteresis() -> None:
    """Bouc and Wen, n = 2: u'' = -2 xi w u' - w^2 (a u + (1 - a) u_y z) + kappa u - u_g''.

    Each piece between two changes of the signs of u' and z is integrated by itself.
    """
    T_s, h_f, u_y, a, pulse = 0.9, 3.0, 0.03, 0.02, Pulse(0.3, 8.0, 4)
    w, kappa = 2 * math.pi / T_s, 2 * G / h_f
    t, y = 0.0, np.array([0.0, -1e-300, 0.0])
    collapsed = False
    while not collapsed:
        over = t >= pulse.end

        def rates(t: float, y: Array, sign: float, over: bool = over) -> list[float]:
            kept = 1 - y[2] ** 2 * (1 + sign) / 2
            force = w**2 * (a * y[0] + (1 - a) * u_y * y[2]) - kappa * y[0]
            damper = 2 * 0.05 * w * y[1]
            return [y[1], -damper - force - pulse(t, is_over=over), y[1] / u_y * kept]

        slow: Event = lambda _t, y: y[1]  # noqa: E731
        zero: Event = lambda _t, y: y[2]  # noqa: E731
        limit: Event = lambda _t, y: 0.1 - abs(y[0]) / h_f  # noqa: E731
        for event in (slow, zero, limit):
            event.terminal = True  # type: ignore[attr-defined]
        # leave an event before it is looked for again: a Taylor step of 1e-9 s is exact
        first = rates(t, y, 1.0)
        goes = y[1] if abs(y[1]) > 1e-14 else first[1]
        leans = y[2] if abs(y[2]) > 1e-14 else goes
        sign = math.copysign(1, goes * leans)
        y, t = y + 1e-9 * np.array(rates(t, y, sign)), t + 1e-9
        piece = solve_ivp(
            lambda t, y, s=sign: rates(t, y, s), (t, 20.0 if over else pulse.end), y,
            events=[slow, zero, limit], max_step=0.02, **TIGHT,
        )  # fmt: skip
        t, y = float(piece.t[-1]), piece.y[:, -1].copy()
        collapsed = piece.t_events[2].size > 0
        assert t < 20
    column = {"m_g_over_m_s": 2.0, "h_f": h_f}
    law = {"u_y": u_y, "hardening": a, "law": "bouc_wen", "exponent": 2.0, "beta": 0.5}
    run = rwmf.simulate(
        bare_frame(
            frame={"T_s": T_s}, p_delta=column, yielding=law, motion=pulse.group(),
            solver=SOLVER | {"t_end": 20.0},
        )
    )  # fmt: skip
    assert float(run["t_collapse"]) == pytest.approx(t, rel=1e-7)


# (c) beside a wall


def test_uplift_does_not_change() -> None:
    """At theta = 0 the column of a single degree of freedom is vertical."""
    for factor, lifts in ((1 - 1e-9, 0), (1 + 1e-6, 1)):
        threshold = 0.25 * 2 / (1 + 2 * 5) * factor
        motion = {"kind": "one_sine", "a_max_g": threshold, "omega_p": 6.0}
        heavy = {"m_g_over_m_s": 5.0}
        run = rwmf.simulate(coupled(motion=motion, p_delta=heavy, solver={"t_end": 0.5}))
        assert int(run["lift_offs"]) == lifts


def test_vertical_motion_does_not_act_on_it() -> None:
    """The wall feels it; the leaning column of a bare frame, that of a resting wall do not."""
    column = {"m_g_over_m_s": 2.0, "h_f": 4.0}
    still = rwmf.simulate(bare_frame(p_delta=column))
    assert float(still["u_s_max"]) > 0
    common = {"wall": {"base": "pinned"}, "cable": None, "impact": None}
    # a hinged wall of no height to speak of: v_g'' has nothing to act on but the column
    light = common | {"frame": {"gamma": 1e6}, "motion": {"a_max_g": 0.05}}
    moved = rwmf.simulate(coupled(**light, p_delta=column, vertical={"ratio": 1.0}))
    same = rwmf.simulate(coupled(**light, p_delta=column))
    assert float(moved["u_s_max"]) == pytest.approx(float(same["u_s_max"]), rel=1e-5)


# (d) storeys


STOREYS = ([2.0, 2.0, 1.5], [700.0, 600.0, 400.0])


def shape_of(coupling: str, m: Sequence[float], k: Sequence[float]) -> list[float] | None:
    """Displacement that a coupling leaves to floors of equal heights."""
    n = len(m)
    if coupling == "full":
        return None
    if coupling == "every_floor":
        return [(i + 1) / n for i in range(n)]
    stiffness = np.diag(np.array(k) + np.append(k[1:], 0.0))
    stiffness -= np.diag(k[1:], 1) + np.diag(k[1:], -1)
    first = eigh(stiffness, np.diag(m))[1][:, 0]
    return list(first / first[-1])


def frame_of(
    coupling: str,
    mu: float,
    m: Sequence[float] = STOREYS[0],
    k: Sequence[float] = STOREYS[1],
    **more: object,
) -> Frame:
    """Storeys of equal heights that make up a wall of 2 H."""
    heights = [2 * H / len(m)] * len(m)
    return Frame(m, k, heights, mu, shape=shape_of(coupling, m, k), **more)


# drifts that pass their limit inside a step


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("rtol", [1e-3, 1e-6, 1e-10])
@pytest.mark.parametrize("coupling", [None, "full"])
def test_peaks_inside_a_step(coupling: str | None, rtol: float, method: str) -> None:
    """A limit just below a peak is passed there, one just above is not, whatever the steps."""
    pulse = Pulse(0.1, 4.0)
    frame = frame_of("full", 3.0, limit=9.0) if coupling else single(0.7, 3.0, 1.0, limit=9.0)
    solver = {"rtol": rtol, "method": method}
    case = case_of(frame, pulse.group(), 4.0, coupling=coupling).replace(solver=solver)
    run = rwmf.simulate(case.replace(output={"dt": 1e-4}))
    names = [f"storey_{i + 1}_drift" for i in range(frame.n)] if coupling else ["u_s"]
    drifts = np.max([abs(run[name].to_numpy()) for name in names], axis=0)
    if not coupling:
        drifts = drifts / 3.0
    largest, first = drifts.max(), float(run["time"][int(drifts.argmax())])
    # the size of the response sets the tolerance, in a run that ends early too
    for factor, falls in ((1 - 1e-5, True), (1 + 1e-5, False)):
        limited = rwmf.simulate(case.replace(p_delta={"drift_limit": largest * factor}))
        assert bool(limited["collapsed"]) == falls
        if falls:
            assert float(limited["t_collapse"]) <= first
            assert float(limited["t_collapse"]) == pytest.approx(first, abs=5e-3)


# the reported quantities


def collapsing() -> rwmf.Case:
    """Return the case of a yielding frame that collapses."""
    frame = single(0.9, 3.0, 2.0, u_y=[0.03])
    return case_of(frame, Pulse(0.2, 8.0, 4).group(), 6.0)


def test_shipped_case(elcentro: Path) -> None:
    """The frame collapses under its weight, and a wall prevents it, as the first comment states."""
    case = rwmf.Case.from_namelist(ROOT / "inputs" / "p_delta_collapse.nml")
    case = case.replace(motion={"file": str(elcentro)})
    alone = rwmf.simulate(case)
    assert float(alone["t_collapse"]) == pytest.approx(11.277, abs=2e-3)
    assert float(alone["u_s_max"]) == pytest.approx(0.8, rel=1e-9)
    assert float(rwmf.simulate(case.replace(p_delta=None))["u_s_max"]) < 0.145
    beside = rwmf.simulate(
        case.replace(
            frame={"gamma": 5.0}, p_delta={"h_f": None}, wall={"h": 4.0, "b": 1.0},
            cable={"eta_0": 2.0, "eta_alpha": 5.0}, impact={"rule": "coupled"},
        )
    )  # fmt: skip
    assert not bool(beside["collapsed"])
    assert float(beside["u_s_max"]) < 0.1


def test_keys_apply_only_with_the_effect() -> None:
    plain = rwmf.simulate(bare_frame())
    assert "collapsed" not in plain
    assert "t_collapse" not in plain
    stands = rwmf.simulate(bare_frame(p_delta={"h_f": 30.0}))
    assert not bool(stands["collapsed"])
    assert "t_collapse" not in stands


def test_command_line(command: Runner, tmp_path: Path) -> None:
    """Collapse is a result, not an error: exit status 0; the summary gives the time."""
    file = tmp_path / "case.nml"
    file.write_text(collapsing().to_namelist(), encoding="utf-8")
    done = command("run", file, "--json")
    assert done.returncode == 0
    found = json.loads(done.stdout)
    assert found["collapsed"] is True
    assert found["t_collapse_s"] == float(rwmf.simulate(collapsing())["t_collapse"])
    assert "p_delta" in found["effects"]


def test_spectrum_and_sweep() -> None:
    """The status of each ordinate, and its peak up to the collapse."""
    T_s = [0.4, 0.9, 1.5]
    case = collapsing()
    spectrum = rwmf.spectrum(case.replace(output=None, spectrum={"T_s": T_s}))
    for i, period in enumerate(T_s):
        run = rwmf.simulate(case.replace(frame={"T_s": period}))
        status = "collapsed" if bool(run["collapsed"]) else "ok"
        assert str(spectrum["status"].values.ravel()[i]) == status
        assert float(spectrum["u_s_max"].values.ravel()[i]) == pytest.approx(
            float(run["u_s_max"]), rel=1e-9
        )
    assert "collapsed" in spectrum["status"].values
    for quantities in (("u_s_max",), ("u_s_max", "ductility")):
        swept = rwmf.sweep(case.replace(output=None), {"T_s": T_s}, quantities=quantities)
        names = swept["status"].attrs["flag_meanings"].split()
        assert [names[i] for i in swept["status"].values] == list(spectrum["status"].values.ravel())


def test_step_back_from_a_collapse() -> None:
    """A host that takes back the step in which the frame collapses can take it again."""
    case = collapsing().replace(output=None)
    t = float(rwmf.simulate(case)["t_collapse"])
    ends = []
    with c_host.stepping(case.to_namelist()) as host:
        host.advance(t - 0.1)
        host.save()
        for _ in range(2):
            host.restore()
            assert host.state().t == t - 0.1
            host.advance(t + 0.1)
            ends.append((host.state().t, host.state().u_s))
            host.advance(t + 0.2)
            assert (host.state().t, host.state().u_s) == ends[-1]
    assert ends[0] == ends[1]
    assert ends[0] == pytest.approx((t, math.copysign(0.3, ends[0][1])), rel=1e-9)


def test_studies_count_a_collapse_as_failure() -> None:
    from rwmf.assess.table import with_overturning

    case = collapsing().replace(output=None)
    swept = rwmf.sweep(case, {"T_s": [0.2, 0.9]}, quantities=("u_s_max",))
    values = with_overturning(swept).values.ravel()
    assert np.isfinite(values[0])
    assert np.isinf(values[1])


test_refusals = refusals(
    lambda groups: rwmf.simulate(bare_frame(**groups)),
    ({"p_delta": {}}, "h_f"),
    ({"p_delta": {"h_f": 3.0, "drift_limit": 0.0}}, "drift_limit"),
    ({"p_delta": {"h_f": 3.0, "m_g_over_m_s": -1.0}}, "m_g_over_m_s"),
    ({"p_delta": {"h_f": -3.0}}, "h_f"),
)


def test_storeys_have_their_heights() -> None:
    frame = frame_of("full", 1.0)
    case = case_of(frame, Pulse(0.1, 4.0).group(), 1.0, coupling="full")
    with pytest.raises(rwmf.InputError, match="h_f"):
        rwmf.simulate(case.replace(p_delta={"h_f": 3.0}))
