"""Record files with every kind of header, with statements of unit, interval and quantity."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

__all__ = ["DT", "SAMPLES", "N", "Variant", "variants"]

N = 40
DT = 0.01
# accelerations [m/s2]
SAMPLES = np.round(np.sin(np.arange(N) * 0.7) * np.hanning(N) * 3, 4)
G = 9.81

_SECONDS = ("s2", "s^2", "s**2", "s/s", "sec2", "sec^2", "sec/sec", "s²", "(s^2)", "s^{2}")
_POWERS = (" s-2", ".s-2", "·s⁻²", " s^-2")


def _spellings(length: str) -> list[str]:
    plain = [f"{length}/{second}" for second in _SECONDS] + [length + power for power in _POWERS]
    return [*plain, f"{length.upper()}/SEC/SEC", f"{length} per second squared"]


# m/s2 per unit, by spelling
ACCELERATIONS: dict[str, float] = (
    dict.fromkeys(["g", "G", "g's", "gn"], G)
    | dict.fromkeys(["%g", "%G", "% g"], G / 100)
    | dict.fromkeys(["mg", "milli-g"], G / 1000)
    | dict.fromkeys(["gal", "Gal", "GAL", "gals"], 0.01)
    | {"mgal": 1e-5}
    | dict.fromkeys(_spellings("m"), 1.0)
    | dict.fromkeys(_spellings("cm"), 0.01)
    | dict.fromkeys(_spellings("mm"), 1e-3)
    | dict.fromkeys(_spellings("in"), 0.0254)
    | dict.fromkeys(_spellings("ft"), 0.3048)
)
OTHERS = (
    "cm/s",
    "m/s",
    "in/sec",
    "CM/SEC",
    "m s-1",
    "cm",
    "mm",
    "kN",
    "furlong/s2",
    "m/s3",
    "rad/s2",
    "0.1 g",
    "10 g",
    "g x 1000",
    "counts/g",
    "Hz",
)
TIMES: dict[str, float] = {
    "s": 1,
    "sec": 1,
    "SEC": 1,
    "seconds": 1,
    "ms": 1e-3,
    "msec": 1e-3,
    "MSEC": 1e-3,
    "milliseconds": 1e-3,
    "us": 1e-6,
    "µs": 1e-6,
    "min": 60.0,
}


@dataclass(frozen=True)
class Variant:
    """A file and the truth about it.

    Attributes
    ----------
    name : str
        For messages.
    content : bytes
        The file.
    unit : float, optional
        Size of its unit [m/s2]; None where the file states none.
    dt : float, optional
        Its interval [s]; None where the file states none.
    is_record : bool
        False for a file that must be refused.
    is_read : bool
        True for a file that must be read with the right keys.
    written : float, optional
        Size of the unit of its numbers where it states none [m/s2].
    """

    name: str
    content: bytes
    unit: float | None = None
    dt: float | None = None
    is_record: bool = True
    is_read: bool = True
    written: float | None = None


def _numbers(unit: float) -> list[str]:
    return [f"{a / unit:.10g}" for a in SAMPLES]


def _at2(unit: float, title: str, counts: str) -> str:
    rows = _numbers(unit)
    lines = [" ".join(rows[i : i + 5]) for i in range(0, N, 5)]
    return (
        "\n".join(
            [
                "PEER NGA STRONG MOTION DATABASE RECORD",
                "Town, 1/1/2000, Station A, 90",
                title,
                counts,
                *lines,
            ]
        )
        + "\n"
    )


def _rows(unit: float, seconds: float = 1.0, mark: str = ",", extra: str = "") -> str:
    times = [f"{i * DT / seconds:.10g}" for i in range(N)]
    return "".join(f"{t}{mark}{a}{extra}\n" for t, a in zip(times, _numbers(unit), strict=True))


_TITLES = (
    "ACCELERATION TIME SERIES IN UNITS OF {}",
    "ACCELERATION TIME HISTORY ({})",
    "Acceleration [{}], FILTER POINTS: HP=0.2 Hz",
    "UNITS: {}",
    "Units of acceleration = {}",
)
_COUNTS = (
    "NPTS= {n}, DT= {dt} {u}",
    "DT= {dt} {u}, NPTS= {n}",
    "NPTS={n}, DT={dt}{u},",
    "DT={dt} {u} NPTS={n}",
    "NPTS = {n} , DT = {dt} {u} , 0 POLE @",
    "DT({u})= {dt}, NPTS= {n}",
    "DT= {dt} {u}\nNPTS= {n}",
)


def _peer() -> Iterator[Variant]:
    for i, (spelling, unit) in enumerate(ACCELERATIONS.items()):
        title = _TITLES[i % len(_TITLES)].format(spelling)
        text = _at2(unit, title, f"NPTS= {N}, DT= {DT} SEC")
        yield Variant(f"AT2 {title}", text.encode(), unit, DT)
    for i, (spelling, title) in enumerate(itertools.product(OTHERS, _TITLES[:2] + _TITLES[3:4])):
        text = _at2(1.0, title.format(spelling), f"NPTS= {N}, DT= {DT} SEC")
        yield Variant(f"AT2 {i} {title.format(spelling)}", text.encode(), is_record=False)
    for quantity in (
        "VELOCITY TIME SERIES IN UNITS OF CM/S",
        "DISPLACEMENT TIME SERIES (CM)",
        "VELOCITY",
        "Displacement history in m",
        "RESPONSE SPECTRUM",
    ):
        text = _at2(1.0, quantity, f"NPTS= {N}, DT= {DT} SEC")
        yield Variant(f"AT2 {quantity}", text.encode(), is_record=False)
    for line, (spelling, seconds) in itertools.product(_COUNTS, TIMES.items()):
        counts = line.format(n=N, dt=f"{DT / seconds:.15g}", u=spelling)
        text = _at2(G, "ACCELERATION TIME SERIES IN UNITS OF G", counts)
        yield Variant(f"AT2 {counts}", text.encode(), G, DT)
    for counts in (
        f"{N}  {DT}  NPTS, DT",
        f"{DT}  {N}  DT, NPTS",
        f"NPTS= {N}\nDT= {DT}",
        f"Points: NPTS= {N}, DT=1.0E-02 SEC",
    ):
        yield Variant(f"AT2 {counts}", _at2(G, "UNITS OF G", counts).encode(), G, DT)
    for counts in (
        f"NPTS= {N}",
        f"NPTS= {N}, DT=",
        f"NPTS= {N + 1}, DT= {DT}",
        f"NPTS= {N}, DT= 100 Hz",
        f"NPTS= {N}, DT= 10 ticks",
        f"DT= {N}, {DT} NPTS",
        f"NPTS= {N}, DT= 10 MSE",
        f"NPTS= {N}, DT= .01\nDT= .02",
        f"NPTS= {N}\nNPTS= {N + 5}\nDT= .01",
    ):
        yield Variant(f"AT2 {counts}", _at2(G, "UNITS OF G", counts).encode(), is_record=False)


_NAMES = (
    "{t} ({s}),{a} ({u})",
    "{t} [{s}],{a} [{u}]",
    '"{t} ({s})","{a} ({u})"',
    "{t} [{s}];{a} [{u}]",
    "{t} [{s}]\t{a} [{u}]",
    "{t} ({s})  {a} ({u})",
    "# {t} ({s}), {a} ({u})",
    "% {t} [{s}], {a} [{u}]",
)


def _tables() -> Iterator[Variant]:
    words = itertools.cycle([("Time", "Acc"), ("t", "a"), ("time", "Acceleration"), ("Zeit", "ag")])
    for i, (spelling, unit) in enumerate(ACCELERATIONS.items()):
        for names in (_NAMES[i % len(_NAMES)], _NAMES[(i + 3) % len(_NAMES)]):
            t, a = next(words)
            header = names.format(t=t, a=a, s="s", u=spelling)
            yield Variant(f"table {header}", f"{header}\n{_rows(unit)}".encode(), unit, DT)
    for i, spelling in enumerate(OTHERS):
        header = _NAMES[i % 6].format(t="Time", a="Acc", s="s", u=spelling)
        yield Variant(f"table {header}", f"{header}\n{_rows(1.0)}".encode(), is_record=False)
    for names, (spelling, seconds) in itertools.product(_NAMES, TIMES.items()):
        header = names.format(t="Time", a="Acc", s=spelling, u="g")
        yield Variant(f"table {header}", f"{header}\n{_rows(G, seconds)}".encode(), G, DT)
    for header in (
        "Period (s),Sa (g)",
        "T (s),Sa (g)",
        "Frequency (Hz),FAS (cm/s)",
        "f [Hz],a [g]",
        "Period,Acceleration",
        "T;PSA (m/s2)",
        "# Period (s), Sa (g)",
        "index,a (g)",
        "sample,acc [m/s2]",
        "Time (s),Velocity (cm/s)",
        "t,v",
        "t [s],u [m]",
        "a1 (g),a2 (g)",
        "Time (s),Acc (cm/s)",
        "t (s),Velocity (g)",
        "sa,poe_50",
        "Time (s),Force (kN)",
        "Time (s),Acc (g),Vel (cm/s)",
        "t,d",
        "T_n [s],S_a [g]",
        "Hz,g",
    ):
        yield Variant(f"table {header}", f"{header}\n{_rows(G)}".encode(), is_record=False)
    for header, unit in (
        ("t_s,a_g", G),
        ("t_s,a_cm_s2", 0.01),
        ("time in s,acc in cm/s2", 0.01),
        ("t/s,a/g", G),
        ("t / s,a / (m/s^2)", 1.0),
        ("time s,acc gal", 0.01),
        ("Time (s),Acc (EW) [cm/s2]", 0.01),
        ("relative time (s),Acc. (m/s/s)", 1.0),
    ):
        yield Variant(f"table {header}", f"{header}\n{_rows(unit)}".encode(), unit, DT)
    for header in ("time,acceleration", "t a", "El Centro 1940", "# a note", "Station A, N-S", ""):
        yield Variant(f"table {header}", f"{header}\n{_rows(G)}".encode(), None, DT, written=G)
    for header in ("time ms acc g", "# times in ms", "Time,ms,Acc,g"):
        yield Variant(
            f"table {header}", f"{header}\n{_rows(G, 1e-3)}".encode(), G, DT, is_read=False
        )


def _orders() -> Iterator[Variant]:
    """Columns beside the acceleration, in any order."""
    cells = {
        "Time (s)": [f"{i * DT:.4g}" for i in range(N)],
        "Acceleration (g)": _numbers(G),
        "Velocity (cm/s)": [f"{i}" for i in range(N)],
        "Displacement (cm)": [f"{-i}" for i in range(N)],
    }
    orders = [
        *itertools.permutations(cells),
        *itertools.permutations(list(cells)[:3]),
        *itertools.permutations(list(cells)[:2]),
    ]
    for order in orders:
        for mark in (",", ";", "\t"):
            rows = zip(*(cells[name] for name in order), strict=True)
            text = "\n".join([mark.join(order), *(mark.join(row) for row in rows)])
            yield Variant(f"order {mark}{order}", text.encode(), G, DT)


def _comments() -> Iterator[Variant]:
    one = "\n".join(_numbers(0.01)) + "\n"
    for mark, facts in itertools.product(
        ("# ", "% ", "! ", "// ", "#"),
        (
            "dt = 0.01 s, units = cm/s2",
            "DT: 10 ms; units: gal",
            "sampling rate: 100 Hz, unit: cm/s^2",
            "Acceleration (cm/s/s), time step 0.01 s",
            "units of cm/s2\n{}NPTS = 40, DT = 0.01",
            "sampling interval (ms) = 10\n{}acc [gal]",
        ),
    ):
        text = mark + facts.format(mark) + "\n" + one
        yield Variant(f"comment {mark}{facts}", text.encode(), 0.01, DT)
    for facts in (
        "units: cm/s",
        "velocity [m/s]",
        "NPTS = 41",
        "unit = cm/s2\n# unit = g",
        "dt = 0.01\n# dt = 0.02",
        "units: furlong",
        "velocity history",
        "dt = 100 Hz",
    ):
        yield Variant(f"comment {facts}", f"# {facts}\n{one}".encode(), is_record=False)
    for line in ("T = 0.01 s", "dt=0.01", "Sampling interval 10 ms", f"{DT} {N}", f"{N} {DT}"):
        yield Variant(f"line {line}", f"{line}\n{one}".encode(), None, DT, written=0.01)
    yield Variant("count", f"{N}\n{one}".encode(), is_record=False)
    yield Variant("count and interval", f"{N}\n{DT}\n{one}".encode(), is_record=False)
    for line in (
        f"0.005 {N}",
        f"{DT} {N}",
        f"{N} {DT}",
        "# dt = 0.02 s",
        "# NPTS = 41",
        "T = 0.02 s",
    ):
        rows = _rows(0.01, mark=" ").replace("0 0\n", "0.001 0\n", 1)
        yield Variant(f"two {line}", f"{line}\n{rows}".encode(), is_record=False)
    yield Variant("no statement", one.encode(), written=0.01)


def _bytes() -> Iterator[Variant]:
    """Make the same files with other marks, line ends and encodings."""
    header = "Time [s];Acc [cm/s²]\n"
    text = header + _rows(0.01, mark=";")
    at2 = _at2(G, "ACCELERATION TIME SERIES IN UNITS OF G", f"NPTS= {N}, DT= {DT} SEC")
    files = {
        "table": (text, 0.01),
        "AT2": (at2, G),
        "decimal commas": (text.replace(".", ","), 0.01),
        "comma after rows": (header.replace(";", ",") + _rows(0.01, extra=","), 0.01),
        "Fortran exponents": (at2.replace("\n0 ", "\n0.D0 "), G),
    }
    for name, (content, unit) in files.items():
        plain = content.encode()
        for change, changed in {
            "none": plain,
            "BOM": b"\xef\xbb\xbf" + plain,
            "CRLF": content.replace("\n", "\r\n").encode(),
            "ctrl-Z": plain + b"\x1a",
            "CRLF ctrl-Z": plain + b"\r\n\x1a\x1a\r\n",
            "no end": plain.rstrip(),
            "Latin-1": content.encode("latin-1"),
            "blank lines": plain.replace(b"\n", b"\n\n"),
            "BOM CRLF ctrl-Z": b"\xef\xbb\xbf" + content.replace("\n", "\r\n").encode() + b"\x1a",
        }.items():
            yield Variant(f"bytes {name} {change}", changed, unit, DT)
        for change, changed in {
            "UTF-16": content.encode("utf-16"),
            "zip": b"PK\3\4" + plain,
            "NUL": b"\0" + plain,
            "ctrl-Z": b"\x1a".join([plain[:-20], plain[-20:]]),
        }.items():
            yield Variant(f"bytes {name} {change}", changed, is_record=False)
    tabs = "Zeit [s]\tAcc [g]\n" + _rows(G, mark="\t").replace(".", ",")
    yield Variant("bytes tabs with decimal commas", tabs.encode(), is_record=False)


def variants() -> list[Variant]:
    """Make all variants.

    Returns
    -------
    list of Variant
        Files and the truth about them.
    """
    return [*_peer(), *_tables(), *_orders(), *_comments(), *_bytes()]
