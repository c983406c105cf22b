"""The command that drives a checked scenario again."""

from __future__ import annotations

import shlex
from collections.abc import Sequence

from fuzzyq_bullet.checks.verdict import Job
from fuzzyq_bullet.workers.pool import MEMORY_MB, TIMEOUT


def replay_command(job: Job, plugins: Sequence[str] = ()) -> str:
    """Return a line for the shell, which also leaves a film.

    Args:
        job: What was driven.
        plugins: Modules it needs.
    """
    return shlex.join(["fuzzyq", "run", *_words(job, plugins)])


def check_command(
    job: Job,
    plugins: Sequence[str] = (),
    *,
    timeout: float = TIMEOUT,
    memory_mb: int = MEMORY_MB,
) -> str:
    """Return a line for the shell that does it again within bounds, for what crashes or hangs.

    Args:
        job: What was driven.
        plugins: Modules it needs.
        timeout: Wall-clock time (s) that it had.
        memory_mb: Memory (MB) that it had.
    """
    words = ["fuzzyq", "check", *_words(job, plugins)]
    if timeout != TIMEOUT:
        words += ["--timeout", f"{timeout:g}"]
    if memory_mb != MEMORY_MB:
        words += ["--memory", str(memory_mb)]
    return shlex.join(words)


def _words(job: Job, plugins: Sequence[str]) -> list[str]:
    words = [f"./{job.file}" if job.file.startswith("-") else job.file]
    for plugin in plugins:
        words += ["--plugin", plugin]
    for option in ("planner", "seed", "drive"):
        value = getattr(job, option)
        if value is not None:
            words += [f"--{option}", str(value)]
    return words
