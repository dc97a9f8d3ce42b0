"""Intensity measures of ground motions, and records scaled to equal intensity."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence

from rwmf import _library
from rwmf._sweep.axes import Entries, Key, Scene
from rwmf._sweep.record_sets import RecordFile
from rwmf.case import Case
from rwmf.case.namelist import compose
from rwmf.errors import InputError, did_you_mean, without_lines

__all__ = ["Intensity", "choose_intensity", "scale_to_one_g"]

_PSEUDO, _PEAK = "pseudo_acceleration", "peak_acceleration"
_KINDS = (_PSEUDO, _PEAK)
# groups of a case that an oscillator under a record keeps
_OSCILLATOR = ("frame", "motion", "model", "solver")
# groups that can determine the period or the damping of a frame
_STRUCTURE = ("wall", "frame", "storeys")


@dataclasses.dataclass(frozen=True)
class Intensity:
    """Intensity measure of a ground motion.

    Attributes
    ----------
    kind : str
        ``pseudo_acceleration`` or ``peak_acceleration``.
    period : float, optional
        Period of the linear oscillator whose peak response is the measure [s].
    damping : float, optional
        Its damping ratio [-].
    is_own : bool
        True when period and damping are those of the case.
    """

    kind: str
    period: float | None = None
    damping: float | None = None
    is_own: bool = False

    @property
    def label(self) -> str:
        """Label of the axis of intensities."""
        if self.kind == _PEAK:
            return "peak ground acceleration over g"
        return (
            "pseudo-spectral acceleration over g of an oscillator with period "
            f"{self.period:.6g} s and damping {self.damping:.6g}"
        )

    @property
    def attributes(self) -> dict[str, str | float]:
        """Attributes of a dataset with records scaled by this measure."""
        found: dict[str, str | float] = {"intensity": self.kind}
        if self.period is not None and self.damping is not None:
            found |= {"intensity_period_s": self.period, "intensity_damping": self.damping}
        return found


def choose_intensity(
    case: Case,
    kind: str | None = None,
    period: float | None = None,
    damping: float | None = None,
    varied: Sequence[Key] = (),
) -> Intensity:
    """Choose the intensity measure for a scene, or check the given one.

    Parameters
    ----------
    case : Case
        The structure.
    kind : str, optional
        ``pseudo_acceleration`` or ``peak_acceleration``. The default is the former with a frame or
        a period, and the latter for a wall alone, whose period depends on the amplitude.
    period, damping : float, optional
        Period [s] and damping ratio [-] of the oscillator; otherwise those of the frame, for
        storeys the first period.
    varied : sequence of (group, key)
        Keys that differ between the runs.

    Returns
    -------
    Intensity
        The intensity measure.

    Raises
    ------
    InputError
        When the kind is unknown, or only one of period and damping is given. Also when neither is
        given and the period of the runs is not unique.
    """
    if kind is None:
        kind = _PEAK if case.frame is None and period is None else _PSEUDO
    if kind not in _KINDS:
        hint = did_you_mean(kind, _KINDS)
        raise InputError(f"intensity = {kind!r}: must be one of {', '.join(_KINDS)}{hint}")
    given = {"period": period, "damping": damping}
    chosen = [name for name, value in given.items() if value is not None]
    if kind == _PEAK:
        if chosen:
            raise InputError(f"{chosen[0]}: must not be given with intensity = {_PEAK!r}")
        return Intensity(kind)
    if len(chosen) == 1:
        raise InputError(
            f"intensity = {_PSEUDO!r}: has {chosen[0]} only: period and damping belong together"
        )
    if period is not None and damping is not None:
        return Intensity(kind, period, damping)
    structural = [f"{group}.{key}" for group, key in varied if group in _STRUCTURE]
    if structural:
        raise InputError(
            f"intensity = {_PSEUDO!r}: {', '.join(structural)} differs between the runs: give "
            "period and damping of one oscillator, so that each record has one factor for all"
        )
    own = None if case.frame is None else case.kernel.axes()["T_s"].value
    if own is None:
        raise InputError(
            f"intensity = {_PSEUDO!r}: the case needs &frame T_s, or give period and damping; or "
            f"take {_PEAK!r}"
        )
    return Intensity(kind, float(own), float(case.frame.xi_s), is_own=True)


def scale_to_one_g(
    case: Case, records: Sequence[RecordFile], intensity: Intensity
) -> tuple[RecordFile, ...]:
    """Scale records to an intensity of 1 g each.

    Parameters
    ----------
    case : Case
        The structure.
    records : sequence of RecordFile
        The suite.
    intensity : Intensity
        From `choose_intensity`.

    Returns
    -------
    tuple of RecordFile
        The same records with new factors; further factors are intensities in g.

    Raises
    ------
    InputError
        When a record cannot be read, or its intensity is zero or not finite.
    """
    changes: dict[str, Mapping[str, object] | None] = {"output": None, "vertical": None}
    if intensity.kind == _PSEUDO:
        # without storeys and wall the frame has one period and no mass ratio
        changes = dict.fromkeys(set(case.groups) - set(_OSCILLATOR))
        changes["frame"] = dict.fromkeys(("gamma", "m_s", "k_s")) | {
            "T_s": intensity.period,
            "xi_s": intensity.damping,
        }
        if not intensity.is_own:
            # the factors of a record must not depend on the solver of a design
            changes |= {
                "solver": dict.fromkeys(case.solver.given - {"t_end"}),
                "model": dict.fromkeys(case.model.given - {"g"}),
            }
    probe = case.replace(**changes)
    return tuple(_scaled(probe, intensity.period, record) for record in records)


def _scaled(probe: Case, T_s: float | None, record: RecordFile) -> RecordFile:
    entries: Entries = {name: group.as_given() for name, group in probe.groups.items()}
    if T_s is not None:
        entries["spectrum"] = {"T_s": (T_s,)}
    Scene(record).apply(entries)
    samples = None if record.array is None else record.array.samples
    try:
        case = _library.read_case(compose(entries), probe.kernel_source(), motion=samples)
    except InputError as error:
        raise InputError(f"intensity: {without_lines(str(error))}") from error
    if T_s is None:
        found = case.peak_of_motion()
    else:
        with _library.start_spectrum(case, probe.label) as spectrum:
            found = (2 * math.pi / T_s) ** 2 * float(spectrum.values()["u_s_max_m"].squeeze())
    intensity = found / float(probe.model.g)
    if not 0 < intensity < math.inf:
        raise InputError(f"{record.path or record.name}: has no intensity that could be scaled")
    return dataclasses.replace(record, scale=record.scale / intensity)
