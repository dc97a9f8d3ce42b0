"""What the page shows, from the kernel: answers to its questions as texts, numbers and arrays.

Nothing here knows HTTP; `worker` runs it in a process apart from the server. Arrays are sent as
bytes of 32-bit floats in base64, which is made and read ten times faster than numbers as text; the
key numbers are texts of all their digits.
"""

from __future__ import annotations

import base64
import json
import math
import os
import re
import time
from collections import OrderedDict
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from rwmf import _library, loops
from rwmf._explore.controls import describe
from rwmf._explore.questions import BadQuestionError, Question, case_of, given
from rwmf.case import Case
from rwmf.errors import InputError, NumericalError, RwmfError
from rwmf.plotting.animation import ground_displacement
from rwmf.quantities import find

__all__ = ["Model", "as_files", "encode", "start"]

Watch = Callable[[int], None]
Array = npt.NDArray[np.float64]

# rows of a history: more than a screen has columns, few enough to be drawn at once
_ROWS = 1500
# a period axis that contains the case's own, where the case has none [s]
_PERIODS = (0.05, 3.0)
# of an ordinate: beyond the samples of a long record; an elastic wall (e = 1) on a stiff frame
# chatters through a record without end, and would hold up all other periods
_MOST_STEPS = 500_000
# curves of the frame alone, and uploaded records, that a process keeps
_KEPT = 32
_KEPT_RECORDS = 3
# columns of a history that the page draws
_SHOWN = re.compile(r"time$|theta$|u_s$|u_g_ddot$|energy_|floor_\d+$|storey_\d+_drift$")
# groups that a frame without a wall does not have, whatever they need
_NOT_BARE = ("output", "spectrum", "cable", "impact", "initial")
# work of a run that depends on what else is asked for, or on the machine
_NOT_KEY_NUMBERS = ("warnings", "effects", "method", "rtol", "seconds", "rhs_evaluations")


class _Record(NamedTuple):
    """A record that a page has sent."""

    path: Path
    base: Case


def as_files(case: Case, folder: Path) -> tuple[Case, list[Path]]:
    """Save the motions of a case from arrays, so that its namelist can name them.

    Parameters
    ----------
    case : Case
        The case.
    folder : Path
        Where to save them.

    Returns
    -------
    Case
        The case with files in place of arrays.
    list of Path
        These files.
    """
    if not case.motions:
        return case, []
    path = folder / "case.nml"
    case.to_namelist(path)
    return Case.from_namelist(path), sorted(folder.glob("case_*.txt"))


def start(case: Case, made: list[Path]) -> dict[str, Any]:
    """Describe keys, and the case to begin with.

    Parameters
    ----------
    case : Case
        The case.
    made : list of Path
        Files of its motions from arrays.

    Returns
    -------
    dict
        As `controls.describe`, with ``name``, ``state``, ``record``, ``made``.
    """
    motion: Mapping[str, Any] = case.groups.get("motion", {})
    return describe() | {
        "name": Path(case.source or "in memory").name,
        "state": given(case),
        "record": Path(str(motion["file"])).name if motion.get("file") else "",
        "made": [path.name for path in made],
    }


def encode(value: object) -> bytes:
    """Write an answer as JSON.

    Parameters
    ----------
    value : object
        Numbers, texts, lists and dicts.

    Returns
    -------
    bytes
        One line without its end.
    """
    # a name of a file may hold bytes that are no text
    return json.dumps(value, allow_nan=False).encode("ascii", "replace")


