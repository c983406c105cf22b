"""``fuzzyq check``: it fails when it should, for the right reason, and one failure stays alone."""

from __future__ import annotations

import errno
import io
import json
import math
import os
import re
import shlex
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest
from lxml import etree

from fuzzyq_bullet.checks.baseline import BaselineRun, compare, this_platform
from fuzzyq_bullet.checks.plan import discover
from fuzzyq_bullet.checks.reports import junit_xml
from fuzzyq_bullet.checks.session import check_all
from fuzzyq_bullet.checks.verdict import Job, Verdict
from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.platforms import data_folder
from fuzzyq_bullet.recording.trajectory import Trajectory
from fuzzyq_bullet.workers import WorkerPool
from tests.helpers.commands import Call

PLANNERS = '''\
"""What breaks robots, for tests: each by the name of a planner."""

import math, os, time
from dataclasses import replace
from typing import Literal

import numpy as np

from fuzzyq_bullet import Decision, PlannerSettings, episode, register_planner
from fuzzyq_bullet.drives import wheels
from fuzzyq_bullet.planning import ImprovedFuzzyPlanner, ImprovedFuzzySettings, RangeSensor


class Settings(PlannerSettings):
    name: Literal["bad"] = "bad"
    how: str = "straight"


class Bad:
    def __init__(self, how):
        self.how = how
        self.good = ImprovedFuzzyPlanner(ImprovedFuzzySettings(weights=(1.0, 1.0)))

    def decide(self, seen):
        if self.how == "crash":
            os.abort()
        elif self.how == "hang":
            while True:
                time.sleep(0.01)
        elif self.how == "eat":
            kept = []
            while True:
                kept.append(bytearray(10**7))
        elif self.how == "exit":
            os._exit(3)
        elif self.how == "raise":
            raise ValueError("no\\nway")
        elif self.how == "blind":
            nothing = lambda headings: np.full(len(headings), seen.range)
            return self.good.decide(replace(seen, sensor=RangeSensor(nothing, nothing)))
        elif self.how == "no-brakes":
            return self.good.decide(seen)
        (gx, gy), (x, y) = seen.goal, seen.position
        return Decision(heading=math.atan2(gy - y, gx - x), step=0.4)


register_planner("bad", Settings, lambda settings, rng: Bad(settings.how))

sound, drive = wheels.limit_acceleration, episode.run


def without_brakes(now, wanted, robot, dt):
    then = sound(now, wanted, robot, dt)
    return then._replace(speed=max(then.speed, now.speed))


def run(scenario, **more):
    broken = getattr(scenario.planner, "how", "") == "no-brakes"
    wheels.limit_acceleration = without_brakes if broken else sound
    return drive(scenario, **more)


episode.run = run
'''

GATE = """\
name: {name}
arena: {{size: [4.0, 3.0]}}
start: {{position: [0.5, 1.5]}}
goal: {{position: [3.5, 1.5]}}
planner: {planner}
obstacles:
  - {{shape: cylinder, position: [0.5, 0.5], radius: 0.1}}
  - {{shape: box, position: [2.0, 1.5], size: [0.2, 1.0]}}
limits: {{time: 40.0}}
"""
LINE = 8
"""Where the box of the gate stands in the file."""

LANE = """\
name: {name}
arena: {{size: [4.0, 2.0]}}
start: {{position: [0.5, 1.0]}}
goal: {{position: [3.5, 1.0]}}
planner: {{name: bad, how: straight}}
obstacles:
  - {{shape: cylinder, position: [0.5, 1.6], radius: 0.1}}
  - {{shape: cylinder, position: [2.0, {y}], radius: 0.2}}
"""
KILLERS = ("crash", "eat", "exit")
HOWS = (*KILLERS, "raise", "straight", "blind", "no-brakes")


MISSES = {"near": "{min_clearance: 0.5}", "late": "{max_time: 5.0}", "given-up": "time: 1.0"}
"""What the sound planner cannot do at the gate, by name."""


