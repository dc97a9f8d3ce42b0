"""Demands of frames without a wall against modal superposition, and against their own histories.

Each mode of a linear frame is an oscillator. For a record, linear between samples, a matrix
exponential gives its exact state. Displacements and absolute accelerations of the floors are sums
over the modes; drifts, shears and the overturning moment follow from them. The maxima are searched
between the samples of that solution. The solution is independent of the kernel.
"""

import math
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import rwmf
from scenes import bare_frame, coupled, record
from scipy.linalg import eigh, expm
from scipy.optimize import minimize_scalar

G = 9.81
DT = 0.02
XI = 0.04
EXACT = 1e-8
Storeys = tuple[list[float], list[float], list[float]]  # masses, stiffnesses, heights
STOREYS: dict[int, Storeys] = {
    2: ([2.0, 1.0], [900.0, 500.0], [4.0, 3.0]),
    3: ([1.0, 1.2, 0.8], [700.0, 900.0, 400.0], [3.0, 3.5, 3.0]),
    6: ([3.0, 3.0, 3.0, 2.5, 2.5, 2.0], [6e3, 6e3, 5e3, 4e3, 3e3, 2e3], [4.0, *[3.2] * 5]),
    9: ([1.0] * 9, list(np.linspace(4e3, 1e3, 9)), [5.0, *[3.0] * 8]),
}


def _shaking(seed: int, n: int = 250) -> np.ndarray:
    """Draw samples of a motion that grows and dies out [g]; it begins at zero."""
    t = np.arange(n) * DT
    noise = np.random.default_rng(seed).standard_normal(n)
    return 0.6 * noise * (t / 1.5) * np.exp(1 - t / 1.5)


def _written(path: Path, a: np.ndarray) -> dict[str, object]:
    rows = "\n".join(f"{i * DT!r},{value!r}" for i, value in enumerate(a.tolist()))
    path.write_text(rows + "\n", encoding="utf-8")
    return record(path)


LINE = np.array([[0.0, 1.0], [0.0, 0.0]])  # rates of a straight line and its slope
Piece = tuple[np.ndarray, np.ndarray, float]  # begin, rates and length of the ground's motion


def _lines(a: np.ndarray) -> list[Piece]:
    """Straight lines between samples [m/s2]."""
    return [(np.array([x, (y - x) / DT]), LINE, DT) for x, y in pairwise(a)]


def _waves(a: float, omega: float, cycles: float, rest: float) -> list[Piece]:
    """Waves of a sine [m/s2], and nothing for a time [s]."""
    turn = np.array([[0.0, omega], [-omega, 0.0]])
    n = math.ceil(cycles * 2 * math.pi / omega / DT)
    length = cycles * 2 * math.pi / omega / n
    phases = [omega * length * i for i in range(n)]
    pulse = [(a * np.array([math.sin(x), math.cos(x)]), turn, length) for x in phases]
    return [*pulse, *[(np.zeros(2), LINE, DT)] * round(rest / DT)]


class Modes:
    """A shear frame, floors from the ground up, damped alike in every mode."""

    def __init__(self, m: list[float], k: list[float], height: list[float], xi: float) -> None:
        self.m, self.k, self.height = np.array(m), np.array(k), np.array(height)
        matrix = np.diag(k) + np.diag([*k[1:], 0.0]) - np.diag(k[1:], 1) - np.diag(k[1:], -1)
        squares, self.shape = eigh(matrix, np.diag(m))
        self.pushed = self.shape.T @ self.m
        # q'' without the ground, from q and q'
        self.rows = [np.array([-(w**2), -2 * xi * w]) for w in np.sqrt(squares)]

    def demands(self, states: np.ndarray) -> np.ndarray:
        """Drifts, shears and accelerations from the ground up, overturning moment, base shear.

        Shears over g, accelerations over g, moment and base shear over the weight; `states` has q
        and q' of each mode in two columns.
        """
        u = self.shape @ (self.pushed * states[:, 0])
        force = [-(row @ state) for row, state in zip(self.rows, states, strict=True)]
        absolute = -self.shape @ (self.pushed * np.array(force))
        drift = np.diff(u, prepend=0.0)
        arms = [np.cumsum(self.height), np.ones(self.m.size)]
        whole = [self.m * arm @ absolute / (G * self.m.sum()) for arm in arms]
        return np.concatenate([drift / self.height, self.k * drift / G, absolute / G, whole])

    def systems(self, drive: np.ndarray) -> np.ndarray:
        """Return the rates of q, q' and the ground's motion, for each mode."""
        systems = np.zeros((len(self.rows), 4, 4))
        systems[:, 0, 1], systems[:, 1, :2], systems[:, 1, 2] = 1, self.rows, -1
        systems[:, 2:, 2:] = drive
        return systems

    def soon(self, now: np.ndarray, drive: np.ndarray, t: float) -> np.ndarray:
        """Return the states after less than 2 ms: the series of the exponential."""
        systems, term = self.systems(drive) * t, now
        states = now.copy()
        for power in range(1, 16):
            term = (systems @ term[:, :, None])[:, :, 0] / power
            states += term
        return states

    def largest(self, pieces: list[Piece], n: int | None = None) -> np.ndarray:
        """Return the largest magnitude of the first n demands under a motion."""
        parts = 16
        states = np.zeros((self.m.size, 2))
        begins, seen = [], []
        flows: dict[tuple[float, ...], np.ndarray] = {}
        for begin, drive, length in pieces:
            key = (*drive.ravel(), length)
            if key not in flows:
                flows[key] = expm(self.systems(drive) * (length / parts))
            now = np.column_stack([states, np.tile(begin, (len(states), 1))])
            for _ in range(parts):
                begins.append((now, drive, length / parts))
                seen.append(np.abs(self.demands(now[:, :2])))
                now = (flows[key] @ now[:, :, None])[:, :, 0]
            states = now[:, :2]
        seen.append(np.abs(self.demands(states)))
        values = np.array(seen)[:, :n]
        found = values.max(axis=0)
        for q in range(found.size):
            # more than the samples may miss of a peak between them, at 130 rad/s and 1.25 ms
            near = values[:, q] > 0.995 * found[q]
            near[1:-1] &= (values[1:-1, q] >= values[:-2, q]) & (values[1:-1, q] >= values[2:, q])
            for i in {j for k in np.flatnonzero(near) for j in (k - 1, k) if 0 <= j < len(begins)}:

                def height(t: float, begin: tuple = begins[i], q: int = q) -> float:
                    return -abs(self.demands(self.soon(*begin[:2], t)[:, :2])[q])

                bounds = (0.0, begins[i][2])
                best = minimize_scalar(
                    height, bounds=bounds, method="bounded", options={"xatol": 1e-9}
                )
                found[q] = max(found[q], -best.fun)
        return found


