"""Components of a record by the names of its files."""

from __future__ import annotations

import re

__all__ = ["VERTICAL", "component_of"]

VERTICAL = "vertical"
_UP = r"(?:up|dwn|down|vert?|[-_]v|[-_]z|[-_]?ud)"
# (whole name, with its ending): key of the record and name of the component; the first that fits
_PATTERNS = tuple(
    re.compile(pattern, re.IGNORECASE)
    for pattern in (
        # K-NET and KiK-net: CHB0021412312349.NS, NGNH311106302345.EW2
        r"(?P<key>.+)\.(?P<part>ns|ew|ud)(?P<further>[12]?)",
        # ESM and COSMOS, by the code of the stream: HI.ARS1..HNN.D.20190728.160908.C.ACC.ASC
        r"(?P<key>(?:.*\.)?[A-Z]{2})(?P<part>[ENZ123])(?P<further>\..*)",
        # PEER, by the number of the record: RSN6_IMPVALL.I_I-ELC180.AT2
        rf"(?P<key>RSN\d+)_(?P<part>.*?)(?P<up>{_UP}(?:[-_]up)?)?(?:[-_]hor[12])?\.\w+",
        # sets of FEMA P-695: far_field_011.csv
        r"(?P<key>(?:far|near)_field_(?:\w+_)?\d\d)(?P<part>[12])\.\w+",
        # NORTHR_SYL090.AT2, quake-UP.txt, quake_h1.csv, quake_x.csv, quake-1.txt
        rf"(?P<key>.+?)(?P<part>\d{{3}}|(?P<up>{_UP})|[-_](?:h?[123]|[xyne]|ns|ew|hor[12]))\.\w+",
    )
)
_VERTICAL_PARTS = ("ud", "z", "3")


def component_of(name: str) -> tuple[str, str]:
    """Return record and component of a file.

    Parameters
    ----------
    name : str
        Name of the file, without folders.

    Returns
    -------
    key : str
        Common to the components of one record; the name itself where no pattern fits.
    part : str
        Name of the component, `VERTICAL` for a vertical one, '' where no pattern fits.
    """
    for pattern in _PATTERNS:
        match = pattern.fullmatch(name)
        if match is None:
            continue
        found = match.groupdict()
        part = found["part"].strip("-_").lower()
        is_up = found.get("up") is not None or part in _VERTICAL_PARTS
        key = found["key"].rstrip("-_") + (found.get("further") or "")
        return key, VERTICAL if is_up else part
    return name, ""
