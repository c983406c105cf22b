"""The studies below a folder, read back from what their sweeps wrote, finished or not."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from pydantic import ValidationError

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.files import read_bytes
from fuzzyq_bullet.studies.episodes import OF_MACHINE, Row, from_csv
from fuzzyq_bullet.studies.registry import study_names, study_of
from fuzzyq_bullet.studies.storage import MAX_BYTES, rows_in, settings_in
from fuzzyq_bullet.studies.study import Study, Swept
from fuzzyq_bullet.wording import shorten

_DEPTH = 3
"""Folders below the one given that are looked into: room for ``paper/steps/table`` in ``out``."""


@dataclass(frozen=True)
class Found:
    """What there is of one call of ``fuzzyq bench``.

    Attributes:
        folder: Where it lies.
        kind: The study's class.
        results: Its sweeps, by stage.
        study: The study itself; None while the sweep that it is about has not begun.
    """

    folder: Path
    kind: type[Study]
    results: dict[str, Swept]
    study: Study | None


def studies_below(folder: Path) -> list[Found]:
    """Return all studies in a folder, which may be that of one sweep itself.

    Returns:
        The studies in the order of their registry, those of one kind by their paths.

    Raises:
        UserError: If there is none, or one is damaged or cannot be read.
    """
    try:
        if not folder.is_dir():
            raise UserError(f"{folder}: no such folder; give one that holds sweeps")
        found: dict[tuple[str, Path], dict[str, Swept]] = {}
        for place in _folders(folder, _DEPTH):
            if (one := _read(place)) is not None:
                name, stage, swept = one
                home = place.parent if stage in study_of(name).folders else place
                found.setdefault((name, home), {})[stage] = swept
    except OSError as error:
        raise UserError(
            f"{error.filename or folder}: cannot be read: {error.strerror or error}"
        ) from error
    if not found:
        raise UserError(
            f"{folder}: holds no sweep; make one: fuzzyq bench success --out {folder / 'success'}"
        )
    order = study_names()
    return [
        _recalled(home, study_of(name), results)
        for (name, home), results in sorted(
            found.items(), key=lambda one: (order.index(one[0][0]), one[0][1])
        )
    ]


def _recalled(home: Path, kind: type[Study], results: dict[str, Swept]) -> Found:
    """Return results with their study.

    Raises:
        UserError: If their settings are none that it would have had.
    """
    in_order = {name: results[name] for name in kind.stage_kinds() if name in results}
    try:
        study = kind.recalled({name: swept.plan for name, swept in in_order.items()})
    except ValidationError as error:
        *_, last = in_order.values()
        raise _damaged(last.folder / "settings.json", error) from error
    return Found(home, kind, in_order, study)


def _damaged(path: Path, error: ValidationError) -> UserError:
    first = error.errors(include_url=False)[0]
    where = ".".join(map(str, first["loc"]))
    return UserError(f"{path}: is damaged: {where}: {first['msg']}")


def _folders(folder: Path, depth: int) -> Iterator[Path]:
    yield folder
    if depth:
        for below in sorted(folder.iterdir()):
            if below.is_dir() and not below.is_symlink() and not below.name.startswith("."):
                yield from _folders(below, depth - 1)


def _read(folder: Path) -> tuple[str, str, Swept] | None:
    """Return study, stage and what came of it; None for a folder that holds no sweep."""
    path, journal = folder / "settings.json", folder / "journal.jsonl"
    if not os.path.lexists(path):
        return None
    told = settings_in(path)
    if told is None:
        if journal.exists():
            raise UserError(f"{path}: is damaged: no settings of a sweep")
        return None
    name, *stages = str(told.get("sweep")).split()
    if name not in study_names():
        if "sweep" in told and journal.exists():
            raise UserError(f"{path}: no study {shorten(name)} is known; --plugin FILE adds it")
        return None
    stage = stages[0] if stages else name
    kind = study_of(name).stage_kinds().get(stage)
    if kind is None:
        return None
    try:
        plan = kind.model_validate(told)
    except ValidationError as error:
        raise _damaged(path, error) from error
    table = folder / f"{stage}.csv"
    finished = os.path.lexists(table)
    if finished:
        rows = _timed(_table(table), journal)
        if len(rows) != plan.total:
            raise UserError(
                f"{table}: is damaged: {len(rows)} rows, and {plan.total} episodes by "
                f"{path.name}; the command that made it makes it again"
            )
    else:
        rows = list({row.key: row for row in rows_in(journal)}.values()) if journal.exists() else []
    for row in rows:
        if not plan.holds(row):
            raise UserError(
                f"{table if finished else journal}: is damaged: {row.planner}, {row.drive}, "
                f"{row.layout} {row.count}, run {row.run} is no episode of this sweep"
            )
    in_order = tuple(sorted(rows, key=lambda row: row.key))
    return name, stage, Swept(plan, in_order, told, folder=folder)


def _timed(rows: list[Row], journal: Path) -> list[Row]:
    """Return rows of a table with what the journal alone has, where there is one still."""
    if not journal.exists():
        return rows
    noted = {row.key: row.model_dump(include=set(OF_MACHINE)) for row in rows_in(journal)}
    return [row.model_copy(update=noted.get(row.key, {})) for row in rows]


def _table(path: Path) -> list[Row]:
    content = read_bytes(path, what="the table of a sweep", most=MAX_BYTES)
    try:
        return from_csv(content.decode())
    except UnicodeDecodeError as error:
        raise UserError(f"{path}: is damaged: no UTF-8 text") from error
    except ValueError as error:
        raise UserError(f"{path}: is damaged: {error}") from error
