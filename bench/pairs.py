"""Combinations of effects: a run of every pair, or the reason for its refusal.

    .venv/bin/python bench/pairs.py            the table of docs/reference/effects.md

Every pair is a small case, which the kernel reads, refuses or runs. A further group, or a further
value of a key that chooses a law, takes one line of ``EFFECTS``.
``tests/python/effects/test_pairs.py`` checks the list against the schema.
"""

import math
import re
import tempfile
import textwrap
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path
from typing import Any

import rwmf
from common import table
from rwmf.case.namelist import compose

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
BUILDINGS: dict[str, Groups] = {
    coupling: {
        "frame": {"T_s": None, "gamma": None},
        "storeys": STOREYS | LINKS.get(coupling, {}) | {"coupling": coupling},
    }
    for coupling in ("reduced", "every_floor", "full", "springs")
}
LOSES = {"cap": 4.0, "post_cap": 10.0, "lambda": 100.0, "ultimate": 50.0}
BALANCE = 1e-6  # of the energy ledger, relative


EFFECTS: dict[str, Groups] = {
    "no wall": {"wall": None, "frame": {"gamma": None}},
    "no frame": {"frame": None},
    "massless frame": {"frame": {"gamma": 0.0}},
    "pinned base": {"wall": {"base": "pinned"}},
    "`published`": {"model": {"formulation": "published"}},
    "`exact`": {"model": {"formulation": "exact"}},
    "cable, linear": {"cable": CABLE | {"law": "linear"}},
    "cable, truss": {"cable": CABLE | {"law": "truss"}},
    "cable yields": {"cable": CABLE | {"eta_y": 1.2}},
    "cable breaks": {"cable": CABLE | {"rupture_strain": 0.01}},
    "`&link`": {"link": {"L": 6.0}},
    "`&damper`": {"damper": {"c_over_m_w": 0.5}},
    "`&nl_damper`": {"nl_damper": {"eta_1": 0.1, "exponent": 0.4}},
    "`&bending`": {
        "bending": {"EI_over_m_w": 5000.0, "modes": 2, "xi": 0.1, "damping": "stiffness"},
        "impact": {"rule": "coupled"},
        "model": {"formulation": "exact"},
    },
    "`&fuse`": {"fuse": {"eta_y": 0.3, "stroke_y": 0.01}},
    "three fuses": {
        "fuse": {"eta_y": [0.1, 0.2, 0.1], "stroke_y": 0.01, "offset": [-0.5, 0.1, 0.5]}
    },
    "two tendons": {"cable": CABLE | {"offset": [-0.2, 0.1], "law": "truss"}},
    **{
        f"`&{group}`, {law}": {group: {"eta_y": 0.1, "stroke_y": 0.01, "law": law} | keys} | more
        for group, keys, more in (
            ("coupling", {}, {"wall": {"walls": 2}}),
            ("restraint", {"offset": [-0.5, 1.0], "height": 2.0}, {}),
        )
        for law in ("elastic_plastic", "friction", "flag")
    },
    **{
        f"`&base`, {part}": {
            "base": {"k_t_over_m_w": 2e4, "xi": 0.2} | keys,
            "model": {"formulation": "exact"},
        }
        for part, keys in (
            ("elastic", {}),
            ("slides", {"mu": 0.2}),
            ("crushes", {"d_y": 4e-3, "strips": 12}),
        )
    },
    "`&yielding`": {"yielding": {"u_y": 0.01, "law": "elastic_plastic"}},
    **{
        f"`&fuse`, {law}": {"fuse": {"eta_y": 0.3, "stroke_y": 0.01, "law": law}}
        for law in ("friction", "flag")
    },
    "`&yielding`, Bouc-Wen": {"yielding": {"u_y": 0.01, "law": "bouc_wen"}},
    **{
        f"`&yielding`, {law}": {"yielding": {"u_y": 0.01, "law": law} | keys}
        for law, keys in (
            ("friction", {"breakaway": 1.2}),
            ("flag", {"flag_height": 0.9}),
            ("peak_oriented", LOSES),
            ("pinched", LOSES | {"pinch_force": 0.4, "pinch_displacement": 0.3}),
        )
    },
    **{f"`&storeys`, {coupling}": groups for coupling, groups in BUILDINGS.items()},
    **{
        f"`&storeys`, {coupling}, {part}": BUILDINGS[coupling]
        | {"yielding": {"storey_u_y": [0.006, 0.004], "law": law}}
        for coupling, part, law in (
            ("every_floor", "each yields", "elastic_plastic"),
            ("full", "each yields", "elastic_plastic"),
            ("full", "Bouc-Wen", "bouc_wen"),
            ("springs", "each yields", "elastic_plastic"),
            ("springs", "Bouc-Wen", "bouc_wen"),
        )
    },
    "`&p_delta`": {"p_delta": {}},
    "`&p_delta h_f`": {"p_delta": {"h_f": 4.0}},
    "`&inerter`": {"inerter": {"inertance_over_m_w": 1.0}},
    "impact, constant": {"impact": {"rule": "constant", "e": 0.8}},
    "impact, `housner`": {"impact": {"rule": "housner"}},
    "impact, `coupled`": {"impact": {"rule": "coupled"}},
    "impact, table": {
        "impact": {"rule": "table", "table_theta_dot": [0.1, 1.0], "table_e": [0.95, 0.7]}
    },
    "vertical, ratio": {"vertical": {"ratio": 0.5}},
    "vertical, record": {"vertical": RECORD},
    "horizontal record": {"motion": {"kind": "record", "a_max_g": None, "omega_p": None} | RECORD},
    "no motion": {"motion": None},
    "`&initial`": {"initial": {"theta_over_alpha": 0.2}},
}
"""Changes of the scene by the name of an effect."""


