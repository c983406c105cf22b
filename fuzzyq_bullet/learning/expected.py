"""Whether a policy is one that a planner can use."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.learning.plain_json import shown

if TYPE_CHECKING:
    from collections.abc import Sequence

    from fuzzyq_bullet.learning.policy import Policy


@dataclass(frozen=True, slots=True)
class Expected:
    """What a planner needs of a policy.

    Attributes:
        planner: The planner's name.
        learner: How the table is to be read; None if any will do.
        states: What each row must mean.
        actions: What each column must mean.
    """

    planner: str
    states: Sequence[str]
    actions: Sequence[str]
    learner: str | None = None

    def check(self, policy: Policy, where: str) -> None:
        """Make sure that a policy fits.

        Args:
            policy: The policy.
            where: What to call it in the message, usually its path.

        Raises:
            UserError: If it does not; one line.
        """
        if policy.planner != self.planner:
            raise UserError(
                f"{where}: is a policy of the planner {shown(policy.planner)}; "
                f"one of {self.planner!r} is needed"
            )
        if self.learner is not None and policy.learner != self.learner:
            raise UserError(
                f"{where}: was learned by {shown(policy.learner)}; {self.planner} needs one that "
                f"was learned by {self.learner!r}"
            )
        for what, given, needed in (
            ("states", policy.states, self.states),
            ("actions", policy.actions, self.actions),
        ):
            if len(given) != len(needed):
                raise UserError(
                    f"{where}: has {len(given)} {what}; {self.planner} has {len(needed)}"
                )
            for i, (one, other) in enumerate(zip(given, needed, strict=True)):
                if one != other:
                    raise UserError(
                        f"{where}: {what}: number {i} is {shown(one)}; "
                        f"that of {self.planner} is {shown(other)}"
                    )
