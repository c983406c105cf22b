"""What a file of this project is, where one of another kind belongs, and what it is for."""

from __future__ import annotations

import os
from collections.abc import Collection
from dataclasses import dataclass
from pathlib import Path

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.reading.yaml_tree import read_tree

SCENARIO, RULES, POLICY = "a scenario", "a file of rules", "a policy"

_TEXT_BYTES = 2_000_000
"""Larger files of keys are not looked into."""
_BEGINNINGS = (
    (4, b"ftyp", "a video"),
    (0, b"GIF8", "a video"),
    (0, b"\x89PNG", "a picture"),
)
"""How files of bytes begin, and where (bytes)."""


@dataclass(frozen=True)
class _Kind:
    """A kind of file that has keys.

    Attributes:
        what: What it is called.
        keys: Keys that it has, and no other kind has together.
        use: What to do with one; ``{0}`` stands for its path.
    """

    what: str
    keys: frozenset[str]
    use: str = ""


_USE_RULES = "name it in a scenario: planner: {{name: improved-fuzzy, rules: {0}}}"
_KINDS = (
    _Kind(SCENARIO, frozenset({"start", "goal"}), "fuzzyq run {0} drives it"),
    _Kind(RULES, frozenset({"inputs", "outputs", "rules"}), _USE_RULES),
    _Kind("the result of a run", frozenset({"scenario", "outcome", "digest"})),
    _Kind(
        POLICY,
        frozenset({"planner", "learner", "states", "actions"}),
        "name it in a scenario: planner: {{name: PLANNER, policy: {0}}}",
    ),
)
_SUFFIXES = {
    ".npz": ("a record", "fuzzyq replay {0} films it"),
    **dict.fromkeys((".fll", ".fis"), (RULES, _USE_RULES)),
}
"""What files of a suffix are, none of them a scenario, and what to do with one."""


def refuse_other_suffix(path: Path) -> None:
    """Make sure that a file that is no scenario is none of another kind, by its suffix.

    Raises:
        UserError: If it is, with what to do with it.
    """
    if (found := _SUFFIXES.get(path.suffix.lower())) is not None:
        what, use = found
        raise UserError(f"{path}: is {what}, not {SCENARIO}; {use.format(path)}")


def refuse_other_kind(where: str, keys: Collection[str], wanted: str) -> None:
    """Make sure that a file is not one of another kind, by its keys.

    Args:
        where: Its path.
        keys: The keys that it has.
        wanted: What it should be, one of the constants above.

    Raises:
        UserError: If it is, with what to do with it; one line instead of one for each key.
    """
    for kind in _KINDS:
        if kind.keys <= set(keys) and kind.what != wanted:
            use = f"; {kind.use.format(where)}" if kind.use else ""
            raise UserError(f"{where}: is {kind.what}, not {wanted}{use}")


def not_a_record(path: Path, content: bytes) -> str:
    """Return what a file is that was given as the record of a run, and which is its record.

    Args:
        path: Its path.
        content: What it holds.

    Returns:
        One line, without the path; empty if it is of no kind that is known.
    """
    for place, mark, what in _BEGINNINGS:
        if content[place:].startswith(mark):
            return f"is {what}, not a record (.npz)" + _hint(_beside(path))
    try:
        text = content[: _TEXT_BYTES + 1].decode("utf-8-sig")
        data = read_tree(text, str(path)).data if len(content) <= _TEXT_BYTES else {}
    except (UnicodeDecodeError, UserError):
        return ""
    keys = set(data) if isinstance(data, dict) else set()
    for kind in _KINDS:
        if not kind.keys <= keys:
            continue
        record, use = _beside(path), ""
        if kind.what == SCENARIO:
            record = _there(Path("out") / f"{data.get('name', path.stem)}.npz")
            use = f"; fuzzyq run {path} makes one"
        return f"is {kind.what}, not a record (.npz)" + (_hint(record) or use)
    return ""


def _hint(record: Path | None) -> str:
    return "" if record is None else f"; its record is {record}"


def _beside(path: Path) -> Path | None:
    """Return the record of whose name that of a film or result is, or begins with."""
    words = path.stem.split("-")
    names = ("-".join(words[:count]) for count in range(len(words), 0, -1))
    return next(filter(None, (_there(path.with_name(f"{name}.npz")) for name in names)), None)


def _there(path: Path) -> Path | None:
    return path if os.path.isfile(path) else None  # noqa: PTH113 - a long name is no error
