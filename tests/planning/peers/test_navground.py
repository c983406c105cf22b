"""Navground's behaviours through their own package; skipped where it is not installed."""

from __future__ import annotations

import importlib.util
import sys

import numpy as np
import pytest

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.planning import NavgroundSettings, make_planner
from tests.planning.peers.helpers import drive

CYLINDER = {"shape": "cylinder", "position": [5.0, 5.05], "radius": 0.3}
there = pytest.mark.skipif(
    importlib.util.find_spec("navground") is None, reason="navground is not installed"
)


def test_without_the_package_one_line_says_how_to_get_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "navground.core", None)
    with pytest.raises(UserError, match=r"pip install 'fuzzyq_bullet\[peers\]'") as error:
        make_planner(NavgroundSettings(), np.random.default_rng(0))
    assert "\n" not in str(error.value)


@pytest.mark.skipif(importlib.util.find_spec("navground") is not None, reason="it is installed")
def test_a_study_without_the_package_is_refused_before_it_drives(fuzzyq, tmp_path):
    few = ("--planners", "navground", "--kinds", "scatter", "--runs", "1", "--jobs", "1")
    done = fuzzyq("bench", "field", *few, "--out", "out", cwd=tmp_path, timeout=120)
    assert done.returncode == 2
    [line] = done.stderr.splitlines()
    assert "pip install 'fuzzyq_bullet[peers]'" in line
    assert not list((tmp_path / "out").glob("*.csv"))


@there
@pytest.mark.parametrize("behavior", ["HL", "ORCA", "HRVO"])
def test_each_behavior_passes_one_obstacle(behavior):
    record = drive({"name": "navground", "behavior": behavior}, [CYLINDER])
    assert record.outcome == "goal"
    assert record.ticks.time[-1] < 25.0


@there
def test_it_is_the_named_behavior_with_its_properties_that_drives():
    times = {
        behavior: drive(
            {"name": "navground", "behavior": behavior, "properties": properties}, [CYLINDER]
        ).ticks.time[-1]
        for behavior, properties in (("HL", {}), ("ORCA", {}), ("HRVO", {}))
    }
    assert len(set(times.values())) == 3
    slow = drive({"name": "navground", "properties": {"eta": 3.0}}, [CYLINDER]).ticks.time[-1]
    assert slow > times["HL"]  # it keeps three seconds from what is ahead, not half of one


@there
def test_a_property_that_the_behavior_does_not_have_is_one_line():
    settings = NavgroundSettings(behavior="ORCA", properties={"eta": 0.2})
    with pytest.raises(UserError, match="ORCA has no 'eta'; it has effective_center"):
        make_planner(settings, np.random.default_rng(0))
