"""One training as a user asks for it: on what, what is there already, what it came to.

As a program it prints, for ``make policies``, the commands that make the shipped policies.
"""

from __future__ import annotations

import shlex
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, get_args

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.files import writable_files
from fuzzyq_bullet.ground_truth import shortest_path
from fuzzyq_bullet.learning.checkpoint import WINDOW, Checkpoint, Curve, success
from fuzzyq_bullet.learning.policy import MAX_WORDS, load_policy
from fuzzyq_bullet.learning.training import MAX_EPISODES
from fuzzyq_bullet.planning import planner_names, settings_for
from fuzzyq_bullet.scenario import load_scenario, realise
from fuzzyq_bullet.scenario.models import Drive
from fuzzyq_bullet.training.field import FieldTask
from fuzzyq_bullet.training.options import AS_USUAL, LearningOptions
from fuzzyq_bullet.training.registry import RECIPES, learn, recipe_of, refuse_unfit
from fuzzyq_bullet.training.tasks import MOST_SEED, Tasks
from fuzzyq_bullet.version import __version__
from fuzzyq_bullet.wording import did_you_mean, not_one_of, shorten

FOLDER = Path("out/train")
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
    """

    planner: str
    episodes: int = USUAL_EPISODES
    drive: Drive = "kinematic"
    seed: int = 0
    scenario: str | None = None
    options: LearningOptions = AS_USUAL
    plugins: tuple[str, ...] = ()

    @property
    def command(self) -> str:
        """The command that does it, with every option written out.

        The output path is not in it: the same training gives the same file everywhere.
        """
        parts = ["fuzzyq", "train", self.planner, "--episodes", str(self.episodes)]
        parts += ["--drive", self.drive, "--seed", str(self.seed)]
        if self.scenario is not None:
            parts += ["--scenario", self.scenario]
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


@dataclass(frozen=True)
class TrainingFiles:
    """What a training writes."""

    policy: Path
    picture: Path
    checkpoint: Path

    @classmethod
    def of(cls, planner: str, out: str | None) -> TrainingFiles:
        """Return what a training writes; ``out`` is the policy, by default in ``FOLDER``.

        Raises:
            UserError: If it is called otherwise.
        """
        policy = FOLDER / f"{planner}.json" if out is None else Path(out)
        if policy.suffix != ".json":
            raise UserError(f"--out: give a file that ends in .json, got {out!r}")
        return cls(
            policy,
            policy.with_name(f"{policy.stem}.png"),
            policy.with_name(f"{policy.stem}.checkpoint.npz"),
        )

    @property
    def all(self) -> tuple[Path, ...]:
        """All of them."""
        return self.policy, self.picture, self.checkpoint

    def check(self) -> None:
        """Make sure that all can be written, before anything is learned."""
        writable_files(self.policy.parent, [path.name for path in self.all])


@dataclass
class TrainingProgress:
    """How far a training is, and how fast.

    Attributes:
        before: Episodes that were done before this process.
        done: Episodes that are done.
        seconds: How long this process trained (s).
    """

    before: int
    done: int = 0
    seconds: float = 0.0
    _began: float = field(default_factory=time.perf_counter)

    def __post_init__(self) -> None:
        self.done = self.before

    @property
    def ran(self) -> int:
        """Episodes of this process."""
        return self.done - self.before

    @property
    def rate(self) -> float | None:
        """Episodes per second; None when there were none."""
        return self.ran / self.seconds if self.ran and self.seconds > 0.0 else None

    def shown(self, total: int, show: Callable[[str, int], None]) -> Callable[[Curve], None]:
        """Return what is to be called after every episode; the clock starts now."""
        self._began = time.perf_counter()

        def update(curve: Curve) -> None:
            self.done = len(curve)
            self.seconds = time.perf_counter() - self._began
            recent = curve[-WINDOW:]
            show(
                f"episode {self.done} of {total}, {self.rate or 0.0:.1f}/s, "
                f"goal in {100 * success(recent):.0f} % of the last {len(recent)}",
                self.done,
            )

        return update


def config_for(
    planner: str,
    episodes: int | None,
    drive: str | None,
    seed: int,
    scenario: str | None,
    options: LearningOptions = AS_USUAL,
    plugins: Sequence[str] = (),
) -> TrainingConfig:
    """Return what is asked for by the options of a command.

    Args:
        planner: Who learns.
        episodes: Of the training; None for as many as it usually takes.
        drive: What moves the robot; None for kinematic, or to learn a field that of the scenario.
        seed: Of the training.
        scenario: What it learns on; None for random fields.
        options: How.
        plugins: Modules of the user's own that it needs.

    Raises:
        UserError: If any of it is not allowed; names the option.
    """
    if planner not in RECIPES:
        known = planner in planner_names()
        what = f"{planner} does not learn" if known else f"no planner {shorten(planner)}"
        hint = "" if known else did_you_mean(planner, RECIPES)
        raise UserError(f"PLANNER: {what}; {hint}those that learn: {', '.join(RECIPES)}")
    recipe = RECIPES[planner]
    own_way = scenario is not None and recipe.in_field is not None
    if episodes is None:
        episodes = recipe.of_field.runs if own_way else USUAL_EPISODES
    if drive is None:
        drive = (
            load_scenario(scenario, policies=False).drive if own_way and scenario else "kinematic"
        )
    if not 1 <= episodes <= MAX_EPISODES:
        raise UserError(f"--episodes: must be from 1 to {MAX_EPISODES}, got {episodes}")
    if not 0 <= seed <= MOST_SEED:
        raise UserError(f"--seed: must be from 0 to {MOST_SEED}, got {seed}")
    refuse_unfit(recipe, options, in_field=own_way)
    drives: tuple[Drive, ...] = get_args(Drive)
    for known_drive in drives:
        if drive == known_drive:
            config = TrainingConfig(
                planner, episodes, known_drive, seed, scenario, options, tuple(plugins)
            )
            break
    else:
        raise UserError(f"--drive: {not_one_of('drive', drive, sorted(drives))}")
    if len(config.command.encode("utf-8", "backslashreplace")) > MAX_WORDS:
        raise UserError(
            "--scenario, --plugin: their paths are too long for the policy to hold: "
            f"{shorten(config.command)}"
        )
    return config


def tasks_for(config: TrainingConfig) -> Tasks | FieldTask:
    """Return what is learned on.

    Raises:
        UserError: If the scenario is wrong.
    """
    recipe = recipe_of(config.planner)
    if config.scenario is None:
        return recipe.tasks(config.drive, config.seed)
    asked = load_scenario(config.scenario, policies=False)
    # The planner that learns takes the place of the scenario's own, of which nothing is used.
    settings = settings_for(config.planner).model_validate({"name": config.planner})
    asked = asked.model_copy(update={"planner": settings})
    realised = realise(asked)  # now rather than in an episode, should obstacles find no place
    if recipe.in_field is not None:
        return FieldTask(realised.model_copy(update={"drive": config.drive}))
    return recipe.tasks(config.drive, config.seed, asked)


def episodes_done(
    config: TrainingConfig,
    tasks: Tasks | FieldTask,
    files: TrainingFiles,
    *,
    resume: bool,
    anew: bool,
) -> int:
    """Return how many episodes of the training that is to go on are done already.

    Raises:
        UserError: If another training was begun or finished there, or the same was begun, and it
            was not said what is to become of it.
    """
    if anew:
        return 0
    checkpoint = files.checkpoint
    try:
        saved = Checkpoint.find(checkpoint)
    except UserError as error:
        raise UserError(f"{error.problems[0]}; --anew begins again") from error
    done, total = (0, 0) if saved is None else (len(saved.curve), saved.plan.get("episodes", 0))
    if resume and saved is not None:
        return done
    if 0 < done != total:
        raise UserError(
            f"{checkpoint}: a training was begun, {done} of {total} episodes are done; "
            "--resume goes on, --anew begins again, another --out leaves it alone"
        )
    finished = [path for path in files.all if path.exists()]
    if (
        finished
        and not (done == 0 and finished == [checkpoint])
        and not _is_same(config, tasks, files)
    ):
        raise UserError(
            f"{finished[0]}: is there already, and not of this training; --anew replaces it, "
            "another --out leaves it alone"
        )
    return 0


def _is_same(config: TrainingConfig, tasks: Tasks | FieldTask, files: TrainingFiles) -> bool:
    """Return whether the policy that is there was made by the very same training."""
    try:
        policy = load_policy(files.policy)
    except UserError:
        return False
    return (policy.command, policy.scenario) == (config.command, tasks.digest())


def episodes_kept(checkpoint: Path) -> int:
    """Return how many episodes are safe on disk."""
    try:
        saved = Checkpoint.find(checkpoint)
    except UserError:  # somebody else's by now
        return 0
    return len(saved.curve) if saved else 0


def learn_policy(
    config: TrainingConfig,
    tasks: Tasks | FieldTask,
    files: TrainingFiles,
    on_episode: Callable[[Curve], None],
    *,
    resume: bool,
) -> Curve:
    """Train, write the policy, and return the learning curve."""
    recipe, options = recipe_of(config.planner), config.options
    if isinstance(tasks, FieldTask):
        policy, curve = recipe.of_field.learn(
            tasks,
            options.setup(recipe.of_field.setup(config.episodes, config.seed)),
            command=config.command,
            checkpoint=files.checkpoint,
            resume=resume,
            on_episode=on_episode,
        )
    else:
        policy, curve = learn(
            recipe,
            tasks,
            options.setup(recipe.setup(config.episodes, config.seed)),
            options=options,
            command=config.command,
            checkpoint=files.checkpoint,
            resume=resume,
            on_episode=on_episode,
        )
    policy.save(files.policy)
    return curve


def title_of(config: TrainingConfig, tasks: Tasks | FieldTask) -> str:
    """Return the heading of the learning curve."""
    # A scenario's name is of plain letters; its path may hold what no font can show.
    where = "random fields" if tasks.scenario is None else tasks.scenario.name
    return f"{config.planner}: learned on {where} ({config.drive}, seed {config.seed})"


def most_of(tasks: Tasks | FieldTask) -> float | None:
    """Return what an episode can earn at most (s): minus the time of the shortest path.

    None where every episode is another, where there is no path, and of a point that jumps, which
    has no greatest speed.
    """
    if not isinstance(tasks, FieldTask) or tasks.scenario.drive == "kinematic":
        return None
    route = shortest_path(tasks.scenario)
    return None if route is None else -route.length / tasks.scenario.robot.max_speed


def summary_of(
    config: TrainingConfig, curve: Curve, progress: TrainingProgress, files: TrainingFiles
) -> dict[str, Any]:
    """Return what became of a training, for people and as JSON."""
    window = min(WINDOW, len(curve))
    parameters = load_policy(files.policy).parameters
    of_field: dict[str, Any] = {
        key: parameters[key] for key in ("first_s", "fastest_s", "fastest_run") if key in parameters
    }
    if of_field:
        of_field["collisions"] = int((curve["outcome"] == b"collision").sum())
    return {
        "planner": config.planner,
        "command": config.command,
        "version": __version__,
        "episodes": len(curve),
        "episodes_before": progress.before,
        "episodes_now": progress.ran,
        "time_s": round(progress.seconds, 3),
        "episodes_per_s": progress.rate and round(progress.rate, 3),
        "window": window,
        "success_first": success(curve[:window]),
        "success_last": success(curve[-window:]),
        **of_field,
        "policy": str(files.policy),
        "picture": str(files.picture),
        "checkpoint": str(files.checkpoint),
    }


if __name__ == "__main__":
    for shipped in SHIPPED.values():
        print(shipped.command)
