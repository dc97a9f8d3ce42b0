"""Support of every effect by every interface of the program.

    .venv/bin/python tests/support/matrix.py > docs/reference/matrix.md

A row is a scene: each entry of ``EFFECTS`` in ``bench/pairs.py`` with a wall and, where such a case
exists, without one. A column is a path: a function that uses one interface of the program and
compares the results with the plain run. ``REFUSALS`` lists refusals with reasons.
``test_matrix.py`` runs all cells, and requires a row for every effect of the kernel.
"""

import contextlib
import io
import json
import math
import re
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import c_host
import numpy as np
import rwmf
import xarray as xr
from checkout import BATCH, ROOT
from rwmf import cli, studies
from rwmf.assess.studies import SURVIVES
from rwmf.case.namelist import compose
from rwmf.motion.record_sets import RecordFile, find_records
from rwmf.run import simulation
from rwmf.run.quantities import ending_of, find
from scenes import read_table

sys.path.append(str(ROOT / "bench"))

import pairs

RTOL = 1e-8
# two methods, or one that starts anew at other instants, agree to the tolerance; errors add up
# over impacts
AGREEMENT = 100 * RTOL
# the same force from the same state, by two formulas
ROUND_OFF = 1e-9
# work of a load by cubics over 50 steps, with smooth springs
WORK = 1e-5
_SOLVER = {"method": "dop853", "rtol": RTOL}
_G = 9.81
_ALONE, _BLOCK = "frame alone", "block"


_INTRODUCTION = """\
# Effects and interfaces

For users who combine an effect with a command or an interface: the table shows where each effect
works. Each row is a small case with a wall, without a frame ("block") or without a wall ("frame
alone"); [effects.md](effects.md) lists the pairs of effects. `+` means that the results equal those
of the plain run: bitwise with the same method (`dop853`, rtol = 1e-8), else to 100 rtol, and to
1e-9 of the weight for the forces of an element or a member. A letter means that the program
refuses the case with the message below. `tests/support/matrix.py` makes this page; a test computes
every cell.
"""


class Scene:
    """One row: a case and its plain run.

    Parameters
    ----------
    groups : mapping
        Groups of the case, from `ROWS`.
    folder : Path
        Folder of its record (`pairs.prepare`).
    """

    def __init__(self, groups: Mapping[str, Any], folder: Path) -> None:
        self.groups = {group: dict(keys) for group, keys in groups.items()}
        self.groups["solver"] |= _SOLVER
        if "base" in groups:
            self.groups["solver"] |= {"method": "taylor"}
        self.groups["output"] |= {"dt": 0.05}
        if "frame" not in self.groups and self.groups["wall"].get("base") == "pinned":
            # before it lies on its side, at 1.9 s
            self.groups["solver"] |= {"t_end": 1.5}
        self.folder = folder

    @cached_property
    def case(self) -> rwmf.Case:
        """The case; the kernel reads it from the text of a file."""
        return rwmf.Case.from_text(compose(self.groups), self.folder / "scene.nml")

    @cached_property
    def recorded(self) -> rwmf.Case:
        """The case under the record of the suite, to its last sample."""
        gone = dict.fromkeys(self.groups.get("motion", {}))
        motion = gone | self.suite[0].motion()
        return self.case.replace(motion=motion, solver={"t_end": None})

    @cached_property
    def suite(self) -> tuple[RecordFile, ...]:
        """A suite of one record."""
        return find_records([self.folder / "record.csv"], unit="g")

    @cached_property
    def plain(self) -> dict[str, Any]:
        """Scalars of the plain run."""
        return scalars(self.case)

    @cached_property
    def plain_recorded(self) -> dict[str, Any]:
        """Scalars of the plain run under the record."""
        return scalars(self.recorded)

    @property
    def has_frame(self) -> bool:
        """Say whether there is a frame, whose displacement is reported."""
        return "frame" in self.groups

    @property
    def peak(self) -> tuple[str, str]:
        """Return key and name of the quantity for a study of the scene."""
        if self.has_frame:
            return "u_s_max_m", "u_s_max"
        return "theta_max_over_alpha", "theta_max_over_alpha"

    @property
    def grid(self) -> dict[str, list[float]]:
        """Grid of a sweep whose only point is the case."""
        axes = self.case.kernel.axes()
        return {"T_s": [axes["T_s"].value]} if "T_s" in axes else {}

    def write(self, folder: Path) -> Path:
        """Write the namelist into another folder."""
        path = folder / "scene.nml"
        self.case.to_namelist(path)
        return path

    def ground(self) -> tuple[list[float], Callable[[float], float]]:
        """Knots [s] and acceleration [m/s2] of the motion, computed like a host."""
        motion = self.case.motion
        if motion is None:
            return [0.0], lambda _: 0.0
        if motion.kind == "record":
            t, a = samples()
            return t, lambda at: float(np.interp(at, t, a))
        end = 2 * math.pi / motion.omega_p
        a_max = motion.a_max_g * _G

        def pulse(at: float) -> float:
            return a_max * math.sin(motion.omega_p * at) if at <= end else 0.0

        return [0.0, end], pulse


