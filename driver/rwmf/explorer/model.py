"""Answers to the requests of the page, computed by the kernel: texts, numbers and arrays.

This module is independent of HTTP; `worker` runs it in a process separate from the server. Arrays
travel as 32-bit floats in base64, which is ten times faster to write and read than decimal numbers.
Key numbers are texts with all digits.
"""

from __future__ import annotations

import base64
import json
import math
import os
import re
import time
from collections import OrderedDict
from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from rwmf.case import Case
from rwmf.case.case import groups_of_wall
from rwmf.case.elements import heights_of_storeys, total
from rwmf.errors import InputError, NumericalError, RwmfError
from rwmf.explorer.controls import describe
from rwmf.explorer.questions import (
    PRESETS,
    BadQuestionError,
    Question,
    case_of,
    case_of_preset,
    given,
)
from rwmf.figures import levels, loops
from rwmf.figures.film import ground_displacement
from rwmf.kernel import results
from rwmf.kernel.numbers import Array, to_json
from rwmf.motion.records import RECORDS
from rwmf.run.headline import headline_rows, rows_by_title, tendon_yield_of
from rwmf.run.quantities import ENDINGS, Quantity, find

# with these, the acceleration at uplift is no constant of the case
_CHANGING_UPLIFT = ("storeys", "bending", "vertical", "initial", "coupling", "restraint")
# energies that are dissipated, and their names
_DISSIPATED = {
    "impact": "impacts",
    "viscous": "dampers",
    "hysteretic": "yielding",
    "bending_damping": "damping of the wall's modes",
}
# largest storey drift over that of the roof [-] for drifts that hardly differ
_EVEN = 1.05
# a part of the input below this is not mentioned
_LEAST_PART = 0.005


def captions_of(
    case: Case, summary: Mapping[str, Any], t_lift_off: float | None, yields: Sequence[bool]
) -> list[str]:
    """Explain the response of a case."""
    found = [
        _uplift(case, summary, t_lift_off),
        _rotation(case, summary),
        _tendon(summary),
        _concentration(summary),
        _yielding(summary, yields),
        _collapse(summary),
        _energy(summary),
    ]
    return [text for text in found if text]


def uplift_acceleration(case: Case) -> float | None:
    """Compute the ground acceleration at which the resting wall lifts off."""
    if case.wall is None or case.wall.base != "rocking":
        return None
    if any(name in case.groups for name in _CHANGING_UPLIFT) or case.wall.walls > 1:
        return None
    if case.cable is not None and "offset" in case.cable:
        return None
    prestress = 0.0 if case.cable is None else total(case.cable, case.cable.eta_0)
    gamma = 0.0 if case.frame is None else float(case.frame.gamma)
    return float(case.wall.b / case.wall.h) * (1.0 + prestress) / (1.0 + 2.0 * gamma)


def _uplift(case: Case, summary: Mapping[str, Any], t_lift_off: float | None) -> str:
    if case.wall is None or case.wall.base != "rocking":
        return ""
    needed = uplift_acceleration(case)
    if t_lift_off is not None:
        beyond = f", where the ground passes {needed:.2g} g" if needed is not None else ""
        return f"The wall lifts off at {t_lift_off:.2f} s{beyond}."
    if summary.get("theta_max_over_alpha", 0.0) > 0.0:
        return ""
    if needed is None:
        return "No uplift: the base stays closed."
    peak = case.kernel.peak_of_motion() / float(case.model.g)
    return f"No uplift: it needs {needed:.2g} g, and the ground reaches {peak:.2g} g."


def _rotation(case: Case, summary: Mapping[str, Any]) -> str:
    ratio = summary.get("theta_max_over_alpha", 0.0)
    if summary.get("overturned"):
        return "The wall overturns."
    if not ratio > 0.0 or case.wall is None:
        return ""
    alpha = math.atan2(float(case.wall.b), float(case.wall.h))
    size = f"its slenderness α = {alpha:.3g} rad"
    if ratio > 1.0:
        return f"It rotates to {ratio:.3g} times {size}: beyond α its weight overturns it."
    return f"It rotates to {_percent(ratio)} of {size}."


