"""A reward of one's own for training: minus the seconds lost, and minus something for turning.

    fuzzyq train fuzzy-q-lambda --reward gentle --plugin examples/extend/reward.py

The policy says in ``parameters`` what it was rewarded for.
"""

from __future__ import annotations

from fuzzyq_bullet.geometry import wrap_angle
from fuzzyq_bullet.training.rewards import Transition, register_reward

TURNING = 0.5
"""What a radian of turning costs (s)."""


@register_reward("gentle")
def gentle(step: Transition) -> float:
    """Return the reward of one step: minus the seconds lost, and minus the turning."""
    delay = step.after.time - step.before.time - step.nearer / step.max_speed
    turned = abs(wrap_angle(step.after.heading - step.before.heading))
    penalty = 30.0 if step.outcome == "collision" else 0.0
    return -delay - TURNING * turned - penalty
