"""Importers: maps of other programs made into scenarios, chosen by suffix and content.

An importer of your own is one function with ``register_importer`` in a file that ``--plugin``
names; ``examples/extend/importer.py`` is one. Those of the package are modules here: each returns
a ``ForeignMap``, and ``import_map`` makes the scenario of it.
"""

from fuzzyq_bullet.scenario.importers import (
    gazebo,
    images,
    irsim,
    movingai,
    own,
    ros_map,
)
from fuzzyq_bullet.scenario.importers.foreign import ForeignMap, ImportOptions, options_of
from fuzzyq_bullet.scenario.importers.registry import (
    Imported,
    Importer,
    import_map,
    importable,
    register_importer,
)

__all__ = [
    "ForeignMap",
    "ImportOptions",
    "Imported",
    "Importer",
    "gazebo",
    "images",
    "import_map",
    "importable",
    "irsim",
    "movingai",
    "options_of",
    "own",
    "register_importer",
    "ros_map",
]
