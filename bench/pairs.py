"""Combinations of effects: a run of every pair, or the reason for its refusal.

    .venv/bin/python bench/pairs.py            the table of docs/reference/effects.md

Every pair is a small case, which the kernel reads, refuses or runs. A further group, or a further
value of a key that chooses a law, takes one line of ``EFFECTS``.
``tests/python/effects/test_pairs.py`` checks the list against the schema.
"""

from __future__ import annotations

import math
import re
import tempfile
import textwrap
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path
from typing import Any

import rwmf

Groups = dict[str, dict[str, Any] | None]

# groups common to all pairs
SCENE: Groups = {
    "wall": {"h": 2.0, "b": 0.5},
    "frame": {"T_s": 0.5, "gamma": 5.0, "xi_s": 0.05},
    "motion": {"kind": "one_sine", "a_max_g": 0.5, "omega_p": 8.0},
    "model": {"formulation": "symmetric"},
    "solver": {"t_end": 2.0},
    "output": {"energy": True, "reactions": True},
}
CABLE = {"eta_0": 1.0, "eta_alpha": 5.0}
RECORD = {"file": "record.csv", "unit": "g"}
SAMPLES = "0.0, 0.0\n0.2, 0.4\n0.5, -0.5\n0.8, 0.2\n1.0, 0.0\n"  # t (s), a (g)
STOREYS = {"m_over_m_w": [2.5, 2.5], "k_over_m_w": [800.0, 800.0], "height": [2.0, 2.0]}
LINKS = {"springs": {"k_link_over_m_w": [4e3, 6e3]}}
LOSES = {"cap": 4.0, "post_cap": 10.0, "lambda": 100.0, "ultimate": 50.0}
NO_PERIOD: Groups = {"frame": {"T_s": None, "gamma": None}}
BALANCE = 1e-6  # of the energy ledger, relative


@dataclass(frozen=True)
class Effect:
    """An effect, its changes of the scene, and its group in messages."""

    name: str
    changes: Groups
    group: str
    no_element: str = ""  # why an element of a host cannot have it, where matrix.py does not say


