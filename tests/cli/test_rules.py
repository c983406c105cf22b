"""Rules and sets of one's own: from a file to the run, its record, its film and what is learned."""

from __future__ import annotations

import csv
import io
import json
import re
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pytest

from fuzzyq_bullet import Trajectory, frame, load_scenario, with_options
from fuzzyq_bullet import episode as episodes
from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.fuzzy import (
    ControllerDefinition,
    load_controller,
    paper_definition,
    save_controller,
)
from fuzzyq_bullet.planning import PlannerSettings
from fuzzyq_bullet.planning.controllers import fields_with
from fuzzyq_bullet.scenario import realise
from fuzzyq_bullet.scenario.files import dump_scenario, parse_scenario
from fuzzyq_bullet.video import paint
from fuzzyq_bullet.video.compositor import Compositor
from fuzzyq_bullet.video.timeline import Timeline
from tests.helpers.rules import SMOOTH, THREE

if TYPE_CHECKING:
    from collections.abc import Callable

    from tests.helpers.commands import Call

FIELD = """\
name: mine
start: {{position: [1, 5]}}
goal: {{position: [9, 5]}}
drive: kinematic
planner: {{name: {planner}, rules: {rules}}}
obstacles:
  - {{shape: cylinder, position: [4.0, 5.1], radius: 0.3}}
  - {{shape: cylinder, position: [6.0, 4.8], radius: 0.3}}
"""


@pytest.fixture
def field(tmp_path: Path) -> Callable[..., Path]:
    """Write a scenario beside two files of rules."""
    (tmp_path / "three.yaml").write_text(THREE)
    (tmp_path / "smooth.yaml").write_text(SMOOTH)
    (tmp_path / "named.yaml").write_text(THREE.replace("near:", "closeby:"))

    def write(rules: str = "three.yaml", planner: str = "improved-fuzzy") -> Path:
        (tmp_path / "mine.yaml").write_text(FIELD.format(rules=rules, planner=planner))
        return tmp_path / "mine.yaml"

    return write


def drive(path: Path) -> Trajectory:
    return episodes.run(load_scenario(path))


# Driving


def test_too_few_points_for_a_set_are_refused_where_the_planner_asks_for_them(
    field: Callable[..., Path], fuzzyq: Call, tmp_path: Path
) -> None:
    narrow = SMOOTH.replace("trapezoidal: [0, 0, 0.4, 0.9]", "triangular: [0.198, 0.2, 0.202]")
    (tmp_path / "narrow.yaml").write_text(narrow)
    why = "with 5 points, none belongs to the set short of step: take more"
    with pytest.raises(UserError, match=rf"mine.yaml:5: planner.samples: {why}$"):
        load_scenario(field("narrow.yaml, samples: 5"))
    load_scenario(field("narrow.yaml, samples: 11"))
    done = fuzzyq("explain", "1", "0", "--rules", tmp_path / "narrow.yaml", "--samples", "5")
    assert (done.returncode, done.stderr) == (2, f"error: --samples: {why}\n")


def test_the_rules_of_a_file_drive_and_the_record_holds_them(
    field: Callable[..., Path], tmp_path: Path
) -> None:
    run = drive(field())
    assert run.outcome == "goal"
    assert run.decisions.rules.shape[1:] == (3, 3)
    assert (run.decisions.near.max(axis=1) > 0).all()
    run.save(tmp_path / "run.npz")
    (tmp_path / "three.yaml").unlink()
    back = Trajectory.load(tmp_path / "run.npz")
    assert back == run
    assert episodes.run(back.scenario).digest() == run.digest()


def test_the_papers_own_controller_is_such_a_file(
    field: Callable[..., Path], tmp_path: Path
) -> None:
    for table in ("corrected", "printed"):
        save_controller(paper_definition(table), tmp_path / "paper.yaml")
        assert drive(field("paper.yaml")).digest() == drive(field(table)).digest()


def test_a_set_that_is_moved_changes_the_run(field: Callable[..., Path], tmp_path: Path) -> None:
    before = drive(field("smooth.yaml"))
    text = SMOOTH.replace("near: {gaussian: [0, 1.5]}", "near: {gaussian: [2, 1.5]}")
    assert text != SMOOTH
    (tmp_path / "smooth.yaml").write_text(text)
    assert drive(field("smooth.yaml")).digest() != before.digest()


