"""Walls that step with a host in Python: the bits of other hosts, threads, memory, errors."""

import copy
import functools
import itertools
import math
import pickle
import signal
import sys
import threading
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import c_host
import numpy as np
import pytest
import rwmf
from heap import growth

TEXT = (
    "&wall h = 2.0, b = 0.5, m_w = 2.0e4 / &frame T_s = 1.0, gamma = 5.0, xi_s = 0.05 /"
    "&impact rule = 'coupled' / &solver method = '{}', t_end = 4.0 / {}"
)
PULSE = "&motion kind = 'one_sine', a_max_g = 0.4, T_p = 1.0 /"
EFFECTS = "&cable eta_0 = 0.5, eta_alpha = 4.0, eta_y = 0.6 / &fuse F_y = 2e4, k = 1e7 /"
METHODS = ("dop853", "adams", "taylor")
DT = 0.02


def case_of(text: str = PULSE, method: str = "dop853") -> rwmf.Case:
    return rwmf.Case.from_text(TEXT.format(method, text))


def step_of(i: int, amplitude: float = 4.0) -> tuple[np.ndarray, np.ndarray]:
    t = np.array([i, i + 1]) * DT
    return t, amplitude * np.sin(6 * t)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("effects", ["", EFFECTS])
def test_the_bits_of_a_host_in_c(method: str, effects: str) -> None:
    text = TEXT.format(method, effects)
    with (
        c_host.stepping(text, 4.0) as theirs,
        rwmf.Wall(rwmf.Case.from_text(text), peak=4.0) as ours,
    ):
        for i in range(60):
            t, a = step_of(i)
            if i % 7 == 3:
                theirs.save()
                snapshot = ours.save()
                theirs.advance_samples(t.tolist(), [0.0, 9.0])
                ours.advance_samples(t, [0.0, 9.0])
                theirs.restore()
                ours.restore(snapshot)
            if i % 5 == 4:
                theirs.advance_ground(float(t[1]), math.sin)
                ours.advance_ground(float(t[1]), math.sin)
            else:
                theirs.advance_samples(t.tolist(), a.tolist())
                ours.advance_samples(t, a)
            state, found = theirs.state(), ours.state
            for name in ("t", "theta", "theta_dot", "theta_ddot", "u_s", "u_s_dot", "u_s_ddot",
                         "impacts", "lift_offs", "steps", "at_rest", "overturned"):  # fmt: skip
                assert getattr(state, name) == getattr(found, name), (i, name)
            assert ours.maxima[:2] == (state.u_s_max, state.theta_max)
            assert [getattr(theirs.forces(), name) for name in ours.forces._fields] == [
                *ours.forces
            ]


def test_the_bits_of_one_run(elcentro: Path) -> None:
    motion = f"&motion kind = 'record', file = '{elcentro}', unit = 'g', scale = 2.0 /"
    case = case_of(motion)
    run = rwmf.simulate(case)
    with rwmf.Wall(case) as wall:
        for k in range(1, 201):
            wall.advance(round(k * 0.02, 2))
        assert wall.maxima.u_s_max == float(run.u_s_max)
        assert wall.maxima.theta_dot_max == pytest.approx(float(run.theta_dot_max), rel=1e-12)
        assert wall.state.impacts == int(run.impacts) > 5
        assert wall.t == 4.0


# uplift, rest, uplift again
T = np.arange(601) * DT
A = 5 * np.sin(7 * T) * np.sin(0.8 * T) + 1.5 * np.sin(23 * T) * np.sin(0.5 * T)
A[((T > 5) & (T < 7)) | (T[-1] == T)] = 0


