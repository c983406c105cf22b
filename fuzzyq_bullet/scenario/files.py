"""Scenario files: read with a line number for every mistake, written, and the bundled ones."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from pydantic import ValidationError

from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.files import read_text, written_beside
from fuzzyq_bullet.planning.controllers import rules_named
from fuzzyq_bullet.planning.fuzzy_q_lambda import field_policy
from fuzzyq_bullet.planning.process.planner import ProcessSettings
from fuzzyq_bullet.planning.registry import (
    DEFAULT_PLANNER,
    make_planner,
    planner_names,
    settings_for,
)
from fuzzyq_bullet.planning.settings import PolicySettings, RoutineSettings
from fuzzyq_bullet.quantities import MAX_OBSTACLES
from fuzzyq_bullet.reading.kinds import SCENARIO, refuse_other_kind, refuse_other_suffix
from fuzzyq_bullet.reading.problems import Problem, lines_of
from fuzzyq_bullet.reading.yaml_tree import Node, read_tree
from fuzzyq_bullet.scenario.checks import find_conflicts
from fuzzyq_bullet.scenario.fields import refuse_other_field
from fuzzyq_bullet.scenario.layouts import realise
from fuzzyq_bullet.scenario.models import Scenario
from fuzzyq_bullet.scenario.problems import MAX_WORDED, problems_of
from fuzzyq_bullet.scenario.robot import Robot, with_robot_from, with_robot_in
from fuzzyq_bullet.scenario.sources import (
    Source,
    bundled_paths,
    find_scenario,
    refuse_keys,
    refuse_suffix,
)
from fuzzyq_bullet.shapes.trace import with_trace_in
from fuzzyq_bullet.wording import error_in_words, shorten

MAX_BYTES = 2_000_000
"""Largest scenario file: 10 000 boxes, one a line, take about 0.8 MB."""


def load_scenario(source: Source, *, policies: bool = True) -> Scenario:
    """Read a scenario from a file, or a bundled one by name, and check that it can be run.

    Args:
        source: A path, or the name of a bundled scenario such as ``paper-50``. A file of that
            name wins.
        policies: Whether the policy that its planner uses must be there and fit; not so for
            whoever only wants the world of the scenario.

    Raises:
        UserError: If it cannot be read or is wrong; one line a mistake:
            ``path:line: key.path: what is wrong; what is allowed``.
    """
    path = find_scenario(source)
    refuse_suffix(path)
    try:
        return parse_scenario(_read(path), str(path), folder=path.parent, policies=policies)
    except UserError:
        refuse_other_suffix(path)
        raise


def parse_scenario(
    text: str, where: str = "scenario", *, folder: Path | None = None, policies: bool = False
) -> Scenario:
    """Read a scenario from YAML text and check that it can be run.

    Args:
        text: The YAML document.
        where: What to call it in messages, usually its path.
        folder: In which relative paths in it begin; without one they stay as they are.
        policies: Whether the policy that its planner uses must be there and fit. Text alone means
            the same whatever files there are.

    Raises:
        UserError: If it is wrong; one line a mistake.
    """
    if len(text) > MAX_BYTES:
        raise UserError(f"{where}: too large; a scenario has at most {MAX_BYTES} bytes")
    tree = read_tree(text, where)
    if not isinstance(tree.data, dict):
        raise UserError(
            f"{where}:{tree.line}: expected a mapping with the keys name, start and goal, "
            f"got {shorten(tree.data)}"
        )
    given = tree.data.get("obstacles")
    if isinstance(given, list) and len(given) > MAX_OBSTACLES:  # not worth a look at each
        line = tree.line_of("obstacles")
        raise UserError(
            f"{where}:{line}: obstacles: must have at most {MAX_OBSTACLES} values, got {len(given)}"
        )
    more = 0
    data = with_robot_in(_with_rules_in(tree, folder or Path(), where), folder)
    data = _with_traces_in(tree, data, folder or Path(), where)
    try:
        scenario = Scenario.model_validate(data)
    except ValidationError as error:
        refuse_keys(text, where)
        refuse_other_kind(where, tree.data, SCENARIO)
        problems = problems_of(error, tree.data)
        more = max(0, error.error_count() - MAX_WORDED)
    except Exception as error:  # of the settings of a planner of the user's own
        line = tree.lines.get("planner", tree.line)
        why = f"its settings cannot be made: {error_in_words(error)}"
        raise UserError(f"{where}:{line}: planner: {why}") from error
    else:
        _refuse_unwritable(scenario, f"{where}:{tree.lines.get('planner', tree.line)}")
        if folder is not None:
            scenario = _with_policy_in(scenario, folder)
        problems = [Problem(loc, message) for loc, message in find_conflicts(scenario)]
        if policies:
            given = "planner" in tree.data
            unfit = _policy_problem(scenario, planner_is_given=given, sound=not problems)
            problems += [unfit] if unfit else []
        if not problems:
            return scenario
    raise UserError(*lines_of(problems, more, tree, where))


def _refuse_unwritable(scenario: Scenario, where: str) -> None:
    """Make sure that the settings of a planner of the user's own can be put on record.

    Raises:
        UserError: If they cannot.
    """
    try:
        scenario.planner.model_dump(mode="json")
    except Exception as error:
        raise UserError(
            f"{where}: planner: its settings cannot be written as JSON: {error_in_words(error)}"
        ) from error


def _with_rules_in(tree: Node, folder: Path, where: str) -> dict[str, Any]:
    """Return the data of a scenario with the rules that its planner names in a file.

    So the record of a run holds them.

    Raises:
        UserError: If that file cannot be read, or is wrong.
    """
    data: dict[str, Any] = tree.data
    planner = data.get("planner")
    if not isinstance(planner, dict) or not isinstance(planner.get("rules"), str):
        return data
    name = planner.get("name", DEFAULT_PLANNER)
    if name not in planner_names() or not issubclass(settings_for(name), RoutineSettings):
        return data
    try:
        rules = rules_named(planner["rules"], folder)
    except UserError as error:
        inner = tree.children["planner"]
        raise error.under(f"{where}:{inner.line_of('rules')}: planner.rules") from error
    return {**data, "planner": {**planner, "rules": rules}}


def _with_traces_in(tree: Node, data: dict[str, Any], folder: Path, where: str) -> dict[str, Any]:
    """Return the data of a scenario with the rows of the traces that its obstacles name.

    Raises:
        UserError: If such a file cannot be read, or is wrong.
    """
    obstacles = data.get("obstacles")
    if not isinstance(obstacles, list):
        return data
    told = []
    for i, item in enumerate(obstacles):
        motion = item.get("motion") if isinstance(item, dict) else None
        try:
            read = with_trace_in(motion, folder)
        except UserError as error:
            inner = tree.children["obstacles"].children[i].children["motion"]
            place = f"{where}:{inner.line_of('file')}: obstacles[{i}].motion.file"
            raise error.under(place) from error
        told.append(item if read is motion else {**item, "motion": read})
    return {**data, "obstacles": told}


def _with_policy_in(scenario: Scenario, folder: Path) -> Scenario:
    """Return the scenario with the paths of its policy or program made absolute, if it names one.

    So it means the same file wherever the scenario is written to, or run from, later on.

    Args:
        scenario: A scenario as its file says.
        folder: Folder of that file, in which a relative path begins.
    """
    planner = scenario.planner
    if isinstance(planner, ProcessSettings):
        command = tuple(
            str((folder / word).absolute()) if word.startswith(("./", "../")) else word
            for word in planner.command
        )
        planner = planner.model_copy(update={"command": command})
        return scenario.model_copy(update={"planner": planner})
    if not isinstance(planner, PolicySettings) or planner.policy is None:
        return scenario
    path = str((folder / planner.policy).absolute())
    return scenario.model_copy(update={"planner": planner.model_copy(update={"policy": path})})


def _policy_problem(scenario: Scenario, *, planner_is_given: bool, sound: bool) -> Problem | None:
    """Return what keeps the planner from using its policy, if anything does.

    Args:
        scenario: The scenario, its policy where it lies.
        planner_is_given: Whether the file has a key ``planner`` at all.
        sound: Whether all else is right, so that its obstacles can be drawn.
    """
    if not isinstance(scenario.planner, PolicySettings | ProcessSettings):
        return None
    try:
        # The planner itself knows best what fits it. What it would draw from is of no matter.
        make_planner(scenario.planner, np.random.default_rng(0))
        if isinstance(scenario.planner, PolicySettings) and (
            sound and field_policy(scenario.planner) is not None
        ):
            refuse_other_field(realise(scenario))
    except UserError as error:
        if isinstance(scenario.planner, ProcessSettings):
            if not scenario.planner.command:
                return Problem(("planner",), error.problems[0])
            return Problem(("planner", "command"), error.problems[0].removeprefix("command: "))
        loc = ("planner", "policy") if planner_is_given else ("planner",)
        return Problem(loc, error.problems[0], missing=True)
    return None


def bundled_scenarios() -> dict[str, str]:
    """Return the description of each bundled scenario, by name, in alphabetical order."""
    return {name: load_scenario(path).description for name, path in bundled_paths().items()}


def dump_scenario(scenario: Scenario, *, defaults: bool = True, folder: Path | None = None) -> str:
    """Return a scenario as YAML text that ``parse_scenario`` reads back as its equal.

    Args:
        scenario: The scenario.
        defaults: Whether every value is written, defaults too, so that the file means the same in a
            version whose defaults differ. Without them it is a file for people to read and change.
        folder: Folder of the file that the text is for: the path of a robot's URDF begins there.
            Without one it is as the scenario has it.
    """
    data = scenario.model_dump(mode="json", exclude_defaults=not defaults)
    if not defaults and "robot" in data:
        told = scenario.robot
        joints = {key: data["robot"].get(key) for key in ("left_wheel", "right_wheel")}
        usual = Robot.model_validate({"model": told.model, **joints}).model_dump(mode="json")
        changed = {key: v for key, v in data["robot"].items() if v != usual[key] or joints.get(key)}
        data["robot"] = {"model": told.model, **changed}
    data = with_robot_from(data, folder)
    lines: list[str] = []
    for key, value in data.items():
        if key == "obstacles" and value:
            lines.append("obstacles:")
            lines.extend(f"  - {_flow(item)}" for item in value)
        elif value is not None:
            lines.append(f"{key}: {_flow(value)}")
    return "\n".join(lines) + "\n"


def save_scenario(scenario: Scenario, path: Source) -> None:
    """Write a scenario to a file, whole or not at all.

    Raises:
        UserError: If the file cannot be written.
    """
    with written_beside(Path(path)) as part:
        part.write_text(dump_scenario(scenario), encoding="utf-8")


def problem_lines(source: Source, problems: list[Problem]) -> list[str]:
    """Return a line for each problem of a scenario file that can be read: ``FILE:LINE: KEY: ...``.

    Args:
        source: A path, or the name of a bundled scenario.
        problems: What is wrong, or doubtful.
    """
    if not problems:
        return []
    path = find_scenario(source)
    return lines_of(
        problems,
        0,
        read_tree(_read(path), str(path)),
        str(path),
    )


def _read(path: Path) -> str:
    return read_text(path, what="a scenario", most=MAX_BYTES)


_PLAIN = re.compile(r"[A-Za-z][A-Za-z0-9_-]*")
_DUMPER: Any = getattr(yaml, "CSafeDumper", yaml.SafeDumper)


def _flow(value: Any) -> str:
    """Return plain data as one line of YAML that YAML 1.1 readers understand alike."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{_flow(key)}: {_flow(item)}" for key, item in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(_flow(item) for item in value) + "]"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float):
        text = repr(value)
        return text.replace("e", ".0e") if "e" in text and "." not in text else text
    if value is None:
        return "null"
    if isinstance(value, str):
        return _text(value)
    return str(value)


def _text(value: str) -> str:
    if _PLAIN.fullmatch(value) and yaml.safe_load(value) == value:  # not yes, null, on ...
        return value
    dumped: str = yaml.dump(
        value, Dumper=_DUMPER, default_style='"', allow_unicode=True, width=1_000_000
    )
    return dumped.strip()
