"""What is left of a soak, held to what was promised: nothing lost, all readable, memory flat."""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from scipy.stats import theilslopes

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.recording.trajectory import Trajectory
from fuzzyq_bullet.studies.episodes import Job, Row, as_csv
from fuzzyq_bullet.studies.storage import rows_in
from fuzzyq_bullet.studies.sweep import run_job
from tests.soak.disturbed import Ledger, quiet_samples
from tests.soak.soak_study import Soak
from tests.soak.watched import marked

SAMPLE = 50
"""Episodes that are run again, undisturbed."""
MOST_GROWTH = 10.0
"""Growth (MB) of the memory of a process over a thousand episodes that counts as flat: its rows
alone are about 3 MB of that, in the command."""
ENOUGH = 200
"""Episodes over which growth can be told from the ups and downs of large and small fields."""


def faults_of_rows(folder: Path, study: Soak) -> Iterator[str]:
    """Yield what is wrong with the rows: each episode has one, once, and the table holds them."""
    plan = study.plan()
    rows = rows_in(folder / "journal.jsonl")
    lines = (folder / "journal.jsonl").read_bytes().splitlines()
    keys = {row.key for row in rows}
    if missing := plan.keys - keys:
        yield f"{len(missing)} episodes have no row, such as {min(missing)}"
    if len(lines) != len(keys):
        yield f"{len(lines)} lines for {len(keys)} episodes"
    if strange := keys - plan.keys:
        yield f"{len(strange)} rows are of no episode, such as {min(strange)}"
    if (folder / "soak.csv").read_text() != as_csv(rows):
        yield "the table is not that of the journal"
    for row in rows:
        if row.error is not None:
            yield f"{row.key}: {row.error}"


def faults_of_records(folder: Path, jobs: Sequence[Job], rows: dict[Any, Row]) -> Iterator[str]:
    """Yield what is wrong with the records: each can be read, and is of its row's run."""
    for job in jobs:
        path = folder / "records" / f"{job.name}.npz"
        if why := why_unreadable(path, rows[job.key].digest):
            yield why


def why_unreadable(path: Path, digest: str | None = None) -> str:
    """Return what is wrong with a record: unreadable, or of another digest; empty if nothing."""
    try:
        found = Trajectory.load(path).digest()
    except UserError as error:
        return str(error)
    return "" if digest in (None, found) else f"{path.name}: is of another run than its row"


def faults_of_digests(jobs: Sequence[Job], rows: dict[Any, Row], seed: int) -> Iterator[str]:
    """Yield which of a sample of episodes come to something else when run again."""
    for job in random.Random(seed).sample(jobs, min(SAMPLE, len(jobs))):
        again = run_job(job).row
        if again != rows[job.key]:
            yield f"{job.name}: {rows[job.key].digest} disturbed, {again.digest} undisturbed"


def faults_of_leftovers(folders: Sequence[Path], temporary: Path, mark: str) -> Iterator[str]:
    """Yield what was left behind: half-written files, temporary ones, processes."""
    for folder in folders:
        yield from (f"{path}: left behind" for path in folder.rglob(".*"))
    yield from (f"{path}: left behind" for path in temporary.iterdir())
    yield from (f"process {pid}: left behind" for pid in marked(mark))


def memory(ledger: Ledger, episodes: int) -> dict[str, dict[str, float | None]]:
    """Return what the command and its workers held (MB): at first, at last, at most, and growth.

    At first and at last are those of the quiet part, where the same processes lived all the time;
    the most is of the whole soak. Growth is the slope over a thousand episodes (Theil and Sen: the
    median of all, which no single step upwards in the largest field changes), for the workers of
    the mean of those that were there; None where there were fewer than ``ENOUGH``.
    """
    quiet = list(quiet_samples(ledger, episodes)) or ledger.samples
    told = {
        "command": (
            [one["command"] for one in quiet],
            [one["command"] for one in ledger.samples],
        ),
        "workers": (
            [float(np.mean([*one["workers"].values()])) for one in quiet],
            [value for one in ledger.samples for value in one["workers"].values()],
        ),
    }
    rows = [one["rows"] for one in quiet]
    return {name: _summed_up(rows, during, always) for name, (during, always) in told.items()}


def _summed_up(
    rows: Sequence[int], during: Sequence[float], always: Sequence[float]
) -> dict[str, float | None]:
    slope = None
    if rows[-1] - rows[0] >= ENOUGH:
        slope = round(float(theilslopes(during, rows).slope) * 1000.0, 1)
    first, last, most = (round(value, 1) for value in (during[0], during[-1], max(always)))
    return {"first": first, "last": last, "most": most, "growth": slope}