@pytest.mark.parametrize("ratio", [0.0, 0.65])
@pytest.mark.parametrize("method", [*METHODS, "bdf"])
def test_pieces_of_one_run(method: str, ratio: float) -> None:
    """A record in calls of one to six intervals: the digits of one run, by `dop853` the bits."""
    case = case_of("", method).replace(
        motion=rwmf.Motion(A, times=T, unit="m/s2"),
        vertical={"ratio": ratio} if ratio else None,
        solver={"t_end": float(T[-1]), "atol": 1e-11},
    )
    run = rwmf.simulate(case, 1.0)
    impacts, first = 0, 0
    with rwmf.Wall(case) as wall:
        while first < T.size - 1:
            last = min(T.size - 1, first + 1 + first % 6)
            wall.advance_samples(T[first : last + 1], A[first : last + 1])
            impacts += sum(event.kind == "impact" for event in wall.events)
            first = last
        state, peak = wall.state, wall.maxima.u_s_max
    assert peak == pytest.approx(float(run.u_s_max), rel=1e-7)
    assert impacts == state.impacts > 5
    if method == "dop853":
        assert (peak, state.theta) == (float(run.u_s_max), float(run.theta[-1]))
        for name in ("impacts", "lift_offs", "steps"):
            assert getattr(state, name) == int(getattr(run, name)), name


@pytest.mark.parametrize("has_wall", [True, False])
@pytest.mark.parametrize("amplitude", [5.0, 0.1])
@pytest.mark.parametrize("method", [*METHODS, "bdf"])
def test_a_motion_with_a_gap(method: str, amplitude: float, has_wall: bool) -> None:
    """It ends the advance of a wall that rocks or rests, or of a frame, and changes nothing."""
    case = case_of("", method)

    def sine(t: float) -> float:
        return amplitude * math.sin(2 * math.pi * t)

    with rwmf.Wall(case if has_wall else case.without_wall(), peak=4.0) as wall:
        with pytest.raises(rwmf.NumericalError, match="not finite"):
            wall.advance_ground(2.0, lambda t: math.nan if 0.7 < t < 1.3 else sine(t))
        assert (wall.t, wall.state.steps) == (0, 0)
        wall.advance_ground(2.0, sine)


@pytest.mark.parametrize("coupling", ["every_floor", "springs", "full"])
def test_forces_of_storeys(coupling: str) -> None:
    """The host gets the sum of all links, and the shear and damping of the lowest storey."""
    m = np.array([3e3, 2e3, 1e3])
    case = rwmf.Case(
        wall={"h": 6.0, "b": 1.2, "m_w": 1e3},
        frame={"xi_s": 0.05},
        storeys={"m": m, "k": [6e5, 5e5, 3e5], "height": [6.0, 4.5, 1.5], "coupling": coupling}
        | ({"k_link": 4e6} if coupling == "springs" else {}),
        impact={"rule": "coupled"},
        motion={"kind": "one_sine", "a_max_g": 0.5, "T_p": 0.7},
        solver={"t_end": 1.0, "rtol": 1e-9},
        output={"reactions": True},
    )
    run = rwmf.simulate(case, 0.05)
    with rwmf.Wall(case) as wall:
        for time, links, floors in zip(
            run.time.values,
            run.links_force.transpose("time", ...).values,
            run.floors_acceleration_g.transpose("time", ...).values,
            strict=True,
        ):
            if time == 0:
                continue
            wall.advance(float(time))
            link, shear = wall.forces.link, wall.forces.frame_shear
            assert link == pytest.approx(-np.nansum(links), rel=1e-6, abs=1e-3)
            # momentum of the floors
            assert link - shear == pytest.approx(9.81 * m @ floors, rel=1e-6, abs=1e-3)