def _tendon(summary: Mapping[str, Any]) -> str:
    if summary.get("cable_ruptured"):
        return "The tendon ruptures."
    loss = summary.get("cable_prestress_loss_over_m_w_g", 0.0)
    if not loss > 0.0:
        return ""
    newtons = summary.get("cable_prestress_loss_N")
    size = f"{loss:.2g} m_w g" if newtons is None else f"{1e-3 * newtons:.3g} kN"
    return f"The tendon yields and loses {size} of its prestress."


def _concentration(summary: Mapping[str, Any]) -> str:
    """Compare the largest storey drift with the drift of the roof."""
    largest, roof = summary.get("storey_drift_max", 0.0), summary.get("roof_drift_max", 0.0)
    if not (largest > 0.0 and roof > 0.0):
        return ""
    storey = next(
        i for i in range(1, 1000) if summary.get(f"storey_{i}_drift_max", largest) == largest
    )
    ratio = f"{largest / roof:.2g} times" if largest > _EVEN * roof else "nearly"
    return f"Storey {storey} has the largest IDR, {100 * largest:.3g} %: {ratio} that of the roof."


def _yielding(summary: Mapping[str, Any], yields: Sequence[bool]) -> str:
    if not yields:
        return ""
    ductility = summary.get("ductility")
    if ductility is None:
        ductility = max(summary[f"storey_{i + 1}_ductility"] for i in range(len(yields)))
    size = f"ductility {ductility:.3g}"
    if not any(yields):
        return f"The frame stays elastic: {size}."
    if len(yields) == 1:
        return f"The frame yields: {size}."
    storeys = [str(i + 1) for i, has_yielded in enumerate(yields) if has_yielded]
    if len(storeys) == 1:
        return f"Storey {storeys[0]} yields: {size}."
    return f"Storeys {', '.join(storeys[:-1])} and {storeys[-1]} yield: largest {size}."


def _collapse(summary: Mapping[str, Any]) -> str:
    if not summary.get("collapsed"):
        return ""
    return f"It collapses at {summary['t_collapse_s']:.2f} s, at a limit of its drift."


def _energy(summary: Mapping[str, Any]) -> str:
    total = summary.get("energy_input_J_per_kg", 0.0)
    if not total > 0.0:
        return ""
    parts = {
        name: summary.get(f"energy_{key}_J_per_kg", 0.0) / total
        for key, name in _DISSIPATED.items()
    }
    if sum(parts.values()) > 1.0 + _LEAST_PART:
        # the weight of a leaning or falling structure adds energy
        return ""
    ordered = sorted(parts.items(), key=lambda part: -part[1])
    texts = [f"{name} {_percent(part)}" for name, part in ordered if part >= _LEAST_PART]
    return f"Of the energy put in by the ground, {', '.join(texts)} at the end." if texts else ""


def _percent(part: float) -> str:
    return f"{100 * part:.0f} %" if part >= 0.0995 else f"{100 * part:.2g} %"


def compare_with_frame(quantity: Quantity, value: float, alone: float | None) -> str:
    """Compare a peak with that of the frame without a wall."""
    if alone is None or not (math.isfinite(value) and math.isfinite(alone) and alone > 0.0):
        return ""
    change = 100.0 * (value / alone - 1.0)
    comparison = f"{_percent(abs(change) / 100)} {'less' if change < 0 else 'more'} than"
    if abs(change) < 0.05:
        comparison = "as much as"
    return f"At the period of the case, {quantity.meaning}: {comparison} the frame alone."


Poll = Callable[[int], None]

# rows of a history: more than the columns of a screen, few enough to draw at once
_ROWS = 1500
# range of the period axis for a case without a period [s]
_PERIODS = (0.05, 3.0)
# time limit of an ordinate, sufficient for a long record. An elastic wall (e = 1) on a stiff frame
# can chatter through a whole record and would block the other periods
_MOST_STEPS = 500_000
# and that of a first answer, which a complete one follows
_FEW_STEPS = 20_000
# number of curves of the bare frame, and of uploaded records, that a process keeps
_KEPT = 32
_KEPT_RECORDS = 3
# history columns drawn by the page
_SHOWN = re.compile(
    r"time$|theta(_dot)?$|u_s$|u_g_ddot$|base_height$|base_slip$|energy_|storey_\d+_drift$"
    r"|floor_\d+_acceleration_g$|q_\d+$"
)
# heights over that of the wall at which its deflected shape is drawn
_SHARE = np.linspace(0.0, 1.0, 25)
# groups that a frame without a wall does not get, beside those of the wall
_NOT_BARE = ("output", "spectrum")
# counters that depend on the requested outputs or on the machine
_NOT_KEY_NUMBERS = ("warnings", "effects", "method", "rtol", "seconds", "rhs_evaluations")