def samples() -> tuple[list[float], list[float]]:
    """Return times [s] and accelerations [m/s2] of the record."""
    rows = [line.split(",") for line in pairs.SAMPLES.splitlines()]
    return [float(t) for t, _ in rows], [_G * float(a) for _, a in rows]


def scalars(case: rwmf.Case) -> dict[str, Any]:
    """Run a case; return its scalars by key."""
    with simulation.start(case) as run:
        return run.summary()


def _rows() -> dict[str, dict[str, Any]]:
    """Make the groups of every row: effects with wall and frame, then those that go without one.

    Whether two effects go together at all is the table of docs/reference/effects.md.
    """
    effects = dict(pairs.EFFECTS)
    no_wall, no_frame = effects.pop("no wall"), effects.pop("no frame")
    found = {"wall and frame": pairs.joined()}
    found |= {name: pairs.joined(effect) for name, effect in effects.items()}
    with tempfile.TemporaryDirectory() as place:
        pairs.prepare(Path(place))
        for rest, gone in ((_BLOCK, no_frame), (_ALONE, no_wall)):
            found[rest] = pairs.joined(gone)
            for name, effect in effects.items():
                groups = pairs.joined(gone, effect)
                with contextlib.suppress(rwmf.InputError):
                    if groups is not None and Scene(groups, Path(place)).case:
                        found[f"{rest}, {name}"] = groups
    return {name: groups or {} for name, groups in found.items()}


ROWS = _rows()


def _same(found: object, expected: object) -> None:
    """Compare bits; a missing value must be missing on both sides."""
    assert np.array_equal(np.ravel(found), np.ravel(expected), equal_nan=True), (found, expected)


def _close(found: object, expected: object) -> None:
    np.testing.assert_allclose(np.ravel(found), np.ravel(expected), rtol=AGREEMENT)


# --- the paths: each raises InputError where the program refuses, AssertionError where it is wrong


def run_simulate(scene: Scene, _: Path) -> None:
    """`rwmf.simulate`, with history, reactions and energy."""
    found = rwmf.simulate(scene.case)
    for key, value in scene.plain.items():
        for name in find(key).names("run") or (None,):
            own = found[name].item() if name else found.attrs[key]
            _same_scalar(key, own.splitlines() if key == "warnings" else own, value)
    assert all(np.isfinite(column).all() for column in found.values() if column.dims == ("time",))
    if scene.case.model.formulation != "published" or "wall" not in scene.groups:
        assert abs(scene.plain["energy_balance_relative"]) < pairs.BALANCE


def _same_scalar(key: str, found: object, expected: object) -> None:
    if key != "seconds":
        assert found == expected, key