@pytest.mark.parametrize("threads", [1, 2, 7])
def test_many_walls_have_the_bits_of_each(threads: int) -> None:
    cases = [case_of().replace(frame={"T_s": 0.3 + 0.1 * k}) for k in range(12)]
    with rwmf.Walls(cases, threads=threads) as walls:
        assert len(walls) == 12
        rows = np.array([[0.0, 3.0 + 0.1 * k] for k in range(12)])
        walls.advance_samples([0.0, 0.3], rows)
        walls.advance(1.0)
        walls.advance_samples([1.0, 1.2], [4.0, -5.0])
        state, forces, maxima, events = walls.state, walls.forces, walls.maxima, walls.events
        assert walls.t == 1.2
    for k, case in enumerate(cases):
        with rwmf.Wall(case) as wall:
            wall.advance_samples([0.0, 0.3], rows[k])
            wall.advance(1.0)
            wall.advance_samples([1.0, 1.2], [4.0, -5.0])
            assert wall.state == tuple(column[k] for column in state)
            assert wall.forces == tuple(column[k] for column in forces)
            assert wall.maxima == tuple(column[k] for column in maxima)
            mine = events.wall == k
            assert [event.t for event in wall.events] == events.t[mine].tolist()
            assert [event.kind for event in wall.events] == events.kind[mine].tolist()


def test_one_case_and_a_number() -> None:
    with rwmf.Walls(case_of(), 3) as walls:
        walls.advance(0.5)
        theta = walls.state.theta
        assert np.ptp(theta) == 0 and theta[0] != 0
        assert walls.state.at_rest.dtype == np.bool_
        assert walls.state.impacts.dtype == np.int64


def test_a_call_that_fails_for_one_wall_changes_none() -> None:
    weak = case_of().replace(solver={"max_steps": 12})
    with rwmf.Walls([case_of(), weak, case_of()]) as walls:
        walls.advance(0.05)
        before = walls.state
        with pytest.raises(rwmf.NumericalError, match="wall 2"):
            walls.advance(4.0)
        for then, now in zip(before, walls.state, strict=True):
            assert np.array_equal(then, now)
        walls.advance(0.06)
        with rwmf.Wall(case_of()) as wall:
            wall.advance(0.05)
            wall.advance(0.06)
            assert wall.state.theta == walls.state.theta[0]


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("method", ["dop853", "taylor"])
def test_trials_never_change_the_path(seed: int, method: str) -> None:
    """Random trial steps, restores and accepted steps: the accepted path keeps its bits."""
    random = np.random.default_rng(seed)
    case = case_of(EFFECTS, method)
    with rwmf.Wall(case) as straight, rwmf.Wall(case) as tried:
        for i in range(60):
            t, a = step_of(i, 6.0)
            snapshot = tried.save()
            for _ in range(random.integers(0, 3)):
                tried.advance_samples(t, random.uniform(-8, 8, 2))
                if random.random() < 0.3:
                    tried.next_event(float(t[1] + random.uniform(0, 0.3)))
                tried.restore(snapshot)
            straight.advance_samples(t, a)
            tried.advance_samples(t, a)
            assert tried.state == straight.state
            assert tried.maxima == straight.maxima
            assert tried.forces == straight.forces


def test_events_end_an_advance() -> None:
    kinds = ("impact", "lift_off")
    run = rwmf.simulate(case_of().replace(solver={"rtol": 1e-10}), 0.01)
    names = run["event"].values.tolist()
    expected = [
        (name, float(t))
        for name, t in zip(names, run["event_time"].values, strict=True)
        if name in kinds
    ]
    found = []
    with rwmf.Wall(case_of().replace(solver={"rtol": 1e-10})) as wall:
        while (event := wall.next_event(4.0, kinds)) is not None:
            found.append((event.kind, event.t))
            assert abs(wall.t - event.t) < 1e-6
            assert wall.state.impacts == sum(name == "impact" for name, _ in found)
        assert wall.t == 4.0
    assert [name for name, _ in found] == [name for name, _ in expected]
    assert [t for _, t in found] == pytest.approx([t for _, t in expected], abs=1e-7)
    with rwmf.Wall(case_of()) as wall:
        peak = wall.next_event(4.0, ["peak"])
        assert peak is not None and peak.kind == "peak"


