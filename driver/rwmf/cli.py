"""The command ``rwmf``: words of the command line to calls of the package."""

from __future__ import annotations

import argparse
import functools
import os
import sys
from collections.abc import Callable, Sequence

import rwmf
from rwmf import animate_command, commands, cost_command
from rwmf._library import instruction_set
from rwmf.errors import Interrupted, OutputError, RwmfError
from rwmf.reproduce import command as reproduce_command
from rwmf.streams import ReaderGoneError, guarded
from rwmf.studies.commands import add_parsers as add_studies
from rwmf.sweep.commands import add_parsers as add_sweeps
from rwmf.words import thread_count, written_file

__all__ = ["main", "make_parser"]

# exit status of what the program did not foresee
_UNFORESEEN = 3
_SHOW_TRACEBACK = "RWMF_TRACEBACK"


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command.

    Parameters
    ----------
    arguments : sequence of str, optional
        Words after the command's name; otherwise those of the process.

    Returns
    -------
    int
        Exit status: 0, 1 numerical failure, 2 input or output, 3 an error that the program did not
        foresee, 130 interrupted.
    """
    with guarded() as lost:
        try:
            status = _run(arguments)
        except RwmfError as error:
            print(f"rwmf: {error}", file=sys.stderr)
            status = error.exit_status
        except KeyboardInterrupt:
            print("rwmf: interrupted", file=sys.stderr)
            status = Interrupted.exit_status
        except SystemExit as leave:
            # after --help, --version, and a word that argparse refuses
            status = int(leave.code or 0)
        except ReaderGoneError:
            status = 0
        except Exception as error:
            status = _report(error)
    if not lost:
        return status
    if isinstance(lost[0], BrokenPipeError):
        return 0
    text = f"the standard output cannot be written: {lost[0].strerror}; files are complete"
    print(f"rwmf: {text}", file=sys.stderr)
    return status or OutputError.exit_status


def _run(arguments: Sequence[str] | None) -> int:
    options = make_parser().parse_args(arguments)
    status = options.run(options)
    sys.stdout.flush()
    return status


def _report(error: Exception) -> int:
    """Show in one line what no command has foreseen, and return the exit status."""
    if os.environ.get(_SHOW_TRACEBACK):
        raise error
    if isinstance(error, OSError) and error.filename is not None:
        print(f"rwmf: {error.filename}: {error.strerror}", file=sys.stderr)
        return OutputError.exit_status
    text = " ".join(str(error).split())
    print(
        f"rwmf: unforeseen {type(error).__name__}{text and ': '}{text} "
        f"({_SHOW_TRACEBACK}=1 in the environment shows where)",
        file=sys.stderr,
    )
    return _UNFORESEEN


def make_parser() -> argparse.ArgumentParser:
    """Build the parser of the command line, one function a subcommand.

    Returns
    -------
    argparse.ArgumentParser
        The parser.
    """
    parser = argparse.ArgumentParser(
        prog="rwmf",
        description="Dynamic response of post-tensioned rocking wall-moment frames.",
        epilog="example: rwmf spectrum inputs/fig12_one_cosine.nml --plot cosine.png",
    )
    version = f"rwmf {rwmf.__version__} ({instruction_set()})"
    parser.add_argument("--version", action="version", version=version)
    subparsers = parser.add_subparsers(metavar="COMMAND", required=True)
    for add in (_add_run, _add_spectrum, _add_cost, _add_check, _add_records):
        add(subparsers)
    add_sweeps(functools.partial(_add, subparsers))
    add_studies(functools.partial(_add, subparsers))
    for add_parser in (reproduce_command.add_parser, animate_command.add_parser):
        add_parser(functools.partial(_add, subparsers))
    return parser


def _add(
    subparsers: argparse._SubParsersAction[argparse.ArgumentParser],
    name: str,
    run: Callable[[argparse.Namespace], int],
    text: str,
    example: str,
) -> argparse.ArgumentParser:
    """Add a subcommand with its help and an example."""
    parser = subparsers.add_parser(
        name, help=text, description=text, epilog=f"example: rwmf {name} {example}"
    )
    parser.set_defaults(run=run)
    return parser


def _add_case(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("case", metavar="CASE.nml", help="namelist file")


def _add_run(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    parser = _add(
        subparsers,
        "run",
        commands.run,
        "Simulate one case and print its maxima, counts and cost (&spectrum is ignored).",
        "inputs/fig06_mild_frame_one_cosine.nml --plot history.png",
    )
    _add_case(parser)
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    parser.add_argument(
        "--plot", metavar="FILE", type=written_file, help="draw the history (png, svg, pdf)"
    )
    parser.add_argument(
        "--loops",
        metavar="FILE",
        type=written_file,
        help="draw force over displacement of frame, cable and fuses",
    )
    parser.add_argument("--out", metavar="DIR", help="write the CSV files of rwmf-batch there")


def _add_spectrum(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    parser = _add(
        subparsers,
        "spectrum",
        commands.spectrum,
        "Compute the spectrum that the case's &spectrum asks for: largest displacements of the "
        "frame, or other quantities.",
        "inputs/fig12_one_cosine.nml --csv cosine.csv --plot cosine.png",
    )
    _add_case(parser)
    parser.add_argument(
        "--csv", metavar="FILE", type=written_file, help="write the spectrum as rwmf-batch does"
    )
    parser.add_argument(
        "--plot", metavar="FILE", type=written_file, help="draw the spectrum (png, svg, pdf)"
    )
    parser.add_argument(
        "--threads", metavar="N", type=thread_count, default=0, help="threads (0: all)"
    )
    parser.add_argument(
        "--quantity",
        metavar="KEY",
        nargs="+",
        help="what each ordinate reports in place of &spectrum quantities (reference/outputs.md)",
    )
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def _add_cost(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    parser = _add(
        subparsers,
        "cost",
        cost_command.run,
        "Show what accuracy costs in time: every method and tolerance, and what is usual today, "
        "against a reference in quadruple precision (less than 30 s).",
        "inputs/accuracy_elcentro_1s.nml --plot cost.png",
    )
    cost_command.add_arguments(parser)


def _add_check(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    parser = _add(
        subparsers,
        "check",
        commands.check,
        "Read and validate a case; print effects, states, events, outputs, what is not simulated, "
        "and every value.",
        "inputs/fig12_one_cosine.nml",
    )
    _add_case(parser)


def _add_records(subparsers: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    text = "Recorded ground motions that come with a Python package."
    parser = subparsers.add_parser(
        "records",
        help=text,
        description=text,
        epilog="example: rwmf records export elcentro inputs/records/elcentro.csv",
    )
    actions = parser.add_subparsers(metavar="ACTION", required=True)
    listing = actions.add_parser(
        "list",
        help="what there is",
        description="List the records with variant, points, dt, peak and checksum.",
        epilog="example: rwmf records list",
    )
    listing.set_defaults(run=commands.list_records)
    export = actions.add_parser(
        "export",
        help="write a record into a file",
        description="Write a record into a file that &motion can name; samples stay unchanged.",
        epilog="example: rwmf records export elcentro inputs/records/elcentro.csv",
    )
    export.add_argument("name", metavar="NAME", help="name from 'rwmf records list'")
    export.add_argument("file", metavar="FILE", type=written_file, help="file to write")
    export.set_defaults(run=commands.export_record)
