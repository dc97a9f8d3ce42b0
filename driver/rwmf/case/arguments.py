"""Conversion and checks of the arguments of public functions, by name."""

from __future__ import annotations

import functools
import inspect
import logging
import os
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, ParamSpec, TypeVar

import numpy as np

from rwmf.case import Case, CaseLike, Motion
from rwmf.case.motion import UNITS
from rwmf.errors import LOG, InputError, call_depth, warn
from rwmf.kernel.files import path_of
from rwmf.kernel.numbers import show, to_array, to_items, to_number, to_whole
from rwmf.kernel.results import check_threads

if TYPE_CHECKING:
    import xarray as xr


_P = ParamSpec("_P")
_R = TypeVar("_R")
_F = TypeVar("_F")
Check = Callable[[str, Any], Any]


def case_of(case: CaseLike) -> Case:
    """Return a case; read it from its file when a path is given."""
    if isinstance(case, Case):
        return case
    return Case.from_namelist(path_of("case", case, "a Case or the path of a namelist"))


def texts_of(name: str, value: object) -> list[str]:
    """Return a list of texts; one text is a list of one."""
    items = [value] if isinstance(value, str) else to_items(value)
    if items is None or not all(isinstance(item, str) for item in items):
        raise InputError(f"{name} = {show(value)}: must be a text or a list of texts")
    return [str(item) for item in items]


def array_of(value: object, dim: str) -> xr.DataArray:
    """Return a labelled array after checking that it has a dimension."""
    import xarray as xr

    if not isinstance(value, xr.DataArray):
        raise InputError(f"values = {show(value)}: must be a variable of the dataset of a sweep")
    if not isinstance(dim, str) or dim not in value.dims:
        known = ", ".join(map(str, value.dims))
        raise InputError(f"values: has no dimension {show(dim)}, only {known}")
    return value


def _must_be(wanted: str, is_good: Callable[[Any], bool]) -> Callable[[str, _F], _F]:
    """Make a check that returns the value itself."""

    def check(name: str, value: _F) -> _F:
        if not is_good(value):
            raise InputError(f"{name} = {show(value)}: must be {wanted}")
        return value

    return check


function_of = _must_be("callable", callable)
_text = _must_be("a text", lambda value: isinstance(value, str))
_mapping = _must_be("names with values", lambda value: isinstance(value, Mapping))
_ax = _must_be("axes of matplotlib", lambda value: hasattr(value, "get_xaxis_transform"))
_reports = _must_be(
    "True, or a function (done, total)", lambda value: callable(value) or isinstance(value, bool)
)
_executor = _must_be(
    "an executor, with a method submit", lambda value: callable(getattr(value, "submit", None))
)


def _truth(name: str, value: object) -> bool:
    if not isinstance(value, bool | np.bool_):
        raise InputError(f"{name} = {show(value)}: must be True or False")
    return bool(value)


def _sequence(name: str, value: object) -> list[Any]:
    # a single record, file or part becomes a list of one
    is_one = isinstance(value, str | os.PathLike | Motion) or hasattr(value, "crc32")
    items = [value] if is_one else to_items(value)
    if items is None:
        raise InputError(f"{name} = {show(value)}: must be a list")
    return items


def _part(name: str, value: object) -> tuple[int, int]:
    items = to_items(value)
    if items is None or len(items) != 2:
        raise InputError(f"{name} = {show(value)}: must be two whole numbers (K, N)")
    k, n = (to_whole(name, item, 1) for item in items)
    return k, n


def _axes(name: str, value: object) -> object:
    if value is None:
        # a new figure
        return value
    items = list(value.ravel()) if isinstance(value, np.ndarray) else value
    for ax in items if isinstance(items, Sequence) and items else [items]:
        _ax(name, ax)
    return value


def _damping(name: str, value: object) -> float:
    wanted = "in [0, 1)"
    number = to_number(name, value, below=1.0, wanted=wanted)
    if number < 0:
        raise InputError(f"{name} = {show(value)}: must be {wanted}")
    return number


