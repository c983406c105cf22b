"""Jobs over worker processes: restarted when one dies, without blaming the innocent."""

from __future__ import annotations

import os
import signal
import threading
import time
import warnings
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass, field
from typing import Any, TypeAlias, TypeVar

from fuzzyq_bullet.experiments.sweep.episode import Done
from fuzzyq_bullet.experiments.sweep.jobs import Job
from fuzzyq_bullet.experiments.sweep.rows import Row
from fuzzyq_bullet.plugins import load_plugins

Work: TypeAlias = Callable[[Job], Done]

T = TypeVar("T")
R = TypeVar("R")

_INTERRUPTS = tuple(
    getattr(signal, name) for name in ("SIGINT", "SIGALRM") if hasattr(signal, name)
)
"""Ctrl-C, and one that had to wait for an import to end (``cli.process``)."""

KILLED = "its worker process died twice: killed, out of memory, or crashed in a library"


@dataclass(frozen=True)
class Pool:
    """What does the work: a backend of joblib.

    Attributes:
        workers: How many at a time; None for one a core.
        backend: Name of a backend that joblib knows.
        options: What else that backend is to be told (``joblib.parallel_config``).
        deaths: What it raises when a worker dies; by default what loky does.
        plugins: Modules that each worker of this machine imports first.
    """

    workers: int | None = None
    backend: str = "loky"
    options: Mapping[str, Any] = field(default_factory=dict)
    deaths: tuple[type[BaseException], ...] | None = None
    plugins: tuple[str, ...] = ()


def finished(jobs: Sequence[Job], work: Work, pool: Pool) -> Generator[Done, None, None]:
    """Do the jobs; yield each as it is finished, in any order.

    When a worker dies, all that were waiting with it are lost, and nobody knows whose fault it was.
    Each of them is then done alone. The one that kills its worker again gets a row that says so,
    and the others go on.

    Args:
        jobs: What to do.
        work: Does one; runs in a worker.
        pool: Who does it.
    """
    waiting = {job.key: job for job in jobs}
    while waiting:
        begun: dict[Any, Job] = {}
        try:
            for done in _noted(list(waiting.values()), work, pool, begun):
                del waiting[done.row.key]
                begun.pop(done.row.key, None)
                yield done
        except deaths(pool):
            for job in list(begun.values()):
                del waiting[job.key]
                yield _alone(job, work, pool)


def _alone(job: Job, work: Work, pool: Pool) -> Done:
    try:
        (done,) = _noted([job], work, pool, {})
    except deaths(pool):
        return Done(Row.failed(job, KILLED))
    return done


def _noted(jobs: Sequence[Job], work: Work, pool: Pool, begun: dict[Any, Job]) -> Iterator[Done]:
    """Do jobs, noting in ``begun`` which have been handed out."""

    def note(job: Job) -> None:
        begun[job.key] = job

    return spread(jobs, work, pool, note)


def spread(
    things: Iterable[T], work: Callable[[T], R], pool: Pool, hand_out: Callable[[T], None]
) -> Generator[R, None, None]:
    """Do work through joblib; yield each result as it comes, in any order.

    Args:
        things: What is to be done.
        work: Does one; runs in a worker.
        pool: Who does it.
        hand_out: Called with each before it is handed out.
    """
    import joblib

    workers = pool.workers or joblib.cpu_count()

    def handed_out() -> Iterator[Any]:
        for thing in things:
            hand_out(thing)
            yield joblib.delayed(work)(thing)

    # joblib would do the work of a single worker in this process, which it may then bring down. So
    # it always has room for two, but is handed one job at a time.
    ahead = 1 if workers == 1 else 2 * workers
    options = {**_loky_options(pool), **pool.options}
    with joblib.parallel_config(pool.backend, n_jobs=max(2, workers), **options):
        parallel = joblib.Parallel(
            return_as="generator_unordered", batch_size=1, pre_dispatch=ahead, max_nbytes=None
        )
        results = None
        try:
            with _deaf_to_ctrl_c() if pool.backend == "loky" else nullcontext():
                results = parallel(handed_out())
            for result in results:  # noqa: UP028 ("yield from" would close it before "finally")
                yield result
        finally:
            with warnings.catch_warnings():  # that not all was waited for is known here
                warnings.simplefilter("ignore")
                if results is not None:
                    results.close()


def deaths(pool: Pool) -> tuple[type[BaseException], ...]:
    """Return what ``spread`` raises when a worker dies."""
    if pool.deaths is not None:
        return pool.deaths
    from joblib.externals.loky.process_executor import BrokenProcessPool

    return (BrokenProcessPool,)


def _loky_options(pool: Pool) -> dict[str, Any]:
    if pool.backend != "loky":
        return {}
    # One thread each: there are as many workers as cores.
    return {
        "inner_max_num_threads": 1,
        "initializer": _begin_worker,
        "initargs": (os.getpid(), pool.plugins),
    }


@contextmanager
def _deaf_to_ctrl_c() -> Iterator[None]:
    """Start processes that leave Ctrl-C to this one, from their first moment on.

    A terminal sends it to all of them, and a process that is still loading its libraries would
    answer with a traceback. What is blocked here stays so in what is started meanwhile; this
    process itself gets the signal afterwards.
    """
    if not hasattr(signal, "pthread_sigmask"):  # Windows
        yield
        return
    from multiprocessing import resource_tracker

    from joblib.externals.loky.backend import resource_tracker as loky_tracker

    for tracker in (resource_tracker, loky_tracker):
        tracker.ensure_running()  # first: what starts it lets the signal through again
    before = signal.pthread_sigmask(signal.SIG_BLOCK, _INTERRUPTS)
    noted: list[int] = []
    # Another thread may be told of it instead, and Python would then raise it in the midst of this.
    handlers = {
        signum: signal.signal(signum, lambda late, _: noted.append(late))
        for signum in _INTERRUPTS
        if threading.current_thread() is threading.main_thread()
        and callable(signal.getsignal(signum))
    }
    try:
        yield
    finally:
        for signum, handler in handlers.items():
            signal.signal(signum, handler)
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
        for late in noted:
            signal.raise_signal(late)


def _begin_worker(parent: int, plugins: Sequence[str]) -> None:
    """Load plugins, and end this worker when its parent process ends, even by ``kill -9``."""

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(0.5)
        os._exit(1)

    threading.Thread(target=watch, name="watch-parent", daemon=True).start()
    # A terminal's Ctrl-C is for the parent, so a KeyboardInterrupt here is always a planner's own.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    load_plugins(plugins)
