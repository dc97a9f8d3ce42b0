"""Errors of random ordinates with any effects, over rtol and their conditioning.

    .venv/bin/python bench/random_ordinates.py OTHER [--seed 1] [--ordinates 1500]
    .venv/bin/python bench/random_ordinates.py OTHER --seed S --scene K

OTHER is a checkout of version 0.7.0, whose extension is linked into driver/rwmf; its `dop853` at
rtol 1e-12 gives the reference. A scene is a seed and a number. It has a rigid or bending wall, a
frame or storeys, any law and device, and rtol from 1e-3 to 1e-11. Its motion is El Centro, Pacoima,
noise of a far fault, lines with jumps or a pulse, with factors up to those near a fault. Its
ordinates have random periods and factors. All quantities are requested together, and some of them
alone.

An error is given over the allowed one: rtol times the quantity, or times its derivative by the
relative size of the motion if that is larger. The derivative comes from reference motions that
differ by 1e-6 and by rtol; for values at the end of a vibration also from another period.
Quantities at the end, and signed ones, are compared with the largest of
their kind. Errors are not judged where a change of the motion by rtol changes the quantity by more
than `CHAOTIC`, or the status. Each bad ordinate is one line. The exit status is 1 when an ordinate
has an error beyond `WRONG`, fails, or has another status.
"""

from __future__ import annotations

import argparse
import math
import random
import re
import sys
import tempfile
from collections import defaultdict
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from figures import ROOT, Build

sys.path.insert(0, str(ROOT / "tests" / "support"))

import combinations
import pairs
from bending_scenes import bending_scene

REFERENCE = {"method": "dop853", "rtol": 1e-12, "max_steps": 30_000}
ORDINATES, ALONE = 8, 4  # of a scene: ordinates, and quantities that are requested alone
NUDGE = 1e-6
LIKELY, WRONG = 3.0, 30.0  # errors over the allowed ones that are counted
CHAOTIC = 0.05
NOTHING = 1e-12  # of any unit
PATIENCE = 8.0, 60.0  # for a reference and for an answer [s]
PERIODS = 0.05, 3.0  # s
# an argument of the maximum jumps between rivals; counts and balances have no accuracy
LEFT_OUT = re.compile(r"_height_m$|^t_|^energy_balance|^impacts$|^lift_offs$|^pivot_lifts$"
                      r"|^overturned$|^cable_ruptured$|^collapsed$")  # fmt: skip
# values at the end of a vibration: the derivative by its period counts as well
PHASE = re.compile(r"^theta_end|^energy_(kinetic|strain|gravity|cable|bending_J)")
# a quantity, and the one whose size its error is compared with
SIZES = (
    (r"storey_residual_drift_max", "storey_drift_max"),
    (r"residual_drift(_at_rest)?$", "drift_max"),
    (r"residual_displacement_m$", "u_s_max_m"),
    (r"theta_end_over_alpha", "theta_max_over_alpha"),
    (r"pivot_normal_min", "pivot_normal_max"),
)
Groups = dict[str, dict[str, Any]]
Samples = Sequence[tuple[float, float]]


class Scene(NamedTuple):
    """A case, its class and that of its motion, and the samples of its records by group."""

    kind: str
    motion: str
    groups: Groups
    records: dict[str, Samples]


class Finding(NamedTuple):
    """The worst quantity of an ordinate, or the reason why it has none."""

    scene: int
    place: str
    error: float = 0.0
    key: str = ""
    note: str = ""


