"""How close `fast` comes to what the machine can do: operations of an ordinate, and where they are.

.venv/bin/python bench/flops.py [--gamma X] [--low T] [--high T] [--ordinates N]

* valgrind --tool=callgrind runs the batch program and counts how often each instruction is
  executed; objdump says which of them are floating-point additions, multiplications, divisions and
  roots, and how many numbers wide (an addition of 8 numbers counts 8, a fused multiply-add 2 a
  number). valgrind knows no AVX-512: the loops run as AVX2, with the same operations.
* bench/peak_rate.c measures how many multiplications and additions one core does in a second.
* perf, where it is installed, says where the time goes.

Only the modules of `fast` are listed: the batch program also reads, writes and does one single run.
"""

from __future__ import annotations

import argparse
import os
import re
import shutil
import subprocess
import tempfile
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from peers.measure import kernel
from peers.problem import case, read_record
from peers.recursion import build
from spectra import RECORD, ROOT

BATCH = ROOT / ".venv" / "bin" / "rwmf-batch"
RTOL = 1e-7
# the modules of the method
PREFIX = "spectrum_fast_"
# name of an instruction: operation, packed or scalar, double
_OPERATION = re.compile(r"^v?(add|sub|mul|div|sqrt|fn?m(?:add|sub)\d+)(p|s)d$")
_MODULE = re.compile(r"__(?:rwmf_)?(\w+?)(?:_v\d)?_MOD_")
_WIDTHS = {"z": 8, "y": 4, "x": 2}


class Count:
    """What was executed in one module of the kernel."""

    def __init__(self) -> None:
        self.instructions = 0
        self.scalar = 0
        """Operations on one number at a time."""
        self.packed = 0
        """Operations on several numbers at a time."""

    def add(self, other: Count) -> None:
        """Add what another module did."""
        self.instructions += other.instructions
        self.scalar += other.scalar
        self.packed += other.packed


def _operations(mnemonic: str, operands: str) -> tuple[int, bool]:
    """Return operations of one instruction, and whether it is packed."""
    match = _OPERATION.match(mnemonic)
    if match is None:
        return 0, False
    each = 2 if match[1].startswith("f") else 1
    register = re.search(r"%([xyz])mm", operands)
    if match[2] == "s" or register is None:
        return each, False
    return each * _WIDTHS[register[1]], True


def _disassemble(path: str) -> dict[int, tuple[int, bool]]:
    """Operations by address."""
    done = _run(["objdump", "-d", "--no-show-raw-insn", path])
    found = {}
    for line in done.splitlines():
        head, _, text = line.partition(":\t")
        mnemonic, _, operands = text.partition(" ")
        n, is_packed = _operations(mnemonic, operands)
        if n:
            found[int(head, 16)] = (n, is_packed)
    return found


def _executed(path: Path) -> Iterator[tuple[str, str, int, int]]:
    """Object, function, address and count of every line of callgrind's output."""
    binary = function = ""
    skip = False
    for line in path.read_text(encoding="utf-8").splitlines():
        if line.startswith("ob="):
            binary = line[3:]
        elif line.startswith("fn="):
            function = line[3:]
        elif line.startswith("calls="):
            # the next line is the cost of what is called
            skip = True
        elif line.startswith("0x"):
            if not skip:
                words = line.split()
                yield binary, function, int(words[0], 16), int(words[-1])
            skip = False


def _module(function: str, binary: str) -> str:
    match = _MODULE.search(function)
    return match[1] if match else Path(binary).name


def _count(namelist: Path) -> dict[str, Count]:
    """Run the batch program under callgrind."""
    output = namelist.with_suffix(".callgrind")
    _run(
        ["valgrind", "--tool=callgrind", "--dump-instr=yes", "--compress-pos=no",
         "--compress-strings=no", f"--callgrind-out-file={output}", str(BATCH), str(namelist),
         "--out", str(namelist.parent)]
    )  # fmt: skip
    found: dict[str, Count] = defaultdict(Count)
    objects: dict[str, dict[int, tuple[int, bool]]] = {}
    for binary, function, address, times in _executed(output):
        if binary not in objects:
            objects[binary] = _disassemble(binary) if Path(binary).is_file() else {}
        count = found[_module(function, binary)]
        n, is_packed = objects[binary].get(address, (0, False))
        count.instructions += times
        if is_packed:
            count.packed += n * times
        else:
            count.scalar += n * times
    return found


