"""The action for other people's workflows: its steps run as GitHub would run them."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest
import yaml

from fuzzyq_bullet.version import __version__
from tests.helpers.commands import FUZZYQ, SHORT

ROOT = Path(__file__).resolve().parents[2]
ACTION = yaml.safe_load((ROOT / "action.yml").read_text())
STEPS: list[dict[str, Any]] = ACTION["runs"]["steps"]
_EXPRESSION = re.compile(r"\$\{\{ *([a-z0-9.-]+) *\}\}")

BLIND = """\
from typing import Literal
from fuzzyq_bullet import Decision, PlannerSettings, register_planner
class Settings(PlannerSettings):
    name: Literal["blind"] = "blind"
class Blind:
    def decide(self, observation):
        return Decision(heading=-1.5, step=0.2)
register_planner("blind", Settings, lambda settings, rng: Blind())
"""
"""A robot that drives straight on, into the wall."""


@dataclass
class Runner:
    """A machine of GitHub's, as far as the steps with a script see one.

    Attributes:
        folder: Where its folders are made.
        inputs: What the workflow gives.
        outputs: Of each step, by its name.
        said: What the last step printed.
    """

    folder: Path
    inputs: Mapping[str, str]
    outputs: dict[str, dict[str, str]] = field(default_factory=dict)
    said: str = ""

    def __post_init__(self) -> None:
        for name in ("workspace", "temporary"):
            (self.folder / name).mkdir()
        installed = self.folder / "temporary" / "fuzzyq" / "bin"
        installed.mkdir(parents=True)
        (installed / "fuzzyq").symlink_to(FUZZYQ)
        self.outputs["python"] = {"python-path": sys.executable}

    @property
    def workspace(self) -> Path:
        return self.folder / "workspace"

    def step(self, name: str) -> int:
        """Run a step; return its exit code."""
        (step,) = (one for one in STEPS if one.get("id") == name)
        script, told = self.folder / "step.sh", self.folder / "told"
        script.write_text(step["run"])
        told.write_text("")
        given = {key: _EXPRESSION.sub(self._value, text) for key, text in step["env"].items()}
        github = {
            "GITHUB_WORKSPACE": str(self.workspace),
            "GITHUB_ACTION_PATH": str(ROOT),
            "GITHUB_OUTPUT": str(told),
            "RUNNER_TEMP": str(self.folder / "temporary"),
            "RUNNER_OS": "Linux",
            "RUNNER_ARCH": "X64",
        }
        done = subprocess.run(
            ["bash", "--noprofile", "--norc", "-eo", "pipefail", str(script)],
            env={**os.environ, **github, **given},
            cwd=self.workspace,
            capture_output=True,
            text=True,
        )
        self.said = done.stdout + done.stderr
        lines = [line.partition("=") for line in told.read_text().splitlines()]
        self.outputs[name] = {key: value for key, _, value in lines}
        return done.returncode

    def _value(self, found: re.Match[str]) -> str:
        match found[1].split("."):
            case ["inputs", name]:
                return self.inputs.get(name, ACTION["inputs"][name]["default"])
            case ["steps", step, "outputs", name]:
                return self.outputs[step][name]
        raise AssertionError(f"unknown: {found[0]}")


def runner(folder: Path, **inputs: str) -> Runner:
    made = Runner(folder, {name.replace("_", "-"): text for name, text in inputs.items()})
    (made.workspace / "scenarios").mkdir()
    (made.workspace / "scenarios" / "short.yaml").write_text(SHORT)
    (made.workspace / "blind.py").write_text(BLIND)
    return made


def test_no_input_is_ever_a_part_of_a_script() -> None:
    scripts = [step["run"] for step in STEPS if "run" in step]
    assert len(scripts) == 3
    assert not any("${{" in script for script in scripts)


def test_every_input_is_described_used_and_has_a_default() -> None:
    text = (ROOT / "action.yml").read_text()
    for name, told in ACTION["inputs"].items():
        assert told["description"].endswith(".")
        assert isinstance(told["default"], str)
        assert f"inputs.{name} }}}}" in text


def test_what_it_uses_of_others_has_a_version() -> None:
    used = [step["uses"] for step in STEPS if "uses" in step]
    assert len(used) == 3
    assert all(re.fullmatch(r"actions/[a-z-]+@v\d+", one) for one in used)


def failures_in(folder: str) -> list[str]:
    tree = ElementTree.parse(Path(folder) / "check.xml")
    return [str(suite.get("failures")) for suite in tree.iter("testsuite")]


def test_a_robot_that_arrives_passes(tmp_path: Path) -> None:
    good = runner(tmp_path)
    assert good.step("check") == 0, good.said
    assert "1 passed" in good.said
    assert failures_in(good.outputs["check"]["folder"]) == ["0"]


@pytest.mark.slow
def test_a_robot_that_hits_the_wall_fails_at_its_line_and_leaves_a_film(tmp_path: Path) -> None:
    bad = runner(tmp_path, planner="blind", plugin="blind.py")
    assert bad.step("check") == 1
    assert "::error file=scenarios/short.yaml,line=2,title=short::" in bad.said
    folder = Path(bad.outputs["check"]["folder"])
    assert {path.name for path in (folder / "films").iterdir()} == {
        "short-blind.mp4",
        "short-blind.npz",
    }
    assert failures_in(str(folder)) == ["1"]


def test_what_cannot_be_run_is_2(tmp_path: Path) -> None:
    wrong = runner(tmp_path, scenarios="nowhere/")
    assert wrong.step("check") == 2
    assert "nowhere" in wrong.said


def words_given(folder: Path, **inputs: str) -> list[str]:
    """Return with what words the last step calls the command, without the folder's."""
    there = runner(folder, **inputs)
    command = folder / "temporary" / "fuzzyq" / "bin" / "fuzzyq"
    command.unlink()
    command.write_text("#!/bin/sh\nprintf '<%s>\\n' \"$@\"\n")
    command.chmod(0o755)
    assert there.step("check") == 0
    assert not list(folder.rglob("broken"))
    place = there.outputs["check"]["folder"]
    words = there.said.replace(place, "OUT").removesuffix(">\n").removeprefix("<").split(">\n<")
    usual = ["check", "--github", "--junit", "OUT/check.xml"]
    usual += ["--video", "failed", "--out", "OUT/films"]
    assert words[: len(usual)] == usual
    return words[len(usual) :]


