"""Random walls on a base that gives, with the second program of each (`compliant_wall`)."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
import rwmf
from compliant_wall import CompliantWall, Device

G = 9.81
END = 2.0  # s
BASES = ("elastic", "slides", "crushes")
MOTIONS = ("one_sine", "one_cosine", "record", "free")
# peaks of the second program, by the quantity of a run
PEAKS = {
    "theta_max_over_alpha": "theta",
    "u_s_max": "u",
    "slide_max": "x",
    "toe_settlement_max": "settlement",
    "fuse_stroke_max": "stroke",
    "crushed_depth_max": "depth",
}


@dataclass
class BaseScene:
    """A case as text, and what its second program needs."""

    number: int
    base: str
    motion: str
    groups: dict[str, dict[str, object]]
    wall: CompliantWall
    knots: list[float]
    theta: float

    def text(self) -> str:
        """Namelist without the group `solver`."""
        groups = (
            f"&{name} {', '.join(f'{k}={_word(v)}' for k, v in keys.items())} /"
            for name, keys in self.groups.items()
        )
        return "\n".join(groups)

    def peaks(self, rtol: float, folder: Path) -> dict[str, float]:
        """Peaks of a run, by quantity; empty if the wall overturns."""
        text = f"{self.text()}\n&solver rtol={rtol}, t_end={END} /\n"
        case = rwmf.Case.from_text(text, folder / "scene.nml")
        run = rwmf.simulate(case.replace(output={"reactions": True, "conditioning": False}))
        if bool(run.overturned):
            return {}
        return {name: float(run[name]) for name in PEAKS if name in run}

    def second_peaks(self) -> dict[str, float]:
        """Peaks of the second program, by quantity."""
        wall = self.wall
        wall.run(np.array([0.0, *(k for k in self.knots if k < END), END]), self.theta)
        found = dict(wall.peaks)
        found["theta"] /= math.atan2(wall.b, wall.h)
        found["depth"] = wall.crushed()
        return {name: found[key] for name, key in PEAKS.items()}


def _word(value: object) -> str:
    if isinstance(value, str):
        return f"'{value}'"
    return ", ".join(map(repr, value)) if isinstance(value, list) else repr(value)


def base_scene(number: int, folder: Path) -> BaseScene:
    """Draw a scene by its number; its record is in the folder."""
    rng = np.random.default_rng((55, number))
    one_of = partial(_power, rng)
    h = one_of(0.5, 10.0)
    b = h * one_of(0.1, 0.8)
    kappa = min(one_of(1e2, 1e6) / b, 1e7)
    xi = 0.0 if rng.random() < 0.15 else one_of(0.01, 2.0)
    base, motion = BASES[number % 3], MOTIONS[int(rng.integers(4))]
    groups: dict[str, dict[str, object]] = {
        "wall": {"h": h, "b": b},
        "base": {"k_t_over_m_w": kappa, "xi": xi},
    }
    options: dict[str, object] = {"delay": 2 * xi / math.sqrt(2 * b * kappa)}
    if rng.random() < 0.6:
        groups["frame"] = {
            "gamma": one_of(0.1, 50.0), "T_s": one_of(0.2, 2.0), "xi_s": float(rng.uniform(0, 0.1)),
        }  # fmt: skip
        frame = groups["frame"]
        options |= {"gamma": frame["gamma"], "xi_s": frame["xi_s"]}
        options["omega_s"] = 2 * math.pi / frame["T_s"]
    eta_0 = 0.0
    if rng.random() < 0.5:
        eta_0, eta_alpha = float(rng.uniform(0.1, 1.0)), float(rng.uniform(1.0, 4.0))
        groups["cable"] = {"eta_0": eta_0, "eta_alpha": eta_alpha, "law": "truss"}
        options |= {"eta_0": eta_0, "eta_alpha": eta_alpha}
    if base == "slides":
        groups["base"]["mu"] = options["mu"] = one_of(0.05, 0.8)
    if base == "crushes":
        settled = G * (1 + eta_0) / (2 * b * kappa)
        options |= {"strips": int(rng.integers(8, 24)), "d_y": settled * one_of(1.3, 6.0)}
        groups["base"] |= {"strips": options["strips"], "d_y": options["d_y"]}
    theta = 0.0
    if motion == "free":
        theta = float(rng.uniform(0.1, 0.7)) * math.atan2(b, h)
        groups["initial"] = {"theta_over_alpha": theta / math.atan2(b, h)}
    elif rng.random() < 0.5:
        options["devices"] = _draw_devices(rng, b, groups)
    ground, knots = _draw_motion(rng, motion, b / h, groups, folder / f"{number}.csv")
    if motion.startswith("one") and rng.random() < 0.3:
        ratio = float(rng.uniform(-1, 1))
        groups["vertical"] = {"ratio": ratio}
        options["upward"] = lambda t: ratio * ground(t)
    wall = CompliantWall(h, b, kappa, ground=ground, **options)
    return BaseScene(number, base, motion, groups, wall, knots, theta)


def _power(rng: np.random.Generator, low: float, high: float) -> float:
    """Draw a number whose logarithm is uniform."""
    return float(math.exp(rng.uniform(math.log(low), math.log(high))))


def _draw_devices(
    rng: np.random.Generator, b: float, groups: dict[str, dict[str, object]]
) -> list[Device]:
    """Draw fuses, dampers or both, under the corners or at places."""
    kinds = int(rng.integers(1, 4))
    found: list[Device] = []
    if kinds & 1:
        eta, stroke, hardening = _power(rng, 0.02, 0.3), b * _power(rng, 1e-4, 1e-2), 0.05
        places = [-b, b]
        groups["fuse"] = {"eta_y": eta, "stroke_y": stroke, "hardening": hardening}
        if rng.random() < 0.4:
            places = [b * float(rng.uniform(-1.5, 1.5)) for _ in range(3)]
            groups["fuse"]["offset"] = places
        found += [Device(d, 0.0, eta * G, stroke, hardening) for d in places]
    if kinds & 2:
        c = _power(rng, 0.1, 10.0)
        groups["damper"] = {"c_over_m_w": c}
        found += [Device(-b, c), Device(b, c)]
    return found


def _draw_motion(
    rng: np.random.Generator,
    kind: str,
    slenderness: float,
    groups: Mapping[str, dict[str, object]],
    path: Path,
) -> tuple[Callable[[float], float], list[float]]:
    """Draw a ground motion that lifts most walls; return it and its knots."""
    peak = slenderness * _power(rng, 0.8, 4.0)
    period = _power(rng, 0.3, 1.5)
    if kind == "free":
        groups["motion"] = {"kind": "none"}
        return lambda t: 0.0, []
    if kind != "record":
        groups["motion"] = {"kind": kind, "a_max_g": peak, "T_p": period}
        wave = math.sin if kind == "one_sine" else math.cos
        return (lambda t: peak * G * wave(2 * math.pi * t / period) if t <= period else 0.0), [
            period
        ]
    times = np.round(np.arange(0, 1.2001, 0.1), 9)
    samples = peak * rng.uniform(-1, 1, times.size)
    samples[-1] = 0.0
    rows = (f"{t!r}, {a!r}" for t, a in zip(times.tolist(), samples.tolist(), strict=True))
    path.write_text("\n".join(rows) + "\n", encoding="utf-8")
    groups["motion"] = {"kind": "record", "file": path.name, "unit": "g"}
    return lambda t: G * float(np.interp(t, times, samples)), times[1:].tolist()
