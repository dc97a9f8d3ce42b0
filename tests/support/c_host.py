"""A host in C, spoken to from Python: `include/rwmf.h` through ctypes."""

import ctypes
import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from ctypes import byref, c_char_p, c_double, c_int32, c_int64, c_size_t, c_void_p
from functools import cache
from pathlib import Path

import rwmf
from checkout import ROOT

IMPACT, PEAK = 1, 2  # RWMF_EVENT_
_MESSAGE_BYTES = 4096
_ERRORS = {1: rwmf.NumericalError, 2: rwmf.InputError}
_GROUND = ctypes.CFUNCTYPE(c_double, c_double, c_void_p)


def _doubles(names: str) -> list[tuple[str, type]]:
    return [(name, c_double) for name in names.split()]


def _counts(names: str) -> list[tuple[str, type]]:
    return [(name, c_int64) for name in names.split()]


class Result(ctypes.Structure):
    """`rwmf_result`."""

    _fields_ = (
        *_doubles("u_s_max theta_max theta_dot_max cable_increment_max t_end"),
        *_counts("impacts lift_offs steps"),
        ("overturned", c_int32),
    )


class State(ctypes.Structure):
    """`rwmf_state`."""

    _fields_ = (
        *_doubles("t theta theta_dot theta_ddot u_s u_s_dot u_s_ddot u_s_max theta_max"),
        *_counts("impacts lift_offs steps"),
        ("at_rest", c_int32),
        ("overturned", c_int32),
    )


class Forces(ctypes.Structure):
    """`rwmf_forces`."""

    _fields_ = tuple(_doubles("link frame_shear cable"))


class Response(ctypes.Structure):
    """`rwmf_response`."""

    _fields_ = tuple(
        _doubles("force stiffness damping mass theta theta_dot theta_ddot cable"),
    )


class MemberInfo(ctypes.Structure):
    """`rwmf_member_info`."""

    _fields_ = (
        *((name, c_int32) for name in ["dofs", "modes", "floors", "links", "side", "broken"]),
        ("u", c_double),
    )


class Event(ctypes.Structure):
    """`rwmf_event`."""

    _fields_ = (*_doubles("t theta theta_dot"), ("kind", c_int32))


@cache
def _library() -> ctypes.CDLL:
    """Load the shared library of the build; RWMF_LIBRARY names another one."""
    built = ROOT / "build" / "src" / "package" / "librwmf.so"
    path = Path(os.environ.get("RWMF_LIBRARY", built))
    assert path.is_file(), f"{path} is missing: run tools/test, or set RWMF_LIBRARY"
    library = ctypes.CDLL(str(path))
    library.rwmf_destroy.restype = library.rwmf_destroy_element.restype = None
    library.rwmf_destroy_case.restype = library.rwmf_destroy_member.restype = None
    return library


def _call(name: str, *arguments: object) -> None:
    """Call a function of the interface, and raise its error as that of Python."""
    message = ctypes.create_string_buffer(_MESSAGE_BYTES)
    function = getattr(_library(), name)
    status = function(*arguments, message, c_size_t(_MESSAGE_BYTES))
    if status != 0:
        raise _ERRORS[status](message.value.decode())


def run(text: str) -> Result:
    """Run a case in namelist text."""
    result = Result()
    _call("rwmf_run", c_char_p(text.encode()), byref(result))
    return result


class Rows(ctypes.Structure):
    """`rwmf_rows`."""

    _fields_ = (
        ("n_columns", c_size_t), ("columns", c_void_p), ("n", c_size_t), ("values", c_void_p),
        ("n_quantities", c_size_t), ("quantities", c_void_p),
    )  # fmt: skip


def run_rows(
    path: Path, column: str, numbers: Sequence[float], quantities: Sequence[str]
) -> list[list[float]]:
    """Run a case of a file for several numbers of a key: the quantities of each."""
    scene = c_void_p()
    _call("rwmf_read_case_file", c_char_p(str(path).encode()), byref(scene))
    columns = (c_char_p * 1)(column.encode())
    keys = (c_char_p * len(quantities))(*(key.encode() for key in quantities))
    values = (c_double * len(numbers))(*numbers)
    results = (c_double * (len(quantities) * len(numbers)))()
    status = (c_int32 * len(numbers))()
    addresses = [ctypes.cast(array, c_void_p) for array in (columns, values, keys)]
    rows = Rows(1, addresses[0], len(numbers), addresses[1], len(quantities), addresses[2])
    try:
        _call("rwmf_run_rows", scene, byref(rows), 1, results, status)
    finally:
        _library().rwmf_destroy_case(byref(scene))
    n = len(quantities)
    return [list(results[i * n : (i + 1) * n]) for i in range(len(numbers))]


