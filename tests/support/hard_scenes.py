"""Hard cases, and the scene from which most of them are derived."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import rwmf

METHODS = ("adams", "bdf", "taylor", "dop853")

# &solver and &motion are joined key by key, the other groups as well; None takes a group out
Groups = Mapping[str, Mapping[str, object] | None]

_SCENE: dict[str, dict[str, object]] = {
    "wall": {"h": 2.0, "b": 0.5},
    "frame": {"T_s": 1.0, "gamma": 5.0, "xi_s": 0.05},
    "cable": {"eta_0": 1.0, "eta_alpha": 5.0},
    "impact": {"e": 0.9},
    "motion": {"kind": "one_cosine", "a_max_g": 0.4, "omega_p": 2 * math.pi},
    "model": {"formulation": "exact"},
    "solver": {"t_end": 6.0},
}
_PULSE_KEYS = ("a_max_g", "v_p", "omega_p", "T_p", "cycles", "t_0")


@dataclass(frozen=True)
class Hard:
    """One hard case.

    Attributes
    ----------
    name : str
        Difficulty of the case, in a few words.
    groups : mapping
        Differences from the common scene.
    record : tuple of pairs
        Time [s] and acceleration [m/s2] of a record that takes the place of the pulse.
    rtol : float
        Requested tolerance of every method.
    """

    name: str
    groups: Groups
    record: tuple[tuple[float, float], ...] = ()
    rtol: float = 1e-9

    def build(self, folder: Path, method: str = "adams", rtol: float | None = None) -> rwmf.Case:
        """Make the case; a record is written into the folder.

        Parameters
        ----------
        folder : Path
            Folder for the record.
        method : str
            `&solver method`.
        rtol : float, optional
            Another relative tolerance than that of the hard case.

        Returns
        -------
        rwmf.Case
            The case.

        Raises
        ------
        InputError
            When the kernel does not accept it.
        """
        groups = scene(self.groups)
        if self.record:
            path = folder / f"{self.name.replace(' ', '_').replace('/', '_')}.txt"
            lines = (f"{t!r} {a!r}" for t, a in self.record)
            path.write_text("\n".join(lines) + "\n", encoding="utf-8")
            motion = dict(groups["motion"])
            for key in _PULSE_KEYS:
                motion.pop(key, None)
            groups["motion"] = motion | {"kind": "record", "file": str(path), "unit": "m/s2"}
        groups["solver"] = groups["solver"] | {"method": method, "rtol": rtol or self.rtol}
        return rwmf.Case(**groups)


def scene(changes: Groups) -> dict[str, dict[str, object]]:
    """Join changes with the common scene.

    Parameters
    ----------
    changes : mapping
        Groups; a None value takes a key or a group out.

    Returns
    -------
    dict
        Groups for `rwmf.Case`.
    """
    groups = {name: dict(keys) for name, keys in _SCENE.items()}
    for name, keys in changes.items():
        if keys is None:
            groups.pop(name, None)
            continue
        group = groups.setdefault(name, {}) | dict(keys)
        groups[name] = {key: value for key, value in group.items() if value is not None}
    return groups


def wall(alpha: float, h: float = 2.0) -> dict[str, object]:
    """Return `&wall` of a slenderness [rad] and half height [m]."""
    return {"h": h, "b": h * math.tan(alpha)}


def quiet() -> dict[str, object]:
    """Return `&motion` without motion."""
    return {"kind": "none", "a_max_g": None, "omega_p": None}


def sine(a_max_g: float, cycles: float, omega_p: float = 2 * math.pi) -> dict[str, object]:
    """Return `&motion` of several cycles [omega_p in rad/s]."""
    return {"kind": "sine", "a_max_g": a_max_g, "cycles": cycles, "omega_p": omega_p}


def threshold(groups: Groups) -> float:
    """Ground acceleration at which the wall of a scene lifts off [m/s2]."""
    values = scene(groups)
    frame = values.get("frame", {})
    eta = values.get("cable", {}).get("eta_0", 0.0)
    slope = values["wall"]["b"] / values["wall"]["h"]
    return 9.81 * slope * (1 + eta) / (1 + 2 * frame.get("gamma", 0.0))


BLOCK: Groups = {"frame": None, "cable": None}
