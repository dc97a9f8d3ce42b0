"""Random combinations of effects and motions, from a number.

A number makes the same scene on every machine, so that a number describes a finding. All checks
of ``test_hard_combinations.py`` use the same scenes.
"""

import math
import random
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

import rwmf
from rwmf import records

Changes = dict[str, Any]
Groups = dict[str, Changes]
Samples = tuple[tuple[float, float], ...]

H, B = 2.0, 0.5
ALPHA = math.atan2(B, H)
T_END = 4.0
MAX_STEPS = 400_000
_PULSE_RATE = 0.55  # part of the scenes that have a pulse, not a record


@dataclass(frozen=True)
class Combination:
    """A scene generated from a number.

    Attributes
    ----------
    number : int
        The same number gives the same scene.
    groups : dict
        Groups of the case, `&solver` but for its method and tolerance, and without records.
    horizontal, vertical : tuple of pairs
        Time [s] and acceleration [m/s2] of the records; empty for none.
    """

    number: int
    groups: Groups
    horizontal: Samples = ()
    vertical: Samples = ()

    def build(self, folder: Path, **changes: Changes) -> rwmf.Case:
        """Make the case; its records are written into the folder.

        Parameters
        ----------
        folder : Path
            Folder for the records.
        **changes
            Keys that are joined with those of their group; None takes one out.

        Returns
        -------
        rwmf.Case
            The case.
        """
        groups = {name: dict(keys) for name, keys in self.groups.items()}
        for group, samples in (("motion", self.horizontal), ("vertical", self.vertical)):
            if samples:
                path = folder / f"{self.number}_{group}.txt"
                lines = (f"{t!r} {a!r}" for t, a in samples)
                path.write_text("\n".join(lines) + "\n", encoding="utf-8")
                groups[group] |= {"file": str(path), "unit": "m/s2"}
        for group, keys in changes.items():
            both = groups.get(group, {}) | keys
            groups[group] = {key: value for key, value in both.items() if value is not None}
        return rwmf.Case(**groups)


def combination(number: int) -> Combination:
    """Make the scene of a number.

    Parameters
    ----------
    number : int
        Any.

    Returns
    -------
    Combination
        A rocking wall that may have any of the effects.
    """
    dice = random.Random(number)
    groups: Groups = {
        "wall": {"h": H, "b": B},
        "model": {
            "formulation": dice.choice(["symmetric", "exact"]),
            "overturning_angle": 0.9,
        },
        "impact": dict(dice.choice(_IMPACTS)),
        "solver": {"t_end": T_END, "max_steps": MAX_STEPS},
    }
    groups |= _frame(dice)
    for chance, name, keys in (
        (0.7, "cable", _cable),
        (0.3, "link", _link),
        (0.3, "damper", _damper),
        (0.3, "fuse", _fuse),
        (0.3, "inerter", _inerter),
    ):
        if dice.random() < chance:
            groups[name] = keys(dice)
    if "frame" not in groups:
        groups.pop("link", None)
    return _moved(dice, number, groups)


def further_combination(number: int) -> Combination:
    """Make the scene of a number with slip, self-centring and strength loss.

    It is `combination` of the same number with other laws of frame, storeys and fuses. Some scenes
    have gravity on the frame and a shear key, and all demands are requested.

    Parameters
    ----------
    number : int
        Any.

    Returns
    -------
    Combination
        A rocking wall that may have any of the effects.
    """
    dice = random.Random(f"further {number}")
    made = combination(number)
    groups = {name: dict(keys) for name, keys in made.groups.items()}
    groups["output"] = {"reactions": True}
    if dice.random() < 0.4:
        groups["wall"]["shear_key"] = True
    if "frame" in groups and dice.random() < 0.8:
        groups["yielding"] = _further_yielding(dice, groups.get("storeys", {}))
    if "frame" in groups and dice.random() < 0.5:
        groups["p_delta"] = {
            "m_g_over_m_s": _log(dice, 0.2, 3.0),
            "drift_limit": dice.choice([0.02, 0.1, 0.5]),
        }
    if dice.random() < 0.3 or "fuse" in groups:
        groups["fuse"] = _fuse(dice) | dice.choice([_friction, _flag])(dice)
    return replace(made, groups=groups)


