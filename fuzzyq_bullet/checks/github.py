"""Verdicts as annotations of GitHub's: each on the scenario's file, at its line."""

from __future__ import annotations

import os
import re
from pathlib import Path

from fuzzyq_bullet.checks.verdict import Verdict

_PLACE = re.compile(r"(?P<file>[^:\n]+\.ya?ml)(:(?P<line>\d+))?: ")


def verdict_commands(verdict: Verdict) -> list[str]:
    """Return the workflow commands that tell of a failure, and of changes."""
    told = []
    if verdict.status != "passed":
        placed = _PLACE.match(verdict.why[0]) if verdict.why else None
        line = int(placed["line"] or 1) if placed else verdict.line
        text = "\n".join([*verdict.why, *([verdict.replay] if verdict.result else [])])
        told.append(_command("error", verdict.file, line, verdict.name, text))
    for warning in verdict.warnings:
        placed = _PLACE.match(warning)
        line = int(placed["line"] or 1) if placed else 1
        told.append(_command("warning", verdict.file, line, verdict.name, warning))
    if verdict.changes:
        text = "\n".join(verdict.changes)
        told.append(_command("warning", verdict.file, verdict.line, verdict.name, text))
    return told


def problem_command(problem: str) -> str:
    """Return the workflow command for a line that begins with a file, and perhaps its line."""
    placed = _PLACE.match(problem)
    if placed is None:
        return f"::error title=fuzzyq check::{_data(problem)}"
    return _command("error", placed["file"], int(placed["line"] or 1), "fuzzyq check", problem)


def harmless(line: str) -> str:
    """Return a line for people that GitHub takes for no command, whatever names it holds."""
    return line.replace("::", ": :").replace("##[", "## [")


def _command(kind: str, file: str, line: int, title: str, text: str) -> str:
    where = f"file={_value(_from_here(file))},line={line},title={_value(title)}"
    return f"::{kind} {where}::{_data(text)}"


def _from_here(file: str) -> str:
    """Return a path as GitHub knows it: from the top of the checkout, which is the usual place."""
    top = Path(os.environ.get("GITHUB_WORKSPACE") or Path.cwd()).resolve()
    path = Path(file).parent.resolve() / Path(file).name  # a link is the file that was checked
    return path.relative_to(top).as_posix() if path.is_relative_to(top) else file


def _data(text: str) -> str:
    return text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")


def _value(text: str) -> str:
    return _data(text).replace(":", "%3A").replace(",", "%2C")
