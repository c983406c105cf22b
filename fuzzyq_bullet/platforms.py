"""What differs between the installations, systems and Pythons that the package runs in."""

from __future__ import annotations

import os
import threading
import time
from contextlib import suppress
from pathlib import Path

_PACKAGE = Path(__file__).resolve().parent


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


def data_folder(name: str) -> Path:
    """Return the bundled folder ``assets`` or ``scenarios``.

    It lies beside the package in a checkout, inside it in a wheel.

    Raises:
        FileNotFoundError: If the installation carries neither place.
    """
    for root in (_PACKAGE / "_data", _PACKAGE.parent):
        if (root / name).is_dir():
            return root / name
    raise FileNotFoundError(f"the installation lacks its folder {name!r}; install it again")


def asset(name: str) -> Path:
    """Return the path of one bundled asset, such as ``robot.urdf``."""
    return data_folder("assets") / name
