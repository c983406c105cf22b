"""Modules of the user's own, imported before anything runs: what registers their planners."""

from __future__ import annotations

import importlib
import importlib.util
import sys
from collections.abc import Sequence
from pathlib import Path

from fuzzyq_bullet.errors import UserError


def load_plugins(names: Sequence[str]) -> None:
    """Import modules, by name or by the path of a ``.py`` file.

    Raises:
        UserError: If one is not there, or fails while it is imported.
    """
    for name in names:
        _load(name)


def _load(name: str) -> None:
    try:
        if name.endswith(".py"):
            _load_file(Path(name))
        else:
            _add_folder(Path())  # which the command has not on its path, as python -m has
            importlib.import_module(name)
    except Exception as error:  # whatever a user's module raises
        reason = f"{type(error).__name__}: {' '.join(str(error).split())}"
        raise UserError(f"--plugin: {name} cannot be imported: {reason}") from error


def _load_file(path: Path) -> None:
    if path.stem in sys.modules:  # imported before, perhaps by another name
        known = getattr(sys.modules[path.stem], "__file__", None)
        if known and Path(known).resolve() == path.resolve():
            return
    spec = importlib.util.spec_from_file_location(path.stem, path)
    if spec is None or spec.loader is None or not path.is_file():
        raise FileNotFoundError("there is no such file")
    _add_folder(path.parent)  # for what lies beside it
    module = importlib.util.module_from_spec(spec)
    sys.modules[path.stem] = module
    try:
        spec.loader.exec_module(module)
    except BaseException:
        del sys.modules[path.stem]
        raise


def _add_folder(folder: Path) -> None:
    """Make what lies in a folder importable, behind all else: it shadows nothing."""
    entry = str(folder.resolve())
    if entry not in sys.path:
        sys.path.append(entry)
