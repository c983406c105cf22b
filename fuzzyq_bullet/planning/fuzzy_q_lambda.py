"""The planner ``fuzzy-q-lambda``, the paper's own: the improved one with learned weights.

Every rule of the controller has learned weights of its own (``learning.fuzzy``). With φ_i the share
of rule i in all that fires,

    ω1 = Σ φ_i·ω1(j_i)        ω2 = Σ φ_i·ω2(j_i)

weigh step and turn in Eq. 17, where j_i is what rule i thinks best: a table of as many pairs as
there are rules, to be looked at with ``fuzzyq explain --policy``.
"""

from __future__ import annotations

from itertools import product
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import ValidationError

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.fuzzy import ControllerDefinition, Inference
from fuzzyq_bullet.fuzzy.rules import RuleBase
from fuzzyq_bullet.learning import Policy, PolicySpec, greedy
from fuzzyq_bullet.planning.base import Observation
from fuzzyq_bullet.planning.controllers import controller_shown
from fuzzyq_bullet.planning.decision import Decision
from fuzzyq_bullet.planning.escape.learned_exits import LEARNER, LearnedExits, seconds_of
from fuzzyq_bullet.planning.improved_fuzzy import ImprovedFuzzyBase
from fuzzyq_bullet.planning.policies import policy_of
from fuzzyq_bullet.planning.settings import FuzzyQLambdaSettings, PlannerSettings
from fuzzyq_bullet.wording import shorten


class Weights(NamedTuple):
    """What a rule may choose.

    Attributes:
        step: ω1 of Eq. 17.
        turn: ω2 of Eq. 17.
    """

    step: float
    turn: float


STEPS = (5.0, 20.0)
"""Slower near obstacles, or at full speed wherever the safety filter allows it."""
TURNS = (0.0, 0.25, 0.5)
CHOICES = tuple(Weights(*one) for one in product(STEPS, TURNS))
CHOICE_NAMES = tuple(f"ω1 {one.step:g}, ω2 {one.turn:g}" for one in CHOICES)


def rule_names(base: RuleBase) -> tuple[str, ...]:
    """Return a name for each rule, row by row of the table: what d is, then what Df is."""
    return tuple(f"{near} {side}" for near, side in product(base.row.labels, base.column.labels))


def twins_of(base: RuleBase) -> tuple[int, ...]:
    """Return the number of each rule's mirror image.

    What stood on the left is as good as what stood on the right: the set of the difference that
    lies furthest to one side stands for that which lies furthest to the other.
    """
    columns = range(len(base.column.sets))
    by_center = sorted(columns, key=lambda column: base.column.sets[column].center)
    opposite = dict(zip(by_center, reversed(by_center), strict=True))
    rows = range(len(base.row.sets))
    return tuple(row * len(columns) + opposite[column] for row in rows for column in columns)


def policy_spec(settings: FuzzyQLambdaSettings) -> PolicySpec:
    """Return what its policies look like: a row for each rule."""
    names = rule_names(controller_shown(settings).base)
    return PolicySpec("fuzzy-q-lambda", names, CHOICE_NAMES, "fuzzy-q-lambda")


def firing(inferred: Inference) -> NDArray[np.float64]:
    """Return φ, shape (R,): the share of each rule in all that fires (Eq. 2), row by row."""
    strengths = np.array(inferred.rules).ravel()
    total = float(strengths.sum())
    return strengths / total if total > 0.0 else np.full(strengths.size, 1.0 / strengths.size)


def learned_policy(file: str | None, rules: ControllerDefinition | None = None) -> Policy:
    """Return the policy in a file, or without one that which is shipped.

    Args:
        file: The policy.
        rules: The rules that it weighs; by default those of Table 4.

    Raises:
        UserError: If there is none, or none of this planner.
    """
    try:
        settings = FuzzyQLambdaSettings(policy=file)
        if rules is not None:
            settings = settings.model_copy(update={"rules": rules})
    except ValidationError as error:
        why = error.errors(include_url=False)[0]["msg"]
        raise UserError(f"policy: {shorten(file)}: {why}") from error
    if field_policy(settings) is not None:
        raise UserError(
            f"{file}: tells what the ways out of a field are worth, not how rules weigh"
        )
    return rule_policy(settings)


def rule_policy(settings: FuzzyQLambdaSettings) -> Policy:
    """Return the weights of the rules: the shipped ones where the policy is that of a field.

    Raises:
        UserError: If the policy cannot be used.
    """
    if field_policy(settings) is not None:
        settings = settings.model_copy(update={"policy": None})
    spec = policy_spec(settings)
    if settings.policy is None and spec.states != policy_spec(FuzzyQLambdaSettings()).states:
        raise UserError(
            "the shipped policy weighs rules with the labels of Table 4; learn with these: "
            "fuzzyq train fuzzy-q-lambda --rules FILE, and name the policy; or drive them with "
            "improved-fuzzy"
        )
    return policy_of(settings, spec)


def field_policy(settings: PlannerSettings) -> Policy | None:
    """Return the policy if it is one of a field, which holds what its ways out are worth.

    Raises:
        UserError: If it cannot be used.
    """
    if not isinstance(settings, FuzzyQLambdaSettings) or settings.policy is None:
        return None
    policy = policy_of(settings)
    if (policy.planner, policy.learner) != (settings.name, LEARNER):
        return None
    if not (settings.breakout and settings.following):
        raise UserError(
            f"{settings.policy}: tells which ways out to take, and the planner takes none; "
            "leave breakout and following on"
        )
    return policy


def weights_of(policy: Policy) -> NDArray[np.float64]:
    """Return what each rule thinks best, (ω1, ω2), shape (R, 2)."""
    return np.array([CHOICES[greedy(values)] for values in policy.table])


def weighed(shares: NDArray[np.float64], weights: NDArray[np.float64]) -> tuple[float, float]:
    """Return (ω1, ω2) in force.

    Args:
        shares: φ, shape (R,).
        weights: Those of each rule, shape (R, 2).
    """
    # Added row by row: matrix products round differently on other processors.
    step, turn = (weights * shares[:, np.newaxis]).sum(axis=0).tolist()
    return step, turn


class FuzzyQLambdaPlanner(ImprovedFuzzyBase):
    """Weighs what the controller says by what each rule that fires has learned.

    Args:
        settings: The planner's settings; they name what it learned.

    Raises:
        UserError: If that cannot be used.
    """

    def __init__(self, settings: FuzzyQLambdaSettings) -> None:
        super().__init__(settings)
        self._weights = weights_of(rule_policy(settings))
        field = field_policy(settings)
        if field is not None:
            self.choose_exits_by(LearnedExits(seconds_of(field, str(settings.policy))).judge)

    def decide(self, observation: Observation, /) -> Decision:
        """Return the decision with the weights of the rules that fire (Step 10)."""
        situation = self.sense(observation)
        weights = weighed(firing(situation.inferred), self._weights)
        return self.act(observation, situation, weights)