def test_each_flight_has_its_turn() -> None:
    """A frame that moves with the wall lets storeys and wall reverse at one instant."""
    text = (
        "&wall h = 2.0, b = 0.5 / &frame xi_s = 0.0 / &link L = 51.46719860381271 /"
        "&storeys m_over_m_w = 0.9844833275004493, k_over_m_w = 227.2292894553269, height = 4.0,"
        "  coupling = 'full' / &yielding storey_u_y = 0.027175303551282344, hardening = 0.0 /"
        "&impact e = 1.0 / &model formulation = 'symmetric' /"
        "&cable eta_0 = 1.0, eta_alpha = 8.98093405830748, eta_y = 1.2705518519832388,"
        "  hardening = 0.0 / &solver t_end = 2.0 /"
        "&motion kind = 'ricker', a_max_g = 0.6155098617535223, T_p = 0.9733479051019143 /"
    )
    kinds = []
    with rwmf.Wall(rwmf.Case.from_text(text), peak=4.0) as wall:
        for i in range(100):
            t, a = step_of(i)
            if i // 10 % 3 == 0:
                wall.advance_samples(t, a)
            elif i // 10 % 3 == 1:
                wall.advance_ground(float(t[1]), lambda t: 4 * math.sin(6 * t))
            else:
                wall.advance(float(t[1]))
            kinds += [event.kind for event in wall.events if event.kind in ("impact", "peak")]
    assert kinds.count("impact") > 5
    assert all("peak" in pair for pair in itertools.pairwise(kinds)), kinds


def test_a_smooth_frame_starts_from_rest() -> None:
    """An interpolation of the first tiny step may reverse where the motion does not."""
    text = (
        "&frame T_s = 0.7, xi_s = 0.02 / &yielding f_y_over_m_s_g = 0.2, law = 'bouc_wen',"
        " exponent = 1.5, beta = 0.7, hardening = 0.1 / &solver method = '{}', t_end = 1.0 /"
    )
    ends = []
    for method in ("dop853", "adams"):
        with rwmf.Wall(rwmf.Case.from_text(text.format(method)), peak=4.0) as frame:
            before = frame.save()
            frame.advance_samples(np.array([0.0, DT]), np.array([0.0, 9.0]))
            frame.restore(before)
            frame.advance_samples(np.array([0.0, DT]), np.array([0.0, 9.0]))
            ends.append(frame.state.u_s)
    assert ends[1] == pytest.approx(ends[0], rel=1e-6)


def test_a_frame_that_begins_later() -> None:
    """Under a constant acceleration a: u = -a/omega**2 (1 - cos(omega t))."""
    case = rwmf.Case.from_text("&frame T_s = 1.0, xi_s = 0.0 / &solver t_end = 4.0 /")
    with rwmf.Wall(case, t_begin=2.0) as frame:
        assert frame.t == 2.0
        frame.advance_samples([2.0, 2.3], [1.0, 1.0])
        expected = -(1 - math.cos(0.6 * math.pi)) / (2 * math.pi) ** 2
        assert frame.state.u_s == pytest.approx(expected, rel=1e-7)


def _fails(error: type[Exception], match: str, call: Callable[[], object]) -> None:
    with pytest.raises(error, match=match):
        call()


