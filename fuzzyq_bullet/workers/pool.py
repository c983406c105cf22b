"""The pool of worker processes of this machine: deaths, timeouts and memory limits."""

from __future__ import annotations

import json
import os
import queue
import secrets
import signal
import subprocess
import sys
import threading
import time
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Protocol, TypeAlias

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.files import remove_parts, remove_temporary
from fuzzyq_bullet.platforms import cores
from fuzzyq_bullet.wording import end_in_words
from fuzzyq_bullet.workers.process import COMMAND

TIMEOUT = 120.0
"""Wall-clock time (s) that one order may take, where nothing else is said."""
MEMORY_MB = 2048
"""Memory that one worker may use (MB), where nothing else is said."""
START_TIMEOUT = 120.0
"""Wall-clock time (s) that a worker may take to load the libraries."""
MOST_LOST = 3
"""Workers that may end one after the other before they are ready: one may, short of memory."""

Function: TypeAlias = Callable[[Any], Any]
"""What a worker calls: a function of a module, which takes and returns what JSON can say."""


@dataclass(frozen=True)
class Answer:
    """What came of one order: one of the first three says it.

    Attributes:
        value: What the function returned.
        failed: Lines of the ``UserError`` that it raised.
        died: How its process ended, in a line.
        late: Whether it was the clock that ended it.
        seconds: Wall-clock time that it took.
    """

    value: Any = None
    failed: tuple[str, ...] = ()
    died: str = ""
    late: bool = False
    seconds: float = 0.0


class Pool(Protocol):
    """Whoever does work in other processes."""

    def run(self, function: Function, arguments: Sequence[Any]) -> Iterator[tuple[int, Answer]]:
        """Call a function with each argument; yield index and answer as each is finished."""


@dataclass(eq=False)
class _Order:
    index: int
    function: Function
    argument: Any
    timeout: float
    writes: str | None
    token: str = field(default_factory=lambda: secrets.token_hex(8))

    def line(self) -> bytes:
        told = {
            "module": self.function.__module__,
            "function": self.function.__name__,
            "argument": self.argument,
            "timeout": self.timeout,
            "order": self.token,
        }
        return json.dumps(told).encode() + b"\n"


class WorkerPool:
    """Processes of this machine, started when there is something to do, ended with the block.

    Each does one order after the other. One that crashes, hangs or uses too much memory costs the
    order that it is at, and another takes its place. A terminal's Ctrl-C does not reach them; they
    end when this process does, even by ``kill -9``.

    Attributes:
        plugins: Modules that each imports first.
        timeout: Wall-clock time (s) after which an order is cut.
        memory_mb: Memory (MB) that each may use.
    """

    def __init__(
        self,
        workers: int | None = None,
        *,
        plugins: Sequence[str] = (),
        timeout: float = TIMEOUT,
        memory_mb: int = MEMORY_MB,
    ) -> None:
        """Make a pool of so many workers at most, None for one a core; nothing is started yet."""
        self.plugins = tuple(plugins)
        self.timeout = timeout
        self.memory_mb = memory_mb
        self._most = workers or cores()
        self._workers: list[_Worker] = []
        self._answers: queue.SimpleQueue[tuple[_Worker, dict[str, Any]]] = queue.SimpleQueue()
        self._lost = 0

    def __enter__(self) -> WorkerPool:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """End all workers, whatever they are at."""
        while self._workers:
            self._workers.pop().end()

    def run(
        self,
        function: Function,
        arguments: Sequence[Any],
        *,
        timeout: float | None = None,
        writes: Sequence[str | None] = (),
    ) -> Iterator[tuple[int, Answer]]:
        """Call a function with each argument; yield index and answer as each is finished.

        Args:
            function: A function of a module, which takes and returns what JSON can say.
            arguments: One for each call.
            timeout: Wall-clock time (s) that each may take; None for that of the pool.
            writes: The file that each writes, if any: a half-written one is removed.

        Raises:
            UserError: If no worker can be started, for a plugin that does not load; or the machine
                fails one, as with a full disk.
        """
        given = self.timeout if timeout is None else timeout
        waiting = deque(
            _Order(i, function, argument, given, writes[i] if writes else None)
            for i, argument in enumerate(arguments)
        )
        try:
            while waiting or any(worker.order is not None for worker in self._workers):
                self._hand_out(waiting)
                for finished in self._collect():
                    self._hand_out(waiting)  # before whoever listens takes its time
                    yield finished
        finally:  # whoever stops listening leaves no worker with half an answer
            for busy in [one for one in self._workers if one.order is not None]:
                self._dismiss(busy)

    def _hand_out(self, waiting: deque[_Order]) -> None:
        starting = sum(not worker.ready for worker in self._workers)
        idle = [worker for worker in self._workers if worker.ready and worker.order is None]
        for worker in idle[: len(waiting)]:
            worker.give(waiting.popleft())
        room = self._most - len(self._workers)
        for _ in range(min(room, len(waiting) - starting)):
            settings = {
                "plugins": self.plugins,
                "memory_mb": self.memory_mb,
                "module": waiting[0].function.__module__,
            }
            self._workers.append(_Worker(settings, self._answers))

    def _collect(self) -> Iterator[tuple[int, Answer]]:
        """Wait for whatever happens first, and yield what it finishes."""
        soonest = min((one.deadline for one in self._workers), default=0.0)
        try:
            wait = max(0.0, min(soonest - time.monotonic(), 1.0))
            worker, told = self._answers.get(timeout=wait)
        except queue.Empty:
            pass
        else:
            if worker not in self._workers:  # it was cut before it could answer
                return
            if "unable" in told:
                raise UserError(*told["unable"])
            if "order" in told and (worker.order is None or told["order"] != worker.order.token):
                return  # said twice, as by a copy of the process that a planner made
            if "ready" in told:
                worker.be_ready()
                self._lost = 0
            else:
                yield from self._settle(worker, told)
        now = time.monotonic()
        for late in [one for one in self._workers if now > one.deadline]:
            limit = late.deadline - late.since
            why = f"cut after {limit:g} s of wall-clock time"
            yield from self._settle(late, {"died": why, "late": True})

    def _settle(self, worker: _Worker, told: dict[str, Any]) -> Iterator[tuple[int, Answer]]:
        order, seconds = worker.order, time.monotonic() - worker.since
        started = worker.ready
        worker.order, worker.deadline = None, float("inf")
        died = told.get("died", "")
        if died or told.get("retire"):
            self._dismiss(worker)
        if order is not None:
            failed = tuple(told.get("failed", ()))
            late = told.get("late", False)
            yield order.index, Answer(told.get("value"), failed, died, late, seconds)
        elif not started:
            self._lost += 1
            if self._lost == MOST_LOST:
                raise UserError(f"no worker process can be started: {died}")

    def _dismiss(self, worker: _Worker) -> None:
        worker.end()
        self._workers.remove(worker)


