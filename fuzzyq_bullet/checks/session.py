"""A check from its first verdict to its last film, over worker processes.

Verdicts are told in order and compared, records put away. What comes back of a job is a verdict,
whatever happens.
"""

from __future__ import annotations

import shutil
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fuzzyq_bullet.checks.baseline import Baselines
from fuzzyq_bullet.checks.group import Group, allow, badness, group_of
from fuzzyq_bullet.checks.run_job import run_job
from fuzzyq_bullet.checks.verdict import Job, Keep, Verdict, check_command, replay_command
from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.files import written_beside
from fuzzyq_bullet.outputs import refuse_other_run
from fuzzyq_bullet.recording.trajectory import Trajectory
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


def _check(order: dict[str, Any]) -> dict[str, Any]:
    return run_job(Job.model_validate(order)).model_dump(mode="json")


def _command(job: Job, verdict: Verdict, pool: WorkerPool) -> str:
    if verdict.result is not None:
        return replay_command(job, pool.plugins)
    return check_command(job, pool.plugins, timeout=pool.timeout, memory_mb=pool.memory_mb)


def _broken(job: Job, why: str) -> Verdict:
    no_film = "" if job.record is None else "its process ended with all that it had recorded"
    return Verdict(name=job.name, file=job.file, status="broken", why=[why], no_film=no_film)


@dataclass(frozen=True)
class Session:
    """What becomes of verdicts.

    Attributes:
        baselines: What they are compared with; None for nothing.
        strict: Whether a run fails that behaves otherwise than recorded.
        keep: Of which runs the record is kept.
        folder: Where.
        replace: Whether it may take the place of that of another run.
        repeat: Runs of each scenario, one after the other; more than one are a group.
        names: The scenarios' names, in order.
    """

    baselines: Baselines | None
    strict: bool
    keep: Keep
    folder: Path
    replace: bool
    repeat: int = 1
    names: Sequence[str] = ()

    def settled(self, finished: Iterable[tuple[int, Verdict]]) -> Iterator[Verdict | Group]:
        """Yield verdicts in the order asked for, each settled as soon as all before it are.

        A group's verdict comes behind those of its runs, which it may change from ``failed`` to
        ``allowed``.

        Args:
            finished: The index of each job and its verdict, in any order.
        """
        due, waiting = 0, dict[int, Verdict]()
        members: list[Verdict] = []
        for i, verdict in finished:
            waiting[i] = verdict
            while due in waiting:
                settled = waiting.pop(due)
                due += 1
                if self.repeat == 1:
                    self._settle(settled)
                    yield settled
                    continue
                members.append(settled)
                _keep_worst(members)
                yield settled
                if len(members) == self.repeat:
                    yield self._settled_group(self.names[due // self.repeat - 1], members)
                    members = []

    def _settle(self, verdict: Verdict) -> None:
        if self.baselines is not None:
            verdict.changes = self.baselines.changes(verdict)
            if self.strict and verdict.changes and verdict.status == "passed":
                verdict.status = "failed"
                verdict.why = ["behaves otherwise than recorded (--strict)"]
        if verdict.record is not None:
            wanted = self.keep != "failed" or verdict.status != "passed"
            self._put_away(verdict, Path(verdict.record), wanted=wanted)

    def _settled_group(self, name: str, members: Sequence[Verdict]) -> Group:
        group = group_of(name, members)
        if self.baselines is not None:
            group.changes = self.baselines.group_changes(group, members)
            if self.strict and group.changes and group.status == "passed":
                group.status = "failed"
                group.why = ["behaves otherwise than recorded (--strict)"]
        allow(group, members)
        for verdict in members:
            if verdict.record is not None:  # the worst alone: see _keep_worst
                failed = verdict.status != "passed" or group.status != "passed"
                wanted = self.keep != "failed" or failed
                self._put_away(verdict, Path(verdict.record), wanted=wanted)
        return group

    def _put_away(self, verdict: Verdict, source: Path, *, wanted: bool) -> None:
        """Move the record of a run to where it is kept, or remove it where it is not wanted.

        It takes the place of one of the same run alone. That it cannot be kept changes no verdict.
        """
        verdict.record = None
        try:
            if not wanted:
                return
            target = self.folder / source.name
            if not self.replace:
                film = target.with_suffix(".mp4")
                refuse_other_run(target, [film], Trajectory.load(source).scenario)
            with written_beside(target) as part:
                shutil.copyfile(source, part)
            verdict.record = str(target)
        except UserError as error:
            verdict.no_film = str(error)
        finally:
            source.unlink(missing_ok=True)


def _keep_worst(members: Sequence[Verdict]) -> None:
    """Remove the records of all runs but the worst of those that have one: it alone is filmed."""
    kept = [verdict for verdict in members if verdict.record is not None]
    if len(kept) > 1:
        worst = max(kept, key=badness)
        for verdict in kept:
            if verdict is not worst and verdict.record is not None:
                Path(verdict.record).unlink(missing_ok=True)
                verdict.record = None


def make_films(pool: WorkerPool, verdicts: Sequence[Verdict]) -> Iterator[str]:
    """Make the films of all runs whose record was kept; yield a line about each.

    A film that fails changes no verdict.
    """
    kept = [verdict for verdict in verdicts if verdict.record]
    films = [str(Path(str(verdict.record)).with_suffix(".mp4")) for verdict in kept]
    orders = [[verdict.record, film] for verdict, film in zip(kept, films, strict=True)]
    for i, answer in pool.run(_film, orders, timeout=FILM_TIMEOUT, writes=films):
        why = answer.died or "\n".join(answer.failed)
        if why:
            kept[i].no_film = why
            yield f"no film {films[i]}: {why}"
        else:
            kept[i].video = films[i]
            yield f"film {films[i]}"


def _film(order: list[str]) -> None:
    """Make a film from a kept trajectory, in a worker."""
    from fuzzyq_bullet.video import record

    trajectory, film = map(Path, order)
    record(Trajectory.load(trajectory), film)
