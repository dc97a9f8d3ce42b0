"""All hard cases, their trusted answers, and the verdict on a method."""

import csv
import math
import zlib
from collections.abc import Iterator
from dataclasses import asdict, dataclass, fields
from pathlib import Path

import cases_chatter
import cases_extremes
import cases_grazing
import cases_memory
import cases_overturning
import cases_pulses
import cases_rest
import rwmf
import trusted
from checkout import REFERENCE
from hard_scenes import Hard

FAMILIES: dict[str, list[Hard]] = {
    "chatter": cases_chatter.CASES,
    "rest and lift-off": cases_rest.CASES,
    "grazing": cases_grazing.CASES,
    "overturning": cases_overturning.CASES,
    "extremes": cases_extremes.CASES,
    "memory": cases_memory.CASES,
    "pulses": cases_pulses.CASES,
}

ANSWERS = REFERENCE / "hard_cases.csv"

# promised error of the peak: max(1e-7, 100 rtol kappa), or 1e-12 m (rad)
PEAK_FLOOR, PEAK_FACTOR, NOTHING = 1e-7, 100.0, 1e-12
# error of the final rotation, after all impacts, relative to the largest rotation
END_FACTOR = 1000.0
# relative change of the motion for kappa, over the tolerance: about the error of a method, because
# near grazing and overturning the response is no linear function of the motion
_CHANGE_FACTOR = 10.0


@dataclass(frozen=True)
class Answer:
    """Trusted answer to a hard case.

    Attributes
    ----------
    family, name : str
        The case.
    checksum : int
        CRC-32 of the computed case, to detect later changes.
    peak : float
        Largest |u_s| [m]; without a frame the largest |theta| [rad].
    theta_max, theta_end : float
        Largest |theta| and theta at the end [rad].
    overturned, impacts : int
        Whether the wall overturned, and impacts.
    kappa, kappa_end : float
        Relative change of the peak, and change of the end over theta_max, per relative change of
        the motion [-].
    error : float
        Relative difference of the peaks at two tolerances of the reference [-].
    """

    family: str
    name: str
    checksum: int
    peak: float
    theta_max: float
    theta_end: float
    overturned: int
    impacts: int
    kappa: float
    kappa_end: float
    error: float


@dataclass(frozen=True)
class Row:
    """Result of one method for one hard case; `verdict` is 'right', 'refused ...' or 'WRONG'."""

    method: str
    rtol: float
    error: float
    error_end: float
    bound: float
    impacts: int
    lift_offs: int
    steps: int
    verdict: str


def every_case() -> Iterator[tuple[str, Hard]]:
    """Yield family and case."""
    for family, cases in FAMILIES.items():
        for hard in cases:
            yield family, hard


def checksum(hard: Hard) -> int:
    """CRC-32 of the numbers of a case."""
    return zlib.crc32(repr((sorted(hard.groups.items()), hard.record, hard.rtol)).encode())


def answer(family: str, hard: Hard, folder: Path) -> Answer:
    """Compute the trusted answer in quadruple precision.

    Parameters
    ----------
    family : str
        Family of the case.
    hard : Hard
        The case.
    folder : Path
        Folder for its record.

    Returns
    -------
    Answer
        Answer and sensitivity.

    Raises
    ------
    NoAnswerError
        When the reference fails.
    """
    case = hard.build(folder)
    found = trusted.solve(case)
    change = _CHANGE_FACTOR * hard.rtol
    kappa, kappa_end = 0.0, 0.0
    for sign in (-1, 1):
        other = trusted.solve(_shaken(case, 1 + sign * change), 1e-13, 1e-14)
        kappa = max(kappa, _ratio(_peak(other, case) - _peak(found, case), _peak(found, case)))
        if not (found["overturned"] or other["overturned"]):
            end = other["theta_end_rad"] - found["theta_end_rad"]
            kappa_end = max(kappa_end, _ratio(end, found["theta_max_rad"]))
    return Answer(
        family, hard.name, checksum(hard), _peak(found, case), found["theta_max_rad"],
        found["theta_end_rad"], int(found["overturned"]), int(found["impacts"]),
        float(f"{kappa / change:.2e}"), float(f"{kappa_end / change:.2e}"), found["error"],
    )  # fmt: skip


