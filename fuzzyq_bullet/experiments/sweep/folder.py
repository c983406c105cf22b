"""The folder of a sweep: it remembers the settings it was made with and refuses any others."""

from __future__ import annotations

import json
import os
import re
import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.files import read_bytes, writable_folder, write_text, written_beside

MAX_SETTINGS = 10_000_000
"""Largest file of settings that is read (bytes)."""
_ABSENT = "nothing"


class Folder:
    """Where a sweep keeps its settings, its journal, its records and its table.

    Attributes:
        path: The folder.
        journal: Path of the rows as they come.
        records: Folder of the records kept.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.journal = path / "journal.jsonl"
        self.records = path / "records"
        self._settings = path / "settings.json"

    def claim(self, settings: Mapping[str, Any]) -> None:
        """Make the folder one for a sweep of these settings, or make sure that it is.

        Args:
            settings: All that the rows depend on, as JSON can say it.

        Raises:
            UserError: If it was made with other settings, or cannot be written to.
        """
        wanted = json.loads(json.dumps(settings))
        writable_folder(self.path)
        before = self._read()
        if before is None:
            if self.journal.exists():
                raise UserError(
                    f"{self._settings}: is gone, and {self.journal.name} is of no use alone"
                )
            write_text(self._settings, json.dumps(wanted, indent=2) + "\n")
        elif before != wanted:
            told = "; ".join(_differences(before, wanted))
            raise UserError(
                f"{self.path}: holds a sweep with other settings: {told}; use another --out"
            )
        writable_folder(self.records)

    def tidy(self) -> None:
        """Remove what a sweep left half-written here when it was killed; none may be at work.

        Nothing else: others keep files here too, and other commands may be writing theirs.
        """
        for folder, name in (
            (self.path, r"settings\.json|[a-z]+\.csv"),
            (self.records, r".+\.npz"),
        ):
            ours = re.compile(rf"\.({name})\.[0-9a-f]{{8}}\.part")
            for left in folder.iterdir():
                if ours.fullmatch(left.name) and left.is_dir() and not left.is_symlink():
                    shutil.rmtree(left, ignore_errors=True)

    def keep(self, name: str, record: bytes) -> None:
        """Keep a record (``.npz``).

        Raises:
            UserError: If it cannot be written.
        """
        with written_beside(self.records / f"{name}.npz") as part:
            part.write_bytes(record)

    def _read(self) -> dict[str, Any] | None:
        if not os.path.lexists(self._settings):
            return None
        content = read_bytes(self._settings, what="the settings of a sweep", most=MAX_SETTINGS)
        try:
            known = json.loads(content)
        except (ValueError, RecursionError):
            known = None
        if not isinstance(known, dict):
            raise UserError(f"{self._settings}: is damaged; use another --out")
        return known


def _differences(before: Mapping[str, Any], wanted: Mapping[str, Any], at: str = "") -> list[str]:
    """Say which settings differ, in the order in which they are asked for; inner ones by a dot."""
    told = []
    for key in [*wanted, *(key for key in before if key not in wanted)]:
        old, new = before.get(key, _ABSENT), wanted.get(key, _ABSENT)
        if isinstance(old, Mapping) and isinstance(new, Mapping):
            told += _differences(old, new, f"{at}{key}.")
        elif old != new:
            told.append(f"{at}{key} {_shown(old)}, asked for {_shown(new)}")
    return told


def _shown(value: Any) -> str:
    if isinstance(value, Mapping):  # all that is in it would hide what differs
        return "something"
    return value if isinstance(value, str) else json.dumps(value)
