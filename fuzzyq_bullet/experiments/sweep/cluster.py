"""Workers of a Dask cluster, for sweeps that are too long for one machine (extra ``cluster``)."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from joblib.parallel import ParallelBackendBase, register_parallel_backend

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.experiments.sweep.workers import Pool

BACKEND = "fuzzyq-dask"
"""What joblib calls it."""
PATIENCE = 10.0
"""How long the scheduler, and then the first worker, may take to answer (s)."""


class _Cluster(ParallelBackendBase):  # type: ignore[misc]
    """The workers of a Dask client as a backend of joblib.

    joblib's own never tells of a task whose workers died, and a sweep would wait for it for ever;
    and with a single core it would work in this process.
    """

    supports_retrieve_callback = True
    supports_return_generator = True
    supports_sharedmem = False

    def __init__(self, client: Any, **options: Any) -> None:
        super().__init__(**options)
        self._client = client
        self._pending: set[Any] = set()

    def configure(self, n_jobs: int = 1, parallel: Any = None, **_: Any) -> int:
        self.parallel = parallel
        return n_jobs

    def effective_n_jobs(self, n_jobs: int) -> int:
        return n_jobs

    def submit(self, func: Callable[[], Any], callback: Callable[[Any], None]) -> Any:
        future = self._client.submit(func, pure=False)
        self._pending.add(future)  # a future that nobody holds is forgotten

        def finished(done: Any) -> None:
            callback(done)
            self._pending.discard(done)

        future.add_done_callback(finished)
        return future

    def retrieve_result_callback(self, out: Any) -> Any:
        return out.result()

    def abort_everything(self, ensure_ready: bool = True) -> None:
        self._client.cancel(list(self._pending))
        self._pending.clear()


@contextmanager
def cluster(address: str, jobs: int | None) -> Iterator[Pool]:
    """Yield the workers of the cluster whose scheduler is at ``address``.

    Args:
        address: Such as ``tcp://127.0.0.1:8786``.
        jobs: Episodes at a time; None for as many as there are workers now.

    Raises:
        UserError: If the extra is missing, there is no scheduler or no worker, or the scheduler is
            lost on the way.
    """
    try:
        from concurrent.futures import CancelledError

        from distributed import Client
        from distributed.comm.addressing import parse_address
        from distributed.comm.registry import get_backend
        from distributed.scheduler import KilledWorker
    except ImportError as error:
        raise UserError(
            "--backend dask: Dask is not installed: pip install 'fuzzyq_bullet[cluster]'"
        ) from error
    # What befalls it is told by the errors below, in one line.
    logging.getLogger("distributed").setLevel(logging.CRITICAL)
    try:
        get_backend(parse_address(address)[0])  # else a client that never was complains at its end
        client = Client(address, timeout=PATIENCE, set_as_default=False)
    except (OSError, ValueError, TypeError) as error:
        raise UserError(
            f"--scheduler: {address}: no Dask scheduler answers there within {PATIENCE:g} s"
        ) from error
    try:
        cores = _cores(client, address)
        register_parallel_backend(BACKEND, _Cluster)
        yield Pool(jobs or cores, BACKEND, {"client": client}, (KilledWorker,))
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
