"""``fuzzyq bench field``: all planners meet the same fields; tables are arithmetic over rows."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any

import pytest

from fuzzyq_bullet import Decision, Observation, UserError
from fuzzyq_bullet.scenario import Scenario, load_scenario, realise
from fuzzyq_bullet.studies.episodes import OF_MACHINE, Job, Row, from_csv
from fuzzyq_bullet.studies.escape.bounds import drive_shortest_path
from fuzzyq_bullet.studies.escape.table import TRAPS
from fuzzyq_bullet.studies.field.drive import Timed, drive_bound, work
from fuzzyq_bullet.studies.field.paired import better_table, paired
from fuzzyq_bullet.studies.field.plan import BOUND, KINDS, FieldPlan
from fuzzyq_bullet.studies.field.study import AgainstField
from fuzzyq_bullet.studies.field.table import FEWEST_PAIRS, Rows, Summary, by_kind, summaries_of
from fuzzyq_bullet.studies.report.found import studies_below
from tests.helpers.commands import SHORT, Call

PAIR = "fuzzy-q-lambda,improved-fuzzy"
ONE = ("--planners", "improved-fuzzy", "--jobs", "1")
WORLD = """\
<sdf version="1.6"><world name="default">
  <light name="sun" type="directional"><pose>0 0 10 0 0 0</pose></light>
  <model name="post"><static>1</static><pose>0 1.5 0 0 0 0</pose><link name="link">
    <collision name="c"><geometry><cylinder><radius>0.1</radius><length>1</length></cylinder>
    </geometry></collision></link></model>