def draw(dice: random.Random) -> Scene:
    """Draw the groups of a scene and its motion."""
    number, family, records = dice.randrange(10**6), dice.random(), {}
    if family < 0.3:
        made = combinations.spectrum_combination(number)
        groups = {k: dict(v) for k, v in made.groups.items() if k != "spectrum"}
        groups["frame"]["T_s"] = 1.0
        records = {"motion": made.horizontal}
    elif family < 0.75:
        make = dice.choice([combinations.combination, combinations.further_combination])
        made = make(number)
        groups = {k: dict(v) for k, v in made.groups.items()}
        records = {"motion": made.horizontal, "vertical": made.vertical}
        storeys = groups.get("storeys", {})
        if storeys.get("coupling") == "every_floor" and dice.random() < 0.5:
            storeys |= {"coupling": "springs", "k_link_over_m_w": 10 ** dice.uniform(2.5, 5.0)}
    elif family < 0.9:
        both = None
        while both is None:
            both = pairs.joined(*dice.sample(pairs.EFFECTS, dice.choice([1, 2, 2, 3])))
        groups = {k: dict(v) for k, v in both.items() if v is not None}
        lines = [tuple(map(float, row.split(","))) for row in pairs.SAMPLES.split("\n") if row]
        records = {name: [(t, 9.81 * a) for t, a in lines] for name in ("motion", "vertical")
                   if "file" in groups.get(name, {})}  # fmt: skip
    else:
        groups, record = bending_scene(number)
        if record:
            groups["motion"] = {"kind": "record"}
            records["motion"] = list(zip(record["times"], record["values"], strict=True))
    groups.setdefault("solver", {})
    groups["output"] = {"reactions": True, "energy": True}
    if "wall" in groups and groups["wall"].get("base") != "pinned":
        groups.setdefault("impact", {"rule": "constant", "e": 1.0} if "bending" not in groups
                          else {"rule": "coupled"})  # fmt: skip
    motion = "as drawn"
    if "motion" not in groups or dice.random() < 0.6:
        motion = _move(dice, groups, records)
    for group, samples in records.items():
        if samples:
            groups[group] |= {"unit": "m/s2"}
    return Scene(_class_of(groups), motion, groups, {k: v for k, v in records.items() if v})


def _move(dice: random.Random, groups: Groups, records: dict[str, Samples]) -> str:
    """Replace the motion and return its name."""
    records.pop("motion", None)
    longest = 4.0 if "bending" in groups or "storeys" in groups else 60.0
    groups["solver"] |= {"t_end": min(longest, dice.choice([8.0, 60.0]))}
    kind = dice.choice(["El Centro", "El Centro", "Pacoima", "far field", "jumps", "near pulse"])
    if kind == "near pulse":
        groups["motion"] = {
            "kind": "mavroeidis_papageorgiou", "a_max_g": dice.uniform(0.2, 1.2),
            "T_p": dice.uniform(0.5, 3.0), "gamma_p": dice.uniform(1.1, 3.0),
            "nu": dice.choice([0.0, 2.0]),
        }  # fmt: skip
        groups["solver"]["t_end"] = min(longest, 15.0)
    elif kind in ("El Centro", "Pacoima"):
        file = ROOT / "inputs" / "records" / f"{kind.replace(' ', '').lower()}.csv"
        scale = 10 ** dice.uniform(-0.5, 0.9) / (3.5 if kind == "Pacoima" else 1.0)
        groups["motion"] = {"kind": "record", "file": str(file), "scale": scale}
        groups["motion"] |= {"unit": "g"} if kind == "El Centro" else {}
    else:
        groups["motion"] = {"kind": "record"}
        records["motion"] = (_jumps if kind == "jumps" else _noise)(dice)
    return kind


def _jumps(dice: random.Random) -> Samples:
    """Draw steps of the ground's acceleration that last 1e-5 to 1e-2 s, with lines between."""
    t, a, made = 0.0, 0.0, [(0.0, 0.0)]
    peak, rise = 9.81 * 10 ** dice.uniform(-0.7, 0.1), 10 ** dice.uniform(-5, -2)
    for _ in range(dice.choice([4, 12, 40])):
        t, a = t + dice.uniform(0.02, 0.5), a * dice.choice([0.0, 1.0, -1.0])
        made.append((t, a))
        t, a = t + rise, peak * dice.uniform(-1.0, 1.0)
        made.append((t, a))
    return [*made, (t + 0.3, 0.0)]


def _noise(dice: random.Random) -> Samples:
    """Draw a long noise of few frequencies under an envelope: a record far from the fault."""
    n, dt = 3000, dice.choice([0.005, 0.01, 0.02])
    peak = 9.81 * 10 ** dice.uniform(-1.0, 0.0)
    waves = [(dice.uniform(0.3, 6.0), dice.uniform(0.0, 6.3)) for _ in range(12)]
    shape = [min(1.0, i / 600) * math.exp(-3 * max(0.0, i / n - 0.5)) for i in range(n)]
    return [(dt * i, peak / 6 * shape[i] * sum(math.sin(6.283 * f * dt * i + p) for f, p in waves))
            for i in range(n)]  # fmt: skip


def _class_of(groups: Groups) -> str:
    """Name the structure and the hardest of its effects."""
    coupling = groups.get("storeys", {}).get("coupling", "reduced")
    law = groups.get("yielding", {}).get("law", "bilinear") if "yielding" in groups else ""
    if "bending" in groups:
        structure = "bending wall"
    elif "wall" not in groups:
        structure = "frame alone"
    elif "storeys" in groups:
        structure = f"storeys {coupling}"
    else:
        structure = "wall and frame" if "frame" in groups else "block"
    if law == "bouc_wen" or "nl_damper" in groups:
        return f"{structure}, corners"
    if law in ("peak_oriented", "pinched"):
        return f"{structure}, loss of strength"
    if law or "fuse" in groups or groups.get("cable", {}).keys() & {"eta_y", "rupture_strain"}:
        return f"{structure}, branches"
    is_plain = not groups.keys() & {"damper", "inerter", "link", "vertical", "p_delta", "initial"}
    return f"{structure}, {'plain' if is_plain else 'devices'}"


