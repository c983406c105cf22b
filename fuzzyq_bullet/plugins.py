"""Modules of the user's own, imported before anything runs: what registers their planners."""

from __future__ import annotations

import hashlib
import importlib
import importlib.util
import os
import signal
import sys
from collections.abc import Sequence
from contextlib import redirect_stdout
from pathlib import Path
from types import ModuleType

from fuzzyq_bullet.errors import Stopped, UserError
from fuzzyq_bullet.wording import error_in_words


def load_plugins(names: Sequence[str]) -> None:
    """Import modules, by name or by the path of a ``.py`` file.

    What they print meanwhile goes to stderr: stdout is for results.

    Raises:
        UserError: If one is not there, or fails or exits while it is imported.
    """
    for name in names:
        with redirect_stdout(sys.stderr):
            _load(name)


def _load(name: str) -> None:
    if name.endswith(".py") and not os.path.isfile(name):  # noqa: PTH113 - a long name is no error
        raise UserError(f"--plugin: {name}: there is no such file")
    try:
        if name.endswith(".py"):
            _load_file(Path(name))
        else:
            _add_folder(Path())  # which the command has not on its path, as python -m has
            importlib.import_module(name)
    except KeyboardInterrupt as error:  # a person's, or that of the module
        if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
            raise
        raise UserError(f"--plugin: {name} cannot be imported: KeyboardInterrupt") from error
    except SystemExit as error:
        raise UserError(f"--plugin: {name} cannot be imported: it tried to exit") from error
    except Stopped:
        raise
    except BaseException as error:  # whatever a user's module raises
        raise UserError(f"--plugin: {name} cannot be imported: {error_in_words(error)}") from error


def _load_file(path: Path) -> None:
    name = _module_name(path)
    if name in sys.modules:  # imported before, perhaps by another path
        return
    spec = importlib.util.spec_from_file_location(name, path)
    if spec is None or spec.loader is None:
        raise ImportError("it is no Python file")
    _add_folder(path.parent)  # for what lies beside it
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    try:
        spec.loader.exec_module(module)
    except BaseException:
        del sys.modules[name]
        raise


def _module_name(path: Path) -> str:
    """Return what a file is called as a module: by its own name, if nothing else has that.

    So it can be imported by others beside it, and takes the place of no module that is there.
    """
    if _is_of(sys.modules.get(path.stem), path):
        return path.stem
    taken = path.stem in sys.modules or path.stem in sys.stdlib_module_names
    if not taken and path.stem.isidentifier():
        spec = importlib.util.find_spec(path.stem)
        # In a worker its folder is on the path already, and it must be the same module there.
        if spec is None or (spec.origin and Path(spec.origin).resolve() == path.resolve()):
            return path.stem
    where = hashlib.sha256(str(path.resolve()).encode()).hexdigest()[:8]
    return f"fuzzyq_plugin_{where}_{path.stem}"


def _is_of(module: ModuleType | None, path: Path) -> bool:
    known = getattr(module, "__file__", None)
    return bool(known) and Path(str(known)).resolve() == path.resolve()


def _add_folder(folder: Path) -> None:
    """Make what lies in a folder importable, behind all else: it shadows nothing."""
    entry = str(folder.resolve())
    if entry not in sys.path:
        sys.path.append(entry)
