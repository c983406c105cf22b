"""One training from its first file to its last: what is there already, and what it came to."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.files import writable_files
from fuzzyq_bullet.learning.checkpoint import WINDOW, Checkpoint, Curve, success
from fuzzyq_bullet.learning.policy import load_policy
from fuzzyq_bullet.recording.metrics import shortest_length
from fuzzyq_bullet.training.config import TrainingConfig
from fuzzyq_bullet.training.field import FieldTask
from fuzzyq_bullet.training.registry import learn
from fuzzyq_bullet.training.tasks import Tasks
from fuzzyq_bullet.version import __version__

FOLDER = Path("out/train")


@dataclass(frozen=True)
class TrainingFiles:
    """What a training writes."""

    policy: Path
    picture: Path
    checkpoint: Path

    @classmethod
    def of(cls, name: str, out: str | None) -> TrainingFiles:
        """Return what a training writes; ``out`` is the policy, by default in ``FOLDER``.

        Args:
            name: What it is called there.
            out: The policy.

        Raises:
            UserError: If it is called otherwise.
        """
        policy = FOLDER / f"{name}.json" if out is None else Path(out)
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


def episodes_done(
    config: TrainingConfig,
    tasks: Tasks | FieldTask,
    files: TrainingFiles,
    *,
    resume: bool,
    anew: bool,
) -> int:
    """Return how many episodes of the training that is to go on are done already.

    A training that is finished goes on too: nothing of it is left to do.

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
    return done


def _is_same(config: TrainingConfig, tasks: Tasks | FieldTask, files: TrainingFiles) -> bool:
    """Return whether the policy that is there was made by the very same training."""
    try:
        policy = load_policy(files.policy)
    except UserError:
        return False
    if isinstance(tasks, FieldTask) and policy.parameters.get("run") != tasks.run_digest():
        return False
    made = (config.command, tasks.digest(), __version__)
    return (policy.command, policy.scenario, policy.version) == made


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
    recipe, options = config.recipe, config.options
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
            rules=config.definition,
            command=config.command,
            checkpoint=files.checkpoint,
            resume=resume,
            on_episode=on_episode,
        )
    policy.save(files.policy)
    return curve


def name_of(config: TrainingConfig, tasks: Tasks | FieldTask) -> str:
    """Return what the files of a training are called by default: the planner, and its field."""
    field = f"-{tasks.scenario.name}" if isinstance(tasks, FieldTask) else ""
    return f"{config.planner}{field}"


def title_of(config: TrainingConfig, tasks: Tasks | FieldTask) -> str:
    """Return the heading of the learning curve."""
    # A scenario's name is of plain letters; its path may hold what no font can show.
    where = "random fields" if tasks.scenario is None else tasks.scenario.name
    return f"{config.planner}: learned on {where} ({config.drive}, seed {config.seed})"


def most_of(tasks: Tasks | FieldTask) -> float | None:
    """Return what an episode can earn at most (s): minus the time of the shortest path.

    None where every episode is another, where there is no path or too much in its way, and of a
    point that jumps, which has no greatest speed.
    """
    if not isinstance(tasks, FieldTask) or tasks.scenario.drive == "kinematic":
        return None
    length = shortest_length(tasks.scenario)
    return None if length is None else -length / tasks.scenario.robot.max_speed


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