class Campaign:
    """Two builds, and the findings of a seed."""

    def __init__(self, other: Path, seed: int, folder: Path) -> None:
        self.here, self.there, self.seed, self.folder = Build(ROOT), Build(other), seed, folder
        self.by_class: dict[str, list[Finding]] = defaultdict(list)
        self.by_motion: dict[str, list[Finding]] = defaultdict(list)

    def check(self, number: int, is_loud: bool = False) -> None:
        """Compare the ordinates of a scene with their reference."""
        dice = random.Random(f"{self.seed} {number}")
        scene = draw(dice)
        for group, samples in scene.records.items():
            path = self.folder / f"{number}_{group}.txt"
            path.write_text("".join(f"{t!r} {a!r}\n" for t, a in samples), encoding="utf-8")
            scene.groups[group]["file"] = str(path)
        rtol = 10 ** -dice.uniform(3.0, 11.0)
        if is_loud:
            print(f"rtol {rtol!r}, {scene.motion}\n{scene.groups}")
        found = self._compare(number, scene, dice, rtol, is_loud)
        self.by_class[scene.kind] += found
        self.by_motion[scene.motion] += found
        for group in scene.records:
            Path(scene.groups[group]["file"]).unlink()

    def _compare(self, number: int, scene: Scene, dice: random.Random, rtol: float,
                 is_loud: bool) -> list[Finding]:  # fmt: skip
        groups = scene.groups
        tight = groups | {"solver": groups["solver"] | REFERENCE}
        loose = groups | {"solver": groups["solver"] | {"rtol": rtol, "max_steps": 300_000}}
        there, here = (build.ask(PATIENCE[1], kind="keys", groups=g)
                       for build, g in ((self.there, tight), (self.here, loose)))  # fmt: skip
        if "error" in there or "error" in here:
            who = "both builds" if "error" in there and "error" in here else "one build"
            reason = here.get("error", there.get("error"))
            return [Finding(number, "", note=f"refused by {who}: {reason}")]
        keys = [key for key in here["keys"] if key in there["keys"] and not LEFT_OUT.search(key)]
        columns = ["T_s", "scale"] if "T_s" in here["axes"] else ["scale"]
        low, high = PERIODS
        rows = [[low * (high / low) ** dice.random(), 2 ** dice.uniform(-1, 1.5)][-len(columns) :]
                for _ in range(ORDINATES)]  # fmt: skip
        changes = [(0.0, 0.0), *((0.0, d) for d in (NUDGE, -NUDGE, rtol)), (NUDGE, 0.0)]
        table = [[x * (1 + d) for x, d in zip(row, some[-len(row) :], strict=True)]
                 for row in rows for some in changes]  # fmt: skip
        words = {"kind": "rows", "columns": columns}
        truth = self.there.ask(PATIENCE[0], groups=tight, table=table, keys=keys, **words)
        if "error" in truth:
            return [Finding(number, "", note=f"no reference: {truth['error'][:80]}")]
        asked = {"together": keys} | {
            key: [key] for key in dict.fromkeys(keys[:1] + dice.sample(keys, min(ALONE, len(keys))))
        }
        answers = {
            name: self.here.ask(PATIENCE[1], groups=loose, table=rows, keys=some, **words)
            for name, some in asked.items()
        }
        found = []
        for i, row in enumerate(rows):
            near = {
                key: truth[key][i * len(changes) : (i + 1) * len(changes)]
                for key in ("status", *keys)
            }
            allowed = _allowed(near, changes, keys, rtol)
            at = ", ".join(f"{name} {x:.17g}" for name, x in zip(columns, row, strict=True))
            place = f"{scene.kind}; {scene.motion}; rtol {rtol:.1e}; {at}"
            worst = Finding(number, place)
            for name, answer in answers.items():
                one = _judge(answer, i, near, allowed, asked[name])
                if is_loud:
                    print(f"{place} {name}: {one}")
                if one[2] or not one[0] <= worst.error:
                    how = name if name == "together" else "alone"
                    worst = Finding(number, place, one[0], f"{one[1]}, {how}", one[2])
                if one[2]:
                    break
            found.append(worst)
        return found