def as_files(case: Case, folder: Path) -> tuple[Case, list[Path]]:
    """Save the motions from arrays as files that a namelist can name."""
    if not case.motions:
        return case, []
    path = folder / "case.nml"
    case.to_namelist(path)
    return Case.from_namelist(path), sorted(folder.glob("case_*.txt"))


def start(case: Case, made: list[Path]) -> dict[str, Any]:
    """Describe keys and the initial case."""
    motion: Mapping[str, Any] = case.groups.get("motion", {})
    return describe() | {
        "name": Path(case.source or "in memory").name,
        "state": given(case),
        "record": Path(str(motion["file"])).name if motion.get("file") else "",
        "made": [path.name for path in made],
        "records": {name: found.variant for name, found in RECORDS.items()},
        "presets": [
            preset._asdict() | {"state": given(case_of_preset(preset.name))} for preset in PRESETS
        ],
    }


def encode(value: object) -> bytes:
    """Encode an answer as JSON."""
    # a file name may contain bytes that are not UTF-8
    return json.dumps(value, allow_nan=False).encode("ascii", "replace")


class Model:
    """Answers to requests about one case and its variants, for any number of pages."""

    def __init__(self, case: Case, folder: Path) -> None:
        self._folder = folder
        self._case = case
        self._record = lru_cache(maxsize=_KEPT_RECORDS)(self._read_record)
        self._alone: OrderedDict[str, Array] = OrderedDict()
        # one processor stays free for the browser, which draws during the next computation
        self._threads = max(1, (os.cpu_count() or 2) - 1)

    def history(self, question: Question, poll: Poll) -> dict[str, Any]:
        """Run a case."""
        case = self._case_of(question)
        t_end = float(case.solver.t_end)
        shown = case.replace(
            output={"dt": t_end / _ROWS if t_end > 0 else 1.0, "energy": True, "reactions": True}
        )
        begun = time.perf_counter()
        with results.start_simulation(shown.kernel, "", poll) as run:
            seconds = time.perf_counter() - begun
            names, values = run.history()
            summary, events = run.summary(), run.events()
            columns = dict(zip((find(name).names("history")[0] for name in names), values,
                               strict=True))  # fmt: skip
            answer = {
                "columns": {
                    name: _pack(column) for name, column in columns.items() if _SHOWN.match(name)
                },
                "impacts": _pack(events["t"][events["kind"] == "impact"]),
                "loops": _loops_of(columns, case),
            }
        if "u_g_ddot" in columns:
            ground = ground_displacement(columns["time"], np.nan_to_num(columns["u_g_ddot"]))
            answer["ground"] = _pack(ground)
        lift_offs = events["t"][events["kind"] == "lift_off"]
        profile = _profile_of(shown, summary)
        both = zip(profile["drift"], profile["yield"], strict=False)
        yields = [peak > level for peak, level in both]
        t_lift_off = float(lift_offs[0]) if lift_offs.size else None
        return answer | {
            "profile": profile,
            "numbers": _key_numbers(summary),
            "headline": list(headline_rows(summary, tendon_yield_of(shown)).items()),
            "groups": _groups_of(summary),
            "captions": captions_of(shown, summary, t_lift_off, yields),
            "method": f"{summary['method']}, rtol = {summary['rtol']:g}",
            "warnings": [*_early_end(case), *summary["warnings"]],
            "namelist": self._namelist(case, question.record),
            "scene": _scene_of(case),
            "kernel_seconds": seconds,
        }

    def spectrum(self, question: Question, poll: Poll) -> dict[str, Any]:
        """Compute the spectrum of a case and that of its frame without a wall."""
        case = self._case_of(question)
        if "T_s" not in case.kernel.axes():
            raise InputError("the scene has no period to vary: it has no spectrum")
        most = _FEW_STEPS if question.quick else _MOST_STEPS
        case = case.replace(solver={"max_steps": min(int(case.solver.max_steps), most)})
        key = _key_of(question.quantity, case)
        periods = _grid(case, question.points)
        begun = time.perf_counter()
        values, status = self._row_of(case, periods, key, poll)
        alone = self._frame_alone(question, case, periods, key, poll)
        caption = self._comparison(question, case, key, poll)
        seconds = time.perf_counter() - begun
        # reasons for missing numbers
        names, counts = np.unique(status[status != "ok"], return_counts=True)
        quantity = find(key)
        return {
            "T": _pack(periods),
            "axis": case.kernel.axes()["T_s"].meaning.replace("2 pi/p", "2π/p").split("; "),
            "values": _pack(values),
            "alone": None if alone is None else _pack(alone),
            "failed": dict(zip(names.tolist(), counts.tolist(), strict=True)),
            "overturned": _pack(periods[np.isin(status, ENDINGS)]),
            "quantity": {"key": key, "unit": quantity.unit, "help": quantity.meaning},
            "caption": caption,
            "quantities": [[name, find(name).meaning] for name in case.kernel.applicable()],
            "kernel_seconds": seconds,
        }

    def cost(self, question: Question, report: Callable[[int, int], None]) -> dict[str, Any]:
        """Measure the cost of accuracy."""
        # quadruple precision needs a second library, loaded on demand
        from rwmf.assess.cost import cost

        found = cost(self._case_of(question), progress=report)
        return dict(to_json(found.to_dict()))

    def add_record(self, number: str, unit: str | None, dt: float | None) -> dict[str, Any]:
        """Check a record uploaded by the page."""
        (path,) = (self._folder / number).iterdir()
        base = self._with_record(path, unit, dt)
        motion = given(base)["motion"]
        # the other processes make the same case from these keys
        self._keys_of(number).write_text(json.dumps(motion), encoding="ascii")
        end = float(f"{base.kernel.end_of_motion():.12g}")
        facts = f"{end:g} s, peak {base.kernel.peak_of_motion() / base.model.g:.3g} g"
        return {"record": number, "name": path.name, "motion": motion, "end": end, "facts": facts}

    def message_of(self, error: RwmfError) -> str:
        """Return the message of an error without the file and lines of a namelist."""
        text = re.sub(r" \(line \d+\)", "", str(error))
        for label in (f"{self._case.source} (edited): ", f"{self._case.source}: "):
            text = text.removeprefix(label)
        # an uploaded record appears under its original name
        return re.sub(rf"{re.escape(str(self._folder))}/[^/]+/", "", text)

    def _with_record(self, path: Path, unit: str | None, dt: float | None) -> Case:
        """Put a record into the case; the kernel detects the keys that the file needs."""
        own = {"kind": "record", "file": str(path), "scale": 1.0}
        # AT2 gives unit and interval, two columns give times
        tries = [own, own | {"unit": unit}, own | {"unit": unit, "dt": dt}]
        problem: InputError | None = None
        scene = self._case.replace(vertical=None, motion=None)
        for keys in tries:
            given_keys = {key: value for key, value in keys.items() if value is not None}
            try:
                return scene.replace(motion=given_keys)
            except InputError as error:
                problem = error
        raise InputError(str(problem))

    def _case_of(self, question: Question) -> Case:
        if not question.record:
            return case_of(question, self._case)
        return case_of(question, self._record(question.record))

    def _keys_of(self, number: str) -> Path:
        """Return the file with the keys of &motion for a record."""
        return self._folder / f"{number}.json"

    def _read_record(self, number: str) -> Case:
        keys = self._keys_of(number)
        if not keys.exists():
            raise BadQuestionError("there is no such record: upload it again")
        (path,) = keys.with_suffix("").iterdir()
        motion = json.loads(keys.read_text(encoding="ascii")) | {"file": str(path)}
        return self._case.replace(vertical=None, motion=None).replace(motion=motion)

    def _namelist(self, case: Case, record: str) -> str:
        text = case.to_namelist()
        # records in the server's folder are saved beside the namelist
        files = [*self._folder.glob("case_*.txt")]
        if record:
            files.append(Path(self._record(record).motion.file))
        for path in files:
            text = text.replace(_quoted(str(path)), _quoted(path.name))
        return text

    def _row_of(
        self, case: Case, periods: Array, key: str, poll: Poll
    ) -> tuple[Array, npt.NDArray[np.str_]]:
        """Return a quantity, NaN for runs that ended early, and the status over periods."""
        with results.start_rows(
            case.kernel, "", ["T_s"], periods[:, None], [key], self._threads, poll
        ) as found:
            values = found.values()
            status = values["status"].ravel()
            found_values = values[key].ravel().astype(np.float64)
            return np.where(np.isin(status, ENDINGS), math.nan, found_values), status

    def _comparison(self, question: Question, case: Case, key: str, poll: Poll) -> str:
        """Compare the case with its frame alone, at its own period."""
        own = _period_of(case)
        if own is None:
            return ""
        period = np.array([own])
        alone = self._frame_alone(question, case, period, key, poll)
        if alone is None:
            return ""
        values, _ = self._row_of(case, period, key, poll)
        return compare_with_frame(find(key), float(values[0]), float(alone[0]))

    def _frame_alone(
        self, question: Question, case: Case, periods: Array, key: str, poll: Poll
    ) -> Array | None:
        """Return the curve of the frame without a wall; it depends on few keys."""
        if "wall" not in question.groups or "frame" not in question.groups:
            return None
        gone = {*_NOT_BARE, *groups_of_wall()}
        changes: dict[str, dict[str, Any] | None] = dict.fromkeys(gone)
        left = {name: keys for name, keys in question.groups.items() if name not in gone}
        changes["frame"] = {"gamma": None}
        if "p_delta" in left and "storeys" not in left and "h_f" not in left["p_delta"]:
            changes["p_delta"] = {"h_f": 2.0 * float(case.wall.h)}
        same = [left, {"gamma": 0}, changes.get("p_delta"), periods.tolist(), key, question.record]
        left["frame"] = {name: x for name, x in left["frame"].items() if name not in
                         ("gamma", "T_s")}  # fmt: skip
        name = json.dumps(same)
        if name not in self._alone:
            try:
                self._alone[name], _ = self._row_of(case.replace(**changes), periods, key, poll)
            except (InputError, NumericalError):
                # a quantity of the wall, or storeys that need a wall
                return None
        self._alone.move_to_end(name)
        if len(self._alone) > _KEPT:
            self._alone.popitem(last=False)
        return self._alone[name]


