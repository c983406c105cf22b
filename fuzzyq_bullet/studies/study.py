"""What a study is: options, plans of what is run, and findings that follow from the rows."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Generator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Literal, NamedTuple, TypeAlias

from pydantic import BaseModel, ConfigDict, Field

from fuzzyq_bullet.planning import PlannerSettings
from fuzzyq_bullet.studies.episodes import MOST_SEED, Place, Row
from fuzzyq_bullet.studies.plan import FieldsPlan, Plan

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class Swept:
    """What came of a plan.

    Attributes:
        plan: It.
        rows: Its rows so far, sorted.
        settings: All that its folder says of it.
        rate: Episodes per second of this time; 0 where none ran.
        folder: Where it lies.
    """

    plan: Any
    rows: tuple[Row, ...]
    settings: Mapping[str, Any] = field(default_factory=dict)
    rate: float = 0.0
    folder: Path = Path()

    @property
    def finished(self) -> bool:
        """Whether all of its episodes have a row."""
        return bool(len(self.rows) == self.plan.total)


Sense: TypeAlias = Literal["exactly", "at most", "at least"]
"""On which side of its bound a figure should be."""
Work: TypeAlias = Callable[[dict[str, Any]], dict[str, Any]]
"""What does a job in a worker process; job and answer as JSON can say them."""
Results: TypeAlias = Mapping[str, Swept]
"""What came of the plans of a study, by stage."""


class Stage(NamedTuple):
    """One sweep of a study.

    Attributes:
        name: What its table is called: ``NAME.csv``.
        plan: What is run.
        planners: The settings of each planner, by what rows call it.
        notes: Lines to say before it begins.
    """

    name: str
    plan: Plan
    planners: Mapping[str, PlannerSettings]
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class Table:
    """A table for a terminal and for the page of a report.

    Attributes:
        caption: What it shows, and how it was made.
        columns: Headings.
        rows: Cells, a text for each column; lines within a cell by line breaks.
        left: Columns that are set to the left; others are numbers, set to the right.
        total: Whether the last row sums up the others.
    """

    caption: str
    columns: Sequence[str]
    rows: Sequence[Sequence[str]]
    left: Sequence[int] = (0,)
    total: bool = False


class Picture(NamedTuple):
    """A picture: what makes it, what it shows for those who do not see it, what stands below."""

    draw: Callable[[], Figure]
    alt: str
    caption: str = ""


@dataclass(frozen=True)
class Findings:
    """What the rows of a study say.

    Attributes:
        tables: What is printed, and stands on the page.
        data: All of it for programs: ``NAME.json``.
        remarks: Lines below the tables.
        missed: Targets that were missed: exit code 1.
        problems: Inputs that could not be read, a line each: exit code 2.
        pictures: The first is ``NAME.png``; all are on the page.
        headline: What stands at the top of the page.
        details: Tables that stand on the page alone.
    """

    tables: tuple[Table, ...]
    data: Mapping[str, Any]
    remarks: tuple[str, ...] = ()
    missed: tuple[str, ...] = ()
    problems: tuple[str, ...] = ()
    pictures: tuple[Picture, ...] = ()
    headline: Table | None = None
    details: tuple[Table, ...] = ()


class Study(BaseModel):
    """A study: a question to planners, put in many environments (``fuzzyq bench NAME``).

    Write one as a subclass with ``@register_study`` and the command line, the sweep over all cores
    or a cluster, resuming, CSV, JSON, picture and report follow from it:

    * its docstring is the help of the command;
    * its fields are the options: ``int``, ``float``, ``str`` or ``Path``, each with a default and,
      by ``pydantic.Field``, a ``description`` and bounds (``ge``, ``le``). ``seed`` is there;
    * ``planner_set`` returns who is asked, and ``plan`` where, usually a ``FieldsPlan``;
    * ``findings`` returns what the rows say: tables, and data for programs.

    A study of several sweeps, each planned by what came of those before, overrides ``stages``
    instead of ``plan`` and ``planner_set``, and has an entry in ``stage_plans`` and ``folders`` for
    each; ``recalled`` then tells a report how to get from the plans back to the options.

    Attributes:
        name: What the command line and the files call it.
        title: What the report calls it.
        stage_plans: The class of each stage's plan, by the name of the stage.
        folders: Where each stage lies in the folder of the study, if not there.
        width: Columns that its tables need.
        pictured: Whether there is a ``NAME.png``.
        filmed: Whether a report shows films of the best, median and worst runs.
        kept: Whether runs are kept that failed although there was a way.
        seed: Of the sweep.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    name: ClassVar[str]
    title: ClassVar[str] = ""
    stage_plans: ClassVar[Mapping[str, type[Plan]]] = {}
    folders: ClassVar[Mapping[str, str]] = {}
    width: ClassVar[int] = 100
    pictured: ClassVar[bool] = False
    filmed: ClassVar[bool] = False
    kept: ClassVar[bool] = False

    seed: int = Field(0, ge=0, le=MOST_SEED, description="Seed of the sweep.")

    def planner_set(self) -> Mapping[str, PlannerSettings]:
        """Return who is asked, by what rows call them.

        Raises:
            UserError: If an option is wrong.
        """
        raise NotImplementedError

    def plan(self) -> Plan:
        """Return what is run.

        Raises:
            UserError: If an option is wrong.
        """
        raise NotImplementedError

    def stages(self) -> Generator[Stage, Swept, None]:
        """Yield its sweeps one after the other; what came of each is sent back.

        Raises:
            UserError: If an option is wrong.
        """
        yield Stage(self.name, self.plan(), self.planner_set())

    def work(self) -> Work:
        """Return what turns a job into its row, in a worker: a function of a module."""
        from fuzzyq_bullet.studies.sweep import work, work_for_row

        return work if self.kept else work_for_row

    def findings(self, results: Results) -> Findings:
        """Return what the rows say; nothing is run.

        Args:
            results: What came of each stage, by its name; of a study with one, by its own.
        """
        raise NotImplementedError

    @classmethod
    def stage_kinds(cls) -> Mapping[str, type[Plan]]:
        """Return the class of each stage's plan, by the name of the stage."""
        return cls.stage_plans or {cls.name: FieldsPlan}

    @classmethod
    def recalled(cls, plans: Mapping[str, Any]) -> Study | None:
        """Return the study whose plans these are, as its folders say them.

        Returns:
            None if one is missing without which there is nothing to be found.
        """
        *_, plan = plans.values()
        told = plan.described()
        if "counts" in told:
            told["counts"] = numbers(told["counts"])
        if "planners" in told:
            told["planners"] = ",".join(told["planners"])
        return cls.model_validate({key: told[key] for key in told if key in cls.model_fields})

    @classmethod
    def usable(cls, results: Results) -> Results | None:
        """Return what of an unfinished study can be shown; None for nothing yet.

        By default the rows of those environments that every planner has met.
        """
        last = list(results)[-1]
        rows = met_by_all(results[last].rows)
        if not rows:
            return None
        swept = results[last]
        return {**results, last: Swept(swept.plan, rows, swept.settings, swept.rate, swept.folder)}

    def heading(self) -> str:
        """Return what a report calls it."""
        drive = getattr(self, "drive", None)
        return f"{self.title or self.name}{f', {drive}' if drive else ''}"

    def command(self, out: Path) -> str:
        """Return the command that makes it, into a folder."""
        fields = sorted(type(self).model_fields, key=lambda name: name == "seed")
        given = {name: getattr(self, name) for name in fields}
        words = [(f"--{key.replace('_', '-')}", value) for key, value in given.items()]
        told = [f"{key} {shlex.quote(str(value))}" for key, value in words if value is not None]
        return " ".join(["fuzzyq bench", self.name, *told, f"--out {shlex.quote(str(out))}"])


