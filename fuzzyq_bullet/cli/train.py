"""``fuzzyq train``: a planner learns, in a way that may be interrupted anywhere and goes on."""

from __future__ import annotations

import shlex
from json import dumps
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fuzzyq_bullet.cli.options import PluginOption, progress_bar, say
from fuzzyq_bullet.errors import Stopped, UserError

HOW: dict[str, Any] = {"rich_help_panel": "Changes to how it learns"}
"""Where --help shows what few need."""

if TYPE_CHECKING:
    from fuzzyq_bullet.learning.checkpoint import Curve
    from fuzzyq_bullet.training.config import TrainingConfig
    from fuzzyq_bullet.training.field import FieldTask
    from fuzzyq_bullet.training.session import TrainingFiles, TrainingProgress
    from fuzzyq_bullet.training.tasks import Tasks


def train(
    planner: Annotated[str, typer.Argument(metavar="PLANNER", help="Planner that learns.")],
    *,
    episodes: Annotated[
        int | None,
        typer.Option(help="Episodes to learn from.", show_default="200; 50 to learn one field"),
    ] = None,
    drive: Annotated[
        str | None,
        typer.Option(
            help="kinematic, or wheels (physics).", show_default="kinematic; that of the field"
        ),
    ] = None,
    scenario: Annotated[
        str | None,
        typer.Option(
            help="Learn on this file or bundled scenario; fuzzy-q-lambda learns its field."
        ),
    ] = None,
    seed: Annotated[
        int | None, typer.Option(help="Seed of the training.", show_default="0; that of the field")
    ] = None,
    rate: Annotated[
        str | None,
        typer.Option(metavar="FROM[:TO]", help="Learning rate η, as in 0.1:0.01.", **HOW),
    ] = None,
    trace: Annotated[
        str | None, typer.Option(metavar="FROM[:TO]", help="Trace decay λ, as in 0.9.", **HOW)
    ] = None,
    epsilon: Annotated[
        str | None,
        typer.Option(metavar="FROM[:TO]", help="Exploration ε, as in 0.5:0.05.", **HOW),
    ] = None,
    discount: Annotated[
        str | None, typer.Option(metavar="NUMBER", help="Discount γ, 0 to 1.", **HOW)
    ] = None,
    reward: Annotated[
        str | None,
        typer.Option(
            metavar="PARTS",
            help="As in hit=30,given_up=10,progress=1; or the name of a plugin's reward.",
            **HOW,
        ),
    ] = None,
    rules: Annotated[
        str | None,
        typer.Option(
            metavar="FILE",
            help="Rules of your own whose weights fuzzy-q-lambda learns (docs/how-to/rules.md).",
            **HOW,
        ),
    ] = None,
    options: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="YAML file with any of these, episodes, drive and seed; the command line wins.",
            **HOW,
        ),
    ] = None,
    out: Annotated[
        str | None,
        typer.Option(
            metavar="FILE",
            help="Policy to write.",
            show_default="out/train/PLANNER.json; with the name of the field behind it",
        ),
    ] = None,
    resume: Annotated[
        bool, typer.Option("--resume", help="Go on with a training that was begun.")
    ] = False,
    anew: Annotated[
        bool, typer.Option("--anew", help="Begin again, whatever was begun or made there before.")
    ] = False,
    plugin: PluginOption = None,
    json: Annotated[bool, typer.Option("--json", help="Summary as JSON on stdout, alone.")] = False,
) -> None:
    """Train a planner; write PLANNER.json (the policy) and PLANNER.png (the learning curve).

    May be ended at any moment: after every episode PLANNER.checkpoint.npz is renewed, and --resume
    goes on to the very same policy. To use it, name it in a scenario file:
    planner: {name: PLANNER, policy: FILE}.

    Raises:
        UserError: If an option is wrong, a file cannot be written, or what was begun is another
            training.
    """
    # What takes long to load waits until the options are known to be right.
    if resume and anew:
        raise UserError("--resume, --anew: give one of them; the first goes on, the other does not")
    from fuzzyq_bullet.files import alone_at, refuse_inputs
    from fuzzyq_bullet.outputs import plugin_inputs
    from fuzzyq_bullet.training.config import config_for, tasks_for
    from fuzzyq_bullet.training.options import AS_USUAL, LearningOptions, read_options
    from fuzzyq_bullet.training.session import (
        TrainingFiles,
        TrainingProgress,
        episodes_done,
        episodes_kept,
        name_of,
        summary_of,
    )

    given = {
        name: text
        for name, text in (
            *(("rate", rate), ("trace", trace), ("epsilon", epsilon)),
            *(("discount", discount), ("reward", reward)),
        )
        if text is not None
    }
    asked, plain, places = (AS_USUAL, {}, {}) if options is None else read_options(options)
    here = {"episodes": episodes, "drive": drive, "seed": seed}
    plain |= {name: value for name, value in here.items() if value is not None}
    try:
        config = config_for(
            planner,
            plain.get("episodes"),
            plain.get("drive"),
            plain.get("seed"),
            scenario,
            asked.changed_by(LearningOptions.parse(given)),
            plugin or [],
            rules,
        )
    except UserError as error:
        name, _, why = error.problems[0].partition(": ")
        key = name.removeprefix("--")
        if here.get(key) is None and key not in given and key in places:  # it stands in the file
            raise UserError(f"{places[key]}: {why}") from error
        raise
    tasks = tasks_for(config)
    files = TrainingFiles.of(name_of(config, tasks), out)
    files.check()
    from fuzzyq_bullet.scenario import find_scenario

    read = [] if scenario is None else [find_scenario(scenario)]
    read += [Path(one) for one in (options, rules) if one is not None]
    refuse_inputs(files.all, [*read, *plugin_inputs(plugin or [])])
    try:
        with alone_at(files.checkpoint):
            done = episodes_done(config, tasks, files, resume=resume, anew=anew)
            progress = TrainingProgress(done)
            curve = _learn(config, tasks, files, progress, resume=resume or done > 0)
    except Stopped:
        where = [] if out is None else ["--out", out]
        again = f"{config.command} {shlex.join([*where, '--resume'])}"
        kept = episodes_kept(files.checkpoint)
        say(f"{kept} of {config.episodes} episodes are kept; to go on: {again}")
        raise
    summary = summary_of(config, curve, progress, files)
    if json:
        typer.echo(dumps(summary, indent=2))
    _tell(config, summary)


