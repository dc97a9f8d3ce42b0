"""How strong a ground motion is for a structure, and records scaled to the same strength."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence

from rwmf import _library
from rwmf._sweep.axes import RecordAxis
from rwmf._sweep.record_sets import RecordFile
from rwmf.case import Case
from rwmf.case.namelist import compose
from rwmf.errors import InputError

__all__ = ["MEASURES", "PEAK", "PSEUDO", "choose_measure", "scale_to_one_g"]

PSEUDO, PEAK = "pseudo_acceleration", "peak_acceleration"
# what a level of intensity is, as the label of its axis
MEASURES = {
    PSEUDO: "pseudo-spectral acceleration over g of an oscillator with the frame's T_s and xi_s",
    PEAK: "peak ground acceleration over g",
}


def choose_measure(case: Case, measure: str | None = None) -> str:
    """Choose the intensity of a scene, or check that it has the one that is asked for.

    Parameters
    ----------
    case : Case
        The structure.
    measure : str, optional
        One of `MEASURES`.

    Returns
    -------
    str
        The measure: of a frame, with storeys or without, ``pseudo_acceleration`` at its first
        period; of a wall alone, which has no period that does not depend on how far it rocks,
        ``peak_acceleration``.

    Raises
    ------
    InputError
        When there is no such measure, or when the scene has no period that it needs.
    """
    if measure is None:
        measure = PEAK if case.frame is None else PSEUDO
    if measure not in MEASURES:
        raise InputError(f"intensity = {measure!r}: must be one of {', '.join(MEASURES)}")
    if measure == PSEUDO and _period(case) is None:
        raise InputError(f"intensity = {PSEUDO!r}: the case needs &frame T_s; or take {PEAK!r}")
    return measure


def _period(case: Case) -> float | None:
    """First period of the frame; None without one, and where the case leaves it to a grid [s]."""
    return None if case.frame is None else case.kernel.axes()["T_s"].value


def scale_to_one_g(
    case: Case, records: Sequence[RecordFile], measure: str
) -> tuple[RecordFile, ...]:
    """Scale records so that the intensity of each is 1 g.

    Parameters
    ----------
    case : Case
        The structure.
    records : sequence of RecordFile
        The suite.
    measure : str
        From `choose_measure`.

    Returns
    -------
    tuple of RecordFile
        The same with other factors; a factor on them is a level of intensity in g.

    Raises
    ------
    InputError
        When a record cannot be read, or has no intensity that could be scaled.
    """
    T_s = _period(case) if measure == PSEUDO else None
    changes: dict[str, object] = {"output": None, "spectrum": None}
    if T_s is not None:
        changes |= dict.fromkeys(name for name in case.groups if name not in _OSCILLATOR)
        changes |= {"frame": {"T_s": T_s, "gamma": None}, "spectrum": {"T_s": [T_s]}}
    probe = case.replace(**{name: keys for name, keys in changes.items() if _is_asked(case, name)})
    return tuple(_scaled(probe, T_s, record) for record in records)


# what an oscillator under a record keeps of a case
_OSCILLATOR = ("frame", "motion", "model", "solver")


def _is_asked(case: Case, group: str) -> bool:
    return group in case.groups or group == "spectrum"


def _scaled(probe: Case, T_s: float | None, record: RecordFile) -> RecordFile:
    entries = {name: {k: g[k] for k in g if k in g.given} for name, g in probe.groups.items()}
    RecordAxis((record,)).apply(entries, 0)
    case = _library.read_case(compose(entries), probe.kernel_source())
    if T_s is None:
        found = case.peak_of_motion()
    else:
        with _library.start_spectrum(case, probe.kernel_source()) as spectrum:
            found = (2 * math.pi / T_s) ** 2 * float(spectrum.values()["u_s_max_m"].squeeze())
    intensity = found / float(probe.model.g)
    if not 0 < intensity < math.inf:
        raise InputError(f"{record.path}: has no intensity that could be scaled")
    return dataclasses.replace(record, scale=record.scale / intensity)
