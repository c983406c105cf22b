"""A sensor in a file of one's own, asked for by a scenario and driven through the command line."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from fuzzyq_bullet.recording.trajectory import Trajectory

EXAMPLE = Path(__file__).parents[2] / "examples" / "extend" / "sensor.py"
SCENARIO = """\
name: rounded
arena: {size: [4.0, 3.0]}
start: {position: [0.6, 1.5]}
goal: {position: [3.2, 1.5]}
planner: {name: improved-fuzzy, weights: [1.0, 1.0]}
sensor: {model: SENSOR}
obstacles: [{shape: cylinder, position: [2.0, 1.3], radius: 0.2}]
"""


@pytest.fixture(scope="module")
def runs(fuzzyq, tmp_path_factory):
    folder = tmp_path_factory.mktemp("sensor")
    records = {}
    for name in ("exact", "rounded, step: 0.1"):
        path = folder / f"{name[:5]}.yaml"
        path.write_text(SCENARIO.replace("SENSOR", name))
        out = folder / name[:5]
        done = fuzzyq("run", path, "--plugin", EXAMPLE, "--no-video", "--json", "--out", out)
        assert done.returncode == 0, done.stderr
        assert json.loads(done.stdout)["outcome"] == "goal"
        records[name[:5]] = Trajectory.load(out / "rounded.npz")
    return records


def test_what_the_planner_is_told_is_what_the_sensor_measures(runs):
    # Of the two, only the rays' lengths are rounded: a line is that of one ray, less the way to
    # its rim, of which there are six.
    for name, many in (("exact", True), ("round", False)):
        lengths = runs[name].decisions.lengths
        met = np.unique(lengths[lengths < 1.0].round(9))
        fractions = np.unique((met % 0.1).round(6))
        assert met.size > 5
        assert (fractions.size > 7) == many, name


def test_a_record_of_a_sensor_that_is_not_there_any_more_is_read(runs):
    # The plugin was loaded in another process.
    assert runs["round"].scenario.sensor.model == "rounded"


def test_without_the_plugin_the_scenario_is_refused_in_one_line(inside, tmp_path):
    from fuzzyq_bullet.errors import UserError

    path = tmp_path / "rounded.yaml"
    path.write_text(SCENARIO.replace("SENSOR", "rounded"))
    with pytest.raises(UserError, match=r"yaml:6: sensor\.model: no model 'rounded'"):
        inside("run", path)