def _quoted(text: str) -> str:
    """Escape a text for a quoted value of a namelist."""
    return text.replace("'", "''")


def _key_of(word: str, case: Case) -> str:
    """Return the key of a quantity given by key or name, in upper or lower case."""
    for key in case.kernel.applicable():
        if word.lower() in (name.lower() for name in (key, *find(key).names("ordinate"))):
            return key
    return word or case.kernel.default_quantity()


def _early_end(case: Case) -> list[str]:
    """Warn when a run ends before the ground motion."""
    end = case.kernel.end_of_motion()
    t_end = float(case.solver.t_end)
    if not t_end < end * (1.0 - 1e-9):
        return []
    return [f"&solver: t_end = {t_end:.10g} s: the ground motion lasts until {end:.10g} s. "
            "Nothing after t_end is part of these results: raise t_end"]  # fmt: skip


def _pack(values: npt.ArrayLike) -> str:
    """Encode an array as base64 of little-endian 32-bit floats."""
    with np.errstate(over="ignore"):
        return base64.b64encode(np.asarray(values).astype("<f4").tobytes()).decode()


def _key_numbers(summary: dict[str, Any]) -> list[list[str]]:
    """Return key, text with all digits, unit and definition of each named scalar."""
    return [
        [key, _text(value), find(key).unit, find(key).meaning]
        for key, value in summary.items()
        if key not in _NOT_KEY_NUMBERS
    ]


