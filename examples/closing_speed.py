"""The default planner with three closing speeds (m/s), as planners of their own to be compared.

Run it with::

    fuzzyq bench field --kinds moving --runs 25 --plugin examples/closing_speed.py \
      --planners fuzzy-q-lambda,closing-0.2,closing-0.5,closing-1.0
"""

from typing import Literal

from pydantic import create_model

from fuzzyq_bullet.planning import FuzzyQLambdaPlanner, FuzzyQLambdaSettings, register_planner
from fuzzyq_bullet.planning.settings import GuardedSettings

for speed in (0.2, 0.5, 1.0):
    name = f"closing-{speed}"
    settings = create_model(
        name,
        __base__=GuardedSettings,
        __doc__=f"The default planner, which reckons with {speed} m/s.",
        name=(Literal[name], name),
        closing_speed=(float, speed),
    )
    register_planner(name, settings, lambda _, rng: FuzzyQLambdaPlanner(FuzzyQLambdaSettings()))