def cell(value: object, form: str = "") -> str:
    """Return a figure as a cell of a table shows it; – for None."""
    return "–" if value is None else format(value, form)


def meets(figure: float, sense: Sense, bound: float) -> bool:
    """Tell whether a figure is what it should be."""
    if sense == "exactly":
        return figure == bound
    return figure <= bound if sense == "at most" else figure >= bound


@dataclass(frozen=True)
class Target:
    """What a figure should be; it is None where there was nothing to measure."""

    what: str
    figure: float | None
    bound: float
    sense: Sense

    @property
    def met(self) -> bool:
        """Whether it is met; a gain that could not be measured is none."""
        return self.figure is not None and meets(self.figure, self.sense, self.bound)

    def __str__(self) -> str:
        seen = "not measured" if self.figure is None else f"{self.figure:.4g}"
        return f"{self.what} {seen}, wanted {self.sense} {self.bound:g}"


def numbers(counts: Sequence[int]) -> str:
    """Return numbers of obstacles as options give them."""
    return ",".join(map(str, counts)) or "none"


def met_by_all(rows: Sequence[Row]) -> tuple[Row, ...]:
    """Return the rows of those environments that every planner has one for."""
    met: dict[str, set[Place]] = {}
    for row in rows:
        met.setdefault(row.planner, set()).add(row.place)
    shared = set.intersection(*met.values()) if met else set()
    return tuple(row for row in rows if row.place in shared)
