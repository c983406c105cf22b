"""Every block of code in the documentation does what a reader of the page would have it do.

The commands of a page are run one after the other in a folder of its own; what a comment in front
of a block can ask for is said in ``tests/helpers/pages.py``.
"""

from __future__ import annotations

import json
import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import typer
import yaml

from fuzzyq_bullet.cli.app import app
from fuzzyq_bullet.fuzzy import load_controller
from fuzzyq_bullet.scenario import parse_scenario
from tests.helpers.commands import Call
from tests.helpers.pages import NAMES, PAGES, ROOT, Block, blocks, given, inline_commands

EACH_PAGE = pytest.mark.parametrize("page", PAGES, ids=NAMES)

EXTRAS = re.compile(r"fuzzyq_bullet\[([a-z,]+)\]|^-?\.\[([a-z,]+)\]$")
PLACEHOLDER = re.compile(r"\b(?:[A-Z]{2,}[A-Z_-]*|D|N|R|P|T|S)\b|…|\.\.\.")
"""What a reader puts something of their own in place of: FILE, NAME, N."""

INCOMPLETE = ("MissingParameter", "NoArgsIsHelpError")
"""Errors of a command that is only named within a line, with an option perhaps."""

ELSEWHERE = {
    "fuzzyq watch": "tests/test_live.py opens the window",
    "python3": "makes an environment",
    "dask": "tests/workers/test_cluster.py starts a cluster",
    "xvfb-run": "tests/test_live.py opens the window on a screen of its own",
    "jupyter": "stays open; tests/test_lessons.py runs the lessons",
    "jupytext": "tests/test_lessons.py opens the lessons as notebooks",
    "jupytext-config": "changes the settings of the reader's account",
    ".ci/run": "runs these tests",
    "apt-get": "installs for the whole machine",
    "git": "is about the reader's own repository",
}
"""Commands that are not run here, and why."""


def read_by_the_command_line(words: list[str]) -> None:
    """Let the command line read words without doing what they say; it raises if they are wrong."""
    command: Any = typer.main.get_command(app)
    name, rest = words[0], words[1:]
    while hasattr(command, "list_commands") and rest and not rest[0].startswith("-"):
        context = command.make_context(name, [], resilient_parsing=True)
        name, *rest = rest
        command = command.get_command(context, name)
        assert command is not None, f"there is no command {name}"
    while "--plugin" in rest:  # it would be imported
        at = rest.index("--plugin")
        del rest[at : at + 2]
    try:
        command.make_context(name, rest)
    except typer.Exit:  # --help
        return


@EACH_PAGE
def test_the_command_line_understands_every_command(page: Path) -> None:
    told = [words for one in blocks(page) if one.kind == "sh" for words in one.commands()]
    for words in [*told, *inline_commands(page)]:
        if words[0] != "fuzzyq" or PLACEHOLDER.search(" ".join(words)):
            continue
        until = next((i for i, word in enumerate(words) if word in ("|", "&", ">", "&&")), None)
        try:
            read_by_the_command_line(words[:until])
        except Exception as error:
            if words not in told and type(error).__name__ in INCOMPLETE:
                continue
            pytest.fail(f"{page}: {' '.join(words)}: {error!r}")


@EACH_PAGE
def test_what_is_data_is_what_it_seems(page: Path, tmp_path: Path) -> None:
    for one in blocks(page):
        if one.kind == "yaml":
            is_sound(one, tmp_path)
        elif one.kind == "json":
            for line in [one.code] if one.code.startswith("{\n") else one.code.splitlines():
                json.loads(line.replace(", …", ""))
        elif one.kind == "python":
            compile(one.code, one.place, "exec")
        else:
            known = ("sh", "toml", "text", "mermaid", "xml", "ini", "perl", "cpp", "")
            assert one.kind in known, f"{one.place}: nobody tries a block of {one.kind}"
            assert one.kind == "sh" or not one.code.startswith("fuzzyq "), f"{one.place}: name sh"


