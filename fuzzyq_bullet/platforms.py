"""What differs between the systems and Pythons that the package runs on."""

from __future__ import annotations

import os
from contextlib import suppress
from importlib.metadata import PackageNotFoundError, version


def cores() -> int:
    """Return how many processor cores this process may use."""
    if hasattr(os, "sched_getaffinity"):  # Linux
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def pybullet_in_words() -> str:
    """Return the distribution that PyBullet comes from here, and its version."""
    for package in ("pybullet", "pybullet-arm64"):
        with suppress(PackageNotFoundError):
            return f"{package} {version(package)}"
    return "pybullet"