class Model:
    """Answers to the questions of any number of pages about one case and its variants.

    Parameters
    ----------
    case : Case
        What the pages begin with.
    folder : Path
        Where uploaded records are, each in a folder with its number.
    """

    def __init__(self, case: Case, folder: Path) -> None:
        self._folder = folder
        self._case = case
        self._records: OrderedDict[str, _Record] = OrderedDict()
        self._alone: OrderedDict[str, str] = OrderedDict()
        # one for the browser, which draws while the next question is computed
        self._threads = max(1, (os.cpu_count() or 2) - 1)

    def history(self, question: Question, watch: Watch) -> dict[str, Any]:
        """Run a case.

        Parameters
        ----------
        question : Question
            Which case.
        watch : callable
            Called about 20 times a second; what it raises stops the kernel.

        Returns
        -------
        dict
            Columns over time, instants of impacts, loops, key numbers, warnings, namelist.

        Raises
        ------
        InputError, NumericalError
            As the kernel reports them.
        BadQuestionError
            When there is no such record.
        """
        case = self._case_of(question)
        t_end = float(case.solver.t_end)
        shown = case.replace(
            output={"dt": t_end / _ROWS if t_end > 0 else 1.0, "energy": True, "reactions": True}
        )
        begun = time.perf_counter()
        with _library.start_simulation(shown.kernel, "", watch) as run:
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
        return answer | {
            "numbers": _key_numbers(summary),
            "method": f"{summary['method']}, rtol = {summary['rtol']:g}",
            "warnings": [*_early_end(case), *summary["warnings"]],
            "namelist": self._namelist(case, question.record),
            "scene": _scene_of(case),
            "kernel_seconds": seconds,
        }

    def spectrum(self, question: Question, watch: Watch) -> dict[str, Any]:
        """Compute a spectrum of a case over periods, and that of its frame alone.

        Parameters
        ----------
        question : Question
            Which case, how many periods, which quantity.
        watch : callable
            As in `history`.

        Returns
        -------
        dict
            ``T``, ``values``, ``alone`` (None without one), ``failed`` (how many of each status),
            ``overturned`` (periods), what the quantity is, and which others the scene has.

        Raises
        ------
        InputError, NumericalError
            As the kernel reports them.
        BadQuestionError
            When there is no such record.
        """
        case = self._case_of(question)
        if "T_s" not in case.kernel.axes():
            raise InputError("the scene has no period to vary: it has no spectrum")
        case = case.replace(solver={"max_steps": min(int(case.solver.max_steps), _MOST_STEPS)})
        key = _key_of(question.quantity, case)
        periods = _grid(case, question.points)
        begun = time.perf_counter()
        values, status = self._row_of(case, periods, key, watch)
        alone = self._frame_alone(question, case, periods, key, watch)
        seconds = time.perf_counter() - begun
        # status names of what is no number
        names, counts = np.unique(status[status != "ok"], return_counts=True)
        quantity = find(key)
        return {
            "T": _pack(periods),
            "values": _pack(values),
            "alone": alone,
            "failed": dict(zip(names.tolist(), counts.tolist(), strict=True)),
            "overturned": _pack(periods[np.isin(status, ("overturned", "collapsed"))]),
            "quantity": {"key": key, "unit": quantity.unit, "help": quantity.meaning},
            "quantities": [[name, find(name).meaning] for name in case.kernel.applicable()],
            "kernel_seconds": seconds,
        }

    def cost(self, question: Question, report: Callable[[int, int], None]) -> dict[str, Any]:
        """Measure what accuracy costs.

        Parameters
        ----------
        question : Question
            Which case.
        report : callable
            Called with the number of finished units of work and of all; what it raises ends it.

        Returns
        -------
        dict
            As ``rwmf cost --json``; what is not finite is None.

        Raises
        ------
        InputError, NumericalError
            As the kernel reports them.
        """
        # quadruple precision is in a library of its own, which is loaded when it is needed
        from rwmf._cost import cost

        found = cost(self._case_of(question), progress=report)
        return dict(_plain(found.to_dict()))

    def add_record(self, number: str, unit: str | None, dt: float | None) -> dict[str, Any]:
        """Check a record that a page has sent.

        Parameters
        ----------
        number : str
            Of its folder, which holds this one file.
        unit : str, optional
            Of its accelerations, unless the file says it.
        dt : float, optional
            Interval of its samples [s], where the file has one column.

        Returns
        -------
        dict
            ``record`` (its number), ``name``, ``motion`` (keys of the group), ``end`` (time of its
            last sample), ``facts``.

        Raises
        ------
        InputError
            When the kernel does not accept the record; the message names the file as its owner
            does.
        """
        (path,) = (self._folder / number).iterdir()
        base = self._with_record(path, unit, dt)
        motion = given(base)["motion"]
        # the other processes make the same case of it
        self._keys_of(number).write_text(json.dumps(motion), encoding="ascii")
        end = float(f"{base.kernel.end_of_motion():.12g}")
        facts = f"{end:g} s, peak {base.kernel.peak_of_motion() / base.model.g:.3g} g"
        return {"record": number, "name": path.name, "motion": motion, "end": end, "facts": facts}

    def plainly(self, error: RwmfError) -> str:
        """Say what is wrong without file and lines of a namelist, which the page does not have.

        Parameters
        ----------
        error : RwmfError
            Of a question.

        Returns
        -------
        str
            The message.
        """
        text = re.sub(r" \(line \d+\)", "", str(error))
        for label in (f"{self._case.source} (edited): ", f"{self._case.source}: "):
            text = text.removeprefix(label)
        # an uploaded record has the name that its owner gave it
        return re.sub(rf"{re.escape(str(self._folder))}/[^/]+/", "", text)

    def _with_record(self, path: Path, unit: str | None, dt: float | None) -> Case:
        """Put a record into the case; which keys it takes is seen from the file by the kernel."""
        own = {"kind": "record", "file": str(path), "scale": 1.0}
        # AT2 has unit and interval, two columns have times
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
        return case_of(question, self._record(question.record).base)

    def _keys_of(self, number: str) -> Path:
        """File with the keys of &motion that go with a record."""
        return self._folder / f"{number}.json"

    def _record(self, number: str) -> _Record:
        if number in self._records:
            self._records.move_to_end(number)
            return self._records[number]
        keys = self._keys_of(number)
        if not keys.exists():
            raise BadQuestionError("there is no such record: upload it again")
        (path,) = keys.with_suffix("").iterdir()
        motion = json.loads(keys.read_text(encoding="ascii")) | {"file": str(path)}
        base = self._case.replace(vertical=None, motion=None).replace(motion=motion)
        self._records[number] = _Record(path, base)
        if len(self._records) > _KEPT_RECORDS:
            self._records.popitem(last=False)
        return self._records[number]

    def _namelist(self, case: Case, record: str) -> str:
        text = case.to_namelist()
        # files in the server's folder are saved beside the namelist
        files = [*self._folder.glob("case_*.txt")]
        if record:
            files.append(self._record(record).path)
        for path in files:
            text = text.replace(_quoted(str(path)), _quoted(path.name))
        return text

    def _row_of(
        self, case: Case, periods: Array, key: str, watch: Watch
    ) -> tuple[Array, npt.NDArray[np.str_]]:
        """Return a quantity and the status over periods."""
        with _library.start_rows(
            case.kernel, "", ["T_s"], periods[:, None], [key], self._threads, watch
        ) as found:
            values = found.values()
            return values[key].ravel().astype(np.float64), values["status"].ravel()

    def _frame_alone(
        self, question: Question, case: Case, periods: Array, key: str, watch: Watch
    ) -> str | None:
        """Return the curve of the frame without a wall, packed; it depends on few of the keys."""
        if "wall" not in question.groups or "frame" not in question.groups:
            return None
        gone = [name for name, needs in _library.needs_of_groups().items()
                if name in _NOT_BARE or "wall" in needs or name == "wall"]  # fmt: skip
        changes: dict[str, dict[str, Any] | None] = dict.fromkeys(gone)
        left = {name: keys for name, keys in question.groups.items() if name not in gone}
        changes["frame"] = {"gamma": None}
        if "p_delta" in left and "storeys" not in left and "h_f" not in left["p_delta"]:
            changes["p_delta"] = {"h_f": 2.0 * float(case.wall.h)}
        same = [left, {"gamma": 0}, changes.get("p_delta"), periods.tolist(), key, question.record]
        left["frame"] = {name: x for name, x in left["frame"].items() if name not in
                         ("gamma", "T_s")}  # fmt: skip
        name = json.dumps(same)
        if name in self._alone:
            self._alone.move_to_end(name)
            return self._alone[name]
        try:
            bare = case.replace(**changes)
            values, _ = self._row_of(bare, periods, key, watch)
        except (InputError, NumericalError):
            # a quantity of the wall, or storeys that no wall holds up
            return None
        self._alone[name] = _pack(values)
        if len(self._alone) > _KEPT:
            self._alone.popitem(last=False)
        return self._alone[name]


