"""Verdicts for programs: JSON, JUnit XML, and annotations of GitHub's."""

from __future__ import annotations

import json
import os
import platform
import re
from collections.abc import Iterable, Iterator, Sequence
from datetime import datetime, timezone
from pathlib import Path
from xml.etree import ElementTree

from fuzzyq_bullet.checks.group import Group, group_lines, in_words
from fuzzyq_bullet.checks.verdict import Verdict, counts_of, explanation, lines_of
from fuzzyq_bullet.version import __version__

_PLACE = re.compile(r"(?P<file>[^:\n]+\.ya?ml)(:(?P<line>\d+))?: ")
_NOT_XML = re.compile("[^\t\n\r\u0020-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""What XML 1.0 cannot hold, not even escaped."""


def as_json(
    verdicts: Sequence[Verdict],
    problems: Sequence[str],
    seconds: float,
    groups: Sequence[Group] = (),
) -> str:
    """Return all that is known of a check.

    Args:
        verdicts: What came of each run.
        problems: What is wrong with the input besides.
        seconds: Wall-clock time of it all (s).
        groups: What came of each scenario, where each ran several times.
    """
    told = {
        "version": __version__,
        **counts_of(verdicts),
        "problems": list(problems),
        "seconds": round(seconds, 3),
        "groups": [group.model_dump(mode="json") for group in groups],
        "scenarios": [verdict.model_dump(mode="json") for verdict in verdicts],
    }
    return json.dumps(told, indent=2)


def junit_xml(
    verdicts: Sequence[Verdict],
    problems: Sequence[str],
    seconds: float,
    groups: Sequence[Group] = (),
) -> str:
    """Return the report, in the form that both Ant's schema and that of Jenkins allow.

    Without groups it is one suite with a case for each scenario. A group is a suite: a case for
    each seed and, last, one for the verdict on all. A run that failed and is allowed to is a
    skipped case, with its reason.

    Args:
        verdicts: What came of each run.
        problems: What is wrong with the input besides; each is an error of its own.
        seconds: Wall-clock time of it all (s).
        groups: What came of each scenario, where each ran several times.
    """
    root = ElementTree.Element("testsuites")
    grouped = {group.file for group in groups}
    for group in groups:
        members = [verdict for verdict in verdicts if verdict.file == group.file]
        cases = [*(_case(verdict) for verdict in members), _group_case(group)]
        lines = [line for verdict in members for line in lines_of(verdict, member=True)]
        taken = sum(verdict.seconds for verdict in members)
        root.append(_suite(len(root), group.name, cases, [*lines, *group_lines(group)], taken))
    alone = [verdict for verdict in verdicts if verdict.file not in grouped]
    cases = [_case(verdict) for verdict in alone]
    cases += [_problem(i, problem) for i, problem in enumerate(problems, 1)]
    if cases or not groups:
        lines = [line for verdict in alone for line in lines_of(verdict)]
        root.append(_suite(len(root), "fuzzyq check", cases, lines, seconds))
    ElementTree.indent(root)
    text = ElementTree.tostring(root, encoding="unicode")
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{text}\n'


def _suite(
    number: int,
    name: str,
    cases: Sequence[ElementTree.Element],
    lines: Sequence[str],
    seconds: float,
) -> ElementTree.Element:
    suite = ElementTree.Element(
        "testsuite",
        {
            "name": _clean(name),
            "package": "fuzzyq",
            "id": str(number),
            "timestamp": datetime.now(timezone.utc).strftime("%Y-%m-%dT%H:%M:%S"),
            "hostname": _clean(platform.node()) or "localhost",
            "tests": str(len(cases)),
            "failures": str(sum(case.find("failure") is not None for case in cases)),
            "errors": str(sum(case.find("error") is not None for case in cases)),
            "skipped": str(sum(case.find("skipped") is not None for case in cases)),
            "time": f"{seconds:.3f}",
        },
    )
    ElementTree.SubElement(suite, "properties")
    suite.extend(cases)
    # Ant's schema wants both, even empty.
    out = ElementTree.SubElement(suite, "system-out")
    out.text = _clean("\n".join(lines))
    ElementTree.SubElement(suite, "system-err")
    return suite


def _case(verdict: Verdict) -> ElementTree.Element:
    case = _element(verdict.name, verdict.file, verdict.seconds)
    if verdict.status == "allowed":
        why = {"message": _clean("allowed by the pass rate: " + "; ".join(verdict.why))}
        ElementTree.SubElement(case, "skipped", why)
    elif verdict.status != "passed":
        # A failure is a verdict about the robot; an error is that there is none.
        kind = "failure" if verdict.status == "failed" else "error"
        why = {"message": _clean("; ".join(verdict.why)), "type": verdict.status}
        ElementTree.SubElement(case, kind, why).text = _clean(
            f"{verdict.file}:{verdict.line}\n{explanation(verdict)}"
        )
    return case


def _group_case(group: Group) -> ElementTree.Element:
    case = _element(f"all {group.runs} runs", group.file, 0.0)
    if group.status != "passed":
        kind = "failure" if group.status == "failed" else "error"
        why = {"message": _clean("; ".join([in_words(group), *group.why])), "type": group.status}
        text = "\n".join([f"{group.file}:{group.line}", *group_lines(group)])
        ElementTree.SubElement(case, kind, why).text = _clean(text)
    return case


def _problem(number: int, problem: str) -> ElementTree.Element:
    case = _element(f"input-{number}", "input", 0.0)
    why = {"message": _clean(problem), "type": "invalid"}
    ElementTree.SubElement(case, "error", why).text = _clean(problem)
    return case


def _element(name: str, file: str, seconds: float) -> ElementTree.Element:
    parts = [part for part in Path(file).with_suffix("").parts if part.strip("./\\")]
    where = {"name": _clean(name), "classname": _clean(".".join(parts)), "time": f"{seconds:.3f}"}
    return ElementTree.Element("testcase", where)


def _clean(text: str) -> str:
    return _NOT_XML.sub("?", text)


def verdict_commands(verdict: Verdict) -> list[str]:
    """Return GitHub's workflow commands that tell of a failure, and of changes, at their lines."""
    told = []
    if verdict.status != "passed":
        placed = _PLACE.match(verdict.why[0]) if verdict.why else None
        line = int(placed["line"] or 1) if placed else verdict.line
        text = "\n".join([*verdict.why, *([verdict.replay] if verdict.result else [])])
        told.append(_command("error", verdict.file, line, verdict.name, text))
    return [*told, *_remarks(verdict, verdict.warnings)]


def group_commands(group: Group, verdicts: Sequence[Verdict]) -> list[str]:
    """Return GitHub's workflow commands on a group: one on its verdict, others on its warnings.

    One error for all its runs, at the line of the worst: GitHub shows ten of a step.

    Args:
        group: The verdict on all.
        verdicts: The runs.
    """
    told = []
    if group.status != "passed":
        lines = [
            in_words(group),
            *group.why,
            *(f"worst: {why}" for why in group.worst_why),
            group.replay,
        ]
        told.append(_command("error", group.file, group.line, group.name, "\n".join(lines)))
    warnings = dict.fromkeys(one for verdict in verdicts for one in verdict.warnings)
    return [*told, *_remarks(group, warnings)]


def _remarks(verdict: Verdict | Group, warnings: Iterable[str]) -> Iterator[str]:
    """Yield commands for warnings, at the lines that they name, and for changes."""
    for warning in warnings:
        placed = _PLACE.match(warning)
        line = int(placed["line"] or 1) if placed else 1
        yield _command("warning", verdict.file, line, verdict.name, warning)
    if verdict.changes:
        text = "\n".join(verdict.changes)
        yield _command("warning", verdict.file, verdict.line, verdict.name, text)


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
