"""What commands that sweep share: lists of counts, the planner, and the bar that shows how far."""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING, get_args

from fuzzyq_bullet.cli.console import progress_bar
from fuzzyq_bullet.errors import UserError

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from fuzzyq_bullet.experiments.sweep.run import Progress, State
    from fuzzyq_bullet.experiments.sweep.workers import Pool
    from fuzzyq_bullet.planning import PlannerSettings
    from fuzzyq_bullet.scenario import Drive

NONE = "none"
BACKENDS = ("loky", "dask")


def counts_of(text: str, option: str) -> tuple[int, ...]:
    """Return numbers of obstacles, sorted, each once; ``none`` stands for none of them.

    Args:
        text: Such as ``5,25,50``.
        option: What to call it in an error.

    Raises:
        UserError: If one is no number of obstacles that a scenario may have.
    """
    from fuzzyq_bullet.scenario import MAX_OBSTACLES

    if text.strip() == NONE:
        return ()
    counts = set()
    for part in text.split(","):
        number = part.strip()
        if not (
            number.isascii()
            and number.isdigit()
            and len(number) < 9
            and int(number) <= MAX_OBSTACLES
        ):
            raise UserError(
                f"{option}: {part[:30]!r} is no number of obstacles; give numbers from 0 to "
                f"{MAX_OBSTACLES} with commas between, or {NONE}"
            )
        counts.add(int(number))
    return tuple(sorted(counts))


def drives_of(text: str) -> tuple[Drive, ...]:
    """Return the drives that ``--drive`` asks for.

    Raises:
        UserError: If there is no such drive.
    """
    from fuzzyq_bullet.scenario import Drive
    from fuzzyq_bullet.wording import not_one_of

    known: tuple[Drive, ...] = get_args(Drive)
    if text == "both":
        return known
    chosen = tuple(drive for drive in known if drive == text)
    if not chosen:
        raise UserError(f"--drive: {not_one_of('drive', text, [*known, 'both'])}")
    return chosen


def one_drive_of(text: str) -> Drive:
    """Return the one drive that ``--drive`` asks for.

    Raises:
        UserError: If there is no such drive, or both are asked for.
    """
    drives = drives_of(text)
    if len(drives) > 1:
        raise UserError(f"--drive: one at a time here: {', '.join(drives)}")
    return drives[0]


def seed_of(seed: int) -> int:
    """Return the seed of a sweep.

    Raises:
        UserError: If it is out of bounds.
    """
    from fuzzyq_bullet.experiments.sweep.jobs import MOST_SEED

    if not 0 <= seed <= MOST_SEED:
        raise UserError(f"--seed: must be from 0 to {MOST_SEED}, got {seed}")
    return seed


def planners_of(text: str) -> dict[str, PlannerSettings]:
    """Return planners as they are set by default, each once, by their names.

    Args:
        text: Such as ``fuzzy,q-learning``.

    Raises:
        UserError: If there is no such planner.
    """
    from fuzzyq_bullet.planning import planner_names, settings_for
    from fuzzyq_bullet.planning.registry import no_planner

    chosen = {}
    for part in text.split(","):
        name = part.strip()
        if name not in planner_names():
            raise UserError(f"--planners: {no_planner(name)}")
        chosen[name] = settings_for(name).model_validate({"name": name})
    return chosen


def planner_of(name: str, weights: str | None) -> PlannerSettings:
    """Return the settings of a planner with these weights.

    Args:
        name: Name of a planner.
        weights: (ω1, ω2) as ``1,1``; None for 1 and 1 where the planner takes weights at all.

    Raises:
        UserError: If there is no such planner, or it does not take such weights.
    """
    from pydantic import ValidationError

    from fuzzyq_bullet.planning import planner_names, settings_for
    from fuzzyq_bullet.planning.registry import no_planner
    from fuzzyq_bullet.wording import shorten

    if name not in planner_names():
        raise UserError(f"--planner: {no_planner(name)}")
    model = settings_for(name)
    takes = "weights" in model.model_fields
    if weights is None:
        return model.model_validate({"name": name, **({"weights": (1.0, 1.0)} if takes else {})})
    if not takes:
        raise UserError(f"--weights: planner {name} takes none")
    try:
        pair = [float(part) for part in weights.split(",")]
        return model.model_validate({"name": name, "weights": tuple(pair)})
    except ValidationError as error:
        why = error.errors(include_url=False)[0]["msg"].splitlines()[0]
        raise UserError(f"--weights: {shorten(weights)}: {why}") from error
    except ValueError as error:
        raise UserError(f"--weights: must be two numbers such as 1,1, got {weights!r}") from error


@contextmanager
def pool_of(
    backend: str, scheduler: str | None, jobs: int | None, plugins: Sequence[str]
) -> Iterator[Pool]:
    """Yield who does the work of a sweep.

    Args:
        backend: ``loky``, processes of this machine, or ``dask``.
        scheduler: Address of the Dask scheduler.
        jobs: Episodes at a time; None for one a core.
        plugins: Modules that each worker imports first.

    Raises:
        UserError: If there is no such backend, or its scheduler cannot be used.
    """
    from fuzzyq_bullet.wording import not_one_of

    if backend not in BACKENDS:
        raise UserError(f"--backend: {not_one_of('backend', backend, BACKENDS)}")
    if (backend == "dask") != (scheduler is not None):
        raise UserError("--backend dask and --scheduler ADDRESS belong together")
    if scheduler is None:
        from fuzzyq_bullet.experiments.sweep.workers import Pool

        yield Pool(jobs, plugins=tuple(plugins))
        return

    files = [name for name in plugins if name.endswith(".py")]
    if files:
        raise UserError(
            f"--plugin: {files[0]} is a file of this machine; with --backend dask install it as a "
            "module on the workers, and give its name"
        )

    from fuzzyq_bullet.experiments.sweep.cluster import cluster

    with cluster(scheduler, jobs) as pool:
        yield pool


@contextmanager
def sweep_bar() -> Iterator[Progress]:
    """Show how far a sweep is: rate, remaining time, and the success so far."""
    with progress_bar("sweeping") as (progress, bar):

        def show(state: State) -> None:
            success = f"{state.successes / state.feasible:.2f}" if state.feasible else "–"
            progress.update(
                bar,
                completed=state.done,
                total=state.total,
                note=f"{state.done} of {state.total}, {state.rate:.1f}/s, "
                f"found {success} of feasible",
            )

        yield show
