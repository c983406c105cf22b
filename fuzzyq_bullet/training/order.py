"""What a training is asked for, and what to type to have it again."""

from __future__ import annotations

import shlex
from dataclasses import dataclass

from fuzzyq_bullet.scenario.models import Drive


@dataclass(frozen=True, slots=True)
class Order:
    """All that the result of a training depends on, but for the version.

    Attributes:
        planner: Name of the planner that learns.
        episodes: For how many episodes.
        drive: What moves the robot.
        seed: Where all chance comes from.
        scenario: What it learns on: a path or the name of a bundled scenario; None for random
            fields.
    """

    planner: str
    episodes: int = 200
    drive: Drive = "kinematic"
    seed: int = 0
    scenario: str | None = None

    @property
    def command(self) -> str:
        """The command that does it, every option told, whatever was typed in fact.

        Where to write to is not in it: the same training gives the same file everywhere.
        """
        parts = ["fuzzyq", "train", self.planner, "--episodes", str(self.episodes)]
        parts += ["--drive", self.drive, "--seed", str(self.seed)]
        if self.scenario is not None:
            parts += ["--scenario", self.scenario]
        return shlex.join(parts)
