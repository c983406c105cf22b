"""The configuration of a training, and the command that does it again.

As a program it prints, for ``make policies``, the commands that make the shipped policies.
"""

from __future__ import annotations

import shlex
from dataclasses import dataclass

from fuzzyq_bullet.scenario.models import Drive


@dataclass(frozen=True, slots=True)
class TrainingConfig:
    """Everything that the result of a training depends on, except the version.

    Attributes:
        planner: Name of the planner that learns.
        episodes: Number of episodes.
        drive: What moves the robot.
        seed: Seed of all random numbers.
        scenario: Path or name of the scenario to learn on; None for random scenarios.
    """

    planner: str
    episodes: int = 200
    drive: Drive = "kinematic"
    seed: int = 0
    scenario: str | None = None

    @property
    def command(self) -> str:
        """The command that does it, with every option written out.

        The output path is not in it: the same training gives the same file everywhere.
        """
        parts = ["fuzzyq", "train", self.planner, "--episodes", str(self.episodes)]
        parts += ["--drive", self.drive, "--seed", str(self.seed)]
        if self.scenario is not None:
            parts += ["--scenario", self.scenario]
        return shlex.join(parts)


SHIPPED = {
    config.planner: config
    for config in (
        TrainingConfig("q-learning", episodes=200, drive="kinematic", seed=0),
        TrainingConfig("q-lambda", episodes=200, drive="kinematic", seed=0),
        TrainingConfig("fuzzy-q-lambda", episodes=1500, drive="wheels", seed=1),
    )
}
"""How each policy in ``assets/policies`` is made, by planner."""

if __name__ == "__main__":
    for config in SHIPPED.values():
        print(config.command)
