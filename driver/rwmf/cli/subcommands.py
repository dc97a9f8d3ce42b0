"""Definition of subcommands, and options that several of them share."""

from __future__ import annotations

import argparse

from rwmf.cli.words import thread_count, whole, written_file

__all__ = ["Subcommands", "add_case", "add_checks", "add_engine", "add_plot", "add_threads"]

# above the number of processes that one machine needs, within the limits of the system
_MOST_WORKERS = 4096


class Subcommands:
    """Subcommands of a command."""

    def __init__(self, parser: argparse.ArgumentParser, metavar: str) -> None:
        self._prog = parser.prog
        self._actions = parser.add_subparsers(metavar=metavar, required=True)

    def add(
        self, name: str, text: str, example: str, run: str = "", **defaults: object
    ) -> argparse.ArgumentParser:
        """Add a subcommand."""
        parser = self._actions.add_parser(
            name,
            help=text,
            description=text,
            epilog=f"example: {self._prog} {name} {example}".rstrip(),
        )
        parser.set_defaults(**({"run": run} if run else {}), **defaults)
        return parser


def add_case(parser: argparse.ArgumentParser) -> None:
    """Add the argument of the case."""
    parser.add_argument("case", metavar="CASE.nml", help="namelist file")


def add_checks(parser: argparse.ArgumentParser) -> None:
    """Add the option ``--checks``."""
    parser.add_argument(
        "--checks",
        metavar="FILE",
        type=written_file,
        nargs="+",
        help="write the demands over the limits of &limits (csv), or draw them (png, pdf, svg)",
    )


def add_plot(parser: argparse.ArgumentParser, content: str) -> None:
    """Add the option for a figure."""
    parser.add_argument(
        "--plot", metavar="FILE", type=written_file, help=f"draw {content} (png, svg, pdf)"
    )


def add_threads(parser: argparse.ArgumentParser) -> None:
    """Add the option for the number of threads."""
    parser.add_argument(
        "--threads", metavar="N", type=thread_count, default=0, help="threads (0: all)"
    )


def add_engine(parser: argparse.ArgumentParser) -> None:
    """Add the options for processes, MPI ranks or Dask workers instead of threads."""
    parser.add_argument(
        "--engine",
        metavar="NAME",
        default="threads",
        help="threads, processes, mpi (under mpiexec -n N python -m mpi4py.futures -m rwmf), dask "
        "or dask:ADDRESS",
    )
    parser.add_argument(
        "--workers", metavar="N", type=whole(0, _MOST_WORKERS), default=0, help="of the engine"
    )
