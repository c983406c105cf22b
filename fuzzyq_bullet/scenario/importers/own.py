"""The project's own scenario files, read to be written out in full."""

from __future__ import annotations

from pathlib import Path

from fuzzyq_bullet.scenario.files import load_scenario
from fuzzyq_bullet.scenario.importers.registry import register_importer
from fuzzyq_bullet.scenario.models import Scenario


@register_importer(".yaml", ".yml", ".json")
def own_scenario(path: Path) -> Scenario:
    """Read the project's own scenario file; what it leaves out is written out."""
    return load_scenario(path, policies=False)