</world></sdf>
"""


def jobs_of(**asked: Any) -> list[Job]:
    study = AgainstField(**{"planners": PAIR, "runs": 1, **asked})
    stage = next(study.stages())
    return stage.plan.jobs(stage.planners)


def row(planner: str, run: int = 0, **changes: Any) -> Row:
    """A success: 11 m driven in 20 s where 10 m are the shortest."""
    plain = {
        "planner": planner,
        "drive": "wheels",
        "layout": "scatter",
        "count": 50,
        "run": run,
        "seed": run,
        "feasible": True,
        "outcome": "goal",
        "time_s": 20.0,
        "path_length_m": 11.0,
        "shortest_path_m": 10.0,
        "turning_rad": 5.5,
        "mean_jerk": 2.0,
        "collisions": 0,
        "decision_ms": 1.0,
        "decision_p95_ms": 4.0,
    }
    return Row(**{**plain, **changes})


def kinds_of(*rows: Row, others: tuple[str, ...] = ("a", "b")) -> dict[str, dict[str, Rows]]:
    return by_kind(rows, [(one, one, "scatter") for one in (*others, BOUND)])


def lines(*rows: Row) -> dict[str, Summary]:
    return {line.planner: line for line in summaries_of(kinds_of(*rows), lambda row: None)}


# What is run


@pytest.mark.parametrize("kind", KINDS)
def test_every_planner_and_the_bound_meet_the_same_field_of_a_kind(kind: str) -> None:
    jobs = [Job.of_order(job.as_order()) for job in jobs_of(kinds=kind)]
    assert [job.planner for job in jobs] == [f"{name}.{kind}" for name in (*PAIR.split(","), BOUND)]
    fields = [realise(job.scenario()) for job in jobs]
    assert len({field.obstacles for field in fields}) == len({field.start for field in fields}) == 1
    assert {job.drive for job in jobs} == {"wheels"}
    field = fields[0]
    assert len(field.movers) == (10 if kind == "moving" else 0)
    assert (field.sensor.noise > 0.0, field.robot.slip > 0.0, field.robot.latency > 0.0) == (
        (kind == "noise",) * 3
    )


def test_kinds_can_be_told_apart_where_their_fields_are_the_same() -> None:
    jobs = jobs_of(kinds="scatter,noise", runs=2)
    assert len({job.key for job in jobs}) == len(jobs) == 2 * 2 * 3
    fields = {job.environment for job in jobs}
    assert len(fields) == 2


def test_traps_take_turns() -> None:
    jobs = jobs_of(kinds="traps", runs=6)
    layouts = [job.environment.layout for job in jobs if job.planner.startswith(BOUND)]
    assert layouts == [*TRAPS, *TRAPS[:2]]


def test_nothing_moves_and_nothing_is_disturbed_for_the_bound(short: Path) -> None:
    scenario = load_scenario(short)
    there = [[1.0, 0.65], [1.0, 0.8]]
    wall = {"shape": "box", "position": there[0], "size": [0.1, 1.2]}
    blocked = Scenario.model_validate(
        {
            **scenario.model_dump(exclude={"obstacles"}),
            "obstacles": [{**wall, "motion": {"kind": "patrol", "points": there, "speed": 0.05}}],
            "sensor": {"noise": 0.2, "dropout": 0.4},
            "robot": {"slip": 0.3},
            "limits": {"time": 5.0},
        }
    )
    bound = drive_bound(blocked)
    assert bound.outcome == "goal"
    assert drive_shortest_path(blocked).outcome != "goal"


def test_a_watch_changes_nothing_of_a_planner_and_notes_every_decision() -> None:
    class Still:
        closed = False

        def decide(self, observation: Observation, /) -> Decision:
            return Decision(heading=1.0, step=0.0)

        def close(self) -> None:
            self.closed = True

    still, seconds, now = Still(), list[float](), iter([1.0, 3.5, 10.0, 10.25])
    timed = Timed(still, seconds, lambda: next(now))
    observation: Any = None  # it does not look at it
    assert [timed.decide(observation) for _ in range(2)] == [still.decide(observation)] * 2
    assert seconds == [2.5, 0.25]
    assert timed.decide.__wrapped__ == still.decide  # whose line a mistake is told with
    timed.close()
    assert still.closed


def test_a_row_tells_the_time_of_its_decisions_unless_it_is_the_bounds() -> None:
    first, _, bound = (
        work({**job.as_order(), "limits": {"time": 0.5}})["row"] for job in jobs_of(kinds="traps")
    )
    assert first["decision_p95_ms"] >= first["decision_ms"] > 0.0
    assert bound["decision_ms"] is None


# What the rows say


def test_only_fields_that_all_have_met_count() -> None:
    kinds = kinds_of(row("a"), row("a", 1), row("b"), row("b", 2), row(BOUND), row(BOUND, 1))
    assert {name: [place[-1] for place in met] for name, met in kinds["scatter"].items()} == {
        "a": [0],
        "b": [0],
        BOUND: [0],
    }
    assert kinds_of(row("a"), row("b", 1), row(BOUND)) == {}


def test_figures_are_of_the_runs_that_arrived_and_contacts_of_all() -> None:
    told = lines(
        *(row("a", run) for run in (0, 1)),
        row("a", 2, outcome="collision", collisions=1, at_fault=False, time_s=1.0),
        row("a", 3, outcome="collision", collisions=1, at_fault=True, feasible=False),
        row("a", 4, outcome="collision", collisions=1, at_fault=True),
        *(
            row("b", run, outcome="error", error="E", feasible=None, time_s=None)
            for run in range(5)
        ),
        *(row(BOUND, run, time_s=16.0) for run in range(5)),
    )
    a, b = told["a"], told["b"]
    assert a.success is not None
    assert (a.success.number, a.success.of) == (2, 4)
    assert (a.contacts, a.at_fault, a.errors) == (3, 2, 0)
    assert a.over_bound is not None
    assert (a.over_bound.value, a.over_bound.pairs) == (pytest.approx(20 / 16), 2)
    assert (a.path, a.turning, a.jerk) == (pytest.approx(1.1), pytest.approx(0.5), 2.0)
    assert b.success is not None
    assert (b.success.number, b.success.of, b.errors) == (0, 5, 5)  # an error excuses nothing
    assert b.over_bound is b.path is b.turning is b.jerk is None
    assert told[BOUND].over_bound is None


def test_what_others_do_better_is_told_and_only_by_enough_fields() -> None:
    def pairs(count: int, time: float) -> list[list[str]]:
        rows = [
            one
            for run in range(count)
            for one in (
                row("a", run),
                row("b", run, time_s=time + run / 100, decision_ms=2.0),
                row(BOUND, run),
            )
        ]
        return [one.better() for one in paired(kinds_of(*rows), "a")]

    assert pairs(FEWEST_PAIRS, 15.0) == [["time"]]
    assert pairs(FEWEST_PAIRS - 1, 15.0) == [[]]
    assert pairs(FEWEST_PAIRS, 25.0) == [[]]


def test_a_planner_that_arrives_where_the_other_does_not_is_better_in_success() -> None:
    rows = [
        one
        for run in range(9)
        for one in (
            row("a", run, outcome="collision", collisions=1),
            row("b", run),
            row(BOUND, run),
        )
    ]
    (one,) = paired(kinds_of(*rows), "a")
    assert one.better() == ["success", "contacts"]
    assert one.figures["time"] is None
    table = better_table([one], "a")
    assert table is not None
    cells = [tuple(line[:3]) for line in table.rows]
    assert cells == [("scatter", "b", "success"), ("scatter", "b", "contacts")]


# From the command line


@pytest.fixture(scope="module")
def swept(inside: Call, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two planners and the bound in one trap and one cellular field, and the report; to be read."""
    out = tmp_path_factory.mktemp("field")
    few = ("--planners", PAIR, "--kinds", "traps,cellular", "--runs", "1", "--jobs", "2")
    done = inside("bench", "field", *few, "--out", out)
    assert done.returncode == 0, done.stderr
    (out / "said").write_text(done.stdout)
    return out


