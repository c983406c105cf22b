"""Worker processes that may die: what happens in one of them is told, and the others go on.

Whatever is spread over processes goes through a ``Pool``: the scenarios of a check, the episodes of
a sweep, the films of a report. ``WorkerPool`` has processes of this machine, ``DaskPool`` those of
a cluster. What is asked and answered is JSON: no class must have the same name on both sides.
"""

from fuzzyq_bullet.workers.pool import Answer, Pool, WorkerPool

__all__ = ["Answer", "Pool", "WorkerPool"]
