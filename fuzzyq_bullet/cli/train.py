"""``fuzzyq train``: a planner learns, in a way that may be interrupted anywhere and goes on."""

from __future__ import annotations

import shlex
import time
from dataclasses import dataclass, field
from json import dumps
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fuzzyq_bullet.cli.console import progress_bar, say
from fuzzyq_bullet.cli.plugin import PluginOption
from fuzzyq_bullet.errors import Stopped, UserError

if TYPE_CHECKING:
    from collections.abc import Callable

    from fuzzyq_bullet.learning.checkpoint import Curve
    from fuzzyq_bullet.training.config import TrainingConfig
    from fuzzyq_bullet.training.tasks import Tasks

FOLDER = Path("out/train")


def train(
    planner: Annotated[str, typer.Argument(metavar="PLANNER", help="Planner that learns.")],
    *,
    episodes: Annotated[int, typer.Option(help="Episodes to learn from.")] = 200,
    drive: Annotated[str, typer.Option(help="kinematic, or wheels (physics).")] = "kinematic",
    scenario: Annotated[
        str | None,
        typer.Option(help="Learn on this file or bundled scenario, not on random fields."),
    ] = None,
    seed: Annotated[int, typer.Option(help="Seed of the training.")] = 0,
    out: Annotated[
        str | None,
        typer.Option(
            metavar="FILE", help="Policy to write.", show_default=f"{FOLDER}/PLANNER.json"
        ),
    ] = None,
    resume: Annotated[
        bool, typer.Option("--resume", help="Go on with a training that was begun.")
    ] = False,
    anew: Annotated[
        bool, typer.Option("--anew", help="Begin again, whatever was begun or made there before.")
    ] = False,
    plugin: PluginOption = None,
    json: Annotated[bool, typer.Option("--json", help="Summary as JSON on stdout, alone.")] = False,
) -> None:
    """Train a planner; write PLANNER.json (the policy) and PLANNER.png (the learning curve).

    May be ended at any moment: after every episode PLANNER.checkpoint.npz is renewed, and --resume
    goes on to the very same policy. To use it, name it in a scenario file:
    planner: {name: PLANNER, policy: FILE}.

    Raises:
        UserError: If an option is wrong, a file cannot be written, or what was begun is another
            training.
    """
    # What takes long to load waits until the options are known to be right.
    if resume and anew:
        raise UserError("--resume, --anew: give one of them; the first goes on, the other does not")
    from fuzzyq_bullet.files import alone_at, refuse_inputs
    from fuzzyq_bullet.outputs import plugin_inputs

    config = _config(planner, episodes, drive, seed, scenario)
    files = _Files.of(config.planner, out)
    tasks = _tasks(config)
    files.check()
    from fuzzyq_bullet.scenario import find_scenario

    read = [] if scenario is None else [find_scenario(scenario)]
    refuse_inputs(files.all, [*read, *plugin_inputs(plugin or [])])
    try:
        with alone_at(files.checkpoint):
            progress = _Progress(_begun(config, tasks, files, resume=resume, anew=anew))
            curve = _learn(config, tasks, files, progress, resume=resume)
    except Stopped:
        where = [] if out is None else ["--out", out]
        again = f"{config.command} {shlex.join([*where, '--resume'])}"
        say(f"{_kept(files.checkpoint)} of {config.episodes} episodes are kept; to go on: {again}")
        raise
    summary = _summary(config, curve, progress, files)
    if json:
        typer.echo(dumps(summary, indent=2))
    _tell(config, summary)


@dataclass(frozen=True)
class _Files:
    """What a training writes."""

    policy: Path
    picture: Path
    checkpoint: Path

    @classmethod
    def of(cls, planner: str, out: str | None) -> _Files:
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
        from fuzzyq_bullet.files import writable_files

        writable_files(self.policy.parent, [path.name for path in self.all])


@dataclass
class _Progress:
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
        from fuzzyq_bullet.learning.checkpoint import WINDOW, success

        self._began = time.perf_counter()

        def update(curve: Curve) -> None:
            self.done = len(curve)
            self.stop()
            recent = curve[-WINDOW:]
            show(
                f"episode {self.done} of {total}, {self.rate or 0.0:.1f}/s, "
                f"goal in {100 * success(recent):.0f} % of the last {len(recent)}",
                self.done,
            )

        return update

    def stop(self) -> None:
        """Read the clock."""
        self.seconds = time.perf_counter() - self._began


