"""The Gymnasium door: two learning problems, registered when this is imported.

    import gymnasium
    import fuzzyq_bullet.gym

    env = gymnasium.make("fuzzyq_bullet/Navigation-v0")

``gymnasium.make("fuzzyq_bullet.gym:fuzzyq_bullet/Navigation-v0")`` needs no import of its own.
PyBullet is loaded only when an environment is made.
"""

import gymnasium

ENVIRONMENTS = {
    "fuzzyq_bullet/Navigation-v0": "fuzzyq_bullet.gym.navigation:NavigationEnv",
    "fuzzyq_bullet/Weights-v0": "fuzzyq_bullet.gym.weights:WeightsEnv",
}
"""The class of each environment by its id."""


def register() -> None:
    """Make the environments known to Gymnasium; a second call does nothing."""
    for name, entry_point in ENVIRONMENTS.items():
        if name not in gymnasium.registry:
            gymnasium.register(id=name, entry_point=entry_point)


register()

__all__ = ["ENVIRONMENTS", "register"]
