"""The command that drives a checked scenario again."""

from __future__ import annotations

import shlex
from collections.abc import Sequence

from fuzzyq_bullet.checks.verdict import Job


def replay_command(job: Job, plugins: Sequence[str] = ()) -> str:
    """Return a line for the shell.

    Args:
        job: What was driven.
        plugins: Modules it needs. Only ``fuzzyq check`` loads them; without any, ``fuzzyq run``
            shows more of what happens.
    """
    words = ["fuzzyq", "check" if plugins else "run", job.file]
    for plugin in plugins:
        words += ["--plugin", plugin]
    for option in ("planner", "seed", "drive"):
        value = getattr(job, option)
        if value is not None:
            words += [f"--{option}", str(value)]
    if plugins:
        words += ["--video", "all"]
    return shlex.join(words)
