"""Progress bars of terminals and notebooks."""

from __future__ import annotations

import html
import shutil
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager

Progress = Callable[[int, int], None]
# the argument `progress` of public functions
Reports = Progress | bool | None

# interval between two pictures of the bar of a notebook [s]
_NOTEBOOK_SECONDS = 0.1


def in_notebook() -> bool:
    """Check whether a Jupyter kernel runs this process and displays its results."""
    if "IPython" not in sys.modules:
        return False
    from IPython.core.getipython import get_ipython

    return getattr(get_ipython(), "kernel", None) is not None


class _Bar:
    """Bar in the output of a notebook's cell: HTML, or a text where a viewer shows none."""

    def __init__(self, total: int, unit: str) -> None:
        self.total = total
        self.unit = unit
        self.done = 0
        self.started = time.monotonic()
        self.ended = False

    def __repr__(self) -> str:
        seconds = time.monotonic() - self.started
        verb = "after" if self.ended else "in"
        return f"{self.done} of {self.total} {self.unit}s {verb} {seconds:.1f} s"

    def _repr_html_(self) -> str:
        words = html.escape(repr(self))
        if self.ended:
            return words
        return f'<progress max="{self.total}" value="{self.done}"></progress> {words}'


@contextmanager
def _notebook_bar(total: int, unit: str) -> Iterator[Progress]:
    from IPython.display import display

    bar = _Bar(total, unit)
    shown = display(bar, display_id=True)
    drawn = bar.started

    def report(done: int, total: int) -> None:
        nonlocal drawn
        bar.done, bar.total = done, total
        now = time.monotonic()
        if now - drawn > _NOTEBOOK_SECONDS:
            drawn = now
            shown.update(bar)

    try:
        yield report
    finally:
        bar.ended = True
        shown.update(bar)


@contextmanager
def progress_bar(total: int, unit: str = "run") -> Iterator[Progress | None]:
    """Show progress in a notebook or on a terminal, and nothing on a redirected output."""
    if in_notebook():
        with _notebook_bar(total, unit) as show:
            yield show
        return
    if not sys.stderr.isatty():
        yield None
        return
    try:
        from tqdm import tqdm
    except ModuleNotFoundError:
        yield _plain_report(unit)
        print(file=sys.stderr)
        return
    # a terminal without a known size gets the usual one
    size = shutil.get_terminal_size()
    with tqdm(
        total=total,
        unit=unit,
        leave=False,
        file=sys.stderr,
        ncols=size.columns,
        nrows=size.lines,
    ) as bar:

        def report(done: int, total: int) -> None:
            # searches find further runs on their way
            bar.total = total
            bar.update(done - bar.n)

        yield report


def _plain_report(unit: str) -> Progress:
    """Overwrite counts in one line, without the package for bars."""

    def report(done: int, total: int) -> None:
        print(f"\r{done} of {total} {unit}s", end="", file=sys.stderr, flush=True)

    return report


@contextmanager
def progress(unit: str = "run") -> Iterator[Progress]:
    """Open the bar with the first report, which gives the number of runs."""
    with ExitStack() as stack:
        bars: list[Progress | None] = []

        def report(done: int, total: int) -> None:
            if not bars:
                bars.append(stack.enter_context(progress_bar(total, unit)))
            if bars[0] is not None:
                bars[0](done, total)

        yield report


@contextmanager
def reporting(wanted: Reports, unit: str = "run") -> Iterator[Progress | None]:
    """Apply the argument `progress` of a public function."""
    if wanted is True:
        with progress(unit) as report:
            yield report
    else:
        yield wanted or None
