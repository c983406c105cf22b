"""How scenarios behaved when it was recorded, beside them; and what is otherwise by now."""

from __future__ import annotations

import os
import platform
from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Literal

from pydantic import BaseModel, ConfigDict, ValidationError

from fuzzyq_bullet.checks.group import Group
from fuzzyq_bullet.checks.verdict import Verdict
from fuzzyq_bullet.errors import UserError
from fuzzyq_bullet.files import read_bytes, writable_files, write_text
from fuzzyq_bullet.platforms import data_folder, pybullet_in_words
from fuzzyq_bullet.recording.metrics import Result
from fuzzyq_bullet.version import __version__

FILE = "check-record.json"
"""Its name, one in each folder that has scenarios."""
RELATIVE = 0.05
"""Share by which time and path may differ before it is told: another platform rounds otherwise."""
CLEARANCE = 0.01
"""The same for the least clearance (m)."""
MAX_BYTES = 20_000_000


class BaselineRun(BaseModel):
    """One run, as it was.

    Attributes:
        file: The scenario file's name.
        platform: What the digest holds for, together with ``result.version``.
        result: Its figures.
    """

    model_config = ConfigDict(extra="forbid")

    file: str
    platform: str
    result: Result


class BaselineGroup(BaseModel):
    """The runs of one scenario with several seeds, as they were together.

    Attributes:
        file: The scenario file's name.
        platform: What the digest holds for, together with ``version``.
        version: Version of the package.
        passed: Runs that passed.
        runs: Runs in all.
        mean_time_s: Mean simulated time of the runs that passed (s).
        digest: Hash of the digests of all runs.
    """

    model_config = ConfigDict(extra="forbid")

    file: str
    platform: str
    version: str
    passed: int
    runs: int
    mean_time_s: float | None
    digest: str


class Baseline(BaseModel):
    """All runs recorded in a folder, by scenario, planner, drive and seed; and repeated ones.

    A group's key ends in its first seed and the number of its runs, such as ``0+20``.
    """

    model_config = ConfigDict(extra="forbid")

    format: Literal[1] = 1
    runs: dict[str, BaselineRun] = {}
    groups: dict[str, BaselineGroup] = {}


class Baselines:
    """The baselines of all folders, read when first needed.

    Attributes:
        problems: A line for each that cannot be read or written; the others do their work.
        missing: How many runs there was nothing to compare with.
    """

    def __init__(self) -> None:
        self._baselines: dict[Path, Baseline | None] = {}
        self.problems: list[str] = []
        self.missing = 0

    def changes(self, verdict: Verdict) -> list[str]:
        """Return what is otherwise than recorded; nothing where nothing was."""
        if verdict.result is None:
            return []
        record = self._of(Path(verdict.file).parent)
        entry = None if record is None else record.runs.get(_key(verdict.result))
        if entry is None:
            self.missing += 1
            return []
        return compare(entry, verdict.result)

    def group_changes(self, group: Group, verdicts: Sequence[Verdict]) -> list[str]:
        """Return what is otherwise than recorded of a group: pass rate, mean time, trajectories.

        Args:
            group: The verdict on all.
            verdicts: The runs.
        """
        key, record = _group_key(verdicts), self._of(Path(group.file).parent)
        if key is None:
            return []
        entry = None if record is None else record.groups.get(key)
        if entry is None:
            self.missing += 1
            return []
        return compare_groups(entry, group)

    def write(self, verdicts: Sequence[Verdict], groups: Sequence[Group] = ()) -> list[Path]:
        """Baseline the runs that passed, beside their scenarios; return what was written.

        Runs that were recorded before and are not among these stay, unless their file is gone.
        """
        folders: dict[Path, Baseline] = {}
        for verdict in verdicts:
            file = Path(verdict.file)
            record = self._of(file.parent)
            if verdict.status != "passed" or verdict.result is None or record is None:
                continue
            folders[file.parent] = record
            record.runs[_key(verdict.result)] = BaselineRun(
                file=file.name, platform=this_platform(), result=verdict.result
            )
        for group in groups:
            members = [verdict for verdict in verdicts if verdict.file == group.file]
            key, record = _group_key(members), folders.get(Path(group.file).parent)
            if group.status != "passed" or key is None or record is None:
                continue
            record.groups[key] = BaselineGroup(
                file=Path(group.file).name,
                platform=this_platform(),
                version=__version__,
                **group.model_dump(include={"passed", "runs", "mean_time_s", "digest"}),
            )
        written = []
        for folder, record in folders.items():
            together = {
                k: g for k, g in sorted(record.groups.items()) if (folder / g.file).exists()
            }
            kept = {k: e for k, e in sorted(record.runs.items()) if (folder / e.file).exists()}
            text = Baseline(runs=kept, groups=together).model_dump_json(indent=1)
            try:
                write_text(folder / FILE, text + "\n")
                written.append(folder / FILE)
            except UserError as error:
                self.problems += error.problems
        return written

    def _of(self, folder: Path) -> Baseline | None:
        if folder not in self._baselines:
            try:
                self._baselines[folder] = read(folder / FILE)
            except UserError as error:
                self._baselines[folder] = None
                self.problems += error.problems
        return self._baselines[folder]


