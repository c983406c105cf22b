"""The environments' ids, known to Gymnasium from the moment both packages are imported.

Importing Gymnasium takes far longer than importing this package, and most who use this package,
pytest among them, need none of it. So whoever imports Gymnasium first, or last, has the ids.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec
from importlib.util import find_spec
from types import ModuleType
from typing import Any

ENVIRONMENTS = {
    "fuzzyq_bullet/Navigation-v0": "fuzzyq_bullet.gym.navigation:NavigationEnv",
    "fuzzyq_bullet/Weights-v0": "fuzzyq_bullet.gym.weights:WeightsEnv",
}
"""The class of each environment by its id."""


def register_in(gymnasium: Any) -> None:
    """Make the environments known to Gymnasium; a second call does nothing.

    Args:
        gymnasium: The module of that name.
    """
    for name, entry_point in ENVIRONMENTS.items():
        if name not in gymnasium.registry:
            gymnasium.register(id=name, entry_point=entry_point)


def register_when_imported() -> None:
    """Make the environments known now, or as soon as Gymnasium is imported."""
    gymnasium = sys.modules.get("gymnasium")
    if hasattr(gymnasium, "registry"):
        register_in(gymnasium)
    elif not any(isinstance(finder, _Watch) for finder in sys.meta_path):
        sys.meta_path.insert(0, _Watch())


class _Watch(MetaPathFinder):
    """Notices the import of Gymnasium, which is left to whoever else finds it."""

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        if fullname != "gymnasium":
            return None
        sys.meta_path.remove(self)
        spec = find_spec(fullname)
        if spec is not None and spec.loader is not None:
            spec.loader = _Registering(spec.loader)
        return spec


class _Registering(Loader):
    """Loads Gymnasium as its own loader does, and registers the environments."""

    def __init__(self, loader: Loader) -> None:
        self._loader = loader

    def __getattr__(self, name: str) -> Any:
        return getattr(self._loader, name)  # whatever else others ask of a loader

    def create_module(self, spec: ModuleSpec) -> ModuleType | None:
        return self._loader.create_module(spec)

    def exec_module(self, module: ModuleType) -> None:
        self._loader.exec_module(module)
        register_in(module)
