"""Progress on a terminal."""

from __future__ import annotations

import shutil
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager

__all__ = ["progress", "progress_bar"]


def _find_bar() -> type | None:
    """Return the class of the progress bar; None when the optional package is not installed.

    The package is tqdm: pure Python without dependencies, maintained since 2013, suitable for
    narrow and simple terminals. The import is here because only a terminal needs it.
    """
    try:
        from tqdm import tqdm
    except ModuleNotFoundError:
        return None
    bar_type: type = tqdm
    return bar_type


@contextmanager
def progress_bar(total: int, unit: str = "run") -> Iterator[Callable[[int, int], None] | None]:
    """Show progress on a terminal, and nothing on a redirected output.

    Parameters
    ----------
    total : int
        Number of units of work.
    unit : str
        Name of a unit.

    Yields
    ------
    callable or None
        Called with the numbers of finished and of all units; None where nothing is shown.
    """
    if not sys.stderr.isatty():
        yield None
        return
    bar_type = _find_bar()
    if bar_type is None:
        yield _plain_report(unit)
        print(file=sys.stderr)
        return
    # a terminal without a known size gets the usual one
    size = shutil.get_terminal_size()
    with bar_type(
        total=total,
        unit=unit,
        leave=False,
        file=sys.stderr,
        ncols=size.columns,
        nrows=size.lines,
    ) as bar:

        def report(done: int, _: int) -> None:
            bar.update(done - bar.n)

        yield report


def _plain_report(unit: str) -> Callable[[int, int], None]:
    """Overwrite counts in one line, without the package for bars."""

    def report(done: int, total: int) -> None:
        print(f"\r{done} of {total} {unit}s", end="", file=sys.stderr, flush=True)

    return report


@contextmanager
def progress(unit: str = "run") -> Iterator[Callable[[int, int], None]]:
    """Open the bar with the first report, which gives the number of runs.

    Parameters
    ----------
    unit : str
        Name of a unit.

    Yields
    ------
    callable
        Called with the numbers of finished and of all runs.
    """
    with ExitStack() as stack:
        bars: list[Callable[[int, int], None] | None] = []

        def report(done: int, total: int) -> None:
            if not bars:
                bars.append(stack.enter_context(progress_bar(total, unit)))
            if bars[0] is not None:
                bars[0](done, total)

        yield report
