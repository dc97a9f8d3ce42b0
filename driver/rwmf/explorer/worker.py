"""Process that computes answers for the server of the page.

The kernel runs here and not in the server: a crash or lack of memory ends this process only. The
process also ends when the server does.
"""

from __future__ import annotations

import os
import queue
import resource
import sys
import threading
import traceback
from multiprocessing.connection import Connection
from typing import Any

from rwmf.errors import RwmfError
from rwmf.explorer.model import Model, encode
from rwmf.explorer.questions import BadQuestionError


class _StoppedError(Exception):
    """The server no longer needs the answer."""


def _take(connection: Connection, tasks: queue.Queue[Any], stopped: threading.Event) -> None:
    """Receive messages of the server: a task, or None to stop the present one."""
    try:
        while True:
            task = connection.recv()
            if task is None:
                stopped.set()
            else:
                # a late stop request must not affect the next task
                stopped.clear()
                tasks.put(task)
    except (EOFError, OSError):
        # the server has ended, perhaps killed, possibly during a run of the kernel
        os._exit(0)


def serve(connection: Connection) -> None:
    """Answer requests until the server ends."""
    tasks: queue.Queue[Any] = queue.Queue()
    stopped = threading.Event()

    def poll(_: int = 0) -> None:
        if stopped.is_set():
            raise _StoppedError

    def report(done: int, total: int) -> None:
        poll()
        connection.send(("progress", (done, total)))

    model = Model(*connection.recv())
    threading.Thread(target=_take, args=(connection, tasks, stopped), daemon=True).start()
    while True:
        name, arguments = tasks.get()
        more = {"history": (poll,), "spectrum": (poll,), "cost": (report,)}.get(name, ())
        try:
            connection.send(("answer", encode(getattr(model, name)(*arguments, *more))))
        except _StoppedError:
            connection.send(("stopped", ""))
        except BadQuestionError as error:
            connection.send(("bad", str(error)))
        except RwmfError as error:
            connection.send(("refused", model.message_of(error)))
        except MemoryError:
            connection.send(("refused", "the case needs more memory than a computation may have"))
        except Exception as error:
            traceback.print_exc()
            connection.send(("failed", f"unexpected {type(error).__name__}: {error}"))


def _limit_memory() -> None:
    """Limit the memory to half, for the browser and other programs."""
    half = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") // 2
    _, most = resource.getrlimit(resource.RLIMIT_DATA)
    if most == resource.RLIM_INFINITY or most > half:
        resource.setrlimit(resource.RLIMIT_DATA, (half, most))


if __name__ == "__main__":
    _limit_memory()
    serve(Connection(int(sys.argv[1])))
