"""Jobs of a check over worker processes: what comes back is a verdict, whatever happens."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from fuzzyq_bullet.checks.run_job import make_film, run_job
from fuzzyq_bullet.checks.text import check_command, replay_command
from fuzzyq_bullet.checks.verdict import FilmJob, Job, Verdict
from fuzzyq_bullet.workers import WorkerPool

FILM_TIMEOUT = 900.0
"""Wall-clock time (s) that one film may take."""


def check_all(pool: WorkerPool, jobs: Sequence[Job]) -> Iterator[tuple[int, Verdict]]:
    """Do jobs; yield the index of each and its verdict as it is finished, in any order.

    Raises:
        UserError: If no worker can be started, for a plugin that does not load.
    """
    orders = [job.model_dump() for job in jobs]
    for i, answer in pool.run(_check, orders, writes=[job.record for job in jobs]):
        job = jobs[i]
        if answer.value is not None:
            verdict = Verdict.model_validate(answer.value)
        else:
            hint = ": it hangs, or needs a longer --timeout" if answer.late else ""
            verdict = _broken(job, (answer.died or "; ".join(answer.failed)) + hint)
        verdict.seconds = round(answer.seconds, 3)
        verdict.replay = job.again or _command(job, verdict, pool)
        yield i, verdict


def film_all(pool: WorkerPool, jobs: Sequence[FilmJob]) -> Iterator[tuple[int, str]]:
    """Make films; yield the index of each, and why it could not be made ("" if it was)."""
    orders = [job.model_dump() for job in jobs]
    videos = [job.video for job in jobs]
    for i, answer in pool.run(_film, orders, timeout=FILM_TIMEOUT, writes=videos):
        yield i, answer.died or "\n".join(answer.failed)


def _check(order: dict[str, Any]) -> dict[str, Any]:
    return run_job(Job.model_validate(order)).model_dump(mode="json")


def _film(order: dict[str, Any]) -> None:
    make_film(FilmJob.model_validate(order))


def _command(job: Job, verdict: Verdict, pool: WorkerPool) -> str:
    if verdict.result is not None:
        return replay_command(job, pool.plugins)
    return check_command(job, pool.plugins, timeout=pool.timeout, memory_mb=pool.memory_mb)


def _broken(job: Job, why: str) -> Verdict:
    no_film = "" if job.record is None else "its process ended with all that it had recorded"
    return Verdict(name=job.name, file=job.file, status="broken", why=[why], no_film=no_film)
