"""Calls of the command, from a seed.

Mutated command lines and sweep files, outputs that are inputs, and sweeps restarted over other
files or other sweeps.
"""

from __future__ import annotations

import random
from collections.abc import Mapping
from dataclasses import dataclass

from fuzz import RECORDS, mutate, mutate_bytes

# files in the folder of every call: short runs
INPUTS = {
    "case.nml": b"""&wall h = 2.0, b = 0.5 /
&frame T_s = 1.0, gamma = 5.0, xi_s = 0.05 /
&cable eta_0 = 1.0 /
&impact e = 0.9 /
&motion kind = 'one_sine', a_max_g = 0.4, omega_p = 6.28 /
&solver method = 'dop853', rtol = 1e-4, t_end = 0.3, max_steps = 2000 /
&spectrum T_s = 0.5, 1.0 /
""",
    "block.nml": b"""&wall h = 2.0, b = 0.5 /
&impact e = 0.9 /
&motion kind = 'one_sine', a_max_g = 0.4, omega_p = 6.28 /
&solver method = 'dop853', rtol = 1e-4, t_end = 0.3, max_steps = 2000 /
""",
    "s.nml": b"&sweep case = 'case.nml' /\n&grid e = 0.8, 0.9 /\n",
    "record.txt": RECORDS[0],
    "old.nc": b"not the result of a sweep",
    "moved.nml": b"""&wall h = 2.0, b = 0.5 /
&frame T_s = 1.0, gamma = 5.0, xi_s = 0.05 /
&impact e = 0.9 /
&motion kind = 'record', file = 'record.txt', unit = 'g' /
&solver method = 'dop853', rtol = 1e-4, t_end = 0.3, max_steps = 2000 /
&spectrum T_s = 0.5, 1.0 /
""",
    # a record that is called as a result of its case
    "rec.nml": b"""&wall h = 2.0, b = 0.5 /
&impact e = 0.9 /
&motion kind = 'record', file = 'rec.history.csv', unit = 'g' /
&solver method = 'dop853', rtol = 1e-4, t_end = 0.3, max_steps = 2000 /
&output dt = 0.1 /
""",
    "rec.history.csv": RECORDS[0],
    "rows.csv": b"intensity,u_s_max,status\n1,0.005,ok\n2,0.02,ok\n3,0.008,ok\n4,0.03,collapsed\n",
    "hazard.csv": b"intensity,frequency\n0.1,0.01\n1,1e-4\n",
    "part.csv": b"# rwmf\n# part 1/1\n# case:\nT_s_s,u_s_max_m,status\n1.0,0.5,ok\n",
    "suite.nml": b"&sweep case = 'moved.nml', records = 'record.txt', unit = 'g' /\n",
    # no sweep at all, and nothing
    "empty.nc": b"",
    "odd.nc.journal": b"no journal either\n",
}
SWEEPS = (
    """&sweep case = 'case.nml', file = 'out.nc' /
&grid T_s = 0.5, 1.0 gamma = 5 b = 0.5, 0.6 /
""",
    """! many
&sweep
   case = 'case.nml'
   records = 'record.txt', 'rec*.txt'
   unit = 'g'
   dt = 0.1
   quantities = 'u_s_max', 'impacts'
   chunk = 3
/
&grid
   eta = 1, 5,  0, 0
   scale = 0.5, 1.0
   formulation = 'exact', "published"
/
""",
    """&sweep case = 'block.nml' quantities = 'theta_max_over_alpha' file = 'out.nc' /
&grid b = 0.5 motion.a_max_g = 0.1, 0.2 n_pulses = 1 max_steps = 500 /
""",
)
COMMANDS = (
    "run case.nml --json",
    "run case.nml --out .",
    "spectrum case.nml --out out.csv --threads 1 --quantities impacts u_s_max",
    "spectrum case.nml --json",
    "check case.nml",
    "records export",
    "records export elcentro --out out.txt",
    "sweep s.nml --out out.nc --threads 1 --engine threads --workers 1 --part 1/2",
    "sweep s.nml --out out.nc",
    "sweep s.nml --out out.nc --restart",
    "sweep --out out.csv --merge record.txt old.nc",
    "sweep --out out.nc --merge old.journal",
    "study overturning block.nml --omega 5 --amplitude 1,9 --tolerance 1 --threads 1",
    "ida case.nml --records record.txt --unit g --levels 0.1,0.2 --highest 0.3 --out out.csv",
    "stripes case.nml block.nml --records record.txt --unit g --levels 1 --intensity arias",
    "cloud case.nml --records record.txt --unit g --factors 1,2 --pelicun sub --out out.nc",
    "fragility rows.csv --limit 0.01 --mce 1 --dispersions 0.1,0.2 --resamples 3 --out out.nc",
    "risk 0.9,0.4 --hazard hazard.csv --levels 0.1,1 --out out.nc --json",
    "study wall case.nml --T_s 0.5 --gamma 5 --out out.nc",
    "study equal-response case.nml --T_p 0.5 --target 0.01",
    "animate block.nml --out out.doc --fps 1 --speed 1 --until 0.2",
)
_WORDS = (
    "", ".", "..", "/", "-", "--", "-1", "0", "1e999", "nan", "-inf", "99999999999", "1" * 5000,
    "x" * 3000, "/".join(["y" * 200] * 40), "missing.nml", "no/where.nc", "caf\udce9", "\u00e9",
    "a b", "*", "[", "**x.at2", "~", "%s", "{}", "--json", "-h", "--version", "--threads", "--out",
    "--merge", "--plot", "--restart", "--T_s", "--t_s", "--E", "--help", "--dance", "1:2", "1:2:3",
    "1:2:-3", ",", "1,2,3", "2:1:5", "::", "K/N", "0/0", "3/2", "1/99999999999", "mpi",
    "threads:1", "dance:1", "out.png", "out.doc", "fema:moon", "g", "cm/s2", "THETA_MAX_over_alpha",
    "1e-300", "1e300",
)  # fmt: skip
# {} is an output that is also an input; _READ lists the paths in namelists
_OVERWRITING = (
    "run moved.nml --plot {}",
    "run moved.nml --loops {} --json",
    "run moved.nml --out sub --plot {}",
    "spectrum moved.nml --out {} --threads 1",
    "spectrum moved.nml --plot {} --json",
    "cost moved.nml --plot {}",
    "animate moved.nml --out {} --until 0.2",
    "sweep s.nml --out {} --threads 1",
    "sweep suite.nml --restart --out {} --threads 1",
    "sweep suite.nml --out {} --part 1/2 --restart",
    "merge {} part.csv",
    "merge {} half.nc.part-1-of-2.journal half.nc.part-2-of-2.journal",
    "study overturning moved.nml --omega 5 --amplitude 1,9 --tolerance 1 --threads 1 --plot {}",
    "ida moved.nml --records record.txt --unit g --levels 1,2 --plot {} --threads 1",
    "stripes moved.nml --records record.txt --unit g --levels 1 --out {} --restart",
    "fragility rows.csv --limit 0.01 --out {}",
    "fragility rows.csv --limit 0.01 --plot {}",
    "risk 0.9,0.4 --hazard hazard.csv --out {}",
    "study wall moved.nml --T_s 0.5 --gamma 5 --out {} --threads 1",
    "study equal-response case.nml --T_p 0.5 --target 0.01 --out {}",
)
_READ = {
    "moved.nml": ("record.txt",),
    "s.nml": ("case.nml",),
    "suite.nml": ("moved.nml", "record.txt"),
}
_HERE = (".", "./", "sub/..", "here", "{folder}", "{folder}/sub/../here")
# possible earlier contents of a sweep's file: exit status without and with --restart
_PLACES = {
    "new.nc": (0, 0),
    "done.nc": (0, 0),
    "torn.nc": (0, 0),
    "another.nc": (2, 0),
    "begun.nc": (2, 0),
    "old.nc": (2, 2),
    "empty.nc": (2, 2),
    "foreign.nc": (2, 2),
    "locked.nc": (2, 2),
    "odd.nc": (2, 2),
    "planted.nc": (2, 2),
    "sub": (2, 2),
    "missing/new.nc": (2, 2),
    "/dev/null": (2, 2),
    "s.nml": (2, 2),
    "case.nml": (2, 2),
}
# earlier contents that a call with --restart may discard
_DISCARDED = ("done.nc", "another.nc", "begun.nc.journal", "torn.nc.journal")


