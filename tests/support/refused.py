"""Tables of wrong input: each row is refused with its message."""

import re
from collections.abc import Callable
from pathlib import Path
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
        Values and, last, a part of the message or a pattern that it matches.

    Returns
    -------
    callable
        The test.
    """

    @pytest.mark.parametrize("row", rows)
    def test(row: tuple[Any, ...]) -> None:
        *values, message = row
        with pytest.raises(rwmf.InputError) as caught:
            call(*values)
        told = str(caught.value)
        assert message in told or re.search(message, told), told

    return test


def refused_files(
    name: str, call: Callable[[Path], object], *rows: tuple[str, str]
) -> Callable[..., None]:
    """Make a test that has a case for each file.

    Parameters
    ----------
    name : str
        Name of the file.
    call : callable
        Is called with its path.
    *rows : tuple of str
        Text of the file, and a pattern that the message matches; the message names the file.

    Returns
    -------
    callable
        The test.
    """

    @pytest.mark.parametrize(("text", "message"), rows)
    def test(text: str, message: str, tmp_path: Path) -> None:
        path = tmp_path / name
        path.write_text(text, encoding="utf-8")
        with pytest.raises(rwmf.InputError, match=message) as caught:
            call(path)
        assert str(path) in str(caught.value)

    return test
