"""Standard calls and their cases."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

SECONDS_OF_RECORD = 5.0
"""El Centro up to here [s]; its strongest part begins at 2 s."""
RECORD = "elcentro.csv"
"""Its file beside the cases."""

_WALL = "&wall h = 2.0, b = 0.5 /"
_ELEMENT = "&wall h = 2.0, b = 0.5, m_w = 2.0e4 /"
_FRAME = "&frame T_s = 0.6, gamma = 5.0, xi_s = 0.05 /"
_STOREYS = """&frame xi_s = 0.05 /
&storeys m_over_m_w = 5*1.0, k_over_m_w = 5*1500.0, height = 5*0.8, coupling = 'full' /"""
_CABLE = "&cable eta_0 = 1.0, eta_alpha = 5.0 /"
_TENDON = "&cable eta_0 = 1.0, eta_alpha = 5.0, law = 'truss', eta_y = 1.2, hardening = 0.02 /"
_IMPACT = "&impact rule = 'coupled' /"
_RECORD = f"&motion kind = 'record', file = '{RECORD}', unit = 'g', scale = 2.0 /"
_EXACT = "&model formulation = 'exact' /"
_FUSE = "&fuse eta_y = 0.5, stroke_y = 0.005, hardening = 0.02 /"
_YIELDING = "&yielding u_y = 0.02, hardening = 0.05 /"
_BOUC_WEN = "&yielding u_y = 0.02, hardening = 0.05, law = 'bouc_wen', exponent = 2.0, beta = 0.5 /"
_DOP853 = "&solver method = 'dop853' /"
_HISTORY = "&output dt = 0.02, energy = .true., reactions = .true. /"
# of a run without its reactions and demands, which take several times as long
_PEAKS = "&output reactions = .false. /"
_BASIC = (_WALL, _FRAME, _CABLE, _IMPACT, _RECORD, _EXACT)
_EVERYTHING = (
    _WALL,
    _FRAME,
    _TENDON,
    _IMPACT,
    _RECORD,
    "&model formulation = 'exact', overturning_angle = 0.9 /",
    "&link L = 6.0 /",
    "&damper c_over_m_w = 0.5 /",
    "&inerter inertance_over_m_w = 2.0 /",
    _FUSE,
    _YIELDING,
    "&vertical ratio = 0.65 /",
    _HISTORY,
)


class Call(NamedTuple):
    """A standard call.

    Attributes
    ----------
    name : str
        Name of the count.
    kind : str
        ``run``, ``spectrum``, ``stepping``, ``element`` (``bench/standard_calls.f90``), ``batch``
        (the batch program), ``simulate``, ``sweep``, ``sweep_runs`` (``in_python.py``).
    groups : tuple of str
        Namelist groups of the case.
    """

    name: str
    kind: str
    groups: tuple[str, ...]

    @property
    def program(self) -> str:
        """Program that makes the call: ``host``, ``batch`` or ``python``."""
        if self.kind in ("run", "spectrum", "stepping", "element"):
            return "host"
        return "batch" if self.kind == "batch" else "python"

    def write(self, folder: Path) -> Path:
        """Write the case."""
        path = folder / f"{self.name}.nml"
        path.write_text("\n".join(self.groups) + "\n", encoding="utf-8")
        return path


CALLS = (
    Call("run_basic", "run", (*_BASIC, _PEAKS)),
    Call("run_basic_dop853", "run", (*_BASIC, _DOP853, _PEAKS)),
    Call("run_all_effects", "run", _EVERYTHING),
    Call("run_storeys_full", "run", (_WALL, _STOREYS, _CABLE, _IMPACT, _RECORD, _EXACT, _PEAKS)),
    Call("run_fuses_yielding", "run", (*_BASIC, _FUSE, _YIELDING, _PEAKS)),
    Call("run_tendon", "run", (_WALL, _FRAME, _TENDON, _IMPACT, _RECORD, _EXACT, _PEAKS)),
    Call("run_bouc_wen", "run", (*_BASIC, _BOUC_WEN, _PEAKS)),
    Call(
        "spectrum_smooth",
        "spectrum",
        (*_BASIC, "&spectrum T_s_min = 0.3, T_s_max = 3.0, n = 32, gamma = 5.0, 100.0 /"),
    ),
    Call(
        "spectrum_effects",
        "spectrum",
        (*_BASIC, _FUSE, _YIELDING, "&spectrum T_s = 0.4, 0.8, 1.6, 3.0 /"),
    ),
    Call(
        "stepping",
        "stepping",
        (_WALL, _FRAME, _IMPACT, _EXACT, "&solver t_end = 4.0, method = 'dop853' /"),
    ),
    Call(
        "element",
        "element",
        (_ELEMENT, _CABLE, "&impact e = 0.9 /", _EXACT, "&solver t_end = 1.0 /"),
    ),
    Call("batch_program", "batch", (*_BASIC, _DOP853, "&output dt = 0.05, reactions = .false. /")),
    # little work for the kernel, so that the overhead of Python matters
    Call(
        "python_simulate",
        "simulate",
        (*_BASIC, _DOP853, "&output dt = 0.02, reactions = .false. /"),
    ),
    Call("python_sweep", "sweep", _BASIC),
    Call("python_sweep_runs", "sweep_runs", (*_BASIC, _DOP853)),
)

NAMES = tuple(call.name for call in CALLS)


def write_record(source: Path, folder: Path) -> None:
    """Cut the exported record of El Centro (two columns, time in s) for the cases in a folder."""
    lines = source.read_text(encoding="utf-8").splitlines()
    kept = [line for line in lines if not line.startswith("#")]
    head, samples = kept[0], kept[1:]
    short = [line for line in samples if float(line.split(",")[0]) <= SECONDS_OF_RECORD]
    (folder / RECORD).write_text("\n".join([head, *short]) + "\n", encoding="utf-8")