@dataclass(frozen=True)
class Call:
    """One call of the command.

    Attributes
    ----------
    words : list of str
        Arguments of the command.
    inputs : dict
        Contents of the existing files, by name.
    loose : tuple of str
        Those that the call may change.
    statuses : tuple of int
        Exit statuses that are right.
    says : str
        Required part of an error message.
    """

    words: list[str]
    inputs: Mapping[str, bytes]
    loose: tuple[str, ...] = ()
    statuses: tuple[int, ...] = (0, 1, 2)
    says: str = ""


def make_call(kind: str, number: int, results: Mapping[str, bytes], folder: str) -> Call:
    """Make the call of a number.

    Parameters
    ----------
    kind : str
        One of `KINDS`.
    number : int
        Any; the same number gives the same call.
    results : dict
        Content of files that only a sweep can write by name.
    folder : str
        Where the call takes place.

    Returns
    -------
    Call
        Words and files.
    """
    return KINDS[kind](number, {**INPUTS, **results}, folder)


def _sweep_file(number: int, inputs: Mapping[str, bytes], _: str) -> Call:
    """Call with a sweep file that is mutated."""
    dice = random.Random(f"sweep {number}")
    text = dice.choice(SWEEPS)
    for _ in range(dice.choice((1, 1, 2, 3))):
        text = mutate(dice, text)
    raw = text.encode("utf-8", "surrogateescape")
    raw = mutate_bytes(dice, raw) if dice.random() < 0.1 else raw
    return Call(["sweep", "s.nml", "--threads", "1"], {**inputs, "s.nml": raw})


