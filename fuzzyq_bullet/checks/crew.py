"""Worker processes that may die: what happens in one of them is told, and the others go on."""

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
from collections.abc import Iterator, Sequence
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import Any, TypeAlias, TypeVar

from fuzzyq_bullet.checks.text import MEMORY_MB, TIMEOUT, check_command, replay_command
from fuzzyq_bullet.checks.verdict import FilmJob, Job, Verdict
from fuzzyq_bullet.checks.worker import COMMAND
from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.files import remove_parts
from fuzzyq_bullet.wording import end_in_words

FILM_TIMEOUT = 900.0
"""Wall-clock time (s) that one film may take."""
START_TIMEOUT = 120.0
"""Wall-clock time (s) that a worker may take to load the libraries."""
MOST_LOST = 3
"""Workers that may end one after the other before they are ready: one may, short of memory."""

AnyJob: TypeAlias = "Job | FilmJob"
_J = TypeVar("_J", Job, FilmJob)
Answer: TypeAlias = dict[str, Any]
"""What a worker said: ``verdict`` or ``filmed``; or ``died``, a line about its end."""


class Crew:
    """Workers, started when there is something to do and ended when the block ends.

    Args:
        workers: Most at a time.
        plugins: Modules that each imports first.
        timeout: Wall-clock time (s) after which a scenario is cut.
        memory_mb: Memory (MB) that each may use.
    """

    def __init__(
        self,
        workers: int = 1,
        *,
        plugins: Sequence[str] = (),
        timeout: float = TIMEOUT,
        memory_mb: int = MEMORY_MB,
    ) -> None:
        self._most = workers
        self._plugins = list(plugins)
        self._timeout = timeout
        self._memory_mb = memory_mb
        self._workers: list[_Worker] = []
        self._answers: queue.SimpleQueue[tuple[_Worker, Answer]] = queue.SimpleQueue()
        self._lost = 0

    def __enter__(self) -> Crew:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def close(self) -> None:
        """End all workers, whatever they are at."""
        while self._workers:
            self._workers.pop().end()

    def check(self, jobs: Sequence[Job]) -> Iterator[tuple[int, Verdict]]:
        """Do jobs; yield the index of each and its verdict as it is finished, in any order.

        Raises:
            UserError: If no worker can be started, for a plugin that does not load.
        """
        orders = [
            {"job": job.model_dump(), "timeout": self._timeout, "writes": job.record}
            for job in jobs
        ]
        for i, answer, seconds in self._done(orders):
            if "verdict" in answer:
                verdict = Verdict.model_validate(answer["verdict"])
            else:
                verdict = _broken(jobs[i], answer["died"])
            verdict.seconds = round(seconds, 3)
            verdict.replay = jobs[i].again or self._command(jobs[i], verdict)
            yield i, verdict

    def _command(self, job: Job, verdict: Verdict) -> str:
        if verdict.result is not None:
            return replay_command(job, self._plugins)
        return check_command(job, self._plugins, timeout=self._timeout, memory_mb=self._memory_mb)

    def film(self, jobs: Sequence[FilmJob]) -> Iterator[tuple[int, str]]:
        """Make films; yield the index of each, and why it could not be made ("" if it was)."""
        orders = [
            {"film": job.model_dump(), "timeout": FILM_TIMEOUT, "writes": job.video} for job in jobs
        ]
        for i, answer, _ in self._done(orders):
            yield i, "" if answer.get("filmed") else answer.get("why") or answer["died"]

    def _done(self, orders: Sequence[dict[str, Any]]) -> Iterator[tuple[int, Answer, float]]:
        """Yield the index of each order, the answer to it, and how long it took (s)."""
        waiting = deque(enumerate(orders))
        try:
            while waiting or any(worker.order is not None for worker in self._workers):
                self._hand_out(waiting)
                yield from self._collect()
        finally:  # whoever stops listening leaves no worker with half an answer
            for busy in [one for one in self._workers if one.order is not None]:
                self._dismiss(busy)

    def _hand_out(self, waiting: deque[tuple[int, dict[str, Any]]]) -> None:
        starting = sum(not worker.ready for worker in self._workers)
        idle = [worker for worker in self._workers if worker.ready and worker.order is None]
        for worker in idle[: len(waiting)]:
            worker.give(*waiting.popleft())
        room = self._most - len(self._workers)
        for _ in range(min(room, len(waiting) - starting)):
            self._workers.append(_Worker(self._plugins, self._memory_mb, self._answers))

    def _collect(self) -> Iterator[tuple[int, Answer, float]]:
        """Wait for whatever happens first, and yield what it finishes."""
        soonest = min((one.deadline for one in self._workers), default=0.0)
        try:
            wait = max(0.0, min(soonest - time.monotonic(), 1.0))
            worker, answer = self._answers.get(timeout=wait)
        except queue.Empty:
            pass
        else:
            if worker not in self._workers:  # it was cut before it could answer
                return
            if "unable" in answer:
                raise UserError(*answer["unable"])
            if "order" in answer and answer["order"] != worker.token:
                return  # said twice, as by a copy of the process that a planner made
            if "ready" in answer:
                worker.be_ready()
                self._lost = 0
            else:
                yield from self._settle(worker, answer)
        now = time.monotonic()
        for late in [one for one in self._workers if now > one.deadline]:
            limit = late.deadline - late.since
            why = f"cut after {limit:g} s of wall-clock time"
            if late.ready:
                why += ": it hangs, or needs a longer --timeout"
            yield from self._settle(late, {"died": why})

    def _settle(self, worker: _Worker, answer: Answer) -> Iterator[tuple[int, Answer, float]]:
        order, seconds = worker.order, time.monotonic() - worker.since
        started = worker.ready
        worker.order, worker.deadline = None, float("inf")
        if "died" in answer or answer.get("retire"):
            self._dismiss(worker)
        if order is not None:
            yield order, answer, seconds
        elif not started:
            self._lost += 1
            if self._lost == MOST_LOST:
                raise UserError(f"no worker process can be started: {answer['died']}")

    def _dismiss(self, worker: _Worker) -> None:
        worker.end()
        self._workers.remove(worker)


