"""Pool of the processes that compute answers: started on demand, replaced after a crash."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from multiprocessing import Pipe
from pathlib import Path
from typing import Any

from rwmf.case import Case
from rwmf.errors import InputError
from rwmf.explorer.questions import BadQuestionError

# largest number of concurrent computations; a page needs one, and a second for its cost chart
_MOST = max(4, min(8, os.cpu_count() or 4))
# time after which a computation may be stopped when requests wait and no process is free [s]
_LONG = 10.0
# time limit of a computation [s]; a cost chart takes many runs
_LIMITS = {"history": 30.0, "spectrum": 60.0, "add_record": 60.0, "cost": 600.0}
# interval at which a waiting thread checks the connection to the page [s]
_LOOK = 0.05
# time for a worker to stop before it is killed [s]
_PATIENCE = 2.0

Poll = Callable[[], None]
Report = Callable[[int, int], None]


class BrokenError(Exception):
    """A computation ended without an answer."""


class BusyError(Exception):
    """A computation was stopped in favour of others, or at its time limit."""


class _Worker:
    """A process and the connection to it."""

    def __init__(self, case: Case, folder: Path) -> None:
        self.connection, theirs = Pipe()
        package = str(Path(__file__).parents[2])
        path = os.pathsep.join([package, *(entry for entry in sys.path if entry)])
        with theirs:
            # a separate session receives no signals of the terminal; -P: modules of the current
            # folder must not replace ours
            self.process = subprocess.Popen(
                [sys.executable, "-P", "-m", "rwmf.explorer.worker", str(theirs.fileno())],
                pass_fds=(theirs.fileno(),),
                env=os.environ | {"PYTHONPATH": path},
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                start_new_session=True,
            )
        self.begun = 0.0
        self.gives_way = False
        self.connection.send((case, folder))

    def end(self) -> None:
        """End the process at once."""
        self.process.kill()
        self.process.wait()


class Workers:
    """Processes that answer requests."""

    def __init__(self, case: Case, folder: Path) -> None:
        self._material = (case, folder)
        self._change = threading.Condition()
        self._free: list[_Worker] = []
        self._all: set[_Worker] = set()
        self._waiting: deque[object] = deque()
        self._ended = False
        # load the package while the browser loads the page
        self._free.append(self._start())

    def ask(
        self, name: str, arguments: tuple[Any, ...], poll: Poll, report: Report | None = None
    ) -> bytes:
        """Compute an answer."""
        worker = self._take(poll)
        usable = False
        try:
            worker.connection.send((name, arguments))
            kind, content = self._follow(worker, _LIMITS[name], poll, report)
            usable = True
        except (EOFError, ConnectionResetError, BrokenPipeError):
            poll()
            raise BrokenError(_end_of(worker.process)) from None
        except BaseException:
            usable = _stop(worker)
            raise
        finally:
            self._give(worker, usable)
        if kind == "answer":
            return bytes(content)
        raise {"bad": BadQuestionError, "refused": InputError}.get(kind, BrokenError)(content)

    def end(self) -> None:
        """End all processes."""
        with self._change:
            self._ended = True
            found, self._all = self._all, set()
            for worker in found:
                worker.end()

    def _start(self) -> _Worker:
        worker = _Worker(*self._material)
        self._all.add(worker)
        return worker

    def _take(self, poll: Poll) -> _Worker:
        """Wait for a worker in order of arrival."""
        me = object()
        begun = time.monotonic()
        with self._change:
            self._waiting.append(me)
            try:
                while True:
                    poll()
                    if self._waiting[0] is me:
                        worker = self._idle()
                        if worker is not None:
                            worker.begun, worker.gives_way = time.monotonic(), False
                            return worker
                        if time.monotonic() - begun > 1.0:
                            self._make_room()
                    self._change.wait(_LOOK)
            finally:
                self._waiting.remove(me)
                self._change.notify_all()

    def _idle(self) -> _Worker | None:
        while self._free:
            worker = self._free.pop()
            if worker.process.poll() is None:
                return worker
            self._all.discard(worker)
            worker.end()
        return self._start() if len(self._all) < _MOST and not self._ended else None

    def _make_room(self) -> None:
        """Stop the longest computation once it has used its guaranteed time."""
        if self._all and not any(worker.gives_way for worker in self._all):
            oldest = min(self._all, key=lambda worker: worker.begun)
            oldest.gives_way = time.monotonic() - oldest.begun > _LONG

    def _give(self, worker: _Worker, usable: bool) -> None:
        with self._change:
            if usable:
                self._free.append(worker)
            elif worker in self._all:
                self._all.discard(worker)
                worker.end()
            self._change.notify_all()

    def _follow(
        self, worker: _Worker, limit: float, poll: Poll, report: Report | None
    ) -> tuple[str, Any]:
        """Wait for the end of a computation."""
        while True:
            if time.monotonic() - worker.begun > limit:
                raise BusyError(
                    f"stopped after {limit:g} s, the limit of a page: shorten t_end, raise "
                    "rtol, check damping and stiffness, or run the case by the command rwmf"
                )
            if not worker.connection.poll(_LOOK):
                poll()
                if worker.gives_way:
                    seconds = time.monotonic() - worker.begun
                    raise BusyError(
                        f"stopped after {seconds:.0f} s, because other pages wait: shorten t_end, "
                        "raise rtol, or close pages that compute"
                    )
                continue
            kind, content = worker.connection.recv()
            if kind != "progress":
                return kind, content
            if report is not None:
                report(*content)


def _stop(worker: _Worker) -> bool:
    """Stop a computation."""
    until = time.monotonic() + _PATIENCE
    with suppress(EOFError, OSError):
        worker.connection.send(None)
        while worker.connection.poll(max(0.0, until - time.monotonic())):
            if worker.connection.recv()[0] != "progress":
                return True
    return False


def _end_of(process: subprocess.Popen[bytes]) -> str:
    """Describe the end of a process."""
    try:
        status = process.wait(_PATIENCE)
    except subprocess.TimeoutExpired:
        status = 0
    ending = signal.Signals(-status).name if status < 0 else f"status {status}"
    return (
        f"the computation ended with {ending} and without an answer, perhaps for lack of memory; "
        "the server goes on. Try a smaller or shorter case, and report this one"
    )
