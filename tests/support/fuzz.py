"""Mutated namelists and records, from a seed.

Texts are cut, doubled, exchanged and overwritten with input that is difficult to parse; the same
number makes the same input on every machine.
"""

import random
from dataclasses import dataclass

from checkout import ROOT

SEEDS = tuple(
    (ROOT / "tests" / "reference" / "fuzzed.nml").read_text(encoding="utf-8").split("! ---\n")
)
RECORDS = (
    b"# time a\n0.0 0.0\n0.1 0.2\n0.2 -0.3\n0.3 0.1\n0.4 0.0\n",
    b"t,a\n0,0\n.1,1e-1\n.2,-2E-1\n.3,0\n",
    b"PEER\nPLACE\nUNITS OF G\n 6  0.1  NPTS, DT\n 0.0 0.1 0.2\n -0.1 0.0 0.0\n",
)
_TOKENS = (
    "1e308", "-1e308", "1e-308", "NaN", "inf", "-0", "0", "1d400", "1e", "+", "-", ".", "'", '"',
    "/", "&", "&end", "=", ",", "!", "$", "\t", "\r\n", "\x00", "\x1b", "é", "\ufeff", "2*1.0",
    "()", "%", ".true.", "''", "'a''b'", "99999999999999999999", "1" * 400, " " * 3000, "#", ";",
    "&wall", "h", "T_s", "e = 1.0", "gamma = 0", "t_end = 1e-300", "dt = 1e-300", "n = 1000000",
    "rtol = 1e-300", "xi_s = 1e300", "eta_0 = 1e300", "a_max_g = 1e300", "T_s = 1e-300",
    "eta_y = 1e-300", "eta_y = 1e300", "stroke_y = 1e-300", "u_y = 1e-300",
    "hardening = 0.9999999", "rupture_strain = 1e300", "b = 1e-300", "h = 1e300",
    "method = 'bdf'", "formulation = 'published'",
)  # fmt: skip
_BYTES = (b"\x00", b"\xff\xfe", b"nan", b"inf", b"1e999", b"-1e308", b"1,2,3", b"\r", b"\n\n", b"#",
          b"1e-308", b"9" * 400, b"x", b"NPTS", b"-", b".", b"1d3", b"\x1a", b"\t,\t")  # fmt: skip


@dataclass(frozen=True)
class Attack:
    """Namelist and record of one attempt."""

    number: int
    namelist: bytes
    record: bytes


def attack(number: int) -> Attack:
    """Make the input of a number.

    Parameters
    ----------
    number : int
        Any; the same number gives the same bytes.

    Returns
    -------
    Attack
        A namelist and a record; one of both at least is mutated.
    """
    dice = random.Random(number)
    text = dice.choice(SEEDS)
    record = dice.choice(RECORDS)
    if dice.random() < 0.25:
        text = SEEDS[1]
        record = mutate_bytes(dice, record)
    for _ in range(dice.choice((0, 1, 1, 2, 3, 8)) if text == SEEDS[1] else dice.choice((1, 2, 5))):
        text = mutate(dice, text)
    raw = text.encode("utf-8", "surrogateescape")
    if dice.random() < 0.1:
        raw = mutate_bytes(dice, raw)
    return Attack(number, raw, record)


def mutate(dice: random.Random, text: str) -> str:
    """Change a text in one place."""
    at, kind = dice.randrange(len(text) + 1), dice.randrange(8)
    if kind == 0:
        return text[:at] + dice.choice(_TOKENS) + text[at:]
    if kind == 1:
        return text[:at] + text[at + dice.randrange(1, 30) :]
    if kind == 2:
        return text[:at]
    if kind == 3:
        return text[:at] + text[at : at + 40] * 2 + text[at + 40 :]
    if kind == 4:
        return text[:at] + chr(dice.randrange(1, 256)) + text[at + 1 :]
    words = text.split(" ")
    spot = dice.randrange(len(words))
    words[spot] = dice.choice(_TOKENS) if kind < 7 else dice.choice(words)
    return " ".join(words)


def mutate_bytes(dice: random.Random, raw: bytes) -> bytes:
    """Change bytes in a few places."""
    for _ in range(dice.randrange(1, 4)):
        at = dice.randrange(len(raw) + 1)
        cut = dice.choice((0, 0, 1, 3, 50))
        raw = raw[:at] + dice.choice(_BYTES) + raw[at + cut :]
    return raw
