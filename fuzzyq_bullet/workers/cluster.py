"""Workers of a Dask cluster, for sweeps that are too long for one machine (extra ``cluster``)."""

from __future__ import annotations

import logging
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from fuzzyq_bullet.errors import MachineError, UserError
from fuzzyq_bullet.workers.pool import Answer, Function, Pool

PATIENCE = 10.0
"""How long the scheduler, and then the first worker, may take to answer (s)."""


class DaskPool:
    """The workers of a Dask client.

    No more is handed out than there are workers: when one dies, all that it was given is suspect.
    """

    def __init__(self, client: Any, workers: int) -> None:
        """Take the workers of a client, so many at a time."""
        self._client = client
        self._workers = workers

    def run(self, function: Function, arguments: Sequence[Any]) -> Iterator[tuple[int, Answer]]:
        """Call a function with each argument; yield index and answer as each is finished."""
        from distributed import as_completed
        from distributed.scheduler import KilledWorker

        waiting = iter(enumerate(arguments))
        pending: dict[Any, int] = {}

        def submit() -> list[Any]:
            for i, argument in waiting:
                future = self._client.submit(function, argument, pure=False)
                pending[future] = i
                return [future]
            return []

        try:
            first = [one for _ in range(self._workers) for one in submit()]
            finished = as_completed(first, loop=self._client.loop)
            for future in finished:
                try:
                    answer = Answer(future.result())
                except KilledWorker:
                    answer = Answer(died="killed, out of memory, or crashed in a library")
                except MachineError:
                    raise
                except UserError as error:
                    answer = Answer(failed=error.problems)
                i = pending.pop(future)
                finished.update(submit())
                yield i, answer
        finally:
            self._client.cancel(list(pending))


@contextmanager
def cluster(address: str, jobs: int | None) -> Iterator[Pool]:
    """Yield the workers of the cluster whose scheduler is at ``address``.

    Args:
        address: Such as ``tcp://127.0.0.1:8786``.
        jobs: Orders at a time; None for as many as there are workers now.

    Raises:
        UserError: If the extra is missing, there is no scheduler or no worker, or the scheduler is
            lost on the way.
    """
    try:
        from concurrent.futures import CancelledError

        from distributed import Client
        from distributed.comm.addressing import parse_address
        from distributed.comm.registry import get_backend
    except ImportError as error:
        raise UserError(
            "--backend dask: Dask is not installed: pip install 'fuzzyq_bullet[cluster]'"
        ) from error
    # What befalls it is told by the errors below, in one line.
    for name in ("distributed", "distributed.client"):  # which has a level of its own
        logging.getLogger(name).setLevel(logging.CRITICAL)
    try:
        get_backend(parse_address(address)[0])  # else a client that never was complains at its end
        client = Client(address, timeout=PATIENCE, set_as_default=False)
    except (OSError, ValueError, TypeError) as error:
        raise UserError(
            f"--scheduler: {address}: no Dask scheduler answers there within {PATIENCE:g} s"
        ) from error
    try:
        cores = _cores(client, address)
        yield DaskPool(client, jobs or cores)
    except CancelledError as error:
        raise UserError(
            f"--scheduler: {address}: the scheduler is gone; the same command goes on"
        ) from error
    finally:
        client.close(timeout=PATIENCE)


def _cores(client: Any, address: str) -> int:
    """Return how many workers there are, which must have one thread each."""
    try:
        client.wait_for_workers(1, timeout=PATIENCE)
    except OSError as error:  # TimeoutError is one
        raise UserError(
            f"--scheduler: {address}: no worker has joined it within {PATIENCE:g} s"
        ) from error
    threads = client.nthreads()
    if any(number > 1 for number in threads.values()):
        raise UserError(
            f"--scheduler: {address}: its workers run {max(threads.values())} episodes in one "
            "process; start them with --nthreads 1"
        )
    return len(threads)