@pytest.mark.slow
def test_a_sweep_writes_table_data_and_picture(swept: Path) -> None:
    rows = from_csv((swept / "field.csv").read_text())
    assert len(rows) == 2 * 3
    assert {row.planner for row in rows if row.layout == "cellular"} == {
        f"{name}.cellular" for name in (*PAIR.split(","), BOUND)
    }
    told = json.loads((swept / "field.json").read_text())
    by_name = {(line["kind"], line["planner"]): line for line in told["lines"]}
    assert len(by_name) == 6
    asked = by_name["cellular", "improved-fuzzy"]
    assert asked["decision_ms"] > 0.0
    assert asked["over_bound"]["value"] > 1.0
    assert asked["score"] is not None
    assert by_name["traps", BOUND]["score"] is by_name["traps", BOUND]["decision_ms"] is None
    assert {one["than"] for one in told["paired"]} == {"fuzzy-q-lambda"}
    assert (swept / "field.png").stat().st_size > 10_000
    said = (swept / "said").read_text()
    assert said.index("Planners in the same fields") < said.index("Each beside fuzzy-q-lambda")
    assert "What others do better" not in said  # of one field nobody can say so


@pytest.mark.slow
def test_the_table_is_the_same_each_time_and_the_journal_alone_has_times(
    swept: Path, inside: Call, tmp_path: Path
) -> None:
    out = tmp_path / "again"
    shutil.copytree(swept, out)
    journal = (out / "journal.jsonl").read_text().splitlines(keepends=True)
    assert all(name in journal[0] for name in OF_MACHINE)
    assert not any(name in (swept / "field.csv").read_text() for name in OF_MACHINE)
    (out / "journal.jsonl").write_text("".join(journal[:2]))
    few = ("--planners", PAIR, "--kinds", "traps,cellular", "--runs", "1", "--jobs", "1")
    done = inside("bench", "field", *few, "--out", out)
    assert "4 episodes in" in done.stderr
    assert "2 were there already" in done.stderr
    assert (out / "field.csv").read_bytes() == (swept / "field.csv").read_bytes()


@pytest.mark.slow
def test_a_report_has_the_tables_with_times_and_the_command(
    swept: Path, inside: Call, tmp_path: Path
) -> None:
    out = tmp_path / "report.html"
    inside("report", swept, "--out", out, "--no-figures", "--no-videos")
    page = out.read_text()
    assert "Each beside fuzzy-q-lambda in the same fields" in page
    assert "fuzzyq bench field --planners fuzzy-q-lambda,improved-fuzzy" in page
    (found,) = studies_below(swept)
    rows = found.results["field"].rows
    assert {row.planner.split(".")[0] for row in rows if row.decision_ms is None} == {BOUND}


