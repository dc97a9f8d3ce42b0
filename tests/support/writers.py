"""Commands that write files: text, a figure, the program in Fortran, NetCDF, a film."""

import sys
from dataclasses import dataclass
from pathlib import Path

from scenes import coupled

RWMF = [sys.executable, "-m", "rwmf"]
SOLVER = {"t_end": 1.0, "method": "dop853", "rtol": 1e-6}


@dataclass(frozen=True)
class Writer:
    """A command and the files that it writes.

    Attributes
    ----------
    words : list of str
        The command, run in the folder of `prepare`; 'rwmf-batch' means the batch program.
    targets : list of str
        Written files.
    through : bool
        Whether it writes to a pipe as well.
    """

    words: list[str]
    targets: list[str]
    through: bool = True


WRITERS = {
    "run --out": Writer(
        [*RWMF, "run", "case.nml", "--out", "."], ["case.summary.csv", "case.history.csv"]
    ),
    "spectrum --out": Writer([*RWMF, "spectrum", "case.nml", "--out", "s.png"], ["s.png"]),
    "rwmf-batch": Writer(
        ["rwmf-batch", "case.nml"], ["case.summary.csv", "case.history.csv", "case.spectrum.csv"]
    ),
    "sweep": Writer([*RWMF, "sweep", "sweep.nml", "--out", "out.nc"], ["out.nc"], through=False),
    "animate": Writer([*RWMF, "animate", "case.nml", "--fps", "5"], ["case.gif"]),
}


def prepare(folder: Path) -> None:
    """Write the input files of the commands.

    Parameters
    ----------
    folder : path
        Where they are run.
    """
    coupled(solver=SOLVER, spectrum={"T_s": [0.5, 1.0]}, output={"dt": 0.001}).to_namelist(
        folder / "case.nml"
    )
    (folder / "sweep.nml").write_text(
        "&sweep case = 'case.nml', chunk = 2 /\n&grid e = 0.8, 0.9 /\n", encoding="ascii"
    )
    (folder / "part1.csv").write_text(
        "# rwmf\n# part 1/1\n# case:\nT_s_s,u_s_max_m,status\n1.0,0.5,ok\n2.0,0.6,ok\n3.0,0.7,ok\n",
        encoding="ascii",
    )
