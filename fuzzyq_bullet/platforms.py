"""What differs between the installations, systems and Pythons that the package runs in."""

from __future__ import annotations

import os
import sys
import threading
import time
from collections.abc import Callable
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


def no_screen() -> str:
    """Return why no window can be opened here, in a few words; empty if nothing speaks against it.

    PyBullet ends the process where it cannot open its window, so this must be known before. It
    needs an X server with OpenGL; other systems than Linux are taken to have a screen.
    """
    import ctypes  # which nothing else needs

    if not sys.platform.startswith("linux"):
        return ""
    name = os.environ.get("DISPLAY", "")
    if not name:
        return "the variable DISPLAY is not set"
    try:
        x11 = ctypes.CDLL("libX11.so.6")
        ctypes.CDLL("libGL.so.1")
    except OSError as error:
        return f"a library is missing ({str(error).partition(':')[0]})"
    x11.XOpenDisplay.restype = ctypes.c_void_p
    display = ctypes.c_void_p(x11.XOpenDisplay(name.encode()))
    if not display:
        return f"there is no X server at DISPLAY={name}"
    # It stays open: a server that its last client leaves starts anew, and lets nobody in meanwhile.
    unused = ctypes.byref(ctypes.c_int())
    has_opengl = x11.XQueryExtension(display, b"GLX", unused, unused, unused)
    return "" if has_opengl else f"the X server at DISPLAY={name} has no OpenGL"


def end_with(parent: int, last: Callable[[], None] = lambda: None) -> None:
    """End this process when its parent ends, even by ``kill -9``.

    Args:
        parent: Its parent.
        last: Called before that.
    """

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(0.5)
        try:
            last()
        finally:
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