def test_another_planner_takes_the_rules_over(field: Callable[..., Path]) -> None:
    asked = with_options(load_scenario(field()), planner="fuzzy")
    assert episodes.run(asked).decisions.rules.shape[1:] == (3, 3)


def test_the_samples_of_the_file_count_unless_the_planner_has_its_own(
    field: Callable[..., Path], tmp_path: Path
) -> None:
    few = SMOOTH + "inference: {samples: 5}\n"
    (tmp_path / "few.yaml").write_text(few)
    coarse, fine = drive(field("few.yaml")), drive(field("smooth.yaml"))
    told = drive(field("smooth.yaml, samples: 5"))
    assert coarse.digest() == told.digest() != fine.digest()


def test_a_scenario_is_written_with_its_rules_and_read_back(field: Callable[..., Path]) -> None:
    scenario = load_scenario(field())
    assert parse_scenario(dump_scenario(scenario)) == scenario


# What is told


def test_csv_names_the_labels_of_the_rules_that_were_asked(field: Callable[..., Path]) -> None:
    run = drive(field())
    rows = list(csv.DictReader(io.StringIO(run.csv("decisions"))))
    assert [name for name in rows[0] if name.startswith("near_")] == [
        "near_near", "near_middle", "near_far",
    ]  # fmt: skip
    table = np.array(
        [[float(row[f"rules_{a}_{b}"]) for a in ("near", "middle", "far")
          for b in ("right", "alike", "left")] for row in rows]
    )  # fmt: skip
    assert table == pytest.approx(run.decisions.rules.reshape(len(rows), 9))