def spectrum_combination(number: int) -> Combination:
    """Make a scene with `&spectrum` of two states without hysteresis.

    Parameters
    ----------
    number : int
        Any.

    Returns
    -------
    Combination
        A frame alone, or with a rocking wall, at a few periods.
    """
    dice = random.Random(f"spectrum {number}")
    groups: Groups = {
        "frame": {"xi_s": dice.choice([0.0, 0.05, 0.05, 0.3])},
        "solver": {"t_end": T_END, "max_steps": MAX_STEPS},
        "spectrum": {"T_s": sorted(_log(dice, 0.05, 3.0) for _ in range(3))},
    }
    if dice.random() > 0.1:
        groups["wall"] = {"h": H, "b": B}
        groups["frame"]["gamma"] = _log(dice, 0.5, 1000.0)
        groups["model"] = {"formulation": dice.choice(["published", "symmetric", "exact"])}
        groups["impact"] = dict(dice.choice([*_IMPACTS[:4], {"rule": "housner"}]))
        if dice.random() < 0.7:
            laws = ["linear"] if groups["model"]["formulation"] == "published" else _LAWS
            groups["cable"] = {
                "eta_0": dice.choice([0.0, 1.0, 4.0]),
                "eta_alpha": dice.uniform(4.5, 12.0),
                "law": dice.choice(laws),
            }
    return _moved(dice, number, groups, may_be_vertical=False)


_LAWS = ["linear", "truss"]
_IMPACTS: tuple[dict[str, Any], ...] = (
    {"e": 0.8},
    {"e": 1.0},
    {"e": 0.5},
    {"rule": "coupled"},
    {"rule": "table", "table_theta_dot": [0.05, 0.8], "table_e": [0.95, 0.7]},
)


def _frame(dice: random.Random) -> Groups:
    """Frame or storeys, elastic, bilinear or smooth; with `full` each storey by itself."""
    kind = dice.choice(["frame", "frame", "storeys", "storeys", "none"])
    if kind == "none":
        return {}
    xi_s = dice.choice([0.0, 0.05, 0.05, 0.3])
    gamma = _log(dice, 0.5, 100.0)
    groups: Groups = {"frame": {"T_s": _log(dice, 0.1, 2.5), "gamma": gamma, "xi_s": xi_s}}
    coupling = ""
    if kind == "storeys":
        coupling = dice.choice(["reduced", "every_floor", "full", "full"])
        groups = {"frame": {"xi_s": xi_s}, "storeys": _storeys(dice, gamma, coupling)}
    draw = dice.random()
    if draw > 0.5:
        return groups
    u_y = _log(dice, 1e-3, 5e-2)
    if coupling == "full":
        groups["yielding"] = _yielding_storeys(dice, u_y, len(groups["storeys"]["height"]))
        return groups
    if draw < 0.25:
        groups["yielding"] = {"u_y": u_y, "hardening": dice.choice([0.0, 0.1])}
    else:
        groups["yielding"] = {
            "u_y": u_y,
            "law": "bouc_wen",
            "exponent": dice.choice([1.0, 2.0, 8.0]),
        }
    return groups


def _storeys(dice: random.Random, gamma: float, coupling: str) -> dict[str, Any]:
    """One to five storeys; some of them far stiffer, or softer, than their neighbours."""
    n = dice.randint(1, 5)
    masses = [dice.uniform(0.5, 1.5) for _ in range(n)]
    masses = [gamma * m / sum(masses) for m in masses]
    # a period of the roof on its storey between 0.05 and 2 s
    usual = masses[-1] * (2 * math.pi / _log(dice, 0.05, 2.0)) ** 2
    odd = dice.choice([1.0, 1.0, 1e-3, 30.0])
    stiffnesses = [usual * dice.uniform(0.5, 2.0) for _ in range(n)]
    stiffnesses[dice.randrange(n)] *= odd
    heights = [dice.uniform(0.5, 1.5) for _ in range(n)]
    heights = [2 * H * height / sum(heights) for height in heights]
    heights[-1] = 2 * H - sum(heights[:-1])
    return {"m_over_m_w": masses, "k_over_m_w": stiffnesses, "height": heights,
            "coupling": coupling}  # fmt: skip