class _Worker:
    """One process and the pipes to it."""

    def __init__(
        self,
        plugins: Sequence[str],
        memory_mb: int,
        answers: queue.SimpleQueue[tuple[_Worker, Answer]],
    ) -> None:
        self._name = secrets.token_hex(8)
        settings = {
            "plugins": list(plugins),
            "memory_mb": memory_mb,
            "parent": os.getpid(),
            "name": self._name,
        }
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
        self.order: int | None = None
        self.token = ""
        self._writes: str | None = None
        self.since = time.monotonic()
        self.deadline = self.since + START_TIMEOUT

    def be_ready(self) -> None:
        self.ready, self.deadline = True, float("inf")

    def give(self, index: int, order: dict[str, Any]) -> None:
        """Hand out an order; that nobody takes it is seen when listening."""
        self.order, self.since = index, time.monotonic()
        self.token = order["order"] = secrets.token_hex(8)
        self.deadline = self.since + order["timeout"]
        self._writes = order["writes"]
        assert self._process.stdin is not None
        with suppress(BrokenPipeError):
            self._process.stdin.write(json.dumps(order).encode() + b"\n")
            self._process.stdin.flush()

    def _listen(self, answers: queue.SimpleQueue[tuple[_Worker, Answer]]) -> None:
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
        if self._writes is not None:
            remove_parts(Path(self._writes), self._name)


def _broken(job: Job, why: str) -> Verdict:
    no_film = "" if job.record is None else "its process ended with all that it had recorded"
    return Verdict(name=job.name, file=job.file, status="broken", why=[why], no_film=no_film)
