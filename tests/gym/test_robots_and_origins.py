"""The environments with other robots and with an arena that does not begin at (0, 0)."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
import pytest

import fuzzyq_bullet
from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.scenario import Scenario

FIELD = {
    "name": "s",
    "arena": {"size": [10, 8], "origin": [-42, 30]},
    "start": {"position": [-40, 31]},
    "goal": {"position": [-33, 36]},
    "obstacles": [{"shape": "cylinder", "position": [-37, 33.2], "radius": 0.5}],
}


def made(kind: str, **more: Any) -> Any:
    assert fuzzyq_bullet.__version__  # importing the package makes the environments known
    scenario = Scenario.model_validate({**FIELD, **more})
    return gymnasium.make(f"fuzzyq_bullet/{kind}-v0", scenario=scenario)


@pytest.mark.parametrize("kind", ["Weights", "Navigation"])
@pytest.mark.parametrize("model", ["turtlebot3-burger", "jackal"])
def test_what_is_seen_stays_within_its_bounds(kind: str, model: str) -> None:
    env = made(kind, robot={"model": model})
    seen, _ = env.reset(seed=1)
    assert env.observation_space.contains(seen)
    for _ in range(5):
        seen, reward, *_ = env.step(np.zeros(2, dtype=np.float32))
        assert env.observation_space.contains(seen)
        assert np.isfinite(reward)
    env.close()


@pytest.mark.parametrize("kind", ["Weights", "Navigation"])
def test_via_points_are_refused_in_one_line(kind: str) -> None:
    with pytest.raises(UserError, match="leave out the via points") as told:
        made(kind, via=[{"position": [-37, 36]}])
    assert len(told.value.problems) == 1