def gate(name: str) -> str:
    good = "{name: improved-fuzzy, weights: [1.0, 1.0]}"
    return GATE.format(name=name, planner=f"{{name: bad, how: {name}}}" if name in HOWS else good)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("check")
    (folder / "planners.py").write_text(PLANNERS)
    fields = folder / "fields"
    fields.mkdir()
    killers = folder / "killers"
    killers.mkdir()
    for name in (*HOWS, "good"):
        (fields / f"{name}.yaml").write_text(gate(name))
    for name in KILLERS:
        (fields / f"{name}.yaml").rename(killers / f"{name}.yaml")
    (killers / "good.yaml").write_text(gate("good"))
    # The robot's radius and the cylinder's together are 0.4 m. The second lane is touched along
    # 2·√(0.4² − 0.3999²) = 18 mm: seven physics steps at full speed.
    for name, y in (("clear", 1.402), ("graze", 1.3999), ("moved", 1.0)):
        (fields / f"{name}.yaml").write_text(LANE.format(name=name, y=y))
    # The box of this robot passes 6 cm from the cylinder, which the disc around it overlaps by 5.
    slim = LANE.format(name="slim", y=1.48) + "robot: {model: jackal}\n"
    (fields / "slim.yaml").write_text(slim + "expect: {min_clearance: 0.0}\n")
    for name, more in MISSES.items():
        text = gate("good").replace("name: good", f"name: {name}")
        (fields / f"{name}.yaml").write_text(
            text.replace("time: 40.0", more) if name == "given-up" else f"{text}expect: {more}\n"
        )
    (fields / "link.yaml").symlink_to("nowhere.yaml")
    (fields / "wrong.yaml").write_text("name: wrong\nstart: here\n")
    (fields / "zzz.yaml").write_text(gate("good"))
    return folder


@pytest.fixture(scope="module")
def checked(fuzzyq: Call, folder: Path) -> subprocess.CompletedProcess[str]:
    options = ["--plugin", "planners.py", "--junit", "reports/junit.xml"]
    return fuzzyq("check", "fields", "--json", "--github", *options, cwd=folder)


@pytest.fixture(scope="module")
def killed(fuzzyq: Call, folder: Path) -> dict[str, Verdict]:
    options = ["--plugin", "planners.py", "--memory", "512", "--json"]
    return verdicts_of(fuzzyq("check", "killers", *options, cwd=folder))


@pytest.fixture(scope="module")
def verdicts(checked: subprocess.CompletedProcess[str]) -> dict[str, Verdict]:
    return verdicts_of(checked)


def verdicts_of(checked: subprocess.CompletedProcess[str]) -> dict[str, Verdict]:
    told = json.loads(checked.stdout)["scenarios"]
    return {one["name"]: Verdict.model_validate(one) for one in told}


def test_what_is_sound_passes_beside_all_that_is_not(verdicts: dict[str, Verdict]) -> None:
    assert {name for name, one in verdicts.items() if one.status == "passed"} == {"good", "clear"}


@pytest.mark.parametrize("how", ["straight", "blind", "no-brakes", "moved", "graze"])
def test_a_robot_that_is_broken_fails_at_the_obstacle_that_it_hit(
    how: str, verdicts: dict[str, Verdict]
) -> None:
    verdict = verdicts[how]
    assert verdict.status == "failed"
    assert verdict.why[0] == "outcome collision, expected goal"
    touch = verdict.touch
    assert touch is not None
    assert (touch.obstacle, touch.line, verdict.line) == (1, LINE, LINE)
    assert f"obstacles[1] (fields/{how}.yaml:{LINE}) at (" in verdict.why[1]
    assert verdict.result is not None
    assert touch.time_s == pytest.approx(verdict.result.time_s, abs=1e-4)
    assert math.dist(touch.point, (2.0, 1.2)) < 1.0
    assert verdict.replay == f"fuzzyq run fields/{how}.yaml --plugin planners.py"


def test_a_run_that_touches_nothing_is_held_to_clearance_time_and_goal(
    verdicts: dict[str, Verdict],
) -> None:
    near, late, given_up = (verdicts[name] for name in MISSES)
    assert near.status == late.status == given_up.status == "failed"
    assert re.fullmatch(r"least clearance 0\.\d{3} m, expected 0\.5 m or more", near.why[0])
    assert near.touch is not None
    assert (near.touch.obstacle, near.line) == (1, LINE)
    assert re.fullmatch(r"took \d+\.\d s, expected 5 s or less", late.why[0])
    assert given_up.why[0] == "outcome timeout, expected goal"
    assert given_up.why[1].startswith("ended at (")


def test_a_disc_that_overlaps_an_obstacle_without_a_contact_touches_nothing(
    verdicts: dict[str, Verdict],
) -> None:
    slim = verdicts["slim"]
    assert slim.result is not None
    assert slim.touch is not None
    assert (slim.status, slim.result.outcome, slim.touch.obstacle) == ("failed", "goal", 1)
    assert slim.touch.distance_m == pytest.approx(-0.053, abs=0.002)
    depth = f"{-slim.touch.distance_m:.3f} m"
    assert slim.why[0] == f"least clearance -{depth}, expected 0 m or more"
    place = f"obstacles[1] (fields/slim.yaml:{LINE})"
    assert f"the disc around the robot {depth} into the cylinder {place}, no con" in slim.why[1]
    assert "touched" not in "".join(slim.why)