def _yielding_storeys(dice: random.Random, u_y: float, n: int) -> dict[str, Any]:
    """Each storey by itself, the lowest one the weakest."""
    keys: dict[str, Any] = {"storey_u_y": [u_y * (1 + i) / n for i in range(n)]}
    law = dice.choice(["bilinear", "bouc_wen"])
    if law == "bilinear":
        return keys | {"hardening": dice.choice([0.0, 0.1])}
    return keys | {"law": law, "exponent": dice.choice([1.0, 2.0, 8.0])}


def _further_yielding(dice: random.Random, storeys: dict[str, Any]) -> dict[str, Any]:
    """Friction, flags, softening and loss of strength, of the frame or of each storey."""
    u_y = _log(dice, 1e-3, 5e-2)
    coupling, n = storeys.get("coupling"), len(storeys.get("height", []))
    keys: dict[str, Any] = {"u_y": u_y}
    if coupling == "full" or (coupling == "every_floor" and dice.random() < 0.5):
        keys = {"storey_u_y": [u_y * (1 + i) / n for i in range(n)]}
    law = dice.choice([_friction, _flag, _softening, _loss, _loss])
    return keys | law(dice)


def _friction(dice: random.Random) -> dict[str, Any]:
    return {"law": "friction", "hardening": dice.choice([0.0, 0.05]),
            "breakaway": dice.choice([1.0, 1.1, 1.5])}  # fmt: skip


def _flag(dice: random.Random) -> dict[str, Any]:
    return {"law": "flag", "hardening": dice.choice([0.0, 0.05]),
            "flag_height": dice.choice([0.3, 0.8, 1.0])}  # fmt: skip


def _softening(dice: random.Random) -> dict[str, Any]:
    return {"hardening": -_log(dice, 0.002, 0.1), "ultimate": dice.uniform(3.0, 20.0)}


def _loss(dice: random.Random) -> dict[str, Any]:
    """Loss of strength, with and without wear, pinching and an end."""
    keys: dict[str, Any] = {
        "law": dice.choice(["peak_oriented", "pinched"]),
        "hardening": dice.choice([0.0, 0.05]),
        "cap": dice.uniform(1.5, 6.0),
        "post_cap": dice.uniform(5.0, 30.0),
        "residual": dice.choice([0.0, 0.1]),
    }
    wear = dice.choice(["none", "one", "four"])
    if wear == "one":
        keys["lambda"] = [_log(dice, 20.0, 300.0)]
    elif wear == "four":
        keys["lambda"] = [_log(dice, 20.0, 300.0) for _ in range(4)]
        keys["lambda_exponent"] = [dice.uniform(1.0, 2.0) for _ in range(4)]
    if keys["law"] == "pinched":
        keys |= {"pinch_force": dice.uniform(0.2, 1.0), "pinch_displacement": dice.random()}
    if dice.random() < 0.3:
        keys["ultimate"] = dice.uniform(5.0, 20.0)
    return keys


def _cable(dice: random.Random) -> dict[str, Any]:
    eta_0, eta_alpha = dice.choice([0.0, 1.0, 1.0, 4.0]), dice.uniform(4.5, 12.0)
    keys: dict[str, Any] = {"eta_0": eta_0, "eta_alpha": eta_alpha}
    keys["law"] = dice.choice(_LAWS)
    kind = dice.choice(["elastic", "yields", "yields", "breaks", "yields and breaks"])
    if "yields" in kind:
        keys |= {"eta_y": eta_0 + dice.uniform(0.1, 0.8), "hardening": dice.choice([0.0, 0.02])}
    if "breaks" in kind:
        # elongation at theta = alpha is b alpha for both laws but for some percent
        alone = eta_0 / (eta_alpha - eta_0)
        keys["rupture_strain"] = B * ALPHA / (2 * H) * (1.1 * alone + dice.uniform(0.05, 0.5))
    return keys


def _link(dice: random.Random) -> dict[str, Any]:
    return {"L": _log(dice, 8.0, 100.0)}


def _damper(dice: random.Random) -> dict[str, Any]:
    return {"c_over_m_w": dice.uniform(0.05, 2.0)}


