"""Instructions of a right-hand side, the kernel's beside a program written by hand.

Run it as ``.venv/bin/python bench/effects.py [--check]``; needs valgrind (Debian: ``valgrind``).

Callgrind counts instructions: the figures are the same in every run of the same binaries. Two
numbers of evaluations are counted, and their difference is free of the start; the loop around the
evaluations is counted by itself and subtracted. ``bench/effects_by_hand.f90`` has one procedure a
scene. An effect takes one line of ``SCENES`` and one procedure there.
"""

from __future__ import annotations

import argparse
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parent.parent
BUILD = ROOT / "build"
PROGRAM = BUILD / "bench" / "effects"

STATES = 64  # of the program's table
FEW, MANY = 10 * STATES, 60 * STATES
MOST = 1.05  # the kernel's instructions over those of the program by hand
SAME = 1e-9  # relative difference of the sums of theta'': it is the same equation

WALL = "&wall h = 2.0, b = 0.5 /"
FRAME = "&frame T_s = 1.0, gamma = 5.0, xi_s = 0.05 /"
CABLE = "&cable eta_0 = 1.0, eta_alpha = 5.0 /"
TRUSS = "&cable eta_0 = 1.0, eta_alpha = 5.0, law = 'truss' /"
E = "&impact rule = 'constant', e = 0.9 /"
SAMPLES = "2.00, 0.1\n2.02, 0.2\n2.04, 0.3\n"  # t (s), a (g): a short record is soon read
RECORD = "&motion kind = 'record', file = 'record.csv', unit = 'g' /"
PULSE = "&motion kind = 'one_sine', a_max_g = 0.4, omega_p = 6.283185307179586 /"
SOLVER = "&solver t_end = 10.0 /"


def _rwmf(formulation: str, *more: str, cable: str = CABLE, motion: str = RECORD) -> list[str]:
    return [WALL, FRAME, cable, E, motion, f"&model formulation = '{formulation}' /", *more]


class Scene(NamedTuple):
    """A scene, its program by hand and the groups of its case."""

    name: str
    hand: str
    groups: list[str]


SCENES = [
    Scene("frame alone", "frame", ["&frame T_s = 1.0, xi_s = 0.05 /", RECORD]),
    Scene("free-standing block", "block", [WALL, E, RECORD]),
    Scene(
        "block + cable, linear",
        "block_linear",
        [WALL, CABLE, E, RECORD, "&model formulation = 'symmetric' /"],
    ),
    Scene(
        "block + cable, truss",
        "block_truss",
        [WALL, TRUSS, E, RECORD, "&model formulation = 'symmetric' /"],
    ),
    Scene("RWMF, published", "published", _rwmf("published")),
    Scene("RWMF, symmetric", "symmetric", _rwmf("symmetric")),
    Scene("RWMF, exact", "exact", _rwmf("exact")),
    Scene("RWMF, one-sine pulse", "pulse", _rwmf("symmetric", motion=PULSE)),
    Scene("RWMF + truss", "truss", _rwmf("symmetric", cable=TRUSS)),
    Scene("RWMF + link", "link", _rwmf("symmetric", "&link L = 6.0 /")),
    Scene("pinned wall", "pinned", ["&wall h = 2.0, b = 0.5, base = 'pinned' /", FRAME, RECORD]),
    Scene("RWMF + damper", "damper", _rwmf("symmetric", "&damper c_over_m_w = 0.5 /")),
]


class Count(NamedTuple):
    """Instructions per evaluation: all, and those in the mathematical library."""

    total: float
    libm: float


def _run(arguments: list[str], work: Path) -> tuple[int, int, str]:
    """Instructions of a whole run, of libm in it, and what it prints."""
    out = work / "callgrind.out"
    command = ["valgrind", "--tool=callgrind", f"--callgrind-out-file={out}", str(PROGRAM)]
    done = subprocess.run([*command, *arguments], capture_output=True, text=True, check=False)
    if done.returncode:
        sys.exit(f"{done.stdout}{done.stderr}")
    return *_self_costs(out.read_text(encoding="utf-8")), done.stdout.strip()


def _self_costs(text: str) -> tuple[int, int]:
    """All instructions and those of libm, from a callgrind file.

    A line of cost belongs to the object named last, except the line after ``calls=``, which is the
    cost of the callee.
    """
    names: dict[str, str] = {}
    total = libm = 0
    in_libm = is_call = False
    for line in text.splitlines():
        if match := re.match(r"ob=\((\d+)\)(?: (.*))?", line):
            if match[2]:
                names[match[1]] = match[2]
            in_libm = "libm.so" in names[match[1]]
        elif match := re.match(r"cob=\((\d+)\) (.*)", line):
            names[match[1]] = match[2]
        elif line.startswith("calls="):
            is_call = True
        elif re.match(r"[0-9+*-]", line):
            if not is_call:
                cost = int(line.split()[1])
                total += cost
                libm += cost if in_libm else 0
            is_call = False
    return total, libm


def _count(side: str, scene: Scene, case: Path) -> tuple[Count, float]:
    """Per evaluation, with the loop, and the sum of theta'' of the longer run."""
    few = _run([side, scene.hand, str(case), str(FEW)], case.parent)
    many = _run([side, scene.hand, str(case), str(MANY)], case.parent)
    total, libm = ((many[i] - few[i]) / (MANY - FEW) for i in (0, 1))
    return Count(total, libm), float(many[2])


def _measure(scene: Scene, work: Path) -> tuple[Count, Count]:
    """Kernel and hand, without the loop."""
    case = work / "case.nml"
    (work / "record.csv").write_text(SAMPLES, encoding="utf-8")
    case.write_text("\n".join([*scene.groups, SOLVER]) + "\n", encoding="utf-8")
    loop, _ = _count("hand", scene._replace(hand="nothing"), case)
    kernel, sum_kernel = _count("kernel", scene, case)
    hand, sum_hand = _count("hand", scene, case)
    if abs(sum_kernel / sum_hand - 1) > SAME:
        sys.exit(f"{scene.name}: not the same equation: {sum_kernel} and {sum_hand}")
    return kernel._replace(total=kernel.total - loop.total), hand._replace(
        total=hand.total - loop.total
    )


def main() -> None:
    """Count and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--check", action="store_true", help=f"fail where the ratio is above {MOST}"
    )
    parser.add_argument("scene", nargs="*", help="names by hand; all without any")
    asked = parser.parse_args()
    if not shutil.which("valgrind"):
        sys.exit("valgrind is missing (Debian: apt-get install valgrind)")
    ninja = Path(sys.executable).parent / "ninja"
    subprocess.run([ninja, "-C", BUILD, "bench/effects"], check=True, stdout=subprocess.DEVNULL)
    print("| scene | kernel | of it libm | by hand | of it libm | ratio |")
    print("|---|---|---|---|---|---|")
    is_above = False
    for scene in SCENES:
        if asked.scene and scene.hand not in asked.scene:
            continue
        with tempfile.TemporaryDirectory() as work:
            kernel, hand = _measure(scene, Path(work))
        ratio = kernel.total / hand.total
        is_above |= ratio > MOST
        print(
            f"| {scene.name} | {kernel.total:.1f} | {kernel.libm:.1f} | {hand.total:.1f} "
            f"| {hand.libm:.1f} | {ratio:.2f} |",
            flush=True,
        )
    if asked.check and is_above:
        sys.exit(f"a ratio is above {MOST}")


if __name__ == "__main__":
    main()