def baselines_beside(files: Sequence[Path]) -> list[Path]:
    """Return where the records of scenario files are, or would be."""
    return [folder / FILE for folder in dict.fromkeys(file.parent for file in files)]


def refuse_unwritable(files: Sequence[Path]) -> None:
    """Make sure, before anything is driven, that --record can note beside scenario files.

    Raises:
        UserError: If a folder cannot be written to, or what is there is no record to add to.
    """
    for path in baselines_beside(files):
        writable_files(path.parent, [path.name])
        read(path)


def refuse_bundled(paths: Sequence[str]) -> None:
    """Make sure that --record is not asked to write beside what is bundled.

    Raises:
        UserError: If one of the paths is the name of a bundled scenario, and no file.
    """
    bundled = {file.stem: file for file in data_folder("scenarios").glob("*.yaml")}
    for path in paths:
        if path in bundled and not os.path.exists(path):  # noqa: PTH110 - a long name is no error
            raise UserError(
                f"{path}: --record notes beside the scenario, and this one is bundled with the "
                f"package; copy {bundled[path]} to a folder of your own"
            )


def read(path: Path) -> Baseline:
    """Read a record; an empty one where there is none.

    Raises:
        UserError: If it cannot be read, or is none of this format.
    """
    if not os.path.lexists(path):
        return Baseline()
    content = read_bytes(path, what="a record of fuzzyq check --record", most=MAX_BYTES)
    try:
        return Baseline.model_validate_json(content)
    except (ValidationError, ValueError) as error:
        raise UserError(f"{path}: not a record of fuzzyq check --record; delete it") from error


def compare(entry: BaselineRun, now: Result) -> list[str]:
    """Return what is otherwise than in an entry, a line each."""
    then, lines = entry.result, []
    if now.outcome != then.outcome:
        lines.append(f"outcome {now.outcome}, recorded {then.outcome}")
    for what, unit, a, b in (
        ("time", "s", now.time_s, then.time_s),
        ("path", "m", now.path_length_m, then.path_length_m),
    ):
        change = a / b - 1.0 if b > 0 else 0.0
        if abs(change) > RELATIVE:
            lines.append(f"{what} {_signed(100 * change, 0)} %: {a:.2f} {unit}, recorded {b:.2f}")
    least, before = now.min_clearance_m, then.min_clearance_m
    if (least is None) != (before is None):
        near = ["nothing near" if one is None else f"{one:.3f} m" for one in (least, before)]
        lines.append(f"clearance {near[0]}, recorded {near[1]}")
    elif least is not None and before is not None and abs(least - before) > CLEARANCE:
        change = 100 * (least - before)
        lines.append(f"clearance {_signed(change, 1)} cm: {least:.3f} m, recorded {before:.3f}")
    same_ground = (entry.platform, then.version) == (this_platform(), now.version)
    if not lines and same_ground and now.digest != then.digest:
        lines.append(
            f"another trajectory than recorded, with much the same figures "
            f"(digest {now.digest[:8]}, recorded {then.digest[:8]})"
        )
    return lines


def compare_groups(entry: BaselineGroup, now: Group) -> list[str]:
    """Return what is otherwise than in a group's entry, a line each."""
    lines = []
    if now.passed != entry.passed:
        lines.append(f"{now.passed} of {now.runs} pass, recorded {entry.passed} of {entry.runs}")
    a, b = now.mean_time_s, entry.mean_time_s
    if a is not None and b and abs(a / b - 1.0) > RELATIVE:
        lines.append(f"mean time {_signed(100 * (a / b - 1.0), 0)} %: {a:.2f} s, recorded {b:.2f}")
    same_ground = (entry.platform, entry.version) == (this_platform(), __version__)
    if not lines and same_ground and now.digest != entry.digest:
        lines.append(
            "other trajectories than recorded, with much the same figures "
            f"(digest {now.digest[:8]}, recorded {entry.digest[:8]})"
        )
    return lines


def this_platform() -> str:
    """Return what a digest depends on besides the version: every part that rounds in its own way.

    With the processor: libraries choose their arithmetic by it.
    """
    packages = [f"numpy {version('numpy')}", pybullet_in_words()]
    return ", ".join([platform.system(), platform.machine(), _processor(), *packages])


def _processor() -> str:
    try:
        with Path("/proc/cpuinfo").open(encoding="utf-8", errors="replace") as file:
            names = (line.partition(":")[2] for line in file if line.startswith("model name"))
            return next(names, "").strip() or "unknown processor"
    except OSError:
        return "unknown processor"


def _key(result: Result) -> str:
    return f"{result.scenario}/{result.planner}/{result.drive}/{result.seed}"


def _group_key(verdicts: Sequence[Verdict]) -> str | None:
    """Return the key of a group; None if its first run has no figures to tell it by."""
    first = verdicts[0].result
    return None if first is None else f"{_key(first)}+{len(verdicts)}"


def _signed(value: float, digits: int) -> str:
    return f"{value:+.{digits}f}".replace("-", "−")
