"""How each planner learns: its problem, its learner and its schedules, one entry a planner."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from inspect import signature
from pathlib import Path
from typing import Any

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.fuzzy import ControllerDefinition
from fuzzyq_bullet.learning import (
    FuzzyQLambda,
    Learner,
    Policy,
    PolicySpec,
    Problem,
    QLambda,
    QLearning,
    Schedule,
    Setup,
    train,
)
from fuzzyq_bullet.learning.checkpoint import Curve
from fuzzyq_bullet.planning.controllers import controller_shown
from fuzzyq_bullet.planning.fuzzy_q_lambda import policy_spec, twins_of
from fuzzyq_bullet.planning.q_learning import POLICY_SPECS as DIRECT
from fuzzyq_bullet.planning.settings import FuzzyQLambdaSettings
from fuzzyq_bullet.scenario import Drive, Scenario
from fuzzyq_bullet.training.field import RUNS, field_setup, learn_field
from fuzzyq_bullet.training.options import AS_USUAL, LearningOptions
from fuzzyq_bullet.training.problems import DirectProblem, RuleWeightsProblem
from fuzzyq_bullet.training.tasks import COUNTS, Tasks
from fuzzyq_bullet.version import __version__

TRACE = Schedule(0.9)
"""λ of ``fuzzy-q-lambda``: what a turn leads to shows seconds later, which is ten steps."""
UNDISCOUNTED = 1.0
"""γ of ``fuzzy-q-lambda``: a second lost late is worth as much as one lost early."""
PATIENCE = 13.0
"""Steps for which a rule of ``fuzzy-q-lambda`` stands by what it tries: on wheels 4 s."""
SLOW_RATE = Schedule(0.02, 0.019)
"""η of ``fuzzy-q-lambda``: what a choice gains is so little beside chance that with Eq. 20, which
ends with the mean of the last hundred trials, nothing can be told apart."""
ALL_COUNTS = (25, 50, 75, 100, 125)
"""Numbers of obstacles that ``fuzzy-q-lambda`` learns on, taken in turn."""


@dataclass(frozen=True)
class FieldLearning:
    """How a planner learns a single field.

    Attributes:
        learn: Learns it (``training.field.learn_field``).
        setup: Builds the schedules from the number of runs and the seed.
        runs: How many, unless more or fewer are asked for.
        takes: The options of learning that it takes.
    """

    learn: Callable[..., tuple[Policy, Curve]]
    setup: Callable[[int, int], Setup]
    runs: int
    takes: tuple[str, ...]


@dataclass(frozen=True)
class Recipe:
    """How a planner learns.

    Attributes:
        planner: Its name.
        spec: What its policies look like: states, actions, learner.
        problem: Builds the learning problem from the tasks to learn it on; where a user asks for
            another than usual, also from ``reward`` (``RewardSettings``) and ``discount``, if it
            takes these.
        learner: Builds the learner; from ``discount`` too, if it takes that and a user asks for it.
        setup: Builds the schedules from the number of episodes and the seed.
        counts: Numbers of obstacles of the random scenarios.
        cellular: Whether it learns in corridors of clumped pillars too.
        in_field: How it learns a single field instead, where a scenario is given; None: as it
            learns everywhere.
        with_rules: Returns how it learns with rules of the user's own; None if it has no rules.
    """

    planner: str
    spec: PolicySpec
    problem: Callable[..., Problem[Any, Any]]
    learner: Callable[..., Learner[Any, Any]]
    setup: Callable[[int, int], Setup]
    counts: tuple[int, ...] = COUNTS
    cellular: bool = False
    in_field: FieldLearning | None = None
    with_rules: Callable[[ControllerDefinition], Recipe] | None = None

    @property
    def of_field(self) -> FieldLearning:
        """How it learns a single field.

        Raises:
            LookupError: If in no way of its own.
        """
        if self.in_field is None:
            raise LookupError(f"{self.planner} learns a field as it learns everywhere")
        return self.in_field

    def tasks(self, drive: Drive, seed: int, scenario: Scenario | None = None) -> Tasks:
        """Return what it learns on."""
        return Tasks(drive, seed, self.counts, self.cellular, scenario)


RECIPES: dict[str, Recipe] = {}
"""By planner."""


def register_recipe(recipe: Recipe) -> None:
    """Make known how a planner learns, so that ``fuzzyq train`` can train it.

    The planner itself is registered by ``planning.register_planner``; its settings are a
    ``PolicySettings``, so that a scenario can name the policy that was learned. In a file that
    ``--plugin`` names (``examples/extend/policy.py`` is a whole one)::

        from fuzzyq_bullet.learning import PolicySpec, QLambda, Setup
        from fuzzyq_bullet.training.registry import Recipe, register_recipe

        spec = PolicySpec("my-planner", STATE_NAMES, ACTION_NAMES, "q-lambda")
        register_recipe(
            Recipe(
                planner="my-planner",
                spec=spec,
                problem=MyProblem,  # called with the Tasks; reset, step, outcome: learning.Problem
                learner=lambda: QLambda(*spec.shape),
                setup=lambda episodes, seed: Setup(episodes, seed),
            )
        )

    What the package is to ship is one more line in ``training.config.SHIPPED``.

    Raises:
        ValueError: If it is known already how that planner learns.
    """
    if recipe.planner in RECIPES:
        raise ValueError(f"it is known already how the planner {recipe.planner!r} learns")
    RECIPES[recipe.planner] = recipe


def _paper_setup(episodes: int, seed: int) -> Setup:
    return Setup(episodes=episodes, seed=seed)


for _planner, _learner in (("q-learning", QLearning), ("q-lambda", QLambda)):
    register_recipe(
        Recipe(
            planner=_planner,
            spec=DIRECT[_planner],
            problem=DirectProblem,
            learner=partial(_learner, *DIRECT[_planner].shape),
            setup=_paper_setup,
        )
    )


def _rule_weights(settings: FuzzyQLambdaSettings) -> Recipe:
    """Return how the rules of a controller learn their weights."""
    spec = policy_spec(settings)
    return Recipe(
        planner=settings.name,
        spec=spec,
        problem=partial(RuleWeightsProblem, settings=settings, discount=UNDISCOUNTED),
        learner=partial(
            FuzzyQLambda,
            *spec.shape,
            discount=UNDISCOUNTED,
            kind="replacing",
            twins=twins_of(controller_shown(settings).base),
            patience=PATIENCE,
        ),
        setup=lambda episodes, seed: Setup(
            episodes=episodes, seed=seed, rate=SLOW_RATE, trace_decay=TRACE
        ),
        counts=ALL_COUNTS,
        cellular=True,
        in_field=FieldLearning(learn_field, field_setup, RUNS, ("rate", "trace")),
        with_rules=lambda rules: _rule_weights(FuzzyQLambdaSettings(rules=rules)),
    )


register_recipe(_rule_weights(FuzzyQLambdaSettings()))


def recipe_of(planner: str) -> Recipe:
    """Return how a planner learns.

    Raises:
        UserError: If it does not learn, or does not exist.
    """
    if planner not in RECIPES:
        raise UserError(f"planner: {planner!r} does not learn; those that do: {', '.join(RECIPES)}")
    return RECIPES[planner]


def learn(
    recipe: Recipe,
    tasks: Tasks,
    setup: Setup,
    *,
    command: str,
    options: LearningOptions = AS_USUAL,
    rules: ControllerDefinition | None = None,
    checkpoint: Path | None = None,
    resume: bool = False,
    on_episode: Callable[[Curve], None] | None = None,
) -> tuple[Policy, Curve]:
    """Train a planner.

    Args:
        recipe: How it learns.
        tasks: What it learns on.
        setup: For how long, and how fast.
        command: What to type to do this again; the policy keeps it.
        options: Discount and reward, if others than usual.
        rules: The rules that the recipe is for, if they are not the paper's.
        checkpoint: Where to keep how far it is after every episode.
        resume: Whether to go on from there.
        on_episode: Called after every episode with the learning curve so far.

    Returns:
        The policy and the learning curve.

    Raises:
        UserError: As ``learning.train``; or if a discount or reward is given, and it takes none.
    """
    learner, problem = _built(recipe, tasks, options)
    made = {"planner": recipe.planner, "drive": tasks.drive, "tasks": tasks.digest()}
    if options.reward is not None:
        made["reward"] = str(options.reward)
    if rules is not None:
        made["rules"] = rules.digest()
    curve = train(
        problem,
        learner,
        setup,
        made=made,
        checkpoint=checkpoint,
        resume=resume,
        on_episode=on_episode,
    )
    described = {**setup.describe(), **learner.describe()}
    described |= {key: made[key] for key in ("reward", "rules") if key in made}
    policy = Policy(
        planner=recipe.planner,
        learner=str(described.pop("learner")),
        command=command,
        seed=setup.seed,
        version=__version__,
        drive=tasks.drive,
        scenario=tasks.digest(),
        episodes=setup.episodes,
        parameters={key: described[key] for key in described if key not in ("seed", "episodes")},
        states=tuple(recipe.spec.states),
        actions=tuple(recipe.spec.actions),
        table=learner.table.tolist(),
    )
    return policy, curve


def refuse_unfit(recipe: Recipe, options: LearningOptions, *, in_field: bool = False) -> None:
    """Make sure that what a planner learns with takes what is asked for.

    Args:
        recipe: How the planner learns.
        options: What is asked for.
        in_field: Whether it is to learn a single field in its own way.

    Raises:
        UserError: If it does not; names the option.
    """
    if in_field and recipe.in_field is not None:
        takes = recipe.in_field.takes
        for name in options.given():
            if name not in takes:
                raise UserError(
                    f"--{name}: is not used where {recipe.planner} learns one field; "
                    f"{' and '.join(f'--{one}' for one in takes)} are"
                )
        return
    known = {*signature(recipe.learner).parameters, *signature(recipe.problem).parameters}
    for name in ("discount", "reward"):
        if getattr(options, name) is not None and name not in known:
            raise UserError(f"--{name}: what {recipe.planner} learns with takes none")
    if options.trace is not None and type(recipe.learner()) is QLearning:
        raise UserError(f"--trace: what {recipe.planner} learns with has no traces")


def _built(
    recipe: Recipe, tasks: Tasks, options: LearningOptions
) -> tuple[Learner[Any, Any], Problem[Any, Any]]:
    """Build learner and problem, with what is asked for."""
    refuse_unfit(recipe, options)
    asked = {"discount": options.discount, "reward": options.reward}
    asked = {name: value for name, value in asked.items() if value is not None}
    learns, is_of = (
        {name: asked[name] for name in asked if name in signature(function).parameters}
        for function in (recipe.learner, recipe.problem)
    )
    return recipe.learner(**learns), recipe.problem(tasks, **is_of)
