"""A plugin for pytest: scenario files as tests, and ``run_scenario`` for tests written by hand.

Loaded wherever the package is installed, so it imports nothing that takes time: neither the
package's own modules nor the physics, until a scenario is run.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Generator, Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from fuzzyq_bullet.checks.run_job import ScenarioRun
    from fuzzyq_bullet.checks.verdict import Verdict
    from fuzzyq_bullet.workers import WorkerPool

ENDINGS = (".scenario.yaml", ".scenario.yml")
IN_FOLDERS = (".yaml", ".yml")

_folders = pytest.StashKey[list[Path]]()
_pool = pytest.StashKey["WorkerPool"]()
_repeat = pytest.StashKey[int]()
MAX_REPEAT = 10_000


def pytest_addoption(parser: pytest.Parser) -> None:
    """Declare what may stand in the configuration."""
    parser.addini(
        "fuzzyq_scenarios",
        "folders in which every *.yaml file is a scenario of fuzzyq_bullet",
        type="paths",
        default=[],
    )
    parser.addini(
        "fuzzyq_plugins",
        "Python modules or files that register what scenarios ask for: planners, expectations",
        type="args",
        default=[],
    )
    parser.addini(
        "fuzzyq_repeat", "runs of each scenario, with seeds that count up from its own", default="1"
    )
    parser.addini("fuzzyq_timeout", "wall-clock seconds that one scenario may take", default="120")


def pytest_configure(config: pytest.Config) -> None:
    """Note the folders once.

    Raises:
        pytest.UsageError: If one is not there: what is misspelt must not pass for tested. If the
            number of runs is none.
    """
    folders = [Path(os.path.normpath(folder)) for folder in config.getini("fuzzyq_scenarios")]
    for folder in folders:
        if not folder.is_dir():
            raise pytest.UsageError(f"fuzzyq_scenarios: {folder}: there is no such folder")
    config.stash[_folders] = folders
    given = str(config.getini("fuzzyq_repeat"))
    if not (given.isascii() and given.isdigit() and 1 <= int(given[:9]) <= MAX_REPEAT):
        raise pytest.UsageError(
            f"fuzzyq_repeat: must be a whole number from 1 to {MAX_REPEAT}, got {given!r}"
        )
    config.stash[_repeat] = int(given)


def pytest_unconfigure(config: pytest.Config) -> None:
    """End the worker process, if there was one."""
    pool = config.stash.get(_pool, None)
    if pool is not None:
        pool.close()


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> pytest.Collector | None:
    """Take up scenario files; they are read when they are run."""
    if not _is_scenario(file_path, parent.config):
        return None
    collector: pytest.Collector = ScenarioFile.from_parent(parent, path=file_path)
    return collector


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report(
    collector: pytest.Collector,
) -> Generator[None, pytest.CollectReport, pytest.CollectReport]:
    """Take up dead links and FIFOs too, which pytest passes over: what is gone is no pass."""
    report = yield
    if isinstance(collector, getattr(pytest, "Directory", ())) and report.passed:
        for path in sorted(collector.path.iterdir()):
            if _is_scenario(path, collector.config) and not path.is_file() and not path.is_dir():
                report.result.append(ScenarioFile.from_parent(collector, path=path))
    return report


def _is_scenario(path: Path, config: pytest.Config) -> bool:
    if path.name.endswith(ENDINGS):
        return True
    in_folder = any(folder in path.parents for folder in config.stash[_folders])
    return in_folder and path.name.endswith(IN_FOLDERS)


@pytest.fixture
def run_scenario(request: pytest.FixtureRequest) -> Callable[..., ScenarioRun]:
    """Run a scenario in this process: ``run_scenario("field.yaml", planner=..., seed=...)``.

    A path is looked for beside the test first. What comes back has ``passed``, ``explanation``,
    ``result`` and ``trajectory``.
    """
    from fuzzyq_bullet.checks import run_job
    from fuzzyq_bullet.plugins import load_plugins

    load_plugins(_plugins(request.config))

    def run(source: str | os.PathLike[str], **options: Any) -> ScenarioRun:
        beside = request.path.parent / source
        again = _command(f"{_from_here(request.path)}::{_within(request.node.nodeid)}")
        file = _from_here(beside) if beside.is_file() else source
        return run_job.run_scenario(file, again=again, **options)

    return run


class ScenarioFile(pytest.File):
    """A scenario file: one test, or one for each seed and one for all of them."""

    def collect(self) -> Iterable[pytest.Item]:
        """Return its test, called like the file; before it, those of its seeds if it repeats."""
        name = self.path.name
        ending = next(one for one in (*ENDINGS, *IN_FOLDERS) if name.endswith(one))
        name = name.removesuffix(ending)
        repeat = self.config.stash[_repeat]
        if repeat == 1:
            yield ScenarioItem.from_parent(self, name=name)
            return
        self.verdicts: dict[int, Verdict] = {}
        for i in range(repeat):
            yield SeedItem.from_parent(self, name=f"{name}[seed+{i}]", index=i)
        yield GroupItem.from_parent(self, name=name)

    def repeated(self, test: str, wanted: Iterable[int]) -> dict[int, Verdict]:
        """Return verdicts by index of the seed; runs those that have not run in this process.

        Args:
            test: Name of the test that asks.
            wanted: Which seeds, counted from the scenario's own.

        Raises:
            ScenarioFailedError: If the scenario cannot be read.
        """
        from fuzzyq_bullet.checks.plan import Plan, planned, refuse_dead_link
        from fuzzyq_bullet.checks.session import check_all
        from fuzzyq_bullet.errors import UserError
        from fuzzyq_bullet.plugins import load_plugins

        missing = [i for i in wanted if i not in self.verdicts]
        if missing:
            file = _from_here(self.path)
            try:
                refuse_dead_link(self.path)
                load_plugins(_plugins(self.config))  # the seed is in a file that may need them
                plan = planned([Path(file)], Plan(repeat=self.config.stash[_repeat]))
                if plan.problems:
                    raise UserError(*plan.problems)
                again = _again(self.config, f"{file}::{test}")
                jobs = [plan.jobs[i].model_copy(update={"again": again}) for i in missing]
                for i, verdict in check_all(_pool_of(self.config), jobs):
                    self.verdicts[missing[i]] = verdict
            except UserError as error:
                raise _failed(error) from None
        return self.verdicts


class ScenarioItem(pytest.Item):
    """One scenario, held to what it expects."""

    def runtest(self) -> None:
        """Run it in a worker process, which it may bring down.

        Raises:
            ScenarioFailedError: If it did not do what it expects, or could not be run.
        """
        from fuzzyq_bullet.checks.plan import refuse_dead_link
        from fuzzyq_bullet.checks.session import check_all
        from fuzzyq_bullet.checks.verdict import Job, explanation
        from fuzzyq_bullet.errors import UserError

        file = _from_here(self.path)
        job = Job(file=file, name=self.name, again=_again(self.config, f"{file}::{self.name}"))
        try:
            refuse_dead_link(self.path)
            ((_, verdict),) = check_all(_pool_of(self.config), [job])
        except UserError as error:
            raise _failed(error) from None
        if verdict.status != "passed":
            raise ScenarioFailedError(explanation(verdict))

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style: Any = None) -> Any:
        """Return the explanation alone; where in the plugin it was raised helps nobody."""
        if isinstance(excinfo.value, ScenarioFailedError):
            return str(excinfo.value)
        return super().repr_failure(excinfo, style)

    def reportinfo(self) -> tuple[Path, int | None, str]:
        """Return what the report is headed with."""
        return self.path, None, f"scenario {self.name}"


class SeedItem(ScenarioItem):
    """One scenario with one of several seeds.

    Args:
        index: Which, counted from the scenario's own.
        options: What pytest gives.
    """

    def __init__(self, *, index: int, **options: Any) -> None:
        super().__init__(**options)
        self._index = index

    def runtest(self) -> None:
        """Run it. Where not every run has to pass, a miss is expected (xfail): the group decides.

        Raises:
            ScenarioFailedError: If every run has to pass, or it crashed, hung or cannot be run.
        """
        from fuzzyq_bullet.checks.verdict import explanation

        verdict = _file_of(self).repeated(self.name, [self._index])[self._index]
        if verdict.status == "failed" and verdict.expect and verdict.expect["pass_rate"] < 1.0:
            pytest.xfail(f"{'; '.join(verdict.why)}; {verdict.replay}")
        if verdict.status != "passed":
            raise ScenarioFailedError(explanation(verdict))


class GroupItem(ScenarioItem):
    """One scenario with all its seeds, held to its pass rate."""

    def runtest(self) -> None:
        """Judge all runs; those that another process did, or that were left out, run here.

        Raises:
            ScenarioFailedError: If too few passed, or one crashed, hung or cannot be run.
        """
        from fuzzyq_bullet.checks.group import group_lines, group_of

        count = self.config.stash[_repeat]
        verdicts = _file_of(self).repeated(self.name, range(count))
        group = group_of(self.name, [verdicts[i] for i in range(count)])
        lines = "\n".join(group_lines(group))
        if group.status != "passed":
            raise ScenarioFailedError(lines)
        self.add_report_section("call", "fuzzyq", lines)  # shown by -rP


class ScenarioFailedError(Exception):
    """Why a scenario failed, in lines for people."""


def _failed(error: Exception) -> ScenarioFailedError:
    return ScenarioFailedError(str(error).replace("--plugin:", "fuzzyq_plugins:"))


def _file_of(item: pytest.Item) -> ScenarioFile:
    assert isinstance(item.parent, ScenarioFile)
    return item.parent


def _again(config: pytest.Config, test: str) -> str:
    """Return the command that runs a test again if only pytest can; else nothing.

    What lies on the path of pytest alone, only pytest finds again.
    """
    modules = any(not name.endswith(".py") for name in config.getini("fuzzyq_plugins"))
    return _command(test) if modules else ""


def _pool_of(config: pytest.Config) -> WorkerPool:
    """Return the worker process of this session; with pytest-xdist each of its processes has one.

    Raises:
        UserError: If the time limit in the configuration is no number.
    """
    if _pool not in config.stash:
        from fuzzyq_bullet.errors import UserError
        from fuzzyq_bullet.workers import WorkerPool

        given = str(config.getini("fuzzyq_timeout"))
        try:
            timeout = float(given)
        except ValueError:
            timeout = 0.0
        if not 0.0 < timeout <= 86400.0:
            raise UserError(f"fuzzyq_timeout: must be seconds, more than 0, got {given!r}")
        config.stash[_pool] = WorkerPool(1, plugins=_plugins(config), timeout=timeout)
    return config.stash[_pool]


def _plugins(config: pytest.Config) -> list[str]:
    """Return the modules of ``fuzzyq_plugins``; files lie beside the configuration."""
    base = config.inipath.parent if config.inipath is not None else config.rootpath
    return [
        _from_here(base / name) if name.endswith(".py") else name
        for name in config.getini("fuzzyq_plugins")
    ]


def _from_here(path: Path) -> str:
    """Return a path as somebody in the current folder would write it."""
    here = Path.cwd()
    return str(path.relative_to(here) if path.is_relative_to(here) else path)


def _within(nodeid: str) -> str:
    """Return what a test is called within its file."""
    return nodeid.partition("::")[2]


def _command(nodeid: str) -> str:
    """Return the command that runs one test."""
    import shlex

    return shlex.join(["pytest", nodeid])
