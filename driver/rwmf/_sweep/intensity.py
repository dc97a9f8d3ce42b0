"""How strong a ground motion is for a structure, and records scaled to the same strength."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence

from rwmf import _library
from rwmf._sweep.axes import Entries, Scene
from rwmf._sweep.record_sets import RecordFile
from rwmf.case import Case
from rwmf.case.namelist import compose
from rwmf.errors import InputError

__all__ = ["MEASURES", "choose_measure", "scale_to_one_g"]

_PSEUDO, _PEAK = "pseudo_acceleration", "peak_acceleration"
# what a level of intensity is, as the label of its axis
MEASURES = {
    _PSEUDO: "pseudo-spectral acceleration over g of an oscillator with the frame's T_s and xi_s",
    _PEAK: "peak ground acceleration over g",
}
# what an oscillator under a record keeps of a case
_OSCILLATOR = ("frame", "motion", "model", "solver")


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
        measure = _PEAK if case.frame is None else _PSEUDO
    if measure not in MEASURES:
        raise InputError(f"intensity = {measure!r}: must be one of {', '.join(MEASURES)}")
    if measure == _PSEUDO and _period(case) is None:
        raise InputError(f"intensity = {_PSEUDO!r}: the case needs &frame T_s; or take {_PEAK!r}")
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
    T_s = _period(case) if measure == _PSEUDO else None
    changes: dict[str, Mapping[str, object] | None] = {"output": None, "vertical": None}
    if T_s is not None:
        # without storeys and wall the frame has one period and no mass ratio
        changes = dict.fromkeys(set(case.groups) - set(_OSCILLATOR))
        changes["frame"] = {"T_s": T_s, "gamma": None, "m_s": None, "k_s": None}
    probe = case.replace(**changes)
    return tuple(_scaled(probe, T_s, record) for record in records)


def _scaled(probe: Case, T_s: float | None, record: RecordFile) -> RecordFile:
    entries: Entries = {name: group.as_given() for name, group in probe.groups.items()}
    if T_s is not None:
        entries["spectrum"] = {"T_s": (T_s,)}
    Scene(record).apply(entries)
    samples = None if record.array is None else record.array.samples
    case = _library.read_case(compose(entries), probe.kernel_source(), motion=samples)
    if T_s is None:
        found = case.peak_of_motion()
    else:
        with _library.start_spectrum(case, probe.label) as spectrum:
            found = (2 * math.pi / T_s) ** 2 * float(spectrum.values()["u_s_max_m"].squeeze())
    intensity = found / float(probe.model.g)
    if not 0 < intensity < math.inf:
        raise InputError(f"{record.path or record.name}: has no intensity that could be scaled")
    return dataclasses.replace(record, scale=record.scale / intensity)