def run_json(scene: Scene, folder: Path) -> None:
    """`rwmf run --json`."""
    shown = json.loads(_command("run", scene.write(folder), "--json"))
    assert list(shown) == list(scene.plain)
    for key, value in scene.plain.items():
        if key == "warnings":
            # a warning about a record names its file, here in another folder
            value, shown[key] = (_without_folders(lines) for lines in (value, shown[key]))
        _same_scalar(key, shown[key], value)


def _without_folders(lines: list[str]) -> list[str]:
    return [re.sub(r"\S*/", "", line) for line in lines]


def _command(*words: str | Path) -> str:
    """Run the command rwmf in this process, and raise its message as an error."""
    output, errors = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(output), contextlib.redirect_stderr(errors):
        status = cli.main([str(word) for word in words])
    if status != 0:
        raise rwmf.InputError(errors.getvalue().removeprefix("rwmf: "))
    return output.getvalue()


def run_check(scene: Scene, folder: Path) -> None:
    """`rwmf check`: effects and outputs of the run."""
    lines = _command("check", scene.write(folder)).splitlines()
    shown = dict(line.split(": ", 1) for line in lines[:7])
    assert shown["effects"].split(", ") == scene.plain["effects"]
    # the instant that `check` computes has no peaks to compare
    keys = {key for key in scene.plain if not key.startswith("sensitivity_")}
    assert keys <= set(shown["outputs"].split(", "))


