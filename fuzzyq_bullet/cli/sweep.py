"""What commands that sweep share: lists of counts, the planner, and the bar that shows how far."""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING, get_args

from fuzzyq_bullet.cli.console import progress_bar
from fuzzyq_bullet.errors import UserError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from fuzzyq_bullet.experiments.sweep.run import Progress, State
    from fuzzyq_bullet.planning import PlannerSettings
    from fuzzyq_bullet.scenario import Drive

NONE = "none"


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
    from fuzzyq_bullet.scenario.problems import did_you_mean, shorten

    known: tuple[Drive, ...] = get_args(Drive)
    if text == "both":
        return known
    chosen = tuple(drive for drive in known if drive == text)
    if not chosen:
        allowed = [*known, "both"]
        hint = did_you_mean(text, allowed)
        raise UserError(f"--drive: no drive {shorten(text)}; {hint}allowed: {', '.join(allowed)}")
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
    from fuzzyq_bullet.scenario.problems import did_you_mean, shorten

    if name not in planner_names():
        hint = did_you_mean(name, planner_names())
        allowed = ", ".join(planner_names())
        raise UserError(f"--planner: no planner {shorten(name)}; {hint}allowed: {allowed}")
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