def _time_shares(namelist: Path) -> dict[str, float]:
    """Share of the time of each module by perf; empty without it."""
    found: dict[str, float] = defaultdict(float)
    if shutil.which("perf") is None:
        return found
    data = str(namelist.with_suffix(".perf"))
    _run(["perf", "record", "-q", "-F", "5000", "-o", data, str(BATCH), str(namelist), "--out",
          str(namelist.parent)])  # fmt: skip
    report = _run(["perf", "report", "-q", "--stdio", "-i", data, "-t", "|",
                   "--fields=overhead,dso,symbol"])  # fmt: skip
    for line in report.splitlines():
        words = [word.strip() for word in line.split("|")]
        if len(words) == 3 and words[0].endswith("%"):
            found[_module(words[2], words[1])] += float(words[0][:-1]) / 100
    return found


def _run(words: list[str]) -> str:
    """Run a program on one thread; return what it prints."""
    done = subprocess.run(
        words,
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "OMP_NUM_THREADS": "1"},
    )
    if done.returncode != 0:
        raise RuntimeError(f"{words[0]} failed:\n{done.stderr[-2000:]}")
    return done.stdout


def main() -> None:
    """Count, measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--gamma", type=float, default=1800.0, help="mass ratio")
    parser.add_argument("--low", type=float, default=0.5, help="shortest period, s")
    parser.add_argument("--high", type=float, default=3.0, help="longest period, s")
    parser.add_argument("--ordinates", type=int, default=192, help="of the count")
    options = parser.parse_args()
    for program in ("valgrind", "objdump"):
        if shutil.which(program) is None:
            raise SystemExit(f"{program} is missing: apt-get install valgrind binutils")
    lanes, plain, fused = (float(word) for word in _run([str(build("peak_rate"))]).split())
    record = read_record(RECORD)
    T_s = np.linspace(options.low, options.high, options.ordinates)
    scene = case(record, "fast", RTOL)
    _, seconds = kernel(scene, T_s, options.gamma, repeats=20)
    with tempfile.TemporaryDirectory() as folder:
        paths = []
        for name, factor in (("count", 1), ("time", 16)):
            grid = {"T_s_min": options.low, "T_s_max": options.high,
                    "n": factor * options.ordinates, "spacing": "linear"}  # fmt: skip
            frame = {"gamma": options.gamma, "T_s": 1.0}
            text = scene.replace(spectrum={"T_s": None, **grid}, frame=frame).text
            paths.append(Path(folder) / f"{name}.nml")
            paths[-1].write_text(text, encoding="utf-8")
        counts, shares = _count(paths[0]), _time_shares(paths[1])
    _print(counts, shares, seconds, options, (int(lanes), plain, fused))


def _print(
    counts: dict[str, Count],
    shares: dict[str, float],
    seconds: float,
    options: argparse.Namespace,
    peak: tuple[int, float, float],
) -> None:
    """Print the table and the sum."""
    lanes, plain, fused = peak
    n = options.ordinates
    cost = seconds / n
    print(
        f"fast at {RTOL:.0e}, gamma = {options.gamma:g}, {n} periods from {options.low:g} to "
        f"{options.high:g} s, one thread: {1e6 * cost:.3g} us an ordinate.\n"
        f"One core: {1e-9 * plain:.3g}e9 multiplications and additions a second in {lanes} lanes, "
        f"{1e-9 * fused:.3g}e9 as fused ones.\n"
    )
    heads = (
        "module", "operations an ordinate", "of these in lanes", "instructions an ordinate",
        "share of the time", "of the core's most",
    )  # fmt: skip
    print("| " + " | ".join(heads) + " |")
    print("|" + "---|" * len(heads))
    ours = [name for name in counts if name.startswith(PREFIX)]
    spent = sum(shares[name] for name in ours)
    total = Count()
    for name in sorted(ours, key=lambda name: (-shares[name], -counts[name].instructions)):
        count = counts[name]
        total.add(count)
        _print_line(name, count, n, cost, shares[name] / spent if spent else 0.0, plain)
    _print_line("all", total, n, cost, 1.0, plain)


def _print_line(name: str, count: Count, n: int, cost: float, share: float, plain: float) -> None:
    """Print what one module does and how fast."""
    operations = count.scalar + count.packed
    packed = f"{count.packed / operations:.0%}" if operations else "-"
    reached = f"{operations / n / (share * cost) / plain:.2%}" if share > 0 else "-"
    print(
        f"| {name} | {operations / n:.0f} | {packed} | {count.instructions / n:.0f} "
        f"| {share:.1%} | {reached} |"
    )


if __name__ == "__main__":
    main()
