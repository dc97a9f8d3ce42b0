"""Rows of the digest, and the computation of a list of them."""

from __future__ import annotations

import hashlib
import multiprocessing
import os
import tempfile
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path

from bitwise.tree import Tree

_WORKERS = 2
_DIGITS = 16


@dataclass(frozen=True)
class Row:
    """One row of the digest.

    Attributes
    ----------
    key : str
        Its name: way in, kind of question, scene, method, parted by slashes.
    answer : callable
        Returns the text to hash. It is called in a new empty folder in another process, so it must
        be picklable: a `functools.partial` of a public function.
    is_quick : bool
        Whether it belongs to the representative part of ``--quick``.
    """

    key: str
    answer: Callable[[], str]
    is_quick: bool = True


def digest_of(text: str) -> str:
    """Hash a text."""
    return hashlib.sha256(text.encode("utf-8", "surrogateescape")).hexdigest()[:_DIGITS]


def compute(rows: Iterable[Row], tree: Tree) -> Iterator[tuple[str, str]]:
    """Compute rows in two processes, in the order in which they become ready."""
    # spawn, never fork: a forked child hangs once OpenMP has run
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(_WORKERS, mp_context=context) as pool:
        waiting = {pool.submit(_answer, row.answer): row.key for row in rows}
        for done in as_completed(waiting):
            yield waiting[done], done.result()


def _answer(answer: Callable[[], str]) -> str:
    """Return the text of a row, computed in a separate folder."""
    before = Path.cwd()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name).resolve()
        os.chdir(folder)
        try:
            text = answer()
        except Exception as error:
            text = f"unexpected {type(error).__name__}: {error}\n".replace(str(folder), "")
        finally:
            os.chdir(before)
    return text