def test_bad_calls_are_named_and_change_nothing() -> None:
    with rwmf.Wall(case_of()) as wall, rwmf.Wall(case_of(EFFECTS)) as other:
        wall.advance(0.3)
        before = wall.state
        nan, text = float("nan"), "0.5"
        bad = rwmf.InputError
        _fails(bad, "cannot advance to t = 0.1 s", lambda: wall.advance(0.1))
        _fails(bad, "t = nan", lambda: wall.advance(np.float64(nan)))
        _fails(bad, "t = '0.5'", lambda: wall.advance(text))  # type: ignore[arg-type]
        _fails(
            bad, "expected is the present time", lambda: wall.advance_samples([0.0, 1.0], [0, 1])
        )
        _fails(bad, "increase strictly", lambda: wall.advance_samples([0.3, 0.3], [0, 1]))
        _fails(bad, r"a: has the shape \(3,\)", lambda: wall.advance_samples([0.3, 1], [0, 1, 2]))
        _fails(bad, r"shape \(2, 2\)", lambda: wall.advance_samples([0.3, 1], np.ones((2, 2))))
        _fails(bad, "times and accel", lambda: wall.advance_samples([0.3], [1.0]))
        _fails(
            bad,
            "not a finite",
            lambda: wall.advance_samples(np.array([0.3, 1]), np.array([0, nan])),
        )
        _fails(bad, "a = nan: must be finite", lambda: wall.advance_samples([0.3, 1], [0, nan]))
        _fails(bad, "function = 3", lambda: wall.advance_ground(1.0, 3))  # type: ignore[arg-type]
        _fails(
            rwmf.NumericalError,
            "finite|number",
            lambda: wall.advance_ground(1.0, lambda t: 1.0 if t in (0.3, 1.0) else nan),
        )
        _fails(
            ZeroDivisionError, "division", lambda: wall.advance_ground(1.0, lambda t: 1 / (t - 1.0))
        )
        _fails(bad, "snapshot = 3", lambda: wall.restore(3))  # type: ignore[arg-type]
        _fails(bad, "another wall", lambda: wall.restore(other.save()))
        _fails(bad, "kinds = 'knock'", lambda: wall.next_event(1.0, ["knock"]))
        _fails(bad, "in use", lambda: wall.advance_ground(1.0, lambda t: wall.t))
        assert wall.state == before
        with rwmf.Walls(case_of(), 2) as walls:
            _fails(bad, "has 1 walls", lambda: walls.restore(wall.save()))
    _fails(bad, "t_begin", lambda: rwmf.Wall(case_of(), t_begin=nan))
    _fails(bad, "peak = 0", lambda: rwmf.Wall(case_of(), peak=0.0))
    _fails(bad, "n = 3", lambda: rwmf.Walls([case_of(), case_of()], 3))
    _fails(bad, "n = 0", lambda: rwmf.Walls(case_of(), 0))
    _fails(bad, "cases", lambda: rwmf.Walls([]))
    _fails(bad, "accuracy", lambda: rwmf.Wall(case_of().replace(solver={"accuracy": 1e-6})))
    _fails(bad, "threads = -1", lambda: rwmf.Walls(case_of(), 2, threads=-1))


def test_use_after_the_end() -> None:
    wall = rwmf.Wall(case_of())
    snapshot = wall.save()
    wall.close()
    wall.close()
    assert "closed" in repr(wall)
    bad = rwmf.InputError
    _fails(bad, "Wall is closed", lambda: wall.advance(1.0))
    _fails(bad, "Wall is closed", lambda: wall.state)
    _fails(bad, "Wall is closed", lambda: wall.restore(snapshot))
    with rwmf.Walls(case_of(), 2) as walls:
        pass
    _fails(bad, "Walls is closed", lambda: walls.maxima)


def test_walls_are_not_pickled_or_copied() -> None:
    with rwmf.Wall(case_of()) as wall:
        for value in (wall, wall.save()):
            for use in (pickle.dumps, copy.copy):
                with pytest.raises(TypeError, match="cannot be pickled or copied"):
                    use(value)
        assert pickle.loads(pickle.dumps(wall.state)) == wall.state


def test_a_wall_in_many_threads() -> None:
    """Walls of several threads have the bits of one; calls of one wall wait for each other."""

    def run(_: int) -> object:
        with rwmf.Wall(case_of()) as wall:
            for i in range(50):
                wall.advance_samples(*step_of(i))
            return wall.state

    with ThreadPoolExecutor(8) as pool:
        assert len(set(pool.map(run, range(16)))) == 1
        with rwmf.Wall(case_of()) as wall:
            times = [0.01 * k for k in range(1, 200)]
            done = list(pool.map(lambda _: wall.save(), times))
            wall.advance(1.0)
            list(pool.map(wall.restore, done))
            assert wall.t == 0.0


