"""Verdicts as JUnit XML, in the form that both Ant's schema and that of Jenkins allow."""

from __future__ import annotations

import platform
import re
from collections.abc import Sequence
from datetime import datetime, timezone
from pathlib import Path
from xml.etree import ElementTree

from fuzzyq_bullet.checks.verdict import Verdict
from fuzzyq_bullet.checks.words import explanation, lines_of

_NOT_XML = re.compile("[^\t\n\r\u0020-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""What XML 1.0 cannot hold, not even escaped."""


def junit_xml(verdicts: Sequence[Verdict], problems: Sequence[str], seconds: float) -> str:
    """Return the report.

    Args:
        verdicts: What came of each scenario.
        problems: What is wrong with the input besides; each is an error of its own.
        seconds: Wall-clock time of it all (s).
    """
    cases = [_case(verdict) for verdict in verdicts]
    cases += [_problem(i, problem) for i, problem in enumerate(problems, 1)]
    suite = ElementTree.Element(
        "testsuite",
        {
            "name": "fuzzyq check",
            "package": "fuzzyq",
            "id": "0",
            "timestamp": datetime.now(timezone.utc).strftime("%Y-%m-%dT%H:%M:%S"),
            "hostname": _clean(platform.node()) or "localhost",
            "tests": str(len(cases)),
            "failures": str(sum(case.find("failure") is not None for case in cases)),
            "errors": str(sum(case.find("error") is not None for case in cases)),
            "time": f"{seconds:.3f}",
        },
    )
    ElementTree.SubElement(suite, "properties")
    suite.extend(cases)
    # Ant's schema wants both, even empty.
    out = ElementTree.SubElement(suite, "system-out")
    out.text = _clean("\n".join(line for verdict in verdicts for line in lines_of(verdict)))
    ElementTree.SubElement(suite, "system-err")
    root = ElementTree.Element("testsuites")
    root.append(suite)
    ElementTree.indent(root)
    text = ElementTree.tostring(root, encoding="unicode")
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{text}\n'


def _case(verdict: Verdict) -> ElementTree.Element:
    case = _element(verdict.name, verdict.file, verdict.seconds)
    if verdict.status != "passed":
        # A failure is a verdict about the robot; an error is that there is none.
        kind = "failure" if verdict.status == "failed" else "error"
        why = {"message": _clean("; ".join(verdict.why)), "type": verdict.status}
        ElementTree.SubElement(case, kind, why).text = _clean(
            f"{verdict.file}:{verdict.line}\n{explanation(verdict)}"
        )
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
