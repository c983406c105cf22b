"""``fuzzyq check`` with workers that are killed: each costs its own run, and no other."""

from __future__ import annotations

import json
import random
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from fuzzyq_bullet import load_scenario, run, with_options
from tests.soak.disturbed import END, ROOT
from tests.soak.verified import why_unreadable
from tests.soak.watched import Watched, kill

SCENARIOS = ("boxes", "crowd", "figure-12f", "mixed", "office", "patrol", "rounds", "sparse")
AGAIN = 16
"""Runs that are done again, undisturbed."""


def check(
    disk: Path, mark: str, *, repeat: int, kills: int, seed: int, jobs: int
) -> tuple[dict[str, int], list[str]]:
    """Run a check, kill workers meanwhile, and hold what it says to what was promised.

    Returns:
        Figures, and what is wrong.
    """
    out, temporary, log = disk / "check", disk / "tmp", disk / "check.txt"
    verdict = disk / "check.json"
    command = [
        *(sys.executable, "-m", "fuzzyq_bullet", "check", *SCENARIOS, "--repeat", str(repeat)),
        *("--jobs", str(jobs), "--video", "all", "--out", str(out), "--replace", "--json"),
    ]
    rng = random.Random(seed)
    total = repeat * len(SCENARIOS)
    due = sorted(rng.randrange(1, total) for _ in range(kills))
    due.append(total + len(SCENARIOS) + 1)  # while films are made
    killed, faults = 0, []
    with log.open("wb") as file, verdict.open("wb") as output:
        watched = Watched(command, mark, temporary, file, ROOT, output)
        while watched.process.poll() is None:
            time.sleep(0.1)
            lines = log.read_bytes().count(b"\n")
            workers = watched.workers()
            if due and lines >= due[0] and workers:
                time.sleep(rng.random())
                kill(rng.choice(workers).pid)
                killed += 1
                due.pop(0)
        if not watched.all_gone(END):
            faults.append(f"processes of the check were still there after {END:g} s")
    told = json.loads(verdict.read_bytes())
    verdicts = told["scenarios"]
    broken = [one for one in verdicts if one["status"] == "broken"]
    films = [one for one in verdicts if one["video"]]
    faults += _faults(verdicts, broken, killed, total)
    faults += _faults_of_digests(verdicts, rng)
    records = sorted(out.glob("*.npz"))
    faults += _faults_of_records(records)
    figures = {
        "runs": len(verdicts),
        "workers_killed": killed,
        "runs_lost_with_them": len(broken),
        "films": len(films),
        "records": len(records),
    }
    return figures, faults


def _faults(
    verdicts: list[dict[str, Any]], broken: list[dict[str, Any]], killed: int, total: int
) -> Iterator[str]:
    names = {one["name"] for one in verdicts}
    if len(verdicts) != total or len(names) != total:
        yield f"check: {len(verdicts)} verdicts, {len(names)} names, for {total} runs"
    if len(broken) > killed:
        yield f"check: {len(broken)} runs are broken, and {killed} workers were killed"
    for one in broken:
        if "killed" not in one["why"][0]:
            yield f"check: {one['name']}: {one['why'][0]}"


def _faults_of_digests(verdicts: list[dict[str, Any]], rng: random.Random) -> Iterator[str]:
    ended = [one for one in verdicts if one["result"] is not None]
    for one in rng.sample(ended, min(AGAIN, len(ended))):
        scenario = with_options(load_scenario(one["file"]), seed=one["result"]["seed"])
        if run(scenario).digest() != one["result"]["digest"]:
            yield f"check: {one['name']}: comes to something else when run again"


def _faults_of_records(records: list[Path]) -> Iterator[str]:
    yield from (f"check: {why}" for path in records if (why := why_unreadable(path)))
