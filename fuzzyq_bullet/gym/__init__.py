"""The Gymnasium door: two learning problems.

    import gymnasium
    import fuzzyq_bullet

    env = gymnasium.make("fuzzyq_bullet/Navigation-v0")

PyBullet is loaded only when an environment is made.
"""

import gymnasium

from fuzzyq_bullet.gym_ids import ENVIRONMENTS, register_in


def register() -> None:
    """Make the environments known to Gymnasium; a second call does nothing."""
    register_in(gymnasium)


register()

__all__ = ["ENVIRONMENTS", "register"]