class Wall:
    """A wall that steps; give it back with `stepping`."""

    def __init__(self, text: str, peak: float) -> None:
        self.handle = c_void_p()
        self._snapshot = c_void_p()
        _call(
            "rwmf_create", c_char_p(text.encode()), c_double(0), c_double(peak), byref(self.handle)
        )

    def advance(self, t: float) -> None:
        """Advance under the motion of the case."""
        _call("rwmf_advance", self.handle, c_double(t))

    def advance_samples(self, t: Sequence[float], a: Sequence[float]) -> None:
        """Advance under straight lines through samples."""
        numbers = c_double * len(t)
        _call("rwmf_advance_samples", self.handle, c_size_t(len(t)), numbers(*t), numbers(*a))

    def advance_ground(self, t: float, ground: Callable[[float], float]) -> None:
        """Advance under an acceleration that the host computes."""
        function = _GROUND(lambda t, _: ground(t))
        _call("rwmf_advance_ground", self.handle, c_double(t), function, None)

    def save(self) -> None:
        """Remember the present state."""
        _call("rwmf_save", self.handle, byref(self._snapshot))

    def restore(self) -> None:
        """Return to it."""
        _call("rwmf_restore", self.handle, self._snapshot)

    def state(self) -> State:
        """Present state."""
        state = State()
        _call("rwmf_query_state", self.handle, byref(state))
        return state

    def events(self) -> list[Event]:
        """Events of the last advance."""
        events, count = (Event * 1000)(), c_size_t()
        _call("rwmf_query_events", self.handle, c_size_t(1000), events, byref(count))
        return list(events[: count.value])

    def forces(self) -> Forces:
        """Present forces."""
        forces = Forces()
        _call("rwmf_query_forces", self.handle, byref(forces))
        return forces

    def destroy(self) -> None:
        """Give everything back."""
        _library().rwmf_destroy_snapshot(byref(self._snapshot))
        _library().rwmf_destroy(byref(self.handle))


@contextmanager
def stepping(text: str, peak: float = 0.0) -> Iterator[Wall]:
    """Make a wall of a case; `peak` [m/s2] as in rwmf.h."""
    wall = Wall(text, peak)
    try:
        yield wall
    finally:
        wall.destroy()


def respond(text: str, side: int, motion: Sequence[float]) -> Response:
    """Make an element and return its force at u, u', u'' of the link and u_g''."""
    element, response = c_void_p(), Response()
    _call("rwmf_create_element", c_char_p(text.encode()), byref(element))
    try:
        numbers = [c_double(value) for value in motion]
        _call("rwmf_respond", element, side, *numbers, byref(response))
    finally:
        _library().rwmf_destroy_element(byref(element))
    return response


class Member:
    """A wall as a member; give it back with `member`."""

    def __init__(self, text: str) -> None:
        self.handle = c_void_p()
        _call("rwmf_create_member", c_char_p(text.encode()), byref(self.handle))

    def info(self) -> MemberInfo:
        """Sizes and committed state."""
        info = MemberInfo()
        _call("rwmf_query_member", self.handle, byref(info))
        return info

    def respond(
        self, motion: Sequence[float], ground: Sequence[float]
    ) -> tuple[list[float], list[list[list[float]]]]:
        """Return forces and tangents (stiffness, damping, mass)."""
        n = len(motion) // 3
        force, tangents = (c_double * n)(), (c_double * (3 * n * n))()
        _call(
            "rwmf_respond_member",
            self.handle,
            (c_double * len(motion))(*motion),
            (c_double * 2)(*ground),
            force,
            tangents,
            None,
        )
        rows = [list(tangents[i * n : (i + 1) * n]) for i in range(3 * n)]
        return list(force), [rows[:n], rows[n : 2 * n], rows[2 * n :]]

    def links(self, motion: Sequence[float]) -> tuple[list[list[float]], list[list[float]]]:
        """Return motion of the links (displacements, velocities, accelerations), derivatives."""
        info = self.info()
        links, slopes = (c_double * (3 * info.links))(), (c_double * (info.links * info.dofs))()
        _call("rwmf_query_links", self.handle, (c_double * len(motion))(*motion), links, slopes)
        m, n = info.links, info.dofs
        return (
            [list(links[i * m : (i + 1) * m]) for i in range(3)],
            [list(slopes[i * n : (i + 1) * n]) for i in range(m)],
        )

    def commit(self) -> None:
        """Keep the state of the last response."""
        _call("rwmf_commit_member", self.handle)

    def place(self, side: int) -> None:
        """Set the side of a wall on its base."""
        _call("rwmf_place_member", self.handle, c_int32(side))

    def destroy(self) -> None:
        """Give it back."""
        _library().rwmf_destroy_member(byref(self.handle))


@contextmanager
def member(text: str) -> Iterator[Member]:
    """Make a member of a case."""
    wall = Member(text)
    try:
        yield wall
    finally:
        wall.destroy()