def is_sound(one: Block, folder: Path) -> None:
    """Read YAML as what its keys say that it is: a job, a controller, options, or a scenario."""
    held = yaml.safe_load(one.code)
    if isinstance(held, list):  # some steps of a job
        held = {"jobs": {"part": {"steps": held}}}
    if "jobs" in held:
        for step in [step for job in held["jobs"].values() for step in job["steps"]]:
            for line in step.get("run", "").splitlines():
                is_job_line(line, one)
    elif any("script" in part for part in held.values() if isinstance(part, dict)):
        for line in [line for part in held.values() for line in part.get("script", [])]:
            is_job_line(line, one)
    elif {"inputs", "outputs"} <= held.keys():
        (folder / "rules.yaml").write_text(one.code)
        load_controller(folder / "rules.yaml")
    elif "episodes" in held:
        from fuzzyq_bullet.training.options import read_options

        (folder / "how.yaml").write_text(one.code)
        read_options(folder / "how.yaml")
    elif one.notes.get("file", "").endswith((".yml", ".action.yaml")):
        return
    else:
        usual = {"name": "part", "start": {"position": [1, 1]}, "goal": {"position": [9, 9]}}
        if "motion" in held or "shape" in held:
            held = {"obstacles": [held]}
        if "obstacles" not in held and "random" not in held:
            usual["obstacles"] = []  # type: ignore[assignment]
        text = yaml.safe_dump(usual | held, sort_keys=False)
        # What a file beside it or a plugin says is tried where the block is run.
        if one.notes.get("file") or re.search(r"\b\w+\.(urdf|yaml|csv)\b|--plugin", one.code):
            return
        parse_scenario(text, one.place)


def is_job_line(line: str, one: Block) -> None:
    """Look at a line of a job in CI."""
    for words in Block(one.page, one.line, "sh", line).commands():
        if words[0] == "fuzzyq":
            read_by_the_command_line(words)


@pytest.mark.slow
@EACH_PAGE
def test_its_commands_do_what_they_say(page: Path, tmp_path: Path, fuzzyq: Call) -> None:
    for name in ("examples", "tests", "scenarios"):
        (tmp_path / name).symlink_to(ROOT / name)
    for name, path in given(page).items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        if path.is_dir():
            shutil.copytree(path, tmp_path / name)
        else:
            shutil.copy(path, tmp_path / name)
    printed, python = "", ""
    for one in blocks(page):
        if "file" in one.notes:
            file = tmp_path / one.notes["file"]
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(one.code, encoding="utf-8")
        elif "not run" in one.notes:
            assert one.notes["not run"], f"{one.place}: why not?"
        elif one.kind == "sh":
            printed = shell(one, tmp_path, fuzzyq)
        elif one.kind == "python":
            python += one.code + "\n"
            run([sys.executable, "-c", python], one, tmp_path)
        if "printed" in one.notes:
            for line in one.code.splitlines():
                if line.strip() not in ("", "..."):
                    said = [told.strip() for told in printed.splitlines()]
                    assert line.strip() in said, f"{one.place}: {line}\n{printed}"


def shell(one: Block, folder: Path, fuzzyq: Call) -> str:
    """Run the commands of a block, and return what the last one printed."""
    printed = ""
    added = dict(
        part.split(maxsplit=1) for part in one.notes.get("tested with", "").split(";") if part
    )
    expected = {int(code) for code in one.notes.get("exits with", "0").split(" or ")}
    for words in one.commands():
        if " ".join(words[:2]) in ELSEWHERE or words[0] in ELSEWHERE:
            continue
        if words[0] == "fuzzyq":
            more = shlex.split(added.get(words[1], ""))
            done = fuzzyq(*words[1:], *more, cwd=folder, timeout=600)
            printed = done.stdout + done.stderr
            assert done.returncode in expected, f"{one.place}: {' '.join(words)}\n{printed}"
        elif words[0] == "make":
            subprocess.run(["make", "-n", *words[1:]], cwd=ROOT, check=True, capture_output=True)
        elif words[0] == "pip":
            has_extras(words, one)
        elif words[0] in ("python", "pytest"):
            called = [sys.executable, *(["-m", "pytest"] if words[0] == "pytest" else [])]
            printed = run([*called, *words[1:]], one, folder)
        else:
            pytest.fail(f"{one.place}: nobody tries {words[0]}")
    return printed


def run(command: list[str], one: Block, folder: Path) -> str:
    """Run a command in a folder, and return what it printed."""
    paths = os.pathsep.join(filter(None, [str(ROOT), os.environ.get("PYTHONPATH", "")]))
    done = subprocess.run(
        command,
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=600,
        env=os.environ | {"MPLBACKEND": "agg", "PYTHONPATH": paths},
    )
    printed = done.stdout + done.stderr
    assert done.returncode == 0, f"{one.place}: {' '.join(command)}\n{printed}"
    return printed


def has_extras(words: list[str], one: Block) -> None:
    """Look whether what pip is to install is there."""
    text = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    for word in words[2:]:
        if match := EXTRAS.search(word):
            for extra in (match[1] or match[2]).split(","):
                assert re.search(rf"^{extra} = \[", text, re.MULTILINE), f"{one.place}: {extra}"
