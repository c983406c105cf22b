"""How much of a run the fuzzy rules drive, and records of version 0.1.0, which do not say it."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import pytest

from fuzzyq_bullet import Trajectory, load_scenario, result_of, run
from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.recording.rules_turn import asked
from fuzzyq_bullet.scenario import with_options
from tests.helpers.synthetic import drive, modes

if TYPE_CHECKING:
    from pathlib import Path


def turned(*degrees: float, exact: tuple[float, ...]) -> Trajectory:
    """Return a record whose first rules turn by these angles, with A_p = 45° and ω2 = 0.5."""
    record = drive(seconds=3.0, outcome="timeout")
    count = len(record.decisions.tick)
    turn, precise = np.zeros(count), np.zeros(count)
    turn[: len(degrees)] = np.array(degrees) / 45.0 / 0.5
    precise[: len(exact)] = exact
    weights = np.tile((3.0, 0.5), (count, 1))
    return replace(
        record, decisions=replace(record.decisions, turn=turn, exact=precise, weights=weights)
    )


def test_a_turn_counts_from_3_degrees_on_and_only_where_the_rules_are_asked() -> None:
    record = turned(3.1, -3.1, 2.9, -2.9, 30.0, 30.0, exact=(0, 0, 0, 0, 0, 1))
    near = record.ticks.clearance[record.decisions.tick] < 1.0
    assert near[:6].all()
    assert result_of(record).rules_turn == round(3 / near.sum(), 6)


def test_where_nothing_is_within_range_there_is_nothing_to_turn_for() -> None:
    record = turned(30.0, exact=(0.0,))
    ticks = replace(record.ticks, clearance=np.full_like(record.ticks.clearance, 1.01))
    assert result_of(replace(record, ticks=ticks)).rules_turn is None


def test_a_planner_without_rules_has_no_share() -> None:
    assert result_of(drive(seconds=1.0, explained=False)).rules_turn is None


def test_rules_that_never_turn_have_a_share_of_nothing() -> None:
    assert result_of(turned(0.0, exact=(0.0,))).rules_turn == 0.0


def test_the_share_of_a_real_run_is_that_of_its_headings() -> None:
    scenario = with_options(load_scenario("figure-10b"), drive="kinematic")
    record = run(scenario)
    facts = record.decisions
    # The point robot's safety filter changes no heading: what is off the middle line is the rules'.
    lean = np.remainder(facts.heading - facts.lines[:, 1] + math.pi, math.tau) - math.pi
    near = record.ticks.clearance[facts.tick] < 1.0
    share = float((np.abs(lean[near]) > math.radians(3.0)).mean())
    assert 0.0 < share < 1.0
    assert result_of(record).rules_turn == pytest.approx(share, abs=1e-6)


def without(record: Trajectory, path: Path, *names: str) -> Path:
    """Write a record that lacks some of its arrays."""
    record.save(path)
    with np.load(path) as archive:
        arrays = {name: archive[name] for name in archive.files if name not in names}
    np.savez(path, **arrays)
    return path


def test_a_record_of_version_0_1_0_is_read_and_has_all_its_figures(tmp_path: Path) -> None:
    record = modes(drive(seconds=3.0, outcome="timeout"), (0, 0.5), (2, 0.5))
    old = Trajectory.load(without(record, tmp_path / "x.npz", "decisions.aim", "decisions.exact"))
    count = len(record.decisions.tick)
    assert old.decisions.aim.shape == (count, 2)
    assert np.isnan(old.decisions.aim).all()
    assert np.isnan(old.decisions.exact).all()
    assert (old.decisions.heading == record.decisions.heading).all()
    # Its ways out decided in place of the rules.
    assert (asked(old.decisions) == (record.decisions.mode == 0)).all()
    assert result_of(old).rules_turn is not None
    assert old.csv("decisions").splitlines()[1].endswith(",,,")  # aim x, aim y and exact are blank
    old.save(tmp_path / "again.npz")
    assert Trajectory.load(tmp_path / "again.npz") == old


@pytest.mark.parametrize("name", ["decisions.heading", "decisions.tick", "ticks.clearance"])
def test_a_record_without_what_moved_the_robot_is_damaged(name: str, tmp_path: Path) -> None:
    path = without(drive(seconds=1.0), tmp_path / "x.npz", name)
    with pytest.raises(UserError, match=f"{name} is missing"):
        Trajectory.load(path)
