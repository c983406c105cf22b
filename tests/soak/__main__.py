"""The soak: thousands of episodes, disturbed at random; then nothing may be lost.

    python -m tests.soak --episodes 2000 --jobs 2 --out out/soak

A study of every planner, with both drives, in bundled scenarios and random fields, keeps every
record. Meanwhile its workers and its command are killed at random moments, and its disk is filled
once; the same command is started again each time. At the end every episode must have one row, every
record be readable, a sample run again must come to the same digests, the memory must be flat, and
nothing be left behind. ``fuzzyq check`` is treated likewise.

It may be ended at any moment: the same command goes on. Linux alone; only root has a disk to fill,
a tmpfs. Exit code 1 when something is wrong.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import subprocess
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from fuzzyq_bullet.files import write_text
from fuzzyq_bullet.studies.storage import rows_in
from fuzzyq_bullet.version import __version__
from tests.soak.checked import check
from tests.soak.disturbed import Ledger, Sweep
from tests.soak.soak_study import Soak
from tests.soak.verified import (
    MOST_GROWTH,
    SAMPLE,
    faults_of_digests,
    faults_of_leftovers,
    faults_of_records,
    faults_of_rows,
    memory,
)

DISK_MB = 4096
"""Size of the disk that is filled (MB); it takes memory only for what lies on it."""


def main(words: Sequence[str] | None = None) -> int:
    """Soak; return 1 if something is wrong."""
    options = _options(words)
    out = options.out.resolve()
    out.mkdir(parents=True, exist_ok=True)
    disk, mounted = _disk_in(out, fill=options.disk == "full")
    ledger = Ledger.of(out / "events.jsonl")
    mark = hashlib.sha256(str(out).encode()).hexdigest()[:16]
    study = Soak(episodes=options.episodes, seed=options.seed)
    sweep = Sweep(
        disk,
        ledger,
        mark,
        episodes=options.episodes,
        seed=options.seed,
        jobs=options.jobs,
        may_fill=mounted,
    )
    begun = time.monotonic()
    sweep.run()
    checked, faults = check(
        disk,
        mark,
        repeat=options.repeat,
        kills=max(1, options.repeat // 2),
        seed=options.seed,
        jobs=options.jobs,
    )
    jobs = study.plan().jobs(study.planner_set())
    rows = {row.key: row for row in rows_in(sweep.folder / "journal.jsonl")}
    faults = [
        *ledger.faults,
        *faults_of_rows(sweep.folder, study),
        *faults_of_records(sweep.folder, jobs, rows),
        *faults_of_digests(jobs, rows, options.seed),
        *faults_of_leftovers([sweep.folder, disk / "check"], sweep.temporary, mark),
        *faults,
    ]
    held = memory(ledger, options.episodes)
    faults += [
        f"the memory of the {name} grows by {one['growth']:.1f} MB in a thousand episodes"
        for name, one in held.items()
        if one["growth"] is not None and one["growth"] > MOST_GROWTH
    ]
    done = [one["kind"] for one in ledger.done]
    told: dict[str, Any] = {
        "version": __version__,
        "episodes": len(rows),
        "planners": list(study.planner_set()),
        "records": len(list((sweep.folder / "records").glob("*.npz"))),
        "run_again": min(SAMPLE, len(jobs)),
        "workers_killed": done.count("worker"),
        "commands_killed": done.count("command"),
        "disk_filled": done.count("disk"),
        "disk_said": [one["said"] for one in ledger.done if one["kind"] == "disk"],
        "command_started": ledger.lives,
        "sweep_s": round(ledger.seconds, 1),
        "memory_mb": held,
        "check": checked,
        "faults": faults,
    }
    write_text(out / "soak.json", json.dumps(told, indent=2) + "\n")
    print(_table(told))
    print(f"{out / 'soak.json'}; this part took {time.monotonic() - begun:.0f} s")
    if mounted and not faults:
        subprocess.run(["umount", str(disk)], check=True)
    return 1 if faults else 0


def _options(words: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m tests.soak", description="Soak the package.")
    parser.add_argument("--episodes", type=int, default=2000, help="of the sweep (2000)")
    parser.add_argument("--repeat", type=int, default=20, help="seeds of the check (20)")
    parser.add_argument("--seed", type=int, default=0, help="of episodes and disturbances (0)")
    parser.add_argument("--jobs", type=int, default=2, help="worker processes (2)")
    parser.add_argument("--disk", choices=("full", "spared"), default="full", help="(full)")
    parser.add_argument("--out", type=Path, default=Path("out/soak"), help="folder (out/soak)")
    return parser.parse_args(words)


def _disk_in(out: Path, *, fill: bool) -> tuple[Path, bool]:
    """Return the folder that the soak works in, and whether it is a disk of its own."""
    disk = out / "disk"
    disk.mkdir(exist_ok=True)
    if not fill or disk.is_mount():
        return disk, disk.is_mount()
    if os.geteuid() != 0:
        print("not root: no disk is filled", file=sys.stderr)
        return disk, False
    mount = ["mount", "-t", "tmpfs", "-o", f"size={DISK_MB}m", "fuzzyq-soak", str(disk)]
    return disk, subprocess.run(mount, check=False).returncode == 0


def _growth(slope: float | None) -> str:
    return "too short to tell growth" if slope is None else f"{slope:+.1f} MB in 1000 episodes"


def _table(told: dict[str, Any]) -> str:
    """Return it for people."""
    held, checked = told["memory_mb"], told["check"]
    lines = [
        ("episodes", f"{told['episodes']}, of {', '.join(told['planners'])}"),
        ("workers killed", f"{told['workers_killed']}"),
        ("commands killed", f"{told['commands_killed']}"),
        ("full disk", "; ".join(told["disk_said"]) or "not tried"),
        ("command started", f"{told['command_started']} times, {told['sweep_s']:.0f} s in all"),
        ("records", f"{told['records']} readable, each of its row's run"),
        ("run again", f"{told['run_again']} episodes"),
        *(
            (
                f"memory, {name}",
                f"{one['first']:.0f} MB at first, {one['last']:.0f} at last, {one['most']:.0f} at "
                f"most; {_growth(one['growth'])}",
            )
            for name, one in held.items()
        ),
        (
            "check",
            f"{checked['runs']} runs, {checked['workers_killed']} workers killed, "
            f"{checked['runs_lost_with_them']} runs broken; {checked['films']} films",
        ),
        ("faults", f"{len(told['faults'])}"),
    ]
    width = max(len(name) for name, _ in lines)
    told_faults = [f"  {fault}" for fault in told["faults"][:20]]
    return "\n".join([*(f"{name:<{width}}  {value}" for name, value in lines), *told_faults])


if __name__ == "__main__":
    sys.exit(main())
