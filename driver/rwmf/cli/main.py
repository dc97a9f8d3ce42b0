"""Entry point of the command ``rwmf``."""

from __future__ import annotations

import os
import signal
import sys
import threading
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from importlib import import_module

from rwmf.cli.parser import make_parser
from rwmf.cli.streams import ReaderGoneError, guarded
from rwmf.errors import OutputError, RwmfError, RwmfWarning

# exit status of unexpected errors
_UNFORESEEN = 3
# 128 and the number of SIGINT, as shells report it
_INTERRUPTED = 130
_SHOW_TRACEBACK = "RWMF_TRACEBACK"
# signals handled like Ctrl-C; by default they would leave unfinished files
_ENDS = (signal.SIGTERM, signal.SIGHUP)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command."""
    with guarded() as lost, _ended_by_signals():
        try:
            status = _run(arguments)
        except RwmfError as error:
            print(f"rwmf: {error}", file=sys.stderr)
            status = error.exit_status
        except KeyboardInterrupt:
            print("rwmf: interrupted", file=sys.stderr)
            status = _INTERRUPTED
        except SystemExit as leave:
            # after --help, --version, or an error of argparse
            status = int(leave.code or 0)
        except ReaderGoneError:
            status = 0
        except Exception as error:
            # the clean-up of a library after an interrupt may also fail
            if _follows_interrupt(error):
                print("rwmf: interrupted", file=sys.stderr)
                status = _INTERRUPTED
            else:
                status = _report(error)
    if not lost:
        return status
    if isinstance(lost[0], BrokenPipeError):
        return 0
    text = f"the standard output cannot be written: {lost[0].strerror}; files are complete"
    print(f"rwmf: {text}", file=sys.stderr)
    return status or OutputError.exit_status


@contextmanager
def _ended_by_signals() -> Iterator[None]:
    """Handle signals like Ctrl-C; a signal ignored at the start, as by nohup, stays ignored."""
    before = {}
    if threading.current_thread() is threading.main_thread():
        usual = [number for number in _ENDS if signal.getsignal(number) is signal.SIG_DFL]
        before = {number: signal.signal(number, _interrupt) for number in usual}
    try:
        yield
    finally:
        for number, action in before.items():
            signal.signal(number, action)


def _interrupt(number: int, _: object) -> None:
    # a second signal must not interrupt the removal of unfinished files
    signal.signal(number, signal.SIG_IGN)
    raise KeyboardInterrupt


def _run(arguments: Sequence[str] | None) -> int:
    """Run a command; its function returns an exit status, the written files, or None."""
    arguments = sys.argv[1:] if arguments is None else arguments
    options = make_parser(arguments).parse_args(arguments)
    # import only the module of the requested command
    module, function = options.run.split(".")
    with warnings.catch_warnings():
        # the commands print the warnings of their results
        warnings.simplefilter("ignore", RwmfWarning)
        found = getattr(import_module(f"rwmf.cli.{module}"), function)(options)
        if not isinstance(found, int):
            # imported here: its libraries are loaded with the command
            from rwmf.cli.output import print_written

            print_written(found or (), is_json=getattr(options, "json", False))
    sys.stdout.flush()
    return found if isinstance(found, int) else 0


def _follows_interrupt(error: BaseException) -> bool:
    before = error.__context__
    return before is not None and (
        isinstance(before, KeyboardInterrupt) or _follows_interrupt(before)
    )


def _report(error: Exception) -> int:
    """Print an unexpected error in one line, and return the exit status."""
    if os.environ.get(_SHOW_TRACEBACK):
        raise error
    if isinstance(error, OSError) and error.filename is not None:
        print(f"rwmf: {error.filename}: {error.strerror}", file=sys.stderr)
        return OutputError.exit_status
    text = " ".join(str(error).split())
    print(
        f"rwmf: unexpected {type(error).__name__}{text and ': '}{text} "
        f"({_SHOW_TRACEBACK}=1 in the environment shows where)",
        file=sys.stderr,
    )
    return _UNFORESEEN
