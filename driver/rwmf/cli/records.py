"""Subcommand ``rwmf records``."""

from __future__ import annotations

import argparse
import zlib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import rwmf
from rwmf.case import Motion
from rwmf.cli.output import check_files, chosen, print_json, print_warnings, printed_warnings
from rwmf.errors import InputError, OutputError
from rwmf.figures import image_files as figures
from rwmf.figures.ground import draw_records, draw_selection
from rwmf.kernel.progress import progress
from rwmf.motion import records
from rwmf.motion.intensity import G
from rwmf.motion.records import Described, curves, describe
from rwmf.motion.selection import select as choose
from rwmf.motion.waveform import waveform_of

# facts of a table: key, title, width and format
_COLUMNS = (
    ("peak_acceleration_g", "PGA g", 9, ".5g"),
    ("peak_velocity_m_s", "PGV m/s", 9, ".5g"),
    ("peak_displacement_m", "PGD m", 9, ".5g"),
    ("arias_m_s", "Arias m/s", 10, ".5g"),
    ("duration_5_95_s", "D5-95 s", 8, ".5g"),
    ("cav_m_s", "CAV m/s", 9, ".5g"),
    ("dt_s", "dt s", 7, "g"),
    ("duration_s", "length s", 9, "g"),
)


def export(options: argparse.Namespace) -> None:
    """Write a record into a file, or list the records (``rwmf records export``)."""
    if options.name is None:
        print("\n".join(records.list_records()))
    elif options.out is None:
        raise InputError("records export: needs --out FILE")
    else:
        print(records.export(options.name, options.out, force=options.force))


def info(options: argparse.Namespace) -> list[str | None]:
    """Describe records (``rwmf records info``)."""
    check_files(options, options.files)
    found = [
        item for file in options.files for item in describe(Path(file), options.unit, options.dt, G)
    ]
    figures.draw_into(options.plot, 4.6, lambda figure: draw_records(figure, _named_curves(found)))
    for facts, _ in found:
        print_warnings(f"{facts['file']}: {facts['name']}", facts["warnings"])
    if options.json:
        print_json({"records": [facts for facts, _ in found]})
    else:
        _print_facts([facts for facts, _ in found])
    return [options.plot]


def _named_curves(found: list[Described]) -> dict[str, Any]:
    names = [facts["name"] for facts, _ in found]
    return {
        name if names.count(name) == 1 else f"{name} ({i})": curves(wave, G)
        for i, (name, (_, wave)) in enumerate(zip(names, found, strict=True), 1)
    }


def _print_facts(found: list[dict[str, Any]]) -> None:
    width = max(len(facts["name"]) for facts in found)
    print(f"{'':{width}s} " + " ".join(f"{title:>{size}s}" for _, title, size, _ in _COLUMNS))
    for facts in found:
        cells = [
            f"{'uneven' if facts[key] is None else format(facts[key], form):>{size}s}"
            for key, _, size, form in _COLUMNS
        ]
        origin = f"{facts['format']} {facts['direction']}".strip()
        print(f"{facts['name']:{width}s} {' '.join(cells)}  {origin}")


def convert(options: argparse.Namespace) -> list[str | None]:
    """Write a channel as columns, corrected by explicit steps (``rwmf records convert``)."""
    if options.out is None:
        raise InputError("records convert: needs --out FILE")
    check_files(options, [options.record])
    raw = records.read(options.record, **chosen(options, "unit", "dt", "channel"))
    steps = chosen(options, "resample", "baseline", "taper", "band")
    if any(step is not None for step in steps.values()):
        found = records.process(raw, **steps, poles=options.poles)
        crc = zlib.crc32(Path(options.record).read_bytes())
        lines = [f"{i}. {step}" for i, step in enumerate(found.steps, 1)]
        header = [f"{raw.name}, from {Path(options.record).name} (CRC-32 {crc:08x})", *lines]
        header.append(f"by rwmf records convert {rwmf.__version__}")
        header.append(f"dt = {found.motion.dt!r} s, units: {found.motion.unit}")
        waves = {"before": waveform_of(raw, G), "after": waveform_of(found.motion, G)}
        for name, wave in waves.items():
            print(
                f"{name:7s} PGA {wave.peak_acceleration()[0] / G:.5g} g, PGV "
                f"{wave.peak_velocity()[0]:.5g} m/s, PGD {wave.peak_displacement()[0]:.5g} m; at "
                f"the end {wave.velocities()[0, -1]:.2g} m/s, {wave.displacements()[0, -1]:.2g} m"
            )
        print("\n".join(lines))
        _write(found.motion, options, header)
    else:
        waves = {"before": waveform_of(raw, G)}
        _write(raw, options, [])
    drawn = {name: curves(wave, G) for name, wave in waves.items()} if options.plot else {}
    figures.draw_into(options.plot, 4.6, lambda figure: draw_records(figure, drawn))
    return [options.plot]


def _write(motion: Motion, options: argparse.Namespace, header: Sequence[str]) -> None:
    """Write a motion, and print the keys that read it."""
    target = Path(options.out)
    if target.exists() and not options.force:
        raise OutputError(f"{target}: is there already; --force replaces it")
    motion.write(target, header)
    step = "" if motion.dt is None else f", dt = {motion.dt!r}"
    print(f"{target}: {motion.values.size} samples to t = {motion.times[-1]:g} s; read them by")
    print(f"&motion kind = 'record', file = '{target}', unit = '{motion.unit}'{step} /")


def select(options: argparse.Namespace) -> list[str | None]:
    """Choose records and scale them to a target spectrum (``rwmf records select``)."""
    check_files(options, [options.target])
    with printed_warnings(options.target), progress("record") as report:
        found = choose(
            options.records,
            options.target,
            options.band,
            is_paired=options.pairs,
            progress=report,
            **chosen(options, "n", "limits", "damping", "unit", "dt"),
        )
    if options.out:
        found.write(options.out)
    label = f"$S_a$({100 * options.damping:g} %) (g)"
    lines = (found.periods, found.target, found.spectra, label)
    figures.draw_into(options.plot, 3.6, lambda figure: draw_selection(figure, *lines))
    rows = list(zip(found.names, found.records, strict=True))
    if options.json:
        print_json(
            {
                "misfit": found.misfit,
                "records": [
                    {"set": name, "name": item.name, "file": item.path, "factor": item.scale}
                    for name, item in rows
                ],
            }
        )
    else:
        for name, item in rows:
            print(f"{item.scale:9.5f}  {item.name}" + ("" if name == item.name else f"  ({name})"))
        print(f"misfit of the geometric mean over the band: {found.misfit:.4g} in ln(Sa)")
    return [options.out, options.plot]
