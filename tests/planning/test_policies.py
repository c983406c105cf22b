"""Where a planner's policy comes from, and what is said when it is not there."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.planning.policies import SHIPPED, policy_of, shipped
from fuzzyq_bullet.planning.q_learning import POLICY_SPECS
from fuzzyq_bullet.planning.settings import PolicySettings
from fuzzyq_bullet.training.config import SHIPPED as TRAININGS

if TYPE_CHECKING:
    from pathlib import Path

SPEC = POLICY_SPECS["q-learning"]


def test_a_planner_without_a_shipped_policy_is_told_to_learn_one_and_to_name_it() -> None:
    with pytest.raises(UserError, match=r"train mine, and name it as planner.policy; none is ship"):
        policy_of(PolicySettings(name="mine"), SPEC)


def test_a_named_policy_that_is_not_there_is_to_be_made(tmp_path: Path) -> None:
    settings = PolicySettings(name="q-learning", policy=str(tmp_path / "none.json"))
    with pytest.raises(UserError, match=r"none.json: .* make one with fuzzyq train q-learning$"):
        policy_of(settings, SPEC)


def test_what_is_shipped_is_there_and_is_what_is_trained() -> None:
    assert set(SHIPPED) == set(TRAININGS)
    assert all(shipped(name).is_file() for name in SHIPPED)
