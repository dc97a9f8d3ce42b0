"""Record files with every kind of header, with statements of unit, interval and quantity."""

import itertools
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from checkout import ROOT

N = 40
DT = 0.01
# accelerations [m/s2]
SAMPLES = np.round(np.sin(np.arange(N) * 0.7) * np.hanning(N) * 3, 4)
G = 9.81
_HEADERS = ROOT / "tests" / "reference" / "record_headers.txt"
_AT2 = "PEER NGA STRONG MOTION DATABASE RECORD\nTown, 1/1/2000, Station A, 90\n"


class Variant(NamedTuple):
    """A file and the truth about it.

    Attributes
    ----------
    name : str
        For messages.
    content : bytes
        The file.
    written : float
        Size of the unit of its numbers [m/s2].
    unit : float, optional
        Size of its unit [m/s2]; None where the file states none.
    dt : float, optional
        Its interval [s]; None where the file states none.
    is_record : bool
        False for a file that must be refused.
    is_read : bool
        True for a file that must be read with the right keys.
    """

    name: str
    content: bytes
    written: float = G
    unit: float | None = None
    dt: float | None = None
    is_record: bool = True
    is_read: bool = True


def _numbers(unit: float) -> list[str]:
    return [f"{a / unit:.10g}" for a in SAMPLES]


def _rows(unit: float, seconds: float = 1.0, mark: str = ",", extra: str = "") -> str:
    times = [f"{i * DT / seconds:.10g}" for i in range(N)]
    return "".join(f"{t}{mark}{a}{extra}\n" for t, a in zip(times, _numbers(unit), strict=True))


def _numbers_by_five(unit: float) -> str:
    cells = _numbers(unit)
    return "".join(f"{' '.join(cells[i : i + 5])}\n" for i in range(0, N, 5))


def _with_headers() -> Iterator[Variant]:
    """Make the files whose headers are stored."""
    for block in _HEADERS.read_text(encoding="utf-8").split("=== ")[1:]:
        heading, *headers = filter(None, block.split("\n"))
        kind, size, seconds, *truth = heading.split()
        written = float(size)
        numbers = {
            "at2": _numbers_by_five(written),
            "table": _rows(written, float(seconds)),
            "one": "\n".join(_numbers(written)) + "\n",
        }[kind]
        stated = [None if word == "-" else float(word) for word in truth[:2] if word != "refused"]
        for line in headers:
            header = line.replace("\\n", "\n").replace("\\t", "\t")
            text = f"{_AT2 if kind == 'at2' else ''}{header}\n{numbers}"
            facts = (*(stated or (None, None)), "refused" not in truth, "unread" not in truth)
            yield Variant(f"{kind} {line}", text.encode(), written, *facts)
    for line in (f"0.005 {N}", f"{DT} {N}", f"{N} {DT}", "# dt = 0.02 s", "# NPTS = 41",
                 "T = 0.02 s"):  # fmt: skip
        rows = _rows(0.01, mark=" ").replace("0 0\n", "0.001 0\n", 1)
        yield Variant(f"two {line}", f"{line}\n{rows}".encode(), is_record=False)
    yield Variant("no statement", "\n".join(_numbers(0.01)).encode(), 0.01)


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
            yield Variant(f"order {mark}{order}", text.encode(), G, G, DT)


def _bytes() -> Iterator[Variant]:
    """Make the same files with other marks, line ends and encodings."""
    header = "Time [s];Acc [cm/s²]\n"
    text = header + _rows(0.01, mark=";")
    at2 = f"{_AT2}UNITS OF G\nNPTS= {N}, DT= {DT} SEC\n{_numbers_by_five(G)}"
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
            yield Variant(f"bytes {name} {change}", changed, unit, unit, DT)
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
    return [*_with_headers(), *_orders(), *_bytes()]