def _quoted(text: str) -> str:
    """Write a text for a place between the quotes of a namelist."""
    return text.replace("'", "''")


def _key_of(word: str, case: Case) -> str:
    """Return the key of a quantity that is given by key or name, in any case of letters."""
    for key in case.kernel.applicable():
        if word.lower() in (name.lower() for name in (key, *find(key).names("ordinate"))):
            return key
    return word or case.kernel.default_quantity()


def _early_end(case: Case) -> list[str]:
    """Warn of a run that does not contain all of the ground motion."""
    end = case.kernel.end_of_motion()
    t_end = float(case.solver.t_end)
    if not t_end < end * (1.0 - 1e-9):
        return []
    return [f"&solver: t_end = {t_end:.10g} s: the ground motion lasts until {end:.10g} s. "
            "Nothing after t_end is part of these results: raise t_end"]  # fmt: skip


def _pack(values: npt.ArrayLike) -> str:
    """Write an array as base64 of little-endian 32-bit floats."""
    with np.errstate(over="ignore"):
        return base64.b64encode(np.asarray(values).astype("<f4").tobytes()).decode()


def _key_numbers(summary: dict[str, Any]) -> list[list[str]]:
    """Key, text with all digits, unit and meaning of each named scalar."""
    return [
        [key, _text(value), find(key).unit, find(key).meaning]
        for key, value in summary.items()
        if key not in _NOT_KEY_NUMBERS
    ]