def test_inputs_are_words_and_no_commands(tmp_path: Path) -> None:
    wild = "; touch broken; $(touch broken) `touch broken` \"' && touch broken"
    names = ("scenarios", "planner", "plugin", "repeat", "arguments")
    words = words_given(tmp_path, **dict.fromkeys(names, wild))
    options = [f"--repeat={wild}", f"--plugin={wild}", f"--planner={wild}"]
    assert words == [*options, *wild.split(), "--", wild]


def test_several_are_one_a_line_and_arguments_are_split_at_blanks(tmp_path: Path) -> None:
    words = words_given(
        tmp_path,
        scenarios="scenarios/*.yaml\n\nmore fields/\n",
        arguments="--jobs 1  --drive *",
        plugin="one.py\ntwo.py\n",
    )
    plugins = ["--plugin=one.py", "--plugin=two.py"]
    arguments = ["--jobs", "1", "--drive", "*"]
    assert words == ["--repeat=1", *plugins, *arguments, "--", "scenarios/*.yaml", "more fields/"]


def test_the_cache_is_that_of_pip_and_changes_with_the_versions(tmp_path: Path) -> None:
    there = runner(tmp_path)
    assert there.step("pip") == 0, there.said
    told = there.outputs["pip"]
    assert Path(told["folder"]).is_absolute()
    version = ".".join(map(str, sys.version_info[:3]))
    assert re.fullmatch(rf"fuzzyq-Linux-X64-{re.escape(version)}-[0-9a-f]{{64}}", told["key"])


