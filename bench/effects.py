"""Instructions of a right-hand side: the kernel's beside those of a program written by hand.

    .venv/bin/python bench/effects.py            the table of developer/effect-costs.md
    .venv/bin/python bench/effects.py --check    compares the rates alone, without valgrind
    .venv/bin/python bench/effects.py --against FOLDER    fails where the kernel's counts are not
                                                 those of another build (of another revision)

Fails where the kernel's rates are not those by hand. Counting needs valgrind (Debian:
``valgrind``), whose figures are the same in every run of the same binaries; what may not grow is
held by ``tools/counts``. ``bench/effects_by_hand.f90`` has one procedure a scene. A further effect
takes one line of ``SCENES`` and one procedure there.
"""

from __future__ import annotations

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections import Counter
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parent.parent
BUILD = ROOT / "build"

SAME = 1e-9  # relative difference of the sums of theta'': it is the same equation
MARK = "__effects_by_hand_MOD_mark"
# not part of a right-hand side
LOOP = re.compile(r"MAIN__|main$|sum_of_|count_scene|.*_MOD_follow_loading_direction|" + MARK)

AT_REST = "&wall h = 2.0, b = 0.5 /"
WALL = f"{AT_REST}\n&initial theta_over_alpha = 0.3 /"
FRAME = "&frame T_s = 1.0, gamma = 5.0, xi_s = 0.05 /"
BARE = "&frame T_s = 1.0, xi_s = 0.05 /"
CABLE = "&cable eta_0 = 1.0, eta_alpha = 5.0 /"
TRUSS = "&cable eta_0 = 1.0, eta_alpha = 5.0, law = 'truss' /"
TENDON = "&cable eta_0 = 1.0, eta_alpha = 5.0, eta_y = 1.5, hardening = 0.02 /"
FUSE = "&fuse eta_y = 0.5, stroke_y = 0.005, hardening = 0.02 /"
YIELDING = "&yielding u_y = 0.02, hardening = 0.05 /"
SMOOTH = "&yielding u_y = 0.02, hardening = 0.05, law = 'bouc_wen', beta = 0.6, exponent = {} /"
E = "&impact rule = 'constant', e = 0.9 /"
EXPONENTS = ((1, "1"), (2, "2"), (3, "3"), (1.7, "n"))
SMOOTH_LAWS = [(n, hand, SMOOTH.format(n)) for n, hand in EXPONENTS]
SAMPLES = "2.00, 0.1\n2.02, 0.2\n2.04, 0.3\n"  # t (s), a (g): a short record is soon read
RECORD = "&motion kind = 'record', file = 'record.csv', unit = 'g' /"
PULSE = "&motion kind = 'one_sine', a_max_g = 0.4, omega_p = 6.283185307179586 /"
SOLVER = "&solver t_end = 10.0, method = 'adams' /"


def _rwmf(
    formulation: str, *more: str, cable: str = CABLE, motion: str = RECORD, wall: str = WALL
) -> list[str]:
    return [wall, FRAME, cable, E, motion, f"&model formulation = '{formulation}' /", *more]


