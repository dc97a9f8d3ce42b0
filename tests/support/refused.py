"""Tables of wrong input: each row is refused with its message."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest
import rwmf


def refusals(call: Callable[..., object], *rows: Any) -> Callable[..., None]:  # noqa: ANN401
    """Make a test that has a case for each row.

    Parameters
    ----------
    call : callable
        Is called with the values of a row.
    *rows : tuple
        Values and, last, a pattern that the message matches.

    Returns
    -------
    callable
        The test.
    """

    @pytest.mark.parametrize("row", rows)
    def test(row: tuple[Any, ...]) -> None:
        *values, message = row
        with pytest.raises(rwmf.InputError, match=message):
            call(*values)

    return test