def _config(
    planner: str, episodes: int, drive: str, seed: int, scenario: str | None
) -> TrainingConfig:
    """Return what is asked for.

    Raises:
        UserError: If any of it is not allowed; names the option.
    """
    from typing import get_args

    from fuzzyq_bullet.learning.policy import MAX_WORDS
    from fuzzyq_bullet.learning.training import MAX_EPISODES
    from fuzzyq_bullet.planning import planner_names
    from fuzzyq_bullet.scenario.models import Drive
    from fuzzyq_bullet.training.config import TrainingConfig
    from fuzzyq_bullet.training.registry import RECIPES
    from fuzzyq_bullet.training.tasks import MOST_SEED
    from fuzzyq_bullet.wording import did_you_mean, not_one_of, shorten

    if planner not in RECIPES:
        known = planner in planner_names()
        what = f"{planner} does not learn" if known else f"no planner {shorten(planner)}"
        hint = "" if known else did_you_mean(planner, RECIPES)
        raise UserError(f"PLANNER: {what}; {hint}those that learn: {', '.join(RECIPES)}")
    if not 1 <= episodes <= MAX_EPISODES:
        raise UserError(f"--episodes: must be from 1 to {MAX_EPISODES}, got {episodes}")
    if not 0 <= seed <= MOST_SEED:
        raise UserError(f"--seed: must be from 0 to {MOST_SEED}, got {seed}")
    drives: tuple[Drive, ...] = get_args(Drive)
    for known_drive in drives:
        if drive == known_drive:
            config = TrainingConfig(planner, episodes, known_drive, seed, scenario)
            break
    else:
        raise UserError(f"--drive: {not_one_of('drive', drive, sorted(drives))}")
    if len(config.command.encode("utf-8", "backslashreplace")) > MAX_WORDS:
        raise UserError(
            f"--scenario: its path is too long for the policy to hold: {shorten(scenario)}"
        )
    return config


def _tasks(config: TrainingConfig) -> Tasks:
    """Return what is learned on.

    Raises:
        UserError: If the scenario is wrong.
    """
    from fuzzyq_bullet.planning import settings_for
    from fuzzyq_bullet.scenario import load_scenario, realise
    from fuzzyq_bullet.training.registry import recipe_of

    recipe = recipe_of(config.planner)
    if config.scenario is None:
        return recipe.tasks(config.drive, config.seed)
    asked = load_scenario(config.scenario, policies=False)
    # The planner that learns takes the place of the scenario's own, of which nothing is used.
    settings = settings_for(config.planner).model_validate({"name": config.planner})
    asked = asked.model_copy(update={"planner": settings})
    realise(asked)  # now rather than in an episode, should its obstacles find no place
    return recipe.tasks(config.drive, config.seed, asked)


def _begun(config: TrainingConfig, tasks: Tasks, files: _Files, *, resume: bool, anew: bool) -> int:
    """Return how many episodes of the training that is to go on are done already.

    Raises:
        UserError: If another training was begun or finished there, or the same was begun, and it
            was not said what is to become of it.
    """
    from fuzzyq_bullet.learning.checkpoint import Checkpoint

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


def _is_same(config: TrainingConfig, tasks: Tasks, files: _Files) -> bool:
    """Return whether the policy that is there was made by the very same training."""
    from fuzzyq_bullet.learning.policy import load_policy

    try:
        policy = load_policy(files.policy)
    except UserError:
        return False
    return (policy.command, policy.scenario) == (config.command, tasks.digest())


def _kept(checkpoint: Path) -> int:
    """Return how many episodes are safe on disk."""
    from fuzzyq_bullet.learning.checkpoint import Checkpoint

    try:
        saved = Checkpoint.find(checkpoint)
    except UserError:  # somebody else's by now
        return 0
    return len(saved.curve) if saved else 0


def _learn(
    config: TrainingConfig, tasks: Tasks, files: _Files, progress: _Progress, *, resume: bool
) -> Curve:
    """Train, write the policy and the picture, and return the learning curve."""
    from fuzzyq_bullet.training.registry import learn, recipe_of

    recipe = recipe_of(config.planner)
    with progress_bar("training", config.episodes) as (bar, task):

        def show(note: str, done: int) -> None:
            bar.update(task, completed=done, note=note)

        show("", progress.before)
        policy, curve = learn(
            recipe,
            tasks,
            recipe.setup(config.episodes, config.seed),
            command=config.command,
            checkpoint=files.checkpoint,
            resume=resume,
            on_episode=progress.shown(config.episodes, show),
        )
    policy.save(files.policy)

    from fuzzyq_bullet.experiments.figures import learning_curve

    learning_curve.draw(curve, _title(config, tasks), files.picture)
    return curve


def _title(config: TrainingConfig, tasks: Tasks) -> str:
    # A scenario's name is of plain letters; its path may hold what no font can show.
    where = "random fields" if tasks.scenario is None else tasks.scenario.name
    return f"{config.planner}: learned on {where} ({config.drive}, seed {config.seed})"


def _summary(
    config: TrainingConfig, curve: Curve, progress: _Progress, files: _Files
) -> dict[str, Any]:
    from fuzzyq_bullet.learning.checkpoint import WINDOW, success
    from fuzzyq_bullet.version import __version__

    window = min(WINDOW, len(curve))
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
        "policy": str(files.policy),
        "picture": str(files.picture),
        "checkpoint": str(files.checkpoint),
    }


def _tell(config: TrainingConfig, summary: dict[str, Any]) -> None:
    rate, before, now = (summary[k] for k in ("episodes_per_s", "episodes_before", "episodes_now"))
    if now:
        pace = f"{now} episodes in {summary['time_s']:.1f} s: {rate:.2f} episodes/s"
        pace += f"; {before} were done already" if before else ""
    else:
        pace = f"all {before} episodes were done already"
    say(f"{config.planner}: {pace} ({config.drive}, seed {config.seed})", style="bold")
    first, last = (100 * summary[key] for key in ("success_first", "success_last"))
    window = summary["window"]
    say(f"goal reached in {first:.0f} % of the first {window} episodes, {last:.0f} % of the last")
    for key in ("policy", "picture", "checkpoint"):
        say(f"  {summary[key]}")