def _storeys(n: int, coupling: str, *more: str) -> list[str]:
    stiffness = (n * (n + 1) // 2) * 100.0
    return [
        AT_REST,
        "&frame xi_s = 0.05 /",
        f"&storeys m_over_m_w = {n}*2.0, k_over_m_w = {n}*{stiffness}, height = {n}*{4.0 / n}, "
        f"coupling = '{coupling}' /",
        CABLE,
        E,
        RECORD,
        "&model formulation = 'symmetric' /",
        *more,
    ]


class Scene(NamedTuple):
    """A scene, its program by hand and the groups of its case."""

    name: str
    hand: str
    groups: list[str]


SCENES = [
    Scene("frame alone", "frame", [BARE, RECORD]),
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
    Scene(
        "pinned wall",
        "pinned",
        [WALL.replace("b = 0.5", "b = 0.5, base = 'pinned'"), FRAME, RECORD],
    ),
    Scene("RWMF + damper", "damper", _rwmf("symmetric", "&damper c_over_m_w = 0.5 /")),
    Scene("RWMF + fuses, elastic", "fuse", _rwmf("symmetric", FUSE)),
    Scene("RWMF + fuses, yielding", "fuse_yielding", _rwmf("symmetric", FUSE)),
    Scene("frame alone, elastic", "oscillator", [BARE, YIELDING, RECORD]),
    Scene("frame alone, yielding", "oscillator_yielding", [BARE, YIELDING, RECORD]),
    Scene("RWMF + yielding frame, elastic", "yielding", _rwmf("symmetric", YIELDING)),
    Scene("RWMF + yielding frame, yielding", "yielding_yielding", _rwmf("symmetric", YIELDING)),
    *(
        Scene(f"frame alone, Bouc-Wen, n = {n}", f"frame_smooth_{hand}", [BARE, law, RECORD])
        for n, hand, law in SMOOTH_LAWS
    ),
    *(
        Scene(f"RWMF + Bouc-Wen, n = {n}", f"smooth_{hand}", _rwmf("symmetric", law, wall=AT_REST))
        for n, hand, law in SMOOTH_LAWS
    ),
    Scene("RWMF + tendon, elastic", "tendon", _rwmf("symmetric", cable=TENDON)),
    Scene("RWMF + tendon, yielding", "tendon_yielding", _rwmf("symmetric", cable=TENDON)),
    Scene("RWMF + inerter", "inerter", _rwmf("symmetric", "&inerter inertance_over_m_w = 2.0 /")),
    Scene("RWMF, 5 storeys, reduced", "one_mode", _storeys(5, "reduced")),
    Scene("RWMF, 5 storeys, every_floor", "one_mode", _storeys(5, "every_floor")),
    Scene("RWMF, 2 storeys, full", "storeys_2", _storeys(2, "full")),
    Scene("RWMF, 5 storeys, full", "storeys", _storeys(5, "full")),
    Scene(
        "RWMF, 5 storeys, full, can yield",
        "storeys_on_branches",
        _storeys(5, "full", "&yielding storey_u_y = 9.0 /"),
    ),
    Scene("RWMF + vertical", "vertical", _rwmf("symmetric", "&vertical ratio = 0.65 /")),
]


class Count(NamedTuple):
    """Instructions per right-hand side, and of a whole run per step."""

    hand: float
    hand_libm: float
    kernel: float
    kernel_libm: float
    step: float


def _section(text: str) -> tuple[int, int, int]:
    """Instructions of one file of callgrind: all, those of right-hand sides, of these in libm.

    A line of cost belongs to the object and function named last, except the line after ``calls=``,
    which is the cost of the callee.
    """
    objects: dict[str, str] = {}
    functions: dict[str, str] = {}
    costs: Counter[tuple[str, str]] = Counter()
    here = ["", ""]
    is_call = False
    for line in text.splitlines():
        if match := re.match(r"(c?)(ob|fn)=\((\d+)\)(?: (.*))?", line):
            names = objects if match[2] == "ob" else functions
            if match[4]:
                names[match[3]] = match[4]
            if not match[1]:
                here[match[2] == "fn"] = match[3]
        elif line.startswith("calls="):
            is_call = True
        elif re.match(r"[0-9+*-]", line):
            if not is_call:
                costs[here[0], here[1]] += int(line.split()[1])
            is_call = False
    inner = {key: n for key, n in costs.items() if not LOOP.match(functions[key[1]])}
    libm = sum(n for key, n in inner.items() if "libm.so" in objects[key[0]])
    return sum(costs.values()), sum(inner.values()), libm


def _run(build: Path, scenes: list[Scene], work: Path, *before: str) -> list[tuple[float, float]]:
    """States and steps of each scene, all in one run of the program; the rates must agree."""
    (work / "record.csv").write_text(SAMPLES, encoding="utf-8")
    arguments = []
    for i, scene in enumerate(scenes):
        case = work / f"{i}.nml"
        case.write_text("\n".join([*scene.groups, SOLVER]) + "\n", encoding="utf-8")
        arguments += [scene.hand, str(case)]
    # all functions of libm are bound before the start, and one thread does everything
    settings = {**os.environ, "LD_BIND_NOW": "1", "OMP_NUM_THREADS": "1"}
    done = subprocess.run(
        [*before, str(build / "bench" / "effects"), *arguments],
        capture_output=True,
        text=True,
        check=False,
        env=settings,
    )
    if done.returncode:
        sys.exit(f"{done.stdout}{done.stderr}")
    found = []
    for scene, line in zip(scenes, done.stdout.splitlines(), strict=True):
        states, sum_hand, sum_kernel, steps = map(float, line.split())
        if abs(sum_kernel / sum_hand - 1) > SAME:
            sys.exit(f"{scene.name}: not the same equation: {sum_kernel} and {sum_hand}")
        found.append((states, steps))
    return found


def _count(build: Path, scenes: list[Scene]) -> list[Count]:
    """Count all scenes."""
    if not shutil.which("valgrind"):
        sys.exit("valgrind is missing (Debian: apt-get install valgrind)")
    with tempfile.TemporaryDirectory() as folder:
        work = Path(folder)
        command = ["valgrind", "--tool=callgrind", f"--dump-before={MARK}"]
        command.append(f"--callgrind-out-file={work}/out")
        counts = []
        for i, (states, steps) in enumerate(_run(build, scenes, work, *command)):
            hand, kernel, run = (
                _section((work / f"out.{4 * i + part}").read_text(encoding="utf-8"))
                for part in (2, 3, 4)
            )
            counts.append(
                Count(*(n / states for n in (*hand[1:], *kernel[1:])), step=run[0] / steps)
            )
        return counts


def _build(folder: Path) -> None:
    ninja = Path(sys.executable).parent / "ninja"
    subprocess.run([ninja, "-C", folder, "bench/effects"], check=True, stdout=subprocess.DEVNULL)


def _compare(scenes: list[Scene], build: Path, other: Path) -> bool:
    """Print the kernel's counts of two builds and say whether one differs."""
    print("| scene | right-hand side | other build |")
    print("|---|---|---|")
    differs = False
    for scene, ours, theirs in zip(
        scenes, _count(build, scenes), _count(other, scenes), strict=True
    ):
        differs |= ours.kernel != theirs.kernel
        print(f"| {scene.name} | {ours.kernel:.2f} | {theirs.kernel:.2f} |")
    return differs


def _tabulate(scenes: list[Scene], build: Path) -> None:
    """Print the table."""
    print("| scene | kernel | in libm | by hand | in libm | ratio | a step of `adams` |")
    print("|---|---|---|---|---|---|---|")
    for scene, count in zip(scenes, _count(build, scenes), strict=True):
        print(
            f"| {scene.name} | {count.kernel:.1f} | {count.kernel_libm:.1f} | {count.hand:.1f} "
            f"| {count.hand_libm:.1f} | {count.kernel / count.hand:.3f} | {count.step:.0f} |"
        )


def main() -> None:
    """Count and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--check", action="store_true", help="compare the rates, count nothing")
    parser.add_argument("--b", default="0.5", help="half width of the wall in m (default 0.5)")
    parser.add_argument("--built", type=Path, metavar="FOLDER", help="build folder, up to date")
    parser.add_argument("--against", type=Path, metavar="FOLDER", help="another build folder")
    parser.add_argument("scene", nargs="*", help="names by hand; all without any")
    asked = parser.parse_args()
    scenes = [
        scene._replace(groups=[text.replace("b = 0.5", f"b = {asked.b}") for text in scene.groups])
        for scene in SCENES
        if not asked.scene or scene.hand in asked.scene
    ]
    build = asked.built or BUILD
    if not asked.built:
        _build(build)
    if asked.against:
        if _compare(scenes, build, asked.against):
            sys.exit("the counts differ")
    elif asked.check:
        with tempfile.TemporaryDirectory() as folder:
            _run(build, scenes, Path(folder))
    else:
        _tabulate(scenes, build)


if __name__ == "__main__":
    main()