@pytest.mark.slow
def test_a_planner_that_fails_fails_alone(fuzzyq: Call, tmp_path: Path) -> None:
    plugin = tmp_path / "broken_field.py"
    plugin.write_text(
        "from typing import Literal\n"
        "from fuzzyq_bullet import PlannerSettings, register_planner\n\n"
        "class Settings(PlannerSettings):\n"
        "    name: Literal['broken-field'] = 'broken-field'\n\n"
        "class Broken:\n"
        "    def decide(self, observation):\n"
        "        raise RuntimeError('lost')\n\n"
        "register_planner('broken-field', Settings, lambda settings, rng: Broken())\n"
    )
    worlds = tmp_path / "worlds"
    worlds.mkdir()
    (worlds / "short.yaml").write_text(SHORT)
    done = fuzzyq(
        "bench", "field", "--worlds", worlds, "--planners", "improved-fuzzy,broken-field",
        "--plugin", plugin, "--out", tmp_path / "out", "--jobs", "1",
    )  # fmt: skip
    assert done.returncode == 1
    rows = {row.planner: row for row in from_csv((tmp_path / "out" / "worlds.csv").read_text())}
    assert rows["improved-fuzzy"].success
    assert rows[BOUND].success
    error = rows["broken-field"].error
    assert error is not None
    assert "lost" in error
    assert f"{plugin}:9" in error


def test_a_planner_that_lacks_what_it_needs_is_told_before_any_drives(
    inside: Call, tmp_path: Path
) -> None:
    planners = ("--planners", "improved-fuzzy,process", "--kinds", "scatter", "--runs", "1")
    with pytest.raises(UserError, match=r"^planner process: ") as error:
        inside("bench", "field", *planners, "--out", tmp_path / "out")
    assert len(error.value.problems) == 1
    assert not (tmp_path / "out" / "field.csv").exists()


@pytest.mark.parametrize(
    ("option", "value"),
    [
        ("--kinds", "sea"),
        ("--planners", "nobody"),
        ("--drive", "kinematic"),
        ("--robot", "tank"),
        ("--max-speed", "99"),
        ("--start", "1,1"),
        ("--worlds", "nowhere"),
    ],
)
def test_what_cannot_be_is_one_line(inside: Call, option: str, value: str, tmp_path: Path) -> None:
    with pytest.raises(UserError, match=f"^{option}: ") as error:
        inside("bench", "field", *ONE, option, value, "--out", tmp_path / "out")
    assert len(error.value.problems) == 1
    assert not (tmp_path / "out").exists()