def _keys(n: int) -> list[str]:
    numbers = range(1, n + 1)
    return [
        *(f"storey_{i}_drift_max" for i in numbers),
        *(f"storey_{i}_shear_max_over_m_w_g" for i in numbers),
        *(f"floor_{i}_acceleration_max_g" for i in numbers),
        "overturning_moment_max_over_weight",
        "base_shear_max_over_weight",
    ]


def _frame(
    storeys: Storeys,
    motion: dict[str, object],
    coupling: str = "full",
    xi: float = XI,
    t_end: float | None = None,
) -> rwmf.Case:
    m, k, height = storeys
    return bare_frame(
        frame={"T_s": None, "gamma": None, "xi_s": xi},
        storeys={"m_over_m_w": m, "k_over_m_w": k, "height": height, "coupling": coupling},
        motion=motion,
        model={"formulation": None},
        solver={"t_end": t_end, "rtol": 1e-12, "method": "dop853"},
        output={"reactions": True},
    )


def _check(case: rwmf.Case, modes: Modes, pieces: list[Piece]) -> None:
    n = modes.m.size
    run = rwmf.simulate(case)
    found = [float(run[key]) for key in _keys(n)]
    assert found == pytest.approx(modes.largest(pieces), rel=EXACT)
    assert float(run["storey_drift_max"]) == max(found[:n])
    assert float(run["floor_acceleration_max_g"]) == max(found[2 * n : 3 * n])
    height = modes.height.sum()
    assert float(run["roof_drift_max"]) == pytest.approx(float(run["u_s_max"]) / height, rel=1e-14)


def _random_storeys(n: int) -> Storeys:
    """Masses, stiffnesses and heights that differ from storey to storey."""
    dice = np.random.default_rng(n)
    m, height = dice.uniform(0.4, 2.0, n), dice.uniform(2.5, 5.0, n)
    k = dice.uniform(400.0, 1200.0, n) * n * (1.2 - np.arange(n) / n)
    return m.tolist(), k.tolist(), height.tolist()


@pytest.mark.parametrize("xi", [0.0, 0.3])
@pytest.mark.parametrize("n", [2, 5, 8])
def test_unequal_storeys(n: int, xi: float, tmp_path: Path) -> None:
    """Without and with much damping, under a record and under waves of a sine."""
    storeys, a = _random_storeys(n), _shaking(10 + n, 120)
    modes = Modes(*storeys, xi)
    case = _frame(storeys, _written(tmp_path / "record.csv", a), xi=xi)
    _check(case, modes, _lines(G * a))
    pulse = {"kind": "sine", "a_max_g": 0.3, "omega_p": 9.0, "cycles": 1.5}
    pieces = _waves(0.3 * G, 9.0, 1.5, 0.5)
    t_end = sum(length for _, _, length in pieces)
    _check(_frame(storeys, pulse, xi=xi, t_end=t_end), modes, pieces)


