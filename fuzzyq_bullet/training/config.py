"""What a user asks to be trained: who learns, for how long, on what, and how.

As a program it prints, for ``make policies``, the commands that make the shipped policies.
"""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from dataclasses import dataclass
from typing import get_args

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.fuzzy import ControllerDefinition, load_controller
from fuzzyq_bullet.learning.policy import MAX_WORDS
from fuzzyq_bullet.learning.training import MAX_EPISODES
from fuzzyq_bullet.planning import planner_names, settings_for
from fuzzyq_bullet.scenario import load_scenario, realise
from fuzzyq_bullet.scenario.fields import refuse_via
from fuzzyq_bullet.scenario.models import Drive
from fuzzyq_bullet.training.field import FieldTask
from fuzzyq_bullet.training.options import AS_USUAL, LearningOptions
from fuzzyq_bullet.training.registry import RECIPES, Recipe, recipe_of, refuse_unfit
from fuzzyq_bullet.training.tasks import MOST_SEED, Tasks
from fuzzyq_bullet.wording import did_you_mean, not_one_of, shorten

USUAL_EPISODES = 200
"""Episodes of a training, unless more or fewer are asked for, as in the paper."""


@dataclass(frozen=True, slots=True)
class TrainingConfig:
    """Everything that the result of a training depends on, except the version.

    Attributes:
        planner: Name of the planner that learns.
        episodes: Number of episodes.
        drive: What moves the robot.
        seed: Seed of all random numbers.
        scenario: Path or name of the scenario to learn on; None for random scenarios.
        options: What it does otherwise than the planner usually learns.
        plugins: Modules of the user's own that it needs.
        rules: File of the rules that it learns to weigh; None for Table 4.
    """

    planner: str
    episodes: int = USUAL_EPISODES
    drive: Drive = "kinematic"
    seed: int = 0
    scenario: str | None = None
    options: LearningOptions = AS_USUAL
    plugins: tuple[str, ...] = ()
    rules: str | None = None

    @property
    def recipe(self) -> Recipe:
        """How the planner learns, with these rules."""
        recipe, definition = recipe_of(self.planner), self.definition
        if definition is None or recipe.with_rules is None:
            return recipe
        return recipe.with_rules(definition)

    @property
    def definition(self) -> ControllerDefinition | None:
        """The rules of the user's own.

        Raises:
            UserError: If they cannot be used.
        """
        return None if self.rules is None else load_controller(self.rules)

    @property
    def command(self) -> str:
        """The command that does it, with every option written out.

        The output path is not in it: the same training gives the same file everywhere.
        """
        parts = ["fuzzyq", "train", self.planner, "--episodes", str(self.episodes)]
        parts += ["--drive", self.drive, "--seed", str(self.seed)]
        if self.scenario is not None:
            parts += ["--scenario", self.scenario]
        if self.rules is not None:
            parts += ["--rules", self.rules]
        parts += self.options.words()
        return shlex.join([*parts, *(word for name in self.plugins for word in ("--plugin", name))])


SHIPPED = {
    config.planner: config
    for config in (
        TrainingConfig("q-learning", episodes=200, drive="kinematic", seed=0),
        TrainingConfig("q-lambda", episodes=200, drive="kinematic", seed=0),
        TrainingConfig("fuzzy-q-lambda", episodes=480, drive="wheels", seed=1),
    )
}
"""How each policy in ``assets/policies`` is made, by planner."""


def config_for(
    planner: str,
    episodes: int | None,
    drive: str | None,
    seed: int | None,
    scenario: str | None,
    options: LearningOptions = AS_USUAL,
    plugins: Sequence[str] = (),
    rules: str | None = None,
) -> TrainingConfig:
    """Return what is asked for by the options of a command.

    Args:
        planner: Who learns.
        episodes: Of the training; None for as many as it usually takes.
        drive: What moves the robot; None for kinematic, or to learn a field that of the scenario.
        seed: Of the training; to learn a field, where its random obstacles lie. None for 0, or to
            learn a field that of the scenario.
        scenario: What it learns on; None for random fields.
        options: How.
        plugins: Modules of the user's own that it needs.
        rules: File of the rules that it learns to weigh.

    Raises:
        UserError: If any of it is not allowed; names the option.
    """
    if planner not in RECIPES:
        known = planner in planner_names()
        what = f"{planner} does not learn" if known else f"no planner {shorten(planner)}"
        hint = "" if known else did_you_mean(planner, RECIPES)
        raise UserError(f"PLANNER: {what}; {hint}those that learn: {', '.join(RECIPES)}")
    recipe = RECIPES[planner]
    if rules is not None:
        if recipe.with_rules is None:
            raise UserError(f"--rules: {planner} has no rules")
        recipe.with_rules(load_controller(rules))
    field = None
    if scenario is not None and recipe.in_field is not None:
        field = load_scenario(scenario, policies=False)
    if episodes is None:
        episodes = USUAL_EPISODES if field is None else recipe.of_field.runs
    if drive is None:
        drive = "kinematic" if field is None else field.drive
    if seed is None:
        seed = 0 if field is None else field.seed
    if not 1 <= episodes <= MAX_EPISODES:
        raise UserError(f"--episodes: must be from 1 to {MAX_EPISODES}, got {episodes}")
    most = MOST_SEED if field is None else 2**63 - 1  # a scenario's own
    if not 0 <= seed <= most:
        raise UserError(f"--seed: must be from 0 to {most}, got {seed}")
    refuse_unfit(recipe, options, in_field=field is not None)
    drives: tuple[Drive, ...] = get_args(Drive)
    for known_drive in drives:
        if drive == known_drive:
            config = TrainingConfig(
                planner, episodes, known_drive, seed, scenario, options, tuple(plugins), rules
            )
            break
    else:
        raise UserError(f"--drive: {not_one_of('drive', drive, sorted(drives))}")
    if len(config.command.encode("utf-8", "backslashreplace")) > MAX_WORDS:
        raise UserError(
            "--scenario, --rules, --plugin: their paths are too long for the policy to hold: "
            f"{shorten(config.command)}"
        )
    return config


def tasks_for(config: TrainingConfig) -> Tasks | FieldTask:
    """Return what is learned on.

    Raises:
        UserError: If the scenario is wrong.
    """
    recipe = config.recipe
    if config.scenario is None:
        return recipe.tasks(config.drive, config.seed)
    asked = load_scenario(config.scenario, policies=False)
    # The planner that learns takes the place of the scenario's own, of which only the rules are
    # used.
    own = config.definition or getattr(asked.planner, "rules", None)
    given = {"rules": own} if recipe.with_rules and isinstance(own, ControllerDefinition) else {}
    settings = settings_for(config.planner).model_validate({"name": config.planner, **given})
    refuse_via(asked, "a training knows the way to the goal alone")
    asked = asked.model_copy(update={"planner": settings})
    if recipe.in_field is not None:
        field = realise(asked, config.seed)
        return FieldTask(field.model_copy(update={"drive": config.drive}))
    realise(asked)  # now rather than in an episode, should its obstacles find no place
    return recipe.tasks(config.drive, config.seed, asked)


if __name__ == "__main__":
    for shipped in SHIPPED.values():
        print(shipped.command)