def _text(value: object) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    return repr(value) if isinstance(value, int | float) else str(value)


def _groups_of(summary: dict[str, Any]) -> list[list[Any]]:
    """Return title and rows of each group: meaning, unit, keys from the ground up, keys of times.

    Ratios are absent where the run has the force in N, as in the table of ``rwmf run``.
    """
    known = {key: value for key, value in summary.items() if key not in _NOT_KEY_NUMBERS}
    return [
        [title, [[(row.item.over_levels if "{i}" in row.item.key else row.item).meaning,
                  row.item.unit, row.keys, row.times] for row in rows]]
        for title, rows in rows_by_title(known).items()
    ]  # fmt: skip


def _profile_of(case: Case, summary: dict[str, Any]) -> dict[str, list[float]]:
    """Return heights, peak drifts, drifts at first yield and peak accelerations of the storeys."""
    floors = sum(bool(re.fullmatch(r"floor_\d+_acceleration_max_g", key)) for key in summary)
    heights = heights_of_storeys(case)
    if not floors or not heights:
        return {"heights": [], "drift": [], "yield": [], "acceleration": []}
    named: Any = {find(key).name or key: value for key, value in summary.items()}
    if case.storeys is None:
        drift = [float(summary["u_s_max_m"]) / heights[0]]
        first = levels.levels_of_frame(named, case).first_yield / heights[0]
    else:
        drift = [float(summary[f"storey_{i + 1}_drift_max"]) for i in range(floors)]
        first = levels.levels_of_storeys(named, case, floors).first_yield
    return {
        "heights": heights,
        "drift": drift,
        "yield": first.tolist(),
        "acceleration": [summary[f"floor_{i + 1}_acceleration_max_g"] for i in range(floors)],
    }


