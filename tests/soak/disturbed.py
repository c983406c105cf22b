"""A sweep that is disturbed at random moments, and started again until it is done."""

from __future__ import annotations

import json
import random
import sys
import time
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Literal, TypeAlias

from tests.soak.watched import Watched, kill

Kind: TypeAlias = Literal["worker", "command", "disk"]
ROOT = Path(__file__).resolve().parents[2]
PLUGIN = Path(__file__).with_name("plugin.py")
QUIET = 0.75
"""Part of the episodes after which nothing is disturbed: memory is watched there. Nor is an episode
killed twice there, whose row would say so: those that were killed are done again at the end."""
EVERY = 25
"""Episodes for every worker that is killed."""
PATIENCE = 900.0
"""How long a command on a full disk may take to notice (s)."""
SAMPLED = 3.0
"""Time between two looks at memory (s)."""
END = 15.0
"""How long processes may outlive a command that was killed (s)."""


@dataclass(frozen=True)
class Disturbance:
    """Something that is done when so many rows are there."""

    rows: int
    kind: Kind


def planned(episodes: int, seed: int, *, disk: bool) -> list[Disturbance]:
    """Return what is to happen, in order; the same for the same seed."""
    rng = random.Random(seed)
    last = max(2, int(episodes * QUIET))
    kinds: list[Kind] = ["worker"] * max(1, episodes // EVERY)
    kinds += ["command"] * max(1, episodes // 500)
    told = [Disturbance(rng.randrange(1, last), kind) for kind in kinds]
    if disk:
        told.append(Disturbance(int(episodes * 0.4), "disk"))
    return sorted(told, key=lambda one: one.rows)


@dataclass
class Ledger:
    """What has happened so far: it goes on where a soak was ended.

    Attributes:
        path: Its file, a JSON object a line.
        done: Disturbances.
        faults: Whatever should not have been.
        samples: Memory: life, rows, that of the command and of each worker (MB).
        lives: How often the command was started.
        seconds: For how long it ran.
    """

    path: Path
    done: list[dict[str, Any]] = field(default_factory=list)
    faults: list[str] = field(default_factory=list)
    samples: list[dict[str, Any]] = field(default_factory=list)
    lives: int = 0
    seconds: float = 0.0

    @classmethod
    def of(cls, path: Path) -> Ledger:
        """Return what a file tells; nothing where there is none."""
        ledger = cls(path)
        if path.exists():
            for line in path.read_text().splitlines():
                ledger._take(json.loads(line))
        return ledger

    def note(self, what: str, told: Any) -> None:
        """Note something, on disk too."""
        self._take({"what": what, "told": told})
        with self.path.open("a") as file:
            file.write(json.dumps({"what": what, "told": told}) + "\n")

    def _take(self, line: dict[str, Any]) -> None:
        what, told = line["what"], line["told"]
        if what == "life":
            self.lives += 1
        elif what == "ran":
            self.seconds += told
        elif what == "fault":
            self.faults.append(told)
        else:
            {"done": self.done, "sample": self.samples}[what].append(told)


class Sweep:
    """The sweep, its folder and its disk.

    Args:
        disk: A folder on a disk that may be filled; the sweep lies in ``sweep`` there.
        ledger: What has happened.
        mark: What its processes are known by.
        episodes: How many.
        seed: Of the sweep, and of what disturbs it.
        jobs: Workers.
        may_fill: Whether the disk is for nothing else.
    """

    def __init__(
        self,
        disk: Path,
        ledger: Ledger,
        mark: str,
        *,
        episodes: int,
        seed: int,
        jobs: int,
        may_fill: bool,
    ) -> None:
        self.folder, self.temporary = disk / "sweep", disk / "tmp"
        self._filler = disk / "filler"
        self._ledger, self._mark = ledger, mark
        self._episodes = episodes
        self._rng = random.Random(seed + 1 + len(ledger.done))
        self._due = planned(episodes, seed, disk=may_fill)[len(ledger.done) :]
        self.command = [
            *(sys.executable, "-m", "fuzzyq_bullet", "bench", "soak", "--plugin", str(PLUGIN)),
            *("--episodes", str(episodes), "--seed", str(seed), "--jobs", str(jobs)),
            *("--out", str(self.folder)),
        ]

    def run(self) -> None:
        """Start the command again whenever it was made to end, until it ends by itself."""
        self.temporary.mkdir(parents=True, exist_ok=True)
        self._filler.unlink(missing_ok=True)
        status = None
        while status is None:
            self._ledger.note("life", self._rows())
            status = self._live()
        if status != 0:
            self._ledger.note("fault", f"the command ended with {status}: {self._last_words()}")

    def _live(self) -> int | None:
        """Run the command until it ends; return its exit code, None if it was made to end."""
        begun = time.monotonic()
        with self._log.open("wb") as log:
            watched = Watched(self.command, self._mark, self.temporary, log, ROOT)
            try:
                status = self._follow(watched)
            finally:
                if not watched.all_gone(END):
                    self._ledger.note("fault", f"processes were still there after {END:g} s")
                self._ledger.note("ran", round(time.monotonic() - begun, 3))
        return status

    def _follow(self, watched: Watched) -> int | None:
        sampled = 0.0
        while watched.process.poll() is None:
            time.sleep(0.1)
            rows = self._rows()
            if time.monotonic() - sampled > SAMPLED:
                sampled = time.monotonic()
                self._sample(watched, rows)
            while self._due and rows >= self._due[0].rows:
                time.sleep(self._rng.random())  # wherever the workers are then
                if not self._disturb(watched, self._due[0]):
                    break  # no worker yet: later
                if self._due.pop(0).kind != "worker":
                    watched.process.wait()
                    return None
        return watched.process.returncode

    def _disturb(self, watched: Watched, what: Disturbance) -> bool:
        """Do it; tell whether there was something to do it to."""
        workers, commander = watched.workers(), watched.commander()
        if not workers or commander is None or watched.process.poll() is not None:
            return False
        told: dict[str, Any] = asdict(what)
        if what.kind == "worker":
            kill(self._rng.choice(workers).pid)
        elif what.kind == "command":
            told["inner"] = self._rng.random() < 0.5
            kill(commander.pid if told["inner"] else watched.process.pid)
        else:
            told["said"] = self._fill(watched)
        self._ledger.note("done", told)
        return True

    def _fill(self, watched: Watched) -> str:
        """Fill the disk, wait for the command to notice, make room again; return what it said."""
        with self._filler.open("wb", buffering=0) as file:
            for size in (2**20, 4096, 1):
                with suppress(OSError):  # that is what it is for
                    while file.write(b"\0" * size):
                        pass
        deadline = time.monotonic() + PATIENCE
        while watched.process.poll() is None:
            if time.monotonic() > deadline:
                self._ledger.note("fault", f"went on for {PATIENCE:g} s on a full disk")
                watched.process.kill()
            time.sleep(0.1)
        said = self._last_words()
        if watched.process.returncode != 2 or "No space left" not in said:
            self._ledger.note("fault", f"on a full disk: {watched.process.returncode}, {said}")
        self._filler.unlink()
        return said

    @property
    def _log(self) -> Path:
        return self._ledger.path.with_name("stderr.txt")

    def _last_words(self) -> str:
        lines = self._log.read_text(errors="replace").splitlines()
        return lines[-1] if lines else ""

    def _rows(self) -> int:
        journal = self.folder / "journal.jsonl"
        return journal.read_bytes().count(b"\n") if journal.exists() else 0

    def _sample(self, watched: Watched, rows: int) -> None:
        commander = watched.commander()
        if commander is not None:
            workers = {one.pid: round(one.memory_mb, 1) for one in watched.workers()}
            told = {"rows": rows, "command": round(commander.memory_mb, 1), "workers": workers}
            self._ledger.note("sample", {"life": self._ledger.lives, **told})


def quiet_samples(ledger: Ledger, episodes: int) -> Iterator[dict[str, Any]]:
    """Yield the samples of the last life that ran any, from where it was disturbed no more."""
    quiet = [one for one in ledger.samples if one["rows"] >= episodes * QUIET]
    last = max((one["life"] for one in quiet), default=0)
    yield from (one for one in quiet if one["life"] == last)