def evaluate(hard: Hard, truth: Answer, method: str, folder: Path) -> Row:
    """Run a case with a method and compare it with the trusted answer.

    Parameters
    ----------
    hard : Hard
        The case.
    truth : Answer
        Its trusted answer.
    method : str
        `&solver method`.
    folder : Path
        Folder for its record.

    Returns
    -------
    Row
        Errors, counts and verdict.
    """
    case = hard.build(folder, method)
    bound = max(PEAK_FLOOR, PEAK_FACTOR * hard.rtol * max(truth.kappa, 1.0))
    try:
        run = rwmf.simulate(case, dt=case.solver.t_end)
    except rwmf.NumericalError as error:
        nan = math.nan
        return Row(method, hard.rtol, nan, nan, bound, 0, 0, 0, f"refused: {error}")
    alpha = math.atan2(case.wall.b, case.wall.h)
    peak = float(run["u_s_max"] if case.frame is not None else run["theta_max_over_alpha"] * alpha)
    error = 0.0 if abs(peak - truth.peak) <= NOTHING else _ratio(peak - truth.peak, truth.peak)
    overturned = int(run["overturned"])
    end = 0.0
    if not overturned and truth.theta_max > NOTHING:
        end = _ratio(float(run["theta"][-1]) - truth.theta_end, truth.theta_max)
    bound_end = END_FACTOR * hard.rtol * max(truth.kappa_end, 1.0)
    right = error <= bound and end <= bound_end
    # within the tolerance of the boundary both outcomes are right
    decided = truth.kappa * hard.rtol < 0.01
    right = right and (overturned == truth.overturned or not decided)
    return Row(
        method, hard.rtol, error, end, bound, int(run["impacts"]), int(run["lift_offs"]),
        int(run.attrs["steps"]), "right" if right else "WRONG",
    )  # fmt: skip


def read_answers() -> dict[tuple[str, str], Answer]:
    """Read the stored answers, by family and name."""
    kinds = {field.name: field.type for field in fields(Answer)}
    with ANSWERS.open(encoding="utf-8", newline="") as stream:
        rows = csv.DictReader(line for line in stream if not line.startswith("#"))
        answers = [Answer(**{key: kinds[key](row[key]) for key in kinds}) for row in rows]
    return {(each.family, each.name): each for each in answers}


def write_answers(answers: list[Answer]) -> None:
    """Store answers with their provenance."""
    with ANSWERS.open("w", encoding="utf-8", newline="") as stream:
        stream.write(
            "# Trusted answers to the hard cases: quadruple precision, Taylor series,\n"
            f"# rtol {trusted.RTOL:g}; error: change from rtol {trusted.RTOL_LOOSE:g}. "
            "Made by: bench/hard_cases.py --reference\n"
        )
        table = csv.DictWriter(stream, [field.name for field in fields(Answer)])
        table.writeheader()
        table.writerows(asdict(each) for each in answers)


def _shaken(case: rwmf.Case, factor: float) -> rwmf.Case:
    """Return the case with a slightly larger motion and initial state."""
    changes: dict[str, dict[str, object]] = {}
    if case.motion.kind == "record":
        changes["motion"] = {"scale": factor}
    elif case.motion.kind != "none":
        changes["motion"] = {"a_max_g": case.motion.a_max_g * factor}
    if case.initial is not None:
        changes["initial"] = {"theta_over_alpha": case.initial.theta_over_alpha * factor}
    return case.replace(**changes)


def _peak(found: dict[str, float], case: rwmf.Case) -> float:
    return found["u_s_max_m"] if case.frame is not None else abs(found["theta_max_rad"])


def _ratio(difference: float, size: float) -> float:
    return abs(difference) / size if size > 0 else abs(difference)