def test_the_interpreter_runs_during_a_call() -> None:
    """During a call of half a second another thread of Python computes.

    Processor time counts; it does not depend on the load of the machine. An interpreter that
    waits for the call would get a switch interval of 5 ms before and after it.
    """
    case = case_of().replace(solver={"rtol": 1e-12})
    started = threading.Event()

    def work() -> None:
        with rwmf.Walls(case, 4000, threads=1) as walls:
            started.set()
            walls.advance(4.0)

    worker = threading.Thread(target=work)
    worker.start()
    assert started.wait(100)
    begin, of_all = time.thread_time(), time.process_time()
    while worker.is_alive():
        pass
    of_interpreter = time.thread_time() - begin
    of_call = time.process_time() - of_all - of_interpreter
    assert min(of_interpreter, of_call) > 10 * sys.getswitchinterval()


def test_ctrl_c_stops_many_walls() -> None:
    case = case_of().replace(solver={"rtol": 1e-12})
    with rwmf.Walls(case, 4000, threads=1) as walls:
        timer = threading.Timer(0.1, signal.raise_signal, [signal.SIGINT])
        timer.start()
        with pytest.raises(rwmf.Interrupted):
            walls.advance(4.0)
        timer.join()
        assert walls.t == 0.0
        assert not walls.state.steps.any()


_LONG = np.arange(0.0, 1e4, 0.02)
_CALLS: dict[str, Callable[[rwmf.Wall], object]] = {
    "advance": lambda wall: wall.advance(1e4),
    "samples": lambda wall: wall.advance_samples(_LONG + wall.t, np.sin(3 * _LONG)),
    "ground": lambda wall: wall.advance_ground(1e4, lambda t: math.sin(3 * t)),
    "next event": lambda wall: wall.next_event(1e4, ("collapsed",)),
}


@functools.cache
def _long_case() -> rwmf.Case:
    motion = rwmf.Motion(np.sin(3 * _LONG), dt=0.02, unit="m/s2", name="long")
    return case_of().replace(motion=motion, solver={"rtol": 1e-12, "method": "adams"})


@pytest.mark.parametrize("is_stepped", [False, True])
@pytest.mark.parametrize("name", _CALLS)
def test_ctrl_c_stops_one_wall(name: str, is_stepped: bool) -> None:
    """Also in a function that the kernel calls; a call that was short before is no exception."""
    with rwmf.Wall(_long_case()) as wall:
        if is_stepped:
            wall.advance(0.01)
            wall.advance(0.02)
        before = wall.state
        timer = threading.Timer(0.1, signal.raise_signal, [signal.SIGINT])
        timer.start()
        begun = time.monotonic()
        with pytest.raises(KeyboardInterrupt):
            _CALLS[name](wall)
        assert time.monotonic() - begun < 5.0
        timer.join()
        assert signal.getsignal(signal.SIGINT) is signal.default_int_handler
        assert name == "next event" or wall.state == before


@pytest.mark.parametrize("size", [1, 500])
def test_cycles_leave_no_memory(size: int) -> None:
    """A lost byte in each cycle of one wall, or of one of many, would be seen."""
    cases = [case_of(EFFECTS, method) for method in (*METHODS, "bdf")]

    def cycle(n: int) -> None:
        for i in range(n):
            case = cases[i % 4]
            with rwmf.Wall(case) if size == 1 else rwmf.Walls(case, size) as wall:
                snapshot = wall.save()
                if i % 10 == 0:
                    wall.advance_samples(*step_of(0))
                    wall.restore(snapshot)
                    assert len(wall.events if size == 1 else wall.events.t) == 0

    n = 2000 if size == 1 else 20
    heap, blocks = growth(cycle, n)
    assert heap < n * size
    assert blocks < n