def test_a_planner_that_raises_is_broken_and_says_how(verdicts: dict[str, Verdict]) -> None:
    verdict = verdicts["raise"]
    assert verdict.status == "broken"
    assert verdict.why[0].startswith("planner bad: stopped by ValueError: no way, after 0.00 s (")
    assert verdict.replay == "fuzzyq check fields/raise.yaml --plugin planners.py"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("how", "why"),
    [
        ("crash", "its process crashed: SIGABRT (aborted)"),
        ("eat", "ran out of the memory that it may use (--memory)"),
        ("exit", "its process ended by itself, with exit code 3"),
    ],
)
def test_what_brings_its_process_down_fails_alone_and_says_how(
    how: str, why: str, killed: dict[str, Verdict]
) -> None:
    assert killed[how].status == "broken"
    assert killed[how].why[0].startswith(why)
    assert killed[how].replay == (
        f"fuzzyq check killers/{how}.yaml --plugin planners.py --memory 512"
    )
    assert killed["good"].status == "passed"


def test_wrong_input_is_told_and_outweighs_failures(
    checked: subprocess.CompletedProcess[str],
) -> None:
    assert checked.returncode == 2
    told = checked.stderr
    assert "error: fields/wrong.yaml:1: goal: is required" in told
    assert "error: fields/zzz.yaml:1: name: good is the name of fields/good.yaml too" in told
    assert "error: fields/link.yaml: cannot be read: a link to nowhere.yaml, which is " in told
    assert "2 passed, 10 failed, 4 mistakes in the input in " in told
    assert "Traceback" not in told
    assert f"::error file=fields/straight.yaml,line={LINE},title=straight::outcome coll" in told
    assert "::error file=fields/wrong.yaml,line=1," in told


def test_the_printed_command_drives_the_same_again(
    verdicts: dict[str, Verdict], folder: Path, fuzzyq: Call
) -> None:
    program, *words = shlex.split(verdicts["no-brakes"].replay)
    assert program == "fuzzyq"
    done = fuzzyq(*words, "--no-video", "--json", "--out", "again", cwd=folder)
    then = verdicts["no-brakes"].result
    assert then is not None
    assert done.returncode == 1
    assert json.loads(done.stdout)["digest"] == then.digest
    # The record tells all that a film shows, also to who does not know the planner.
    record = Trajectory.load(folder / "again" / "no-brakes.npz")
    assert (record.scenario.planner.name, record.digest()) == ("bad", then.digest)


@pytest.mark.slow
def test_a_hang_is_cut_and_the_next_goes_on(folder: Path) -> None:
    (folder / "hang.yaml").write_text(
        gate("good").replace("improved-fuzzy, weights: [1.0, 1.0]", "bad, how: hang")
    )
    files = (folder / "hang.yaml", folder / "fields" / "straight.yaml")
    record = str(folder / "hang.npz")
    jobs = [Job(file=str(file), name=file.stem, record=record, keep="all") for file in files]
    with WorkerPool(1, plugins=[str(folder / "planners.py")], timeout=4.0) as pool:
        done = dict(check_all(pool, jobs))
    assert done[0].status == "broken"
    assert done[0].why[0].startswith("cut after 4 s of wall-clock time")
    assert done[0].no_film
    assert (done[1].status, done[1].record) == ("failed", record)


@pytest.mark.slow
def test_a_worker_that_dies_while_it_starts_is_replaced(folder: Path, tmp_path: Path) -> None:
    dying = tmp_path / "dying.py"
    dying.write_text(
        "import os, pathlib\n"
        f"lives = pathlib.Path({str(tmp_path / 'lives')!r})\n"
        "if not lives.exists():\n    lives.touch()\n    os.abort()\n"
    )
    job = Job(file=str(folder / "fields" / "good.yaml"), name="good", drive="kinematic")
    with WorkerPool(1, plugins=[str(dying)]) as pool:
        assert dict(check_all(pool, [job]))[0].status == "passed"
    (tmp_path / "lives").unlink()
    dying.write_text("import os\nos._exit(7)\n")
    told = "no worker process can be started: its process ended by itself, with exit code 7"
    with WorkerPool(1, plugins=[str(dying)]) as pool, pytest.raises(UserError, match=told):
        dict(check_all(pool, [job]))