@pytest.mark.slow
def test_what_is_installed_already_is_used_again_unless_with_another_python(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PIP_NO_INDEX", "1")  # so that nothing is installed, and it fails instead
    monkeypatch.setenv("PIP_FIND_LINKS", "")
    there = runner(tmp_path)
    ready = tmp_path / "temporary" / "fuzzyq" / "ready"
    ready.write_text(sys.executable)
    assert there.step("install") == 0, there.said
    assert there.step("check") == 0, there.said
    ready.write_text("/another/python")
    assert there.step("install") == 1
    assert not ready.exists()
    assert (ready.parent / "bin" / "python").exists()


def test_the_versions_that_it_installs_are_those_of_the_lock(tmp_path: Path) -> None:
    (install,) = (step["run"] for step in STEPS if "constraint" in step.get("run", ""))
    (sed,) = re.findall(r"sed .* \"\$GITHUB_ACTION_PATH/requirements.lock\"", install)
    done = subprocess.run(
        ["bash", "-c", sed], env={**os.environ, "GITHUB_ACTION_PATH": str(ROOT)}, stdout=-1
    )
    lines = done.stdout.decode().splitlines()
    assert len(lines) > 50
    assert all(re.fullmatch(r"[a-z0-9._-]+==[^ \\]+( ;[^\\]*)?", line) for line in lines)


# What the pages say


def blocks(page: str) -> list[Any]:
    """Return what a page shows as YAML."""
    text = (ROOT / "docs" / "how-to" / page).read_text()
    return [yaml.safe_load(one) for one in re.findall(r"^```yaml\n(.*?)^```", text, re.M | re.S)]


def test_the_workflow_of_the_page_is_three_lines_and_the_inputs_are_there() -> None:
    workflow, more, _ = blocks("github.md")
    checkout, ours = workflow["jobs"]["check"]["steps"]
    assert checkout == {"uses": "actions/checkout@v4"}
    for step in (ours, *more):
        assert step["uses"] == f"OWNER/fuzzyq_bullet@v{__version__}"
        assert step["with"].keys() <= ACTION["inputs"].keys()
    text = (ROOT / "docs" / "how-to" / "github.md").read_text()
    told = re.findall(r"^\| `([a-z-]+)` \|.*\| (?:`(.*)` )?\|$", text, re.M)
    assert dict(told) == {name: one["default"] for name, one in ACTION["inputs"].items()}


@pytest.mark.slow
@pytest.mark.parametrize(("goal", "status"), [("[1.4, 0.7]", 0), ("[1.2, 1.5]", 2)])
def test_the_script_of_the_page_for_gitlab_runs(goal: str, status: int, tmp_path: Path) -> None:
    (file,) = blocks("gitlab.md")
    install, *script = file["scenarios"]["script"]
    assert install.startswith("pip install ")
    assert install.endswith(f'@v{__version__}"')
    (tmp_path / "scenarios").mkdir()
    (tmp_path / "scenarios" / "a.yaml").write_text(SHORT.replace("[1.4, 0.7]", goal))
    path = f"{FUZZYQ.parent}{os.pathsep}{os.environ['PATH']}"
    done = subprocess.run(
        ["bash", "-eo", "pipefail", "-c", "\n".join(script)],
        env={**os.environ, "PATH": path},
        cwd=tmp_path,
    )
    assert done.returncode == status
    if status == 0:
        kept = file["scenarios"]["artifacts"]
        assert (tmp_path / kept["reports"]["junit"]).is_file()
        assert all((tmp_path / folder).is_dir() for folder in kept["paths"])


def test_everything_that_is_published_says_the_same_version() -> None:
    assert yaml.safe_load((ROOT / "CITATION.cff").read_text())["version"] == __version__