def _text(value: object) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    return repr(value) if isinstance(value, int | float) else str(value)


def _loops_of(columns: dict[str, Array], case: Case) -> list[dict[str, str]]:
    return [
        {
            "spring": loop.spring,
            "displacement": _pack(loop.displacement),
            "force": _pack(loop.force),
            "label": _FORCES[loop.spring.split()[-1]],
        }
        for loop in loops.springs_of(columns, case)
    ]


_FORCES = {"frame": "F_s/(m_s g)", "cable": "P/(m_w g)", "fuse": "F/(m_w g)"}


def _scene_of(case: Case) -> dict[str, Any]:
    """Measures that the picture of the wall and the marker in the spectrum need."""
    found: dict[str, Any] = dict.fromkeys(case.groups, True)
    if case.wall is not None:
        h, b = float(case.wall.h), float(case.wall.b)
        found |= {"h": h, "b": b, "pinned": case.wall.base == "pinned"}
    if case.storeys is not None:
        found["heights"] = list(case.storeys.height)
        found["coupling"] = case.storeys.coupling
    found["formulation"] = case.model.formulation
    found["T"] = _period_of(case)
    return found


def _period_of(case: Case) -> float | None:
    """Return where the case stands on the axis of its spectrum [s]."""
    axis = case.kernel.axes().get("T_s")
    return None if axis is None else axis.value


def _grid(case: Case, points: int) -> Array:
    """Periods of the spectrum: those of the case's own range, with its own period in it."""
    low, high = _PERIODS
    group: Mapping[str, Any] = case.groups.get("spectrum", {})
    if group.get("T_s"):
        low, high = min(group["T_s"]), max(group["T_s"])
    elif group.get("T_s_min") and group.get("T_s_max"):
        low, high = group["T_s_min"], group["T_s_max"]
    own = _period_of(case)
    if own:
        low, high = min(low, own), max(high, own)
    if not high > low:
        low, high = 0.5 * low, 2.0 * high
    if group.get("spacing") == "log":
        return np.geomspace(low, high, points)
    return np.linspace(low, high, points)


def _plain(value: object) -> Any:  # noqa: ANN401 (JSON has several types)
    """Make what JSON can hold: what is not finite becomes None."""
    if isinstance(value, dict):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_plain(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