def run_batch(scene: Scene, folder: Path) -> None:
    """`rwmf-batch`: CSV of summary and history."""
    path = scene.write(folder)
    done = subprocess.run([BATCH, path], cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise rwmf.InputError(done.stderr)
    _, (row,) = read_table(path.with_suffix(".summary.csv"))
    for key, text in row.items():
        value = scene.plain[key]
        if isinstance(value, float) and key != "seconds":
            _same(float(text), value)
    _, history = read_table(path.with_suffix(".history.csv"))
    names, values = _history(path)
    assert list(history[0]) == names
    _same([[float(line[name]) for line in history] for name in names], values)


def _history(path: Path) -> tuple[list[str], Any]:
    with simulation.start(rwmf.Case.from_namelist(path)) as run:
        names, values = run.history()
        return names, values.copy()


def run_spectrum(scene: Scene, _: Path) -> None:
    """`rwmf.spectrum` with the method of the run."""
    key, name = scene.peak
    found = rwmf.spectrum(scene.case, scene.grid.get("T_s", [1.0]))
    _same(found[name], scene.plain[key])


def run_auto_spectrum(scene: Scene, _: Path) -> None:
    """`rwmf.spectrum` with its default method, `auto`."""
    case = scene.case.replace(solver={"method": None})
    key, name = scene.peak
    found = rwmf.spectrum(case, scene.grid.get("T_s", [1.0]))
    _close(found[name], scene.plain[key])


def run_sweep(scene: Scene, _: Path) -> None:
    """Run `rwmf.sweep` with its default quantity, then with every named scalar."""
    rows = [find(key) for key in scene.plain]
    names = [row.name for row in rows if row.name and "ordinate" in row.outputs.split()]
    _check_sweep(scene, rwmf.sweep(scene.case, scene.grid), [scene.peak[1]])
    _check_sweep(scene, rwmf.sweep(scene.case, scene.grid, quantities=names), names)


def run_netcdf(scene: Scene, folder: Path) -> None:
    """`rwmf.sweep` with a NetCDF file, read again."""
    wanted = [scene.peak[1], "base_shear_max_over_weight"]
    path = folder / "sweep.nc"
    with rwmf.sweep(scene.case, scene.grid, file=path, quantities=wanted) as found:
        _check_sweep(scene, found, wanted)


def run_points(scene: Scene, _: Path) -> None:
    """`rwmf.sweep` with points: the second of two rows."""
    axes = scene.case.kernel.axes()
    own = {name: axis.value for name, axis in axes.items()}
    points = {name: [1.1 * value, value] for name, value in own.items()}
    found = rwmf.sweep(scene.case, points=points)
    _check_sweep(scene, found.isel(point=[1]), [scene.peak[1]])


def _check_sweep(scene: Scene, found: xr.Dataset, wanted: list[str]) -> None:
    states = found["status"].attrs["flag_meanings"].split()
    assert states[int(found["status"].squeeze())] == "ok"
    plain = {find(key).name: value for key, value in scene.plain.items()}
    for name in wanted:
        _same(found[name], float(plain[name]))


def study_overturning(scene: Scene, _: Path) -> None:
    """`studies.overturning_map`."""
    # one pulse below and one above overturning; no bisection
    levels, omega = [1.5, 6.0], 4.0
    quiet = scene.case.replace(output=None)
    found = studies.overturning_map(quiet, [omega], levels, tolerance=10.0)
    p = float(found["p"])
    T_p = 2 * math.pi / (omega * p)
    for level, outcome in zip(levels, found["outcome"].values[0], strict=True):
        motion = {"a_max_g": level * float(found["alpha"]), "omega_p": None, "T_p": T_p}
        run = scalars(quiet.replace(motion=motion, solver={"t_end": T_p + 25 / p}))
        assert outcome == (SURVIVES if ending_of(run) == "ok" else run.get("impacts", 0))


def levels_of_intensity(scene: Scene, _: Path) -> None:
    """`rwmf.sweep` at a level of intensity."""
    key, name = scene.peak
    found = rwmf.sweep(
        scene.case,
        {"scale": [0.5]},
        scene.suite,
        quantities=name,
        intensity="pseudo_acceleration" if scene.has_frame else "peak_acceleration",
    )
    intensity = max(map(abs, samples()[1])) / _G
    if scene.has_frame:
        # a linear oscillator with the first period
        (T_s,) = scene.grid["T_s"]
        kept = ("frame", "motion", "model", "solver")
        gone = dict.fromkeys(group for group in scene.recorded.groups if group not in kept)
        alone = scene.recorded.replace(**gone, frame={"T_s": T_s, "gamma": None})
        intensity = (2 * math.pi / T_s) ** 2 * scalars(alone)["u_s_max_m"] / _G
    # the factor of the record is exact, that of the run above has its tolerance
    factor = float(str(found["record_format"].values[0]).rpartition("times ")[2])
    assert math.isclose(factor, 1.0 / intensity, rel_tol=1e-2)
    case = scene.recorded.replace(motion={"scale": factor * 0.5})
    _same(found[name], scalars(case)[key])


def study_wall_effect(scene: Scene, _: Path) -> None:
    """`studies.wall_effect`."""
    found = studies.wall_effect(scene.case, scene.grid, scene.suite)
    alone = scalars(scene.recorded.without_wall())["u_s_max_m"]
    if scene.case.storeys is not None and scene.case.storeys.coupling == "every_floor":
        # the period that the floors have by themselves comes back to round-off
        np.testing.assert_allclose(found["u_s_max_alone"].squeeze(), alone, rtol=ROUND_OFF)
        alone = found["u_s_max_alone"].values
    _same(found["u_s_max_alone"], alone)
    _same(found["ratio"], scene.plain_recorded["u_s_max_m"] / alone)


def study_equal_response(scene: Scene, _: Path) -> None:
    """`studies.equal_response`."""
    # a tolerance that the climb meets: no bisection
    T_p, target = 0.8, 0.01
    quiet = scene.case.replace(output=None)
    found = studies.equal_response(quiet, [T_p], target, tolerance=0.5)
    amplitude = float(found["a_max_g"].squeeze())

    def response(a_max_g: float) -> float:
        motion = {"a_max_g": a_max_g, "omega_p": None, "T_p": T_p}
        t_end = T_p + 10 * scene.grid["T_s"][0]
        run = scalars(quiet.replace(motion=motion, solver={"t_end": t_end}))
        return math.inf if run.get("overturned") else run[scene.peak[0]]

    assert target <= response(amplitude)
    assert amplitude <= 1e-4 or response(amplitude / 1.25) < target


def step_own(scene: Scene, _: Path) -> None:
    """Advance a wall under the motion of its case and repeat a step."""
    knots, _ = scene.ground()
    with c_host.stepping(scene.case.to_namelist()) as wall:
        wall.advance(knots[-1])
        wall.save()
        wall.advance(knots[-1] + 0.3)
        wall.restore()
        wall.advance(scene.case.solver.t_end)
        _same_end(wall.state(), scene.case)


def _same_end(state: c_host.State, case: rwmf.Case) -> None:
    """Compare with the maxima, the counts and the last row of a run."""
    with simulation.start(case) as run:
        names, values = run.history()
        plain = run.summary()
        # the last row of a wall that overturned is before its end
        if values[names.index("t_s"), -1] == case.solver.t_end:
            plain |= dict(zip(names, values[:, -1].tolist(), strict=True))
    for key, value in {
        "u_s_max_m": state.u_s_max,
        "impacts": state.impacts,
        "lift_offs": state.lift_offs,
        "theta_rad": state.theta,
        "theta_dot_rad_s": state.theta_dot,
        "u_s_m": state.u_s,
        "u_s_dot_m_s": state.u_s_dot,
    }.items():
        if key in plain:
            _same(value, plain[key])


def step_samples(scene: Scene, _: Path) -> None:
    """Advance a wall under samples of a host program."""
    t, a = samples()
    peak = max(map(abs, a))
    with c_host.stepping(scene.case.to_namelist(), peak) as wall:
        for i in range(len(t) - 1):
            wall.advance_samples(t[i : i + 2], a[i : i + 2])
        _same_end(wall.state(), scene.recorded)


def step_ground(scene: Scene, _: Path) -> None:
    """Advance a wall under a function of a host program."""
    knots, ground = scene.ground()
    t_end = scene.case.solver.t_end
    with c_host.stepping(scene.case.to_namelist()) as wall:
        for t in [*(knot for knot in knots if 0 < knot < t_end), t_end]:
            wall.advance_ground(t, ground)
        state = wall.state()
    if scene.has_frame:
        _close(state.u_s_max, scene.plain["u_s_max_m"])
    if (size := scene.case.wall) is not None:
        alpha = math.atan2(size.b, size.h)
        _close(state.theta_max, scene.plain["theta_max_over_alpha"] * alpha)


def run_element(scene: Scene, _: Path) -> None:
    """Force of the element and of the link of a stepping wall."""
    text = scene.case.to_namelist()
    knots, ground = scene.ground()
    changes: dict[str, Any] = {}
    if not scene.has_frame:
        # without mass: it only defines the motion of the wall's top
        changes["frame"] = {"gamma": 0.0, "T_s": 0.5, "xi_s": 0.0}
    if len(knots) == 1 or (not scene.has_frame and scene.case.cable is not None):
        # peak of the quantity for the motion of the ground alone
        changes["initial"] = {"theta_over_alpha": 0.2}
    c_host.respond(text, 1, [0.1, 0.0, 0.0, 0.0])
    with c_host.stepping(scene.case.replace(**changes).to_namelist()) as wall:
        for t in (0.3, 0.45, 0.9):
            wall.advance(t)
            state = wall.state()
            assert not state.at_rest
            side = -1 if state.theta < 0 and scene.case.wall.base == "rocking" else 1
            motion = [state.u_s, state.u_s_dot, state.u_s_ddot, ground(t)]
            found = c_host.respond(text, side, motion)
            assert abs(found.force + wall.forces().link) <= ROUND_OFF * _G


def run_member(scene: Scene, _: Path) -> None:
    """Compare the forces of a member with those of the links of a stepping wall."""
    text = scene.case.to_namelist()
    changes: dict[str, Any] = {"initial": {"theta_over_alpha": 0.2}}
    if not scene.has_frame:
        changes["frame"] = {"gamma": 0.0, "T_s": 0.5, "xi_s": 0.0}
    if "storeys" in scene.groups and scene.groups.get("yielding", {}).get("law") == "bouc_wen":
        # smooth storeys start at rest; the frame has no effect on the member
        changes["yielding"] = None
    with c_host.member(text) as member:
        started = scene.case.replace(**changes).to_namelist()
        with c_host.stepping(started) as wall:
            if member.info().side == 0:
                member.place(1)
            if member.info().dofs > 1 or member.info().links > 1:
                _compare_start(scene, wall, member)
            else:
                _compare_path(scene, wall, member)


def _accelerations(scene: Scene, t: float) -> list[float]:
    """Horizontal acceleration of the ground, and its vertical record [m/s2]."""
    vertical = scene.groups.get("vertical", {})
    return [scene.ground()[1](t), float(np.interp(t, *samples())) if "file" in vertical else 0.0]


def _compare_path(scene: Scene, wall: c_host.Wall, member: c_host.Member) -> None:
    """Follow the wall through its peaks and impacts; compare the force of its link."""
    turns = {c_host.IMPACT}
    if {"fuse", "cable", "coupling", "restraint"} & scene.groups.keys():
        turns.add(c_host.PEAK)
    state = wall.state()
    member.respond([state.u_s, 0.0, 0.0], [0.0, 0.0])
    member.commit()
    present = last = 0.0
    for goal in (0.001, 0.3, 0.45, 0.9):
        while present < goal:
            wall.save()
            wall.advance(goal)
            # not the last event again, which a restart may locate some round-off later
            later = (e for e in wall.events() if e.kind in turns and e.t > last + 1e-9)
            turn = next(later, None)
            wall.restore()
            if turn is not None:
                last = turn.t
            present = goal if turn is None else turn.t
            wall.advance(present)
            state = wall.state()
            motion = [state.u_s, state.u_s_dot, state.u_s_ddot]
            hits = turn is not None and turn.kind == c_host.IMPACT
            force, _ = member.respond([0.0] * 3 if hits else motion, _accelerations(scene, present))
            member.commit()
            if hits:
                member.place(-member.info().side)
        assert not state.at_rest
        assert abs(force[0] + wall.forces().link) <= ROUND_OFF * _G


def _compare_start(scene: Scene, wall: c_host.Wall, member: c_host.Member) -> None:
    """Solve for the accelerations of frame and member at the start; compare with the wall."""
    state = wall.state()
    n = member.info().dofs
    motion = np.zeros((3, n))
    motion[0, 0] = state.u_s
    ground = _accelerations(scene, 0.0)
    force, tangents = member.respond(motion.ravel().tolist(), ground)
    links, slopes = (np.array(found) for found in member.links(motion.ravel().tolist()))
    if member.info().floors:
        # floors at rest have no force yet but that of the springs
        pulls = -np.array(force[-member.info().floors :])
        assert abs(pulls.sum() - wall.forces().link) <= ROUND_OFF * _G
        wall_dofs = n - member.info().floors
        mass, rest = np.array(tangents[2])[:wall_dofs, :wall_dofs], np.array(force[:wall_dofs])
        roof = np.ones(wall_dofs)
    else:
        floors, shears = _frame(scene, links[0])
        mass = np.array(tangents[2]) + slopes.T @ np.diag(floors) @ slopes
        rest = force + slopes.T @ (floors * ground[0] + shears)
        roof = slopes[-1]
    assert abs(roof @ np.linalg.solve(mass, -rest) - state.u_s_ddot) <= ROUND_OFF * _G


def _frame(scene: Scene, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Masses of the floors and resisting forces of the frame, over the mass of the wall."""
    storeys = scene.groups.get("storeys")
    if storeys is None:
        frame = scene.groups.get("frame", {"gamma": 0.0, "T_s": 1.0})
        mass = np.array([frame["gamma"]])
        return mass, mass * (2 * math.pi / frame["T_s"]) ** 2 * u
    drifts = np.diff(u, prepend=0.0)
    if "yielding" in scene.groups:
        limits = np.array(scene.groups["yielding"]["storey_u_y"])
        drifts = np.clip(drifts, -limits, limits)
    shears = np.array(storeys["k_over_m_w"]) * drifts
    return np.array(storeys["m_over_m_w"]), shears - np.append(shears[1:], 0.0)


def run_c(scene: Scene, _: Path) -> None:
    """`rwmf_run` of the C interface."""
    found, plain = c_host.run(scene.case.to_namelist()), scene.plain
    for key, value in {
        "u_s_max_m": found.u_s_max,
        "theta_dot_max_rad_s": found.theta_dot_max,
        "cable_force_increment_max_over_m_w_g": found.cable_increment_max,
        "impacts": found.impacts,
        "lift_offs": found.lift_offs,
        "overturned": bool(found.overturned),
        "steps": found.steps,
    }.items():
        if key in plain:
            _same(value, plain[key])


def run_pushover(scene: Scene, _: Path) -> None:
    """`rwmf.pushover` there and back: the work is stored, dissipated and released."""
    curve = rwmf.pushover(scene.case, (0.008, -0.004), steps=50)
    assert all(np.isfinite(curve[name]).all() for name in ("roof_drift", "base_shear_over_weight"))
    if scene.case.model.formulation == "published" and "wall" in scene.groups:
        return
    held = sum(curve[f"energy_{part}"] for part in ("stored", "hysteretic", "released"))
    work = curve["energy_work"]
    assert float(abs(work - (held - held[0])).max()) < WORK * float(abs(work).max())


PATHS: dict[str, Callable[[Scene, Path], None]] = {
    "run": run_simulate,
    "run, JSON": run_json,
    "batch, CSV": run_batch,
    "check": run_check,
    "run, C": run_c,
    "spectrum": run_spectrum,
    "spectrum, auto": run_auto_spectrum,
    "sweep": run_sweep,
    "sweep, points": run_points,
    "sweep, NetCDF": run_netcdf,
    "overturning": study_overturning,
    "levels": levels_of_intensity,
    "wall effect": study_wall_effect,
    "equal response": study_equal_response,
    "stepping": step_own,
    "stepping, samples": step_samples,
    "stepping, function": step_ground,
    "element": run_element,
    "member": run_member,
    "pushover": run_pushover,
}


@dataclass(frozen=True)
class Refusal:
    """A refusal: paths, a pattern of the names of rows, the beginning of the message."""

    paths: tuple[str, ...]
    rows: str
    message: str


_HOSTS_MOTION = ("stepping, samples", "stepping, function")
_STATELESS = "what yields has to be remembered, and an element holds no state"
# the first that names a cell holds
REFUSALS = (
    Refusal(("overturning",), _ALONE, "overturning: the case has no &wall"),
    Refusal(("overturning",), "no motion|horizontal record",
            "overturning: the case needs a pulse in &motion"),
    Refusal(("overturning",), "pinned base", "overturning: a hinged wall does not rock"),
    Refusal(("spectrum", "spectrum, auto"), "block, pinned base", "&spectrum: must not be given "
            "without &frame when &wall base = 'pinned'"),
    Refusal(("equal response",), "block, pinned base",
            "equal response: the case needs &frame T_s, or a &wall that rocks alone"),
    Refusal(("wall effect",), _BLOCK, "wall effect: the case has no &frame whose displacement the "
            "wall could change"),
    Refusal(("equal response",), "no motion|horizontal record",
            "equal response: the case needs a pulse in &motion"),
    Refusal(_HOSTS_MOTION, "vertical, record", "a host hands over the horizontal motion: a case "
            "with &vertical takes a ratio to it, or advances under its own motion"),
    Refusal(("element",), _ALONE, "an element needs the group &wall"),
    Refusal(("member",), _ALONE, "a member needs the group &wall"),
    Refusal(("pushover",), rf"^{_ALONE}(?!, `&[sp])", "a pushover needs the height "
            "of the frame for its drift: give &p_delta h_f, or floors with their heights"),
    Refusal(("element",), "`&storeys`", "an element has no &storeys: the frame is the host's"),
    Refusal(("element",), "`&yielding`", "an element has no &yielding: the frame is the host's"),
    Refusal(("element",), "`&fuse`|three fuses", f"an element has no &fuse: {_STATELESS}"),
    Refusal(("element",), "cable yields|cable breaks",
            f"an element has no &cable eta_y or rupture_strain: {_STATELESS}"),
    Refusal(("member",), "`&base`", "&base: must not be given for a member of a host"),
    Refusal(("pushover",), "`&base`", "&base: must not be given for a static curve"),
    Refusal(("element",), "`&base`", "an element has no &base: its settlement and slip are states"),
    Refusal(("element",), "vertical, record", "an element has no &vertical file: the host hands "
            "over the motion, and &vertical ratio follows it"),
    Refusal(("element",), "impact, table", "an element has no &impact rule = 'table': the host "
            "applies the velocity factor, and can look it up"),
    *(Refusal(("element",), f"`&{group}", f"an element has no &{group}: {reason}")
      for group, reason in (("bending", "the modes are states, and an element holds none"),
                            ("coupling", "what yields has to be remembered"),
                            ("restraint", "what yields has to be remembered"),
                            ("p_delta", "the frame is the host's"))),
)  # fmt: skip


def entry_of(table: Iterable[Refusal], row: str, path: str) -> Refusal | None:
    """Find the entry of a table for a cell.

    Parameters
    ----------
    table : iterable of Refusal
        `REFUSALS`.
    row, path : str
        The cell.

    Returns
    -------
    Refusal or None
        The first entry that names it.
    """
    for entry in table:
        if path in entry.paths and re.search(entry.rows, row):
            return entry
    return None


def reason(error: Exception) -> str:
    """Strip a message of the file and the line that it names."""
    text = re.sub(r" \(line \d+\)", "", str(error).strip())
    return re.sub(r"^(sweep, [^:]+: )?(\S*\.nml( \(edited\))?: )?", "", text)


def make() -> str:
    """Make the page in Markdown.

    Returns
    -------
    str
        The columns, the matrix and the messages of the refused cells.
    """
    names = list(PATHS)
    parts = [_INTRODUCTION, "| | interface | compared with the plain run |\n|---|---|---|"]
    for i, (name, path) in enumerate(PATHS.items()):
        parts.append(f"| {i + 1} | {name} | {(path.__doc__ or '').strip()} |")
    parts.append("\n| effect | " + " | ".join(str(i + 1) for i in range(len(names))) + " |")
    parts.append("|---|" + "---|" * len(names))
    parts += [f"| {row} | " + " | ".join(_mark(row, name) for name in names) + " |" for row in ROWS]
    parts.append("\n| | message |\n|---|---|")
    parts += [f"| {_letter(i)} | {entry.message} |" for i, entry in enumerate(REFUSALS)]
    return "\n".join(parts) + "\n"


def _mark(row: str, path: str) -> str:
    refusal = entry_of(REFUSALS, row, path)
    return "+" if refusal is None else _letter(REFUSALS.index(refusal))


def _letter(i: int) -> str:
    return chr(ord("a") + i)


if __name__ == "__main__":
    print(make(), end="")