@dataclass(frozen=True)
class Outcome:
    """Result of a pair: 'runs', 'refused' with the message, or 'alternatives' of one key."""

    kind: str
    message: str = ""


def joined(*effects: Groups) -> Groups | None:
    """Scene with some effects."""
    wanted: Groups = {}
    for effect in effects:
        for group, keys in effect.items():
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


def try_pair(first: str, second: str, folder: Path) -> Outcome:
    """Read and run a pair."""
    groups = joined(EFFECTS[first], EFFECTS[second])
    if groups is None:
        return Outcome("alternatives")
    text = compose(groups)
    try:
        case = rwmf.Case.from_text(text, source=folder / "pair.nml")
    except rwmf.InputError as error:
        return Outcome("refused", str(error).split("pair.nml: ", 1)[1])
    run = rwmf.simulate(case)
    for name in ("u_s_max", "theta_max_over_alpha", "base_shear_max_over_weight"):
        assert name not in run or math.isfinite(float(run[name])), (text, name)
    if groups["model"] != {"formulation": "published"}:
        assert abs(float(run["energy_balance_relative"])) < BALANCE, text
    return Outcome("runs")


def refusals(outcomes: dict[tuple[str, str], Outcome]) -> list[tuple[str, str, str]]:
    """Join the refused pairs that have the same reason."""
    partners: dict[tuple[str, str], list[str]] = {}
    for (first, second), outcome in outcomes.items():
        if outcome.kind == "refused":
            # line numbers refer to no file
            reason = re.sub(r" \(line \d+\)", "", outcome.message)
            partners.setdefault((reason, second), []).append(first)
    rows: dict[tuple[str, str], list[str]] = {}
    for (reason, second), firsts in partners.items():
        rows.setdefault((reason, "; ".join(firsts)), []).append(second)
    return [(firsts, "; ".join(seconds), reason) for (reason, firsts), seconds in rows.items()]


def main() -> None:
    """Print the effects and the refused pairs."""
    with tempfile.TemporaryDirectory() as place:
        prepare(Path(place))
        outcomes = {pair: try_pair(*pair, Path(place)) for pair in combinations(EFFECTS, 2)}
    kinds = [outcome.kind for outcome in outcomes.values()]
    names = "; ".join(EFFECTS)
    print(textwrap.fill(f"The {len(EFFECTS)} effects: {names}.", 118) + "\n")
    print(f"Of their pairs {kinds.count('runs')} run, {kinds.count('alternatives')} are ", end="")
    print(f"alternatives of one key or group, and {kinds.count('refused')} are refused:\n")
    print(table(("effect", "refused with", "message"), refusals(outcomes)))


if __name__ == "__main__":
    main()