def _loops_of(columns: dict[str, Array], case: Case) -> list[dict[str, str]]:
    """Return the loops of the springs, in kN where masses are known."""
    found = []
    for loop in loops.springs_of(columns, case):
        force, label = loop.force, _FORCES.get(loop.kind, "F/(m_w g) [-]")
        if loop.newtons is not None:
            force, label = 1e-3 * loop.newtons, "force [kN]"
        packed = {"displacement": _pack(loop.displacement), "force": _pack(force)}
        found.append({"spring": loop.spring, "kind": loop.kind, "label": label} | packed)
    return found


# labels of forces; others are F/(m_w g)
_FORCES = {"frame": "F_s/(m_s g) [-]", "storey": "V/(m_w g) [-]", "cable": "P/(m_w g) [-]"}


def _scene_of(case: Case) -> dict[str, Any]:
    """Return the dimensions for the sketch of the wall and the marker in the spectrum."""
    found: dict[str, Any] = dict.fromkeys(case.groups, True)
    if case.wall is not None:
        h, b = float(case.wall.h), float(case.wall.b)
        found |= {"h": h, "b": b, "pinned": case.wall.base == "pinned"}
        found["shapes"] = levels.mode_shapes(case, _SHARE).T.tolist()
        found["axes"] = levels.axes_of(case)
        found["lines"] = [
            [line.kind, levels.COLOURS_OF.get(line.kind), line.ends]
            for line in levels.lines_of(case)
        ]
        found["ends"] = levels.outermost(case).tolist()
    if case.storeys is not None:
        found["heights"] = list(case.storeys.height)
        found["coupling"] = case.storeys.coupling
    found["formulation"] = case.model.formulation
    found["g"] = float(case.model.g)
    found["T"] = _period_of(case)
    return found


def _period_of(case: Case) -> float | None:
    """Return the period of the case on the axis of its spectrum [s]."""
    axis = case.kernel.axes().get("T_s")
    return None if axis is None else axis.value


def _grid(case: Case, points: int) -> Array:
    """Return the periods of the spectrum: the case's range, including its period."""
    own = _period_of(case)
    low, high = _PERIODS
    if own and case.frame is None and case.storeys is None:
        # smaller blocks overturn, larger ones hardly rock
        low, high = 0.5 * own, 3.0 * own
    group: Mapping[str, Any] = case.groups.get("spectrum", {})
    if group.get("T_s"):
        low, high = min(group["T_s"]), max(group["T_s"])
    elif group.get("T_s_min") and group.get("T_s_max"):
        low, high = group["T_s_min"], group["T_s_max"]
    if own:
        low, high = min(low, own), max(high, own)
    if not high > low:
        low, high = 0.5 * low, 2.0 * high
    if group.get("spacing") == "log":
        return np.geomspace(low, high, points)
    return np.linspace(low, high, points)