EFFECTS = [
    Effect("no wall", {"wall": None, "frame": {"gamma": None}}, "wall"),
    Effect("no frame", {"frame": None}, "frame"),
    Effect("massless frame", {"frame": {"gamma": 0.0}}, "frame"),
    Effect("pinned base", {"wall": {"base": "pinned"}}, "wall"),
    Effect("`published`", {"model": {"formulation": "published"}}, "model"),
    Effect("`exact`", {"model": {"formulation": "exact"}}, "model"),
    Effect("cable, linear", {"cable": CABLE | {"law": "linear"}}, "cable"),
    Effect("cable, truss", {"cable": CABLE | {"law": "truss"}}, "cable"),
    Effect("cable yields", {"cable": CABLE | {"eta_y": 1.2}}, "cable"),
    Effect("cable breaks", {"cable": CABLE | {"rupture_strain": 0.01}}, "cable"),
    Effect("`&link`", {"link": {"L": 6.0}}, "link"),
    Effect("`&damper`", {"damper": {"c_over_m_w": 0.5}}, "damper"),
    Effect("`&nl_damper`", {"nl_damper": {"eta_1": 0.1, "exponent": 0.4}}, "nl_damper"),
    Effect(
        "`&bending`",
        {
            "bending": {
                "EI_over_m_w": 5000.0,
                "modes": 2,
                "xi": 0.1,
                "damping": "stiffness",
            },
            "impact": {"rule": "coupled"},
            "model": {"formulation": "exact"},
        },
        "bending",
        no_element="the modes are states, and an element holds none",
    ),
    Effect("`&fuse`", {"fuse": {"eta_y": 0.3, "stroke_y": 0.01}}, "fuse"),
    Effect(
        "three fuses",
        {"fuse": {"eta_y": [0.1, 0.2, 0.1], "stroke_y": 0.01, "offset": [-0.5, 0.1, 0.5]}},
        "fuse",
    ),
    Effect("two tendons", {"cable": CABLE | {"offset": [-0.2, 0.1], "law": "truss"}}, "cable"),
    *(
        Effect(
            f"`&{group}`, {law}",
            {group: {"eta_y": 0.1, "stroke_y": 0.01, "law": law} | keys} | changes,
            group,
            no_element="what yields has to be remembered",
        )
        for group, keys, changes in (
            ("coupling", {}, {"wall": {"walls": 2}}),
            ("restraint", {"offset": [-0.5, 1.0], "height": 2.0}, {}),
        )
        for law in ("elastic_plastic", "friction", "flag")
    ),
    Effect("`&yielding`", {"yielding": {"u_y": 0.01, "law": "elastic_plastic"}}, "yielding"),
    *(
        Effect(f"`&fuse`, {law}", {"fuse": {"eta_y": 0.3, "stroke_y": 0.01, "law": law}}, "fuse")
        for law in ("friction", "flag")
    ),
    Effect("`&yielding`, Bouc-Wen", {"yielding": {"u_y": 0.01, "law": "bouc_wen"}}, "yielding"),
    *(
        Effect(f"`&yielding`, {law}", {"yielding": {"u_y": 0.01, "law": law} | keys}, "yielding")
        for law, keys in (
            ("friction", {"breakaway": 1.2}),
            ("flag", {"flag_height": 0.9}),
            ("peak_oriented", LOSES),
            ("pinched", LOSES | {"pinch_force": 0.4, "pinch_displacement": 0.3}),
        )
    ),
    *(
        Effect(
            f"`&storeys`, {coupling}",
            NO_PERIOD | {"storeys": STOREYS | LINKS.get(coupling, {}) | {"coupling": coupling}},
            "storeys",
        )
        for coupling in ("reduced", "every_floor", "full", "springs")
    ),
    *(
        Effect(
            f"`&storeys`, {coupling}, {part}",
            NO_PERIOD
            | {
                "storeys": STOREYS | LINKS.get(coupling, {}) | {"coupling": coupling},
                "yielding": {"storey_u_y": [0.006, 0.004], "law": law},
            },
            "yielding" if law == "bouc_wen" else "storeys",
        )
        for coupling, part, law in (
            ("every_floor", "each yields", "elastic_plastic"),
            ("full", "each yields", "elastic_plastic"),
            ("full", "Bouc-Wen", "bouc_wen"),
            ("springs", "each yields", "elastic_plastic"),
            ("springs", "Bouc-Wen", "bouc_wen"),
        )
    ),
    Effect("`&p_delta`", {"p_delta": {}}, "p_delta", "the frame is the host's"),
    Effect("`&p_delta h_f`", {"p_delta": {"h_f": 4.0}}, "p_delta"),
    Effect("`&inerter`", {"inerter": {"inertance_over_m_w": 1.0}}, "inerter"),
    Effect("impact, constant", {"impact": {"rule": "constant", "e": 0.8}}, "impact"),
    Effect("impact, `housner`", {"impact": {"rule": "housner"}}, "impact"),
    Effect("impact, `coupled`", {"impact": {"rule": "coupled"}}, "impact"),
    Effect(
        "impact, table",
        {"impact": {"rule": "table", "table_theta_dot": [0.1, 1.0], "table_e": [0.95, 0.7]}},
        "impact",
    ),
    Effect("vertical, ratio", {"vertical": {"ratio": 0.5}}, "vertical"),
    Effect("vertical, record", {"vertical": RECORD}, "vertical"),
    Effect(
        "horizontal record",
        {"motion": {"kind": "record", "a_max_g": None, "omega_p": None} | RECORD},
        "motion",
    ),
    Effect("no motion", {"motion": None}, "motion"),
    Effect("`&initial`", {"initial": {"theta_over_alpha": 0.2}}, "initial"),
]