def _learn(
    config: TrainingConfig,
    tasks: Tasks | FieldTask,
    files: TrainingFiles,
    progress: TrainingProgress,
    *,
    resume: bool,
) -> Curve:
    """Train with a progress bar, and draw the learning curve."""
    from fuzzyq_bullet.training.session import learn_policy, most_of, title_of

    with progress_bar("training", config.episodes) as (bar, task):

        def show(note: str, done: int) -> None:
            bar.update(task, completed=done, note=note)

        show("", progress.before)
        told = progress.shown(config.episodes, show)
        curve = learn_policy(config, tasks, files, told, resume=resume)

    from fuzzyq_bullet.figures.learning_curve import picture
    from fuzzyq_bullet.figures.style import save_png
    from fuzzyq_bullet.training.field import FieldTask

    title, bound = title_of(config, tasks), most_of(tasks)
    same = isinstance(tasks, FieldTask)
    save_png(picture(curve, title, same=same, bound=bound), files.picture)
    return curve


def _tell(config: TrainingConfig, summary: dict[str, Any]) -> None:
    rate, before, now = (summary[k] for k in ("episodes_per_s", "episodes_before", "episodes_now"))
    if now:
        pace = f"{now} episodes in {summary['time_s']:.1f} s: {rate:.2f} episodes/s"
        pace += f"; {before} were done already" if before else ""
    else:
        pace = f"all {before} episodes were done already; --anew trains again"
    say(f"{config.planner}: {pace} ({config.drive}, seed {config.seed})", style="bold")
    say(_gain(summary))
    for key in ("policy", "picture", "checkpoint"):
        say(f"  {summary[key]}")


def _gain(summary: dict[str, Any]) -> str:
    if "first_s" not in summary:
        first, last = (100 * summary[key] for key in ("success_first", "success_last"))
        window = f"the first {summary['window']} episodes"
        return f"goal reached in {first:.0f} % of {window}, {last:.0f} % of the last"
    if summary["fastest_run"] is None:
        return "the goal was reached in no run"
    first = summary["first_s"]
    return (
        f"the first run {'did not get to the goal' if first is None else f'took {first:.1f} s'}, "
        f"the fastest (number {summary['fastest_run']}) took {summary['fastest_s']:.1f} s; "
        f"contacts in {summary['collisions']} of {summary['episodes']} runs"
    )