class _Worker:
    """One process and the pipes to it."""

    def __init__(
        self,
        settings: dict[str, Any],
        answers: queue.SimpleQueue[tuple[_Worker, dict[str, Any]]],
    ) -> None:
        self._name = secrets.token_hex(8)
        settings = {**settings, "parent": os.getpid(), "name": self._name}
        path = [os.path.abspath(entry) for entry in sys.path]  # noqa: PTH100  ("" is the folder)
        one_thread = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"), "1")
        self._process = subprocess.Popen(
            [sys.executable, "-I", "-c", COMMAND, json.dumps(path), json.dumps(settings)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env={**os.environ, **one_thread},
            # A terminal's Ctrl-C is for the process that started it; and a group of its own ends
            # as a whole.
            start_new_session=True,
        )
        # A thread, not a selector: Windows has none for pipes.
        self._listener = threading.Thread(target=self._listen, args=(answers,), daemon=True)
        self._listener.start()
        self.ready = False
        self.order: _Order | None = None
        self._writes: str | None = None
        self.since = time.monotonic()
        self.deadline = self.since + START_TIMEOUT

    def be_ready(self) -> None:
        self.ready, self.deadline = True, float("inf")

    def give(self, order: _Order) -> None:
        """Hand out an order; that nobody takes it is seen when listening."""
        self.order, self.since = order, time.monotonic()
        self.deadline = self.since + order.timeout
        self._writes = order.writes
        assert self._process.stdin is not None
        with suppress(BrokenPipeError):
            self._process.stdin.write(order.line())
            self._process.stdin.flush()

    def _listen(self, answers: queue.SimpleQueue[tuple[_Worker, dict[str, Any]]]) -> None:
        """Hand on whatever it says, and at last how it ended."""
        assert self._process.stdout is not None
        with suppress(ValueError):  # what it said as it was ended
            for line in self._process.stdout:
                answers.put((self, json.loads(line)))
        answers.put((self, {"died": end_in_words(self._process.wait())}))

    def end(self) -> None:
        """End the process and all that it started."""
        if hasattr(os, "killpg"):
            with suppress(ProcessLookupError, PermissionError):
                os.killpg(self._process.pid, signal.SIGKILL)
        else:
            self._process.kill()
        self._process.wait()
        self._listener.join()  # to the end of the pipe, which is there with that of the process
        for pipe in (self._process.stdin, self._process.stdout):
            assert pipe is not None
            with suppress(BrokenPipeError):
                pipe.close()
        remove_temporary(self._name)
        if self._writes is not None:
            remove_parts(Path(self._writes), self._name)