def test_one_mode(tmp_path: Path) -> None:
    """`reduced` is the response of the first mode; the other modes follow the ground."""
    n = 6
    a = _shaking(1)
    run = rwmf.simulate(_frame(STOREYS[n], _written(tmp_path / "record.csv", a), "reduced"))
    modes = Modes(*STOREYS[n], XI)
    modes.pushed[1:] = 0
    found = [float(run[key]) for key in _keys(n)]
    assert found[: 2 * n] == pytest.approx(modes.largest(_lines(G * a), 2 * n), rel=EXACT)
    # a floor has its share of the mode's acceleration, beside the whole of the ground's
    one = Modes([1.0], [-modes.rows[0][0]], [1.0], XI)
    roof = rwmf.simulate(
        bare_frame(
            frame={"T_s": 2 * math.pi / math.sqrt(one.k[0]), "gamma": None, "xi_s": XI},
            motion=record(tmp_path / "record.csv"),
            model={"formulation": None},
            solver={"t_end": None, "rtol": 1e-12, "method": "dop853"},
            output={"reactions": True},
        ),
        dt=1e-4,
    )
    relative = roof["floor_1_acceleration_g"].values - roof["u_g_ddot"].values / G
    share = modes.shape[:, 0] * modes.pushed[0]
    for i in range(n):
        absolute = share[i] * relative + roof["u_g_ddot"].values / G
        assert found[2 * n + i] == pytest.approx(np.abs(absolute).max(), rel=1e-5)
        assert found[2 * n + i] >= np.abs(absolute).max() * (1 - 1e-9)


def test_single_degree_of_freedom(tmp_path: Path) -> None:
    """It is floor 1, and has no storey; the height is the one that gravity acts over."""
    a = _shaking(3)
    case = bare_frame(
        frame={"T_s": 0.7, "gamma": None, "xi_s": XI},
        motion=_written(tmp_path / "record.csv", a),
        model={"formulation": None},
        solver={"t_end": None, "rtol": 1e-12, "method": "dop853"},
        output={"reactions": True},
    )
    run = rwmf.simulate(case)
    expected = Modes([1.0], [(2 * math.pi / 0.7) ** 2], [1.0], XI).largest(_lines(G * a))
    assert float(run["floor_1_acceleration_max_g"]) == pytest.approx(expected[2], rel=EXACT)
    assert float(run["floor_acceleration_max_g"]) == float(run["floor_1_acceleration_max_g"])
    assert float(run["base_shear_max_over_weight"]) == pytest.approx(expected[2], rel=EXACT)
    assert not [name for name in run if "storey" in str(name) or "roof_drift" in str(name)]
    high = rwmf.simulate(case.replace(p_delta={"h_f": 4.0, "m_g_over_m_s": 0.0}))
    assert float(high["roof_drift_max"]) == pytest.approx(expected[0] / 4.0, rel=EXACT)
    assert float(high["overturning_moment_max_over_weight"]) == pytest.approx(
        4.0 * expected[2], rel=EXACT
    )


_TIMES = {
    "storey_drift_max": "storey_{}_drift",
    "floor_acceleration_max_g": "floor_{}_acceleration_g",
    "overturning_moment_max_over_weight": "overturning_moment_over_weight",
    "roof_drift_max": "u_s",
}


@pytest.mark.parametrize("coupling", ["full", "every_floor"])
def test_times_are_those_of_the_maxima(coupling: str) -> None:
    """The column that has the maximum is closest to it in the row next to its time."""
    m, k, height = STOREYS[2]
    case = coupled(
        wall={"h": sum(height) / 2, "b": 0.8},
        frame={"T_s": None, "gamma": None},
        storeys={"m_over_m_w": m, "k_over_m_w": k, "height": height, "coupling": coupling},
        solver={"t_end": 3.0},
        output={"reactions": True},
    )
    run = rwmf.simulate(case, dt=1e-3)
    for key, column in _TIMES.items():
        columns = {column.format(i) for i in range(1, len(m) + 1)}
        rows = np.max([np.abs(run[name].values) for name in columns], axis=0)
        time = float(run[f"t_{key.removesuffix('_g').removesuffix('_over_weight')}"])
        highest = float(run[key]) * (sum(height) if column == "u_s" else 1.0)
        assert rows[np.argmin(np.abs(run.time.values - time))] == pytest.approx(highest, rel=1e-3)
        assert abs(run.time.values[np.argmax(rows)] - time) < 2e-3, key


def test_smooth_frame_beside_a_wall_at_rest() -> None:
    """Yielded storeys continue to push: rows, reactions and demands at rest include it."""
    case = coupled(
        frame={"xi_s": 0.2},
        yielding={"u_y": 0.01, "law": "bouc_wen"},
        motion={"a_max_g": 0.4, "omega_p": 6.28},
        impact={"e": 0.5},
        solver={"t_end": 20.0},
        output={"reactions": True},
    )
    end = rwmf.simulate(case, dt=0.01).isel(time=-1)
    assert float(end["theta"]) == 0
    force = float(end["frame_force_over_m_s_g"])
    assert abs(force) > 1e-3
    for name in ("pivot_horizontal_over_m_w_g", "wall_shear_over_m_w_g"):
        assert abs(float(end[name])) == pytest.approx(5.0 * abs(force), rel=1e-12), name