# Written after Ant's and Jenkins' schemas: what both allow, as far as check writes it.
SCHEMA = """\
<xs:schema xmlns:xs="http://www.w3.org/2001/XMLSchema">
 <xs:element name="testsuites"><xs:complexType><xs:sequence>
  <xs:element name="testsuite" maxOccurs="unbounded"><xs:complexType><xs:sequence>
   <xs:element name="properties"><xs:complexType/></xs:element>
   <xs:element name="testcase" minOccurs="0" maxOccurs="unbounded"><xs:complexType>
    <xs:choice minOccurs="0">
     <xs:element name="skipped"><xs:complexType>
      <xs:attribute name="message" type="xs:string"/></xs:complexType></xs:element>
     <xs:element name="failure" type="bad"/><xs:element name="error" type="bad"/>
    </xs:choice>
    <xs:attribute name="name" type="xs:token" use="required"/>
    <xs:attribute name="classname" type="xs:token" use="required"/>
    <xs:attribute name="time" type="xs:decimal" use="required"/>
   </xs:complexType></xs:element>
   <xs:element name="system-out" type="xs:string"/>
   <xs:element name="system-err" type="xs:string"/>
  </xs:sequence>
   <xs:attribute name="name" type="xs:token" use="required"/>
   <xs:attribute name="package" type="xs:token" use="required"/>
   <xs:attribute name="id" type="xs:int" use="required"/>
   <xs:attribute name="hostname" type="xs:token" use="required"/>
   <xs:attribute name="timestamp" use="required"><xs:simpleType>
    <xs:restriction base="xs:dateTime">
     <xs:pattern value="[0-9]{4}-[0-9]{2}-[0-9]{2}T[0-9]{2}:[0-9]{2}:[0-9]{2}"/>
    </xs:restriction></xs:simpleType></xs:attribute>
   <xs:attribute name="tests" type="xs:int" use="required"/>
   <xs:attribute name="failures" type="xs:int" use="required"/>
   <xs:attribute name="errors" type="xs:int" use="required"/>
   <xs:attribute name="skipped" type="xs:int"/>
   <xs:attribute name="time" type="xs:decimal" use="required"/>
  </xs:complexType></xs:element>
 </xs:sequence></xs:complexType></xs:element>
 <xs:complexType name="bad"><xs:simpleContent><xs:extension base="xs:string">
  <xs:attribute name="message" type="xs:string"/>
  <xs:attribute name="type" type="xs:string" use="required"/>
 </xs:extension></xs:simpleContent></xs:complexType>
</xs:schema>
"""


def test_the_junit_report_is_valid_and_counts_right(
    checked: subprocess.CompletedProcess[str], folder: Path
) -> None:
    schema = etree.XMLSchema(etree.parse(io.BytesIO(SCHEMA.encode())))
    report = etree.parse(str(folder / "reports" / "junit.xml"))
    schema.assertValid(report)
    suite = report.find("testsuite")
    assert suite.get("failures") == "9"
    assert int(suite.get("tests")) == len(suite.findall("testcase"))
    assert int(suite.get("errors")) == 1 + len(json.loads(checked.stdout)["problems"])
    # A name that XML cannot hold does not spoil it.
    odd = Verdict(name="odd", file="a\x07b.yaml", status="broken", why=["\x1b[1m<&>"])
    schema.assertValid(etree.fromstring(junit_xml([odd], ["a\x00b"], 1.0).encode()))