def _command_line(number: int, inputs: Mapping[str, bytes], _: str) -> Call:
    """Call with mutated words, none of which becomes the name of an existing file."""
    dice = random.Random(f"command {number}")
    words = dice.choice(COMMANDS).split()
    for _ in range(dice.choice((1, 1, 2, 3))):
        at, kind = dice.randrange(len(words) + 1), dice.randrange(4)
        if kind == 0 or at == len(words):
            words.insert(at, dice.choice(_WORDS))
        elif kind == 1:
            del words[at]
        elif kind == 2 and words[at] not in INPUTS:
            words[at] = words[at][: dice.randrange(len(words[at]) + 1)] + dice.choice(_WORDS)
        else:
            words[at] = dice.choice(_WORDS)
    # an argument of a process has no NUL
    return Call([word.replace("\0", "") for word in words], inputs)


def _overwriting(number: int, inputs: Mapping[str, bytes], folder: str) -> Call:
    """Call whose output is one of its inputs, each under some name."""
    dice = random.Random(f"overwriting {number}")
    if dice.random() < 0.1:
        # outputs without a given name
        place = dice.choice(_HERE).replace("{folder}", folder)
        words = ["run", dice.choice(("", "./", "here/", "link-", "hard-")) + "rec.nml"]
        words += ["--out", place]
    else:
        words = dice.choice(_OVERWRITING).split()
        read = [word for word in words if word in inputs]
        read += [more for word in read for more in _READ.get(word, ())]
        output = dice.choice(read)
        words = [
            _spelled(dice, output if word == "{}" else word, folder)
            if word == "{}" or (word in inputs and not word.endswith(".journal"))
            else word
            for word in words
        ]
    if dice.random() < 0.2:
        words.insert(dice.randrange(1, len(words) + 1), dice.choice(_WORDS))
        return Call(words, inputs)
    return Call(words, inputs, (), (2,), "read by this run")


def _spelled(dice: random.Random, name: str, folder: str) -> str:
    """Return another name of a file."""
    shape = dice.choice(
        (
            "{}",
            "./{}",
            "sub/../{}",
            "here/{}",
            "{folder}/{}",
            "link-{}",
            "hard-{}",
            "./here/link-{}",
        )
    )
    return shape.replace("{folder}", folder).replace("{}", name)


def _restart(number: int, inputs: Mapping[str, bytes], folder: str) -> Call:
    """Call of a sweep into a place where something is, which may be another's."""
    dice = random.Random(f"restart {number}")
    place = dice.choice(list(_PLACES))
    restarts = dice.random() < 0.7
    is_name = place in inputs or f"{place}.journal" in inputs
    spelled = _spelled(dice, place, folder) if place in inputs else place
    words = ["sweep", "s.nml", "--threads", "1", "--out", spelled]
    words += ["--restart"] * restarts
    statuses = (_PLACES[place][restarts],)
    loose: tuple[str, ...] = ()
    if is_name and (restarts or place == "torn.nc"):
        loose = tuple(name for name in _DISCARDED if name.startswith(place))
    if spelled not in (place, f"./{place}") or dice.random() < 0.2:
        # the journal of another name, or of a part, is another journal
        statuses = (0, 2)
        words += ["--part", f"{dice.randrange(1, 3)}/2"] * dice.randrange(2)
    if dice.random() < 0.2:
        words.insert(dice.randrange(1, len(words) + 1), dice.choice(_WORDS))
        statuses = (0, 1, 2)
        loose = tuple(name for name in _DISCARDED if name.startswith(place))
    return Call(words, inputs, loose, statuses)


KINDS = {
    "command lines": _command_line,
    "sweep files": _sweep_file,
    "outputs that are inputs": _overwriting,
    "restarts": _restart,
}
