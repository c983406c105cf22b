"""Where bundled files lie: beside the package in a checkout, inside it in a wheel."""

from __future__ import annotations

from pathlib import Path

_PACKAGE = Path(__file__).resolve().parent


def data_folder(name: str) -> Path:
    """Return the bundled folder ``assets`` or ``scenarios``.

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
