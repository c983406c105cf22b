"""What takes time in a report, and is therefore done in worker processes: films and figures."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TypeAlias

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.experiments.figures import drawing
from fuzzyq_bullet.experiments.report.films import Film, Wanted, film
from fuzzyq_bullet.experiments.sweep.workers import Pool, deaths, spread

Task: TypeAlias = "tuple[int, Wanted | int, Path]"
"""Its place in the list, a run to be filmed or the number of a figure, and a folder to make."""
Made: TypeAlias = "Film | bytes"


def make(
    things: Sequence[Wanted | int],
    workers: int | None,
    plugins: Sequence[str],
    done: Callable[[], None],
) -> list[Made]:
    """Return the film of each run, and each figure as a PNG, in their order.

    Args:
        things: Runs to be filmed, and numbers of figures.
        workers: How many at a time; None for one a core.
        plugins: Modules that each worker imports first.
        done: Called after each.

    Raises:
        UserError: If no film can be written, or a worker process dies.
    """
    pool = Pool(workers, plugins=tuple(plugins))
    made: dict[int, Made] = {}
    # One folder for all, made here: workers that are ended leave theirs behind.
    with tempfile.TemporaryDirectory(prefix="fuzzyq-", ignore_cleanup_errors=True) as folder:
        tasks = [(place, thing, Path(folder) / str(place)) for place, thing in enumerate(things)]
        try:
            for place, one in spread(tasks, _make, pool, lambda task: None):
                made[place] = one
                done()
        except deaths(pool) as error:
            raise UserError(
                "a worker process died: killed, out of memory, or crashed in a library; "
                "try --jobs 1"
            ) from error
    return [made[place] for place in range(len(things))]


def _make(task: Task) -> tuple[int, Made]:
    place, thing, folder = task
    folder.mkdir()
    if isinstance(thing, Wanted):
        return place, film(thing, folder)
    path, *_ = drawing(thing)(folder)
    return place, path.read_bytes()
