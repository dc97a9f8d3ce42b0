"""Progress on a terminal."""

from __future__ import annotations

import shutil
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager

__all__ = ["progress", "progress_bar"]


def _find_bar() -> type | None:
    """Class of the progress bar; None when the optional package is not installed.

    It is tqdm: pure Python without dependencies, maintained since 2013, at home on narrow and
    dumb terminals. Imported here because only a terminal needs it.
    """
    try:
        from tqdm import tqdm
    except ModuleNotFoundError:
        return None
    bar_type: type = tqdm
    return bar_type


@contextmanager
def progress_bar(total: int, unit: str = "run") -> Iterator[Callable[[int, int], None] | None]:
    """Show progress on a terminal; nothing where the output is kept.

    Parameters
    ----------
    total : int
        Number of what is to be done.
    unit : str
        Name of one of them.

    Yields
    ------
    callable or None
        Takes the number of what is done and of all; None where nothing is shown.
    """
    if not sys.stderr.isatty():
        yield None
        return
    bar_type = _find_bar()
    if bar_type is None:
        yield _plain_report(unit)
        print(file=sys.stderr)
        return
    # a terminal that does not tell its size gets a usual one
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
    """Write counts over each other, where no package draws a bar."""

    def report(done: int, total: int) -> None:
        print(f"\r{done} of {total} {unit}s", end="", file=sys.stderr, flush=True)

    return report


@contextmanager
def progress(unit: str = "run") -> Iterator[Callable[[int, int], None]]:
    """Open the bar with the first report, which knows how many runs there are.

    Parameters
    ----------
    unit : str
        Name of one of them.

    Yields
    ------
    callable
        Takes the number of finished runs and of all.
    """
    with ExitStack() as stack:
        bars: list[Callable[[int, int], None] | None] = []

        def report(done: int, total: int) -> None:
            if not bars:
                bars.append(stack.enter_context(progress_bar(total, unit)))
            if bars[0] is not None:
                bars[0](done, total)

        yield report