@dataclass(frozen=True)
class Outcome:
    """Result of a pair: 'runs', 'refused' with the message, or 'alternatives' of one key."""

    kind: str
    message: str = ""


def joined(*effects: Effect) -> Groups | None:
    """Scene with some effects."""
    wanted: Groups = {}
    for effect in effects:
        for group, keys in effect.changes.items():
            here = wanted.setdefault(group, keys)
            if here is None or keys is None:
                if here is not keys:
                    return None
            elif any(here.get(key, value) != value for key, value in keys.items()):
                return None
            else:
                wanted[group] = here | keys
    groups: Groups = {}
    for group in SCENE | wanted:
        keys = wanted.get(group, {})
        if keys is None:
            continue
        both = (SCENE.get(group) or {}) | keys
        groups[group] = {key: value for key, value in both.items() if value is not None}
    return groups


def prepare(folder: Path) -> None:
    """Write the record that the effects name."""
    (folder / "record.csv").write_text(SAMPLES, encoding="utf-8")


def try_pair(first: Effect, second: Effect, folder: Path) -> Outcome:
    """Read and run a pair."""
    groups = joined(first, second)
    if groups is None:
        return Outcome("alternatives")
    text = "\n".join(
        f"&{group} " + ", ".join(f"{key} = {_value(value)}" for key, value in keys.items()) + " /"
        for group, keys in groups.items()
    )
    try:
        case = rwmf.Case.from_text(text + "\n", source=folder / "pair.nml")
    except rwmf.InputError as error:
        return Outcome("refused", str(error).split("pair.nml: ", 1)[1])
    run = rwmf.simulate(case)
    for name in ("u_s_max", "theta_max_over_alpha", "base_shear_max_over_weight"):
        assert name not in run or math.isfinite(float(run[name])), (text, name)
    if groups["model"] != {"formulation": "published"}:
        assert abs(float(run["energy_balance_relative"])) < BALANCE, text
    return Outcome("runs")


def _value(value: object) -> str:
    if isinstance(value, bool):
        return f".{str(value).lower()}."
    if isinstance(value, list):
        return ", ".join(map(repr, value))
    return repr(value)


def _reason(message: str) -> str:
    """Remove line numbers, which refer to no file, from a message."""
    return re.sub(r" \(line \d+\)", "", message)


def refusals(outcomes: dict[tuple[str, str], Outcome]) -> list[tuple[str, str, str]]:
    """Join the refused pairs that have the same reason."""
    partners: dict[tuple[str, str], list[str]] = {}
    for (first, second), outcome in outcomes.items():
        if outcome.kind == "refused":
            partners.setdefault((_reason(outcome.message), second), []).append(first)
    rows: dict[tuple[str, str], list[str]] = {}
    for (reason, second), firsts in partners.items():
        rows.setdefault((reason, "; ".join(firsts)), []).append(second)
    return [(firsts, "; ".join(seconds), reason) for (reason, firsts), seconds in rows.items()]


def main() -> None:
    """Print the effects and the refused pairs."""
    with tempfile.TemporaryDirectory() as place:
        prepare(Path(place))
        outcomes = {
            (a.name, b.name): try_pair(a, b, Path(place)) for a, b in combinations(EFFECTS, 2)
        }
    kinds = [outcome.kind for outcome in outcomes.values()]
    names = "; ".join(effect.name for effect in EFFECTS)
    print(textwrap.fill(f"The {len(EFFECTS)} effects: {names}.", 118) + "\n")
    print(f"Of their pairs {kinds.count('runs')} run, {kinds.count('alternatives')} are ", end="")
    print(f"alternatives of one key or group, and {kinds.count('refused')} are refused:\n")
    print("| effect | refused with | message |\n|---|---|---|")
    for row in refusals(outcomes):
        print("| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |")


if __name__ == "__main__":
    main()
