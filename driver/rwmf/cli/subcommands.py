"""How a word of the command line is added, and the options that several words share."""

from __future__ import annotations

import argparse

from rwmf.cli.words import thread_count, written_file

__all__ = ["Subcommands", "add_case", "add_plot", "add_threads"]


class Subcommands:
    """The words that may follow a command.

    Parameters
    ----------
    parser : argparse.ArgumentParser
        Parser of the command.
    metavar : str
        What its help calls them.
    """

    def __init__(self, parser: argparse.ArgumentParser, metavar: str) -> None:
        self._prog = parser.prog
        self._actions = parser.add_subparsers(metavar=metavar, required=True)

    def add(
        self, name: str, text: str, example: str, run: str = "", **defaults: object
    ) -> argparse.ArgumentParser:
        """Add a word.

        Parameters
        ----------
        name : str
            The word.
        text : str
            What it does, for the help.
        example : str
            Words after it, for the help.
        run : str
            Module of this package and its function that does it, for example ``'run.run'``; the
            module is imported when the word is used. Empty for a word that others follow.
        **defaults
            What is known with this word, without an option.

        Returns
        -------
        argparse.ArgumentParser
            Its parser, which has no options yet.
        """
        parser = self._actions.add_parser(
            name,
            help=text,
            description=text,
            epilog=f"example: {self._prog} {name} {example}".rstrip(),
        )
        parser.set_defaults(**({"run": run} if run else {}), **defaults)
        return parser


def add_case(parser: argparse.ArgumentParser) -> None:
    """Add the case.

    Parameters
    ----------
    parser : argparse.ArgumentParser
        Parser of the word.
    """
    parser.add_argument("case", metavar="CASE.nml", help="namelist file")


def add_plot(parser: argparse.ArgumentParser, what: str) -> None:
    """Add the option that names a figure.

    Parameters
    ----------
    parser : argparse.ArgumentParser
        Parser of the word.
    what : str
        What is drawn.
    """
    parser.add_argument(
        "--plot", metavar="FILE", type=written_file, help=f"draw {what} (png, svg, pdf)"
    )


def add_threads(parser: argparse.ArgumentParser) -> None:
    """Add the number of threads.

    Parameters
    ----------
    parser : argparse.ArgumentParser
        Parser of the word.
    """
    parser.add_argument(
        "--threads", metavar="N", type=thread_count, default=0, help="threads (0: all)"
    )
