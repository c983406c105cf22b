"""A worker process: orders in on its standard input, answers out, one JSON line each.

Started by ``workers.pool`` with ``COMMAND``. It may crash, hang or run out of memory: whoever
started it sees that, and starts another.
"""

from __future__ import annotations

import json
import os
import signal
import sys
from collections.abc import Callable
from typing import Any

from fuzzyq_bullet.files import own_parts, remove_temporary
from fuzzyq_bullet.platforms import end_with

try:
    import resource
except ImportError:  # Windows, where no memory limit is kept
    resource = None  # type: ignore[assignment]

COMMAND = (
    "import json, sys; sys.path[:] = json.loads(sys.argv[1]); "
    "from fuzzyq_bullet.workers.process import main; main(json.loads(sys.argv[2]))"
)
"""For ``python -I -c``, which lets no folder that happens to be current shadow a module."""

GRACE = 30
"""Time (s) behind its limit at which a worker ends itself, when nobody did."""
RETIRE_AT = 0.5
"""Share of the memory it may use at which a worker makes way for a fresh one.

So what one order left behind is never blamed on the next.
"""


def main(settings: dict[str, Any]) -> None:
    """Do what is ordered until the standard input ends.

    Args:
        settings: ``plugins``: modules to import first; ``module``: another, which holds what will
            be called; ``memory_mb``: most memory (MB, 2²⁰ bytes); ``parent``: the process without
            which this one has no purpose; ``name``: what marks the files that it has half written.
    """
    # What planners and libraries print must not get between the answers.
    answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
    os.dup2(2, 1)
    end_with(settings["parent"], lambda: remove_temporary(settings["name"]))
    # No terminal's Ctrl-C comes here, so a KeyboardInterrupt is always a planner's own.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    limit = int(settings["memory_mb"]) * 2**20
    if resource is not None:
        resource.setrlimit(resource.RLIMIT_DATA, (limit, limit))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))

    def answer(**told: Any) -> None:
        try:
            answers.write(json.dumps(told) + "\n")
            answers.flush()
        except BrokenPipeError:  # whoever asked is gone
            os._exit(1)

    from importlib import import_module

    from fuzzyq_bullet.errors import MachineError, UserError
    from fuzzyq_bullet.plugins import load_plugins

    own_parts(settings["name"])
    try:
        load_plugins(settings["plugins"])
    except UserError as error:
        answer(unable=list(error.problems))
        return
    # Before any clock runs: the physics, and whatever else is needed.
    import_module("fuzzyq_bullet.episode")
    import_module(settings["module"])

    answer(ready=True)
    for line in sys.stdin:
        order = json.loads(line)
        function: Callable[[Any], Any] = getattr(import_module(order["module"]), order["function"])
        _end_within(int(order["timeout"]) + GRACE)
        try:
            told = {"value": function(order["argument"])}
        except MachineError as error:  # whatever else is ordered would fail too
            answer(unable=list(error.problems))
            return
        except UserError as error:
            told = {"failed": list(error.problems)}
        except MemoryError:
            told = {"failed": ["out of memory"]}
        answer(**told, retire=_resident() > RETIRE_AT * limit, order=order["order"])
        _end_within(0)


def _end_within(seconds: int) -> None:
    """Let the kernel end this process, which no hang in a library can keep from it; 0 for never."""
    if hasattr(signal, "alarm"):
        signal.signal(signal.SIGALRM, signal.SIG_DFL)
        signal.alarm(seconds)


def _resident() -> int:
    """Return the memory that this process holds now (bytes)."""
    try:
        with open("/proc/self/statm", encoding="ascii") as file:  # noqa: PTH123
            return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")
    except OSError:
        return 0