def test_no_scenario_is_an_error_and_no_green_run(fuzzyq: Call, tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    (tmp_path / "old.xml").write_text("of yesterday")
    paths = ["nothing", "empty", "no/**/*.yaml", ""]
    done = fuzzyq("check", *paths, "--junit", "old.xml", cwd=tmp_path)
    assert (done.returncode, done.stdout) == (2, "")
    lines = done.stderr.splitlines()
    for path, line in zip(paths, lines, strict=True):
        assert line.startswith(f"error: {path}: " if path else "error: an empty path; ")
    assert (tmp_path / "old.xml").read_text() == "of yesterday"


def test_a_folder_that_cannot_be_read_is_told_and_the_others_are_looked_into(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "a").mkdir()
    (tmp_path / "locked").mkdir()
    (tmp_path / "a" / "good.yaml").write_text(gate("good"))
    scan = os.scandir

    def refuse(path: str) -> Iterator[os.DirEntry[str]]:  # for root, no permission is missing
        if str(path).endswith("locked"):
            raise PermissionError(errno.EACCES, "Permission denied", str(path))
        return scan(path)

    monkeypatch.setattr(os, "scandir", refuse)
    found = discover([str(tmp_path)])
    assert found.files == [tmp_path / "a" / "good.yaml"]
    assert found.problems == [f"{tmp_path / 'locked'}: cannot be read: Permission denied"]


def test_a_record_that_cannot_be_read_is_a_mistake_and_the_scenario_runs(
    fuzzyq: Call, tmp_path: Path
) -> None:
    (tmp_path / "good.yaml").write_text(gate("good"))
    (tmp_path / "check-record.json").write_text("{")
    done = fuzzyq("check", ".", "--strict", "--drive", "kinematic", cwd=tmp_path)
    assert (done.returncode, done.stdout[:10]) == (2, "ok    good")
    assert "1 not compared: not recorded yet" in done.stderr
    assert "error: check-record.json: not a record of fuzzyq check --record" in done.stderr


def test_what_cannot_be_recorded_is_told_before_anything_is_driven(
    inside: Call, tmp_path: Path
) -> None:
    lane = LANE.format(name="lane", y=1.6).replace("{name: bad, how: straight}", "fuzzy")
    (tmp_path / "lane.yaml").write_text(lane)
    record = tmp_path / "check-record.json"
    record.mkdir()
    with pytest.raises(
        UserError, match=r"check-record\.json: cannot be written: there is a folder"
    ):
        inside("check", ".", "--record", cwd=tmp_path)
    record.rmdir()
    record.write_text("{")
    with pytest.raises(UserError, match=r"check-record\.json: not a record of fuzzyq check"):
        inside("check", ".", "--record", cwd=tmp_path)
    assert record.read_text() == "{"


def test_a_bundled_scenario_is_not_recorded_into_the_installation(
    inside: Call, tmp_path: Path
) -> None:
    with pytest.raises(UserError, match="mixed: --record notes beside the scenario, and this one"):
        inside("check", "mixed", "--record", cwd=tmp_path)
    assert not (data_folder("scenarios") / "check-record.json").exists()


@pytest.mark.slow
@pytest.mark.usefixtures("in_this_process")
def test_repeats_have_seeds_of_their_own_and_a_change_of_behaviour_is_told(
    inside: Call, folder: Path, tmp_path: Path
) -> None:
    (tmp_path / "good.yaml").write_text(gate("good"))
    done = inside("check", ".", "--record", "--repeat", "2", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    names = [line.split()[1] for line in done.stdout.splitlines() if line.startswith("ok")]
    assert names == ["good-seed-0", "good-seed-1", "good"]
    record = tmp_path / "check-record.json"
    runs = json.loads(record.read_text())
    assert list(runs["runs"]) == [f"good/improved-fuzzy/wheels/{seed}" for seed in (0, 1)]
    figures = runs["runs"]["good/improved-fuzzy/wheels/0"]["result"]
    figures["time_s"] /= 1.12
    figures["min_clearance_m"] += 0.03
    record.write_text(json.dumps(runs))
    done = inside("check", ".", "--strict", cwd=tmp_path)
    assert done.returncode == 1
    assert "changed: time +12 %: " in done.stdout
    assert "changed: clearance −3.0 cm: " in done.stdout
    assert "FAIL  good  goal" in done.stdout
    done = inside("check", ".", cwd=tmp_path)
    assert done.returncode == 0
    assert "changed: time +12 %: " in done.stdout
    assert "1 passed, 1 changed in" in done.stderr


def test_digests_count_on_one_platform_only(verdicts: dict[str, Verdict]) -> None:
    now = verdicts["good"].result
    assert now is not None
    then = now.model_copy(update={"digest": "0" * 32})
    here = BaselineRun(file="good.yaml", platform=this_platform(), result=then)
    assert "another trajectory" in compare(here, now)[0]
    assert not compare(here.model_copy(update={"platform": "another"}), now)
    assert not compare(here.model_copy(update={"result": now}), now)


def test_nothing_that_github_would_obey_is_echoed(fuzzyq: Call, tmp_path: Path) -> None:
    (tmp_path / "::stop-commands::x.yaml").write_text("name: x\n")
    (tmp_path / "named.yaml").write_text("name: '##[error]x'\nstart: 1\n")
    (tmp_path / "::set-output name=a::b.yaml").write_text(
        "name: stuck\nstart: {position: [1, 1]}\ngoal: {position: [9, 9]}\nlimits: {time: 0.5}\n"
    )
    done = fuzzyq("check", ".", "--github", cwd=tmp_path)
    assert done.returncode == 2
    for line in (done.stdout + done.stderr).splitlines():
        command = line.strip().startswith("::")
        assert not command or line.startswith(("::error ", "::warning "))
        assert command or "##[" not in line
