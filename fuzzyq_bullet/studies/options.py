"""What the options of studies mean: numbers of obstacles, drives, planners and their policies."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, get_args

from pydantic import ValidationError

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.learning import hash_of
from fuzzyq_bullet.planning import (
    PlannerSettings,
    planner_names,
    settings_for,
)
from fuzzyq_bullet.planning.controllers import rules_named
from fuzzyq_bullet.planning.fuzzy_q_lambda import policy_spec, rule_policy
from fuzzyq_bullet.planning.policies import policy_of
from fuzzyq_bullet.planning.q_learning import POLICY_SPECS
from fuzzyq_bullet.planning.registry import no_planner
from fuzzyq_bullet.planning.settings import (
    FuzzyQLambdaSettings,
    PolicySettings,
    QLambdaSettings,
    QLearningSettings,
    RoutineSettings,
)
from fuzzyq_bullet.scenario import MAX_OBSTACLES, Drive
from fuzzyq_bullet.wording import not_one_of, shorten

NONE = "none"
_TOLD = "json:"
"""What rules begin with that are no file, but what a plan holds of one."""
RULES_HELP = "Rules of your own for the planners that have some: a file (docs/how-to/rules.md)."
PAPER = ("fuzzy", "improved-fuzzy", "q-learning", "q-lambda", "fuzzy-q-lambda")
"""The planners of Fig. 13 and Table 5, in the order in which they are shown."""
GUARDED = {
    "q-learning-guarded": QLearningSettings(guard=True, breakout=True),
    "q-lambda-guarded": QLambdaSettings(guard=True, breakout=True),
}
"""The direct planners with the safety filter and the ways out of the improved ones."""
POSITIONAL = {
    "q-learning-position": QLearningSettings(),
    "q-lambda-position": QLambdaSettings(),
}
"""The direct planners with a table of places, learned in each environment before it is driven."""
VARIANTS: Mapping[str, PlannerSettings] = {**GUARDED, **POSITIONAL}
"""What studies know beside the planners themselves."""


def counts_of(text: str, option: str) -> tuple[int, ...]:
    """Return numbers of obstacles, sorted, each once; ``none`` stands for none of them.

    Args:
        text: Such as ``5,25,50``.
        option: What to call it in an error.

    Raises:
        UserError: If one is no number of obstacles that a scenario may have.
    """
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


def planner_of(name: str, weights: str | None) -> PlannerSettings:
    """Return the settings of a planner with these weights.

    Args:
        name: Name of a planner.
        weights: (ω1, ω2) as ``1,1``; None for 1 and 1 where the planner takes weights at all.

    Raises:
        UserError: If there is no such planner, or it does not take such weights.
    """
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


def with_rules(settings: PlannerSettings, rules: str | None) -> PlannerSettings:
    """Return the settings with rules of the user's own, where the planner has rules.

    Args:
        settings: The planner's.
        rules: A file, or one of ``RULE_WORDS``; ``json:…``, if a study tells it from its
            folder. None leaves the settings as they are.

    Raises:
        UserError: If the rules are wrong, or the planner has a policy that does not fit them.
    """
    if rules is None or "rules" not in type(settings).model_fields:
        return settings
    try:
        found = (
            json.loads(rules.removeprefix(_TOLD)) if rules.startswith(_TOLD) else rules_named(rules)
        )
        given = type(settings).model_validate({**settings.model_dump(), "rules": found})
        if isinstance(given, FuzzyQLambdaSettings):
            rule_policy(given)
    except UserError as error:
        raise error.under("--rules") from error
    except ValueError as error:  # JSON that is none, or not of a controller
        raise UserError(f"--rules: {shorten(rules)}: is no file of rules") from error
    return given


def rules_told(settings: Mapping[str, Any]) -> str | None:
    """Return the rules of a planner, as a study's plan tells it, as ``with_rules`` takes them."""
    rules = settings.get("rules")
    usual = rules is None or rules == RoutineSettings.model_fields["rules"].default
    return None if usual else rules if isinstance(rules, str) else _TOLD + json.dumps(rules)


def planners_of(names: str | Iterable[str], rules: str | None = None) -> dict[str, PlannerSettings]:
    """Return planners as they are set by default, each once, by their names.

    Args:
        names: Such as ``fuzzy,q-learning``; those of ``VARIANTS`` are known too.
        rules: Rules of the user's own, for those that have rules.

    Raises:
        UserError: If there is no such planner, or the rules do not fit.
    """
    chosen: dict[str, PlannerSettings] = {}
    for part in names.split(",") if isinstance(names, str) else names:
        name = part.strip()
        if name not in planner_names() and name not in VARIANTS:
            every = (*planner_names(), *VARIANTS)
            raise UserError(f"--planners: {not_one_of('planner', name, every)}")
        usual = VARIANTS.get(name)
        settings = usual or settings_for(name).model_validate({"name": name})
        chosen[name] = with_rules(settings, rules)
    return chosen


def described(planners: Mapping[str, PlannerSettings]) -> dict[str, Any]:
    """Return what the rows of planners depend on, as JSON can say it.

    A policy goes in by its contents and not by its path: after another training the same path
    means another planner.

    Args:
        planners: By what rows call them.

    Raises:
        UserError: If a policy is missing or damaged.
    """
    return {label: _described(label, settings) for label, settings in planners.items()}


def in_order(names: Sequence[str]) -> tuple[str, ...]:
    """Return names, each once: the paper's first and in its order, then the rest."""
    known = [name for name in PAPER if name in names]
    return tuple(dict.fromkeys((*known, *names)))


def _described(label: str, settings: PlannerSettings) -> dict[str, Any]:
    told = settings.model_dump(mode="json")
    if label in POSITIONAL:
        return told  # it learns what it needs by itself
    if isinstance(settings, FuzzyQLambdaSettings):
        told["policy"] = hash_of(policy_of(settings, policy_spec(settings)))
    elif isinstance(settings, PolicySettings) and settings.name in POLICY_SPECS:
        told["policy"] = hash_of(policy_of(settings, POLICY_SPECS[settings.name]))
    return told
