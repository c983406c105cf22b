"""The pool of workers: what one order leaves behind is not blamed on the next."""

from __future__ import annotations

import os

import pytest

from fuzzyq_bullet.workers import WorkerPool

kept: list[bytes] = []


def keep(megabytes: int) -> int:
    """Hold memory for good, and return the number of the process."""
    kept.append(b"x" * (megabytes * 2**20))
    return os.getpid()


@pytest.mark.slow
@pytest.mark.parametrize(("megabytes", "processes"), [(1, 1), (450, 2)])
def test_a_worker_that_holds_much_memory_makes_way_for_a_fresh_one(
    megabytes: int, processes: int
) -> None:
    with WorkerPool(1, memory_mb=1000) as pool:
        answers = [answer for _, answer in pool.run(keep, [megabytes, 1])]
    assert len({answer.value for answer in answers}) == processes
    assert not any(answer.died or answer.failed for answer in answers)