def _allowed(near: dict[str, Any], changes: Sequence[tuple[float, float]], keys: Sequence[str],
             rtol: float) -> dict[str, float]:  # fmt: skip
    """Error that rtol and conditioning allow each quantity; infinite where it is chaotic."""
    energies = max((abs(near[key][0]) for key in keys if key.startswith("energy")), default=0.0)
    found = {}
    for key in keys:
        x = near[key]
        size = max(abs(x[0]), NOTHING, energies if key.startswith("energy") else 0.0)
        for pattern, other in SIZES:
            like = re.sub(pattern, other, key)
            if like != key and like in near:
                size = max(size, abs(near[like][0]))
        slope = max(
            abs(y - x[0]) * rtol / abs(period + scale)
            for y, (period, scale) in zip(x[1:], changes[1:], strict=True)
            if period == 0 or PHASE.search(key)
        )
        found[key] = max(rtol * size, slope) if slope <= CHAOTIC * size else math.inf
    return found


def _judge(answer: dict[str, Any], i: int, near: dict[str, Any], allowed: dict[str, float],
           keys: Sequence[str]) -> tuple[float, str, str]:  # fmt: skip
    """Return the largest error over the allowed one, its quantity, and a note on the status."""
    statuses = set(near["status"])
    if "error" in answer:
        return 0.0, "", f"failed: {answer['error'][:80]}"
    status = answer["status"][i]
    if statuses - {"ok", "overturned", "collapsed"} or (len(statuses) > 1 and status in statuses):
        return 0.0, "", "not judged"
    if status not in statuses:
        return 0.0, "", f"status {status}; reference {near['status'][0]}"
    if all(math.isinf(allowed[key]) for key in keys):
        return 0.0, "", "chaotic"
    worst, name = 0.0, ""
    for key in keys:
        x, truth = answer[key][i], near[key][0]
        if math.isnan(truth) or (status != "ok" and math.isnan(x)):
            continue
        error = 0.0 if x == truth else abs(x - truth) / allowed[key]
        if not error <= worst:
            worst, name = (math.inf if math.isnan(error) else error), key
    return worst, name, ""


def _table(findings: dict[str, list[Finding]]) -> Iterator[str]:
    """Yield the lines of a table by classes."""
    levels = LIKELY, WRONG
    heads = ("class", "ordinates", "largest error", *(f"beyond {level:g}" for level in levels),
             "failed", "status", "not judged")  # fmt: skip
    yield "| " + " | ".join(heads) + " |\n|" + len(heads) * "---|"
    everything = [one for some in findings.values() for one in some]
    for name, found in [*sorted(findings.items()), ("all", everything)]:
        errors = [one.error for one in found if not one.note]
        counts = [sum(error > level for error in errors) for level in levels]
        failed = sum(one.note.startswith("failed") for one in found)
        status = sum(one.note.startswith("status") for one in found)
        rest = sum(bool(one.note) for one in found) - failed - status
        cells = name, len(found), f"{max(errors, default=0):.2g}", *counts, failed, status, rest
        yield "| " + " | ".join(map(str, cells)) + " |"


def main() -> int:
    """Print the tables and every bad ordinate; 1 when there is one."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("other", type=Path, help="checkout of version 0.7.0")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--ordinates", type=int, default=1500)
    parser.add_argument("--scene", type=int, help="the only scene, with all its numbers")
    options = parser.parse_args()
    one_scene = options.scene is not None
    numbers = [options.scene] if one_scene else range(-(-options.ordinates // ORDINATES))
    with tempfile.TemporaryDirectory() as folder:
        campaign = Campaign(options.other.resolve(), options.seed, Path(folder))
        for number in numbers:
            campaign.check(number, is_loud=one_scene)
            print(f"scene {number}", end="\r", file=sys.stderr, flush=True)
    for by in (campaign.by_class, campaign.by_motion):
        print("\n".join([*_table(by), ""]))
    bad = 0
    found = [one for some in campaign.by_class.values() for one in some]
    for one in sorted(found, key=lambda one: -one.error):
        is_bad = one.error > WRONG or one.note.startswith(("failed", "status"))
        bad += is_bad
        if is_bad or one.error > LIKELY or one.note.startswith(("refused by one", "no reference")):
            what = f"{one.note}, {one.key}" if one.note else f"{one.error:.2g} x, {one.key}"
            print(f"--seed {options.seed} --scene {one.scene}: {what}; {one.place}")
    return int(bad > 0)


if __name__ == "__main__":
    sys.exit(main())