def test_the_film_shows_the_sets_that_were_asked(
    field: Callable[..., Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    written: list[str] = []
    real = paint.write

    def write(image: object, at: object, text: str, *args: object, **more: object) -> None:
        written.append(text)
        real(image, at, text, *args, **more)  # type: ignore[arg-type]

    monkeypatch.setattr(paint, "write", write)
    run = drive(field())
    with Compositor(run) as compositor:
        list(compositor.changes(Timeline(run).at(float(run.ticks.time[-1]) / 2)))
    assert {"near", "middle", "far", "alike"} < set(written)
    assert "VN" not in written


def test_labels_that_would_give_columns_one_name_are_told_apart() -> None:
    columns = fields_with(("A", "A_B"), ("B_C", "C"))
    assert columns["near"].names("near") == ["near_A", "near_A_B"]
    assert columns["rules"].names("rules") == [
        "rules:A:B_C", "rules:A:C", "rules:A_B:B_C", "rules:A_B:C"
    ]  # fmt: skip


def test_a_record_of_an_unknown_planner_keeps_its_table(
    field: Callable[..., Path], tmp_path: Path
) -> None:
    run = drive(field())
    elsewhere = replace(
        run, scenario=run.scenario.model_copy(update={"planner": PlannerSettings(name="theirs")})
    )
    elsewhere.save(tmp_path / "run.npz")
    back = Trajectory.load(tmp_path / "run.npz")
    assert np.array_equal(back.decisions.rules, run.decisions.rules)
    assert "rules_1_3" in back.csv("decisions").splitlines()[0].split(",")


def test_mcap_names_the_labels_of_the_rules_that_were_asked(field: Callable[..., Path]) -> None:
    pytest.importorskip("foxglove", reason="the extra mcap is not installed")
    from fuzzyq_bullet.export.mcap import mcap_of

    assert mcap_of(drive(field()))  # a table that is not 5 by 5
    assert b"closeby" in mcap_of(drive(field("named.yaml")))


def test_the_film_shows_the_freer_side_on_its_side_in_whatever_order_the_sets_stand(
    field: Callable[..., Path], tmp_path: Path
) -> None:
    told = load_controller(field().with_name("three.yaml")).model_dump(mode="json")
    side = told["inputs"]["difference"]["sets"]
    told["inputs"]["difference"]["sets"] = dict(reversed(side.items()))
    told["rules"] = {label: row[::-1] for label, row in told["rules"].items()}
    save_controller(ControllerDefinition.model_validate(told), tmp_path / "turned.yaml")
    run, turned = drive(field()), drive(field("turned.yaml"))
    middle = float(run.ticks.time[-1]) / 2
    table = np.s_[498:710, 616:890]  # panel 3
    assert np.array_equal(frame(run, middle)[table], frame(turned, middle)[table])


def test_words_are_words_and_no_markup(field: Callable[..., Path], inside: Call) -> None:
    path = field().with_name("three.yaml")
    path.write_text(THREE.replace("words: right freer", 'words: "[/red]"'))
    assert "[/red]" in inside("explain", 1.2, -0.8, "--rules", path).stdout


# Mistakes


@pytest.mark.parametrize(
    ("rules", "told"),
    [
        (
            "corected",
            "planner.rules: got 'corected'; did you mean 'corrected'? allowed: corrected,",
        ),
        ("nowhere.yaml", "nowhere.yaml: cannot be read: No such file or directory"),
        ("wrong.yaml", "wrong.yaml:7: inputs.distance.sets.middle.triangular: needs 3 values"),
        ("{inputs: 1}", "planner.rules.inputs: expected a mapping (key: value), got 1"),
        ("7", "planner.rules: must be corrected, printed, none, or a controller"),
    ],
)
def test_wrong_rules_get_one_line_in_the_scenario(
    rules: str, told: str, field: Callable[..., Path], tmp_path: Path
) -> None:
    (tmp_path / "wrong.yaml").write_text(THREE.replace("[1, 2.5, 4]", "[1, 2.5]"))
    with pytest.raises(UserError) as caught:
        load_scenario(field(rules))
    assert any(told in one for one in caught.value.problems)
    assert all(one.startswith(f"{tmp_path}/mine.yaml:5: planner.rules")
               for one in caught.value.problems)  # fmt: skip


def test_a_gap_is_told_before_a_run(
    field: Callable[..., Path], tmp_path: Path, inside: Call
) -> None:
    path = field()
    gappy = THREE.replace("[1, 2.5, 4]", "[1.5, 2.5, 4]")
    gappy = gappy.replace("[0, 0, 1, 2.5]", "[0, 0, 0.5, 1]")
    (tmp_path / "three.yaml").write_text(gappy)
    told = inside("validate", path).stderr
    assert "mine.yaml:5: planner.rules: inputs.distance.sets: from 1 to 1.5 belongs to no" in told


def test_the_shipped_policy_does_not_weigh_other_labels(field: Callable[..., Path]) -> None:
    with pytest.raises(UserError, match="fuzzyq train fuzzy-q-lambda --rules FILE"):
        load_scenario(field(planner="fuzzy-q-lambda"))


# Commands


def test_explain_exports_what_explain_reads(tmp_path: Path, inside: Call) -> None:
    answers = []
    for name in ("a.yaml", "a.fll", "a.fis"):
        assert inside("explain", "--export", tmp_path / name).returncode == 0
        shown = inside("explain", 1.2, -0.8, "--rules", tmp_path / name, "--json").stdout
        answers.append(json.loads(shown))
    paper = json.loads(inside("explain", 1.2, -0.8, "--json").stdout)
    assert all(one["turn"] == paper["turn"] and one["stride"] == paper["stride"] for one in answers)
    own = tmp_path / "a.yaml"
    with pytest.raises(UserError, match="is there already; --replace replaces it"):
        inside("explain", "--export", own)
    with pytest.raises(UserError, match=r"a\.yaml"):
        inside("explain", "--rules", own, "--export", own, "--replace")
    assert load_controller(tmp_path / "a.yaml") == paper_definition()


def test_an_exported_table_says_that_explain_and_film_turn_its_columns_round(
    tmp_path: Path, inside: Call
) -> None:
    inside("explain", "--export", tmp_path / "a.yaml")
    text = (tmp_path / "a.yaml").read_text()
    shown = re.search(r"show these columns in another order: (.+)\.\n  # +(.+)\n", text)
    assert shown is not None
    head = next(
        line for line in inside("explain", 1.2, -0.8).stdout.splitlines() if "d \\ Df" in line
    )
    assert shown[1].split(", ") == head.split()[3:] == shown[2].split()[::-1]
    told = load_controller(tmp_path / "a.yaml").model_dump(mode="json")
    side = told["inputs"]["difference"]["sets"]
    told["inputs"]["difference"]["sets"] = dict(reversed(side.items()))
    told["rules"] = {label: row[::-1] for label, row in told["rules"].items()}
    save_controller(ControllerDefinition.model_validate(told), tmp_path / "b.yaml")
    assert "in another order" not in (tmp_path / "b.yaml").read_text()


def test_explain_shows_a_table_of_any_size(field: Callable[..., Path], inside: Call) -> None:
    path = field().with_name("three.yaml")
    page = inside("explain", 1.2, -0.8, "--rules", path).stdout
    assert "Rules (three by three): [turn step]" in page
    assert "Columns left: the left is freer; right: the right is freer." in page
    assert "if d is near (0.87)" in page
    with pytest.raises(UserError, match=r"--rules: nowhere\.yaml: cannot be read"):
        inside("explain", 1, 1, "--rules", "nowhere.yaml")


def test_figure_4_shows_the_surface_of_ones_own_rules(
    field: Callable[..., Path], tmp_path: Path, inside: Call
) -> None:
    path = field().with_name("three.yaml")
    for out, rules in (("own", [path]), ("paper", [])):
        more = ["--rules", *rules] if rules else []
        assert inside("figure", 4, "--out", tmp_path / out, *more).returncode == 0
    own, paper = tmp_path / "own" / "figure4-three.png", tmp_path / "paper" / "figure4.png"
    assert own.read_bytes() != paper.read_bytes()
    with pytest.raises(UserError, match="--rules: figure '9' shows no controller"):
        inside("figure", 9, "--rules", path, "--out", tmp_path)


@pytest.mark.slow
def test_a_bench_compares_planners_with_ones_own_rules(
    field: Callable[..., Path], tmp_path: Path, inside: Call
) -> None:
    path = field().with_name("three.yaml")
    out = tmp_path / "bench"
    done = inside(
        "bench", "success", "--planners", "fuzzy,improved-fuzzy,q-learning", "--counts", 5,
        "--runs", 1, "--rules", path, "--out", out,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    planners = json.loads((out / "settings.json").read_text())["planners"]
    assert planners["fuzzy"]["rules"]["name"] == "three by three"
    assert "rules" not in planners["q-learning"]
    for wrong in ("{}", "{x.yaml", '{"a": 1}'):
        with pytest.raises(UserError, match="--rules: "):
            inside("bench", "success", "--planners", "fuzzy", "--rules", wrong, "--out", out)
    with pytest.raises(UserError, match="--rules: the shipped policy"):
        inside("bench", "success", "--planners", "fuzzy-q-lambda", "--rules", path, "--out", out)


def test_the_weights_of_ones_own_rules_are_learned_and_drive(
    field: Callable[..., Path], tmp_path: Path, inside: Call
) -> None:
    path, out = field().with_name("three.yaml"), tmp_path / "policy.json"
    done = inside(
        "train", "fuzzy-q-lambda", "--rules", path, "--episodes", 2, "--out", out, "--json"
    )
    assert done.returncode == 0, done.stderr
    policy = json.loads(out.read_text())
    assert policy["states"][:2] == ["near right", "near alike"]
    assert len(policy["states"]) == 9
    assert f"--rules {path}" in policy["command"]
    assert policy["parameters"]["rules"] == load_controller(path).digest()
    run = drive(field("three.yaml, policy: policy.json", "fuzzy-q-lambda"))
    assert run.decisions.rules.shape[1:] == (3, 3)
    weights = inside("explain", "--rules", path, "--policy", out, "--json")
    assert len(json.loads(weights.stdout)["weights"]) == 9
    with pytest.raises(UserError, match="--rules: q-learning has no rules"):
        inside("train", "q-learning", "--rules", path)


def test_a_field_is_learned_with_the_rules_of_its_scenario(field: Callable[..., Path]) -> None:
    from fuzzyq_bullet.training.config import config_for, tasks_for
    from fuzzyq_bullet.training.field import FieldTask

    save_controller(paper_definition("printed"), field().with_name("printed.yaml"))
    config = config_for("fuzzy-q-lambda", 1, None, None, str(field("printed.yaml")))
    task = tasks_for(config)
    assert isinstance(task, FieldTask)
    assert task.settings.rules == paper_definition("printed")
    assert realise(task.scenario).planner.name == "fuzzy-q-lambda"
