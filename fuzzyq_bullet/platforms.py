"""What differs between the systems and Pythons that the package runs on."""

from __future__ import annotations

import os
import threading
import time
from contextlib import suppress


def cores() -> int:
    """Return how many processor cores this process may use."""
    if hasattr(os, "sched_getaffinity"):  # Linux
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def pybullet_in_words() -> str:
    """Return the distribution that PyBullet comes from here, and its version."""
    from importlib.metadata import PackageNotFoundError, version  # which takes long to load

    for package in ("pybullet", "pybullet-arm64"):
        with suppress(PackageNotFoundError):
            return f"{package} {version(package)}"
    return "pybullet"


def end_with(parent: int) -> None:
    """End this process when its parent ends, even by ``kill -9``."""

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(0.5)
        os._exit(1)

    threading.Thread(target=watch, name="watch-parent", daemon=True).start()