def _fuse(dice: random.Random) -> dict[str, Any]:
    # two fuses together bear less than the weight: else they hold the wall up
    return {"eta_y": dice.uniform(0.05, 0.4), "stroke_y": _log(dice, 3e-4, 1e-2),
            "hardening": dice.choice([0.0, 0.05])}  # fmt: skip


def _inerter(dice: random.Random) -> dict[str, Any]:
    return {"inertance_over_m_w": _log(dice, 0.1, 10.0)}


def _moved(
    dice: random.Random, number: int, groups: Groups, may_be_vertical: bool = True
) -> Combination:
    """Add the motion: a pulse or a record, with or without a vertical one."""
    peak = dice.uniform(0.1, 0.9)
    if dice.random() < _PULSE_RATE:
        groups["motion"] = _pulse(dice, peak)
        if may_be_vertical and dice.random() < 0.3:
            groups["vertical"] = {"ratio": dice.uniform(-0.7, 0.7)}
        return Combination(number, groups)
    groups["motion"] = {"kind": "record"}
    ends_with_record = dice.random() < 0.5
    horizontal = _record(dice, 9.81 * peak)
    if ends_with_record and horizontal[-1][0] > 0:
        del groups["solver"]["t_end"]  # most walls are in mid flight then
    draw, vertical = dice.random(), ()
    if not may_be_vertical or draw >= 0.4:
        return Combination(number, groups, horizontal)
    if draw < 0.2:
        groups["vertical"] = {"ratio": dice.uniform(-0.7, 0.7)}
    else:
        groups["vertical"] = {}
        vertical = _record(dice, 9.81 * 0.6 * peak)
    return Combination(number, groups, horizontal, vertical)


def _pulse(dice: random.Random, peak: float) -> dict[str, Any]:
    kinds = ["one_sine", "one_cosine", "sine", "type_c", "mavroeidis_papageorgiou", "ricker",
             "ricker_antisymmetric"]  # fmt: skip
    kind = dice.choice(kinds)
    keys = {"kind": kind, "a_max_g": peak, "T_p": dice.uniform(0.3, 1.5)}
    if kind == "sine":
        keys["cycles"] = dice.choice([0.5, 1.25, 3.0])
    elif kind == "type_c":
        keys["n_pulses"] = dice.choice([1, 2])
    elif kind == "mavroeidis_papageorgiou":
        keys |= {"gamma_p": dice.uniform(1.1, 3.0), "nu": dice.choice([0.0, math.pi / 2, 2.0])}
    if dice.random() < 0.3:
        keys["t_0"] = dice.choice([0.37, -0.2])
    return keys


def _record(dice: random.Random, peak: float) -> Samples:
    """El Centro, or noise at odd times: unequal intervals, 0.0137 s, a start that is not zero."""
    start = dice.choice([0.0, 0.0, 0.31, -0.47])
    if dice.random() < 0.35:
        t, a = elcentro()
        first = dice.randrange(0, 400)
        pairs = [(t[i] - t[first] + start, a[i]) for i in range(first, first + 180)]
        largest = max(abs(a) for _, a in pairs)
        return tuple((t, a * peak / largest) for t, a in pairs)
    n = dice.choice([2, 3, 12, 60])
    steps = dice.choice(["0.0137", "unequal", "unequal"])
    t, values = start, []
    for _ in range(n):
        values.append((t, peak * dice.uniform(-1.0, 1.0)))
        t += 0.0137 if steps == "0.0137" else _log(dice, 1e-4, 0.4)
    if dice.random() < 0.3:
        values[-1] = (values[-1][0], 0.0)
    return tuple(values)


@cache
def elcentro() -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Return times [s] and accelerations [m/s2] of El Centro.

    Returns
    -------
    tuple
        Times and accelerations.
    """
    t, a = [], []
    for line in _elcentro_text().splitlines():
        cells = line.split("#")[0].replace(",", " ").split()
        try:
            t.append(float(cells[0]))
            a.append(9.81 * float(cells[1]))
        except (IndexError, ValueError):
            continue
    return tuple(t), tuple(a)


def _elcentro_text() -> str:
    import tempfile

    with tempfile.TemporaryDirectory() as place:
        path = Path(place) / "elcentro.csv"
        records.export("elcentro", path)
        return path.read_text(encoding="utf-8")


def _log(dice: random.Random, low: float, high: float) -> float:
    return low * (high / low) ** dice.random()
