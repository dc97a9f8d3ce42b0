"""Options of ``rwmf records``."""

from __future__ import annotations

import argparse

from rwmf.cli.subcommands import Subcommands, add_plot
from rwmf.cli.words import number, numbers, whole, written_file

__all__ = ["add_records"]

_MOST_CHANNELS = 1000
_MOST_RECORDS = 100_000


def add_records(commands: Subcommands) -> None:
    """Add the subcommand ``records`` and its actions."""
    parser = commands.add(
        "records",
        "Ground motions: peaks and intensities, formats, suites, sequences; records of a package.",
        "info inputs/records/elcentro.csv --unit g",
    )
    actions = Subcommands(parser, "ACTION")
    actions.add(
        "list",
        "List the records with variant, points, dt, peak and checksum.",
        "",
        "records_command.show",
    )
    export = actions.add(
        "export",
        "Write a record into a file for &motion; the samples are unchanged.",
        "elcentro inputs/records/elcentro.csv",
        "records_command.export",
    )
    export.add_argument("name", metavar="NAME", help="name from 'rwmf records list'")
    _add_written(export, "replace a file that has other content")
    _add_info(actions)
    _add_convert(actions)
    _add_select(actions)
    _add_join(actions)


def _add_info(actions: Subcommands) -> None:
    parser = actions.add(
        "info",
        "Print peaks, Arias intensity, duration D5-95, CAV, interval and length of records.",
        "inputs/records/elcentro.csv --unit g --plot elcentro.png",
        "records_command.info",
    )
    parser.add_argument("files", metavar="FILE", nargs="+", help="record in a known format")
    _add_samples(parser)
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    add_plot(parser, "histories, spectrum and build-up of energy")


def _add_convert(actions: Subcommands) -> None:
    parser = actions.add(
        "convert",
        "Write a channel of ESM, K-NET, COSMOS, CGS or a table as columns for &motion.",
        "CHB0021412312349.EW chiba_ew.txt",
        "records_command.convert",
    )
    parser.add_argument("record", metavar="RECORD", help="file in a known format")
    _add_written(parser, "replace an existing file")
    text = "number of the channel, from 1; for a file with several"
    parser.add_argument("--channel", metavar="N", type=whole(1, _MOST_CHANNELS), help=text)
    _add_samples(parser)


def _add_select(actions: Subcommands) -> None:
    parser = actions.add(
        "select",
        "Scale records to a target spectrum and choose those whose mean fits it best.",
        "folder --target target.csv --band 0.2,2 --n 11 --out suite.csv",
        "records_command.select",
    )
    text = "files, folders, patterns, lists, fema:far_field and others, as for a sweep"
    parser.add_argument("records", metavar="RECORD", nargs="+", help=text)
    text = "two columns, periods in s and pseudo-accelerations in g, or as their names say"
    parser.add_argument("--target", metavar="FILE", required=True, help=text)
    text = "first and last period of the band in s"
    parser.add_argument("--band", metavar="T1,T2", type=numbers, required=True, help=text)
    text = "number of records (default: all)"
    parser.add_argument("--n", metavar="N", type=whole(1, _MOST_RECORDS), help=text)
    text = "smallest and largest factor (0.25,4)"
    parser.add_argument(
        "--limits", metavar="LOW,HIGH", type=numbers, default=[0.25, 4.0], help=text
    )
    text = "damping ratio of the spectra (0.05)"
    parser.add_argument("--damping", type=number(0, 1), default=0.05, help=text)
    text = "take pairs of horizontal components with one factor"
    parser.add_argument("--pairs", action="store_true", help=text)
    text = "write the list of records and factors, which --records of a study reads"
    parser.add_argument("--out", metavar="LIST.csv", type=written_file, help=text)
    _add_samples(parser)
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    add_plot(parser, "the scaled spectra and the target")


def _add_join(actions: Subcommands) -> None:
    parser = actions.add(
        "join",
        "Join main shock, pause and aftershock into one record for &motion.",
        "main.AT2 after.AT2 sequence.txt --pause 20 --factors 1,0.8",
        "records_command.join",
    )
    parser.add_argument("main", metavar="MAIN", help="main shock, in a known format")
    parser.add_argument("after", metavar="AFTER", help="aftershock")
    _add_written(parser, "replace an existing file")
    text = "time without acceleration between them in s"
    parser.add_argument("--pause", metavar="S", type=number(above=0), required=True, help=text)
    text = "factors on both (1,1)"
    parser.add_argument("--factors", metavar="F1,F2", type=numbers, default=[1.0, 1.0], help=text)
    _add_samples(parser)


def _add_written(parser: argparse.ArgumentParser, force: str) -> None:
    parser.add_argument("file", metavar="FILE", type=written_file, help="file to write")
    parser.add_argument("--force", action="store_true", help=force)


def _add_samples(parser: argparse.ArgumentParser) -> None:
    text = "unit of files that do not give it: g, m/s2 or cm/s2"
    parser.add_argument("--unit", metavar="WORD", choices=("g", "m/s2", "cm/s2"), help=text)
    text = "interval of the samples of one column in s"
    parser.add_argument("--dt", metavar="S", type=number(above=0), help=text)
