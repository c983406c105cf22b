"""A check from its first verdict to its last film: told in order, compared, records put away."""

from __future__ import annotations

import shutil
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from fuzzyq_bullet.checks.jobs import film_all
from fuzzyq_bullet.checks.verdict import FilmJob, Keep, Verdict
from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.files import written_beside
from fuzzyq_bullet.outputs import refuse_other_run
from fuzzyq_bullet.trajectory import Trajectory

if TYPE_CHECKING:
    from fuzzyq_bullet.checks.baseline import Baselines
    from fuzzyq_bullet.workers import WorkerPool


@dataclass(frozen=True)
class Session:
    """What becomes of verdicts.

    Attributes:
        baselines: What they are compared with; None for nothing.
        strict: Whether a run fails that behaves otherwise than recorded.
        keep: Of which runs the record is kept.
        folder: Where.
        replace: Whether it may take the place of that of another run.
    """

    baselines: Baselines | None
    strict: bool
    keep: Keep
    folder: Path
    replace: bool

    def settled(self, finished: Iterable[tuple[int, Verdict]]) -> Iterator[Verdict]:
        """Yield verdicts in the order asked for, each settled as soon as all before it are.

        Args:
            finished: The index of each job and its verdict, in any order.
        """
        due, waiting = 0, dict[int, Verdict]()
        for i, verdict in finished:
            waiting[i] = verdict
            while due in waiting:
                settled = waiting.pop(due)
                self._settle(settled)
                yield settled
                due += 1

    def _settle(self, verdict: Verdict) -> None:
        if self.baselines is not None:
            verdict.changes = self.baselines.changes(verdict)
            if self.strict and verdict.changes and verdict.status == "passed":
                verdict.status = "failed"
                verdict.why = ["behaves otherwise than recorded (--strict)"]
        if verdict.record is not None:
            self._put_away(verdict, Path(verdict.record))

    def _put_away(self, verdict: Verdict, source: Path) -> None:
        """Move the record of a run to where it is kept, or remove it.

        It takes the place of one of the same run alone. That it cannot be kept changes no verdict.
        """
        verdict.record = None
        try:
            if self.keep == "failed" and verdict.status == "passed":
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


def make_films(pool: WorkerPool, verdicts: Sequence[Verdict]) -> Iterator[str]:
    """Make the films of all runs whose record was kept; yield a line about each.

    A film that fails changes no verdict.
    """
    kept = [verdict for verdict in verdicts if verdict.record]
    records = [str(verdict.record) for verdict in kept]
    films = [FilmJob(record=one, video=str(Path(one).with_suffix(".mp4"))) for one in records]
    for i, why in film_all(pool, films):
        if why:
            kept[i].no_film = why
            yield f"no film {films[i].video}: {why}"
        else:
            kept[i].video = films[i].video
            yield f"film {films[i].video}"