# Worlds of a folder


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Three worlds, one that cannot be read, and what is no world."""
    worlds = tmp_path / "worlds"
    worlds.mkdir()
    (worlds / "b.yaml").write_text(SHORT)
    (worlds / "a.world").write_text(WORLD)
    told = {"name": "c", "start": {"position": [1, 1]}, "goal": {"position": [2, 1]}, "seed": 7}
    (worlds / "c.json").write_text(json.dumps(told))
    (worlds / "d.world").write_text("<sdf><wor")
    (worlds / "notes.txt").write_text("no world")
    (worlds / "e.png").write_bytes(b"a picture of a map")
    return worlds


def stage_of(folder: Path, **asked: Any) -> Any:
    study = AgainstField(**{"planners": "improved-fuzzy", "worlds": folder, **asked})
    return next(study.stages())


def test_a_folder_gives_its_worlds_sorted_and_a_line_for_each_that_cannot_be_read(
    folder: Path,
) -> None:
    plan = stage_of(folder).plan
    assert list(plan.worlds) == ["short", "c"]
    without, broken = plan.unread
    assert without.startswith(f"{folder / 'a.world'}: has no start and goal; give --start X,Y")
    assert broken.startswith(f"{folder / 'd.world'}:1: ")


def test_start_and_goal_are_given_to_worlds_that_have_none(folder: Path) -> None:
    for name in ("b.yaml", "c.json", "d.world"):
        (folder / name).unlink()
    stage = stage_of(
        folder, start="0,0,1.57", goal="0,13,1", robot="jackal", max_speed=2.0, range=3
    )
    job = stage.plan.jobs(stage.planners)[0]
    world = job.scenario()
    assert (world.start.position, world.start.heading) == ((0.0, 0.0), 1.57)
    # Gazebo's worlds have no edge: the goal lies 10 m beyond the last thing that stands there.
    assert (world.goal.position, world.goal.radius) == ((0.0, 13.0), 1.0)
    assert (world.robot.model, world.robot.max_speed, world.sensor_range) == ("jackal", 2.0, 3.0)
    assert stage.notes == ("left out in 1 world: lights: nothing to run into",)


def test_a_job_brings_its_world_to_workers_that_have_no_such_file(folder: Path) -> None:
    stage = stage_of(folder, repeat=2)
    jobs = stage.plan.jobs(stage.planners)
    shutil.rmtree(folder)
    assert [(job.key[2], job.environment.run, job.environment.seed) for job in jobs[::2]] == [
        ("short", 0, 0),
        ("short", 1, 1),
        ("c", 0, 7),
        ("c", 1, 8),
    ]
    orders = [json.loads(json.dumps(job.as_order())) for job in jobs]
    assert [Job.of_order(order).scenario().seed for order in orders[::2]] == [0, 1, 7, 8]
    assert work(orders[0])["row"]["outcome"] == "goal"


def test_a_world_keeps_what_it_says_of_its_robot_and_sensor(folder: Path) -> None:
    (folder / "b.yaml").write_text(
        SHORT + "sensor: {range: 2.0, noise: 0.01}\nrobot: {slip: 0.02}\nlimits: {time: 9.0}\n"
    )
    stage = stage_of(folder)
    world = stage.plan.jobs(stage.planners)[0].scenario()
    assert (world.sensor_range, world.sensor.noise) == (2.0, 0.01)
    assert (world.robot.slip, world.limits.time) == (0.02, 9.0)


def test_two_worlds_of_one_name_are_not_mixed_up(folder: Path) -> None:
    (folder / "z.yaml").write_text(SHORT)
    *_, twice = stage_of(folder).plan.unread
    assert twice == f"{folder / 'z.yaml'}: name: short is the name of {folder / 'b.yaml'} too"


def test_a_task_brings_its_map_which_is_no_world_of_its_own(tmp_path: Path) -> None:
    maps = Path(__file__).parents[1] / "scenario" / "maps"
    for name in ("cave.map", "cave.map.scen", "lab.yaml", "lab.pgm"):
        shutil.copy(maps / name, tmp_path)
    plan = stage_of(tmp_path).plan
    assert list(plan.worlds) == ["cave.map"]
    (line,) = plan.unread
    assert "lab.yaml: has no start and goal" in line


@pytest.mark.slow
def test_worlds_are_scored_and_the_others_go_on_where_one_cannot_be_read(
    folder: Path, tmp_path: Path, fuzzyq: Call
) -> None:
    out = tmp_path / "out"
    done = fuzzyq("bench", "field", *ONE, "--worlds", folder, "--out", out)
    assert done.returncode == 2
    errors = [line for line in done.stderr.splitlines() if line.startswith("error: ")]
    assert [Path(line.split(":")[1].strip()).name for line in errors] == ["a.world", "d.world"]
    rows = from_csv((out / "worlds.csv").read_text())
    assert [(row.planner, row.layout, row.outcome) for row in rows] == [
        (planner, name, "goal") for planner in ("improved-fuzzy", BOUND) for name in ("c", "short")
    ]
    told = json.loads((out / "field.json").read_text())
    scores = {one["world"]: float(one["improved-fuzzy"]) for one in told["worlds"]}
    for row in rows:
        if row.planner == "improved-fuzzy":
            assert row.shortest_path_m is not None
            assert row.time_s is not None
            best = 0.6 * (row.shortest_path_m + 0.2)
            assert scores[row.layout] == pytest.approx(
                best / min(max(row.time_s, 2 * best), 8 * best), abs=5e-4
            )
    first = [line.split()[0] for line in done.stdout.splitlines() if line.strip()]
    assert [word for word in first if word in told["settings"]["worlds"]] == ["c", "short"]
    again = fuzzyq("bench", "field", *ONE, "--worlds", folder, "--out", out)
    assert "0 episodes in" in again.stderr
    (folder / "c.json").write_text((folder / "c.json").read_text().replace("[2, 1]", "[2, 2]"))
    other = fuzzyq("bench", "field", *ONE, "--worlds", folder, "--out", out)
    assert other.returncode == 2
    assert "holds a sweep with other settings: worlds.c.sha256" in other.stderr


def test_a_plan_leads_back_to_its_study(folder: Path) -> None:
    study = AgainstField(planners=PAIR, worlds=folder, goal="2,1.2,0.3", repeat=3)
    plan = next(study.stages()).plan
    read = type(plan).model_validate(json.loads(plan.model_dump_json()))
    assert AgainstField.recalled({"worlds": read}) == study
    fields = AgainstField(planners=PAIR, kinds="moving,noise", runs=3, seed=4, max_speed=0.5)
    plan = next(fields.stages()).plan
    assert isinstance(plan, FieldPlan)
    read = FieldPlan.model_validate(json.loads(plan.model_dump_json()))
    assert AgainstField.recalled({"field": read}) == fields
