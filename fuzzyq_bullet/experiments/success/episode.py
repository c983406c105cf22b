"""What a worker does in sweeps that keep rows alone."""

from __future__ import annotations

from fuzzyq_bullet.experiments.sweep.episode import Done, run_job
from fuzzyq_bullet.experiments.sweep.jobs import Job


def run_row(job: Job) -> Done:
    """Run one episode and leave its record behind: whole planners fail here by the thousand.

    Its row has the seed, and the digest to know it by: it can be run again.
    """
    return Done(run_job(job).row)
