"""One thing that was found out about a scenario."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

from fuzzyq_bullet.reading.problems import Loc

Kind: TypeAlias = Literal["sight", "turn", "reach", "luck", "limit"]


@dataclass(frozen=True, slots=True)
class Finding:
    """One finding.

    Attributes:
        kind: ``sight`` (rays and solids differ), ``turn`` (no room to turn in the start), ``reach``
            (no way), ``luck`` (a gap as wide as the robot), ``limit`` (what was not looked at).
        loc: The keys that lead to it in the scenario.
        message: What it is, where and by how much.
        wrong: Whether the scenario is not sound because of it; else it is a note.
    """

    kind: Kind
    loc: Loc
    message: str
    wrong: bool = True