# each check with the names of its arguments; None is allowed where it is the default
_ROWS: tuple[tuple[Check, str], ...] = (
    (_truth, "across force has_branches is_paired legend open_browser restart"),
    (_text, "component intensity kind quantity"),
    (texts_of, "quantities variables"),
    (_sequence, "left_out parts records words"),
    (_mapping, "grid"),
    (functools.partial(to_number, above=0.0), "dt peak period t_end target tolerance"),
    (
        lambda name, value: to_array(name, value, above=0.0, least=1).tolist(),
        "levels omega_over_p periods T_p",
    ),
    (to_number, "horizon limit t_begin"),
    (_damping, "damping"),
    (_part, "part"),
    (path_of, "file path"),
    (function_of, "function ground"),
    (_ax, "ax"),
    (_axes, "axes"),
    (_executor, "executor"),
    (_reports, "progress"),
    (_must_be("'g', 'm/s2' or 'cm/s2'", lambda x: isinstance(x, str) and x in UNITS), "unit"),
    (lambda name, value: to_array(name, value, least=1).tolist(), "amplitude"),
    (lambda name, value: to_whole(name, value, 0, 10**15), "chunk"),
    (lambda name, x: path_of(name, x) if not isinstance(x, str) or x else "", "folder"),
    (lambda name, value: to_whole(name, value, 1), "n"),
    (lambda name, value: to_whole(name, value, 0, 65535), "port"),
    (lambda name, value: check_threads(value, name), "threads"),
)
_CHECKS = {name: check for check, names in _ROWS for name in names.split()}


def _is_of_caller(error: BaseException) -> bool:
    """Return whether a callback of the user raised an error, not the package or a library."""
    frame = error.__traceback__
    while frame is not None and frame.tb_next is not None:
        frame = frame.tb_next
    path = Path(frame.tb_frame.f_code.co_filename if frame is not None else __file__)
    return "site-packages" not in path.parts and Path(__file__).parents[1] not in path.parents


@contextmanager
def _logged(name: str) -> Iterator[None]:
    """Log start and end of a public function: the user's call at level INFO, others at DEBUG."""
    # methods of hosts run in the time loop of their caller
    is_analysis = call_depth.get() == 1 and "." not in name
    began = time.perf_counter()
    LOG.debug("%s: started", name)
    end = "failed"
    try:
        yield
        end = "finished"
    finally:
        level = logging.INFO if is_analysis else logging.DEBUG
        LOG.log(level, "%s: %s after %.3f s", name, end, time.perf_counter() - began)


def checked(function: Callable[_P, _R]) -> Callable[_P, _R]:
    """Convert or refuse the arguments of a public function before it runs.

    The warnings of its result are emitted, unless another public function has called it. The logger
    "rwmf" records its start and end.
    """
    signature = inspect.signature(function)
    defaults = {name: item.default for name, item in signature.parameters.items()}
    further = {name for name, item in signature.parameters.items() if item.kind is item.VAR_KEYWORD}

    @functools.wraps(function)
    def call(*args: _P.args, **kwargs: _P.kwargs) -> _R:
        if "quantity" in kwargs and "quantity" not in signature.parameters:
            raise TypeError(f"{function.__name__}: quantity is now quantities")
        bound = signature.bind(*args, **kwargs)
        for name, value in bound.arguments.items():
            if name in _CHECKS and value is not defaults[name]:
                bound.arguments[name] = _CHECKS[name](name, value)
            elif name in further:
                bound.arguments[name] = {
                    word: item if item is None or word not in _CHECKS else _CHECKS[word](word, item)
                    for word, item in value.items()
                }
        before = call_depth.set(call_depth.get() + 1)
        try:
            with _logged(function.__qualname__):
                result = function(*bound.args, **bound.kwargs)
        except ArithmeticError as error:
            if _is_of_caller(error):
                raise
            text = f"{function.__name__}: numbers exceed the range of the computation ({error})"
            raise InputError(text) from error
        finally:
            call_depth.reset(before)
        lines = getattr(result, "attrs", {}).get("warnings")
        if lines and call_depth.get() == 0:
            warn(str(lines).splitlines())
        return result

    return call
